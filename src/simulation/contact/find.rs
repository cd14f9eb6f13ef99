//! Which balls may touch each other, or a wall, before long (broad phase).
//!
//! A search finds all pairs that can meet while no ball is farther than its *reach* from where it was then (its *home*;
//! Verlet 1967). A search holds until a ball is about to go farther, so a pile at rest is searched once.

use glam::{DVec2, Vec2Swizzles};

use super::super::grid::{Grid, touch};
use super::constraints::{Constraint, Marks, Pair};
use super::cover::{Covered, Home};
use super::layout::{Layer, Layout};
use super::near::{Cells, Gathered, Near};
use super::show::Start;
use super::sleep::Rest;
use super::stripes::{NOWHERE, Stripe, clear_all};
use super::team::Team;
use super::{Body, Setting};

/// A ball may go so much of its radius, whatever its speed, before pairs are searched anew.
const SKIN: f64 = 0.1;
/// ... and as far as speeds take it in so many substeps: one that is slow through a part of the way at the root mean square
/// of all speeds, since a fast one may hit it; one that is fast ahead of it, from where it is.
const HORIZON: f64 = 3.0;
/// That part, and the least radius of what covers a ball's own way, as a part of this way: one half would be just the way,
/// and what presses may push a ball back.
const COVERED: (f64, f64) = (0.25, 0.6);
/// The same where nothing rests. Nearly all balls are covered in discs of one size then, which suit one size of cells, and
/// the fastest leave theirs.
const COVERED_IN_FLIGHT: (f64, f64) = (1.0, 0.25);
/// The horizon where nothing rests, so that balls go straight on until they are hit.
const HORIZON_OF_FLIGHT: f64 = 4.0;
/// That of few balls, all pairs of which are soon compared.
const FEW_HORIZON: f64 = 6.0;
/// The most balls that are few: comparing all pairs is cheaper than keeping a grid.
pub(super) const FEW_IN_ALL: usize = 40;
/// Balls are put in the order of their places once in so many searches.
const SEARCHES_PER_ORDER: u32 = 16;
/// Cells are made for discs larger than those that there are by this factor ...
const ROOM: f64 = 1.04;
/// ... and anew where discs have become larger than that, or smaller by this factor.
const MISFIT: f64 = 1.25;

/// Balls are covered for a shorter time where more pairs than so many for each were found, and for a longer one again where
/// less than so many ...
const NEAR_EACH: (usize, usize) = (4, 16);
/// ... since what covers them is so many times as wide as they are.
const WIDE: f64 = 2.5;
/// How much shorter that becomes, less one, at most.
const HASTE: u32 = 3;

/// What balls carry from one search to the next: lists with one entry a ball, which are put in a new order together.
pub(super) struct Cargo<'a> {
    pub(super) bodies: &'a mut Vec<Body>,
    pub(super) restitutions: &'a mut Vec<f64>,
    pub(super) ids: &'a mut Vec<u32>,
    pub(super) hit: &'a mut Vec<bool>,
    pub(super) rests: &'a mut Vec<Rest>,
    /// Where they were a substep ago; empty where that is not needed.
    pub(super) before: &'a mut Vec<Start>,
}

impl Near {
    /// Searches anew.
    pub(super) fn search(&mut self, mut cargo: Cargo<'_>, setting: &Setting, team: &Team) {
        let places =
            if self.searches % SEARCHES_PER_ORDER == 1 { self.put_in_order(&mut cargo) } else { None };
        self.searches += 1;
        self.search_after(places.as_deref(), &cargo, setting, team);
    }

    /// The same after bodies came to these places in their order, where that is another now.
    pub(super) fn search_after(
        &mut self,
        places: Option<&[u32]>,
        cargo: &Cargo<'_>,
        setting: &Setting,
        team: &Team,
    ) {
        self.moved = 0;
        let bodies: &[Body] = cargo.bodies;
        self.keep(Layout::of(bodies.len()), places);
        clear_all(&mut self.stripes, self.layout, bodies.len());
        self.crossing.clear();
        self.crossing.resize(bodies.len(), Layer::Own);
        self.find_homes(bodies, cargo.rests, setting, team);
        self.found = 0;
        if self.seeks_pairs {
            self.find_pairs(bodies, setting, team);
            self.take_pairs(bodies, cargo.rests, setting, team);
            self.found = self.pair_count();
        }
        self.crowd = self.are_crowd(cargo.bodies);
        self.look_ahead(cargo.bodies);
    }

    /// Finds out for how long balls are to be covered after the next search: where they are so fast that this is for many
    /// others' places, each search costs less than what it found would.
    fn look_ahead(&mut self, bodies: &[Body]) {
        let (few, many) = NEAR_EACH;
        let covered: f64 = self.discs.iter().map(|disc| disc.radius).sum();
        let wide = covered > WIDE * bodies.iter().map(|body| body.radius).sum::<f64>();
        if self.found < few * bodies.len() {
            self.haste = self.haste.saturating_sub(1);
        } else if self.found > many * bodies.len() && wide && !self.crowd {
            self.haste = (self.haste + 1).min(HASTE);
        }
    }

    /// Covers all balls where they are, and finds those near walls.
    fn find_homes(&mut self, bodies: &[Body], rests: &[Rest], setting: &Setting, team: &Team) {
        let squares: f64 = bodies.iter().map(|body| body.velocity.length_squared()).sum();
        self.rms_speed = (squares / bodies.len() as f64).sqrt();
        let cover = self.cover(bodies.len(), setting);
        // Stripes lie along what presses, so that few pairs that carry much lie across their edges.
        let turned = self.layout.is_cut() && setting.kick.y.abs() > setting.kick.x.abs();
        if turned != self.turned {
            (self.turned, self.cells) = (turned, None);
        }
        let Self { layout, stripes, homes, discs, kept_pushes, .. } = self;
        let pushed = |at: usize| {
            let found = kept_pushes.binary_search_by_key(&(at as u32), |&(body, _)| body);
            found.map_or(DVec2::ZERO, |at| kept_pushes[at].1)
        };
        homes.resize(bodies.len(), Home { position: DVec2::ZERO, reach: 0.0 });
        discs.resize(bodies.len(), Covered { centre: DVec2::ZERO, radius: 0.0 });
        let shares = layout.share_read(Layer::Own, bodies);
        let shares = shares.zip(layout.share(Layer::Own, homes)).zip(layout.share(Layer::Own, discs));
        let shares = shares.zip(layout.share_read(Layer::Own, rests));
        let shares = shares.zip(layout.share_stripes(Layer::Own, stripes));
        team.each(shares, |((((bodies, homes), discs), rests), (number, stripe))| {
            for (own, ((body, home), disc)) in bodies.iter().zip(homes).zip(discs).enumerate() {
                *home = cover(body);
                let centre = in_cells(turned, home.position);
                let radius = body.radius + home.reach;
                *disc = Covered { centre, radius };
                let clear = setting.walls.is_none() || is_clear(home.position, radius, setting.size);
                if !clear && rests[own].counted > 0.0 {
                    stripe[0].add_beside(own as u32, pushed(layout.start(number) + own));
                }
            }
        });
    }

    /// How each of so many balls is covered where it is now.
    pub(super) fn cover(&self, count: usize, setting: &Setting) -> impl Fn(&Body) -> Home + use<> {
        let usual = if setting.can_rest { HORIZON } else { HORIZON_OF_FLIGHT };
        let hasty = (usual / f64::from(1 + self.haste)).max(1.0);
        let horizon = if count <= FEW_IN_ALL { FEW_HORIZON } else { hasty };
        let (of_all, of_own) = if setting.can_rest { COVERED } else { COVERED_IN_FLIGHT };
        let time = horizon * setting.substep;
        let least = of_all * self.rms_speed * time;
        let fall = 0.5 * horizon * time * setting.kick.length();
        move |body| {
            let skin = SKIN * body.radius;
            if body.inverse_mass == 0.0 {
                return Home { position: body.position, reach: skin };
            }
            let way = body.velocity.length() * time;
            let far = least.max(of_own * way);
            let ahead = (way - far).clamp(0.0, far);
            let ahead = if ahead > 0.0 { body.velocity * (time * ahead / way) } else { DVec2::ZERO };
            Home { position: body.position + ahead, reach: far + fall + skin }
        }
    }

    /// How far a ball is covered at least around its way, px.
    pub(super) fn skin(&self, body: &Body, setting: &Setting) -> f64 {
        SKIN * body.radius + self.rms_speed * setting.substep
    }

    /// Finds the pairs of balls.
    #[inline]
    fn find_pairs(&mut self, bodies: &[Body], setting: &Setting, team: &Team) {
        let Self { layout, stripes, cells, discs, gathered, turned, .. } = self;
        if bodies.len() <= FEW_IN_ALL {
            let pairs = &mut stripes[0].pairs;
            for (i, one) in discs.iter().enumerate() {
                for (j, other) in discs.iter().enumerate().skip(i + 1) {
                    if touch(one.centre, one.radius, other.centre, other.radius) {
                        pairs.push(Pair { first: i as u32, second: j as u32 });
                    }
                }
            }
            return;
        }
        let sum: f64 = discs.iter().map(|disc| disc.radius).sum();
        let suits = |cells: &Cells| {
            sum < ROOM * cells.made_for && sum > cells.made_for / MISFIT && !cells.grid.misfits()
        };
        let size = in_cells(*turned, setting.size);
        let Cells { grid, .. } = match cells {
            Some(cells) if suits(cells) => cells,
            _ => {
                let roomy = |disc: &Covered| Covered { radius: ROOM * disc.radius, ..*disc };
                let discs: Vec<Covered> = discs.iter().map(roomy).collect();
                cells.insert(Cells { grid: Grid::for_discs(&discs, size), made_for: sum })
            }
        };
        let pair = |first, second| Pair { first, second };
        let overlap = |first: u32, second: u32| {
            let (first, second) = (&bodies[first as usize], &bodies[second as usize]);
            touch(first.position, first.radius, second.position, second.radius)
        };
        if !layout.is_cut() {
            grid.collect(discs, &mut stripes[0].pairs, pair, overlap);
            return;
        }
        grid.sort_into_cells(discs);
        let (layout, grid) = (*layout, &*grid);
        let pieces = layout.stripes();
        let rows = grid.rows().div_ceil(pieces);
        gathered.resize_with(pieces + 1, Gathered::default);
        team.each(gathered.iter_mut().enumerate(), |(piece, Gathered { pairs, parted })| {
            if piece < pieces {
                let end = grid.rows().min((piece + 1) * rows);
                grid.collect_rows(end.min(piece * rows)..end, pairs, pair, overlap);
            } else {
                pairs.clear();
                grid.compare_large(&mut |first, second| pairs.push(pair(first, second)));
            }
            parted.resize_with(layout.len(), Vec::new);
            parted.iter_mut().for_each(Vec::clear);
            for pair in pairs {
                let number = layout.of_pair(pair.first as usize, pair.second as usize);
                parted[number].push(pair.within(layout.start(number)));
            }
        });
    }

    /// Gives the stripes the pairs that were found, in their order, with what is known of them.
    fn take_pairs(&mut self, bodies: &[Body], rests: &[Rest], setting: &Setting, team: &Team) {
        let Self { layout, stripes, gathered, crossing, .. } = self;
        let (layout, gathered) = (*layout, &*gathered);
        team.each(stripes.iter_mut().enumerate(), |(number, stripe)| {
            let start = layout.start(number).min(bodies.len());
            let bodies = &bodies[start..start + layout.count(number, bodies.len())];
            let Stripe { pairs, constraints, places_of_constraints, marks, kept, heights, .. } = &mut *stripe;
            kept.link(bodies.len());
            if layout.is_cut() {
                for part in gathered {
                    pairs.extend_from_slice(&part.parted[number]);
                }
            }
            if setting.has_fixed {
                let fixed = |at: u32| rests[start + at as usize].counted == 0.0;
                pairs.retain(|pair| !(fixed(pair.first) && fixed(pair.second)));
            }
            if setting.kick != DVec2::ZERO && !pairs.is_empty() {
                heights.sort(pairs, bodies, -setting.kick.normalize_or_zero());
            }
            marks.resize(pairs.len(), Marks::CLOSE);
            places_of_constraints.resize(pairs.len(), NOWHERE);
            for ((pair, mark), place) in pairs.iter().zip(marks).zip(places_of_constraints) {
                if let Some(constraint) = kept.of(*pair) {
                    mark.set(Marks::HELD | Marks::LIVE, true);
                    *place = constraints.len() as u32;
                    constraints.push(Constraint { pair: *pair, ..constraint });
                }
            }
            // Where none sleeps or is fixed, all weigh what they did.
            if bodies.iter().any(|body| body.inverse_mass == 0.0) {
                stripe.weigh_all(bodies);
            }
        });
        for layer in [Layer::Seams, Layer::Rest] {
            for number in layout.numbers(layer) {
                let start = layout.start(number);
                for pair in &stripes[number].pairs {
                    let pair = pair.from(start);
                    (crossing[pair.first as usize], crossing[pair.second as usize]) = (layer, layer);
                }
            }
        }
    }

    /// Puts the balls in the order in which the last search found them in the cells: neighbours in space are neighbours
    /// in memory then. The places that they have now, if that could be done.
    #[inline]
    fn put_in_order(&mut self, cargo: &mut Cargo<'_>) -> Option<Vec<u32>> {
        let Cells { grid, .. } = self.cells.as_ref()?;
        let order: Vec<u32> = grid.order().collect();
        if order.len() != cargo.bodies.len() {
            // Balls were added since.
            return None;
        }
        let mut places = vec![0; order.len()];
        for (at, &was) in (0..).zip(&order) {
            places[was as usize] = at;
        }
        cargo.permute(&order);
        Some(places)
    }
}

/// A place in the coordinates of the cells.
pub(super) fn in_cells(turned: bool, place: DVec2) -> DVec2 {
    if turned { place.yx() } else { place }
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
