//! A cell in a process of its own, which may hang, abort or take too much memory.

use std::fs;
use std::io::{self, Read};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::cell::Cell;
use crate::report::document::duration;

/// A process that takes more memory is ended, bytes.
const MOST_MEMORY: u64 = 2 << 30;
/// How often it is looked at.
const LOOK: Duration = Duration::from_millis(4);
/// A cell ends itself at its limit where the solver asks; one that does not is ended after so many times that.
const PATIENCE: u32 = 3;

/// Runs a cell in a process.
pub(super) fn cell(program: &Path, name: &str, quick: bool, limit: Duration) -> Cell {
    let mut command = Command::new(program);
    command.args(["report", "--cell", name]).args(quick.then_some("--quick"));
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null());
    let begun = Instant::now();
    let ended = command.spawn().and_then(|child| wait(child, limit * PATIENCE + Duration::from_secs(1)));
    let used = begun.elapsed().as_secs_f64();
    let failed = |why: String| Cell { run_seconds: used, ..Cell::failed(why) };
    match ended {
        Ok(Ended::Itself(status, text)) if status.success() => serde_json::from_str(&text)
            .unwrap_or_else(|error| failed(format!("its result is no result: {error}"))),
        Ok(Ended::Itself(status, _)) => failed(format!("it aborted ({status})")),
        Ok(Ended::Late) => {
            let why = format!("a frame did not end within {}", duration(used));
            Cell { run_seconds: used, ..Cell::ran_out(why) }
        }
        Ok(Ended::TooLarge) => failed(format!("it took more than {} GiB of memory", MOST_MEMORY >> 30)),
        Err(error) => failed(format!("its process did not run: {error}")),
    }
}

enum Ended {
    Itself(ExitStatus, String),
    Late,
    TooLarge,
}

/// Waits for a process, and ends it where it takes too long or too much.
fn wait(mut child: Child, limit: Duration) -> io::Result<Ended> {
    let begun = Instant::now();
    let ended = loop {
        if let Some(status) = child.try_wait()? {
            // What a cell writes fits into the pipe's buffer, so that it never waits for its reader.
            let mut text = String::new();
            if let Some(mut output) = child.stdout.take() {
                output.read_to_string(&mut text)?;
            }
            return Ok(Ended::Itself(status, text));
        }
        if begun.elapsed() > limit {
            break Ended::Late;
        }
        if memory(child.id()).is_some_and(|bytes| bytes > MOST_MEMORY) {
            break Ended::TooLarge;
        }
        thread::sleep(LOOK);
    };
    child.kill()?;
    child.wait()?;
    Ok(ended)
}

/// The memory that a process of this number holds, bytes, where the system tells it.
fn memory(process: u32) -> Option<u64> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let resident = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    resident.trim().trim_end_matches(" kB").parse::<u64>().ok().map(|kilobytes| kilobytes << 10)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::stability::cell::Verdict;

    #[cfg(target_os = "linux")]
    #[test]
    fn the_memory_of_a_process_is_told() {
        let held = std::hint::black_box(vec![1_u8; 64 << 20]);
        let told = memory(std::process::id()).unwrap();
        // Other tests run meanwhile.
        assert!((held.len() as u64..1 << 34).contains(&told), "{told}");
    }

    #[cfg(unix)]
    #[test]
    fn a_process_that_fails_hangs_or_is_missing_is_a_cell_that_failed() {
        let limit = Duration::from_millis(10);
        for (program, why) in
            [("/bin/false", "aborted"), ("/bin/true", "no result"), ("/no/such/program", "did not run")]
        {
            let cell = cell(Path::new(program), "corner/exact", true, limit);
            assert_eq!(cell.verdict, Verdict::Failed);
            assert!(cell.why.contains(why), "{cell:?}");
        }
        let child = Command::new("/bin/sleep").arg("20").stdout(Stdio::piped()).spawn().unwrap();
        assert!(matches!(wait(child, limit), Ok(Ended::Late)));
    }
}
