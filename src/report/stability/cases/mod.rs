//! The cases, by what makes them hard.

mod crowds;
mod impacts;
mod numbers;
mod times;

use std::fmt::Display;

use glam::DVec2;

use super::case::{Case, Setup, Step};
use crate::report::document::power_of_ten;
use crate::simulation::limits::OutOfRange;
use crate::simulation::{Ball, Pairs, World};

/// A frame, s.
const FRAME: f64 = 1.0 / 60.0;
/// The demo's gravity, px/s².
const GRAVITY: f64 = 980.0;

/// All of them, in the order of the table.
pub(super) fn all() -> Vec<Case> {
    [impacts::cases(), numbers::cases(), times::cases(), crowds::cases()].into_iter().flatten().collect()
}

fn told(error: impl Display) -> String {
    error.to_string()
}

fn ball(x: f64, y: f64, radius: f64) -> Result<Ball, OutOfRange> {
    Ball::new(DVec2::new(x, y), radius)
}

fn moving(x: f64, y: f64, radius: f64, velocity: (f64, f64)) -> Result<Ball, OutOfRange> {
    ball(x, y, radius)?.with_velocity(velocity.into())
}

/// A world in which balls meet, without walls.
fn open(width: f64, height: f64) -> Result<World, OutOfRange> {
    Ok(World::new(DVec2::new(width, height))?.with_pairs(Pairs::Impulse))
}

/// The same with walls of this restitution, and gravity.
fn boxed(width: f64, height: f64, restitution: f64, gravity: f64) -> Result<World, OutOfRange> {
    open(width, height)?.with_walls(restitution)?.with_gravity(DVec2::new(0.0, gravity))
}

/// So many seconds in frames of 1/60 s.
fn frames(seconds: f64) -> Vec<Step> {
    vec![Step::Advance(FRAME); (60.0 * seconds).round() as usize]
}

fn run(world: World, balls: Vec<Ball>, seconds: f64) -> Setup {
    Setup::Run { world, balls, steps: frames(seconds) }
}

/// A power of ten as it is printed, or 0.
fn said(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        1.0 => "1".to_owned(),
        _ => power_of_ten(value.log10().round() as i32),
    }
}

/// Balls of radius 10 and restitution e, apart from each other in a box of at least 430 by 400 px, in motion.
fn scattered(count: u32, restitution: f64) -> Result<Vec<Ball>, OutOfRange> {
    let place = |index: u32| {
        let (column, row) = (f64::from(index % 8), f64::from(index / 8));
        let turn = 2.4 * f64::from(index);
        let velocity = (150.0 * turn.cos(), 150.0 * turn.sin());
        moving(40.0 + 45.0 * column, 40.0 + 45.0 * row, 10.0, velocity)?.with_restitution(restitution)
    };
    (0..count).map(place).collect()
}
