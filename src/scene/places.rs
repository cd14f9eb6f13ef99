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

/// The discs in a room, each in every cell that its bounding box touches.
struct Taken {
    low: DVec2,
    cell: f64,
    columns: usize,
    rows: usize,
    /// The first link of each cell's chain.
    heads: Vec<u32>,
    /// A disc, and the next link of the chain.
    links: Vec<(u32, u32)>,
    /// Centres and radii, px.
    discs: Vec<(DVec2, f64)>,
}

/// The end of a chain.
const NONE: u32 = u32::MAX;

impl Taken {
    /// The discs of `present`, with room for `more` of radii up to `widest`.
    fn new(room: &Room, widest: f64, present: &[Ball], more: usize) -> Self {
        let extent = (room.high - room.low).max(DVec2::splat(f64::MIN_POSITIVE));
        // No more than a few cells a ball, however small the balls.
        let least = (extent.x * extent.y / (4 * (present.len() + more) + 64) as f64).sqrt();
        let cell = (2.0 * widest).max(least);
        let count = |length: f64| ((length / cell) as usize).min(1 << 20) + 1;
        let (columns, rows) = (count(extent.x), count(extent.y));
        let heads = vec![NONE; columns * rows];
        let mut taken =
            Self { low: room.low, cell, columns, rows, heads, links: Vec::new(), discs: Vec::new() };
        for ball in present {
            taken.take(ball.position(), ball.radius());
        }
        taken
    }

    /// The cells that a disc's bounding box touches; those outside count as the border's.
    fn cells(&self, at: DVec2, radius: f64) -> impl Iterator<Item = usize> + use<> {
        let low = (at - radius - self.low) / self.cell;
        let high = (at + radius - self.low) / self.cell;
        // A cast from a float saturates: what lies before the first cell is in it.
        let columns = (low.x as usize).min(self.columns - 1)..=(high.x as usize).min(self.columns - 1);
        let rows = (low.y as usize).min(self.rows - 1)..=(high.y as usize).min(self.rows - 1);
        let width = self.columns;
        rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
    }

    fn take(&mut self, at: DVec2, radius: f64) {
        let disc = self.discs.len() as u32;
        self.discs.push((at, radius));
        for cell in self.cells(at, radius) {
            self.links.push((disc, self.heads[cell]));
            self.heads[cell] = (self.links.len() - 1) as u32;
        }
    }

    fn is_free(&self, at: DVec2, radius: f64) -> bool {
        self.cells(at, radius).all(|cell| {
            let mut link = self.heads[cell];
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
    }
}
