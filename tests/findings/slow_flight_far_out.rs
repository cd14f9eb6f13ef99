//! A slow ball far from the origin, moved by `contact`: each substep rounds its place to the digits that a large number
//! has, and after a second the ledger took the sum for a broken law.

use carom::simulation::ledger::Ledger;
use carom::{Ball, DVec2, Simulation, Solver, World};

#[test]
fn rounding_in_each_substep_is_no_violation_and_more_than_that_is_one() {
    let world = World::new(DVec2::new(1.0, 1e6)).unwrap();
    let ball = Ball::new(DVec2::new(0.5, 9e5), 0.1).unwrap();
    let ball = ball.with_velocity(DVec2::new(0.01, 0.123)).unwrap();
    let mut simulation = Simulation::new(world, vec![ball], Solver::Contact).unwrap();
    for seconds in [2.0, 5.0, 60.0] {
        let mut ledger = Ledger::new(&simulation);
        simulation.advance(seconds).unwrap();
        ledger.check(&simulation).unwrap();
    }
    let mut ledger = Ledger::new(&simulation);
    simulation.set_position(0, simulation.balls()[0].position() + DVec2::new(0.0, 1e-6)).unwrap();
    simulation.advance(1.0).unwrap();
    ledger.check(&simulation).unwrap_err();
}
