//! Where balls lie on each other, are pressed together or begin in each other: how `exact` lays them to rest, and what wakes
//! them. Most of these cases once took events without end.

mod crowds;
mod elastic;
mod fits;
mod overlaps;
mod piles;
mod pockets;

use carom::simulation::grid::Grid;
use carom::simulation::invariants::{
    kinetic_energy, max_overlap, max_wall_overlap, momentum, non_finite, potential_energy,
};
use carom::{Ball, DVec2, Pairs, Scene, Simulation, Solver, World};

const EARTH: f64 = 980.0;

fn ball(x: f64, y: f64, radius: f64) -> Ball {
    Ball::new(DVec2::new(x, y), radius).and_then(|ball| ball.with_restitution(0.5)).unwrap()
}

fn moving(ball: Ball, x: f64, y: f64) -> Ball {
    ball.with_velocity(DVec2::new(x, y)).unwrap()
}

fn boxed(width: f64, height: f64, gravity: f64) -> World {
    let world = World::new(DVec2::new(width, height)).unwrap().with_walls(0.5).unwrap();
    world.with_gravity(DVec2::new(0.0, gravity)).unwrap().with_pairs(Pairs::Impulse)
}

fn exact(world: World, balls: Vec<Ball>) -> Simulation {
    Simulation::new(world, balls, Solver::Exact).unwrap()
}

fn hits(simulation: &Simulation) -> u64 {
    simulation.tally().impacts + simulation.tally().wall_hits
}

fn energy(simulation: &Simulation) -> f64 {
    kinetic_energy(simulation.balls()) + potential_energy(simulation.world(), simulation.balls())
}

fn overlap(simulation: &Simulation) -> f64 {
    max_overlap(&mut Grid::new(simulation.balls(), simulation.world().size()), simulation.balls())
}

fn fastest(simulation: &Simulation) -> f64 {
    simulation.balls().iter().map(|ball| ball.velocity().length()).fold(0.0, f64::max)
}

/// Balls of three sizes in rows, that fall.
fn rows(count: u32, columns: u32) -> Vec<Ball> {
    let place = |i: u32| {
        let (column, row) = (f64::from(i % columns), f64::from(i / columns));
        ball(14.0 + 25.0 * column + row, 20.0 + 26.0 * row, 9.0 + f64::from(i * 7 % 3))
    };
    (0..count).map(place).collect()
}

/// A column of balls of radius 3.5 that stands on the floor.
fn column(count: u32) -> Simulation {
    let height = 7.0 * f64::from(count) + 100.0;
    let place = |k: u32| ball(200.0, height - 3.5 - 7.0 * f64::from(k), 3.5);
    exact(boxed(400.0, height, EARTH), (0..count).map(place).collect())
}
