//! What happens at an impact, and how balls come to rest.
//!
//! With restitution below 1, ever smaller hops would follow each other without end (`McNamara` & Young 1992). A ball
//! rests on a wall that gravity presses it to when it would bounce off more slowly than the rest speed u; it slides on
//! without friction, until an impact lifts it. Balls that hit each other more slowly than u, and within 2u/g of an
//! impact before, lose nothing: the TC model of Luding & `McNamara` (1998).

use glam::DVec2;

use crate::simulation::Tally;
use crate::simulation::impulse::{exact_impact, held_impact};

use super::flights::{Marks, Matter};
use super::{Exact, LEAN, Needs};

/// The part of the rest speed below which even a wall of restitution 1 holds a ball, since its hops are too many.
const CONSERVATIVE: f64 = 0.01;
/// The part of the rest speed that a ball bounces off one that rests with, at least, while it chatters.
const LEAST_HOP: f64 = 0.25;
/// The gravity that sets the time scale of chatter where there is none, px/s².
const EARTH: f64 = 980.0;
/// A ball with less room than this between two walls, px, is held by both.
const JAMMED: f64 = 1e-6;
/// A ball that hits a wall is this near to it, px. One that is not began beyond it, and stays where it is.
const AT_THE_WALL: f64 = 1e-6;

/// Two balls that touch: the position and the velocity of the one relative to the other.
struct Meeting {
    distance: DVec2,
    velocity: DVec2,
}

impl Meeting {
    /// Whether they approach each other more slowly than this, px/s, or part.
    #[inline]
    fn slower_than(&self, speed: f64) -> bool {
        let closing = -self.velocity.dot(self.distance);
        closing <= 0.0 || closing * closing < speed * speed * self.distance.length_squared()
    }
}

/// The shares of two masses in a change of their relative velocity: each the other's over the sum.
#[inline]
fn shares<N: Needs>(m1: f64, m2: f64) -> (f64, f64) {
    if N::ALIKE { (0.5, 0.5) } else { (m2 / (m1 + m2), m1 / (m1 + m2)) }
}

impl Exact {
    /// How soon after its last impact a slow one is chatter, s: as long as a hop at the rest speed.
    pub(super) fn chatter(&self) -> f64 {
        let gravity = self.gravity.length();
        2.0 * self.rest_speed / if gravity > 0.0 { gravity } else { EARTH }
    }

    /// Whether a ball's last impact is so recent that another is chatter.
    fn hit_lately(&self, slot: usize, now: f64) -> bool {
        self.marks[slot].has(Marks::STRUCK) && now - self.flights[slot].time < self.chatter()
    }

    /// Begins a new flight of a ball.
    fn set_out(&mut self, slot: usize, (position, velocity): (DVec2, DVec2), now: f64) {
        let flight = &mut self.flights[slot];
        (flight.position, flight.velocity, flight.time) = (position, velocity, now);
        self.marks[slot].set(Marks::STRUCK, true);
    }

    pub(super) fn hit_wall<N: Needs>(
        &mut self,
        tally: &mut Tally,
        slot: usize,
        axis: usize,
        high: bool,
        now: f64,
    ) {
        let (mut position, mut velocity) = self.state::<N>(slot, now);
        let Matter { radius, mass, .. } = *self.matter::<N>(slot);
        let wall = if high { self.size[axis] - radius } else { radius };
        if (position[axis] - wall).abs() < AT_THE_WALL {
            position[axis] = wall;
        }
        let sign = if high { 1.0 } else { -1.0 };
        let before = velocity[axis];
        let (speed, restitution) = (sign * before, self.walls.unwrap_or_default());
        let pressed = N::GRAVITY && sign * self.gravity[axis] > 0.0;
        let lately = self.hit_lately(slot, now);
        let least = if restitution < 1.0 { self.rest_speed } else { CONSERVATIVE * self.rest_speed };
        if self.size[axis] - 2.0 * radius < JAMMED || (pressed && restitution * speed < least) {
            velocity[axis] = 0.0;
            self.marks[slot].set(Marks::rests_on(axis), true);
        } else {
            let chatters = speed < self.rest_speed && lately;
            velocity[axis] *= if chatters { -1.0 } else { -restitution };
        }
        tally.wall_hits += u64::from(speed > 0.0);
        tally.wall_impulse[axis] += mass * (velocity[axis] - before);
        self.set_out(slot, (position, velocity), now);
        if pressed && !lately {
            // So long a hop is one of its own; what is pressed to the wall by others hits it sooner.
            self.marks[slot].set(Marks::LEANS, false);
        }
        self.foresee::<N>(slot, now);
    }

    pub(super) fn collide<N: Needs>(&mut self, tally: &mut Tally, one: usize, other: usize, now: f64) {
        let ((p1, v1), (p2, v2)) = (self.state::<N>(one, now), self.state::<N>(other, now));
        let meeting = Meeting { distance: p1 - p2, velocity: v1 - v2 };
        let (first, second) = (self.matter::<N>(one), self.matter::<N>(other));
        let slow = meeting.slower_than(self.rest_speed);
        let leans = meeting.slower_than(LEAN * self.rest_speed);
        let chatters = slow && (self.hit_lately(one, now) || self.hit_lately(other, now));
        let e = if chatters { 1.0 } else { first.restitution.min(second.restitution) };
        let (c1, c2) = if N::GRAVITY && (self.marks[one].rests() | self.marks[other].rests()) != 0 {
            self.hit_held(one, other, &meeting, (first.mass, second.mass), e)
        } else {
            exact_impact(meeting.distance, meeting.velocity, shares::<N>(first.mass, second.mass), e)
        };
        for (slot, position, velocity, change) in [(one, p1, v1, c1), (other, p2, v2, c2)] {
            let marks = &mut self.marks[slot];
            if N::GRAVITY {
                // A ball that is given a speed across the wall it rests on flies again.
                (0..2)
                    .filter(|&axis| change[axis] != 0.0)
                    .for_each(|axis| marks.set(Marks::rests_on(axis), false));
            }
            marks.set(Marks::HIT, true);
            marks.set(Marks::LEANS, leans);
            self.set_out(slot, (position, velocity + change), now);
        }
        tally.impacts += 1;
        self.foresee::<N>(one, now);
        self.foresee::<N>(other, now);
    }

    /// The changes of velocity where one of two balls, or both, rest on walls, which hold them unless the blow is so
    /// hard that they bounce.
    fn hit_held(
        &self,
        one: usize,
        other: usize,
        &Meeting { distance, velocity }: &Meeting,
        (m1, m2): (f64, f64),
        e: f64,
    ) -> (DVec2, DVec2) {
        let free = exact_impact(distance, velocity, (m2 / (m1 + m2), m1 / (m1 + m2)), e);
        let yields = (self.gives(one, free.0) / m1, self.gives(other, free.1) / m2);
        let length = distance.length().max(f64::MIN_POSITIVE);
        let approach = -velocity.dot(distance) / length;
        let hop = LEAST_HOP * self.rest_speed;
        if self.marks[one].rests() != self.marks[other].rests() && e * approach < hop {
            // At rest on one that rests: hop, or gravity would close the contact again at once, for ever.
            let more = -(approach.max(0.0) + hop) / length;
            return held_impact(distance, distance * more, yields, 0.0);
        }
        held_impact(distance, velocity, yields, e)
    }

    /// Along which axes a ball can take a change of velocity: 0 where it would be pressed into the wall it rests on.
    fn gives(&self, slot: usize, change: DVec2) -> DVec2 {
        let gives = |axis: usize| {
            let into = change[axis] * self.gravity[axis].signum();
            let held = self.marks[slot].has(Marks::rests_on(axis)) && into >= 0.0;
            if held && self.walls.unwrap_or_default() * into < self.rest_speed { 0.0 } else { 1.0 }
        };
        DVec2::new(gives(0), gives(1))
    }
}
