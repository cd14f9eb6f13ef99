//! A look at balls at the very times of impacts, where overlaps are deepest and no ordinary frame would see them.

use carom::Simulation;
use carom::simulation::grid::Grid;
use carom::simulation::invariants::{max_overlap, max_wall_overlap};

/// What was seen so far.
pub struct Looks {
    grid: Grid,
    /// The deepest overlap of two balls, as a part of the smaller one's radius.
    pub overlap: f64,
    /// The deepest that a ball reached over a wall, as a part of its radius.
    pub escape: f64,
    /// Impacts of two balls that were looked at.
    pub seen: u64,
}

impl Looks {
    pub fn new(simulation: &Simulation) -> Self {
        let grid = Grid::new(simulation.balls(), simulation.world().size());
        Self { grid, overlap: 0.0, escape: 0.0, seen: 0 }
    }

    /// Advances for some hundred events, or as many as there are in these seconds: to less than 2⁻⁴⁶ s before one of
    /// them, and over it.
    pub fn advance(&mut self, simulation: &mut Simulation, seconds: f64) {
        simulation.advance_while(seconds, || false).unwrap();
        self.look(simulation);
        let before = simulation.tally().impacts;
        simulation.advance(2_f64.powi(-46)).unwrap();
        self.seen += simulation.tally().impacts - before;
        self.look(simulation);
    }

    fn look(&mut self, simulation: &Simulation) {
        self.overlap = self.overlap.max(max_overlap(&mut self.grid, simulation.balls()));
        self.escape = self.escape.max(max_wall_overlap(simulation.world(), simulation.balls()));
    }
}
