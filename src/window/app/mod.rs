//! The window at work: events become commands, and each frame is advanced, painted and presented.
//!
//! - `input`: keys, the mouse and files, and what they do;
//! - `view`: what is painted;
//! - `saving`: what is saved.

mod input;
mod saving;
mod view;

use std::io::{self, Write};
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec2;
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::keyboard::ModifiersState;
use winit::window::{Window, WindowId};

use super::clock::{FrameClock, FrameRate};
use super::create::create;
use super::hands::Hands;
use super::messages::{Messages, Tone};
use super::overlay::{Browser, Gauge, Overlay};
use super::record::Recorder;
use super::screen::Screen;
use super::timings::Timings;
use super::watch::Watch;
use super::{Options, WindowError, words};
use crate::paint::Painter;
use crate::paint::trails::Trails;
use crate::scene::Scene;
use crate::session::{CommandError, Session};

/// How long to wait before looking whether a window that could not be seen can.
const LOOK_AGAIN: Duration = Duration::from_millis(250);
/// The longest that a frame simulates, in time of the wall's clock: with the time that painting takes, thirty frames a
/// second or so remain. Where more happens than can be computed in it, time runs slower and the window still answers.
const ADVANCE_MOST: Duration = Duration::from_millis(25);
/// How long to wait for the next frame where this one was not presented, which would have waited for the screen.
const STILL: Duration = Duration::from_micros(16_667);

/// Which frames are presented.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Present {
    /// All: the window may have lost what it showed.
    Always,
    /// Those that look other than the one before.
    Changes,
}

/// The window and what is shown in it.
pub(super) struct App {
    /// The scene as the command line named it.
    scene: String,
    options: Options,
    session: Session,
    /// The window and its framebuffer, once there are.
    screen: Option<(Arc<Window>, Screen)>,
    painter: Painter,
    /// What was painted over the balls last, and at which scale.
    overlay: (Overlay, f64),
    clock: FrameClock,
    rate: FrameRate,
    frames_per_second: Option<f64>,
    timings: Option<Timings>,
    modifiers: ModifiersState,
    hands: Hands,
    /// When the pointer was last moved.
    pointed: Option<Instant>,
    /// Whether time runs back for as long as a key is held.
    rewinding: bool,
    help: bool,
    /// The list of scenes, while it is open, and where the pointer is, in pixels.
    browser: Option<Browser>,
    browsed: DVec2,
    /// Where balls went, while that is shown, and the simulated time that was painted last.
    trails: Option<Trails>,
    time: f64,
    /// What the figures are taken from, while they are shown.
    gauge: Option<Gauge>,
    /// How long it took to advance, to paint and to present the last frame.
    split: [Duration; 3],
    /// Until when it is shown where gravity pulls.
    gravity_until: Option<Instant>,
    messages: Messages,
    /// What tells that the scene file was saved, where that is asked for.
    watch: Option<Watch>,
    recorder: Option<Recorder>,
    recording_since: Instant,
    /// When to look what became of it.
    recorder_looks: Option<Instant>,
    /// When to come again with a frame that it could not take.
    recorder_again: Option<Instant>,
    /// Whether other windows cover this one.
    occluded: bool,
    /// While nothing of the window can be seen: when to look again. The event that would tell may come too early.
    look_again: Option<Instant>,
    /// While nothing looks other than it did: when to take the next frame.
    next_frame: Option<Instant>,
    /// When what lies over the balls next changes by itself.
    overlay_changes: Option<Instant>,
    /// The title as it was set last.
    title: String,
    /// Why the event loop was ended, where it was not the user.
    failure: Option<WindowError>,
}

impl ApplicationHandler for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.screen.is_none() {
            let size = self.session.simulation().world().size();
            match create(event_loop, size, &self.options, &self.scene) {
                Ok((window, screen)) => {
                    window.request_redraw();
                    self.screen = Some((window, screen));
                    self.set_title();
                }
                Err(error) => self.fail(event_loop, error),
            }
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested => event_loop.exit(),
            // The frame follows the window's size, whatever events have told of it so far.
            WindowEvent::Resized(_) | WindowEvent::ScaleFactorChanged { .. } => self.request_redraw(),
            WindowEvent::Occluded(occluded) => {
                self.occluded = occluded;
                self.request_redraw();
            }
            WindowEvent::Focused(false) => self.lose_focus(),
            WindowEvent::ModifiersChanged(modifiers) => self.modifiers = modifiers.state(),
            WindowEvent::KeyboardInput { event, is_synthetic: false, .. } => self.key(event_loop, &event),
            WindowEvent::CursorMoved { position, .. } => self.point_at(position),
            WindowEvent::CursorLeft { .. } => {
                self.hands.leave();
                self.request_redraw();
            }
            WindowEvent::MouseInput { state, button, .. } => self.press(button, state),
            WindowEvent::MouseWheel { delta, .. } => self.turn_wheel(delta),
            WindowEvent::DroppedFile(path) => self.open_file(&path),
            WindowEvent::RedrawRequested => {
                if let Err(error) = self.frame(Present::Always) {
                    self.fail(event_loop, error);
                }
            }
            _ => {}
        }
    }

    /// Sleeps until something happens, until something that is said or shown goes by itself, or until it is time for a
    /// frame that nothing asks for, or to look whether the window can be seen again.
    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let now = Instant::now();
        let due = |at: Option<Instant>| at.is_some_and(|at| now >= at);
        if due(self.overlay_changes) {
            self.overlay_changes = None;
            self.set_title();
            self.request_redraw();
        }
        self.look_at_file(now);
        if due(self.recorder_looks) {
            self.look_at_recorder(now);
            self.request_redraw();
        }
        if due(self.recorder_again) {
            self.record_again(now);
        }
        if due(self.look_again) {
            self.look_again = None;
            self.request_redraw();
        }
        if due(self.next_frame)
            && let Err(error) = self.frame(Present::Changes)
        {
            self.fail(event_loop, error);
        }
        let file = self.watch.as_ref().map(Watch::next_poll);
        let wakes = [
            self.overlay_changes,
            self.recorder_looks,
            self.recorder_again,
            file,
            self.look_again,
            self.next_frame,
        ];
        let wake = wakes.into_iter().flatten().min();
        event_loop.set_control_flow(wake.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
    }
}

impl App {
    pub(super) fn new(scene: &Scene, options: &Options, session: Session) -> Self {
        Self {
            scene: scene.argument().to_owned(),
            options: options.clone(),
            session,
            screen: None,
            painter: Painter::default(),
            overlay: (Overlay::default(), 0.0),
            clock: FrameClock::default(),
            rate: FrameRate::default(),
            frames_per_second: None,
            timings: options.timings.then(Timings::default),
            modifiers: ModifiersState::empty(),
            hands: Hands::new(),
            pointed: None,
            rewinding: false,
            help: false,
            browser: None,
            browsed: DVec2::ZERO,
            trails: None,
            time: 0.0,
            gauge: None,
            split: [Duration::ZERO; 3],
            gravity_until: None,
            messages: Messages::new(options.quiet, Instant::now()),
            watch: input::watch(scene, options),
            recorder: None,
            recording_since: Instant::now(),
            recorder_looks: None,
            recorder_again: None,
            occluded: false,
            look_again: None,
            next_frame: None,
            overlay_changes: None,
            title: String::new(),
            failure: None,
        }
    }

    /// Finishes what is under way: where the frames' time went, if that was asked for, and what went wrong, if anything
    /// did.
    pub(super) fn end(mut self) -> (Option<Timings>, Option<WindowError>) {
        // Nothing is shown any more.
        self.screen = None;
        match self.recorder.take().and_then(|recorder| recorder.finish(Instant::now())) {
            None => {}
            Some(Ok(recorded)) => self.announce(recorded.to_string()),
            Some(Err(error)) => self.complain(format!("no recording saved: {error}")),
        }
        (self.timings, self.failure)
    }

    fn fail(&mut self, event_loop: &ActiveEventLoop, error: WindowError) {
        self.failure = Some(error);
        event_loop.exit();
    }

    /// Time that passes from now until the next frame is not simulated, and does not count into the frame rate.
    fn stop_clock(&mut self) {
        self.clock.stop();
        self.rate = FrameRate::default();
        self.frames_per_second = None;
    }

    fn request_redraw(&self) {
        if let Some((window, _)) = &self.screen {
            window.request_redraw();
        }
    }

    /// One frame: measure, advance, paint, present; the last two where they are needed.
    ///
    /// The world is the window, in px that are as large on every screen: with a scale factor of 2, four pixels to one.
    fn frame(&mut self, present: Present) -> Result<(), WindowError> {
        self.next_frame = None;
        let Some((window, screen)) = &mut self.screen else { return Ok(()) };
        let (size, scale) = (window.inner_size(), window.scale_factor());
        if self.occluded || size.width == 0 || size.height == 0 || window.is_minimized() == Some(true) {
            // Nothing can be seen: time stands still, and goes on from there.
            self.stop_clock();
            self.look_again = Some(Instant::now() + LOOK_AGAIN);
            return Ok(());
        }
        self.look_again = None;
        if screen.size() != size {
            screen.resize(size)?;
        }
        let start = Instant::now();
        let measured = self.advance(start, world_size(size, scale))?;
        let advanced = Instant::now();
        let changed = self.paint(scale, measured, start);
        let painted = Instant::now();
        let Some((window, screen)) = &mut self.screen else { return Ok(()) };
        if window.inner_size() != size {
            // This picture is the wrong size already; the next will not be.
            window.request_redraw();
            return Ok(());
        }
        if !changed && present == Present::Changes {
            self.stand_still(start);
            return Ok(());
        }
        let presented = screen.present()?;
        self.split = [advanced - start, painted - advanced, presented.upload + presented.present];
        if let Some(timings) = &mut self.timings {
            timings.add([advanced - start, painted - advanced, presented.upload, presented.present]);
        }
        if !changed {
            self.stand_still(start);
            return Ok(());
        }
        if self.is_moving() {
            self.request_redraw();
        }
        if let Some(rate) = self.rate.count(Instant::now()) {
            self.frames_per_second = Some(rate);
            self.set_title();
        }
        Ok(())
    }

    /// Whether a frame now would move anything.
    fn is_moving(&self) -> bool {
        self.browser.is_none() && (self.rewinding || self.session.is_moving())
    }

    /// Brings the session to the time `now`, in a world of this size. Returns the seconds since the last frame.
    fn advance(&mut self, now: Instant, size: DVec2) -> Result<f64, WindowError> {
        let measured = self.clock.tick(now);
        let resized = self.session.resize(size);
        resized.or_else(|error| match error {
            CommandError::OutOfRange(error) => Err(error),
            error => {
                self.complain(error.to_string());
                Ok(())
            }
        })?;
        if let Some(change) = self.hands.hold(&self.session) {
            // A ball that has no room where the hand is stays where it was.
            let _ = self.session.apply(change.into());
        }
        if self.browser.is_some() {
            return Ok(measured);
        }
        if !self.rewinding {
            let compared = self.session.truth().is_some();
            self.session.advance_while(measured, || now.elapsed() < ADVANCE_MOST)?;
            if compared && self.session.truth().is_none() {
                self.complain("exact cannot follow here in real time: no longer compared".to_owned());
            }
        } else if !self.session.rewind(measured) {
            self.rewinding = false;
            self.complain(CommandError::NoEarlier.to_string());
        }
        Ok(measured)
    }

    /// After a frame that began at `start` and looked as the one before: asks for the next, where time runs, and says
    /// nothing of how many there are.
    fn stand_still(&mut self, start: Instant) {
        self.next_frame = self.is_moving().then_some(start + STILL);
        self.rate = FrameRate::default();
        self.frames_per_second = None;
        // Balls may have come where nobody sees them.
        self.set_title();
    }

    /// Says what was done, over the picture.
    fn say(&mut self, text: String) {
        self.tell(text, Tone::Said);
    }

    /// Says what was done in the title bar, too.
    fn entitle(&mut self, text: String) {
        self.messages.entitle(text.clone(), Instant::now());
        self.tell(text, Tone::Said);
    }

    /// Says what was done everywhere: a file's name may be wanted later.
    fn announce(&mut self, text: String) {
        // A window outlives the terminal that it was started from.
        let _ = writeln!(io::stderr(), "carom: {text}");
        self.entitle(text);
    }

    /// Says everywhere what could not be done.
    fn complain(&mut self, text: String) {
        let _ = writeln!(io::stderr(), "carom: {text}");
        self.messages.entitle(text.clone(), Instant::now());
        self.tell(text, Tone::Wrong);
    }

    fn tell(&mut self, text: String, tone: Tone) {
        self.messages.say(text, tone, Instant::now());
        self.set_title();
        self.request_redraw();
    }

    fn set_title(&mut self) {
        let Some((window, _)) = &self.screen else { return };
        let title = match self.messages.title(Instant::now()) {
            Some(message) => format!("carom – {message}"),
            None => words::title(&self.session, self.frames_per_second),
        };
        if title != self.title {
            window.set_title(&title);
            self.title = title;
        }
    }
}

fn world_size(size: PhysicalSize<u32>, scale_factor: f64) -> DVec2 {
    let size = size.to_logical(scale_factor);
    DVec2::new(size.width, size.height)
}
