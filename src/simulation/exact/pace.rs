//! Whether there are more impacts than can be followed, in a second or at one time.

use crate::simulation::clock::INSTANT;

use super::Exact;

/// So many impacts a second can be followed, at less than half of real time ...
const FOLLOWED: f64 = (1 << 20) as f64;
/// ... and so many for each pair of the balls that take part: the more of them are fast in a substep, the more others each impact
/// has to be looked for with, and it costs more than here, a hundred times as much among two thousand.
const FOLLOWED_PER_PAIR: f64 = 800.0;
/// More of them are let pass, so that a crash is followed to its end, up to so many in all ...
const LET_PASS: f64 = (1 << 18) as f64;
/// ... or for each ball.
const LET_PASS_PER_BALL: f64 = 16.0;
/// The same where few balls fall, for which substeps do as well: some seventy impacts in a frame of a 60th take less than a hundredth
/// of its time ...
const FOLLOWED_IN_FALL: f64 = (1 << 12) as f64;
/// ... and those of a crash a tenth. After these it ends with the substep, and at once after so many.
const LET_PASS_IN_FALL: f64 = (1 << 8) as f64;
const MOST_IN_FALL: f64 = (1 << 12) as f64;
/// Events at one time above which balls have no room to move at all: hits that would go on for ever take all their
/// speed then. Galperin's billiard with a mass ratio of 10¹⁶ has two thousand.
const MOST_AT_ONCE: usize = 1 << 16;
/// The same where some time passes, and only balls get nowhere in it. No more than the other: it is compared first.
const MOST_CREEPING: usize = 1 << 12;
/// Either for each ball, where that is more in all.
const MOST_AT_ONCE_PER_BALL: usize = 64;

/// How far impacts have run ahead of what can be followed.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::simulation) struct Pace {
    /// Impacts that were too many, less those for which there was time since.
    ahead: f64,
    /// Whether impacts take energy: those that have no end then do.
    takes_energy: bool,
    /// Whether few balls fall.
    falls: bool,
}

impl Pace {
    /// The same where few balls fall: impacts that have no end are left to others then, whether they take energy or not.
    pub(in crate::simulation) fn in_fall(self) -> Self {
        Self { takes_energy: false, falls: true, ..self }
    }

    /// The same where impacts take energy, or not.
    pub(in crate::simulation) fn where_impacts_take(self, takes_energy: bool) -> Self {
        Self { takes_energy, ..self }
    }

    /// Takes account of a time of so many seconds, with so many impacts, in which so many balls took part.
    pub(super) fn pass(&mut self, seconds: f64, impacts: f64, busy: usize) {
        let busy = busy as f64;
        let among_all = FOLLOWED.max(FOLLOWED_PER_PAIR * 0.5 * busy * busy);
        let followed = if self.falls { FOLLOWED_IN_FALL } else { among_all };
        self.ahead = (self.ahead + impacts - followed * seconds).max(0.0);
    }

    /// Whether impacts among so many balls have run too far ahead.
    pub(super) fn is_outrun(self, balls: usize) -> bool {
        let among_all = LET_PASS.max(LET_PASS_PER_BALL * balls as f64);
        self.ahead > if self.falls { MOST_IN_FALL } else { among_all }
    }

    /// Whether there are so many that substeps suit balls that fall better.
    pub(super) fn suits_substeps(self) -> bool {
        self.falls && self.ahead > LET_PASS_IN_FALL
    }
}

impl Exact {
    /// The same solver that stops where there are more impacts than can be followed, and has kept pace so far as this says.
    pub(in crate::simulation) fn while_it_keeps_pace(self, so_far: Pace) -> Self {
        Self { pace: Some(so_far), ..self }
    }

    /// How impacts have kept pace, where it stops once they do not.
    pub(in crate::simulation) fn pace(&self) -> Pace {
        self.pace.unwrap_or_default()
    }

    /// Whether it has stopped, for good.
    pub(in crate::simulation) fn is_outrun(&self) -> bool {
        self.is_over() || self.is_stuck() || self.pace.is_some_and(|pace| pace.is_outrun(self.flights.len()))
    }

    /// Whether it has to stop because another event at this time would find balls wedged in, which would take energy though
    /// impacts do not.
    #[inline]
    pub(super) fn is_stuck(&self) -> bool {
        // A constant first: this is asked after each event.
        self.at_once >= MOST_CREEPING
            && self.pace.is_some_and(|pace| !pace.takes_energy)
            && self.at_once >= self.most_at_once()
    }

    /// Whether balls are wedged in without room, so that they hit each other endlessly at one time.
    pub(super) fn wedged(&self) -> bool {
        self.at_once > MOST_CREEPING && self.at_once > self.most_at_once()
    }

    fn most_at_once(&self) -> usize {
        let creeps = self.latest > self.instant + INSTANT;
        if creeps { MOST_CREEPING } else { MOST_AT_ONCE }.max(MOST_AT_ONCE_PER_BALL * self.flights.len())
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
        let all =
            [(2, 2, true), (100, 100, true), (400, 400, false), (10_000, 10, true), (10_000, 10_000, false)];
        for (balls, busy, outrun) in all {
            let mut pace = Pace::default();
            for _ in 0..1000 {
                pace.pass(1e-3, 1e7 * 1e-3, busy);
            }
            assert_eq!(pace.is_outrun(balls), outrun, "{busy} of {balls}");
        }
    }
}
