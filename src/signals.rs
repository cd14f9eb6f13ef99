//! What happens when the program is told to end: a recording is finished, unless it is told so again, and nothing half-written
//! stays behind.

#[cfg(feature = "window")]
use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use std::{fs, thread};

use carom::headless::discard_unfinished;
use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXCPU, SIGXFSZ};
use signal_hook::flag;
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

/// A signal that comes so soon after the first is the same call: `timeout` sends it to the program and to its group, and a terminal
/// that is closed more than once.
const SAME: Duration = Duration::from_millis(250);

/// From now on, a signal that ends the program finishes the window's recording first, removes other unfinished outputs, lets
/// `last_words` be said, and then ends it as ever: whoever waits for it sees which signal it was, and a shell's script stops as
/// it should. Another SIGINT, SIGQUIT or SIGTERM meanwhile ends it at once; the recording is not saved then.
pub fn watch(last_words: impl FnOnce() + Send + 'static) {
    let ignored = ignored();
    // Where nobody waits for SIGXFSZ, a file beyond the limit (`ulimit -f`) ends the program; the flag, which nobody reads, makes
    // an error of it that the write returns.
    let _ = flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)));
    let watched = [SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXCPU]
        .into_iter()
        .filter(|signal| ignored & (1 << (signal - 1)) == 0);
    // Where signals cannot be watched, they end the program as they always did.
    let Ok(mut signals) = Signals::new(watched) else { return };
    thread::spawn(move || {
        let Some(signal) = signals.forever().next() else { return };
        let first = Instant::now();
        let again = thread::Builder::new();
        // Where no thread is to be had, the recording is waited for whatever comes.
        let _ = again.spawn(move || {
            // Others come by themselves once more: SIGXCPU does every second.
            let insists = |signal: &_| [SIGINT, SIGQUIT, SIGTERM].contains(signal) && first.elapsed() > SAME;
            if let Some(signal) = signals.forever().find(insists) {
                end(signal, || {});
            }
        });
        #[cfg(feature = "window")]
        if let Some(said) = carom::window::end_recording() {
            let _ = writeln!(io::stderr(), "carom: {said}");
        }
        end(signal, last_words);
    });
}

/// Ends the program as this signal does, with nothing half-written left.
fn end(signal: i32, last_words: impl FnOnce()) {
    discard_unfinished();
    last_words();
    let _ = emulate_default_handler(signal);
}

/// The signals that whoever started the program wants to be ignored (nohup, a shell for what runs in the background),
/// signal 1 in the lowest bit; none where the system does not say.
fn ignored() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or_default()
}
