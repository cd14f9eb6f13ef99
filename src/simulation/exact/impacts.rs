//! What happens at an impact, and how balls come to rest.
//!
//! With restitution below 1, ever smaller hops would follow each other without end (`McNamara` & Young 1992). A ball
//! rests on a wall that gravity presses it to when it would bounce off more slowly than the rest speed u; it slides on
//! without friction, until an impact lifts it. Balls that hit each other more slowly than u, and within 2u/g of an
//! impact before, lose nothing, and neither do faster ones that have moved less than a thousandth of 2u²/g since: the
//! TC model of Luding & `McNamara` (1998), in time and in length. What chatters so for long is laid to rest by
//! `settle`. Without gravity no faster ones are chatter: hits that come ever sooner end by themselves, or in a crush, which
//! stops all that is in it (`pace`). Laid to rest are elastic balls, too, where they touch a wall that takes nearly all of it, or are
//! slow between walls that take any.
//!
//! Nothing is moved, overlaps or not. What overlaps and approaches has an impact now, and what overlaps and parts has
//! none (Bannerman et al. 2014); what overlaps at rest, as where balls were put into each other, or a window shrank
//! over a pile, has one now after which it parts, and where that costs work it comes from nowhere.

use glam::DVec2;

use crate::simulation::Tally;
use crate::simulation::flight::{self, DEEP};
use crate::simulation::impulse::{any_offset, exact_impact, held_impact};
use crate::simulation::jams;

use super::flights::{Marks, Matter, Way};
use super::settle::FIRM;
use super::{Exact, LEAN, Needs};

/// The part of the rest speed below which even a wall of restitution 1 holds a ball, since its hops are too many.
const CONSERVATIVE: f64 = 0.01;
/// The part of the rest speed that a ball bounces off one that rests with, at least, while it chatters.
const LEAST_HOP: f64 = 0.5;
/// What a ball moves between two fast hits that are chatter, as a part of what it moves between two slow ones. So
/// little that no other impact is taken for chatter, and it need not be more: a ball in a wedge gets there in a few
/// hits.
const BARELY: f64 = 1e-3;
/// ... once so many hits came one soon after the other: a ball on the floor that is hit goes to and fro a few times
/// between what hit it and the floor, and loses what it should.
pub(super) const QUICK: u32 = 8;
/// Balls that are wedged in are stopped all at once, with those that they touch, in one of so many events: impact by impact, a heavy
/// one would take as many to stop on a light one as it is times as heavy.
const STOPPED: usize = 64;
/// Impacts that follow each other sooner than in this part of chatter's time are a storm, where there are many in a row: what lies
/// on others is hit by each of them once or twice in that time.
const STORM: f64 = 1.0 / 64.0;
/// The demo's gravity, px/s²: the rest speed is meant for it, and where there is none it sets chatter's time scale.
pub(super) const EARTH: f64 = 980.0;
/// A ball that hits a wall is as near to it as this part of the world's size. One that is not began beyond it, and
/// stays where it is.
const AT_THE_WALL: f64 = 1e-12;

/// Two balls that touch: the position and the velocity of the one relative to the other.
pub(super) struct Meeting {
    pub(super) offset: DVec2,
    pub(super) velocity: DVec2,
}

impl Meeting {
    /// Whether they approach each other more slowly than this, px/s, or part.
    #[inline]
    fn slower_than(&self, speed: f64) -> bool {
        let closing = -self.velocity.dot(self.offset);
        closing <= 0.0 || closing * closing < speed * speed * self.offset.length_squared()
    }

    /// The same meeting as it counts if they must part at `least`, px/s, whatever restitution makes of their approach.
    fn parting_at(&self, least: f64, e: f64) -> Self {
        let Self { offset, velocity } = *self;
        let length = offset.length().max(f64::MIN_POSITIVE);
        let approach = -velocity.dot(offset) / length;
        // The impact will change the velocity by (1 + e) times the approach.
        let faster = (approach.max(0.0) + least) / (1.0 + e);
        let velocity = if e * approach < least { offset * (-faster / length) } else { velocity };
        Self { offset, velocity }
    }
}

/// The shares of two masses in a change of their relative velocity: each the other's over the sum.
#[inline]
fn shares(m1: f64, m2: f64) -> (f64, f64) {
    (m2 / (m1 + m2), m1 / (m1 + m2))
}

/// The same where one of the masses may be infinite.
fn shares_with_fixed(first: &Matter, second: &Matter) -> (f64, f64) {
    if first.is_fixed() {
        (0.0, 1.0)
    } else if second.is_fixed() {
        (1.0, 0.0)
    } else {
        shares(first.mass, second.mass)
    }
}

impl Exact {
    /// The approach, px/s, below which an impact of a ball now is chatter, so soon after its last one; 0 where that was
    /// long ago.
    ///
    /// That is the rest speed, or more under gravity where the ball has hardly moved since, nor between the hits before. So a ball
    /// that is driven into a wedge is thrown back in the end, where otherwise it would hit ever more often and never
    /// stop.
    fn chatter_speed(&self, slot: usize, now: f64) -> f64 {
        let since = now - self.flights[slot].time;
        if self.marks[slot].has(Marks::STRUCK) && since < self.chatter_time {
            if self.marks[slot].quick_hits() < QUICK || self.gravity == DVec2::ZERO {
                // Nothing presses what flies together: hits that come ever sooner part it in the end, or have no end.
                return self.rest_speed;
            }
            let length = (BARELY * self.rest_speed * self.chatter_time).min(self.chatter_length);
            self.rest_speed.max(length / since)
        } else {
            0.0
        }
    }

    /// Whether a ball of this radius has no room between the walls across an axis.
    pub(in crate::simulation) fn jams(&self, radius: f64, axis: usize) -> bool {
        self.jams_on(radius) >> axis & 1 == 1
    }

    /// On which axes it has none, a bit each.
    pub(super) fn jams_on(&self, radius: f64) -> usize {
        if self.walls.is_some() { jams(self.size, radius).bitmask() as usize } else { 0 }
    }

    /// Begins a new flight of a ball with an impact.
    #[inline]
    pub(super) fn set_out(&mut self, slot: usize, (position, velocity): (DVec2, DVec2), now: f64) {
        let since = now - self.flights[slot].time;
        let is_within = |time: f64| self.marks[slot].has(Marks::STRUCK) && since < time;
        let (soon, at_once) = (is_within(self.chatter_time), is_within(STORM * self.chatter_time));
        self.marks[slot].strike(soon, at_once);
        let flight = &mut self.flights[slot];
        (flight.position, flight.velocity, flight.time) = (position, velocity, now);
    }

    /// Takes the impact of a ball on the wall across an axis, at its low or its high end.
    pub(super) fn hit_wall<N: Needs>(
        &mut self,
        tally: &mut Tally,
        slot: usize,
        axis: usize,
        high: bool,
        now: f64,
    ) {
        if N::HOLDS && self.ends_wait::<N>(slot, now) {
            return self.foresee::<N>(slot, now);
        }
        let (mut position, mut velocity) = self.state::<N>(slot, now);
        if N::HOLDS && velocity[axis].abs() > FIRM * self.rest_speed {
            velocity = self.throw_off(slot, velocity, now);
        }
        let Matter { radius, mass, .. } = *self.matter::<N>(slot);
        let wall = if high { self.size[axis] - radius } else { radius };
        if (position[axis] - wall).abs() < AT_THE_WALL * self.size[axis] {
            position[axis] = wall;
        }
        let sign = if high { 1.0 } else { -1.0 };
        let (before, speed) = (velocity[axis], sign * velocity[axis]);
        let pressed = N::HOLDS && sign * self.gravity[axis] > 0.0;
        let chatter_speed = self.chatter_speed(slot, now);
        let chatters = speed < chatter_speed;
        let rests = self.jams(radius, axis) || (pressed && self.too_slow(speed));
        velocity[axis] = if rests { 0.0 } else { -before * self.wall_restitution(chatters) };
        tally.wall_hits += u64::from(speed > 0.0);
        tally.wall_impulse[axis] += mass * (velocity[axis] - before);
        // That of an elastic wall says nothing: it would lose nothing either way.
        let counts = !chatters || self.wall_restitution(false) < 1.0;
        self.set_out(slot, (position, velocity), now);
        let marks = &mut self.marks[slot];
        marks.set(Marks::rests_on(axis), rests);
        if pressed && chatter_speed == 0.0 {
            // So long a hop is one of its own; what is pressed to the wall by others hits it sooner.
            marks.set(Marks::LEANS, false);
        }
        if counts {
            marks.note_chatter(chatters);
        }
        let long = counts && marks.chatter() >= self.long_chatter;
        self.foresee::<N>(slot, now);
        if long {
            self.settle::<N>(tally, slot, now);
        }
    }

    /// Ends that a ball is carried, if it is, and returns its velocity where that of its flight is this.
    pub(super) fn throw_off(&mut self, slot: usize, velocity: DVec2, now: f64) -> DVec2 {
        if !self.marks[slot].has(Marks::CARRIED) {
            return velocity;
        }
        let velocity = self.true_velocity(slot, velocity, self.since_middle(now));
        self.marks[slot].go(Way::Flies);
        velocity
    }

    /// Notes that a ball flies by itself if it was lifted off a wall, where it rested on these axes before: its velocity is no mean one.
    pub(super) fn note_lift(&mut self, slot: usize, rested: usize) {
        let marks = &mut self.marks[slot];
        if marks.has(Marks::CARRIED) && marks.rests() != rested {
            marks.go(Way::Flies);
        }
    }

    /// Whether a ball that hits a wall at this speed, px/s, where gravity presses it, stays there.
    fn too_slow(&self, speed: f64) -> bool {
        let restitution = self.wall_restitution(false);
        if self.pressing.is_some() && restitution < 1.0 {
            // Those hops cost too little to be left out.
            return speed < self.rest_speed;
        }
        let least = if restitution < 1.0 { self.rest_speed } else { CONSERVATIVE * self.rest_speed };
        restitution * speed < least
    }

    /// The part of its speed that a wall gives back.
    fn wall_restitution(&self, chatters: bool) -> f64 {
        match self.walls {
            Some(_) if self.wedged() => 0.0,
            Some(_) if chatters => 1.0,
            restitution => restitution.unwrap_or_default(),
        }
    }

    /// Takes the impact of two balls, and those that others which they touch have with them at this time.
    pub(super) fn collide<N: Needs>(&mut self, tally: &mut Tally, one: usize, other: usize, now: f64) {
        let ((p1, mut v1), (p2, mut v2)) = (self.state::<N>(one, now), self.state::<N>(other, now));
        let mut meeting = Meeting { offset: p1 - p2, velocity: v1 - v2 };
        if meeting.offset == DVec2::ZERO {
            // Very near it.
            meeting.offset = any_offset(one, other, 1e-9);
        }
        let firm = N::HOLDS && !meeting.slower_than(FIRM * self.rest_speed);
        if N::HOLDS && self.waits_at::<N>(tally, [one, other], firm, now) {
            return;
        }
        if firm {
            for slot in [one, other] {
                if self.marks[slot].has(Marks::HELD) {
                    self.free::<N>(slot, now);
                }
            }
            (v1, v2) = (self.throw_off(one, v1, now), self.throw_off(other, v2, now));
            meeting.velocity = v1 - v2;
        }
        let matter = |slot: usize| {
            let matter = *self.matter::<N>(slot);
            // What is held does not give way.
            let held = N::HOLDS && self.marks[slot].has(Marks::HELD);
            Matter { mass: if held { f64::INFINITY } else { matter.mass }, ..matter }
        };
        let (first, second) = (&matter(one), &matter(other));
        let leans = meeting.slower_than(LEAN * self.rest_speed);
        let least = self.least_parting(&meeting, first.radius + second.radius);
        let restitution = if self.wedged() { 0.0 } else { first.restitution.min(second.restitution) };
        if N::HOLDS && self.wedged() && (first.is_fixed() || second.is_fixed()) {
            return self.stop_on_fixed::<N>(tally, [one, other], &meeting, now);
        }
        let may_chatter = self.takes_energy(restitution) && !self.wedged();
        let chatters = |slot, matter| may_chatter && self.chatters::<N>(slot, matter, &meeting, now);
        let chatter = (chatters(one, first), chatters(other, second));
        let e = if chatter.0 || chatter.1 { 1.0 } else { restitution };
        let (rests1, rests2) = (self.marks[one].rests(), self.marks[other].rests());
        let pulls = [self.pull::<N>(one), self.pull::<N>(other)];
        let pressed = N::HOLDS && pulls[0] != pulls[1];
        let plain = least == 0.0 && !chatter.0 && !chatter.1 && !self.wedged();
        let (meeting, e) = if pressed || least > 0.0 {
            let hop = if pressed && !self.wedged() {
                let hop = self.least_hop(restitution) * self.sliding_part(meeting.offset, [rests1, rests2]);
                let presses = (pulls[1] - pulls[0]).dot(meeting.offset.normalize());
                hop.min(self.longest_hop([one, other], presses, now))
            } else {
                0.0
            };
            (meeting.parting_at(least.max(hop), restitution), restitution)
        } else {
            (meeting, e)
        };
        let (c1, c2) = if N::HOLDS && (rests1 | rests2) != 0 {
            self.hit_held(one, other, &meeting, (first, second), e)
        } else {
            let shares = if N::ALIKE { (0.5, 0.5) } else { shares(first.mass, second.mass) };
            exact_impact(meeting.offset, meeting.velocity, shares, e)
        };
        for (slot, position, velocity, change, chatters) in
            [(one, p1, v1, c1, chatter.0), (other, p2, v2, c2, chatter.1)]
        {
            let rests = self.marks[slot].rests();
            self.mark_hit::<N>(slot, change, leans, chatters);
            self.set_out(slot, (position, velocity + change), now);
            self.note_lift(slot, rests);
        }
        tally.impacts += 1;
        self.beside = false;
        self.foresee_both::<N>(one, other, now);
        if self.beside && plain {
            self.collide_together::<N>(tally, [(one, v1), (other, v2)], now);
        }
        for slot in [one, other] {
            if self.marks[slot].chatter() >= self.long_chatter {
                self.settle::<N>(tally, slot, now);
            }
            if N::HOLDS && self.has_flurry(slot) {
                self.end_flurry::<N>(tally, slot, now);
            }
        }
        // An impact counts as one event or two.
        if self.wedged() && self.at_once % STOPPED < 2 {
            self.settle::<N>(tally, one, now);
        }
    }

    /// One ball begins to overlap another, or ceases to. Both fly on.
    pub(super) fn pass<N: Needs>(&mut self, one: usize, other: usize, now: f64) {
        let Some(overlaps) = &mut self.overlaps else { return };
        for (slot, other) in [(one, other as u32), (other, one as u32)] {
            // The lists are sorted.
            match overlaps[slot].binary_search(&other) {
                Ok(index) => drop(overlaps[slot].remove(index)),
                Err(index) => overlaps[slot].insert(index, other),
            }
            self.marks[slot].set(Marks::HIT, true);
        }
        self.foresee::<N>(one, now);
        self.foresee::<N>(other, now);
    }

    /// Whether this impact of a ball is chatter.
    #[inline]
    fn chatters<N: Needs>(&self, slot: usize, matter: &Matter, meeting: &Meeting, now: f64) -> bool {
        // That another ball has hit a fixed one a moment before says nothing: it has not moved.
        !(N::HOLDS && matter.is_fixed()) && meeting.slower_than(self.chatter_speed(slot, now))
    }

    /// Marks a ball that another has hit, whose velocity changes by so much.
    #[inline]
    fn mark_hit<N: Needs>(&mut self, slot: usize, change: DVec2, leans: bool, chatters: bool) {
        if N::HOLDS && self.marks[slot].rests() != 0 && change != DVec2::ZERO {
            // A ball that is given a speed across the wall it rests on flies again, and along both axes where others had stopped it.
            for axis in 0..2 {
                if change[axis] != 0.0 || !self.stands_on_wall::<N>(slot, axis) {
                    self.marks[slot].set(Marks::rests_on(axis), false);
                }
            }
        }
        let marks = &mut self.marks[slot];
        marks.set(Marks::HIT, true);
        if !(N::HOLDS && marks.has(Marks::HELD)) {
            // What has no room, and stays, leans on the others still.
            let stays = N::HOLDS && marks.rests() == 3 && marks.has(Marks::LEANS);
            marks.set(Marks::LEANS, leans || stays);
            marks.note_chatter(chatters);
        }
    }

    /// Whether a wall is what a ball rests on that rests along an axis: it has no room between two, or gravity presses it to one.
    fn stands_on_wall<N: Needs>(&self, slot: usize, axis: usize) -> bool {
        let radius = self.matter::<N>(slot).radius;
        let (size, at, pull) = (self.size[axis], self.flights[slot].position[axis], self.gravity[axis]);
        let over = if pull < 0.0 { radius - at } else { at - (size - radius) };
        self.jams(radius, axis) || (self.walls.is_some() && pull != 0.0 && over >= -AT_THE_WALL * size)
    }

    /// The changes of velocity where one of two balls, or both, rest on walls, which hold them unless the blow is so
    /// hard that they bounce, or are fixed.
    fn hit_held(
        &self,
        one: usize,
        other: usize,
        &Meeting { offset, velocity }: &Meeting,
        (first, second): (&Matter, &Matter),
        e: f64,
    ) -> (DVec2, DVec2) {
        let free = exact_impact(offset, velocity, shares_with_fixed(first, second), e);
        let inverse_masses =
            (self.gives(one, first, free.0) / first.mass, self.gives(other, second, free.1) / second.mass);
        held_impact(offset, velocity, inverse_masses, e)
    }

    /// Whether impacts of this restitution take energy, or those on walls that may follow.
    pub(super) fn takes_energy(&self, e: f64) -> bool {
        e < 1.0 || self.wedged() || self.walls.is_some_and(|e| e < 1.0)
    }

    /// The least speed, px/s, at which a ball parts from one that rests: slower, gravity would close the contact again
    /// at once, for ever.
    pub(super) fn least_hop(&self, e: f64) -> f64 {
        LEAST_HOP * self.rest_speed * if self.takes_energy(e) { 1.0 } else { CONSERVATIVE }
    }

    /// The part of the least hop with which a ball parts that slides along the wall it rests on, from what nothing moves. In
    /// a steep wedge it slides far while it parts a little, and gravity along the wall may be weak: it would hop for ever.
    fn sliding_part(&self, offset: DVec2, rests: [usize; 2]) -> f64 {
        let (slides, along) = match rests {
            [1, 3] | [3, 1] => (1, offset.y),
            [2, 3] | [3, 2] => (2, offset.x),
            _ => return 1.0,
        };
        along.abs() / offset.length() * (self.pulls[slides].length() / self.gravity.length())
    }

    /// The least speed, px/s, at which balls that overlap at relative rest part; 0 where they do not.
    fn least_parting(&self, meeting: &Meeting, reach: f64) -> f64 {
        // Nearly all only touch; no root is taken of them.
        let touching = meeting.offset.length_squared() >= (1.0 - DEEP) * reach * reach;
        if touching || self.wedged() || !meeting.slower_than(self.rest_speed) {
            return 0.0;
        }
        flight::least_parting(meeting.offset.length(), reach)
    }

    /// Along which axes a ball can take a change of velocity: 0 where it would be pressed into the wall it rests on.
    fn gives(&self, slot: usize, matter: &Matter, change: DVec2) -> DVec2 {
        let gives = |axis: usize| {
            if self.jams(matter.radius, axis) {
                return 0.0;
            }
            let into = change[axis] * self.gravity[axis].signum();
            let held = self.marks[slot].has(Marks::rests_on(axis)) && into >= 0.0;
            if held && self.walls.unwrap_or_default() * into < self.rest_speed { 0.0 } else { 1.0 }
        };
        DVec2::new(gives(0), gives(1))
    }
}
