//! The panel: names, numbers and units in three columns, and the chart beneath them.

use std::rc::Rc;

use glam::DVec2;
use tiny_skia::{Pixmap, PixmapMut, PixmapPaint, Transform};

use crate::paint::text::{BASELINE, LINE, shorten, text, width};
use crate::paint::{BALL, Colour};

use super::super::sheet::{Area, INK, QUIET, Rounded};
use super::chart::{self, KINETIC, POTENTIAL};
use super::gauge::{Figures, Gauge};
use super::number::{WIDTH, alike, number, perhaps};

/// Size of the text, px.
const TEXT_SIZE: f64 = 13.0;
/// The text shrinks to this size, px, before the chart is left out, ...
const LEAST_TEXT_SIZE: f64 = 10.5;
/// ... and to this one before rows are, ...
const SMALLEST: f64 = 9.0;
/// ... of each group those of the highest rank first: each row's rank.
const RANKS: [&[u8]; 4] = [&[0, 0, 3], &[1, 4, 4, 4], &[1, 2, 5, 5], &[0, 4, 4, 3]];
const RANK: u8 = 5;
/// Where the text of the least of it would be smaller than this, px, there is no panel.
const ILLEGIBLE: f64 = 7.0;
/// Characters of the columns of names and of units; between two columns there is one more.
const NAME: usize = 11;
const UNIT: usize = 4;
/// The margin around the text, in text sizes.
const PADDING: f64 = 1.0;
/// The gap between two groups of rows, in text sizes.
const GAP: f64 = 0.5;
/// The chart's height, in text sizes.
const CHART: f64 = 6.0;
/// From the picture's corner, px.
const MARGIN: f64 = 10.0;

/// The room that the panel has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::window) struct Room {
    /// Size of the picture, px.
    pub(in crate::window) picture: DVec2,
    /// Pixels per px of the world.
    pub(in crate::window) scale: f64,
}

/// A panel that has been painted; equal to another where it is the very same.
#[derive(Debug, Clone)]
pub(in crate::window) struct Panel(Rc<Pixmap>);

impl PartialEq for Panel {
    fn eq(&self, other: &Self) -> bool {
        Rc::ptr_eq(&self.0, &other.0)
    }
}

impl Panel {
    /// Where one would be in this room, `top` pixels below the picture's upper edge, if there is room for any.
    pub(in crate::window::overlay) fn would_be(room: Room, top: f64) -> Option<Area> {
        lay_out(room).map(|(_, _, extent)| place(extent, top, room.scale))
    }

    /// The width of a picture in which one can be read, px.
    pub(in crate::window::overlay) fn least_width(scale: f64) -> f64 {
        (Layout::new(0, false).extent.x * SMALLEST + 2.0 * MARGIN) * scale
    }

    /// Where it is, `top` pixels below the picture's upper edge.
    pub(in crate::window::overlay) fn area(&self, top: f64, scale: f64) -> Area {
        place(DVec2::new(self.0.width().into(), self.0.height().into()), top, scale)
    }

    /// Copies it there.
    pub(in crate::window::overlay) fn paint(&self, pixmap: &mut PixmapMut<'_>, area: &Area) {
        let (x, y) = (area.corner.x as i32, area.corner.y as i32);
        let paint = PixmapPaint::default();
        pixmap.draw_pixmap(x, y, self.0.as_ref().as_ref(), &paint, Transform::identity(), None);
    }
}

/// In the upper left corner, `top` pixels below the edge.
fn place(extent: DVec2, top: f64, scale: f64) -> Area {
    let margin = (MARGIN * scale).round();
    Area { corner: DVec2::new(margin, (top + margin).floor()), extent }
}

impl Gauge {
    /// The panel with the figures that stand now, painted where it is not yet; none before the first frame, or where
    /// there is no room for any.
    pub(in crate::window) fn panel(&mut self, room: Room) -> Option<Panel> {
        if let Some((painted_for, panel)) = &self.painted
            && *painted_for == room
        {
            return Some(panel.clone());
        }
        let panel = Panel(Rc::new(paint(self, room)?));
        self.painted = Some((room, panel.clone()));
        Some(panel)
    }
}

/// A row: what it says, and the colour of its name.
struct Row {
    name: &'static str,
    value: String,
    unit: &'static str,
    colour: Colour,
}

/// The rows, in their groups.
fn rows(figures: &Figures) -> Vec<Vec<Row>> {
    let row = |name, value, unit| Row { name, value, unit, colour: QUIET };
    let [advance, paint, present] = figures.split;
    let [x, y] = alike(figures.momentum);
    let [energy, kinetic, potential] =
        alike([figures.kinetic + figures.potential, figures.kinetic, figures.potential]);
    vec![
        vec![
            row("balls", number(figures.balls as f64, 0), ""),
            row("time", number(figures.time, 2), "s"),
            row("speed", running(figures.speed, figures.time_scale), "×"),
        ],
        vec![
            row("frames", perhaps(figures.frame_rate, 1), "/s"),
            row("  advance", number(advance, 3), "ms"),
            row("  paint", number(paint, 3), "ms"),
            row("  present", number(present, 3), "ms"),
        ],
        vec![
            row("impacts", perhaps(figures.impact_rate, 1), "/s"),
            row("overlap", perhaps(figures.overlap, 5), "r"),
            row("momentum x", x, ""),
            row("         y", y, ""),
        ],
        vec![
            row("energy", energy, ""),
            Row { colour: KINETIC, ..row("  kinetic", kinetic, "") },
            Row { colour: POTENTIAL, ..row("  potential", potential, "") },
            row("  change", perhaps(figures.change.map(|change| 100.0 * change), 4), "%"),
        ],
    ]
}

/// How fast time runs, of what it should where it does not.
fn running(actual: Option<f64>, time_scale: f64) -> String {
    let wanted = speed(time_scale);
    let told = actual.map(|actual| {
        // Two digits, or all before the point.
        let digits = if actual >= 10.0 { 0 } else { 1 + usize::from(actual < 1.0) };
        format!("{actual:.digits$} of {wanted}")
    });
    told.filter(|told| told.chars().count() <= WIDTH).unwrap_or(wanted)
}

/// A time scale as it is said: in halves where time runs slower.
fn speed(time_scale: f64) -> String {
    let slower = 1.0 / time_scale;
    if time_scale < 1.0 && slower == slower.round() && (1.0..1e6).contains(&slower) {
        format!("1/{}", number(slower, 0))
    } else if time_scale == time_scale.round() {
        number(time_scale, 0)
    } else {
        number(time_scale, 3)
    }
}

/// Where things stand in the panel, in text sizes.
struct Layout {
    /// Width and height of the panel.
    extent: DVec2,
    /// Rows of a higher rank are left out.
    rank: u8,
    chart: bool,
}

impl Layout {
    /// With the rows up to this rank.
    fn new(rank: u8, chart: bool) -> Self {
        let counts = RANKS.map(|ranks| ranks.iter().filter(|&&other| other <= rank).count());
        let rows: usize = 1 + counts.iter().sum::<usize>();
        let groups = counts.iter().filter(|&&count| count > 0).count();
        let columns = width("m", 1.0) * (NAME + 1 + WIDTH + 1 + UNIT) as f64;
        let chart_height = if chart { CHART + LINE + GAP } else { 0.0 };
        let height = rows as f64 * LINE + groups as f64 * GAP + chart_height;
        Self { extent: DVec2::new(columns, height) + 2.0 * PADDING, rank, chart }
    }

    /// With as much as can be read in so much room.
    fn fitting(room: DVec2, scale: f64) -> Self {
        let all = Self::new(RANK, true);
        if all.size(room) >= LEAST_TEXT_SIZE * scale {
            return all;
        }
        let fits = |layout: &Self| layout.size(room) >= SMALLEST * scale;
        (0..=RANK).rev().map(|rank| Self::new(rank, false)).find(fits).unwrap_or_else(|| Self::new(0, false))
    }

    /// The text's size with which the panel fits so much room, px.
    fn size(&self, room: DVec2) -> f64 {
        (room / self.extent).min_element()
    }
}

/// How a panel is laid out in this room, the size of its text and its own size, px; none where nobody could read it.
fn lay_out(Room { picture, scale }: Room) -> Option<(Layout, f64, DVec2)> {
    let room = picture - 2.0 * MARGIN * scale;
    let layout = Layout::fitting(room, scale);
    // Where rows are left out, the rest has no need to be large.
    let most = if layout.rank < RANK { LEAST_TEXT_SIZE } else { TEXT_SIZE };
    let size = layout.size(room).min(most * scale);
    let extent = (layout.extent * size).ceil();
    (size >= ILLEGIBLE * scale).then_some((layout, size, extent))
}

fn paint(gauge: &Gauge, room: Room) -> Option<Pixmap> {
    let figures = gauge.figures()?;
    let (layout, size, extent) = lay_out(room)?;
    let mut pixmap = Pixmap::new(extent.x as u32, extent.y as u32)?;
    let target = &mut pixmap.as_mut();
    Rounded { corner: DVec2::ZERO, extent, radius: 0.5 * size }.sheet(target, 1.0);

    let letter = width("m", size);
    let left = PADDING * size;
    let values = left + (NAME + 1) as f64 * letter;
    let units = values + (WIDTH + 1) as f64 * letter;
    // A value ends where its column does.
    let value_at = |value: &str| values + (WIDTH - value.chars().count()) as f64 * letter;
    let mut top = PADDING * size;
    let baseline = |top: f64| top + BASELINE * size;
    let solver = figures.solver.name();
    let title = shorten(&figures.scene, NAME + WIDTH + UNIT + 1 - solver.len());
    text(target, DVec2::new(left, baseline(top)), size, BALL, &title);
    let right = extent.x - PADDING * size - width(solver, size);
    text(target, DVec2::new(right, baseline(top)), size, QUIET, solver);
    top += LINE * size;
    for (group, ranks) in rows(figures).iter().zip(RANKS) {
        let mut shown = group.iter().zip(ranks).filter(|&(_, &rank)| rank <= layout.rank).peekable();
        if shown.peek().is_some() {
            top += GAP * size;
        }
        for (Row { name, value, unit, colour }, _) in shown {
            let at = |x| DVec2::new(x, baseline(top));
            text(target, at(left), size, *colour, name);
            text(target, at(value_at(value)), size, INK, value);
            text(target, at(units), size, QUIET, unit);
            top += LINE * size;
        }
    }
    if layout.chart {
        top += GAP * size;
        let corner = DVec2::new(left, top);
        let across = extent.x - 2.0 * PADDING * size;
        chart::paint(target, gauge, corner, DVec2::new(across, CHART * size), size);
    }
    Some(pixmap)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use crate::scene::Scene;

    use super::super::Frame;
    use super::*;

    fn gauge(scene: &str, given: f64) -> Gauge {
        let mut simulation = Scene::load(scene).unwrap().build().unwrap();
        let mut gauge = Gauge::default();
        for _ in 0..300 {
            simulation.advance(1.0 / 60.0).unwrap();
            gauge.feed(&Frame {
                scene,
                simulation: &simulation,
                time_scale: 1.0,
                speed: None,
                paused: false,
                measured: 1.0 / 60.0,
                given: Some(given),
                split: [Duration::from_micros(40); 3],
            });
        }
        gauge
    }

    fn room(x: f64, y: f64, scale: f64) -> Room {
        Room { picture: DVec2::new(x, y), scale }
    }

    #[test]
    fn every_row_fits_its_columns_whatever_the_numbers() {
        let mut figures = gauge("gravity", 1.0).figures().unwrap().clone();
        for value in [0.0, 1e-300, 0.123_456, 99_999.5, 1.2e9, 1e300, f64::NAN] {
            for value in [value, -value] {
                figures.time = value.abs();
                (figures.time_scale, figures.speed) = (value, Some(value));
                (figures.frame_rate, figures.impact_rate) = (Some(value), Some(value));
                (figures.change, figures.overlap) = (Some(value), Some(value));
                (figures.kinetic, figures.potential) = (value, value);
                (figures.split, figures.momentum) = ([value; 3], [value; 2]);
                for Row { name, value, unit, .. } in rows(&figures).iter().flatten() {
                    assert!(name.chars().count() <= NAME, "{name}");
                    assert!(value.chars().count() <= WIDTH, "{name}: {value}");
                    assert!(unit.chars().count() <= UNIT, "{unit}");
                }
            }
        }
    }

    #[test]
    fn every_row_has_a_rank_and_in_little_room_those_are_left_out_that_say_least() {
        let gauge = gauge("gravity", 1.0);
        let rows = rows(gauge.figures().unwrap());
        assert_eq!(RANKS.map(<[u8]>::len).to_vec(), rows.iter().map(Vec::len).collect::<Vec<_>>());
        let mut least = RANK;
        for (x, y) in [(1280.0, 720.0), (400.0, 300.0), (320.0, 200.0), (200.0, 120.0)] {
            let (layout, size, _) = lay_out(room(x, y, 1.0)).unwrap();
            assert!(size >= SMALLEST && layout.rank <= least, "{x}x{y}: {size} px, {}", layout.rank);
            least = layout.rank;
        }
        assert!(least < 2);
    }

    #[test]
    fn time_scales_read_as_they_are_said() {
        for (time_scale, said) in
            [(1.0, "1"), (16.0, "16"), (1.0 / 64.0, "1/64"), (0.3, "0.300"), (1.5, "1.500")]
        {
            assert_eq!(speed(time_scale), said);
        }
    }

    #[test]
    fn where_time_runs_slower_it_says_by_how_much() {
        for (actual, time_scale, said) in [
            (None, 1.0, "1"),
            (Some(0.2), 1.0, "0.20 of 1"),
            (Some(0.0), 1.0, "0.00 of 1"),
            (Some(2.34), 16.0, "2.3 of 16"),
            (Some(12.3), 16.0, "12 of 16"),
            (Some(0.004), 1.0 / 64.0, "1/64"),
        ] {
            assert_eq!(running(actual, time_scale), said);
        }
    }

    #[test]
    fn a_panel_stays_the_same_until_its_figures_or_its_room_change() {
        let mut gauge = gauge("gravity", 1.0);
        let wide = room(1280.0, 720.0, 1.0);
        let panel = gauge.panel(wide).unwrap();
        assert_eq!(gauge.panel(wide).unwrap(), panel);
        assert!(gauge.panel(room(1280.0, 721.0, 1.0)).unwrap() != panel);
        assert!(gauge.panel(wide).unwrap() != panel);
    }

    #[test]
    fn the_panel_fits_every_picture_and_is_twice_as_large_at_twice_the_scale() {
        let mut gauge = gauge("gravity", 1.0);
        for (x, y) in [(400.0, 300.0), (640.0, 480.0), (300.0, 2000.0), (3000.0, 200.0)] {
            let Panel(panel) = gauge.panel(room(x, y, 1.0)).unwrap();
            assert!(f64::from(panel.width()) < x && f64::from(panel.height()) < y, "{x}x{y}");
        }
        let Panel(once) = gauge.panel(room(1280.0, 720.0, 1.0)).unwrap();
        let Panel(twice) = gauge.panel(room(2560.0, 1440.0, 2.0)).unwrap();
        assert!(twice.width().abs_diff(2 * once.width()) <= 2);
        assert!(twice.height().abs_diff(2 * once.height()) <= 2);
        for (x, y) in [(0.0, 0.0), (5.0, 5.0), (20.0, 500.0)] {
            assert!(gauge.panel(room(x, y, 1.0)).is_none(), "{x}x{y} has no room");
        }
    }
}
