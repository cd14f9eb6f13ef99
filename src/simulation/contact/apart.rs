//! What pushed balls out of each other in a substep, and was taken back once they had moved.
//!
//! In a pile at rest that is the same in all substeps. Where sweeps are followed to their end, each would find it anew, and its
//! absence, too, hundreds of sweeps long: both begin with what it was (warm starting). Walls find theirs at once.

use super::Body;
use super::constraints::Constraint;
use super::fates::{Fate, Shift};
use super::support::{give, two};

/// What constraints gave while balls moved, besides what they gave in the end, mass·px/s.
#[derive(Debug, Clone, Default)]
pub(super) struct Apart {
    given: Vec<f64>,
    /// All that they gave while balls moved.
    held: Vec<f64>,
}

impl Apart {
    /// Forgets it: there are other constraints, or other substeps.
    pub(super) fn clear(&mut self) {
        self.given.clear();
    }

    /// Gives what was given in the last substep, where nothing has hit either ball of a pair: what is found of others depends on how
    /// fast they are.
    pub(super) fn give_again(&mut self, constraints: &mut [Constraint], bodies: &mut [Body], fates: &[Fate]) {
        let unmoved = |at: u32| fates[at as usize].hits == 0 && fates[at as usize].shift == Shift::None;
        self.give(constraints, bodies, 1.0, |constraint| {
            unmoved(constraint.pair.first) && unmoved(constraint.pair.second)
        });
    }

    /// Notes what holds balls while they move, and takes back as much as was taken back in the last substep.
    pub(super) fn take_back(&mut self, constraints: &mut [Constraint], bodies: &mut [Body]) {
        self.held.clear();
        self.held.extend(constraints.iter().map(|constraint| constraint.impulse));
        self.give(constraints, bodies, -1.0, |_| true);
    }

    /// Notes what was taken back in the end.
    pub(super) fn note_relaxed(&mut self, constraints: &[Constraint]) {
        self.given.clear();
        let held = self.held.iter().zip(constraints);
        self.given.extend(held.map(|(held, constraint)| held - constraint.impulse));
    }

    /// Gives so many times what was given to those pairs that press on each other, one of which can be moved, but pulls none.
    fn give(
        &mut self,
        constraints: &mut [Constraint],
        bodies: &mut [Body],
        times: f64,
        which: impl Fn(&Constraint) -> bool,
    ) {
        self.given.resize(constraints.len(), 0.0);
        for (constraint, &given) in constraints.iter_mut().zip(&self.given) {
            let (first, second) = two(bodies, constraint.pair);
            let moves = first.inverse_mass > 0.0 || second.inverse_mass > 0.0;
            if given != 0.0 && constraint.impulse > 0.0 && moves && which(constraint) {
                let change = (times * given).max(-constraint.impulse);
                constraint.impulse += change;
                give(constraint.normal * change, first, second);
            }
        }
    }
}
