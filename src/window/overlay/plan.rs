//! Where everything over the picture is: nothing lies on anything else, and what has no room is shortened or left out.
//!
//! What belongs into pictures that are saved or recorded has its place first, and the same one whatever is said to who
//! sits before the window; a strip at the lower edge is left to that. From the top: the warning, the figures, what of the
//! plot there is room for beside them, how far back in time one is; gravity's dial last.

use glam::DVec2;

use super::behind::Warning;
use super::compare::Plot;
use super::figures::{Panel, Room};
use super::help::Help;
use super::notes::{self, Gap, Measures, Note};
use super::sheet::Area;
use super::{Overlay, Sheet};

/// What of an overlay is shown in a picture, and where.
#[derive(Debug, Default)]
pub(super) struct Plan {
    pub(super) warning: Option<Warning>,
    pub(super) help: Option<Help>,
    pub(super) figures: Option<Area>,
    pub(super) plot: Option<Plot>,
    pub(super) past: Option<Note>,
    pub(super) dial: Option<Area>,
    pub(super) recording: Option<Note>,
    pub(super) paused: Option<Note>,
    pub(super) message: Option<Note>,
}

/// What stands at the upper edge above the figures.
struct Head {
    warning: Option<Warning>,
    plot: Option<Plot>,
    past: Option<Note>,
    /// Where the figures begin, px from the upper edge.
    top: f64,
}

impl Plan {
    pub(super) fn new(overlay: &Overlay, room: Room) -> Self {
        let Room { picture, scale } = room;
        let measures = Measures::new(picture, scale);
        let mut plan = Self::default();
        let mut taken = Vec::new();
        if overlay.page.is_some() {
            // It covers all but what is said over it.
            taken.push(Area { corner: DVec2::ZERO, extent: DVec2::new(picture.x, measures.low()) });
        } else {
            plan.place_kept(overlay, room, &measures);
            taken.extend(plan.areas());
        }
        plan.recording = overlay.recording.map(|seconds| Note::recording(seconds, &measures));
        let dot = plan.recording.as_ref().map(|note| note.area);
        taken.extend(dot);
        let corners = [plan.dial, dot];
        plan.message =
            overlay.message.as_ref().and_then(|message| Note::message(message, &measures, &taken, corners));
        // Last: it stays, and what does not is seen in its place meanwhile.
        taken.extend(plan.message.as_ref().map(|note| note.area));
        let paused = overlay.paused.then(|| Note::paused(&measures, dot));
        plan.paused = paused
            .filter(|note| note.area.is_inside(picture) && !taken.iter().any(|area| area.meets(&note.area)));
        plan
    }

    /// Places what belongs into pictures that are saved.
    fn place_kept(&mut self, overlay: &Overlay, room: Room, measures: &Measures) {
        let Room { picture, scale } = room;
        if let Some(Sheet::Help(_)) = overlay.sheet {
            // Figures and plot would look out from behind it.
            let help = Help::new(picture, measures.low(), scale);
            let past = overlay.past.as_ref().map(|text| Note::past(text, measures).below(0.0, measures));
            self.past = past.filter(|note| note.area.is_inside(picture) && !note.area.meets(&help.area));
            self.help = Some(help);
        } else {
            let head = Head::new(overlay, room, overlay.figures.is_some());
            self.figures = overlay.figures.as_ref().map(|panel| panel.area(head.top, scale));
            (self.warning, self.plot, self.past) = (head.warning, head.plot, head.past);
        }
        if overlay.gravity.is_some() {
            let mut taken = self.areas();
            // A recording's dot, up to an hour, whether there is one or not.
            taken.push(Note::recording(3599, measures).area);
            self.dial = notes::dial(measures, &taken);
        }
    }

    /// Where everything is that has a place so far.
    pub(super) fn areas(&self) -> Vec<Area> {
        let notes = [&self.past, &self.recording, &self.paused, &self.message];
        let notes = notes.map(|note| note.as_ref().map(|note| note.area));
        let warning = self.warning.as_ref().map(Warning::area);
        let help = self.help.as_ref().map(|help| help.area);
        let plot = self.plot.map(|plot| plot.area);
        [warning, help, self.figures, plot, self.dial].into_iter().chain(notes).flatten().collect()
    }
}

impl Head {
    /// With room for `figures` or none.
    fn new(overlay: &Overlay, room: Room, figures: bool) -> Self {
        let Room { picture, scale } = room;
        let measures = Measures::new(picture, scale);
        let warning = match overlay.sheet {
            Some(Sheet::Behind(solver)) => Some(Warning::new(picture, solver, scale)),
            _ => None,
        };
        let warning = warning.filter(|warning| warning.area().extent.y <= measures.low());
        let top = warning.as_ref().map_or(0.0, |warning| warning.area().extent.y);
        let panel = |top: f64| {
            Panel::would_be(figures_room(room, top, overlay.comparison.is_some()), top).filter(|_| figures)
        };
        let left = |top: f64| panel(top).map_or(0.0, |area| area.end().x);
        let plot = |top: f64| {
            let corner = DVec2::new(left(top), top);
            let free = Area { corner, extent: DVec2::new(picture.x, measures.low()) - corner };
            overlay.comparison.as_ref().and_then(|_| Plot::new(picture, free, scale))
        };
        let Some(note) = overlay.past.as_ref().map(|text| Note::past(text, &measures)) else {
            return Self { warning, plot: plot(top), past: None, top };
        };
        let beside = plot(top);
        let (right, bottom) = beside.map_or((picture.x, top), |plot| (plot.area.corner.x, plot.area.end().y));
        let gap = Gap { top, left: left(top), right, bottom };
        let placed = note.in_gap(&gap, &measures);
        let taken = [panel(top), beside.map(|plot| plot.area)];
        let low = DVec2::new(picture.x, measures.low());
        if placed.area.is_inside(low) && !taken.iter().flatten().any(|area| area.meets(&placed.area)) {
            return Self { warning, plot: beside, past: Some(placed), top };
        }
        // The others make way for it.
        let past = note.below(top, &measures);
        let below = past.area.end().y;
        if !past.area.is_inside(low) {
            return Self { warning, plot: beside, past: None, top };
        }
        Self { warning, plot: plot(below), past: Some(past), top: below }
    }
}

/// The room for figures from `top` px below the upper edge on, beside a plot or alone.
fn figures_room(Room { picture, scale }: Room, top: f64, plot: bool) -> Room {
    let low = Measures::new(picture, scale).low();
    // They are narrower only where they can be read all the same.
    let beside = picture.x - Plot::least_width(scale);
    let width = if plot && beside >= Panel::least_width(scale) { beside } else { picture.x };
    Room { picture: DVec2::new(width, low - top), scale }
}

impl Overlay {
    /// The room that all else leaves to the figures.
    pub(in crate::window) fn room_for_figures(&self, room: Room) -> Room {
        figures_room(room, Head::new(self, room, true).top, self.comparison.is_some())
    }
}
