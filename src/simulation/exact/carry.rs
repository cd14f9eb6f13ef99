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

use glam::DVec2;

use crate::simulation::Tally;
use crate::simulation::clock::Clock;

use super::contacts::{Contact, Support};
use super::flights::Marks;
use super::gradients::Enough;
use super::group::{Group, Member};
use super::settle::{Belong, LIFTED, Near};
use super::{Exact, Needs};

/// Steps while a hop at the rest speed lasts: what is carried hops at half of it.
const STEPS_PER_HOP: f64 = 2.0;
/// Groups of so many at least are carried. Few have few impacts, which are right one by one.
const FEWEST: usize = 24;
/// Groups in which one ball has so many times the mass of another are not: the velocities would not be found well enough.
const UNLIKE: f64 = 1000.0;
/// The part of what is between two balls that is left after a step at least.
const KEPT_APART: f64 = 0.5;
/// How far balls that are carried are kept from each other, as a part of how far one falls in a step, twice: the nearer they are, the
/// more often they hit each other once a blow has made them faster, and the farther, the more is a crowd lifted.
const APART: f64 = 0.01;
/// The energy that contacts give at most to balls that are to part, as a part of that of their mass at the rest speed, twice, beside
/// what it takes to lift as many layers as they lie in. They give a few thousandths, and where there is no room a thousand times as much
/// as all.
const MOST_GIVEN: f64 = 0.03125;
/// How exactly velocities are found, as a part of what gravity gives in a step.
const PRECISION: f64 = 1e-4;
/// Among many, what is between two balls may close by this part of it more in a step: they still hardly meet.
const CLOSES: f64 = 0.4;
/// Among many, how much faster than they are to balls may part, as a part of what gravity gives in a step.
const FASTER: f64 = 0.1;
/// Among many, that is enough after so many steps.
const MOST_STEPS: usize = 100;
/// Steps from one search for forces that balance gravity to the next.
const STEPS_PER_SEARCH: u64 = 8;
/// Steps from one try to part where there is no room to the next.
const STEPS_PER_PARTING: u64 = 16;

/// What is known of the balls that are carried, beside their flights.
#[derive(Debug, Clone)]
pub(super) struct Carry {
    /// Steps in a second.
    rate: u32,
    /// When the next step is, where one is called for.
    next: Option<Clock>,
    /// Whether whoever takes events does not know of it yet.
    is_new: bool,
    /// What contacts pushed in the last step, px/s times a mass, in the order of their keys.
    pushes: Vec<(Key, f64)>,
    /// How many flurries there were since the last step.
    flurries: u32,
}

/// A contact: the slot of a ball, and that of the other, or a number for a wall that no slot has.
type Key = (u32, u32);

impl Carry {
    /// Nothing is carried. A hop at the rest speed lasts so long, s.
    pub(super) fn new(hop_time: f64) -> Self {
        let rate = (STEPS_PER_HOP / hop_time).ceil().clamp(1.0, f64::from(u32::MAX)) as u32;
        Self { rate, next: None, is_new: false, pushes: Vec::new(), flurries: 0 }
    }

    /// How long a step is, s.
    fn step(&self) -> f64 {
        f64::from(self.rate).recip()
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

    /// Counts a flurry, and says whether there were no more than this since the last step.
    pub(super) fn counts_flurry(&mut self, most: u32) -> bool {
        self.flurries += 1;
        self.flurries <= most
    }

    /// How many flurries there were since the last step.
    pub(super) fn flurries(&self) -> u32 {
        self.flurries
    }

    /// What a contact pushed in the last step.
    fn push(&self, key: Key) -> f64 {
        self.pushes.binary_search_by_key(&key, |(key, _)| *key).map_or(0.0, |at| self.pushes[at].1)
    }
}

/// By what a contact is known from step to step.
fn key(members: &[Member], contact: &Contact) -> Key {
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

    /// How near balls are to each other that are carried as one group, px: as far as one at the rest speed goes in two steps.
    pub(super) fn carry_touch(&self) -> f64 {
        self.rest_speed * self.chatter_time
    }

    /// Whether a ball's velocity is a mean one, from which its flight goes off.
    fn is_carried(&self, slot: usize) -> bool {
        let marks = self.marks[slot];
        // On the walls that it may rest on at first it does not hop.
        marks.has(Marks::CARRIED) && marks.rests() == 0
    }

    /// How long after the middle of a step a time is, s.
    pub(super) fn since_middle(&self, now: f64) -> f64 {
        self.carry.next_since(self.origin).map_or(0.0, |next| 0.5 * self.carry.step() - (next - now))
    }

    /// A ball's velocity where that of its flight is this, so long after the middle of a step. That of one that is carried is
    /// its mean one, made as much faster or slower as it has fallen or risen since: all balls together neither gain nor lose
    /// energy within a step.
    pub(super) fn true_velocity(&self, slot: usize, velocity: DVec2, since_middle: f64) -> DVec2 {
        if !self.is_carried(slot) {
            return velocity;
        }
        let mean = velocity - self.gravity * since_middle;
        let square = mean.length_squared();
        let gained = 2.0 * since_middle * self.gravity.dot(mean);
        if square == 0.0 { mean } else { mean * (1.0 + gained / square).max(0.0).sqrt() }
    }

    /// Whether a group that does not come to rest at once is carried. Without room its balls would not find velocities.
    pub(super) fn may_be_carried(&self, group: &Group) -> bool {
        let carried = |member: &Member| self.marks[member.slot].has(Marks::CARRIED);
        self.gravity != DVec2::ZERO
            && !self.is_crammed()
            && group.absorbs
            && (group.members.len() >= FEWEST || group.members.iter().any(carried))
            && !group.members.iter().any(|member| member.deep)
            && group.most_unlike() <= UNLIKE
            && group.contacts.iter().any(|contact| contact.against != Support::Wall)
    }

    /// Moves all that is carried, and what has chattered for long beside it, on to their next step.
    pub(super) fn step<N: Needs>(&mut self, tally: &mut Tally, now: f64) {
        (self.carry.next, self.carry.flurries) = (None, 0);
        let mut pushes = Vec::new();
        let mut seen = vec![false; self.flights.len()];
        let counted = |slot: &usize| self.marks[*slot].hits_in_step() > 0;
        let counted: Vec<usize> = (0..self.marks.len()).filter(counted).collect();
        self.marks.iter_mut().for_each(|marks| marks.count_hits(false));
        for slot in 0..seen.len() {
            let marks = self.marks[slot];
            let moves = !(seen[slot] || marks.has(Marks::HELD) || self.matter::<N>(slot).is_fixed());
            if moves && (marks.has(Marks::CARRIED) || marks.is_restless()) {
                let near = Near { touch: self.carry_touch(), belong: Belong::Slow(1.0) };
                let group = self.gather::<N>(slot, now, near);
                group.members.iter().for_each(|member| seen[member.slot] = true);
                self.step_group::<N>(tally, group, now, &mut pushes);
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
        pushes.sort_unstable_by_key(|(key, _)| *key);
        self.carry.pushes = pushes;
        // All that it is called for by is known now.
        self.carry.is_new = false;
    }

    /// The same for one group, if it may be carried.
    fn step_group<N: Needs>(
        &mut self,
        tally: &mut Tally,
        mut group: Group,
        now: f64,
        pushes: &mut Vec<(Key, f64)>,
    ) {
        if !self.may_be_carried(&group) {
            return self.leave_alone::<N>(tally, &group, now);
        }
        let means = self.kick(&mut group);
        let Some(by_walls) = self.find_velocities::<N>(&mut group, now) else {
            return self.leave_alone::<N>(tally, &group, now);
        };
        tally.wall_impulse += by_walls;
        self.choose_held(&mut group, &means, now);
        for contact in group.contacts.iter().filter(|contact| contact.push > 0.0) {
            pushes.push((key(&group.members, contact), contact.push));
        }
        self.carry_on::<N>(&group, now);
        self.note_leaning(&group);
    }

    /// Whether a step is one of so many.
    fn is_nth_step(&self, now: f64, nth: u64) -> bool {
        let (steps, _) = self.origin.after(now).steps(self.carry.rate);
        steps % nth == 0
    }

    /// Gives a group's balls what gravity gives in a step, and returns their mean velocities in the last one.
    fn kick(&self, group: &mut Group) -> Vec<DVec2> {
        let kick = self.gravity * self.carry.step();
        let each = group.members.iter().zip(&mut group.velocities);
        each.map(|(member, velocity)| {
            // What stands on a wall does not hop there.
            let mean = *velocity - 0.5 * self.marks[member.slot].free_part(kick);
            *velocity = mean + kick;
            mean
        })
        .collect()
    }

    /// In how many layers a group's balls lie, about.
    fn layers<N: Needs>(&self, group: &Group) -> f64 {
        let down = self.gravity.normalize_or_zero();
        let places = || group.members.iter().map(|member| member.position.dot(down));
        let depth = places().fold(f64::NEG_INFINITY, f64::max) - places().fold(f64::INFINITY, f64::min);
        let radii: f64 = group.members.iter().map(|member| self.matter::<N>(member.slot).radius).sum();
        depth / (2.0 * radii / group.members.len() as f64)
    }

    /// Finds the velocities with which a group's balls stay apart until the next step, starting from what their contacts pushed in
    /// the last one, and returns the momentum that walls give, if there are any velocities that take energy: what is nearer than it is
    /// kept parts, or where that has no room, or takes none, does at least not come nearer. What is left of approaches impacts see to.
    fn find_velocities<N: Needs>(&mut self, group: &mut Group, now: f64) -> Option<DVec2> {
        let step = self.carry.step();
        let gravity = self.gravity.length();
        let (apart, kick) = (APART * gravity * step * step, gravity * step);
        let enough = Enough {
            slower: PRECISION * kick,
            closing: CLOSES / step,
            faster: FASTER * kick,
            dead: 0.0,
            most_steps: MOST_STEPS,
        };
        for contact in &mut group.contacts {
            contact.least = ((1.0 - KEPT_APART) * (apart - contact.gap) / step).min(0.5 * self.rest_speed);
        }
        let kicked = group.velocities.clone();
        let mass: f64 = group.inverse_masses.iter().map(|inverse_mass| inverse_mass.recip()).sum();
        let lifts = gravity * apart * self.layers::<N>(group);
        let most_given = mass * (MOST_GIVEN * self.rest_speed * self.rest_speed + lifts);
        // Where there was no room a moment ago there is none.
        let were_tight = group.members.iter().filter(|member| self.marks[member.slot].has(Marks::TIGHT));
        let tight = !self.is_nth_step(now, STEPS_PER_PARTING) && 2 * were_tight.count() > group.members.len();
        let all = [f64::INFINITY, 0.0];
        for &most in &all[usize::from(tight)..] {
            group.velocities.clone_from(&kicked);
            for contact in &mut group.contacts {
                contact.least = contact.least.min(most);
                // Pushes without bounds lead nowhere from where there is no room.
                contact.push = if most > 0.0 { self.carry.push(key(&group.members, contact)) } else { 0.0 };
                contact.apply(contact.push, &mut group.velocities, &group.inverse_masses);
            }
            let steps = group.move_on(enough);
            self.note_steps(group, steps);
            // Comparisons that are false for a NaN.
            let given: f64 = group.contacts.iter().map(|contact| contact.push * contact.least.max(0.0)).sum();
            if given <= most_given && group.energy(&group.velocities) <= group.energy(&kicked) {
                let found = std::mem::replace(&mut group.velocities, kicked);
                let by_walls = group.by_walls(&found, &group.contacts, 1.0);
                group.velocities = found;
                for member in &group.members {
                    self.marks[member.slot].set(Marks::TIGHT, most == 0.0);
                }
                return Some(by_walls);
            }
        }
        group.velocities = kicked;
        None
    }

    /// Chooses the members of a group that are held from now on, by how their velocities changed, and now and then, since what
    /// is between balls still closes for a while, by whether forces can balance gravity.
    fn choose_held(&self, group: &mut Group, means: &[DVec2], now: f64) {
        let (gravity, step) = (self.gravity.length(), self.carry.step());
        let changes = group.velocities.iter().zip(means).map(|(velocity, mean)| (*velocity - *mean) / step);
        group.accelerations = changes.collect();
        group.choose(gravity, self.rest_speed, false);
        if !self.is_nth_step(now, STEPS_PER_SEARCH) || group.members.iter().all(|member| member.stays) {
            return;
        }
        let touch = self.touch_distance();
        let near = group.contacts.iter().filter(|contact| contact.gap < touch);
        let contacts = near.map(|contact| Contact { push: contact.push / step, least: 0.0, ..*contact });
        let mut still = Group { contacts: contacts.collect(), ..group.clone() };
        // Without any that are slow enough, and pressed by none but such now, there is hardly any to be found.
        still.accelerations.fill(DVec2::ZERO);
        still.choose(gravity, self.rest_speed, false);
        if still.members.iter().all(|member| !member.stays) {
            return;
        }
        still.accelerations.fill(self.gravity);
        for contact in &still.contacts {
            contact.apply(contact.push, &mut still.accelerations, &still.inverse_masses);
        }
        still.balance(gravity);
        still.choose(gravity, self.rest_speed, false);
        group.members = still.members;
    }

    /// Lets a group's balls set out with their new velocities, or holds them.
    fn carry_on<N: Needs>(&mut self, group: &Group, now: f64) {
        let pushed = group.pushed();
        let half_kick = self.gravity * (0.5 * self.carry.step());
        let each = group.members.iter().zip(&group.velocities).zip(pushed);
        for ((&Member { slot, position, stays, .. }, &velocity), pushed) in each {
            let held = self.marks[slot].has(Marks::HELD);
            self.marks[slot].calm_down();
            self.marks[slot].count_hits(!stays);
            if held && stays {
                continue;
            }
            if !held && !pushed {
                // Its flight goes on as it is.
                self.marks[slot].set(Marks::CARRIED, false);
                continue;
            }
            if held {
                self.let_go::<N>(slot);
            }
            let radius = self.matter::<N>(slot).radius;
            for axis in 0..2 {
                let rests = stays || self.jams(radius, axis);
                self.marks[slot].set(Marks::rests_on(axis), rests);
            }
            let marks = &mut self.marks[slot];
            marks.set(Marks::HELD, stays);
            marks.set(Marks::CARRIED, !stays);
            marks.set(Marks::HIT, true);
            marks.set(Marks::LEANS, true);
            let velocity = if stays { DVec2::ZERO } else { marks.free_part(velocity - half_kick) };
            self.redirect(slot, (position, velocity), now);
            if !stays {
                self.call_step(now);
            }
        }
        // Not before all of them have set out.
        for member in &group.members {
            self.foresee::<N>(member.slot, now);
        }
    }

    /// Leaves a group to its impacts, and what has chattered for long to `settle`.
    fn leave_alone<N: Needs>(&mut self, tally: &mut Tally, group: &Group, now: f64) {
        for &Member { slot, .. } in &group.members {
            if self.is_carried(slot) {
                let (position, velocity) = self.state::<N>(slot, now);
                let mean = velocity - self.gravity * (0.5 * self.carry.step());
                if mean.length() < LIFTED * self.rest_speed {
                    // So slow is only what velocities are wrong by.
                    self.redirect(slot, (position, velocity - mean), now);
                }
            }
            self.marks[slot].set(Marks::CARRIED, false);
            self.foresee::<N>(slot, now);
        }
        let chatters = |member: &&Member| self.marks[member.slot].chatter() >= self.long_chatter;
        if let Some(member) = group.members.iter().find(chatters) {
            self.settle::<N>(tally, member.slot, now);
        }
    }

    /// Begins a new flight of a ball without an impact.
    pub(super) fn redirect(&mut self, slot: usize, (position, velocity): (DVec2, DVec2), now: f64) {
        let flight = &mut self.flights[slot];
        (flight.position, flight.velocity, flight.time) = (position, velocity, now);
        self.marks[slot].set(Marks::STRUCK, true);
    }
}
