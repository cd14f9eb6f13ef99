//! Drawing a figure, on whatever `plotters` draws on.

use std::fmt::Display;

use plotters::chart::ChartContext;
use plotters::coord::Shift;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::Places;
use super::{Curve, Dot, Entry, FONT, Figure, GREY, Guide, LEGEND, Mark, NUMBERS, Panel, Style};

type Area<DB> = DrawingArea<DB, Shift>;
type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<Places, Places>>;

const WHITE: RGBColor = RGBColor(255, 255, 255);
const INK: RGBColor = RGBColor(30, 30, 30);
const GRID: RGBColor = RGBColor(222, 222, 222);

/// Font sizes, px.
const TITLE: u32 = 19;
const LABEL: u32 = 16;
const NUMBER: u32 = 15;
const NOTE: u32 = 14;
/// The height of a note's line, px.
const NOTE_LINE: u32 = 16;
/// Half the size of the largest mark, px.
const MARK: u32 = 6;
/// The radius of a ring, px.
const RING: u32 = 8;
/// The size of exponents, and how far their middle is above that of what they raise, px.
const EXPONENT: u32 = 11;
const RAISED: u32 = 5;
/// The length of ticks, px.
const TICK: u32 = 4;
/// Where a guide's name may begin, in shares of its line: the first of those where least is in its way.
const NAME_AT: [f64; 16] =
    [0.8, 0.75, 0.85, 0.88, 0.7, 0.91, 0.65, 0.6, 0.55, 0.5, 0.45, 0.4, 0.35, 0.3, 0.25, 0.2];
/// How far a name keeps from what is drawn, px.
const CLEAR: i32 = 3;

/// An error of the plotting library in words.
fn told(error: impl Display) -> String {
    error.to_string()
}

/// Text of a size, px of the figure at scale 1.
fn text(size: u32, scale: u32, colour: RGBColor) -> TextStyle<'static> {
    (FONT, size * scale).into_font().color(&colour)
}

/// Draws all panels and the legend; `scale` enlarges everything.
pub(super) fn figure<DB: DrawingBackend>(area: &Area<DB>, figure: &Figure, scale: u32) -> Result<(), String> {
    area.fill(&WHITE).map_err(told)?;
    let height = area.dim_in_pixel().1;
    let (panels, strip) = area.split_vertically(height - LEGEND * figure.legend_rows() as u32 * scale);
    let rows = figure.panels.len().div_ceil(figure.columns);
    for (area, one) in panels.split_evenly((rows, figure.columns)).iter().zip(&figure.panels) {
        panel(area, one, figure.has_notes(), scale)?;
    }
    legend(&strip, figure, scale)?;
    area.present().map_err(told)
}

/// Draws a panel, with a line for a note where `noted`: in all panels of a figure, so that their frames are in line.
fn panel<DB: DrawingBackend>(area: &Area<DB>, panel: &Panel, noted: bool, scale: u32) -> Result<(), String> {
    let area = area.margin(8 * scale, 8 * scale, 8 * scale, 18 * scale);
    let mut area = area.titled(&panel.title, text(TITLE, scale, INK)).map_err(told)?;
    if noted {
        let (line, below) = area.split_vertically(NOTE_LINE * scale);
        let style = text(NOTE, scale, INK).pos(Pos::new(HPos::Right, VPos::Center));
        let (width, height) = line.dim_in_pixel();
        let at = (width as i32, height as i32 / 2);
        line.draw(&Text::new(panel.note.clone(), at, style)).map_err(told)?;
        area = below;
    }
    let mut builder = ChartBuilder::on(&area);
    builder.x_label_area_size(42 * scale).y_label_area_size(66 * scale);
    let mut chart = builder.build_cartesian_2d(panel.x.places(), panel.y.places()).map_err(told)?;
    chart
        .configure_mesh()
        .bold_line_style(GRID.stroke_width(scale))
        .light_line_style(TRANSPARENT)
        .axis_style(INK.stroke_width(scale))
        .x_labels(panel.x.ticks().len())
        .y_labels(panel.y.ticks().len())
        // Exponents are smaller text, which the library does not know.
        .label_style((FONT, NUMBER).into_font().color(&TRANSPARENT))
        .axis_desc_style(text(LABEL, scale, INK))
        .x_desc(panel.x.label)
        .y_desc(panel.y.label)
        .set_all_tick_mark_size(TICK * scale)
        .draw()
        .map_err(told)?;
    draw_numbers(&chart, panel, &area, scale)?;
    for guide in &panel.guides {
        draw_guide(&mut chart, panel, guide, scale)?;
    }
    for curve in &panel.curves {
        draw_curve(&mut chart, panel, curve, scale)?;
    }
    Ok(())
}

/// The numbers and names at the ticks of both axes.
fn draw_numbers<DB: DrawingBackend>(
    chart: &Chart<'_, DB>,
    panel: &Panel,
    area: &Area<DB>,
    scale: u32,
) -> Result<(), String> {
    let (px, (left, top)) = (scale as i32, area.get_base_pixel());
    let (across, down) = chart.plotting_area().get_pixel_range();
    let apart = 2 * TICK as i32 * px;
    for place in panel.x.ticks() {
        let x = chart.backend_coord(&(place, panel.y.ends().0)).0 - left;
        let y = down.end - top + apart + NUMBER as i32 * px / 2;
        let font = if panel.x.is_named() { FONT } else { NUMBERS };
        draw_number(area, panel.x.number(place), (x, y), true, font, scale)?;
    }
    for place in panel.y.ticks() {
        let y = chart.backend_coord(&(panel.x.ends().0, place)).1 - top;
        let at = (across.start - left - apart, y);
        draw_number(area, panel.y.number(place), at, false, NUMBERS, scale)?;
    }
    Ok(())
}

/// A number with its exponent: its middle in height, and its middle or its right end, are at this place.
fn draw_number<DB: DrawingBackend>(
    area: &Area<DB>,
    (base, exponent): (String, String),
    (x, y): (i32, i32),
    centred: bool,
    font: &'static str,
    scale: u32,
) -> Result<(), String> {
    let style = |size: u32| {
        let style: TextStyle<'static> = (font, size * scale).into_font().color(&INK);
        style.pos(Pos::new(HPos::Left, VPos::Center))
    };
    let (large, small) = (style(NUMBER), style(EXPONENT));
    let width = |text: &str, style: &TextStyle<'_>| {
        area.estimate_text_size(text, style).map(|(width, _)| width as i32).map_err(told)
    };
    let (base_width, exponent_width) = (width(&base, &large)?, width(&exponent, &small)?);
    let whole = base_width + exponent_width;
    let x = if centred { x - whole / 2 } else { x - whole };
    area.draw(&Text::new(base, (x, y), large)).map_err(told)?;
    if exponent.is_empty() {
        return Ok(());
    }
    area.draw(&Text::new(exponent, (x + base_width, y - (RAISED * scale) as i32), small)).map_err(told)
}

/// The ends of a guide's line, cut off at the diagram's edges; none where it does not come through.
fn ends(panel: &Panel, guide: &Guide) -> Option<[(f64, f64); 2]> {
    let ((left, right), (bottom, top)) = (panel.x.ends(), panel.y.ends());
    let (x, y) = (panel.x.place(guide.through.0), panel.y.place(guide.through.1));
    let at_height = |height: f64| x + (height - y) / guide.slope;
    let (one, other) = (at_height(bottom), at_height(top));
    let (from, to) = (left.max(one.min(other)), right.min(one.max(other)));
    let on_line = |x_place: f64| (x_place, y + guide.slope * (x_place - x));
    (from < to).then(|| [on_line(from), on_line(to)])
}

/// A straight line through the diagram, with its name above it, where no other line is if there is such a place.
fn draw_guide<DB: DrawingBackend>(
    chart: &mut Chart<'_, DB>,
    panel: &Panel,
    guide: &Guide,
    scale: u32,
) -> Result<(), String> {
    let Some([from, to]) = ends(panel, guide) else { return Ok(()) };
    chart.draw_series(LineSeries::new([from, to], GREY.stroke_width(scale))).map_err(told)?;
    let style = text(NOTE, scale, GREY).pos(Pos::new(HPos::Left, VPos::Bottom));
    let size = chart.plotting_area().estimate_text_size(&guide.label, &style).map_err(told)?;
    let (width, height, clear) = (size.0 as i32, size.1 as i32, CLEAR * scale as i32);
    let (others, right) =
        (in_the_way(chart, panel, guide, scale), chart.plotting_area().get_pixel_range().0.end);
    let at = |share: f64| (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
    let crossed = |share: &f64| {
        let (x, y) = chart.backend_coord(&at(*share));
        let (across, down) = (x - clear..x + width + clear, y - height - clear..y + clear);
        let is_outside = across.end > right;
        (is_outside, others.iter().filter(|(x, y)| across.contains(x) && down.contains(y)).count())
    };
    let share = NAME_AT.into_iter().min_by_key(crossed).unwrap_or(NAME_AT[0]);
    chart.draw_series([Text::new(guide.label.clone(), at(share), style)]).map_err(told)?;
    Ok(())
}

/// The pixels of all lines in a panel but this guide's own, and the middles and edges of its marks.
fn in_the_way<DB: DrawingBackend>(
    chart: &Chart<'_, DB>,
    panel: &Panel,
    guide: &Guide,
    scale: u32,
) -> Vec<(i32, i32)> {
    let guides = panel.guides.iter().filter(|other| *other != guide).filter_map(|other| ends(panel, other));
    let mut lines: Vec<Vec<(f64, f64)>> = guides.map(|ends| ends.to_vec()).collect();
    let at = |x: f64, y: f64| (panel.x.place(x), panel.y.place(y));
    for dots in panel.curves.iter().map(|curve| &curve.dots) {
        lines.push(dots.iter().filter(|dot| dot.joined).map(|dot| at(dot.x, dot.y)).collect());
        let spread = |dot: &Dot| dot.spread.map(|(least, most)| vec![at(least, dot.y), at(most, dot.y)]);
        lines.extend(dots.iter().filter_map(spread));
    }
    let mut pixels = Vec::new();
    for line in lines {
        let corners: Vec<(i32, i32)> = line.iter().map(|place| chart.backend_coord(place)).collect();
        for pair in corners.windows(2) {
            let ((x, y), (across, down)) = (pair[0], (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1));
            let steps = across.abs().max(down.abs()).max(1);
            pixels.extend((0..steps).map(|step| (x + across * step / steps, y + down * step / steps)));
        }
        pixels.extend(corners.last());
    }
    let half = (MARK * scale) as i32;
    for dot in panel.curves.iter().flat_map(|curve| &curve.dots) {
        let (x, y) = chart.backend_coord(&at(dot.x, dot.y));
        pixels.extend([(x - half, y), (x + half, y), (x, y - half), (x, y + half)]);
    }
    pixels
}

fn draw_curve<DB: DrawingBackend>(
    chart: &mut Chart<'_, DB>,
    panel: &Panel,
    curve: &Curve,
    scale: u32,
) -> Result<(), String> {
    let places: Vec<(f64, f64)> =
        curve.dots.iter().map(|dot| (panel.x.place(dot.x), panel.y.place(dot.y))).collect();
    let joined: Vec<(f64, f64)> =
        places.iter().zip(&curve.dots).filter(|(_, dot)| dot.joined).map(|(&at, _)| at).collect();
    let line = curve.style.colour.stroke_width(2 * scale);
    match curve.style.dash {
        _ if !curve.lined => Ok(()),
        None => chart.draw_series(LineSeries::new(joined, line)).map(drop),
        Some((dash, gap)) => {
            let series = DashedLineSeries::new(joined, dash * scale, gap * scale, line);
            chart.draw_series(series).map(drop)
        }
    }
    .map_err(told)?;
    for (dot, &(_, y)) in curve.dots.iter().zip(&places) {
        if let Some((least, most)) = dot.spread {
            let ends = [(panel.x.place(least), y), (panel.x.place(most), y)];
            chart.draw_series(LineSeries::new(ends, curve.style.colour.stroke_width(scale))).map_err(told)?;
        }
    }
    let marked = places.iter().step_by(curve.marked).copied().collect();
    draw_marks(chart, curve.style.mark, curve.style, marked, scale)?;
    let used = curve.dots.iter().zip(places).filter(|(dot, _)| dot.used).map(|(_, at)| at).collect();
    draw_marks(chart, Mark::Ring, curve.style, used, scale)
}

fn draw_marks<DB: DrawingBackend>(
    chart: &mut Chart<'_, DB>,
    mark: Mark,
    style: Style,
    places: Vec<(f64, f64)>,
    scale: u32,
) -> Result<(), String> {
    let (fill, places) = (style.colour.filled(), places.into_iter());
    match mark {
        Mark::Circle => chart.draw_series(places.map(|at| Circle::new(at, 4 * scale, fill))).map(drop),
        Mark::Triangle => {
            chart.draw_series(places.map(|at| TriangleMarker::new(at, MARK * scale, fill))).map(drop)
        }
        Mark::Square => {
            let square = |at: (f64, f64)| {
                let half = 4 * scale as i32;
                EmptyElement::at(at) + Rectangle::new([(-half, -half), (half, half)], fill)
            };
            chart.draw_series(places.map(square)).map(drop)
        }
        Mark::Ring => {
            let line = style.colour.stroke_width(scale);
            chart.draw_series(places.map(|at| Circle::new(at, RING * scale, line))).map(drop)
        }
        Mark::None => Ok(()),
    }
    .map_err(told)
}

/// The curves' names: in a row in the middle, or in two columns.
fn legend<DB: DrawingBackend>(area: &Area<DB>, figure: &Figure, scale: u32) -> Result<(), String> {
    let entries = figure.legend();
    let px = scale as i32;
    let (row, style) = (LEGEND as i32 * px, text(LABEL, scale, INK));
    let width = |label: &str| {
        let size = area.estimate_text_size(label, &style).map_err(told)?;
        Ok::<i32, String>(size.0 as i32 + 66 * px)
    };
    let whole = area.dim_in_pixel().0 as i32;
    if figure.legend_rows() == 1 {
        let widths = entries.iter().map(|entry| width(entry.label)).collect::<Result<Vec<i32>, String>>()?;
        // Behind the last name there is no gap.
        let mut x = whole / 2 - (widths.iter().sum::<i32>() - 26 * px) / 2;
        for (one, width) in entries.into_iter().zip(widths) {
            entry(area, (x, row / 2), one, scale)?;
            x += width;
        }
        return Ok(());
    }
    for (index, one) in entries.into_iter().enumerate() {
        let (column, line) = (index as i32 % 2, index as i32 / 2);
        entry(area, (66 * px + whole / 2 * column, row * line + row / 2), one, scale)?;
    }
    Ok(())
}

/// A line with a mark, or a mark alone, and its name.
fn entry<DB: DrawingBackend>(
    area: &Area<DB>,
    (x, y): (i32, i32),
    Entry { label, style: Style { colour, mark, dash }, lined }: Entry<'_>,
    scale: u32,
) -> Result<(), String> {
    let px = scale as i32;
    let (line, fill) = (colour.stroke_width(2 * scale), colour.filled());
    let ends = [(x, y), (x + 32 * px, y)];
    match dash {
        _ if !lined => Ok(()),
        None => area.draw(&PathElement::new(ends, line)),
        Some((dash, gap)) => area.draw(&DashedPathElement::new(ends, dash * scale, gap * scale, line)),
    }
    .map_err(told)?;
    let (at, half) = ((x + 16 * px, y), 4 * px);
    match mark {
        Mark::Circle => area.draw(&Circle::new(at, 4 * scale, fill)),
        Mark::Triangle => area.draw(&TriangleMarker::new(at, MARK * scale, fill)),
        Mark::Square => {
            let corners = [(at.0 - half, at.1 - half), (at.0 + half, at.1 + half)];
            area.draw(&Rectangle::new(corners, fill))
        }
        Mark::Ring => area.draw(&Circle::new(at, RING * scale, colour.stroke_width(scale))),
        Mark::None => Ok(()),
    }
    .map_err(told)?;
    let style = text(LABEL, scale, INK).pos(Pos::new(HPos::Left, VPos::Center));
    area.draw(&Text::new(label.to_owned(), (x + 40 * px, y), style)).map_err(told)
}
