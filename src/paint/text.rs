//! Text, as outlines that tiny-skia fills: legible at any scale.

use std::sync::OnceLock;

use glam::DVec2;
use tiny_skia::{FillRule, PathBuilder, PixmapMut, Transform};
use ttf_parser::{Face, OutlineBuilder};

use super::Colour;

/// The advance of every glyph of the font, which is monospaced, as a fraction of the size.
const ADVANCE: f64 = 0.602;
/// From one line's baseline to the next's, as a fraction of the size.
pub(crate) const LINE: f64 = 1.5;

/// The width of a line of text at `size` px.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    text.chars().count() as f64 * ADVANCE * size
}

/// Fills a line of text whose baseline starts at `at`; characters that the font lacks are left out.
pub(crate) fn text(pixmap: &mut PixmapMut<'_>, at: DVec2, size: f64, colour: Colour, text: &str) {
    let Some(face) = face() else { return };
    let scale = size / f64::from(face.units_per_em());
    let mut outline = Outline { path: PathBuilder::new(), origin: at, scale };
    for character in text.chars() {
        if let Some(glyph) = face.glyph_index(character) {
            face.outline_glyph(glyph, &mut outline);
        }
        outline.origin.x += ADVANCE * size;
    }
    if let Some(path) = outline.path.finish() {
        pixmap.fill_path(&path, &colour.paint(), FillRule::Winding, Transform::identity(), None);
    }
}

fn face() -> Option<&'static Face<'static>> {
    static FACE: OnceLock<Option<Face<'static>>> = OnceLock::new();
    FACE.get_or_init(|| Face::parse(epaint_default_fonts::HACK_REGULAR, 0).ok()).as_ref()
}

/// Glyphs in font units, y up, on their way to a path in px, y down.
struct Outline {
    path: PathBuilder,
    origin: DVec2,
    scale: f64,
}

impl Outline {
    fn point(&self, x: f32, y: f32) -> (f32, f32) {
        let at = self.origin + DVec2::new(f64::from(x), -f64::from(y)) * self.scale;
        (at.x as f32, at.y as f32)
    }
}

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.point(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.point(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.point(x1, y1), self.point(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.point(x1, y1), self.point(x2, y2), self.point(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_is_there_and_as_wide_as_said() {
        let face = face().unwrap();
        let em = f64::from(face.units_per_em());
        for character in "aM0.←→·".chars() {
            let advance = face.glyph_hor_advance(face.glyph_index(character).unwrap()).unwrap();
            assert!((f64::from(advance) / em - ADVANCE).abs() < 1e-3, "{character}");
        }
    }
}
