//! What wakes balls that sleep.
//!
//! A ball wakes where something hits it firmly, or where what holds it and what lies on it no longer balance its weight: then it moves,
//! and those that lean on it wake in turn, as far as the change is felt. So there are no islands to keep, and a ball that lands on a
//! large pile wakes what it shakes. One that finds no rest among sleepers wakes them, so that they make room.

use glam::DVec2;

use super::abreast::LEVEL;
use super::constraints::Given;
use super::sleep::Rest;
use super::stripes::{Holder, Stripes};
use super::support::{solve, two};
use super::thrown::THROWN;
use super::{Body, Contact, Setting};

/// A ball that has had no rest when this was looked at so often wakes those that hold it.
const RESTLESS: u32 = 8;
/// A ball at rest wakes where what acts on it differs from balance by more than this part of its weight: one of two that carried
/// it may have gone away little by little ...
const WEIGHT: f64 = 0.15;
/// ... and this part of all that presses on it more than its weight does.
const PRESS: f64 = 0.35;
/// What acts on a ball that wakes goes on acting unless it would throw it, or presses on it with more than so many kicks of
/// gravity: what little of more turns aside would shoot it away.
const SQUEEZED: f64 = 1e4;
/// A ball wakes where it loses a support, or a load, of more than this part of its weight.
const LOST: f64 = 0.1;
/// Walls alone carry a ball that no others press up or down by more than this part of its weight.
const CARRIED: f64 = 0.1;

impl Contact {
    /// Frees a ball that is moved from outside: it wakes, and what held it holds it no longer.
    pub(super) fn free_by_hand(&mut self, at: usize) {
        self.all_asleep = false;
        let Self { setting, bodies, rests, near: Some(near), .. } = self else { return };
        if at >= near.homes.len() {
            // It was added after pairs were searched: nothing holds it yet.
            return;
        }
        near.link_pairs(bodies.len());
        let stripes = &mut near.all();
        if rests[at].asleep {
            let given = stripes.given(at, rests[at].counted);
            wake(at, &given, setting.kick, bodies, rests, stripes);
        }
        stripes.let_go_of_one(at, bodies, setting.kick);
        self.wake_unbalanced();
    }

    /// Wakes those that hold a ball which has not come to rest for long: between balls that do not give way
    /// one that is squeezed may overlap them, or rattle, for ever.
    pub(super) fn wake_around_restless(&mut self) {
        let Self { setting, bodies, rests, near: Some(near), .. } = self else { return };
        let stripes = &mut near.all();
        for at in 0..rests.len() {
            if rests[at].restless < RESTLESS {
                continue;
            }
            rests[at].restless = 0;
            for other in stripes.holders(at).map(|holder| holder.other).collect::<Vec<_>>() {
                wake_if_asleep(other, setting.kick, bodies, rests, stripes);
            }
        }
        self.wake_unbalanced();
    }

    /// Wakes those at the border of sleep that are not balanced any more, and those that this disturbs.
    pub(super) fn wake_unbalanced(&mut self) {
        let Self { setting, bodies, rests, near: Some(near), .. } = self else { return };
        if near.stripes.iter().all(|stripe| stripe.disturbed.is_empty()) {
            return;
        }
        near.link_pairs(bodies.len());
        let kick = setting.kick;
        let layout = near.layout;
        let stripes = &mut near.all();
        while stripes.list.iter().any(|stripe| !stripe.disturbed.is_empty()) {
            for number in 0..layout.len() {
                while let Some((body, lost)) = stripes.list[number].disturbed.pop() {
                    let at = layout.start(number) + body as usize;
                    // What lost a support moves, however hard the others press.
                    let lost_much = lost * rests[at].counted > LOST * kick.length();
                    if !rests[at].asleep {
                        if lost_much && stripes.falls(at, rests[at].counted, kick) {
                            stripes.let_go_of_one(at, bodies, kick);
                        }
                        continue;
                    }
                    let given = stripes.given(at, rests[at].counted);
                    let pressed = if lost_much { 0.0 } else { given.pressed };
                    let (net, kicks) = (given.velocity + kick, kick.length_squared());
                    let slides = net.dot(kick).abs() < CARRIED * kicks
                        && stripes.is_carried_by_walls_alone(at, &rests[at], kick);
                    // What pushes it along the walls presses on it, too, but balances nothing.
                    let pressed = if slides { pressed - net.length() } else { pressed };
                    if net.length() > tolerance(kick, pressed) {
                        let goes_on = wake_after_substep(at, &given, kick, bodies, rests, stripes);
                        if slides && goes_on {
                            stripes.give_way(at, net, bodies);
                        }
                    }
                }
            }
        }
    }
}

/// By how much what acts on a ball at rest may differ from balance, as a change of its velocity in a substep, px/s, where so much
/// presses on it. What is to fall asleep is in balance up to that, too: else it would wake of what it fell asleep in.
pub(super) fn tolerance(kick: DVec2, pressed: f64) -> f64 {
    let weight = kick.length();
    WEIGHT * weight + PRESS * (pressed - weight).max(0.0)
}

/// Wakes a ball, once a substep is over, if it sleeps. Its pairs must be linked.
pub(super) fn wake_if_asleep(
    at: usize,
    kick: DVec2,
    bodies: &mut [Body],
    rests: &mut [Rest],
    stripes: &mut Stripes<'_>,
) {
    if rests[at].asleep {
        let given = stripes.given(at, rests[at].counted);
        wake_after_substep(at, &given, kick, bodies, rests, stripes);
    }
}

/// Wakes a ball, at rest, once a substep is over, as if it had been held like this in it. Whether that goes on.
fn wake_after_substep(
    at: usize,
    given: &Given,
    kick: DVec2,
    bodies: &mut [Body],
    rests: &mut [Rest],
    stripes: &mut Stripes<'_>,
) -> bool {
    let goes_on = wake(at, given, kick, bodies, rests, stripes);
    bodies[at].free = if goes_on { -given.velocity } else { DVec2::ZERO };
    goes_on
}

/// Wakes a ball, at rest. Whether what it is `given` goes on: not where it would be shot away. Its pairs must be linked.
fn wake(
    at: usize,
    given: &Given,
    kick: DVec2,
    bodies: &mut [Body],
    rests: &mut [Rest],
    stripes: &mut Stripes<'_>,
) -> bool {
    rests[at].begin_anew(bodies[at].position);
    bodies[at].inverse_mass = rests[at].counted;
    stripes.weigh_pairs_of(at, bodies);
    let (moves, pressed) = ((given.velocity + kick).length(), given.pressed);
    // What falls freely carries nothing any more: what lay on it falls with it.
    let falls = stripes.falls(at, rests[at].counted, kick);
    let goes_on = !falls && moves < THROWN * kick.length() && pressed < SQUEEZED * kick.length();
    if !goes_on {
        stripes.let_go_of_one(at, bodies, kick);
    }
    goes_on
}

/// Wakes a ball that something hits firmly, at this part of a substep: until then it stood still.
pub(super) fn wake_by_hit(
    at: usize,
    part: f64,
    setting: &Setting,
    bodies: &mut [Body],
    rests: &mut [Rest],
    stripes: &mut Stripes<'_>,
) {
    let kick = setting.kick;
    let given = stripes.given(at, rests[at].counted);
    let goes_on = wake(at, &given, kick, bodies, rests, stripes);
    let given = if goes_on { given.velocity } else { DVec2::ZERO };
    let (body, change) = (&mut bodies[at], kick + given);
    body.position += 0.5 * change * part * part * setting.substep;
    body.velocity = change * (0.5 - part);
    body.free = body.velocity - given;
}

impl Stripes<'_> {
    /// Whether next to nothing holds a ball of this inverse mass up, against its weight and all that presses it down: it falls, and
    /// carries nothing. Its pairs must be linked.
    fn falls(&self, body: usize, inverse_mass: f64, kick: DVec2) -> bool {
        let (number, own) = self.layout.place_of(body);
        let stripe = &self.list[number];
        let by_walls = stripe.place_beside(own).map(|at| stripe.beside[at].push.dot(kick));
        let by_others =
            self.holders(body).map(|holder| holder.impulse * inverse_mass * holder.normal.dot(kick));
        let (mut up, mut down) = (0.0, kick.length_squared());
        for push in by_others.chain(by_walls) {
            up -= push.min(0.0);
            down += push.max(0.0);
        }
        up < LOST * down
    }

    /// Whether nothing but walls carries a ball, and it carries nothing: it is free to slide. Its pairs must be linked.
    pub(super) fn is_carried_by_walls_alone(&self, body: usize, rest: &Rest, kick: DVec2) -> bool {
        let weight = kick.length();
        let steep = |holder: &Holder| (holder.normal.dot(kick).abs() - LEVEL * weight).max(0.0);
        let pressed: f64 = self.holders(body).map(|holder| holder.impulse * steep(&holder)).sum();
        pressed * rest.counted < CARRIED * weight * weight
    }

    /// Has a ball that was asleep in this substep, and stopped what pushed it as if it were fixed, move as if it had not been: by what
    /// it was given, `net`, px/s, of which it gives back what is too much. Else a row at rest would turn back what comes slowly. Its
    /// pairs must be linked.
    fn give_way(&mut self, body: usize, net: DVec2, bodies: &mut [Body]) {
        bodies[body].velocity += net;
        bodies[body].free += net;
        self.each_pair_of(body, |stripe, at, start| {
            let Some(constraint) = stripe.constraint_mut(at).filter(|constraint| constraint.impulse > 0.0)
            else {
                return;
            };
            let pair = constraint.pair;
            let (first, second) = two(&mut bodies[start..], pair);
            let change = solve(constraint, first, second, 1.0);
            if change < 0.0 {
                // One that sleeps, too, has lost what this gave it.
                stripe.disturbed.push((pair.other((body - start) as u32), -change));
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::ball::Ball;
    use super::super::Tally;
    use super::super::testing::{TUNING, boxed_world};
    use super::*;

    #[test]
    fn what_wakes_and_is_let_go_of_throws_none_of_those_that_were_held_against_it() {
        // A ball that sleeps between two awake ones, and what presses both on it and on the walls, in kicks of gravity.
        for squeezed in [2.0, 200.0, 2e4] {
            let balls = [10.0, 30.0, 50.0].map(|x| Ball::new(DVec2::new(x, 90.0), 10.0).unwrap());
            let mut contact = Contact::new(&boxed_world(DVec2::new(60.0, 100.0)), &balls, TUNING);
            while contact.steps < 12 {
                contact.step(&mut Tally::default());
            }
            let Contact { setting, bodies, rests, near: Some(near), ids, .. } = &mut contact else {
                panic!()
            };
            let kick = setting.kick;
            near.link_pairs(3);
            let sleeper = ids.iter().position(|&id| id == 1).unwrap();
            let push = squeezed * kick.length();
            for constraint in &mut near.stripes[0].constraints {
                let (first, second) = (constraint.pair.first as usize, constraint.pair.second as usize);
                constraint.normal = (bodies[first].position - bodies[second].position).normalize();
                (constraint.impulse, constraint.grip) = (push / bodies[first].inverse_mass, DVec2::ZERO);
            }
            // Between the walls each is held in balance: by both sides, and from below.
            for (body, rest) in bodies.iter_mut().zip(&mut *rests) {
                (body.velocity, body.free) = (DVec2::ZERO, kick);
                rest.asleep = false;
            }
            rests[sleeper].asleep = true;
            (bodies[sleeper].inverse_mass, bodies[sleeper].free) = (0.0, DVec2::ZERO);
            near.weigh_all(bodies);
            wake_if_asleep(sleeper, kick, bodies, rests, &mut near.all());
            contact.wake_unbalanced();
            for body in &contact.bodies {
                let thrown = (body.velocity - body.free).length();
                assert!(thrown <= THROWN * kick.length(), "{squeezed}: {thrown}");
            }
        }
    }

    #[test]
    fn what_is_hit_asleep_without_a_support_falls_from_then_on() {
        let ball = Ball::new(DVec2::new(50.0, 50.0), 10.0).unwrap();
        for part in [0.0, 0.3, 1.0] {
            let mut contact = Contact::new(&boxed_world(DVec2::splat(100.0)), &[ball], TUNING);
            contact.step(&mut Tally::default());
            let Contact { setting, bodies, rests, near: Some(near), .. } = &mut contact else { panic!() };
            near.link_pairs(1);
            rests[0].asleep = true;
            (bodies[0].inverse_mass, bodies[0].velocity) = (0.0, DVec2::ZERO);
            let place = bodies[0].position;
            wake_by_hit(0, part, setting, bodies, rests, &mut near.all());
            let left = (1.0 - part) * setting.substep;
            let fallen = bodies[0].end(setting.substep) - place;
            assert!(fallen.abs_diff_eq(0.5 * setting.gravity * left * left, 1e-12), "{part}: {fallen}");
            // Through the next substep.
            let velocity = bodies[0].velocity + bodies[0].change(setting.kick);
            let law = setting.gravity * (left + 0.5 * setting.substep);
            assert!(velocity.abs_diff_eq(law, 1e-12), "{part}: {velocity}");
        }
    }
}
