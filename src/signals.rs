//! What happens when the program is told to end: a recording is finished, and nothing half-written stays behind.

#[cfg(feature = "window")]
use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::{fs, thread};

use carom::headless::discard_unfinished;
use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXCPU, SIGXFSZ};
use signal_hook::flag;
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

/// From now on, a signal that ends the program finishes the window's recording first, removes other unfinished outputs, lets
/// `last_words` be said, and then ends it as ever: whoever waits for it sees which signal it was, and a shell's script stops as
/// it should.
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
        if let Some(signal) = signals.forever().next() {
            #[cfg(feature = "window")]
            if let Some(said) = carom::window::end_recording() {
                let _ = writeln!(io::stderr(), "carom: {said}");
            }
            discard_unfinished();
            last_words();
            let _ = emulate_default_handler(signal);
        }
    });
}

/// The signals that whoever started the program wants to be ignored (nohup, a shell for what runs in the background),
/// signal 1 in the lowest bit; none where the system does not say.
fn ignored() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or_default()
}
