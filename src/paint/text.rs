//! Text, as outlines that tiny-skia fills: legible at any scale.

use std::sync::OnceLock;

use ab_glyph::{Font, FontRef, GlyphId, OutlineCurve, Point};
use glam::DVec2;
use tiny_skia::{Color, FillRule, Paint, PathBuilder, PixmapMut, Transform};

/// The advance of every glyph of the font, which is monospaced, as a fraction of the size.
const ADVANCE: f64 = 0.602;
/// From one line's baseline to the next's, as a fraction of the size.
pub(crate) const LINE: f64 = 1.5;
/// From the top of a line to its baseline: letters reach about 0.7 above that, and their middle stands in the line's.
pub(crate) const BASELINE: f64 = LINE / 2.0 + 0.35;
/// The box that stands for a character that the font lacks: its left, right and upper edge and the width of its lines,
/// as fractions of the size.
const MISSING: [f64; 4] = [0.08, 0.52, 0.72, 0.05];

/// The glyph of characters that the font lacks.
const LACKING: GlyphId = GlyphId(0);

/// The width of a line of text at `size` px.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    text.chars().count() as f64 * ADVANCE * size
}

/// Fills a line of text whose baseline starts at `at`. A character that the font lacks is shown as a box.
pub(crate) fn text(pixmap: &mut PixmapMut<'_>, at: DVec2, size: f64, colour: impl Into<Color>, text: &str) {
    let Some(font) = font() else { return };
    let Some(units_per_em) = font.units_per_em() else { return };
    let scale = size / f64::from(units_per_em);
    let mut outline = Outline { path: PathBuilder::new(), origin: at, scale };
    for character in text.chars() {
        match font.glyph_id(character) {
            LACKING => outline.missing(size),
            glyph => outline.glyph(&font.outline(glyph).map(|glyph| glyph.curves).unwrap_or_default()),
        }
        outline.origin.x += ADVANCE * size;
    }
    if let Some(path) = outline.path.finish() {
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        paint.set_color(colour.into());
        pixmap.fill_path(&path, &paint, FillRule::Winding, Transform::identity(), None);
    }
}

/// Breaks each paragraph into lines of at most `characters`, between words. A word that is longer is broken, too.
pub(crate) fn wrap<S: AsRef<str>>(paragraphs: &[S], characters: usize) -> Vec<String> {
    let most = characters.max(1);
    let mut lines = Vec::new();
    for paragraph in paragraphs {
        let (mut line, mut count) = (String::new(), 0);
        for word in paragraph.as_ref().split_whitespace() {
            let mut letters: Vec<char> = word.chars().collect();
            if count > 0 && count + 1 + letters.len() <= most {
                line.push(' ');
                count += 1;
            } else if count > 0 {
                lines.push(std::mem::take(&mut line));
                count = 0;
            }
            while count + letters.len() > most {
                lines.push(letters.drain(..most).collect());
            }
            count += letters.len();
            line.extend(letters);
        }
        lines.push(line);
    }
    lines
}

/// The text itself where it has at most so many characters; otherwise its beginning and an ellipsis.
pub(crate) fn shorten(text: &str, characters: usize) -> String {
    if text.chars().count() <= characters {
        return text.to_owned();
    }
    let kept: String = text.chars().take(characters.saturating_sub(1)).collect();
    format!("{}…", kept.trim_end())
}

fn font() -> Option<&'static FontRef<'static>> {
    static FONT: OnceLock<Option<FontRef<'static>>> = OnceLock::new();
    FONT.get_or_init(|| FontRef::try_from_slice(epaint_default_fonts::HACK_REGULAR).ok()).as_ref()
}

/// Glyphs in font units, y up, on their way to a path in px, y down.
struct Outline {
    path: PathBuilder,
    origin: DVec2,
    scale: f64,
}

impl Outline {
    fn point(&self, Point { x, y }: Point) -> (f32, f32) {
        let at = self.origin + DVec2::new(f64::from(x), -f64::from(y)) * self.scale;
        (at.x as f32, at.y as f32)
    }

    /// The closed contours of a glyph: where a curve does not begin at the end of the one before, the next begins.
    fn glyph(&mut self, curves: &[OutlineCurve]) {
        let mut end = None;
        for curve in curves {
            let (&OutlineCurve::Line(start, next)
            | &OutlineCurve::Quad(start, _, next)
            | &OutlineCurve::Cubic(start, _, _, next)) = curve;
            if end != Some(start) {
                self.close(end);
                let (x, y) = self.point(start);
                self.path.move_to(x, y);
            }
            let (x, y) = self.point(next);
            match curve {
                OutlineCurve::Line(..) => self.path.line_to(x, y),
                &OutlineCurve::Quad(_, control, _) => {
                    let (x1, y1) = self.point(control);
                    self.path.quad_to(x1, y1, x, y);
                }
                &OutlineCurve::Cubic(_, first, second, _) => {
                    let ((x1, y1), (x2, y2)) = (self.point(first), self.point(second));
                    self.path.cubic_to(x1, y1, x2, y2, x, y);
                }
            }
            end = Some(next);
        }
        self.close(end);
    }

    /// Closes the contour that ends here, if any does.
    fn close(&mut self, end: Option<Point>) {
        if end.is_some() {
            self.path.close();
        }
    }

    /// The box for a character that the font lacks: a rectangle, and a hole in it that turns the other way.
    fn missing(&mut self, size: f64) {
        let [left, right, top, line] = MISSING.map(|part| (part * size / self.scale) as f32);
        let corners = [(left, 0.0), (left, top), (right, top), (right, 0.0)];
        self.polygon(corners);
        let (left, right, top) = (left + line, right - line, top - line);
        self.polygon([(left, line), (right, line), (right, top), (left, top)]);
    }

    fn polygon(&mut self, corners: [(f32, f32); 4]) {
        let [first, second, third, fourth] = corners.map(|(x, y)| Point { x, y });
        self.glyph(
            &[(first, second), (second, third), (third, fourth)]
                .map(|(from, to)| OutlineCurve::Line(from, to)),
        );
    }
}

#[cfg(test)]
mod tests {
    use tiny_skia::Pixmap;

    use super::*;

    #[test]
    fn the_font_is_there_and_as_wide_as_said() {
        let font = font().unwrap();
        let em = font.units_per_em().unwrap();
        for character in "aM0.←→·".chars() {
            let glyph = font.glyph_id(character);
            let advance = f64::from(font.h_advance_unscaled(glyph) / em);
            assert!(glyph != LACKING && (advance - ADVANCE).abs() < 1e-3, "{character}");
        }
    }

    /// How much of a picture of 20 × 20 px a text covers, in pixels.
    fn ink(letters: &str) -> f64 {
        let mut pixmap = Pixmap::new(20, 20).unwrap();
        text(&mut pixmap.as_mut(), DVec2::new(2.0, 17.0), 20.0, Color::WHITE, letters);
        pixmap.pixels().iter().map(|pixel| f64::from(pixel.alpha()) / 255.0).sum()
    }

    #[test]
    fn a_character_that_the_font_lacks_is_an_empty_box_and_not_nothing() {
        assert_eq!(ink(" "), 0.0);
        let [left, right, top, line] = MISSING.map(|part| 20.0 * part);
        let frame = 2.0 * line * (right - left + top - 2.0 * line);
        for missing in ["\u{10fffd}", "\u{65e5}", "\n", "\u{7}"] {
            assert!((ink(missing) / frame - 1.0).abs() < 0.2, "{missing:?}: {} of {frame}", ink(missing));
        }
    }

    #[test]
    fn lines_break_between_words_and_in_words_too_long_for_one_and_lose_none() {
        let paragraphs = ["one two three", "incomprehensible four", ""];
        assert_eq!(wrap(&paragraphs, 100), paragraphs);
        assert_eq!(wrap(&paragraphs, 7), ["one two", "three", "incompr", "ehensib", "le four", ""]);
        assert_eq!(wrap(&["ab cd"], 0), ["a", "b", "c", "d"]);
        assert_eq!(wrap(&["äö üß"], 2), ["äö", "üß"]);
    }

    #[test]
    fn a_text_is_shortened_only_where_it_is_too_long_and_says_so() {
        assert_eq!((shorten("abcd", 4), shorten("abcd", 3)), ("abcd".to_owned(), "ab…".to_owned()));
        assert_eq!((shorten("a bcd", 3), shorten("abc", 0)), ("a…".to_owned(), "…".to_owned()));
    }
}
