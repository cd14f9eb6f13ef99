//! With which velocities balls that are carried go on until their next step, and which of them are held from then on.

use glam::DVec2;

use super::carry::key;
use super::contacts::{Contact, Support};
use super::flights::Marks;
use super::group::{Group, Member};
use super::settle::FIRM;
use super::sweeps::Enough;
use super::{Exact, Needs};

/// The part of what is between two balls that is left after a step at least.
const KEPT_APART: f64 = 0.5;
/// How far balls that are carried are kept from each other, as a part of how far one falls in a step, twice: the nearer they are, the
/// more often they hit each other once a blow has made them faster, and the farther, the more is a crowd lifted.
const APART: f64 = 0.01;
/// The same of those that go straight, and whose steps are longer, over how many times as long: they hop over nothing.
const APART_STRAIGHT: f64 = 0.005;
/// The part that counts of the acceleration with which two that go round each other part: until the step ends they may go round
/// each other more slowly.
const ROUND: f64 = 0.8;
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
/// Among many, that is enough after so many sweeps, and as many more as steps are times as long.
const MOST_SWEEPS: f64 = 50.0;
/// A crowd of many swings before it comes to rest, and its balls close what is between them only now and then: those that are so many
/// times as far from each other as what touches may hold each other.
const SWINGS: f64 = 10.0;
/// Steps from one search for forces that balance gravity to the next.
const STEPS_PER_SEARCH: u64 = 8;
/// Steps from one try to part where there is no room to the next.
const STEPS_PER_PARTING: u64 = 16;

/// How fast two may approach each other at first, px/s, that are to come no nearer than by this, px, in this time, s, and part with this
/// acceleration meanwhile.
fn fastest_approach(closes: f64, around: f64, time: f64) -> f64 {
    if closes <= 0.0 {
        return closes / time;
    }
    // So fast they turn back just there, or do not until then.
    let turns_back = (2.0 * around * closes).sqrt();
    if turns_back < around * time { turns_back } else { closes / time + 0.5 * around * time }
}

impl Exact {
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
    pub(super) fn find_velocities<N: Needs>(&mut self, group: &mut Group, now: f64) -> Option<DVec2> {
        let step = self.carry.step();
        let gravity = self.gravity.length();
        let (longer, kick) = (self.carry.longer, gravity * step);
        let part = if self.carry.goes_straight() { APART_STRAIGHT / longer } else { APART };
        let apart = part * gravity * step * step;
        let enough = Enough {
            slower: PRECISION * kick,
            closing: CLOSES / step,
            faster: FASTER * kick,
            dead: 0.0,
            most_sweeps: (MOST_SWEEPS * (1.0 + longer)) as usize,
        };
        let kicked = group.velocities.clone();
        let lifts = gravity * apart * self.layers::<N>(group);
        let most_given = group.mass() * (MOST_GIVEN * self.rest_speed * self.rest_speed + lifts);
        // Where there was no room a moment ago there is none.
        let were_tight = group.members.iter().filter(|member| self.marks[member.slot].has(Marks::TIGHT));
        let tight = !self.is_nth_step(now, STEPS_PER_PARTING) && 2 * were_tight.count() > group.members.len();
        let blows = self.has_blows();
        for (part, rebound) in [(true, blows), (false, true), (false, false)] {
            if tight && part || !blows && rebound {
                continue;
            }
            group.velocities.clone_from(&kicked);
            for contact in &mut group.contacts {
                let closes = (1.0 - KEPT_APART) * (contact.gap - apart);
                let around = self.acceleration_around(&group.members, contact, &kicked);
                let least = (-fastest_approach(closes, around, step)).min(0.5 * self.rest_speed);
                contact.least = if part { least } else { least.min(0.0) };
                let rebounds = rebound.then(|| self.rebound::<N>(&group.members, contact, &kicked)).flatten();
                contact.least = rebounds.map_or(contact.least, |speed| contact.least.max(speed));
                // Pushes without bounds lead nowhere from where there is no room.
                contact.push = if part { self.carry.push(key(&group.members, contact)) } else { 0.0 };
                contact.apply(contact.push, &mut group.velocities, &group.inverse_masses);
            }
            let steps = group.move_on(enough, self.carry.headway.is_jammed(group));
            self.note_steps(group, steps);
            // What rebounds takes some.
            let parts = |contact: &&Contact| {
                !rebound || self.rebound::<N>(&group.members, contact, &kicked).is_none()
            };
            let given = |contact: &Contact| contact.push * contact.least.max(0.0);
            let given: f64 = group.contacts.iter().filter(parts).map(given).sum();
            // Comparisons that are false for a NaN.
            if given <= most_given && group.energy(&group.velocities) <= group.energy(&kicked) {
                let by_walls = group.by_walls_since(kicked);
                for member in &group.members {
                    self.marks[member.slot].set(Marks::TIGHT, !part);
                }
                return Some(by_walls);
            }
        }
        group.velocities = kicked;
        None
    }

    /// The acceleration with which two part that go round each other straight, as much of it as counts, px/s²: so what rolls over another
    /// one is lifted off it by no more than it takes.
    fn acceleration_around(&self, members: &[Member], contact: &Contact, velocities: &[DVec2]) -> f64 {
        if !self.carry.goes_straight() {
            return 0.0;
        }
        let (place, velocity) = match contact.against {
            Support::Wall => return 0.0,
            Support::Member(other) => (members[other].position, velocities[other]),
            Support::Immovable(slot) => (self.flights[slot].position, DVec2::ZERO),
        };
        let along = (velocities[contact.one] - velocity).perp_dot(contact.normal);
        ROUND * along * along / members[contact.one].position.distance(place)
    }

    /// Chooses the members of a group that are held from now on, by how their velocities changed, and now and then, since what
    /// is between balls still closes for a while, by whether forces can balance gravity.
    pub(super) fn choose_held(&self, group: &mut Group, means: &[DVec2], now: f64) {
        let (gravity, step) = (self.gravity.length(), self.carry.step());
        let changes = group.velocities.iter().zip(means).map(|(velocity, mean)| (*velocity - *mean) / step);
        group.accelerations = changes.collect();
        // Where all together have not even the energy of the rest speed, some are faster as they swing.
        let swings = group.energy(&group.velocities) <= group.mass() * self.rest_speed * self.rest_speed;
        let slow = if swings { FIRM * self.rest_speed } else { self.rest_speed };
        group.choose(gravity, slow, false);
        if !self.is_nth_step(now, STEPS_PER_SEARCH) || group.members.iter().all(|member| member.stays) {
            return;
        }
        let many = group.is_of_many();
        let touch = if many { self.swing_distance() } else { self.touch_distance() };
        let near = group.contacts.iter().filter(|contact| contact.gap < touch);
        let contacts = near.map(|contact| Contact { push: contact.push / step, least: 0.0, ..*contact });
        let mut still = Group { contacts: contacts.collect(), ..group.clone() };
        // Without any that are slow enough, and pressed by none but such now, or half of many, there is hardly any to be found.
        still.accelerations.fill(DVec2::ZERO);
        still.choose(gravity, slow, false);
        let may_stay = still.members.iter().filter(|member| member.stays).count();
        if may_stay == 0 || many && 2 * may_stay < still.members.len() {
            return;
        }
        still.accelerations.fill(self.gravity);
        for contact in &still.contacts {
            contact.apply(contact.push, &mut still.accelerations, &still.inverse_masses);
        }
        still.balance(gravity);
        still.choose(gravity, slow, false);
        group.members = still.members;
    }

    /// How far the fastest of those that are among many goes in a time, px: among those that are no farther from each other are nearly all
    /// that may meet until then.
    pub(super) fn farthest_way<N: Needs>(&self, now: f64, time: f64) -> f64 {
        let among = (0..self.flights.len()).filter(|&slot| self.marks[slot].is_among_many());
        time * among.map(|slot| self.state::<N>(slot, now).1.length()).fold(0.0, f64::max)
    }

    /// How near balls are that hold each other while a crowd of many swings, px.
    pub(super) fn swing_distance(&self) -> f64 {
        SWINGS * self.touch_distance()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Two balls on straight ways: the one stands, and the other comes from `gap` px off it, across at `along` px/s.
        #[test]
        fn what_goes_round_another_as_fast_as_it_may_comes_no_nearer_than_that_and_no_farther_off_than_without(
            reach in 1.0..100.0_f64,
            gap in 1e-6..0.1_f64,
            along in 0.0..500.0_f64,
            time in 1e-4..5e-3_f64,
        ) {
            let distance = reach + gap;
            let around = along * along / distance;
            let closes = 0.5 * gap;
            let approach = fastest_approach(closes, around, time);
            let at = |after: f64| DVec2::new(distance - approach * after, along * after).length();
            let nearest = (0..=1000).map(|part| at(f64::from(part) * 1e-3 * time)).fold(f64::INFINITY, f64::min);
            // To first order in the way across over the distance.
            let off = (along * time / distance).powi(2);
            prop_assume!(off < 0.05);
            prop_assert!(distance - nearest <= closes * (1.0 + off) + 1e-12, "{} px of {closes}", distance - nearest);
            let straight = DVec2::new(distance - closes, along * time).length();
            prop_assert!(at(time) <= straight + 1e-12, "{} px off, not {straight}", at(time));
        }
    }

    #[test]
    fn what_parts_already_may_approach_each_other_no_faster_for_going_round() {
        assert_eq!(fastest_approach(-0.5, 100.0, 0.25), -2.0);
        assert_eq!(fastest_approach(0.5, 0.0, 0.25), 2.0);
    }
}
