//! How pairs lie at a substep's beginning: along which direction they press, how fast they have to part, and which are
//! held apart at all.
//!
//! Most of a pile presses as it did. What its places alone tell is found for all such pairs at once, before any velocity
//! is changed: a processor then works on many of them at a time, and what each gives waits for no root and no quotient.

use glam::DVec2;

use super::super::impulse::COINCIDENT_NORMAL;
use super::holds::Hold;
use super::impacts::{Fate, Shift};
use super::meeting::COINCIDENT;
use super::stripes::Stripe;
use super::support::{MENDED, Share, YIELDING, give, press, two};
use super::{Body, Setting};

/// Pairs farther apart than this part of their radii, and not closing in, are left out of a substep.
const APART: f64 = 0.01;
/// The part of what was given along earlier directions that is let go in a substep.
const LOOSENED: f64 = 0.02;
/// A direction that turns by more than this in a substep, rad, belongs to another contact than the one before.
const STEADY: f64 = 0.03;

/// What turning a hold changes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turned {
    /// By how much that changes what it gives the first ball, mass·px/s.
    more: DVec2,
    /// The impulse that it had before, mass·px/s.
    carried: f64,
}

impl Stripe {
    /// Looks at all pairs anew, and holds those apart that are close.
    pub(super) fn take_up_all(&mut self, setting: &Setting, share: &mut Share<'_>) {
        self.gather();
        self.follow_all(setting, share);
        let Share { bodies, fates, rests } = share;
        let Self { pairs, holds, held, live, touching, turned, disturbed, .. } = self;
        let mut kept = 0;
        for (place, &turned) in turned.iter().enumerate() {
            let at = touching[place] as usize;
            let (pair, hold) = (pairs[at], &mut holds[at]);
            let (first, second) = two(bodies, pair);
            let carried = turned.map_or(hold.impulse, |turned| turned.carried);
            let near = if let Some(Turned { more, .. }) = turned {
                give(more, first, second);
                press(hold, first, second, YIELDING);
                true
            } else {
                take_up(setting, hold, [first, second], shift_of(fates, pair.first, pair.second))
            };
            touching[kept] = at as u32;
            kept += usize::from(near);
            live[at] = near;
            let holds = near && (hold.met || hold.impulse > 0.0);
            // What sleeps is seen at the body, which is at hand.
            let still = first.inverse_mass == 0.0 || second.inverse_mass == 0.0;
            if still && (held[at] || holds) {
                for body in [pair.first, pair.second] {
                    if bodies[body as usize].inverse_mass == 0.0 && rests[body as usize].asleep {
                        disturbed.push((body, if holds { 0.0 } else { carried }));
                    }
                }
            }
            held[at] = holds;
            hold.met = false;
        }
        touching.truncate(kept);
    }

    /// Gathers the pairs that may have to be held apart.
    #[expect(clippy::needless_bitwise_bool, reason = "a branch there cannot be foreseen by a processor")]
    fn gather(&mut self) {
        let Self { pairs, live, idle, close, touching, .. } = self;
        touching.resize(pairs.len(), 0);
        let mut count = 0;
        for (at, ((&close, &live), &idle)) in (0..).zip(close.iter().zip(&*live).zip(&*idle)) {
            touching[count] = at;
            count += usize::from((close | live) & !idle);
        }
        touching.truncate(count);
    }

    /// Turns the holds of all pairs that press and were hit by nothing, and finds how fast they have to part: what
    /// [`take_up`] comes to for them, but for what it gives their balls.
    fn follow_all(&mut self, setting: &Setting, Share { bodies, fates, .. }: &Share<'_>) {
        let Self { pairs, holds, touching, distances, turned, .. } = self;
        distances.clear();
        turned.clear();
        if setting.kick == DVec2::ZERO {
            turned.resize(touching.len(), None);
            return;
        }
        distances.extend(touching.iter().map(|&at| {
            let pair = pairs[at as usize];
            bodies[pair.first as usize].position.distance_squared(bodies[pair.second as usize].position)
        }));
        // A loop by itself takes several roots at once, and none of them waits for another.
        for distance in &mut *distances {
            *distance = distance.sqrt();
        }
        turned.extend(touching.iter().zip(&*distances).map(|(&at, &distance)| {
            let (pair, hold) = (pairs[at as usize], &mut holds[at as usize]);
            let shift = shift_of(fates, pair.first, pair.second);
            if hold.impulse == 0.0 || hold.met || shift != Shift::None {
                return None;
            }
            let (first, second) = (&bodies[pair.first as usize], &bodies[pair.second as usize]);
            let reach = first.radius + second.radius;
            // Without a branch: which pairs overlap cannot be foreseen by a processor.
            let gap = distance - reach;
            let way = if gap > 0.0 { -gap } else { MENDED * -gap };
            hold.least = setting.least_parting(way, reach);
            let carried = hold.impulse;
            Some(Turned { more: hold.turn(direction(first.position - second.position, distance)), carried })
        }));
    }
}

impl Setting {
    /// How fast two balls, of radii with this sum, have to part to go so far in a substep, px: px/s. No faster than
    /// overlaps are taken away.
    #[inline]
    fn least_parting(&self, way: f64, reach: f64) -> f64 {
        (way / self.substep).min(self.mending * reach)
    }
}

/// How two balls are shifted by impacts.
#[inline]
fn shift_of(fates: &[Fate], first: u32, second: u32) -> Shift {
    fates[first as usize].shift.max(fates[second as usize].shift)
}

/// Looks at a pair anew: its direction and distance. Whether it is close enough to be held apart; then it is, once.
/// Where one of them is shifted by an impact, its place says nothing of overlaps.
///
/// Not inlined: few of a pile need it, and it would take the registers of the others.
#[inline(never)]
fn take_up(setting: &Setting, hold: &mut Hold, [first, second]: [&mut Body; 2], shift: Shift) -> bool {
    if shift == Shift::Far {
        // Where a fast ball was hit it comes from far away: what it was near to, it has met already.
        if hold.impulse > 0.0 {
            let_go(hold, first, second);
        }
        return false;
    }
    let offset = first.position - second.position;
    let squared = offset.length_squared();
    let reach = first.radius + second.radius;
    let end = offset + (first.velocity - second.velocity) * setting.substep;
    let near = (1.0 + 2.0 * APART) * reach * reach;
    if hold.impulse == 0.0 && squared.min(end.length_squared()) > near {
        return false;
    }
    let distance = squared.sqrt();
    let gap = distance - reach;
    let end_apart = end.length_squared() > reach * reach;
    // One that was hit stands where it would have come from: what they part by themselves is no overlap.
    let elsewhere = shift == Shift::Some || hold.met;
    let apart = gap > 0.0 || (elsewhere && end_apart);
    if apart && end_apart && hold.impulse == 0.0 {
        // They pass each other as they go now, and circles curve away from the tangent where they are: one where they
        // will be brakes nothing, unless others turn them.
        let normal = end.normalize();
        give(hold.turn(normal), first, second);
        hold.least = (reach - offset.dot(normal)) / setting.substep;
        return true;
    }
    let normal = direction(offset, distance);
    give(hold.turn(normal), first, second);
    let way = if apart {
        -gap.max(0.0)
    } else {
        let deep = if setting.kick == DVec2::ZERO || elsewhere {
            (reach - end.length()).clamp(0.0, -gap)
        } else {
            -gap
        };
        if setting.kick == DVec2::ZERO {
            // Nothing presses them together again: they are moved, and need no velocity.
            let moved = normal * (MENDED * deep * hold.mass);
            first.position += moved * first.inverse_mass;
            second.position -= moved * second.inverse_mass;
            0.0
        } else {
            MENDED * deep
        }
    };
    hold.least = setting.least_parting(way, reach);
    press(hold, first, second, YIELDING);
    true
}

/// The direction of an offset of this length.
#[inline]
fn direction(offset: DVec2, length: f64) -> DVec2 {
    if length < COINCIDENT { COINCIDENT_NORMAL } else { offset / length }
}

impl Hold {
    /// Turns it into another direction. By how much that changes what it gives the first ball, mass·px/s.
    ///
    /// What was given along the old one turns into the new one within a few substeps, as if the balls gripped each
    /// other a little: that works against the motion that turns it, and lets piles come to rest. Where the direction
    /// turns by more in a substep, or nothing presses any more, nothing is left of it.
    #[inline]
    fn turn(&mut self, normal: DVec2) -> DVec2 {
        let given = self.normal * self.impulse + self.grip;
        let steady = (normal - self.normal).length_squared() < STEADY * STEADY;
        if steady && self.impulse > 0.0 {
            self.grip = (given - normal * self.impulse) * (1.0 - LOOSENED);
        } else {
            (self.impulse, self.grip) = (0.0, DVec2::ZERO);
        }
        self.normal = normal;
        normal * self.impulse + self.grip - given
    }
}

/// Forgets how two balls held each other. What that has given them stays, as if it had been an impact.
pub(super) fn let_go(hold: &mut Hold, first: &mut Body, second: &mut Body) {
    let given = hold.normal * hold.impulse + hold.grip;
    first.free += given * first.inverse_mass;
    second.free -= given * second.inverse_mass;
    (hold.impulse, hold.grip) = (0.0, DVec2::ZERO);
}
