//! The balls as a frame shows them: between the substeps that are taken, and never written back.

use glam::{BVec2, DVec2};

use super::super::Frame;
use super::super::ball::Ball;
use super::layout::Layer;
use super::near::Near;
use super::stripes::{Stripe, of_layer};
use super::team::Team;
use super::{Contact, Setting};

/// Places that differ by less, px, are the same but for rounding.
const ROUNDING: f64 = 1e-6;

/// A ball that others hold moves where it is faster than so many kicks of gravity: no pile trembles so.
const MOVING: f64 = 8.0;

/// One that is slower, but moves, lies on them as far as so many times what they give it is its weight: wholly where that is half.
const HARDLY: f64 = 2.0;

/// What others give one that moves holds it up up to so many times its weight, and goes on in the next substep ...
const CARRIED: f64 = 1.5;
/// ... and is a blow, and over, from so many times.
const BLOW: f64 = 4.0;

/// A body where the substep begins that a frame ends in.
#[derive(Debug, Clone, Copy)]
pub(super) struct Start {
    pub(super) position: DVec2,
    /// Its velocity then.
    pub(super) velocity: DVec2,
    /// The same as [`super::Body`] has it, until it meets something.
    pub(super) way: DVec2,
    /// Whether it was thrown within the substep, and does not leave what held it then.
    pub(super) is_let_go: bool,
}

impl Start {
    /// That of one that was here, and this fast, and is hit by nothing.
    pub(super) fn going(position: DVec2, velocity: DVec2) -> Self {
        Self { position, velocity, way: velocity, is_let_go: false }
    }

    /// That of a ball which was not there when the substep began, and does not fly through it: it is fixed, or comes at its end.
    pub(super) fn of(ball: &Ball) -> Self {
        Self::going(ball.position, ball.velocity)
    }
}

/// What holds a body.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Held {
    by_others: bool,
    /// Across which axes a wall does.
    by_walls: BVec2,
}

impl Held {
    /// Whether anything does.
    pub(super) fn any(self) -> bool {
        self != Self::default()
    }
}

impl Contact {
    /// Notes which bodies are held in the substep that is over.
    pub(super) fn find_held(&mut self, team: &Team) {
        self.find_held_by_balls(team);
        self.find_held_by_walls();
    }

    /// Those that other bodies hold. Each thread looks at what it has worked on: to fetch that from another's cache takes
    /// longer than to look at it.
    pub(super) fn find_held_by_balls(&mut self, team: &Team) {
        let Self { near: Some(near), held, bodies, .. } = self else { return };
        held.clear();
        held.resize(bodies.len(), Held::default());
        let find = |(stripe, held): (&mut Stripe, &mut [Held])| {
            for constraint in stripe.constraints.iter().filter(|constraint| constraint.impulse > 0.0) {
                for body in [constraint.pair.first, constraint.pair.second] {
                    held[body as usize].by_others = true;
                }
            }
        };
        let Near { layout, stripes, .. } = near;
        for &layer in Layer::OUTWARD {
            team.each(of_layer(stripes, *layout, layer).zip(layout.share(layer, held)), find);
        }
    }

    fn find_held_by_walls(&mut self) {
        let Self { near: Some(near), held, .. } = self else { return };
        for (body, beside) in near.beside() {
            held[body].by_walls |= beside.push.cmpne(DVec2::ZERO);
        }
    }

    /// A body's velocity between the substep that is over and the next: half of what gravity leaves of itself comes on top. Along a
    /// wall that holds it, that is nothing, and where nothing carries any, all fall.
    pub(super) fn velocity_between(&self, at: usize) -> DVec2 {
        let (body, kick) = (&self.bodies[at], self.setting.kick);
        if !self.setting.grounded {
            return body.velocity + 0.5 * kick;
        }
        let Held { by_others, by_walls } = self.held.get(at).copied().unwrap_or_default();
        let falls = DVec2::select(by_walls, DVec2::ZERO, DVec2::ONE);
        let change = falls * body.change(kick);
        if !by_others {
            return body.velocity + 0.5 * change;
        }
        // In kicks of gravity.
        let [speed, held] = [body.velocity, body.velocity - body.free].map(|by| by.length() / kick.length());
        let moves = speed > MOVING;
        let is_held_up = change.length_squared() <= change.dot(kick) || held <= CARRIED;
        if moves && is_held_up {
            // What others only hold up while it moves loses a part of gravity to them, along their contacts.
            body.velocity + 0.5 * change
        } else if moves && held > BLOW {
            body.velocity + 0.5 * falls * kick
        } else if speed <= 1.0 {
            // It rests, or is about to: what it lacks in a substep it has in the next.
            body.velocity
        } else {
            // What they hardly hold flies. What stops or drives it a little may go on or not.
            body.velocity + 0.5 * (1.0 - HARDLY * held).max(0.0) * falls * kick
        }
    }

    /// A body where a substep is about to begin.
    pub(super) fn start_of(&self, at: usize) -> Start {
        let velocity = self.velocity_between(at);
        // As if it had been there, on its way, when the substep began.
        Start::going(self.bodies[at].position - velocity * self.late, velocity)
    }

    /// Notes how fast bodies go into the substep, until they meet something.
    pub(super) fn note_start(&mut self) {
        for (start, body) in self.before.iter_mut().zip(&self.bodies) {
            start.way = body.velocity;
        }
    }

    /// Finds out on which legs bodies are after this share of the last substep, where a frame ends in it.
    pub(super) fn look_up_legs(&mut self, share: f64) {
        if !self.before.is_empty() {
            self.course.legs.look_up(self.bodies.len(), share * self.setting.substep);
        }
    }

    /// Whether nothing but gravity and impacts moved a body in the substep that is over.
    pub(super) fn flies(&self, at: usize) -> bool {
        let body = &self.bodies[at];
        body.inverse_mass > 0.0 && body.is_free() && self.held.get(at).is_none_or(|held| !held.any())
    }

    /// A body's position and velocity at the end of the last substep, or after this share of it.
    #[inline]
    pub(super) fn seen(&self, at: usize, share: f64) -> (DVec2, DVec2) {
        let end = (self.bodies[at].position, self.velocity_between(at));
        let Some(start) = self.before.get(at) else { return end };
        let line = || (start.position.lerp(end.0, share), start.velocity.lerp(end.1, share));
        if self.course.was_hit(at) {
            return self.seen_on_legs(at, start, share).unwrap_or_else(|| {
                let (place, velocity) = line();
                // What flies on ways that are not known has turned round, and would seem slow between them.
                let nearer = if share < 0.5 { start.velocity } else { end.1 };
                (place, if self.flies(at) { nearer } else { velocity })
            });
        }
        let (place, velocity) = line();
        (if self.flies(at) { self.bent(at, place, share) } else { place }, velocity)
    }

    /// Where a body is that flies, and would be in this `place` on its straight way: gravity has bent that. But what is foreseen
    /// of it follows the straight way, which may come to a wall a little later: never beyond one.
    fn bent(&self, at: usize, place: DVec2, share: f64) -> DVec2 {
        let Setting { substep, kick, .. } = self.setting;
        let place = place - 0.5 * share * (1.0 - share) * substep * kick;
        self.setting.inside(place, self.bodies[at].radius)
    }

    /// A body that was hit, by nothing but impacts, on its ways between these; [`None`] where something else has moved it,
    /// too, or they are not known.
    fn seen_on_legs(&self, at: usize, start: &Start, share: f64) -> Option<(DVec2, DVec2)> {
        let Setting { substep, kick, .. } = self.setting;
        let body = &self.bodies[at];
        let (on, last) = self.course.legs.of_body(at)?;
        let end = last.place + last.velocity? * (substep - last.since);
        if !(self.flies(at) && end.abs_diff_eq(body.position, ROUNDING)) {
            return None;
        }
        let (since, place, way) = match on {
            None => (0.0, start.position, start.way),
            Some(leg) => (leg.since, leg.place, leg.velocity?),
        };
        let place = place + way * (share * substep - since);
        Some((self.bent(at, place, share), way + kick * (share - 0.5)))
    }

    /// Shows the balls as they are at the clock's time, after this share of the last substep where `before` tells of its
    /// beginning. This evaluates, and never writes back. Which bodies others hold must have been found.
    pub(super) fn show(&mut self, frame: &mut Frame<'_>, share: f64) {
        for (hit, &held) in self.hit.iter_mut().zip(&self.held) {
            *hit |= held.by_others;
        }
        self.find_held_by_walls();
        self.look_up_legs(share);
        // Bodies are read out of their order: that costs less than to write balls out of theirs.
        let mut places = std::mem::take(&mut self.places);
        places.resize(self.ids.len(), 0);
        for (at, &id) in (0..).zip(&self.ids) {
            places[id as usize] = at;
        }
        for (ball, &at) in frame.balls.iter_mut().zip(&places) {
            // Not even rounding moves a fixed one.
            if !ball.is_fixed() {
                (ball.position, ball.velocity) = self.seen(at as usize, share);
            }
        }
        if self.near.is_some() {
            for (touching, &at) in frame.touching.iter_mut().zip(&places) {
                *touching = self.hit[at as usize];
            }
            self.hit.fill(false);
        } else {
            frame.touching.fill(false);
        }
        self.places = places;
        if let Some(grid) = &mut self.shown {
            frame.touching.fill(false);
            frame.show_overlaps::<true>(grid);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{TUNING, boxed_world};
    use super::*;

    /// The velocity that is shown of a body that moves so, and is given so much by others, both in kicks of gravity, downwards.
    fn shown(speed: f64, given: f64) -> f64 {
        let balls = [Ball::new(DVec2::splat(50.0), 5.0).unwrap()];
        let mut contact = Contact::new(&boxed_world(DVec2::splat(100.0)), &balls, TUNING);
        let kick = contact.setting.kick;
        contact.bodies[0].velocity = speed * kick;
        contact.bodies[0].free = (speed - given) * kick;
        contact.held = vec![Held { by_others: true, ..Held::default() }];
        contact.velocity_between(0).y / kick.y
    }

    #[test]
    fn what_others_hardly_hold_or_struck_is_shown_in_free_flight_and_what_they_hold_is_not() {
        // A velocity through a substep is half a kick behind that at its end.
        for (speed, given, more) in [
            (5.0, 0.0, 0.5),
            (-5.0, -1e-9, 0.5),
            (5.0, -0.25, 0.25),
            (5.0, -1.0, 0.0),
            (5.0, -3.0, 0.0),
            (0.5, 0.0, 0.0),
            (20.0, -1.0, 0.0),
            (20.0, -0.5, 0.25),
            (20.0, -1.2, -0.1),
            (20.0, -3.0, 0.0),
            (20.0, -6.0, 0.5),
            (-20.0, 6.0, 0.5),
        ] {
            let found = shown(speed, given) - speed;
            assert!((found - more).abs() < 1e-6, "{speed} {given}: {found}, not {more}");
        }
    }
}
