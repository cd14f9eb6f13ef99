//! The window at work: events become commands, and each frame is advanced, painted and presented.
//!
//! - `frame`: measure, advance, paint, present;
//! - `input`: keys, the mouse and files, and what they do;
//! - `view`: what is painted;
//! - `saving`: what is saved.

mod frame;
mod input;
mod saving;
#[cfg(test)]
mod tests;
mod view;

use std::io::{self, Write};
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec2;
use winit::application::ApplicationHandler;
use winit::event::{StartCause, WindowEvent};
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
use super::timings::Turn;
use super::waiting::Waiting;
use super::watch::Watch;
use super::{Options, WindowError, words};
use crate::paint::Painter;
use crate::paint::trails::Trails;
use crate::scene::Scene;
use crate::session::Session;
use frame::Present;

/// Whether time runs back, for as long as a key is held.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Rewinding {
    No,
    Back,
    /// It has come as far back as is remembered, which was said, and stands there.
    AtStart,
}

/// The window and what is shown in it.
#[expect(clippy::struct_excessive_bools, reason = "independent of each other")]
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
    /// The turn of the event loop, since it woke.
    turn: Turn,
    /// What keys and the mouse asked for that there was no time for yet.
    waiting: Waiting,
    /// When something was last seen under way that took its time.
    busy: Option<Instant>,
    modifiers: ModifiersState,
    hands: Hands,
    /// When the pointer was last moved.
    pointed: Option<Instant>,
    /// Whether time runs back.
    rewinding: Rewinding,
    /// Whether the key is down that makes it.
    rewind_held: bool,
    help: bool,
    /// Which of its pages, where there are many.
    help_page: usize,
    /// The list of scenes, while it is open.
    browser: Option<Browser>,
    /// When a click there last chose a scene.
    clicked: Option<Instant>,
    /// Where the pointer is, in pixels.
    pointer: DVec2,
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
    /// The last scene of the user's own that was played: the list of scenes has it, whatever is played now.
    own: Option<Scene>,
    /// What tells that the scene file was saved, where that is asked for.
    watch: Option<Watch>,
    recorder: Option<Recorder>,
    /// Whether another recording is to begin once the last one is written.
    records_next: bool,
    recording_since: Instant,
    /// When to look what became of the recording.
    recorder_looks: Option<Instant>,
    /// When to come again with a frame that the recorder could not take.
    recorder_again: Option<Instant>,
    /// Whether other windows cover this one.
    occluded: bool,
    /// While nothing of the window can be seen: when to look again. The event that would tell may come too early.
    look_again: Option<Instant>,
    /// Where a picture could not be shown: when to try again.
    retry: Option<Instant>,
    /// While nothing looks other than it did: when to take the next frame.
    next_frame: Option<Instant>,
    /// Whether what was painted last is still to be presented.
    unseen: bool,
    /// When what lies over the balls next changes by itself.
    overlay_changes: Option<Instant>,
    /// The title as it was set last.
    title: String,
    /// What was complained of last.
    complaint: String,
    /// Why the event loop was ended, where it was not the user.
    failure: Option<WindowError>,
}

impl ApplicationHandler for App {
    fn new_events(&mut self, _: &ActiveEventLoop, _: StartCause) {
        self.turn = Turn::begin(Instant::now());
        if let Some(timings) = &self.options.timings {
            timings.lock().begin_turn();
        }
    }

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
            WindowEvent::DroppedFile(path) => self.drop_file(path),
            WindowEvent::RedrawRequested => {
                if let Err(error) = self.frame(Present::Now) {
                    self.fail(event_loop, error);
                }
            }
            _ => {}
        }
        self.spent("events");
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
            && let Err(error) = self.frame(Present::WhenAsked)
        {
            self.fail(event_loop, error);
        }
        if self.is_busy() {
            self.busy = Some(now);
        }
        self.catch_up();
        self.spent("what waited");
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
        event_loop.set_control_flow(match wake {
            // While the session works, its frames go on with that.
            _ if !self.waiting.is_empty() && !self.session.is_working() => ControlFlow::Poll,
            Some(at) => ControlFlow::WaitUntil(at),
            None => ControlFlow::Wait,
        });
        if let Some(timings) = &self.options.timings {
            timings.lock().add_turn(self.turn.own(Instant::now()), || {
                let size = self.session.simulation().world().size().round();
                format!("{} · {}×{} px", words::shown(&self.session), size.x, size.y)
            });
        }
    }
}

impl App {
    pub(super) fn new(scene: &Scene, options: &Options, session: Session) -> Self {
        let mut app = Self {
            scene: scene.argument().to_owned(),
            options: options.clone(),
            session,
            screen: None,
            painter: Painter::default(),
            overlay: (Overlay::default(), 0.0),
            clock: FrameClock::default(),
            rate: FrameRate::default(),
            frames_per_second: None,
            turn: Turn::begin(Instant::now()),
            waiting: Waiting::default(),
            busy: None,
            modifiers: ModifiersState::empty(),
            hands: Hands::new(),
            pointed: None,
            rewinding: Rewinding::No,
            rewind_held: false,
            help: false,
            help_page: 0,
            browser: None,
            clicked: None,
            pointer: DVec2::ZERO,
            trails: None,
            time: 0.0,
            gauge: None,
            split: [Duration::ZERO; 3],
            gravity_until: None,
            messages: Messages::new(options.quiet, Instant::now()),
            own: scene.file().map(|_| scene.clone()),
            watch: input::watch(scene, options),
            recorder: None,
            records_next: false,
            recording_since: Instant::now(),
            recorder_looks: None,
            recorder_again: None,
            occluded: false,
            look_again: None,
            retry: None,
            next_frame: None,
            unseen: false,
            overlay_changes: None,
            title: String::new(),
            complaint: String::new(),
            failure: None,
        };
        if options.watch && app.watch.is_none() {
            let name = scene.name();
            app.complain(format!(
                "--watch: {name} is built in, so there is no file to watch; carom scene {name} > mine.toml makes one"
            ));
        }
        app
    }

    /// Finishes what is under way, and tells what went wrong, if anything did.
    pub(super) fn end(mut self) -> Option<WindowError> {
        // Nothing is shown any more.
        self.screen = None;
        match self.recorder.take().and_then(|recorder| recorder.finish(Instant::now())) {
            None => {}
            Some(Ok(recorded)) => self.announce(recorded.to_string()),
            Some(Err(error)) => self.complain(format!("no recording saved: {error}")),
        }
        self.failure
    }

    /// For the timings: what the processor time since they were told last went on.
    fn spent(&self, on: &'static str) {
        if let Some(timings) = &self.options.timings {
            timings.lock().spent(on);
        }
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

    /// Says what was done, over the picture.
    fn say(&mut self, text: String) {
        self.messages.say(text, Tone::Said, Instant::now());
        self.set_title();
        self.request_redraw();
    }

    /// Says what was done in the title bar, too.
    fn entitle(&mut self, text: String) {
        self.tell(text, Tone::Said, false);
    }

    /// Says what was done everywhere: a file's name may be wanted later.
    fn announce(&mut self, text: String) {
        // A window outlives the terminal that it was started from.
        let _ = writeln!(io::stderr(), "carom: {text}");
        self.tell(text, Tone::Said, true);
    }

    /// Says everywhere what could not be done.
    fn complain(&mut self, text: String) {
        // A terminal keeps what was said: once is enough.
        if text != self.complaint {
            let _ = writeln!(io::stderr(), "carom: {text}");
            self.complaint.clone_from(&text);
        }
        self.tell(text, Tone::Wrong, false);
    }

    /// Says something over the picture and in the title bar, where it may be one that `lasts` whatever is said next.
    fn tell(&mut self, text: String, tone: Tone, lasts: bool) {
        let now = Instant::now();
        self.messages.say(text.clone(), tone, now);
        self.messages.entitle(text, lasts, now);
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
