//! Where the cards are.

use glam::DVec2;

use crate::paint::text::{LINE, width};

use super::super::TEXT_SIZE;
use super::super::notes::{self, Measures};

/// The width of a card at most, px.
const WIDEST_CARD: f64 = 190.0;
/// The width of a card's picture by its height.
const ASPECT: f64 = 16.0 / 9.0;
/// Pictures of cards are as low as this part of their height where another row has room then, ...
const LOWER: f64 = 0.55;
/// ... and down to this height, px, where not even one has.
const LEAST_PICTURE: f64 = 40.0;
/// The margin around the cards, px.
const MARGIN: f64 = 24.0;
/// The gap between two cards, px.
const GAP: f64 = 14.0;
/// The margin inside of a card, px.
pub(super) const PADDING: f64 = 8.0;
/// The size of the text on a card, as a part of that on other sheets.
pub(super) const SMALL: f64 = 0.8;
/// Lines of text on a card on what it is about; one more is its name, and one how it is moved.
pub(super) const ABOUT_LINES: usize = 3;

/// Where the cards are, in pixels.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Layout {
    /// The size of the whole picture.
    pub(super) extent: DVec2,
    /// Pixels per px of the world; fewer than asked for where the picture is too small for that.
    pub(super) scale: f64,
    pub(super) columns: usize,
    /// Whole rows that are seen at once; at least one.
    pub(super) rows: usize,
    /// The first card's corner.
    pub(super) start: DVec2,
    /// A card's size.
    pub(super) card: DVec2,
    /// The size of a card's picture; 0 where there is no room for any.
    pub(super) picture: DVec2,
    /// Between two cards.
    pub(super) gap: f64,
    /// The size of the text on cards.
    pub(super) size: f64,
}

impl Layout {
    /// The layout of a picture of this size, with `scale` pixels per px of the world.
    pub(super) fn new(extent: DVec2, scale: f64) -> Self {
        // What does not fit at its size is smaller.
        let measures = Measures::new(extent, scale);
        let margin = MARGIN * measures.margin / notes::MARGIN;
        let room = DVec2::new(extent.x - 2.0 * margin, measures.low() - margin).max(DVec2::ONE);
        let scale = scale.min(room.x / 150.0).min(room.y / 128.0);
        let (gap, size) = (GAP * scale, SMALL * TEXT_SIZE * scale);
        let columns = ((room.x + gap) / (WIDEST_CARD * scale + gap)).floor().max(1.0);
        let across = ((room.x + gap) / columns - gap).min(WIDEST_CARD * 1.15 * scale);
        let written = (2 + ABOUT_LINES) as f64 * LINE * size + 2.0 * PADDING * scale;
        let head = 2.6 * TEXT_SIZE * scale;
        let inside = across - 2.0 * PADDING * scale;
        let mut picture = DVec2::new(inside, inside / ASPECT).round();
        let lower = |rows: f64| ((room.y - head + gap) / rows - gap - written).floor().min(picture.y);
        let rows = ((room.y - head + gap) / (written + picture.y + gap)).floor();
        let another = lower(rows + 1.0);
        picture.y = if another >= LOWER * picture.y { another } else { lower(1.0) };
        if picture.y < LEAST_PICTURE * scale {
            picture = DVec2::ZERO;
        }
        let card = DVec2::new(across, written + picture.y);
        let rows = ((room.y - head + gap) / (card.y + gap)).floor().max(1.0);
        let used = columns * (across + gap) - gap;
        let start = DVec2::new((extent.x - used) / 2.0, margin + head).round();
        Self {
            extent,
            scale,
            columns: columns as usize,
            rows: rows as usize,
            start,
            card,
            picture,
            gap,
            size,
        }
    }

    /// The characters of a line on a card.
    pub(super) fn characters(&self) -> usize {
        ((self.card.x - 2.0 * PADDING * self.scale) / width("m", self.size)).floor() as usize
    }

    /// The corner of the card in this place of those that are seen.
    pub(super) fn corner(&self, place: usize) -> DVec2 {
        let cell = DVec2::new((place % self.columns) as f64, (place / self.columns) as f64);
        (self.start + cell * (self.card + self.gap)).round()
    }
}
