//! The run of events: they are taken in their order in time, from one year of the calendar to the next, and handed to what
//! they are about.

use crate::simulation::clock::{Clock, INSTANT};
use crate::simulation::{Frame, Tally};

use super::calendar::{self, Dawn, Entry};
use super::flights::{Matter, Target};
use super::{Exact, Needs};

/// Events that follow each other so fast on average, s, and without end, count as at one time: this over the number of balls,
/// where they are so many or more, since others have events in the meantime ...
pub(super) const CREEP: f64 = 1e-5;
pub(super) const MANY: usize = 100;
/// ... where balls go no farther between them than this part of their radius on average, over the same number of balls. Elastic ones
/// that have next to no room would go to and fro in it without end. In Galperin's billiard they go as far as the gap at its start over
/// the square root of the mass ratio: 3e-5 px of 300 with 10¹⁴.
const NOWHERE: f64 = 1e-8;
/// The same of balls that lose speed in impacts: one that a heavier one presses into a pocket would go to and fro there for ever,
/// since what chatters loses none.
const NOWHERE_OF_CHATTER: f64 = 2e-10;
/// What counts as at one time ends after this part of chatter's time, however slowly events creep: as long as what rises at the rest
/// speed needs to its top. What was stopped for want of room is pressed by gravity until then, and would be stopped again without end.
/// Where the rest speed is less than the usual one, that counts.
pub(super) const LONGEST_INSTANT: f64 = 0.5;

/// Impacts of a ball in a year of the calendar, about. More, and the queue grows; fewer, and years change too often.
const HITS_PER_YEAR: f64 = 1.0;
/// A year is made for this many balls at least.
pub(super) const FEWEST: usize = 64;
/// The shortest year, s.
pub(super) const SHORTEST_YEAR: f64 = 1.0 / (1_u64 << 58) as f64;
/// The longest year, s.
pub(super) const LONGEST_YEAR: f64 = 16.0;
/// The most events that are saved up for the search for groups at rest.
const MOST_CREDIT: i64 = 1024;
/// Events between two looks at the caller's watch.
const EVENTS_PER_LOOK: u32 = 256;

/// Why the events up to a time are not all taken yet.
enum Pause {
    /// A step is called for, perhaps before that time.
    Called,
    /// The year ends at this time, s since it began: its origin must move on.
    NewYear(f64),
    /// The caller has no time for what comes at this time, s since the year began.
    Stopped(f64),
}

impl Exact {
    /// Whether the caller's watch says so; it is looked at now and then.
    pub(super) fn has_time(&mut self, go_on: &mut dyn FnMut() -> bool) -> bool {
        self.unwatched += 1;
        if self.unwatched < EVENTS_PER_LOOK {
            return true;
        }
        self.unwatched = 0;
        go_on()
    }

    /// Moves on to `target`, or as far as the caller's watch allows; where it got.
    pub(super) fn go<N: Needs>(
        &mut self,
        frame: &mut Frame<'_>,
        target: Clock,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Clock {
        if !self.begin::<N>(frame.balls, go_on) {
            return self.clock;
        }
        loop {
            let target = self.until_it_ends(target);
            let step = self.carry.step_until(target);
            let until = step.unwrap_or(target).shown_since(self.origin);
            match self.take_events::<N>(frame.tally, until, go_on) {
                None if step.is_none() => return target,
                None => {
                    if !self.has_time(go_on) {
                        let before = self.origin.shown_before((until - INSTANT).max(0.0));
                        return before.min(target).max(self.clock);
                    }
                    self.latest = self.latest.max(until);
                    self.step::<N>(frame.tally, until);
                }
                Some(Pause::Called) => {}
                Some(Pause::NewYear(time)) => {
                    self.begin_year(time);
                    if self.is_outrun() {
                        return self.origin.min(target).max(self.clock);
                    }
                }
                Some(Pause::Stopped(time)) => {
                    return self.origin.shown_before(time).min(target).max(self.clock);
                }
            }
        }
    }

    /// Takes all events up to `until`, s since the year began.
    fn take_events<N: Needs>(
        &mut self,
        tally: &mut Tally,
        until: f64,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Option<Pause> {
        loop {
            while let Some(entry) = self.next_event(until) {
                if !self.has_time(go_on) {
                    self.calendar.put_back(entry);
                    return Some(Pause::Stopped(entry.time));
                }
                self.take::<N>(tally, entry);
                if self.carry.is_just_called() {
                    return Some(Pause::Called);
                }
                if self.calendar.is_crowded() || self.is_stuck() || self.has_just_pressed() {
                    return Some(Pause::NewYear(self.calendar.moment_before(entry.time)));
                }
            }
            let day = self.calendar.day_ends();
            if day > until {
                return None;
            }
            let Self { flights, calendar, .. } = self;
            let dawn = calendar.open(|entry| flights[entry.ball as usize].event == entry.time);
            if dawn == Dawn::YearOver {
                return Some(Pause::NewYear(day));
            }
        }
    }

    /// The next event of the open day, where it is not later than `until`.
    #[inline]
    fn next_event(&mut self, until: f64) -> Option<Entry> {
        if self.calendar.is_unread() {
            self.read_ahead();
        }
        self.calendar.next(until)
    }

    /// Takes one event, if it still holds.
    #[inline]
    fn take<N: Needs>(&mut self, tally: &mut Tally, entry: Entry) {
        let (slot, now) = (entry.ball as usize, entry.time);
        let creeps = (self.creep * self.at_once as f64).min(self.longest_instant);
        if now > self.instant + INSTANT + creeps || self.gets_on::<N>(slot, now) {
            (self.instant, self.at_once) = (now, 0);
        }
        self.count_event();
        let flight = &self.flights[slot];
        if flight.event != now {
            return;
        }
        self.latest = now;
        if flight.impact != now {
            return self.cross::<N>(slot, now);
        }
        match flight.against.target() {
            Target::Nothing => {}
            Target::Wall { axis, high } => {
                self.hits += 1;
                self.hit_wall::<N>(tally, slot, axis, high, now);
            }
            Target::Ball(other) => {
                let theirs = &self.flights[other];
                // Both must still have each other ahead.
                if theirs.impact == now && theirs.against.target() == Target::Ball(slot) {
                    self.hits += 2;
                    // Both wrote it down.
                    let both = self.calendar.strike_out(Entry { time: now, ball: other as u32 });
                    if N::DETECT {
                        self.pass::<N>(slot, other, now);
                    } else {
                        self.collide::<N>(tally, slot, other, now);
                    }
                    // Not before: whether balls are wedged in is seen by the count.
                    if both {
                        self.count_event();
                    }
                } else {
                    self.foresee::<N>(slot, now);
                }
            }
        }
    }

    /// Whether the events since the present time began get anywhere, however little time they take, by how fast this ball is; or how
    /// fast it comes to the wall that it hits next: in a tube it may fall meanwhile. What drives another one along gets on.
    fn gets_on<N: Needs>(&self, slot: usize, now: f64) -> bool {
        let since = now - self.instant;
        if since <= INSTANT {
            return false;
        }
        let Matter { mut radius, mut restitution, .. } = *self.matter::<N>(slot);
        let (_, velocity) = self.state::<N>(slot, now);
        let speed = match self.flights[slot].against.target() {
            Target::Nothing => 0.0,
            Target::Wall { axis, .. } => velocity[axis].abs(),
            Target::Ball(other) => {
                let theirs = self.matter::<N>(other);
                (radius, restitution) = (radius.min(theirs.radius), restitution.min(theirs.restitution));
                velocity.length()
            }
        };
        let many = self.flights.len().max(MANY) as f64;
        let nowhere = if restitution < 1.0 { NOWHERE_OF_CHATTER } else { NOWHERE / many };
        since * speed > radius * nowhere * self.at_once as f64
    }

    /// Counts an event at the present time.
    #[inline]
    fn count_event(&mut self) {
        self.at_once += 1;
        self.credit = (self.credit + 1).min(MOST_CREDIT);
    }

    /// Moves the origin of time on by `time`, to a moment of the calendar, and begins a year there, as long as the last
    /// one's impacts suggest.
    fn begin_year(&mut self, time: f64) {
        self.origin = self.origin.after(time);
        let balls = self.flights.len().max(FEWEST) as f64;
        let suggested = HITS_PER_YEAR * balls * time / self.hits.max(1) as f64;
        // Where not even a moment has passed, that says no more than that the year was far too long.
        let shortest = SHORTEST_YEAR.max(self.span / calendar::MOMENTS);
        while self.span > 1.5 * suggested && self.span > shortest {
            self.span /= 2.0;
        }
        // Only once: a year without impacts says little of the next.
        if self.span < 0.75 * suggested && self.span < LONGEST_YEAR {
            self.span *= 2.0;
        }
        if let Some(pace) = &mut self.pace {
            let busy = self.flights.iter().filter(|flight| flight.time > 0.0).count();
            pace.pass(time, 0.5 * self.hits as f64, busy);
            if pace.suits_substeps() {
                self.note_pressing(0.0);
            }
        }
        self.hits = 0;
        self.latest -= time;
        self.instant -= time;
        self.calendar.begin(self.span);
        for (slot, flight) in self.flights.iter_mut().enumerate() {
            flight.time -= time;
            flight.impact -= time;
            flight.event -= time;
            self.calendar.write(flight.event, slot as u32);
        }
    }
}
