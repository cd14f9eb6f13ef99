//! Balls that rest may sleep: they stand still, as if they were fixed, and cost next to nothing.
//!
//! A ball falls asleep where it is held, and has hardly moved for a while. It wakes where something hits it firmly, or
//! where what holds it and what lies on it no longer balance its weight: then it moves, and those that lean on it wake
//! in turn, as far as the change is felt. So there are no islands to keep, and a ball that lands on a large pile wakes
//! what it shakes.

use glam::DVec2;

use super::holds::Given;
use super::stripes::Stripes;
use super::support::let_go;
use super::{Body, Contact, Setting};

/// Seconds that a ball must have rested for.
const WINDOW: f64 = 0.5;
/// ... and substeps.
const LEAST_WINDOW: u64 = 32;
/// A ball rests where it has drifted slower than this, in kicks of gravity (the speed that gravity gives in a substep).
const DRIFT: f64 = 0.25;
/// ... and where what acts on it is in balance up to this part of its weight and of all that presses on it.
const EVEN: f64 = 0.15;
/// A ball that overlaps another by more than this part of the smaller radius is not at rest.
const DEEP: f64 = 0.05;
/// What swings may be where it was when the window ends, but not after so many eighths of it, too.
const EIGHTHS: u64 = 3;
/// A ball wakes where what acts on it differs from balance by more than this part of its weight ...
const WEIGHT: f64 = 0.5;
/// ... and this part of all that presses on it.
const PRESS: f64 = 0.25;
/// What acts on a ball that wakes goes on acting if it differs from balance by less than so many kicks of gravity.
const WARM: f64 = 300.0;
/// A ball wakes where it loses a support, or a load, of more than this part of its weight.
const LOST: f64 = 0.1;

/// Whether a ball sleeps, and what it takes to wake it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rest {
    pub(super) asleep: bool,
    /// Its inverse mass when it is awake: 0 where nothing moves it.
    pub(super) inverse_mass: f64,
    /// Where it was when its rest was last looked at.
    anchor: DVec2,
    /// Whether it was elsewhere in the meantime.
    swung: bool,
}

impl Rest {
    pub(super) fn new(body: &Body) -> Self {
        Self { asleep: false, inverse_mass: body.inverse_mass, anchor: body.position, swung: false }
    }
}

impl Contact {
    /// Lets balls fall asleep that have rested for a while.
    pub(super) fn fall_asleep(&mut self) {
        let window = ((WINDOW * f64::from(self.rate)).ceil() as u64).max(LEAST_WINDOW);
        if !self.sleeps {
            return;
        }
        match self.steps % window {
            0 => self.put_to_sleep(window),
            step if step == window * EIGHTHS / 8 => self.find_swinging(window),
            _ => {}
        }
    }

    /// How far a ball at rest may drift in a window of so many substeps, px.
    fn drift(&self, window: u64) -> f64 {
        DRIFT * self.setting.kick.length() * window as f64 * self.setting.substep
    }

    /// Notes which balls are elsewhere than when their rest was last looked at.
    fn find_swinging(&mut self, window: u64) {
        let drift = self.drift(window);
        for (rest, body) in self.rests.iter_mut().zip(&self.bodies) {
            rest.swung = body.position.distance_squared(rest.anchor) > drift * drift;
        }
    }

    /// Puts those to sleep that have rested since that was last looked at.
    fn put_to_sleep(&mut self, window: u64) {
        self.find_held();
        self.release_deep();
        let drift = self.drift(window);
        let Self { setting, bodies, rests, near: Some(near), held, .. } = self else { return };
        near.link_pairs(bodies.len());
        let stripes = near.all();
        for (at, (body, rest)) in bodies.iter_mut().zip(&mut *rests).enumerate() {
            // One that was hit just now has not gone far either.
            let slow = body.velocity.length_squared() < setting.kick.length_squared();
            let still = slow && !rest.swung && body.position.distance_squared(rest.anchor) < drift * drift;
            (rest.anchor, rest.swung) = (body.position, false);
            if still
                && rest.inverse_mass > 0.0
                && !rest.asleep
                && is_balanced(at, body, rest, held[at], &stripes, setting)
            {
                rest.asleep = true;
                body.inverse_mass = 0.0;
                (body.velocity, body.free) = (DVec2::ZERO, DVec2::ZERO);
            }
        }
        near.weigh_all(bodies);
        self.all_asleep = self.rests.iter().all(|rest| rest.asleep || rest.inverse_mass == 0.0);
    }

    /// Wakes a ball that is moved from outside.
    pub(super) fn wake_by_hand(&mut self, at: usize) {
        self.all_asleep = false;
        let Self { setting, bodies, rests, near, .. } = self;
        if let Some(near) = near
            && rests[at].asleep
        {
            near.link_pairs(bodies.len());
            let given = near.all().given(at, rests[at].inverse_mass);
            wake(at, &given, setting.kick, bodies, rests, &mut near.all());
        }
    }

    /// Counts bodies that overlap others deeply as not held.
    fn release_deep(&mut self) {
        let Self { bodies, near: Some(near), held, .. } = self else { return };
        for (number, stripe) in near.stripes.iter().enumerate() {
            let start = near.layout.start(number);
            for pair in &stripe.pairs {
                let (i, j) = (start + pair.first as usize, start + pair.second as usize);
                let (first, second) = (&bodies[i], &bodies[j]);
                let reach = first.radius + second.radius - DEEP * first.radius.min(second.radius);
                if first.position.distance_squared(second.position) < reach * reach {
                    (held[i], held[j]) = (false, false);
                }
            }
        }
    }

    /// Wakes those at the border of sleep that are not balanced any more.
    pub(super) fn wake_unbalanced(&mut self) {
        let Self { setting, bodies, rests, near: Some(near), .. } = self else { return };
        if near.stripes.iter().all(|stripe| stripe.disturbed.is_empty()) {
            return;
        }
        near.link_pairs(bodies.len());
        let kick = setting.kick;
        for number in 0..near.stripes.len() {
            let start = near.layout.start(number);
            let mut disturbed = std::mem::take(&mut near.stripes[number].disturbed);
            for (body, lost) in disturbed.drain(..) {
                let at = start + body as usize;
                if !rests[at].asleep {
                    continue;
                }
                let given = near.all().given(at, rests[at].inverse_mass);
                // What lost a support moves, however hard the others press.
                let pressed =
                    if lost * rests[at].inverse_mass > LOST * kick.length() { 0.0 } else { given.pressed };
                let tolerance = WEIGHT * kick.length() + PRESS * pressed;
                if (given.velocity + kick).length_squared() > tolerance * tolerance {
                    // As if it had been held like this in the substep that is over.
                    bodies[at].free = -wake(at, &given, kick, bodies, rests, &mut near.all());
                }
            }
            near.stripes[number].disturbed = disturbed;
        }
    }
}

impl Stripes<'_> {
    /// Forgets what others and walls give a ball. Its pairs must be linked.
    fn let_go_of(&mut self, body: usize, bodies: &mut [Body]) {
        for number in self.layout.of_body(body) {
            let start = self.layout.start(number);
            let (stripe, own) = (&mut self.list[number], (body - start) as u32);
            let mut cursor = stripe.links.begin(own);
            while let Some(at) = stripe.links.next(&mut cursor) {
                let_go(&mut bodies[start..], stripe.pairs[at], &mut stripe.holds[at]);
            }
            if let Some(at) = stripe.place_beside(own) {
                stripe.beside[at].push = DVec2::ZERO;
            }
        }
    }
}

/// Wakes a ball, at rest, and tells what of that which it is `given` goes on: nothing where it would be shot away. Its
/// pairs must be linked.
fn wake(
    at: usize,
    given: &Given,
    kick: DVec2,
    bodies: &mut [Body],
    rests: &mut [Rest],
    stripes: &mut Stripes<'_>,
) -> DVec2 {
    let rest = &mut rests[at];
    (rest.asleep, rest.anchor) = (false, bodies[at].position);
    bodies[at].inverse_mass = rest.inverse_mass;
    stripes.weigh_pairs_of(at, bodies);
    if (given.velocity + kick).length() < WARM * kick.length() {
        given.velocity
    } else {
        stripes.let_go_of(at, bodies);
        DVec2::ZERO
    }
}

/// Whether what holds a ball balances its weight. A wall on which it lies, or hops less high than gravity takes it in a
/// substep, holds it as it must.
fn is_balanced(
    at: usize,
    body: &Body,
    rest: &Rest,
    held: bool,
    stripes: &Stripes<'_>,
    setting: &Setting,
) -> bool {
    let given = stripes.given(at, rest.inverse_mass);
    let below = setting.size - body.radius - body.position;
    let above = body.position - body.radius;
    let gap = DVec2::select(setting.kick.cmpgt(DVec2::ZERO), below, above);
    let beside = DVec2::splat(f64::from(u8::from(stripes.is_beside(at))));
    let grounded = gap.cmplt(setting.kick.abs() * setting.substep * beside);
    let left = DVec2::select(grounded, DVec2::ZERO, given.velocity + setting.kick);
    (held || grounded.any()) && left.length() < EVEN * (setting.kick.length() + given.pressed)
}

/// Wakes a ball that something hits firmly, in the midst of a substep.
pub(super) fn wake_by_hit(
    at: usize,
    kick: DVec2,
    bodies: &mut [Body],
    rests: &mut [Rest],
    stripes: &mut Stripes<'_>,
) {
    let given = stripes.given(at, rests[at].inverse_mass);
    let held = wake(at, &given, kick, bodies, rests, stripes);
    bodies[at].free = kick;
    bodies[at].velocity = kick + held;
}
