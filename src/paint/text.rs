//! Text, as outlines that tiny-skia fills: legible at any scale.

use std::sync::OnceLock;

use glam::DVec2;
use tiny_skia::{Color, FillRule, Paint, PathBuilder, PixmapMut, Transform};
use ttf_parser::{Face, OutlineBuilder};

/// The advance of every glyph of the font, which is monospaced, as a fraction of the size.
const ADVANCE: f64 = 0.602;
/// From one line's baseline to the next's, as a fraction of the size.
pub(crate) const LINE: f64 = 1.5;
/// From the top of a line to its baseline: letters reach about 0.7 above that, and their middle stands in the line's.
pub(crate) const BASELINE: f64 = LINE / 2.0 + 0.35;
/// The box that stands for a character that the font lacks: its left, right and upper edge and the width of its lines,
/// as fractions of the size.
const MISSING: [f64; 4] = [0.08, 0.52, 0.72, 0.05];

/// The width of a line of text at `size` px.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    text.chars().count() as f64 * ADVANCE * size
}

/// Fills a line of text whose baseline starts at `at`. A character that the font lacks is shown as a box.
pub(crate) fn text(pixmap: &mut PixmapMut<'_>, at: DVec2, size: f64, colour: impl Into<Color>, text: &str) {
    let Some(face) = face() else { return };
    let scale = size / f64::from(face.units_per_em());
    let mut outline = Outline { path: PathBuilder::new(), origin: at, scale };
    for character in text.chars() {
        match face.glyph_index(character) {
            Some(glyph) => drop(face.outline_glyph(glyph, &mut outline)),
            None => outline.missing(size),
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

    /// The box for a character that the font lacks: a rectangle, and a hole in it that turns the other way.
    fn missing(&mut self, size: f64) {
        let [left, right, top, line] = MISSING.map(|part| (part * size / self.scale) as f32);
        let corners = [(left, 0.0), (left, top), (right, top), (right, 0.0)];
        self.polygon(corners);
        let (left, right, top) = (left + line, right - line, top - line);
        self.polygon([(left, line), (right, line), (right, top), (left, top)]);
    }

    fn polygon(&mut self, [first, others @ ..]: [(f32, f32); 4]) {
        self.move_to(first.0, first.1);
        for (x, y) in others {
            self.line_to(x, y);
        }
        self.close();
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
    use tiny_skia::Pixmap;

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
