//! Figures: panels of curves, as SVG and as PNG.
//!
//! Both are drawn by the same code with `plotters`, in a font that the program carries, so that a figure needs no font
//! of the system and looks the same everywhere. Colours are those of Okabe and Ito, which most colour-blind people tell
//! apart; marks and dashes tell the same in grey.

mod axis;
mod draw;
#[cfg(test)]
mod tests;
mod words;

use std::sync::OnceLock;

pub(super) use axis::Axis;
use plotters::prelude::{BitMapBackend, IntoDrawingArea, RGBColor, SVGBackend};
use plotters::style::{FontStyle, register_font};
use thiserror::Error;
use tiny_skia::{IntSize, Pixmap};
use words::FONTS;

use crate::simulation::Solver;

/// A figure could not be drawn.
#[derive(Debug, Error)]
#[error("the figure {name} could not be drawn: {why}")]
pub struct ChartError {
    name: String,
    why: String,
}

/// The shape that a curve's points are marked with. Marks at one place must all show: each is smaller than those before it, which
/// are drawn first, and the square is hollow, to be told from a circle in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Mark {
    Triangle,
    Square,
    Circle,
    /// A ring of this radius, px, around what is marked.
    Ring(u32),
    None,
}

impl Mark {
    /// The ring around such a mark: one of its own size, so that rings at one place show, too.
    fn ringed(self) -> Self {
        Self::Ring(match self {
            Self::Triangle => 13,
            Self::Square => 10,
            _ => 7,
        })
    }
}

/// How a curve looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Style {
    pub(super) colour: RGBColor,
    pub(super) mark: Mark,
    /// Dashes and gaps, px; none for a line without gaps.
    pub(super) dash: Option<(u32, u32)>,
}

const ORANGE: RGBColor = RGBColor(213, 94, 0);
const BLUE: RGBColor = RGBColor(0, 90, 160);
const GREEN: RGBColor = RGBColor(0, 158, 115);
const BLACK: RGBColor = RGBColor(0, 0, 0);
/// The names of guides, and their lines, which must not look like data.
const GREY: RGBColor = RGBColor(110, 110, 110);
const FAINT: RGBColor = RGBColor(175, 175, 175);

impl Style {
    /// A solver looks the same in every figure.
    pub(super) fn of(solver: Solver) -> Self {
        match solver {
            Solver::Canvas => Self { colour: ORANGE, mark: Mark::Triangle, dash: Some((7, 4)) },
            Solver::Exact => Self { colour: BLUE, mark: Mark::Circle, dash: None },
            Solver::Contact => Self { colour: GREEN, mark: Mark::Square, dash: Some((2, 3)) },
        }
    }

    /// What is no solver: reference runs and limits.
    pub(super) fn plain(dash: Option<(u32, u32)>) -> Self {
        Self { colour: BLACK, mark: Mark::None, dash }
    }
}

/// A point, and how far it may be off to the left and right.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Dot {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) spread: Option<(f64, f64)>,
    /// Whether it is of the setting that a solver is used with: it gets a ring.
    pub(super) used: bool,
    /// Whether its curve's line goes through it: where it is a rung of the ladder that the curve is of.
    pub(super) joined: bool,
}

impl Dot {
    pub(super) fn at(x: f64, y: f64) -> Self {
        Self { x, y, spread: None, used: false, joined: true }
    }
}

/// Points in a line.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Curve {
    pub(super) label: String,
    pub(super) style: Style,
    pub(super) dots: Vec<Dot>,
    /// One in so many of them has a mark.
    pub(super) marked: usize,
    /// Whether a line joins them: not where they have no order.
    pub(super) lined: bool,
}

/// A straight line of this slope through a point, on logarithmic axes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Guide {
    pub(super) label: String,
    pub(super) through: (f64, f64),
    pub(super) slope: f64,
}

/// One diagram.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Panel {
    pub(super) title: String,
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) curves: Vec<Curve>,
    pub(super) guides: Vec<Guide>,
    /// What is to be said of points that are not there.
    pub(super) note: String,
}

impl Panel {
    /// What accuracy costs: a quantity, called `label`, against run time, a curve for each solver.
    pub(super) fn of_solvers(
        title: &str,
        label: &'static str,
        note: String,
        dots: impl Fn(Solver) -> Vec<Dot>,
    ) -> Self {
        let curve = |&solver: &Solver| Curve {
            label: solver.name().to_owned(),
            style: Style::of(solver),
            dots: dots(solver),
            marked: 1,
            lined: true,
        };
        let curves: Vec<Curve> = Solver::ALL.iter().map(curve).collect();
        let all = || curves.iter().flat_map(|curve| &curve.dots);
        Self {
            title: title.to_owned(),
            x: Axis::log("run time, s", all().map(|dot| dot.x)),
            y: Axis::log(label, all().map(|dot| dot.y)),
            guides: Vec::new(),
            note,
            curves,
        }
    }
}

/// What is said of the settings that each solver could not be run with, where there are any.
pub(super) fn given_up(missing: impl Fn(Solver) -> usize) -> String {
    let counts = Solver::ALL.iter().map(|&solver| (solver, missing(solver))).filter(|&(_, count)| count > 0);
    let said: Vec<String> = counts.map(|(solver, count)| format!("{solver}: {count} given up")).collect();
    said.join("; ")
}

/// Panels beside and below each other, with one legend.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Figure {
    /// The name of its files, without their ending.
    pub(super) name: String,
    pub(super) columns: usize,
    pub(super) panels: Vec<Panel>,
}

/// A line of the legend.
struct Entry<'a> {
    label: &'a str,
    style: Style,
    /// Whether its line is drawn, or its mark alone.
    lined: bool,
}

/// The width and the height of a panel, px.
const PANEL: (u32, u32) = (480, 350);
/// The width of a panel that has none beside it, px.
const WIDE: u32 = 800;
/// The height of a row of the legend, px.
const LEGEND: u32 = 30;
/// Pixels of the PNG for each px.
const ENLARGED: u32 = 2;
/// Each of those is drawn as so many times as many, for smooth edges: the plotting library smooths lines, but not circles.
const FINE: u32 = 2;

impl Figure {
    /// The figure's files: name and content.
    ///
    /// # Errors
    /// [`ChartError`] where the plotting library refuses.
    pub(super) fn files(&self) -> Result<Vec<(String, Vec<u8>)>, ChartError> {
        let wrong = |why: String| ChartError { name: self.name.clone(), why };
        carry_font().map_err(wrong)?;
        let svg = self.svg().map_err(wrong)?;
        let png = self.png().map_err(wrong)?;
        Ok(vec![(format!("{}.svg", self.name), svg.into_bytes()), (format!("{}.png", self.name), png)])
    }

    /// Its size, px.
    fn size(&self) -> (u32, u32) {
        let rows = self.panels.len().div_ceil(self.columns) as u32;
        let width = if self.columns == 1 { WIDE } else { PANEL.0 * self.columns as u32 };
        (width, PANEL.1 * rows + LEGEND * self.legend_rows() as u32)
    }

    /// The curves' names, each once, and what a ring means where there is one.
    fn legend(&self) -> Vec<Entry<'_>> {
        let mut entries: Vec<Entry<'_>> = Vec::new();
        let curves = || self.panels.iter().flat_map(|panel| &panel.curves);
        for Curve { label, style, lined, .. } in curves() {
            if entries.iter().all(|entry| entry.label != label) {
                entries.push(Entry { label, style: *style, lined: *lined });
            }
        }
        if curves().flat_map(|curve| &curve.dots).any(|dot| dot.used) {
            let style = Style { mark: Mark::Square.ringed(), ..Style::plain(None) };
            entries.push(Entry { label: "as it is used", style, lined: false });
        }
        entries
    }

    /// Whether anything is said above one of its frames.
    fn has_notes(&self) -> bool {
        self.panels.iter().any(|panel| !panel.note.is_empty())
    }

    /// Rows of the legend: what does not stand in one stands in two columns.
    fn legend_rows(&self) -> usize {
        let entries = self.legend().len();
        if entries > 4 { entries.div_ceil(2) } else { 1 }
    }

    fn svg(&self) -> Result<String, String> {
        let mut text = String::new();
        draw::figure(&SVGBackend::with_string(&mut text, self.size()).into_drawing_area(), self, 1)?;
        Ok(text)
    }

    fn png(&self) -> Result<Vec<u8>, String> {
        let (width, height) = self.size();
        let (width, height) = (width * ENLARGED, height * ENLARGED);
        let mut pixels = vec![0; (3 * width * FINE) as usize * (height * FINE) as usize];
        let area = BitMapBackend::with_buffer(&mut pixels, (width * FINE, height * FINE)).into_drawing_area();
        draw::figure(&area, self, ENLARGED * FINE)?;
        drop(area);
        let opaque = shrunk(&pixels, width as usize);
        let size = IntSize::from_wh(width, height).ok_or("it has no size")?;
        let pixmap = Pixmap::from_vec(opaque, size).ok_or("it has the wrong size")?;
        pixmap.encode_png().map_err(|error| error.to_string())
    }
}

/// The opaque pixels of a picture that is so wide, each the mean of `FINE`·`FINE` of these without opacity.
fn shrunk(fine: &[u8], width: usize) -> Vec<u8> {
    let step = FINE as usize;
    let rows = fine.chunks_exact(3 * step * step * width);
    let pixel = |rows: &[u8], x: usize| {
        let at = |channel: usize| {
            let parts = (0..step * step).map(|part| {
                let (right, down) = (x * step + part % step, part / step);
                u32::from(rows[3 * (down * step * width + right) + channel])
            });
            (parts.sum::<u32>() / (FINE * FINE)) as u8
        };
        [at(0), at(1), at(2), 255]
    };
    rows.flat_map(|rows| (0..width).flat_map(move |x| pixel(rows, x))).collect()
}

/// Tells the plotting library the fonts, once.
fn carry_font() -> Result<(), String> {
    static CARRIED: OnceLock<bool> = OnceLock::new();
    let carry = || FONTS.into_iter().all(|(name, font)| register_font(name, FontStyle::Normal, font).is_ok());
    if *CARRIED.get_or_init(carry) {
        Ok(())
    } else {
        Err("the font that the program carries is broken".to_owned())
    }
}
