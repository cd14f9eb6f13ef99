//! Where the loads of balls at rest go: down to what carries them, and on to the ground.
//!
//! A substep stops each ball on what carries it as if that were the ground (`carry`), and tells what carries it little of
//! the load, or nothing: where masses are unequal, impulses alone would take thousands of substeps to find it. Balls that
//! are to sleep on each other are given the impulses that they rest on here, from the top down. They are in balance with
//! them, and stay so as long as nothing changes.

use glam::DVec2;

use super::constraints::Marks;
use super::near::Near;
use super::show::Held;
use super::sleep::Rest;
use super::stripes::{Holder, Stripes};
use super::wake::tolerance;
use super::{Body, Setting};

/// Rounds over what carries a ball, where each may undo some of what the others did, at most.
const ROUNDS: u32 = 32;
/// A ball stands on the very top of another up to an angle of this sine.
const TOP: f64 = 0.01;
/// A round that changes less than this part of a load is the last.
const ROUNDING: f64 = 1e-12;

/// What is to be known of balls to tell whether they rest on each other.
#[derive(Debug)]
pub(super) struct Resting<'a> {
    pub(super) setting: &'a Setting,
    pub(super) bodies: &'a [Body],
    pub(super) rests: &'a [Rest],
    /// Whether each is held by others or by a wall.
    pub(super) held: &'a [Held],
    pub(super) stripes: Stripes<'a>,
}

/// Which balls rest, and what that takes.
#[derive(Debug)]
pub(super) struct Loads {
    /// For each ball, whether it rests on what does so, too, if it stands still.
    pub(super) bears: Vec<bool>,
    /// What constraints take besides what they gave in the last substep, from the top down.
    by_balls: Vec<Passed>,
    /// What walls do: the ball, and the velocity that they give it in a substep, px/s.
    by_walls: Vec<(usize, DVec2)>,
}

/// A load that a ball passes on to one below.
#[derive(Debug, Clone, Copy)]
struct Passed {
    upper: usize,
    to: Holder,
    /// mass·px/s: less than none where it takes back a part of what it did.
    impulse: f64,
}

impl Resting<'_> {
    /// Finds which of the balls that stand still rest.
    pub(super) fn loads(&self, still: &[bool]) -> Loads {
        let Self { setting, bodies, rests, .. } = self;
        let fixed = |at: usize| rests[at].counted == 0.0;
        // What moves each, in a substep, if nothing more is done, mass·px/s.
        let mut start = vec![DVec2::ZERO; bodies.len()];
        let mut loads = Loads { bears: vec![true; bodies.len()], by_balls: Vec::new(), by_walls: Vec::new() };
        for (at, &still) in still.iter().enumerate() {
            if fixed(at) || rests[at].asleep {
                continue;
            }
            let grounded = self.grounded(at);
            if !still || !(self.held[at].any() || grounded.any()) {
                loads.bears[at] = false;
                continue;
            }
            if self.would_slide_off(at) {
                loads.bears[at] = false;
                continue;
            }
            let given = self.stripes.given(at, rests[at].counted);
            let moves = given.velocity + setting.kick;
            let free = DVec2::select(grounded, DVec2::ZERO, self.off_walls(at, moves));
            if free.length() >= tolerance(setting.kick, given.pressed) {
                start[at] = moves / rests[at].counted;
            }
        }
        if start.iter().all(|&start| start == DVec2::ZERO) {
            return loads;
        }
        let candidates = (0..bodies.len()).filter(|&at| loads.bears[at] && !fixed(at));
        let mut order: Vec<(f64, usize)> = candidates.map(|at| (self.depth(at), at)).collect();
        order.sort_by(|one, other| one.0.total_cmp(&other.0));
        loop {
            let mut left = start.clone();
            loads.by_balls.clear();
            loads.by_walls.clear();
            for &(_, at) in &order {
                if left[at] != DVec2::ZERO && loads.bears[at] {
                    self.pass_on(at, &mut left, &mut loads);
                }
            }
            // From the ground up: what lies on something that does not rest does not rest.
            let mut any_drops = false;
            for &Passed { upper, to, .. } in loads.by_balls.iter().rev() {
                if !loads.bears[to.other] {
                    any_drops |= std::mem::take(&mut loads.bears[upper]);
                }
            }
            if !any_drops {
                return loads;
            }
            // Once more, without what those pass on; sleepers may bear what is left.
            for &(_, at) in order.iter().filter(|&&(_, at)| rests[at].asleep) {
                loads.bears[at] = true;
            }
        }
    }

    /// Passes on what moves a ball to the walls and to the balls on which it lies, if that leaves nothing of it.
    fn pass_on(&self, at: usize, left: &mut [DVec2], loads: &mut Loads) {
        let Self { setting, rests, stripes, .. } = self;
        let mut below: Vec<Passed> = stripes
            .holders(at)
            .filter(|to| self.depth(to.other) > self.depth(at))
            .map(|to| Passed { upper: at, to, impulse: 0.0 })
            .collect();
        let (mut moves, mut by_walls) = (left[at], DVec2::ZERO);
        for _ in 0..ROUNDS {
            let before = moves;
            for Passed { to, impulse, .. } in &mut below {
                // Never a pull. What found no rest before may be hit in every other substep, and be held too much in this one.
                let least = if rests[at].restless > 0 { -(to.impulse + *impulse) } else { 0.0 };
                let push = (-moves.dot(to.normal)).max(least);
                *impulse += push;
                moves += to.normal * push;
            }
            let off = self.off_walls(at, moves);
            by_walls += off - moves;
            moves = off;
            if moves.distance_squared(before) <= ROUNDING * ROUNDING * left[at].length_squared() {
                break;
            }
        }
        let inverse_mass = rests[at].counted;
        let passed: f64 = below.iter().map(|passed| passed.impulse).sum();
        let pressed = stripes.given(at, inverse_mass).pressed + (passed + by_walls.length()) * inverse_mass;
        loads.bears[at] = moves.length() * inverse_mass < tolerance(setting.kick, pressed);
        if !loads.bears[at] {
            return;
        }
        below.retain(|passed| passed.impulse != 0.0);
        for Passed { to, impulse, .. } in &below {
            left[to.other] -= to.normal * *impulse;
        }
        loads.by_balls.append(&mut below);
        if by_walls != DVec2::ZERO {
            loads.by_walls.push((at, by_walls * inverse_mass));
        }
    }

    /// Whether a ball stands on a single fixed one, away from walls, and not on its very top: it seems at rest where it turns round, as in
    /// a swing, and would slide off as soon as it moved. (On one that can move it would, too; but small ones on large ones in piles come to
    /// rest later so.)
    fn would_slide_off(&self, at: usize) -> bool {
        let mut holders = self.stripes.holders(at);
        let (only, more) = (holders.next(), holders.next());
        let kick = self.setting.kick;
        let slides = |Holder { other, normal, .. }: Holder| {
            self.rests[other].own == 0.0 && normal.perp_dot(kick).abs() > TOP * kick.length()
        };
        more.is_none() && !self.stripes.is_beside(at) && only.is_some_and(slides)
    }

    /// How far down a ball is: greater for what is lower.
    fn depth(&self, at: usize) -> f64 {
        self.bodies[at].position.dot(self.setting.kick)
    }

    /// Along which axes a ball lies on a wall, or hops less high than gravity takes it in a substep.
    fn grounded(&self, at: usize) -> glam::BVec2 {
        let Setting { kick, .. } = *self.setting;
        let [above, below] = self.gaps(at);
        DVec2::select(kick.cmpgt(DVec2::ZERO), below, above).cmplt(kick.abs() * self.near_wall(at))
    }

    /// What is left of a velocity, or an impulse, where walls take what presses against them.
    fn off_walls(&self, at: usize, moves: DVec2) -> DVec2 {
        let [above, below] = self.gaps(at);
        let gap = DVec2::select(moves.cmpgt(DVec2::ZERO), below, above);
        let leans = gap.cmplt(DVec2::splat(self.setting.kick.length() * self.near_wall(at)));
        DVec2::select(leans, DVec2::ZERO, moves)
    }

    /// How far it is from a ball to the walls on both sides, px.
    fn gaps(&self, at: usize) -> [DVec2; 2] {
        let Body { position, radius, .. } = self.bodies[at];
        [position - radius, self.setting.size - radius - position]
    }

    /// The length of a substep where a ball may touch a wall, s; elsewhere less than any time.
    fn near_wall(&self, at: usize) -> f64 {
        if self.stripes.is_beside(at) { self.setting.substep } else { f64::NEG_INFINITY }
    }
}

impl Near {
    /// Gives balls that sleep the loads that they rest on.
    pub(super) fn take_loads(&mut self, loads: &Loads, rests: &[Rest]) {
        for Passed { to: Holder { number, at, .. }, impulse, .. } in &loads.by_balls {
            // What is awake finds its own.
            let stripe = &mut self.stripes[*number];
            if stripe.marks[*at].has(Marks::IDLE)
                && let Some(constraint) = stripe.constraint_mut(*at)
            {
                constraint.impulse = (constraint.impulse + impulse).max(0.0);
            }
        }
        for &(at, push) in loads.by_walls.iter().filter(|&&(at, _)| rests[at].asleep) {
            let (number, own) = self.layout.place_of(at);
            let stripe = &mut self.stripes[number];
            if let Some(place) = stripe.place_beside(own) {
                stripe.beside[place].push += push;
            }
        }
    }
}
