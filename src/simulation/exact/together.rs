//! What happens where a ball meets several others at one time.
//!
//! One after the other, such impacts would depend on which of them is taken first, and a scene that is its own mirror
//! image would not stay so. They are solved as one (see `simultaneous`).

use glam::DVec2;

use crate::simulation::Tally;
use crate::simulation::flight::Pair;
use crate::simulation::simultaneous::{Body, Contact, exchange, lie_in_each_other};

use super::flights::{Marks, Way};
use super::{Exact, LEAN, Needs};

/// Balls touch where the square of their distance exceeds that at which they touch by at most this part of it: their
/// times of impact round differently, and balls that part by so little do so within a time that no frame shows.
pub(super) const AT_HAND: f64 = 1e-11;
/// Impacts at one time that are solved as one. More of them are taken one after the other.
const MOST_TOGETHER: usize = 64;

/// The balls that meet at one time, and the pairs of them that do.
#[derive(Debug, Default)]
struct Group {
    slots: Vec<usize>,
    positions: Vec<DVec2>,
    bodies: Vec<Body>,
    contacts: Vec<Contact>,
}

/// Two balls that meet at that time.
struct Meeting {
    /// From the second to the first, px.
    offset: DVec2,
    restitution: f64,
    /// Whether one of them may come to rest.
    may_rest: bool,
}

impl Exact {
    /// Makes one impact of that of two balls, which has just been taken, and of all at this time that others which they
    /// touch have with them or with further ones. The two had these velocities before.
    ///
    /// Nothing changes where there are no others, or where any of them may come to rest; nor where the two lie in each
    /// other, or rounding hides that they touch, as it does where they are tiny and far from the origin: their impact
    /// stands, and may not be undone.
    #[cold]
    pub(super) fn collide_together<N: Needs>(
        &mut self,
        tally: &mut Tally,
        two: [(usize, DVec2); 2],
        now: f64,
    ) {
        let Some(mut group) = self.group::<N>(two, now) else { return };
        let has_the_two = group.contacts.iter().any(|contact| (contact.first, contact.second) == (0, 1));
        if !has_the_two || group.contacts.len() < 2 {
            return;
        }
        let Some(pushed) = exchange(&mut group.bodies, &group.contacts) else { return };
        // One of them has been counted.
        tally.impacts += pushed as u64 - 1;
        self.hits += 2 * (pushed - 1);
        for (index, &slot) in group.slots.iter().enumerate() {
            let velocity = group.bodies[index].velocity;
            if index < 2 {
                self.flights[slot].velocity = velocity;
                continue;
            }
            self.set_out(slot, (group.positions[index], velocity), now);
            let marks = &mut self.marks[slot];
            marks.go(Way::Flies);
            marks.set(Marks::HIT, true);
            marks.set(Marks::LEANS, false);
            marks.note_chatter(false);
        }
        for &slot in &group.slots {
            self.foresee::<N>(slot, now);
        }
    }

    /// All balls that meet these two, or each other, at this time; [`None`] where there are too many, or one may come
    /// to rest.
    fn group<N: Needs>(&self, two: [(usize, DVec2); 2], now: f64) -> Option<Group> {
        let cells = self.cells.as_ref()?;
        let mut group = Group::default();
        for (slot, velocity) in two {
            let (position, _) = self.state::<N>(slot, now);
            self.join::<N>(&mut group, slot, (position, velocity))?;
        }
        let mut at = 0;
        while at < group.slots.len() {
            let slot = group.slots[at];
            let mut near = Vec::new();
            cells.for_each_near::<N>(slot, self.flights[slot].place, None, |other| near.push(other));
            for other in near {
                let known = group.slots.iter().position(|&slot| slot == other);
                if known.is_some_and(|known| known <= at) {
                    continue;
                }
                let (position, velocity) = match known {
                    Some(known) => (group.positions[known], group.bodies[known].velocity),
                    None => self.true_state::<N>(other, now),
                };
                let own = (group.positions[at], group.bodies[at].velocity);
                let Some(meeting) = self.meets::<N>((slot, own), (other, (position, velocity))) else {
                    continue;
                };
                if meeting.may_rest
                    || self.marks[other].has(Marks::WAITS)
                    || group.contacts.len() == MOST_TOGETHER
                {
                    return None;
                }
                let second = match known {
                    Some(known) => known,
                    None => self.join::<N>(&mut group, other, (position, velocity))?,
                };
                let Meeting { offset, restitution, .. } = meeting;
                group.contacts.push(Contact { first: at, second, offset, restitution });
            }
            at += 1;
        }
        Some(group)
    }

    /// How a ball meets another one now, if it does and they are not in each other already, by their slots, positions and
    /// velocities.
    fn meets<N: Needs>(
        &self,
        (slot, (position, own)): (usize, (DVec2, DVec2)),
        (other, (their_position, their_velocity)): (usize, (DVec2, DVec2)),
    ) -> Option<Meeting> {
        let (matter, theirs) = (self.matter::<N>(slot), self.matter::<N>(other));
        let pair = Pair {
            offset: their_position - position,
            velocity: their_velocity - own,
            reach: matter.radius + theirs.radius,
            own,
            slow: 0.0,
            dull: 0.0,
        };
        let touch = pair.are_within(AT_HAND) && !lie_in_each_other(pair.offset, pair.reach);
        if !(touch && pair.closes_in()) {
            return None;
        }
        let restitution = matter.restitution.min(theirs.restitution);
        let closing = -pair.velocity.dot(pair.offset) / pair.offset.length();
        // What hits slowly may chatter, and come to rest.
        let may_rest = (N::HOLDS || restitution < 1.0) && closing < LEAN * self.rest_speed;
        Some(Meeting { offset: -pair.offset, restitution, may_rest })
    }

    /// Adds a ball with this position and velocity to a group, and returns its place there, or [`None`] where walls or
    /// others hold it.
    fn join<N: Needs>(
        &self,
        group: &mut Group,
        slot: usize,
        (position, velocity): (DVec2, DVec2),
    ) -> Option<usize> {
        let matter = self.matter::<N>(slot);
        let marks = self.marks[slot];
        if N::HOLDS && !matter.is_fixed() && (marks.rests() != 0 || marks.has(Marks::HELD)) {
            return None;
        }
        group.slots.push(slot);
        group.positions.push(position);
        group.bodies.push(Body { velocity, inverse_mass: 1.0 / matter.mass });
        Some(group.slots.len() - 1)
    }
}
