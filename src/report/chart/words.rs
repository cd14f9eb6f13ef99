//! Text in figures: it stays text in an SVG, and is set glyph by glyph in a picture.
//!
//! The plotting library (plotters 0.3.7) sets a glyph without the space that its font leaves before it, so that some letters touch
//! and others stand apart, and all of them a fifth of their size too high.

use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::draw::{Area, told};

/// The library's name for the font of words.
pub(super) const FONT: &str = "sans-serif";
/// That of the numbers: the other has no minus.
pub(super) const NUMBERS: &str = "monospace";
/// The fonts that the program carries, by these names.
pub(super) const FONTS: [(&str, &[u8]); 2] =
    [(FONT, epaint_default_fonts::UBUNTU_LIGHT), (NUMBERS, epaint_default_fonts::HACK_REGULAR)];
/// How far the line that letters stand on is below their middle, a part of their size: half of what is between small and capital
/// letters.
const MIDDLE: f32 = 0.26;
/// How far that line is above what letters stand over, a part of their size.
const OVER: f32 = 0.25;

/// What figures are drawn on.
pub(super) trait Paper: DrawingBackend {
    /// Whether it takes text as text.
    const TAKES_TEXT: bool;
}

impl Paper for SVGBackend<'_> {
    const TAKES_TEXT: bool = true;
}

impl Paper for BitMapBackend<'_> {
    const TAKES_TEXT: bool = false;
}

/// A line of text.
#[derive(Clone, Copy)]
pub(super) struct Words<'a> {
    pub(super) text: &'a str,
    pub(super) font: &'static str,
    /// Pixels of the drawing.
    pub(super) size: u32,
    pub(super) colour: RGBColor,
    /// Where the place that it is drawn at is on it, along it ...
    pub(super) along: HPos,
    /// ... and across: in its middle, or below it.
    pub(super) across: VPos,
    /// Whether it is read from below.
    pub(super) upright: bool,
}

impl Words<'_> {
    /// Its length, pixels.
    pub(super) fn width(&self) -> i32 {
        self.places().1.ceil() as i32
    }

    /// Its height, pixels, about.
    pub(super) fn height(&self) -> i32 {
        (0.8 * f64::from(self.size)) as i32
    }

    /// Its characters with where each begins, and where the last ends, pixels.
    fn places(&self) -> (Vec<(char, f32)>, f32) {
        let Some(font) = font(self.font) else { return (Vec::new(), 0.0) };
        let font = font.as_scaled(self.size as f32);
        let (mut places, mut end, mut before) = (Vec::new(), 0.0, None);
        for letter in self.text.chars() {
            let glyph = font.glyph_id(letter);
            end += before.map_or(0.0, |before| font.kern(before, glyph));
            places.push((letter, end));
            end += font.h_advance(glyph);
            before = Some(glyph);
        }
        (places, end)
    }

    /// Draws it at this place.
    pub(super) fn draw<DB: Paper>(&self, area: &Area<DB>, (x, y): (i32, i32)) -> Result<(), String> {
        if DB::TAKES_TEXT {
            let turned = if self.upright { FontTransform::Rotate270 } else { FontTransform::None };
            let style: TextStyle<'_> =
                (self.font, self.size).into_font().transform(turned).color(&self.colour);
            let style = style.pos(Pos::new(self.along, self.across));
            return area.draw(&Text::new(self.text, (x, y), style)).map_err(told);
        }
        for (right, down, cover) in self.pixels() {
            let at = if self.upright { (x + down, y - right) } else { (x + right, y + down) };
            area.draw_pixel(at, &self.colour.mix(f64::from(cover.min(1.0)))).map_err(told)?;
        }
        Ok(())
    }

    /// The pixels that it covers, to the right of and below its place, and how much of each.
    fn pixels(&self) -> Vec<(i32, i32, f32)> {
        let Some(font) = font(self.font) else { return Vec::new() };
        let (size, (places, end)) = (self.size as f32, self.places());
        let before = match self.along {
            HPos::Left => 0.0,
            HPos::Center => end / 2.0,
            HPos::Right => end,
        };
        let below = match self.across {
            VPos::Bottom => -OVER,
            VPos::Center | VPos::Top => MIDDLE,
        };
        let mut pixels = Vec::new();
        for (letter, begin) in places {
            let place = point(begin - before, below * size);
            let glyph = font.glyph_id(letter).with_scale_and_position(PxScale::from(size), place);
            if let Some(outline) = font.outline_glyph(glyph) {
                let corner = outline.px_bounds().min;
                outline.draw(|right, down, cover| {
                    pixels.push((corner.x as i32 + right as i32, corner.y as i32 + down as i32, cover));
                });
            }
        }
        pixels
    }
}

/// The font of this name.
fn font(name: &str) -> Option<FontRef<'static>> {
    let (_, font) = FONTS.into_iter().find(|&(known, _)| known == name)?;
    FontRef::try_from_slice(font).ok()
}

#[cfg(test)]
mod tests {
    use ab_glyph::GlyphId;

    use super::*;

    const SIZE: u32 = 300;

    /// Where the ink of a picture of these words begins and ends, pixels from the left, in this many stretches.
    fn stretches(text: &str) -> Vec<(i32, i32)> {
        let (width, height) = (1500, 400);
        let mut pixels = vec![255; 3 * width * height];
        {
            let area =
                BitMapBackend::with_buffer(&mut pixels, (width as u32, height as u32)).into_drawing_area();
            let words = Words {
                text,
                font: FONT,
                size: SIZE,
                colour: RGBColor(0, 0, 0),
                along: HPos::Left,
                across: VPos::Center,
                upright: false,
            };
            words.draw(&area, (0, 200)).unwrap();
        }
        let is_inked = |&x: &usize| (0..height).any(|y| pixels[3 * (y * width + x)] < 128);
        let mut stretches: Vec<(i32, i32)> = Vec::new();
        for x in (0..width).filter(is_inked).map(|x| x as i32) {
            match stretches.last_mut().filter(|(_, end)| *end == x) {
                Some((_, end)) => *end = x + 1,
                None => stretches.push((x, x + 1)),
            }
        }
        stretches
    }

    #[test]
    fn letters_stand_as_far_apart_as_their_font_says() {
        let font = font(FONT).unwrap();
        let scaled = font.as_scaled(SIZE as f32);
        for text in ["ll", "ol", "lo", "by", "rb", "no"] {
            let (mut place, mut expected, mut before) = (0.0, Vec::new(), None);
            for letter in text.chars() {
                let glyph = font.glyph_id(letter);
                place += before.map_or(0.0, |before| scaled.kern(before, glyph));
                let units = font.outline(glyph).unwrap().bounds;
                let size = scaled.h_scale_factor();
                let (left, right) =
                    (units.min.x.min(units.max.x) * size, units.min.x.max(units.max.x) * size);
                expected.push((place + left, place + right));
                place += scaled.h_advance(glyph);
                before = Some(glyph);
            }
            let found = stretches(text);
            assert_eq!(found.len(), expected.len(), "{text}: {found:?}");
            for ((begin, end), (left, right)) in found.iter().zip(&expected) {
                let off = (*begin as f32 - left).abs().max((*end as f32 - right).abs());
                assert!(off < 1.5, "{text}: {found:?} is not {expected:?}");
            }
        }
    }

    #[test]
    fn the_fonts_have_every_character_that_figures_use() {
        let (text, numbers) = ("0123456789.,:;()/·–×=+²³⁴⁵⁶⁷⁸⁹µabcxyzABCXYZ'%", "0123456789.-−");
        for (name, used) in [(FONT, text), (NUMBERS, numbers)] {
            let font = font(name).unwrap();
            let missing: String = used.chars().filter(|&it| font.glyph_id(it) == GlyphId(0)).collect();
            assert_eq!(missing, "");
        }
    }
}
