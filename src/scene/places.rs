//! Places at which random balls overlap nothing.
//!
//! Balls are first thrown at random places, the largest first, as long as places are easy to find (random sequential
//! addition: it jams near 0.547 of the area for equal discs; Feder 1980). Denser fills stand on the sites of a
//! hexagonal lattice, as wide as the room allows, each shifted at random within its share.

use glam::DVec2;
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use rand::seq::SliceRandom;

use crate::simulation::Ball;

/// The most places that are drawn for one ball.
const MOST_DRAWS: u32 = 5000;
/// After so many balls in a row without a place the room counts as jammed.
const JAMMED: u32 = 4;
/// The most sites of a lattice that is tried, for each ball and in addition: where there are more, it is not the balls'
/// own density that leaves no place.
const SITES_PER_BALL: f64 = 8.0;
const MORE_SITES: f64 = 1e5;
/// How closely the pitch of the lattice is sought: halvings of the interval that it lies in.
const PITCH_STEPS: u32 = 20;

/// Places drawn at random, each with the index of its radius; fewer than radii where the room is jammed.
pub(super) fn throw(
    rng: &mut ChaCha8Rng,
    room: &Room,
    radii: &[f64],
    present: &[Ball],
) -> Vec<(usize, DVec2)> {
    let mut order: Vec<usize> = (0..radii.len()).collect();
    order.sort_by(|&a, &b| radii[b].total_cmp(&radii[a]));
    let widest = order.first().map_or(1.0, |&first| radii[first]);
    let mut taken = Taken::new(room, widest, present, radii.len());
    let mut places = Vec::with_capacity(radii.len());
    let mut failures = 0;
    for index in order {
        let radius = radii[index];
        let (low, high) = (room.low + radius, room.high - radius);
        let mut draw = || low + (high - low) * DVec2::new(rng.random(), rng.random());
        let fits = high.cmpge(low).all();
        let free = (0..MOST_DRAWS).map(|_| draw()).find(|&at| fits && taken.is_free(at, radius));
        if let Some(at) = free {
            taken.take(at, radius);
            places.push((index, at));
            failures = 0;
        } else {
            failures += 1;
            if failures == JAMMED {
                break;
            }
        }
    }
    places
}

/// Places on a hexagonal lattice, in random order and shifted at random; none where the room is too small.
pub(super) fn lay_out(
    rng: &mut ChaCha8Rng,
    room: &Room,
    radii: &[f64],
    widest: f64,
    present: &[Ball],
) -> Vec<(usize, DVec2)> {
    let taken = Taken::new(room, widest, present, 0);
    let sites = |pitch: f64| lattice(room, pitch, widest, &taken);
    let tightest = 2.0 * widest;
    let count = radii.len() as f64;
    if !(count..=SITES_PER_BALL * count + MORE_SITES).contains(&room.lattice_size(tightest, widest)) {
        return Vec::new();
    }
    // The widest pitch that still has a site for each ball.
    let (mut low, mut high) = (tightest, (room.high - room.low).max_element().max(tightest));
    for _ in 0..PITCH_STEPS {
        let middle = f64::midpoint(low, high);
        if room.lattice_size(middle, widest) >= count && sites(middle).len() >= radii.len() {
            low = middle;
        } else {
            high = middle;
        }
    }
    let mut places = sites(low);
    if places.len() < radii.len() {
        return Vec::new();
    }
    places.shuffle(rng);
    let shift = |(index, site): (usize, DVec2)| {
        let radius = radii[index];
        let reach = (low / 2.0 - radius) * (1.0 - 1e-9);
        let at = site + random_direction(rng) * (reach * rng.random::<f64>());
        (index, at.max(room.low + radius).min(room.high - radius))
    };
    places.into_iter().take(radii.len()).enumerate().map(shift).collect()
}

/// The lattice's sites of this pitch at which a ball of half the pitch meets nothing that is taken.
fn lattice(room: &Room, pitch: f64, widest: f64, taken: &Taken) -> Vec<DVec2> {
    let row_height = pitch * 3.0_f64.sqrt() / 2.0;
    let (low, high) = (room.low + widest, room.high - widest);
    let mut sites = Vec::new();
    let mut row = 0;
    loop {
        let y = low.y + f64::from(row) * row_height;
        if y > high.y {
            return sites;
        }
        let indent = if row % 2 == 0 { 0.0 } else { pitch / 2.0 };
        let mut column = 0;
        loop {
            let x = low.x + indent + f64::from(column) * pitch;
            if x > high.x {
                break;
            }
            if taken.is_free(DVec2::new(x, y), pitch / 2.0) {
                sites.push(DVec2::new(x, y));
            }
            column += 1;
        }
        row += 1;
    }
}

/// A unit vector in a random direction, without sines: a point drawn in the unit disc, set to length 1.
pub(super) fn random_direction(rng: &mut ChaCha8Rng) -> DVec2 {
    loop {
        let point = 2.0 * DVec2::new(rng.random(), rng.random()) - 1.0;
        let squared = point.length_squared();
        if squared <= 1.0 && squared > 1e-6 {
            return point / squared.sqrt();
        }
    }
}

/// The rectangle to fill.
pub(super) struct Room {
    pub(super) low: DVec2,
    pub(super) high: DVec2,
}

impl Room {
    /// Its area, px².
    pub(super) fn area(&self) -> f64 {
        let extent = self.high - self.low;
        extent.x * extent.y
    }

    /// The most sites that a lattice of this pitch has here: enough to refuse what can never fit.
    fn lattice_size(&self, pitch: f64, widest: f64) -> f64 {
        let inner = self.high - self.low - 2.0 * widest;
        if inner.min_element() < 0.0 {
            return 0.0;
        }
        let rows = inner.y / (pitch * 3.0_f64.sqrt() / 2.0) + 1.0;
        (inner.x / pitch + 1.0).floor() * rows.floor()
    }
}

/// The discs in a room: those of about a size in a grid of cells that are as wide as they are, so that each lies in four
/// cells at most, however large it is.
struct Taken {
    /// From the finest; cells are twice as wide from each to the next.
    grids: Vec<Cells>,
    /// A disc, and the next link of the chain.
    links: Vec<(u32, u32)>,
    /// Centres and radii, px.
    discs: Vec<(DVec2, f64)>,
}

/// The cells of one width.
struct Cells {
    /// The room's corner.
    low: DVec2,
    width: f64,
    columns: usize,
    rows: usize,
    /// The first link of each cell's chain.
    heads: Vec<u32>,
}

/// The end of a chain.
const NONE: u32 = u32::MAX;

impl Taken {
    /// The discs of `present`, with room for `more` of radii up to `widest`.
    fn new(room: &Room, widest: f64, present: &[Ball], more: usize) -> Self {
        let extent = (room.high - room.low).max(DVec2::splat(f64::MIN_POSITIVE));
        // No more than a few cells a ball, however small the balls.
        let least = (extent.x * extent.y / (4 * (present.len() + more) + 64) as f64).sqrt();
        let largest = present.iter().map(Ball::radius).fold(widest, f64::max);
        let finest = Cells::new(room.low, extent, (2.0 * widest).max(least));
        let coarser = |cells: &Cells| {
            let has_all = 2.0 * largest <= cells.width || cells.heads.len() == 1;
            (!has_all).then(|| Cells::new(room.low, extent, 2.0 * cells.width))
        };
        let grids = std::iter::successors(Some(finest), coarser).collect();
        let mut taken = Self { grids, links: Vec::new(), discs: Vec::new() };
        for ball in present {
            taken.take(ball.position(), ball.radius());
        }
        taken
    }

    fn take(&mut self, at: DVec2, radius: f64) {
        let disc = self.discs.len() as u32;
        self.discs.push((at, radius));
        // What is wider than all cells lies in the widest: then that is one for all of the room.
        let fitting = self.grids.iter().position(|cells| 2.0 * radius <= cells.width);
        let last = self.grids.len() - 1;
        let cells = &mut self.grids[fitting.unwrap_or(last)];
        for cell in cells.touched(at, radius) {
            self.links.push((disc, cells.heads[cell]));
            cells.heads[cell] = (self.links.len() - 1) as u32;
        }
    }

    fn is_free(&self, at: DVec2, radius: f64) -> bool {
        self.grids.iter().all(|cells| {
            cells.touched(at, radius).all(|cell| {
                let mut link = cells.heads[cell];
                while link != NONE {
                    let (disc, next) = self.links[link as usize];
                    let (position, other) = self.discs[disc as usize];
                    let reach = radius + other;
                    if at.distance_squared(position) < reach * reach {
                        return false;
                    }
                    link = next;
                }
                true
            })
        })
    }
}

impl Cells {
    fn new(low: DVec2, extent: DVec2, width: f64) -> Self {
        let count = |length: f64| ((length / width) as usize).min(1 << 20) + 1;
        let (columns, rows) = (count(extent.x), count(extent.y));
        Self { low, width, columns, rows, heads: vec![NONE; columns * rows] }
    }

    /// The cells that a disc's bounding box touches; those outside count as the border's.
    fn touched(&self, at: DVec2, radius: f64) -> impl Iterator<Item = usize> + use<> {
        let low = (at - radius - self.low) / self.width;
        let high = (at + radius - self.low) / self.width;
        // A cast from a float saturates: what lies before the first cell is in it.
        let columns = (low.x as usize).min(self.columns - 1)..=(high.x as usize).min(self.columns - 1);
        let rows = (low.y as usize).min(self.rows - 1)..=(high.y as usize).min(self.rows - 1);
        let width = self.columns;
        rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Discs of all sizes, in places that look random, inside and outside of a room.
    fn discs(count: u32) -> Vec<Ball> {
        let part = |index: u32, factor: f64| (f64::from(index + 1) * factor).fract();
        let disc = |index| {
            let at = DVec2::new(part(index, 0.618_034), part(index, 0.754_878)) * 900.0 - 150.0;
            Ball::new(at, 0.01 + 200.0 * part(index, 0.569_84).powi(12)).unwrap()
        };
        (0..count).map(disc).collect()
    }

    #[test]
    fn a_place_is_free_where_no_disc_of_any_size_is() {
        let room = Room { low: DVec2::new(20.0, 30.0), high: DVec2::new(620.0, 430.0) };
        let present = discs(100);
        let taken = Taken::new(&room, 2.0, &present, 50);
        assert!(taken.grids.len() > 3);
        let mut free = 0;
        for probe in discs(3000) {
            let (at, radius) = (probe.position(), probe.radius());
            let met = present.iter().any(|ball| {
                let reach = radius + ball.radius();
                at.distance_squared(ball.position()) < reach * reach
            });
            assert_eq!(taken.is_free(at, radius), !met, "{at} {radius}");
            free += u32::from(!met);
        }
        assert!((300..2700).contains(&free), "{free}");
    }

    #[test]
    fn discs_take_no_more_memory_the_larger_they_are() {
        let room = Room { low: DVec2::ZERO, high: DVec2::new(1280.0, 720.0) };
        for radius in [0.5, 3.0, 40.0, 360.0, 1e6] {
            let ball = |index| Ball::new(DVec2::new(f64::from(index) / 10.0, 300.0), radius).unwrap();
            let present: Vec<Ball> = (0..5000).map(ball).collect();
            let taken = Taken::new(&room, 1.0, &present, 1);
            assert!(taken.links.len() <= 4 * present.len(), "{radius}: {} links", taken.links.len());
            let cells: usize = taken.grids.iter().map(|cells| cells.heads.len()).sum();
            assert!(cells <= 10 * present.len(), "{radius}: {cells} cells");
        }
    }
}
