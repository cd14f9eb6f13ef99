//! What is painted over the simulation: sheets, figures, and what hands are about to do.

mod behind;
mod browser;
mod compare;
mod edge;
mod figures;
mod hand;
mod help;
mod notes;
mod sheet;

use glam::DVec2;
use tiny_skia::PixmapMut;

use crate::simulation::Solver;

use super::messages::Message;
pub(super) use browser::{Browser, Direction, Page};
pub(super) use compare::Comparison;
pub(super) use figures::{Frame, Gauge, Panel, Room};
pub(super) use hand::Hand;
use notes::Gap;

/// Size of the text on sheets, px.
const TEXT_SIZE: f64 = 15.0;

/// What is painted over the balls in a frame. Two that are equal look the same.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Overlay {
    /// The size of the world, px, where its walls are inside of the picture.
    pub(super) edge: Option<DVec2>,
    /// The balls' true places.
    pub(super) comparison: Option<Comparison>,
    /// What the pointer is on, or about to do.
    pub(super) hand: Option<Hand>,
    /// Where gravity pulls, px/s².
    pub(super) gravity: Option<DVec2>,
    /// The figures of the simulation.
    pub(super) figures: Option<Panel>,
    /// How far back in time one is.
    pub(super) past: Option<String>,
    pub(super) sheet: Option<Sheet>,
    /// The list of all scenes, which covers the balls.
    pub(super) page: Option<Page>,
    /// How long a recording has run, s.
    pub(super) recording: Option<u64>,
    pub(super) message: Option<Message>,
    /// Whether something stands in the lower corners that the message is to keep out of.
    pub(super) corners: bool,
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

    /// What of it belongs into a picture that is saved or recorded, and what is for who sits before the window.
    pub(super) fn parts(&self) -> (Self, Self) {
        let told = Self {
            hand: self.hand.clone(),
            recording: self.recording,
            message: self.message.clone(),
            // Also where that is in the other part.
            corners: self.corners,
            ..Self::default()
        };
        (Self { hand: None, recording: None, message: None, ..self.clone() }, told)
    }

    /// What the figures and the plot leave free at the upper edge, `top` pixels below it.
    fn gap(&self, pixmap: &PixmapMut<'_>, top: f64, scale: f64) -> Gap {
        let picture = sheet::extent(pixmap);
        let mut gap = Gap { top, left: 0.0, right: picture.x, bottom: top };
        if self.sheet != Some(Sheet::Help) {
            if let Some(figures) = &self.figures {
                gap.left = figures.right(scale);
            }
            if self.comparison.is_some() {
                DVec2 { x: gap.right, y: gap.bottom } = Comparison::lower_left(picture, top, scale);
            }
        }
        gap
    }

    /// Paints all of it on a picture with `scale` pixels per px of the world.
    pub(super) fn paint(&self, pixmap: &mut PixmapMut<'_>, scale: f64) {
        if let Some(size) = self.edge {
            edge::edge(pixmap, size, scale);
        }
        if let Some(comparison) = &self.comparison {
            comparison.paint_places(pixmap, scale);
        }
        if let Some(hand) = &self.hand {
            hand.paint(pixmap, scale);
        }
        // What stands at the upper edge makes way for the warning.
        let top = match self.sheet {
            Some(Sheet::Behind(solver)) => behind::behind(pixmap, solver, scale),
            _ => 0.0,
        };
        if let Some(gravity) = self.gravity {
            notes::gravity(pixmap, gravity, scale);
        }
        // The help stands where these would look out from behind it.
        if self.sheet != Some(Sheet::Help) {
            if let Some(comparison) = &self.comparison {
                comparison.paint_plot(pixmap, top, scale);
            }
            if let Some(figures) = &self.figures {
                figures.paint(pixmap, top, scale);
            }
        }
        if let Some(past) = &self.past {
            notes::past(pixmap, past, self.gap(pixmap, top, scale), scale);
        }
        if let Some(page) = &self.page {
            page.paint(pixmap);
        }
        if let Some(seconds) = self.recording {
            notes::recording(pixmap, seconds, scale);
        }
        if self.sheet == Some(Sheet::Help) {
            help::help(pixmap, scale);
        }
        if let Some(message) = &self.message {
            notes::message(pixmap, message, self.corners, scale);
        }
    }
}

#[cfg(test)]
mod tests {
    use tiny_skia::Pixmap;

    use super::super::messages::Tone;
    use super::*;

    #[test]
    fn overlays_paint_on_any_size() {
        let far = DVec2::splat(1e6);
        let hands = [
            Hand::Aim { at: DVec2::ZERO, wished: 20.0, fits: None },
            Hand::Aim { at: far, wished: 20.0, fits: Some(3.0) },
            Hand::Throw { from: DVec2::ZERO, to: far, radius: Some(20.0), path: vec![DVec2::ZERO, far] },
            Hand::Throw { from: DVec2::ZERO, to: DVec2::ZERO, radius: None, path: Vec::new() },
            Hand::Over { centre: DVec2::ZERO, radius: 1e6 },
            Hand::Hold { centre: far, radius: 1.0 },
        ];
        let text = "a long message that has to be broken into lines ".repeat(9);
        for (width, height) in [(1, 1), (40, 3000), (1280, 720), (4000, 40)] {
            for (hand, sheet) in hands.iter().zip([Sheet::Help, Sheet::Behind(Solver::Exact)].iter().cycle())
            {
                let mut pixmap = Pixmap::new(width, height).unwrap();
                let overlay = Overlay {
                    hand: Some(hand.clone()),
                    gravity: Some(DVec2::new(0.0, 980.0)),
                    past: Some("3.2 s ago".to_owned()),
                    sheet: Some(*sheet),
                    recording: Some(75),
                    message: Some(Message { text: text.clone(), tone: Tone::Wrong, opacity: 0.5 }),
                    ..Overlay::default()
                };
                overlay.paint(&mut pixmap.as_mut(), 2.0);
            }
        }
    }
}
