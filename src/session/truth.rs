//! The same balls moved by the exact solver, to compare with.

use super::thin::every_second;
use crate::simulation::{Simulation, Solver};

/// The most errors that are kept: half of them go where there are more.
const MOST_ERRORS: usize = 4096;

/// What the exact solver makes of the balls from a moment on, and how far from it the others are.
#[derive(Debug, Clone)]
pub(super) struct Truth {
    pub(super) simulation: Simulation,
    /// Simulated seconds since then, and the largest distance of a ball from its true place, px; in order.
    pub(super) errors: Vec<(f64, f64)>,
    /// Simulated seconds since then.
    time: f64,
    /// Every so many frames, one error is kept.
    spacing: u64,
    frames: u64,
}

impl Truth {
    /// The truth about a simulation from now on.
    pub(super) fn of(simulation: &Simulation) -> Self {
        let mut simulation = simulation.clone();
        simulation.set_solver(Solver::Exact);
        Self { simulation, errors: vec![(0.0, 0.0)], time: 0.0, spacing: 1, frames: 0 }
    }

    /// Moves on by `seconds` to where `shown` is, for as long as `go_on` says so; whether it got there.
    pub(super) fn advance(
        &mut self,
        seconds: f64,
        shown: &Simulation,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<bool, crate::OutOfRange> {
        let done = self.simulation.advance_while(seconds, go_on)?;
        self.time += done;
        self.frames += 1;
        if self.frames.is_multiple_of(self.spacing) {
            self.errors.push((self.time, largest_error(shown, &self.simulation)));
        }
        if self.errors.len() > MOST_ERRORS {
            self.errors.retain(every_second());
            self.spacing *= 2;
        }
        Ok(done >= seconds)
    }
}

/// The largest distance between a ball and its true place, px.
fn largest_error(shown: &Simulation, truth: &Simulation) -> f64 {
    let pairs = shown.balls().iter().zip(truth.balls());
    pairs.map(|(ball, true_ball)| ball.position().distance(true_ball.position())).fold(0.0, f64::max)
}
