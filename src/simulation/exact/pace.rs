//! Whether there are more impacts than can be followed.

/// So many impacts a second can be followed, at less than half of real time ...
const FOLLOWED: f64 = (1 << 20) as f64;
/// ... and so many for each ball that takes part. Substeps would cost more where all balls do.
const FOLLOWED_PER_BALL: f64 = 2048.0;
/// More of them are let pass, so that a crash is followed to its end, up to so many in all ...
const LET_PASS: f64 = (1 << 18) as f64;
/// ... or for each ball.
const LET_PASS_PER_BALL: f64 = 16.0;

/// How far impacts have run ahead of what can be followed.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::simulation) struct Pace {
    /// Impacts that were too many, less those for which there was time since.
    ahead: f64,
}

impl Pace {
    /// Takes account of a time of so many seconds, with so many impacts, in which so many balls took part.
    pub(super) fn pass(&mut self, seconds: f64, impacts: f64, busy: usize) {
        let followed = FOLLOWED.max(FOLLOWED_PER_BALL * busy as f64);
        self.ahead = (self.ahead + impacts - followed * seconds).max(0.0);
    }

    /// Whether impacts among so many balls have run too far ahead.
    pub(super) fn is_outrun(self, balls: usize) -> bool {
        self.ahead > LET_PASS.max(LET_PASS_PER_BALL * balls as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crash_is_followed_and_a_rattle_is_not() {
        let mut crash = Pace::default();
        crash.pass(1e-6, LET_PASS, 2);
        assert!(!crash.is_outrun(2));
        crash.pass(1.0, 0.0, 2);
        crash.pass(1e-6, LET_PASS, 2);
        assert!(!crash.is_outrun(2));
        // Among many balls, of which few take part, as among few.
        for (balls, busy, outrun) in [(2, 2, true), (10_000, 10, true), (10_000, 10_000, false)] {
            let mut pace = Pace::default();
            for _ in 0..1000 {
                pace.pass(1e-3, 1e7 * 1e-3, busy);
            }
            assert_eq!(pace.is_outrun(balls), outrun, "{busy} of {balls}");
        }
    }
}
