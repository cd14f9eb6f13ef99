//! Large discs: each row is an opaque span between two edges, blended with the coverage that tiny-skia gives them.

use std::ops::Range;

use super::disc::Disc;
use super::ink::{Ink, Pixel, fill};
use super::lines::{Corners, LINES, Lines, Row};
use super::target::Target;

/// Paints a disc whose radius has been prepared. `lines` is room to work in.
pub(super) fn paint(disc: &Disc, corners: &Corners, lines: &mut Lines, target: &mut Target<'_>) {
    let area = disc.area().intersection(target.clip);
    if area.is_empty() {
        return;
    }
    let (count, ink) = ((area.right - area.left) as usize, Ink::new(disc.colour));
    let from_area = |end: i32| end.wrapping_sub(area.left * LINES as i32);
    let (top, rows) = lines.follow(disc, area, corners);
    for (Row { left, right }, pixels) in rows.zip(target.rows_from(area.left, top)) {
        let row = Row { left: left.map(from_area), right: right.map(from_area) };
        row.paint(&mut pixels[..count], &ink);
    }
}

impl Row {
    /// Paints the row on pixels that begin where ends are 0: edges blended, and what lies between them filled.
    #[inline]
    fn paint(&self, pixels: &mut [Pixel], ink: &Ink) {
        let (Self { left, right }, count) = (self, pixels.len() as i32);
        let start = left[0].min(left[1]).min(left[2].min(left[3])) >> 2;
        let end = (right[0].max(right[1]).max(right[2].max(right[3])) + 3) >> 2;
        // A disc is convex: its narrowest line is the first or the last.
        let full = (left[0].max(left[3]) + 3) >> 2..right[0].min(right[3]) >> 2;
        let block = BLOCK as i32;
        let narrow = full.start <= start + block && end - block <= full.end && start + 2 * block <= end;
        if narrow && 0 <= start && end <= count {
            self.paint_ends(&mut pixels[start as usize..end as usize], start, end - block, ink);
        } else {
            let touched = (0..LINES).filter(|&line| left[line] < right[line]);
            let start = touched.clone().map(|line| left[line] >> 2).min().unwrap_or(0);
            let end = touched.map(|line| (right[line] + 3) >> 2).max().unwrap_or(0);
            self.paint_blocks(pixels, start.max(0)..end.min(count), full.start..full.end.min(count), ink);
        }
    }

    /// Paints exactly the pixels that the row touches, where each of its edges lies in a block: those from columns
    /// `first` and `last` on.
    #[inline]
    fn paint_ends(&self, pixels: &mut [Pixel], first: i32, last: i32, ink: &Ink) {
        let Some((left, rest)) = pixels.split_first_chunk_mut::<BLOCK>() else { return };
        let Some((inside, right)) = rest.split_last_chunk_mut::<BLOCK>() else { return };
        // The remainder spares a check: the ends are within.
        let within = |end: i32, column: i32| (end - column * LINES as i32) as usize % PLACES;
        ink.blend(left, &coverage(self.left.map(|end| within(end, first)), [ENDS - 1; LINES]));
        ink.blend(right, &coverage([0; LINES], self.right.map(|end| within(end, last))));
        fill(inside, ink.pixel);
    }

    /// Paints the columns `touched` block by block, and fills at once what there is of `full` between two blocks.
    fn paint_blocks(&self, pixels: &mut [Pixel], touched: Range<i32>, full: Range<i32>, ink: &Ink) {
        let mut at = touched.start;
        while at < touched.end {
            let part = at * LINES as i32;
            let within = |end: i32| (end.saturating_sub(part).max(0) as usize).min(ENDS - 1);
            let coverage = coverage(self.left.map(within), self.right.map(within));
            let rest = &mut pixels[at as usize..];
            if let Some(pixels) = rest.first_chunk_mut::<BLOCK>() {
                ink.blend(pixels, &coverage);
            } else {
                ink.blend_bytes(rest.as_flattened_mut(), &coverage);
            }
            at += BLOCK as i32;
            if full.contains(&at) {
                fill(&mut pixels[at as usize..full.end as usize], ink.pixel);
                at = full.end;
            }
        }
    }
}

/// Pixels whose coverage is looked up at once. Their bytes are an SSE register.
const BLOCK: usize = 4;
/// Places of an end in a block.
const ENDS: usize = BLOCK * LINES + 1;

/// The coverage, for each byte of a block, of lines that begin and end at these places.
///
/// A part of a line adds 16, and four whole lines are 256, which is 0 here: tiny-skia takes 1 off where all of the last
/// line is covered, so that a whole pixel has 255.
#[inline(always)]
#[expect(clippy::inline_always, reason = "half of it falls away where one of the sides is known")]
fn coverage(left: [usize; LINES], right: [usize; LINES]) -> [u8; 4 * BLOCK] {
    let mut sum = [0_u8; 4 * BLOCK];
    for line in 0..LINES {
        let (behind_left, behind_right) = (&BEHIND[left[line]], &BEHIND[right[line]]);
        sum = std::array::from_fn(|byte| {
            sum[byte].wrapping_add(behind_left[byte]).wrapping_sub(behind_right[byte])
        });
    }
    // Whole pixels before an end are those that do not begin behind one three parts earlier.
    let behind_left = &WHOLE[left[LINES - 1]];
    let not_before_right = &WHOLE[right[LINES - 1].saturating_sub(LINES - 1)];
    std::array::from_fn(|byte| sum[byte].wrapping_sub(behind_left[byte] & !not_before_right[byte]))
}

/// What a line adds to each byte of a block behind an end at each place: to the coverage, and 1 where it covers the
/// whole pixel.
static BEHIND: [[u8; 4 * BLOCK]; PLACES] = behind(16, 1);
static WHOLE: [[u8; 4 * BLOCK]; PLACES] = behind(1, LINES);
/// [`ENDS`] and more, to be a power of two.
const PLACES: usize = 32;

/// `level` for each `parts` of a pixel that lie behind an end.
const fn behind(level: u8, parts: usize) -> [[u8; 4 * BLOCK]; PLACES] {
    let mut levels = [[0; 4 * BLOCK]; PLACES];
    let mut end = 0;
    while end < ENDS {
        let mut byte = 0;
        while byte < 4 * BLOCK {
            let behind = (LINES * (byte / 4 + 1)).saturating_sub(end);
            let behind = if behind < LINES { behind } else { LINES };
            levels[end][byte] = level * (behind / parts) as u8;
            byte += 1;
        }
        end += 1;
    }
    levels
}
