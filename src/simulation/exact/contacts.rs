//! Contacts of balls that touch, and what they push: the linear complementarity problem of pushes that never pull.

use glam::DVec2;

use crate::simulation::cholesky::{Cholesky, Skyline};

/// How often it is tried to find those contacts that push.
const ROUNDS: usize = 12;
/// Contacts are swept so many times ...
const SWEEPS: usize = 4;
/// ... before a step, and so often at most.
const DESCENTS: usize = 32;
/// How often a step is shortened to a quarter.
const SHORTENED: usize = 10;
/// The part of its own give by which each contact is softer where all are solved for directly, so that there is an answer: from this ...
const LEAST_SOFTNESS: f64 = 1e-12;
/// ... to this ...
const MOST_SOFTNESS: f64 = 1e-2;
/// ... by so many times each time.
const SOFTER: f64 = 100.0;
/// Each contact has so many before it, back to the first that it shares a ball with. Where their mean square is larger than this, steps
/// of conjugate gradients take less time ...
const MOST_SQUARE: usize = 1 << 12;
/// ... of which so many are made then at most.
const MOST_STEPS: usize = 100;
/// This mean square takes as long as one such step.
const SQUARE_PER_STEP: usize = 1 << 5;

/// Two members that touch, or one and what nothing moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Contact {
    pub(super) one: usize,
    pub(super) against: Support,
    /// The unit vector to the one.
    pub(super) normal: DVec2,
    /// What is between the two, px; below 0 they overlap.
    pub(super) gap: f64,
    /// The sum of the inverse masses.
    pub(super) give: f64,
    /// The force, or the momentum, that each gives to the other.
    pub(super) push: f64,
    /// How fast the two are to part at least, px/s.
    pub(super) least: f64,
    /// Whether there is to be no other relative motion along the contact; else there is no push.
    pub(super) pushes: bool,
}

/// What a member touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Support {
    Member(usize),
    Wall,
    /// A ball that counts as immovable, by its slot.
    Immovable(usize),
}

impl Contact {
    /// How fast the two part, or are driven apart.
    pub(super) fn parting(&self, motions: &[DVec2]) -> f64 {
        let other = if let Support::Member(other) = self.against { motions[other] } else { DVec2::ZERO };
        (motions[self.one] - other).dot(self.normal)
    }

    /// The same beyond what they are to.
    pub(super) fn spare(&self, motions: &[DVec2]) -> f64 {
        self.parting(motions) - self.least
    }

    /// How much faster than at its mean velocity a member is to part at first from what does not move, if gravity changes its velocity
    /// by twice its part of these in the meantime: drawn away from that, it would come nearer to it first. 0 where it is drawn to it.
    pub(super) fn sooner(&self, half_kicks: &[DVec2]) -> f64 {
        let drawn = self.normal.dot(half_kicks[self.one]);
        if matches!(self.against, Support::Member(_)) { 0.0 } else { drawn.max(0.0) }
    }

    /// The members that it pushes, and where to.
    pub(super) fn pushed(&self) -> impl Iterator<Item = (usize, DVec2)> + use<> {
        let Self { one, against, normal, .. } = *self;
        let other = if let Support::Member(other) = against { Some((other, -normal)) } else { None };
        std::iter::once((one, normal)).chain(other)
    }

    /// Changes the motions of the two by a push.
    pub(super) fn apply(&self, push: f64, motions: &mut [DVec2], inverse_masses: &[f64]) {
        motions[self.one] += self.normal * (push * inverse_masses[self.one]);
        if let Support::Member(other) = self.against {
            motions[other] -= self.normal * (push * inverse_masses[other]);
        }
    }
}

/// Notes which contacts push already, or their members do not part.
fn note_pushing(motions: &[DVec2], contacts: &mut [Contact]) {
    for contact in contacts {
        contact.pushes = contact.push > 0.0 || contact.spare(motions) <= 0.0;
    }
}

/// Solves the linear complementarity problem of the contacts: finds pushes, none of which pulls, that leave the
/// members' motions without approach, and returns how many steps it took. At first all contacts push that do already, or do not part,
/// then those that would pull do not, and those that approach do, and again (block pivoting; Portugal, Júdice & Vicente 1994). Where
/// there are more than their balls can answer to, as in crystals, that need not come to an end.
pub(super) fn pivot(
    motions: &mut [DVec2],
    inverse_masses: &[f64],
    contacts: &mut [Contact],
    enough: f64,
) -> usize {
    let mut steps = 0;
    note_pushing(motions, contacts);
    for _ in 0..ROUNDS {
        contacts.sort_by_key(|contact| !contact.pushes);
        let pushing = contacts.partition_point(|contact| contact.pushes);
        steps += 1 + solve(motions, inverse_masses, &mut contacts[..pushing], enough, usize::MAX);
        let mut found = true;
        for contact in &mut *contacts {
            if contact.push < 0.0 {
                contact.apply(-contact.push, motions, inverse_masses);
                (contact.push, contact.pushes, found) = (0.0, false, false);
            }
        }
        for contact in &mut contacts[pushing..] {
            if contact.spare(motions) < -enough {
                (contact.pushes, found) = (true, false);
            }
        }
        if found {
            break;
        }
    }
    steps
}

/// The same from pushes that are nearly right, and however many contacts there are, as nearly as it is found: by sweeps over all
/// contacts, each as if the others were right (projected Gauss-Seidel), and between these by steps to what those that push would push
/// for good, as far as none pulls and that takes energy (Silcowitz, Niebe & Erleben 2010). Contacts should stand in the order of their
/// places. Returns how many steps of conjugate gradients take as long.
pub(super) fn descend(
    motions: &mut [DVec2],
    inverse_masses: &[f64],
    contacts: &mut [Contact],
    enough: f64,
) -> usize {
    let (mut steps, mut softness) = (0, LEAST_SOFTNESS);
    for _ in 0..DESCENTS {
        let changes = (0..SWEEPS).map(|_| sweep(motions, inverse_masses, contacts));
        let Some(largest) = changes.last() else { break };
        steps += SWEEPS;
        if largest <= enough {
            break;
        }
        note_pushing(motions, contacts);
        // These stay in their order, and so do all.
        let mut pushing: Vec<Contact> = contacts.iter().filter(|contact| contact.pushes).copied().collect();
        steps += step_down(motions, inverse_masses, &mut pushing, enough, &mut softness);
        let pushed = contacts.iter_mut().filter(|contact| contact.pushes);
        pushed.zip(pushing).for_each(|(contact, pushing)| contact.push = pushing.push);
    }
    steps
}

/// Sets each contact's push, so that its members do not approach and it does not pull, and returns the largest change of how fast
/// members part.
fn sweep(motions: &mut [DVec2], inverse_masses: &[f64], contacts: &mut [Contact]) -> f64 {
    let mut largest = 0.0_f64;
    for contact in contacts {
        let change = (contact.push - contact.spare(motions) / contact.give).max(0.0) - contact.push;
        contact.push += change;
        contact.apply(change, motions, inverse_masses);
        largest = largest.max(change.abs() * contact.give);
    }
    largest
}

/// Goes as far to where there is no relative motion along any of these contacts as none of them pulls, and as energy, less what
/// contacts give that are to part, falls by it. Where that is not all the way contacts are softer the next time, as where they are more
/// than their balls can answer to.
fn step_down(
    motions: &mut [DVec2],
    inverse_masses: &[f64],
    contacts: &mut [Contact],
    enough: f64,
    softness: &mut f64,
) -> usize {
    let pushes = |contacts: &[Contact]| -> Vec<f64> { contacts.iter().map(|contact| contact.push).collect() };
    let spares = |motions: &[DVec2], contacts: &[Contact]| -> Vec<f64> {
        contacts.iter().map(|contact| contact.spare(motions)).collect()
    };
    let (start, before, spare) = (motions.to_vec(), pushes(contacts), spares(motions, contacts));
    let (goal, steps) = if let Some((factors, steps)) = factors(contacts, inverse_masses, *softness) {
        let changes = factors.solve(spare.clone());
        (before.iter().zip(changes).map(|(before, change)| before - change).collect(), steps)
    } else {
        let steps = solve(motions, inverse_masses, contacts, enough, MOST_STEPS);
        motions.copy_from_slice(&start);
        (pushes(contacts), steps)
    };
    // Of a goal that is not finite no part is one.
    let is_finite = goal.iter().all(|push: &f64| push.is_finite());
    let (goal, mut part) = (if is_finite { &goal } else { &before }, 1.0);
    for _ in 0..SHORTENED {
        let part_way = before.iter().zip(goal).map(|(before, goal)| before + part * (goal - before));
        let changes: Vec<f64> = part_way.zip(&before).map(|(push, before)| push.max(0.0) - before).collect();
        for (contact, change) in contacts.iter().zip(&changes) {
            contact.apply(*change, motions, inverse_masses);
        }
        // What energy gains, less what contacts give, to the last digit.
        let each = changes.iter().zip(&spare).zip(spares(motions, contacts));
        let gained: f64 = each.map(|((change, before), after)| 0.5 * change * (before + after)).sum();
        if gained < 0.0 {
            let each = contacts.iter_mut().zip(&before).zip(changes);
            each.for_each(|((contact, before), change)| contact.push = before + change);
            let changed = if part == 1.0 { 1.0 / SOFTER } else { SOFTER };
            *softness = (*softness * changed).clamp(LEAST_SOFTNESS, MOST_SOFTNESS);
            return steps;
        }
        motions.copy_from_slice(&start);
        part *= 0.25;
    }
    contacts.iter_mut().zip(before).for_each(|(contact, push)| contact.push = push);
    *softness = (*softness * SOFTER).min(MOST_SOFTNESS);
    steps
}

/// The factors of how contacts' members part for their pushes, where these do not take long to find, and how many steps of conjugate
/// gradients take as long.
fn factors(contacts: &[Contact], inverse_masses: &[f64], softness: f64) -> Option<(Cholesky, usize)> {
    let firsts = firsts(contacts, inverse_masses.len());
    let square = firsts.iter().enumerate().map(|(row, first)| (row - first).pow(2)).sum::<usize>();
    let is_narrow = square <= MOST_SQUARE * contacts.len();
    is_narrow.then(|| {
        let factors = Cholesky::new(gives(contacts, inverse_masses, &firsts, softness));
        (factors, square / (SQUARE_PER_STEP * contacts.len().max(1)))
    })
}

/// The first contact with which each has a member in common, at most itself.
fn firsts(contacts: &[Contact], members: usize) -> Vec<usize> {
    let mut first_of = vec![usize::MAX; members];
    let first = |(row, contact): (usize, &Contact)| {
        let pushed = contact.pushed().map(|(member, _)| {
            first_of[member] = first_of[member].min(row);
            first_of[member]
        });
        pushed.fold(row, usize::min)
    };
    contacts.iter().enumerate().map(first).collect()
}

/// By how much each contact's members part faster for each contact's push; each gives way a little more than it does.
fn gives(contacts: &[Contact], inverse_masses: &[f64], firsts: &[usize], softness: f64) -> Skyline {
    // Each member's contacts so far, from the last one back: which it is, where that pushes it, and the one before.
    let mut last_of = vec![None; inverse_masses.len()];
    let mut chain: Vec<(usize, DVec2, Option<usize>)> = Vec::with_capacity(2 * contacts.len());
    let mut matrix = Skyline::default();
    for (row, (contact, &first)) in contacts.iter().zip(firsts).enumerate() {
        let values = matrix.add_row(first);
        values[row - first] = contact.give * (1.0 + softness);
        for (member, direction) in contact.pushed() {
            let mut link = last_of[member];
            while let Some((column, theirs, before)) = link.map(|link: usize| chain[link]) {
                values[column - first] += direction.dot(theirs) * inverse_masses[member];
                link = before;
            }
            chain.push((row, direction, last_of[member]));
            last_of[member] = Some(chain.len() - 1);
        }
    }
    matrix
}

/// Finds the pushes after which there is no relative motion along any contact, up to `enough`, from those that there
/// are, by preconditioned conjugate gradients (Hestenes & Stiefel 1952), and returns how many steps it took: no more than `most`.
fn solve(
    motions: &mut [DVec2],
    inverse_masses: &[f64],
    contacts: &mut [Contact],
    enough: f64,
    most: usize,
) -> usize {
    let most = most.min(2 * contacts.len() + 20);
    let mut residuals: Vec<f64> = contacts.iter().map(|contact| -contact.spare(motions)).collect();
    let mut directions = vec![0.0; contacts.len()];
    let mut moved = vec![DVec2::ZERO; motions.len()];
    let mut before = f64::INFINITY;
    for taken in 0..most {
        if residuals.iter().all(|residual| residual.abs() <= enough) {
            return taken;
        }
        let squares =
            contacts.iter().zip(&residuals).map(|(contact, residual)| residual * residual / contact.give);
        let square = squares.sum::<f64>();
        moved.fill(DVec2::ZERO);
        for ((contact, residual), direction) in contacts.iter().zip(&residuals).zip(&mut directions) {
            *direction = residual / contact.give + square / before * *direction;
            contact.apply(*direction, &mut moved, inverse_masses);
        }
        before = square;
        let curvatures =
            contacts.iter().zip(&directions).map(|(contact, direction)| contact.parting(&moved) * direction);
        let curvature = curvatures.sum::<f64>();
        if curvature <= 0.0 {
            return taken;
        }
        let step = square / curvature;
        for ((contact, residual), direction) in contacts.iter_mut().zip(&mut residuals).zip(&directions) {
            contact.push += step * direction;
            *residual -= step * contact.parting(&moved);
        }
        motions.iter_mut().zip(&moved).for_each(|(motion, moved)| *motion += *moved * step);
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contacts of balls of mass 1 at these places, each of them with all that are as near as 1, and with the floor under those of
    /// height 0; their balls in the order in which they are given.
    fn contacts(places: &[DVec2]) -> Vec<Contact> {
        let contact = |one, against, normal, give| Contact {
            one,
            against,
            normal,
            gap: 0.0,
            give,
            push: 0.0,
            least: 0.0,
            pushes: false,
        };
        let mut contacts = Vec::new();
        for (one, &place) in places.iter().enumerate() {
            if place.y == 0.0 {
                contacts.push(contact(one, Support::Wall, DVec2::Y, 1.0));
            }
            for (other, &beside) in places[..one].iter().enumerate() {
                if place.distance(beside) < 1.001 {
                    contacts.push(contact(one, Support::Member(other), (place - beside).normalize(), 2.0));
                }
            }
        }
        contacts
    }

    #[test]
    fn each_ball_of_a_column_of_thousands_is_borne_but_for_a_part_in_ten_thousand() {
        for count in [10, 100, 3000] {
            let places: Vec<DVec2> = (0..count).map(|row| DVec2::new(0.0, f64::from(row))).collect();
            let mut contacts = contacts(&places);
            let mut left = vec![-DVec2::Y; places.len()];
            descend(&mut left, &vec![1.0; places.len()], &mut contacts, 1e-4);
            let most = left.iter().map(|left| left.length()).fold(0.0, f64::max);
            assert!(most < 1e-4, "{count} balls: {most}");
            // The floor bears them all.
            assert!(
                (contacts[0].push / f64::from(count) - 1.0).abs() < 1e-4,
                "{count} balls: {}",
                contacts[0].push
            );
        }
    }

    #[test]
    fn in_a_crystal_that_falls_no_contact_pulls_and_none_is_left_that_approaches() {
        // Rows of ten, each between those of the one below: more contacts than there are ways for balls to move. They fall on the
        // floor and to the left or the right, each at a speed of its own.
        let place = |at: u32| {
            let (row, column) = (f64::from(at / 10), f64::from(at % 10));
            DVec2::new(column + 0.5 * (row % 2.0), 0.75_f64.sqrt() * row)
        };
        let places: Vec<DVec2> = (0..100).map(place).collect();
        let velocity = |at: usize| DVec2::new((at % 7) as f64 - 3.0, -1.0 - (at % 5) as f64);
        let before: Vec<DVec2> = (0..100).map(velocity).collect();
        let mut contacts = contacts(&places);
        assert!(contacts.len() > 2 * places.len());
        let mut velocities = before.clone();
        descend(&mut velocities, &vec![1.0; places.len()], &mut contacts, 1e-7);
        let energy =
            |velocities: &[DVec2]| velocities.iter().map(|velocity| velocity.length_squared()).sum::<f64>();
        assert!(energy(&velocities) < energy(&before));
        for contact in &contacts {
            let parting = contact.parting(&velocities);
            assert!(contact.push >= 0.0 && parting > -1e-5, "{contact:?} parts at {parting}");
            assert!(contact.push < 1e-4 || parting < 1e-4, "{contact:?} pushes and parts at {parting}");
        }
    }
}
