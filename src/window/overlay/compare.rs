//! Balls beside their true places, and how their error grows.

use std::fmt::Write;

use glam::DVec2;
use tiny_skia::PixmapMut;

use crate::paint::Colour;
use crate::paint::strokes::Pen;
use crate::paint::text::{BASELINE, LINE, text, width};
use crate::simulation::Simulation;

use super::TEXT_SIZE;
use super::sheet::{Area, INK, QUIET};

/// The true places: lighter than a ball, and warm where it is cold.
const TRUE: Colour = Colour(0xff, 0xd0, 0x6a);
/// The width of rings and of the lines to them, px of the world.
const RING: f64 = 1.5;
/// A ball that is nearer to its true place than this, px of the picture, has no line to it.
const VISIBLE: f64 = 1.0;
/// Width and height of the plot, px.
const PLOT: DVec2 = DVec2::new(300.0, 190.0);
/// The plot's distance from the picture's edges, px.
const MARGIN: f64 = 10.0;
/// In a picture less than so many times as wide and as high as the plot, the plot shrinks ...
const PLOT_PART: DVec2 = DVec2::new(2.0, 2.2);
/// ... but to no less than this part, at which one can read it, ...
const LEAST_PLOT: f64 = 0.58;
/// ... as long as that hides no more than this part of the picture's width and height. Elsewhere the error is said alone,
const MOST_HIDDEN: f64 = 0.6;
/// in text of this size, px, with room for so many characters.
const VALUE_SIZE: f64 = 9.0;
const VALUE_CHARACTERS: f64 = 17.0;
/// The plot's text, px.
const PLOT_TEXT: f64 = 0.8 * TEXT_SIZE;
/// The decades of the error that are shown at least, px: from rounding to the size of a window.
const DECADES: (i32, i32) = (-12, 3);
/// One in so many decades has a label.
const LABELLED: i32 = 3;
/// The plot begins with this simulated time, s, and doubles it when it is full.
const LEAST_SPAN: f64 = 4.0;

/// Balls, where the exact solver has them, and how far they were from there.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::window) struct Comparison {
    /// A ball's place, its true place, px of the world, and its radius.
    balls: Vec<(DVec2, DVec2, f64)>,
    /// Simulated seconds since the comparison began, and the largest distance, px.
    errors: Vec<(f64, f64)>,
}

impl Comparison {
    /// Of a simulation with what the exact solver makes of the same balls.
    pub(in crate::window) fn new(shown: &Simulation, truth: &Simulation, errors: &[(f64, f64)]) -> Self {
        let pairs = shown.balls().iter().zip(truth.balls()).filter(|(ball, _)| !ball.is_fixed());
        let balls = pairs.map(|(ball, other)| (ball.position(), other.position(), ball.radius())).collect();
        Self { balls, errors: errors.to_vec() }
    }

    /// Paints the true places over the balls.
    pub(super) fn paint_places(&self, pixmap: &mut PixmapMut<'_>, scale: f64) {
        let pen = |opacity| Pen { colour: TRUE, opacity, width: RING * scale };
        for &(place, true_place, radius) in &self.balls {
            pen(0.9).ring(pixmap, true_place * scale, radius * scale);
            if place.distance(true_place) * scale > VISIBLE {
                pen(0.7).line(pixmap, place * scale, true_place * scale);
            }
        }
    }

    /// Paints the plot of the error.
    pub(super) fn paint_plot(&self, pixmap: &mut PixmapMut<'_>, plot: &Plot) {
        let Some(&(now, error)) = self.errors.last() else { return };
        let Plot { area, size, curve } = *plot;
        let Area { corner, extent } = area;
        area.rounded(0.5 * size).sheet(pixmap, 1.0);
        let title_at = corner + DVec2::new(size, 0.6 * size + BASELINE * size);
        text(pixmap, title_at, size, INK, "error");
        let value = in_words(error);
        let right = corner.x + extent.x - size - width(&value, size);
        text(pixmap, DVec2::new(right, title_at.y), size, TRUE, &value);
        if !curve {
            return;
        }

        let label = width("10⁻¹²", size) + 1.3 * size;
        let low = corner + DVec2::new(label, (1.6 + LINE) * size);
        let high = corner + extent - DVec2::new(size, 0.8 * size + LINE * size);
        let axes = Axes { low, high, span: span(now) };
        let scale = size / PLOT_TEXT;
        axes.paint(pixmap, size, scale);
        let pen = Pen { colour: TRUE, opacity: 1.0, width: 1.5 * scale };
        let mut points = self.errors.iter().map(|&(time, error)| axes.place(time, error));
        let Some(mut from) = points.next() else { return };
        for to in points {
            // Points nearer to each other than a pixel are one.
            if from.distance(to) >= 1.0 {
                pen.line(pixmap, from, to);
                from = to;
            }
        }
        pen.line(pixmap, from, axes.place(now, error));
    }
}

/// How large it is where the error is said alone, px.
fn value_extent(scale: f64) -> DVec2 {
    DVec2::new(width("m", 1.0) * VALUE_CHARACTERS + 2.0, LINE + 1.2) * VALUE_SIZE * scale
}

/// Where the plot is, and how much of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plot {
    pub(super) area: Area,
    /// The size of its text, px.
    size: f64,
    /// Whether there is more than what the error is now.
    curve: bool,
}

impl Plot {
    /// The width that is to be left free for the least of it, px.
    pub(super) fn least_width(scale: f64) -> f64 {
        value_extent(scale).x + MARGIN * scale
    }

    /// In the upper right corner of what is left free of a picture of this size, none where that is too small.
    ///
    /// As large as the scale says, but not so large that it hides what it is about.
    pub(super) fn new(picture: DVec2, free: Area, scale: f64) -> Option<Self> {
        let room = |margin: f64| free.extent - 2.0 * margin;
        let wished = scale.min((picture / PLOT_PART / PLOT).min_element());
        let least = LEAST_PLOT * scale;
        let fits = (room(MARGIN * wished) / PLOT).min_element().min(wished);
        let seen_beside = (PLOT * least).cmple(picture * MOST_HIDDEN).all();
        let part = if fits < least && seen_beside { least } else { fits };
        let (size, extent, margin, curve) = if part >= least && (PLOT * part).cmple(room(MARGIN * part)).all()
        {
            (PLOT_TEXT * part, PLOT * part, MARGIN * part, true)
        } else {
            (VALUE_SIZE * scale, value_extent(scale), MARGIN * scale / 2.0, false)
        };
        let corner = free.corner + DVec2::new(free.extent.x - extent.x - margin, margin);
        let fits = extent.cmple(room(margin)).all();
        fits.then_some(Self { area: Area { corner: corner.round(), extent }, size, curve })
    }
}

/// Where times and errors are in the plot.
struct Axes {
    /// Upper left and lower right corner, px.
    low: DVec2,
    high: DVec2,
    /// The time at the right end, s.
    span: f64,
}

impl Axes {
    fn place(&self, time: f64, error: f64) -> DVec2 {
        let (first, last) = (f64::from(DECADES.0), f64::from(DECADES.1));
        // No error is below all decades; one that is no number, above.
        let decade = if error.is_nan() { last } else { error.log10().clamp(first, last) };
        let part = DVec2::new(time / self.span, 1.0 - (decade - first) / (last - first));
        self.low + part * (self.high - self.low)
    }

    fn paint(&self, pixmap: &mut PixmapMut<'_>, size: f64, scale: f64) {
        let line = |opacity| Pen { colour: INK, opacity, width: scale };
        for decade in (DECADES.0..=DECADES.1).step_by(LABELLED as usize) {
            let y = self.place(0.0, 10_f64.powi(decade)).y.round() + 0.5;
            line(0.15).line(pixmap, DVec2::new(self.low.x, y), DVec2::new(self.high.x, y));
            let name = decade_in_words(decade);
            let at = DVec2::new(self.low.x - width(&name, size) - 0.5 * size, y + 0.35 * size);
            text(pixmap, at, size, QUIET, &name);
        }
        line(0.5).line(pixmap, self.low, DVec2::new(self.low.x, self.high.y));
        for (time, align) in [(0.0, 0.0), (self.span, 1.0)] {
            let name = format!("{time} s");
            let x = self.place(time, 1.0).x - align * width(&name, size);
            text(pixmap, DVec2::new(x, self.high.y + 1.2 * size), size, QUIET, &name);
        }
    }
}

/// The time that the plot shows, s: doubled until the present fits.
fn span(now: f64) -> f64 {
    let mut span = LEAST_SPAN;
    while span < now && span < 1e9 {
        span *= 2.0;
    }
    span
}

/// A decade as a power of ten, px.
fn decade_in_words(decade: i32) -> String {
    let mut name = "10".to_owned();
    for digit in decade.to_string().chars() {
        name.push(match digit {
            '-' => '⁻',
            '0' => '⁰',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            digit => char::from_u32('⁰' as u32 + digit as u32 - '0' as u32).unwrap_or(digit),
        });
    }
    name
}

/// An error with two digits, px.
fn in_words(error: f64) -> String {
    if error == 0.0 {
        return "none".to_owned();
    }
    let mut value = String::new();
    // Writing to a string does not fail.
    let _ = if (0.01..10_000.0).contains(&error) {
        let decimals = (1 - error.log10().floor() as i32).max(0) as usize;
        write!(value, "{error:.decimals$} px")
    } else {
        write!(value, "{error:.1e} px")
    };
    value
}

#[cfg(test)]
mod tests {
    use tiny_skia::Pixmap;

    use super::*;

    #[test]
    fn errors_are_said_with_two_digits() {
        for (error, said) in [
            (0.0, "none"),
            (1.234e-13, "1.2e-13 px"),
            (0.0123, "0.012 px"),
            (0.5, "0.50 px"),
            (7.77, "7.8 px"),
            (123.4, "123 px"),
        ] {
            assert_eq!(in_words(error), said);
        }
        assert_eq!((decade_in_words(-12), decade_in_words(3)), ("10⁻¹²".to_owned(), "10³".to_owned()));
    }

    #[test]
    fn the_plot_holds_every_time_and_every_error() {
        for now in [0.0, 3.9, 4.1, 1e4] {
            let axes = Axes { low: DVec2::ZERO, high: DVec2::splat(100.0), span: span(now) };
            for error in [0.0, 1e-300, 1e-12, 1.0, 1e9, f64::INFINITY, f64::NAN] {
                let place = axes.place(now, error);
                assert!(place.cmpge(DVec2::ZERO).all() && place.cmple(DVec2::splat(100.0)).all(), "{place}");
            }
            assert!(axes.place(now, 1e-3).y > axes.place(now, 1e-2).y);
        }
    }

    #[test]
    fn a_line_joins_a_ball_with_its_true_place_only_where_one_can_see_that_they_differ() {
        let between = |apart: f64| {
            let place = DVec2::new(60.0, 50.0);
            let balls = vec![(place, place + DVec2::new(apart, 0.0), 5.0)];
            let mut pixmap = Pixmap::new(200, 100).unwrap();
            Comparison { balls, errors: Vec::new() }.paint_places(&mut pixmap.as_mut(), 1.0);
            pixmap.pixel(80, 50).unwrap().alpha() > 0
        };
        assert!(between(50.0) && !between(0.5));
    }

    #[test]
    fn comparisons_paint_on_any_size() {
        let far = DVec2::splat(1e7);
        let comparison = Comparison {
            balls: vec![(DVec2::ZERO, far, 1e6), (DVec2::ZERO, DVec2::NAN, 5.0)],
            errors: vec![(0.0, 0.0), (1.0, 1e-13), (2.0, f64::INFINITY)],
        };
        for (width, height) in [(1, 1), (40, 3000), (400, 300), (4000, 40)] {
            let mut pixmap = Pixmap::new(width, height).unwrap();
            comparison.paint_places(&mut pixmap.as_mut(), 2.0);
            let picture = DVec2::new(width.into(), height.into());
            for extent in [picture, DVec2::splat(1.0)] {
                let area = Area { corner: DVec2::ZERO, extent };
                for curve in [false, true] {
                    comparison.paint_plot(&mut pixmap.as_mut(), &Plot { area, size: 24.0, curve });
                }
            }
        }
    }

    #[test]
    fn the_plot_shrinks_and_then_says_no_more_than_the_error_and_then_nothing() {
        let plot = |width: f64, height: f64| {
            let picture = DVec2::new(width, height);
            Plot::new(picture, Area { corner: DVec2::ZERO, extent: picture }, 1.0)
        };
        let full = plot(1280.0, 720.0).unwrap();
        assert_eq!((full.area.corner, full.area.extent), (DVec2::new(970.0, 10.0), PLOT));
        for (width, height, curve) in
            [(640.0, 480.0, true), (320.0, 240.0, true), (200.0, 150.0, false), (1280.0, 100.0, false)]
        {
            let plot = plot(width, height).unwrap();
            assert!(plot.curve == curve && plot.size >= LEAST_PLOT * PLOT_TEXT, "{width}x{height}: {plot:?}");
        }
        assert!(plot(100.0, 80.0).is_none() && plot(400.0, 20.0).is_none());
    }
}
