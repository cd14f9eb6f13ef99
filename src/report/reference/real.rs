//! The numbers that the reference computes with: `f64`, and a pair of them with twice its digits.

use std::ops::{Add, Div, Mul, Neg, Sub};

use qd::Quad;

/// A number with a sum, a product, a quotient and a root.
pub(in crate::report) trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The unit of rounding: what 1 is relative to the digit after its last.
    const ROUNDING: f64;

    /// This value, without rounding.
    fn of(value: f64) -> Self;
    /// The root of what is not negative.
    fn root(self) -> Self;
    /// The nearest `f64`.
    fn rounded(self) -> f64;
}

impl Real for f64 {
    const ROUNDING: f64 = Self::EPSILON;

    fn of(value: f64) -> Self {
        value
    }

    fn root(self) -> Self {
        self.sqrt()
    }

    fn rounded(self) -> f64 {
        self
    }
}

impl Real for Quad {
    // Its quotients and roots are a few units of 2⁻¹⁰⁴ off.
    const ROUNDING: f64 = f64::EPSILON * f64::EPSILON * 4.0;

    fn of(value: f64) -> Self {
        Self::from(value)
    }

    fn root(self) -> Self {
        self.sqrt()
    }

    fn rounded(self) -> f64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotients_and_roots_have_twice_the_digits_of_an_f64() {
        // Some crates of such numbers have quotients with the digits of an `f64` alone.
        let mut worst = 0.0_f64;
        for step in 1..2000 {
            let one = Quad::of(1.0 + f64::from(step) / 7.0) + Quad::of(1e-17 * f64::from(step));
            let other = Quad::of(0.5 + f64::from(step % 97) / 3.0) - Quad::of(3e-18 * f64::from(step));
            worst = worst.max(((one / other * other - one) / one).rounded().abs());
            worst = worst.max(((one.root() * one.root() - one) / one).rounded().abs());
        }
        assert!(worst < Quad::ROUNDING, "{worst:e}");
        // √2 and 1/3 in decimals, a part at a time.
        let root = Quad::of(2.0).root() - Quad::of(std::f64::consts::SQRT_2);
        assert!((root.rounded() + 9.667_293_313_452_913e-17).abs() < 1e-31, "{:e}", root.rounded());
        let third = Quad::of(1.0) / Quad::of(3.0) - Quad::of(1.0 / 3.0);
        assert!((third.rounded() - 1.850_371_707_708_594e-17).abs() < 1e-31, "{:e}", third.rounded());
    }
}
