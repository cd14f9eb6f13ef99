//! A disc as it is to be painted.

use glam::DVec2;

use super::Colour;
use super::coverage::SMALLEST_SPANS;
use super::target::Area;

/// A ball in pixels of the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Disc {
    pub(super) centre: DVec2,
    pub(super) radius: f64,
    pub(super) colour: Colour,
}

impl Disc {
    /// Whether there is any of it in a picture of this size; of a NaN, or of a negative scale, there is not.
    pub(super) fn is_inside(&self, size: DVec2) -> bool {
        let inside = (self.centre + self.radius).cmpgt(DVec2::ZERO) & (self.centre - self.radius).cmplt(size);
        self.radius > 0.0 && inside.all()
    }

    /// Whether it is painted by a mask, and not by spans.
    pub(super) fn is_small(&self) -> bool {
        self.radius < SMALLEST_SPANS
    }

    /// The pixels that it may touch, and some around them: what is rounded moves its edge by less than a pixel.
    pub(super) fn area(&self) -> Area {
        let reach = self.radius + 1.0;
        // Truncation rounds up left of 0, where nothing is painted.
        let low = |centre: f64| ((centre - reach) as i32).saturating_sub(1);
        let high = |centre: f64| ((centre + reach) as i32).saturating_add(1);
        Area {
            left: low(self.centre.x),
            top: low(self.centre.y),
            right: high(self.centre.x),
            bottom: high(self.centre.y),
        }
    }

    /// About how long it takes to paint it, ns.
    pub(super) fn cost(&self) -> u64 {
        // Larger ones are cut off at the borders.
        let radius = self.radius.min(1000.0);
        let cost = if self.is_small() {
            20.0 + 4.0 * radius * radius
        } else {
            200.0 + radius * (25.0 + 0.4 * radius)
        };
        (cost as u32).into()
    }
}
