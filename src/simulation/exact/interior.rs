//! What contacts push where there is no room: in rows that fit between walls to the last digit, and in crystals, where they are more
//! than their balls can answer to.
//!
//! The velocities that are looked for are the nearest, by energy, to those that were with which no contact closes: a convex problem,
//! in which only the pushes are not unique. Where there is no room it has no interior; a point that comes from outside finds its
//! answer all the same, for hundreds of balls in some twenty steps (Mehrotra 1992; Wright 1997).

use glam::{DMat2, DVec2};

use crate::simulation::cholesky::{Cholesky, Skyline};

use super::contacts::{Contact, Support};
use super::sweeps::Enough;

/// So many steps are made at most.
const MOST_STEPS: usize = 40;
/// The part of the way to where a push or a spare would be none that a step goes at most.
const SHORT_OF: f64 = 0.995;
/// Where a step can go no farther than this part of its way there is no answer.
const SHORTEST: f64 = 1e-4;
/// The part of its own give by which each contact counts as softer in a step, so that rounding leaves the masses seen beside what is
/// stiff: what that leaves undone the next step does.
const SOFTNESS: f64 = 1e-11;

/// Finds velocities with which each contact's members part as fast as they are to at least, and those that push hardly faster, and what
/// contacts push then, whatever they push so far. Returns how many steps it took, and whether there are such velocities and they were
/// found: else nothing is changed. Members follow each other in this order; the nearer those that touch are in it, the less time it
/// takes.
pub(super) fn approach_from_outside(
    motions: &mut [DVec2],
    inverse_masses: &[f64],
    contacts: &mut [Contact],
    order: &[usize],
    enough: Enough,
) -> (usize, bool) {
    let mut before = motions.to_vec();
    for contact in &*contacts {
        contact.apply(-contact.push, &mut before, inverse_masses);
    }
    let fastest = contacts.iter().map(|contact| -contact.spare(&before)).fold(enough.slower, f64::max);
    let mut ranks = vec![0; order.len()];
    order.iter().enumerate().for_each(|(rank, &member)| ranks[member] = rank);
    let problem = Problem {
        masses: inverse_masses.iter().map(|inverse_mass| inverse_mass.recip()).collect(),
        before,
        contacts,
        order,
        ranks,
    };
    let mut point = problem.begin(fastest);
    for steps in 0..MOST_STEPS {
        if problem.is_found(&point, enough) {
            motions.copy_from_slice(&point.motions);
            for (contact, Strain { spare, push }) in contacts.iter_mut().zip(point.strains) {
                contact.push = if push * contact.give > spare { push } else { 0.0 };
            }
            return (steps, true);
        }
        let step = problem.step(&point);
        let part = (SHORT_OF * step.longest(&point)).min(1.0);
        // False for a NaN.
        let goes_on = part > SHORTEST && step.motions.iter().all(|motion| motion.is_finite());
        if !goes_on {
            return (steps + 1, false);
        }
        point.go(&step, part);
    }
    (MOST_STEPS, false)
}

/// What is looked for.
struct Problem<'a> {
    masses: Vec<f64>,
    /// The velocities before contacts push.
    before: Vec<DVec2>,
    contacts: &'a [Contact],
    order: &'a [usize],
    /// The place of each member in that order.
    ranks: Vec<usize>,
}

/// How a contact is strained.
#[derive(Debug, Clone, Copy)]
struct Strain {
    /// How much faster its members part than they are to, px/s: more than not at all. In the end that is what their velocities say.
    spare: f64,
    /// What it pushes, more than nothing.
    push: f64,
}

impl Strain {
    /// None in the end.
    fn product(self) -> f64 {
        self.spare * self.push
    }

    /// How much its members' parting has to change, as a step counts it, for its push to change by all of it.
    fn yields(self, contact: &Contact) -> f64 {
        self.spare + self.push * SOFTNESS * contact.give
    }

    /// It after this part of a change.
    fn after(self, by: &Self, part: f64) -> Self {
        Self { spare: self.spare + part * by.spare, push: self.push + part * by.push }
    }
}

/// The point that comes to the answer, or by how much it is to move.
struct Point {
    motions: Vec<DVec2>,
    strains: Vec<Strain>,
}

impl Point {
    /// What part of the way of a step from here on can be gone before a push or a spare is none; at most all, and a little more.
    fn longest(&self, from: &Self) -> f64 {
        let until_none = |value: f64, by: f64| if by < 0.0 { -value / by } else { f64::INFINITY };
        let each = from.strains.iter().zip(&self.strains);
        each.map(|(from, by)| until_none(from.spare, by.spare).min(until_none(from.push, by.push)))
            .fold(SHORT_OF.recip(), f64::min)
    }

    /// Goes this part of the way of a step.
    fn go(&mut self, step: &Self, part: f64) {
        self.motions.iter_mut().zip(&step.motions).for_each(|(motion, by)| *motion += *by * part);
        for (strain, by) in self.strains.iter_mut().zip(&step.strains) {
            *strain = strain.after(by, part);
        }
    }
}

impl Problem<'_> {
    /// Where it begins: at the velocities that were, with all contacts strained by as much as the fastest approach, px/s.
    fn begin(&self, fastest: f64) -> Point {
        let strain = |contact: &Contact| Strain {
            spare: contact.spare(&self.before).max(fastest),
            push: fastest / contact.give,
        };
        Point { motions: self.before.clone(), strains: self.contacts.iter().map(strain).collect() }
    }

    /// Whether that is the answer: nothing closes, what parts does not push, and velocities are what pushes make of them.
    fn is_found(&self, point: &Point, enough: Enough) -> bool {
        let mut each = self.contacts.iter().zip(&point.strains);
        let apart = each.all(|(contact, strain)| {
            let loose = strain.spare.min(strain.push * contact.give);
            -contact.spare(&point.motions) <= enough.slower && loose <= enough.faster
        });
        let off = |(momentum, mass): (DVec2, &f64)| momentum.length() <= enough.faster * mass;
        apart && self.momenta_off(point, |strain, _| strain.push).into_iter().zip(&self.masses).all(off)
    }

    /// The momenta that velocities lack where contacts push so much.
    fn momenta_off(&self, point: &Point, push: impl Fn(&Strain, usize) -> f64) -> Vec<DVec2> {
        let each = point.motions.iter().zip(&self.before).zip(&self.masses);
        let mut momenta: Vec<DVec2> = each.map(|((now, before), mass)| (*before - *now) * *mass).collect();
        for (at, (contact, strain)) in self.contacts.iter().zip(&point.strains).enumerate() {
            let push = push(strain, at);
            contact.pushed().for_each(|(member, direction)| momenta[member] += direction * push);
        }
        momenta
    }

    /// The step that leads there, as far as the problem is linear: with what is left to be made good of it by that (Mehrotra 1992).
    fn step(&self, point: &Point) -> Point {
        let factors = self.factors(point);
        let straight: Vec<f64> = point.strains.iter().map(|strain| strain.product()).collect();
        let first = self.step_by(point, &factors, &straight);
        let part = first.longest(point).min(1.0);
        let each = point.strains.iter().zip(&first.strains);
        let left: f64 = each.clone().map(|(strain, by)| strain.after(by, part).product()).sum();
        let (all, count) = (straight.iter().sum::<f64>(), straight.len() as f64);
        // All are to fall alike, the less the farther the straight way leads.
        let ratio = (left / all).max(0.0);
        let alike = ratio * ratio * ratio * all / count;
        let made_good = each.map(|(strain, by)| strain.product() + by.product() - alike).collect::<Vec<_>>();
        self.step_by(point, &factors, &made_good)
    }

    /// The step with which, to first order, each contact's product of spare and push falls by this.
    fn step_by(&self, point: &Point, factors: &Cholesky, falls: &[f64]) -> Point {
        let off = |contact: &Contact, strain: &Strain| contact.spare(&point.motions) - strain.spare;
        let push_by = |contact: &Contact, strain: &Strain, falls: f64, parting_by: f64| {
            -(falls + strain.push * parting_by) / strain.yields(contact)
        };
        let momenta = self.momenta_off(point, |strain, at| {
            let contact = &self.contacts[at];
            strain.push + push_by(contact, strain, falls[at], off(contact, strain))
        });
        let motions = self.solve(factors, &momenta);
        let strain_by = |((contact, strain), &falls): ((&Contact, &Strain), &f64)| {
            let parting = contact.parting(&motions) + off(contact, strain);
            let push = push_by(contact, strain, falls, parting);
            Strain { spare: parting + push * SOFTNESS * contact.give, push }
        };
        let strains = self.contacts.iter().zip(&point.strains).zip(falls).map(strain_by).collect();
        Point { motions, strains }
    }

    /// The factors of how momenta change velocities while contacts give way by as much as they are strained: two rows a ball.
    fn factors(&self, point: &Point) -> Cholesky {
        let own = |&member: &usize| DMat2::from_diagonal(DVec2::splat(self.masses[member]));
        let mut diagonal: Vec<DMat2> = self.order.iter().map(own).collect();
        // With which earlier ones each touches.
        let mut earlier: Vec<Vec<(usize, DMat2)>> = vec![Vec::new(); self.order.len()];
        for (contact, strain) in self.contacts.iter().zip(&point.strains) {
            let normal = contact.normal;
            let stiffness = DMat2::from_cols(normal * normal.x, normal * normal.y)
                * (strain.push / strain.yields(contact));
            let one = self.ranks[contact.one];
            diagonal[one] += stiffness;
            if let Support::Member(other) = contact.against {
                let other = self.ranks[other];
                diagonal[other] += stiffness;
                earlier[one.max(other)].push((one.min(other), stiffness));
            }
        }
        let mut matrix = Skyline::default();
        for (rank, (own, earlier)) in diagonal.iter().zip(&earlier).enumerate() {
            let first = 2 * earlier.iter().map(|(other, _)| *other).fold(rank, usize::min);
            for axis in 0..2 {
                let values = matrix.add_row(first);
                for (other, stiffness) in earlier {
                    let at = 2 * other - first;
                    values[at] -= stiffness.x_axis[axis];
                    values[at + 1] -= stiffness.y_axis[axis];
                }
                let at = 2 * rank - first;
                values[at..=at + axis].copy_from_slice(&own.row(axis).to_array()[..=axis]);
            }
        }
        Cholesky::new(matrix)
    }

    /// The velocities that these momenta give.
    fn solve(&self, factors: &Cholesky, momenta: &[DVec2]) -> Vec<DVec2> {
        let solution =
            factors.solve(self.order.iter().flat_map(|&member| momenta[member].to_array()).collect());
        let mut motions = vec![DVec2::ZERO; momenta.len()];
        for (&member, motion) in self.order.iter().zip(solution.as_chunks().0) {
            motions[member] = DVec2::from_array(*motion);
        }
        motions
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of equal balls of mass 2 on a floor, from wall to wall without any room between them, each over the gaps of the row below
    /// or, if these are `square`, over its balls.
    fn rows(columns: usize, rows: usize, square: bool) -> Vec<Contact> {
        let contact = |one: usize, against: Support, normal: DVec2| {
            let give = if let Support::Member(_) = against { 1.0 } else { 0.5 };
            Contact { one, against, normal, gap: 0.0, give, push: 0.0, least: 0.0, pushes: false }
        };
        let slanted = DVec2::new(0.5, 0.75_f64.sqrt());
        let mut contacts = Vec::new();
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            let at = row * columns + column;
            let left = if column == 0 { Support::Wall } else { Support::Member(at - 1) };
            contacts.push(contact(at, left, DVec2::X));
            if column == columns - 1 {
                contacts.push(contact(at, Support::Wall, DVec2::NEG_X));
            }
            if row == 0 {
                contacts.push(contact(at, Support::Wall, DVec2::Y));
            } else if square {
                contacts.push(contact(at, Support::Member(at - columns), DVec2::Y));
            } else {
                contacts.push(contact(at, Support::Member(at - columns), slanted));
                if column + 1 < columns {
                    let other = Support::Member(at - columns + 1);
                    contacts.push(contact(at, other, DVec2::new(-slanted.x, slanted.y)));
                }
            }
        }
        contacts
    }

    fn solved(contacts: &mut [Contact], before: &[DVec2]) -> (Option<usize>, Vec<DVec2>) {
        let order: Vec<usize> = (0..before.len()).collect();
        let mut motions = before.to_vec();
        let enough = Enough { slower: 1e-8, closing: 0.0, faster: 1e-6, dead: 0.0, most_sweeps: 0 };
        let masses = vec![0.5; before.len()];
        let (steps, found) = approach_from_outside(&mut motions, &masses, contacts, &order, enough);
        (found.then_some(steps), motions)
    }

    /// Velocities of all kinds.
    fn falling(count: usize) -> Vec<DVec2> {
        (0..count).map(|at| DVec2::new((at * 7 % 13) as f64 - 6.0, -3.0 - (at * 5 % 11) as f64)).collect()
    }

    #[test]
    fn rows_without_room_come_to_a_stand_in_a_few_steps_whatever_their_number() {
        for (columns, number) in [(2, 1), (8, 1), (25, 4), (25, 16)] {
            let mut contacts = rows(columns, number, true);
            let (steps, motions) = solved(&mut contacts, &falling(columns * number));
            assert!(steps.is_some_and(|steps| steps < 25), "{columns} × {number}: {steps:?}");
            // Across, none has room; and all fall.
            let fastest = motions.iter().map(|motion| motion.length()).fold(0.0, f64::max);
            assert!(fastest < 1e-5, "{columns} × {number}: {fastest}");
        }
    }

    #[test]
    fn in_a_crystal_without_room_nothing_closes_or_pulls_and_pushes_take_energy() {
        let mut contacts = rows(20, 12, false);
        let before = falling(240);
        let (steps, motions) = solved(&mut contacts, &before);
        assert!(steps.is_some_and(|steps| steps < 30), "{steps:?}");
        let energy =
            |motions: &[DVec2]| -> f64 { motions.iter().map(|motion| motion.length_squared()).sum() };
        assert!(energy(&motions) < energy(&before));
        let mut pushed = before;
        for contact in &contacts {
            assert!(contact.push >= 0.0 && contact.spare(&motions) >= -1e-8, "{contact:?}");
            contact.apply(contact.push, &mut pushed, &[0.5; 240]);
        }
        let off = pushed.iter().zip(&motions).map(|(pushed, motion)| pushed.distance(*motion));
        assert!(off.fold(0.0, f64::max) < 1e-4);
    }

    #[test]
    fn where_there_is_no_answer_nothing_is_changed() {
        // A row that is to part, and cannot.
        let mut contacts = rows(9, 1, true);
        for contact in &mut contacts {
            contact.least = 1.0;
        }
        let (steps, motions) = solved(&mut contacts, &falling(9));
        assert_eq!((steps, motions), (None, falling(9)));
        assert!(contacts.iter().all(|contact| contact.push == 0.0));
    }
}
