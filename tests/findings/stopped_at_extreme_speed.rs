//! Balls at 10⁹ px/s under `exact`, as canvas makes them in one long frame, stopped between two events. The clock stops at a
//! multiple of 2⁻⁴⁶ s, 10⁻⁵ px there: before what had just happened, so that a ball that had hit a wall was shown beyond it,
//! and one that had hit another in it.

use carom::simulation::ledger::Ledger;
use carom::{Ball, DVec2, Pairs, Simulation, Solver, World};

/// Holds balls of radius 0.25 at these places, with these speeds from top to bottom, to the laws at each of many stops.
fn stop_often(balls: &[(DVec2, f64)]) {
    let world = World::new(DVec2::new(120.0, 174.0)).unwrap().with_walls(1.0).unwrap();
    let ball = |&(place, speed): &(DVec2, f64)| {
        Ball::new(place, 0.25).unwrap().with_velocity(DVec2::new(7.0, speed)).unwrap()
    };
    let balls = balls.iter().map(ball).collect();
    let mut simulation = Simulation::new(world.with_pairs(Pairs::Impulse), balls, Solver::Exact).unwrap();
    let mut ledger = Ledger::new(&simulation);
    for stop in 0..2000 {
        let mut looks = stop % 5;
        let mut go_on = || {
            looks -= 1;
            looks > 0
        };
        simulation.advance_while(1.0, &mut go_on).unwrap();
        ledger.check(&simulation).unwrap_or_else(|violation| panic!("stop {stop}: {violation}"));
    }
    let hits = simulation.tally().impacts + simulation.tally().wall_hits;
    assert!(hits > 100_000, "{hits}");
}

#[test]
fn a_ball_that_has_hit_a_wall_is_never_seen_beyond_it() {
    // Beside each other: a stop falls between their hits at one time.
    stop_often(&[20.0, 40.0, 60.0].map(|x| (DVec2::new(x, 80.0), 0.98e9)));
}

#[test]
fn a_ball_that_has_hit_another_is_never_seen_in_it() {
    stop_often(&[(DVec2::new(20.0, 80.0), 0.98e9), (DVec2::new(20.1, 90.0), -0.97e9)]);
}
