//! What many contacts push: more than can be solved for directly from step to step, or than their balls can answer to, as in
//! crystals.

use glam::DVec2;

use super::contacts::Contact;

/// How nearly velocities are found with which contacts part as fast as they are to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Enough {
    /// How much slower they may part, px/s, ...
    pub(super) slower: f64,
    /// ... and how much of what is between the two they may close beyond that, 1/s;
    pub(super) closing: f64,
    /// how much faster those that push may part, px/s;
    pub(super) faster: f64,
    /// and how much slower those that do not push yet may part before they do, px/s.
    pub(super) dead: f64,
    /// How many steps it may take.
    pub(super) most_steps: usize,
}

/// Looks for pushes, none of which pulls, with which each contact's members part as fast as they are to at least, from those that
/// there are, and returns how many steps it took: by projected gradients, each step of which begins ahead of where the last one ended
/// (Nesterov 1983; of contacts: Mazhar et al. 2015), and there where it would turn back (O'Donoghue & Candès 2015).
pub(super) fn accelerate(
    motions: &mut [DVec2],
    inverse_masses: &[f64],
    contacts: &mut [Contact],
    enough: Enough,
) -> usize {
    let softness = softness(inverse_masses, contacts);
    let mut unpushed = motions.to_vec();
    for contact in &*contacts {
        contact.apply(-contact.push, &mut unpushed, inverse_masses);
    }
    // Where the next step begins, and where the last one ended.
    let mut begins: Vec<f64> = contacts.iter().map(|contact| contact.push).collect();
    let (mut motions_there, mut motions_before) = (motions.to_vec(), motions.to_vec());
    let mut inertia = 1.0_f64;
    for steps in 1..=enough.most_steps {
        motions.copy_from_slice(&unpushed);
        let (mut found, mut along) = (true, 0.0);
        for ((contact, begins), softness) in contacts.iter_mut().zip(&mut begins).zip(&softness) {
            let spare = contact.spare(&motions_there);
            let begins_to = *begins > 0.0 || spare < -enough.dead;
            let push = if begins_to { (*begins - spare * softness).max(0.0) } else { 0.0 };
            found &= spare >= -enough.slower - enough.closing * contact.gap.max(0.0);
            found &= push == 0.0 || spare <= enough.faster;
            along += spare * (push - contact.push);
            *begins = std::mem::replace(&mut contact.push, push);
            if push > 0.0 {
                contact.apply(push, motions, inverse_masses);
            }
        }
        if found {
            return steps;
        }
        let next = 0.5 * inertia * ((inertia * inertia + 4.0).sqrt() - inertia);
        let turns_back = along > 0.0;
        let ahead = if turns_back { 0.0 } else { inertia * (1.0 - inertia) / (inertia * inertia + next) };
        inertia = if turns_back { 1.0 } else { next };
        for (contact, begins) in contacts.iter().zip(&mut begins) {
            *begins = contact.push + ahead * (contact.push - *begins);
        }
        for ((there, before), now) in motions_there.iter_mut().zip(&mut motions_before).zip(&*motions) {
            *there = *now + (*now - *before) * ahead;
            *before = *now;
        }
    }
    enough.most_steps
}

/// How much each contact's push may change for how fast its members part, if all do at once: so little that none of their members is
/// moved too far by all of its contacts together.
fn softness(inverse_masses: &[f64], contacts: &[Contact]) -> Vec<f64> {
    // Along no direction do a member's contacts push it more than as many as the larger eigenvalue of the sum of n·nᵀ.
    let mut sums = vec![[0.0; 3]; inverse_masses.len()];
    for contact in contacts {
        for (member, way) in contact.pushed() {
            let [xx, xy, yy] = &mut sums[member];
            (*xx, *xy, *yy) = (*xx + way.x * way.x, *xy + way.x * way.y, *yy + way.y * way.y);
        }
    }
    let at_once = |member: usize| {
        let [xx, xy, yy] = sums[member];
        0.5 * (xx + yy) + DVec2::new(0.5 * (xx - yy), xy).length()
    };
    let give = |contact: &Contact| -> f64 {
        contact.pushed().map(|(member, _)| inverse_masses[member] * at_once(member)).sum()
    };
    contacts.iter().map(|contact| give(contact).recip()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::contacts::Support;
    use super::*;

    /// A square of balls of two masses, a part of their diameter from each other, on a floor and beside a wall.
    fn lattice(side: usize, gap: f64) -> (Vec<f64>, Vec<Contact>) {
        let inverse_masses: Vec<f64> =
            (0..side * side).map(|at| if at % 3 == 0 { 0.1 } else { 1.0 }).collect();
        let contact = |one: usize, against: Support, normal: DVec2| {
            let theirs = if let Support::Member(other) = against { inverse_masses[other] } else { 0.0 };
            let give = inverse_masses[one] + theirs;
            Contact { one, against, normal, gap, give, push: 0.0, least: 0.0, pushes: false }
        };
        let mut contacts = Vec::new();
        for at in 0..side * side {
            let (row, column) = (at / side, at % side);
            let below = if row == 0 { Support::Wall } else { Support::Member(at - side) };
            let beside = if column == 0 { Support::Wall } else { Support::Member(at - 1) };
            contacts.extend([contact(at, below, DVec2::Y), contact(at, beside, DVec2::X)]);
            if row > 0 && column > 0 {
                contacts.push(contact(at, Support::Member(at - side - 1), DVec2::splat(0.5_f64.sqrt())));
            }
        }
        (inverse_masses, contacts)
    }

    fn falling(count: usize) -> Vec<DVec2> {
        (0..count).map(|at| DVec2::new((at % 7) as f64 - 3.0, -1.0 - (at % 5) as f64)).collect()
    }

    #[test]
    fn hundreds_that_fall_part_without_a_pull_or_a_needless_push_and_lose_energy() {
        let (inverse_masses, mut contacts) = lattice(14, 0.0);
        assert!(contacts.len() > 2 * inverse_masses.len());
        let before = falling(inverse_masses.len());
        let mut velocities = before.clone();
        let enough = Enough { slower: 1e-6, closing: 0.0, faster: 1e-6, dead: 0.0, most_steps: 20_000 };
        assert!(accelerate(&mut velocities, &inverse_masses, &mut contacts, enough) < 20_000);
        let energy = |velocities: &[DVec2]| -> f64 {
            let each = velocities.iter().zip(&inverse_masses);
            each.map(|(velocity, inverse_mass)| velocity.length_squared() / inverse_mass).sum()
        };
        assert!(energy(&velocities) < energy(&before));
        let mut pushed = before;
        for contact in &contacts {
            let parting = contact.parting(&velocities);
            assert!(contact.push >= 0.0 && parting > -1e-5, "{contact:?} parts at {parting}");
            assert!(contact.push == 0.0 || parting < 1e-5, "{contact:?} pushes and parts at {parting}");
            contact.apply(contact.push, &mut pushed, &inverse_masses);
        }
        // The velocities are what the pushes make of those that were.
        let off = pushed.iter().zip(&velocities).map(|(pushed, velocity)| pushed.distance(*velocity));
        assert!(off.fold(0.0, f64::max) < 1e-9);
    }

    #[test]
    fn what_is_between_balls_may_close_and_what_parts_nearly_fast_enough_is_left_alone() {
        let (inverse_masses, contacts) = lattice(8, 1e-3);
        let slow: Vec<DVec2> =
            falling(inverse_masses.len()).iter().map(|velocity| *velocity * 1e-4).collect();
        let closing = Enough { slower: 0.0, closing: 2.0, faster: 0.0, dead: 2e-3, most_steps: 100 };
        let (mut velocities, mut left) = (slow.clone(), contacts.clone());
        assert_eq!(accelerate(&mut velocities, &inverse_masses, &mut left, closing), 1);
        assert!(left.iter().all(|contact| contact.push == 0.0));
        assert_eq!(velocities, slow);
        let at_once = Enough { closing: 0.0, dead: 0.0, ..closing };
        assert!(accelerate(&mut velocities, &inverse_masses, &mut left, at_once) > 1);
        assert!(left.iter().any(|contact| contact.push > 0.0));
    }
}
