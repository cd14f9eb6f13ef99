//! Closed-form flight and its roots: when does a ball reach a wall (here), when do two balls meet (`pair`, `accelerated`).
//!
//! Every time is seconds from now; [`NEVER`] says that it does not happen. Roots are written so that nearly equal
//! numbers are never subtracted, and the rule for contact is that of Bannerman, Strobl, Formella and Pöschel (2014,
//! arXiv:1211.6718): what overlaps and approaches meets now, what overlaps and parts does not meet. Of what overlaps at
//! rest they say nothing; here it meets now.

mod accelerated;
mod pair;
#[cfg(test)]
mod reference;

use glam::DVec2;

pub(super) use pair::{DEEP, Pair, least_parting};

/// The time of what does not happen.
pub(super) const NEVER: f64 = f64::INFINITY;

/// Where something is after `time` seconds, with constant acceleration.
#[inline]
pub(super) fn position(position: DVec2, velocity: DVec2, acceleration: DVec2, time: f64) -> DVec2 {
    position + (velocity + 0.5 * acceleration * time) * time
}

/// When something that is `gap` away from a line, approaches it at `speed` and is accelerated toward it by
/// `acceleration` (both negative for away) next meets it while approaching.
///
/// Behind the line (a negative gap) it meets as soon as it approaches.
#[inline]
pub(super) fn reach(gap: f64, speed: f64, acceleration: f64) -> f64 {
    if acceleration == 0.0 {
        return if speed > 0.0 { gap.max(0.0) / speed } else { NEVER };
    }
    if gap <= 0.0 && speed >= 0.0 && (speed > 0.0 || acceleration > 0.0) {
        return 0.0;
    }
    let discriminant = speed * speed + 2.0 * acceleration * gap;
    if acceleration < 0.0 {
        // It slows down: it comes in time, or turns back.
        return if speed > 0.0 && discriminant >= 0.0 {
            2.0 * gap / (speed + discriminant.sqrt())
        } else {
            NEVER
        };
    }
    if speed > 0.0 {
        2.0 * gap / (speed + discriminant.sqrt())
    } else if discriminant >= 0.0 {
        // It goes away first and returns.
        (discriminant.sqrt() - speed) / acceleration
    } else {
        // It never comes out from behind the line; it approaches again from its turning point on.
        -speed / acceleration
    }
}

/// When something that moves at a steady `velocity`, not 0, arrives `distance` away, both along one axis, with signs; 0
/// where it moves away from there: then it is behind.
#[inline]
pub(super) fn arrive(distance: f64, velocity: f64) -> f64 {
    (distance / velocity).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_reached_when_the_closed_form_says_so() {
        // Dropped from 10 px at 20 px/s²; thrown up first; never, since it turns back.
        assert_eq!(reach(10.0, 0.0, 20.0), 1.0);
        assert_eq!(reach(0.0, -10.0, 20.0), 1.0);
        assert_eq!(reach(10.0, 5.0, -20.0), NEVER);
        assert_eq!(reach(10.0, 5.0, 0.0), 2.0);
        assert_eq!(reach(10.0, -5.0, 0.0), NEVER);
        // Behind the line: now where it approaches, else from the turning point on, else never.
        assert_eq!(reach(-1.0, 5.0, -3.0), 0.0);
        assert_eq!(reach(-100.0, -5.0, 10.0), 0.5);
        assert_eq!(reach(-1.0, -5.0, 0.0), NEVER);
    }

    #[test]
    fn in_steady_flight_arriving_is_reaching() {
        for (gap, speed) in [(10.0, 5.0), (1e-300, 1e9), (0.0, 3.0), (-1.0, 5.0), (0.1, 0.3)] {
            assert_eq!(arrive(gap, speed), reach(gap, speed, 0.0));
            assert_eq!(arrive(-gap, -speed), reach(gap, speed, 0.0));
        }
    }

    #[test]
    fn a_tiny_gap_keeps_all_its_digits() {
        // t = g/v·(1 − ag/2v² + …): 1e-9 px at 1e3 px/s. The naive root has no digit of it right.
        for gravity in [980.0, -980.0] {
            let series = 1e-12 * (1.0 - gravity * 1e-9 / 2e6);
            assert!((reach(1e-9, 1e3, gravity) / series - 1.0).abs() < 4.0 * f64::EPSILON);
        }
        assert!((reach(1e-200, 1.0, 1.0) / 1e-200 - 1.0).abs() < 4.0 * f64::EPSILON);
    }
}
