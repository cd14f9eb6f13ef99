//! Balls that are wedged in between what carries them and one that does not give way above them, asleep or fixed, which nearly faces
//! that. (Between what is fixed alone, `firm` holds them.)
//!
//! In a flat wedge, what holds a ball is many times its weight, and sweeps find that in hundreds of substeps, while the ball hops
//! in it, and wakes those around it. What keeps it from going farther in is found at once: among its velocities that take it into
//! none of its neighbours, as these move now, the one that is nearest to what it has. What it presses on gives way no faster for
//! that.
//!
//! That is so for pairs of one stripe: a wedge across the edge of two is left to sweeps.

use super::constraints::{Constraint, Marks};
use super::floors::{Floor, held};
use super::sleep::Rest;
use super::stripes::Stripe;
use super::{Body, Setting};

/// A wedge is flat where what is above faces what carries the ball to within an angle of this cosine: 30° under or between fixed
/// ones, 14° under one asleep. What others hold, sweeps find soon; if they were stopped so, too, piles would come to rest later.
pub(super) const FLAT_UNDER_FIXED: f64 = 0.87;
pub(super) const FLAT_UNDER_SLEEPER: f64 = 0.97;

/// A pair that is held apart, of which one cannot be moved: either, which may change while the list stands.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wedging {
    /// Its lower ball.
    lower: u32,
    /// The place of its constraint.
    at: u32,
    /// How flat a wedge under the upper one counts as flat, as a cosine.
    flat: f64,
}

impl Stripe {
    /// Gathers such pairs in the order of their lower balls.
    pub(super) fn gather_wedging(&mut self, setting: &Setting, rests: &[Rest]) {
        let Self { pairs, places_of_constraints, marks, wedging, .. } = self;
        wedging.clear();
        let still = marks.iter().zip(pairs).zip(&*places_of_constraints);
        let still = still.filter(|((marks, _), _)| marks.touch() && marks.has(Marks::STILL));
        wedging.extend(still.filter_map(|((_, pair), &at)| {
            let is_fixed = rests[pair.first as usize].own == 0.0;
            let flat = if is_fixed { Some(FLAT_UNDER_FIXED) } else { setting.flat_under_sleeper };
            flat.map(|flat| Wedging { lower: pair.second, at, flat })
        }));
        wedging.sort_unstable_by_key(|wedging| (wedging.lower, wedging.at));
    }
}

/// Stops a ball that these constraints, `its`, have others carry, if it lies in a flat wedge: if what does not give way above it, among
/// those that are `wedging`, faces one of them. Whether it does.
///
/// Not inlined: few balls lie so.
#[inline(never)]
pub(super) fn stop_in_wedge(
    ball: usize,
    constraints: &[Constraint],
    bodies: &mut [Body],
    its: &[u32],
    wedging: &[Wedging],
    floors: &mut Vec<Floor>,
) -> bool {
    let from = wedging.partition_point(|wedging| (wedging.lower as usize) < ball);
    let above = wedging[from..].iter().take_while(|wedging| wedging.lower as usize == ball);
    floors.clear();
    floors.extend(above.filter_map(|&Wedging { at, flat, .. }| {
        let Constraint { pair, normal, least, .. } = constraints[at as usize];
        // It may be the other one that cannot be moved.
        let is_firm = bodies[pair.first as usize].inverse_mass == 0.0;
        let faces = || its.iter().any(|&at| constraints[at as usize].normal.dot(normal) > flat);
        (is_firm && faces()).then(|| Floor { up: -normal, least: least.min(0.0) })
    }));
    if floors.is_empty() || bodies[ball].inverse_mass == 0.0 {
        return false;
    }
    floors.extend(its.iter().map(|&at| Floor::under(constraints, bodies, at)));
    let body = &mut bodies[ball];
    let change = held(body.velocity, floors).change;
    // Nothing is passed on to what it presses on.
    body.velocity += change;
    body.free += change;
    true
}
