//! What text over the picture stands on, and the colours of all that is painted over it.

use glam::DVec2;
use tiny_skia::{Color, FillRule, Paint, PathBuilder, PixmapMut, Rect, Stroke, Transform};

use crate::paint::Colour;

/// Text, and lines over the picture.
pub(super) const INK: Colour = Colour(0xe6, 0xe6, 0xe6);
/// Text that explains other text: names, units, notes.
pub(super) const QUIET: Colour = Colour(0x9c, 0x9c, 0x9c);
/// What warns.
pub(super) const AMBER: Colour = Colour(0xe0, 0xa0, 0x30);
/// Sheets.
const SHEET: Colour = Colour(0x0c, 0x0c, 0x0c);
/// Opacity of a sheet, 0 to 1: the balls stay visible behind it.
const SHEET_OPACITY: f64 = 225.0 / 255.0;

/// A colour of an opacity from 0 to 1.
pub(super) fn faded(colour: Colour, opacity: f64) -> Color {
    let mut colour = Color::from(colour);
    colour.set_alpha(opacity.clamp(0.0, 1.0) as f32);
    colour
}

/// The size of a picture, px.
pub(super) fn extent(pixmap: &PixmapMut<'_>) -> DVec2 {
    DVec2::new(f64::from(pixmap.width()), f64::from(pixmap.height()))
}

/// Fills a rectangle that the picture shines through a little, for text to stand on.
pub(super) fn sheet(pixmap: &mut PixmapMut<'_>, corner: DVec2, extent: DVec2) {
    rectangle(pixmap, corner, extent, faded(SHEET, SHEET_OPACITY));
}

/// Fills a rectangle of `extent` px from its upper left `corner` on.
pub(super) fn rectangle(pixmap: &mut PixmapMut<'_>, corner: DVec2, extent: DVec2, colour: impl Into<Color>) {
    let rect = Rect::from_xywh(corner.x as f32, corner.y as f32, extent.x as f32, extent.y as f32);
    if let Some(rect) = rect {
        pixmap.fill_rect(rect, &solid(colour), Transform::identity(), None);
    }
}

/// A part of a picture, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub(super) corner: DVec2,
    pub(super) extent: DVec2,
}

impl Area {
    /// Its lower right corner.
    pub(super) fn end(&self) -> DVec2 {
        self.corner + self.extent
    }

    /// Whether a part of it is a part of the other, too.
    pub(super) fn meets(&self, other: &Self) -> bool {
        self.corner.cmplt(other.end()).all() && other.corner.cmplt(self.end()).all()
    }

    /// Whether all of it is in a picture of this size.
    pub(super) fn is_inside(&self, picture: DVec2) -> bool {
        self.corner.cmpge(DVec2::ZERO).all() && self.end().cmple(picture).all()
    }

    /// It as a sheet whose corners have this radius, px.
    pub(super) fn rounded(&self, radius: f64) -> Rounded {
        Rounded { corner: self.corner, extent: self.extent, radius }
    }
}

/// A sheet with round corners.
pub(super) struct Rounded {
    pub(super) corner: DVec2,
    pub(super) extent: DVec2,
    /// The radius of the corners, px.
    pub(super) radius: f64,
}

impl Rounded {
    /// Fills it as a sheet of this opacity, 0 to 1.
    pub(super) fn sheet(&self, pixmap: &mut PixmapMut<'_>, opacity: f64) {
        self.fill(pixmap, faded(SHEET, SHEET_OPACITY * opacity));
    }

    pub(super) fn fill(&self, pixmap: &mut PixmapMut<'_>, colour: impl Into<Color>) {
        if let Some(path) = self.path() {
            pixmap.fill_path(&path, &solid(colour), FillRule::Winding, Transform::identity(), None);
        }
    }

    /// Draws its edge, `width` px wide, half of it inside.
    pub(super) fn edge(&self, pixmap: &mut PixmapMut<'_>, width: f64, colour: impl Into<Color>) {
        if let Some(path) = self.path() {
            let stroke = Stroke { width: width as f32, ..Stroke::default() };
            pixmap.stroke_path(&path, &solid(colour), &stroke, Transform::identity(), None);
        }
    }

    fn path(&self) -> Option<tiny_skia::Path> {
        /// How far from its ends to the corner a cubic has its control points that is nearly a quarter circle.
        const CONTROL: f64 = 0.552_285;
        let half = self.extent / 2.0;
        let radius = self.radius.min(half.min_element());
        if !(radius >= 0.0 && half.is_finite()) {
            return None;
        }
        let middle = self.corner + half;
        let mut path = PathBuilder::new();
        // From each corner's first end to its second, clockwise.
        let corners = [DVec2::new(1.0, -1.0), DVec2::ONE, DVec2::new(-1.0, 1.0), DVec2::NEG_ONE];
        for (index, sign) in corners.into_iter().enumerate() {
            let corner = middle + sign * half;
            let to_x = corner - DVec2::new(sign.x * radius, 0.0);
            let to_y = corner - DVec2::new(0.0, sign.y * radius);
            let (first, last) = if index % 2 == 0 { (to_x, to_y) } else { (to_y, to_x) };
            let at = |point: DVec2| (point.x as f32, point.y as f32);
            let (x, y) = at(first);
            if index == 0 {
                path.move_to(x, y);
            } else {
                path.line_to(x, y);
            }
            let (x1, y1) = at(first.lerp(corner, CONTROL));
            let (x2, y2) = at(last.lerp(corner, CONTROL));
            let (x, y) = at(last);
            path.cubic_to(x1, y1, x2, y2, x, y);
        }
        path.close();
        path.finish()
    }
}

/// An antialiased paint of one colour.
pub(super) fn solid(colour: impl Into<Color>) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color(colour.into());
    paint
}
