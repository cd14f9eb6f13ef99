//! What holds balls gives them no energy.
//!
//! A ball may count as heavier than it is where it is held (`weights`), what is let go of keeps what it was given, and what
//! pressed in the last substep may press on nothing in this one: each of these may be energy from nowhere. So may what takes
//! balls out of each other that were put there (`parting`); and, without gravity, what holds a ball that comes from far away: it
//! is held by where it will be, which may ask for more speed than is taken away again. So where there are such balls, those
//! that become faster by what holds them take together no more than it takes from others. Where nothing carries any, they keep
//! their momentum: those that hold each other move against each other with no more energy than they would. Impacts see to
//! their own energy. Where something carries balls, all share one account: which of them it carries is not looked for.

use glam::DVec2;

use super::common::mean;
use super::fates::Shift;
use super::islands::islands;
use super::sleep::Rest;
use super::{Body, Contact};

impl Contact {
    /// Notes how balls would move without what holds them, after their impacts, where that may give them energy.
    pub(super) fn note_unheld(&mut self) {
        let Self { setting, bodies, near: Some(near), course, parting, unheld, .. } = self else { return };
        let far = || course.fates.iter().any(|fate| fate.shift == Shift::Far);
        unheld.clear();
        let falls = || setting.kick != DVec2::ZERO && !setting.is_grounded();
        if near.weights.differ || parting.goes_on() || falls() || (setting.kick == DVec2::ZERO && far()) {
            unheld.extend(bodies.iter().map(|body| body.free));
        }
    }

    /// Slows those that have gained energy by what holds them, where they have gained more than others have lost.
    pub(super) fn keep_energy(&mut self) {
        let Self { setting, bodies, rests, near: Some(near), unheld, .. } = self else { return };
        if unheld.is_empty() {
            return;
        }
        if setting.is_grounded() {
            keep_of_all(bodies, rests, unheld, setting.kick);
        } else {
            let mut pairs = near.holding().map(|(first, second, _)| (first, second)).peekable();
            if pairs.peek().is_none() {
                // Each falls by itself: no islands need to be looked for.
                return;
            }
            for island in islands(bodies.len(), pairs) {
                keep_of_island(bodies, rests, unheld, &island);
            }
        }
    }
}

/// Slows those of all balls that have gained energy.
fn keep_of_all(bodies: &mut [Body], rests: &[Rest], unheld: &[DVec2], kick: DVec2) {
    let change = |body: &Body, &unheld: &DVec2| energy(body.velocity, kick) - energy(unheld, kick);
    let (mut gained, mut lost) = (0.0, 0.0);
    for ((body, rest), unheld) in bodies.iter().zip(rests).zip(unheld).filter(|((_, rest), _)| rest.own > 0.0)
    {
        // With what they weigh, whatever they count with.
        let change = change(body, unheld) / rest.own;
        *(if change > 0.0 { &mut gained } else { &mut lost }) += change.abs();
    }
    if gained <= lost {
        return;
    }
    for (body, unheld) in bodies.iter_mut().zip(unheld) {
        let change = change(body, unheld);
        if change > 0.0 {
            let kept = energy(*unheld, kick) + change * (lost / gained);
            slow(body, body.velocity * (speed_of(kept, body.velocity, kick) - 1.0));
        }
    }
}

/// Slows balls that hold each other against what they all have in common.
fn keep_of_island(bodies: &mut [Body], rests: &[Rest], unheld: &[DVec2], island: &[usize]) {
    let (_, before) = motion(island, rests, |at| unheld[at]);
    let (common, energy) = motion(island, rests, |at| bodies[at].velocity);
    if energy > before {
        let kept = (before / energy).sqrt();
        for &at in island {
            let body = &mut bodies[at];
            slow(body, (body.velocity - common) * (kept - 1.0));
        }
    }
}

/// The velocity that balls have in common, and twice the energy of their motion against that.
fn motion(balls: &[usize], rests: &[Rest], velocity: impl Fn(usize) -> DVec2) -> (DVec2, f64) {
    let weighed = || balls.iter().map(|&at| (rests[at].own.recip(), velocity(at)));
    let common = mean(weighed());
    (common, weighed().map(|(own, velocity)| own * velocity.distance_squared(common)).sum())
}

/// Changes a ball's velocity as if an impact had: what holds it goes on.
fn slow(body: &mut Body, change: DVec2) {
    body.velocity += change;
    body.free += change;
}

/// Twice the energy, for its mass, that a ball has with this velocity, which gravity's kick has changed already: its height has
/// not followed yet. So what only falls keeps its energy, and so does what is kept from falling.
fn energy(velocity: DVec2, kick: DVec2) -> f64 {
    velocity.length_squared() - velocity.dot(kick)
}

/// The part of its velocity with which a ball has an energy, which is less than it has; that with the least where none has so
/// little, and all of it where it stands still.
fn speed_of(energy: f64, velocity: DVec2, kick: DVec2) -> f64 {
    let (square, along) = (velocity.length_squared(), velocity.dot(kick));
    let root = (along * along + 4.0 * square * energy).max(0.0).sqrt();
    if square > 0.0 { ((along + root) / (2.0 * square)).clamp(0.0, 1.0) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::super::super::ball::Ball;
    use super::super::super::world::{Pairs, World};
    use super::super::{Body, Tuning};
    use super::*;

    /// A heavy ball, a light one and a fixed one, which do not touch.
    fn unlike() -> Contact {
        let world = World::new(DVec2::splat(400.0)).unwrap().with_gravity(DVec2::new(0.0, 980.0)).unwrap();
        let ball =
            |x: f64, mass: f64| Ball::new(DVec2::new(x, 100.0), 10.0).unwrap().with_mass(mass).unwrap();
        let balls = [ball(100.0, 1e4), ball(200.0, 1.0), ball(300.0, 1.0).fixed()];
        let tuning = Tuning { rest_speed: 1.0, substeps: None, sleep: true, threads: 1 };
        let mut contact = Contact::new(&world.with_pairs(Pairs::Impulse), &balls, tuning);
        contact.find();
        contact
    }

    /// Which body the ball of this index is.
    fn at(contact: &Contact, index: u32) -> usize {
        contact.ids.iter().position(|&id| id == index).unwrap()
    }

    #[test]
    fn those_that_gain_take_no_more_than_others_lose() {
        let mut contact = unlike();
        let (heavy, light) = (at(&contact, 0), at(&contact, 1));
        contact.bodies[light].free = DVec2::new(30.0, 40.0);
        contact.bodies[heavy].free = DVec2::ZERO;
        contact.note_unheld();
        contact.bodies[light].velocity = DVec2::new(0.0, -30.0);
        contact.bodies[heavy].velocity = DVec2::new(100.0, 0.0);
        contact.bodies[heavy].free = DVec2::new(60.0, 0.0);
        contact.keep_energy();
        // The light one has lost 50² - 30², and will be higher than it would have been.
        let speed = ((1600.0 - 70.0 * contact.setting.kick.y) / 1e4).sqrt();
        let Body { velocity, free, .. } = contact.bodies[heavy];
        assert!((velocity - DVec2::new(speed, 0.0)).length() < 1e-12, "{velocity}");
        assert!((velocity - free - DVec2::new(40.0, 0.0)).length() < 1e-12, "what holds it goes on");
        assert_eq!(contact.bodies[light].velocity, DVec2::new(0.0, -30.0));
    }

    #[test]
    fn what_is_kept_from_falling_gives_no_energy_to_others() {
        let mut contact = unlike();
        let (heavy, light) = (at(&contact, 0), at(&contact, 1));
        for body in &mut contact.bodies {
            body.free = body.velocity + contact.setting.kick;
        }
        contact.note_unheld();
        contact.bodies[heavy].velocity = DVec2::ZERO;
        contact.bodies[light].velocity = DVec2::new(100.0, 0.0);
        contact.keep_energy();
        assert_eq!(contact.bodies[light].velocity, DVec2::ZERO);
    }

    #[test]
    fn what_is_lost_may_be_gained() {
        let mut contact = unlike();
        let (heavy, light) = (at(&contact, 0), at(&contact, 1));
        contact.bodies[heavy].free = DVec2::new(3.0, 0.0);
        contact.note_unheld();
        contact.bodies[heavy].velocity = DVec2::ZERO;
        contact.bodies[light].velocity = DVec2::new(0.0, 299.0);
        contact.keep_energy();
        assert_eq!(contact.bodies[light].velocity, DVec2::new(0.0, 299.0));
    }
}
