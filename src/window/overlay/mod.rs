//! What is painted over the simulation: sheets, figures, and what hands are about to do.

mod behind;
mod browser;
mod compare;
mod edge;
mod figures;
mod hand;
mod help;
mod notes;
mod plan;
mod sheet;

use glam::DVec2;
use tiny_skia::PixmapMut;

use crate::simulation::Solver;

use super::messages::Message;
pub(super) use browser::{Browser, Direction, Page};
pub(super) use compare::Comparison;
pub(super) use figures::{Frame, Gauge, Panel, Room};
pub(super) use hand::Hand;
use help::Help;
use notes::Measures;
use plan::Plan;

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
    /// Whether it is said that time stands still.
    pub(super) paused: bool,
    pub(super) message: Option<Message>,
}

/// A sheet over the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sheet {
    /// This page of every key and what it does.
    Help(usize),
    /// Time runs slower than it should, with this solver.
    Behind(Solver),
}

impl Overlay {
    pub(super) fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Paints all of it on a picture with `scale` pixels per px of the world.
    pub(super) fn paint(&self, pixmap: &mut PixmapMut<'_>, scale: f64) {
        let plan = self.plan(pixmap, scale);
        self.paint_world(pixmap, scale);
        self.paint_hand(pixmap, scale);
        self.paint_sheets(pixmap, &plan, scale);
        self.paint_notes(pixmap, &plan, scale);
    }

    /// Paints what belongs into a picture that is saved or recorded.
    pub(super) fn paint_kept(&self, pixmap: &mut PixmapMut<'_>, scale: f64) {
        let plan = self.plan(pixmap, scale);
        self.paint_world(pixmap, scale);
        self.paint_sheets(pixmap, &plan, scale);
    }

    /// Paints the rest, which is for who sits before the window.
    pub(super) fn paint_told(&self, pixmap: &mut PixmapMut<'_>, scale: f64) {
        let plan = self.plan(pixmap, scale);
        self.paint_hand(pixmap, scale);
        self.paint_notes(pixmap, &plan, scale);
    }

    fn plan(&self, pixmap: &PixmapMut<'_>, scale: f64) -> Plan {
        Plan::new(self, Room { picture: sheet::extent(pixmap), scale })
    }

    /// Paints what belongs to places in the world.
    fn paint_world(&self, pixmap: &mut PixmapMut<'_>, scale: f64) {
        if let Some(size) = self.edge {
            edge::edge(pixmap, size, scale);
        }
        if let Some(comparison) = &self.comparison {
            comparison.paint_places(pixmap, scale);
        }
    }

    fn paint_hand(&self, pixmap: &mut PixmapMut<'_>, scale: f64) {
        if let Some(hand) = &self.hand {
            hand.paint(pixmap, scale);
        }
    }

    fn paint_sheets(&self, pixmap: &mut PixmapMut<'_>, plan: &Plan, scale: f64) {
        if let Some(warning) = &plan.warning {
            warning.paint(pixmap);
        }
        if let (Some(gravity), Some(dial)) = (self.gravity, plan.dial) {
            notes::gravity(pixmap, dial, gravity, scale);
        }
        if let (Some(comparison), Some(plot)) = (&self.comparison, &plan.plot) {
            comparison.paint_plot(pixmap, plot);
        }
        if let (Some(figures), Some(area)) = (&self.figures, &plan.figures) {
            figures.paint(pixmap, area);
        }
        if let Some(past) = &plan.past {
            past.paint_past(pixmap, scale);
        }
        if let Some(page) = &self.page {
            page.paint(pixmap);
        }
        if let (Some(help), Some(Sheet::Help(page))) = (&plan.help, self.sheet) {
            help.paint(pixmap, page);
        }
    }

    fn paint_notes(&self, pixmap: &mut PixmapMut<'_>, plan: &Plan, scale: f64) {
        if let Some(recording) = &plan.recording {
            recording.paint_recording(pixmap, scale);
        }
        if let Some(paused) = &plan.paused {
            paused.paint_paused(pixmap, scale);
        }
        if let (Some(message), Some(note)) = (&self.message, &plan.message) {
            note.paint_message(pixmap, message, scale);
        }
    }
}

/// How many pages the help has in this room.
pub(super) fn help_pages(room: Room) -> usize {
    Help::new(room.picture, Measures::new(room.picture, room.scale).low(), room.scale).pages()
}

#[cfg(test)]
mod tests {
    use tiny_skia::Pixmap;

    use super::super::messages::Tone;
    use super::*;
    use crate::scene::Scene;
    use crate::simulation::Simulation;

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
            for (hand, sheet) in
                hands.iter().zip([Sheet::Help(0), Sheet::Behind(Solver::Exact)].iter().cycle())
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

    fn simulation() -> Simulation {
        Scene::load("gravity").unwrap().build().unwrap()
    }

    /// What figures are taken from.
    fn gauge(simulation: &Simulation) -> Gauge {
        let mut gauge = Gauge::default();
        gauge.feed(&Frame {
            scene: "gravity",
            simulation,
            time_scale: 1.0,
            speed: None,
            paused: false,
            measured: 0.0,
            given: Some(1.0),
            split: [std::time::Duration::ZERO; 3],
        });
        gauge
    }

    /// Some overlay: each bit of `which` is for something that may be seen over the balls, or not.
    fn some(which: u32, room: Room, simulation: &Simulation, gauge: &mut Gauge) -> Overlay {
        let has = |bit: u32| which >> bit & 1 == 1;
        let sheet = match which >> 6 & 3 {
            1 => Some(Sheet::Help(0)),
            2 => Some(Sheet::Behind(Solver::Exact)),
            _ => None,
        };
        let text = if has(8) { "a message " } else { "a long message that has to be broken into lines " };
        let message = Message { text: text.repeat(1 + which as usize % 7), tone: Tone::Wrong, opacity: 1.0 };
        let mut overlay = Overlay {
            comparison: has(0).then(|| Comparison::new(simulation, simulation, &[(1.0, 1.0)])),
            gravity: has(1).then_some(DVec2::new(0.0, 980.0)),
            past: has(2).then(|| "looking for the next impact … · Esc: stop".to_owned()),
            recording: has(3).then_some(75),
            paused: has(8),
            message: has(4).then_some(message),
            sheet,
            ..Overlay::default()
        };
        if has(5) {
            overlay.figures = gauge.panel(overlay.room_for_figures(room));
        }
        overlay
    }

    const SIZES: [(f64, f64); 8] = [
        (200.0, 150.0),
        (320.0, 240.0),
        (400.0, 300.0),
        (640.0, 480.0),
        (1280.0, 720.0),
        (160.0, 600.0),
        (900.0, 130.0),
        (60.0, 40.0),
    ];

    #[test]
    fn nothing_lies_over_anything_else_or_is_cut_off() {
        let simulation = simulation();
        let gauge = &mut gauge(&simulation);
        for ((width, height), &scale) in SIZES.into_iter().zip([1.0, 1.5].iter().cycle()) {
            let room = Room { picture: DVec2::new(width, height) * scale, scale };
            for which in 0..1 << 9 {
                let plan = Plan::new(&some(which, room, &simulation, gauge), room);
                let areas = plan.areas();
                for (index, area) in areas.iter().enumerate() {
                    let told = || format!("{width}x{height} by {scale}, {which:#b}: {plan:?}");
                    assert!(area.is_inside(room.picture), "{}", told());
                    assert!(!areas[..index].iter().any(|other| other.meets(area)), "{}", told());
                }
            }
        }
    }

    #[test]
    fn in_small_windows_all_that_is_asked_for_alone_is_seen() {
        let simulation = simulation();
        let gauge = &mut gauge(&simulation);
        for (width, height) in [(200.0, 150.0), (320.0, 240.0), (400.0, 300.0)] {
            let room = Room { picture: DVec2::new(width, height), scale: 1.0 };
            for bit in 0..6 {
                let plan = Plan::new(&some(1 << bit, room, &simulation, gauge), room);
                assert_eq!(plan.areas().len(), 1, "{width}x{height}, {bit}");
            }
            // Of all together the dot, the message, and how far back one is.
            let plan = Plan::new(&some(0b1_0011_1111, room, &simulation, gauge), room);
            assert!(plan.recording.is_some() && plan.message.is_some() && plan.past.is_some());
        }
    }

    #[test]
    fn that_time_stands_still_is_said_beside_a_recording_however_small_the_window_and_gives_way_to_messages()
    {
        for (width, height) in &SIZES[..6] {
            let room = Room { picture: DVec2::new(*width, *height), scale: 1.0 };
            let message = Message { text: "long ".repeat(40), tone: Tone::Said, opacity: 1.0 };
            let mut overlay = Overlay { paused: true, recording: Some(75), ..Overlay::default() };
            assert_eq!(Plan::new(&overlay, room).areas().len(), 2, "{width}x{height}");
            overlay.paused = false;
            overlay.message = Some(message);
            let alone = Plan::new(&overlay, room).message.unwrap().area;
            overlay.paused = true;
            assert_eq!(Plan::new(&overlay, room).message.unwrap().area, alone, "{width}x{height}");
        }
    }

    #[test]
    fn what_is_recorded_is_where_it_is_seen_whatever_is_said_over_it() {
        let simulation = simulation();
        let gauge = &mut gauge(&simulation);
        for &(width, height) in &SIZES[..3] {
            let room = Room { picture: DVec2::new(width, height), scale: 1.0 };
            for which in 0..1 << 9 {
                let seen = Plan::new(&some(which, room, &simulation, gauge), room);
                let kept = Plan::new(&some(which & !0b1_1000, room, &simulation, gauge), room);
                let places = |plan: &Plan| {
                    (plan.figures, plan.plot, plan.dial, plan.past.as_ref().map(|note| note.area))
                };
                assert_eq!(places(&seen), places(&kept), "{width}x{height}, {which:#b}");
            }
        }
    }
}
