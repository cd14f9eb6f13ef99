//! The `exact` solver: event-driven, exact between and at impacts.
//!
//! Between impacts each ball's flight is closed form; impacts are foreseen, kept in one queue, and taken in their order
//! in time (Alder & Wainwright 1959). Each ball holds its state at its own last impact and the earliest of its coming
//! impacts (Lubachevsky 1991); frames evaluate the flights and never write back, so the result does not depend on how
//! time is cut into frames.
//!
//! - `begin`: what is made of the balls at the beginning;
//! - `flights`: what is known of a ball;
//! - `events`: how they are taken in their order in time, year by year;
//! - `foresee`, `meetings`: which event comes next for a ball, on its own way or with others;
//! - `impacts`: what happens at an impact, and how balls come to rest on walls;
//! - `crush`: what becomes of a ball that is hit without end between others;
//! - `together`: what happens where several balls meet at one time;
//! - `settle`, `gather`, `group`, `contacts`, `sweeps`, `interior`: how they come to rest on each other;
//! - `carry`, `means`, `onward`, `blows`, `flurry`, `headway`: how many go on that press on each other until then, and with which
//!   velocities, what becomes of blows on them, what ends their flurries of hits, and which of them are jammed;
//! - `pace`: whether there are more impacts than can be followed;
//! - `pressing`: when it ends because balls press on each other, where `contact` holds these;
//! - `cells`, `swept`, `calendar`: where balls are, and will be, and the queue;
//! - `read_ahead`: how memory is kept from being waited for, where balls are many.

mod begin;
mod blows;
mod calendar;
mod carry;
mod cells;
mod contacts;
mod crush;
mod events;
mod flights;
mod flurry;
mod foresee;
mod gather;
mod group;
mod headway;
mod impacts;
mod interior;
mod means;
mod meetings;
mod onward;
mod pace;
mod pressing;
mod read_ahead;
mod settle;
mod sweeps;
mod swept;
mod together;

use std::fmt::Debug;

use glam::DVec2;

use super::clock::Clock;
use super::world::World;
use super::{Advance, Frame, Part};
pub(super) use begin::counted_rest_speed;
use calendar::Calendar;
use carry::Carry;
use cells::Cells;
use flights::{Flight, Marks, Matter};
pub(super) use pace::Pace;
use pressing::Pressing;
use swept::Swept;

/// The event-driven solver.
///
/// Balls stand here in an order of their own, in which neighbours in space are neighbours in memory: a *slot* is a
/// ball's place in it.
#[derive(Debug, Clone)]
pub(super) struct Exact {
    gravity: DVec2,
    /// The acceleration of a ball by the axes along which nothing accelerates it (see [`Marks::unaccelerated`]).
    pulls: [DVec2; 4],
    size: DVec2,
    walls: Option<f64>,
    /// The low and the high walls, px; at infinity where there are none.
    walls_at: [DVec2; 2],
    rest_speed: f64,
    /// How soon after its last impact a slow one is chatter, s: as long as a hop at the rest speed.
    chatter_time: f64,
    /// What balls have moved at most between two hits that are chatter, px, whatever the rest speed.
    chatter_length: f64,
    /// Whether balls may rest on walls, or be held between them, or are fixed.
    holds: bool,
    /// Which slot each ball is in.
    slots: Vec<u32>,
    flights: Vec<Flight>,
    marks: Vec<Marks>,
    /// One for each slot, or one for all where they are alike.
    matter: Vec<Matter>,
    calendar: Calendar,
    /// Where pairs meet.
    cells: Option<Cells>,
    /// Where there is one cell alone, what each slot's ball sweeps until its next impact; else empty.
    swept: Vec<Swept>,
    /// Where they only fly through each other: whom each slot's ball overlaps now.
    overlaps: Option<Vec<Vec<u32>>>,
    clock: Clock,
    /// When the calendar's year began.
    origin: Clock,
    /// The length of the year, s: a power of two.
    span: f64,
    /// Events of balls in this year: impacts count twice.
    hits: usize,
    /// Balls of which it is known what comes next: less than all at the very beginning alone.
    begun: usize,
    /// When the last event was, s since the year began.
    latest: f64,
    /// When the present run of events at one time, as good as, began, s since the year began.
    instant: f64,
    /// How many events it has had so far.
    at_once: usize,
    /// How slowly events creep on average, s, that may count as at one time.
    creep: f64,
    /// How long, s, events may at most that count as at one time.
    longest_instant: f64,
    /// How impacts keep pace, where it stops once they do not.
    pace: Option<Pace>,
    /// After so many impacts in a row that are chatter a ball has chattered for long.
    long_chatter: u32,
    /// When it stops, where it does once something presses.
    pressing: Option<Pressing>,
    /// Whether a ball that was looked at since this was cleared touches another one.
    beside: bool,
    /// Events taken since the caller's watch was looked at.
    unwatched: u32,
    /// Events that may yet be spent on the search for groups at rest; below 0 it waits.
    credit: i64,
    /// For each slot its place in the group that is looked at.
    found: Vec<u32>,
    /// How balls are carried.
    carry: Carry,
    /// Which held balls lean on which fixed ones.
    propped: Vec<(u32, u32)>,
}

/// A ball that hit another more slowly than so many times the rest speed leans on it, for as long as so many hops at
/// the rest speed: what lies on others is shown as touching them between its hops, too.
const LEAN: f64 = 8.0;

/// What a simulation needs of the solver, decided when that is made: code for the rest is not even compiled in.
trait Needs {
    /// Balls are accelerated, and may rest on walls, be held between them or be fixed.
    const HOLDS: bool;
    /// All balls have one radius, mass and restitution.
    const ALIKE: bool;
    /// They fly through each other.
    const DETECT: bool;
}

struct Need<const HOLDS: bool, const ALIKE: bool, const DETECT: bool>;

impl<const G: bool, const A: bool, const D: bool> Needs for Need<G, A, D> {
    const HOLDS: bool = G;
    const ALIKE: bool = A;
    const DETECT: bool = D;
}

impl Exact {
    fn alike(&self) -> bool {
        self.matter.len() == 1 && self.flights.len() > 1
    }

    #[inline]
    fn matter<N: Needs>(&self, slot: usize) -> &Matter {
        &self.matter[if N::ALIKE { 0 } else { slot }]
    }

    /// A ball's acceleration.
    #[inline]
    fn pull<N: Needs>(&self, slot: usize) -> DVec2 {
        if N::HOLDS { self.pulls[self.marks[slot].unaccelerated()] } else { DVec2::ZERO }
    }

    /// Position and velocity of a ball now.
    #[inline]
    fn state<N: Needs>(&self, slot: usize, now: f64) -> (DVec2, DVec2) {
        let flight = &self.flights[slot];
        // Adding a gravity of zero would take time, too.
        if N::HOLDS { flight.at(now, self.pull::<N>(slot)) } else { flight.straight(now) }
    }

    /// Shows the balls as they are at the clock's time. This evaluates, and never writes back.
    fn show<N: Needs>(&mut self, frame: &mut Frame<'_>) {
        // Stopped by the caller's watch, the clock may be a little behind what has happened: before it, balls were not on
        // their flights from there yet, which come out of a wall or another ball.
        let now = self.clock.shown_since(self.origin).max(self.latest);
        let lean = LEAN * self.chatter_time;
        let since_middle = self.since_middle(now);
        let part = if N::HOLDS { self.shown_part::<N>(since_middle) } else { 1.0 };
        for &(_, prop) in &self.propped {
            self.marks[prop as usize].set(Marks::HIT, true);
        }
        // Flights are read in no order, which takes less time than to write balls in none.
        for ((ball, touches), &slot) in frame.balls.iter_mut().zip(&mut *frame.touching).zip(&self.slots) {
            let slot = slot as usize;
            let (flight, marks) = (&self.flights[slot], self.marks[slot]);
            (ball.position, ball.velocity) = if N::HOLDS {
                flight.at(now, self.pulls[marks.unaccelerated()])
            } else {
                flight.straight(now)
            };
            if N::HOLDS {
                if marks.has(Marks::WAITS) {
                    ball.velocity = self.own_velocity(slot, ball.position);
                } else if self.goes_off(slot) {
                    ball.velocity = self.true_velocity(slot, ball.velocity, since_middle) * part;
                }
            }
            // What is held, or has no room, rests along both axes.
            let leans = marks.has(Marks::LEANS) && (marks.rests() == 3 || now - flight.time < lean);
            let inside = self.overlaps.as_ref().is_some_and(|overlaps| !overlaps[slot].is_empty());
            *touches = leans || inside || marks.has(Marks::HIT);
        }
        for marks in &mut self.marks {
            // What goes along with others touches them in the next frame, too, however soon it is let go of.
            marks.set(Marks::HIT, marks.has(Marks::GOES_ALONG));
        }
    }

    /// The time that it has come to.
    pub(super) fn clock(&self) -> Clock {
        self.clock
    }

    fn advance_as<N: Needs>(
        &mut self,
        frame: &mut Frame<'_>,
        target: Clock,
        go_on: &mut dyn FnMut() -> bool,
    ) {
        self.clock = self.go::<N>(frame, target, go_on);
        self.show::<N>(frame);
    }
}

impl Advance for Exact {
    fn advance(&mut self, frame: &mut Frame<'_>, seconds: f64, go_on: &mut dyn FnMut() -> bool) -> f64 {
        let (from, target) = (self.clock, self.clock.after(seconds));
        match (self.holds, self.alike(), self.overlaps.is_some()) {
            (false, false, false) => self.advance_as::<Need<false, false, false>>(frame, target, go_on),
            (false, true, false) => self.advance_as::<Need<false, true, false>>(frame, target, go_on),
            (true, false, false) => self.advance_as::<Need<true, false, false>>(frame, target, go_on),
            (true, true, false) => self.advance_as::<Need<true, true, false>>(frame, target, go_on),
            (false, _, true) => self.advance_as::<Need<false, false, true>>(frame, target, go_on),
            (true, _, true) => self.advance_as::<Need<true, false, true>>(frame, target, go_on),
        }
        if self.clock == target { seconds } else { self.clock.seconds_since(from) }
    }

    fn parts(&self, world: &World) -> Vec<Part> {
        let mut parts = Part::of_motion(world);
        if let Some(cells) = &self.cells {
            parts.push(if cells.single() { Part::AllPairs } else { Part::Grid });
        }
        if world.walls.is_some() || self.cells.is_some() {
            parts.push(Part::Events);
        }
        if self.cells.is_some() && self.overlaps.is_none() {
            parts.push(Part::Impulse);
        }
        parts
    }

    fn clone_boxed(&self) -> Box<dyn Advance> {
        Box::new(self.clone())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::simulation::Tally;
    use crate::simulation::ball::Ball;
    use crate::simulation::world::Pairs;

    /// Balls and counts after some frames, some of which are cut short by the watch.
    fn played(world: &World, balls: &[Ball], many: bool, boxes: bool) -> (Vec<Ball>, Vec<bool>, Tally) {
        let mut exact = Exact::new(world, balls, 1.0);
        exact.calendar.many = many;
        if !boxes {
            exact.swept.clear();
        }
        let (mut balls, mut touching, mut tally) =
            (balls.to_vec(), vec![false; balls.len()], Tally::default());
        for looks in 0..30 {
            let mut left = looks % 5;
            let mut go_on = || {
                left -= 1;
                left != 0
            };
            let frame = &mut Frame { world, balls: &mut balls, touching: &mut touching, tally: &mut tally };
            exact.advance(frame, 0.02, &mut go_on);
        }
        (balls, touching, tally)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn reading_ahead_and_boxes_change_no_bit(
            kinds in prop_oneof![2..17_usize, 2..300_usize].prop_flat_map(|count| {
                prop::collection::vec((0.0..1.0_f64, -300.0..300.0_f64, -300.0..300.0_f64), count)
            }),
            pull in prop::sample::select(vec![0.0, 0.0, 98.0]),
            ratio in prop::sample::select(vec![1.0, 3.0, 30.0]),
            pairs in prop::sample::select(vec![None, Some(Pairs::Detect), Some(Pairs::Impulse)]),
            walled: bool,
        ) {
            let columns = (kinds.len() as f64).sqrt().ceil() as usize;
            let ball = |(at, &(size, x, y)): (usize, &(f64, f64, f64))| {
                let place = DVec2::new((at % columns) as f64 + 0.5, (at / columns) as f64 + 0.5) * 12.0;
                let ball = Ball::new(place, 5.5 * f64::powf(ratio, -size).max(0.2)).unwrap();
                ball.with_velocity(DVec2::new(x, y)).unwrap()
            };
            let balls: Vec<Ball> = kinds.iter().enumerate().map(ball).collect();
            let mut world = World::new(DVec2::splat(12.0 * columns as f64)).unwrap();
            if walled {
                world = world.with_walls(0.9).unwrap();
            }
            if pull > 0.0 {
                world = world.with_gravity(DVec2::new(0.0, pull)).unwrap();
            }
            if let Some(pairs) = pairs {
                world = world.with_pairs(pairs);
            }
            let usual = played(&world, &balls, false, true);
            prop_assert_eq!(&played(&world, &balls, true, true), &usual);
            prop_assert_eq!(&played(&world, &balls, false, false), &usual);
        }
    }
}
