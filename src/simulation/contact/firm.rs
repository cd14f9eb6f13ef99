//! What is firm, fixed balls and, beside these, walls, gives way to nothing: what lies between two of them that nearly face each other,
//! or is thrown in there, goes into neither. They press on it with many times what presses it in, which sweeps find in hundreds of
//! substeps, and impacts come ever more often there (inelastic collapse; Bernu & Mazighi 1990), so that more are left than are
//! taken: before either had stopped it, it would be through.
//!
//! So what would take it into them is taken from its velocity: after each impact, as far as no other is to come of it, and when all
//! has been held apart. What is left is the nearest velocity that takes it into none. What is fast, and what a fast one hit, is left
//! as it is.

use glam::DVec2;

use super::super::lesser::lesser;
use super::constraints::Marks;
use super::fates::{Limits, Shift};
use super::floors::{Floor, held};
use super::impacts::Stage;
use super::meeting::strike;
use super::sleep::Rest;
use super::stripes::Stripes;
use super::sweep::Pass;
use super::wedges::FLAT_UNDER_FIXED;
use super::{Body, Contact, Setting};

/// They are near a ball that is no farther from them than this part of its radius, and than it goes in a substep.
const NEAR: f64 = 0.25;
/// At least this part of a substep is left after an impact.
const LEFT: f64 = 1e-6;

/// A ball between such.
#[derive(Debug)]
pub(super) struct Between {
    body: usize,
    onward: Onward,
    /// What is firm and near it there.
    sides: Vec<Side>,
    /// Whether it may not have been hit as often as it would have been.
    spent: bool,
}

/// How a ball goes on after it was hit.
#[derive(Debug, Clone, Copy)]
struct Onward {
    /// Where it was hit for the last time.
    place: DVec2,
    /// By how much it is faster since then, in the mean, than through the substep.
    faster: DVec2,
    /// How much of the substep is left, s.
    left: f64,
}

impl Onward {
    fn of(setting: &Setting, body: &Body, time: f64) -> Self {
        let part = time / setting.substep;
        // Only what nothing holds goes along its parabola.
        let change = if body.is_free() { body.change(setting.kick) } else { DVec2::ZERO };
        Self {
            place: body.end(time) + change * (0.5 * time * (part - 1.0)),
            faster: change * (0.5 * part),
            left: (setting.substep - time).max(LEFT * setting.substep),
        }
    }

    /// The velocity through the substep of a ball that comes into none of these sides, as near as possible to what it is.
    fn held(&self, velocity: DVec2, sides: impl Iterator<Item = Side>) -> DVec2 {
        let goes = velocity + self.faster;
        let floors: Vec<_> = sides.map(|side| side.floor(goes, self.left)).collect();
        let change = held(goes, &floors).change;
        if change == DVec2::ZERO { velocity } else { goes + change - self.faster }
    }
}

/// What is firm and near a ball.
#[derive(Debug, Clone, Copy)]
struct Side {
    /// Where it pushes.
    up: DVec2,
    /// How far away it is, px.
    gap: f64,
    /// The sum of both radii, px; of a wall infinite.
    reach: f64,
    /// The stripe and the place of the pair with it, and the fixed ball, unless it is a wall.
    pair: Option<(usize, usize, usize)>,
}

impl Side {
    /// What it is to a ball that goes on so fast for so long: its tangent where the ball would hit it, or else would be nearest to it.
    /// What a ball only passes does not brake it then, however close.
    fn floor(self, velocity: DVec2, left: f64) -> Floor {
        let Self { up, gap, reach, .. } = self;
        let (closing, speed) = (-velocity.dot(up), velocity.length_squared());
        if reach == f64::INFINITY || gap <= 0.0 || closing <= 0.0 {
            return Floor { up, least: -gap.max(0.0) / left };
        }
        let distance = reach + gap;
        // It is nearest at closing·distance / speed; the quarter of the discriminant tells whether the way there leads into it.
        let quarter = closing * closing * distance * distance - speed * gap * (distance + reach);
        let time = if quarter > 0.0 {
            gap * (distance + reach) / (closing * distance + quarter.sqrt())
        } else {
            closing * distance / speed
        };
        let tangent = (up * distance + velocity * lesser(time, left)).normalize();
        // How far it is from that tangent, by what is no difference of nearly equal numbers.
        let gap = gap * up.dot(tangent) - 0.5 * reach * up.distance_squared(tangent);
        Floor { up: tangent, least: -gap.max(0.0) / left }
    }
}

impl Setting {
    /// How far what is near a body may be, px.
    fn near(&self, body: &Body) -> f64 {
        NEAR * body.radius + body.velocity.length() * self.substep
    }

    /// The walls near a body at this place.
    fn walls_near(&self, body: &Body, place: DVec2) -> impl Iterator<Item = Side> + use<> {
        let (near, radius, size) = (self.near(body), body.radius, self.size);
        let sides = [(DVec2::X, 0.0), (DVec2::Y, 0.0), (DVec2::NEG_X, size.x), (DVec2::NEG_Y, size.y)];
        let sides = sides.into_iter().take(if self.walls.is_some() { 4 } else { 0 });
        let sides = sides.map(move |(up, wall)| Side {
            up,
            gap: place.dot(up) + wall - radius,
            reach: f64::INFINITY,
            pair: None,
        });
        sides.filter(move |side| side.gap < near)
    }

    /// What is firm and near a body at this place; nothing where no two face each other. Its pairs must be linked.
    fn sides(
        &self,
        at: usize,
        place: DVec2,
        bodies: &[Body],
        rests: &[Rest],
        all: &Stripes<'_>,
    ) -> Vec<Side> {
        let (body, near) = (&bodies[at], self.near(&bodies[at]));
        let mut sides = Vec::new();
        for number in all.of_body(at) {
            let (stripe, start) = (&all.list[number], all.layout.start(number));
            let own = (at - start) as u32;
            for pair in stripe.links.of(own).filter(|&pair| stripe.marks[pair].has(Marks::STILL)) {
                let other = start + stripe.pairs[pair].other(own) as usize;
                if rests[other].own == 0.0 {
                    let (up, distance) = (place - bodies[other].position).normalize_and_length();
                    let reach = body.radius + bodies[other].radius;
                    let gap = distance - reach;
                    if gap < near {
                        sides.push(Side { up, gap, reach, pair: Some((number, pair, other)) });
                    }
                }
            }
        }
        if !sides.is_empty() {
            sides.extend(self.walls_near(body, place));
        }
        let faces = |(number, one): (usize, &Side)| {
            sides[..number].iter().any(|other| -one.up.dot(other.up) > FLAT_UNDER_FIXED)
        };
        if !sides.iter().enumerate().any(faces) {
            sides.clear();
        }
        sides
    }
}

impl Stage<'_> {
    /// Keeps a body that was hit out of what no other impact with it is to come of: what it was hit by often enough, or presses on and
    /// comes to too slowly to bounce. Its pairs must be linked.
    pub(super) fn keep_between(&mut self, at: usize, stripes: &Stripes<'_>) {
        let (body, fate, setting) = (self.bodies[at], self.fates[at], self.setting);
        // What is slow is borne by what it presses on, and is known to press from then on.
        if fate.fast || setting.kick == DVec2::ZERO || body.velocity.length() < setting.firm {
            return;
        }
        let onward = Onward::of(setting, &body, fate.time);
        let mut sides = setting.sides(at, onward.place, self.bodies, self.rests, stripes);
        let is_over = |side: &Side| match side.pair {
            None => setting.walls.is_some_and(|e| self.limits.is_spent(&fate, fate.shift, e, 1.0)),
            Some((number, pair, other)) => {
                let states = [at, other].map(|body| (&self.bodies[body], &self.fates[body]));
                let firm = stripes.list[number].firm(pair, setting);
                let is_elastic = self.restitutions[at].min(self.restitutions[other]) == 1.0;
                firm.is_some_and(|firm| !is_elastic && -body.velocity.dot(side.up) < firm)
                    || fate.hits >= self.limits.least(fate.shift) && self.is_either_spent((at, other), states)
            }
        };
        sides.retain(is_over);
        let held = onward.held(body.velocity, sides.iter().copied());
        if held != body.velocity {
            strike(&mut self.bodies[at], held - body.velocity, fate.time);
        }
    }
}

impl Contact {
    /// The balls that may be between firm things at the substep's beginning, in their order.
    pub(super) fn find_between(&mut self) -> Vec<usize> {
        let Self { setting, bodies, rests, near: Some(near), .. } = self else { return Vec::new() };
        if !setting.has_fixed || setting.kick == DVec2::ZERO {
            return Vec::new();
        }
        let mut beside = Vec::new();
        for (number, stripe) in near.stripes.iter().enumerate() {
            let start = near.layout.start(number);
            let still = stripe.pairs.iter().zip(&stripe.marks).filter(|(_, marks)| marks.has(Marks::STILL));
            beside.extend(still.filter_map(|(pair, _)| {
                let pair = pair.from(start);
                let [first, second] = [pair.first, pair.second].map(|body| body as usize);
                let (fixed, at) = if rests[first].own == 0.0 { (first, second) } else { (second, first) };
                let (fixed_ball, body) = (&bodies[fixed], &bodies[at]);
                let reach = body.radius + fixed_ball.radius + setting.near(body);
                // What sleeps may be woken by a hit.
                let moves = rests[fixed].own == 0.0 && rests[at].own > 0.0;
                (moves && body.position.distance_squared(fixed_ball.position) < reach * reach).then_some(at)
            }));
        }
        beside.sort_unstable();
        // With what else is near.
        let mut between = Vec::new();
        for balls in beside.chunk_by(|one, other| one == other) {
            let body = &bodies[balls[0]];
            if balls.len() > 1 || setting.walls_near(body, body.position).next().is_some() {
                between.push(balls[0]);
            }
        }
        if !between.is_empty() {
            near.link_pairs(bodies.len());
        }
        between
    }

    /// How these go on after their impacts, and between what. Those that are fast are left as they are.
    pub(super) fn look_onward(&mut self, between: Vec<usize>) -> Vec<Between> {
        let Self { setting, bodies, restitutions, rests, near: Some(near), course, .. } = self else {
            return Vec::new();
        };
        let limits = Limits::of(bodies.len(), near.crowd, setting);
        let all = near.all();
        let look = |body: usize| {
            let fate = course.fates.get(body).copied().unwrap_or_default();
            let onward = Onward::of(setting, &bodies[body], fate.time);
            let sides = setting.sides(body, onward.place, bodies, rests, &all);
            let left_out = sides.is_empty() || fate.fast || fate.shift == Shift::Far;
            let spent = limits.may_be_spent(&fate, restitutions[body]);
            (!left_out).then_some(Between { body, onward, sides, spent })
        };
        between.into_iter().filter_map(look).collect()
    }

    /// Stops these before the passes and after them. What is left of the passes.
    pub(super) fn stop_between<'a>(&mut self, between: &[Between], passes: [Pass<'a>; 2]) -> [Pass<'a>; 2] {
        if between.is_empty() {
            return passes;
        }
        self.stop(between);
        self.sweep(&passes);
        self.stop(between);
        [Pass::NOTHING; 2]
    }

    fn stop(&mut self, between: &[Between]) {
        for Between { body, onward, sides, spent } in between {
            let body = &mut self.bodies[*body];
            if body.is_free() && !spent {
                // Its impacts have seen to it.
                continue;
            }
            let held = onward.held(body.velocity, sides.iter().copied());
            if held != body.velocity {
                body.free += held - body.velocity;
                body.velocity = held;
            }
        }
    }
}
