//! Discs that are put into the cells one by one, and looked for about a place.

use glam::DVec2;

use super::{Disc, Grid, wrap};

/// Balls that were inserted since others were sorted.
#[derive(Debug, Clone, Default)]
pub(super) struct Insertions {
    /// A chain for each cell.
    chained: Vec<Inserted>,
    /// The last of each chain.
    lasts: Vec<u32>,
    /// Those too large for the cells.
    large: Vec<u32>,
}

/// A ball in a cell to which it was not sorted, and the one before it there.
#[derive(Debug, Clone, Copy)]
struct Inserted {
    index: u32,
    before: u32,
}

/// The beginning of a chain.
const NONE: u32 = u32::MAX;

impl Insertions {
    pub(super) fn clear(&mut self) {
        let Self { chained, lasts, large } = self;
        chained.clear();
        lasts.clear();
        large.clear();
    }
}

impl Grid {
    /// Inserts a disc that is new, or has moved; where it was sorted or inserted before it stays, too. One that is inserted
    /// again and again at about one place, as one that rattles, or as one too large for the cells, is there but once.
    pub(in crate::simulation) fn insert(&mut self, index: u32, disc: &impl Disc) {
        let Insertions { chained, lasts, large } = &mut *self.inserted;
        if disc.radius() > self.reach {
            if !large.contains(&index) {
                large.push(index);
            }
            return;
        }
        lasts.resize(self.columns * self.rows, NONE);
        let centre = disc.centre() * self.density;
        let cell = wrap(centre.y, self.rows) * self.columns + wrap(centre.x, self.columns);
        let last = &mut lasts[cell];
        if chained.get(*last as usize).is_none_or(|inserted| inserted.index != index) {
            chained.push(Inserted { index, before: *last });
            *last = chained.len() as u32 - 1;
        }
    }

    /// Calls `visit` with each disc that may touch one of `radius` about `centre`, among others; one that was sorted
    /// and inserted may come twice.
    pub(in crate::simulation) fn for_each_near(
        &self,
        centre: DVec2,
        radius: f64,
        mut visit: impl FnMut(u32),
    ) {
        self.large.iter().for_each(|entry| visit(entry.index));
        self.inserted.large.iter().for_each(|&index| visit(index));
        self.reached(centre, radius, |cell| {
            self.in_cell(cell).iter().for_each(|entry| visit(entry.index));
            let mut last = self.inserted.lasts.get(cell).copied().unwrap_or(NONE);
            while last != NONE {
                let Inserted { index, before } = self.inserted.chained[last as usize];
                visit(index);
                last = before;
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::ball::Ball;

    #[test]
    fn what_is_inserted_again_and_again_at_about_one_place_comes_once() {
        let at = |x: f64, radius: f64| Ball::new(DVec2::new(x, 50.0), radius).unwrap();
        let balls: Vec<Ball> = (0..100).map(|k| at(f64::from(k), 1.0)).collect();
        let mut grid = Grid::new(&balls, DVec2::splat(100.0));
        grid.sort_into_cells(&balls);
        let visits = |grid: &Grid| {
            let mut count = 0;
            grid.for_each_near(DVec2::splat(50.0), 1.0, |_| count += 1);
            count
        };
        let sorted = visits(&grid);
        for k in 0..1000 {
            grid.insert(7, &at(50.5 + 1e-5 * f64::from(k), 1.0));
            grid.insert(8, &at(f64::from(k % 100), 1e6));
        }
        assert_eq!(visits(&grid), sorted + 2);
    }
}
