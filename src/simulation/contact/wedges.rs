//! Balls that are wedged in between what carries them and what nearly faces that and does not give way: a ball asleep, or a fixed one.
//!
//! In a flat wedge, what holds a ball is many times its weight, and sweeps find that in hundreds of substeps, while the ball hops
//! in it, and wakes those around it. What keeps it from going farther in is found at once: among its velocities that take it into
//! none of its neighbours, as these move now, the one that is nearest to what it has. What it presses on gives way no faster for
//! that.
//!
//! Where all that is around a ball is of one stripe, that is done from the ground up as what carries it stops it (`carry`), else, where
//! any are fixed, after that, ball by ball.

use glam::DVec2;

use super::carry::Floor;
use super::constraints::{Constraint, Marks};
use super::layout::Layer;
use super::near::Near;
use super::sleep::Rest;
use super::stripes::{Stripe, Stripes};
use super::{Body, Contact, Setting};

/// A wedge is flat where what is above faces what carries the ball to within an angle of this cosine: 30° under a fixed ball, 14° under
/// one asleep, or where two below face each other. What others hold, sweeps find soon; if they were stopped so, too, piles would come
/// to rest later.
const FLAT_UNDER_FIXED: f64 = 0.87;
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

/// What is around a ball that may be wedged in.
#[derive(Debug, Clone, Default)]
pub(super) struct Wedge {
    /// What cannot be moved and lies on it, as floors that look down, and how flat a wedge under each counts as flat.
    above: Vec<(Floor, f64)>,
    /// What carries it, and whether that cannot be moved.
    below: Vec<(Floor, bool)>,
}

impl Setting {
    /// How flat a wedge under a ball that cannot be moved counts as flat, as a cosine, if any does.
    fn flat_under(&self, is_fixed: bool) -> Option<f64> {
        if is_fixed { Some(FLAT_UNDER_FIXED) } else { self.flat_under_sleeper }
    }
}

impl Stripe {
    /// Gathers such pairs in the order of their lower balls.
    pub(super) fn gather_wedging(&mut self, setting: &Setting, rests: &[Rest]) {
        let Self { pairs, places_of_constraints, marks, wedging, .. } = self;
        wedging.clear();
        let still = marks.iter().zip(pairs).zip(&*places_of_constraints);
        let still = still.filter(|((marks, _), _)| marks.touch() && marks.has(Marks::STILL));
        wedging.extend(still.filter_map(|((_, pair), &at)| {
            let [upper, lower] = [pair.first, pair.second].map(|body| rests[body as usize].own == 0.0);
            // Nothing wedges in a fixed ball, but what lies on one may face another.
            let flat = setting.flat_under(upper || lower);
            flat.map(|flat| Wedging { lower: pair.second, at, flat })
        }));
        wedging.sort_unstable_by_key(|wedging| (wedging.lower, wedging.at));
    }
}

/// Stops a ball that these constraints, `its`, have others carry, if it lies in a flat wedge of what they are with and of what is
/// `wedging`. Whether it does.
///
/// Not inlined: few balls lie so.
#[inline(never)]
pub(super) fn stop_in_wedge(
    setting: &Setting,
    ball: usize,
    constraints: &[Constraint],
    bodies: &mut [Body],
    its: &[u32],
    wedging: &[Wedging],
    wedge: &mut Wedge,
) -> bool {
    let from = wedging.partition_point(|wedging| (wedging.lower as usize) < ball);
    let above = wedging[from..].iter().take_while(|wedging| wedging.lower as usize == ball);
    wedge.clear();
    for &Wedging { at, flat, .. } in above {
        wedge.add_above(&constraints[at as usize], bodies, flat);
    }
    if wedge.above.is_empty() && !setting.has_fixed {
        return false;
    }
    for &at in its {
        wedge.add_below(constraints, bodies, at);
    }
    wedge.stop(setting, &mut bodies[ball])
}

impl Wedge {
    fn clear(&mut self) {
        self.above.clear();
        self.below.clear();
    }

    /// Adds the upper ball of a constraint, if that cannot be moved.
    fn add_above(&mut self, constraint: &Constraint, bodies: &[Body], flat: f64) {
        let &Constraint { pair, normal, least, .. } = constraint;
        // It may be the other one that cannot be moved.
        if bodies[pair.first as usize].inverse_mass == 0.0 {
            self.above.push((Floor { up: -normal, least: least.min(0.0) }, flat));
        }
    }

    /// Adds the lower ball of the constraint at this place.
    fn add_below(&mut self, constraints: &[Constraint], bodies: &[Body], at: u32) {
        let lower = constraints[at as usize].pair.second;
        let is_firm = bodies[lower as usize].inverse_mass == 0.0;
        self.below.push((Floor::under(constraints, bodies, at), is_firm));
    }

    /// Stops the ball in it, if it is flat: if what does not give way above it faces what carries it, or two of those that carry it
    /// face each other, and one does not give way. Whether it is.
    fn stop(&mut self, setting: &Setting, body: &mut Body) -> bool {
        let Self { above, below } = self;
        if body.inverse_mass == 0.0 {
            return false;
        }
        above.retain(|(floor, flat)| below.iter().any(|(carrying, _)| -carrying.up.dot(floor.up) > *flat));
        let flat_below = || {
            below.iter().enumerate().any(|(number, (one, firm))| {
                let others = below[..number].iter().filter(|(_, other_firm)| firm | other_firm);
                others.into_iter().any(|(other, _)| one.up.dot(other.up) < -FLAT_UNDER_SLEEPER)
            })
        };
        // Where none is fixed, sleepers below give way in time: piles would stand steeper.
        if above.is_empty() && !(setting.has_fixed && flat_below()) {
            return false;
        }
        let floors = above.iter().map(|(floor, _)| *floor).chain(below.iter().map(|(floor, _)| *floor));
        let change = held_between(body.velocity, &floors) - body.velocity;
        // Nothing is passed on to what it presses on.
        body.velocity += change;
        body.free += change;
        true
    }
}

impl Contact {
    /// The balls that may be wedged in across the edges of stripes, in their order, where any are fixed. Others, which never fall
    /// through, are left to sweeps: piles come to rest no sooner if these are stopped, too.
    pub(super) fn wedged_across(&mut self) -> Vec<usize> {
        let mut across = Vec::new();
        let Self { setting, bodies, near: Some(near), .. } = self else { return across };
        if !(near.layout.is_cut() && setting.has_fixed) {
            return across;
        }
        near.link_pairs(bodies.len());
        let Near { layout, stripes, .. } = near;
        let all = Stripes { layout: *layout, list: stripes };
        for (number, stripe) in all.list.iter().enumerate() {
            let start = layout.start(number);
            let has_others = |body: usize| {
                let others = all.of_body(body).filter(|&other| other != number);
                others.into_iter().any(|other| {
                    let own = (body - layout.start(other)) as u32;
                    all.list[other].links.of(own).next().is_some()
                })
            };
            let below = stripe.wedging.iter().map(|wedging| start + wedging.lower as usize);
            across.extend(below.filter(|&body| has_others(body)));
            if layout.layer(number) != Layer::Own {
                // Two of those that carry a ball may face each other.
                let uppers = stripe.carrying.iter().map(|&at| stripe.constraints[at as usize].pair.first);
                across.extend(uppers.map(|upper| start + upper as usize));
            }
        }
        across.sort_unstable();
        across.dedup();
        across
    }

    /// Stops these, if they are, one after the other.
    pub(super) fn stop_wedged(&mut self, across: &[usize]) {
        let Self { setting, bodies, rests, near: Some(near), .. } = self else { return };
        let all = near.all();
        let mut wedge = Wedge::default();
        for &body in across {
            wedge.clear();
            for number in all.of_body(body) {
                let (stripe, start) = (&all.list[number], all.layout.start(number));
                let own = (body - start) as u32;
                for at in stripe.links.of(own).filter(|&at| stripe.marks[at].touch()) {
                    let (pair, place) = (stripe.pairs[at], stripe.places_of_constraints[at]);
                    let is_fixed = rests[start + pair.first as usize].own == 0.0;
                    if pair.first == own {
                        wedge.add_below(&stripe.constraints, &bodies[start..], place);
                    } else if let Some(flat) = setting.flat_under(is_fixed) {
                        wedge.add_above(&stripe.constraints[place as usize], &bodies[start..], flat);
                    }
                }
            }
            wedge.stop(setting, &mut bodies[body]);
        }
    }
}

/// The velocity that is nearest to this one of those that sink into no floor. That is a projection onto a convex set, of which one or
/// two floors bound what is nearest. A velocity of 0 sinks into none, so it only ever becomes less.
fn held_between(velocity: DVec2, floors: &(impl Iterator<Item = Floor> + Clone)) -> DVec2 {
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
