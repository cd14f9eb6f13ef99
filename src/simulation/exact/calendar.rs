//! The queue of coming events: a calendar (Brown 1988) whose days are written in any order and sorted when they come.
//!
//! A year has so many days that few events fall on each. An event of this year is appended to its day; when a day
//! comes, those of its events that still hold are sorted and taken in turn. What lies beyond the year is not written
//! down at all: whoever owns the calendar writes it when its year begins.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;
use std::hint::black_box;
use std::mem;

use super::events::FEWEST;

/// Something will happen to a ball at a time, s since the year began.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Entry {
    pub time: f64,
    pub ball: u32,
}

impl Entry {
    /// A number in the order of entries.
    #[inline]
    fn key(&self) -> u128 {
        // The order of `f64::total_cmp`: bits in their order above zero, from the highest down below it.
        let bits = self.time.to_bits();
        let below_zero = (bits.cast_signed() >> 63).cast_unsigned();
        u128::from(bits ^ (below_zero | 1 << 63)) << 32 | u128::from(self.ball)
    }
}

impl Eq for Entry {}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key().cmp(&other.key())
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
    /// The length of a day, s.
    day: f64,
    days_per_second: f64,
    /// The year's days, and one for all that is beyond it.
    days: Vec<Day>,
    /// How many days have been opened.
    opened: usize,
    /// How many events have been written down this year, and how many are too many.
    written: usize,
    most: usize,
    /// The events of the open day, latest first.
    today: Vec<Entry>,
    /// Those that were written into it after it was opened, and had too many before them.
    late: BinaryHeap<Reverse<Entry>>,
    /// How many of the open day's events, its latest, have not been [read](Self::read) ahead, except those that were
    /// written into it since.
    unread: usize,
    /// Whether there are so many balls that what comes is read ahead, and what is written waits in `pending`.
    pub(super) many: bool,
    /// What has yet to be written into its days.
    pending: Vec<(usize, Entry)>,
}

/// What was written down for a day, in any order.
#[derive(Debug, Clone, Default)]
struct Day {
    /// Room for entries; what stands in it after the last means nothing.
    room: Vec<Entry>,
    count: usize,
}

impl Day {
    #[inline]
    fn push(&mut self, entry: Entry) {
        match self.room.get_mut(self.count) {
            Some(place) => {
                *place = entry;
                self.count += 1;
            }
            None => self.push_with_room(entry),
        }
    }

    /// Out of the way of what is written down nearly always.
    #[cold]
    #[inline(never)]
    fn push_with_room(&mut self, entry: Entry) {
        // By a quarter, not to the double: days stay full, and all of them have the same number to hold.
        let more = self.count / 4 + 4;
        self.room.reserve_exact(more);
        self.room.resize(self.count + more, entry);
        self.count += 1;
    }
}

/// Events of a ball to be written down in a year, at most. A year of one impact a ball has three or four.
const MOST_WRITTEN: usize = 6;
/// So many events of the open day are looked through for the place of one that is written into it.
const MOST_SOONER: usize = 64;
/// So many balls, their cells and their days do not stay in the caches near the processor.
const MANY: usize = 30_000;
/// So many events are read ahead at once where balls are many: enough for memory to answer many at a time, and what they
/// look at, about a kilobyte each, stays in the nearest cache.
pub(super) const READ_AHEAD: usize = 32;
/// So many events wait to be written at most: what [`READ_AHEAD`] events write, about.
const MOST_PENDING: usize = 64;
/// So few events of a day are ranked; more are sorted, which goes by guesses only for as few as these.
const FEW: usize = 20;
/// Moments of a year, of which each may be its end: a power of two.
pub(super) const MOMENTS: f64 = (1_u64 << 20) as f64;

/// The days of a year for so many balls: one for four of them, so that few events are to be sorted and few days to be
/// opened, as long as the ends of all days stay in the caches; fewer and longer ones where the balls are very many.
fn days(balls: usize) -> usize {
    (balls / 4).min(2048).max(balls / 256).max(32).next_power_of_two()
}

/// Writes `entries` into `ranked`, the latest first. Each goes where as many are before it as are later than it: to compare
/// all of a few with each other costs less than the guesses at which comes first that a sort makes, half of them wrong.
fn rank(entries: &[Entry], ranked: &mut [Entry]) {
    let mut keys = [0; FEW];
    for (place, (key, entry)) in keys.iter_mut().zip(entries).enumerate() {
        // What was foreseen again as it was before is there twice: each has a place of its own.
        *key = entry.key() << 8 | place as u128;
    }
    let keys = &keys[..entries.len()];
    for (entry, own) in entries.iter().zip(keys) {
        let later: usize = keys.iter().map(|key| usize::from(key > own)).sum();
        ranked[later] = *entry;
    }
}

impl Calendar {
    /// A calendar for the events of so many balls; its first year has yet to [`begin`](Self::begin).
    pub(super) fn new(balls: usize) -> Self {
        Self {
            day: 0.0,
            days_per_second: 0.0,
            days: vec![Day::default(); days(balls) + 1],
            opened: 0,
            written: 0,
            most: MOST_WRITTEN * balls.max(FEWEST),
            today: Vec::new(),
            late: BinaryHeap::new(),
            unread: 0,
            many: balls > MANY,
            pending: Vec::new(),
        }
    }

    /// How many days a year has; that of what is beyond it stands after them.
    fn beyond(&self) -> usize {
        self.days.len() - 1
    }

    /// Begins an empty year of `span` seconds, a power of two.
    pub(super) fn begin(&mut self, span: f64) {
        self.day = span / self.beyond() as f64;
        self.days_per_second = 1.0 / self.day;
        self.days.iter_mut().for_each(|day| day.count = 0);
        self.opened = 0;
        self.written = 0;
        self.today.clear();
        self.late.clear();
        self.unread = 0;
        self.pending.clear();
    }

    /// Writes an event down, unless it lies beyond the year.
    #[inline]
    pub(super) fn write(&mut self, time: f64, ball: u32) {
        // The year and its days are powers of two: the product is exact. Whether an event is within the year is a toss,
        // for which there is no branch: what is not goes to a day of its own, which never comes.
        let beyond = self.beyond();
        let day = ((time * self.days_per_second) as u32 as usize).min(beyond);
        let entry = Entry { time, ball };
        self.written += usize::from(day < beyond);
        if day < self.opened {
            return self.write_today(entry);
        }
        if self.many {
            return self.write_later(day, entry);
        }
        self.write_into(day, entry);
    }

    /// Out of the way of what is written down where balls are few.
    #[inline(never)]
    fn write_later(&mut self, day: usize, entry: Entry) {
        self.pending.push((day, entry));
        if self.pending.len() == MOST_PENDING {
            self.write_pending();
        }
    }

    #[inline]
    fn write_into(&mut self, day: usize, entry: Entry) {
        let beyond = self.beyond();
        self.days[day].push(entry);
        self.days[beyond].count = 0;
    }

    /// Writes what waits for it into its days. Each of them alone would wait for memory: they are read all at once
    /// before.
    fn write_pending(&mut self) {
        let last = |&(day, _): &(usize, Entry)| {
            let day: &Day = &self.days[day];
            day.room.get(day.count).map_or(0, |entry| entry.ball)
        };
        black_box(self.pending.iter().map(last).fold(0, |read, ball| read ^ ball));
        let mut pending = mem::take(&mut self.pending);
        pending.drain(..).for_each(|(day, entry)| self.write_into(day, entry));
        self.pending = pending;
    }

    /// Writes an event of the open day down: mostly it comes soon, so that few others are before it.
    fn write_today(&mut self, entry: Entry) {
        let sooner = self.today.iter().rev().take(MOST_SOONER).take_while(|other| **other < entry).count();
        if sooner < MOST_SOONER {
            self.today.insert(self.today.len() - sooner, entry);
        } else {
            self.late.push(Reverse(entry));
        }
    }

    /// Gives back an event that was taken and will be taken again.
    pub(super) fn put_back(&mut self, entry: Entry) {
        self.write_today(entry);
    }

    /// Takes the next event of the open day, where it is not later than `until`.
    #[inline]
    pub(super) fn next(&mut self, until: f64) -> Option<Entry> {
        if !self.late.is_empty() {
            return self.next_with_late(until);
        }
        self.today.pop_if(|entry| entry.time <= until)
    }

    /// Takes an event out where it is the next of the open day; whether it was.
    #[inline]
    pub(super) fn strike_out(&mut self, event: Entry) -> bool {
        self.today.pop_if(|entry| *entry == event).is_some()
    }

    #[cold]
    fn next_with_late(&mut self, until: f64) -> Option<Entry> {
        let late = self.late.peek().map(|late| late.0);
        if self.today.last().copied().is_none_or(|early| late.is_some_and(|late| late < early)) {
            return late.filter(|late| late.time <= until).and_then(|_| self.late.pop()).map(|late| late.0);
        }
        self.today.pop_if(|entry| entry.time <= until)
    }

    /// Opens the next day, with those of its entries that `holds` says yes to.
    ///
    /// The open day must have come to its end.
    pub(super) fn open(&mut self, mut holds: impl FnMut(&Entry) -> bool) -> Dawn {
        if self.many {
            self.write_pending();
        }
        if self.opened == self.beyond() {
            return Dawn::YearOver;
        }
        let Day { room, count } = &mut self.days[self.opened];
        self.opened += 1;
        // As `retain` does, but without a branch for each, which would be a toss.
        let mut kept = 0;
        for index in 0..*count {
            let entry = room[index];
            room[kept] = entry;
            kept += usize::from(holds(&entry));
        }
        let entries = &room[..kept];
        self.today.clear();
        self.today.extend_from_slice(entries);
        if kept <= FEW {
            rank(entries, &mut self.today);
        } else {
            self.today.sort_unstable_by(|a, b| b.cmp(a));
        }
        self.unread = if self.many { kept } else { 0 };
        Dawn::Day
    }

    /// Whether the next event is one that should be [read](Self::read) ahead.
    #[inline]
    pub(super) fn is_unread(&self) -> bool {
        self.unread > 0 && self.today.len() <= self.unread
    }

    /// The next events, at most [`READ_AHEAD`], which are still to be taken.
    pub(super) fn read(&mut self) -> &[Entry] {
        self.unread = self.today.len().saturating_sub(READ_AHEAD);
        &self.today[self.unread..]
    }

    /// Whether so much has been written that what no longer holds takes too much room: the year should end early.
    #[inline]
    pub(super) fn is_crowded(&self) -> bool {
        self.written > self.most
    }

    /// The last of the year's moments that is not later than `time`.
    pub(super) fn moment_before(&self, time: f64) -> f64 {
        let span = self.day * self.beyond() as f64;
        // All are powers of two, except the whole number of moments.
        (time / span * MOMENTS).floor() / MOMENTS * span
    }

    /// When the open day ends and the next begins, s since the year began.
    pub(super) fn day_ends(&self) -> f64 {
        self.opened as f64 * self.day
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Writes an event down in both.
    fn write(calendar: &mut Calendar, heap: &mut BinaryHeap<Reverse<Entry>>, time: f64, ball: usize) {
        let entry = Entry { time, ball: ball as u32 };
        calendar.write(entry.time, entry.ball);
        if time < 1.0 {
            heap.push(Reverse(entry));
        }
    }

    proptest! {
        #[test]
        fn entries_stand_in_their_order_in_time_and_then_by_balls(one: f64, other: f64, balls: [u32; 2], alike: bool) {
            let times = [one, if alike { one } else { other }];
            let [first, second] = [0, 1].map(|i| Entry { time: times[i], ball: balls[i] });
            prop_assert_eq!(first.cmp(&second), times[0].total_cmp(&times[1]).then(balls[0].cmp(&balls[1])));
        }

        #[test]
        fn events_come_as_from_a_heap_however_they_are_written(
            times in prop::collection::vec(0.0..1.2_f64, 0..400),
            more in prop::collection::vec(0.0..0.5_f64, 300),
            narrow: bool,
            twice: bool,
            many: bool,
            until in 0.0..1.0_f64,
        ) {
            // All in a day or two, so that these are read in several parts, or all over the year.
            let scale = if narrow { 0.05 } else { 1.0 };
            let (mut calendar, mut heap) = (Calendar::new(times.len()), BinaryHeap::new());
            calendar.many = many;
            calendar.begin(1.0);
            for (ball, &time) in times.iter().enumerate() {
                write(&mut calendar, &mut heap, scale * time, ball);
                if twice && ball % 3 == 0 {
                    write(&mut calendar, &mut heap, scale * time, ball);
                }
            }
            let mut taken = 0;
            loop {
                loop {
                    if calendar.is_unread() {
                        prop_assert!(many);
                        prop_assert!((1..=READ_AHEAD).contains(&calendar.read().len()));
                    }
                    let Some(entry) = calendar.next(scale * until).or_else(|| calendar.next(1.0)) else { break };
                    prop_assert_eq!(Some(Reverse(entry)), heap.pop());
                    taken += 1;
                    if taken % 7 == 0 {
                        calendar = calendar.clone();
                        calendar.put_back(entry);
                        prop_assert_eq!(calendar.next(1.0), Some(entry));
                    }
                    // Many bring another one, soon, in the open day or a later one.
                    if let Some(wait) = more.get(taken) {
                        write(&mut calendar, &mut heap, entry.time + scale * wait, 1000 + taken);
                    }
                }
                if calendar.open(|_| true) == Dawn::YearOver {
                    break;
                }
            }
            prop_assert_eq!(heap.pop(), None);
            // Another year begins empty.
            calendar.begin(2.0);
            while calendar.open(|_| true) == Dawn::Day {
                prop_assert_eq!(calendar.next(2.0), None);
            }
        }
    }
}
