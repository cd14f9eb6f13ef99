//! What comes next for a ball: the earliest of its impacts on walls and other balls (these in `meetings`), and of the
//! borders that it crosses.

use crate::simulation::clock::INSTANT;
use crate::simulation::flight::{self, NEVER};
use crate::simulation::lesser::lesser;

use super::cells::Border;
use super::flights::{Against, Marks};
use super::swept::Swept;
use super::{Exact, Needs};

/// Nothing hits what is carried so shortly before its next step, s.
const BEFORE_STEP: f64 = 8.0 * INSTANT;

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

impl Exact {
    /// Finds a ball's earliest impact from now on, and whose earliest that is too.
    pub(super) fn foresee<N: Needs>(&mut self, slot: usize, now: f64) {
        let before = self.hide::<N>(slot);
        self.foresee_hidden::<N>(slot, now);
        self.reveal::<N>(slot, before, now);
    }

    /// The same for two balls that have just hit each other.
    #[inline]
    pub(super) fn foresee_both<N: Needs>(&mut self, one: usize, other: usize, now: f64) {
        // All but always they part now, in straight flight beside each other: that needs no proof by the roots, twice.
        let beside = !N::HOLDS || self.marks[one].unaccelerated() == self.marks[other].unaccelerated();
        let parts = beside && !N::DETECT && self.pair::<N>(one, other, now).parts_from_touch();
        if parts {
            let before = (self.hide::<N>(one), self.hide::<N>(other));
            self.foresee_hidden::<N>(one, now);
            self.foresee_hidden::<N>(other, now);
            self.reveal::<N>(other, before.1, now);
            self.reveal::<N>(one, before.0, now);
        } else {
            self.foresee::<N>(one, now);
            self.foresee::<N>(other, now);
        }
    }

    /// Takes a ball out of its cell for a while: nobody meets itself.
    #[inline]
    fn hide<N: Needs>(&mut self, slot: usize) -> usize {
        if let Some(swept) = self.swept.get_mut(slot) {
            *swept = Swept::NOTHING;
            return 0;
        }
        let place = self.flights[slot].place;
        self.cells.as_mut().map_or(0, |cells| cells.hide::<N>(slot, place))
    }

    /// Puts it back.
    #[inline]
    fn reveal<N: Needs>(&mut self, slot: usize, before: usize, now: f64) {
        if !self.swept.is_empty() {
            self.swept[slot] = self.sweep::<N>(slot, now);
        } else if let Some(cells) = &mut self.cells {
            cells.reveal(slot, before);
        }
    }

    /// Foresees what comes next for a ball that is hidden, and does not meet others that are.
    #[inline]
    fn foresee_hidden<N: Needs>(&mut self, slot: usize, now: f64) {
        // What is carried sets out anew in its next step: it comes back to others just then.
        let carried = N::HOLDS && self.marks[slot].has(Marks::CARRIED);
        let step = self.carry.next_since(self.origin).filter(|_| carried);
        let until = step.map_or(NEVER, |step| (step - BEFORE_STEP).max(now));
        let flight = &mut self.flights[slot];
        (flight.impact, flight.against) = (until, Against::NOTHING);
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
}
