//! The sheet that lists every key; page by page where the picture is too small for all of them.

use glam::DVec2;
use tiny_skia::PixmapMut;

use crate::paint::text::{LINE, text, width};
use crate::paint::{BALL, Colour};

use super::super::keys::{Group, HELP};
use super::TEXT_SIZE;
use super::sheet::{Area, INK, QUIET};

/// Between the two columns of the help, and around them, in text sizes.
const GAP: f64 = 2.2;
/// The characters of a column: of its keys, and of what they do.
const KEY_CHARACTERS: usize = 14;
const DOES_CHARACTERS: usize = 26;
/// Lines between two groups.
const APART: f64 = 0.7;
/// Lines of the title.
const TITLE: f64 = 1.6;
/// The text of all keys shrinks to this size, px, before they come page by page ...
const LEAST_SIZE: f64 = 8.5;
/// ... of as many groups as fit in text of this size, or else one, ...
const PAGE_SIZE: f64 = 9.0;
/// ... with this around them and from line to line, in text sizes.
const PAGE_GAP: f64 = 0.8;
const PAGE_LINE: f64 = 1.35;

/// How the help is laid out in a picture.
#[derive(Debug)]
pub(super) struct Help {
    pub(super) area: Area,
    /// The size of the text, px.
    size: f64,
    /// Groups of keys, page by page; none where all are on one sheet.
    pages: Vec<Vec<&'static Group>>,
}

impl Help {
    /// In a picture of this size, at whose lower edge notes have their place from `low` px on.
    pub(super) fn new(picture: DVec2, low: f64, scale: f64) -> Self {
        let column = width("m", 1.0) * (KEY_CHARACTERS + DOES_CHARACTERS) as f64;
        let lines = HELP.iter().map(|groups| height(*groups)).fold(0.0, f64::max);
        // In units of the text's size; it shrinks where the window is too small for it.
        let needed = DVec2::new(2.0 * column + 3.0 * GAP, (TITLE + lines) * LINE + 1.6 * GAP);
        let wanted = TEXT_SIZE * scale;
        let all = Self::sheet(picture, low, wanted, needed, Vec::new());
        if all.size >= LEAST_SIZE * scale {
            return all;
        }
        let wide = column - width("m", 1.0) + 2.0 * PAGE_GAP;
        let high = |groups: &[&Group]| height(groups.iter().copied()) * PAGE_LINE + 2.0 * PAGE_GAP;
        let mut pages: Vec<Vec<&Group>> = Vec::new();
        for group in HELP.iter().copied().flatten() {
            match pages.last_mut() {
                Some(page) if high(&[&page[..], &[group]].concat()) * PAGE_SIZE * scale <= low => {
                    page.push(group);
                }
                _ => pages.push(vec![group]),
            }
        }
        let highest = pages.iter().map(|page| high(page)).fold(0.0, f64::max);
        Self::sheet(picture, low, wanted, DVec2::new(wide, highest), pages)
    }

    /// A sheet that needs so many text sizes, in the middle of the picture, or of what lies above the notes.
    fn sheet(picture: DVec2, low: f64, wanted: f64, needed: DVec2, pages: Vec<Vec<&'static Group>>) -> Self {
        let size = |room: DVec2| wanted.min((room / needed).min_element());
        let place = |room: DVec2| ((room - needed * size(room)) / 2.0).round();
        let above = DVec2::new(picture.x, low.max(1.0));
        let reaches = (place(picture) + needed * size(picture)).y > low;
        let room = if reaches { above } else { picture };
        Self { area: Area { corner: place(room), extent: needed * size(room) }, size: size(room), pages }
    }

    /// How many pages there are.
    pub(super) fn pages(&self) -> usize {
        self.pages.len().max(1)
    }

    /// Paints this page, or the last one.
    pub(super) fn paint(&self, pixmap: &mut PixmapMut<'_>, page: usize) {
        let Self { area, size, pages } = self;
        area.rounded(0.6 * size).sheet(pixmap, 1.0);
        let Some(last) = pages.len().checked_sub(1) else { return self.paint_all(pixmap) };
        let page = page.min(last);
        let next = if page < last { "more" } else { "close" };
        let hint = format!("{}/{} · H: {next}", page + 1, pages.len());
        let at = area.corner
            + DVec2::new(area.extent.x - PAGE_GAP * size - width(&hint, *size), (PAGE_GAP + 1.0) * size);
        text(pixmap, at, *size, QUIET, &hint);
        let groups = pages.get(page).map_or(&[][..], |groups| groups);
        let start = area.corner + PAGE_GAP * size;
        self.paint_groups(pixmap, groups, start, PAGE_LINE, KEY_CHARACTERS - 1);
    }

    /// Paints all keys in two columns.
    fn paint_all(&self, pixmap: &mut PixmapMut<'_>) {
        let size = self.size;
        let start = self.area.corner + DVec2::new(GAP, 0.8 * GAP) * size;
        let title = concat!("carom ", env!("CARGO_PKG_VERSION"));
        text(pixmap, start + DVec2::new(0.0, size), size, BALL, title);
        let column = width("m", 1.0) * (KEY_CHARACTERS + DOES_CHARACTERS) as f64;
        for (groups, index) in HELP.iter().zip(0..) {
            let across = f64::from(index) * (column + GAP);
            let groups: Vec<_> = groups.iter().collect();
            let start = start + DVec2::new(across, TITLE * LINE) * size;
            self.paint_groups(pixmap, &groups, start, LINE, KEY_CHARACTERS);
        }
    }

    /// Paints groups below each other, `step` text sizes from line to line, what keys do behind so many `characters`.
    fn paint_groups(
        &self,
        pixmap: &mut PixmapMut<'_>,
        groups: &[&Group],
        start: DVec2,
        step: f64,
        characters: usize,
    ) {
        let size = self.size;
        let mut line = 0.0;
        for group in groups {
            let mut row = |key, does, colour: Colour| {
                let at = start + DVec2::new(0.0, line * step + 1.0) * size;
                text(pixmap, at, size, colour, key);
                text(pixmap, at + DVec2::new(width("m", size) * characters as f64, 0.0), size, INK, does);
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

/// The lines that groups take below each other.
fn height<'a>(groups: impl IntoIterator<Item = &'a Group>) -> f64 {
    let lines = groups.into_iter().map(|group| (1 + group.keys.len()) as f64 + APART);
    lines.sum::<f64>() - APART
}

#[cfg(test)]
mod tests {
    use super::super::notes::Measures;
    use super::*;

    #[test]
    fn the_help_fits_its_columns() {
        for (key, does) in HELP.iter().copied().flatten().flat_map(|group| group.keys) {
            assert!(key.chars().count() + 2 <= KEY_CHARACTERS, "{key}");
            assert!(does.chars().count() <= DOES_CHARACTERS, "{does}");
        }
    }

    #[test]
    fn every_key_is_on_one_page_and_can_be_read_there() {
        let keys = HELP.iter().copied().flatten().map(|group| group.keys.len()).sum::<usize>();
        for (width, height, most) in
            [(1280.0, 720.0, 1), (640.0, 480.0, 1), (400.0, 300.0, 2), (320.0, 240.0, 4), (200.0, 150.0, 4)]
        {
            let picture = DVec2::new(width, height);
            let low = Measures::new(picture, 1.0).low();
            let help = Help::new(picture, low, 1.0);
            assert!(help.size >= 7.5, "{width}x{height}: {}", help.size);
            assert!(help.area.is_inside(DVec2::new(width, low)), "{help:?}");
            assert!(help.pages() <= most, "{width}x{height}: {}", help.pages());
            let paged = help.pages.iter().flatten().map(|group| group.keys.len()).sum::<usize>();
            assert!(help.pages.is_empty() || paged == keys);
        }
    }

    #[test]
    fn a_page_of_the_help_fits_its_heading() {
        for group in HELP.iter().copied().flatten() {
            let hint = "4/4 · H: close".chars().count();
            assert!(
                group.name.chars().count() + 1 + hint < KEY_CHARACTERS + DOES_CHARACTERS,
                "{}",
                group.name
            );
        }
    }
}
