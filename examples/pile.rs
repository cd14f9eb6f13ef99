//! Builds a pile from balls of its own, without a scene file, and sets up the solver that holds it.
//!
//! A ball, a world and a simulation check their numbers when they are made; nothing is checked, and nothing can fail,
//! later but a delta that is no time.

use carom::simulation::grid::Grid;
use carom::simulation::invariants::max_overlap;
use carom::{Ball, DVec2, Pairs, Simulation, Solver, World};

const RADIUS: f64 = 8.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let size = DVec2::new(400.0, 400.0);
    let world =
        World::new(size)?.with_gravity(DVec2::new(0.0, 980.0))?.with_walls(0.3)?.with_pairs(Pairs::Impulse);

    let mut balls = Vec::new();
    for row in 0..10 {
        for column in 0..20 {
            // Rows that lean a little, so that the pile is not a row of towers.
            let place = DVec2::new(2.4 * f64::from(column) + 0.3 * f64::from(row % 2), 2.2 * f64::from(row));
            balls.push(Ball::new((place + 1.1) * RADIUS, RADIUS)?.with_restitution(0.3)?.with_mass(2.0)?);
        }
    }
    // Nothing moves this one; what falls on it runs off.
    balls.push(Ball::new(DVec2::new(200.0, 330.0), 40.0)?.fixed());

    // The defaults are a rest speed of 1 px/s, 120 to 240 substeps a second here, and sleep.
    let mut simulation = Simulation::new(world, balls, Solver::Contact)?
        .with_rest_speed(0.5)?
        .with_substeps(480)?
        .with_sleep(true);

    let fastest = |balls: &[Ball]| balls.iter().map(|ball| ball.velocity().length()).fold(0.0, f64::max);
    for second in 1..=8 {
        simulation.advance(1.0)?;
        println!("{second} s: the fastest ball has {:.3} px/s", fastest(simulation.balls()));
    }

    let balls = simulation.balls();
    let overlap = max_overlap(&mut Grid::new(balls, size), balls);
    println!("the deepest overlap is {overlap:.4} of a radius");
    assert_eq!(fastest(balls), 0.0, "all of them sleep");
    assert!(overlap < 0.05);
    Ok(())
}
