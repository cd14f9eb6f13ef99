//! Balls that rest may sleep: they stand still, as if they were fixed, and cost next to nothing.
//!
//! A ball falls asleep where it is held, and has hardly moved for a while. It wakes where something hits it firmly, or
//! where what holds it and what lies on it no longer balance its weight: then it moves, and those that lean on it wake
//! in turn, as far as the change is felt. So there are no islands to keep, and a ball that lands on a large pile wakes what it
//! shakes.

use glam::DVec2;

use super::find::Near;
use super::{Body, Contact};

/// Seconds that a ball must have rested for.
const WINDOW: f64 = 0.5;
/// A ball rests where it has drifted slower than this, in kicks of gravity (the speed that gravity gives in a substep).
const DRIFT: f64 = 0.25;
/// A ball that overlaps another by more than this part of the smaller radius is not at rest.
const DEEP: f64 = 0.05;
/// A ball wakes where what acts on it differs from balance by more than this part of its weight ...
const WEIGHT: f64 = 0.5;
/// ... and this part of all that presses on it.
const PRESS: f64 = 0.25;
/// A ball wakes where it loses a support, or a load, of more than this part of its weight.
const LOST: f64 = 0.1;

/// Whether a ball sleeps, and what it takes to wake it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rest {
    pub(super) asleep: bool,
    /// Its inverse mass when it is awake: 0 where nothing moves it.
    pub(super) weight: f64,
    /// Where it was when its rest was last looked at.
    anchor: DVec2,
}

impl Rest {
    pub(super) fn new(body: &Body) -> Self {
        Self { asleep: false, weight: body.inverse_mass, anchor: body.position }
    }
}

impl Contact {
    /// Lets balls fall asleep that have rested for a while.
    pub(super) fn fall_asleep(&mut self) {
        let window = (WINDOW * f64::from(self.rate)).ceil() as u64;
        if !self.sleeps || !self.steps.is_multiple_of(window) {
            return;
        }
        self.find_held();
        self.find_grounded();
        self.find_deep();
        let Self { setting, bodies, rests, near: Some(near), held, .. } = self else { return };
        let drift = DRIFT * setting.kick.length() * window as f64 * setting.substep;
        for ((body, rest), &held) in bodies.iter_mut().zip(&mut *rests).zip(&*held) {
            // One that was hit just now has not gone far either.
            let slow = body.velocity.length_squared() < setting.kick.length_squared();
            let still = slow && body.position.distance_squared(rest.anchor) < drift * drift;
            rest.anchor = body.position;
            if still && held && rest.weight > 0.0 {
                rest.asleep = true;
                body.inverse_mass = 0.0;
                (body.velocity, body.free) = (DVec2::ZERO, DVec2::ZERO);
            }
        }
        for at in 0..near.pairs.len() {
            near.weigh(at, bodies);
        }
        self.all_asleep = self.rests.iter().all(|rest| rest.asleep || rest.weight == 0.0);
    }

    /// Counts bodies as held that hop on a wall less high than gravity takes them in a substep.
    fn find_grounded(&mut self) {
        let Self { setting, bodies, near: Some(near), held, .. } = self else { return };
        let hop = setting.kick.abs() * setting.substep;
        for beside in &near.beside {
            let body = &bodies[beside.body as usize];
            let below = setting.size - body.radius - body.position;
            let above = body.position - body.radius;
            let gap = DVec2::select(setting.kick.cmpgt(DVec2::ZERO), below, above);
            held[beside.body as usize] |= gap.cmplt(hop).any();
        }
    }

    /// Counts bodies that overlap others deeply as not held.
    fn find_deep(&mut self) {
        let Self { bodies, near: Some(near), held, .. } = self else { return };
        for pair in &near.pairs {
            let (first, second) = (&bodies[pair.first as usize], &bodies[pair.second as usize]);
            let reach = first.radius + second.radius - DEEP * first.radius.min(second.radius);
            if first.position.distance_squared(second.position) < reach * reach {
                held[pair.first as usize] = false;
                held[pair.second as usize] = false;
            }
        }
    }

    /// Wakes those at the border of sleep that are not balanced any more.
    pub(super) fn wake_unbalanced(&mut self) {
        let Self { setting, bodies, rests, near: Some(near), border, .. } = self else { return };
        if border.is_empty() {
            return;
        }
        near.link_pairs(bodies.len());
        let kick = setting.kick;
        for (body, lost) in border.drain(..) {
            let at = body as usize;
            if !rests[at].asleep {
                continue;
            }
            let given = near.given(body, rests[at].weight);
            // What lost a support moves, however hard the others press.
            let pressed = if lost * rests[at].weight > LOST * kick.length() { 0.0 } else { given.pressed };
            let tolerance = WEIGHT * kick.length() + PRESS * pressed;
            if (given.velocity + kick).length_squared() > tolerance * tolerance {
                wake(at, bodies, rests, near);
                // As if it had been held like this in the substep that is over.
                bodies[at].free = -given.velocity;
            }
        }
    }
}

/// Wakes a ball, at rest. Its pairs must be linked.
pub(super) fn wake(at: usize, bodies: &mut [Body], rests: &mut [Rest], near: &mut Near) {
    let rest = &mut rests[at];
    (rest.asleep, rest.anchor) = (false, bodies[at].position);
    bodies[at].inverse_mass = rest.weight;
    near.weigh_pairs_of(at as u32, bodies);
}

/// Wakes a ball that something hits firmly, in the midst of a substep.
pub(super) fn wake_by_hit(at: usize, kick: DVec2, bodies: &mut [Body], rests: &mut [Rest], near: &mut Near) {
    let given = near.given(at as u32, rests[at].weight);
    wake(at, bodies, rests, near);
    bodies[at].free = kick;
    bodies[at].velocity = kick + given.velocity;
}
