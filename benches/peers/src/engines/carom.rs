//! carom, by one of its solvers, without sleep.

use carom::{Simulation, Solver};

use super::{Engine, Failure, State};
use crate::scenes::Scene;

/// A simulation of carom's.
pub struct Carom(Simulation);

impl Carom {
    pub fn new(scene: &Scene, solver: Solver) -> Result<Self, Failure> {
        Ok(Self(Simulation::new(scene.world, scene.balls.clone(), solver)?.with_sleep(false)))
    }
}

impl Engine for Carom {
    fn step(&mut self, seconds: f64) -> Result<(), Failure> {
        Ok(self.0.advance(seconds)?)
    }

    fn state(&mut self, states: &mut Vec<State>) -> Result<(), Failure> {
        states.clear();
        let balls = self.0.balls().iter();
        states.extend(balls.map(|ball| State { position: ball.position(), velocity: ball.velocity() }));
        Ok(())
    }
}
