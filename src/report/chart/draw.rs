//! Drawing a figure, on whatever `plotters` draws on.

use std::fmt::Display;

use plotters::chart::ChartContext;
use plotters::coord::Shift;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axis::Places;
use super::words::{FONT, NUMBERS, Paper, Words};
use super::{Curve, Dot, Entry, FAINT, Figure, GREY, Guide, LEGEND, Mark, Panel, Style};

pub(super) type Area<DB> = DrawingArea<DB, Shift>;
type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<Places, Places>>;

const WHITE: RGBColor = RGBColor(255, 255, 255);
const INK: RGBColor = RGBColor(30, 30, 30);
const GRID: RGBColor = RGBColor(222, 222, 222);

/// Font sizes, px.
const TITLE: u32 = 19;
const LABEL: u32 = 16;
const NUMBER: u32 = 15;
const NOTE: u32 = 14;
/// The height of the title's line, px.
const TITLE_LINE: u32 = 26;
/// The room beside and below a frame for its numbers and labels, px.
const BESIDE: u32 = 66;
const BELOW: u32 = 42;
/// The height of a note's line, px.
const NOTE_LINE: u32 = 16;
/// Half the size of the largest mark, px.
const MARK: u32 = 7;
/// Half the edge of a square, px: there is room in it for a circle.
const SQUARE: u32 = 5;
/// The radius of a circle, px.
const CIRCLE: u32 = 3;
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
pub(super) fn told(error: impl Display) -> String {
    error.to_string()
}

/// Text of a size, px of the figure at scale 1, in ink, its middle at the place that it is drawn at.
fn text(text: &str, size: u32, scale: u32) -> Words<'_> {
    Words {
        text,
        font: FONT,
        size: size * scale,
        colour: INK,
        along: HPos::Center,
        across: VPos::Center,
        upright: false,
    }
}

/// Draws all panels and the legend; `scale` enlarges everything.
pub(super) fn figure<DB: Paper>(area: &Area<DB>, figure: &Figure, scale: u32) -> Result<(), String> {
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
fn panel<DB: Paper>(area: &Area<DB>, panel: &Panel, noted: bool, scale: u32) -> Result<(), String> {
    let area = area.margin(8 * scale, 8 * scale, 8 * scale, 18 * scale);
    let width = area.dim_in_pixel().0 as i32;
    let (line, mut area) = area.split_vertically(TITLE_LINE * scale);
    // Over the middle of the frame.
    let middle = i32::midpoint(width, (BESIDE * scale) as i32);
    text(&panel.title, TITLE, scale).draw(&line, (middle, (TITLE_LINE * scale) as i32 / 2))?;
    if noted {
        let (line, below) = area.split_vertically(NOTE_LINE * scale);
        let note = Words { along: HPos::Right, ..text(&panel.note, NOTE, scale) };
        note.draw(&line, (width, (NOTE_LINE * scale) as i32 / 2))?;
        area = below;
    }
    let mut builder = ChartBuilder::on(&area);
    builder.x_label_area_size(BELOW * scale).y_label_area_size(BESIDE * scale);
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
        .set_all_tick_mark_size(TICK * scale)
        .draw()
        .map_err(told)?;
    draw_numbers(&chart, panel, &area, scale)?;
    let (half, height) = ((LABEL * scale) as i32 / 2, area.dim_in_pixel().1 as i32);
    text(panel.x.label, LABEL, scale).draw(&area, (middle, height - half))?;
    let label = Words { upright: true, ..text(panel.y.label, LABEL, scale) };
    label.draw(&area, (half, (height - (BELOW * scale) as i32) / 2))?;
    for guide in &panel.guides {
        draw_guide(&mut chart, panel, guide, scale)?;
    }
    draw_curves(&mut chart, panel, scale)
}

/// The numbers and names at the ticks of both axes.
fn draw_numbers<DB: Paper>(
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
fn draw_number<DB: Paper>(
    area: &Area<DB>,
    (base, exponent): (String, String),
    (x, y): (i32, i32),
    centred: bool,
    font: &'static str,
    scale: u32,
) -> Result<(), String> {
    let words = |said, size| Words { font, along: HPos::Left, ..text(said, size, scale) };
    let (base, exponent) = (words(&base, NUMBER), words(&exponent, EXPONENT));
    let whole = base.width() + exponent.width();
    let x = if centred { x - whole / 2 } else { x - whole };
    base.draw(area, (x, y))?;
    if exponent.text.is_empty() {
        return Ok(());
    }
    exponent.draw(area, (x + base.width(), y - (RAISED * scale) as i32))
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
fn draw_guide<DB: Paper>(
    chart: &mut Chart<'_, DB>,
    panel: &Panel,
    guide: &Guide,
    scale: u32,
) -> Result<(), String> {
    let Some([from, to]) = ends(panel, guide) else { return Ok(()) };
    chart.draw_series(LineSeries::new([from, to], FAINT.stroke_width(scale))).map_err(told)?;
    let name = text(&guide.label, NOTE, scale);
    let name = Words { colour: GREY, along: HPos::Left, across: VPos::Bottom, ..name };
    let (width, height, clear) = (name.width(), name.height(), CLEAR * scale as i32);
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
    let area = chart.plotting_area().strip_coord_spec();
    let ((x, y), (left, top)) = (chart.backend_coord(&at(share)), area.get_base_pixel());
    name.draw(&area, (x - left, y - top))
}

/// The pixels of all lines in a panel but this guide's own, and the middles and edges of its marks.
fn in_the_way<DB: Paper>(chart: &Chart<'_, DB>, panel: &Panel, guide: &Guide, scale: u32) -> Vec<(i32, i32)> {
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

/// All curves, so that what lies on another leaves it in sight: dashed lines over whole ones, which their gaps show, and small
/// marks over large ones.
fn draw_curves<DB: Paper>(chart: &mut Chart<'_, DB>, panel: &Panel, scale: u32) -> Result<(), String> {
    let mut curves: Vec<&Curve> = panel.curves.iter().collect();
    curves.sort_by_key(|curve| curve.style.dash.is_some());
    for curve in &curves {
        draw_lines(chart, panel, curve, scale)?;
    }
    curves.sort_by_key(|curve| curve.style.mark);
    for Curve { style, dots, marked, .. } in curves {
        let place = |dot: &Dot| (panel.x.place(dot.x), panel.y.place(dot.y));
        draw_marks(chart, style.mark, *style, dots.iter().step_by(*marked).map(place), scale)?;
        let used = dots.iter().filter(|dot| dot.used).map(place);
        draw_marks(chart, style.mark.ringed(), *style, used, scale)?;
    }
    Ok(())
}

/// The line of a curve, and those that say how far its dots may be off.
fn draw_lines<DB: Paper>(
    chart: &mut Chart<'_, DB>,
    panel: &Panel,
    curve: &Curve,
    scale: u32,
) -> Result<(), String> {
    let joined = curve.dots.iter().filter(|dot| dot.joined);
    let joined: Vec<(f64, f64)> = joined.map(|dot| (panel.x.place(dot.x), panel.y.place(dot.y))).collect();
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
    for dot in &curve.dots {
        if let Some((least, most)) = dot.spread {
            let ends = [least, most].map(|x| (panel.x.place(x), panel.y.place(dot.y)));
            chart.draw_series(LineSeries::new(ends, curve.style.colour.stroke_width(scale))).map_err(told)?;
        }
    }
    Ok(())
}

/// Marks at these places of a diagram.
fn draw_marks<DB: Paper>(
    chart: &mut Chart<'_, DB>,
    mark: Mark,
    style: Style,
    places: impl Iterator<Item = (f64, f64)>,
    scale: u32,
) -> Result<(), String> {
    let places: Vec<(i32, i32)> = places.map(|place| chart.backend_coord(&place)).collect();
    let area = chart.plotting_area().strip_coord_spec();
    let (left, top) = area.get_base_pixel();
    places.into_iter().try_for_each(|(x, y)| draw_mark(&area, mark, style, (x - left, y - top), scale))
}

/// A mark at this pixel: filled, or, where others may lie on it, hollow.
fn draw_mark<DB: Paper>(
    area: &Area<DB>,
    mark: Mark,
    Style { colour, .. }: Style,
    (x, y): (i32, i32),
    scale: u32,
) -> Result<(), String> {
    match mark {
        Mark::Triangle => area.draw(&TriangleMarker::new((x, y), MARK * scale, colour.filled())),
        Mark::Square => {
            let half = (SQUARE * scale) as i32;
            // From the middle of an edge: a corner where the line began would be cut off.
            let corners = [(0, -1), (1, -1), (1, 1), (-1, 1), (-1, -1), (0, -1)];
            let corners = corners.map(|(across, down)| (x + half * across, y + half * down));
            area.draw(&PathElement::new(corners, colour.stroke_width(2 * scale)))
        }
        Mark::Circle => area.draw(&Circle::new((x, y), CIRCLE * scale, colour.filled())),
        Mark::Ring(radius) => area.draw(&Circle::new((x, y), radius * scale, colour.stroke_width(scale))),
        Mark::None => Ok(()),
    }
    .map_err(told)
}

/// The curves' names: in a row in the middle, or in two columns.
fn legend<DB: Paper>(area: &Area<DB>, figure: &Figure, scale: u32) -> Result<(), String> {
    let entries = figure.legend();
    let px = scale as i32;
    let row = LEGEND as i32 * px;
    let width = |entry: &Entry<'_>| text(entry.label, LABEL, scale).width() + 66 * px;
    let whole = area.dim_in_pixel().0 as i32;
    if figure.legend_rows() == 1 {
        let widths: Vec<i32> = entries.iter().map(width).collect();
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
fn entry<DB: Paper>(
    area: &Area<DB>,
    (x, y): (i32, i32),
    Entry { label, style, lined }: Entry<'_>,
    scale: u32,
) -> Result<(), String> {
    let px = scale as i32;
    let line = style.colour.stroke_width(2 * scale);
    let ends = [(x, y), (x + 32 * px, y)];
    match style.dash {
        _ if !lined => Ok(()),
        None => area.draw(&PathElement::new(ends, line)),
        Some((dash, gap)) => area.draw(&DashedPathElement::new(ends, dash * scale, gap * scale, line)),
    }
    .map_err(told)?;
    draw_mark(area, style.mark, style, (x + 16 * px, y), scale)?;
    Words { along: HPos::Left, ..text(label, LABEL, scale) }.draw(area, (x + 40 * px, y))
}
