//! What holds balls that press on each other and on walls: impulses without restitution, never negative, that leave no
//! pair closer than touching at the end of the substep.
//!
//! They are found by projected Gauss–Seidel sweeps (Cottle, Pang & Stone 1992), one against gravity and one back, and
//! more where these have not settled. The first starts from the impulses of the last substep. An impulse gives way a
//! little, so that overlaps follow loads, as springs would have it (soft constraints; Catto 2011): without that, a pile
//! of rigid balls without friction never comes to rest. What moves balls out of overlaps is no speed of theirs: it is
//! taken away after the move. Last, each ball is stopped on what lies below it, from the ground up, so that no load, and
//! no ratio of masses, makes anything sink; where substeps are the shortest, what stopped it acts on what lies below in
//! the next. Where many were hit, they are held apart once more after that.

use glam::DVec2;

use super::super::lesser::lesser;
use super::constraints::{Constraint, Pair};
use super::find::{FEW, Near};
use super::layout::Layer;
use super::stripes::Stripe;
use super::substeps::Softness;
use super::sweep::{Pass, Share};
use super::wall_support::{hold_on_walls, lay_on_walls, relax_on_walls};
use super::{Body, Contact, Setting};

/// The part of slow sliding of balls that press on each other that is taken away in a substep.
const DAMPED: f64 = 0.1;
/// Rounds over the pairs of one ball, where each may undo some of what the others did.
const INNER: u32 = 3;

/// Sweeps there and back in a substep, at most. Three let piles of thousands come to rest sooner than one or eight.
const ROUNDS: u32 = 3;
/// The same among few balls, where a crash is followed to its end.
const ROUNDS_OF_FEW: u32 = 32;
/// The same where masses differ, so that heavy balls come through light ones, and light ones come to rest beside heavy ones:
/// with 50, more of them are squeezed out with speed from nowhere ...
const ROUNDS_OF_MIXED: u32 = 16;
/// ... or fewer, down to [`ROUNDS`], where these would hold more than so many pairs in all: thousands stay in real time.
const PAIRS_OF_MIXED: usize = 100_000;
/// What stops a ball on what carries it is passed on to that in the next substep, but by each of their pairs, each time
/// that it is looked at, no more than so many kicks of gravity of twice their effective mass: under heavy ones, light balls
/// would be squeezed out.
const PASSED_ON: f64 = 2.0;
/// Where impacts shifted more than one in so many balls, they are held apart once more after they were stopped.
const MANY: usize = 64;
/// Sweeps have settled where none of their changes moves a ball by more than this part of its radius in the substep.
const SETTLED: f64 = 5e-3;
/// The same among few balls, and where masses differ.
const SETTLED_OF_FEW: f64 = 1e-3;

impl Contact {
    /// Holds what presses.
    pub(super) fn support(&mut self) {
        let few = self.bodies.len() <= FEW;
        let differ = self.near.as_ref().is_some_and(|near| near.weights.differ);
        (self.setting.softness, self.setting.differ) = (self.substeps.softness(differ), differ);
        let Softness { yielding, yielding_of_few, .. } = self.setting.softness;
        let (rounds, settled, left) = match self.near.as_ref() {
            // Nothing presses: overlaps are only moved out of.
            _ if self.setting.kick == DVec2::ZERO => (1, SETTLED, yielding),
            // It does not settle before there is room again.
            Some(near) if near.crowd => (1, SETTLED, yielding),
            _ if few => (ROUNDS_OF_FEW, SETTLED_OF_FEW, yielding),
            // As many as few balls may have: the others fly, or sleep.
            Some(near) if near.touched <= 3 * FEW => (ROUNDS_OF_FEW, SETTLED_OF_FEW, yielding_of_few),
            Some(near) if differ => {
                let affordable = (PAIRS_OF_MIXED / near.touched.max(1)) as u32;
                (affordable.clamp(ROUNDS, ROUNDS_OF_MIXED), SETTLED_OF_FEW, yielding)
            }
            _ => (ROUNDS, SETTLED, yielding),
        };
        let most = settled / self.setting.substep;
        let inward = |setting: &Setting, stripe: &mut Stripe, share: &mut Share<'_>| {
            // Stripes that have settled are left as they are.
            if !std::mem::take(&mut stripe.unsettled) {
                return;
            }
            let pressed = stripe.solve_inward(share.bodies, left, most);
            let held = hold_on_walls(setting, share.bodies, &mut stripe.beside) > most;
            stripe.unsettled = pressed || held;
        };
        let outward = |setting: &Setting, stripe: &mut Stripe, share: &mut Share<'_>| {
            if !stripe.unsettled {
                return;
            }
            hold_on_walls(setting, share.bodies, &mut stripe.beside);
            stripe.solve_outward(share.bodies, left);
        };
        let (inward, outward) =
            (Pass::over_near(Layer::INWARD, &inward), Pass::over_near(Layer::OUTWARD, &outward));
        self.sweep(&[Pass::over_near(Layer::OUTWARD, &prepare), inward]);
        let unsettled = |near: &Near| near.stripes.iter().any(|stripe| stripe.unsettled);
        for _ in 1..rounds {
            if !self.near.as_ref().is_some_and(unsettled) {
                break;
            }
            self.sweep(&[outward, inward]);
        }
        if let Some(near) = &mut self.near {
            near.touched = near.stripes.iter().map(|stripe| stripe.touching.len()).sum();
        }
    }

    /// Whether what stops balls on what carries them is passed on to that. Where it is not, the part of a load that the sweeps
    /// miss is borne by nothing, sideways, too, which holds up slopes. That is left so in longer substeps, where little moves:
    /// it comes to rest. Where all balls are few, the sweeps miss nothing.
    pub(super) fn passes_on(&self) -> bool {
        self.bodies.len() > FEW && self.substeps.are_short()
    }
}

/// Begins with what held a stripe's balls in the last substep (warm starting).
fn prepare(setting: &Setting, stripe: &mut Stripe, share: &mut Share<'_>) {
    if setting.kick == DVec2::ZERO {
        stripe.forget();
    }
    lay_on_walls(setting, share.fates, &mut stripe.beside);
    hold_on_walls(setting, share.bodies, &mut stripe.beside);
    stripe.prepare_all(setting, share);
    stripe.unsettled = true;
}

impl Pass<'_> {
    /// Stops what still sinks on what carries it (shock propagation). Not without gravity: nothing lies on anything.
    pub(super) const CARRY: Self = Self {
        layers: Layer::AROUND,
        only_busy: true,
        work: &|setting, stripe, share| stripe.carry_all::<false>(setting, share.bodies),
    };

    /// The same, where what stops a ball acts on what carries it in the next substep.
    pub(super) const CARRY_AND_PASS_ON: Self = Self {
        layers: Layer::AROUND,
        only_busy: true,
        work: &|setting, stripe, share| stripe.carry_all::<true>(setting, share.bodies),
    };

    /// Holds balls apart once more where many were hit: what stopped some on what carries them has turned them against
    /// others, and those that are beside or above them are to give way at once, not in the next substep.
    pub(super) const HOLD_AGAIN: Self = Self {
        layers: Layer::OUTWARD,
        only_busy: true,
        work: &|setting, stripe, share| {
            if stripe.is_shaken(share.bodies.len()) {
                stripe.solve_outward(share.bodies, setting.softness.yielding);
                hold_on_walls(setting, share.bodies, &mut stripe.beside);
            }
        },
    };

    /// Takes the velocities away that moved balls out of overlaps.
    pub(super) const RELAX: Self = Self {
        layers: Layer::OUTWARD,
        only_busy: true,
        work: &|setting, stripe, share| stripe.relax_all(setting, share.bodies),
    };

    /// The same of what walls gave.
    pub(super) const RELAX_ON_WALLS: Self = Self {
        layers: &[Layer::Own],
        only_busy: true,
        work: &|_, stripe, share| relax_on_walls(share.bodies, &mut stripe.beside),
    };
}

/// Pairs are looked at in hands of so many, in this order: each five places after the one before, around the hand.
const HAND: [usize; 16] = [0, 5, 10, 15, 4, 9, 14, 3, 8, 13, 2, 7, 12, 1, 6, 11];

/// Deals a list of pairs out: in an order in which those that follow each other seldom have a ball in common, as those of
/// an upper ball do. A processor works on a few of them at a time then, where else each waits for the last.
pub(super) fn deal(pairs: &[u32], dealt: &mut Vec<u32>) {
    let (hands, others) = pairs.as_chunks();
    dealt.clear();
    dealt.extend(hands.iter().flat_map(|hand: &[u32; HAND.len()]| HAND.map(|place| hand[place])));
    dealt.extend_from_slice(others);
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

    /// Stops what still sinks, from the ground up.
    fn carry_all<const PASSES_ON: bool>(&mut self, setting: &Setting, bodies: &mut [Body]) {
        let Self { constraints, carrying, uppers, floors, .. } = self;
        let (constraints, carrying) = (&mut constraints[..], &carrying[..]);
        let most = PASSED_ON * setting.kick.length();
        for ends in uppers.windows(2) {
            let its = &carrying[ends[0] as usize..ends[1] as usize];
            let Some(&first) = its.first() else { continue };
            let upper = constraints[first as usize].pair.first as usize;
            match *its {
                // On one it lies as on two that are the same: that takes no branch, which a processor could not foresee.
                [one] | [one, _] => {
                    stop_on::<_, PASSES_ON>(upper, constraints, bodies, most, [one, its[its.len() - 1]]);
                }
                [one, two, three] => {
                    stop_on::<_, PASSES_ON>(upper, constraints, bodies, most, [one, two, three]);
                }
                _ => {
                    floors.clear();
                    floors.extend(its.iter().map(|&at| (Floor::under(constraints, bodies, at), 0.0)));
                    carry(&bodies[upper], floors);
                    let by = its.iter().zip(&*floors).map(|(&at, &(floor, added))| ((at, floor), added));
                    stop::<PASSES_ON>(upper, constraints, bodies, most, by);
                }
            }
        }
    }

    /// Takes the velocities away that moved balls out of overlaps, and brakes what slides.
    fn relax_all(&mut self, setting: &Setting, bodies: &mut [Body]) {
        let Self { constraints, touching, .. } = self;
        each(constraints, touching.iter(), bodies, |constraint, first, second| {
            constraint.least = lesser(0.0, constraint.least);
            // Across what presses: neither changes the other.
            let sliding = constraint.normal.perp_dot(first.velocity - second.velocity);
            solve(constraint, first, second, 1.0);
            calm(constraint, first, second, sliding, setting.firm);
        });
    }

    /// Holds all pairs apart that touch, one after the other with gravity. Whether that moves any ball faster than at
    /// `most` sums of both radii a second.
    fn solve_inward(&mut self, bodies: &mut [Body], left: f64, most: f64) -> bool {
        let Self { constraints, touching, .. } = self;
        let mut moves = false;
        each(constraints, touching.iter().rev(), bodies, |constraint, first, second| {
            let change = solve(constraint, first, second, left).abs();
            let speed = change * (first.inverse_mass + second.inverse_mass);
            moves |= speed > most * (first.radius + second.radius);
        });
        moves
    }

    /// The same against gravity.
    fn solve_outward(&mut self, bodies: &mut [Body], left: f64) {
        let Self { constraints, touching, .. } = self;
        each(constraints, touching.iter(), bodies, |constraint, first, second| {
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

/// What carries a ball: how fast it goes down there, at most.
#[derive(Debug, Clone, Copy)]
pub(super) struct Floor {
    up: DVec2,
    /// px/s along `up`, never more than 0.
    least: f64,
}

impl Floor {
    /// The lower ball of the constraint at this place.
    #[inline]
    fn under(constraints: &[Constraint], bodies: &[Body], at: u32) -> Self {
        let constraint = &constraints[at as usize];
        let (up, lower) = (constraint.normal, &bodies[constraint.pair.second as usize]);
        Self { up, least: (lower.velocity.dot(up) + constraint.least.min(0.0)).min(0.0) }
    }
}

/// Finds how much what carries a ball that still sinks adds to its velocity, so that it stops there as if on firm ground
/// (shock propagation; Guendelman, Bridson & Fedkiw 2003). It only ever slows a ball down.
fn carry(body: &Body, floors: &mut [(Floor, f64)]) {
    let mut velocity = body.velocity;
    for _ in 0..INNER {
        for (floor, added) in &mut *floors {
            let more = (floor.least - velocity.dot(floor.up)).max(0.0);
            *added += more;
            velocity += floor.up * more;
        }
    }
}

/// The same on few. What each adds is a number then, and so is what that changes for the others.
#[inline]
fn carry_on<const FLOORS: usize>(body: &Body, floors: [Floor; FLOORS]) -> [f64; FLOORS] {
    let shared = floors.map(|one| floors.map(|other| one.up.dot(other.up)));
    // How much too fast it goes down on each, and how much each has added.
    let mut lacking = floors.map(|floor| floor.least - body.velocity.dot(floor.up));
    let mut added = [0.0; FLOORS];
    for _ in 0..INNER {
        for this in 0..FLOORS {
            let more = lacking[this].max(0.0);
            added[this] += more;
            for other in 0..FLOORS {
                lacking[other] -= if this == other { more } else { shared[this][other] * more };
            }
        }
    }
    added
}

/// Stops a ball on the few that these constraints are with.
#[inline]
fn stop_on<const FLOORS: usize, const PASSES_ON: bool>(
    upper: usize,
    constraints: &mut [Constraint],
    bodies: &mut [Body],
    most: f64,
    its: [u32; FLOORS],
) {
    let floors = its.map(|at| Floor::under(constraints, bodies, at));
    let added = carry_on(&bodies[upper], floors);
    stop::<PASSES_ON>(upper, constraints, bodies, most, its.into_iter().zip(floors).zip(added));
}

/// Stops a ball by what the floor of each constraint adds to its velocity. Where that is passed on, it holds the ball in the next
/// substep, too, and its opposite then acts on what carries it: up to `most`, px/s, between balls as heavy as each other.
#[inline]
fn stop<const PASSES_ON: bool>(
    upper: usize,
    constraints: &mut [Constraint],
    bodies: &mut [Body],
    most: f64,
    by: impl IntoIterator<Item = ((u32, Floor), f64)>,
) {
    let mut body = bodies[upper];
    if body.inverse_mass == 0.0 {
        return;
    }
    for ((at, Floor { up, .. }), added) in by {
        let mut kept = added;
        if PASSES_ON {
            let constraint = &mut constraints[at as usize];
            let impulse = lesser(added / body.inverse_mass, 2.0 * most * constraint.mass);
            let lower = &mut bodies[constraint.pair.second as usize];
            constraint.impulse += impulse;
            lower.free += up * (impulse * lower.inverse_mass);
            kept -= impulse * body.inverse_mass;
        }
        body.velocity += up * added;
        body.free += up * kept;
    }
    bodies[upper] = body;
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

#[cfg(test)]
mod tests {
    use super::super::super::ball::Ball;
    use super::*;

    #[test]
    fn every_pair_is_dealt_once_and_in_a_hand_none_after_its_neighbour() {
        let mut dealt = Vec::new();
        for count in 0..100 {
            deal(&(0..count).collect::<Vec<_>>(), &mut dealt);
            assert!(
                (0..count).all(|place| dealt.contains(&place)) && dealt.len() == count as usize,
                "{count}"
            );
            let hands = &dealt[..dealt.len() - dealt.len() % HAND.len()];
            assert!(hands.windows(2).all(|two| two[0].abs_diff(two[1]) > 1), "{count}: {dealt:?}");
        }
    }

    #[test]
    fn a_ball_on_few_others_is_stopped_as_on_many() {
        let ball = Ball::new(DVec2::ZERO, 5.0).unwrap();
        for turn in 0..1000 {
            let angle = |k: u32| f64::from(k * turn) * 0.618;
            let body =
                Body { velocity: 100.0 * DVec2::from_angle(angle(7)), ..Body::new(&ball, DVec2::ZERO) };
            let floor =
                |k| Floor { up: DVec2::from_angle(angle(k)), least: -20.0 * angle(k + 3).sin().abs() };
            let floors = [floor(1), floor(2), floor(3)];
            let on_many = |floors: &[Floor]| {
                let mut floors: Vec<_> = floors.iter().map(|&floor| (floor, 0.0)).collect();
                carry(&body, &mut floors);
                floors.into_iter().map(|(floor, added)| floor.up * added).sum::<DVec2>()
            };
            let on_few = |few: &[Floor], added: &[f64]| {
                few.iter().zip(added).map(|(floor, &added)| floor.up * added).sum::<DVec2>()
            };
            let [one, two, _] = floors;
            for (few, many) in [
                (on_few(&[one, one], &carry_on(&body, [one, one])), on_many(&[one])),
                (on_few(&[one, two], &carry_on(&body, [one, two])), on_many(&[one, two])),
                (on_few(&floors, &carry_on(&body, floors)), on_many(&floors)),
            ] {
                assert!(few.abs_diff_eq(many, 1e-9), "turn {turn}: {few} and {many}");
            }
        }
    }
}
