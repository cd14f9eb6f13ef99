//! The strip that warns of time that runs slower than it should.

use glam::DVec2;
use tiny_skia::PixmapMut;

use crate::paint::text::{BASELINE, LINE, text, width, wrap};
use crate::simulation::Solver;

use super::TEXT_SIZE;
use super::sheet::{AMBER, Area, INK, rectangle, sheet};

/// The height of the amber line below the strip, in text sizes.
const EDGE: f64 = 0.15;
/// The margin around the warning, in text sizes.
const MARGIN: f64 = 0.7;
/// The warning's lines break at the window's edge, but into no fewer characters than this: from there the text shrinks.
const LINE_CHARACTERS: usize = 24;
/// The text's sizes that are tried, px, before less is said; the strip takes no more than this part of the picture's height.
const SIZES: [f64; 3] = [TEXT_SIZE, 12.0, 10.0];
const MOST_HIDDEN: f64 = 0.35;
/// What is said at least.
const SHORT: &str = "Time runs slower.";

/// A strip along the upper edge that says that time runs slower, why, and what to do about it; in a small picture less.
#[derive(Debug)]
pub(super) struct Warning {
    lines: Vec<String>,
    /// The size of the text, px.
    size: f64,
    /// The strip without the line below it, px.
    extent: DVec2,
}

impl Warning {
    pub(super) fn new(picture: DVec2, solver: Solver, scale: f64) -> Self {
        let [why, what] = behind_text(solver);
        let hint = what.split(',').next().unwrap_or_default().to_owned();
        let texts = [vec![why, what], vec![SHORT.to_owned(), hint]];
        let tries = texts.iter().flat_map(|text| SIZES.map(|size| (text, size * scale)));
        let fitting =
            tries.map(|(text, size)| (Self::of(text, picture, size), size)).find(|(warning, size)| {
                warning.size >= *size && warning.area().extent.y <= MOST_HIDDEN * picture.y
            });
        fitting
            .map_or_else(|| Self::of(&[SHORT.to_owned()], picture, SIZES[0] * scale), |(warning, _)| warning)
    }

    /// These paragraphs in text of the size `wanted`, px, or smaller.
    fn of(paragraphs: &[String], picture: DVec2, wanted: f64) -> Self {
        let room = ((picture.x / wanted - 2.0 * MARGIN) / width("m", 1.0)).max(0.0) as usize;
        let lines = wrap(paragraphs, room.max(LINE_CHARACTERS));
        let longest = lines.iter().map(|line| width(line, 1.0)).fold(0.0, f64::max);
        // In units of the text's size; at most half of the picture is covered.
        let needed = DVec2::new(longest, lines.len() as f64 * LINE) + 2.0 * MARGIN;
        let size = wanted.min((picture / (needed * DVec2::new(1.0, 2.0))).min_element());
        Self { lines, size, extent: DVec2::new(picture.x, (needed.y * size).round()) }
    }

    /// The amber line's height, px.
    fn edge(&self) -> f64 {
        (EDGE * self.size).round().max(1.0)
    }

    /// Where it is.
    pub(super) fn area(&self) -> Area {
        Area { corner: DVec2::ZERO, extent: self.extent + DVec2::new(0.0, self.edge()) }
    }

    pub(super) fn paint(&self, pixmap: &mut PixmapMut<'_>) {
        let (size, extent) = (self.size, self.extent);
        sheet(pixmap, DVec2::ZERO, extent);
        rectangle(pixmap, DVec2::new(0.0, extent.y), DVec2::new(extent.x, self.edge()), AMBER);
        for (index, line) in self.lines.iter().enumerate() {
            let baseline = MARGIN + index as f64 * LINE + BASELINE;
            text(pixmap, DVec2::new(MARGIN, baseline) * size, size, INK, line);
        }
    }
}

/// What the warning says of this solver: two sentences.
fn behind_text(solver: Solver) -> [String; 2] {
    // Only events follow every impact: the others have so much to do for each ball.
    let why = if solver == Solver::Exact {
        format!("{solver} has more impacts here than there is time for, so time runs slower.")
    } else {
        format!("{solver} takes longer for a frame here than there is time for, so time runs slower.")
    };
    let piles = Solver::Contact;
    let what = if solver == piles {
        "D: see what takes the time.".to_owned()
    } else {
        let keys = if solver.next() == piles { "S" } else { "S twice" };
        format!("{keys}: take the solver {piles}, which is meant for piles.")
    };
    [why, what]
}

#[cfg(test)]
mod tests {
    use tiny_skia::Pixmap;

    use super::*;

    #[test]
    fn the_warning_says_how_often_s_leads_to_the_solver_for_piles() {
        for &solver in Solver::ALL {
            let [why, what] = behind_text(solver);
            assert!(why.starts_with(solver.name()) && why.contains("time runs slower"), "{why}");
            let presses = match what.split_once(": take the solver contact").map(|(keys, _)| keys) {
                None => 0,
                Some("S") => 1,
                Some("S twice") => 2,
                Some(keys) => panic!("{keys}"),
            };
            let reached = (0..presses).fold(solver, |solver, _| solver.next());
            assert_eq!(reached, Solver::Contact, "{what}");
        }
        assert_eq!(behind_text(Solver::Contact)[1], "D: see what takes the time.");
    }

    /// Where the warning's text reaches, px from the left, and how high its strip is, in a picture of this size.
    fn reach(width: u32, height: u32, scale: f64) -> (usize, usize) {
        let mut pixmap = Pixmap::new(width, height).unwrap();
        let picture = DVec2::new(width.into(), height.into());
        Warning::new(picture, Solver::Exact, scale).paint(&mut pixmap.as_mut());
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
