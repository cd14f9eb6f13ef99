//! Balls that are wedged in between what carries them and what is above them and does not give way: a ball asleep, or a fixed one.
//!
//! In a flat wedge, what holds a ball is many times its weight, and sweeps find that in hundreds of substeps, while the ball hops
//! in it, and wakes those around it. What keeps it from going farther in is found at once: among its velocities that take it into
//! none of its neighbours, as these move now, the one that is nearest to what it has. What it presses on gives way no faster for
//! that.

use glam::DVec2;

use super::Body;
use super::carry::{Floor, stop};
use super::constraints::{Constraint, Marks};
use super::sleep::Rest;
use super::stripes::Stripe;

/// A wedge is flat where what is above faces what carries the ball to within an angle of this cosine: 30° under a fixed ball, 14° under
/// one asleep. What others hold, sweeps find soon; if they were stopped so, too, deep piles would come to rest later.
const FLAT_UNDER_FIXED: f64 = 0.87;
const FLAT_UNDER_SLEEPER: f64 = 0.97;
/// By so much of a ball's speed it may still go into what holds it: what rounding leaves in flat wedges.
const ROUNDING: f64 = 1e-9;

/// A pair that is held apart, of which one cannot be moved.
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
    pub(super) fn gather_wedging(&mut self, rests: &[Rest]) {
        let Self { pairs, places_of_constraints, marks, wedging, .. } = self;
        wedging.clear();
        let still = marks.iter().zip(pairs).zip(&*places_of_constraints);
        let still = still.filter(|((marks, _), _)| marks.touch() && marks.has(Marks::STILL));
        wedging.extend(still.map(|((_, pair), &at)| {
            let is_fixed = rests[pair.first as usize].own == 0.0;
            let flat = if is_fixed { FLAT_UNDER_FIXED } else { FLAT_UNDER_SLEEPER };
            Wedging { lower: pair.second, at, flat }
        }));
        wedging.sort_unstable_by_key(|wedging| (wedging.lower, wedging.at));
    }
}

/// Stops a ball between what these constraints, `its`, have carry it and what does not give way above it, among those that are
/// `wedging`, if that is a flat wedge. Whether it is.
#[inline]
pub(super) fn stop_in_wedge(
    ball: usize,
    constraints: &mut [Constraint],
    bodies: &mut [Body],
    its: &[u32],
    wedging: &[Wedging],
    floors: &mut Vec<(Floor, f64)>,
) -> bool {
    if wedging.is_empty() || bodies[ball].inverse_mass == 0.0 {
        return false;
    }
    let from = wedging.partition_point(|wedging| (wedging.lower as usize) < ball);
    let above = wedging[from..].iter().take_while(|wedging| wedging.lower as usize == ball);
    floors.clear();
    floors.extend(above.filter_map(|&Wedging { at, flat, .. }| {
        let Constraint { pair, normal, least, .. } = constraints[at as usize];
        let faces = || its.iter().any(|&at| constraints[at as usize].normal.dot(normal) > flat);
        // It may be the other one that cannot be moved.
        let is_firm = bodies[pair.first as usize].inverse_mass == 0.0;
        (is_firm && faces()).then(|| (Floor { up: -normal, least: least.min(0.0) }, 0.0))
    }));
    if floors.is_empty() {
        return false;
    }
    floors.extend(its.iter().map(|&at| (Floor::under(constraints, bodies, at), 0.0)));
    hold_between(bodies[ball].velocity, floors);
    // Nothing is passed on to any constraint.
    let by = floors.iter().map(|&(floor, added)| ((0, floor), added));
    stop::<false>(ball, constraints, bodies, 0.0, by);
    true
}

/// Finds how much each floor adds to a velocity, so that it sinks into none, by the least change. That is a projection onto a convex
/// set: of what bounds it, one or two add anything. A velocity of 0 sinks into none, so it only ever becomes less.
fn hold_between(velocity: DVec2, floors: &mut [(Floor, f64)]) {
    let slack = ROUNDING * velocity.length();
    let holds = |held: DVec2, floors: &[(Floor, f64)]| {
        floors.iter().all(|(floor, _)| held.dot(floor.up) >= floor.least - slack)
    };
    if holds(velocity, floors) {
        return;
    }
    let lacking = |floor: Floor| floor.least - velocity.dot(floor.up);
    for one in 0..floors.len() {
        let floor = floors[one].0;
        let added = lacking(floor);
        if added > 0.0 && holds(velocity + floor.up * added, floors) {
            floors[one].1 = added;
            return;
        }
    }
    for one in 0..floors.len() {
        for other in 0..one {
            let (first, second) = (floors[one].0, floors[other].0);
            let shared = first.up.dot(second.up);
            // 0 where both have one direction, or face each other: there, each alone says all.
            let sine = first.up.perp_dot(second.up);
            let apart = sine * sine;
            let added = [(first, second), (second, first)]
                .map(|(this, that)| (lacking(this) - shared * lacking(that)) / apart);
            let held = velocity + first.up * added[0] + second.up * added[1];
            if added.iter().all(|&added| added >= 0.0) && holds(held, floors) {
                (floors[one].1, floors[other].1) = (added[0], added[1]);
                return;
            }
        }
    }
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
            let mut floors: Vec<_> = (1..2 + turn % 4).map(|k| (floor(k), 0.0)).collect();
            // Hildreth's way to the same (1957): slow, but by nothing else than one floor at a time.
            let mut slow = floors.clone();
            let mut expected = velocity;
            for _ in 0..50_000 {
                for (floor, added) in &mut slow {
                    let more = (floor.least - expected.dot(floor.up)).max(-*added);
                    *added += more;
                    expected += floor.up * more;
                }
            }
            hold_between(velocity, &mut floors);
            let held: DVec2 = velocity + floors.iter().map(|(floor, added)| floor.up * *added).sum::<DVec2>();
            assert!(held.abs_diff_eq(expected, 1e-6), "turn {turn}: {held} and {expected}");
        }
    }
}
