//! The deltas of a run: even ones at a frame rate, or those of a file.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::scene::{read_up_to, shown};
use crate::simulation::limits::{DELTA, OutOfRange, Short};

/// The frames of a run, one delta in seconds each.
#[derive(Debug, Clone, PartialEq)]
pub struct Frames(Kind);

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    /// A first frame of 0 s, `whole` frames of `delta`, and the rest of the time where it is not 0.
    Even {
        whole: u64,
        delta: f64,
        rest: f64,
    },
    Listed(Vec<f64>),
}

/// Why there are no frames to run.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FramesError {
    /// The time, s, is out of range.
    #[error("the time is {} s; give 0 to {LONGEST:e}", Short(*.0))]
    Seconds(f64),
    /// The frame rate, frames per second, is out of range.
    #[error("the frame rate is {} per second; give {:e} to {:e}", Short(*.0), RATES.0, RATES.1)]
    Rate(f64),
    /// They come to too many frames.
    #[error(
        "{} s at {} frames per second are {:e} frames; ask for at most {MOST_FRAMES:e}",
        Short(*seconds), Short(*rate), seconds * rate
    )]
    TooMany {
        /// The time, s.
        seconds: f64,
        /// The frame rate, frames per second.
        rate: f64,
    },
    /// The file of deltas cannot be read.
    #[error("{}: {source}; give a file with one delta in seconds a line", path.display())]
    Unreadable {
        /// The file's path.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A line of the file is not a delta.
    #[error("{}:{line}: {message}; write one delta in seconds a line, such as 0.0166", path.display())]
    Line {
        /// The file's path.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        message: String,
    },
    /// The file of deltas has none.
    #[error("{} has no deltas; write one delta in seconds a line", path.display())]
    Empty {
        /// The file's path.
        path: PathBuf,
    },
}

/// The lowest and the highest frame rate, frames per second.
const RATES: (f64, f64) = (1e-6, 1e9);
/// The longest run, s: 31 years.
const LONGEST: f64 = 1e9;
/// The most frames of a run.
const MOST_FRAMES: f64 = 1e15;
/// The longest file of deltas, bytes: ten million frames.
const LONGEST_FILE: u64 = 1 << 28;
/// The most characters of a line that a message quotes.
const LONGEST_QUOTE: usize = 60;
/// Time that differs from a whole number of frames by no more than this part of one, and no more seconds, is that number of frames.
const ROUNDING: f64 = 1e-6;

impl Frames {
    /// `seconds` in frames of 1/`rate` s, after a first frame of 0 s as in the demo. Where the time is not a whole
    /// number of frames, the last one is shorter.
    ///
    /// # Errors
    /// [`FramesError::Seconds`] and [`FramesError::Rate`] where one of the two is out of range, [`FramesError::TooMany`] where they
    /// are together.
    pub fn even(seconds: f64, rate: f64) -> Result<Self, FramesError> {
        if !(0.0..=LONGEST).contains(&seconds) {
            return Err(FramesError::Seconds(seconds));
        }
        if !(RATES.0..=RATES.1).contains(&rate) {
            return Err(FramesError::Rate(rate));
        }
        let frames = seconds * rate;
        if frames > MOST_FRAMES {
            return Err(FramesError::TooMany { seconds, rate });
        }
        let delta = 1.0 / rate;
        let nearest = frames.round();
        let (whole, rest) = if (frames - nearest).abs() <= ROUNDING * rate.min(1.0) {
            (nearest, 0.0)
        } else {
            (frames.floor(), (frames - frames.floor()) / rate)
        };
        Ok(Self(Kind::Even { whole: whole as u64, delta, rest }))
    }

    /// The deltas of a file: one a line, blank lines and what stands after a # left out.
    ///
    /// # Errors
    /// [`FramesError`] where it cannot be read, or a line is not a delta.
    pub fn read(path: &Path) -> Result<Self, FramesError> {
        let text = read(path).map_err(|source| FramesError::Unreadable { path: path.to_owned(), source })?;
        Self::parse(path, &text)
    }

    /// The deltas of such a file's text; messages call it `path`.
    ///
    /// # Errors
    /// [`FramesError`] where a line is not a delta, or there is none.
    pub fn parse(path: &Path, text: &str) -> Result<Self, FramesError> {
        let mut deltas = Vec::new();
        // Some editors begin a file with a mark that nobody sees.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        for (line, entry) in (1..).zip(text.lines()) {
            let entry = entry.split('#').next().unwrap_or_default().trim();
            if entry.is_empty() {
                continue;
            }
            let wrong = |message| FramesError::Line { path: path.to_owned(), line, message };
            let delta: f64 = entry
                .parse()
                .map_err(|_| wrong(format!("\"{}\" is not a number", shown(entry, LONGEST_QUOTE))))?;
            deltas.push(DELTA.check(delta).map_err(|error: OutOfRange| wrong(error.to_string()))?);
        }
        if deltas.is_empty() {
            return Err(FramesError::Empty { path: path.to_owned() });
        }
        Ok(Self(Kind::Listed(deltas)))
    }

    /// How many frames there are.
    #[must_use]
    pub fn count(&self) -> u64 {
        match &self.0 {
            Kind::Even { whole, rest, .. } => 1 + whole + u64::from(*rest > 0.0),
            Kind::Listed(deltas) => deltas.len() as u64,
        }
    }

    /// How long all of them take, s.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        match &self.0 {
            Kind::Even { whole, delta, rest } => *whole as f64 * delta + rest,
            Kind::Listed(deltas) => deltas.iter().sum(),
        }
    }

    /// The delta in seconds of a frame, from 0, of which there are [`count`](Self::count); 0 where there is no such frame.
    #[must_use]
    pub fn delta(&self, frame: u64) -> f64 {
        match &self.0 {
            Kind::Even { .. } if frame == 0 => 0.0,
            Kind::Even { whole, delta, .. } if frame <= *whole => *delta,
            Kind::Even { whole, rest, .. } if frame == *whole + 1 => *rest,
            Kind::Even { .. } => 0.0,
            Kind::Listed(deltas) => deltas.get(frame as usize).copied().unwrap_or_default(),
        }
    }
}

/// The text of a file of deltas, which is at most [`LONGEST_FILE`] bytes long.
fn read(path: &Path) -> io::Result<String> {
    let too_long = || io::Error::other(format!("the file has more than {LONGEST_FILE} bytes"));
    read_up_to(LONGEST_FILE, path)?.ok_or_else(too_long)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(frames: &Frames) -> Vec<f64> {
        (0..frames.count()).map(|frame| frames.delta(frame)).collect()
    }

    #[test]
    fn even_frames_begin_with_nothing_and_add_up_to_the_time() {
        assert_eq!(all(&Frames::even(0.0, 60.0).unwrap()), [0.0]);
        assert_eq!(all(&Frames::even(0.1, 60.0).unwrap()), [[0.0].as_slice(), &[1.0 / 60.0; 6]].concat());
        assert_eq!(all(&Frames::even(1.0, 0.5).unwrap()), [0.0, 1.0]);
        // However few of them there are in a second.
        assert_eq!(all(&Frames::even(1.0, 1e-6).unwrap()), [0.0, 1.0]);
        let uneven = all(&Frames::even(0.25, 10.0).unwrap());
        assert_eq!(uneven.len(), 4);
        assert!((uneven.iter().sum::<f64>() - 0.25).abs() < 1e-15);
    }

    #[test]
    fn frames_take_as_long_as_their_deltas_together() {
        let listed = Frames::parse(Path::new("deltas.txt"), "0\n0.5\n0.25").unwrap();
        for frames in [Frames::even(0.25, 10.0).unwrap(), Frames::even(0.0, 60.0).unwrap(), listed] {
            assert!((frames.seconds() - all(&frames).iter().sum::<f64>()).abs() < 1e-15);
        }
    }

    #[test]
    fn a_frame_that_is_not_there_takes_no_time() {
        let listed = Frames::parse(Path::new("deltas.txt"), "0\n0.5\n").unwrap();
        for frames in [Frames::even(0.25, 10.0).unwrap(), Frames::even(0.0, 60.0).unwrap(), listed] {
            for frame in [frames.count(), frames.count() + 1, u64::MAX] {
                assert_eq!(frames.delta(frame), 0.0);
            }
        }
    }

    #[test]
    fn times_and_rates_that_make_no_sense_are_refused() {
        for (seconds, rate) in [(-1.0, 60.0), (f64::NAN, 60.0), (1.0, 0.0), (1.0, f64::INFINITY), (1e9, 1e9)]
        {
            let error = Frames::even(seconds, rate).unwrap_err().to_string();
            assert!(!error.contains("--"), "who calls the library gave no option: {error}");
        }
    }

    #[test]
    fn a_list_of_deltas_may_have_notes_blank_lines_and_an_editors_mark() {
        let text = "\u{feff}0 # the first\r\n\n# all of them\n  0.016\t\n0.5# long\n";
        assert_eq!(all(&Frames::parse(Path::new("deltas.txt"), text).unwrap()), [0.0, 0.016, 0.5]);
        let error = Frames::parse(Path::new("deltas.txt"), "0\nsoon # or later\n").unwrap_err().to_string();
        assert!(error.contains("deltas.txt") && error.contains("\"soon\" is not a number"), "{error}");
    }
}
