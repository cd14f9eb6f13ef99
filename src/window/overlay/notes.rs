//! What is said over the picture: messages, how far back in time one is, that time stands still, that a recording runs, and
//! where gravity pulls.

use glam::DVec2;
use tiny_skia::PixmapMut;

use crate::paint::strokes::Pen;
use crate::paint::text::{BASELINE, LINE, shorten, text, width, wrap};
use crate::paint::{BALL, Colour, fill_disc};

use super::super::messages::{Message, Tone};
use super::TEXT_SIZE;
use super::hand::arrow;
use super::sheet::{AMBER, Area, INK, Rounded, faded};

/// From the picture's edge to a note, px.
pub(super) const MARGIN: f64 = 16.0;
/// Around a note's text, in text sizes.
const PADDING: DVec2 = DVec2::new(0.9, 0.35);
/// The most characters of a line.
const LONGEST_LINE: usize = 76;
/// The dot that tells of a recording.
const RED: Colour = Colour(0xf0, 0x3c, 0x3c);
/// What the dot takes of a line, in text sizes.
const DOT: f64 = 1.2;
/// The circle in which gravity's arrow stands: its radius, px.
const DIAL: f64 = 36.0;
/// The gravity from which on the arrow grows, px/s² ...
const LEAST_GRAVITY: f64 = 10.0;
/// ... by this part of the dial with each tenfold.
const GRAVITY_STEP: f64 = 0.3;
/// Notes shrink in a picture that is smaller than this, px ...
const ROOMY: DVec2 = DVec2::new(480.0, 360.0);
/// ... but their text to no less than this part, and the rest of them to these.
const LEAST_TEXT: f64 = 2.0 / 3.0;
const LEAST_MARGIN: f64 = 0.25;
const LEAST_DIAL: f64 = 0.5;
/// A message is tried in so many sizes, and then in this part of it with half the margin, before it is shortened.
const SIZES: u32 = 4;
const LAST_TEXT: f64 = 0.5;
/// No line of it has fewer characters than this, and where it is shortened, it has no more lines than that.
const FEWEST: usize = 8;
const MOST_LINES: usize = 8;

/// How large notes are in a picture, px.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measures {
    picture: DVec2,
    /// The size of text, and the least to which it shrinks where a message is long.
    text: f64,
    least: f64,
    /// The size of a message that would be shortened otherwise.
    last: f64,
    pub(super) margin: f64,
    /// The radius of gravity's dial.
    dial: f64,
}

impl Measures {
    pub(super) fn new(picture: DVec2, scale: f64) -> Self {
        let part = ((picture / ROOMY).min_element() / scale).min(1.0);
        let text = TEXT_SIZE * scale;
        Self {
            picture,
            text: text * part.max(LEAST_TEXT),
            least: text * LEAST_TEXT,
            last: text * LAST_TEXT,
            margin: MARGIN * scale * part.max(LEAST_MARGIN),
            dial: DIAL * scale * part.max(LEAST_DIAL),
        }
    }

    fn line(&self) -> f64 {
        (LINE + 2.0 * PADDING.y) * self.text
    }

    /// Where the strip begins at the lower edge that is left to notes of one line, whether there are any or not: what
    /// comes and goes moves nothing.
    pub(super) fn low(&self) -> f64 {
        self.picture.y - 1.5 * self.margin - self.line()
    }
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
#[derive(Debug, Clone)]
pub(super) struct Note {
    lines: Vec<String>,
    /// The size of the text, px.
    size: f64,
    pub(super) area: Area,
}

impl Note {
    /// Lines of text of this size, with something before them that is as wide as `indent` text sizes; not placed yet.
    fn new(lines: Vec<String>, size: f64, indent: f64) -> Self {
        let longest = lines.iter().map(|line| width(line, 1.0)).fold(0.0, f64::max);
        let extent = (DVec2::new(longest + indent, lines.len() as f64 * LINE) + 2.0 * PADDING) * size;
        Self { lines, size, area: Area { corner: DVec2::ZERO, extent } }
    }

    fn at(mut self, corner: DVec2) -> Self {
        self.area.corner = corner.round();
        self
    }

    /// How far back in time one is, in one line; not placed yet.
    pub(super) fn past(text: &str, measures: &Measures) -> Self {
        let Measures { picture, text: mut size, least, margin, .. } = *measures;
        let room = picture.x - 2.0 * margin;
        let longest = |size: f64| ((room / size - 2.0 * PADDING.x) / width("m", 1.0)).max(0.0) as usize;
        if text.chars().count() > longest(size) {
            size = least;
        }
        Self::new(vec![shorten(text, longest(size))], size, 0.0)
    }

    /// The same note in a gap, where it has room there.
    pub(super) fn in_gap(&self, gap: &Gap, measures: &Measures) -> Self {
        self.clone().at(gap.corner(self.area.extent, measures.picture, measures.margin))
    }

    /// The same note in the middle, below `top` px.
    pub(super) fn below(&self, top: f64, measures: &Measures) -> Self {
        let x = (measures.picture.x - self.area.extent.x) / 2.0;
        self.clone().at(DVec2::new(x, top + measures.margin))
    }

    /// That a recording has run for so many seconds, in the lower right corner: always there, however small.
    pub(super) fn recording(seconds: u64, measures: &Measures) -> Self {
        let Measures { picture, margin, .. } = *measures;
        let lines = vec![format!("{}:{:02}", seconds / 60, seconds % 60)];
        let needed = Self::new(lines.clone(), 1.0, DOT).area.extent;
        let size = measures.text.min(((picture - 2.0 * margin).max(DVec2::ONE) / needed).min_element());
        let note = Self::new(lines, size, DOT);
        let corner = picture - margin - note.area.extent;
        note.at(corner)
    }

    /// That time stands still, in the lower right corner, or beside the recording's dot that is there; as small as text is.
    pub(super) fn paused(measures: &Measures, dot: Option<Area>) -> Self {
        let Measures { picture, least, margin, .. } = *measures;
        let note = Self::new(vec!["paused".to_owned()], least, 0.0);
        let right = dot.map_or(picture.x - margin, |dot| dot.corner.x - margin / 2.0);
        let corner = DVec2::new(right, picture.y - margin) - note.area.extent;
        note.at(corner)
    }

    /// A message at the lower edge, clear of what has its place already, of which `corners` are in the lower ones: as
    /// large as it fits, and if it does not, shortened; none where there is no room for a line.
    pub(super) fn message(
        message: &Message,
        measures: &Measures,
        taken: &[Area],
        corners: [Option<Area>; 2],
    ) -> Option<Self> {
        let Measures { picture, text: most, least, last, margin, .. } = *measures;
        let paragraphs: Vec<&str> = message.text.lines().collect();
        let [left, right] = corners;
        let start = left.map_or(0.0, |area| area.end().x);
        let end = right.map_or(picture.x, |area| area.corner.x);
        let place = |size: f64, margin: f64, lines: Option<usize>| {
            let low = picture.y - margin;
            let tops = corners.iter().flatten().map(|area| area.corner.y - margin / 2.0);
            let top = tops.fold(low, f64::min);
            // At the lower edge, above what is in its corners, and between that.
            let places = [(0.0, picture.x, low), (0.0, picture.x, top), (start, end, low)];
            places.into_iter().find_map(|(start, end, bottom)| {
                let room = (end - start - 2.0 * margin) / size - 2.0 * PADDING.x;
                let characters = ((room / width("m", 1.0)).max(0.0) as usize).min(LONGEST_LINE);
                let wrapped = cut(wrap(&paragraphs, characters), lines, characters);
                let note = Self::new(wrapped, size, 0.0);
                let extent = note.area.extent;
                let x = ((picture.x - extent.x) / 2.0).min(end - margin - extent.x).max(start + margin);
                let note = note.at(DVec2::new(x, bottom - extent.y));
                let free =
                    characters >= FEWEST && note.area.is_inside(picture) && extent.y <= picture.y / 2.0;
                (free && !taken.iter().any(|area| area.meets(&note.area))).then_some(note)
            })
        };
        let sizes = (0..SIZES).map(|step| most + (least - most) * f64::from(step) / f64::from(SIZES - 1));
        let lines = (1..=MOST_LINES).rev();
        sizes
            .map(|size| (size, margin, None))
            .chain([(last, margin / 2.0, None)])
            .chain(lines.map(|lines| (least, margin, Some(lines))))
            .find_map(|(size, margin, lines)| place(size, margin, lines))
    }

    /// Paints it, with an edge of this colour and a dot before its text.
    fn paint(
        &self,
        pixmap: &mut PixmapMut<'_>,
        (edge, dot): (Option<Colour>, Option<Colour>),
        opacity: f64,
        scale: f64,
    ) {
        let size = self.size;
        let sheet = self.area.rounded(0.6 * size);
        sheet.sheet(pixmap, opacity);
        if let Some(colour) = edge {
            sheet.edge(pixmap, 1.5 * scale, faded(colour, opacity));
        }
        let start = self.area.corner + PADDING * size;
        if let Some(colour) = dot {
            fill_disc(pixmap, start + DVec2::new(0.4, LINE / 2.0) * size, 0.35 * size, colour);
        }
        let indent = if dot.is_some() { DOT } else { 0.0 };
        for (index, line) in self.lines.iter().enumerate() {
            let at = start + DVec2::new(indent, index as f64 * LINE + BASELINE) * size;
            text(pixmap, at, size, faded(INK, opacity), line);
        }
    }

    pub(super) fn paint_message(&self, pixmap: &mut PixmapMut<'_>, message: &Message, scale: f64) {
        let edge = (message.tone == Tone::Wrong).then_some(AMBER);
        self.paint(pixmap, (edge, None), message.opacity, scale);
    }

    pub(super) fn paint_past(&self, pixmap: &mut PixmapMut<'_>, scale: f64) {
        self.paint(pixmap, (Some(BALL), None), 1.0, scale);
    }

    pub(super) fn paint_paused(&self, pixmap: &mut PixmapMut<'_>, scale: f64) {
        self.paint(pixmap, (None, None), 1.0, scale);
    }

    pub(super) fn paint_recording(&self, pixmap: &mut PixmapMut<'_>, scale: f64) {
        self.paint(pixmap, (None, Some(RED)), 1.0, scale);
    }
}

/// No more of these lines than that, if any; the last of them tells that there were more.
fn cut(mut lines: Vec<String>, most: Option<usize>, characters: usize) -> Vec<String> {
    if let Some(most) = most.filter(|&most| most < lines.len()) {
        lines.truncate(most);
        if let Some(last) = lines.last_mut() {
            *last = shorten(&format!("{last} …"), characters);
        }
    }
    lines
}

/// Where gravity's dial is: in the lower left corner, and no higher than a line where it would come into the way of what
/// has its place already; nowhere where it is in the way all the same.
pub(super) fn dial(measures: &Measures, taken: &[Area]) -> Option<Area> {
    let Measures { picture, margin, .. } = *measures;
    [measures.dial, measures.line() / 2.0].into_iter().find_map(|radius| {
        let corner = DVec2::new(margin, picture.y - margin - 2.0 * radius);
        let area = Area { corner, extent: DVec2::splat(2.0 * radius) };
        (area.is_inside(picture) && !taken.iter().any(|other| other.meets(&area))).then_some(area)
    })
}

/// Paints there an arrow that points where gravity, px/s², pulls; it grows with its logarithm.
pub(super) fn gravity(pixmap: &mut PixmapMut<'_>, area: Area, gravity: DVec2, scale: f64) {
    let Area { corner, extent } = area;
    let radius = extent.x / 2.0;
    let centre = corner + radius;
    Rounded { corner, extent, radius }.sheet(pixmap, 1.0);
    let strength = gravity.length();
    // As fine as the dial is small.
    let fine = scale * (radius / (DIAL * scale)).max(0.5);
    let Some(direction) = gravity.try_normalize() else {
        return fill_disc(pixmap, centre, 3.0 * fine, INK);
    };
    let length = (0.2 + GRAVITY_STEP * (strength / LEAST_GRAVITY).log10()).clamp(0.2, 0.85);
    let pen = Pen { colour: INK, opacity: 1.0, width: 2.5 * fine };
    let half = direction * length * radius;
    arrow(pixmap, pen, centre - half, centre + half, 9.0 * fine);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where a message stands in a picture of this width, and what takes its corners.
    fn message_in(corners: bool, width: f64) -> (Area, Vec<Area>) {
        let measures = Measures::new(DVec2::new(width, 300.0), 1.0);
        let text = "a message that is longer than any narrow window is wide".to_owned();
        let said = Message { text, tone: Tone::Said, opacity: 1.0 };
        let taken = corners.then(|| [dial(&measures, &[]).unwrap(), Note::recording(75, &measures).area]);
        let taken: Vec<_> = taken.into_iter().flatten().collect();
        let corners = [taken.first().copied(), taken.last().copied()];
        (Note::message(&said, &measures, &taken, corners).unwrap().area, taken)
    }

    #[test]
    fn a_message_keeps_out_of_the_corners_where_they_are_taken() {
        let (low, _) = message_in(false, 400.0);
        let (high, taken) = message_in(true, 400.0);
        assert!(taken.iter().any(|area| area.meets(&low)), "it is in the way");
        for width in [400.0, 1280.0] {
            let (area, taken) = message_in(true, width);
            assert!(taken.iter().all(|corner| !corner.meets(&area)), "{width}");
        }
        assert!(high.end().y < low.end().y, "above them");
        assert_eq!(message_in(true, 1280.0).0, message_in(false, 1280.0).0, "between them there is room");
    }

    #[test]
    fn a_message_that_has_no_room_is_shortened_and_says_so() {
        let measures = Measures::new(DVec2::new(200.0, 150.0), 1.0);
        let text = "a message of many words ".repeat(20);
        let said = Message { text, tone: Tone::Wrong, opacity: 1.0 };
        let above = Area { corner: DVec2::ZERO, extent: DVec2::new(200.0, measures.low()) };
        let note = Note::message(&said, &measures, &[above], [None; 2]).unwrap();
        assert_eq!(note.lines, ["a message of many words a …"]);
        let all = Area { corner: DVec2::ZERO, extent: DVec2::new(200.0, 150.0) };
        assert!(Note::message(&said, &measures, &[all], [None; 2]).is_none());
    }

    #[test]
    fn a_message_below_a_sheet_takes_a_second_line_rather_than_be_shortened() {
        let text =
            "no recording saved: cannot create carom-gravity-1.gif: no space left on the device".to_owned();
        let said = Message { text: text.clone(), tone: Tone::Wrong, opacity: 1.0 };
        for (width, height) in [(300.0, 200.0), (320.0, 240.0), (400.0, 300.0)] {
            let picture = DVec2::new(width, height);
            let measures = Measures::new(picture, 1.0);
            let above = Area { corner: DVec2::ZERO, extent: DVec2::new(width, measures.low()) };
            let note = Note::message(&said, &measures, &[above], [None; 2]).unwrap();
            assert_eq!(note.lines.join(" "), text, "{width}x{height}");
            assert!(note.size >= 7.5 && note.area.is_inside(picture) && !note.area.meets(&above));
        }
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
