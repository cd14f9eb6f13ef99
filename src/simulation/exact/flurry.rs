//! Flurries of hits among what is carried, and how they end.
//!
//! What is carried is so near to each other that a blow sends its balls to and fro by the hundred until they set out anew in the
//! next step, and where they have no room without end. So a ball that has been hit often since the last step does so at once, with
//! those beside it that have been hit, too: what is left of their approach is taken, as impacts without restitution would take it
//! in the end, so far that none of them meet before that step.

use glam::DVec2;

use crate::simulation::Tally;
use crate::simulation::clock::INSTANT;

use super::contacts::Support;
use super::flights::Marks;
use super::gather::{Belong, Near};
use super::group::{Group, Member};
use super::settle::{FIRM, LARGEST, STEPS_PER_EVENT};
use super::sweeps::Enough;
use super::{Exact, Needs};

/// So many hits of a ball since the last step, or the last flurry, are one.
const FLURRY: u32 = 8;
/// The part of what is between two balls that is left when the step ends at least, ...
const KEPT_APART: f64 = 0.5;
/// ... and between one and what nothing moves, which it may hop off in the meantime.
const KEPT_OFF: f64 = 1e-3;
/// How exactly velocities are found, in rest speeds.
const PRECISION: f64 = 1e-8;
/// How much faster than they have to those may part that push where there is no room, in rest speeds.
const LOOSE: f64 = 1e-2;
/// What takes an approach from a flurry that is faster than this, in rest speeds, gets on, however little time passes.
const GETS_ON: f64 = 1e-3;
/// Among many contacts, how much faster than they have to balls are looked for that part, as a part of the fastest approach: so few
/// sweeps find velocities with which none meets again at once.
const MARGIN: f64 = 1e-2;
/// In so many sweeps at most, and, where there is no room for that margin, so many without it.
const MOST_SWEEPS: usize = 100;
/// What goes straight waits in place where what takes the approach gives it more energy than this part of that of its mass at the rest
/// speed, twice.
const MOST_GAINED: f64 = 0.05;
/// Any group waits in place for the next step after so many flurries of one of its balls since the last one, ...
const MOST_FLURRIES: u32 = 12;
/// ... and one of many after so many: exact fits would have more and more of them.
const FEW_FLURRIES: u32 = 4;

impl Exact {
    /// Whether a ball has had a flurry of hits since the last step.
    #[inline]
    pub(super) fn has_flurry(&self, slot: usize) -> bool {
        self.marks[slot].hits_in_step() > FLURRY
    }

    /// How fast two balls part at most that come back to each other before the next step, where one of them sets out anew then, px/s,
    /// by the acceleration that presses them on each other, px/s².
    pub(super) fn longest_hop(&self, two: [usize; 2], presses: f64, now: f64) -> f64 {
        let counts = two.iter().any(|&slot| self.marks[slot].hits_in_step() > 0);
        let next = self.carry.next_since(self.origin).filter(|_| counts);
        next.map_or(f64::INFINITY, |next| 0.5 * (presses * (next - now)).max(0.0))
    }

    /// Ends the flurry of hits that a ball has had.
    pub(super) fn end_flurry<N: Needs>(&mut self, tally: &mut Tally, slot: usize, now: f64) {
        let Some(next) = self.carry.next_since(self.origin) else { return };
        let left = (next - now).max(INSTANT);
        debug_assert!(!self.marks[slot].has(Marks::HELD));
        let near = Near {
            touch: self.carry_touch(),
            belong: Belong::Flurry,
            farther: self.farthest_way::<N>(now, left),
            most: LARGEST,
        };
        let mut group = self.gather::<N>(slot, now, near, &[]);
        let deep = group.members.iter().any(|member| member.deep);
        let may_end = !deep && group.absorbs;
        group.members.iter().for_each(|member| self.marks[member.slot].count_hits(may_end));
        self.unwatched += (group.members.len() / STEPS_PER_EVENT) as u32;
        if !may_end {
            // It goes on until the step, and what came no nearer to others may do so.
            return group.members.iter().for_each(|member| self.foresee::<N>(member.slot, now));
        }
        let most = if group.is_of_many() { FEW_FLURRIES } else { MOST_FLURRIES };
        if self.carry.headway.has_too_many_flurries(&group, most) {
            return self.wait_in_place::<N>(&group, now);
        }
        // What is held is freed by a firm hit.
        let firm = FIRM * self.rest_speed;
        let Group { contacts, velocities, .. } = &mut group;
        contacts.retain(|contact| {
            let is_held =
                matches!(contact.against, Support::Immovable(slot) if self.marks[slot].has(Marks::HELD));
            !is_held || contact.parting(velocities) > -firm
        });
        // In the time that is left they get as far as at these velocities.
        let half_kick = self.gravity * (0.5 * left);
        let kicks: Vec<DVec2> =
            group.members.iter().map(|member| self.marks[member.slot].accelerated_part(half_kick)).collect();
        group.velocities.iter_mut().zip(&kicks).for_each(|(velocity, kick)| *velocity += *kick);
        let Some((fastest, before)) = self.take_flurry(&mut group, left, &kicks) else { return };
        if self.gained_by(&group, &before, now)
            > MOST_GAINED * group.mass() * self.rest_speed * self.rest_speed
        {
            return self.wait_in_place::<N>(&group, now);
        }
        tally.wall_impulse += group.by_walls_since(before);
        if fastest > GETS_ON * self.rest_speed {
            self.at_once = 0;
        }
        group.velocities.iter_mut().zip(&kicks).for_each(|(velocity, kick)| *velocity -= *kick);
        self.go_on_after_flurry::<N>(&group, now);
    }

    /// Twice the energy that a group's balls gain as their velocities change from these, where those of some are mean ones: what an
    /// impulse gives that lifts them early in a step, less what it takes from their motion.
    fn gained_by(&self, group: &Group, before: &[DVec2], now: f64) -> f64 {
        let since_middle = self.since_middle(now);
        let each = group.members.iter().zip(before).zip(&group.velocities).zip(&group.inverse_masses);
        each.map(|(((member, before), after), inverse_mass)| {
            let square = |velocity: DVec2| self.true_square(member.slot, velocity, since_middle);
            (square(*after) - square(*before)) / inverse_mass
        })
        .sum()
    }

    /// Takes from a group's velocities what lets its members meet in the time that is left, s. Returns their fastest approach, and the
    /// velocities before, if there was any, and what takes it loses energy.
    fn take_flurry(&mut self, group: &mut Group, left: f64, kicks: &[DVec2]) -> Option<(f64, Vec<DVec2>)> {
        let before = group.velocities.clone();
        // What is drawn away from what does not move comes nearer to that first, unless it parts from it: without, where that takes
        // energy.
        let drawn = group.contacts.iter().any(|contact| contact.sooner(kicks) > 0.0);
        for parts in [true, false].into_iter().skip(usize::from(!drawn)) {
            for contact in &mut group.contacts {
                let kept = if matches!(contact.against, Support::Member(_)) { KEPT_APART } else { KEPT_OFF };
                let sooner = if parts { contact.sooner(kicks) } else { 0.0 };
                contact.least = sooner - (1.0 - kept) * contact.gap.max(0.0) / left;
            }
            let fastest = (-group.slowest_parting()).max(0.0);
            if fastest <= PRECISION * self.rest_speed {
                return None;
            }
            let takes = self.take_approach(group, &before, fastest);
            // False for a NaN.
            if takes && group.energy(&group.velocities) <= group.energy(&before) {
                return Some((fastest, before));
            }
            group.go_back(&before);
        }
        None
    }

    /// Takes the approach, of which this is the fastest, from these velocities, and returns whether it does.
    fn take_approach(&mut self, group: &mut Group, before: &[DVec2], fastest: f64) -> bool {
        let precision = PRECISION * self.rest_speed;
        let jammed = self.carry.headway.is_jammed(group);
        let found = if group.takes_sweeps() {
            // With a margin, as long as there is room for it.
            self.take_nearly(group, MARGIN * fastest)
        } else {
            let steps = group.move_on_exactly(precision);
            self.note_steps(group, steps);
            !jammed || group.slowest_parting() >= -precision
        };
        if found {
            return true;
        }
        group.go_back_unless_it_loses(before);
        if jammed {
            let faster = LOOSE * self.rest_speed;
            let enough =
                Enough { slower: precision, closing: 0.0, faster, dead: 0.0, most_sweeps: MOST_SWEEPS };
            let (steps, found) = group.move_on_without_room(enough);
            self.note_steps(group, steps);
            return found;
        }
        // What is left then only begins the next flurry.
        self.take_nearly(group, 0.0);
        true
    }

    /// Takes it by sweeps so far that what pushes parts faster than it has to by a margin, px/s, and
    /// returns whether nothing is left of it.
    fn take_nearly(&mut self, group: &mut Group, margin: f64) -> bool {
        group.contacts.iter_mut().for_each(|contact| contact.least += margin);
        let precision = PRECISION * self.rest_speed;
        let half = precision + 0.5 * margin;
        let sweeps = group.sweep(Enough {
            slower: half,
            closing: 0.0,
            faster: half,
            dead: margin,
            most_sweeps: MOST_SWEEPS,
        });
        group.contacts.iter_mut().for_each(|contact| contact.least -= margin);
        self.note_steps(group, sweeps);
        group.slowest_parting() >= -precision
    }

    /// Notes for the caller's watch what steps or sweeps to find a group's velocities took.
    pub(super) fn note_steps(&mut self, group: &Group, steps: usize) {
        self.unwatched += (steps * group.contacts.len() / STEPS_PER_EVENT) as u32;
    }

    /// Lets those of a group's balls set out that have been pushed.
    fn go_on_after_flurry<N: Needs>(&mut self, group: &Group, now: f64) {
        let pushed = group.pushed();
        for ((&Member { slot, position, .. }, &velocity), &pushed) in
            group.members.iter().zip(&group.velocities).zip(&pushed)
        {
            if pushed {
                let rests = self.marks[slot].rests();
                let velocity = self.lift_off(slot, velocity);
                let marks = &mut self.marks[slot];
                marks.set(Marks::HIT, true);
                self.note_lift(slot, rests);
                self.redirect(slot, (position, velocity), now);
            }
        }
        // Not before all of them have set out.
        for (&Member { slot, .. }, _) in group.members.iter().zip(pushed).filter(|(_, pushed)| *pushed) {
            self.foresee::<N>(slot, now);
        }
    }
}
