//! How pairs lie at a substep's beginning: along which direction they press, how fast they have to part, and which are
//! held apart at all.
//!
//! Most of a pile presses as it did. How far apart its balls are is found for all pairs at once, before any velocity is
//! changed: a processor then works on many of them at a time, and what each gives waits for no root.

use glam::DVec2;

use super::super::impulse::COINCIDENT_NORMAL;
use super::super::lesser::lesser;
use super::holds::Hold;
use super::impacts::{Fate, Shift};
use super::meeting::COINCIDENT;
use super::stripes::Stripe;
use super::support::{MENDED, Share, YIELDING, dealt, give, press, two};
use super::{Body, Setting};

/// Pairs farther apart than this part of their radii, and not closing in, are left out of a substep.
const APART: f64 = 0.01;
/// The part of what was given along earlier directions that is let go in a substep.
const LOOSENED: f64 = 0.02;
/// A direction that turns by more than this in a substep, rad, belongs to another contact than the one before.
const STEADY: f64 = 0.03;

impl Stripe {
    /// Looks at all pairs anew, and holds those apart that are close.
    pub(super) fn take_up_all(&mut self, setting: &Setting, share: &mut Share<'_>) {
        self.gather_near();
        self.see_all(setting, share.bodies);
        self.hold_all(setting, share);
        self.gather_touching();
    }

    /// Gathers the pairs that may have to be held apart.
    #[expect(clippy::needless_bitwise_bool, reason = "a branch there cannot be foreseen by a processor")]
    fn gather_near(&mut self) {
        let Self { marks, touching, .. } = self;
        touching.resize(marks.len(), 0);
        let mut count = 0;
        for (at, mark) in (0..).zip(marks) {
            touching[count] = at;
            count += usize::from((mark.close | mark.live) & !mark.idle);
        }
        touching.truncate(count);
    }

    /// Gathers those that are held apart, and where the pairs of each upper ball begin.
    #[expect(clippy::needless_bitwise_bool, reason = "as above")]
    fn gather_touching(&mut self) {
        let Self { pairs, marks, touching, uppers, .. } = self;
        touching.resize(marks.len(), 0);
        uppers.resize(marks.len() + 1, 0);
        let (mut count, mut balls, mut last) = (0, 0, u32::MAX);
        for (at, (pair, mark)) in (0..).zip(pairs.iter().zip(marks)) {
            let touches = mark.live & !mark.idle;
            touching[count] = at;
            count += usize::from(touches);
            balls += usize::from(touches & (pair.first != last));
            last = if touches { pair.first } else { last };
            uppers[balls] = count as u32;
        }
        touching.truncate(count);
        uppers.truncate(balls + 1);
    }

    /// Sees how all gathered pairs lie, unless what is done with one moves others.
    fn see_all(&mut self, setting: &Setting, bodies: &[Body]) {
        let Self { pairs, touching, ways, distances, .. } = self;
        ways.clear();
        distances.clear();
        if setting.kick == DVec2::ZERO {
            return;
        }
        let pairs = &pairs[..];
        ways.extend(touching.iter().map(|&at| {
            let pair = pairs[at as usize];
            bodies[pair.first as usize].position - bodies[pair.second as usize].position
        }));
        // Roots by themselves: a processor takes several at once then, and nothing waits for them.
        distances.extend(ways.iter().map(|way| way.length_squared().sqrt()));
    }

    /// Holds all gathered pairs apart that are close.
    fn hold_all(&mut self, setting: &Setting, Share { bodies, fates, rests }: &mut Share<'_>) {
        let Self { pairs, holds, marks, touching, ways, distances, disturbed, .. } = self;
        let (pairs, touching) = (&pairs[..], &touching[..]);
        let (ways, distances) = (&ways[..], &distances[..ways.len()]);
        let (holds, marks) = (&mut holds[..pairs.len()], &mut marks[..pairs.len()]);
        for place in dealt(touching.len()) {
            let at = touching[place] as usize;
            let (pair, hold, mark) = (pairs[at], &mut holds[at], &mut marks[at]);
            let (first, second) = two(bodies, pair);
            let carried = hold.impulse;
            let shift = shift_of(fates, pair.first, pair.second);
            // Most of a pile presses as it did.
            let near = match ways.get(place) {
                Some(&way) if carried > 0.0 && shift == Shift::None && !hold.met => {
                    follow(setting, hold, first, second, (way, distances[place]));
                    true
                }
                _ => take_up(setting, hold, first, second, shift),
            };
            let holds = near && (hold.met || hold.impulse > 0.0);
            // What sleeps is seen at the body, which is at hand.
            let still = first.inverse_mass == 0.0 || second.inverse_mass == 0.0;
            if still && (mark.held || holds) {
                for body in [pair.first, pair.second] {
                    if bodies[body as usize].inverse_mass == 0.0 && rests[body as usize].asleep {
                        disturbed.push((body, if holds { 0.0 } else { carried }));
                    }
                }
            }
            (mark.live, mark.held) = (near, holds);
            hold.met = false;
        }
    }
}

/// Turns the hold of a pair that presses, and was hit by nothing, and holds it apart: what [`take_up`] comes to for it.
/// Where the first is, seen from the second, and how far away, is known.
#[inline]
fn follow(
    setting: &Setting,
    hold: &mut Hold,
    first: &mut Body,
    second: &mut Body,
    (offset, distance): (DVec2, f64),
) {
    let reach = first.radius + second.radius;
    // Without a branch: which pairs overlap cannot be foreseen by a processor.
    let out = reach - distance;
    let mut turned = *hold;
    turned.least = setting.least_parting(lesser(MENDED * out, out), reach);
    give(turned.turn(direction(offset, distance)), first, second);
    press(&mut turned, first, second, YIELDING);
    *hold = turned;
}

impl Setting {
    /// How fast two balls, of radii with this sum, have to part to go so far in a substep, px: px/s. No faster than
    /// overlaps are taken away.
    #[inline]
    fn least_parting(&self, way: f64, reach: f64) -> f64 {
        lesser(self.mending * reach, way / self.substep)
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
fn take_up(setting: &Setting, hold: &mut Hold, first: &mut Body, second: &mut Body, shift: Shift) -> bool {
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
