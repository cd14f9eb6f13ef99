//! What is said over the picture: messages, how far back in time one is, that a recording runs, and where gravity
//! pulls.

use glam::DVec2;
use tiny_skia::PixmapMut;

use crate::paint::strokes::Pen;
use crate::paint::text::{BASELINE, LINE, text, width, wrap};
use crate::paint::{BALL, Colour, fill_disc};

use super::super::messages::{Message, Tone};
use super::TEXT_SIZE;
use super::hand::arrow;
use super::sheet::{AMBER, INK, Rounded, extent, faded};

/// From the picture's edge to a note, px.
const MARGIN: f64 = 16.0;
/// Around a note's text, in text sizes.
const PADDING: DVec2 = DVec2::new(0.9, 0.35);
/// The most characters of a line.
const LONGEST_LINE: usize = 76;
/// The dot that tells of a recording.
const RED: Colour = Colour(0xf0, 0x3c, 0x3c);
/// The circle in which gravity's arrow stands: its radius, px.
const DIAL: f64 = 36.0;
/// What the dial, and a recording's dot with its time, take of a lower corner, px.
const CORNER: DVec2 = DVec2::new(132.0, MARGIN + 2.0 * DIAL);
/// The gravity from which on the arrow grows, px/s² ...
const LEAST_GRAVITY: f64 = 10.0;
/// ... by this part of the dial with each tenfold.
const GRAVITY_STEP: f64 = 0.3;

/// Where on the picture a note stands.
enum Place {
    /// In the middle of the lower edge; above its corners where they are taken and it would reach into them.
    Below {
        corners: bool,
    },
    BelowRight,
    Above(Gap),
}

/// The room at the upper edge of a picture that other things leave, px.
pub(super) struct Gap {
    pub(super) top: f64,
    /// Between these ...
    pub(super) left: f64,
    pub(super) right: f64,
    /// ... and from here on to the picture's right edge.
    pub(super) bottom: f64,
}

impl Gap {
    /// The corner of what is so large in such a picture: in its middle as far as there is room.
    fn corner(&self, extent: DVec2, picture: DVec2, margin: f64) -> DVec2 {
        let fits = extent.x + 2.0 * margin <= self.right - self.left;
        let (right, top) = if fits { (self.right, self.top) } else { (picture.x, self.bottom) };
        let last = right - margin - extent.x;
        let x = ((picture.x - extent.x) / 2.0).max(self.left + margin).min(last);
        DVec2::new(x, top + margin)
    }
}

/// Lines on a sheet.
struct Note<'a> {
    lines: &'a [String],
    opacity: f64,
    edge: Option<Colour>,
    /// A dot before the text.
    dot: Option<Colour>,
}

impl Note<'_> {
    fn paint(&self, pixmap: &mut PixmapMut<'_>, place: &Place, scale: f64) {
        let picture = extent(pixmap);
        let longest = self.lines.iter().map(|line| width(line, 1.0)).fold(0.0, f64::max);
        let indent = if self.dot.is_some() { 1.2 } else { 0.0 };
        // In units of the text's size, which shrinks where the picture is too small for it.
        let needed = DVec2::new(longest + indent, self.lines.len() as f64 * LINE) + 2.0 * PADDING;
        let room = (picture - 2.0 * MARGIN * scale).max(DVec2::ONE) * DVec2::new(1.0, 0.5);
        let size = (TEXT_SIZE * scale).min((room / needed).min_element());
        let extent = needed * size;
        let margin = MARGIN * scale;
        let corner = match place {
            Place::Below { corners } => {
                let meets = *corners && extent.x > picture.x - 2.0 * CORNER.x * scale;
                let above = if meets { CORNER.y * scale } else { 0.0 };
                DVec2::new((picture.x - extent.x) / 2.0, picture.y - above - margin - extent.y)
            }
            Place::Above(gap) => gap.corner(extent, picture, margin),
            Place::BelowRight => picture - margin - extent,
        }
        .round();
        let sheet = Rounded { corner, extent, radius: 0.6 * size };
        sheet.sheet(pixmap, self.opacity);
        if let Some(colour) = self.edge {
            sheet.edge(pixmap, 1.5 * scale, faded(colour, self.opacity));
        }
        let start = corner + PADDING * size;
        if let Some(colour) = self.dot {
            fill_disc(pixmap, start + DVec2::new(0.4, LINE / 2.0) * size, 0.35 * size, colour);
        }
        for (index, line) in self.lines.iter().enumerate() {
            let at = start + DVec2::new(indent, index as f64 * LINE + BASELINE) * size;
            text(pixmap, at, size, faded(INK, self.opacity), line);
        }
    }
}

/// Paints a message at the lower edge, whose corners may be taken by the dial or a recording's dot.
pub(super) fn message(pixmap: &mut PixmapMut<'_>, message: &Message, corners: bool, scale: f64) {
    let room = (extent(pixmap).x - 2.0 * MARGIN * scale) / width("m", TEXT_SIZE * scale);
    let most = (room - 2.0 * PADDING.x).clamp(12.0, LONGEST_LINE as f64) as usize;
    let paragraphs: Vec<&str> = message.text.lines().collect();
    let edge = (message.tone == Tone::Wrong).then_some(AMBER);
    let lines = wrap(&paragraphs, most);
    let note = Note { lines: &lines, opacity: message.opacity, edge, dot: None };
    note.paint(pixmap, &Place::Below { corners }, scale);
}

/// Paints, at the upper edge where there is a gap, how far back in time one is.
pub(super) fn past(pixmap: &mut PixmapMut<'_>, text: &str, gap: Gap, scale: f64) {
    let note = Note { lines: &[text.to_owned()], opacity: 1.0, edge: Some(BALL), dot: None };
    note.paint(pixmap, &Place::Above(gap), scale);
}

/// Paints, in the lower right corner, that a recording has run for so many seconds.
pub(super) fn recording(pixmap: &mut PixmapMut<'_>, seconds: u64, scale: f64) {
    let time = format!("{}:{:02}", seconds / 60, seconds % 60);
    let note = Note { lines: &[time], opacity: 1.0, edge: None, dot: Some(RED) };
    note.paint(pixmap, &Place::BelowRight, scale);
}

/// Paints, in the lower left corner, an arrow that points where gravity, px/s², pulls; it grows with its logarithm.
pub(super) fn gravity(pixmap: &mut PixmapMut<'_>, gravity: DVec2, scale: f64) {
    let radius = DIAL * scale;
    let margin = MARGIN * scale + radius;
    let centre = DVec2::new(margin, extent(pixmap).y - margin);
    let corner = centre - radius;
    Rounded { corner, extent: DVec2::splat(2.0 * radius), radius }.sheet(pixmap, 1.0);
    let strength = gravity.length();
    let Some(direction) = gravity.try_normalize() else {
        return fill_disc(pixmap, centre, 3.0 * scale, INK);
    };
    let length = (0.2 + GRAVITY_STEP * (strength / LEAST_GRAVITY).log10()).clamp(0.2, 0.85);
    let pen = Pen { colour: INK, opacity: 1.0, width: 2.5 * scale };
    let half = direction * length * radius;
    arrow(pixmap, pen, centre - half, centre + half, 9.0 * scale);
}

#[cfg(test)]
mod tests {
    use tiny_skia::Pixmap;

    use super::*;

    /// The rows of the lower left corner, from below, on which a message of this picture's width leaves something.
    fn rows_in_the_corner(corners: bool, width: u32) -> usize {
        let mut pixmap = Pixmap::new(width, 300).unwrap();
        let text = "a message that is longer than any narrow window is wide".to_owned();
        let said = Message { text, tone: Tone::Said, opacity: 1.0 };
        message(&mut pixmap.as_mut(), &said, corners, 1.0);
        let taken = |y: u32| (0..CORNER.x as u32).any(|x| pixmap.pixel(x, y).unwrap().alpha() > 0);
        (300 - CORNER.y as u32..300).filter(|&y| taken(y)).count()
    }

    #[test]
    fn a_message_keeps_out_of_the_corners_where_they_are_taken() {
        assert!(rows_in_the_corner(false, 400) > 0, "it is in the way");
        assert_eq!(rows_in_the_corner(true, 400), 0);
        assert_eq!(rows_in_the_corner(true, 1280), 0);
    }

    const PICTURE: DVec2 = DVec2::new(800.0, 600.0);
    const EXTENT: DVec2 = DVec2::new(240.0, 30.0);

    #[test]
    fn a_note_stands_in_the_middle_or_in_a_gap_or_below_what_leaves_none() {
        for (left, right, x, y) in [
            (0.0, 800.0, 280.0, 10.0),
            (300.0, 800.0, 310.0, 10.0),
            (0.0, 500.0, 250.0, 10.0),
            (300.0, 560.0, 310.0, 10.0),
            (300.0, 559.0, 310.0, 210.0),
            // Over what is there rather than out of the picture.
            (600.0, 800.0, 550.0, 210.0),
        ] {
            let gap = Gap { top: 0.0, left, right, bottom: 200.0 };
            assert_eq!(gap.corner(EXTENT, PICTURE, 10.0), DVec2::new(x, y), "{left} to {right}");
        }
    }
}
