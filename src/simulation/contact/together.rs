//! What happens where several pairs meet at one time in free flight: one impact (see `simultaneous`), so that no order of
//! them has to be chosen, and a scene that is its own mirror image stays so.
//!
//! Only where all balls are one stripe: among thousands that fall in upon each other, order is the least of errors.

use std::collections::BTreeMap;

use glam::DVec2;

use super::super::simultaneous::{self, exchange, lie_in_each_other};
use super::SHIFT;
use super::constraints::Marks;
use super::events::{Event, Spot};
use super::fates::Shift;
use super::impacts::{Stage, pair};
use super::meeting::{Meeting, strike};
use super::stripes::Stripes;

/// Impacts are at one time that are no farther apart than this part of a substep: their times round differently.
const AT_ONE_TIME: f64 = 1e-10;
/// Pairs that are solved as one. More of them are taken one after the other.
const MOST: usize = 64;

/// A pair that takes part.
struct Meets {
    spot: Spot,
    bodies: (usize, usize),
    meeting: Meeting,
}

impl Stage<'_> {
    /// Takes the impact of a pair as one with all that are foreseen for its time, and returns the bodies that were hit;
    /// [`None`], with nothing changed, where there are no others or something holds one of the balls.
    pub(super) fn take_together(&mut self, event: &Event, stripes: &mut Stripes<'_>) -> Option<Vec<usize>> {
        let latest = event.time + AT_ONE_TIME * self.setting.substep;
        let others = |event: &Event| event.time <= latest && event.pair().is_some();
        if !self.queue.peek().is_some_and(others) {
            return None;
        }
        let mut pairs = vec![self.meets(event.pair()?, stripes)?];
        let mut events = Vec::new();
        let mut all = true;
        while all
            && events.len() < MOST
            && let Some(next) = self.queue.peek().copied().filter(others)
        {
            self.queue.pop();
            if self.still_holds(&next, Self::bodies_of(&next, stripes)) {
                events.push(next);
                let meets = next.pair().and_then(|spot| self.meets(spot, stripes));
                all = meets.is_some();
                pairs.extend(meets);
            }
        }
        let hit = if all && !events.is_empty() { self.exchange_all(&pairs, stripes) } else { None };
        if hit.is_none() {
            self.queue.extend(events);
        }
        hit
    }

    /// How a pair meets, if nothing but gravity acts on either of its balls, and they are not in each other already.
    fn meets(&self, spot: Spot, stripes: &Stripes<'_>) -> Option<Meets> {
        let bodies = pair(spot, stripes);
        let flies = |at: usize| self.bodies[at].is_free() && !self.rests[at].asleep;
        let parted = self.fates[bodies.0].is_over_with(&self.fates[bodies.1]);
        if parted || !(flies(bodies.0) && flies(bodies.1)) {
            return None;
        }
        let held = stripes.list[spot.stripe as usize].marks[spot.at as usize].has(Marks::HELD);
        let meeting = if held { None } else { self.meeting(bodies, None) }?;
        let reach = self.bodies[bodies.0].radius + self.bodies[bodies.1].radius;
        (!lie_in_each_other(meeting.offset, reach)).then_some(Meets { spot, bodies, meeting })
    }

    /// Gives all balls of these pairs their velocities after the one impact.
    fn exchange_all(&mut self, pairs: &[Meets], stripes: &mut Stripes<'_>) -> Option<Vec<usize>> {
        let time = pairs.iter().map(|pair| pair.meeting.time).fold(0.0, f64::max);
        // The velocity at that time is that through the substep and what gravity has changed it by since its middle.
        let since_middle = time / self.setting.substep - 0.5;
        // By their places, so that no order of events counts.
        let mut places = BTreeMap::new();
        for body in pairs.iter().flat_map(|pair| [pair.bodies.0, pair.bodies.1]) {
            places.insert(body, 0);
        }
        let mut bodies = Vec::new();
        for (&body, place) in &mut places {
            *place = bodies.len();
            let inverse_mass = self.rests[body].in_impacts();
            let body = &self.bodies[body];
            let velocity = body.velocity + body.change(self.setting.kick) * since_middle;
            bodies.push(simultaneous::Body { velocity, inverse_mass });
        }
        let contact = |Meets { bodies: (first, second), meeting, .. }: &Meets| simultaneous::Contact {
            first: places[first],
            second: places[second],
            offset: meeting.offset,
            restitution: self.restitutions[*first].min(self.restitutions[*second]),
        };
        let contacts: Vec<_> = pairs.iter().map(contact).collect();
        let before: Vec<DVec2> = bodies.iter().map(|body| body.velocity).collect();
        let pushed = exchange(&mut bodies, &contacts)?;
        let fastest = pairs.iter().map(|pair| pair.meeting.speed).fold(0.0, f64::max);
        if fastest > self.setting.rest_speed {
            self.tally.impacts += pushed as u64;
        }
        for Meets { spot, bodies: (first, second), .. } in pairs {
            stripes.list[spot.stripe as usize].note_met(spot.at as usize, time > 0.0);
            (self.hit[*first], self.hit[*second]) = (true, true);
        }
        let moved: Vec<usize> =
            places.keys().copied().filter(|&at| self.bodies[at].inverse_mass > 0.0).collect();
        for &at in &moved {
            let change = bodies[places[&at]].velocity - before[places[&at]];
            strike(&mut self.bodies[at], change, time);
            let far = time * change.length() > SHIFT * self.bodies[at].radius;
            self.note_hit(at, time, if far { Shift::Some } else { Shift::None });
        }
        Some(moved)
    }
}
