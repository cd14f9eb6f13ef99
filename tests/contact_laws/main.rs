//! The laws that `contact` keeps: each on the smallest case that shows it. Here is what they are shown on.

mod changes;
mod crushes;
mod edits;
mod frames;
mod gases;
mod heaps;
mod impacts;
mod masses;
#[path = "../common/numbers.rs"]
mod numbers;
mod piles;
mod random;
mod sleep;
mod slides;
mod wedges;

use carom::simulation::grid::Grid;
use carom::simulation::invariants::{
    kinetic_energy, max_overlap, max_wall_overlap, momentum, potential_energy,
};
use carom::{Ball, DVec2, Pairs, Scene, Simulation, Solver, World};

const EARTH: DVec2 = DVec2::new(0.0, 980.0);
const FRAME: f64 = 1.0 / 60.0;

fn ball(x: f64, y: f64, radius: f64) -> Ball {
    Ball::new(DVec2::new(x, y), radius).unwrap()
}

fn moving(ball: Ball, x: f64, y: f64) -> Ball {
    ball.with_velocity(DVec2::new(x, y)).unwrap()
}

fn world(width: f64, height: f64, restitution: f64) -> World {
    let world = World::new(DVec2::new(width, height)).unwrap();
    world.with_walls(restitution).unwrap().with_pairs(Pairs::Impulse)
}

fn simulation(world: World, balls: Vec<Ball>) -> Simulation {
    Simulation::new(world, balls, Solver::Contact).unwrap()
}

/// As it is, and in substeps, which balls without gravity, and few that fall and do not lie on each other, take only where they
/// are asked for.
fn both_ways(simulation: &Simulation) -> [Simulation; 2] {
    [simulation.clone(), simulation.clone().with_substeps(240).unwrap()]
}

fn energy(simulation: &Simulation) -> f64 {
    kinetic_energy(simulation.balls()) + potential_energy(simulation.world(), simulation.balls())
}

/// The most by which its energy rises above what it has been within so many frames.
fn rise(simulation: &mut Simulation, frames: u32) -> f64 {
    let (mut least, mut rise) = (energy(simulation), 0.0_f64);
    for _ in 0..frames {
        simulation.advance(FRAME).unwrap();
        rise = rise.max(energy(simulation) - least);
        least = least.min(energy(simulation));
    }
    rise
}

fn overlap(simulation: &Simulation) -> f64 {
    let balls = simulation.balls();
    max_overlap(&mut Grid::new(balls, simulation.world().size()), balls)
}

/// The largest distance between places of the same ball, px, and between its velocities, px/s.
fn apart(one: &Simulation, other: &Simulation) -> (f64, f64) {
    let pairs = one.balls().iter().zip(other.balls());
    pairs.fold((0.0, 0.0), |(place, velocity): (f64, f64), (a, b)| {
        (place.max(a.position().distance(b.position())), velocity.max(a.velocity().distance(b.velocity())))
    })
}

fn fastest(simulation: &Simulation) -> f64 {
    simulation.balls().iter().map(|ball| ball.velocity().length()).fold(0.0, f64::max)
}

/// Balls of radius 10 upon each other on the floor, from the bottom, of these masses; the highest place of all.
fn tower(masses: &[f64]) -> Simulation {
    let height = 20.0 * masses.len() as f64 + 100.0;
    let balls = masses.iter().enumerate().map(|(k, &mass)| {
        let at = ball(200.0, height - 10.0 - 20.0 * k as f64, 10.0);
        at.with_mass(mass).unwrap().with_restitution(0.5).unwrap()
    });
    simulation(world(400.0, height, 0.5).with_gravity(EARTH).unwrap(), balls.collect())
}

/// The settled pile of the issue, small: half a 16:9 box of balls of radius 3 to 6.
fn pile(count: usize) -> Simulation {
    seeded_pile(count, 1)
}

/// The same with other balls for each seed.
fn seeded_pile(count: usize, seed: u64) -> Simulation {
    let area = count as f64 * std::f64::consts::PI * 21.0 * 2.0;
    let (width, height) = ((area * 16.0 / 9.0).sqrt().round(), (area * 9.0 / 16.0).sqrt().round());
    let text = format!(
        "size = [{width}, {height}]\ngravity = [0, 980]\n[walls]\nrestitution = 0.7\n[pairs]\n[[fill]]\n\
         count = {count}\nradius = [3, 6]\nrestitution = 0.7\nseed = {seed}\n"
    );
    Scene::parse("pile", &text).unwrap().with_solver(Solver::Contact).build().unwrap()
}
