//! What pushed balls out of overlaps in a substep, and was taken back once they had moved.
//!
//! In a pile at rest that is the same in all substeps. Where sweeps are followed to their end, each would find it anew, and its
//! absence, too, hundreds of sweeps long: both begin with what it was (warm starting).

use glam::DVec2;

use super::Body;
use super::constraints::{Beside, Constraint};
use super::support::{give, two};

/// What constraints and walls gave while balls moved, besides what they gave in the end.
#[derive(Debug, Clone, Default)]
pub(super) struct Apart {
    /// For each constraint, mass·px/s.
    by_balls: Vec<f64>,
    /// For each ball beside a wall, px/s.
    by_walls: Vec<DVec2>,
    /// The same of all that they gave while balls moved.
    held_by_balls: Vec<f64>,
    held_by_walls: Vec<DVec2>,
}

impl Apart {
    /// Forgets it: there are other constraints.
    pub(super) fn clear(&mut self) {
        self.by_balls.clear();
        self.by_walls.clear();
    }

    /// Gives it to all that press on each other, or takes it back, as `times` is 1 or −1.
    pub(super) fn give(
        &mut self,
        constraints: &mut [Constraint],
        beside: &mut [Beside],
        bodies: &mut [Body],
        times: f64,
    ) {
        self.by_balls.resize(constraints.len(), 0.0);
        self.by_walls.resize(beside.len(), DVec2::ZERO);
        let pressing = constraints.iter_mut().zip(&self.by_balls);
        for (constraint, &by) in pressing.filter(|(constraint, by)| constraint.impulse > 0.0 && **by != 0.0) {
            let change = (times * by).max(-constraint.impulse);
            constraint.impulse += change;
            let (first, second) = two(bodies, constraint.pair);
            give(constraint.normal * change, first, second);
        }
        for (beside, &by) in beside.iter_mut().zip(&self.by_walls) {
            let body = &mut bodies[beside.body as usize];
            if body.inverse_mass > 0.0 && beside.push != DVec2::ZERO {
                beside.push += times * by;
                body.velocity += times * by;
            }
        }
    }

    /// Notes what holds balls while they move, and takes back what pushed them apart in the last substep.
    pub(super) fn note_held(
        &mut self,
        constraints: &mut [Constraint],
        beside: &mut [Beside],
        bodies: &mut [Body],
    ) {
        self.held_by_balls.clear();
        self.held_by_balls.extend(constraints.iter().map(|constraint| constraint.impulse));
        self.held_by_walls.clear();
        self.held_by_walls.extend(beside.iter().map(|beside| beside.push));
        self.give(constraints, beside, bodies, -1.0);
    }

    /// Notes what of that was taken back.
    pub(super) fn note_relaxed(&mut self, constraints: &[Constraint], beside: &[Beside]) {
        self.by_balls.clear();
        let held = self.held_by_balls.iter().zip(constraints);
        self.by_balls.extend(held.map(|(held, constraint)| held - constraint.impulse));
        self.by_walls.clear();
        let held = self.held_by_walls.iter().zip(beside);
        self.by_walls.extend(held.map(|(held, beside)| held - beside.push));
    }
}
