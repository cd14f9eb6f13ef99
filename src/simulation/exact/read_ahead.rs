//! Reading ahead: what the next events will look at is brought into the caches before they are taken.

use std::hint::black_box;

use super::Exact;
use super::calendar::{Entry, READ_AHEAD};
use super::cells::{END, MOST_HEADS};

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
            read ^= flights[slot].event.to_bits()
                ^ marks[slot].unaccelerated() as u64
                ^ u64::from(cells.behind(slot));
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
}
