//! Where one paints: rows of a picture, and an area of them.

use super::Colour;
use super::ink::{Ink, Pixel};

/// A part of a picture's rows, and where one may paint in it.
pub(super) struct Target<'a> {
    /// Whole rows, from row `top` of the picture on.
    pub(super) pixels: &'a mut [Pixel],
    /// The picture's width, px.
    pub(super) width: usize,
    /// The row of the picture that `pixels` begins with.
    pub(super) top: i32,
    /// What may be painted; within the rows that are there.
    pub(super) clip: Area,
}

/// A rectangle of pixels; empty where an end is not after its start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub(super) left: i32,
    pub(super) top: i32,
    pub(super) right: i32,
    pub(super) bottom: i32,
}

impl Area {
    pub(super) fn is_empty(self) -> bool {
        self.left >= self.right || self.top >= self.bottom
    }

    /// What both have in common.
    pub(super) fn intersection(self, other: Self) -> Self {
        Self {
            left: self.left.max(other.left),
            top: self.top.max(other.top),
            right: self.right.min(other.right),
            bottom: self.bottom.min(other.bottom),
        }
    }

    /// The smallest area that holds both.
    pub(super) fn around(self, other: Self) -> Self {
        Self {
            left: self.left.min(other.left),
            top: self.top.min(other.top),
            right: self.right.max(other.right),
            bottom: self.bottom.max(other.bottom),
        }
    }

    /// The number of its pixels.
    pub(super) fn count(self) -> u64 {
        let side = |low: i32, high: i32| u64::from(high.saturating_sub(low).max(0).unsigned_abs());
        side(self.left, self.right) * side(self.top, self.bottom)
    }
}

impl<'a> Target<'a> {
    /// Whole rows of a picture, from `top` on.
    pub(super) fn rows(pixels: &'a mut [Pixel], width: usize, top: i32) -> Self {
        let rows = (pixels.len() / width) as i32;
        let clip = Area { left: 0, top, right: width as i32, bottom: top + rows };
        Self { pixels, width, top, clip }
    }

    /// The rows from `y` on, each from column `x` on; neither lies before the clip. None where `y` lies beyond it.
    pub(super) fn rows_from(&mut self, x: i32, y: i32) -> impl Iterator<Item = &mut [Pixel]> {
        let start = (y - self.top) as usize * self.width + x as usize;
        self.pixels.get_mut(start..).unwrap_or_default().chunks_mut(self.width)
    }

    /// Fills all that may be painted.
    pub(super) fn fill(&mut self, colour: Colour) {
        let (clip, Ink { pixel, .. }) = (self.clip, Ink::new(colour));
        if clip.is_empty() {
            return;
        }
        let count = (clip.right - clip.left) as usize;
        if count == self.width {
            let start = (clip.top - self.top) as usize * self.width;
            let rows = (clip.bottom - clip.top) as usize;
            self.pixels[start..start + rows * self.width].fill(pixel);
            return;
        }
        let rows = self.rows_from(clip.left, clip.top).take((clip.bottom - clip.top) as usize);
        for row in rows {
            row[..count].fill(pixel);
        }
    }
}
