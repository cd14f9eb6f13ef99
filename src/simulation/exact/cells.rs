//! Where balls are, roughly: cells that a ball's flight crosses one after the other.
//!
//! Each ball is in a cell at least as wide as itself, so that it meets nothing of its own size that is not in that cell
//! or one of the eight around it. Cells come in levels, each twice as wide as the one before; a ball lives in the finest
//! that is wide enough for it, and a coarse cell holds whole fine ones. Two balls can meet only where the finer one's
//! place, seen at the coarser one's level, is next to the coarser one's: small balls look up a level for large ones, and
//! large ones look down (a hierarchical grid as in Ogarko & Luding 2012).

use glam::DVec2;

use crate::simulation::world::World;

use super::Needs;

/// The most balls for which one cell, all pairs and no crossings, is enough.
const FEW: usize = 16;
/// The end of a cell's list.
const END: u32 = u32::MAX;
/// The finest cells are at most so many to a ball: an empty world needs no more.
const CELLS_PER_BALL: f64 = 3.0;
/// The most columns, and rows.
const MOST: f64 = 65_535.0;
/// Cells are wider than the balls in them by this factor, so that rounding never puts two touching ones two cells apart.
const MARGIN: f64 = 1.0 + 1e-9;

/// One level holds diameters up to this factor; a coarser one more for each further factor of two.
const ONE_LEVEL: f64 = 2.5;

/// A cell of some level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Place {
    column: u16,
    row: u16,
}

/// A grid of cells of one width.
#[derive(Debug, Clone, Copy)]
struct Level {
    /// Its cells are 2 to the power of this times as wide as the finest.
    shift: u32,
    columns: usize,
    rows: usize,
    /// Where its cells begin in `heads`.
    first: usize,
}

/// Balls in cells. The outermost cells reach to infinity, so that every position has one.
#[derive(Debug)]
pub(super) struct Cells {
    levels: Vec<Level>,
    /// Of the finest cells, px.
    width: DVec2,
    /// The first ball of each cell.
    heads: Vec<u32>,
    /// The ball behind each ball in its cell.
    next: Vec<u32>,
    /// Each ball's level; empty where there is one alone.
    level_of: Vec<u8>,
}

/// A rectangle of cells of one level: columns and rows, both from the first to the last.
#[derive(Debug, Clone, Copy)]
struct Block {
    columns: (usize, usize),
    rows: (usize, usize),
}

/// The border of a cell across an axis (0 or 1), at its high or its low end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Border {
    pub axis: usize,
    pub up: bool,
}

impl Cells {
    /// Empty cells for balls of these radii.
    pub(super) fn new(world: &World, radii: &[f64]) -> Self {
        let (least, most) = radii
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(low, high), &radius| (low.min(radius), high.max(radius)));
        let count = radii.len();
        let area = world.size.x * world.size.y;
        let roomy = (area / (CELLS_PER_BALL * count.max(1) as f64)).sqrt();
        let largest = 2.0 * most * MARGIN;
        let ratio = largest / roomy.max(2.0 * least * MARGIN);
        let shifts = (ratio / ONE_LEVEL).log2().ceil().clamp(0.0, 15.0) as u32;
        let width = roomy.max(largest / f64::from(1_u32 << shifts));
        let several = (world.size / width).floor().clamp(DVec2::ONE, DVec2::splat(MOST));
        let (finest, shifts) = if count <= FEW { (DVec2::ONE, 0) } else { (several, shifts) };
        let mut cells = Self {
            levels: Vec::new(),
            width: world.size / finest,
            heads: Vec::new(),
            next: vec![END; count],
            level_of: Vec::new(),
        };
        for shift in 0..=shifts {
            let (columns, rows) =
                (((finest.x as usize) >> shift).max(1), ((finest.y as usize) >> shift).max(1));
            cells.levels.push(Level { shift, columns, rows, first: cells.heads.len() });
            cells.heads.resize(cells.heads.len() + columns * rows, END);
        }
        if shifts > 0 {
            let wide = |shift: u32| cells.width.min_element() * f64::from(1_u32 << shift);
            let level = |&radius: &f64| (0..shifts).find(|&shift| wide(shift) >= 2.0 * radius * MARGIN);
            cells.level_of = radii.iter().map(|radius| level(radius).unwrap_or(shifts) as u8).collect();
        }
        cells
    }

    /// Whether there is one cell alone.
    pub(super) fn single(&self) -> bool {
        self.heads.len() == 1
    }

    fn level(&self, ball: usize) -> usize {
        if self.level_of.is_empty() { 0 } else { self.level_of[ball].into() }
    }

    /// The cell of a ball that is at `position`.
    pub(super) fn place(&self, ball: usize, position: DVec2) -> Place {
        let Level { shift, columns, rows, .. } = self.levels[self.level(ball)];
        let cell = (position / self.width).floor().max(DVec2::ZERO).min(DVec2::splat(MOST));
        Place {
            column: (cell.x as usize >> shift).min(columns - 1) as u16,
            row: (cell.y as usize >> shift).min(rows - 1) as u16,
        }
    }

    /// A number for which places that are near each other mostly have near values (Morton 1966).
    pub(super) fn order(&self, ball: usize, position: DVec2) -> u64 {
        let shift = self.levels[self.level(ball)].shift;
        let Place { column, row } = self.place(ball, position);
        let spread = |number: u16| {
            (0..16).fold(0, |bits, bit| bits | (u64::from(number) >> bit & 1) << (2 * bit + 2 * shift))
        };
        spread(column) | spread(row) << 1
    }

    /// Puts a ball into a cell.
    pub(super) fn put(&mut self, ball: usize, place: Place) {
        let cell = self.index(ball, place);
        self.next[ball] = self.heads[cell];
        self.heads[cell] = ball as u32;
    }

    #[inline]
    fn index(&self, ball: usize, place: Place) -> usize {
        let level = &self.levels[self.level(ball)];
        level.first + usize::from(place.row) * level.columns + usize::from(place.column)
    }

    /// The coordinate of a border of a ball's cell; `None` at the world's edge.
    #[inline]
    pub(super) fn line<N: Needs>(&self, ball: usize, place: Place, border: Border) -> Option<f64> {
        let Level { shift, columns, rows, .. } = self.levels[if N::ALIKE { 0 } else { self.level(ball) }];
        let (at, count) = if border.axis == 0 { (place.column, columns) } else { (place.row, rows) };
        let number = usize::from(at) + usize::from(border.up);
        (number != 0 && number != count).then(|| (number << shift) as f64 * self.width[border.axis])
    }

    /// Moves a ball over a border of its cell; the cell that it is in then.
    pub(super) fn cross(&mut self, ball: usize, place: Place, border: Border) -> Place {
        let cell = self.index(ball, place);
        let after = self.next[ball];
        if self.heads[cell] == ball as u32 {
            self.heads[cell] = after;
        } else {
            let mut before = self.heads[cell] as usize;
            while self.next[before] != ball as u32 {
                before = self.next[before] as usize;
            }
            self.next[before] = after;
        }
        let mut place = place;
        let coordinate = if border.axis == 0 { &mut place.column } else { &mut place.row };
        *coordinate = if border.up { *coordinate + 1 } else { *coordinate - 1 };
        self.put(ball, place);
        place
    }

    /// Hands over all balls, the ball itself among them, that are in the cell `place` of a ball's level or around it.
    /// With `from`, the cell that it was in before, only those that were not around that.
    #[inline]
    pub(super) fn for_each_near<N: Needs>(
        &self,
        ball: usize,
        place: Place,
        from: Option<Place>,
        mut visit: impl FnMut(usize),
    ) {
        let own = if N::ALIKE { 0 } else { self.level(ball) };
        let level = &self.levels[own];
        let Some(block) = around(level, place, from) else { return };
        self.visit_few(level, block, &mut visit);
        if N::ALIKE || self.levels.len() == 1 {
            return;
        }
        for (other, level) in self.levels.iter().enumerate() {
            if other < own {
                self.visit_block(level, finer(&self.levels[own], block, level), &mut visit);
            } else if other > own {
                let seen = |place: Place| Place {
                    column: (usize::from(place.column) >> (other - own)).min(level.columns - 1) as u16,
                    row: (usize::from(place.row) >> (other - own)).min(level.rows - 1) as u16,
                };
                if let Some(block) = around(level, seen(place), from.map(seen)) {
                    self.visit_few(level, block, &mut visit);
                }
            }
        }
    }

    /// Visits a block of at most nine cells. Most are empty, which no branch could foretell: those that are not are
    /// gathered first.
    #[inline]
    fn visit_few(&self, level: &Level, block: Block, visit: &mut impl FnMut(usize)) {
        let (mut found, mut count) = ([END; 9], 0);
        for row in block.rows.0..=block.rows.1 {
            let start = level.first + row * level.columns;
            for &head in &self.heads[start + block.columns.0..=start + block.columns.1] {
                found[count.min(8)] = head;
                count += usize::from(head != END);
            }
        }
        for &head in &found[..count.min(9)] {
            let mut at = head;
            while at != END {
                visit(at as usize);
                at = self.next[at as usize];
            }
        }
    }

    fn visit_block(&self, level: &Level, block: Block, visit: &mut impl FnMut(usize)) {
        for row in block.rows.0..=block.rows.1 {
            let start = level.first + row * level.columns;
            for &head in &self.heads[start + block.columns.0..=start + block.columns.1] {
                let mut at = head;
                while at != END {
                    visit(at as usize);
                    at = self.next[at as usize];
                }
            }
        }
    }
}

/// The cells around `place`, itself among them, less those around `from`, a neighbour of it or itself.
#[inline]
fn around(level: &Level, place: Place, from: Option<Place>) -> Option<Block> {
    let span = |at: u16, from: Option<u16>, count: usize| {
        let at = usize::from(at);
        match from.map(usize::from) {
            Some(from) if from < at => (at + 1, at + 1),
            Some(from) if from > at => (at.wrapping_sub(1), at.wrapping_sub(1)),
            _ => (at.saturating_sub(1), (at + 1).min(count - 1)),
        }
    };
    if from == Some(place) {
        return None;
    }
    let columns = span(place.column, from.map(|from| from.column), level.columns);
    let rows = span(place.row, from.map(|from| from.row), level.rows);
    (columns.0 < level.columns && rows.0 < level.rows).then_some(Block { columns, rows })
}

/// The cells of a finer level that make up a block of a coarser one.
fn finer(coarse: &Level, block: Block, fine: &Level) -> Block {
    let shift = coarse.shift - fine.shift;
    let span = |(first, last): (usize, usize), coarse: usize, fine: usize| {
        // The last coarse cell takes in what is left over.
        (first << shift, if last + 1 == coarse { fine - 1 } else { ((last + 1) << shift) - 1 })
    };
    Block {
        columns: span(block.columns, coarse.columns, fine.columns),
        rows: span(block.rows, coarse.rows, fine.rows),
    }
}
