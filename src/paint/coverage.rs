//! Small discs: coverage that tiny-skia rasterises once for each radius, sixteen times as large.
//!
//! A disc under [`SMALLEST_SPANS`] px shows tiny-skia's sampling, four rows and four columns a pixel: while it moves,
//! its area wobbles by up to 3 %. Rasterised sixteen times as large, and summed up over the pixels from each of 16×16
//! places, it has the same area in all of them, since each of the small pixels is counted once.

use glam::DVec2;
use tiny_skia::Pixmap;

use super::circle::fill_disc;
use super::disc::Disc;
use super::ink::{Ink, LANES};
use super::target::Target;
use super::{BALL, Colour};

/// From this radius on, px, discs are painted by spans, as tiny-skia's own sampling is fine enough: the area changes by
/// less than 0.2 % when a disc is moved by 1/64 px.
pub(super) const SMALLEST_SPANS: f64 = 10.0;
/// Places within a pixel, along each axis, that a centre is rounded to, as a power of two: a place is a *part* of a
/// pixel.
const PHASE_BITS: u32 = 4;
const PHASES: i32 = 1 << PHASE_BITS;
const PARTS: usize = PHASES as usize;
/// Steps per px that a radius is rounded to.
const STEPS: f64 = 32.0;

/// The masks of small discs, for each radius in use: 17 MB if all there are were in use.
#[derive(Debug, Default)]
pub(super) struct Coverage {
    /// By the radius in steps.
    masks: Vec<Option<Masks>>,
}

/// The coverage of a disc at each of the places within a pixel that its centre may have.
#[derive(Debug)]
struct Masks {
    /// How far the disc reaches from its centre, in parts of a pixel.
    reach: i32,
    /// Rows of a mask.
    rows: usize,
    /// Blocks of [`LANES`] pixels in a row.
    blocks: usize,
    /// Mask for mask, by row and column of the place, and row for row.
    coverage: Vec<[u8; LANES]>,
}

/// A radius in steps.
fn step(radius: f64) -> usize {
    // A disc that can hardly be seen has the smallest radius that can.
    ((radius * STEPS + 0.5) as i32).max(1) as usize
}

impl Coverage {
    /// Makes the masks for a small radius where they are not there.
    pub(super) fn prepare(&mut self, radius: f64) {
        let step = step(radius);
        if self.masks.len() <= step {
            self.masks.resize_with(step + 1, || None);
        }
        self.masks[step].get_or_insert_with(|| Masks::new(step as f64 / STEPS));
    }

    /// Paints a disc whose radius has been prepared.
    pub(super) fn paint(&self, disc: &Disc, target: &mut Target<'_>) {
        if let Some(Some(masks)) = self.masks.get(step(disc.radius)) {
            masks.paint(disc.centre, disc.colour, target);
        }
    }

    /// Bytes of all masks.
    #[cfg(test)]
    fn bytes(&self) -> usize {
        self.masks.iter().flatten().map(|masks| size_of_val(&*masks.coverage)).sum()
    }
}

impl Masks {
    fn new(radius: f64) -> Self {
        let large = radius * f64::from(PHASES);
        let reach = large.ceil() as i32;
        let most = (2 * reach + PHASES - 1).div_euclid(PHASES) + 1;
        let (rows, blocks) = (most as usize, (most as usize).div_ceil(LANES));
        let sums = Sums::of_disc(large, reach, rows);
        let mut coverage = vec![[0; LANES]; PARTS * PARTS * rows * blocks];
        let bytes = coverage.as_flattened_mut();
        for y in 0..PHASES {
            // What rounding leaves of a pixel goes to the next, so that it does not add up.
            let mut rest = [Sums::SQUARE / 2; PARTS];
            for row in 0..rows {
                let strip = sums.strip((first(y, reach) + row as i32) * PHASES - y);
                for (column, (left, right)) in strip.clone().zip(strip.skip(1)).enumerate() {
                    // Side by side in the strip are the places that the centre may have in a row of them.
                    let mut covered = [0; PARTS];
                    for lane in 0..PARTS {
                        let sum = rest[lane] + right[lane] - left[lane];
                        rest[lane] = sum % Sums::SQUARE;
                        covered[lane] = (sum / Sums::SQUARE) as u8;
                    }
                    for (lane, covered) in covered.into_iter().enumerate() {
                        let place = y as usize * PARTS + Sums::place(lane, reach);
                        bytes[(place * rows + row) * blocks * LANES + column] = covered;
                    }
                }
            }
        }
        Self { reach, rows, blocks, coverage }
    }

    fn paint(&self, centre: DVec2, colour: Colour, target: &mut Target<'_>) {
        let (x, y) = (in_parts(centre.x), in_parts(centre.y));
        let (column, row) = (x & (PHASES - 1), y & (PHASES - 1));
        let left = (x >> PHASE_BITS) + first(column, self.reach);
        let top = (y >> PHASE_BITS) + first(row, self.reach);
        let clip = target.clip;
        let (from, to) = (top.max(clip.top), (top + self.rows as i32).min(clip.bottom));
        if from >= to {
            return;
        }
        let width = self.blocks;
        let start = (row * PHASES + column) as usize * self.rows * width;
        let mask = &self.coverage[start + (from - top) as usize * width..start + (to - top) as usize * width];
        let ink = Ink::new(colour);
        if left >= clip.left && left + (width * LANES) as i32 <= clip.right {
            for (mask, pixels) in mask.chunks_exact(width).zip(target.rows_from(left, from)) {
                let (pixels, _) = pixels.as_chunks_mut::<LANES>();
                for (mask, pixels) in mask.iter().zip(pixels) {
                    // Whole pixels too: to tell them apart would take longer.
                    let coverage: [u8; 4 * LANES] = std::array::from_fn(|byte| mask[byte / 4]);
                    ink.blend(pixels, &coverage);
                }
            }
        } else {
            let skipped = (clip.left - left).max(0) as usize;
            let Some(count) = usize::try_from(clip.right - left.max(clip.left)).ok() else { return };
            for (mask, pixels) in mask.chunks_exact(width).zip(target.rows_from(left.max(clip.left), from)) {
                let mask = mask.as_flattened().iter().skip(skipped);
                for (&coverage, pixel) in mask.zip(&mut pixels[..count]) {
                    ink.blend_bytes(pixel, &[coverage; 4]);
                }
            }
        }
    }
}

/// A coordinate in px, rounded to parts of a pixel.
fn in_parts(coordinate: f64) -> i32 {
    // Moved to where truncation rounds down; a small disc that can be seen is no farther from the picture than this.
    const MOVED: i32 = 1 << 16;
    (coordinate * f64::from(PHASES) + (f64::from(MOVED) + 0.5)) as i32 - MOVED
}

/// The first pixel, from that of the centre, that a disc with its centre at a `part` of it reaches.
fn first(part: i32, reach: i32) -> i32 {
    (part - reach) >> PHASE_BITS
}

/// Sums over the rectangles from the upper left corner of a large disc's picture: a summed-area table (Crow 1984).
struct Sums {
    reach: i32,
    /// Of a line, with room on both sides.
    width: usize,
    table: Vec<u32>,
}

impl Sums {
    /// How many pixels become one.
    const SQUARE: u32 = (PHASES * PHASES) as u32;
    /// Before the first column of the disc.
    const ROOM: usize = PARTS - 1;

    /// A disc of `radius` px that reaches `reach` px from its centre, for squares in so many columns.
    fn of_disc(radius: f64, reach: i32, columns: usize) -> Self {
        let (side, width) = (2 * reach as usize, (columns + 1) * PARTS);
        let mut table = vec![0; (side + 1) * width];
        if let Some(mut pixmap) = Pixmap::new(side as u32, side as u32) {
            fill_disc(&mut pixmap.as_mut(), DVec2::splat(f64::from(reach)), radius, BALL);
            for (row, pixels) in pixmap.pixels().chunks_exact(side).enumerate() {
                let (above, below) = table[row * width..].split_at_mut(width);
                let mut sum = 0;
                let mut pixels = pixels.iter();
                for (above, below) in above.iter().zip(below).skip(Self::ROOM + 1) {
                    sum += pixels.next().map_or(0, |pixel| u32::from(pixel.alpha()));
                    *below = above + sum;
                }
            }
        }
        Self { reach, width, table }
    }

    /// Of [`PHASES`] lines from this one on, `y` px from the centre, the sums of all that lies left of each column, from
    /// [`ROOM`](Self::ROOM) before the disc on.
    fn strip(&self, y: i32) -> impl Iterator<Item = [u32; PARTS]> + Clone {
        let line = |y: i32| {
            let line = (y + self.reach).clamp(0, 2 * self.reach) as usize;
            self.table[line * self.width..][..self.width].as_chunks().0
        };
        let lines = line(y).iter().zip(line(y + PHASES));
        lines.map(|(above, below): (&[u32; PARTS], _)| std::array::from_fn(|lane| below[lane] - above[lane]))
    }

    /// The part of a pixel in which the centre of a disc stands whose first pixel begins in this lane of a strip.
    fn place(lane: usize, reach: i32) -> usize {
        (Self::ROOM - lane + reach as usize) % PARTS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_masks_of_all_small_radii_take_no_more_than_20_megabytes() {
        let mut coverage = Coverage::default();
        for step in 0..=(SMALLEST_SPANS * STEPS) as usize * 8 {
            coverage.prepare((step as f64 / STEPS / 8.0).min(SMALLEST_SPANS));
        }
        assert!((10_000_000..20_000_000).contains(&coverage.bytes()), "{} bytes", coverage.bytes());
    }

    #[test]
    fn the_middle_of_a_mask_is_where_the_centre_is_within_a_pixel() {
        for step in [32, 33, 100, 319, 320] {
            let masks = Masks::new(f64::from(step) / STEPS);
            let masks_by_place = masks.coverage.chunks_exact(masks.rows * masks.blocks);
            for (place, mask) in (0..).zip(masks_by_place) {
                let (x, y): (i32, i32) = (place % PHASES, place / PHASES);
                let (mut sum, mut middle) = (0.0, DVec2::ZERO);
                for (row, line) in (0..).zip(mask.chunks_exact(masks.blocks)) {
                    for (column, &coverage) in (0..).zip(line.as_flattened()) {
                        let at = DVec2::new(f64::from(column), f64::from(row)) + 0.5;
                        sum += f64::from(coverage);
                        middle += at * f64::from(coverage);
                    }
                }
                let first = DVec2::new(first(x, masks.reach).into(), first(y, masks.reach).into());
                let centre = DVec2::new(x.into(), y.into()) / f64::from(PHASES);
                let off = (middle / sum + first - centre).abs().max_element();
                assert!(off < 1.0 / 32.0, "{step}, {place}: {off}");
            }
        }
    }

    #[test]
    fn a_disc_has_the_same_coverage_at_every_place_within_a_pixel() {
        for radius in [0.5, 1.0, 3.0, 4.21875, 9.96875] {
            let masks = Masks::new(radius);
            let area = std::f64::consts::PI * radius * radius * 255.0;
            for mask in masks.coverage.chunks_exact(masks.rows * masks.blocks) {
                let sum: f64 = mask.as_flattened().iter().copied().map(f64::from).sum();
                assert!((sum - area).abs() < 1.0 + 0.003 * area, "r {radius}: {sum} of {area}");
            }
            let sums = masks.coverage.chunks_exact(masks.rows * masks.blocks);
            let sums = sums.map(|mask| mask.as_flattened().iter().copied().map(u64::from).sum::<u64>());
            let (low, high) = (sums.clone().min().unwrap(), sums.max().unwrap());
            assert!(high - low <= 1, "r {radius}: {low} to {high}");
        }
    }
}
