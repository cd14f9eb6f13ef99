//! Figures: panels of curves, as SVG and as PNG.
//!
//! Both are drawn by the same code with `plotters`, in a font that the program carries, so that a figure needs no font
//! of the system and looks the same everywhere. Colours are those of Okabe and Ito, which most colour-blind people tell
//! apart; marks and dashes tell the same in grey.

mod axis;
mod draw;

use std::sync::OnceLock;

pub(super) use axis::Axis;
use plotters::prelude::{BitMapBackend, IntoDrawingArea, RGBColor, SVGBackend};
use plotters::style::{FontStyle, register_font};
use thiserror::Error;
use tiny_skia::{IntSize, Pixmap};

use crate::simulation::Solver;

/// A figure could not be drawn.
#[derive(Debug, Error)]
#[error("the figure {name} could not be drawn: {why}")]
pub struct ChartError {
    name: String,
    why: String,
}

/// The shape that a curve's points are marked with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mark {
    Circle,
    Square,
    Triangle,
    Ring,
    None,
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
const GREY: RGBColor = RGBColor(110, 110, 110);

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
const FONT: &str = "sans-serif";
/// The numbers' font: the other has no minus.
const NUMBERS: &str = "monospace";

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
            let style = Style { mark: Mark::Ring, ..Style::plain(None) };
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
        let mut pixels = vec![0; 3 * width as usize * height as usize];
        let area = BitMapBackend::with_buffer(&mut pixels, (width, height)).into_drawing_area();
        draw::figure(&area, self, ENLARGED)?;
        drop(area);
        let opaque = pixels.chunks_exact(3).flat_map(|pixel| [pixel[0], pixel[1], pixel[2], 255]).collect();
        let size = IntSize::from_wh(width, height).ok_or("it has no size")?;
        let pixmap = Pixmap::from_vec(opaque, size).ok_or("it has the wrong size")?;
        pixmap.encode_png().map_err(|error| error.to_string())
    }
}

/// Tells the plotting library the fonts, once.
fn carry_font() -> Result<(), String> {
    static CARRIED: OnceLock<bool> = OnceLock::new();
    let carry = || {
        let fonts =
            [(FONT, epaint_default_fonts::UBUNTU_LIGHT), (NUMBERS, epaint_default_fonts::HACK_REGULAR)];
        fonts.into_iter().all(|(name, font)| register_font(name, FontStyle::Normal, font).is_ok())
    };
    if *CARRIED.get_or_init(carry) {
        Ok(())
    } else {
        Err("the font that the program carries is broken".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure() -> Figure {
        let curve = |solver: Solver, shift: f64| Curve {
            label: solver.name().to_owned(),
            style: Style::of(solver),
            dots: (0..8).map(|k| Dot::at(1e-6 * 2_f64.powi(k), shift * 0.5_f64.powi(k))).collect(),
            marked: 1,
            lined: true,
        };
        let panel = Panel {
            title: "A test".to_owned(),
            x: Axis::log("run time, s", [1e-6, 1e-3]),
            y: Axis::log("error, px", [1e-13, 10.0]),
            curves: vec![curve(Solver::Canvas, 10.0), curve(Solver::Exact, 1e-10)],
            guides: vec![Guide { label: "order 1".to_owned(), through: (1e-6, 10.0), slope: -1.0 }],
            note: "contact: given up".to_owned(),
        };
        Figure { name: "test".to_owned(), columns: 2, panels: vec![panel.clone(), panel] }
    }

    #[test]
    fn the_legend_shows_lines_and_rings_where_there_are_any() {
        let mut figure = figure();
        let lined = |figure: &Figure| figure.legend().iter().map(|entry| entry.lined).collect::<Vec<_>>();
        assert_eq!(lined(&figure), [true, true]);
        figure.panels[0].curves[0].lined = false;
        figure.panels[1].curves[1].dots[2].used = true;
        assert_eq!(lined(&figure), [false, true, false]);
        assert_eq!(figure.legend()[2].style.mark, Mark::Ring);
    }

    #[test]
    fn a_figure_is_an_svg_and_a_png_of_twice_its_size() {
        let files = figure().files().unwrap();
        assert_eq!([&*files[0].0, &*files[1].0], ["test.svg", "test.png"]);
        let svg = String::from_utf8(files[0].1.clone()).unwrap();
        assert!(svg.contains("order 1") && svg.contains("exact") && svg.contains("−12"), "{svg}");
        let png = Pixmap::decode_png(&files[1].1).unwrap();
        assert_eq!((png.width(), png.height()), (1920, 760));
        // The curves are there in their colours.
        let has = |colour: RGBColor| {
            png.pixels()
                .iter()
                .any(|pixel| (pixel.red(), pixel.green(), pixel.blue()) == (colour.0, colour.1, colour.2))
        };
        assert!(has(ORANGE) && has(BLUE) && !has(GREEN));
    }

    #[test]
    fn the_line_of_a_curve_goes_through_the_dots_that_it_joins() {
        let mut figure = figure();
        figure.columns = 1;
        figure.panels.truncate(1);
        figure.panels[0].guides.clear();
        figure.panels[0].curves = vec![Curve {
            style: Style::of(Solver::Exact),
            dots: vec![
                Dot::at(1e-5, 1e-4),
                Dot::at(1e-4, 1e-4),
                Dot { joined: false, ..Dot::at(1e-4, 1e-8) },
            ],
            ..figure.panels[0].curves[1].clone()
        }];
        carry_font().unwrap();
        let svg = figure.svg().unwrap();
        let lines: Vec<&str> =
            svg.split("<polyline").filter(|tag| tag.split('>').next().unwrap().contains("#005AA0")).collect();
        let points = |line: &str| {
            line.split("points=\"").nth(1).unwrap().split('"').next().unwrap().trim().split(' ').count()
        };
        // That of the legend, too.
        assert!(!lines.is_empty() && lines.iter().all(|line| points(line) == 2), "{lines:?}");
        assert_eq!(svg.matches("<circle").count(), 4, "{svg}");
    }

    /// The texts of an SVG: where they begin or end, and what they say.
    fn texts(svg: &str) -> Vec<((f64, f64), String)> {
        let number = |tag: &str, name: &str| {
            tag.split(&format!(" {name}=\"")).nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
        };
        let texts = svg.split("<text").skip(1).map(|text| {
            let (tag, rest) = text.split_once('>').unwrap();
            ((number(tag, "x"), number(tag, "y")), rest.split('<').next().unwrap().trim().to_owned())
        });
        texts.collect()
    }

    #[test]
    fn an_exponent_is_right_behind_its_ten_and_above_it() {
        carry_font().unwrap();
        let texts = texts(&figure().svg().unwrap());
        let behind = |text: &str| {
            let pairs = texts.windows(2).filter(|pair| pair[0].1 == "10" && pair[1].1 == text);
            pairs.map(|pair| (pair[1].0.0 - pair[0].0.0, pair[1].0.1 - pair[0].0.1)).collect::<Vec<_>>()
        };
        for exponent in ["−12", "−6", "0"] {
            let places = behind(exponent);
            assert!(!places.is_empty(), "{exponent}");
            assert!(
                places.iter().all(|&(x, y)| (12.0..18.0).contains(&x) && (-8.0..-3.0).contains(&y)),
                "{places:?}"
            );
        }
    }

    #[test]
    fn no_line_crosses_a_guides_name_where_there_is_a_place_for_it() {
        carry_font().unwrap();
        // A curve that falls steeply, a mark whose spread goes from end to end, and a curve that goes along most of the guide.
        let steep = (0..30).map(|step| 10_f64.powf(-6.0 + f64::from(step) / 10.0));
        let steep = steep.map(|x| vec![Dot::at(x, 10.0), Dot::at(1.02 * x, 1e-13)]);
        let level = (0..28).map(|step| 10_f64.powf(1.0 - f64::from(step) / 2.0));
        let level = level.map(|y| vec![Dot { spread: Some((1e-6, 1e-3)), ..Dot::at(1e-6, y) }]);
        let along = vec![Dot::at(2e-6, 6.5), Dot::at(2.9e-4, 1.3e-5 / 2.9e-4)];
        for dots in steep.chain(level).chain([along]) {
            let mut figure = figure();
            figure.columns = 1;
            figure.panels.truncate(1);
            let panel = &mut figure.panels[0];
            panel.curves.truncate(1);
            panel.curves[0].style = Style::of(Solver::Exact);
            panel.curves[0].dots.clone_from(&dots);
            let svg = figure.svg().unwrap();
            let ((left, below), _) = texts(&svg).into_iter().find(|(_, text)| text == "order 1").unwrap();
            let lines = svg.split("<polyline").filter(|tag| tag.contains("#005AA0"));
            // A name of seven letters, 14 px high.
            let crossed = lines.filter(|line| {
                let points = line.split("points=\"").nth(1).unwrap().split('"').next().unwrap();
                let points: Vec<f64> = points.split([' ', ',']).filter_map(|it| it.parse().ok()).collect();
                (0..=1000).map(|step| f64::from(step) / 1000.0).any(|share| {
                    let at = |index: usize| {
                        points[index] + share * (points[points.len() - 2 + index] - points[index])
                    };
                    (0.0..42.0).contains(&(at(0) - left)) && (0.0..11.0).contains(&(below - at(1)))
                })
            });
            assert_eq!(crossed.count(), 0, "the name at {left}, {below} and the line of {dots:?}");
        }
    }

    #[cfg(feature = "window")]
    #[test]
    fn the_fonts_have_every_character_that_figures_use() {
        use ab_glyph::{Font, FontRef, GlyphId};

        let (text, numbers) = ("0123456789.,:;()/·–×=+²³⁴⁵⁶⁷⁸⁹µabcxyzABCXYZ'%", "0123456789.-−");
        for (font, used) in
            [(epaint_default_fonts::UBUNTU_LIGHT, text), (epaint_default_fonts::HACK_REGULAR, numbers)]
        {
            let font = FontRef::try_from_slice(font).unwrap();
            let missing: String = used.chars().filter(|&it| font.glyph_id(it) == GlyphId(0)).collect();
            assert_eq!(missing, "");
        }
    }
}
