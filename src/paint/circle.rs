//! Circles as polygons, and discs as tiny-skia fills them.

use std::f64::consts::{PI, TAU};

use glam::DVec2;
use tiny_skia::{FillRule, Path, PathBuilder, PixmapMut, Transform};

use super::Colour;

/// How far a circle's polygon may leave the circle, px; farther only for circles that no screen holds.
const SAGITTA: f64 = 0.05;
/// The fewest and the most sides of a polygon.
const SIDES: (f64, f64) = (16.0, 1024.0);

/// The sides of the polygon that a circle is taken for.
///
/// tiny-skia's own circle is flattened so coarsely that a disc of 10 px loses 2 % of its area; this polygon, in about
/// the same time, less than 0.2 %.
pub(super) fn sides(radius: f64) -> usize {
    // A chord over the angle 2h leaves the circle by r(1 − cos h) ≈ rh²/2.
    (PI * (radius / (2.0 * SAGITTA)).sqrt()).clamp(SIDES.0, SIDES.1).ceil() as usize
}

/// The corners of the polygon for a circle of radius 1 around the origin, with the circle's area; from the right and
/// clockwise as the screen shows it.
pub(super) fn corners(sides: usize) -> impl Iterator<Item = DVec2> {
    let turn = DVec2::from_angle(TAU / sides as f64);
    // The polygon's area is n/2·R² sin(2π/n), the circle's π.
    let first = DVec2::new((TAU / sides as f64 / turn.y).sqrt(), 0.0);
    std::iter::successors(Some(first), move |&corner| Some(turn.rotate(corner))).take(sides)
}

/// A corner of the polygon for a circle of radius 1, brought to its place in another as tiny-skia takes it.
pub(super) fn place(corner: DVec2, centre: DVec2, radius: f64) -> (f32, f32) {
    let at = centre + corner * radius;
    (at.x as f32, at.y as f32)
}

/// Fills an antialiased disc by tiny-skia's own rasteriser.
pub(super) fn fill_disc(pixmap: &mut PixmapMut<'_>, centre: DVec2, radius: f64, colour: Colour) {
    if let Some(path) = circle(centre, radius) {
        pixmap.fill_path(&path, &colour.paint(), FillRule::Winding, Transform::identity(), None);
    }
}

/// A circle as a path for tiny-skia to fill.
fn circle(centre: DVec2, radius: f64) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (index, corner) in corners(sides(radius)).enumerate() {
        let (x, y) = place(corner, centre, radius);
        if index == 0 {
            path.move_to(x, y);
        } else {
            path.line_to(x, y);
        }
    }
    path.close();
    path.finish()
}
