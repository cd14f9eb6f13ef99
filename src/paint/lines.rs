//! Where a large disc begins and ends on each of the lines that tiny-skia samples.
//!
//! tiny-skia cuts a pixel into four lines and each line into four parts. The ends of a disc on its lines follow the
//! sides of its polygon, in the fixed-point arithmetic of tiny-skia's edges: they are those of `fill_path` to the bit,
//! for a disc that no border cuts.

use std::ops::Range;

use glam::DVec2;

use super::circle::{corners, place, sides};
use super::disc::Disc;
use super::target::Area;

/// Lines in a row of pixels, and parts of a pixel on a line.
pub(super) const LINES: usize = 4;
/// From this radius on, px, a polygon would have too many sides; then, and farther out than [`FARTHEST`], the ends come
/// from the circle itself.
const SMALLEST_CIRCLE: f64 = 2000.0;
/// How far from the origin, px, the fixed-point arithmetic reaches.
const FARTHEST: f64 = 8000.0;

/// Corners of regular polygons, made once for each number of sides: under 2 MB in all.
#[derive(Debug, Default)]
pub(super) struct Corners(Vec<Vec<DVec2>>);

/// Where the lines of a disc's rows begin and end, in parts of a pixel; kept from disc to disc. A line that the disc
/// does not reach has no length.
#[derive(Debug, Default)]
pub(super) struct Lines {
    /// Four begin for each row, and [`STRIDE`] more stand after the last ...
    left: Vec<i32>,
    /// ... and as many end.
    right: Vec<i32>,
    /// The polygon's corners, in 64ths of a line and of a part.
    corners: Vec<(i32, i32)>,
    /// Those of its left side, from the highest to the lowest.
    chain: Vec<(i32, i32)>,
}

/// How many lines a polygon's side is followed at a time: whole strides, of which the next side overwrites what is too
/// much, are faster than counting the lines of each.
const STRIDE: usize = 8;

/// Where the four lines of a row begin and end, in parts.
pub(super) struct Row {
    pub(super) left: [i32; LINES],
    pub(super) right: [i32; LINES],
}

impl Corners {
    /// Makes the corners for a radius where they are not there.
    pub(super) fn prepare(&mut self, radius: f64) {
        if radius < SMALLEST_CIRCLE {
            let sides = sides(radius);
            if self.0.len() <= sides {
                self.0.resize_with(sides + 1, Vec::new);
            }
            if self.0[sides].is_empty() {
                self.0[sides] = corners(sides).collect();
            }
        }
    }
}

impl Lines {
    /// Finds the lines of a disc whose radius has been prepared, in an area that may cut it off, which is not empty.
    /// Gives the first row that the disc touches, and the lines of that and of those below it.
    pub(super) fn follow(
        &mut self,
        disc: &Disc,
        area: Area,
        corners: &Corners,
    ) -> (i32, impl Iterator<Item = Row>) {
        let far = disc.centre.abs().max_element() + disc.radius > FARTHEST;
        let (top, rows) = if far || disc.radius >= SMALLEST_CIRCLE {
            (area.top, self.follow_circle(disc, area.top..area.bottom))
        } else {
            let Area { top, bottom, .. } = disc.area();
            (top, self.follow_polygon(disc, corners, top..bottom))
        };
        let (first, end) = ((area.top - top) as usize, (area.bottom - top) as usize);
        let first = rows.start.max(first);
        let rows = first..rows.end.min(end).max(first);
        let (lefts, rights) = (&self.left.as_chunks().0[rows.clone()], &self.right.as_chunks().0[rows]);
        let lines = lefts.iter().zip(rights).map(|(&left, &right)| Row { left, right });
        (top + first as i32, lines)
    }

    /// Forgets what lines there were, for so many rows.
    fn clear(&mut self, rows: usize) {
        for side in [&mut self.left, &mut self.right] {
            side.clear();
            side.resize(rows * LINES + STRIDE, 0);
        }
    }

    /// The ends of these rows' lines, which are all that the disc has, as tiny-skia's edges have them; which of them it
    /// touches.
    fn follow_polygon(&mut self, disc: &Disc, corners: &Corners, rows: Range<i32>) -> Range<usize> {
        self.clear(rows.len());
        let Some(polygon) = corners.0.get(sides(disc.radius)) else { return 0..0 };
        self.corners.clear();
        self.corners.extend(polygon.iter().map(|&corner| {
            let (x, y) = place(corner, disc.centre, disc.radius);
            (round_down(x), round_down(y) - (rows.start << 8))
        }));
        // Clockwise from the right: the lowest corner is a quarter around, the highest three.
        let (count, corners) = (self.corners.len(), &mut self.corners);
        let lower = |a: usize, b: usize| corners[a].1 > corners[b].1;
        let near = |quarters: usize| (quarters * count / 4, quarters * count / 4 + 1);
        let lowest = if lower(near(1).0, near(1).1) { near(1).0 } else { near(1).1 };
        let highest = if lower(near(3).0, near(3).1) { near(3).1 } else { near(3).0 };
        let (first, end) = (line(corners[highest].1), line(corners[lowest].1));
        corners.extend_from_within(..=lowest);
        self.chain.clear();
        self.chain.extend(corners[lowest..=highest].iter().rev());
        let right = &corners[highest..=count + lowest];
        for (chain, ends) in [(&self.chain[..], &mut self.left), (right, &mut self.right)] {
            follow_sides(chain, ends);
            ends[end..end + STRIDE].fill(0);
        }
        // Where the sides meet, rounding may let them cross.
        for line in [first, end.saturating_sub(1)] {
            if self.left[line] > self.right[line] {
                std::mem::swap(&mut self.left[line], &mut self.right[line]);
            }
        }
        first / LINES..end.div_ceil(LINES)
    }

    /// The ends of these rows' lines, where the circle crosses them; which of them it may touch.
    fn follow_circle(&mut self, disc: &Disc, rows: Range<i32>) -> Range<usize> {
        self.clear(rows.len());
        let parts = LINES as f64;
        for (index, (left, right)) in self.left.iter_mut().zip(&mut self.right).enumerate() {
            let down = f64::from(rows.start) + (index as f64 + 0.5) / parts - disc.centre.y;
            let square = (disc.radius - down) * (disc.radius + down);
            if square > 0.0 {
                let end = |across: f64| {
                    let end = ((disc.centre.x + across) * parts).round();
                    end.clamp(f64::from(i32::MIN / 4), f64::from(i32::MAX / 4)) as i32
                };
                (*left, *right) = (end(-square.sqrt()), end(square.sqrt()));
            }
        }
        0..rows.len()
    }
}

/// A coordinate in 256ths of a pixel, which are 64ths of a line, rounded down.
fn round_down(coordinate: f32) -> i32 {
    // In f64 the sum has no room for fractions, so it rounds to the nearest; the lower half of its bits is the number.
    // A cast checks its range and takes three times as long.
    const NO_FRACTIONS: f64 = 1.5 * (1_u64 << 52) as f64;
    // So little less than a half that no f32 lies between them.
    const HALF: f64 = 0.5 - 1.0 / (1_u64 << 25) as f64;
    (f64::from(coordinate) * 256.0 - HALF + NO_FRACTIONS).to_bits() as i32
}

/// The line that a height, in 64ths of a line, is rounded to.
fn line(height: i32) -> usize {
    (height + 32) as usize >> 6
}

/// Where a polygon's sides, from its highest to its lowest corner, cross lines, stepped down line by line as
/// tiny-skia's `LineEdge` is; up to [`STRIDE`] lines below the lowest corner are overwritten.
fn follow_sides(corners: &[(i32, i32)], ends: &mut [i32]) {
    let Some((&first, corners)) = corners.split_first() else { return };
    let (mut upper, mut from) = (first, line(first.1));
    for &lower in corners {
        let to = line(lower.1);
        if from < to {
            let slope = ((lower.0 - upper.0) << 16) / (lower.1 - upper.1);
            let down = (from << 6) as i32 + 32 - upper.1;
            let across = (i64::from(slope) * i64::from(down)) >> 16;
            let mut x = ((upper.0 + across as i32) << 10) + (1 << 15);
            while from < to {
                let Some(ends) = ends[from..].first_chunk_mut::<STRIDE>() else { return };
                for end in ends {
                    *end = x >> 16;
                    x = x.wrapping_add(slope);
                }
                from += STRIDE;
            }
        }
        (upper, from) = (lower, to);
    }
}
