//! The `canvas` solver: the demo's own frame step, bit for bit.
//!
//! Each frame moves every ball by its velocity times the delta, bounces it off the walls, and lets touching balls
//! exchange momentum, in the demo's order of operations. It never moves overlapping balls apart, and its result depends
//! on how time is cut into frames: that is the demo. What `canvas` adds is only speed: beyond [`ALL_PAIRS_MOST`] balls
//! the search for touching pairs runs on a [`Grid`], and the pairs found are put back into the demo's order.

use glam::DVec2;

use super::ball::Ball;
use super::grid::{Grid, touch};
use super::impulse::{Form, canvas_impact, canvas_rebound};
use super::world::{Pairs, World};
use super::{Advance, Edit, Frame, Part};

/// The most balls for which comparing all pairs is cheaper than keeping a grid (measured: they draw level near 40).
const ALL_PAIRS_MOST: usize = 40;
/// More touching pairs than this, 256 MiB of them, are not kept to be put in order, but looked for in order.
const MOST_PAIRS: usize = 1 << 25;

/// The canvas demo's frame step.
#[derive(Debug, Clone)]
pub(super) struct Canvas {
    search: Search,
    /// `None` where contacts are only detected.
    impulse: Option<Form>,
    /// Whether some balls are fixed, which the demo knows nothing of.
    fixed: bool,
}

/// How touching pairs are found.
#[derive(Debug, Clone)]
enum Search {
    Nothing,
    AllPairs,
    Grid(Grid),
}

impl Canvas {
    /// Decides, once, which parts of the step this world and these balls need.
    pub(super) fn new(world: &World, balls: &[Ball]) -> Self {
        let search = match (world.pairs, balls.len()) {
            (None, _) | (_, 0..=1) => Search::Nothing,
            (_, 2..=ALL_PAIRS_MOST) => Search::AllPairs,
            _ => Search::Grid(Grid::new(balls, world.size)),
        };
        // The demo's `elastic` stage knows no restitution and has a formula of its own.
        let elastic = balls.iter().all(|ball| ball.restitution == 1.0);
        let form = if elastic { Form::Elastic } else { Form::Inelastic };
        let impulse = (world.pairs == Some(Pairs::Impulse)).then_some(form);
        Self { search, impulse, fixed: balls.iter().any(Ball::is_fixed) }
    }

    fn advance_as<const FIXED: bool>(&mut self, frame: &mut Frame<'_>, seconds: f64) {
        match (frame.world.gravity.is_some(), frame.world.walls.is_some()) {
            (false, false) => move_balls::<false, false, FIXED>(frame, seconds),
            (false, true) => move_balls::<false, true, FIXED>(frame, seconds),
            (true, false) => move_balls::<true, false, FIXED>(frame, seconds),
            (true, true) => move_balls::<true, true, FIXED>(frame, seconds),
        }
        match (&mut self.search, self.impulse) {
            // A single ball may have touched one that is gone.
            (Search::Nothing, _) if frame.world.pairs.is_some() => frame.touching.fill(false),
            (Search::Nothing, _) => {}
            (Search::AllPairs, None) => all_pairs(frame, show::<FIXED>),
            (Search::AllPairs, Some(Form::Elastic)) => all_pairs(frame, collide::<true, FIXED>),
            (Search::AllPairs, Some(Form::Inelastic)) => all_pairs(frame, collide::<false, FIXED>),
            (Search::Grid(grid), None) => {
                frame.touching.fill(false);
                frame.show_overlaps::<FIXED>(grid);
            }
            (Search::Grid(grid), Some(form)) => {
                let all = grid.find_up_to(MOST_PAIRS, frame.balls);
                grid.sort();
                match form {
                    Form::Elastic if all => in_order(grid, frame, collide::<true, FIXED>),
                    Form::Inelastic if all => in_order(grid, frame, collide::<false, FIXED>),
                    Form::Elastic => all_pairs(frame, collide::<true, FIXED>),
                    Form::Inelastic => all_pairs(frame, collide::<false, FIXED>),
                }
            }
        }
    }
}

impl Advance for Canvas {
    /// Always finishes: a frame costs about the same whatever happens in it, and the demo has no half frames.
    fn advance(&mut self, frame: &mut Frame<'_>, seconds: f64, _: &mut dyn FnMut() -> bool) -> f64 {
        if self.fixed {
            self.advance_as::<true>(frame, seconds);
        } else {
            self.advance_as::<false>(frame, seconds);
        }
        seconds
    }

    fn take_up(&mut self, _: &World, _: &[Ball], edit: Edit) -> bool {
        // It remembers no velocities.
        matches!(edit, Edit::Thrown(_))
    }

    fn parts(&self, world: &World) -> Vec<Part> {
        let mut parts = Part::of_motion(world);
        match self.search {
            Search::Nothing => return parts,
            Search::AllPairs => parts.push(Part::AllPairs),
            Search::Grid(_) => parts.push(Part::Grid),
        }
        if self.impulse.is_some() {
            parts.push(Part::Impulse);
        }
        parts
    }

    fn clone_boxed(&self) -> Box<dyn Advance> {
        Box::new(self.clone())
    }
}

/// Steps 1 and 2 of the demo's frame. It runs them as two loops over the balls; in one loop each ball sees the same
/// operations in the same order.
fn move_balls<const GRAVITY: bool, const WALLS: bool, const FIXED: bool>(
    frame: &mut Frame<'_>,
    seconds: f64,
) {
    let gravity = frame.world.gravity.unwrap_or_default() * seconds;
    let restitution = frame.world.walls.unwrap_or_default();
    let size = frame.world.size;
    let (mut hits, mut impulse) = (0, DVec2::ZERO);
    for ball in &mut *frame.balls {
        if FIXED && ball.is_fixed() {
            continue;
        }
        if GRAVITY {
            ball.velocity += gravity;
        }
        ball.position += ball.velocity * seconds;
        if WALLS {
            let (radius, high, before) = (ball.radius, size - ball.radius, ball.velocity);
            let hit = bounce(&mut ball.position.x, &mut ball.velocity.x, radius, high.x, restitution)
                + bounce(&mut ball.position.y, &mut ball.velocity.y, radius, high.y, restitution);
            if hit > 0 {
                hits += hit;
                impulse += ball.mass * (ball.velocity - before);
            }
        }
    }
    frame.tally.wall_hits += hits;
    frame.tally.wall_impulse += impulse;
}

/// One axis of a ball against its two walls; 1 where it hit one.
#[inline]
fn bounce(position: &mut f64, velocity: &mut f64, low: f64, high: f64, restitution: f64) -> u64 {
    let at = if *position < low {
        low
    } else if *position > high {
        high
    } else {
        return 0;
    };
    *position = at;
    *velocity = -*velocity * restitution;
    1
}

/// Step 3 of the demo's frame, as it stands there.
fn all_pairs(frame: &mut Frame<'_>, mut contact: impl FnMut(&mut Frame<'_>, usize, usize)) {
    frame.touching.fill(false);
    for i in 0..frame.balls.len() {
        let Ball { position, radius, .. } = frame.balls[i];
        for j in i + 1..frame.balls.len() {
            let other = &frame.balls[j];
            if touch(position, radius, other.position, other.radius) {
                contact(frame, i, j);
            }
        }
    }
}

/// Step 3 on the pairs of the grid.
fn in_order(grid: &Grid, frame: &mut Frame<'_>, mut contact: impl FnMut(&mut Frame<'_>, usize, usize)) {
    frame.touching.fill(false);
    for &(i, j) in grid.touching() {
        contact(frame, i as usize, j as usize);
    }
}

/// Flags a pair that touches; fixed balls do not notice each other.
fn show<const FIXED: bool>(frame: &mut Frame<'_>, i: usize, j: usize) {
    if FIXED && frame.balls[i].is_fixed() && frame.balls[j].is_fixed() {
        return;
    }
    frame.touching[i] = true;
    frame.touching[j] = true;
}

/// Flags a pair that touches, and exchanges its momentum.
fn collide<const ELASTIC: bool, const FIXED: bool>(frame: &mut Frame<'_>, i: usize, j: usize) {
    show::<FIXED>(frame, i, j);
    let form = if ELASTIC { Form::Elastic } else { Form::Inelastic };
    let (first, second) = (&frame.balls[i], &frame.balls[j]);
    if FIXED && (first.is_fixed() || second.is_fixed()) {
        let (index, free, fixed) = if second.is_fixed() { (i, first, second) } else { (j, second, first) };
        // Both may be fixed: then both are at rest, and do not approach.
        if let Some(velocity) = canvas_rebound(form, free, fixed) {
            frame.balls[index].velocity = velocity;
            frame.tally.impacts += 1;
        }
    } else if let Some((first, second)) = canvas_impact(form, first, second) {
        frame.balls[i].velocity = first;
        frame.balls[j].velocity = second;
        frame.tally.impacts += 1;
    }
}
