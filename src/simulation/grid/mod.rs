//! Broad phase: which balls touch, without asking every pair.
//!
//! Balls are sorted by counting into the cells of a uniform grid, and each is compared with those of its own and the
//! neighbouring cells. The grid is a torus: a cell far away shares its place with one near by, so that balls may be
//! anywhere and the grid stays small; a pair found by that coincidence fails the comparison of true distances. A ball
//! too big for the cells looks up the cells that it reaches instead, so one giant among grains costs only itself.

mod collect;
mod insert;

use std::ops::Range;

use glam::DVec2;

use super::ball::Ball;
use insert::Insertions;

/// A uniform grid over balls, reused from frame to frame.
#[derive(Debug, Clone)]
pub struct Grid {
    /// Cells per px on each axis.
    density: DVec2,
    /// Columns and rows, powers of two, at least 4 so that a cell's neighbours are all different.
    columns: usize,
    rows: usize,
    /// The largest radius that the cells are wide enough for.
    reach: f64,
    /// Where each cell's balls begin in `sorted`; one more than there are cells.
    starts: Vec<u32>,
    cell_of: Vec<u32>,
    sorted: Vec<Entry>,
    large: Vec<Entry>,
    /// What was inserted since.
    inserted: Box<Insertions>,
    touching: Vec<(u32, u32)>,
}

/// What a grid needs to know of what it sorts.
pub(super) trait Disc {
    /// The centre, px.
    fn centre(&self) -> DVec2;
    /// The radius, px.
    fn radius(&self) -> f64;
}

impl Disc for Ball {
    fn centre(&self) -> DVec2 {
        self.position
    }

    fn radius(&self) -> f64 {
        self.radius
    }
}

/// What the comparison needs of a ball, side by side in the order of the cells.
#[derive(Debug, Clone, Copy, Default)]
struct Entry {
    position: DVec2,
    radius: f64,
    index: u32,
}

/// A part of a cell that covers the rounding of coordinates: 2⁻¹² of a cell while they are less than [`FAR`] cells.
const EDGE: f64 = 1.0 / 1024.0;
/// Cells are this much wider than the largest diameter, so that rounding never puts two touching balls two
/// cells apart.
const MARGIN: f64 = 1.0 + EDGE;
/// Coordinates are clamped to this many cells: all that is farther out shares the outermost ones.
const FAR: f64 = (1_u64 << 40) as f64;
/// Adding this to a number of less than 2⁵¹ leaves its nearest integer in the low bits of the sum.
const ROUND_TO_BITS: f64 = 1.5 * (1_u64 << 52) as f64;
/// Cells on an axis are doubled fewer times than this: their product, before it is cut to the number of balls, still
/// fits in 32 bits.
const MOST_DOUBLINGS: usize = 14;
/// The fewest cells on an axis: with four, a cell's neighbours on both sides are different cells.
const FEWEST: usize = 4;
/// Marks a ball that is kept out of the cells.
const NO_CELL: u32 = u32::MAX;
impl Grid {
    /// A grid with cells that suit the radii of `balls` in a world of `size` px. It stays right, if not fast, for any
    /// other balls.
    #[must_use]
    pub fn new(balls: &[Ball], size: DVec2) -> Self {
        Self::for_discs(balls, size)
    }

    /// The same for discs of any kind.
    pub(super) fn for_discs(discs: &[impl Disc], size: DVec2) -> Self {
        let reach = best_reach(discs);
        let width = 2.0 * MARGIN * reach;
        // The cells that an axis takes, up to the next power of two.
        let axis = |length: f64| {
            let counts = std::iter::successors(Some(FEWEST), |count| Some(2 * count)).take(MOST_DOUBLINGS);
            counts.take_while(|&count| (count / 2) as f64 * width < length).last().unwrap_or(FEWEST)
        };
        let (mut columns, mut rows) = (axis(size.x), axis(size.y));
        // About two cells a ball are enough: in a wide world the torus goes round more than once.
        let most = (2 * discs.len()).max(FEWEST * FEWEST);
        while columns * rows > most {
            if columns > rows { columns /= 2 } else { rows /= 2 }
        }
        Self {
            density: DVec2::splat(width.recip()),
            columns,
            rows,
            reach,
            starts: Vec::new(),
            cell_of: Vec::new(),
            sorted: Vec::new(),
            large: Vec::new(),
            inserted: Box::default(),
            touching: Vec::new(),
        }
    }

    /// Finds all pairs of `balls` that touch: (xᵢ−xⱼ)² + (yᵢ−yⱼ)² ≤ (rᵢ+rⱼ)², in no particular order.
    ///
    /// Balls with a NaN or an infinity touch nothing.
    pub fn find(&mut self, balls: &[Ball]) {
        self.find_up_to(usize::MAX, balls);
    }

    /// The same, unless there are more pairs than `most`: then none of them is kept. Whether all were.
    pub(super) fn find_up_to(&mut self, most: usize, balls: &[Ball]) -> bool {
        let mut touching = std::mem::take(&mut self.touching);
        touching.clear();
        self.sort_into_cells(balls);
        // No ball is compared any more once they are too many: a hundred thousand at one point have five billion pairs.
        self.neighbours(0..self.rows, &mut |ball, others| {
            if touching.len() <= most {
                compare(ball, others, &mut |i, j| touching.push((i, j)));
            }
        });
        self.compare_large(&mut |i, j| {
            if touching.len() <= most {
                touching.push((i, j));
            }
        });
        let too_many = touching.len() > most;
        if too_many {
            touching = Vec::new();
        }
        self.touching = touching;
        !too_many
    }

    /// Calls `contact` with each pair (i, j), i < j, that touches, in no particular order, and keeps none of them.
    pub fn for_each(&mut self, balls: &[Ball], mut contact: impl FnMut(u32, u32)) {
        self.sort_into_cells(balls);
        self.neighbours(0..self.rows, &mut |ball, others| compare(ball, others, &mut contact));
        self.compare_large(&mut contact);
    }

    /// How many rows of cells there are.
    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    /// Whether the last search compared more pairs of discs that are too large for the cells than there are discs:
    /// other cells would suit them better.
    pub(super) fn misfits(&self) -> bool {
        self.large.len().pow(2) / 2 > self.sorted.len() + self.large.len()
    }

    /// The order in which the discs of the last search stand in the cells, row by row, and after them those too large.
    pub(super) fn order(&self) -> impl Iterator<Item = u32> {
        self.sorted.iter().chain(&self.large).map(|entry| entry.index)
    }

    /// Brings the pairs found into the order in which a loop over i and j > i meets them.
    ///
    /// Pairs that share no ball could be solved in any order; those that share one could not.
    pub fn sort(&mut self) {
        self.touching.sort_unstable();
    }

    /// The pairs (i, j), i < j, that the last [`find`](Self::find) found.
    #[must_use]
    pub fn touching(&self) -> &[(u32, u32)] {
        &self.touching
    }

    /// A counting sort of the balls by cell, those too large for the cells apart.
    pub(super) fn sort_into_cells(&mut self, discs: &[impl Disc]) {
        self.starts.clear();
        self.starts.resize(self.columns * self.rows + 1, 0);
        self.cell_of.clear();
        self.large.clear();
        self.inserted.clear();
        for (index, disc) in discs.iter().enumerate() {
            if disc.radius() > self.reach {
                self.cell_of.push(NO_CELL);
                self.large.push(Entry::new(index, disc));
                continue;
            }
            let centre = disc.centre() * self.density;
            let (column, row) = (wrap(centre.x, self.columns), wrap(centre.y, self.rows));
            let cell = row * self.columns + column;
            self.starts[cell] += 1;
            self.cell_of.push(cell as u32);
        }
        // Counts become ends; filling from the back turns ends into starts.
        let mut end = 0;
        for start in &mut self.starts {
            end += *start;
            *start = end;
        }
        self.sorted.resize(end as usize, Entry::default());
        for (index, (disc, &cell)) in discs.iter().zip(&self.cell_of).enumerate().rev() {
            if cell != NO_CELL {
                let start = &mut self.starts[cell as usize];
                *start -= 1;
                self.sorted[*start as usize] = Entry::new(index, disc);
            }
        }
    }

    /// Calls `visit` with each ball in a cell of these rows and those that it is to be compared with, in groups: those after
    /// it there, and those of the cells east, south-west, south and south-east, so that each pair of neighbouring cells is
    /// visited once.
    #[inline]
    fn neighbours(&self, among: Range<usize>, visit: &mut impl FnMut(&Entry, &[Entry])) {
        let Self { columns, rows, starts, sorted, .. } = self;
        let (last_column, last_row) = (*columns - 1, *rows - 1);
        let range = |first: usize, last: usize| starts[first] as usize..starts[last + 1] as usize;
        for row in among {
            let here = row * *columns;
            let south = if row == last_row { 0 } else { here + *columns };
            for column in 0..*columns {
                let own = range(here + column, here + column);
                if own.is_empty() {
                    continue;
                }
                // Neighbours in a row are neighbours in `sorted`, so two ranges serve, except at the torus's seam.
                let (east, seam_east) = if column == last_column {
                    (own.clone(), range(here, here))
                } else {
                    (range(here + column, here + column + 1), 0..0)
                };
                let (below, seam_below) = if column == 0 {
                    (range(south, south + 1), range(south + last_column, south + last_column))
                } else if column == last_column {
                    (range(south + column - 1, south + column), range(south, south))
                } else {
                    (range(south + column - 1, south + column + 1), 0..0)
                };
                for at in own {
                    let ball = &sorted[at];
                    visit(ball, &sorted[at + 1..east.end]);
                    visit(ball, &sorted[below.clone()]);
                    if !(seam_east.is_empty() && seam_below.is_empty()) {
                        visit(ball, &sorted[seam_east.clone()]);
                        visit(ball, &sorted[seam_below.clone()]);
                    }
                }
            }
        }
    }

    /// Compares each large ball with the cells that it reaches, and with the other large ones.
    pub(super) fn compare_large(&self, contact: &mut impl FnMut(u32, u32)) {
        for (at, ball) in self.large.iter().enumerate() {
            compare(ball, &self.large[at + 1..], contact);
            self.reached(ball.position, ball.radius, |cell| compare(ball, self.in_cell(cell), contact));
        }
    }

    /// The discs that were sorted to a cell.
    fn in_cell(&self, cell: usize) -> &[Entry] {
        &self.sorted[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// Calls `visit` with each cell that a disc of `radius` about `centre` reaches.
    fn reached(&self, centre: DVec2, radius: f64, mut visit: impl FnMut(usize)) {
        let Self { density, columns, rows, reach, .. } = self;
        let arm = DVec2::splat(radius + *reach);
        let low = (centre - arm) * *density - EDGE;
        let high = (centre + arm) * *density + EDGE;
        for row in span(low.y, high.y, *rows) {
            for column in span(low.x, high.x, *columns) {
                visit((row % *rows) * *columns + column % *columns);
            }
        }
    }
}

impl Entry {
    fn new(index: usize, disc: &impl Disc) -> Self {
        Self { position: disc.centre(), radius: disc.radius(), index: index as u32 }
    }

    /// The two balls' indices, the lower first.
    fn pair_with(&self, other: &Self) -> (u32, u32) {
        (self.index.min(other.index), self.index.max(other.index))
    }
}

/// The radius that the cells are made for: the one with the fewest comparisons, where those of the balls in cells grow
/// with the cells' area over that of the balls, and those of the larger balls among each other with their square.
fn best_reach(discs: &[impl Disc]) -> f64 {
    let mut radii: Vec<f64> = discs.iter().map(Disc::radius).collect();
    radii.sort_unstable_by(f64::total_cmp);
    let (Some(&smallest), Some(&largest)) = (radii.first(), radii.last()) else { return 1.0 };
    let comparisons = |reach: f64| {
        let small = radii.partition_point(|&radius| radius <= reach);
        let large = (radii.len() - small) as f64;
        let squares: f64 = radii[..small].iter().map(|radius| radius * radius).sum();
        let in_cells = 4.5 * (small as f64 * small as f64) * reach * reach / squares;
        (in_cells + large * large / 2.0, reach)
    };
    let halvings = std::iter::successors(Some(largest), |reach| Some(reach / 2.0));
    let candidates = halvings.take_while(|&reach| reach >= smallest).map(comparisons);
    candidates.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(largest, |(_, reach)| reach)
}

/// The number, on a torus of `count` cells, of the cell that a coordinate in cells lies in.
#[inline]
fn wrap(coordinate: f64, count: usize) -> usize {
    (bits(coordinate) as usize) & (count - 1)
}

/// A number whose low bits are those of the integer nearest to a coordinate in cells less a half: monotonic, without a
/// branch, and the same for all coordinates of a cell.
#[inline]
fn bits(coordinate: f64) -> u64 {
    // A NaN stays one and lands in some cell, where it touches nothing.
    (coordinate.clamp(-FAR, FAR) - 0.5 + ROUND_TO_BITS).to_bits()
}

/// The cells from `low` to `high` on an axis of `count`, as numbers to be taken modulo `count`; each at most once.
fn span(low: f64, high: f64, count: usize) -> Range<usize> {
    let first = wrap(low, count);
    let length = bits(high).wrapping_sub(bits(low)).saturating_add(1);
    first..first + length.min(count as u64) as usize
}

#[inline]
fn compare(ball: &Entry, others: &[Entry], contact: &mut impl FnMut(u32, u32)) {
    for other in others {
        if touch(ball.position, ball.radius, other.position, other.radius) {
            let (first, second) = ball.pair_with(other);
            contact(first, second);
        }
    }
}

/// Whether two discs touch or overlap. The squares are the demo's own, so the answer is too; swapping the discs does
/// not change a bit of it.
#[inline]
pub(super) fn touch(p1: DVec2, r1: f64, p2: DVec2, r2: f64) -> bool {
    let reach = r1 + r2;
    p1.distance_squared(p2) <= reach * reach
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn all_pairs(balls: &[Ball]) -> Vec<(u32, u32)> {
        let touching = |&(i, j): &(usize, usize)| {
            let (a, b) = (&balls[i], &balls[j]);
            touch(a.position, a.radius, b.position, b.radius)
        };
        let pairs = (0..balls.len()).flat_map(|i| (i + 1..balls.len()).map(move |j| (i, j)));
        pairs.filter(touching).map(|(i, j)| (i as u32, j as u32)).collect()
    }

    fn found(balls: &[Ball], size: DVec2) -> Vec<(u32, u32)> {
        let mut grid = Grid::new(balls, size);
        grid.find(balls);
        grid.sort();
        grid.touching().to_vec()
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

        /// Positions far outside the world, radii over four decades, worlds from tiny to wide.
        #[test]
        fn the_grid_finds_what_all_pairs_find_in_the_same_order(
            discs in prop::collection::vec((-1.5..2.5_f64, -1.5..2.5_f64, 0.0..1.0_f64), 0..120),
            width in 1.0..2000.0_f64, height in 1.0..2000.0_f64, decades in 0.0..4.0_f64, offset in 0..14_i32,
        ) {
            let shift = if offset == 0 { 0.0 } else { 10_f64.powi(offset - 6) };
            let balls: Vec<Ball> = discs
                .iter()
                .map(|&(x, y, size)| {
                    let position = DVec2::new(x * width + shift, y * height - shift);
                    Ball::new(position, 0.1 * 10_f64.powf(size * decades)).unwrap()
                })
                .collect();
            prop_assert_eq!(found(&balls, DVec2::new(width, height)), all_pairs(&balls));
        }
    }

    #[test]
    fn balls_that_have_left_every_range_touch_what_all_pairs_say() {
        let mut balls: Vec<Ball> =
            (0..50).map(|i| Ball::new(DVec2::new(f64::from(i), 0.0), 0.6).unwrap()).collect();
        for (ball, x) in
            balls.iter_mut().zip([f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, 1e300, -1e30])
        {
            ball.position.x = x;
        }
        balls[10].position.y = f64::NAN;
        balls[11].radius = 5000.0;
        balls[12].radius = 7000.0;
        balls[12].position.x = f64::NAN;
        assert_eq!(found(&balls, DVec2::splat(50.0)), all_pairs(&balls));
    }

    #[test]
    fn more_pairs_than_were_asked_for_are_none() {
        let balls = vec![Ball::new(DVec2::splat(50.0), 1.0).unwrap(); 20];
        let mut grid = Grid::new(&balls, DVec2::splat(100.0));
        assert!(grid.find_up_to(190, &balls));
        assert_eq!(grid.touching().len(), 190);
        assert!(!grid.find_up_to(189, &balls));
        assert_eq!(grid.touching(), []);
    }
}
