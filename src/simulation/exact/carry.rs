//! Balls that press on each other, and are not to be held yet, are carried: they go on in steps.
//!
//! Where many lie on each other and some of them still move, none of those that these press on can be held (see `settle`),
//! and all would hit each other a thousand times a second. So their velocities are found for all of them at once, from step to
//! step: what they were, with what gravity gives, changed by pushes at the contacts, none of which pulls, until no two come
//! nearer to each other than they are apart (Stewart & Trinkle 1996). That takes energy, and gives none, and as discs are convex
//! none comes into another before the next step: there are no impacts between them. Others are met as ever.
//!
//! These are *mean* velocities, from one step to the next. The flight from here to there is the parabola over that chord,
//! which begins slower by half of what gravity gives in a step: so what is carried has the acceleration of all that flies, and
//! they meet where straight lines do. It hops by an eighth of g times the square of the step, as what lies on others does else.
//! Many, whose steps last longer, would hop too far; and what is jammed (see `headway`) has no room for that. They go along the chord
//! itself.

use glam::DVec2;

use crate::simulation::Tally;
use crate::simulation::clock::Clock;

use super::blows::Blow;
use super::contacts::{Contact, Support};
use super::flights::{Marks, Way};
use super::gather::{Belong, Near};
use super::group::{Group, Member};
use super::headway::Headway;
use super::settle::{LIFTED, STEPS_PER_EVENT};
use super::{Exact, Needs};

/// Steps while a hop at the rest speed lasts, where no more balls than this can be carried: they hop at half of it.
const STEPS_PER_HOP: f64 = 2.0;
const FEW: f64 = 100.0;
/// The steps of more take longer to find, and last as many times as long as these are more, up to so many times.
const LONGEST_STEP: f64 = 4.0;
/// Groups of so many at least are carried. Few have few impacts, which are right one by one, but for those
/// that hits come to without end: where balls fit between walls to the last digit.
const FEWEST: usize = 24;
/// Groups in which one ball has so many times the mass of another are not: the velocities would not be found well enough.
const UNLIKE: f64 = 1000.0;

/// What is known of the balls that are carried, beside their flights.
#[derive(Debug, Clone)]
pub(super) struct Carry {
    /// Steps in a second.
    rate: u32,
    /// Whether a wall, or a fixed ball, may carry any.
    pub(super) grounded: bool,
    /// How many times as long as that of few a step lasts.
    pub(super) longer: f64,
    /// When the next step is, where one is called for.
    next: Option<Clock>,
    /// Whether whoever takes events does not know of it yet.
    is_new: bool,
    /// What contacts pushed in the last step, px/s times a mass, in the order of their keys.
    pushes: Vec<(Key, f64)>,
    pub(super) headway: Headway,
    /// What waits for the next step, in the order of slots.
    pub(super) blows: Vec<Blow>,
    /// The slots of what has waited for it, and does no more, in their order.
    pub(super) released: Vec<usize>,
}

/// A contact: the slot of a ball, and that of the other, or a number for a wall that no slot has.
pub(super) type Key = (u32, u32);

impl Carry {
    /// Nothing is carried, but so many balls could be. A hop at the rest speed lasts so long, s.
    pub(super) fn new(hop_time: f64, grounded: bool, balls: usize) -> Self {
        let longer = if grounded { (balls as f64 / FEW).clamp(1.0, LONGEST_STEP) } else { 1.0 };
        let rate = (STEPS_PER_HOP / (longer * hop_time)).ceil().clamp(1.0, f64::from(u32::MAX)) as u32;
        Self {
            rate,
            grounded,
            longer,
            next: None,
            is_new: false,
            pushes: Vec::new(),
            headway: Headway::default(),
            blows: Vec::new(),
            released: Vec::new(),
        }
    }

    /// How long a step is, s.
    pub(super) fn step(&self) -> f64 {
        f64::from(self.rate).recip()
    }

    /// Whether what is carried goes straight, however much room it has.
    pub(super) fn goes_straight(&self) -> bool {
        self.longer > 1.0
    }

    /// When the next step is, if it is not later than this.
    pub(super) fn step_until(&self, target: Clock) -> Option<Clock> {
        // By what is shown: sums of deltas that come to one time differ by their rounding.
        self.next.filter(|next| next.shown() <= target.shown())
    }

    /// When the next step is, s since an earlier time.
    pub(super) fn next_since(&self, origin: Clock) -> Option<f64> {
        self.next.map(|next| next.shown_since(origin))
    }

    /// Whether a step is called for, for the first time since this was asked.
    #[inline]
    pub(super) fn is_just_called(&mut self) -> bool {
        std::mem::take(&mut self.is_new)
    }

    /// Begins a step: there is no next one yet.
    fn begin_step(&mut self) {
        self.headway.begin_step();
        self.released.clear();
        self.next = None;
    }

    /// What a contact pushed in the last step.
    pub(super) fn push(&self, key: Key) -> f64 {
        self.pushes.binary_search_by_key(&key, |(key, _)| *key).map_or(0.0, |at| self.pushes[at].1)
    }
}

/// By what a contact is known from step to step.
pub(super) fn key(members: &[Member], contact: &Contact) -> Key {
    let one = members[contact.one].slot as u32;
    match contact.against {
        Support::Member(other) => {
            let other = members[other].slot as u32;
            (one.min(other), one.max(other))
        }
        Support::Immovable(other) => (one, other as u32),
        Support::Wall => {
            let [x, y] = contact.normal.to_array();
            let side = if x == 0.0 { 2 + u32::from(y < 0.0) } else { u32::from(x < 0.0) };
            (one, u32::MAX - side)
        }
    }
}

impl Exact {
    /// Sees to it that there is a step, as soon as one begins.
    pub(super) fn call_step(&mut self, now: f64) {
        if self.carry.next.is_none() {
            let rate = self.carry.rate;
            let (over, _) = self.origin.after(now).steps(rate);
            (self.carry.next, self.carry.is_new) = (Some(Clock::at_step(over + 1, rate)), true);
        }
    }

    /// How near balls are to each other that are carried as one group, px: as far as one at the rest speed goes in two steps
    /// of few.
    pub(super) fn carry_touch(&self) -> f64 {
        self.rest_speed * self.chatter_time
    }

    /// Whether a ball is carried by others.
    pub(super) fn is_carried(&self, slot: usize) -> bool {
        let marks = self.marks[slot];
        // On the walls that it may rest on at first it does not hop.
        marks.has(Marks::CARRIED) && marks.rests() == 0
    }

    /// Whether a group that does not come to rest at once is carried. Without room its balls would not find velocities.
    pub(super) fn may_be_carried(&self, group: &Group) -> bool {
        let goes_on = |member: &Member| {
            let marks = self.marks[member.slot];
            marks.has(Marks::GOES_ALONG) || marks.is_in_storm()
        };
        self.gravity != DVec2::ZERO
            && !self.is_crammed()
            && group.absorbs
            && (group.members.len() >= FEWEST || group.members.iter().any(goes_on))
            && !group.members.iter().any(|member| member.deep)
            && group.most_unlike() <= UNLIKE
            && group.contacts.iter().any(|contact| contact.against != Support::Wall)
    }

    /// Moves all that is carried, and what has chattered for long beside it, on to their next step.
    pub(super) fn step<N: Needs>(&mut self, tally: &mut Tally, now: f64) {
        self.unwatched += (self.flights.len() / STEPS_PER_EVENT) as u32;
        self.carry.begin_step();
        self.take_blows::<N>(now);
        let farther = self.farthest_way::<N>(now, self.carry.step()).max(self.swing_distance());
        let (mut pushes, mut chatters) = (Vec::new(), Vec::new());
        let mut seen = vec![false; self.flights.len()];
        let counted = |slot: &usize| self.marks[*slot].hits_in_step() > 0;
        let counted: Vec<usize> = (0..self.marks.len()).filter(counted).collect();
        for marks in &mut self.marks {
            let among_many = marks.is_among_many();
            marks.set(Marks::AMONG_MANY, among_many);
            marks.count_hits(false);
        }
        for slot in 0..seen.len() {
            let marks = self.marks[slot];
            let moves = !(seen[slot] || marks.has(Marks::HELD) || self.matter::<N>(slot).is_fixed());
            if moves && (marks.has(Marks::GOES_ALONG) || marks.is_restless()) {
                let near =
                    Near { touch: self.carry_touch(), belong: Belong::Slow(1.0), farther, most: usize::MAX };
                let group = self.gather::<N>(slot, now, near, &seen);
                group.members.iter().for_each(|member| seen[member.slot] = true);
                chatters.extend(self.step_group::<N>(tally, group, now, &mut pushes));
            }
        }
        // Those that came no nearer to others until now may do so from now on.
        for slot in counted.into_iter().filter(|&slot| !seen[slot]) {
            self.foresee::<N>(slot, now);
        }
        if self.carry.next.is_none() {
            // There is no step that they could be counted from.
            self.marks.iter_mut().for_each(|marks| marks.count_hits(false));
        }
        self.carry.blows.clear();
        pushes.sort_unstable_by_key(|(key, _)| *key);
        self.carry.pushes = pushes;
        // Not before all have their velocities back: a group may wait for the next step at once.
        for slot in chatters {
            self.settle::<N>(tally, slot, now);
        }
        // All that it is called for by is known now.
        self.carry.is_new = false;
    }

    /// The same for one group, if it may be carried; else returns one of its balls that has chattered for long, if any has.
    fn step_group<N: Needs>(
        &mut self,
        tally: &mut Tally,
        mut group: Group,
        now: f64,
        pushes: &mut Vec<(Key, f64)>,
    ) -> Option<usize> {
        if !self.may_be_carried(&group) {
            return self.leave_alone::<N>(&group, now);
        }
        let means = self.kick(&mut group);
        let Some(by_walls) = self.find_velocities::<N>(&mut group, now) else {
            return self.leave_alone::<N>(&group, now);
        };
        tally.wall_impulse += by_walls;
        self.choose_held(&mut group, &means, now);
        for contact in group.contacts.iter().filter(|contact| contact.push > 0.0) {
            pushes.push((key(&group.members, contact), contact.push));
        }
        self.carry_on::<N>(&group, now);
        self.note_leaning(&group);
        None
    }

    /// Whether a step is one of so many.
    pub(super) fn is_nth_step(&self, now: f64, nth: u64) -> bool {
        let (steps, _) = self.origin.after(now).steps(self.carry.rate);
        steps % nth == 0
    }

    /// Gives a group's balls what gravity gives in a step, and returns their mean velocities in the last one.
    fn kick(&self, group: &mut Group) -> Vec<DVec2> {
        let kick = self.gravity * self.carry.step();
        let each = group.members.iter().zip(&mut group.velocities);
        each.map(|(member, velocity)| {
            // What stands on a wall, or goes straight, does not hop.
            let mean = *velocity - 0.5 * self.marks[member.slot].accelerated_part(kick);
            *velocity = mean + kick;
            mean
        })
        .collect()
    }

    /// Lets a group's balls set out with their new velocities, or holds them.
    fn carry_on<N: Needs>(&mut self, group: &Group, now: f64) {
        let (pushed, many) = (group.pushed(), group.is_of_many());
        let straight = self.carry.goes_straight() || self.carry.headway.is_jammed(group);
        let half_kick = self.gravity * (0.5 * self.carry.step());
        let each = group.members.iter().zip(&group.velocities).zip(pushed);
        let mut changed = Vec::new();
        for ((&Member { slot, position, stays, .. }, &velocity), pushed) in each {
            let held = self.marks[slot].has(Marks::HELD);
            let marks = &mut self.marks[slot];
            marks.set(Marks::AMONG_MANY, many);
            if held && stays {
                marks.go(Way::Held);
                continue;
            }
            changed.push(slot);
            marks.calm_down();
            marks.count_hits(true);
            if !held && !pushed && !stays && !straight {
                // Its flight goes on as it is, unless that was a straight one.
                let was_straight = marks.has(Marks::STRAIGHT);
                marks.go(Way::Flies);
                if was_straight {
                    let velocity = marks.free_part(velocity - half_kick);
                    self.redirect(slot, (position, velocity), now);
                }
                continue;
            }
            if held {
                self.let_go::<N>(slot);
            }
            let jams = self.jams_on(self.matter::<N>(slot).radius);
            let marks = &mut self.marks[slot];
            marks.rest(jams);
            marks.go(if stays { Way::Held } else { Way::Carried });
            marks.set(Marks::STRAIGHT, straight && !stays);
            marks.set(Marks::HIT, true);
            marks.set(Marks::LEANS, true);
            let velocity = if stays {
                DVec2::ZERO
            } else {
                marks.free_part(velocity) - marks.accelerated_part(half_kick)
            };
            self.redirect(slot, (position, velocity), now);
            if !stays {
                self.call_step(now);
            }
        }
        // Not before all of them have set out.
        for slot in changed {
            self.foresee::<N>(slot, now);
        }
    }

    /// Leaves a group to its impacts, and returns one of its balls that has chattered for long, for `settle`, if any has.
    fn leave_alone<N: Needs>(&mut self, group: &Group, now: f64) -> Option<usize> {
        let half_step = 0.5 * self.carry.step();
        for &Member { slot, .. } in &group.members {
            self.give_own_back::<N>(slot, now);
            let straight = self.marks[slot].has(Marks::STRAIGHT);
            let (position, velocity) = self.state::<N>(slot, now);
            if self.is_carried(slot) || straight {
                let half_kick = self.gravity * half_step;
                let mean = velocity - self.marks[slot].accelerated_part(half_kick);
                // So slow is only what velocities are wrong by.
                let is_slow = self.carry.grounded && mean.length() < LIFTED * self.rest_speed;
                let mean = if is_slow { DVec2::ZERO } else { mean };
                if self.carry.goes_straight() && self.goes_off_straight(slot) {
                    // It has not hopped.
                    self.redirect(slot, (position, self.true_velocity(slot, mean, half_step)), now);
                } else if is_slow || straight {
                    let velocity = self.marks[slot].free_part(mean + half_kick);
                    self.redirect(slot, (position, velocity), now);
                }
            }
            let marks = &mut self.marks[slot];
            if !marks.has(Marks::HELD) {
                marks.go(Way::Flies);
            }
            marks.set(Marks::TIGHT, false);
            marks.set(Marks::AMONG_MANY, false);
        }
        for member in &group.members {
            self.foresee::<N>(member.slot, now);
        }
        let mut slots = group.members.iter().map(|member| member.slot);
        slots.find(|&slot| self.marks[slot].chatter() >= self.long_chatter)
    }

    /// Begins a new flight of a ball without an impact.
    pub(super) fn redirect(&mut self, slot: usize, (position, velocity): (DVec2, DVec2), now: f64) {
        let flight = &mut self.flights[slot];
        (flight.position, flight.velocity, flight.time) = (position, velocity, now);
        self.marks[slot].set(Marks::STRUCK, true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_up_to_a_hundred_hop_at_half_the_rest_speed_and_those_of_more_are_longer_up_to_four_times() {
        let hop = 1.0 / 512.0;
        let carry = |grounded, balls| Carry::new(hop, grounded, balls);
        for (balls, rate) in [(0, 1024), (100, 1024), (200, 512), (400, 256), (100_000, 256)] {
            let carry = carry(true, balls);
            assert_eq!((carry.rate, carry.goes_straight()), (rate, balls > 100), "{balls} balls");
            assert_eq!(carry.longer * f64::from(carry.rate), 1024.0);
        }
        // A cloud that nothing carries keeps its momentum only as it falls.
        assert_eq!((carry(false, 400).rate, carry(false, 400).goes_straight()), (1024, false));
    }
}
