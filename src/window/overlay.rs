//! What is painted over the simulation: the help sheet, and the ball that is about to be thrown.

use glam::DVec2;
use tiny_skia::{Color, Paint, PathBuilder, PixmapMut, Rect, Stroke, Transform};

use crate::paint::text::{LINE, text, width};
use crate::paint::{BALL, Colour, disc};

use super::keys;

/// Text on the help sheet, and lines over the picture.
const INK: Colour = Colour(0xe6, 0xe6, 0xe6);
/// Opacity of the sheet, 0 to 255: the balls stay visible behind it.
const SHEET_ALPHA: u8 = 225;
/// Size of the help's text, px.
const TEXT_SIZE: f64 = 15.0;
/// Between the two columns of the help, and around them, in text sizes.
const GAP: f64 = 2.5;
/// Columns are this wide at least: keys, and what they do, in characters.
const KEY_CHARACTERS: usize = 11;
const DOES_CHARACTERS: usize = 22;

/// Paints the sheet that lists every key, in two columns in the middle of the picture.
pub(super) fn help(pixmap: &mut PixmapMut<'_>, scale: f64) {
    let rows = keys::help();
    let lines = rows.len().div_ceil(2);
    let column = |size: f64| width("m", size) * (KEY_CHARACTERS + DOES_CHARACTERS) as f64;
    // In units of the text's size; it shrinks where the window is too small for it.
    let extent = DVec2::new(2.0 * column(1.0) + 3.0 * GAP, (lines as f64 + 1.5) * LINE + 2.0 * GAP);
    let picture = DVec2::new(f64::from(pixmap.width()), f64::from(pixmap.height()));
    let size = (TEXT_SIZE * scale).min((picture / extent).min_element());
    let corner = ((picture - extent * size) / 2.0).round();

    let sheet =
        Rect::from_xywh(corner.x as f32, corner.y as f32, (extent.x * size) as f32, (extent.y * size) as f32);
    if let Some(sheet) = sheet {
        let mut paint = Paint::default();
        paint.set_color(Color::from_rgba8(0x0c, 0x0c, 0x0c, SHEET_ALPHA));
        pixmap.fill_rect(sheet, &paint, Transform::identity(), None);
    }
    let start = corner + GAP * size;
    let title = concat!("carom ", env!("CARGO_PKG_VERSION"));
    text(pixmap, start + DVec2::new(0.0, size), size, BALL, title);
    for (index, (key, does)) in rows.iter().enumerate() {
        let across = (index / lines) as f64 * (column(size) + GAP * size);
        let down = ((index % lines) as f64 + 1.5) * LINE * size + size;
        let at = start + DVec2::new(across, down);
        text(pixmap, at, size, BALL, key);
        let behind = width("m", size) * KEY_CHARACTERS as f64;
        text(pixmap, at + DVec2::new(behind, 0.0), size, INK, does);
    }
}

/// Paints the ball that will be added and a line to where its velocity points; all in pixels.
pub(super) fn throw(pixmap: &mut PixmapMut<'_>, from: DVec2, to: DVec2, radius: f64, scale: f64) {
    disc(pixmap, from, radius, BALL);
    let mut path = PathBuilder::new();
    path.move_to(from.x as f32, from.y as f32);
    path.line_to(to.x as f32, to.y as f32);
    if let Some(path) = path.finish() {
        let stroke = Stroke { width: (2.0 * scale) as f32, ..Stroke::default() };
        pixmap.stroke_path(&path, &INK.paint(), &stroke, Transform::identity(), None);
    }
}

#[cfg(test)]
mod tests {
    use tiny_skia::Pixmap;

    use super::*;

    #[test]
    fn the_help_fits_its_columns() {
        for (key, does) in keys::help() {
            assert!(key.chars().count() < KEY_CHARACTERS, "{key}");
            assert!(does.chars().count() <= DOES_CHARACTERS, "{does}");
        }
    }

    #[test]
    fn overlays_paint_on_any_size() {
        for (width, height) in [(1, 1), (40, 3000), (1280, 720), (4000, 40)] {
            let mut pixmap = Pixmap::new(width, height).unwrap();
            help(&mut pixmap.as_mut(), 2.0);
            throw(&mut pixmap.as_mut(), DVec2::ZERO, DVec2::splat(1e6), 20.0, 1.0);
            throw(&mut pixmap.as_mut(), DVec2::ZERO, DVec2::ZERO, 20.0, 1.0);
        }
    }
}
