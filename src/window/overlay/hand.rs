//! What the pointer is on, and what it is about to do.

use glam::DVec2;
use tiny_skia::PixmapMut;

use crate::paint::strokes::Pen;
use crate::paint::{BALL, Colour, fill_disc};

use super::sheet::{AMBER, INK};

/// The widths of lines and of thin ones, px of the world.
const LINE: f64 = 2.0;
const THIN: f64 = 1.5;
/// How far a ring lies outside of its ball, px.
const APART: f64 = 3.0;
/// The length of the two strokes of an arrow's head, px.
const HEAD: f64 = 10.0;
/// The cosine and the sine of the angle between them and the arrow's line: 30°.
const HEAD_TURN: DVec2 = DVec2::new(0.866, 0.5);

/// What is shown of the hand; lengths and places in px of the world.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::window) enum Hand {
    /// A ball would be added here.
    Aim {
        at: DVec2,
        /// The radius that was asked for, and that for which there is room.
        wished: f64,
        fits: Option<f64>,
    },
    /// A ball will be thrown.
    Throw {
        from: DVec2,
        to: DVec2,
        /// None where there is no room for it.
        radius: Option<f64>,
        /// Where it will fly.
        path: Vec<DVec2>,
    },
    /// The pointer is over this ball.
    Over { centre: DVec2, radius: f64 },
    /// This ball is held.
    Hold { centre: DVec2, radius: f64 },
}

impl Hand {
    pub(super) fn paint(&self, pixmap: &mut PixmapMut<'_>, scale: f64) {
        let pen = |colour, opacity, width| Pen { colour, opacity, width: width * scale };
        match self {
            Self::Aim { at, wished, fits } => {
                let (colour, radius) = fits.map_or((AMBER, *wished), |radius| (INK, radius));
                pen(colour, 0.6, THIN).ring(pixmap, *at * scale, radius * scale);
                if fits.is_none() {
                    cross(pixmap, pen(colour, 0.6, THIN), *at * scale, radius * scale);
                }
            }
            Self::Throw { from, to, radius, path } => {
                fading(pixmap, path, scale);
                if let Some(radius) = radius {
                    fill_disc(pixmap, *from * scale, radius * scale, BALL);
                }
                let colour = if radius.is_some() { INK } else { AMBER };
                arrow(pixmap, pen(colour, 1.0, LINE), *from * scale, *to * scale, HEAD * scale);
            }
            Self::Over { centre, radius } => {
                pen(INK, 0.6, THIN).ring(pixmap, *centre * scale, (radius + APART) * scale);
            }
            Self::Hold { centre, radius } => {
                pen(INK, 1.0, LINE).ring(pixmap, *centre * scale, (radius + APART) * scale);
            }
        }
    }
}

/// A line with a head at its end.
pub(super) fn arrow(pixmap: &mut PixmapMut<'_>, pen: Pen, from: DVec2, to: DVec2, head: f64) {
    pen.line(pixmap, from, to);
    let line = from - to;
    let head = head.min(line.length() / 2.0);
    let Some(back) = line.try_normalize() else { return };
    for turn in [HEAD_TURN, HEAD_TURN * DVec2::new(1.0, -1.0)] {
        pen.line(pixmap, to, to + turn.rotate(back) * head);
    }
}

/// Two lines through a ring.
fn cross(pixmap: &mut PixmapMut<'_>, pen: Pen, centre: DVec2, radius: f64) {
    for direction in [DVec2::ONE, DVec2::new(1.0, -1.0)] {
        let arm = direction * radius * std::f64::consts::FRAC_1_SQRT_2;
        pen.line(pixmap, centre - arm, centre + arm);
    }
}

/// A path that fades towards its end.
fn fading(pixmap: &mut PixmapMut<'_>, path: &[DVec2], scale: f64) {
    const START: f64 = 0.8;
    let colour: Colour = BALL;
    let count = path.len() as f64;
    for (index, ends) in path.windows(2).enumerate() {
        let opacity = START * (1.0 - index as f64 / count);
        let pen = Pen { colour, opacity, width: THIN * scale };
        pen.line(pixmap, ends[0] * scale, ends[1] * scale);
    }
}
