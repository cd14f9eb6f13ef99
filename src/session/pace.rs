//! Whether the simulation keeps up with the time that is measured.

use std::collections::VecDeque;

/// What is looked back on, in measured seconds, s.
const SPAN: f64 = 1.0;
/// Frames that are shorter than this are kept together, s: however short they are, there are few to look back on.
const PART: f64 = 0.01;
/// More measured seconds than this must be lost of the last one before a session has fallen behind, s: more than one frame can
/// lose, and than a busy machine takes now and then ...
const FALLEN_BEHIND: f64 = 0.1;
/// ... and no more than this before it has caught up. Were it the same, what is said of falling behind would flicker.
const CAUGHT_UP: f64 = 0.05;

/// How much of the time of the last frames was lost, because they were cut short.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Pace {
    /// The frames of the last second, in order.
    frames: VecDeque<Noted>,
    pub(super) behind: bool,
}

/// A frame, or some short ones.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Noted {
    /// Measured seconds.
    measured: f64,
    /// How many of them were not simulated.
    lost: f64,
    /// Simulated seconds.
    done: f64,
}

impl Pace {
    /// Notes a frame of `measured` seconds that was `asked` to simulate so many seconds and has `done` so many.
    pub(super) fn note(&mut self, measured: f64, asked: f64, done: f64) {
        let lost = if done < asked { measured * (1.0 - done / asked) } else { 0.0 };
        match self.frames.back_mut().filter(|last| last.measured + measured < PART) {
            Some(last) => {
                last.measured += measured;
                last.lost += lost;
                last.done += done;
            }
            None => self.frames.push_back(Noted { measured, lost, done }),
        }
        let mut span = self.sum(|frame| frame.measured);
        while let Some(first) = self.frames.front().filter(|first| span - first.measured >= SPAN) {
            span -= first.measured;
            self.frames.pop_front();
        }
        let most = if self.behind { CAUGHT_UP } else { FALLEN_BEHIND };
        self.behind = self.sum(|frame| frame.lost) > most;
    }

    /// Simulated seconds per measured second, of the last second; `None` where that is what was asked for.
    pub(super) fn speed(&self) -> Option<f64> {
        self.behind.then(|| self.sum(|frame| frame.done) / self.sum(|frame| frame.measured))
    }

    fn sum(&self, part: fn(&Noted) -> f64) -> f64 {
        self.frames.iter().map(part).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pace_is_behind_where_more_than_a_tenth_of_the_last_second_is_lost_and_until_that_is_over() {
        let mut pace = Pace::default();
        for frame in 0..200 {
            // A frame in twelve is cut short, as on a busy machine.
            let done = if frame % 12 == 0 { 0.0 } else { 1.0 / 60.0 };
            pace.note(1.0 / 60.0, 1.0 / 60.0, done);
            assert!(!pace.behind && pace.speed().is_none(), "frame {frame}");
        }
        // At four times the speed, a quarter of which is done.
        (0..60).for_each(|_| pace.note(1.0 / 60.0, 4.0 / 60.0, 1.0 / 60.0));
        assert!(pace.behind);
        assert!((pace.speed().unwrap() - 1.0).abs() < 1e-9, "{:?}", pace.speed());
        let whole = (1..100).find(|_| {
            pace.note(1.0 / 60.0, 4.0 / 60.0, 4.0 / 60.0);
            !pace.behind
        });
        assert!((40..=60).contains(&whole.unwrap()), "{whole:?} frames");
    }

    #[test]
    fn of_frames_as_short_as_can_be_no_more_are_kept() {
        let mut pace = Pace::default();
        for _ in 0..100_000 {
            pace.note(1e-4, 1e-4, 5e-5);
            pace.note(0.0, 0.0, 0.0);
        }
        assert!(pace.frames.len() < 150, "{}", pace.frames.len());
        assert!((pace.speed().unwrap() - 0.5).abs() < 1e-6, "{:?}", pace.speed());
    }

    #[test]
    fn one_frame_however_long_is_not_enough_and_frames_of_no_time_are_nothing() {
        let mut pace = Pace::default();
        for done in [0.0, 0.1] {
            pace.note(0.1, 1.6, done);
            pace.note(0.0, 0.0, 0.0);
            assert_eq!(pace.behind, done > 0.0, "two are");
        }
    }
}
