//! What stops a ball that still sinks on what carries it, from the ground up, as if that were firm (shock propagation;
//! Guendelman, Bridson & Fedkiw 2003), so that no load, and no ratio of masses, makes anything sink. Where substeps are the
//! shortest, what stopped it acts on what lies below in the next.

use glam::DVec2;

use super::super::lesser::lesser;
use super::amount::Amount;
use super::constraints::Constraint;
use super::layout::Layer;
use super::stripes::Stripe;
use super::sweep::Pass;
use super::wedges::stop_in_wedge;
use super::{Body, Contact, Setting};

/// Rounds over the pairs of one ball, where each may undo some of what the others did.
const INNER: u32 = 3;
/// What stops a ball on what carries it is passed on to that in the next substep, but by each of their pairs, each time
/// that it is looked at, no more than so many kicks of gravity of twice their effective mass: under heavy ones, light balls
/// would be squeezed out.
const PASSED_ON: f64 = 2.0;

impl Contact {
    /// Whether what stops balls on what carries them is passed on to that. Where it is not, the part of a load that the sweeps
    /// miss is borne by nothing, sideways, too, which holds up slopes. That is left so in longer substeps, where little moves:
    /// it comes to rest. Where all balls are few, the sweeps miss nothing.
    fn passes_on(&self) -> bool {
        self.setting.amount > Amount::Few && self.substeps.are_short()
    }

    /// The pass in which what still sinks stops on what carries it.
    pub(super) fn carry(&self) -> Pass<'static> {
        if self.setting.kick == DVec2::ZERO || !self.setting.grounded {
            // Stopped on what falls as it does, a ball would slow down all of them.
            Pass::NOTHING
        } else if self.passes_on() {
            Pass::CARRY_AND_PASS_ON
        } else {
            Pass::CARRY
        }
    }
}

impl Pass<'_> {
    /// Stops what still sinks on what carries it (shock propagation). Not without gravity: nothing lies on anything.
    const CARRY: Self = Self {
        layers: Layer::AROUND,
        only_busy: true,
        work: &|setting, stripe, share| stripe.carry_all::<false>(setting, share.bodies),
    };

    /// The same, where what stops a ball acts on what carries it in the next substep.
    const CARRY_AND_PASS_ON: Self = Self {
        layers: Layer::AROUND,
        only_busy: true,
        work: &|setting, stripe, share| stripe.carry_all::<true>(setting, share.bodies),
    };
}

impl Stripe {
    /// Stops what still sinks, from the ground up.
    fn carry_all<const PASSES_ON: bool>(&mut self, setting: &Setting, bodies: &mut [Body]) {
        // Twice, so that what has no wedges does not look for any.
        if self.wedging.is_empty() {
            self.carry_each::<PASSES_ON, false>(setting, bodies);
        } else {
            self.carry_each::<PASSES_ON, true>(setting, bodies);
        }
    }

    fn carry_each<const PASSES_ON: bool, const WEDGES: bool>(
        &mut self,
        setting: &Setting,
        bodies: &mut [Body],
    ) {
        let Self { constraints, carrying, uppers, wedging, faced, floors, .. } = self;
        let (constraints, carrying) = (&mut constraints[..], &carrying[..]);
        let most = PASSED_ON * setting.kick.length();
        for ends in uppers.windows(2) {
            let its = &carrying[ends[0] as usize..ends[1] as usize];
            let Some(&first) = its.first() else { continue };
            let upper = constraints[first as usize].pair.first as usize;
            if WEDGES && stop_in_wedge(upper, constraints, bodies, its, wedging, faced) {
                continue;
            }
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
}

/// What carries a ball: how fast it goes down there, at most.
#[derive(Debug, Clone, Copy)]
pub(super) struct Floor {
    pub(super) up: DVec2,
    /// px/s along `up`, never more than 0.
    pub(super) least: f64,
}

impl Floor {
    /// The lower ball of the constraint at this place.
    #[inline]
    pub(super) fn under(constraints: &[Constraint], bodies: &[Body], at: u32) -> Self {
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

#[cfg(test)]
mod tests {
    use super::super::super::ball::Ball;
    use super::*;

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
