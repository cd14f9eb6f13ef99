//! How a simulation begins: what is made of the balls, their order, cells and first events.

use glam::DVec2;

use crate::simulation::ball::Ball;
use crate::simulation::clock::Clock;
use crate::simulation::grid::Grid;
use crate::simulation::invariants::free;
use crate::simulation::limits::DEFAULT_REST_SPEED;
use crate::simulation::world::{Pairs, World};

use super::calendar::Calendar;
use super::carry::Carry;
use super::cells::Cells;
use super::events::{CREEP, LONGEST_INSTANT, LONGEST_YEAR, MANY, SHORTEST_YEAR};
use super::flights::{Flight, Marks, Matter};
use super::swept::Swept;
use super::{Exact, Needs, impacts};

/// What balls move at most between two hits that are chatter, as a part of the smallest radius.
const CHATTER_LENGTH: f64 = 1e-3;

impl Exact {
    pub(in crate::simulation) fn new(world: &World, balls: &[Ball], rest_speed: f64) -> Self {
        let gravity = world.gravity.unwrap_or_default();
        let smallest = smallest_radius(balls);
        let least_usual = counted_rest_speed(rest_speed.max(DEFAULT_REST_SPEED), gravity, balls);
        let rest_speed = counted_rest_speed(rest_speed, gravity, balls);
        let has_pairs = balls.len() > 1 && world.pairs.is_some();
        let ids = if has_pairs { by_place(world, balls) } else { (0..balls.len() as u32).collect() };
        let mut exact = Self {
            gravity,
            pulls: pulls(gravity),
            size: world.size,
            walls: world.walls,
            walls_at: match world.walls {
                Some(_) => [DVec2::ZERO, world.size],
                None => [DVec2::NEG_INFINITY, DVec2::INFINITY],
            },
            rest_speed,
            chatter_time: hop_time(rest_speed, gravity),
            chatter_length: CHATTER_LENGTH * smallest,
            holds: gravity != DVec2::ZERO,
            slots: inverse(&ids),
            flights: in_order(balls, &ids).map(|ball| Flight::new(ball.position, ball.velocity)).collect(),
            marks: vec![Marks::default(); balls.len()],
            matter: in_order(balls, &ids).map(Matter::of).collect(),
            calendar: Calendar::new(balls.len()),
            // Anew, since the balls have another order now.
            cells: has_pairs.then(|| cells_of(world, in_order(balls, &ids))),
            overlaps: (world.pairs == Some(Pairs::Detect)).then(|| vec![Vec::new(); balls.len()]),
            swept: Vec::new(),
            clock: Clock::default(),
            origin: Clock::default(),
            span: first_span(world, balls),
            hits: 0,
            begun: 0,
            latest: 0.0,
            instant: 0.0,
            at_once: 0,
            longest_instant: LONGEST_INSTANT * hop_time(least_usual, gravity),
            creep: CREEP / balls.len().max(MANY) as f64,
            pace: None,
            long_chatter: Marks::MOST_CHATTER,
            pressing: None,
            unwatched: 0,
            credit: 0,
            beside: false,
            found: Vec::new(),
            carry: Carry::new(
                hop_time(rest_speed, gravity),
                world.walls.is_some() || balls.iter().any(Ball::is_fixed),
                free(balls).count(),
            ),
            propped: Vec::new(),
        };
        if exact.overlaps.is_none() && exact.matter.iter().all(|matter| *matter == exact.matter[0]) {
            exact.matter.truncate(1);
        }
        if exact.cells.as_ref().is_some_and(Cells::single) {
            exact.swept = vec![Swept::ALL; balls.len()];
        }
        exact.hold_immovable(in_order(balls, &ids));
        exact
    }

    /// The same solver at a later time, at which its balls are as they are.
    pub(in crate::simulation) fn starting_at(self, clock: Clock) -> Self {
        // The balls are as they were shown; what is left of that time differs with the frames that it is the sum of.
        Self { clock, origin: clock.shown(), ..self }
    }

    /// Lays to rest what cannot move: what has no room between walls, and fixed balls, which no impact lifts either.
    fn hold_immovable<'a>(&mut self, balls: impl Iterator<Item = &'a Ball>) {
        for (slot, ball) in balls.enumerate() {
            for axis in 0..2 {
                let held = ball.is_fixed() || self.jams(ball.radius, axis);
                self.marks[slot].set(Marks::rests_on(axis), held);
                self.holds |= held;
            }
        }
    }

    /// Foresees the first event of each ball, before anything has moved, and returns whether that is done: a crowd at
    /// one place takes long, and may be gone on with later.
    pub(super) fn begin<N: Needs>(&mut self, balls: &[Ball], go_on: &mut dyn FnMut() -> bool) -> bool {
        if self.begun == 0 {
            self.place_all::<N>(balls);
        }
        while self.begun < self.flights.len() {
            if !self.has_time(go_on) {
                return false;
            }
            self.foresee::<N>(self.begun, 0.0);
            self.begun += 1;
        }
        true
    }

    /// Puts all balls into their cells, and finds out which overlap from the beginning.
    fn place_all<N: Needs>(&mut self, balls: &[Ball]) {
        self.calendar.begin(self.span);
        if let Some(cells) = &mut self.cells {
            for (slot, flight) in self.flights.iter_mut().enumerate() {
                flight.place = cells.place(slot, flight.position);
                cells.put::<N>(slot, flight.place);
            }
        }
        if let Some(overlaps) = &mut self.overlaps {
            let balls: Vec<Ball> = in_order(balls, &inverse(&self.slots)).copied().collect();
            Grid::new(&balls, self.size).for_each(&balls, |i, j| {
                // Fixed balls do not notice each other.
                if !(balls[i as usize].is_fixed() && balls[j as usize].is_fixed()) {
                    overlaps[i as usize].push(j);
                    overlaps[j as usize].push(i);
                }
            });
            for others in overlaps {
                others.sort_unstable();
            }
        }
    }
}

/// A ball for each slot: neighbours in space have neighbouring ones.
fn by_place(world: &World, balls: &[Ball]) -> Vec<u32> {
    let cells = cells_of(world, balls.iter());
    let mut ids: Vec<u32> = (0..balls.len() as u32).collect();
    ids.sort_by_cached_key(|&id| cells.morton_code(id as usize, balls[id as usize].position));
    ids
}

/// A slot for each ball, where this is a ball for each slot; and back.
fn inverse(of: &[u32]) -> Vec<u32> {
    let mut inverse = vec![0; of.len()];
    (0..).zip(of).for_each(|(place, &number)| inverse[number as usize] = place);
    inverse
}

/// The balls by their slots.
fn in_order<'a>(balls: &'a [Ball], ids: &'a [u32]) -> impl Iterator<Item = &'a Ball> {
    ids.iter().map(|&id| &balls[id as usize])
}

/// Empty cells for these balls.
fn cells_of<'a>(world: &World, balls: impl Iterator<Item = &'a Ball>) -> Cells {
    let radii: Vec<f64> = balls.map(|ball| ball.radius).collect();
    Cells::new(world, &radii)
}

/// The acceleration of a ball by the axes on which it rests.
fn pulls(gravity: DVec2) -> [DVec2; 4] {
    [0, 1, 2, 3].map(|rests| {
        let free = |axis: usize| if rests & (1 << axis) == 0 { gravity[axis] } else { 0.0 };
        DVec2::new(free(0), free(1))
    })
}

/// The rest speed as it counts, px/s. It is meant for the demo's gravity; stronger gravity raises it in proportion, so
/// that hops last as long, and are as many in a second. But hops that are left out are never to be seen: where gravity
/// is weak, or balls are tiny, it is lowered until they rise by no more than a hundredth of the smallest radius of a
/// ball that moves.
pub(in crate::simulation) fn counted_rest_speed(asked: f64, gravity: DVec2, balls: &[Ball]) -> f64 {
    if gravity == DVec2::ZERO {
        return asked;
    }
    let strength = gravity.length();
    let unseen = (2.0 * strength * 0.01 * smallest_radius(balls)).sqrt();
    (asked * (strength / impacts::EARTH).max(1.0)).min(unseen)
}

/// How long a hop at this speed lasts, s; where there is no gravity, under the demo's.
pub(super) fn hop_time(speed: f64, gravity: DVec2) -> f64 {
    let strength = gravity.length();
    2.0 * speed / if strength > 0.0 { strength } else { impacts::EARTH }
}

/// The smallest radius of a ball that moves, px; infinite where none does.
fn smallest_radius(balls: &[Ball]) -> f64 {
    free(balls).fold(f64::INFINITY, |low, ball| low.min(ball.radius))
}

/// The length of the first year, s: about the time between two impacts of a ball.
fn first_span(world: &World, balls: &[Ball]) -> f64 {
    let count = balls.len().max(1) as f64;
    let energy = balls.iter().map(|ball| ball.velocity.length_squared()).sum::<f64>() / count;
    let free = (world.size.x * world.size.y / count).sqrt();
    let speed = energy.sqrt() + (world.gravity.unwrap_or_default().length() * free).sqrt();
    // By comparison, not by a logarithm, whose last bit differs from machine to machine.
    let spans = std::iter::successors(Some(SHORTEST_YEAR), |span| Some(span * 2.0));
    // Where nothing moves any length will do.
    spans.take_while(|&span| span < LONGEST_YEAR).find(|span| span * speed >= free).unwrap_or(1.0)
}
