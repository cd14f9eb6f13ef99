//! What holds balls that press on each other and on walls: impulses without restitution, never negative, that leave no
//! pair closer than touching at the end of the substep.
//!
//! They are found by projected Gauss–Seidel sweeps (Cottle, Pang & Stone 1992), one against gravity and one back, and
//! more where these have not settled. The first starts from the impulses of the last substep. An impulse gives way a
//! little, so that overlaps follow loads, as springs would have it (soft constraints; Catto 2011): without that, a pile
//! of rigid balls without friction never comes to rest. What moves balls out of overlaps is no speed of theirs: it is
//! taken away after the move. Where many were hit, they are held apart once more after they were stopped on what carries
//! them (`carry`).

use std::ops::Range;

use glam::DVec2;

use super::super::lesser::lesser;
use super::amount::Amount;
use super::constraints::{Constraint, Pair};
use super::energy::Keeping;
use super::layout::Layer;
use super::near::Near;
use super::prepare::on_fixed;
use super::stripes::Stripe;
use super::sweep::{Pass, Share};
use super::unlike::Unlike;
use super::wall_support::{hold_on_walls, lay_on_walls, let_off_walls, relax_on_walls};
use super::{Body, Contact, Setting};

/// The part of slow sliding of balls that press on each other that is taken away in a substep.
const DAMPED: f64 = 0.1;
/// Sweeps there and back in a substep, at most. Three let piles of thousands come to rest sooner than one or eight.
const ROUNDS: u32 = 3;
/// The same where few balls press, and a crash is followed to its end, and so is what a steep wedge bears, a flat arch, or a tube
/// of unlike balls: sweeps find that slowly, and what is missing would be stored in overlaps, and given back as speed.
const ROUNDS_OF_FEW: u32 = 300;
/// The same where few pairs of many like balls press, since the others fly, or sleep: what is squeezed between sleepers, which do not
/// give way, is given more in each sweep, without end, and that would shoot away what it wakes.
const ROUNDS_AMONG_SLEEPERS: u32 = 40;
/// So many pairs are few.
const PAIRS_AMONG_SLEEPERS: usize = 120;
/// The same of more balls whose masses differ, so that heavy balls come through light ones, and light ones come to rest beside
/// heavy ones: with 50, more of them are squeezed out with speed from nowhere ...
const ROUNDS_OF_MIXED: u32 = 16;
/// ... or fewer, down to [`ROUNDS`], where these would hold more than so many pairs in all: thousands stay in real time.
const PAIRS_OF_MIXED: usize = 100_000;
/// Among some balls there are more rounds, too, ...
const ROUNDS_OF_SOME: u32 = 128;
/// ... and sweeps have not settled either where a change is more than so many kicks of gravity: among small balls, large ones may
/// wedge each other in.
const FAST: f64 = 2.0;
/// Without gravity nothing presses, and what was hit as often as it may be is stopped by sweeps alone, a crowd of unlike masses by
/// hundreds: as many as look at no more than so many pairs in all. With one, such crowds stand still, and keep their speed.
const PAIRS_WITHOUT_GRAVITY: usize = 400_000;
/// Where impacts shifted more than one in so many balls, they are held apart once more after they were stopped.
const MANY: usize = 64;
/// Sweeps have settled where none of their changes moves a ball by more than this part of its radius in the substep.
const SETTLED: f64 = 5e-3;
/// The same where masses differ, or few of many balls are awake.
const SETTLED_OF_MIXED: f64 = 1e-3;
/// Among few balls, the same of all that sweeps would change yet, if each changes as much less than the one before as the last
/// one did ...
const SETTLED_OF_FEW: f64 = 2e-4;
/// ... and no more than so many kicks of gravity.
const FAST_OF_FEW: f64 = 0.5;
/// The first sweep there and back is taken to change this part of what one before it had.
const FIRST_DECAY: f64 = 0.9;

/// What sweeps that have settled may change speeds by.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tolerance {
    /// In radii, or sums of two, a second.
    part: f64,
    /// At most, px/s.
    speed: f64,
}

impl Tolerance {
    /// Where nobody asks.
    const NONE: Self = Self { part: f64::INFINITY, speed: f64::INFINITY };

    /// What that is for a radius, or for two in all.
    #[inline]
    pub(super) fn of(self, reach: f64) -> f64 {
        lesser(self.speed, self.part * reach)
    }
}

/// How pairs of a kind are held.
#[derive(Debug, Clone, Copy)]
struct Sweeps {
    /// How many sweeps there and back there are at most.
    rounds: u32,
    /// What a sweep may change where they have settled.
    enough: Tolerance,
    /// What is left of an impulse that gives way.
    left: f64,
}

/// How what presses is held.
struct Holding {
    /// By how unlike its balls are.
    sweeps: [Sweeps; Unlike::KINDS],
    /// Whether they are followed to their end: all that they would change yet counts.
    to_the_end: bool,
}

impl Contact {
    /// Holds what presses.
    pub(super) fn support(&mut self) {
        let holding = self.holding();
        let Holding { sweeps, to_the_end } = holding;
        self.setting.to_the_end = to_the_end.then_some(sweeps[0].enough);
        let note = if self.setting.keeping == Keeping::Nothing { Pass::NOTHING } else { Pass::NOTE_UNHELD };
        let unsettled = |near: &Near| near.stripes.iter().any(|stripe| stripe.unsettled);
        let rounds = sweeps.iter().map(|of| of.rounds).max().unwrap_or_default();
        for round in 0..rounds {
            let inward = |setting: &Setting, stripe: &mut Stripe, share: &mut Share<'_>| {
                stripe.hold_inward(setting, share.bodies, &holding, round);
            };
            let outward = |setting: &Setting, stripe: &mut Stripe, share: &mut Share<'_>| {
                stripe.hold_outward(setting, share.bodies, &holding, round);
            };
            let inward = Pass { layers: Layer::INWARD, only_busy: true, work: &inward };
            if round == 0 {
                self.sweep(&[note, Pass::WARM_START, inward]);
            } else if self.near.as_ref().is_some_and(unsettled) {
                self.sweep(&[Pass { layers: Layer::OUTWARD, only_busy: true, work: &outward }, inward]);
            } else {
                break;
            }
        }
        if let Some(near) = &mut self.near {
            near.touched = near.stripes.iter().map(|stripe| stripe.touching.len()).sum();
            let like: usize = near.stripes.iter().map(|stripe| stripe.ends[0]).sum();
            near.touched_unlike = near.touched - like;
        }
    }

    /// Takes the velocities away that moved balls out of overlaps: of many in one sweep; where few press, among sleepers, in as many as
    /// hold them. One that slides into a flat wedge between two sleepers is moved out of it many times as fast as these push it.
    pub(super) fn relaxing(&self) -> impl Iterator<Item = Pass<'static>> + use<> {
        let touched = self.near.as_ref().map_or(0, |near| near.touched);
        let few_press = (1..=PAIRS_AMONG_SLEEPERS).contains(&touched) && self.asleep > 0;
        let follows = few_press && self.setting.kick != DVec2::ZERO && self.setting.amount > Amount::Few;
        let again = if follows { ROUNDS_AMONG_SLEEPERS as usize } else { 0 };
        let more = std::iter::repeat_n([Pass::RELAX_AGAIN, Pass::RELAX_ON_WALLS], again);
        [Pass::RELAX, Pass::RELAX_ON_WALLS].into_iter().chain(more.flatten())
    }

    /// What suits what presses.
    fn holding(&self) -> Holding {
        let Setting { kick, substep, softness, unlike, amount, .. } = self.setting;
        let few = amount == Amount::Few;
        let enough = |settled: f64, fast: f64| Tolerance { part: settled / substep, speed: fast };
        let usual = |kind| Sweeps {
            rounds: ROUNDS,
            enough: enough(SETTLED, f64::INFINITY),
            left: softness.yielding(kind),
        };
        let firm = enough(SETTLED_OF_MIXED, f64::INFINITY);
        let one = |kind| Sweeps { rounds: 1, ..usual(kind) };
        let affordable = |pairs: usize, touched: usize| (pairs / touched.max(1)) as u32;
        let sweeps = match self.near.as_ref() {
            // It does not settle before there is room again.
            Some(near) if near.crowd => Unlike::ALL.map(one),
            near if kick == DVec2::ZERO => {
                // None is known to touch in the first one.
                let pairs = |near: &Near| near.stripes.iter().map(|stripe| stripe.pairs.len()).sum();
                let touched =
                    near.map_or(0, |near| if near.touched > 0 { near.touched } else { pairs(near) });
                let rounds = affordable(PAIRS_WITHOUT_GRAVITY, touched).clamp(1, ROUNDS_OF_FEW);
                Unlike::ALL.map(|kind| Sweeps { rounds, enough: firm, ..usual(kind) })
            }
            _ if few && !unlike.differs() => {
                let enough = enough(SETTLED_OF_FEW, FAST_OF_FEW * kick.length());
                let sweeps = Unlike::ALL.map(|kind| Sweeps { rounds: ROUNDS_OF_FEW, enough, ..usual(kind) });
                return Holding { sweeps, to_the_end: true };
            }
            Some(near) if few || near.touched <= PAIRS_AMONG_SLEEPERS => Unlike::ALL.map(|kind| {
                let left = if few { softness.yielding(kind) } else { softness.yielding_of_few(kind) };
                let rounds = if kind.differs() { ROUNDS_OF_FEW } else { ROUNDS_AMONG_SLEEPERS };
                Sweeps { rounds, enough: firm, left }
            }),
            near => Unlike::ALL.map(|kind| {
                if kind.differs() {
                    let touched = near.map_or(0, |near| near.touched_unlike);
                    // What flies weighs what it does: sweeps alone have to carry heavy balls through light ones.
                    let most = if self.setting.grounded { ROUNDS_OF_MIXED } else { ROUNDS_OF_FEW };
                    let rounds = affordable(PAIRS_OF_MIXED, touched).clamp(ROUNDS, most);
                    Sweeps { rounds, enough: firm, ..usual(kind) }
                } else if amount <= Amount::Some {
                    let enough = enough(SETTLED, FAST * kick.length());
                    Sweeps { rounds: ROUNDS_OF_SOME, enough, ..usual(kind) }
                } else {
                    usual(kind)
                }
            }),
        };
        Holding { sweeps, to_the_end: false }
    }
}

impl Holding {
    /// How each kind is held that still is in this round, and the stripe has any of: like balls always are in the first ones.
    fn of(&self, stripe: &Stripe, round: u32) -> impl DoubleEndedIterator<Item = (Unlike, Sweeps)> + use<> {
        let kinds = Unlike::ALL.into_iter().zip(self.sweeps);
        let counts = Unlike::ALL.map(|kind| stripe.touching_of(kind).len());
        kinds.filter(move |&(kind, of)| round < of.rounds && (counts[kind as usize] > 0 || !kind.differs()))
    }
}

impl Stripe {
    /// One sweep with gravity, unless it has settled.
    fn hold_inward(&mut self, setting: &Setting, bodies: &mut [Body], holding: &Holding, round: u32) {
        // Stripes that have settled are left as they are.
        if !std::mem::take(&mut self.unsettled) {
            return;
        }
        if holding.to_the_end {
            // All are alike then.
            let Sweeps { enough, left, .. } = holding.sweeps[0];
            let pressed = self.measure_inward(bodies, left, enough);
            let change = pressed.max(hold_on_walls(setting, bodies, &mut self.beside, enough));
            let before = std::mem::replace(&mut self.changed, change);
            self.unsettled = goes_on(change, before);
            return;
        }
        // No more than that is asked for, and a quotient for each pair would cost.
        let (mut pressed, mut least) = (false, None);
        for (kind, Sweeps { enough, left, .. }) in holding.of(self, round).rev() {
            self.solve_inward(bodies, kind, left, |speed, [one, other]| {
                pressed |= speed > enough.of(one + other);
            });
            least = least.or(Some(enough));
        }
        let Some(least) = least else { return };
        self.unsettled = hold_on_walls(setting, bodies, &mut self.beside, least) > 1.0 || pressed;
    }

    /// One sweep back.
    fn hold_outward(&mut self, setting: &Setting, bodies: &mut [Body], holding: &Holding, round: u32) {
        if !self.unsettled {
            return;
        }
        hold_on_walls(setting, bodies, &mut self.beside, Tolerance::NONE);
        for (kind, Sweeps { left, .. }) in holding.of(self, round) {
            self.solve_outward(bodies, kind, left);
        }
    }
}

/// Whether sweeps that changed so much, and so much `before`, will change more than is enough yet, which is 1: as a geometric
/// series (Aitken 1926).
fn goes_on(change: f64, before: f64) -> bool {
    let decay = if before.is_finite() { change / before } else { FIRST_DECAY };
    // Not where nothing changes any more.
    change * decay > 1.0 - decay
}

impl Pass<'_> {
    /// Begins with what held balls in the last substep (warm starting).
    const WARM_START: Self = Self {
        layers: Layer::OUTWARD,
        only_busy: true,
        work: &|setting, stripe, share| {
            if setting.kick == DVec2::ZERO {
                stripe.forget();
            }
            lay_on_walls(share.fates, &mut stripe.beside);
            if setting.to_the_end.is_some() {
                stripe.apart.give_again(&mut stripe.constraints, share.bodies, share.fates);
            } else {
                stripe.apart.clear();
            }
            hold_on_walls(setting, share.bodies, &mut stripe.beside, Tolerance::NONE);
            stripe.prepare_all(setting, share);
            (stripe.unsettled, stripe.changed) = (true, f64::INFINITY);
        },
    };

    /// Takes back what walls gave those that leave them.
    pub(super) const LET_OFF_WALLS: Self = Self {
        layers: &[Layer::Own],
        only_busy: true,
        work: &|setting, stripe, share| let_off_walls(setting, share.bodies, &mut stripe.beside),
    };

    /// Holds balls apart once more where many were hit: what stopped some on what carries them has turned them against
    /// others, and those that are beside or above them are to give way at once, not in the next substep.
    pub(super) const HOLD_AGAIN: Self = Self {
        layers: Layer::OUTWARD,
        only_busy: true,
        work: &|setting, stripe, share| {
            if stripe.is_shaken(share.bodies.len()) {
                for kind in Unlike::ALL {
                    stripe.solve_outward(share.bodies, kind, setting.softness.yielding(kind));
                }
                hold_on_walls(setting, share.bodies, &mut stripe.beside, Tolerance::NONE);
            }
        },
    };

    /// Takes the velocities away that moved balls out of overlaps.
    pub(super) const RELAX: Self = Self {
        layers: Layer::OUTWARD,
        only_busy: true,
        work: &|setting, stripe, share| stripe.relax_all(setting, share),
    };

    /// Once more: what is left of them.
    const RELAX_AGAIN: Self = Self {
        layers: Layer::OUTWARD,
        only_busy: true,
        work: &|_, stripe, share| {
            let Stripe { constraints, touching, .. } = stripe;
            each(constraints, touching.iter(), share.bodies, |constraint, first, second| {
                solve(constraint, first, second, 1.0);
            });
        },
    };

    /// The same of what walls gave.
    pub(super) const RELAX_ON_WALLS: Self = Self {
        layers: &[Layer::Own],
        only_busy: true,
        work: &|_, stripe, share| _ = relax_on_walls(share.bodies, &mut stripe.beside, Tolerance::NONE),
    };
}

impl Near {
    /// Whether impacts have shifted many of any stripe's balls, of so many in all.
    pub(super) fn is_shaken(&self, bodies: usize) -> bool {
        self.stripes
            .iter()
            .enumerate()
            .any(|(number, stripe)| stripe.is_shaken(self.layout.count(number, bodies)))
    }
}

impl Stripe {
    /// Whether impacts have shifted many of so many balls.
    fn is_shaken(&self, bodies: usize) -> bool {
        self.shifted * MANY > bodies
    }

    /// What held balls when they met is of no use any more.
    fn forget(&mut self) {
        for constraint in &mut self.constraints {
            (constraint.impulse, constraint.grip) = (0.0, DVec2::ZERO);
        }
        for beside in &mut self.beside {
            beside.push = DVec2::ZERO;
        }
    }

    /// Takes the velocities away that moved balls out of overlaps, and brakes what slides.
    fn relax_all(&mut self, setting: &Setting, share: &mut Share<'_>) {
        let Self { constraints, touching, apart, .. } = self;
        let Share { bodies, rests, .. } = share;
        let few = setting.amount == Amount::Few;
        if setting.to_the_end.is_some() {
            apart.take_back(constraints, bodies);
        }
        each(constraints, touching.iter(), bodies, |constraint, first, second| {
            constraint.least = lesser(0.0, constraint.least);
            // Across what presses: neither changes the other.
            let sliding = constraint.normal.perp_dot(first.velocity - second.velocity);
            solve(constraint, first, second, 1.0);
            let still = first.inverse_mass == 0.0 || second.inverse_mass == 0.0;
            // Few come to rest without. And else nothing would slide down a slope of fixed balls.
            let glides = few || setting.has_fixed && still && on_fixed(rests, constraint.pair);
            if !glides {
                calm(constraint, first, second, sliding, setting.firm);
            }
        });
        // Only few balls are followed so far, and these are one stripe: there are no others to wait for.
        let Some(enough) = setting.to_the_end else { return };
        let mut before = f64::INFINITY;
        for _ in 1..ROUNDS_OF_FEW {
            let relaxed = relax_on_walls(bodies, &mut self.beside, enough);
            let change = self.measure_inward(bodies, 1.0, enough).max(relaxed);
            if !goes_on(change, std::mem::replace(&mut before, change)) {
                break;
            }
        }
        self.apart.note_relaxed(&self.constraints);
    }

    /// The pairs of a kind that touch, among those that do.
    #[inline]
    fn touching_of(&self, kind: Unlike) -> Range<usize> {
        let kind = kind as usize;
        (if kind == 0 { 0 } else { self.ends[kind - 1] })..self.ends[kind]
    }

    /// Holds all pairs of a kind apart that touch, one after the other with gravity, and tells by how much that changes the speed
    /// at which each parts, px/s, and its radii.
    #[inline]
    fn solve_inward(
        &mut self,
        bodies: &mut [Body],
        kind: Unlike,
        left: f64,
        mut tell: impl FnMut(f64, [f64; 2]),
    ) {
        let range = self.touching_of(kind);
        let Self { constraints, touching, .. } = self;
        each(constraints, touching[range].iter().rev(), bodies, |constraint, first, second| {
            let change = solve(constraint, first, second, left).abs();
            tell(change * (first.inverse_mass + second.inverse_mass), [first.radius, second.radius]);
        });
    }

    /// The same of like balls. The most that changes, in times what is enough.
    fn measure_inward(&mut self, bodies: &mut [Body], left: f64, enough: Tolerance) -> f64 {
        let mut most = 0.0_f64;
        self.solve_inward(bodies, Unlike::Nothing, left, |speed, [one, other]| {
            // By the smaller: on a large one, fixed or not, it would be left to wander.
            most = most.max(speed / enough.of(2.0 * lesser(one, other)));
        });
        most
    }

    /// Holds all pairs of a kind apart that touch, one after the other against gravity.
    fn solve_outward(&mut self, bodies: &mut [Body], kind: Unlike, left: f64) {
        let range = self.touching_of(kind);
        let Self { constraints, touching, .. } = self;
        each(constraints, touching[range].iter(), bodies, |constraint, first, second| {
            solve(constraint, first, second, left);
        });
    }
}

/// Works on the constraints at these places.
#[inline]
fn each<'a>(
    constraints: &mut [Constraint],
    places: impl Iterator<Item = &'a u32>,
    bodies: &mut [Body],
    mut work: impl FnMut(&mut Constraint, &mut Body, &mut Body),
) {
    for &place in places {
        let constraint = &mut constraints[place as usize];
        let (first, second) = two(bodies, constraint.pair);
        // A copy is kept in registers: what is written in parts and read as a whole makes a processor wait.
        let mut copy = *constraint;
        work(&mut copy, first, second);
        (constraint.least, constraint.impulse) = (copy.least, copy.impulse);
    }
}

/// Takes a part of the speed away with which two balls that press on each other slide along each other, where that is
/// slow.
#[inline]
fn calm(constraint: &Constraint, first: &mut Body, second: &mut Body, sliding: f64, slow: f64) {
    let braked = if constraint.impulse > 0.0 && sliding.abs() < slow { sliding } else { 0.0 };
    let change = constraint.normal.perp() * (braked * DAMPED * constraint.mass);
    for (body, change) in [(first, -change), (second, change)] {
        body.velocity += change * body.inverse_mass;
        body.free += change * body.inverse_mass;
    }
}

/// Brings a pair's impulse to where both part with the least velocity, or to 0. Of a soft one only a part is `left`, so
/// that what they overlap by, in the end, follows what they carry. The impulse's change.
#[inline]
pub(super) fn solve(constraint: &mut Constraint, first: &mut Body, second: &mut Body, left: f64) -> f64 {
    // What needs no velocity is found first: pairs wait for each other's.
    let wanted = left * (constraint.impulse + constraint.least * constraint.mass);
    let (one, other) = (constraint.normal * first.inverse_mass, constraint.normal * second.inverse_mass);
    let parting = (first.velocity - second.velocity).dot(constraint.normal);
    let impulse = (wanted - parting * (left * constraint.mass)).max(0.0);
    let change = impulse - constraint.impulse;
    constraint.impulse = impulse;
    first.velocity += one * change;
    second.velocity -= other * change;
    change
}

/// Gives the first of two balls an impulse, and the second its opposite.
#[inline]
pub(super) fn give(impulse: DVec2, first: &mut Body, second: &mut Body) {
    first.velocity += impulse * first.inverse_mass;
    second.velocity -= impulse * second.inverse_mass;
}

/// Both bodies of a pair.
#[inline]
pub(super) fn two(bodies: &mut [Body], pair: Pair) -> (&mut Body, &mut Body) {
    let both = bodies.get_disjoint_mut([pair.first as usize, pair.second as usize]);
    let [first, second] = both.expect("a pair is of two balls");
    (first, second)
}
