//! A ball: a rigid disc that does not turn.

use glam::DVec2;

use super::limits::{
    COORDINATE, FIXED_MASS, FIXED_VELOCITY, MASS, OutOfRange, RADIUS, RESTITUTION, VELOCITY,
};

/// A disc with a position, a velocity, a radius, a mass and a coefficient of restitution.
///
/// A `Ball` that is made is valid: its numbers are finite and in the ranges of [`limits`](super::limits), so no solver
/// checks them again. Radius, mass and restitution stay so; a simulation may move a ball to a place, and to a velocity, beyond
/// these ranges, where no walls hold it. Only the mass of a [fixed](Self::fixed) ball is infinite. Lengths are in px with y
/// growing downward, times in seconds.
///
/// ```
/// use carom::{Ball, DVec2};
///
/// let ball = Ball::new(DVec2::new(30.0, 50.0), 30.0)?
///     .with_velocity(DVec2::new(-100.0, 390.0))?
///     .with_mass(30.0)?
///     .with_restitution(0.7)?;
/// assert_eq!(ball.radius(), 30.0);
/// assert!(Ball::new(DVec2::ZERO, 0.0).is_err());
/// # Ok::<(), carom::OutOfRange>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    pub(super) position: DVec2,
    pub(super) velocity: DVec2,
    pub(super) radius: f64,
    /// Infinite for a fixed ball: its inverse is 0 wherever one is wanted, and no flag makes balls larger in memory.
    pub(super) mass: f64,
    pub(super) restitution: f64,
}

impl Ball {
    /// A ball at rest with its centre at `position` px, of `radius` px, mass 1 and restitution 1.
    ///
    /// # Errors
    /// [`OutOfRange`] where a coordinate or the radius is not in its range.
    pub fn new(position: DVec2, radius: f64) -> Result<Self, OutOfRange> {
        Ok(Self {
            position: COORDINATE.check_vector(position)?,
            velocity: DVec2::ZERO,
            radius: RADIUS.check(radius)?,
            mass: 1.0,
            restitution: 1.0,
        })
    }

    /// The same ball with its centre at `position` px.
    ///
    /// # Errors
    /// [`OutOfRange`] where a coordinate is not in its range.
    pub fn with_position(self, position: DVec2) -> Result<Self, OutOfRange> {
        Ok(Self { position: COORDINATE.check_vector(position)?, ..self })
    }

    /// The same ball, moving at `velocity` px/s.
    ///
    /// # Errors
    /// [`OutOfRange`] where a component is not in the range of velocities, which for a fixed ball is 0 alone.
    pub fn with_velocity(self, velocity: DVec2) -> Result<Self, OutOfRange> {
        let range = if self.is_fixed() { &FIXED_VELOCITY } else { &VELOCITY };
        Ok(Self { velocity: range.check_vector(velocity)?, ..self })
    }

    /// The same ball, of another mass, in any unit that all balls share.
    ///
    /// # Errors
    /// [`OutOfRange`] where the mass is not in its range; a mass is never 0, and a fixed ball's is infinite.
    pub fn with_mass(self, mass: f64) -> Result<Self, OutOfRange> {
        let range = if self.is_fixed() { &FIXED_MASS } else { &MASS };
        Ok(Self { mass: range.check(mass)?, ..self })
    }

    /// The same ball, of another coefficient of restitution. Where two balls meet, the smaller of theirs counts.
    ///
    /// # Errors
    /// [`OutOfRange`] where it is not from 0 to 1.
    pub fn with_restitution(self, restitution: f64) -> Result<Self, OutOfRange> {
        Ok(Self { restitution: RESTITUTION.check(restitution)?, ..self })
    }

    /// The same ball, fixed for good: nothing moves it, neither gravity nor walls nor balls, and balls bounce off it as
    /// off a wall. Its mass is infinite, and it is at rest, whatever mass and velocity it had; it takes no others.
    /// Fixed balls do not notice each other, and may overlap.
    ///
    /// ```
    /// use carom::{Ball, DVec2};
    ///
    /// let peg = Ball::new(DVec2::new(640.0, 200.0), 8.0)?.fixed();
    /// assert!(peg.is_fixed() && peg.mass() == f64::INFINITY);
    /// assert!(peg.with_velocity(DVec2::X).is_err() && peg.with_mass(1.0).is_err());
    /// # Ok::<(), carom::OutOfRange>(())
    /// ```
    #[must_use]
    pub fn fixed(self) -> Self {
        Self { velocity: DVec2::ZERO, mass: f64::INFINITY, ..self }
    }

    /// Whether nothing moves this ball.
    #[must_use]
    #[inline]
    pub fn is_fixed(&self) -> bool {
        self.mass == f64::INFINITY
    }

    /// The centre, px.
    #[must_use]
    pub fn position(&self) -> DVec2 {
        self.position
    }

    /// The velocity, px/s.
    #[must_use]
    pub fn velocity(&self) -> DVec2 {
        self.velocity
    }

    /// The radius, px.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The mass; infinite where the ball is fixed.
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// The coefficient of restitution, 0 to 1.
    #[must_use]
    pub fn restitution(&self) -> f64 {
        self.restitution
    }
}
