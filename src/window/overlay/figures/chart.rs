//! The strip chart: kinetic and potential energy over the last ten simulated seconds.

use glam::DVec2;
use tiny_skia::{PathBuilder, PixmapMut, Stroke, Transform};

use crate::paint::Colour;
use crate::paint::text::{LINE, text, width};

use super::super::sheet::{INK, QUIET, faded, rectangle, solid};
use super::gauge::{Gauge, Point, SPAN};

/// The two energies: far apart in hue and in grey, and quieter than balls.
pub(super) const KINETIC: Colour = Colour(0x5c, 0xd0, 0xbc);
pub(super) const POTENTIAL: Colour = Colour(0xb0, 0x82, 0xd8);
/// Size of the words beneath, in text sizes.
const SMALL: f64 = 0.85;
/// Width of a line, in text sizes.
const STROKE: f64 = 0.12;

/// Paints the chart in `extent` px from `corner` on, and what it shows beneath it, for text of `size` px around it.
pub(super) fn paint(pixmap: &mut PixmapMut<'_>, gauge: &Gauge, corner: DVec2, extent: DVec2, size: f64) {
    rectangle(pixmap, corner, extent, faded(INK, 0.06));
    let total = |point: &Point| point.kinetic + point.potential;
    let Some(now) = gauge.points().next_back().map(|point| point.time) else { return };
    let given = gauge.figures().map(|figures| figures.given).filter(|given| given.is_finite());
    let all = || gauge.points().flat_map(|point| [point.kinetic, point.potential, total(point)]).chain(given);
    // Half of each, so that their difference is finite, too.
    let (low, high) =
        all().fold((0.0_f64, 0.0_f64), |(low, high), value| (low.min(value / 2.0), high.max(value / 2.0)));
    // Before ten seconds have passed, the line begins at the left.
    let start = (now - SPAN).max(gauge.points().next().map_or(now, |point| point.time).min(now));
    let place = |time: f64, energy: f64| {
        let part = DVec2::new((time - start) / SPAN, (high - energy / 2.0) / (high - low));
        corner + part * extent
    };
    if high > low {
        if let Some(given) = given {
            let level = place(start, given);
            rectangle(pixmap, level - DVec2::new(0.0, 0.5), DVec2::new(extent.x, 1.0), faded(QUIET, 0.5));
        }
        let total: fn(&Point) -> f64 = |point| point.kinetic + point.potential;
        let curves = [
            (total, faded(QUIET, 0.7), 0.6),
            (|point| point.potential, POTENTIAL.into(), 1.0),
            (|point| point.kinetic, KINETIC.into(), 1.0),
        ];
        for (energy, colour, weight) in curves {
            let mut path = PathBuilder::new();
            for point in gauge.points().filter(|point| point.time >= start) {
                let at = place(point.time, energy(point));
                let (x, y) = (at.x as f32, at.y as f32);
                if path.is_empty() { path.move_to(x, y) } else { path.line_to(x, y) }
            }
            let stroke = Stroke { width: (weight * STROKE * size) as f32, ..Stroke::default() };
            if let Some(path) = path.finish() {
                pixmap.stroke_path(&path, &solid(colour), &stroke, Transform::identity(), None);
            }
        }
    }
    let small = SMALL * size;
    let below = corner + DVec2::new(0.0, extent.y + LINE * size - 0.3 * small);
    text(pixmap, below, small, QUIET, "energy");
    let span = format!("last {SPAN:.0} s");
    text(pixmap, below + DVec2::new(extent.x - width(&span, small), 0.0), small, QUIET, &span);
}
