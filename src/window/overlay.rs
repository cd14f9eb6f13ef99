//! What is painted over the simulation: the help sheet, the strip that warns of slow time, and the ball that is about to
//! be thrown.

use glam::DVec2;
use tiny_skia::{Color, Paint, PathBuilder, PixmapMut, Rect, Stroke, Transform};

use crate::paint::text::{LINE, text, width};
use crate::paint::{BALL, Colour, fill_disc};
use crate::simulation::Solver;

use super::keys;

/// Text on the help sheet, and lines over the picture.
const INK: Colour = Colour(0xe6, 0xe6, 0xe6);
/// The edge of the warning strip.
const AMBER: Colour = Colour(0xe0, 0xa0, 0x30);
/// How high that edge is, below the strip, and how wide the margin around the warning, in text sizes.
const EDGE: f64 = 0.15;
const MARGIN: f64 = 0.7;
/// The warning's lines break at the window's edge, but into no fewer characters than this: from there the text shrinks.
const LINE_CHARACTERS: usize = 24;
/// Opacity of the sheet, 0 to 255: the balls stay visible behind it.
const SHEET_ALPHA: u8 = 225;
/// Size of the help's text, px.
const TEXT_SIZE: f64 = 15.0;
/// Between the two columns of the help, and around them, in text sizes.
const GAP: f64 = 2.5;
/// Columns are this wide at least: keys, and what they do, in characters.
const KEY_CHARACTERS: usize = 11;
const DOES_CHARACTERS: usize = 22;

/// What is painted over the balls in a frame.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Overlay {
    /// A ball that is about to be thrown: its centre, where the pointer is, and its radius, px of the world.
    pub(super) throw: Option<(DVec2, DVec2, f64)>,
    pub(super) sheet: Option<Sheet>,
}

/// A sheet over the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sheet {
    /// Every key and what it does.
    Help,
    /// Time runs slower than it should, with this solver.
    Behind(Solver),
}

impl Overlay {
    pub(super) fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    pub(super) fn paint(&self, pixmap: &mut PixmapMut<'_>, scale: f64) {
        if let Some((from, to, radius)) = self.throw {
            throw(pixmap, from * scale, to * scale, radius * scale, scale);
        }
        match self.sheet {
            Some(Sheet::Help) => help(pixmap, scale),
            Some(Sheet::Behind(solver)) => behind(pixmap, solver, scale),
            None => {}
        }
    }
}

/// Paints the sheet that lists every key, in two columns in the middle of the picture.
fn help(pixmap: &mut PixmapMut<'_>, scale: f64) {
    let rows = keys::help();
    let lines = rows.len().div_ceil(2);
    let column = |size: f64| width("m", size) * (KEY_CHARACTERS + DOES_CHARACTERS) as f64;
    // In units of the text's size; it shrinks where the window is too small for it.
    let extent = DVec2::new(2.0 * column(1.0) + 3.0 * GAP, (lines as f64 + 1.5) * LINE + 2.0 * GAP);
    let picture = DVec2::new(f64::from(pixmap.width()), f64::from(pixmap.height()));
    let size = (TEXT_SIZE * scale).min((picture / extent).min_element());
    let corner = ((picture - extent * size) / 2.0).round();

    sheet(pixmap, corner, extent * size);
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

/// Paints a strip along the upper edge that says that time runs slower, why, and what to do about it.
fn behind(pixmap: &mut PixmapMut<'_>, solver: Solver, scale: f64) {
    let solvers: Vec<_> = Solver::ALL.iter().map(|solver| solver.name()).collect();
    let picture = DVec2::new(f64::from(pixmap.width()), f64::from(pixmap.height()));
    let wanted = TEXT_SIZE * scale;
    let room = ((picture.x / wanted - 2.0 * MARGIN) / width("m", 1.0)).max(0.0) as usize;
    let lines = wrap(&behind_text(solver.name(), &solvers), room.max(LINE_CHARACTERS));
    let longest = lines.iter().map(|line| width(line, 1.0)).fold(0.0, f64::max);
    // In units of the text's size; at most half of the picture is covered.
    let extent = DVec2::new(longest, lines.len() as f64 * LINE) + 2.0 * MARGIN;
    let size = wanted.min((picture / (extent * DVec2::new(1.0, 2.0))).min_element());
    let height = (extent.y * size).round();
    sheet(pixmap, DVec2::ZERO, DVec2::new(picture.x, height));
    let edge = (EDGE * size).round().max(1.0);
    rectangle(pixmap, DVec2::new(0.0, height), DVec2::new(picture.x, edge), AMBER.into());
    for (index, line) in lines.iter().enumerate() {
        // Letters reach about 0.7 above the baseline; their middle stands in the line's.
        let baseline = MARGIN + index as f64 * LINE + LINE / 2.0 + 0.35;
        text(pixmap, DVec2::new(MARGIN, baseline) * size, size, INK, line);
    }
}

/// What the warning says: two sentences, for the solver in use and the names of all there are.
fn behind_text(solver: &str, solvers: &[&str]) -> [String; 2] {
    let why = format!("{solver} has more impacts here than it can follow in real time, so time runs slower.");
    let piles = "contact";
    let what = if solver != piles && solvers.contains(&piles) {
        format!("S: take the solver {piles}, which is meant for piles.")
    } else {
        "S: take another solver.".to_owned()
    };
    [why, what]
}

/// Breaks each paragraph into lines of at most `characters`, between words; a longer word has a line of its own.
fn wrap(paragraphs: &[String], characters: usize) -> Vec<String> {
    let mut lines = Vec::new();
    for paragraph in paragraphs {
        let mut line = String::new();
        for word in paragraph.split_whitespace() {
            if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > characters {
                lines.push(std::mem::take(&mut line));
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
        lines.push(line);
    }
    lines
}

/// Fills a rectangle that the picture shines through a little, for text to stand on.
fn sheet(pixmap: &mut PixmapMut<'_>, corner: DVec2, extent: DVec2) {
    rectangle(pixmap, corner, extent, Color::from_rgba8(0x0c, 0x0c, 0x0c, SHEET_ALPHA));
}

fn rectangle(pixmap: &mut PixmapMut<'_>, corner: DVec2, extent: DVec2, colour: Color) {
    let rect = Rect::from_xywh(corner.x as f32, corner.y as f32, extent.x as f32, extent.y as f32);
    if let Some(rect) = rect {
        let mut paint = Paint::default();
        paint.set_color(colour);
        pixmap.fill_rect(rect, &paint, Transform::identity(), None);
    }
}

/// Paints the ball that will be added and a line to where its velocity points; all in pixels.
fn throw(pixmap: &mut PixmapMut<'_>, from: DVec2, to: DVec2, radius: f64, scale: f64) {
    fill_disc(pixmap, from, radius, BALL);
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
            behind(&mut pixmap.as_mut(), Solver::Exact, 2.0);
            throw(&mut pixmap.as_mut(), DVec2::ZERO, DVec2::splat(1e6), 20.0, 1.0);
            throw(&mut pixmap.as_mut(), DVec2::ZERO, DVec2::ZERO, 20.0, 1.0);
        }
    }

    #[test]
    fn the_warning_names_the_solver_for_piles_where_there_is_one() {
        let [why, what] = behind_text("exact", &["canvas", "exact"]);
        assert!(why.starts_with("exact has more impacts here") && why.contains("time runs slower"));
        assert_eq!(what, "S: take another solver.");
        let [_, what] = behind_text("exact", &["canvas", "exact", "contact"]);
        assert_eq!(what, "S: take the solver contact, which is meant for piles.");
        let [why, what] = behind_text("contact", &["canvas", "exact", "contact"]);
        assert!(why.starts_with("contact"));
        assert_eq!(what, "S: take another solver.");
    }

    #[test]
    fn lines_break_between_words_and_lose_none() {
        let paragraphs = ["one two three".to_owned(), "incomprehensible four".to_owned()];
        assert_eq!(wrap(&paragraphs, 100), paragraphs);
        assert_eq!(wrap(&paragraphs, 7), ["one two", "three", "incomprehensible", "four"]);
        assert_eq!(wrap(&paragraphs, 0), ["one", "two", "three", "incomprehensible", "four"]);
    }

    /// Where the warning's text reaches, px from the left, and how high its strip is, in a picture of this size.
    fn reach(width: u32, height: u32, scale: f64) -> (usize, usize) {
        let mut pixmap = Pixmap::new(width, height).unwrap();
        behind(&mut pixmap.as_mut(), Solver::Exact, scale);
        let row = |y: usize| &pixmap.pixels()[y * width as usize..(y + 1) * width as usize];
        let strip = (0..height as usize).filter(|&y| row(y)[0].alpha() > 0).count();
        let light = |pixel: &tiny_skia::PremultipliedColorU8| pixel.blue() > 0x60;
        let right = (0..height as usize).filter_map(|y| row(y).iter().rposition(light)).max();
        (right.unwrap(), strip)
    }

    #[test]
    fn the_warning_is_as_large_as_the_scale_says_and_fits_narrow_windows() {
        let (right, strip) = reach(1280, 720, 1.0);
        assert!(right < 1280 && (50..90).contains(&strip), "two lines: {right} px, {strip} px high");
        let (right_twice, strip_twice) = reach(2560, 1440, 2.0);
        assert!(right_twice.abs_diff(2 * right) <= 4 && strip_twice.abs_diff(2 * strip) <= 4);
        for (width, height) in [(500, 400), (240, 600), (100, 400), (400, 60)] {
            let (right, strip) = reach(width, height, 1.0);
            assert!(right < width as usize, "{width}x{height}: {right}");
            assert!(strip <= height as usize / 2 + 2, "{width}x{height}: {strip}");
        }
    }
}
