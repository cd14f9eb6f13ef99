//! Balls that rest may sleep: they stand still, as if they were fixed, and cost next to nothing.
//!
//! A ball falls asleep where it is held, and has hardly moved for a while, until something wakes it (`wake`). One that lies still, a
//! little too deep in others that do not give way, sleeps in the end, too: what it wakes falls a little deeper into each other, time
//! after time.

use glam::DVec2;

use super::loads::Resting;
use super::unlike::Unlike;
use super::{Ball, Body, Contact, Setting, takes_energy};

/// Seconds that a ball must have rested for.
const WINDOW: f64 = 0.5;
/// ... and steps in which time is counted: substeps, where their number was asked for.
const LEAST_WINDOW: u64 = 32;
/// A ball rests where it has drifted slower than this, in kicks of gravity (the speed that gravity gives in a substep) that suits
/// its size.
const DRIFT: f64 = 0.25;
/// ... and in the end slower than one kick, or gone no farther in a substep than one kick goes in a substep that suits its size, or,
/// where it was hit just then and not in the substep before, slower than so many: one that leans on others may hop on them for ever
/// in every other substep. (One was seen to, 1.3 kicks fast, by 0.0002 of its radius.)
const HOP: f64 = 2.0;
/// A ball that overlaps another by more than this part of the smaller radius is not at rest ...
pub(super) const DEEP: f64 = 0.05;
/// ... but one that is no deeper than this in any has jammed, where it lay still so often in a row when that was looked at. The second
/// number is for many of one size: a crystal has no room to give, and they would not part if they lay awake for minutes; the others
/// mostly do within five seconds.
const JAMMED: f64 = 0.1;
const JAMMED_AFTER: (u8, u8) = (11, 4);
/// What has come this part of the way that its speed would have taken it since its rest was last looked at has begun to slide.
const BEGUN: f64 = 0.25;
/// What swings may be where it was when the window ends, but not after so many eighths of it, too.
const EIGHTHS: u64 = 3;

/// Whether a ball sleeps, and what it takes to wake it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rest {
    pub(super) asleep: bool,
    /// Its own inverse mass: 0 where nothing moves it.
    pub(super) own: f64,
    /// The inverse mass with which it counts where it is held, or did when it fell asleep (`weights`).
    pub(super) counted: f64,
    /// In what it is unlike those around it.
    pub(super) unlike: Unlike,
    /// Where it was when its rest was last looked at.
    anchor: DVec2,
    /// Whether it was elsewhere in the meantime.
    swung: bool,
    /// Where it was a substep before its rest is looked at, and whether it was hit then; nothing where it was woken since.
    last: Option<(DVec2, bool)>,
    /// How often its rest was looked at, and it had none, since it last slept, or woke those that hold it.
    pub(super) restless: u32,
    /// How often in a row it lay still when its rest was looked at, but deep in others. That goes on while it sleeps: where it is
    /// woken and lies still again, it sleeps again.
    jammed: u8,
    /// In how many substeps in a row, of those in which room was looked for, it has had none to go on (`room`).
    pub(super) stuck: u8,
}

impl Rest {
    pub(super) fn new(body: &Body) -> Self {
        let (own, place) = (body.inverse_mass, body.position);
        Self {
            asleep: false,
            own,
            counted: own,
            unlike: Unlike::Nothing,
            anchor: place,
            swung: false,
            last: None,
            restless: 0,
            jammed: 0,
            stuck: 0,
        }
    }

    /// Notes that a ball wakes, at this place.
    pub(super) fn begin_anew(&mut self, place: DVec2) {
        (self.asleep, self.anchor, self.last) = (false, place, None);
    }

    /// The inverse mass with which it takes impacts: 0 where it stands still whatever hits it.
    #[inline]
    pub(super) fn in_impacts(&self) -> f64 {
        if self.asleep { 0.0 } else { self.own }
    }
}

impl Contact {
    /// Lets balls fall asleep that have rested for a while.
    pub(super) fn fall_asleep(&mut self) {
        let Setting { kick, least_restitution, walls, .. } = self.setting;
        // Where nothing takes energy, what moves goes on for ever.
        let may_rest = kick != DVec2::ZERO && takes_energy(walls, least_restitution);
        if !self.tuning.sleep || !may_rest {
            return;
        }
        let window = ((WINDOW * f64::from(self.substeps.rate)).ceil() as u64).max(LEAST_WINDOW);
        let length = self.substeps.length();
        let (now, before) = (self.steps % window, (self.steps - length) % window);
        let swings = window * EIGHTHS / 8;
        if now < length {
            self.put_to_sleep(window);
        } else if before < swings && swings <= now {
            self.find_swinging(window);
        } else if now + self.substeps.next_length() >= window {
            self.note_places();
        }
    }

    /// How far each ball may drift at rest in a window of so many of the steps in which time is counted, px.
    fn drifts(&self, window: u64) -> Vec<f64> {
        let (gravity, substeps) = (self.setting.gravity, &self.substeps);
        let seconds = window as f64 / f64::from(substeps.rate);
        let kick = |body: &Body| gravity.length() * substeps.seconds_for(body.radius, gravity);
        self.bodies.iter().map(|body| DRIFT * kick(body) * seconds).collect()
    }

    /// Notes which balls are elsewhere than when their rest was last looked at.
    fn find_swinging(&mut self, window: u64) {
        let drifts = self.drifts(window);
        for ((rest, body), drift) in self.rests.iter_mut().zip(&self.bodies).zip(drifts) {
            rest.swung = body.position.distance_squared(rest.anchor) > drift * drift;
        }
    }

    /// Notes where balls are a substep before their rest is looked at.
    fn note_places(&mut self) {
        for (at, (rest, body)) in self.rests.iter_mut().zip(&self.bodies).enumerate() {
            rest.last = Some((body.position, self.course.was_hit(at)));
        }
    }

    /// Puts those to sleep that have rested since that was last looked at.
    fn put_to_sleep(&mut self, window: u64) {
        let team = self.team.clone();
        self.find_held(&team);
        let depths = self.depths();
        let most_drifts = self.drifts(window);
        let (usual, of_one_size) = JAMMED_AFTER;
        let jammed_after = if self.substeps.of_one_size { of_one_size } else { usual };
        let Self { setting, substeps, bodies, rests, near: Some(near), held, course, .. } = self else {
            return;
        };
        near.link_pairs(bodies.len());
        let stripes = near.all();
        let seconds_looked_at = window as f64 / f64::from(substeps.rate);
        let slowest = setting.rest_speed * seconds_looked_at;
        let (elastic, along) = (setting.least_restitution == 1.0, setting.kick.perp().normalize_or_zero());
        let still = |at: usize, body: &Body, rest: &Rest| {
            // One that was hit just now has not gone far either. But one that others squeeze may be hit all the time, and
            // have a velocity that takes it nowhere.
            let Some((last, was_hit)) = rest.last else { return false };
            let hops = course.was_hit(at) && !was_hit;
            let seconds = setting.substep.max(substeps.seconds_for(body.radius, setting.gravity));
            let kick = setting.gravity.length() * seconds;
            let (most, step) = (if hops { HOP } else { 1.0 } * kick, kick * seconds);
            let slow = body.velocity.length_squared() < most * most
                || (body.position.distance_squared(last) < step * step && !hops);
            let gone = body.position.distance_squared(rest.anchor);
            let drifts = |most: f64| gone >= most * most;
            // What slides on a wall is slow where gravity is strong, and nothing makes it tremble; it may have begun to just now, and
            // what goes to and fro between others without loss may be back where it was.
            let goes = || {
                let (speed, way) = (body.velocity.dot(along), (body.position - rest.anchor).dot(along));
                let goes_on = way * speed.signum() > BEGUN * speed.abs() * seconds_looked_at;
                drifts(slowest) || speed.abs() > setting.rest_speed && (elastic || goes_on)
            };
            let slides = || goes() && stripes.is_carried_by_walls_alone(at, rest, setting.kick);
            slow && !(rest.swung || drifts(most_drifts[at]) || slides())
        };
        let looked_at = bodies.iter().zip(&mut *rests).zip(&depths).enumerate();
        let still: Vec<bool> = looked_at
            .map(|(at, ((body, rest), &depth))| {
                let is_still = still(at, body, rest);
                rest.jammed = if is_still && depth > DEEP { rest.jammed.saturating_add(1) } else { 0 };
                is_still && (depth <= DEEP || (depth <= JAMMED && rest.jammed >= jammed_after))
            })
            .collect();
        let loads = Resting { setting, bodies, rests, held, stripes: near.all() }.loads(&still);
        for (at, (body, rest)) in bodies.iter_mut().zip(&mut *rests).enumerate() {
            (rest.anchor, rest.swung) = (body.position, false);
            if rest.asleep || rest.counted == 0.0 {
                continue;
            }
            rest.restless += 1;
            if still[at] && loads.bears[at] {
                (rest.asleep, rest.restless) = (true, 0);
                body.inverse_mass = 0.0;
                (body.velocity, body.free) = (DVec2::ZERO, DVec2::ZERO);
            }
        }
        near.weigh_all(bodies);
        near.take_loads(&loads, rests);
        self.wake_around_restless();
        self.all_asleep = self.rests.iter().all(|rest| rest.asleep || rest.counted == 0.0);
        self.asleep = self.rests.iter().filter(|rest| rest.asleep).count();
    }

    /// Whether any that sleeps lies in a fixed one of these: neither would ever move out of the other.
    pub(super) fn any_sleeps_in(&self, balls: &[Ball]) -> bool {
        balls.iter().filter(|ball| ball.is_fixed()).any(|ball| {
            let mut sleepers = self.bodies.iter().zip(&self.rests).filter(|(_, rest)| rest.asleep);
            sleepers.any(|(body, _)| body.position.distance(ball.position) < body.radius + ball.radius)
        })
    }

    /// How deep each body lies in others at most, in the smaller radius.
    fn depths(&self) -> Vec<f64> {
        let mut depths = vec![0.0_f64; self.bodies.len()];
        let Self { bodies, near: Some(near), .. } = self else { return depths };
        for (i, j) in near.pairs() {
            let depth = bodies[i].depth_in(&bodies[j]);
            (depths[i], depths[j]) = (depths[i].max(depth), depths[j].max(depth));
        }
        depths
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::ball::Ball;
    use super::super::Tally;
    use super::super::fates::Fate;
    use super::super::testing::{TUNING, boxed_world};
    use super::*;

    /// A ball that lies on the floor, in beats of so many substeps.
    fn lying(count: u32) -> Contact {
        let balls = [20.0, 60.0].map(|x| {
            Ball::new(DVec2::new(x, 90.0), 10.0).and_then(|ball| ball.with_restitution(0.5)).unwrap()
        });
        let mut contact = Contact::new(&boxed_world(DVec2::splat(100.0)), &balls, TUNING);
        contact.substeps.begin_beat_of(count);
        contact
    }

    /// Takes substeps until so many parts of a beat are over.
    fn go(contact: &mut Contact, to: u64) {
        while contact.steps < to {
            contact.step(&mut Tally::default());
        }
        assert_eq!(contact.steps, to);
    }

    #[test]
    fn rest_is_looked_at_in_its_window_however_long_substeps_are() {
        for (count, length) in [(8, 3), (4, 6), (3, 8), (2, 12)] {
            let mut contact = lying(count);
            // Half a second. A ball is elsewhere when three eighths of it are over.
            let (window, swings) = (720, 269 / length * length);
            go(&mut contact, swings);
            contact.bodies[1].position.x += 5.0;
            go(&mut contact, swings + length);
            contact.bodies[1].position.x -= 5.0;
            go(&mut contact, window - length);
            assert_eq!(contact.rests[0].last.unwrap().0, contact.bodies[0].position);
            go(&mut contact, window);
            assert_eq!([0, 1].map(|at| contact.rests[at].asleep), [true, false], "{count} substeps");
            go(&mut contact, 2 * window);
            assert!(contact.all_asleep);
        }
    }

    #[test]
    fn a_ball_that_was_hit_just_now_may_be_twice_as_fast_as_others_and_sleep() {
        // Whether it was hit a substep before, in kicks of gravity how fast it is after the hit, and whether it falls asleep.
        for (before, kicks, asleep) in [(false, 1.5, true), (false, 2.5, false), (true, 1.5, false)] {
            let mut contact = lying(4);
            go(&mut contact, 714);
            // As far as it has come since: one that was hit before, too, is looked at by that.
            contact.bodies[0].position.x += 0.05;
            contact.rests[0].last.as_mut().unwrap().1 = before;
            let kick = contact.setting.kick.length();
            contact.course.fates.resize(2, Fate::default());
            contact.course.fates[0].hits = 1;
            contact.bodies[0].velocity = DVec2::new(kicks * kick, 0.0);
            contact.steps = 720;
            contact.put_to_sleep(720);
            assert_eq!(contact.rests[0].asleep, asleep, "{before} {kicks}");
        }
    }

    /// When two balls of radius 10 that lie in each other by this part of it, in a box without room for them, are asleep, s; and
    /// whether that is so because many are of one size.
    fn jammed(depth: f64, of_one_size: bool) -> Option<f64> {
        let width = 40.0 - 10.0 * depth;
        let balls = [10.0, width - 10.0].map(|x| Ball::new(DVec2::new(x, 10.2), 10.0).unwrap());
        let mut contact = Contact::new(&boxed_world(DVec2::new(width, 20.2)), &balls, TUNING);
        contact.substeps.of_one_size = of_one_size;
        while !contact.all_asleep && contact.steps < 20 * u64::from(contact.substeps.rate) {
            contact.step(&mut Tally::default());
        }
        contact.all_asleep.then(|| contact.steps as f64 / f64::from(contact.substeps.rate))
    }

    #[test]
    fn what_lies_still_in_another_that_has_no_room_to_give_sleeps_after_five_seconds_and_a_half() {
        for (depth, of_one_size, asleep) in [
            (0.04, false, Some(0.5)),
            (0.07, false, Some(5.5)),
            (0.07, true, Some(2.0)),
            (0.15, false, None),
            (0.15, true, None),
        ] {
            assert_eq!(jammed(depth, of_one_size), asleep, "{depth}, {of_one_size}");
        }
    }

    #[test]
    fn what_lies_on_the_floor_and_deep_in_another_does_not_fall_asleep() {
        for (overlap, asleep) in [(0.1, true), (2.0, false)] {
            let mut contact = lying(4);
            go(&mut contact, 714);
            contact.bodies[1].position.x = contact.bodies[0].position.x + 20.0 - overlap;
            go(&mut contact, 720);
            assert_eq!(contact.rests[0].asleep, asleep, "{overlap}");
        }
    }
}
