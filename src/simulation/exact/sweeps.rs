//! What many contacts push: more than can be solved for directly from step to step, or than their balls can answer to, as in
//! crystals.

use glam::DVec2;

use crate::simulation::lesser::greater;

use super::contacts::{Contact, Support};

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
    /// How many sweeps it may take.
    pub(super) most_sweeps: usize,
}

/// Looks for pushes, none of which pulls, with which each contact's members part as fast as they are to at least, from those that
/// there are, and returns how many sweeps over all contacts it took: at each the push is found that is right if the others are
/// (projected Gauss-Seidel), in the order of their colours, and each sweep begins ahead of where the last one ended (Nesterov 1983), or
/// there where it would turn back (O'Donoghue & Candès 2015). As each uses what the ones before it found, so many sweeps come as far
/// as twice as many steps along gradients, and where little is moved, as by a blow, as ten times as many.
pub(super) fn accelerate(
    motions: &mut [DVec2],
    inverse_masses: &[f64],
    contacts: &mut [Contact],
    enough: Enough,
) -> usize {
    let mut bodies = bodies(motions, inverse_masses);
    let mut ended: Vec<DVec2> = bodies.iter().map(|body| body.motion).collect();
    let order = by_colours(contacts, motions.len());
    let visit = |&at: &u32| Visit::new(&contacts[at as usize], motions.len(), enough);
    let mut visits: Vec<Visit> = order.iter().map(visit).collect();
    let (mut inertia, mut ahead) = (1.0_f64, 0.0);
    let mut sweeps = 0;
    while sweeps < enough.most_sweeps {
        for (body, ended) in bodies.iter_mut().zip(&mut ended) {
            let motion = body.motion;
            body.motion += (motion - *ended) * ahead;
            *ended = motion;
        }
        let mut sweep = Sweep { ahead, worst: 0.0, along: 0.0 };
        for visit in &mut visits {
            visit.answer(&mut bodies, enough, &mut sweep);
        }
        sweeps += 1;
        if sweep.worst <= 0.0 {
            break;
        }
        let next = 0.5 * inertia * ((inertia * inertia + 4.0).sqrt() - inertia);
        let turns_back = sweep.along > 0.0;
        ahead = if turns_back { 0.0 } else { inertia * (1.0 - inertia) / (inertia * inertia + next) };
        inertia = if turns_back { 1.0 } else { next };
    }
    for (motion, body) in motions.iter_mut().zip(&bodies) {
        *motion = body.motion;
    }
    for (&at, visit) in order.iter().zip(&visits) {
        contacts[at as usize].push = visit.push;
    }
    sweeps
}

/// One sweep over all contacts.
#[derive(Debug, Clone, Copy)]
struct Sweep {
    /// How far ahead of where the last one ended it began, as a part of the way of that.
    ahead: f64,
    /// How much slower or faster than it may any contact's members were found to part, px/s, if more than 0.
    worst: f64,
    /// How far it goes back along the way of the last one.
    along: f64,
}

/// What a contact moves.
#[derive(Debug, Clone, Copy)]
struct Body {
    motion: DVec2,
    inverse_mass: f64,
}

/// The members, and behind them what nothing moves.
fn bodies(motions: &[DVec2], inverse_masses: &[f64]) -> Vec<Body> {
    let member = |(&motion, &inverse_mass): (&DVec2, &f64)| Body { motion, inverse_mass };
    let still = Body { motion: DVec2::ZERO, inverse_mass: 0.0 };
    motions.iter().zip(inverse_masses).map(member).chain(std::iter::once(still)).collect()
}

/// What a sweep has to know of a contact, in one place.
#[derive(Debug, Clone, Copy)]
struct Visit {
    one: u32,
    other: u32,
    normal: DVec2,
    least: f64,
    /// How much slower than `least` its members may part.
    slack: f64,
    /// The push for which they part faster by 1.
    softness: f64,
    push: f64,
    /// What it pushed when the last sweep ended.
    ended: f64,
}

impl Visit {
    fn new(contact: &Contact, still: usize, enough: Enough) -> Self {
        let Contact { one, against, normal, gap, give, push, least, .. } = *contact;
        let other = if let Support::Member(other) = against { other } else { still };
        let slack = enough.slower + enough.closing * gap.max(0.0);
        let (one, other) = (one as u32, other as u32);
        Self { one, other, normal, least, slack, softness: give.recip(), push, ended: push }
    }

    /// Pushes its members, so that they part as fast as they are to.
    #[inline]
    fn answer(&mut self, bodies: &mut [Body], enough: Enough, sweep: &mut Sweep) {
        let (one, other) = (bodies[self.one as usize], bodies[self.other as usize]);
        let spare = (one.motion - other.motion).dot(self.normal) - self.least;
        if self.push == 0.0 && self.ended == 0.0 && spare >= -enough.dead {
            return;
        }
        let begins = self.push + sweep.ahead * (self.push - self.ended);
        let push = greater(0.0, begins - spare * self.softness);
        // Without jumps, which would be foreseen wrongly half of the time.
        let faster = if push == 0.0 { f64::INFINITY } else { enough.faster };
        sweep.worst = greater(sweep.worst, greater(-self.slack - spare, spare - faster));
        sweep.along += (begins - push) * (push - self.push);
        (self.ended, self.push) = (self.push, push);
        let given = self.normal * (push - begins);
        bodies[self.one as usize].motion = one.motion + given * one.inverse_mass;
        bodies[self.other as usize].motion = other.motion - given * other.inverse_mass;
    }
}

/// The contacts in an order in which those that have a member in common do not follow each other, but those of one colour do: none of
/// these needs what another one of them has found, and momentum from sweep to sweep leads on in no order of places.
fn by_colours(contacts: &[Contact], members: usize) -> Vec<u32> {
    let mut taken = vec![0_u32; members];
    let colour = |contact: &Contact| {
        let both = contact.pushed().fold(0, |both, (member, _)| both | taken[member]);
        // What has more contacts than there are colours has several of the last one.
        let colour = both.trailing_ones().min(u32::BITS - 1);
        contact.pushed().for_each(|(member, _)| taken[member] |= 1 << colour);
        colour
    };
    let colours: Vec<u32> = contacts.iter().map(colour).collect();
    let mut order: Vec<u32> = (0..contacts.len() as u32).collect();
    order.sort_by_key(|&at| colours[at as usize]);
    order
}

#[cfg(test)]
mod tests {
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
        let enough = Enough { slower: 1e-6, closing: 0.0, faster: 1e-6, dead: 0.0, most_sweeps: 20_000 };
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
        let closing = Enough { slower: 0.0, closing: 2.0, faster: 0.0, dead: 2e-3, most_sweeps: 100 };
        let (mut velocities, mut left) = (slow.clone(), contacts.clone());
        assert_eq!(accelerate(&mut velocities, &inverse_masses, &mut left, closing), 1);
        assert!(left.iter().all(|contact| contact.push == 0.0));
        assert_eq!(velocities, slow);
        let at_once = Enough { closing: 0.0, dead: 0.0, ..closing };
        assert!(accelerate(&mut velocities, &inverse_masses, &mut left, at_once) > 1);
        assert!(left.iter().any(|contact| contact.push > 0.0));
    }
}
