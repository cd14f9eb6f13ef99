//! The law of impact where several balls touch at one time: Moreau's (1988), with Newton's restitution at each contact.
//!
//! Contacts push, and never pull. Where one pushes, its two balls part with their restitution times the speed that they
//! approached with; where none is needed, they part at least as fast: with a contact's impulse λ and its speeds of
//! parting v before and v′ after, λ ≥ 0, v′ + e·v ≥ 0, and λ·(v′ + e·v) = 0. So no order of the impacts has to be
//! chosen, momentum is kept, and energy never rises, nor falls where e = 1: ΔE = ½·Σ λ·(v′ + v) = −½·Σ λ·(1 − e)·|v|.

use glam::DVec2;

/// A ball that takes part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Body {
    /// Before the impact, then after it, px/s.
    pub velocity: DVec2,
    /// 1 over its mass: 0 where it is fixed.
    pub inverse_mass: f64,
}

/// Two balls that touch, and approach each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contact {
    /// The places of the two among the bodies.
    pub first: usize,
    pub second: usize,
    /// From the second to the first, px: of any length, since a unit vector's rounding would make the energy drift.
    pub offset: DVec2,
    pub restitution: f64,
}

impl Contact {
    /// Pushes its two balls apart with an impulse of this many times its offset, mass/s.
    fn push(&self, bodies: &mut [Body], impulse: f64) {
        for (index, push) in [(self.first, impulse), (self.second, -impulse)] {
            let body = &mut bodies[index];
            body.velocity += self.offset * (push * body.inverse_mass);
        }
    }
}

/// Balls touch whose distance's square falls short of that at which they do by no more than this part of it, as where
/// somebody put them side by side with four decimals.
const TOUCHING: f64 = 1e-5;

/// Whether two balls lie deeper in each other than those that touch: as in a world that shrank, no time is known at which
/// they met, and impacts of a crowd of them do not settle.
pub(super) fn lie_in_each_other(offset: DVec2, reach: f64) -> bool {
    offset.length_squared() < (1.0 - TOUCHING) * reach * reach
}

/// The most sweeps that the impulses may take to settle.
const MOST_SWEEPS: usize = 10_000;
/// They have settled where a sweep changed no speed by more than this part of the balls' own ...
const SETTLED: f64 = 4.0 * f64::EPSILON;
/// ... or, where light balls are thrown about among heavy ones, go to and fro by their rounding: after [`LONG`] sweeps, by
/// no more than this part.
const ROUNDED: f64 = 1e-12;
const LONG: usize = 1000;

/// Gives bodies their velocities after all contacts' impulses, and returns how many contacts push; `None`, with nothing
/// changed, where the impulses do not settle, as with masses that are too unequal.
///
/// The linear complementarity problem is solved by projected Gauss–Seidel sweeps, to rounding.
pub(super) fn exchange(bodies: &mut [Body], contacts: &[Contact]) -> Option<usize> {
    let closing = |bodies: &[Body], contact: &Contact| {
        (bodies[contact.second].velocity - bodies[contact.first].velocity).dot(contact.offset)
    };
    let before = bodies.to_vec();
    let approaches: Vec<f64> = contacts.iter().map(|contact| closing(bodies, contact)).collect();
    let speeds = |contact: &Contact| {
        (bodies[contact.first].velocity.length() + bodies[contact.second].velocity.length())
            * contact.offset.length()
    };
    let scale = contacts.iter().map(speeds).fold(0.0, f64::max);
    let mut impulses = vec![0.0; contacts.len()];
    for sweep in 0..MOST_SWEEPS {
        let mut largest = 0.0_f64;
        for ((contact, impulse), approach) in contacts.iter().zip(&mut impulses).zip(&approaches) {
            let (first, second) = (bodies[contact.first], bodies[contact.second]);
            let give = contact.offset.length_squared() * (first.inverse_mass + second.inverse_mass);
            let short = closing(bodies, contact) + contact.restitution * approach;
            let change = (*impulse + short / give).max(0.0) - *impulse;
            *impulse += change;
            largest = largest.max(change.abs() * give);
            contact.push(bodies, change);
        }
        if largest <= SETTLED * scale || (sweep >= LONG && largest <= ROUNDED * scale) {
            // Anew and in one go: the roundings of all sweeps have added up.
            bodies.copy_from_slice(&before);
            for (contact, &impulse) in contacts.iter().zip(&impulses) {
                contact.push(bodies, impulse);
            }
            return Some(impulses.iter().filter(|&&impulse| impulse > 0.0).count());
        }
    }
    bodies.copy_from_slice(&before);
    None
}
