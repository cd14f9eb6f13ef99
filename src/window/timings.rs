//! Where the frames' time went, for `--timings`.

use std::fmt;
use std::time::Duration;

/// The times of each frame's four parts, ms.
#[derive(Debug, Default)]
pub(super) struct Timings {
    frames: Vec<[f64; 4]>,
}

const PARTS: [&str; 4] = ["advance", "paint", "upload", "present"];

impl Timings {
    pub(super) fn add(&mut self, parts: [Duration; 4]) {
        self.frames.push(parts.map(|part| part.as_secs_f64() * 1e3));
    }
}

impl fmt::Display for Timings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "frame times in ms, {} frames", self.frames.len())?;
        if self.frames.is_empty() {
            return Ok(());
        }
        for (part, name) in PARTS.iter().enumerate() {
            let mut times: Vec<f64> = self.frames.iter().map(|frame| frame[part]).collect();
            times.sort_by(f64::total_cmp);
            let at = |share: f64| times[(share * (times.len() - 1) as f64) as usize];
            write!(
                f,
                "\n{name:<8} median {:.4}, 99 % under {:.4}, longest {:.4}",
                at(0.5),
                at(0.99),
                at(1.0)
            )?;
        }
        Ok(())
    }
}
