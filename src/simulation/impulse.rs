//! The law of impact: two smooth discs exchange momentum along the line of their centres (Newton 1687).
//!
//! With normal velocities v₁, v₂ along the line of centres and restitution e, momentum is kept,
//! m₁v₁′ + m₂v₂′ = m₁v₁ + m₂v₂, and the speed of parting is e times that of approach, v₁′ − v₂′ = e·(v₂ − v₁).
//! Tangential velocities stay as they are: there is no friction.

use glam::DVec2;

use super::ball::Ball;

/// The direction of an impact between two balls whose centres coincide. Any fixed one will do, as long as it is
/// always the same: the demo divides zero by zero here.
pub(super) const COINCIDENT_NORMAL: DVec2 = DVec2::X;

/// Where a ball is seen from another at the same point, as if it were at this distance: in a direction of the pair's own, so
/// that many go all ways.
pub(super) fn any_offset(one: usize, other: usize, distance: f64) -> DVec2 {
    // A unit vector without sines, which differ from machine to machine; the golden ratio spreads them.
    let golden = 0.618_033_988_749_894_9;
    let t = 2.0 * (golden * (3 * one.min(other) + one.max(other)) as f64).fract() - 1.0;
    distance * DVec2::new(1.0 - t * t, 2.0 * t) / (1.0 + t * t)
}

/// The two forms in which the demo writes the law. They agree to rounding where e = 1, and differ in the last bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// Both balls give back everything: the textbook's elastic exchange.
    Elastic,
    /// The smaller restitution of the two counts.
    Inelastic,
}

/// The velocities of two touching balls after their impact in the demo's own arithmetic, operation by operation;
/// `None` where the impact would leave them approaching each other, that is, where they part already.
///
/// Every sum and product is taken in the demo's order, because the result is compared with it bit for bit.
#[inline]
pub(super) fn canvas_impact(form: Form, first: &Ball, second: &Ball) -> Option<(DVec2, DVec2)> {
    let (m1, m2) = (first.mass, second.mass);
    let normal = normal(first.position - second.position);
    let tangent = DVec2::new(-normal.y, normal.x);
    let (v1n, v1t) = (first.velocity.dot(normal), first.velocity.dot(tangent));
    let (v2n, v2t) = (second.velocity.dot(normal), second.velocity.dot(tangent));
    let (after1, after2) = match form {
        Form::Elastic => {
            ((v1n * (m1 - m2) + 2.0 * m2 * v2n) / (m1 + m2), (v2n * (m2 - m1) + 2.0 * m1 * v1n) / (m1 + m2))
        }
        Form::Inelastic => {
            let e = first.restitution.min(second.restitution);
            (
                (m1 * v1n + m2 * v2n + e * m2 * (v2n - v1n)) / (m1 + m2),
                (m1 * v1n + m2 * v2n + e * m1 * (v1n - v2n)) / (m1 + m2),
            )
        }
    };
    if after1 < after2 {
        return None;
    }
    Some((normal * after1 + tangent * v1t, normal * after2 + tangent * v2t))
}

/// The velocity of a ball after its impact on a fixed one: what [`canvas_impact`] tends to as the other's mass grows.
/// `None` where it does not approach, whatever the restitution: the demo's balls of restitution 0 stick to each other,
/// but none sticks to what is fixed.
#[inline]
pub(super) fn canvas_rebound(form: Form, ball: &Ball, fixed: &Ball) -> Option<DVec2> {
    let normal = normal(ball.position - fixed.position);
    let tangent = DVec2::new(-normal.y, normal.x);
    let (along, across) = (ball.velocity.dot(normal), ball.velocity.dot(tangent));
    if along >= 0.0 {
        return None;
    }
    let e = match form {
        Form::Elastic => 1.0,
        Form::Inelastic => ball.restitution.min(fixed.restitution),
    };
    Some(normal * (-e * along) + tangent * across)
}

/// The changes of velocity of two balls whose relative position is `offset` and whose relative velocity is `velocity`
/// (first less second), by an impact with restitution `e`. `shares` of the change of relative velocity are theirs: each
/// the other's mass over the sum of both.
///
/// It is written with Δv·Δr/|Δr|²·Δr, without a unit normal, whose rounding would make the energy drift.
#[inline]
pub(super) fn exact_impact(offset: DVec2, velocity: DVec2, shares: (f64, f64), e: f64) -> (DVec2, DVec2) {
    let offset = direction(offset);
    let change = offset * (-(1.0 + e) * velocity.dot(offset) / offset.length_squared());
    (change * shares.0, change * -shares.1)
}

/// The same where walls may hold a ball, or one is fixed, by the balls' inverse masses along each axis: 0 where one
/// cannot give way. Balls that are both held along the line of centres keep their velocities.
pub(super) fn held_impact(
    offset: DVec2,
    velocity: DVec2,
    inverse_masses: (DVec2, DVec2),
    e: f64,
) -> (DVec2, DVec2) {
    let offset = direction(offset);
    let (first, second) = (inverse_masses.0 * offset, inverse_masses.1 * offset);
    let yielding = (first + second).dot(offset);
    if yielding <= 0.0 {
        return (DVec2::ZERO, DVec2::ZERO);
    }
    let impulse = -(1.0 + e) * velocity.dot(offset) / yielding;
    (first * impulse, -second * impulse)
}

/// A vector of any length along the line of centres.
#[inline]
fn direction(offset: DVec2) -> DVec2 {
    if offset.length_squared() < f64::MIN_POSITIVE { COINCIDENT_NORMAL } else { offset }
}

/// The unit vector along `difference`, component by component over its length.
#[inline]
fn normal(difference: DVec2) -> DVec2 {
    let squared = difference.length_squared();
    // Below the smallest normal number the square has lost its digits, and with them the direction.
    if squared < f64::MIN_POSITIVE { COINCIDENT_NORMAL } else { difference / squared.sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(x: f64, y: f64, vx: f64, vy: f64, mass: f64, restitution: f64) -> Ball {
        Ball::new(DVec2::new(x, y), 10.0)
            .and_then(|ball| ball.with_velocity(DVec2::new(vx, vy)))
            .and_then(|ball| ball.with_mass(mass))
            .and_then(|ball| ball.with_restitution(restitution))
            .unwrap()
    }

    #[test]
    fn equal_masses_exchange_their_normal_velocities_head_on() {
        let (left, right) = (ball(0.0, 0.0, 50.0, 3.0, 2.0, 1.0), ball(20.0, 0.0, -10.0, -4.0, 2.0, 1.0));
        let (after_left, after_right) = canvas_impact(Form::Elastic, &left, &right).unwrap();
        assert_eq!((after_left, after_right), (DVec2::new(-10.0, 3.0), DVec2::new(50.0, -4.0)));
    }

    #[test]
    fn the_speed_of_parting_is_the_smaller_restitution_times_the_speed_of_approach() {
        for e in [0.0, 0.25, 0.5, 1.0] {
            let (left, right) = (ball(0.0, 0.0, 40.0, 0.0, 3.0, e), ball(20.0, 0.0, 0.0, 0.0, 1.0, 1.0));
            let (after_left, after_right) = canvas_impact(Form::Inelastic, &left, &right).unwrap();
            assert!((after_right.x - after_left.x - e * 40.0).abs() < 1e-13 * 40.0);
            assert!((3.0 * after_left.x + after_right.x - 120.0).abs() < 1e-12);
        }
    }

    #[test]
    fn parting_balls_are_left_alone() {
        let (left, right) = (ball(0.0, 0.0, -1.0, 0.0, 1.0, 0.5), ball(15.0, 0.0, 1.0, 0.0, 1.0, 0.5));
        assert_eq!(canvas_impact(Form::Elastic, &left, &right), None);
        assert_eq!(canvas_impact(Form::Inelastic, &left, &right), None);
    }

    #[test]
    fn a_fixed_ball_is_the_limit_of_a_heavy_one() {
        for (form, e) in [(Form::Elastic, 1.0), (Form::Inelastic, 0.0), (Form::Inelastic, 0.6)] {
            let light = ball(3.0, 4.0, -70.0, 20.0, 2.0, e);
            let fixed = Ball::new(DVec2::ZERO, 10.0).unwrap().fixed();
            let after = canvas_rebound(form, &light, &fixed).unwrap();
            let heavy = ball(0.0, 0.0, 0.0, 0.0, 1e17, 1.0);
            let (limit, _) = canvas_impact(form, &light, &heavy).unwrap();
            assert!((after - limit).length() < 1e-13, "{form:?}: {after} is not {limit}");
            for parting in [DVec2::new(70.0, -20.0), DVec2::ZERO] {
                assert_eq!(canvas_rebound(form, &light.with_velocity(parting).unwrap(), &fixed), None);
            }
        }
    }

    #[test]
    fn coincident_centres_meet_along_a_fixed_direction_and_stay_finite() {
        for offset in [0.0, 1e-200] {
            let (one, other) = (ball(offset, 0.0, -5.0, 1.0, 1.0, 0.5), ball(0.0, 0.0, 5.0, 2.0, 1.0, 0.5));
            let (after_one, after_other) = canvas_impact(Form::Inelastic, &one, &other).unwrap();
            assert_eq!(after_one.x - after_other.x, 0.5 * 10.0);
            assert_eq!((after_one.y, after_other.y), (1.0, 2.0));
        }
    }

    /// From taking all to giving all back; with one of them, four digits of e·v are left beside v.
    const RESTITUTIONS: [f64; 4] = [0.0, 1e-12, 0.5, 1.0];

    /// The impact of two free balls, in both forms of the law.
    fn free_impacts(offset: DVec2, velocity: DVec2, (m1, m2): (f64, f64), e: f64) -> [(DVec2, DVec2); 2] {
        let shares = (m2 / (m1 + m2), m1 / (m1 + m2));
        let inverse_masses = (DVec2::splat(1.0 / m1), DVec2::splat(1.0 / m2));
        [exact_impact(offset, velocity, shares, e), held_impact(offset, velocity, inverse_masses, e)]
    }

    /// How far the speed of parting is from e times that of approach, as a fraction of the relative speed.
    fn violation(offset: DVec2, velocity: DVec2, (first, second): (DVec2, DVec2), e: f64) -> f64 {
        let along = offset.normalize();
        let approach = -velocity.dot(along);
        let parting = (velocity + first - second).dot(along);
        (parting - e * approach).abs() / velocity.length()
    }

    #[test]
    fn momentum_and_the_law_of_restitution_hold_for_all_ratios_of_masses() {
        let offset = DVec2::new(-12.0, 5.0);
        for mass in [1.0, 3.0, 1e4, 1e9, 1e14] {
            for e in RESTITUTIONS {
                for velocity in [DVec2::new(40.0, 7.0), DVec2::new(1e8, -1e8), DVec2::new(1e-6, 0.0)] {
                    for (m1, m2) in [(1.0, mass), (mass, 1.0)] {
                        for changes in free_impacts(offset, velocity, (m1, m2), e) {
                            let (first, second) = changes;
                            let given = m1 * first;
                            assert!((given + m2 * second).length() <= 4.0 * f64::EPSILON * given.length());
                            // They push along the line of centres, and away from each other.
                            assert!(first.perp_dot(offset).abs() <= 52.0 * f64::EPSILON * first.length());
                            assert!(first.dot(offset) > 0.0 && second.dot(offset) < 0.0);
                            assert!(violation(offset, velocity, changes, e) <= 4.0 * f64::EPSILON);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn energy_is_kept_where_all_is_given_back_and_otherwise_lost_as_the_law_says() {
        // ΔE = −½ μ (1 − e²) vₙ² with the reduced mass μ.
        let (offset, m2) = (DVec2::new(3.0, 4.0), 5.0);
        let (v1, v2) = (DVec2::new(-60.0, -10.0), DVec2::new(15.0, 20.0));
        for m1 in [1.0, 1e4, 1e9, 1e14] {
            for e in RESTITUTIONS {
                // ½m(v + Δv)² − ½mv², without the difference of the squares.
                let gained = |mass: f64, v: DVec2, change: DVec2| mass * change.dot(v + 0.5 * change);
                let approach = (v1 - v2).dot(offset) / 5.0;
                let lost = 0.5 * (1.0 - e * e) * approach * approach / (1.0 / m1 + 1.0 / m2);
                for (first, second) in free_impacts(offset, v1 - v2, (m1, m2), e) {
                    let (one, other) = (gained(m1, v1, first), gained(m2, v2, second));
                    assert!((one + other + lost).abs() <= 8.0 * f64::EPSILON * (one.abs() + other.abs()));
                }
            }
        }
    }

    #[test]
    fn a_ball_that_a_wall_holds_moves_along_the_wall_only() {
        // The one rests on the floor; the other comes from above, to the right of it.
        let (offset, velocity) = (DVec2::new(-6.0, 8.0), DVec2::new(3.0, -50.0));
        for mass in [1.0, 1e14] {
            for e in RESTITUTIONS {
                let inverse_masses = (DVec2::new(1.0 / mass, 0.0), DVec2::ONE);
                let changes = held_impact(offset, velocity, inverse_masses, e);
                let (first, second) = changes;
                assert_eq!(first.y, 0.0);
                assert!(first.x < 0.0 && second.x > 0.0 && second.y < 0.0);
                // The floor takes the vertical momentum and nothing of the horizontal.
                assert!((mass * first.x + second.x).abs() <= 4.0 * f64::EPSILON * second.x);
                assert!(violation(offset, velocity, changes, e) <= 4.0 * f64::EPSILON);
            }
        }
    }

    #[test]
    fn balls_that_walls_hold_in_every_direction_that_counts_do_not_push_each_other() {
        let below = DVec2::new(0.0, 10.0);
        let floor = DVec2::new(1.0, 0.0);
        for held in [floor, DVec2::ZERO] {
            let changes = held_impact(below, DVec2::new(5.0, -5.0), (held, held), 1.0);
            assert_eq!(changes, (DVec2::ZERO, DVec2::ZERO));
        }
    }

    #[test]
    fn coincident_centres_give_the_exact_law_a_fixed_direction_too() {
        for offset in [DVec2::ZERO, DVec2::new(0.0, 1e-200)] {
            for e in RESTITUTIONS {
                for (first, second) in free_impacts(offset, DVec2::new(-8.0, 3.0), (1.0, 3.0), e) {
                    assert!((first - DVec2::new(6.0 * (1.0 + e), 0.0)).length() <= 32.0 * f64::EPSILON);
                    assert!((second + DVec2::new(2.0 * (1.0 + e), 0.0)).length() <= 32.0 * f64::EPSILON);
                }
            }
        }
    }
}
