//! Which balls may touch each other, or a wall, before long.
//!
//! A search finds all pairs that can meet while no ball is farther than its *reach* from where it was then (its *home*;
//! Verlet 1967). A search holds until a ball is about to go farther, so a pile at rest is searched once.

use glam::DVec2;

use super::super::grid::{Disc, Grid, touch};
use super::order::{Heights, Kept, Known, Links};
use super::sleep::Rest;
use super::{Body, Setting};

/// A ball may go so much of its radius, whatever its speed, before pairs are searched anew.
const SKIN: f64 = 0.1;
/// ... and as far as its speed, or the root mean square of all speeds, takes it in so many substeps.
const HORIZON: f64 = 3.0;
/// The same for few balls, all pairs of which are soon compared.
const FEW_HORIZON: f64 = 6.0;
/// The most balls that are few: comparing all pairs is cheaper than keeping a grid.
pub(super) const FEW: usize = 40;
/// Balls are put in the order of their places once in so many searches.
const SEARCHES_PER_ORDER: u32 = 16;
/// Cells are made anew where discs have become larger or smaller than those that they were made for by this factor.
const MISFIT: f64 = 1.25;

/// The place of a ball that is not beside a wall.
const NOWHERE: u32 = u32::MAX;

/// What the last search found.
#[derive(Debug, Default)]
pub(super) struct Near {
    /// Where there is gravity, the first is the upper one, and pairs stand in the order of its height, from the lowest up,
    /// before those that were added since.
    pub(super) pairs: Vec<Pair>,
    /// For each pair; empty where nothing rests.
    pub(super) holds: Vec<Hold>,
    /// For each of these, whether they pressed on each other, or met, in the last substep.
    pub(super) held: Vec<bool>,
    /// For each pair, whether nothing moves either of its balls.
    pub(super) idle: Vec<bool>,
    /// For each pair, whether it may come close enough in this substep to be held apart.
    pub(super) close: Vec<bool>,
    /// Balls that may touch a wall.
    pub(super) beside: Vec<Beside>,
    /// For each ball its place among them, or [`NOWHERE`].
    pub(super) places_beside: Vec<u32>,
    pub(super) homes: Vec<Home>,
    /// Balls that were kept from going where they are not covered.
    pub(super) strays: Vec<u32>,
    /// Whether pairs are looked for.
    pub(super) seeks_pairs: bool,
    /// How many pairs the search found; others were added since.
    pub(super) found: usize,
    /// Balls that were covered anew since the search.
    pub(super) moved: Vec<u32>,
    pub(super) discs: Vec<Reach>,
    pub(super) grid: Option<(Grid, f64)>,
    /// The root mean square of all speeds at the search, px/s.
    usual: f64,
    searches: u32,
    kept: Kept,
    heights: Heights,
    pub(super) links: Links,
    pub(super) known: Known,
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

/// What holds a ball in a substep, px/s.
pub(super) struct Given {
    /// The sum.
    pub(super) velocity: DVec2,
    /// The sum of the sizes, whatever their directions.
    pub(super) pressed: f64,
}

/// A ball that may touch a wall.
#[derive(Debug, Clone, Copy)]
pub(super) struct Beside {
    pub(super) body: u32,
    /// The velocity that the walls give it in a substep, px/s.
    pub(super) push: DVec2,
}

/// Where a ball was when it was last covered, and how far from there it is, px.
#[derive(Debug, Clone, Copy)]
pub(super) struct Home {
    pub(super) position: DVec2,
    pub(super) reach: f64,
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
pub(super) struct Reach {
    pub(super) centre: DVec2,
    pub(super) radius: f64,
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
    pub(super) rests: &'a mut Vec<Rest>,
    /// Where they were a substep ago; empty where that is not needed.
    pub(super) before: &'a mut Vec<(DVec2, DVec2)>,
}

impl Near {
    /// Searches anew.
    pub(super) fn search(&mut self, mut cargo: Cargo<'_>, setting: &Setting, pairs: bool) {
        if self.searches % SEARCHES_PER_ORDER == 1 {
            self.put_in_order(&mut cargo);
        }
        self.searches += 1;
        self.seeks_pairs = pairs;
        self.moved.clear();
        self.strays.clear();
        self.links.clear();
        let bodies: &[Body] = cargo.bodies;
        self.kept.take(&self.pairs, &self.holds, &self.beside, bodies.len());
        self.find_homes(bodies, setting);
        if setting.walls.is_some() {
            self.find_walls(bodies, cargo.rests, setting);
        }
        if pairs {
            self.find_pairs(bodies, cargo.rests, setting);
        }
        self.found = self.pairs.len();
    }

    /// Finds the mass of a pair anew, and whether it is idle.
    #[inline]
    pub(super) fn weigh(&mut self, at: usize, bodies: &[Body]) {
        let pair = self.pairs[at];
        let give = bodies[pair.first as usize].inverse_mass + bodies[pair.second as usize].inverse_mass;
        self.idle[at] = give == 0.0;
        if let Some(hold) = self.holds.get_mut(at) {
            hold.mass = give.recip();
        }
    }

    /// The same for all pairs.
    pub(super) fn weigh_all(&mut self, bodies: &[Body]) {
        self.idle.resize(self.pairs.len(), false);
        for at in 0..self.pairs.len() {
            self.weigh(at, bodies);
        }
    }

    /// The same for all pairs of a ball, which must be linked.
    pub(super) fn weigh_pairs_of(&mut self, body: u32, bodies: &[Body]) {
        let mut link = self.links.last(body);
        while let Some(at) = link {
            self.weigh(at.pair(), bodies);
            link = self.links.before(at);
        }
    }

    /// What others and walls give a ball of this inverse mass in a substep. Its pairs must be linked.
    pub(super) fn given(&self, body: u32, inverse_mass: f64) -> Given {
        let mut given = Given { velocity: DVec2::ZERO, pressed: 0.0 };
        for at in self.pairs_of(body) {
            let hold = &self.holds[at];
            let push = (hold.normal * hold.impulse + hold.grip) * inverse_mass;
            given.velocity += if self.pairs[at].first == body { push } else { -push };
            given.pressed += hold.impulse * inverse_mass;
        }
        if let Some(at) = self.place_beside(body) {
            given.velocity += self.beside[at].push;
            given.pressed += self.beside[at].push.length();
        }
        given
    }

    /// Links each of so many balls to its pairs, as far as they are not linked yet.
    pub(super) fn link_pairs(&mut self, count: usize) {
        self.links.link(&self.pairs, count);
    }

    /// The places of a ball's pairs, as far as they are linked.
    #[inline]
    pub(super) fn pairs_of(&self, body: u32) -> impl Iterator<Item = usize> {
        self.links.of(body)
    }

    /// The place of a ball among those beside walls, if it is one of them.
    pub(super) fn place_beside(&self, body: u32) -> Option<usize> {
        self.places_beside.get(body as usize).filter(|&&place| place != NOWHERE).map(|&place| place as usize)
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
            let body = &mut bodies[beside.body as usize];
            if body.inverse_mass > 0.0 {
                body.velocity += beside.push;
            }
        }
    }

    fn find_homes(&mut self, bodies: &[Body], setting: &Setting) {
        let squares: f64 = bodies.iter().map(|body| body.velocity.length_squared()).sum();
        self.usual = (squares / bodies.len() as f64).sqrt();
        let cover = self.cover(bodies.len(), setting);
        self.homes.clear();
        self.homes.extend(bodies.iter().map(cover));
    }

    /// How each of so many balls is covered where it is now.
    pub(super) fn cover(&self, count: usize, setting: &Setting) -> impl Fn(&Body) -> Home + use<> {
        let horizon = if count <= FEW { FEW_HORIZON } else { HORIZON };
        let (time, usual) = (horizon * setting.substep, self.usual);
        let fall = 0.5 * horizon * time * setting.kick.length();
        move |body| {
            let moves = body.inverse_mass > 0.0;
            let far = if moves { body.velocity.length().max(usual) * time + fall } else { 0.0 };
            Home { position: body.position, reach: far + SKIN * body.radius }
        }
    }

    /// How far a ball is covered at least around its way, px.
    pub(super) fn skin(&self, body: &Body, setting: &Setting) -> f64 {
        SKIN * body.radius + self.usual * setting.substep
    }

    fn find_walls(&mut self, bodies: &[Body], rests: &[Rest], setting: &Setting) {
        self.beside.clear();
        self.places_beside.clear();
        self.places_beside.resize(bodies.len(), NOWHERE);
        for (at, (body, home)) in bodies.iter().zip(&self.homes).enumerate() {
            let clear = is_clear(home.position, body.radius + home.reach, setting.size);
            if !clear && rests[at].weight > 0.0 {
                self.places_beside[at] = self.beside.len() as u32;
                self.beside.push(Beside { body: at as u32, push: self.kept.by_wall(at) });
            }
        }
    }

    #[inline]
    fn find_pairs(&mut self, bodies: &[Body], rests: &[Rest], setting: &Setting) {
        self.discs.clear();
        self.discs.extend(
            bodies
                .iter()
                .zip(&self.homes)
                .map(|(body, home)| Reach { centre: home.position, radius: body.radius + home.reach }),
        );
        let Self { grid, pairs, holds, held, close, kept, heights, discs, .. } = self;
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
        let fixed = |at: u32| rests[at as usize].weight == 0.0;
        if rests.iter().any(|rest| rest.weight == 0.0) {
            pairs.retain(|pair| !(fixed(pair.first) && fixed(pair.second)));
        }
        if setting.kick != DVec2::ZERO {
            heights.sort(pairs, bodies, -setting.kick.normalize_or_zero());
        }
        close.clear();
        close.resize(pairs.len(), true);
        if setting.rests {
            holds.clear();
            holds.extend(pairs.iter().map(|pair| kept.by_ball(*pair).unwrap_or(Hold::NONE)));
            held.clear();
            held.extend(holds.iter().map(|hold| hold.impulse > 0.0));
        }
        self.weigh_all(bodies);
    }

    /// Puts the balls in the order in which the last search found them in the cells: neighbours in space are neighbours
    /// in memory then.
    #[inline]
    fn put_in_order(&mut self, cargo: &mut Cargo<'_>) {
        let Some((grid, _)) = &self.grid else { return };
        let order: Vec<u32> = grid.order().collect();
        if order.len() != cargo.bodies.len() {
            // Balls were added since.
            return;
        }
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
    }
}

/// Whether a disc lies clear of all walls.
#[inline]
pub(super) fn is_clear(centre: DVec2, radius: f64, size: DVec2) -> bool {
    let arm = DVec2::splat(radius);
    (centre.cmpgt(arm) & centre.cmplt(size - arm)).all()
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
        *self.rests = permuted(self.rests, order);
        if !self.before.is_empty() {
            *self.before = permuted(self.before, order);
        }
    }
}
