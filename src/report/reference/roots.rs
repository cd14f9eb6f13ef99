//! Where a polynomial of up to fourth degree first falls through zero.
//!
//! Plainly: between two neighbouring turns it is monotone, and its turns are the zeros of its derivative. This is slow,
//! and has nothing in common with how the `exact` solver finds the same times.

use super::real::Real;

/// The value at `time` of the polynomial with these coefficients, the constant one first.
fn value<R: Real>(coefficients: &[R], time: R) -> R {
    coefficients.iter().rev().fold(R::of(0.0), |sum, &coefficient| sum * time + coefficient)
}

fn derivative<R: Real>(coefficients: &[R]) -> Vec<R> {
    let powers = (1..).map(f64::from);
    coefficients.iter().skip(1).zip(powers).map(|(&coefficient, power)| coefficient * R::of(power)).collect()
}

/// The zeros inside `0 .. end` at which the sign changes, in their order.
fn zeros<R: Real>(coefficients: &[R], end: R) -> Vec<R> {
    if coefficients.len() < 2 {
        return Vec::new();
    }
    let mut borders = vec![R::of(0.0)];
    borders.extend(zeros(&derivative(coefficients), end));
    borders.push(end);
    let signs_differ = |from: R, to: R| (from > R::of(0.0)) != (to > R::of(0.0));
    let spans = borders
        .windows(2)
        .filter(|span| signs_differ(value(coefficients, span[0]), value(coefficients, span[1])));
    spans.map(|span| bisect(coefficients, span[0], span[1])).collect()
}

/// The zero between two times at which the signs differ.
fn bisect<R: Real>(coefficients: &[R], from: R, to: R) -> R {
    let (mut low, mut high) = (from, to);
    let above = value(coefficients, low) > R::of(0.0);
    loop {
        let middle = (low + high) * R::of(0.5);
        if middle <= low || middle >= high {
            return high;
        }
        if (value(coefficients, middle) > R::of(0.0)) == above {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// When the polynomial first falls from above zero to zero or below, within `0 .. end`.
pub(super) fn first_fall<R: Real>(coefficients: &[R], end: R) -> Option<R> {
    let slope = derivative(coefficients);
    // Bisection ends on the far side of a zero, so that a fall is told from a rise by the slope.
    zeros(coefficients, end).into_iter().find(|&time| value(&slope, time) < R::of(0.0))
}

#[cfg(test)]
mod tests {
    use qd::Quad;

    use super::*;

    /// The product of (t − z) for all of these.
    fn with_zeros(zeros: &[f64]) -> Vec<Quad> {
        zeros.iter().fold(vec![Quad::of(1.0)], |product, &zero| {
            let mut next = vec![Quad::of(0.0); product.len() + 1];
            for (power, &coefficient) in product.iter().enumerate() {
                next[power + 1] += coefficient;
                next[power] -= coefficient * Quad::of(zero);
            }
            next
        })
    }

    #[test]
    fn the_first_fall_is_found_to_all_digits() {
        for (zeros, end, wanted) in [
            (&[1.0, 2.0, 3.0, 4.0][..], 10.0, Some(1.0)),
            (&[-1.0, 2.0, 3.0, 4.0], 10.0, Some(3.0)),
            (&[-1.0, 2.0, 3.0, 4.0], 2.5, None),
            (&[0.25, 0.250_000_1], 1.0, Some(0.25)),
            (&[5.0], 10.0, None),
        ] {
            let found = first_fall(&with_zeros(zeros), Quad::of(end));
            assert_eq!(found.is_some(), wanted.is_some(), "{zeros:?}");
            if let (Some(found), Some(wanted)) = (found, wanted) {
                assert!((found - Quad::of(wanted)).rounded().abs() < 1e-24, "{zeros:?}");
            }
        }
    }
}
