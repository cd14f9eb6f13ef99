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

/// The energy that was given has its line, and room for it, where it is at most this many times the highest that is drawn:
/// beyond, all else would be one line along the bottom.
const MOST_GIVEN: f64 = 2.0;

/// The least and the greatest energy that the chart has room for, halved, so that their difference is finite, too; and the one
/// that was given, if it is among them.
fn range(gauge: &Gauge, start: f64) -> (f64, f64, Option<f64>) {
    let drawn = gauge.points().filter(|point| point.time >= start);
    let all = drawn.flat_map(|point| [point.kinetic, point.potential, point.kinetic + point.potential]);
    let (low, high) =
        all.fold((0.0_f64, 0.0_f64), |(low, high), value| (low.min(value / 2.0), high.max(value / 2.0)));
    let given = gauge.figures().and_then(|figures| figures.given);
    let most = MOST_GIVEN * high.max(-low);
    let given = given.filter(|given| given.is_finite() && (given / 2.0).abs() <= most);
    let half = given.map_or(0.0, |given| given / 2.0);
    (low.min(half), high.max(half), given)
}

/// Paints the chart in `extent` px from `corner` on, and what it shows beneath it, for text of `size` px around it.
pub(super) fn paint(pixmap: &mut PixmapMut<'_>, gauge: &Gauge, corner: DVec2, extent: DVec2, size: f64) {
    rectangle(pixmap, corner, extent, faded(INK, 0.06));
    let Some(now) = gauge.points().next_back().map(|point| point.time) else { return };
    // Before ten seconds have passed, the line begins at the left.
    let start = (now - SPAN).max(gauge.points().next().map_or(now, |point| point.time).min(now));
    let (low, high, given) = range(gauge, start);
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

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::super::gauge::Frame;
    use super::*;
    use crate::scene::Scene;
    use crate::simulation::invariants;

    #[test]
    fn energy_that_was_given_and_is_long_gone_leaves_the_curves_their_room() {
        let simulation = Scene::load("elastic").unwrap().build().unwrap();
        let energy = invariants::energy(simulation.world(), simulation.balls());
        for (given, is_drawn) in [(energy, true), (1.5 * energy, true), (1000.0 * energy, false)] {
            let mut gauge = Gauge::default();
            gauge.feed(&Frame {
                scene: "elastic",
                simulation: &simulation,
                time_scale: 1.0,
                speed: None,
                paused: false,
                measured: 1.0,
                given: Some(given),
                split: [Duration::ZERO; 3],
            });
            let (low, high, level) = range(&gauge, 0.0);
            assert_eq!((low, level.is_some()), (0.0, is_drawn), "{given}");
            assert!(2.0 * high <= 1.5 * energy, "{high} for {energy}");
        }
    }
}
