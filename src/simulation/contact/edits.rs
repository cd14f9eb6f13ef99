//! Balls that are added, or thrown, from outside.
//!
//! That is done to balls as they are shown, which may be within a substep whose end is found already. A ball that flies freely from
//! there to its end is brought to where it is then, as if it had been so from the beginning. Where others, or walls, are in its way,
//! those have passed, or not been met, in the meantime: then the solver is made anew from what is shown, unless the ball was slow.

use glam::DVec2;

use super::super::ball::Ball;
use super::super::world::World;
use super::body::Body;
use super::show::Start;
use super::sleep::Rest;
use super::unlike::Crush;
use super::wall_support::any_jams;
use super::{Contact, SHIFT, can_rest, has_pairs};

/// A thrown ball that something is in the way of stays where it would have come to, unless that is more than this part of its radius
/// from where it comes to now.
const AWAY: f64 = 0.5;
/// More balls than these are not added within a substep: all others would have to be looked at for each of them.
const MANY: usize = 256;

/// The rest of the substep that a frame ends in.
#[derive(Debug, Clone, Copy)]
struct Remainder {
    /// How much of it is over, and how much is left, s.
    over: f64,
    left: f64,
    gravity: DVec2,
}

/// A free flight of a ball through what is left of a substep.
#[derive(Debug, Clone, Copy)]
struct Flight {
    radius: f64,
    from: DVec2,
    velocity: DVec2,
    to: DVec2,
}

impl Remainder {
    fn flight(self, ball: &Ball) -> Flight {
        let Self { left, gravity, .. } = self;
        let way = (ball.velocity + 0.5 * gravity * left) * left;
        let to = if ball.is_fixed() { ball.position } else { ball.position + way };
        Flight { radius: ball.radius, from: ball.position, velocity: ball.velocity, to }
    }

    /// The ball where the substep began, if it flew, and its velocity at its end.
    fn ends(self, flight: Flight) -> (Start, DVec2) {
        let Self { over, left, gravity } = self;
        let velocity = flight.velocity - gravity * over;
        let position = flight.from - (velocity + 0.5 * gravity * over) * over;
        let mean = velocity + 0.5 * gravity * (over + left);
        (Start::going(position, velocity, mean), flight.velocity + gravity * left)
    }
}

impl Flight {
    /// Whether it comes to lie deep in another ball of this radius that goes from one place to another meanwhile. That is moved by
    /// up to so much beside that way, px.
    fn meets(&self, radius: f64, (from, to): (DVec2, DVec2), beside: f64) -> bool {
        let reach = self.radius + radius + beside - SHIFT * self.radius.min(radius);
        let (begin, end) = (self.from - from, self.to - to);
        let way = end - begin;
        let length = way.length_squared();
        let nearest = if length == 0.0 { 0.0 } else { (-begin.dot(way) / length).clamp(0.0, 1.0) };
        (begin + way * nearest).length_squared() < reach * reach
    }
}

impl Contact {
    /// What is left of the substep that a frame ended in, where it is not over.
    fn remainder(&self) -> Option<Remainder> {
        let (share, substep) = (self.share(), self.setting.substep);
        let remainder =
            Remainder { over: share * substep, left: (1.0 - share) * substep, gravity: self.setting.gravity };
        (!self.before.is_empty() && remainder.left > 0.0).then_some(remainder)
    }

    /// Whether a ball that flies so comes out of the walls, or to lie in any other but the body at `but`. `balls` are as they are shown.
    fn is_barred(&self, flight: Flight, balls: &[Ball], but: Option<usize>, left: f64) -> bool {
        self.setting.inside(flight.to, flight.radius) != flight.to
            || self.comes_into(flight, balls, but, left)
    }

    /// The same without the walls.
    fn comes_into(&self, flight: Flight, balls: &[Ball], but: Option<usize>, left: f64) -> bool {
        let meets = |(at, (body, &id)): (usize, (&Body, &u32))| {
            // What was hit does not go straight.
            let speed = || body.velocity.length().max(self.before[at].velocity.length());
            let beside = if self.course.was_hit(at) { speed() * left } else { 0.0 };
            let way = (balls[id as usize].position, body.position);
            but != Some(at) && flight.meets(body.radius, way, beside)
        };
        self.pairs && self.bodies.iter().zip(&self.ids).enumerate().any(meets)
    }

    /// Whether a body was hit, or may have been, after what is shown.
    fn is_hit_later(&self, at: usize) -> bool {
        let is_on_last = |(on, last)| on == Some(last);
        self.course.was_hit(at) && !self.course.legs.of_body(at).is_some_and(is_on_last)
    }

    /// Takes up balls that were added after those that are known, if it can; `balls` are all.
    pub(super) fn take_up(&mut self, world: &World, balls: &[Ball]) -> bool {
        let tuning = self.tuning;
        let known = self.bodies.len();
        let new = &balls[known..];
        let Some(substeps) = self.substeps.with(world, balls, tuning) else { return false };
        if has_pairs(world, balls) != self.pairs
            || can_rest(world, balls) != self.setting.can_rest
            || self.shown.is_some()
            || self.any_sleeps_in(new)
        {
            return false;
        }
        let remainder = self.remainder();
        let flights: Vec<Flight> =
            remainder.iter().flat_map(|rest| new.iter().map(|ball| rest.flight(ball))).collect();
        if let Some(Remainder { left, .. }) = remainder
            && self.are_barred(&flights, balls, left)
        {
            return false;
        }
        self.substeps = substeps;
        self.setting.firm = substeps.firm(self.setting.kick);
        self.setting.crush = Crush::among(balls);
        self.setting.softness = substeps.softness(self.setting.crush);
        self.setting.has_fixed = balls.iter().any(Ball::is_fixed);
        self.setting.jammed = any_jams(world, balls);
        for (at, ball) in new.iter().enumerate() {
            let mut body = Body::new(ball, self.setting.kick);
            let mut start = Start::of(ball);
            if let (Some(remainder), Some(&flight)) =
                (remainder, flights.get(at).filter(|_| !ball.is_fixed()))
            {
                let velocity;
                (start, velocity) = remainder.ends(flight);
                body.go(flight.to, velocity, self.setting.kick);
            }
            self.bodies.push(body);
            self.rests.push(Rest::new(&body));
            self.restitutions.push(ball.restitution);
            self.ids.push((known + at) as u32);
            self.hit.push(false);
            if !self.before.is_empty() {
                self.before.push(start);
            }
        }
        self.parting.begin_again(known as u32);
        self.all_asleep = false;
        true
    }

    /// Whether anything is in the way of any of the last of these balls, which fly so, one for each flight, or are fixed.
    fn are_barred(&self, flights: &[Flight], balls: &[Ball], left: f64) -> bool {
        let new = &balls[balls.len() - flights.len()..];
        let bars = |(at, (&flight, ball)): (usize, (&Flight, &Ball))| {
            let meets = |(other, its): (&Flight, &Ball)| {
                !(ball.is_fixed() && its.is_fixed())
                    && flight.meets(other.radius, (other.from, other.to), 0.0)
            };
            let others = || flights[..at].iter().zip(new);
            // Fixed ones may stand in walls.
            self.pairs && others().any(meets)
                || if ball.is_fixed() {
                    self.comes_into(flight, balls, None, left)
                } else {
                    self.is_barred(flight, balls, None, left)
                }
        };
        flights.len() > MANY || flights.iter().zip(new).enumerate().any(bars)
    }

    /// Gives a ball the velocity that it was given from outside, if it can; `balls` are all, as they are shown.
    pub(super) fn throw(&mut self, balls: &[Ball], index: usize) -> bool {
        let ball = &balls[index];
        if ball.is_fixed() {
            // Nothing moves it.
            return true;
        }
        let Some(at) = self.ids.iter().position(|&id| id as usize == index) else { return false };
        let Some(remainder) = self.remainder() else {
            self.free_by_hand(at);
            let place = self.bodies[at].position;
            self.bodies[at].go(place, ball.velocity, self.setting.kick);
            return true;
        };
        // What it hit then would be hit by nothing now.
        if self.is_hit_later(at) {
            return false;
        }
        let flight = remainder.flight(ball);
        let flies = self.flies(at);
        let barred = self.is_barred(flight, balls, Some(at), remainder.left);
        let place = self.bodies[at].position;
        if barred && place.distance(flight.to) > AWAY * ball.radius {
            return false;
        }
        self.free_by_hand(at);
        let (start, velocity) = remainder.ends(flight);
        if barred {
            let velocity = if flies { velocity } else { ball.velocity };
            self.bodies[at].go(place, velocity, self.setting.kick);
            self.before[at].velocity = ball.velocity;
        } else {
            self.bodies[at].go(flight.to, velocity, self.setting.kick);
            self.before[at] = start;
            let Self { near, bodies, setting, .. } = self;
            // One that was added after pairs were searched is covered by the next search.
            if let Some(near) = near.as_mut().filter(|near| at < near.homes.len()) {
                near.cover_way(at, (flight.to, flight.to), bodies, setting);
            }
        }
        true
    }
}
