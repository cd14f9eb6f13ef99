//! How pairs lie at a substep's beginning: along which direction they press, how fast they have to part, and which are
//! held apart at all.
//!
//! Most of a pile presses as it did. How far apart its balls are is found for all pairs at once, before any velocity is
//! changed: a processor then works on many of them at a time, and what each gives waits for no root.

use std::mem::take;

use glam::DVec2;

use super::super::impulse::COINCIDENT_NORMAL;
use super::super::lesser::lesser;
use super::abreast::leaning;
use super::amount::Amount;
use super::constraints::{Constraint, Marks, Pair};
use super::fates::{Fate, Shift};
use super::meeting::COINCIDENT;
use super::sleep::Rest;
use super::stripes::Stripe;
use super::support::{give, solve, two};
use super::sweep::Share;
use super::unlike::Unlike;
use super::{Body, Setting};

/// Pairs farther apart than this part of their radii, and not closing in, are left out of a substep.
const APART: f64 = 0.01;
/// The part of what was given along earlier directions that is let go in a substep.
const LOOSENED: f64 = 0.05;
/// A direction that turns by more than this in a substep, rad, belongs to another contact than the one before.
const STEADY: f64 = 0.03;

impl Stripe {
    /// Looks at all pairs anew, and holds those apart that are close.
    pub(super) fn prepare_all(&mut self, setting: &Setting, share: &mut Share<'_>) {
        if !self.close_for.stands(&self.marks, Marks::CLOSE | Marks::LIVE | Marks::IDLE, (0, 0)) {
            self.gather_close();
            self.dealt.clear();
            deal(&self.close, &mut self.dealt);
        }
        self.see_all(setting, share.bodies);
        self.hold_all(setting, share);
        // Whether, and as what, pairs are held apart.
        let still = Marks::STILL | Marks::IDLE;
        let touching = Marks::LIVE | still | Marks::UNLIKE_IN_SIZE | Marks::UNLIKE_IN_DENSITY;
        let counts = (self.constraints.len(), leaning(&self.beside, setting.kick).count());
        if !self.carrying_for.stands(&self.marks, touching, counts) {
            self.gather_touching();
            self.gather_wedging(setting, share.rests);
            self.deal_touching();
            self.keep_carrying(setting, share.rests);
        }
    }

    /// Gathers the pairs that may have to be held apart.
    fn gather_close(&mut self) {
        let Self { marks, close, .. } = self;
        close.resize(marks.len(), 0);
        let places = &mut close[..];
        let mut count = 0;
        for (at, marks) in (0..).zip(marks) {
            places[count] = at;
            count += usize::from(marks.has(Marks::CLOSE | Marks::LIVE) & !marks.has(Marks::IDLE));
        }
        close.truncate(count);
    }

    /// Gathers the constraints of those that are held apart, those of each upper ball side by side.
    fn gather_touching(&mut self) {
        let Self { places_of_constraints, marks, carrying, .. } = self;
        carrying.resize(marks.len(), 0);
        let places = &mut carrying[..];
        let mut count = 0;
        for (marks, &place) in marks.iter().zip(&*places_of_constraints) {
            places[count] = place;
            count += usize::from(marks.touch());
        }
        carrying.truncate(count);
    }

    /// Deals them out, kind by kind of how unlike their balls are.
    fn deal_touching(&mut self) {
        let Self { places_of_constraints, marks, carrying, touching, ends, .. } = self;
        touching.clear();
        if !marks.iter().any(|marks| marks.unlike().differs()) {
            deal(carrying, touching);
            *ends = [touching.len(); Unlike::KINDS];
            return;
        }
        for (kind, end) in Unlike::ALL.into_iter().zip(ends) {
            let pairs = marks.iter().zip(&*places_of_constraints);
            let of_kind = pairs.filter(|(marks, _)| marks.touch() && marks.unlike() == kind);
            let places: Vec<u32> = of_kind.map(|(_, &place)| place).collect();
            deal(&places, touching);
            *end = touching.len();
        }
    }

    /// Sees how all dealt pairs lie, unless what is done with one moves others.
    fn see_all(&mut self, setting: &Setting, bodies: &[Body]) {
        let Self { pairs, dealt, ways, distances, .. } = self;
        ways.clear();
        distances.clear();
        if setting.kick == DVec2::ZERO {
            return;
        }
        let pairs = &pairs[..];
        ways.extend(dealt.iter().map(|&at| {
            let pair = pairs[at as usize];
            bodies[pair.first as usize].position - bodies[pair.second as usize].position
        }));
        // Roots by themselves: a processor takes several at once then, and nothing waits for them.
        distances.extend(ways.iter().map(|way| way.length_squared().sqrt()));
    }

    /// Holds all dealt pairs apart that are close.
    fn hold_all(&mut self, setting: &Setting, share: &mut Share<'_>) {
        self.shifted = share.fates.iter().filter(|fate| fate.shift != Shift::None).count();
        let calm = self.shifted == 0;
        let (dealt, ways) = (take(&mut self.dealt), take(&mut self.ways));
        let distances = take(&mut self.distances);
        if setting.kick == DVec2::ZERO {
            for &at in &dealt {
                self.prepare_anew(at as usize, setting, share);
            }
        }
        // Most of a pile presses as it did, nothing has hit it, and all of it can be moved.
        let unlike = Marks::MET | Marks::STILL;
        for ((&at, &way), &distance) in dealt.iter().zip(&ways).zip(&distances) {
            let at = at as usize;
            let (marks, place) = (&mut self.marks[at], self.places_of_constraints[at]);
            if let Some(constraint) = self.constraints.get_mut(place as usize)
                && constraint.impulse > 0.0
                && distance >= COINCIDENT
                && !marks.has(unlike)
                && (calm || shift_of(share.fates, constraint.pair) == Shift::None)
            {
                let (first, second) = two(share.bodies, constraint.pair);
                follow(setting, constraint, first, second, (way, distance), marks.unlike());
                marks.set(Marks::LIVE, true);
                marks.set(Marks::HELD, constraint.impulse > 0.0);
            } else {
                self.prepare_anew(at, setting, share);
            }
        }
        (self.dealt, self.ways, self.distances) = (dealt, ways, distances);
    }

    /// Looks at a pair anew, and holds it apart where it is close.
    ///
    /// Not inlined: few of a pile need it, and it would take the registers of the others.
    #[inline(never)]
    fn prepare_anew(&mut self, at: usize, setting: &Setting, share: &mut Share<'_>) {
        let Self { pairs, constraints, places_of_constraints, marks, disturbed, .. } = self;
        let Share { bodies, fates, rests, .. } = share;
        let (pair, marks, place) = (pairs[at], &mut marks[at], &mut places_of_constraints[at]);
        let (first, second) = two(bodies, pair);
        let met = marks.has(Marks::MET);
        let known = constraints.get(*place as usize).copied();
        let mut constraint = known
            .unwrap_or_else(|| Constraint::none(pair, (first.inverse_mass + second.inverse_mass).recip()));
        let carried = constraint.impulse;
        let on_fixed = on_fixed(rests, pair);
        let grips = setting.grips(on_fixed);
        // What any hit shifts a ball by may be more than there is room between fixed ones.
        let moved =
            met || on_fixed && [pair.first, pair.second].iter().any(|&at| fates[at as usize].hits > 0);
        let how = (grips, marks.unlike());
        let near = prepare(setting, &mut constraint, (first, second), (shift_of(fates, pair), moved), how);
        if known.is_some() {
            constraints[*place as usize] = constraint;
        } else if near {
            *place = constraints.len() as u32;
            constraints.push(constraint);
        }
        // Where all balls meet without loss, none that only met rests on the other: it may meet it again, turned back by a third.
        let held = near && (met && setting.least_restitution < 1.0 || constraint.impulse > 0.0);
        if marks.has(Marks::STILL) && (marks.has(Marks::HELD) || held) {
            for body in [pair.first, pair.second] {
                if bodies[body as usize].inverse_mass == 0.0 && rests[body as usize].asleep {
                    disturbed.push((body, if held { 0.0 } else { carried }));
                }
            }
        }
        marks.set(Marks::LIVE, near);
        marks.set(Marks::HELD, held);
        marks.set(Marks::MET, false);
    }
}

/// Pairs are looked at in hands of so many, in this order: each five places after the one before, around the hand.
const HAND: [usize; 16] = [0, 5, 10, 15, 4, 9, 14, 3, 8, 13, 2, 7, 12, 1, 6, 11];

/// Deals a list of pairs out, behind those that are dealt: in an order in which those that follow each other seldom have a ball in
/// common, as those of an upper ball do. A processor works on a few of them at a time then, where else each waits for the last.
fn deal(pairs: &[u32], dealt: &mut Vec<u32>) {
    let (hands, others) = pairs.as_chunks();
    dealt.extend(hands.iter().flat_map(|hand: &[u32; HAND.len()]| HAND.map(|place| hand[place])));
    dealt.extend_from_slice(others);
}

/// What a list of pairs was gathered for. A pile is much the same from one substep to the next: most lists stand.
#[derive(Debug, Clone, Default)]
pub(super) struct Followed {
    marks: Vec<Marks>,
    /// How many constraints there were, and how many balls that leaned on a wall.
    counts: (usize, usize),
}

impl Followed {
    /// Notes that the list is empty, as are all pairs.
    pub(super) fn forget(&mut self) {
        self.marks.clear();
        self.counts = (0, 0);
    }

    /// Whether the list stands still: pairs have the same of `these` marks, and the counts are the same, as before. Where not, notes
    /// how it is now.
    fn stands(&mut self, marks: &[Marks], these: Marks, counts: (usize, usize)) -> bool {
        let changed = self.marks.iter().zip(marks).fold(Marks::NONE, |all, (&old, &new)| all | (old ^ new));
        let same = self.counts == counts && self.marks.len() == marks.len() && !changed.has(these);
        if !same {
            self.marks.clear();
            self.marks.extend_from_slice(marks);
            self.counts = counts;
        }
        same
    }
}

/// Turns the constraint of a pair that presses, and was hit by nothing, and holds it apart: what [`prepare`] comes to for it.
/// Where the first is, seen from the second, and how far away, is known; they are not at one place.
#[inline]
fn follow(
    setting: &Setting,
    constraint: &mut Constraint,
    first: &mut Body,
    second: &mut Body,
    (offset, distance): (DVec2, f64),
    unlike: Unlike,
) {
    let reach = first.radius + second.radius;
    // Without a branch: which pairs overlap cannot be foreseen by a processor.
    let out = reach - distance;
    let mut turned = *constraint;
    turned.least = setting.least_parting(lesser(setting.softness.mended(unlike) * out, out), reach);
    give(turned.turn(offset / distance, setting.grips(false)), first, second);
    solve(&mut turned, first, second, setting.softness.yielding(unlike));
    *constraint = turned;
}

impl Setting {
    /// Whether two balls that press on each other grip each other a little while they slide: large piles tremble, and without that ten
    /// thousand balls take five times as long to come to rest. Not on a fixed one, which is to be slid down; one asleep is none.
    #[inline]
    fn grips(&self, on_fixed: bool) -> bool {
        self.amount > Amount::Few && !on_fixed
    }

    /// How fast two balls, of radii with this sum, have to part to go so far in a substep, px: px/s. No faster than
    /// overlaps are taken away.
    #[inline]
    fn least_parting(&self, way: f64, reach: f64) -> f64 {
        lesser(self.mending * reach, way / self.substep)
    }
}

/// Whether one of a pair is fixed, and does not only sleep.
#[inline]
pub(super) fn on_fixed(rests: &[Rest], pair: Pair) -> bool {
    [pair.first, pair.second].iter().any(|&body| rests[body as usize].own == 0.0)
}

/// How two balls are shifted by impacts.
#[inline]
fn shift_of(fates: &[Fate], pair: Pair) -> Shift {
    fates[pair.first as usize].shift.max(fates[pair.second as usize].shift)
}

/// Looks at a pair anew: its direction and distance. Whether it is close enough to be held apart; then it is, once.
/// Where one of them is shifted by an impact, its place says nothing of overlaps.
fn prepare(
    setting: &Setting,
    constraint: &mut Constraint,
    (first, second): (&mut Body, &mut Body),
    (shift, moved): (Shift, bool),
    (grips, unlike): (bool, Unlike),
) -> bool {
    let left = setting.softness.yielding(unlike);
    if shift == Shift::Far {
        let_go(constraint, first, second);
        return hold_at_end(setting, constraint, (first, second), (grips, left));
    }
    let offset = first.position - second.position;
    let squared = offset.length_squared();
    let reach = first.radius + second.radius;
    let end = offset + (first.velocity - second.velocity) * setting.substep;
    let near = (1.0 + 2.0 * APART) * reach * reach;
    if constraint.impulse == 0.0 && squared.min(end.length_squared()) > near {
        // They have parted: what is left of earlier directions would go on for ever.
        give(-take(&mut constraint.grip), first, second);
        return false;
    }
    let distance = squared.sqrt();
    let gap = distance - reach;
    let end_apart = end.length_squared() > reach * reach;
    // One that was hit stands where it would have come from: what they part by themselves is no overlap.
    let elsewhere = shift == Shift::Some || moved;
    let apart = gap > 0.0 || (elsewhere && end_apart);
    if apart && end_apart && constraint.impulse == 0.0 {
        // They pass each other as they go now, and circles curve away from the tangent where they are: one where they
        // will be brakes nothing, unless others turn them.
        let normal = end.normalize();
        give(constraint.turn(normal, grips), first, second);
        constraint.least = (reach - offset.dot(normal)) / setting.substep;
        return true;
    }
    let normal = direction(offset, distance);
    give(constraint.turn(normal, grips), first, second);
    let way = if apart {
        -gap.max(0.0)
    } else {
        let deep = if setting.kick == DVec2::ZERO || elsewhere {
            (reach - end.length()).clamp(0.0, -gap)
        } else {
            -gap
        };
        let out = setting.softness.mended(unlike) * deep;
        if setting.kick == DVec2::ZERO {
            // Nothing presses them together again: they are moved, and need no velocity.
            let moved = normal * (out * constraint.mass);
            first.position += moved * first.inverse_mass;
            second.position -= moved * second.inverse_mass;
            0.0
        } else {
            out
        }
    };
    constraint.least = setting.least_parting(way, reach);
    solve(constraint, first, second, left);
    true
}

/// Holds two balls apart of which one comes from far away, if they would lie in each other at the substep's end. That is
/// where they are: where a fast ball that was hit stands now says nothing of it.
fn hold_at_end(
    setting: &Setting,
    constraint: &mut Constraint,
    (first, second): (&mut Body, &mut Body),
    (grips, left): (bool, f64),
) -> bool {
    let end = first.end(setting.substep) - second.end(setting.substep);
    let (distance, reach) = (end.length(), first.radius + second.radius);
    if distance >= reach {
        return false;
    }
    let normal = direction(end, distance);
    give(constraint.turn(normal, grips), first, second);
    let stands = (first.position - second.position).dot(normal);
    constraint.least = setting.least_parting(reach - stands, reach);
    solve(constraint, first, second, left);
    true
}

/// The direction of an offset of this length.
#[inline]
fn direction(offset: DVec2, length: f64) -> DVec2 {
    if length < COINCIDENT { COINCIDENT_NORMAL } else { offset / length }
}

impl Constraint {
    /// Turns it into another direction. By how much that changes what it gives the first ball, mass·px/s.
    ///
    /// What was given along the old one turns into the new one within some twenty substeps, as if the balls gripped each
    /// other a little: that works against the motion that turns it, and lets piles come to rest. Unless they are to have a grip, or
    /// where the direction turns by more in a substep, or nothing presses any more, nothing is left.
    #[inline]
    fn turn(&mut self, normal: DVec2, grips: bool) -> DVec2 {
        let given = self.normal * self.impulse + self.grip;
        let turned = (normal - self.normal).length_squared();
        if turned < STEADY * STEADY && self.impulse > 0.0 {
            let left = if grips { 1.0 - LOOSENED } else { 0.0 };
            self.grip = (given - normal * self.impulse) * left;
        } else {
            (self.impulse, self.grip) = (0.0, DVec2::ZERO);
        }
        self.normal = normal;
        normal * self.impulse + self.grip - given
    }
}

/// Forgets how two balls held each other. What that has given them stays, as if it had been an impact.
pub(super) fn let_go(constraint: &mut Constraint, first: &mut Body, second: &mut Body) {
    let given = constraint.normal * constraint.impulse + constraint.grip;
    first.free += given * first.inverse_mass;
    second.free -= given * second.inverse_mass;
    (constraint.impulse, constraint.grip) = (0.0, DVec2::ZERO);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_is_dealt_once_and_in_a_hand_none_after_its_neighbour() {
        let mut dealt = Vec::new();
        for count in 0..100 {
            dealt.clear();
            deal(&(0..count).collect::<Vec<_>>(), &mut dealt);
            assert!(
                (0..count).all(|place| dealt.contains(&place)) && dealt.len() == count as usize,
                "{count}"
            );
            let hands = &dealt[..dealt.len() - dealt.len() % HAND.len()];
            assert!(hands.windows(2).all(|two| two[0].abs_diff(two[1]) > 1), "{count}: {dealt:?}");
        }
    }

    #[test]
    fn a_list_stands_until_a_mark_that_it_follows_changes_or_a_constraint_is_added() {
        let (followed, mut marks) = (&mut Followed::default(), vec![Marks::CLOSE; 40]);
        let mut stands =
            |marks: &[Marks], constraints| followed.stands(marks, Marks::CLOSE | Marks::LIVE, constraints);
        assert!(!stands(&marks, (0, 0)) && stands(&marks, (0, 0)));
        marks[17].set(Marks::HELD, true);
        assert!(stands(&marks, (0, 0)));
        marks[39].set(Marks::LIVE, true);
        assert!(!stands(&marks, (0, 0)) && stands(&marks, (0, 0)));
        assert!(!stands(&marks, (1, 0)) && stands(&marks, (1, 0)));
        marks.push(Marks::NONE);
        assert!(!stands(&marks, (1, 0)) && stands(&marks, (1, 0)));
        followed.forget();
        assert!(followed.stands(&[], Marks::LIVE, (0, 0)));
    }
}
