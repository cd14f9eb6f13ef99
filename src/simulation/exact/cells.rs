//! Where balls are, roughly: a grid of cells, each at least as wide as the widest ball, so that a ball meets nothing
//! that is not in its own cell or one of the eight around it.

use glam::DVec2;

use crate::simulation::ball::Ball;
use crate::simulation::world::World;

/// The most balls for which one cell, all pairs and no crossings, is enough.
const FEW: usize = 16;
/// The end of a cell's list.
const END: u32 = u32::MAX;

/// Balls in cells. The outermost cells reach to infinity, so that every position has one.
#[derive(Debug)]
pub(super) struct Cells {
    columns: usize,
    rows: usize,
    width: DVec2,
    /// The first ball of each cell.
    heads: Vec<u32>,
    /// The ball behind each ball in its cell.
    next: Vec<u32>,
    /// Each ball's cell.
    cell: Vec<u32>,
}

impl Cells {
    pub(super) fn new(world: &World, balls: &[Ball]) -> Self {
        let widest = balls.iter().map(|ball| 2.0 * ball.radius).fold(0.0, f64::max);
        let area = world.size.x * world.size.y;
        // Not more than four cells a ball.
        let width = widest.max((area / (4.0 * balls.len().max(1) as f64)).sqrt());
        let several = (world.size / width).floor().max(DVec2::ONE);
        let count = if balls.len() <= FEW { DVec2::ONE } else { several };
        let (columns, rows) = (count.x as usize, count.y as usize);
        let mut cells = Self {
            columns,
            rows,
            // A little wider than the widest ball, for rounding.
            width: world.size / count,
            heads: vec![END; columns * rows],
            next: vec![END; balls.len()],
            cell: vec![0; balls.len()],
        };
        for (index, ball) in balls.iter().enumerate() {
            let place = (ball.position / cells.width).floor().max(DVec2::ZERO).min(count - 1.0);
            cells.put(index, place.y as usize * columns + place.x as usize);
        }
        cells
    }

    fn put(&mut self, ball: usize, cell: usize) {
        self.cell[ball] = cell as u32;
        self.next[ball] = self.heads[cell];
        self.heads[cell] = ball as u32;
    }

    /// The borders of a ball's cell, low and high; infinite at the rim.
    pub(super) fn borders(&self, ball: usize) -> (DVec2, DVec2) {
        let (column, row) =
            (self.cell[ball] as usize % self.columns, self.cell[ball] as usize / self.columns);
        let low = |at: usize, width: f64| if at == 0 { f64::NEG_INFINITY } else { at as f64 * width };
        let high = |at: usize, count: usize, width: f64| {
            if at + 1 == count { f64::INFINITY } else { (at + 1) as f64 * width }
        };
        (
            DVec2::new(low(column, self.width.x), low(row, self.width.y)),
            DVec2::new(high(column, self.columns, self.width.x), high(row, self.rows, self.width.y)),
        )
    }

    /// Moves a ball to the next cell along an axis (0 or 1), up or down.
    pub(super) fn cross(&mut self, ball: usize, axis: usize, up: bool) {
        let from = self.cell[ball] as usize;
        let mut before = self.heads[from];
        if before == ball as u32 {
            self.heads[from] = self.next[ball];
        } else {
            while self.next[before as usize] != ball as u32 {
                before = self.next[before as usize];
            }
            self.next[before as usize] = self.next[ball];
        }
        let step = if axis == 0 { 1 } else { self.columns };
        self.put(ball, if up { from + step } else { from - step });
    }

    /// Hands over every other ball in a ball's cell and the cells around it.
    pub(super) fn for_each_near(&self, ball: usize, mut visit: impl FnMut(usize)) {
        let (column, row) =
            (self.cell[ball] as usize % self.columns, self.cell[ball] as usize / self.columns);
        for near_row in row.saturating_sub(1)..(row + 2).min(self.rows) {
            for near_column in column.saturating_sub(1)..(column + 2).min(self.columns) {
                let mut at = self.heads[near_row * self.columns + near_column];
                while at != END {
                    if at as usize != ball {
                        visit(at as usize);
                    }
                    at = self.next[at as usize];
                }
            }
        }
    }
}
