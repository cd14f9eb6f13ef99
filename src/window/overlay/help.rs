//! The sheet that lists every key.

use glam::DVec2;
use tiny_skia::PixmapMut;

use crate::paint::BALL;
use crate::paint::text::{LINE, text, width};

use super::super::keys::{Group, HELP};
use super::TEXT_SIZE;
use super::sheet::{INK, QUIET, Rounded, extent};

/// Between the two columns of the help, and around them, in text sizes.
const GAP: f64 = 2.2;
/// The characters of a column: of its keys, and of what they do.
const KEY_CHARACTERS: usize = 14;
const DOES_CHARACTERS: usize = 26;
/// Lines between two groups.
const APART: f64 = 0.7;
/// Lines of the title.
const TITLE: f64 = 1.6;

/// Paints the sheet that lists every key, in two columns in the middle of the picture.
pub(super) fn help(pixmap: &mut PixmapMut<'_>, scale: f64) {
    let column = width("m", 1.0) * (KEY_CHARACTERS + DOES_CHARACTERS) as f64;
    let lines = HELP.iter().map(|groups| height(groups)).fold(0.0, f64::max);
    // In units of the text's size; it shrinks where the window is too small for it.
    let needed = DVec2::new(2.0 * column + 3.0 * GAP, (TITLE + lines) * LINE + 1.6 * GAP);
    let picture = extent(pixmap);
    let size = (TEXT_SIZE * scale).min((picture / needed).min_element());
    let corner = ((picture - needed * size) / 2.0).round();
    Rounded { corner, extent: needed * size, radius: 0.6 * size }.sheet(pixmap, 1.0);

    let start = corner + DVec2::new(GAP, 0.8 * GAP) * size;
    let title = concat!("carom ", env!("CARGO_PKG_VERSION"));
    text(pixmap, start + DVec2::new(0.0, size), size, BALL, title);
    for (groups, index) in HELP.iter().zip(0..) {
        let across = f64::from(index) * (column + GAP);
        let mut line = TITLE;
        for group in *groups {
            let mut row = |key, does, colour| {
                let at = start + DVec2::new(across, line * LINE + 1.0) * size;
                text(pixmap, at, size, colour, key);
                let behind = DVec2::new(width("m", size) * KEY_CHARACTERS as f64, 0.0);
                text(pixmap, at + behind, size, INK, does);
                line += 1.0;
            };
            row(group.name, "", QUIET);
            for &(key, does) in group.keys {
                row(key, does, BALL);
            }
            line += APART;
        }
    }
}

/// The lines that a column takes.
fn height(groups: &[Group]) -> f64 {
    let rows: usize = groups.iter().map(|group| 1 + group.keys.len()).sum();
    rows as f64 + APART * (groups.len() - 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_help_fits_its_columns() {
        for (key, does) in HELP.iter().copied().flatten().flat_map(|group| group.keys) {
            assert!(key.chars().count() + 2 <= KEY_CHARACTERS, "{key}");
            assert!(does.chars().count() <= DOES_CHARACTERS, "{does}");
        }
    }
}
