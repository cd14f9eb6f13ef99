//! What holds balls gives them no energy.
//!
//! A ball may count as heavier than it is where it is held (`weights`), what is let go of keeps what it was given, what
//! pressed in the last substep may press on nothing in this one, and overlaps store what sweeps miss in a crash: each of these
//! may be energy from nowhere. So may what takes balls out of each other that were put there (`parting`); and, without gravity,
//! what holds a ball that comes from far away: it is held by where it will be, which may ask for more speed than is taken away
//! again. So those that become faster by what holds them take together no more than it takes from others. Where nothing
//! carries any, they keep their momentum: those that hold each other move against each other with no more energy than they
//! would. Impacts see to their own energy. Where something carries balls, all share one account: which of them it carries is
//! not looked for. What is moved off a wall along which it is squeezed (`rows`) is none of it.

use glam::DVec2;

use super::super::lesser::lesser;
use super::common::mean;
use super::fates::Shift;
use super::islands::islands;
use super::layout::Layer;
use super::sleep::Rest;
use super::stripes::{Stripe, of_layer};
use super::sweep::{Pass, Share};
use super::unlike::Unlike;
use super::{Body, Contact, Setting};

/// How energy is kept in a substep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Keeping {
    /// Nothing can gain any.
    Nothing,
    /// What a ball gains counts as far as it is more than half a kick of gravity has: a held one has one velocity all through a
    /// substep, what flies that in the middle of it. And slowed as often as it jitters, a flat arch would wind up until it breaks.
    Loosely,
    /// All of it does, as it always does of unlike ones: those that are pressed out of each other may gain much by little, too.
    Strictly,
}

/// What a stripe's balls gain and lose by what holds them.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Account {
    gained: f64,
    lost: f64,
}

impl Contact {
    /// Finds out how energy is to be kept in this substep, after its impacts.
    pub(super) fn find_keeping(&mut self) {
        let Self { setting, substeps, near: Some(_), course, parting, .. } = self else { return };
        let far = || course.fates.iter().any(|fate| fate.shift == Shift::Far);
        let falls = || setting.kick != DVec2::ZERO && !(setting.grounded && substeps.are_at_rest());
        setting.keeping = if parting.goes_on() {
            Keeping::Strictly
        } else if setting.unlike.differs() || falls() || far() {
            Keeping::Loosely
        } else {
            Keeping::Nothing
        };
    }

    /// Slows those that have gained energy by what holds them, where they have gained more than others have lost.
    pub(super) fn keep_energy(&mut self) {
        let Self { setting, bodies, rests, near: Some(near), .. } = self else { return };
        if setting.keeping == Keeping::Nothing {
            return;
        }
        if setting.grounded {
            let (mut gained, mut lost) = (0.0, 0.0);
            for Stripe { account, .. } in of_layer(&mut near.stripes, near.layout, Layer::Own) {
                gained += account.gained;
                lost += account.lost;
            }
            if gained > lost {
                let slow = |setting: &Setting, stripe: &mut Stripe, share: &mut Share<'_>| {
                    stripe.slow_gaining(setting, share, lost / gained);
                };
                self.sweep(&[Pass { layers: &[Layer::Own], only_busy: false, work: &slow }]);
            }
            return;
        }
        let mut pairs = near.holding().map(|(first, second, _)| (first, second)).peekable();
        if pairs.peek().is_none() {
            // Each falls by itself: no islands need to be looked for.
            return;
        }
        let unheld = |at| {
            let (stripe, place) = near.layout.place_of(at);
            near.stripes[stripe].unheld[place as usize]
        };
        for island in islands(bodies.len(), pairs) {
            keep_of_island(bodies, rests, unheld, &island);
        }
    }
}

impl Pass<'_> {
    /// Notes how balls would move without what holds them.
    pub(super) const NOTE_UNHELD: Self = Self {
        layers: &[Layer::Own],
        only_busy: false,
        work: &|setting, Stripe { unheld, unheld_energies, .. }, Share { bodies, .. }| {
            unheld.clear();
            unheld_energies.clear();
            if setting.grounded {
                unheld_energies.extend(bodies.iter().map(|body| energy(body.free, setting.kick)));
            } else {
                unheld.extend(bodies.iter().map(|body| body.free));
            }
        },
    };

    /// Adds up what they gain by it, and lose.
    pub(super) const ADD_UP: Self = Self {
        layers: &[Layer::Own],
        only_busy: false,
        work: &|setting, Stripe { unheld_energies, account, .. }, Share { bodies, rests, .. }| {
            *account = Account::default();
            for ((body, rest), &before) in bodies.iter().zip(*rests).zip(&*unheld_energies) {
                // What sleeps gains nothing: most of a pile, or none.
                if body.inverse_mass == 0.0 {
                    continue;
                }
                // With what it weighs, whatever it counts with. No branch: what comes of each is a toss.
                let (own, spare) = if setting.unlike.differs() {
                    (rest.own, setting.spare(rest.unlike))
                } else {
                    (body.inverse_mass, setting.spare(Unlike::Nothing))
                };
                let mass = own.recip();
                let (gained, lost) = gain(setting.kick, body, spare, before);
                account.gained += gained * mass;
                account.lost += lost * mass;
            }
        },
    };
}

impl Stripe {
    /// Leaves those that have gained energy by what holds them only a part of that.
    fn slow_gaining(&self, setting: &Setting, share: &mut Share<'_>, part: f64) {
        let (Setting { kick, .. }, Share { bodies, rests, .. }) = (*setting, share);
        for ((body, rest), &before) in bodies.iter_mut().zip(*rests).zip(&self.unheld_energies) {
            let (gained, _) = gain(kick, body, setting.spare(rest.unlike), before);
            if gained > 0.0 {
                let kept = energy(body.velocity, kick) - (1.0 - part) * gained;
                slow(body, body.velocity * (speed_of(kept, body.velocity, kick) - 1.0));
            }
        }
    }
}

/// Twice the energy, for its mass, that a ball has gained since `before`, beyond what is to `spare`, and that it has lost.
#[inline]
fn gain(kick: DVec2, body: &Body, spare: f64, before: f64) -> (f64, f64) {
    let gain = energy(body.velocity, kick) - before;
    (-lesser(spare - gain, 0.0), -lesser(gain, 0.0))
}

impl Setting {
    /// Twice the energy, for its mass, of which what a ball gains does not count.
    #[inline]
    fn spare(&self, unlike: Unlike) -> f64 {
        if self.keeping == Keeping::Loosely && !unlike.differs() {
            0.25 * self.kick.length_squared()
        } else {
            0.0
        }
    }
}

/// Slows balls that hold each other against what they all have in common.
fn keep_of_island(bodies: &mut [Body], rests: &[Rest], unheld: impl Fn(usize) -> DVec2, island: &[usize]) {
    let (_, before) = motion(island, rests, unheld);
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
    use super::super::Body;
    use super::super::testing::TUNING;
    use super::*;

    /// A heavy ball, a light one and a fixed one, which do not touch.
    fn unlike() -> Contact {
        with_mass(1e4)
    }

    /// The same with a first ball of this mass.
    fn with_mass(mass: f64) -> Contact {
        let world = World::new(DVec2::splat(400.0)).unwrap().with_gravity(DVec2::new(0.0, 980.0)).unwrap();
        let ball =
            |x: f64, mass: f64| Ball::new(DVec2::new(x, 100.0), 10.0).unwrap().with_mass(mass).unwrap();
        let balls = [ball(100.0, mass), ball(200.0, 1.0), ball(300.0, 1.0).fixed()];
        let mut contact = Contact::new(&world.with_pairs(Pairs::Impulse), &balls, TUNING);
        contact.find();
        contact
    }

    fn note_unheld(contact: &mut Contact) {
        contact.find_keeping();
        contact.sweep(&[Pass::NOTE_UNHELD]);
    }

    fn keep_energy(contact: &mut Contact) {
        contact.sweep(&[Pass::ADD_UP]);
        contact.keep_energy();
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
        note_unheld(&mut contact);
        contact.bodies[light].velocity = DVec2::new(0.0, -30.0);
        contact.bodies[heavy].velocity = DVec2::new(100.0, 0.0);
        contact.bodies[heavy].free = DVec2::new(60.0, 0.0);
        keep_energy(&mut contact);
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
        note_unheld(&mut contact);
        contact.bodies[heavy].velocity = DVec2::ZERO;
        contact.bodies[light].velocity = DVec2::new(100.0, 0.0);
        keep_energy(&mut contact);
        assert_eq!(contact.bodies[light].velocity, DVec2::ZERO);
    }

    #[test]
    fn what_is_lost_may_be_gained() {
        let mut contact = unlike();
        let (heavy, light) = (at(&contact, 0), at(&contact, 1));
        contact.bodies[heavy].free = DVec2::new(3.0, 0.0);
        note_unheld(&mut contact);
        contact.bodies[heavy].velocity = DVec2::ZERO;
        contact.bodies[light].velocity = DVec2::new(0.0, 299.0);
        keep_energy(&mut contact);
        assert_eq!(contact.bodies[light].velocity, DVec2::new(0.0, 299.0));
    }

    #[test]
    fn among_like_balls_what_is_gained_counts_beyond_half_a_kick() {
        // Across gravity, in kicks: what a ball is given, and what it keeps.
        for (given, kept) in [(0.4, 0.4), (0.5, 0.5), (1.0, 0.5), (100.0, 0.5)] {
            let mut contact = with_mass(1.0);
            let at = at(&contact, 0);
            let kick = contact.setting.kick.y;
            for body in &mut contact.bodies {
                body.free = DVec2::ZERO;
            }
            note_unheld(&mut contact);
            contact.bodies[at].velocity = DVec2::new(given * kick, 0.0);
            keep_energy(&mut contact);
            let found = contact.bodies[at].velocity.x / kick;
            assert!((found - kept).abs() < 1e-12, "{given}: {found}");
        }
    }
}
