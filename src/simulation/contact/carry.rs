//! What stops a ball that still sinks on what carries it, from the ground up, as if that were firm (shock propagation;
//! Guendelman, Bridson & Fedkiw 2003), so that no load, and no ratio of masses, makes anything sink. Where substeps are the
//! shortest, what stopped it acts on what lies below in the next.

use super::super::lesser::{greater, lesser};
use super::amount::Amount;
use super::constraints::Constraint;
use super::floors::{Floor, Held, added_by_two, held};
use super::layout::Layer;
use super::meeting::strike;
use super::stripes::Stripe;
use super::sweep::Pass;
use super::unlike::Unlike;
use super::wedges::stop_in_wedge;
use super::{Body, Contact, DVec2, Setting};

/// Rounds over the pairs of one ball among balls that are unlike in density, where each may undo some of what the others did.
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
        let Self { constraints, carrying, uppers, wedging, floors, added, .. } = self;
        let (constraints, carrying) = (&mut constraints[..], &carrying[..]);
        let most = PASSED_ON * setting.kick.length();
        for ends in uppers.windows(2) {
            let its = &carrying[ends[0] as usize..ends[1] as usize];
            let Some(&first) = its.first() else { continue };
            let upper = constraints[first as usize].pair.first as usize;
            if WEDGES && stop_in_wedge(upper, constraints, bodies, its, wedging, floors) {
                continue;
            }
            if setting.unlike == Unlike::Density {
                stop_by_sweeps::<PASSES_ON>(upper, constraints, bodies, most, its, (floors, added));
                continue;
            }
            if let [one] | [one, _] = *its {
                stop_on_two::<PASSES_ON>(upper, constraints, bodies, most, [one, its[its.len() - 1]]);
                continue;
            }
            floors.clear();
            floors.extend(its.iter().map(|&at| Floor::under(constraints, bodies, at)));
            let Held { change, by } = held(bodies[upper].velocity, floors);
            if change == DVec2::ZERO {
                continue;
            }
            if by[0].is_some() {
                let by = by.into_iter().flatten().map(|(floor, added)| ((its[floor], floors[floor]), added));
                stop::<PASSES_ON>(upper, constraints, bodies, most, by);
            } else {
                strike(&mut bodies[upper], change, 0.0);
            }
        }
    }
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

/// Stops a ball on the one or two that these constraints are with; one may be both.
#[inline]
fn stop_on_two<const PASSES_ON: bool>(
    upper: usize,
    constraints: &mut [Constraint],
    bodies: &mut [Body],
    most: f64,
    both: [u32; 2],
) {
    let floors = both.map(|at| Floor::under(constraints, bodies, at));
    let velocity = bodies[upper].velocity;
    let lacking = floors.map(|floor| floor.least - velocity.dot(floor.up));
    let added = added_by_two(lacking, floors[0].up.dot(floors[1].up));
    stop::<PASSES_ON>(upper, constraints, bodies, most, both.into_iter().zip(floors).zip(added));
}

/// Stops a ball, where any are unlike in density, on what these constraints, `its`, are with, one after the other: what a heavy ball gives
/// light ones that it is wedged between grows only slowly so, and fewer are crushed. As each leaves something of those before, every
/// other ball takes them the other way round.
fn stop_by_sweeps<const PASSES_ON: bool>(
    upper: usize,
    constraints: &mut [Constraint],
    bodies: &mut [Body],
    most: f64,
    its: &[u32],
    (floors, added): (&mut Vec<Floor>, &mut Vec<f64>),
) {
    let in_turn = |number: usize| its[if upper.is_multiple_of(2) { number } else { its.len() - 1 - number }];
    floors.clear();
    floors.extend((0..its.len()).map(|number| Floor::under(constraints, bodies, in_turn(number))));
    added.clear();
    added.resize(its.len(), 0.0);
    let mut velocity = bodies[upper].velocity;
    for _ in 0..INNER {
        for (floor, added) in floors.iter().zip(&mut *added) {
            let more = greater(0.0, floor.least - velocity.dot(floor.up));
            *added += more;
            velocity += floor.up * more;
        }
    }
    let by = (0..its.len()).map(|number| ((in_turn(number), floors[number]), added[number]));
    stop::<PASSES_ON>(upper, constraints, bodies, most, by);
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
