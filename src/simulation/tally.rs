//! What is counted while a simulation runs.

use glam::DVec2;

/// What has happened since the simulation began.
///
/// In substeps under gravity [`Solver::Contact`](super::Solver::Contact) counts neither impacts nor hits on walls that are slower than the rest speed
/// ([`with_rest_speed`](super::Simulation::with_rest_speed)): what lies on others meets them so in each of these. `Exact` counts
/// them all, until balls rest; `Canvas` counts each frame in which two balls touch and exchange momentum.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Tally {
    /// Impacts between two balls, of which one may be fixed.
    pub impacts: u64,
    /// Impacts of a ball on a wall.
    pub wall_hits: u64,
    /// The momentum that walls have given to balls in these impacts, mass·px/s: without what they carry of balls at
    /// rest, and without what fixed balls give.
    pub wall_impulse: DVec2,
}

impl Tally {
    /// Adds what has happened elsewhere.
    pub(super) fn add(&mut self, other: &Self) {
        self.impacts += other.impacts;
        self.wall_hits += other.wall_hits;
        self.wall_impulse += other.wall_impulse;
    }

    /// What has happened since it was `before`.
    pub(super) fn since(&self, before: &Self) -> Self {
        Self {
            impacts: self.impacts - before.impacts,
            wall_hits: self.wall_hits - before.wall_hits,
            wall_impulse: self.wall_impulse - before.wall_impulse,
        }
    }
}
