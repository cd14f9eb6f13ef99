//! What discs of each size are painted with, kept from picture to picture.

use super::BACKGROUND;
use super::coverage::Coverage;
use super::disc::Disc;
use super::lines::{Corners, Lines};
use super::spans;
use super::target::Target;

/// What discs need to be painted, beside themselves.
#[derive(Debug, Default)]
pub(super) struct Shapes {
    coverage: Coverage,
    corners: Corners,
}

impl Shapes {
    /// Makes what a disc needs where it is not there.
    pub(super) fn prepare(&mut self, disc: &Disc) {
        if disc.is_small() {
            self.coverage.prepare(disc.radius);
        } else {
            self.corners.prepare(disc.radius);
        }
    }

    /// Paints the background and the discs, which have been prepared, as far as the target's clip allows.
    pub(super) fn paint<'a>(&self, discs: impl Iterator<Item = &'a Disc>, mut target: Target<'_>) {
        target.fill(BACKGROUND);
        let mut lines = Lines::default();
        for disc in discs {
            self.paint_one(disc, &mut lines, &mut target);
        }
    }

    /// Paints a disc, which has been prepared. `lines` is room to work in.
    pub(super) fn paint_one(&self, disc: &Disc, lines: &mut Lines, target: &mut Target<'_>) {
        if disc.is_small() {
            self.coverage.paint(disc, target);
        } else {
            spans::paint(disc, &self.corners, lines, target);
        }
    }
}
