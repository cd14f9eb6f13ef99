//! Pairs that touch, with few of a crowd.

use std::f64::consts::PI;
use std::ops::Range;

use super::{Disc, Entry, Grid, compare, touch};

/// The most others, at least half as large, that a ball lies in and is paired with from one run of cells. Of a crowd at one
/// point each is held apart from so many at a time, and from the rest when these are gone.
const MOST_BESIDE: usize = 64;
/// Where there are more pairs than this, a ball is paired with no more than that of any others.
const MANY: usize = 1 << 20;
/// More balls than this in the cells beside one are a crowd, of which the first that touch it are enough.
const CROWD: usize = 256;

impl Grid {
    /// Replaces `pairs` by each pair of `discs` that touches, in no particular order, and at most [`MOST_BESIDE`] of a
    /// crowd. Discs may be larger than the balls in them: balls are a crowd where these `overlap`.
    pub(in crate::simulation) fn collect<P: Copy>(
        &mut self,
        discs: &[impl Disc],
        pairs: &mut Vec<P>,
        pair: impl Fn(u32, u32) -> P,
        overlap: impl Fn(u32, u32) -> bool,
    ) {
        self.sort_into_cells(discs);
        self.collect_rows(0..self.rows, pairs, &pair, overlap);
        self.compare_large(&mut |first, second| pairs.push(pair(first, second)));
    }

    /// Calls `contact` with each pair (i, j), i < j, that touches, in no particular order. Of a crowd no more for a ball and
    /// a run of cells than [`MOST_BESIDE`] of its size, and no more smaller ones than could lie around it.
    pub(in crate::simulation) fn for_each_of_few(
        &mut self,
        discs: &[impl Disc],
        mut contact: impl FnMut(u32, u32),
    ) {
        self.sort_into_cells(discs);
        let mut smallest = None;
        self.neighbours(0..self.rows, &mut |ball: &Entry, others: &[Entry]| {
            if others.len() <= CROWD {
                compare(ball, others, &mut contact);
                return;
            }
            let smallest = *smallest.get_or_insert_with(|| self.smallest());
            // Each takes an angle of at least 2r/(R + r) around it.
            let around = PI * (ball.radius / smallest + 1.0);
            for other in ball.not_too_many(others, smallest, around as usize + MOST_BESIDE, |_| true) {
                let (first, second) = ball.pair_with(other);
                contact(first, second);
            }
        });
        self.compare_large(&mut contact);
    }

    /// Replaces `pairs` by each pair that touches and is found from these rows of cells, as [`collect`](Self::collect) does;
    /// discs too large for the cells are left out. The discs must have been sorted into the cells.
    pub(in crate::simulation) fn collect_rows<P: Copy>(
        &self,
        rows: Range<usize>,
        pairs: &mut Vec<P>,
        pair: impl Fn(u32, u32) -> P,
        overlap: impl Fn(u32, u32) -> bool,
    ) {
        let mut found = 0;
        let mut smallest = None;
        self.neighbours(rows, &mut |ball: &Entry, others: &[Entry]| {
            let paired = |other: &Entry| {
                let (first, second) = ball.pair_with(other);
                pair(first, second)
            };
            let before = found;
            if others.len() <= CROWD {
                // Each is written, and the next writes over it where it did not touch: no branch that cannot be
                // foreseen.
                if pairs.len() < found + others.len() {
                    pairs.resize(2 * (found + others.len()), pair(0, 0));
                }
                for other in others {
                    pairs[found] = paired(other);
                    found += usize::from(touch(ball.position, ball.radius, other.position, other.radius));
                }
            }
            if others.len() > CROWD || found > before + MOST_BESIDE {
                let smallest = *smallest.get_or_insert_with(|| self.smallest());
                found = before;
                let counts = |other: &Entry| before > MANY || overlap(ball.index, other.index);
                for other in ball.not_too_many(others, smallest, usize::MAX, counts) {
                    match pairs.get_mut(found) {
                        Some(place) => *place = paired(other),
                        None => pairs.push(paired(other)),
                    }
                    found += 1;
                }
            }
        });
        pairs.truncate(found);
    }

    /// The smallest radius of a disc in the cells, px.
    fn smallest(&self) -> f64 {
        self.sorted.iter().map(|entry| entry.radius).fold(f64::INFINITY, f64::min)
    }
}

impl Entry {
    /// Those of `others` that touch it, but of those that count no more than [`MOST_BESIDE`] that are half as large and more,
    /// and no more smaller ones than `small`. None of them is smaller than `smallest`.
    fn not_too_many<'a>(
        &self,
        others: &'a [Self],
        smallest: f64,
        mut small: usize,
        counts: impl Fn(&Self) -> bool,
    ) -> impl Iterator<Item = &'a Self> {
        let Self { position, radius, .. } = *self;
        if 2.0 * smallest >= radius {
            small = 0;
        }
        let mut large = MOST_BESIDE;
        let takes = move |other: &'a Self| {
            // Of a crowd no more are looked at than are needed.
            if large == 0 && small == 0 {
                return None;
            }
            let left = if 2.0 * other.radius >= radius { &mut large } else { &mut small };
            let beside = *left > 0 && touch(position, radius, other.position, other.radius);
            *left -= usize::from(beside && counts(other));
            Some(beside.then_some(other))
        };
        others.iter().map_while(takes).flatten()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use proptest::prelude::*;

    use super::*;
    use crate::simulation::ball::Ball;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(8))]

        /// In cells far too large for them, each ball has hundreds beside it, and few that it touches.
        #[test]
        fn of_no_crowd_few_are_all(
            places in prop::collection::vec((0.0..400.0_f64, 0.0..400.0_f64, 1.0..3.0_f64), 2000..3000),
        ) {
            let balls: Vec<_> =
                places.iter().map(|&(x, y, radius)| Ball::new(DVec2::new(x, y), radius).unwrap()).collect();
            let mut grid = Grid::new(&[Ball::new(DVec2::ZERO, 100.0).unwrap()], DVec2::splat(400.0));
            let (mut all, mut few) = (Vec::new(), Vec::new());
            grid.for_each(&balls, |i, j| all.push((i, j)));
            grid.for_each_of_few(&balls, |i, j| few.push((i, j)));
            prop_assert!(all.len() > 100);
            prop_assert_eq!(few, all);
        }
    }

    /// Discs around where fast balls may go touch hundreds of others, whose balls are far from each other.
    #[test]
    fn wide_discs_of_balls_that_are_no_crowd_have_all_their_pairs() {
        let disc = |k: u32| Ball::new(DVec2::new(f64::from(k % 20), f64::from(k / 20)), 40.0).unwrap();
        let discs: Vec<_> = (0..400).map(disc).collect();
        let mut pairs = Vec::new();
        Grid::new(&discs, DVec2::splat(20.0)).collect(&discs, &mut pairs, |i, j| (i, j), |_, _| false);
        assert_eq!(pairs.len(), 400 * 399 / 2);
    }

    #[test]
    fn of_a_crowd_each_ball_has_so_many_pairs_with_large_ones_and_all_with_small_ones() {
        let at = |radius: f64| Ball::new(DVec2::splat(50.0), radius).unwrap();
        for small in [0, 100] {
            let mut balls = vec![at(4.0); 1000];
            balls.extend(vec![at(1.0); small]);
            let mut pairs = Vec::new();
            Grid::new(&balls, DVec2::splat(100.0)).collect(&balls, &mut pairs, |i, j| (i, j), |_, _| true);
            let mut counts = vec![0; balls.len()];
            for &(i, j) in &pairs {
                let large = j < 1000;
                assert!(i < j && i < 1000 + small as u32);
                counts[i as usize] += usize::from(large);
                counts[j as usize] += usize::from(large);
            }
            // Each in one direction; in the other as many may have it.
            assert!(counts[..1000].iter().all(|&count| count >= MOST_BESIDE), "{small}");
            let all_large = pairs.iter().filter(|&&(i, j)| i < 1000 && j < 1000).count();
            assert!(all_large <= 1000 * MOST_BESIDE, "{small}: {all_large}");
            let mixed = pairs.iter().filter(|&&(i, j)| i < 1000 && j >= 1000).count();
            assert_eq!(mixed, 1000 * small);
        }
    }
}
