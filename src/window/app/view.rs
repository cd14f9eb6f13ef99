//! What is painted: balls, what lies behind them, and what lies over them.

use std::time::{Duration, Instant};

use glam::DVec2;

use super::super::hands::Gesture;
use super::super::overlay::{Comparison, Frame, Hand, Overlay, Panel, Room, Sheet};
use super::super::words;
use super::{App, Rewinding};

/// How long it is shown what the pointer would do, after it has moved.
const POINTED: Duration = Duration::from_millis(1500);

impl App {
    /// Paints what looks other than it did last, and tells whether anything does.
    pub(super) fn paint(&mut self, scale: f64, measured: f64, now: Instant) -> bool {
        let Some(room) = self.room() else { return false };
        let overlay = (self.overlay(room, measured, now), scale);
        self.overlay_changes = self.next_change(now);
        self.spent("overlay");
        let same = self.overlay == overlay;
        self.overlay = overlay;
        let Some((_, screen)) = &mut self.screen else { return false };
        let Some((mut pixmap, kept)) = screen.pixmap() else { return false };
        let (simulation, painter) = (self.session.simulation(), &mut self.painter);
        let (overlay, _) = &mut self.overlay;
        if !kept {
            painter.forget();
        }
        let size = (pixmap.width(), pixmap.height());
        if same && overlay.is_empty() && self.trails.is_none() {
            return painter.repaint(simulation, scale, &mut pixmap);
        }
        // Trails fade where nothing else moves, but not while time stands still.
        let time = std::mem::replace(&mut self.time, simulation.time());
        let fades = self.trails.is_some() && time != simulation.time();
        if same && !fades && !painter.would_change(simulation, scale, size) {
            return false;
        }
        painter.paint(simulation, scale, &mut pixmap);
        if let Some(trails) = &mut self.trails {
            trails.follow(simulation, scale, size);
            trails.paint(&mut pixmap);
        }
        if let Some(recorder) = self.recorder.as_mut().filter(|recorder| recorder.is_recording()) {
            overlay.paint_kept(&mut pixmap, scale);
            self.recorder_again = recorder.add(pixmap.as_ref(), now);
            if !recorder.is_recording() {
                // This picture has ended it.
                overlay.recording = None;
            }
            overlay.paint_told(&mut pixmap, scale);
        } else {
            overlay.paint(&mut pixmap, scale);
        }
        true
    }

    /// The room on the screen.
    pub(super) fn room(&self) -> Option<Room> {
        let (window, screen) = self.screen.as_ref()?;
        let size = screen.size();
        let picture = DVec2::new(size.width.into(), size.height.into());
        Some(Room { picture, scale: window.scale_factor() })
    }

    /// What is to be painted over the balls `now`, `measured` seconds after the frame before.
    pub(super) fn overlay(&mut self, room: Room, measured: f64, now: Instant) -> Overlay {
        let session = &self.session;
        // Only what the solver was cut short in counts as lost: frames that take long to present are simulated all the same.
        let behind = session.is_behind() && !session.is_paused() && !self.options.quiet;
        let sheet = if self.help {
            Some(Sheet::Help(self.help_page))
        } else {
            behind.then(|| Sheet::Behind(session.simulation().solver()))
        };
        let gravity = self.gravity_until.is_some_and(|until| now < until && !self.options.quiet);
        let recorder = self.recorder.as_ref().filter(|recorder| recorder.is_recording());
        let now_played = self.session.simulation();
        let (page, missing) =
            self.browser.as_mut().map_or((None, false), |browser| browser.page(room, now_played));
        if missing {
            self.request_redraw();
        }
        let session = &self.session;
        let simulation = session.simulation();
        let compared = session.truth().map(|truth| Comparison::new(simulation, truth, session.errors()));
        // In the past the world is as large as it was then.
        let world = simulation.world();
        let inside = (world.size() + 0.5).cmplt(room.picture / room.scale).any();
        let mut overlay = Overlay {
            edge: (inside && world.walls().is_some()).then(|| world.size()),
            comparison: compared,
            hand: self.hand(now),
            gravity: gravity.then(|| session.simulation().world().gravity().unwrap_or_default()),
            figures: None,
            past: words::past(session, self.rewinding != Rewinding::No, room.picture / room.scale)
                .filter(|_| !self.options.quiet),
            sheet,
            page,
            recording: recorder.map(|_| now.saturating_duration_since(self.recording_since).as_secs()),
            // Behind the list of scenes time stands still whatever was asked for.
            paused: session.is_paused() && self.browser.is_none() && !self.options.quiet,
            message: self.messages.shown(now),
        };
        overlay.figures = self.figures(overlay.room_for_figures(room), measured);
        overlay
    }

    /// The figures after a frame that came `measured` seconds after the one before, where they are shown and have room.
    fn figures(&mut self, room: Room, measured: f64) -> Option<Panel> {
        let gauge = self.gauge.as_mut()?;
        gauge.feed(&Frame {
            scene: self.session.name(),
            simulation: self.session.simulation(),
            time_scale: self.session.time_scale(),
            speed: self.session.speed(),
            paused: self.session.is_paused(),
            measured,
            given: (!self.session.is_carrying()).then(|| self.session.given_energy()),
            split: self.split,
        });
        gauge.panel(room)
    }

    /// When what is painted over the balls next changes by itself.
    fn next_change(&self, now: Instant) -> Option<Instant> {
        let ends = [self.gravity_until, self.pointed.map(|at| at + POINTED), self.messages.next_change(now)];
        ends.into_iter().flatten().filter(|&at| at > now).min()
    }

    /// What is shown of the hand, for a while after it has moved, and for as long as it holds something; nothing where
    /// the help or the list of scenes lies over the balls.
    pub(super) fn hand(&self, now: Instant) -> Option<Hand> {
        if self.help || self.browser.is_some() {
            return None;
        }
        if !self.hands.are_busy() && self.pointed.is_none_or(|at| now >= at + POINTED) {
            return None;
        }
        let ball = |index: usize| self.session.simulation().balls().get(index);
        Some(match self.hands.gesture(&self.session)? {
            Gesture::Aim { at, wished, fits } => Hand::Aim { at, wished, fits },
            Gesture::Throw { from, to, velocity, radius } => {
                let path = radius.map(|radius| self.session.path(from, velocity, radius));
                Hand::Throw { from, to, radius, path: path.unwrap_or_default() }
            }
            Gesture::Over(index) => {
                let ball = ball(index)?;
                Hand::Over { centre: ball.position(), radius: ball.radius() }
            }
            Gesture::Hold(index) => {
                let ball = ball(index)?;
                Hand::Hold { centre: ball.position(), radius: ball.radius() }
            }
        })
    }
}
