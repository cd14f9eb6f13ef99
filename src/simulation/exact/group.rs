//! Balls that touch each other, as one system: what their contacts leave of their velocities, and whether forces there
//! balance gravity.

use glam::DVec2;

use super::contacts::{Contact, Support, descend, pivot};
use super::interior::approach_from_outside;
use super::sweeps::{Enough, accelerate};

/// The part of gravity that may be left unbalanced on a ball that is held: as if there were so much friction.
const UNBALANCED: f64 = 1e-3;
/// The part of the approach that may be left when it is taken: what is left, the next impacts see to.
const PRECISION: f64 = 1e-6;
/// A ball between others of more than so many times its mass takes, to stop them, some three times as many impacts as the
/// root of that.
pub(super) const RATTLER: f64 = 20.0;
/// The part of the energy with which all of a group would hop that its balls are given to part, if less was taken from them: with
/// a twentieth some take ten times as many impacts, and with all of it what they gain in the end is seen.
const LEAST_GIVEN: f64 = 0.3;
/// Forces at so few contacts are found to rounding: in a steep wedge they are many times a ball's weight.
const FEW_CONTACTS: usize = 32;
/// Pushes at more contacts than this are found by sweeps when a group moves on, ...
const SWEPT_CONTACTS: usize = 200;
/// ... and forces at them, in so many at most, ...
const BALANCE_SWEEPS: usize = 2000;
/// ... unless a ball has more than so many times the mass of another, or it is so many times as long as it is wide: it takes more
/// sweeps then, as many as there are layers, and solving for all in the order of their places takes less.
pub(super) const MOST_UNLIKE: f64 = 10.0;
const MOST_SLENDER: f64 = 8.0;
/// A step from outside takes about as long as so many sweeps.
const SWEEPS_PER_STEP: usize = 20;
/// Blows on groups of more contacts than this wait in any case.
const MANY_CONTACTS: usize = 400;

/// A ball of a group.
#[derive(Debug, Clone, Copy)]
pub(super) struct Member {
    pub(super) slot: usize,
    pub(super) position: DVec2,
    /// It overlaps another by more than rounding.
    pub(super) deep: bool,
    pub(super) stays: bool,
}

/// Balls that touch each other, directly or through others.
#[derive(Debug, Default, Clone)]
pub(super) struct Group {
    pub(super) members: Vec<Member>,
    pub(super) inverse_masses: Vec<f64>,
    pub(super) velocities: Vec<DVec2>,
    /// The members' accelerations, px/s²: gravity, then what the pushes at the contacts leave of it.
    pub(super) accelerations: Vec<DVec2>,
    pub(super) contacts: Vec<Contact>,
    /// Whether any contact takes energy from impacts: else all impacts that are left would keep it.
    pub(super) absorbs: bool,
}

/// What a change of a group's velocities took.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Change {
    /// Steps to find it.
    pub(super) steps: usize,
    /// Twice the kinetic energy that it took from the balls; below 0 it gave some.
    pub(super) taken: f64,
    /// The momentum that walls gave.
    pub(super) by_walls: DVec2,
}

impl Group {
    /// Takes a ball in, and returns its place in the group.
    pub(super) fn add(
        &mut self,
        slot: usize,
        (position, velocity): (DVec2, DVec2),
        mass: f64,
        gravity: DVec2,
    ) -> usize {
        self.members.push(Member { slot, position, deep: false, stays: false });
        self.inverse_masses.push(mass.recip());
        self.velocities.push(velocity);
        self.accelerations.push(gravity);
        self.members.len() - 1
    }

    pub(super) fn add_contact(&mut self, one: usize, against: Support, (gap, normal): (f64, DVec2)) {
        let theirs = if let Support::Member(other) = against { self.inverse_masses[other] } else { 0.0 };
        let give = self.inverse_masses[one] + theirs;
        self.contacts.push(Contact { one, against, normal, gap, give, push: 0.0, least: 0.0, pushes: false });
    }

    /// How many times as heavy the heaviest member is as the lightest.
    pub(super) fn most_unlike(&self) -> f64 {
        let lowest =
            self.inverse_masses.iter().fold(f64::INFINITY, |low, &inverse_mass| low.min(inverse_mass));
        let highest = self.inverse_masses.iter().fold(0.0_f64, |high, &inverse_mass| high.max(inverse_mass));
        highest / lowest
    }

    /// Takes the approach from velocities, as impacts without restitution would in the end.
    pub(super) fn take_approach(&mut self) -> Change {
        let approaches = self.contacts.iter().map(|contact| -contact.parting(&self.velocities));
        let most = approaches.fold(0.0, f64::max);
        let (mut velocities, mut contacts) = (self.velocities.clone(), self.contacts.clone());
        let steps = pivot(&mut velocities, &self.inverse_masses, &mut contacts, PRECISION * most);
        // Where no answer was found, not even that they lose energy is sure, nor that there is one.
        let taken = self.energy(&self.velocities) - self.energy(&velocities);
        // A comparison that is false where a jam has made a NaN of it.
        let found = taken >= 0.0;
        if !found {
            return Change { steps, ..Change::default() };
        }
        let by_walls = self.by_walls(&velocities, &contacts, 1.0);
        self.velocities = velocities;
        Change { steps, taken, by_walls }
    }

    /// Lets members that touch and of which one is so much heavier that the other would go to and fro between it and the next
    /// by the thousand before it stopped it part at `least`, px/s, unless they stay, or are farther from each other than `near`, px:
    /// they would rise for ever, each time that the light one comes after the other. They get the energy back that was `taken`
    /// from their approach, as chatter loses none, but some at least.
    pub(super) fn part_unlike(&mut self, least: f64, near: f64, taken: f64) -> Change {
        let (mut velocities, mut contacts) = (self.velocities.clone(), self.contacts.clone());
        let mut found = false;
        for contact in &mut contacts {
            contact.push = 0.0;
            let (one, Support::Member(other)) = (contact.one, contact.against) else { continue };
            let (give, gives) = (self.inverse_masses[one], self.inverse_masses[other]);
            let unlike = give.max(gives) > RATTLER * give.min(gives);
            if unlike && contact.gap < near && !self.members[one].stays && !self.members[other].stays {
                (contact.least, found) = (least, true);
            }
        }
        if !found {
            return Change::default();
        }
        let steps = pivot(&mut velocities, &self.inverse_masses, &mut contacts, PRECISION * least);
        // Where no answer was found, there is none.
        let found = contacts.iter().all(|contact| contact.spare(&velocities) > -0.5 * least);
        if !found {
            return Change { steps, ..Change::default() };
        }
        let enough =
            least * least * self.inverse_masses.iter().map(|inverse_mass| inverse_mass.recip()).sum::<f64>();
        let most = taken.clamp(LEAST_GIVEN * enough, enough);
        let given = self.energy(&velocities) - self.energy(&self.velocities);
        let each = velocities.iter().zip(&self.velocities);
        let changes: Vec<DVec2> = each.map(|(parted, velocity)| *parted - *velocity).collect();
        // What a wedge moves counts as many times as heavy: it parts more slowly. A part p of the changes gives so much energy:
        // p·(given - square) + p²·square.
        let square = self.energy(&changes);
        let along = 0.5 * (given - square);
        let part = if given > most { ((along * along + square * most).sqrt() - along) / square } else { 1.0 };
        let each = self.velocities.iter().zip(changes);
        let parted: Vec<DVec2> = each.map(|(velocity, change)| *velocity + change * part).collect();
        let by_walls = self.by_walls(&parted, &contacts, part);
        self.velocities = parted;
        Change { steps, taken: -given.min(most), by_walls }
    }

    /// The momentum that walls gave members that have these velocities now, where so much of what the contacts push came of it:
    /// all that they have more, but for what immovable ones gave. Where there is no room, what these and walls push against each other has
    /// no bounds: of that no more counts than what all members' velocities have changed by.
    pub(super) fn by_walls(&self, velocities: &[DVec2], contacts: &[Contact], part: f64) -> DVec2 {
        if contacts.iter().all(|contact| contact.against != Support::Wall) {
            return DVec2::ZERO;
        }
        let each = velocities.iter().zip(&self.velocities).zip(&self.inverse_masses);
        let (given, most) = each
            .map(|((after, before), inverse_mass)| (*after - *before) / *inverse_mass)
            .fold((DVec2::ZERO, 0.0), |(given, most), change| (given + change, most + change.length()));
        let immovable = contacts.iter().filter(|contact| matches!(contact.against, Support::Immovable(_)));
        let by_those: DVec2 =
            immovable.map(|contact| contact.normal * (contact.push * part).clamp(-most, most)).sum();
        given - by_those
    }

    /// The momentum that walls gave members that had these velocities before contacts pushed them to those that they have.
    pub(super) fn by_walls_since(&mut self, before: Vec<DVec2>) -> DVec2 {
        let found = std::mem::replace(&mut self.velocities, before);
        let by_walls = self.by_walls(&found, &self.contacts, 1.0);
        self.velocities = found;
        by_walls
    }

    /// The mass of all.
    pub(super) fn mass(&self) -> f64 {
        self.inverse_masses.iter().map(|inverse_mass| inverse_mass.recip()).sum()
    }

    /// Twice their kinetic energy with these velocities.
    pub(super) fn energy(&self, velocities: &[DVec2]) -> f64 {
        let each = velocities.iter().zip(&self.inverse_masses);
        each.map(|(velocity, inverse_mass)| velocity.length_squared() / inverse_mass).sum()
    }

    /// Looks for forces that balance gravity, and returns how many steps it took.
    pub(super) fn balance(&mut self, gravity: f64) -> usize {
        if self.takes_sweeps() {
            let enough = PRECISION * gravity;
            let enough = Enough {
                slower: enough,
                closing: 0.0,
                faster: enough,
                dead: 0.0,
                most_sweeps: BALANCE_SWEEPS,
            };
            return accelerate(&mut self.accelerations, &self.inverse_masses, &mut self.contacts, enough);
        }
        let precision = if self.contacts.len() <= FEW_CONTACTS { 1e-14 } else { 0.1 * UNBALANCED };
        pivot(&mut self.accelerations, &self.inverse_masses, &mut self.contacts, precision * gravity)
    }

    /// Looks for velocities with which each contact's members part as fast as they are to at least, from what contacts push
    /// already, and returns how many steps it took; `directly` where sweeps do not find them, as where there is no room.
    pub(super) fn move_on(&mut self, enough: Enough, directly: bool) -> usize {
        let sweeps =
            if self.takes_sweeps() { self.sweep(enough) } else { self.move_on_exactly(enough.slower) };
        let found = if self.takes_sweeps() {
            sweeps < enough.most_sweeps
        } else {
            self.slowest_parting() >= -enough.slower
        };
        sweeps + if found || !directly { 0 } else { self.move_on_without_room(enough).0 }
    }

    /// The same by sweeps alone.
    pub(super) fn sweep(&mut self, enough: Enough) -> usize {
        accelerate(&mut self.velocities, &self.inverse_masses, &mut self.contacts, enough)
    }

    /// The same, solving for all pushes directly, however many there are.
    pub(super) fn move_on_exactly(&mut self, enough: f64) -> usize {
        self.line_up();
        descend(&mut self.velocities, &self.inverse_masses, &mut self.contacts, enough)
    }

    /// The same where there is no room. Returns how many sweeps take as long, and whether there are such velocities: else they stay as
    /// they are.
    pub(super) fn move_on_without_room(&mut self, enough: Enough) -> (usize, bool) {
        let axis = self.longer_axis();
        let mut order: Vec<usize> = (0..self.members.len()).collect();
        let place = |&member: &usize| self.members[member].position[axis];
        order.sort_by(|one, other| place(one).total_cmp(&place(other)));
        let Self { velocities, inverse_masses, contacts, .. } = self;
        let (steps, found) = approach_from_outside(velocities, inverse_masses, contacts, &order, enough);
        (SWEEPS_PER_STEP * steps, found)
    }

    /// Whether it has many contacts.
    pub(super) fn is_of_many(&self) -> bool {
        self.contacts.len() > MANY_CONTACTS || self.takes_sweeps()
    }

    /// Whether it moves on by sweeps: velocities are not found to the last digit then.
    pub(super) fn takes_sweeps(&self) -> bool {
        let is_compact = || {
            let size = self.size();
            size.max_element() <= MOST_SLENDER * size.min_element()
        };
        self.contacts.len() > SWEPT_CONTACTS && is_compact() && self.most_unlike() <= MOST_UNLIKE
    }

    /// Goes back to these velocities, without pushes, unless those that it has take energy.
    pub(super) fn go_back_unless_it_loses(&mut self, before: &[DVec2]) {
        // False for a NaN.
        let loses = self.energy(&self.velocities) <= self.energy(before);
        if !loses {
            self.go_back(before);
        }
    }

    /// Goes back to these velocities, without pushes.
    pub(super) fn go_back(&mut self, before: &[DVec2]) {
        self.velocities.copy_from_slice(before);
        self.contacts.iter_mut().for_each(|contact| contact.push = 0.0);
    }

    /// How much faster than it is to the contact parts that does so least, px/s.
    pub(super) fn slowest_parting(&self) -> f64 {
        self.contacts.iter().map(|contact| contact.spare(&self.velocities)).fold(f64::INFINITY, f64::min)
    }

    /// Which members any contact pushes.
    pub(super) fn pushed(&self) -> Vec<bool> {
        let mut pushed = vec![false; self.members.len()];
        let pushing = self.contacts.iter().filter(|contact| contact.push > 0.0);
        pushing.flat_map(Contact::pushed).for_each(|(member, _)| pushed[member] = true);
        pushed
    }

    /// From the first to the last of its balls' centres, px.
    fn size(&self) -> DVec2 {
        let places = || self.members.iter().map(|member| member.position);
        places().fold(DVec2::NEG_INFINITY, DVec2::max) - places().fold(DVec2::INFINITY, DVec2::min)
    }

    /// The axis along which it is longer.
    fn longer_axis(&self) -> usize {
        let size = self.size();
        usize::from(size.y > size.x)
    }

    /// Puts contacts into the order of their places along the group's longer side: those that have a member in common are near
    /// each other then.
    fn line_up(&mut self) {
        let axis = self.longer_axis();
        let place = |member: usize| self.members[member].position[axis];
        let middle = |contact: &Contact| match contact.against {
            Support::Member(other) => 0.5 * (place(contact.one) + place(other)),
            Support::Wall | Support::Immovable(_) => place(contact.one),
        };
        self.contacts.sort_by(|one, other| middle(one).total_cmp(&middle(other)));
    }

    /// Chooses the members that stay: slow, in balance, and neither supported nor pressed by any but such as stay.
    /// What overlaps is to part first, unless it is `stuck`: there is no room.
    pub(super) fn choose(&mut self, gravity: f64, rest_speed: f64, stuck: bool) {
        let Self { members, velocities, accelerations, contacts, .. } = self;
        let enough = UNBALANCED * gravity;
        for ((member, velocity), acceleration) in members.iter_mut().zip(velocities).zip(&*accelerations) {
            let still = if member.deep { stuck } else { velocity.length() <= rest_speed };
            member.stays = still && acceleration.length() <= enough;
        }
        let mut found = false;
        while !found {
            found = true;
            for contact in &*contacts {
                let Support::Member(other) = contact.against else { continue };
                let counts = contact.push > 0.0 || contact.parting(accelerations) < -enough;
                if counts && members[contact.one].stays != members[other].stays {
                    (members[contact.one].stays, members[other].stays) = (false, false);
                    found = false;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Contacts of which there are more than the balls can answer to, as in a jam: what walls push against each other then may
        /// be any number.
        #[test]
        fn walls_give_what_changes_the_momentum_and_no_more_where_there_is_no_room(
            balls in prop::collection::vec((-9.0..9.0_f64, -9.0..9.0_f64, 0..7_i32, -9.0..9.0_f64, -9.0..9.0_f64), 2..6),
        ) {
            let mut group = Group::default();
            for (slot, &(x, y, decade, u, v)) in balls.iter().enumerate() {
                let mass = 10_f64.powi(decade);
                group.add(slot, (DVec2::new(x, y), DVec2::new(u, v)), mass, DVec2::ZERO);
                for wall in [DVec2::X, -DVec2::X, DVec2::Y, -DVec2::Y] {
                    group.add_contact(slot, Support::Wall, (0.0, wall));
                }
                for before in 0..slot {
                    let way = group.members[slot].position - group.members[before].position;
                    group.add_contact(slot, Support::Member(before), (0.0, way.normalize_or(DVec2::X)));
                }
            }
            let momentum = |group: &Group| -> DVec2 {
                let each = group.velocities.iter().zip(&group.inverse_masses);
                each.map(|(velocity, inverse_mass)| *velocity / *inverse_mass).sum()
            };
            let before = momentum(&group);
            let Change { by_walls, .. } = group.take_approach();
            let given = momentum(&group) - before;
            prop_assert!(by_walls.distance(given) <= 1e-9 * (before.length() + given.length()), "{by_walls}, not {given}");
        }
    }
}
