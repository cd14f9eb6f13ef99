//! The queue of coming events: a calendar (Brown 1988) whose days are written in any order and sorted when they come.
//!
//! A year has so many days that few events fall on each. An event of this year is appended to its day; when a day
//! comes, those of its events that still hold are sorted and taken in turn. What lies beyond the year is not written
//! down at all: whoever owns the calendar writes it when its year begins.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::FEWEST;

/// Something will happen to a ball at a time, s since the year began.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Entry {
    pub time: f64,
    pub ball: u32,
}

impl Eq for Entry {}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        self.time.total_cmp(&other.time).then(self.ball.cmp(&other.ball))
    }
}

/// What comes after the last event of a day.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Dawn {
    /// Another day.
    Day,
    /// The year is over.
    YearOver,
}

/// Events in their order in time.
#[derive(Debug, Clone)]
pub(super) struct Calendar {
    /// The length of the year, s.
    span: f64,
    days_per_second: f64,
    days: Vec<Vec<Entry>>,
    /// How many days have been opened.
    opened: usize,
    /// How many events have been written down this year, and how many are too many.
    written: usize,
    most: usize,
    /// The events of the open day, latest first.
    today: Vec<Entry>,
    /// Those that were written into it after it was opened.
    late: BinaryHeap<Reverse<Entry>>,
}

/// Events of a ball to be written down in a year, at most. A year of one impact a ball has three or four.
const MOST_WRITTEN: usize = 6;
/// Moments of a year, of which each may be its end: a power of two.
pub(super) const MOMENTS: f64 = (1_u64 << 20) as f64;

/// The days of a year for so many balls: short ones, with few events to sort, as long as all of them stay in the caches;
/// fewer and longer ones where the balls are very many.
fn days(balls: usize) -> usize {
    balls.min(2048).max(balls / 64).max(32).next_power_of_two()
}

impl Calendar {
    /// A calendar for the events of so many balls; its first year has yet to [`begin`](Self::begin).
    pub(super) fn new(balls: usize) -> Self {
        Self {
            span: 0.0,
            days_per_second: 0.0,
            days: vec![Vec::new(); days(balls)],
            opened: 0,
            written: 0,
            most: MOST_WRITTEN * balls.max(FEWEST),
            today: Vec::new(),
            late: BinaryHeap::new(),
        }
    }

    /// Begins an empty year of `span` seconds, a power of two.
    pub(super) fn begin(&mut self, span: f64) {
        self.span = span;
        self.days_per_second = self.days.len() as f64 / span;
        self.days.iter_mut().for_each(Vec::clear);
        self.opened = 0;
        self.written = 0;
        self.today.clear();
        self.late.clear();
    }

    /// Writes an event down, unless it lies beyond the year.
    #[inline]
    pub(super) fn write(&mut self, time: f64, ball: u32) {
        if time < self.span {
            // The year and its days are powers of two: the product is exact.
            let day = (time * self.days_per_second) as usize;
            let entry = Entry { time, ball };
            self.written += 1;
            if day < self.opened {
                self.late.push(Reverse(entry));
            } else {
                let day = &mut self.days[day];
                if day.len() == day.capacity() {
                    // By a quarter, not to the double: days stay full, and all of them have the same number to hold.
                    day.reserve_exact(day.len() / 4 + 4);
                }
                day.push(entry);
            }
        }
    }

    /// Gives back an event that was taken and will be taken again.
    pub(super) fn put_back(&mut self, entry: Entry) {
        self.late.push(Reverse(entry));
    }

    /// Takes the next event of the open day, where it is not later than `until`.
    #[inline]
    pub(super) fn next(&mut self, until: f64) -> Option<Entry> {
        let early = self.today.last().copied();
        if let Some(&Reverse(late)) = self.late.peek()
            && early.is_none_or(|early| late < early)
        {
            return if late.time <= until { self.late.pop().map(|entry| entry.0) } else { None };
        }
        let next = early.filter(|entry| entry.time <= until);
        if next.is_some() {
            self.today.pop();
        }
        next
    }

    /// Opens the next day, with those of its entries that `holds` says yes to.
    ///
    /// The open day must have come to its end.
    pub(super) fn open(&mut self, holds: impl FnMut(&Entry) -> bool) -> Dawn {
        if self.opened == self.days.len() {
            return Dawn::YearOver;
        }
        std::mem::swap(&mut self.today, &mut self.days[self.opened]);
        self.opened += 1;
        self.today.retain(holds);
        self.today.sort_unstable_by(|a, b| b.cmp(a));
        Dawn::Day
    }

    /// Whether so much has been written that what no longer holds takes too much room: the year should end early.
    #[inline]
    pub(super) fn is_crowded(&self) -> bool {
        self.written > self.most
    }

    /// The last of the year's moments that is not later than `time`.
    pub(super) fn moment_before(&self, time: f64) -> f64 {
        // All are powers of two, but for the whole number of moments.
        (time / self.span * MOMENTS).floor() / MOMENTS * self.span
    }

    /// When the open day ends and the next begins, s since the year began.
    pub(super) fn day_ends(&self) -> f64 {
        self.opened as f64 / self.days_per_second
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn events_come_in_their_order_however_they_are_written(
            times in prop::collection::vec(0.0..1.2_f64, 0..300), more in prop::collection::vec(0.0..0.5_f64, 300),
        ) {
            let mut calendar = Calendar::new(times.len());
            calendar.begin(1.0);
            for (ball, &time) in times.iter().enumerate() {
                calendar.write(time, ball as u32);
            }
            let (mut taken, mut last) = (Vec::new(), 0.0);
            loop {
                while let Some(entry) = calendar.next(1.0) {
                    prop_assert!(entry.time >= last);
                    last = entry.time;
                    // Each event of the first half brings another one soon, in the open day or a later one.
                    if taken.len() < more.len() / 2 {
                        calendar.write(last + more[taken.len()], 1000 + taken.len() as u32);
                    }
                    taken.push(entry.ball);
                }
                if calendar.open(|_| true) == Dawn::YearOver {
                    break;
                }
            }
            for (ball, &time) in times.iter().enumerate() {
                prop_assert_eq!(taken.contains(&(ball as u32)), time < 1.0);
            }
        }
    }
}
