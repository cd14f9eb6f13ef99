//! Where balls are, roughly: cells that a ball's flight crosses one after the other.
//!
//! Each ball is in a cell at least as wide as itself, so that it meets nothing of its own size that is not in that cell
//! or one of the eight around it. Cells come in levels, each twice as wide as the one before; a ball lives in the
//! finest that is wide enough for it, and a coarse cell holds whole fine ones. Two balls can meet only where the finer
//! one's place, seen at the coarser one's level, is next to the coarser one's: small balls look up a level for large
//! ones, and large ones look down (a hierarchical grid as in Ogarko & Luding 2012).

use glam::DVec2;

use crate::simulation::world::World;

use super::Needs;

/// The most balls for which one cell, all pairs and no crossings, is enough.
const MOST_IN_ONE_CELL: usize = 16;
/// The end of a cell's list.
pub(super) const END: u32 = u32::MAX;
/// The most cells of one level that an event looks at.
pub(super) const MOST_HEADS: usize = 9;
/// The finest cells are at most so many to a ball: an empty world needs no more.
const CELLS_PER_BALL: f64 = 3.0;
/// The most columns, and rows.
const MOST: f64 = 65_535.0;
/// Cells are wider than their balls by this factor, so that rounding never puts two touching ones two cells apart.
const MARGIN: f64 = 1.0 + 1e-9;

/// One level holds diameters up to this factor; a coarser one more for each further factor of two.
const ONE_LEVEL: f64 = 2.5;

/// A cell of some level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Place {
    column: u16,
    row: u16,
}

/// A grid of cells of one width, with a rim of empty cells around it, so that each cell has eight neighbours.
#[derive(Debug, Clone, Copy)]
struct Level {
    /// Its cells are 2 to the power of this times as wide as the finest.
    shift: u32,
    columns: usize,
    rows: usize,
    /// Where the link of its first cell is, after the rim's.
    first: usize,
    /// From a cell's link to that of the one below it.
    stride: usize,
}

impl Level {
    /// Where a cell's link is.
    #[inline]
    fn index(&self, place: Place) -> usize {
        self.first + usize::from(place.row) * self.stride + usize::from(place.column)
    }
}

/// Balls in cells. The outermost cells reach to infinity, so that every position has one.
#[derive(Debug, Clone)]
pub(super) struct Cells {
    levels: Vec<Level>,
    /// Of the finest cells, px.
    width: DVec2,
    /// The ball behind each ball in its cell, and then the first ball of each cell; [`END`] where there is none.
    links: Vec<u32>,
    /// Each ball's level; empty where there is one alone.
    level_of: Vec<u8>,
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
        let shifts = (0..15).find(|&shift| ratio <= ONE_LEVEL * f64::from(1_u32 << shift)).unwrap_or(15);
        let width = roomy.max(largest / f64::from(1_u32 << shifts));
        let several = (world.size / width).floor().clamp(DVec2::ONE, DVec2::splat(MOST));
        let (finest, shifts) = if count <= MOST_IN_ONE_CELL { (DVec2::ONE, 0) } else { (several, shifts) };
        let mut cells = Self {
            levels: Vec::new(),
            width: world.size / finest,
            links: vec![END; count],
            level_of: Vec::new(),
        };
        for shift in 0..=shifts {
            let (columns, rows) =
                (((finest.x as usize) >> shift).max(1), ((finest.y as usize) >> shift).max(1));
            let (rim, stride) = (cells.links.len(), columns + 2);
            cells.levels.push(Level { shift, columns, rows, first: rim + stride + 1, stride });
            cells.links.resize(rim + stride * (rows + 2), END);
        }
        if shifts > 0 {
            let wide = |shift: u32| width * f64::from(1_u32 << shift);
            let level = |&radius: &f64| (0..shifts).find(|&shift| wide(shift) >= 2.0 * radius * MARGIN);
            cells.level_of = radii.iter().map(|radius| level(radius).unwrap_or(shifts) as u8).collect();
        }
        cells
    }

    /// Whether there is one cell alone.
    pub(super) fn single(&self) -> bool {
        self.levels.iter().all(|level| level.columns * level.rows == 1)
    }

    fn level(&self, ball: usize) -> usize {
        if self.level_of.is_empty() { 0 } else { self.level_of[ball].into() }
    }

    /// The level that a ball lives in, which need not be looked up where all balls are alike.
    #[inline]
    fn home<N: Needs>(&self, ball: usize) -> usize {
        if N::ALIKE { 0 } else { self.level(ball) }
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
    pub(super) fn morton_code(&self, ball: usize, position: DVec2) -> u64 {
        let shift = self.levels[self.level(ball)].shift;
        let Place { column, row } = self.place(ball, position);
        let spread = |number: u16| {
            (0..16).fold(0, |bits, bit| bits | (u64::from(number) >> bit & 1) << (2 * bit + 2 * shift))
        };
        spread(column) | spread(row) << 1
    }

    /// Puts a ball into a cell.
    #[inline]
    pub(super) fn put<N: Needs>(&mut self, ball: usize, place: Place) {
        let cell = self.levels[self.home::<N>(ball)].index(place);
        self.links[ball] = self.links[cell];
        self.links[cell] = ball as u32;
    }

    /// Takes a ball out of its cell for a while: what [`reveal`](Self::reveal) takes to put it back where it was. Balls
    /// that are hidden at one time must be revealed in the opposite order.
    #[inline]
    pub(super) fn hide<N: Needs>(&mut self, ball: usize, place: Place) -> usize {
        let mut before = self.levels[self.home::<N>(ball)].index(place);
        while self.links[before] != ball as u32 {
            before = self.links[before] as usize;
        }
        self.links[before] = self.links[ball];
        before
    }

    /// Puts a ball back that was hidden.
    #[inline]
    pub(super) fn reveal(&mut self, ball: usize, before: usize) {
        self.links[before] = ball as u32;
    }

    /// The coordinate of a border of a ball's cell, and whether it is the world's edge.
    #[inline]
    pub(super) fn line<N: Needs>(&self, ball: usize, place: Place, border: Border) -> (f64, bool) {
        let level = &self.levels[self.home::<N>(ball)];
        let (at, count) =
            if border.axis == 0 { (place.column, level.columns) } else { (place.row, level.rows) };
        let number = usize::from(at) + usize::from(border.up);
        (self.line_after(level, border.axis, number), number == 0 || number == count)
    }

    /// The coordinates of two borders of a ball's cell, across one axis and the other, where neither is the world's edge.
    #[inline]
    pub(super) fn inner_lines<N: Needs>(
        &self,
        ball: usize,
        place: Place,
        borders: [Border; 2],
    ) -> Option<[f64; 2]> {
        let level = &self.levels[self.home::<N>(ball)];
        let column = usize::from(place.column) + usize::from(borders[0].up);
        let row = usize::from(place.row) + usize::from(borders[1].up);
        let inside = (1..level.columns).contains(&column) && (1..level.rows).contains(&row);
        inside.then(|| [self.line_after(level, 0, column), self.line_after(level, 1, row)])
    }

    /// The coordinate of the line after so many columns or rows.
    #[inline]
    fn line_after(&self, level: &Level, axis: usize, number: usize) -> f64 {
        // Counted in the finest cells: few enough for a conversion of one instruction.
        f64::from((number << level.shift) as u32) * self.width[axis]
    }

    /// Moves a ball over a border of its cell; the cell that it is in then.
    #[inline]
    pub(super) fn cross<N: Needs>(&mut self, ball: usize, place: Place, border: Border) -> Place {
        self.hide::<N>(ball, place);
        let place = place.beyond(border);
        self.put::<N>(ball, place);
        place
    }

    /// Hands over all balls that are in a ball's cell or around it, and that ball, too, where it is not hidden. Where it
    /// came there over a border, `crossed`, only those that were not around the cell before.
    #[inline]
    pub(super) fn for_each_near<N: Needs>(
        &self,
        ball: usize,
        place: Place,
        crossed: Option<Border>,
        mut visit: impl FnMut(usize),
    ) {
        let own = self.home::<N>(ball);
        self.visit_around(&self.levels[own], place, crossed, &mut visit);
        if N::ALIKE || self.levels.len() == 1 {
            return;
        }
        let before = crossed.map(|border| place.beyond(border.other_side()));
        for (other, level) in self.levels.iter().enumerate() {
            if other < own {
                self.visit_within(&self.levels[own], place, crossed, level, &mut visit);
            } else if other > own {
                let seen = |place: Place| Place {
                    column: (usize::from(place.column) >> (other - own)).min(level.columns - 1) as u16,
                    row: (usize::from(place.row) >> (other - own)).min(level.rows - 1) as u16,
                };
                if before.map(seen) != Some(seen(place)) {
                    self.visit_around(level, seen(place), crossed, &mut visit);
                }
            }
        }
    }

    /// Visits the balls in the nine cells around a place, or in the three of them beyond a border that was
    /// crossed. How many balls there are in a cell, if any, no branch could foretell: all that are next in their cells
    /// queue up in one row, at most one for each cell at a time.
    #[inline]
    fn visit_around(
        &self,
        level: &Level,
        place: Place,
        crossed: Option<Border>,
        visit: &mut impl FnMut(usize),
    ) {
        let (mut queue, mut count) = ([END; 16], 0_usize);
        let gather = |head: u32| {
            queue[count % 16] = head;
            count += usize::from(head != END);
        };
        self.heads_around(level, place, crossed, gather);
        let mut visited = 0;
        while visited < count {
            let other = queue[visited % 16] as usize;
            visited += 1;
            let after = self.links[other];
            queue[count % 16] = after;
            count += usize::from(after != END);
            visit(other);
        }
    }

    /// Hands over the first balls, or [`END`], of the nine cells around a place, or of the three of them beyond a
    /// border.
    #[inline]
    fn heads_around(
        &self,
        level: &Level,
        place: Place,
        crossed: Option<Border>,
        mut gather: impl FnMut(u32),
    ) {
        let (middle, stride) = (level.index(place), level.stride);
        if let Some(border) = crossed {
            // Which of the four borders it is, no branch could foretell either.
            let (along, across) = if border.axis == 0 { (1, stride) } else { (stride, 1) };
            let beyond = if border.up { middle + along } else { middle - along };
            [beyond - across, beyond, beyond + across]
                .map(|cell| self.links[cell])
                .into_iter()
                .for_each(gather);
        } else {
            // One by one: what has just been written cannot be read together with what has not without waiting.
            for cell in [middle - stride, middle, middle + stride] {
                let row = self.links[cell - 1..].first_chunk().unwrap_or(&[END; 3]);
                row.iter().copied().for_each(&mut gather);
            }
        }
    }

    /// The ball behind a ball in its cell, or [`END`].
    #[inline]
    pub(super) fn behind(&self, ball: usize) -> u32 {
        self.links[ball]
    }

    /// Hands over the first ball, or [`END`], of each cell of a ball's own level that its next event looks at, at most
    /// [`MOST_HEADS`] of them: those around it, or, where it crosses a border, the one that it leaves, the one that it
    /// comes into and those beyond.
    #[inline]
    pub(super) fn heads_near(
        &self,
        ball: usize,
        place: Place,
        crosses: Option<Border>,
        mut gather: impl FnMut(u32),
    ) {
        let level = &self.levels[self.level(ball)];
        let to = crosses.map_or(place, |border| place.beyond(border));
        if crosses.is_some() {
            [place, to].map(|place| self.links[level.index(place)]).into_iter().for_each(&mut gather);
        }
        self.heads_around(level, to, crosses, gather);
    }

    /// Visits the cells of a finer level that make up those around a place, or beyond a border, of a coarser one.
    fn visit_within(
        &self,
        coarse: &Level,
        place: Place,
        crossed: Option<Border>,
        fine: &Level,
        visit: &mut impl FnMut(usize),
    ) {
        let shift = coarse.shift - fine.shift;
        let span = |axis: usize, at: u16, coarse: usize, fine: usize| {
            let at = usize::from(at);
            let (first, last) = match crossed {
                Some(border) if border.axis == axis && border.up => (at + 1, at + 1),
                Some(border) if border.axis == axis => (at.wrapping_sub(1), at.wrapping_sub(1)),
                _ => (at.saturating_sub(1), (at + 1).min(coarse - 1)),
            };
            // The last coarse cell takes in what is left over; beyond it, and before the first, there is nothing.
            if first >= coarse {
                return 0..0;
            }
            first << shift..if last + 1 == coarse { fine } else { (last + 1) << shift }
        };
        for row in span(1, place.row, coarse.rows, fine.rows) {
            for column in span(0, place.column, coarse.columns, fine.columns) {
                let place = Place { column: column as u16, row: row as u16 };
                let mut at = self.links[fine.index(place)];
                while at != END {
                    visit(at as usize);
                    at = self.links[at as usize];
                }
            }
        }
    }
}

impl Border {
    /// The same border, seen from the cell beyond it.
    pub(super) fn other_side(self) -> Self {
        Self { up: !self.up, ..self }
    }
}

impl Place {
    /// The place on the other side of a border.
    #[inline]
    fn beyond(self, Border { axis, up }: Border) -> Self {
        // Again without a branch: less one is what all ones add.
        let step = if up { 1 } else { u16::MAX };
        let (columns, rows) = if axis == 0 { (step, 0) } else { (0, step) };
        Self { column: self.column.wrapping_add(columns), row: self.row.wrapping_add(rows) }
    }
}
