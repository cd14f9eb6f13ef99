//! Balls that are held against each other come to rest as a group.
//!
//! What lies on others would hit them without end: the load of a pile of n layers comes through n times as many impacts
//! as that of one ball. So a ball that has chattered for long asks for its group, all balls that touch each other
//! there, and two questions are answered for all of them at once. First, what becomes of their velocities when the
//! impacts that are left take all approach: so a ball is stopped in a wedge, and a row between walls. Second, whether
//! forces at their contacts can balance gravity. Balls that are in balance and slow stand still from then on: they are
//! *held*, until something hits them firmly, or one that they touch is freed, or the balance is lost when another ball
//! joins the group.

use glam::DVec2;

use crate::simulation::Tally;

use super::contacts::{Contact, Support};
use super::flights::{Flight, Marks, Way};
use super::gather::{Belong, Near};
use super::group::{Group, Member};
use super::{Exact, LEAN, Needs};

/// How slow balls that touch, but have not chattered, are beside each other if they are of one group, in rest speeds.
const SLOW: f64 = LEAN;
/// How fast, in rest speeds, what hits a held ball is if it frees it. What is slower bounces off it as off a fixed one.
pub(super) const FIRM: f64 = 2.0;
/// How far below another a ball is, as a part of the distance at which they touch, that cannot lean on it.
const BESIDE: f64 = 0.25;
/// The most balls of a group that is solved for directly. Held ones beyond it count as immovable.
pub(super) const LARGEST: usize = 4096;
/// How fast a ball leaves the wall that it rests on at least, in rest speeds.
pub(super) const LIFTED: f64 = 1e-3;
/// Steps of conjugate gradients, over one contact, that are paid for with one event. They take about a hundredth of the
/// time of that, so that the search for groups takes a third of all time at most.
pub(super) const STEPS_PER_EVENT: usize = 32;
/// So many times as much is paid for a search that finds nothing.
const IN_VAIN: i64 = 4;
/// So many events at one time and more, and so many for each ball, say that balls that overlap have no room to part.
const STUCK: usize = 1000;
const STUCK_PER_BALL: usize = 16;
/// Balls that are in so many others each are no group that could rest: it would take long to find out.
const MOST_CONTACTS: usize = 8;
/// How near balls are that hop off each other, in squares of the hop's speed over gravity: a quarter of how far they hop.
const NEAR: f64 = 0.125;

impl Exact {
    /// Stops the group of a ball that has chattered for long, and lays it to rest as far as it is in balance.
    pub(super) fn settle<N: Needs>(&mut self, tally: &mut Tally, slot: usize, now: f64) {
        let stuck = self.is_crammed();
        let Some(mut group) = self.group_to_stop::<N>(slot, now, stuck) else { return };
        if group.takes_sweeps() && self.may_be_carried(&group) {
            return self.leave_to_step::<N>(&group, now);
        }
        let stopped = group.take_approach();
        let (mut steps, mut by_walls, mut carry) = (stopped.steps, stopped.by_walls, false);
        if self.gravity != DVec2::ZERO {
            let gravity = self.gravity.length();
            steps += group.balance(gravity);
            group.choose(gravity, self.rest_speed, stuck);
            carry = self.may_be_carried(&group) && group.members.iter().any(|member| !member.stays);
            if carry {
                self.call_step(now);
            } else {
                // Gravity would press them on each other again at once.
                let hop = self.least_hop(0.0);
                let parted = group.part_unlike(hop, NEAR * hop * hop / gravity, stopped.taken);
                (steps, by_walls) = (steps + parted.steps, by_walls + parted.by_walls);
            }
        }
        tally.wall_impulse += by_walls;
        let cost = (group.members.len() + steps * group.contacts.len() / STEPS_PER_EVENT) as i64;
        // Where nothing comes to rest, it is too early.
        let in_vain = group.members.iter().all(|member| !member.stays)
            && (self.gravity != DVec2::ZERO || stopped.taken <= 0.0);
        self.credit -= if in_vain { IN_VAIN * cost } else { cost };
        self.unwatched += cost as u32;
        self.lay_down::<N>(&group, carry, now);
        self.note_leaning(&group);
    }

    /// Lets a group of many wait for the next step, except those that are held: what becomes of them that finds out by sweeps, in less
    /// time.
    fn leave_to_step<N: Needs>(&mut self, group: &Group, now: f64) {
        self.call_step(now);
        self.credit -= group.members.len() as i64;
        for &Member { slot, .. } in &group.members {
            let held = self.marks[slot].has(Marks::HELD);
            self.marks[slot].calm_down();
            self.marks[slot].count_hits(!held);
        }
        self.wait_in_place::<N>(group, now);
    }

    /// Whether so much happens at one time that balls that overlap have no room to part.
    pub(super) fn is_crammed(&self) -> bool {
        self.at_once > STUCK.max(STUCK_PER_BALL * self.flights.len())
    }

    /// The group of a ball that has chattered for long, if it is time to stop it: not where it is carried, and taken in in the next
    /// step, unless it is stuck.
    fn group_to_stop<N: Needs>(&mut self, slot: usize, now: f64, stuck: bool) -> Option<Group> {
        let goes_along = self.marks[slot].has(Marks::GOES_ALONG) && !stuck;
        if self.note_pressing(now) || self.credit < 0 || goes_along {
            return None;
        }
        if stuck {
            self.end_waits::<N>(now);
        }
        let belong = if stuck { Belong::Slow(SLOW) } else { Belong::UpToCarried(SLOW) };
        let near = Near { touch: self.touch_distance(), belong, farther: 0.0, most: LARGEST };
        let group = self.gather::<N>(slot, now, near, &[]);
        if !stuck && group.members.iter().any(|member| self.marks[member.slot].has(Marks::GOES_ALONG)) {
            self.credit -= group.members.len() as i64;
            return None;
        }
        let crowded = group.contacts.len() > MOST_CONTACTS * group.members.len();
        let slow = |contact: &Contact| -contact.parting(&group.velocities) <= self.rest_speed;
        let lies = self.gravity != DVec2::ZERO && group.contacts.iter().all(slow);
        // Among elastic balls, what chatters fast loses nothing.
        if crowded || !(group.absorbs || lies) {
            self.give_up(&group);
            return None;
        }
        Some(group)
    }

    /// Holds the members of a group that stay, and lets the others set out, to be carried or not.
    fn lay_down<N: Needs>(&mut self, group: &Group, carry: bool, now: f64) {
        let among_balls = group.contacts.iter().any(|contact| contact.against != Support::Wall);
        for (&Member { slot, position, stays, .. }, &velocity) in group.members.iter().zip(&group.velocities)
        {
            let held = self.marks[slot].has(Marks::HELD);
            self.marks[slot].calm_down();
            if held && stays {
                continue;
            }
            if held {
                self.let_go::<N>(slot);
            }
            if among_balls {
                // What it touches, or as good as, has stopped it, or let it go.
                self.marks[slot].set(Marks::HIT, true);
            }
            let mut velocity = if stays { DVec2::ZERO } else { self.lift_off(slot, velocity) };
            // On the walls that it may rest on at first it is not carried.
            let goes_off = carry && !stays && self.marks[slot].rests() == 0;
            if goes_off {
                velocity = self.carried_velocity(velocity, self.since_middle(now));
            }
            self.set_out(slot, (position, velocity), now);
            self.marks[slot].go(match (stays, carry) {
                (true, _) => Way::Held,
                (false, true) => Way::Carried,
                (false, false) => Way::Flies,
            });
            self.marks[slot].set(Marks::STRAIGHT, goes_off && self.carry.goes_straight());
            self.foresee::<N>(slot, now);
        }
    }

    /// Lifts a ball that sets out at this velocity off the walls that it rests on, or leaves it on them where that is only what is left
    /// of an approach, and returns its velocity.
    pub(super) fn lift_off(&mut self, slot: usize, mut velocity: DVec2) -> DVec2 {
        for axis in 0..2 {
            let rests = Marks::rests_on(axis);
            if self.marks[slot].has(rests) {
                let lifted = velocity[axis].abs() > LIFTED * self.rest_speed;
                self.marks[slot].set(rests, !lifted);
                velocity[axis] = if lifted { velocity[axis] } else { 0.0 };
            }
        }
        velocity
    }

    /// Leaves a group as it is, until its balls have chattered for long again.
    fn give_up(&mut self, group: &Group) {
        self.credit -= IN_VAIN * (group.members.len() + group.contacts.len() / STEPS_PER_EVENT) as i64;
        group.members.iter().for_each(|member| self.marks[member.slot].calm_down());
    }

    /// Notes which balls that are held are shown as touching others.
    pub(super) fn note_leaning(&mut self, group: &Group) {
        let held = |index: usize| Some(&group.members[index]).filter(|member| member.stays);
        for contact in group.contacts.iter().filter(|contact| contact.push > 0.0) {
            let Some(one) = held(contact.one) else { continue };
            match contact.against {
                Support::Wall => continue,
                Support::Member(other) => self.marks[group.members[other].slot].set(Marks::LEANS, true),
                Support::Immovable(other) => {
                    let pair = (one.slot as u32, other as u32);
                    if !self.propped.contains(&pair) {
                        self.propped.push(pair);
                    }
                }
            }
            self.marks[one.slot].set(Marks::LEANS, true);
        }
    }

    /// How near balls are that touch, px: twice as far as one at the rest speed hops from another.
    pub(super) fn touch_distance(&self) -> f64 {
        (0.5 * self.rest_speed * self.chatter_time).min(self.chatter_length)
    }

    /// Ends the hold on a ball; whoever does it lets it set out, and finds out what comes next.
    pub(super) fn let_go<N: Needs>(&mut self, slot: usize) {
        let jams = self.jams_on(self.matter::<N>(slot).radius);
        let marks = &mut self.marks[slot];
        marks.rest(jams);
        marks.go(Way::Flies);
        marks.forget_quick_hits();
        marks.calm_down();
        // It touched others until now, and does so no more where the next frame is shown.
        marks.set(Marks::HIT, true);
        self.propped.retain(|&(ball, _)| ball as usize != slot);
    }

    /// Frees a held ball that is hit, with the held ones that it touches, and in turn those that lie on them or beside
    /// them. Whoever hits it finds out what comes next for the ball itself.
    pub(super) fn free<N: Needs>(&mut self, hit: usize, now: f64) {
        let mut freed = vec![hit];
        let touch = 2.0 * self.touch_distance();
        let mut at = 0;
        while at < freed.len() {
            let one = freed[at];
            if self.marks[one].has(Marks::HELD) {
                let Flight { position, place, .. } = self.flights[one];
                self.let_go::<N>(one);
                self.redirect(one, (position, DVec2::ZERO), now);
                let radius = self.matter::<N>(one).radius;
                let Some(cells) = &self.cells else { break };
                cells.for_each_near::<N>(one, place, None, |other| {
                    if self.marks[other].has(Marks::HELD) {
                        let offset = self.flights[other].position - position;
                        let reach = radius + self.matter::<N>(other).radius;
                        let below = offset.dot(self.gravity) > BESIDE * reach * self.gravity.length();
                        if offset.length() - reach < touch && (one == hit || !below) {
                            freed.push(other);
                        }
                    }
                });
            }
            at += 1;
        }
        for slot in freed.into_iter().filter(|&slot| slot != hit) {
            self.foresee::<N>(slot, now);
        }
    }
}
