//! Whether the simulation keeps up with the time that is measured.

/// How many measured seconds of frames must go through whole before a session that fell behind has caught up, s. Were
/// it less, what is said of falling behind would flicker.
const CAUGHT_UP: f64 = 1.0;

/// Whether frames were cut short, and for how long none has been since.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Pace {
    pub(super) behind: bool,
    /// Measured seconds since the last frame that was cut short, s; counted only while behind.
    whole: f64,
}

impl Pace {
    /// Notes a frame of `measured` seconds that was `asked` to simulate so many seconds and has `done` so many.
    pub(super) fn note(&mut self, measured: f64, asked: f64, done: f64) {
        if done < asked {
            *self = Self { behind: true, whole: 0.0 };
        } else if self.behind {
            self.whole += measured;
            self.behind = self.whole < CAUGHT_UP;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pace_is_behind_from_a_frame_cut_short_until_a_second_has_gone_through_whole() {
        let mut pace = Pace::default();
        pace.note(0.25, 0.25, 0.25);
        assert!(!pace.behind);
        // At four times the speed; however much was done, some was not.
        pace.note(0.25, 1.0, 0.75);
        assert!(pace.behind);
        for _ in 0..3 {
            pace.note(0.25, 1.0, 1.0);
            assert!(pace.behind);
        }
        pace.note(0.25, 1.0, 0.0);
        for _ in 0..3 {
            pace.note(0.25, 1.0, 1.0);
            assert!(pace.behind, "the second begins anew with each frame cut short");
        }
        pace.note(0.25, 1.0, 1.0);
        assert!(!pace.behind);
        pace.note(0.0, 0.0, 0.0);
        assert!(!pace.behind, "a frame of no time leaves nothing out");
    }
}
