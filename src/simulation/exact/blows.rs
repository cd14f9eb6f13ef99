//! Blows on many balls that are carried: each lasts until their next step.
//!
//! What falls on a heap of hundreds sends those that it hits to and fro between others, and how that ends takes the velocities of all
//! to find out (`flurry`), for each blow anew. So it *waits* there: from where it hits what is carried it goes along with that, and
//! the next step finds velocities after all blows since the last one at once, in which it parts as fast as their restitution has it.
//! Meanwhile it keeps its own velocity, which is shown, and made faster or slower as it falls or rises, so that it neither gains nor
//! loses energy, unless it is slower than what it hops. Against the heap that holds what it hits it rebounds as against one body.
//!
//! A whole group waits *in place* where its flurries of hits were too many since the last step, or where it chatters and the next step
//! finds out in less time what becomes of it. It stands still, and so does, until then, what comes to it, if it has not waited before
//! in the same step: there are no hits among what waits so. No time passes for it meanwhile: that must not go on from step to step
//! (`headway`).

use glam::DVec2;

use crate::simulation::Tally;

use super::contacts::{Contact, Support};
use super::flights::{Marks, Way};
use super::group::{Group, MOST_UNLIKE, Member};
use super::settle::FIRM;
use super::{Exact, Needs};

/// A ball that waits for the next step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Blow {
    slot: usize,
    /// Where it began to wait, px, and how fast it was there, px/s.
    position: DVec2,
    velocity: DVec2,
    /// The same as it goes into the next step: where it was carried straight, its mean velocity, made as much faster or slower as what
    /// falls. Those that it was carried with kept their distance at these velocities, and still do.
    onward: Option<DVec2>,
    /// On which axes it rested, a bit each.
    rests: usize,
}

impl Blow {
    /// The ball's own velocity once it has come here.
    fn velocity_at(&self, position: DVec2, gravity: DVec2) -> DVec2 {
        let square = self.velocity.length_squared();
        let gained = 2.0 * gravity.dot(position - self.position);
        if square == 0.0 { DVec2::ZERO } else { self.velocity * (1.0 + gained / square).max(0.0).sqrt() }
    }
}

impl Exact {
    /// Lets a ball wait that hits another one firmly, if that is carried among many, or that comes to one that waits in place; or ends
    /// that they wait, if any does: its flight goes on. Returns whether there is no other impact now.
    #[inline]
    pub(super) fn waits_at<N: Needs>(
        &mut self,
        tally: &mut Tally,
        [one, other]: [usize; 2],
        firm: bool,
        now: f64,
    ) -> bool {
        if !(self.marks[one].is_among_many() || self.marks[other].is_among_many()) {
            return false;
        }
        let comes =
            [(one, other), (other, one)].into_iter().find(|&(slot, to)| self.comes_to::<N>(slot, to, firm));
        if let Some((slot, to)) = comes {
            tally.impacts += 1;
            self.begin_wait::<N>(slot, to, now);
        } else if !(self.ends_wait::<N>(one, now) | self.ends_wait::<N>(other, now)) {
            return false;
        }
        let ((p1, v1), (p2, v2)) = (self.state::<N>(one, now), self.state::<N>(other, now));
        if comes.is_none() && (v1 - v2).dot(p1 - p2) < 0.0 {
            // At once: else what waits beside them could stop one again before the other has given it anything.
            self.collide::<N>(tally, one, other, now);
        } else {
            self.foresee_both::<N>(one, other, now);
        }
        true
    }

    /// Whether a ball that hits another one, firmly or not, waits from now on: where that waits in place, or is carried among many and
    /// the ball has not been hit since the last step.
    fn comes_to<N: Needs>(&self, slot: usize, other: usize, firm: bool) -> bool {
        let (its, theirs) = (self.marks[slot], self.marks[other]);
        // A group with an unlike ball could not be carried by sweeps, or not at all.
        let (mass, other_mass) = (self.matter::<N>(slot).mass, self.matter::<N>(other).mass);
        if mass.max(other_mass) > MOST_UNLIKE * mass.min(other_mass) {
            return false;
        }
        if theirs.waits_in_place() {
            // Once: an unlike ball that comes to it each time, and ends that it waits, could do so without end.
            let may_wait = self.carry.released.binary_search(&slot).is_err();
            return !its.waits_in_place() && !its.has(Marks::HELD) && may_wait;
        }
        // On a wall neither would go along with the other.
        let fly = its.rests() == 0 && theirs.rests() == 0;
        let new = !its.has(Marks::GOES_ALONG) && its.hits_in_step() == 0;
        firm && fly && new && theirs.is_among_many()
    }

    /// Lets a ball wait that hits another one, and go along with that.
    fn begin_wait<N: Needs>(&mut self, slot: usize, other: usize, now: f64) {
        let (_, along) = self.state::<N>(other, now);
        self.note_blow::<N>(slot, now);
        let (position, _) = self.state::<N>(slot, now);
        self.set_out(slot, (position, along), now);
        let (rests, straight) = (self.marks[other].rests(), self.marks[other].has(Marks::STRAIGHT));
        let marks = &mut self.marks[slot];
        marks.rest(rests);
        marks.go(Way::Waits);
        marks.set(Marks::STRAIGHT, straight);
        marks.set(Marks::LEANS, false);
        marks.note_chatter(false);
        // Only once in a step: between two that come nearer it would wait without end.
        marks.count_hits(true);
        marks.set(Marks::HIT, true);
        self.marks[other].set(Marks::HIT, true);
    }

    /// Lets all of a group wait where they are, but those that are held.
    pub(super) fn wait_in_place<N: Needs>(&mut self, group: &Group, now: f64) {
        self.carry.headway.note_wait(group);
        let waiting: Vec<usize> = group
            .members
            .iter()
            .map(|member| member.slot)
            .filter(|&slot| !self.marks[slot].has(Marks::HELD))
            .collect();
        for &slot in &waiting {
            self.note_blow::<N>(slot, now);
            let (position, _) = self.state::<N>(slot, now);
            self.redirect(slot, (position, DVec2::ZERO), now);
            let marks = &mut self.marks[slot];
            marks.rest(3);
            marks.go(Way::Waits);
            marks.set(Marks::HIT, true);
        }
        // Not before all of them stand.
        for slot in waiting {
            self.foresee::<N>(slot, now);
        }
    }

    /// Notes how a ball gets on by itself that waits from now on, unless it does already.
    fn note_blow<N: Needs>(&mut self, slot: usize, now: f64) {
        if let Err(at) = self.find_blow(slot) {
            let (position, velocity) = self.true_state::<N>(slot, now);
            let onward = self.onward::<N>(slot, now);
            let rests = self.marks[slot].rests();
            self.carry.blows.insert(at, Blow { slot, position, velocity, onward, rests });
        }
    }

    /// Where the blow of a ball stands that waits, or would.
    fn find_blow(&self, slot: usize) -> Result<usize, usize> {
        self.carry.blows.binary_search_by_key(&slot, |blow| blow.slot)
    }

    /// Ends that a ball waits, and returns whether it does: it sets out at its own velocity. Whoever does it finds out what comes next.
    pub(super) fn ends_wait<N: Needs>(&mut self, slot: usize, now: f64) -> bool {
        let Ok(at) = self.find_blow(slot) else { return false };
        let blow = self.carry.blows.remove(at);
        if let Err(at) = self.carry.released.binary_search(&slot) {
            self.carry.released.insert(at, slot);
        }
        self.give_back::<N>(blow, None, now);
        self.marks[slot].go(Way::Flies);
        true
    }

    /// Gives a ball this velocity, or its own back, on the walls where it rested.
    fn give_back<N: Needs>(&mut self, blow: Blow, velocity: Option<DVec2>, now: f64) {
        let (position, _) = self.state::<N>(blow.slot, now);
        let velocity = velocity.unwrap_or_else(|| blow.velocity_at(position, self.gravity));
        let marks = &mut self.marks[blow.slot];
        marks.rest(blow.rests);
        // So did only what it went along with.
        marks.set(Marks::STRAIGHT, false);
        marks.forget_quick_hits();
        self.redirect(blow.slot, (position, velocity), now);
    }

    /// Ends that any wait.
    pub(super) fn end_waits<N: Needs>(&mut self, now: f64) {
        let blows = std::mem::take(&mut self.carry.blows);
        for &blow in &blows {
            self.give_back::<N>(blow, None, now);
            self.marks[blow.slot].go(Way::Flies);
        }
        for blow in blows {
            self.foresee::<N>(blow.slot, now);
        }
    }

    /// The velocity of a ball that waits, once it has come here.
    pub(super) fn own_velocity(&self, slot: usize, position: DVec2) -> DVec2 {
        let blow = self.find_blow(slot).map(|at| self.carry.blows[at]);
        blow.map_or(DVec2::ZERO, |blow| blow.velocity_at(position, self.gravity))
    }

    /// Gives what waits its own velocity when a step begins, which then takes all blows at once.
    pub(super) fn take_blows<N: Needs>(&mut self, now: f64) {
        for at in 0..self.carry.blows.len() {
            let blow = self.carry.blows[at];
            self.give_back::<N>(blow, blow.onward, now);
        }
    }

    /// Gives what goes into a step with another velocity its own back, where it is left alone there.
    pub(super) fn give_own_back<N: Needs>(&mut self, slot: usize, now: f64) {
        if let Ok(at) = self.find_blow(slot)
            && self.carry.blows[at].onward.is_some()
        {
            self.give_back::<N>(self.carry.blows[at], None, now);
        }
    }

    /// Whether anything has waited since the last step.
    pub(super) fn has_blows(&self) -> bool {
        !self.carry.blows.is_empty()
    }

    /// How fast the members of a contact are to part at least whose restitution counts, since what waits met the other: it touches it, and
    /// approaches it firmly at these velocities, px/s.
    pub(super) fn rebound<N: Needs>(
        &self,
        members: &[Member],
        contact: &Contact,
        velocities: &[DVec2],
    ) -> Option<f64> {
        let Support::Member(other) = contact.against else { return None };
        let two = [members[contact.one].slot, members[other].slot];
        let approach = -contact.parting(velocities);
        let waits = two.iter().any(|&slot| self.marks[slot].has(Marks::WAITS));
        if !waits || contact.gap > self.carry_touch() || approach <= FIRM * self.rest_speed {
            return None;
        }
        let [e, other_e] = two.map(|slot| self.matter::<N>(slot).restitution);
        Some(e.min(other_e) * approach)
    }
}
