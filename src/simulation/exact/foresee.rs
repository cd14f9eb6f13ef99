//! What comes next for a ball: the earliest of its impacts on walls and other balls, and of the borders that it
//! crosses.

use std::hint::black_box;

use glam::DVec2;

use crate::simulation::flight::{self, NEVER, Pair};
use crate::simulation::lesser::lesser;

use super::calendar::{Entry, READ_AHEAD};
use super::cells::{Border, END, MOST_HEADS};
use super::flights::{Against, Marks};
use super::together::AT_HAND;
use super::{Exact, Needs};

/// So many balls near a ball count as one event more for the caller's watch: each of them costs a root.
const NEAR_PER_EVENT: u32 = 16;

/// What a ball's own flight leads to, whatever the others do.
#[derive(Debug, Clone, Copy)]
struct Ahead {
    /// When it hits a wall, and which.
    impact: f64,
    wall: Against,
    /// When it leaves its cell, and where.
    crossing: f64,
    border: Border,
}

impl Ahead {
    const NOTHING: Self = Self {
        impact: NEVER,
        wall: Against::NOTHING,
        crossing: NEVER,
        border: Border { axis: 0, up: false },
    };

    /// Takes the crossing of a border instead, where that is earlier.
    #[inline]
    fn or_cross(&mut self, time: f64, border: Border) {
        if time < self.crossing {
            (self.crossing, self.border) = (time, border);
        }
    }

    /// Takes the impact on a wall instead, where that is earlier.
    #[inline]
    fn or_hit(&mut self, time: f64, Border { axis, up }: Border) {
        if time < self.impact {
            (self.impact, self.wall) = (time, Against::wall(axis, up));
        }
    }
}

/// Balls near those of the next events: for each of these at most one in each cell.
struct Slots {
    slots: [u32; MOST_HEADS * READ_AHEAD],
    count: usize,
}

impl Slots {
    fn new() -> Self {
        Self { slots: [END; MOST_HEADS * READ_AHEAD], count: 0 }
    }

    /// Adds one, unless it is [`END`]: which of the two no branch could foretell.
    #[inline]
    fn push(&mut self, slot: u32) {
        self.slots[self.count] = slot;
        self.count += usize::from(slot != END);
    }

    fn iter(&self) -> impl Iterator<Item = usize> {
        self.slots[..self.count].iter().map(|&slot| slot as usize)
    }
}

impl Exact {
    /// Finds a ball's earliest impact from now on, and whose earliest that is too.
    pub(super) fn foresee<N: Needs>(&mut self, slot: usize, now: f64) {
        let before = self.hide::<N>(slot);
        self.foresee_hidden::<N>(slot, now);
        self.reveal(slot, before);
    }

    /// The same for two balls that have just hit each other.
    #[inline]
    pub(super) fn foresee_both<N: Needs>(&mut self, one: usize, other: usize, now: f64) {
        // All but always they part now, in straight flight beside each other: that needs no proof by the roots, twice.
        let beside = !N::HOLDS || self.marks[one].rests() == self.marks[other].rests();
        let parts = beside && !N::DETECT && self.pair::<N>(one, other, now).parts_from_touch();
        if parts {
            let before = (self.hide::<N>(one), self.hide::<N>(other));
            self.foresee_hidden::<N>(one, now);
            self.foresee_hidden::<N>(other, now);
            self.reveal(other, before.1);
            self.reveal(one, before.0);
        } else {
            self.foresee::<N>(one, now);
            self.foresee::<N>(other, now);
        }
    }

    /// Takes a ball out of its cell for a while: nobody meets itself.
    #[inline]
    fn hide<N: Needs>(&mut self, slot: usize) -> usize {
        let place = self.flights[slot].place;
        self.cells.as_mut().map_or(0, |cells| cells.hide::<N>(slot, place))
    }

    /// Puts it back.
    #[inline]
    fn reveal(&mut self, slot: usize, before: usize) {
        if let Some(cells) = &mut self.cells {
            cells.reveal(slot, before);
        }
    }

    /// Foresees what comes next for a ball that is hidden, and does not meet others that are.
    #[inline]
    fn foresee_hidden<N: Needs>(&mut self, slot: usize, now: f64) {
        let flight = &mut self.flights[slot];
        (flight.impact, flight.against) = (NEVER, Against::NOTHING);
        self.find_next::<N>(slot, now, None);
    }

    /// Takes a ball over the border of its cell. Its flight stays as it is, and so does the impact foreseen, unless one
    /// in the cells that have come near is earlier.
    pub(super) fn cross<N: Needs>(&mut self, slot: usize, now: f64) {
        let border = self.marks[slot].border();
        let Some(cells) = &mut self.cells else { return };
        let from = self.flights[slot].place;
        self.flights[slot].place = cells.cross::<N>(slot, from, border);
        self.find_next::<N>(slot, now, Some(border));
    }

    /// Finds what comes next for a ball, where that is earlier than the impact that it has ahead, and writes it down. Where
    /// it crosses a border now, only what has come near by that is looked at.
    ///
    /// One function for all of it, and not inlined: what a ball needs stays in registers, from one step to the next.
    #[inline(never)]
    fn find_next<N: Needs>(&mut self, slot: usize, now: f64, crossed: Option<Border>) {
        let ahead = self.ahead::<N>(slot, now, crossed);
        let flight = &mut self.flights[slot];
        if ahead.impact < flight.impact {
            (flight.impact, flight.against) = (ahead.impact, ahead.wall);
        }
        self.meet_others::<N>(slot, now, crossed);
        self.write_next::<N>(slot, &ahead);
    }

    /// Reads nearly all that the next events will look at: their balls, then the cells near these, then who is in them.
    /// Each event alone would wait for memory at every step; asked for one step of all events at once, memory answers
    /// many times as fast.
    #[inline(never)]
    pub(super) fn read_ahead(&mut self) {
        let Self { cells, calendar, flights, marks, .. } = self;
        let events = calendar.read();
        let Some(cells) = cells else { return };
        // What is read is good for nothing else, but the compiler must not know.
        let mut read = 0;
        for &Entry { ball, .. } in events {
            let slot = ball as usize;
            read ^=
                flights[slot].event.to_bits() ^ marks[slot].rests() as u64 ^ u64::from(cells.behind(slot));
        }
        // Balls at the head of their cells, and those behind them; hardly any is third.
        let mut near = Slots::new();
        for &Entry { time, ball } in events {
            let slot = ball as usize;
            let flight = &flights[slot];
            // What no longer holds crosses nothing: it may be bound for a wall.
            let crosses = (flight.event == time && flight.impact != time).then(|| marks[slot].border());
            cells.heads_near(slot, flight.place, crosses, |head| near.push(head));
        }
        let mut second = Slots::new();
        for slot in near.iter() {
            read ^= flights[slot].event.to_bits();
            second.push(cells.behind(slot));
        }
        for slot in second.iter() {
            read ^= flights[slot].event.to_bits() ^ u64::from(cells.behind(slot));
        }
        black_box(read);
    }

    /// Whether two balls that fly through each other overlap now.
    fn overlap(&self, slot: usize, other: usize) -> bool {
        self.overlaps.as_ref().is_some_and(|overlaps| overlaps[slot].binary_search(&(other as u32)).is_ok())
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

    /// Writes what comes first for a ball into the calendar.
    #[inline]
    fn write_next<N: Needs>(&mut self, slot: usize, ahead: &Ahead) {
        let flight = &mut self.flights[slot];
        let event = lesser(flight.impact, ahead.crossing);
        flight.event = event;
        self.marks[slot].set_border(ahead.border);
        self.calendar.write(event, slot as u32);
    }

    /// Walls, where the ball is in a cell at the edge, and the borders of its cell. Where it comes over a border now,
    /// that is `crossed`.
    #[inline]
    fn ahead<N: Needs>(&self, slot: usize, now: f64, crossed: Option<Border>) -> Ahead {
        if !N::HOLDS {
            return self.straight_ahead::<N>(slot);
        }
        let mut ahead = Ahead::NOTHING;
        for (axis, up) in [(0, false), (0, true), (1, false), (1, true)] {
            self.look::<N>(slot, now, Border { axis, up }, crossed, &mut ahead);
        }
        ahead
    }

    /// The same in straight flight, where each axis has one side ahead. Which of the two is reached first no processor
    /// can foretell: there is no branch for it.
    #[inline]
    fn straight_ahead<N: Needs>(&self, slot: usize) -> Ahead {
        let flight = &self.flights[slot];
        let borders = [0, 1].map(|axis| Border { axis, up: flight.velocity[axis] > 0.0 });
        let inner = self.cells.as_ref().and_then(|cells| cells.inner_lines::<N>(slot, flight.place, borders));
        // Nearly always, where there are many cells.
        let Some(lines) = inner else { return self.straight_at_edge::<N>(slot, borders) };
        let [x, y] = [self.arrive(slot, 0, lines[0]), self.arrive(slot, 1, lines[1])];
        Ahead { crossing: lesser(x, y), border: borders[usize::from(y < x)], ..Ahead::NOTHING }
    }

    /// The same where one of the sides, or both, are walls.
    #[inline(never)]
    fn straight_at_edge<N: Needs>(&self, slot: usize, borders: [Border; 2]) -> Ahead {
        let radius = self.matter::<N>(slot).radius;
        let mut ahead = Ahead::NOTHING;
        for border in borders {
            let Border { axis, up } = border;
            let line =
                self.cells.as_ref().map(|cells| cells.line::<N>(slot, self.flights[slot].place, border));
            if let Some((line, false)) = line {
                ahead.or_cross(self.arrive(slot, axis, line), border);
            } else {
                let wall = if up { self.walls_at[1][axis] - radius } else { self.walls_at[0][axis] + radius };
                ahead.or_hit(self.arrive(slot, axis, wall), border);
            }
        }
        ahead
    }

    /// When a ball in straight flight arrives at a line across an axis.
    #[inline]
    fn arrive(&self, slot: usize, axis: usize, line: f64) -> f64 {
        let flight = &self.flights[slot];
        let speed = flight.velocity[axis];
        let time = flight.time + flight::arrive(line - flight.position[axis], speed);
        if speed == 0.0 { NEVER } else { time }
    }

    /// Looks at one side of a ball's cell.
    #[inline]
    fn look<N: Needs>(
        &self,
        slot: usize,
        now: f64,
        border: Border,
        crossed: Option<Border>,
        ahead: &mut Ahead,
    ) {
        let flight = &self.flights[slot];
        let line = self.cells.as_ref().map(|cells| cells.line::<N>(slot, flight.place, border));
        if let Some((line, false)) = line {
            ahead.or_cross(self.leaves::<N>(slot, now, border, crossed, line), border);
        } else if self.walls.is_some() {
            let (radius, size) = (self.matter::<N>(slot).radius, self.size[border.axis]);
            let wall = if border.up { size - radius } else { radius };
            ahead.or_hit(flight.time + self.reach::<N>(slot, border, wall), border);
        }
    }

    /// When a ball leaves its cell over a border at `line`.
    #[inline]
    fn leaves<N: Needs>(
        &self,
        slot: usize,
        now: f64,
        border: Border,
        crossed: Option<Border>,
        line: f64,
    ) -> f64 {
        let flight = &self.flights[slot];
        let time = flight.time + self.reach::<N>(slot, border, line);
        let Border { axis, up } = border;
        let (speed, pull) = (flight.velocity[axis], self.pull::<N>(slot)[axis]);
        let toward = |along: f64| if up { along } else { -along };
        // What gravity slows down on its way over a line comes back over it: then the way out is behind, and so it is
        // where it comes back now, at the top of its flight perhaps.
        let falls = toward(speed + pull * (now - flight.time)) <= 0.0 || crossed == Some(border.other_side());
        let behind = toward(pull) < 0.0 && falls;
        // It is in the cell still, so that it leaves it now at the earliest, whatever the rounding.
        if behind { NEVER } else { time.max(now) }
    }

    /// How long after its beginning a ball's flight reaches a line across an axis from within: counted from the
    /// beginning, so that it is the same whenever it is asked for.
    #[inline]
    fn reach<N: Needs>(&self, slot: usize, Border { axis, up }: Border, line: f64) -> f64 {
        let flight = &self.flights[slot];
        let (distance, speed) = (line - flight.position[axis], flight.velocity[axis]);
        let pull = self.pull::<N>(slot)[axis];
        let sign = if up { 1.0 } else { -1.0 };
        flight::reach(sign * distance, sign * speed, sign * pull)
    }

    /// Two balls as the first sees the other now.
    #[inline]
    fn pair<N: Needs>(&self, slot: usize, other: usize, now: f64) -> Pair {
        self.pair_seen_from::<N>(slot, self.state::<N>(slot, now), other, now)
    }

    /// The same where the first one's position and velocity are known.
    #[inline]
    fn pair_seen_from<N: Needs>(
        &self,
        slot: usize,
        (position, velocity): (DVec2, DVec2),
        other: usize,
        now: f64,
    ) -> Pair {
        let (their_position, their_velocity) = self.state::<N>(other, now);
        let (slow, dull) = if self.wedged() { (0.0, self.rest_speed) } else { (self.rest_speed, 0.0) };
        Pair {
            offset: their_position - position,
            velocity: their_velocity - velocity,
            reach: self.matter::<N>(slot).radius + self.matter::<N>(other).radius,
            own: velocity,
            slow,
            dull,
        }
    }

    /// When two balls meet that touch, or nearly do. They are looked at anew: that keeps all others in registers.
    #[cold]
    fn meet_at_hand<N: Needs>(&self, slot: usize, other: usize, now: f64) -> f64 {
        self.pair::<N>(slot, other, now).meet()
    }

    /// Finds the ball that this one meets first, where that is before both have another impact; then each is the
    /// other's earliest. Where it crosses a border now, only those that have come near by that are looked at.
    #[inline]
    fn meet_others<N: Needs>(&mut self, slot: usize, now: f64, crossed: Option<Border>) {
        let Some(cells) = &self.cells else { return };
        let flight = &self.flights[slot];
        let own = self.state::<N>(slot, now);
        let pair = |other: usize| self.pair_seen_from::<N>(slot, own, other, now);
        let inside = |other: usize| N::DETECT && self.overlap(slot, other);
        let mut first = First { time: flight.impact, partner: END, touches: false };
        let mut accelerated = Postponed::default();
        let meet_accelerated = |other: usize, first: &mut First| {
            let pair = pair(other);
            if pair.are_within(AT_HAND) {
                first.touches = true;
            }
            let pull = self.pull::<N>(other) - self.pull::<N>(slot);
            // A meeting after the next impact of either of them does not count.
            let limit = first.time.min(self.flights[other].impact);
            let time = if inside(other) {
                pair.part_accelerated(pull, limit - now)
            } else {
                pair.meet_accelerated(pull, limit - now)
            };
            first.or(now + time, other, self.flights[other].impact);
        };
        let mut near = 0;
        cells.for_each_near::<N>(slot, flight.place, crossed, |other| {
            near += 1;
            let held = |slot: usize| self.marks[slot].rests() == 3;
            if N::HOLDS && held(slot) && held(other) {
                // Neither moves: they never meet.
            } else if N::HOLDS && self.marks[slot].rests() != self.marks[other].rests() {
                // These cost most, and least where there is little time left: they come last.
                if !accelerated.push(other) {
                    meet_accelerated(other, &mut first);
                }
            } else {
                let pair = pair(other);
                let time = if inside(other) {
                    pair.part()
                } else if pair.are_within(AT_HAND) {
                    first.touches = true;
                    self.meet_at_hand::<N>(slot, other, now)
                } else {
                    pair.meet_from_afar()
                };
                first.or(now + time, other, self.flights[other].impact);
            }
        });
        for &other in accelerated.all() {
            meet_accelerated(other, &mut first);
        }
        self.beside |= first.touches;
        if N::HOLDS {
            self.unwatched += near / NEAR_PER_EVENT;
        }
        if first.partner != END {
            let First { time, partner, .. } = first;
            let partner = partner as usize;
            (self.flights[slot].impact, self.flights[slot].against) = (time, Against::ball(partner));
            let other = &mut self.flights[partner];
            (other.impact, other.against) = (time, Against::ball(slot));
            if time < other.event {
                other.event = time;
                self.calendar.write(time, partner as u32);
            }
        }
    }
}

/// The earliest meeting found, if it is earlier than what else will happen to a ball.
struct First {
    time: f64,
    /// [`END`] while none has been found.
    partner: u32,
    /// Whether any of those that were looked at touches the ball.
    touches: bool,
}

impl First {
    /// Takes a meeting instead where it is earlier, and earlier than the partner's next impact: again a toss, for which
    /// there is no branch, since each choice between two numbers hangs on one comparison.
    #[inline]
    fn or(&mut self, time: f64, partner: usize, impact: f64) {
        let time = if time < impact { time } else { NEVER };
        self.partner = if time < self.time { partner as u32 } else { self.partner };
        self.time = if time < self.time { time } else { self.time };
    }
}

/// A few slots that are looked at last.
#[derive(Debug, Clone, Default)]
struct Postponed {
    slots: [usize; 16],
    count: usize,
}

impl Postponed {
    /// Keeps a slot, if there is room.
    fn push(&mut self, slot: usize) -> bool {
        let room = self.count < self.slots.len();
        if room {
            self.slots[self.count] = slot;
            self.count += 1;
        }
        room
    }

    fn all(&self) -> &[usize] {
        &self.slots[..self.count]
    }
}
