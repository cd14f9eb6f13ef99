//! Which balls may touch each other, or a wall, before long.
//!
//! A search finds all pairs that can meet while no ball is farther than its *reach* from where it was then (its *home*;
//! Verlet 1967). A search holds until a ball is about to go farther, so a pile at rest is searched once.

use glam::DVec2;

use super::super::grid::{Disc, Grid, touch};
use super::order::{Heights, Kept};
use super::{Body, Setting};

/// A ball may go so much of its radius, whatever its speed, before pairs are searched anew.
const SKIN: f64 = 0.1;
/// ... and as far as its speed, or the root mean square of all speeds, takes it in so many substeps.
const HORIZON: f64 = 3.0;
/// The same for few balls, all pairs of which are soon compared.
const FEW_HORIZON: f64 = 6.0;
/// The most balls for which comparing all pairs is cheaper than keeping a grid.
const FEW: usize = 40;
/// Balls are put in the order of their places once in so many searches.
const SEARCHES_PER_ORDER: u32 = 16;
/// Cells are made anew where discs have become larger or smaller than those that they were made for by this factor.
const MISFIT: f64 = 1.25;

/// What the last search found.
#[derive(Debug, Default)]
pub(super) struct Near {
    /// Where there is gravity, the first is the upper one, and pairs stand in the order of its height, from the lowest up.
    pub(super) pairs: Vec<Pair>,
    /// For each pair; empty where nothing rests.
    pub(super) holds: Vec<Hold>,
    /// For each of these, whether they pressed on each other, or met, in the last substep.
    pub(super) held: Vec<bool>,
    /// Balls that may touch a wall.
    pub(super) beside: Vec<Beside>,
    pub(super) homes: Vec<Home>,
    /// Whether a ball was kept from going where it is not covered.
    pub(super) stale: bool,
    discs: Vec<Reach>,
    grid: Option<(Grid, f64)>,
    searches: u32,
    kept: Kept,
    heights: Heights,
}

/// Two balls that may touch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair {
    pub(super) first: u32,
    pub(super) second: u32,
}

/// How two balls hold each other.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hold {
    /// What holds them apart in a substep, mass·px/s along `normal`.
    pub(super) impulse: f64,
    /// From the second to the first, of length 1, where it was last needed.
    pub(super) normal: DVec2,
    /// What is left of what was given along earlier directions, mass·px/s.
    pub(super) grip: DVec2,
    /// The velocity, px/s along `normal`, with which they would just touch at the end of the substep.
    pub(super) least: f64,
    /// Whether they have come to touch in this substep.
    pub(super) met: bool,
    /// The mass of both against each other.
    pub(super) mass: f64,
}

impl Hold {
    pub(super) const NONE: Self =
        Self { impulse: 0.0, normal: DVec2::ZERO, grip: DVec2::ZERO, least: 0.0, met: false, mass: 0.0 };
}

/// A ball that may touch a wall.
#[derive(Debug, Clone, Copy)]
pub(super) struct Beside {
    pub(super) body: u32,
    /// The velocity that the walls give it in a substep, px/s.
    pub(super) push: DVec2,
}

/// Where a ball was at the last search, and how far from there it is covered, px.
#[derive(Debug, Clone, Copy)]
pub(super) struct Home {
    position: DVec2,
    reach: f64,
}

impl Home {
    /// The covered place nearest to `to`.
    pub(super) fn limit(&self, to: DVec2) -> DVec2 {
        self.position + (to - self.position).clamp_length_max(self.reach)
    }

    #[inline]
    pub(super) fn covers(&self, place: DVec2) -> bool {
        place.distance_squared(self.position) <= self.reach * self.reach
    }
}

/// The disc that a ball stays in while it is covered.
#[derive(Debug, Clone, Copy)]
struct Reach {
    centre: DVec2,
    radius: f64,
}

impl Disc for Reach {
    fn centre(&self) -> DVec2 {
        self.centre
    }

    fn radius(&self) -> f64 {
        self.radius
    }
}

/// What balls carry from one search to the next.
pub(super) struct Cargo<'a> {
    pub(super) bodies: &'a mut Vec<Body>,
    pub(super) restitutions: &'a mut Vec<f64>,
    pub(super) ids: &'a mut Vec<u32>,
    pub(super) hit: &'a mut Vec<bool>,
    /// Where they were a substep ago; empty where that is not needed.
    pub(super) before: &'a mut Vec<(DVec2, DVec2)>,
}

impl Near {
    /// Whether all balls stay covered in a substep in which nothing hits them.
    pub(super) fn covers(&self, bodies: &[Body], substep: f64) -> bool {
        // No early exit: a search is rare, and without one this loop is straight.
        !self.stale
            && self.homes.len() == bodies.len()
            && self.homes.iter().zip(bodies).fold(true, |covered, (home, body)| {
                covered & home.covers(body.position + body.velocity * substep)
            })
    }

    /// Searches anew.
    pub(super) fn search(&mut self, mut cargo: Cargo<'_>, setting: &Setting, pairs: bool) {
        if self.searches % SEARCHES_PER_ORDER == 1 {
            self.put_in_order(&mut cargo);
        }
        self.searches += 1;
        self.stale = false;
        let bodies: &[Body] = cargo.bodies;
        self.kept.take(&self.pairs, &self.holds, &self.beside, bodies.len());
        self.find_homes(bodies, setting);
        if setting.walls.is_some() {
            self.find_walls(bodies, setting);
        }
        if pairs {
            self.find_pairs(bodies, setting);
        }
    }

    /// Gives balls anew what holds them: pairs that are not near any more hold nothing.
    pub(super) fn push_again(&self, bodies: &mut [Body]) {
        for body in bodies.iter_mut() {
            body.velocity = body.free;
        }
        for (pair, hold) in self.pairs.iter().zip(&self.holds) {
            let push = hold.normal * hold.impulse + hold.grip;
            let (first, second) = (pair.first as usize, pair.second as usize);
            bodies[first].velocity += push * bodies[first].inverse_mass;
            bodies[second].velocity -= push * bodies[second].inverse_mass;
        }
        for beside in &self.beside {
            bodies[beside.body as usize].velocity += beside.push;
        }
    }

    /// Covers a ball that was hit so that it goes as far as `end` in this substep, if it is not covered there. Whether
    /// that has found new pairs.
    pub(super) fn widen(&mut self, at: usize, end: DVec2, bodies: &[Body], rests: bool) -> bool {
        let Self { pairs, holds, held, homes, .. } = self;
        let far = end.distance(homes[at].position);
        if far <= homes[at].reach {
            return false;
        }
        let before = pairs.len();
        let was = homes[at].reach;
        // Twice as far, since it may be hit again.
        homes[at].reach = 2.0 * far;
        let home = homes[at];
        for (other, (body, its)) in bodies.iter().zip(&*homes).enumerate() {
            let reach = bodies[at].radius + body.radius + its.reach;
            let distance = its.position.distance(home.position);
            let give = bodies[at].inverse_mass + body.inverse_mass;
            if other != at && give > 0.0 && distance <= reach + home.reach && distance > reach + was {
                pairs.push(Pair { first: at as u32, second: other as u32 });
                if rests {
                    holds.push(Hold { mass: give.recip(), ..Hold::NONE });
                    held.push(false);
                }
            }
        }
        pairs.len() > before
    }

    fn find_homes(&mut self, bodies: &[Body], setting: &Setting) {
        let horizon = if bodies.len() <= FEW { FEW_HORIZON } else { HORIZON };
        let time = horizon * setting.substep;
        let squares: f64 = bodies.iter().map(|body| body.velocity.length_squared()).sum();
        let usual = (squares / bodies.len() as f64).sqrt();
        let fall = 0.5 * horizon * time * setting.kick.length();
        self.homes.clear();
        self.homes.extend(bodies.iter().map(|body| {
            let reach = if body.inverse_mass > 0.0 {
                body.velocity.length().max(usual) * time + fall + SKIN * body.radius
            } else {
                0.0
            };
            Home { position: body.position, reach }
        }));
    }

    fn find_walls(&mut self, bodies: &[Body], setting: &Setting) {
        self.beside.clear();
        for (at, (body, home)) in bodies.iter().zip(&self.homes).enumerate() {
            let arm = DVec2::splat(body.radius + home.reach);
            let clear = home.position.cmpgt(arm) & home.position.cmplt(setting.size - arm);
            if !clear.all() && body.inverse_mass > 0.0 {
                self.beside.push(Beside { body: at as u32, push: self.kept.by_wall(at) });
            }
        }
    }

    #[inline]
    fn find_pairs(&mut self, bodies: &[Body], setting: &Setting) {
        self.discs.clear();
        self.discs.extend(
            bodies
                .iter()
                .zip(&self.homes)
                .map(|(body, home)| Reach { centre: home.position, radius: body.radius + home.reach }),
        );
        let Self { grid, pairs, holds, held, kept, heights, discs, .. } = self;
        if discs.len() <= FEW {
            pairs.clear();
            for (i, one) in discs.iter().enumerate() {
                for (j, other) in discs.iter().enumerate().skip(i + 1) {
                    if touch(one.centre, one.radius, other.centre, other.radius) {
                        pairs.push(Pair { first: i as u32, second: j as u32 });
                    }
                }
            }
        } else {
            let sum: f64 = discs.iter().map(|disc| disc.radius).sum();
            let suits =
                |(grid, made): &(Grid, f64)| sum < MISFIT * made && sum > made / MISFIT && !grid.misfits();
            let (grid, _) = match grid {
                Some(grid) if suits(grid) => grid,
                _ => grid.insert((Grid::for_discs(discs, setting.size), sum)),
            };
            grid.collect(discs, pairs, |first, second| Pair { first, second });
        }
        let fixed = |at: u32| bodies[at as usize].inverse_mass == 0.0;
        if bodies.iter().any(|body| body.inverse_mass == 0.0) {
            pairs.retain(|pair| !(fixed(pair.first) && fixed(pair.second)));
        }
        if setting.kick != DVec2::ZERO {
            heights.sort(pairs, bodies, -setting.kick.normalize_or_zero());
        }
        if setting.rests {
            holds.clear();
            holds.extend(pairs.iter().map(|pair| {
                let (first, second) = (&bodies[pair.first as usize], &bodies[pair.second as usize]);
                let mass = (first.inverse_mass + second.inverse_mass).recip();
                kept.by_ball(*pair).map_or(Hold { mass, ..Hold::NONE }, |hold| Hold { mass, ..hold })
            }));
            held.clear();
            held.extend(holds.iter().map(|hold| hold.impulse > 0.0));
        }
    }

    /// Puts the balls in the order in which the last search found them in the cells: neighbours in space are neighbours
    /// in memory then.
    #[inline]
    fn put_in_order(&mut self, cargo: &mut Cargo<'_>) {
        let Some((grid, _)) = &self.grid else { return };
        let order: Vec<u32> = grid.order().collect();
        let mut place = vec![0; order.len()];
        for (at, &was) in (0..).zip(&order) {
            place[was as usize] = at;
        }
        cargo.permute(&order);
        for pair in &mut self.pairs {
            (pair.first, pair.second) = (place[pair.first as usize], place[pair.second as usize]);
        }
        for beside in &mut self.beside {
            beside.body = place[beside.body as usize];
        }
        self.beside.sort_unstable_by_key(|beside| beside.body);
    }
}

impl Cargo<'_> {
    fn permute(&mut self, order: &[u32]) {
        fn permuted<T: Copy>(items: &[T], order: &[u32]) -> Vec<T> {
            order.iter().map(|&at| items[at as usize]).collect()
        }
        *self.bodies = permuted(self.bodies, order);
        *self.restitutions = permuted(self.restitutions, order);
        *self.ids = permuted(self.ids, order);
        *self.hit = permuted(self.hit, order);
        if !self.before.is_empty() {
            *self.before = permuted(self.before, order);
        }
    }
}
