//! The `exact` solver: event-driven, exact between and at impacts.
//!
//! Between impacts each ball's flight is closed form; impacts are foreseen, kept in one queue, and taken in their order
//! in time. Each ball holds its state at its own last impact and the earliest of its coming impacts; frames evaluate the
//! flights and never write back, so the result does not depend on how time is cut into frames.
//!
//! A ball rests on a wall that gravity presses it to when it would bounce off more slowly than [`REST_SPEED`]. Impacts
//! of balls below that speed that follow each other within [`Exact::chatter`] seconds lose nothing, so that
//! inelastic collapse (`McNamara` & Young 1992) ends: the TC model of Luding & `McNamara` (1998).

mod cells;
mod clock;

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use glam::DVec2;

use super::ball::Ball;
use super::flight::{self, NEVER, Pair};
use super::grid::Grid;
use super::impulse::exact_impact;
use super::world::{Pairs, World};
use super::{Advance, Frame, Part};
use cells::Cells;
use clock::Clock;

/// Below this speed of bouncing, px/s, balls come to rest on walls, and chattering balls lose nothing. A hop that is
/// left out is u²/2g high: half a thousandth of a pixel under the demo's gravity.
pub const REST_SPEED: f64 = 1.0;
/// The part of [`REST_SPEED`] below which even a wall of restitution 1 holds a ball, since its hops are too many.
const CONSERVATIVE: f64 = 0.01;
/// The part of [`REST_SPEED`] that a ball bounces off one that rests with, at least, while it chatters.
const LEAST_HOP: f64 = 0.25;
/// The gravity that sets the time scale of chatter where there is none, px/s².
const EARTH: f64 = 980.0;
/// Times are relative to an origin that moves on by this much, s, at fixed times: their digits never run out.
const EPOCH: f64 = 0.25;

/// A ball's flight since its last impact, and what will end it.
#[derive(Debug, Clone, Copy)]
struct Flight {
    position: DVec2,
    velocity: DVec2,
    acceleration: DVec2,
    /// When the flight began, s since the origin.
    time: f64,
    /// How many flights the ball has had: what was foreseen for one does not hold for the next.
    number: u64,
    /// The earliest impact foreseen.
    impact: f64,
    against: Against,
}

/// What a ball will hit.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Against {
    Nothing,
    /// A wall across an axis, at the high or the low end.
    Wall {
        axis: usize,
        high: bool,
    },
    /// Another ball, in its flight of this number.
    Ball {
        index: usize,
        number: u64,
    },
}

/// An entry of the queue. It holds if its ball still has that impact, or that border, ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Event {
    time: f64,
    ball: u32,
    crossing: bool,
}

impl Eq for Event {}

impl PartialOrd for Event {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Event {
    fn cmp(&self, other: &Self) -> Ordering {
        let order = self.time.total_cmp(&other.time);
        order.then(self.ball.cmp(&other.ball)).then(self.crossing.cmp(&other.crossing))
    }
}

/// The event-driven solver.
#[derive(Debug)]
pub(super) struct Exact {
    gravity: DVec2,
    walls: Option<f64>,
    flights: Vec<Flight>,
    queue: BinaryHeap<Reverse<Event>>,
    /// Where pairs exchange momentum.
    cells: Option<Cells>,
    /// Where they are only detected.
    grid: Option<Grid>,
    clock: Clock,
    origin: Clock,
    begun: bool,
}

impl Exact {
    pub(super) fn new(world: &World, balls: &[Ball]) -> Self {
        let gravity = world.gravity.unwrap_or_default();
        let flight = |ball: &Ball| Flight {
            position: ball.position,
            velocity: ball.velocity,
            acceleration: gravity,
            time: 0.0,
            number: 0,
            impact: NEVER,
            against: Against::Nothing,
        };
        let several = balls.len() > 1;
        Self {
            gravity,
            walls: world.walls,
            flights: balls.iter().map(flight).collect(),
            queue: BinaryHeap::new(),
            cells: (several && world.pairs == Some(Pairs::Impulse)).then(|| Cells::new(world, balls)),
            grid: (several && world.pairs == Some(Pairs::Detect)).then(|| Grid::new(balls, world.size)),
            clock: Clock::default(),
            origin: Clock::default(),
            begun: false,
        }
    }

    /// How soon after its last impact a slow one is chatter, s: as long as a hop at [`REST_SPEED`].
    fn chatter(&self) -> f64 {
        let gravity = self.gravity.length();
        2.0 * REST_SPEED / if gravity > 0.0 { gravity } else { EARTH }
    }

    /// Takes all events up to `until`, s since the origin.
    fn run(&mut self, frame: &mut Frame<'_>, until: f64) {
        while let Some(Reverse(event)) = self.queue.peek().copied().filter(|next| next.0.time <= until) {
            self.queue.pop();
            let (ball, now) = (event.ball as usize, event.time);
            if event.crossing {
                self.cross(frame, ball, now);
            } else if self.flights[ball].impact == now {
                match self.flights[ball].against {
                    Against::Nothing => {}
                    Against::Wall { axis, high } => self.hit_wall(frame, ball, axis, high, now),
                    Against::Ball { index, number } if self.flights[index].number == number => {
                        self.collide(frame, ball, index, now);
                    }
                    // The other has been turned away before.
                    Against::Ball { .. } => self.foresee(frame, ball, now),
                }
            }
        }
    }

    /// Moves the origin of time on.
    fn rebase(&mut self) {
        self.origin.add(EPOCH);
        self.queue.clear();
        for flight in &mut self.flights {
            flight.time -= EPOCH;
            flight.impact -= EPOCH;
        }
        for ball in 0..self.flights.len() {
            self.schedule(ball, 0.0);
        }
    }

    /// Position and velocity of a ball now.
    fn state(&self, ball: usize, now: f64) -> (DVec2, DVec2) {
        let flight = &self.flights[ball];
        let since = now - flight.time;
        (
            flight::position(flight.position, flight.velocity, flight.acceleration, since),
            flight.velocity + flight.acceleration * since,
        )
    }

    /// Begins a new flight of a ball.
    fn set_out(&mut self, ball: usize, position: DVec2, velocity: DVec2, now: f64) {
        let flight = &mut self.flights[ball];
        flight.position = position;
        flight.velocity = velocity;
        flight.time = now;
        flight.number += 1;
        flight.impact = NEVER;
        flight.against = Against::Nothing;
    }

    /// Finds a ball's earliest impact from now on, and whose earliest that is too.
    fn foresee(&mut self, frame: &Frame<'_>, ball: usize, now: f64) {
        self.flights[ball].impact = NEVER;
        self.flights[ball].against = Against::Nothing;
        self.foresee_walls(frame, ball);
        self.foresee_balls(frame, ball, now);
        self.schedule(ball, now);
    }

    fn foresee_walls(&mut self, frame: &Frame<'_>, ball: usize) {
        if self.walls.is_none() {
            return;
        }
        let flight = &mut self.flights[ball];
        let radius = frame.balls[ball].radius;
        for axis in 0..2 {
            let (at, speed, pull) = (flight.position[axis], flight.velocity[axis], flight.acceleration[axis]);
            for high in [false, true] {
                // From the flight's beginning, so that the time is the same whenever it is asked for.
                let time = flight.time
                    + if high {
                        flight::reach(frame.world.size[axis] - radius - at, speed, pull)
                    } else {
                        flight::reach(at - radius, -speed, -pull)
                    };
                if time < flight.impact {
                    flight.impact = time;
                    flight.against = Against::Wall { axis, high };
                }
            }
        }
    }

    fn foresee_balls(&mut self, frame: &Frame<'_>, ball: usize, now: f64) {
        let Some(cells) = &self.cells else { return };
        let (position, velocity) = self.state(ball, now);
        let (acceleration, number) = (self.flights[ball].acceleration, self.flights[ball].number);
        let (mut best, mut partner) = (self.flights[ball].impact, None);
        cells.for_each_near(ball, |index| {
            let (other, other_velocity) = self.state(index, now);
            let pair = Pair {
                distance: other - position,
                velocity: other_velocity - velocity,
                reach: frame.balls[ball].radius + frame.balls[index].radius,
                own: velocity,
            };
            let relative = self.flights[index].acceleration - acceleration;
            let time = now
                + if relative == DVec2::ZERO {
                    pair.meet()
                } else {
                    pair.meet_accelerated(relative, best - now)
                };
            if time < best && time < self.flights[index].impact {
                best = time;
                partner = Some(index);
            }
        });
        if let Some(index) = partner {
            let other = &mut self.flights[index];
            other.impact = best;
            other.against = Against::Ball { index: ball, number };
            let number = other.number;
            self.flights[ball].impact = best;
            self.flights[ball].against = Against::Ball { index, number };
            self.queue.push(Reverse(Event { time: best, ball: index as u32, crossing: false }));
        }
    }

    /// Puts what comes first for a ball into the queue.
    fn schedule(&mut self, ball: usize, now: f64) {
        let impact = self.flights[ball].impact;
        let (border, ..) = self.next_border(ball, now);
        let (time, crossing) = if border < impact { (border, true) } else { (impact, false) };
        if time < EPOCH {
            self.queue.push(Reverse(Event { time, ball: ball as u32, crossing }));
        }
    }

    /// When a ball leaves its cell, along which axis, and whether upward.
    fn next_border(&self, ball: usize, now: f64) -> (f64, usize, bool) {
        let Some(cells) = &self.cells else { return (NEVER, 0, false) };
        let flight = &self.flights[ball];
        let (low, high) = cells.borders(ball);
        let mut first = (NEVER, 0, false);
        for axis in 0..2 {
            let (at, speed, pull) = (flight.position[axis], flight.velocity[axis], flight.acceleration[axis]);
            for up in [false, true] {
                let gap = if up { high[axis] - at } else { at - low[axis] };
                if gap.is_finite() {
                    let sign = if up { 1.0 } else { -1.0 };
                    let time = flight.time + flight::reach(gap, sign * speed, sign * pull);
                    // A border that was crossed on the way out is behind.
                    if time >= now && time < first.0 {
                        first = (time, axis, up);
                    }
                }
            }
        }
        first
    }

    fn cross(&mut self, frame: &Frame<'_>, ball: usize, now: f64) {
        let (time, axis, up) = self.next_border(ball, now);
        if time == now
            && let Some(cells) = &mut self.cells
        {
            cells.cross(ball, axis, up);
            self.foresee_balls(frame, ball, now);
            self.schedule(ball, now);
        }
    }

    fn hit_wall(&mut self, frame: &mut Frame<'_>, ball: usize, axis: usize, high: bool, now: f64) {
        let (mut position, mut velocity) = self.state(ball, now);
        let radius = frame.balls[ball].radius;
        let wall = if high { frame.world.size[axis] - radius } else { radius };
        // The root says that it is there; a ball that began beyond the wall stays where it is.
        if (position[axis] - wall).abs() < 1e-6 {
            position[axis] = wall;
        }
        let sign = if high { 1.0 } else { -1.0 };
        let (speed, restitution) = (sign * velocity[axis], self.walls.unwrap_or_default());
        frame.tally.wall_hits += u64::from(speed > 0.0);
        let jammed = frame.world.size[axis] - 2.0 * radius < 1e-6;
        let least = if restitution < 1.0 { REST_SPEED } else { CONSERVATIVE * REST_SPEED };
        if jammed || (sign * self.gravity[axis] > 0.0 && restitution * speed < least) {
            velocity[axis] = 0.0;
            self.flights[ball].acceleration[axis] = 0.0;
        } else {
            let slow = speed < REST_SPEED && self.hit_lately(ball, now);
            velocity[axis] *= if slow { -1.0 } else { -restitution };
        }
        self.set_out(ball, position, velocity, now);
        self.foresee(frame, ball, now);
    }

    /// Whether a ball's last impact is so recent that another is chatter.
    fn hit_lately(&self, ball: usize, now: f64) -> bool {
        self.flights[ball].number > 0 && now - self.flights[ball].time < self.chatter()
    }

    fn collide(&mut self, frame: &mut Frame<'_>, one: usize, other: usize, now: f64) {
        let ((p1, v1), (p2, v2)) = (self.state(one, now), self.state(other, now));
        let (first, second) = (frame.balls[one], frame.balls[other]);
        let (distance, velocity) = (p1 - p2, v1 - v2);
        let approach = -velocity.dot(distance) / distance.length().max(f64::MIN_POSITIVE);
        let mut e = first.restitution.min(second.restitution);
        if approach < REST_SPEED && (self.hit_lately(one, now) || self.hit_lately(other, now)) {
            e = 1.0;
        }
        let free = (DVec2::splat(first.mass.recip()), DVec2::splat(second.mass.recip()));
        let pressed = self.flights[one].acceleration != self.flights[other].acceleration;
        let least = LEAST_HOP * REST_SPEED;
        // A ball that rests on a wall is held by it, unless the blow is so hard that it bounces.
        let changes = exact_impact(distance, velocity, free, e).and_then(|(c1, c2)| {
            let yields = (free.0 * self.gives(one, c1), free.1 * self.gives(other, c2));
            exact_impact(distance, velocity, yields, e).map(|changes| {
                // At rest on one that rests: hop, or the contact would close again at once, for ever.
                if pressed && approach < least && approach > 0.0 {
                    let more = (approach + least) / (2.0 * approach);
                    (changes.0 * more, changes.1 * more)
                } else if pressed && approach <= 0.0 {
                    let away = distance * (-least / distance.length().max(f64::MIN_POSITIVE));
                    exact_impact(distance, away, yields, 0.0).unwrap_or(changes)
                } else {
                    changes
                }
            })
        });
        if let Some((c1, c2)) = changes {
            self.lift(one, c1);
            self.lift(other, c2);
            self.set_out(one, p1, v1 + c1, now);
            self.set_out(other, p2, v2 + c2, now);
        } else {
            self.set_out(one, p1, v1, now);
            self.set_out(other, p2, v2, now);
        }
        frame.tally.impacts += 1;
        frame.touching[one] = true;
        frame.touching[other] = true;
        self.foresee(frame, one, now);
        self.foresee(frame, other, now);
    }

    /// Along which axes a ball can take a change of velocity: 0 where it would be pressed into the wall it rests on.
    fn gives(&self, ball: usize, change: DVec2) -> DVec2 {
        let mut gives = DVec2::ONE;
        for axis in 0..2 {
            let rests = self.flights[ball].acceleration[axis] == 0.0 && self.gravity[axis] != 0.0;
            let into = change[axis] * self.gravity[axis].signum();
            if rests && into >= 0.0 && self.walls.unwrap_or_default() * into < REST_SPEED {
                gives[axis] = 0.0;
            }
        }
        gives
    }

    /// A ball that is given a speed across the wall it rests on flies again.
    fn lift(&mut self, ball: usize, change: DVec2) {
        for axis in 0..2 {
            if change[axis] != 0.0 {
                self.flights[ball].acceleration[axis] = self.gravity[axis];
            }
        }
    }
}

impl Advance for Exact {
    fn advance(&mut self, frame: &mut Frame<'_>, seconds: f64) {
        frame.touching.fill(false);
        if !self.begun {
            self.begun = true;
            for ball in 0..self.flights.len() {
                self.foresee(frame, ball, 0.0);
            }
        }
        self.clock.add(seconds);
        let mut until = self.clock.shown_since(self.origin);
        while until >= EPOCH {
            self.run(frame, EPOCH);
            self.rebase();
            until = self.clock.shown_since(self.origin);
        }
        self.run(frame, until);
        // What is shown is evaluated, never written back.
        for (ball, flight) in frame.balls.iter_mut().zip(&self.flights) {
            let since = until - flight.time;
            ball.position = flight::position(flight.position, flight.velocity, flight.acceleration, since);
            ball.velocity = flight.velocity + flight.acceleration * since;
        }
        if let Some(grid) = &mut self.grid {
            let Frame { balls, touching, .. } = frame;
            grid.for_each(balls, |i, j| {
                touching[i as usize] = true;
                touching[j as usize] = true;
            });
        }
    }

    fn parts(&self, world: &World) -> Vec<Part> {
        let mut parts = vec![Part::Motion];
        if world.gravity.is_some() {
            parts.push(Part::Gravity);
        }
        if world.walls.is_some() {
            parts.push(Part::Walls);
        }
        if self.grid.is_some() {
            parts.push(Part::Grid);
        }
        if self.cells.is_some() {
            parts.push(Part::Grid);
            parts.push(Part::Impulse);
        }
        if world.walls.is_some() || self.cells.is_some() {
            parts.push(Part::Events);
        }
        parts
    }
}
