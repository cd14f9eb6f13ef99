//! Blows on many balls that are carried: each lasts until their next step.
//!
//! What falls on a heap of hundreds sends those that it hits to and fro between others, and how that ends takes the velocities of all
//! to find out (`flurry`), for each blow anew. So it *waits* there: from where it hits what is carried it goes along with that, and
//! the next step finds velocities after all blows since the last one at once, in which it parts as fast as their restitution has it.
//! Meanwhile it keeps its own velocity, which is shown, and made faster or slower as it falls or rises, so that it neither gains nor
//! loses energy, unless it is slower than what it hops. Against the heap that holds what it hits it rebounds as against one body.
//!
//! A whole group waits *in place*, in such a hop, where its flurries of hits were too many since the last step, or where it chatters
//! and the next step finds out in less time what becomes of it. No time passes for it meanwhile: that must not go on from step to step
//! (`carry`).

use glam::DVec2;

use super::contacts::{Contact, Support};
use super::flights::Marks;
use super::group::{Group, MOST_UNLIKE, Member};
use super::settle::FIRM;
use super::{Exact, Needs};

/// A ball that waits for the next step, or did.
#[derive(Debug, Clone, Copy)]
pub(super) struct Blow {
    slot: usize,
    /// Where it hit something, px, and how fast it was there, px/s.
    position: DVec2,
    velocity: DVec2,
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
    /// Lets a ball wait that hits another one firmly, if that is carried among many, or waits beside such; or ends that they wait, if
    /// any does: its flight goes on. Returns whether there is no impact now.
    #[inline]
    pub(super) fn waits_at<N: Needs>(&mut self, [one, other]: [usize; 2], firm: bool, now: f64) -> bool {
        if !(self.marks[one].is_among_many() || self.marks[other].is_among_many()) {
            return false;
        }
        if firm && self.comes_to::<N>(one, other) {
            self.begin_wait::<N>(one, other, now);
        } else if firm && self.comes_to::<N>(other, one) {
            self.begin_wait::<N>(other, one, now);
        } else if self.marks[one].has(Marks::WAITS) || self.marks[other].has(Marks::WAITS) {
            self.end_wait::<N>(one, now);
            self.end_wait::<N>(other, now);
        } else {
            return false;
        }
        self.foresee_both::<N>(one, other, now);
        true
    }

    /// Whether a ball that has not been hit since the last step comes to one that is carried among many.
    fn comes_to<N: Needs>(&self, slot: usize, along: usize) -> bool {
        let (its, theirs) = (self.marks[slot], self.marks[along]);
        // On a wall neither would go along with the other.
        let fly = its.rests() == 0 && theirs.rests() == 0;
        // A group with an unlike ball could not be carried by sweeps, or not at all.
        let (mass, other_mass) = (self.matter::<N>(slot).mass, self.matter::<N>(along).mass);
        let alike = mass.max(other_mass) <= MOST_UNLIKE * mass.min(other_mass);
        let new = !its.has(Marks::GOES_ALONG) && its.hits_in_step() == 0;
        fly && alike && new && theirs.is_among_many()
    }

    /// Lets a ball wait, and go along with another one.
    fn begin_wait<N: Needs>(&mut self, slot: usize, along: usize, now: f64) {
        let (position, velocity) = self.state::<N>(slot, now);
        let (_, along_velocity) = self.state::<N>(along, now);
        self.forget_blows();
        self.set_out(slot, (position, along_velocity), now);
        let marks = &mut self.marks[slot];
        marks.set(Marks::WAITS, true);
        marks.set(Marks::LEANS, false);
        marks.note_chatter(false);
        // Only once in a step: between two that come nearer it would wait without end.
        marks.count_hits(true);
        marks.set(Marks::HIT, true);
        self.marks[along].set(Marks::HIT, true);
        let at = self.carry.blows.partition_point(|blow| blow.slot < slot);
        self.carry.blows.insert(at, Blow { slot, position, velocity });
    }

    /// Lets all of a group wait where they are, in a hop that lasts until the next step, but those that are held.
    pub(super) fn wait_in_place<N: Needs>(&mut self, group: &Group, now: f64) {
        let left = self.carry.next_since(self.origin).map_or(0.0, |next| (next - now).max(0.0));
        let (half_kick, since_middle) = (self.gravity * (0.5 * left), self.since_middle(now));
        self.forget_blows();
        self.carry.note_wait();
        for (&Member { slot, position, .. }, &velocity) in group.members.iter().zip(&group.velocities) {
            if self.marks[slot].has(Marks::HELD) {
                continue;
            }
            if !self.marks[slot].has(Marks::WAITS) {
                let velocity = self.true_velocity(slot, velocity, since_middle);
                self.carry.blows.push(Blow { slot, position, velocity });
            }
            let hop = -self.marks[slot].free_part(half_kick);
            self.redirect(slot, (position, hop), now);
            self.marks[slot].set(Marks::CARRIED, false);
            self.marks[slot].set(Marks::WAITS, true);
            self.marks[slot].set(Marks::HIT, true);
        }
        self.carry.blows.sort_unstable_by_key(|blow| blow.slot);
        // Not before all of them have set out.
        for member in &group.members {
            self.foresee::<N>(member.slot, now);
        }
    }

    /// Forgets what waits no longer.
    fn forget_blows(&mut self) {
        let Self { carry, marks, .. } = self;
        carry.blows.retain(|blow| marks[blow.slot].has(Marks::WAITS));
    }

    /// Ends that a ball waits, if it does: it sets out at its own velocity. Whoever does it finds out what comes next.
    pub(super) fn end_wait<N: Needs>(&mut self, slot: usize, now: f64) {
        self.give_back::<N>(slot, now);
        self.marks[slot].set(Marks::WAITS, false);
    }

    /// Gives a ball its own velocity back, if it waits.
    fn give_back<N: Needs>(&mut self, slot: usize, now: f64) {
        if self.marks[slot].has(Marks::WAITS) {
            let (position, _) = self.state::<N>(slot, now);
            self.redirect(slot, (position, self.own_velocity(slot, position)), now);
        }
    }

    /// The velocity of a ball that waits, once it has come here.
    pub(super) fn own_velocity(&self, slot: usize, position: DVec2) -> DVec2 {
        let blows = &self.carry.blows;
        let at = blows.binary_search_by_key(&slot, |blow| blow.slot);
        at.map_or(DVec2::ZERO, |at| blows[at].velocity_at(position, self.gravity))
    }

    /// Gives what waits its own velocity when a step begins, which then takes all blows at once.
    pub(super) fn take_blows<N: Needs>(&mut self, now: f64) {
        for at in 0..self.carry.blows.len() {
            self.give_back::<N>(self.carry.blows[at].slot, now);
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

    /// Ends all blows: the step is over.
    pub(super) fn end_blows(&mut self) {
        for blow in std::mem::take(&mut self.carry.blows) {
            self.marks[blow.slot].set(Marks::WAITS, false);
        }
    }
}
