//! What a quantity may be: every limit of the physics in one place, with its unit and its reason.
//!
//! The ranges are wide enough for every case that carom is tested on (mass ratios of 10¹⁸, speeds of
//! 10⁸ px/s, an hour in one step) and narrow enough that the few of them that a formula multiplies stay far inside of the range
//! of an `f64`, which ends at 10³⁰⁸: an energy is at most 10⁴⁸, the fourth power of a length or a speed 10³⁶. A solver that
//! starts from checked input need not guard each operation against overflow.

use std::fmt;

use glam::DVec2;

/// A physical quantity: its name, its unit, and the closed range that its values may come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// The name as an error message says it.
    pub name: &'static str,
    /// The unit, empty for a ratio.
    pub unit: &'static str,
    /// The smallest value allowed.
    pub low: f64,
    /// The largest value allowed.
    pub high: f64,
}

/// A coordinate of a ball's centre. At 10⁹ px an `f64` still resolves 10⁻⁷ px.
pub const COORDINATE: Quantity = Quantity { name: "position", unit: "px", low: -1e9, high: 1e9 };
/// A component of a ball's velocity.
pub const VELOCITY: Quantity = Quantity { name: "velocity", unit: "px/s", low: -1e9, high: 1e9 };
/// A ball's radius. Squares of smaller radii would be lost beside ordinary coordinates.
pub const RADIUS: Quantity = Quantity { name: "radius", unit: "px", low: 1e-6, high: 1e9 };
/// A ball's mass. Only ratios of masses matter; 10⁻³⁰ … 10³⁰ leaves room for any that `f64` can resolve.
pub const MASS: Quantity = Quantity { name: "mass", unit: "", low: 1e-30, high: 1e30 };
/// A component of a fixed ball's velocity.
pub const FIXED_VELOCITY: Quantity =
    Quantity { name: "velocity of a fixed ball", low: 0.0, high: 0.0, ..VELOCITY };
/// A fixed ball's mass.
pub const FIXED_MASS: Quantity =
    Quantity { name: "mass of a fixed ball", low: f64::INFINITY, high: f64::INFINITY, ..MASS };
/// A coefficient of restitution: 0 takes all of the approach speed, 1 gives all of it back.
pub const RESTITUTION: Quantity = Quantity { name: "restitution", unit: "", low: 0.0, high: 1.0 };
/// A component of gravity.
pub const GRAVITY: Quantity = Quantity { name: "gravity", unit: "px/s²", low: -1e9, high: 1e9 };
/// A side of the world.
pub const SIZE: Quantity = Quantity { name: "size", unit: "px", low: 1.0, high: 1e6 };
/// The delta of one frame. Eleven days in one step are a mistake of the caller's, not a frame.
pub const DELTA: Quantity = Quantity { name: "delta", unit: "s", low: 0.0, high: 1e6 };

/// The speed below which bouncing counts as rest.
pub const REST_SPEED: Quantity = Quantity { name: "rest speed", unit: "px/s", low: 1e-9, high: 1e9 };

/// The rest speed of a simulation that is not told otherwise, px/s. A hop that is left out is then half a thousandth of
/// a pixel high under the demo's gravity.
pub const DEFAULT_REST_SPEED: f64 = 1.0;

/// Substeps in a second of `contact`: from 24, as many as a film has pictures, to 245,760, which is 1024 times 240, the number that
/// it takes where nothing asks for more or fewer.
pub const SUBSTEPS: Quantity = Quantity { name: "substeps", unit: "1/s", low: 24.0, high: 245_760.0 };

/// The most threads that share the work of a substep.
pub const MAX_THREADS: u32 = 256;

/// The most balls that one simulation takes: their indices are `u32`, and ten million balls of `exact` fill three
/// gigabytes.
pub const MAX_BALLS: usize = 10_000_000;

impl Quantity {
    /// The value itself where it is finite and in range.
    ///
    /// # Errors
    /// [`OutOfRange`] for NaN, an infinity, or a value outside `low ..= high`.
    pub fn check(&'static self, value: f64) -> Result<f64, OutOfRange> {
        // A NaN fails both comparisons, so it is not in the range.
        if value >= self.low && value <= self.high {
            Ok(value)
        } else {
            Err(OutOfRange { quantity: self, value })
        }
    }

    /// Both components of a vector, each checked.
    ///
    /// # Errors
    /// [`OutOfRange`] for the first component that [`check`](Self::check) refuses.
    pub fn check_vector(&'static self, value: DVec2) -> Result<DVec2, OutOfRange> {
        Ok(DVec2::new(self.check(value.x)?, self.check(value.y)?))
    }
}

/// A value that its quantity does not allow. The message says what is wrong and what to write instead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutOfRange {
    /// Which quantity.
    pub quantity: &'static Quantity,
    /// The value that was refused.
    pub value: f64,
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Quantity { name, unit, low, high } = *self.quantity;
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        let value = self.value;
        if low == high {
            return write!(f, "{name} is {}{unit}; it must be {}{unit}", Short(value), Short(low));
        }
        write!(f, "{name} is {}{unit}; it must be from {} to {}{unit}", Short(value), Short(low), Short(high))
    }
}

impl std::error::Error for OutOfRange {}

/// A number as a person would write it: 1e9, not 1000000000.
pub(crate) struct Short(pub(crate) f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size != 0.0 && !(1e-4..1e6).contains(&size) && size.is_finite() {
            write!(f, "{:e}", self.0)
        } else {
            write!(f, "{}", self.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_a_range_are_in_it_and_their_neighbours_outside_are_not() {
        for quantity in
            [&COORDINATE, &VELOCITY, &RADIUS, &MASS, &RESTITUTION, &GRAVITY, &SIZE, &DELTA, &REST_SPEED]
        {
            assert!(quantity.check(quantity.low).is_ok() && quantity.check(quantity.high).is_ok());
            assert!(quantity.check(quantity.low.next_down()).is_err());
            assert!(quantity.check(quantity.high.next_up()).is_err());
            assert!(quantity.check(f64::NAN).is_err());
        }
    }

    #[test]
    fn a_fixed_ball_has_one_velocity_and_one_mass() {
        assert_eq!(
            (FIXED_VELOCITY.check(0.0), FIXED_MASS.check(f64::INFINITY)),
            (Ok(0.0), Ok(f64::INFINITY))
        );
        for velocity in [f64::MIN_POSITIVE, -1.0, f64::NAN] {
            assert!(FIXED_VELOCITY.check(velocity).is_err());
        }
        for mass in [f64::MAX, 0.0, f64::NAN] {
            assert!(FIXED_MASS.check(mass).is_err());
        }
    }

    #[test]
    fn a_refusal_says_what_is_wrong_and_what_is_allowed() {
        assert_eq!(
            RADIUS.check(-3.0).unwrap_err().to_string(),
            "radius is -3 px; it must be from 1e-6 to 1e9 px"
        );
        assert_eq!(
            RESTITUTION.check(f64::NAN).unwrap_err().to_string(),
            "restitution is NaN; it must be from 0 to 1"
        );
        assert_eq!(
            FIXED_VELOCITY.check(3.0).unwrap_err().to_string(),
            "velocity of a fixed ball is 3 px/s; it must be 0 px/s"
        );
        assert_eq!(
            FIXED_MASS.check(1e30).unwrap_err().to_string(),
            "mass of a fixed ball is 1e30; it must be inf"
        );
    }
}
