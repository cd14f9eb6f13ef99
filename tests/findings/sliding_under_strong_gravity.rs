//! Under strong gravity `exact` counts a larger rest speed, and hops at that; the ledger allowed for those of the one that
//! was asked for, and took what a ball gains that slides down a large one for energy from nowhere.

use carom::simulation::ledger::Ledger;
use carom::{Ball, DVec2, Pairs, Simulation, Solver, World};

#[test]
fn hops_down_a_fixed_ball_under_strong_gravity_are_within_what_is_allowed() {
    let world = World::new(DVec2::new(250.0, 250.0)).and_then(|world| world.with_walls(0.8)).unwrap();
    let world = world.with_gravity(DVec2::new(0.0, 14_000.0)).unwrap().with_pairs(Pairs::Impulse);
    let (large, small) = (67.0, 1.2);
    let top = DVec2::new(125.0, 125.0) + (large + small) * DVec2::from_angle(-1.5);
    let fixed = Ball::new(DVec2::new(125.0, 125.0), large).unwrap().with_restitution(0.8).unwrap().fixed();
    let sliding = Ball::new(top, small).and_then(|ball| ball.with_restitution(0.8)).unwrap();
    let mut simulation = Simulation::new(world, vec![sliding, fixed], Solver::Exact).unwrap();
    let mut ledger = Ledger::new(&simulation);
    for _ in 0..300 {
        simulation.advance(1e-3).unwrap();
        ledger.check(&simulation).unwrap();
    }
    assert!(simulation.balls()[0].position().y > 125.0, "it has left the large one");
}
