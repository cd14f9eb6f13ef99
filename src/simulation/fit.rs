//! Whether balls fit into a world, and where between its walls.

use std::fmt;

use glam::{BVec2, DVec2};

use super::ball::Ball;
use super::limits::MAX_BALLS;
use super::world::World;

/// Why balls and a world do not make a simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum BuildError {
    /// A ball is wider than the walls are apart.
    BallWiderThanWorld {
        /// The ball's place in the list, from 0.
        index: usize,
        /// Its radius, px.
        radius: f64,
        /// The world's size, px.
        size: DVec2,
    },
    /// There are more balls than [`MAX_BALLS`].
    TooManyBalls {
        /// How many there are.
        count: usize,
    },
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BallWiderThanWorld { index, radius, size } => write!(
                f,
                "ball {index} (radius {radius} px) is wider than the world ({}x{} px); \
                 make the world larger or the radius at most {}",
                size.x,
                size.y,
                size.min_element() / 2.0
            ),
            Self::TooManyBalls { count } => {
                write!(f, "{count} balls are too many; the most is {MAX_BALLS}")
            }
        }
    }
}

impl std::error::Error for BuildError {}

/// Checks that `balls`, which come after `before` others, fit into the world.
pub(super) fn check_fit(world: &World, balls: &[Ball], before: usize) -> Result<(), BuildError> {
    let count = before + balls.len();
    if count > MAX_BALLS {
        return Err(BuildError::TooManyBalls { count });
    }
    if world.walls.is_some() {
        let most = world.size.min_element() / 2.0;
        if let Some(index) = balls.iter().position(|ball| ball.radius > most) {
            let (radius, size) = (balls[index].radius, world.size);
            return Err(BuildError::BallWiderThanWorld { index: before + index, radius, size });
        }
    }
    Ok(())
}

/// A ball is as wide as the world where that is wider by less than this part of it.
const JAMMED: f64 = 1e-12;

/// Along which axes a ball of this radius has no room between the walls of a world of `size`.
#[inline]
pub(super) fn jams(size: DVec2, radius: f64) -> BVec2 {
    (size - 2.0 * radius).cmplt(JAMMED * size)
}

/// The place between the walls of a world of `size` that is nearest to this one of a ball.
#[inline]
pub(crate) fn within(place: DVec2, radius: f64, size: DVec2) -> DVec2 {
    // Not `clamp`: it panics where rounding leaves high below low for a ball as wide as the world.
    place.min(size - radius).max(DVec2::splat(radius))
}
