//! Balls that are added, or thrown, from outside.
//!
//! That is done to balls as they are shown, which may be within a substep whose end is found already. A ball that flies freely from
//! there is brought to where it is at that end, as if it had been so from the beginning. Where others, or walls, are in its way, they
//! have passed meanwhile, or were not met: one that is added has the solver made anew then, from what is shown; one that is thrown
//! stays where it would have come to, if that is nearly the same, or where it is shown. So does one that others hold: to make the solver
//! anew wakes what sleeps, and who carries a ball through a pile throws it in each frame.

use glam::DVec2;

use super::super::ball::Ball;
use super::super::world::World;
use super::body::Body;
use super::fates::Fate;
use super::show::Start;
use super::sleep::Rest;
use super::{Contact, SHIFT};

/// A thrown ball that something is in the way of stays where it would have come to, unless that is more than this part of its radius
/// from where it comes to now: it is in no other there.
const AWAY: f64 = 0.1;
/// More pairs of an added ball and one that was there are not looked at within a substep.
const MOST_LOOKED_AT: usize = 1 << 18;

/// Of a substep of which no more than this part is left nothing is.
const ROUNDING: f64 = 1e-9;

/// The rest of the substep that a frame ends in.
#[derive(Debug, Clone, Copy)]
pub(super) struct Remainder {
    /// How much of it is over, and how much is left, s.
    over: f64,
    pub(super) left: f64,
    gravity: DVec2,
}

/// A way of a ball through what is left of a substep.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    radius: f64,
    from: DVec2,
    pub(super) to: DVec2,
    /// How deep it may come to lie in others, as a part of the smaller radius: none at all where others hold it now.
    deep: f64,
}

impl Remainder {
    /// That of a ball that flies, or stands where it is fixed.
    pub(super) fn way(self, ball: &Ball) -> Way {
        let Self { left, gravity, .. } = self;
        let flown = (ball.velocity + 0.5 * gravity * left) * left;
        let to = if ball.is_fixed() { ball.position } else { ball.position + flown };
        Way { radius: ball.radius, from: ball.position, to, deep: SHIFT }
    }

    /// The velocity at its end of a ball that flies, px/s.
    pub(super) fn last_velocity(self, ball: &Ball) -> DVec2 {
        ball.velocity + self.gravity * self.left
    }

    /// Where the substep would have begun for a ball that is shown as it is, and comes to this place with this velocity at its end;
    /// whether it `flies` there.
    pub(super) fn start(self, ball: &Ball, (to, velocity): (DVec2, DVec2), flies: bool) -> Start {
        let Self { over, left, gravity } = self;
        let share = over / (over + left);
        // What nothing holds is shown so much above the straight line.
        let bent = if flies { 0.5 * over * left * gravity } else { DVec2::ZERO };
        let position = (ball.position + bent - share * to) / (1.0 - share);
        Start::going(position, (ball.velocity - share * velocity) / (1.0 - share))
    }
}

impl Way {
    /// Whether it leads into another ball of this radius that goes from one place to another meanwhile. That is moved by up to so
    /// much beside that way, px.
    fn meets(&self, radius: f64, (from, to): (DVec2, DVec2), beside: f64) -> bool {
        let reach = self.radius + radius + beside - self.deep * self.radius.min(radius);
        let (begin, end) = (self.from - from, self.to - to);
        let way = end - begin;
        let length = way.length_squared();
        let nearest = if length == 0.0 { 0.0 } else { (-begin.dot(way) / length).clamp(0.0, 1.0) };
        let nearest = (begin + way * nearest).length();
        nearest < reach && (self.deep > 0.0 || nearest < begin.length())
    }
}

impl Contact {
    /// What is left of the substep that is shown, where it is not over.
    pub(super) fn remainder(&mut self) -> Option<Remainder> {
        if self.before.is_empty() && self.all_asleep {
            // They have slept through it, and nothing told of it yet.
            self.course.fates.fill(Fate::default());
            self.before = (0..self.bodies.len()).map(|at| self.start_of(at)).collect();
        }
        let (share, substep) = (self.share(), self.setting.substep);
        let is_within = !self.before.is_empty() && share < 1.0 - ROUNDING;
        is_within.then_some(Remainder {
            over: share * substep,
            left: (1.0 - share) * substep,
            gravity: self.setting.gravity,
        })
    }

    /// Whether a ball's way leads out of the walls.
    pub(super) fn leads_out(&self, way: Way) -> bool {
        self.setting.inside(way.to, way.radius) != way.to
    }

    /// Whether a ball's way leads into any other but the body at `but`. `balls` are as they are shown.
    pub(super) fn comes_into(&self, way: Way, balls: &[Ball], but: Option<usize>, left: f64) -> bool {
        let meets = |(at, (body, &id)): (usize, (&Body, &u32))| {
            // What was hit does not go straight.
            let speed = || body.velocity.length().max(self.before[at].velocity.length());
            let beside = if self.course.was_hit(at) { speed() * left } else { 0.0 };
            but != Some(at) && way.meets(body.radius, (balls[id as usize].position, body.position), beside)
        };
        self.pairs && self.bodies.iter().zip(&self.ids).enumerate().any(meets)
    }

    /// Whether a body was hit firmly, or may have been, after what is shown: what it hit then would be hit by nothing if it were thrown.
    pub(super) fn is_hit_later(&self, at: usize) -> bool {
        if !self.course.was_hit(at) {
            return false;
        }
        let (start, body) = (&self.before[at], &self.bodies[at]);
        let [now, last] = match self.course.legs.of_body(at) {
            Some((on, last)) => [on.map_or(Some(start.way), |leg| leg.velocity), last.velocity],
            None => [Some(start.velocity), Some(body.velocity)],
        };
        let turned = now.zip(last).map_or(f64::INFINITY, |(now, last)| now.distance(last));
        turned > self.setting.firm + self.setting.kick.length()
    }

    /// Takes up balls that were added after those that are known, if it can; `balls` are all.
    pub(super) fn add(&mut self, world: &World, balls: &[Ball]) -> bool {
        let known = self.bodies.len();
        let new = &balls[known..];
        let remainder = self.remainder();
        let barred = remainder.is_some_and(|remainder| self.are_barred(new, balls, remainder));
        if barred || self.any_sleeps_in(new) || !self.adapt(world, balls) {
            return false;
        }
        for (at, ball) in new.iter().enumerate() {
            let (mut body, mut start) = (Body::new(ball, self.setting.kick), Start::of(ball));
            if let Some(remainder) = remainder.filter(|_| !ball.is_fixed()) {
                let (to, velocity) = (remainder.way(ball).to, remainder.last_velocity(ball));
                body.go(to, velocity, self.setting.kick);
                start = remainder.start(ball, (to, velocity), true);
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

    /// Whether anything is in the way of any of these balls that are added to those that are known; `balls` are all.
    fn are_barred(&self, added: &[Ball], balls: &[Ball], remainder: Remainder) -> bool {
        if added.len() * balls.len() > MOST_LOOKED_AT {
            return true;
        }
        let ways: Vec<Way> = added.iter().map(|ball| remainder.way(ball)).collect();
        let bars = |(at, (&way, ball)): (usize, (&Way, &Ball))| {
            let meets = |(other, its): (&Way, &Ball)| {
                !(ball.is_fixed() && its.is_fixed()) && way.meets(other.radius, (other.from, other.to), 0.0)
            };
            // Fixed ones may stand in walls.
            let in_wall = !ball.is_fixed() && self.leads_out(way);
            in_wall
                || self.pairs && ways[..at].iter().zip(added).any(meets)
                || self.comes_into(way, balls, None, remainder.left)
        };
        ways.iter().zip(added).enumerate().any(bars)
    }

    /// Gives a ball the velocity that it was given from outside, if it can; `balls` are all, as they are shown.
    pub(super) fn throw(&mut self, balls: &[Ball], index: usize) -> bool {
        let ball = &balls[index];
        if ball.is_fixed() {
            // Nothing moves it.
            return true;
        }
        let Some(at) = self.body_of(index) else { return false };
        let kick = self.setting.kick;
        let place = self.bodies[at].position;
        let Some(remainder) = self.remainder() else {
            self.free_by_hand(at);
            self.bodies[at].go(place, ball.velocity, kick);
            return true;
        };
        let flies = self.flies(at) && !self.before[at].is_let_go;
        let found = self.place_for(at, remainder, balls, flies);
        if (found.is_none() || self.is_hit_later(at)) && self.is_loose() {
            return false;
        }
        let (to, is_flown) = found.unwrap_or((place, false));
        self.free_by_hand(at);
        // What others hold does not fall.
        let velocity = if flies || is_flown { remainder.last_velocity(ball) } else { ball.velocity };
        self.bodies[at].go(to, velocity, kick);
        self.before[at] =
            Start { is_let_go: !(flies || is_flown), ..remainder.start(ball, (to, velocity), true) };
        self.forget_course_of(at);
        let Self { near, bodies, setting, .. } = self;
        // After others were added, all are covered by the next search. Here pairs are linked, since it was freed.
        if let Some(near) = near.as_mut().filter(|near| near.homes.len() == bodies.len()) {
            near.cover_way(at, (to, to), bodies, setting);
        }
        self.show_again(balls);
        true
    }

    /// Where a thrown ball, which flew until now or not, is at the end of the substep that is shown, and whether it flies there; if
    /// there is any place for it that is near enough.
    fn place_for(
        &self,
        at: usize,
        remainder: Remainder,
        balls: &[Ball],
        flies: bool,
    ) -> Option<(DVec2, bool)> {
        let ball = &balls[self.ids[at] as usize];
        let way = Way { deep: if flies { SHIFT } else { 0.0 }, ..remainder.way(ball) };
        let is_free = |to: DVec2| {
            let way = Way { to, ..way };
            !(self.leads_out(way) || self.comes_into(way, balls, Some(at), remainder.left))
        };
        // Where it would have come to otherwise.
        let place = self.bodies[at].position;
        if is_free(way.to) {
            Some((way.to, true))
        } else if place.distance(way.to) <= AWAY * ball.radius {
            Some((place, false))
        } else {
            is_free(ball.position).then_some((ball.position, false))
        }
    }

    /// Whether nothing holds any ball, nor any sleeps: to make the solver anew changes nothing then.
    pub(super) fn is_loose(&self) -> bool {
        !(self.held.iter().any(|held| held.any()) || self.rests.iter().any(|rest| rest.asleep))
    }
}
