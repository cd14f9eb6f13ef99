//! The law of impact where several balls touch at one time: Moreau's (1988), with Newton's restitution at each contact.
//!
//! Contacts push, and never pull. Where one pushes, its two balls part with their restitution times the speed that they
//! approached with; where none is needed, they part at least as fast: with a contact's impulse λ and its speeds of
//! parting v before and v′ after, λ ≥ 0, v′ + e·v ≥ 0, and λ·(v′ + e·v) = 0. So no order of the impacts has to be
//! chosen, momentum is kept, and energy never rises, nor falls where e = 1: ΔE = ½·Σ λ·(v′ + v) = −½·Σ λ·(1 − e)·|v|.

use glam::DVec2;

use super::cholesky::{Cholesky, Skyline};

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
    /// How fast its two balls approach each other, times its offset's length.
    fn closing(&self, bodies: &[Body]) -> f64 {
        (bodies[self.second].velocity - bodies[self.first].velocity).dot(self.offset)
    }

    /// In which direction along its offset it pushes a body: 0 where that is neither of its own.
    fn side(&self, body: usize) -> f64 {
        f64::from(u8::from(body == self.first)) - f64::from(u8::from(body == self.second))
    }

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

/// So many sweeps are made before impulses that have not settled are solved for, and so often: of unlike masses, or in long
/// rows, they would take thousands.
const SWEEPS: [usize; 2] = [100, 20];
/// ... so many times at most.
const ROUNDS: usize = 20;
/// They have settled where a sweep changed no speed by more than this part of the balls' own ...
const SETTLED: f64 = 4.0 * f64::EPSILON;
/// ... or, once they were solved for, by no more than this part: where light balls are thrown about among heavy ones, they
/// go to and fro by their rounding.
const ROUNDED: f64 = 1e-12;

/// Gives bodies their velocities after all contacts' impulses, and returns how many contacts push; `None`, with nothing
/// changed, where the impulses do not settle, as with masses that are too unequal.
///
/// The linear complementarity problem is solved by projected Gauss–Seidel sweeps, and where these are slow with steps to the
/// solution for those contacts that push (Silcowitz, Niebe & Erleben 2010), to the rounding of the heaviest's momentum.
pub(super) fn exchange(bodies: &mut [Body], contacts: &[Contact]) -> Option<usize> {
    let before = bodies.to_vec();
    let mut impulses = Impulses::new(bodies, contacts);
    for round in 0..ROUNDS {
        let tolerance = if round == 0 { SETTLED } else { ROUNDED } * impulses.scale;
        for _ in 0..SWEEPS[round.min(1)] {
            if impulses.sweep(bodies) <= tolerance {
                // Anew and in one go: the roundings of all sweeps have added up.
                bodies.copy_from_slice(&before);
                for (contact, &impulse) in contacts.iter().zip(&impulses.list) {
                    contact.push(bodies, impulse);
                }
                return Some(impulses.list.iter().filter(|&&impulse| impulse > 0.0).count());
            }
        }
        impulses.solve_pushing(bodies);
    }
    bodies.copy_from_slice(&before);
    None
}

/// The contacts' impulses, which never pull, while they are solved for.
struct Impulses<'a> {
    contacts: &'a [Contact],
    /// How fast each contact's balls approached each other, times its offset's length.
    approaches: Vec<f64>,
    /// How fast balls move, at most, times the length of an offset.
    scale: f64,
    list: Vec<f64>,
}

impl<'a> Impulses<'a> {
    /// None yet.
    fn new(bodies: &[Body], contacts: &'a [Contact]) -> Self {
        let speeds = |contact: &Contact| {
            (bodies[contact.first].velocity.length() + bodies[contact.second].velocity.length())
                * contact.offset.length()
        };
        Self {
            contacts,
            approaches: contacts.iter().map(|contact| contact.closing(bodies)).collect(),
            scale: contacts.iter().map(speeds).fold(0.0, f64::max),
            list: vec![0.0; contacts.len()],
        }
    }

    /// How much faster a contact's balls would have to part, times its offset's length.
    fn short(&self, at: usize, bodies: &[Body]) -> f64 {
        let contact = &self.contacts[at];
        contact.closing(bodies) + contact.restitution * self.approaches[at]
    }

    /// Solves for one impulse after the other, and returns the largest change of a speed, times the offset's length.
    fn sweep(&mut self, bodies: &mut [Body]) -> f64 {
        let mut largest = 0.0_f64;
        for (at, contact) in self.contacts.iter().enumerate() {
            let (first, second) = (bodies[contact.first], bodies[contact.second]);
            let give = contact.offset.length_squared() * (first.inverse_mass + second.inverse_mass);
            let change = (self.list[at] + self.short(at, bodies) / give).max(0.0) - self.list[at];
            self.list[at] += change;
            largest = largest.max(change.abs() * give);
            contact.push(bodies, change);
        }
        largest
    }

    /// Solves for all impulses that push at once; those that would have to pull end, and the others are solved for again.
    fn solve_pushing(&mut self, bodies: &mut [Body]) {
        let mut pushing: Vec<usize> = (0..self.list.len()).filter(|&at| self.list[at] > 0.0).collect();
        while !pushing.is_empty() {
            let shorts = pushing.iter().map(|&at| self.short(at, bodies)).collect();
            let changes = Cholesky::new(self.gives(&pushing, bodies)).solve(shorts);
            if !changes.iter().all(|change| change.is_finite()) {
                return;
            }
            let before = pushing.len();
            for (&at, change) in pushing.iter().zip(changes) {
                let impulse = (self.list[at] + change).max(0.0);
                self.contacts[at].push(bodies, impulse - self.list[at]);
                self.list[at] = impulse;
            }
            pushing.retain(|&at| self.list[at] > 0.0);
            if pushing.len() == before {
                return;
            }
        }
    }

    /// By how much each of these contacts' balls part faster for each of these impulses.
    fn gives(&self, pushing: &[usize], bodies: &[Body]) -> Skyline {
        let mut gives = Skyline::default();
        for &at in pushing {
            let one = &self.contacts[at];
            for (give, &other) in gives.add_row(0).iter_mut().zip(pushing) {
                let other = &self.contacts[other];
                let shares = [one.first, one.second]
                    .map(|body| one.side(body) * other.side(body) * bodies[body].inverse_mass);
                *give = one.offset.dot(other.offset) * (shares[0] + shares[1]);
            }
        }
        gives
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A square of balls that touch their neighbours, and the contacts of those that approach each other.
    fn square(velocities: &[DVec2], masses: &[f64], restitution: f64) -> (Vec<Body>, Vec<Contact>) {
        let side = velocities.len().isqrt();
        let body = |(&velocity, mass): (&DVec2, &f64)| Body { velocity, inverse_mass: mass.recip() };
        let bodies: Vec<Body> = velocities.iter().zip(masses).map(body).collect();
        let place = |at: usize| DVec2::new((at % side) as f64, (at / side) as f64);
        let contact = |first: usize, second: usize| Contact {
            first,
            second,
            offset: (place(first) - place(second)) * 20.0,
            restitution,
        };
        let right = (0..side * side).filter(|at| at % side + 1 < side).map(|at| contact(at, at + 1));
        let down = (0..side * (side - 1)).map(|at| contact(at, at + side));
        let approach = |contact: &Contact| contact.closing(&bodies) > 0.0;
        let contacts = right.chain(down).filter(approach).collect();
        (bodies, contacts)
    }

    proptest! {
        #[test]
        fn contacts_of_masses_a_million_times_as_heavy_part_as_moreaus_law_says(
            velocities in prop::collection::vec([-1.0..1.0, -1.0..1.0].prop_map(DVec2::from), 36),
            masses in prop::collection::vec((-3.0..3.0).prop_map(|exponent| 10_f64.powf(exponent)), 36),
            restitution in prop::sample::select(vec![0.0, 0.5, 1.0]),
        ) {
            let (before, contacts) = square(&velocities, &masses, restitution);
            let mut bodies = before.clone();
            let pushing = exchange(&mut bodies, &contacts);
            prop_assert!(pushing.is_some_and(|pushing| 0 < pushing && pushing <= contacts.len()));
            for contact in &contacts {
                let (was, is) = (contact.closing(&before), contact.closing(&bodies));
                prop_assert!(is + restitution * was < 1e-9 * contact.offset.length(), "{is} after {was}");
            }
            let momentum = |bodies: &[Body]| bodies.iter().map(|body| body.velocity / body.inverse_mass).sum::<DVec2>();
            let scale: f64 = before.iter().map(|body| body.velocity.length() / body.inverse_mass).sum();
            prop_assert!(momentum(&bodies).distance(momentum(&before)) < 1e-12 * scale);
            let energy = |bodies: &[Body]| bodies.iter().map(|body| body.velocity.length_squared() / body.inverse_mass).sum::<f64>();
            let kept = energy(&bodies) / energy(&before);
            prop_assert!(if restitution == 1.0 { (kept - 1.0).abs() < 1e-9 } else { kept < 1.0 }, "{kept}");
        }
    }

    #[test]
    fn a_row_of_fifty_that_is_squeezed_from_both_ends_comes_to_rest_at_once() {
        // Each sweep brings an impulse on by one contact, and takes away little of it.
        let mut bodies = vec![Body { velocity: DVec2::ZERO, inverse_mass: 1.0 }; 50];
        (bodies[0].velocity, bodies[49].velocity) = (DVec2::X, -DVec2::X);
        let contact = |first: usize| Contact {
            first,
            second: first + 1,
            offset: DVec2::new(-20.0, 0.0),
            restitution: 0.0,
        };
        let contacts: Vec<Contact> = (0..49).map(contact).collect();
        assert_eq!(exchange(&mut bodies, &contacts), Some(49));
        assert!(bodies.iter().all(|body| body.velocity.length() < 1e-12));
    }

    #[test]
    fn contacts_that_others_make_needless_are_no_harm() {
        // A triangle of five rows has more contacts than its balls have ways to move against each other.
        let place = |row: usize, column: usize| {
            DVec2::new(column as f64 - 0.5 * row as f64, row as f64 * 0.75_f64.sqrt()) * 20.0
        };
        let places: Vec<DVec2> =
            (0..5).flat_map(|row| (0..=row).map(move |column| place(row, column))).collect();
        let middle = places.iter().sum::<DVec2>() / places.len() as f64;
        let body = |&place: &DVec2| Body { velocity: middle - place, inverse_mass: 1.0 };
        let mut bodies: Vec<Body> = places.iter().map(body).collect();
        let pairs = (0..15).flat_map(|first| (first + 1..15).map(move |second| (first, second)));
        let contact = |(first, second): (usize, usize)| {
            let offset: DVec2 = places[first] - places[second];
            (offset.length() < 20.1).then_some(Contact { first, second, offset, restitution: 0.5 })
        };
        let contacts: Vec<Contact> = pairs.filter_map(contact).collect();
        assert_eq!(contacts.len(), 30);
        let before = bodies.clone();
        assert!(exchange(&mut bodies, &contacts).is_some());
        for (was, is) in before.iter().zip(&bodies) {
            assert!(
                is.velocity.distance(-0.5 * was.velocity) < 1e-9,
                "{} after {}",
                is.velocity,
                was.velocity
            );
        }
    }
}
