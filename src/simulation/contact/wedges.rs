//! Balls that are wedged in between what carries them and one that does not give way above them, asleep or fixed, which nearly faces
//! that. (Between what is fixed alone, `firm` holds them.)
//!
//! In a flat wedge, what holds a ball is many times its weight, and sweeps find that in hundreds of substeps, while the ball hops
//! in it, and wakes those around it. What keeps it from going farther in is found at once: among its velocities that take it into
//! none of its neighbours, as these move now, the one that is nearest to what it has. What it presses on gives way no faster for
//! that.
//!
//! That is so for pairs of one stripe: a wedge across the edge of two is left to sweeps.

use glam::DVec2;

use super::carry::Floor;
use super::constraints::{Constraint, Marks};
use super::sleep::Rest;
use super::stripes::Stripe;
use super::{Body, Setting};

/// A wedge is flat where what is above faces what carries the ball to within an angle of this cosine: 30° under or between fixed
/// ones, 14° under one asleep. What others hold, sweeps find soon; if they were stopped so, too, piles would come to rest later.
pub(super) const FLAT_UNDER_FIXED: f64 = 0.87;
pub(super) const FLAT_UNDER_SLEEPER: f64 = 0.97;
/// By so much of a ball's speed it may still go into what holds it: what rounding leaves in flat wedges.
const ROUNDING: f64 = 1e-9;

/// A pair that is held apart, of which one cannot be moved: either, which may change while the list stands.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wedging {
    /// Its lower ball.
    lower: u32,
    /// The place of its constraint.
    at: u32,
    /// How flat a wedge under the upper one counts as flat, as a cosine.
    flat: f64,
}

impl Stripe {
    /// Gathers such pairs in the order of their lower balls.
    pub(super) fn gather_wedging(&mut self, setting: &Setting, rests: &[Rest]) {
        let Self { pairs, places_of_constraints, marks, wedging, .. } = self;
        wedging.clear();
        let still = marks.iter().zip(pairs).zip(&*places_of_constraints);
        let still = still.filter(|((marks, _), _)| marks.touch() && marks.has(Marks::STILL));
        wedging.extend(still.filter_map(|((_, pair), &at)| {
            let is_fixed = rests[pair.first as usize].own == 0.0;
            let flat = if is_fixed { Some(FLAT_UNDER_FIXED) } else { setting.flat_under_sleeper };
            flat.map(|flat| Wedging { lower: pair.second, at, flat })
        }));
        wedging.sort_unstable_by_key(|wedging| (wedging.lower, wedging.at));
    }
}

/// Stops a ball that these constraints, `its`, have others carry, if it lies in a flat wedge: if what does not give way above it, among
/// those that are `wedging`, faces one of them. Whether it does.
///
/// Not inlined: few balls lie so.
#[inline(never)]
pub(super) fn stop_in_wedge(
    ball: usize,
    constraints: &[Constraint],
    bodies: &mut [Body],
    its: &[u32],
    wedging: &[Wedging],
    floors: &mut Vec<Floor>,
) -> bool {
    let from = wedging.partition_point(|wedging| (wedging.lower as usize) < ball);
    let above = wedging[from..].iter().take_while(|wedging| wedging.lower as usize == ball);
    floors.clear();
    floors.extend(above.filter_map(|&Wedging { at, flat, .. }| {
        let Constraint { pair, normal, least, .. } = constraints[at as usize];
        // It may be the other one that cannot be moved.
        let is_firm = bodies[pair.first as usize].inverse_mass == 0.0;
        let faces = || its.iter().any(|&at| constraints[at as usize].normal.dot(normal) > flat);
        (is_firm && faces()).then(|| Floor { up: -normal, least: least.min(0.0) })
    }));
    if floors.is_empty() || bodies[ball].inverse_mass == 0.0 {
        return false;
    }
    floors.extend(its.iter().map(|&at| Floor::under(constraints, bodies, at)));
    let body = &mut bodies[ball];
    let change = held_between(body.velocity, &floors.iter().copied()) - body.velocity;
    // Nothing is passed on to what it presses on.
    body.velocity += change;
    body.free += change;
    true
}

/// The velocity that is nearest to this one of those that sink into no floor. That is a projection onto a convex set, of which one or
/// two floors bound what is nearest. A velocity of 0 sinks into none, so it only ever becomes less.
pub(super) fn held_between(velocity: DVec2, floors: &(impl Iterator<Item = Floor> + Clone)) -> DVec2 {
    let slack = ROUNDING * velocity.length();
    let holds = |held: &DVec2| floors.clone().all(|floor| held.dot(floor.up) >= floor.least - slack);
    if holds(&velocity) {
        return velocity;
    }
    let on_one = floors.clone().filter_map(|floor| {
        let added = floor.least - velocity.dot(floor.up);
        Some(velocity + floor.up * added).filter(|held| added > 0.0 && holds(held))
    });
    let on_two = floors.clone().enumerate().flat_map(|(number, one)| {
        floors.clone().take(number).filter_map(move |other| {
            let sine = one.up.perp_dot(other.up);
            let held = (one.up.perp() * other.least - other.up.perp() * one.least) / sine;
            // Both push, and neither pulls.
            let change = held - velocity;
            let pushes = [change.perp_dot(other.up), one.up.perp_dot(change)];
            Some(held).filter(|_| pushes.iter().all(|push| push * sine >= 0.0))
        })
    });
    // Where rounding leaves none of a very flat wedge, it is that which sinks into nothing.
    on_one.chain(on_two.filter(holds)).next().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_held_between_floors_changes_as_little_as_keeps_it_out_of_all() {
        for turn in 0..500 {
            let angle = |k: u32| f64::from(k * turn) * 0.618;
            let velocity = 100.0 * DVec2::from_angle(angle(7));
            let floor =
                |k| Floor { up: DVec2::from_angle(angle(k)), least: -20.0 * angle(k + 3).sin().abs() };
            let floors: Vec<_> = (1..2 + turn % 4).map(floor).collect();
            // Hildreth's way to the same (1957): slow, but by nothing else than one floor at a time.
            let mut slow: Vec<_> = floors.iter().map(|&floor| (floor, 0.0)).collect();
            let mut expected = velocity;
            for _ in 0..50_000 {
                for (floor, added) in &mut slow {
                    let more = (floor.least - expected.dot(floor.up)).max(-*added);
                    *added += more;
                    expected += floor.up * more;
                }
            }
            let held = held_between(velocity, &floors.iter().copied());
            assert!(held.abs_diff_eq(expected, 1e-6), "turn {turn}: {held} and {expected}");
        }
    }

    #[test]
    fn what_goes_into_a_wedge_stands_still_in_it_however_flat_it_is() {
        for flat in [0.3, 1e-2, 1e-4, 1e-7, 1e-10, 0.0] {
            let ups = [DVec2::from_angle(0.35), DVec2::from_angle(0.35 + std::f64::consts::PI - flat)];
            let floors = ups.map(|up| Floor { up, least: 0.0 });
            let into = -(ups[0] + ups[1]).normalize_or(ups[0].perp());
            let held = held_between(3.0 * into, &floors.into_iter());
            assert!(flat < 1e-8 || held.length() < 1e-6, "{flat} rad: {held}");
            assert!(floors.iter().all(|floor| held.dot(floor.up) > -1e-6), "{flat} rad: {held}");
        }
    }
}
