//! The window: winit and pixels, and the only folder that knows them.
//!
//! Each frame measures the time since the one before, advances the session by it, paints straight into pixels'
//! framebuffer and presents it. Where nothing moves (paused, hidden, minimised) no frame is asked for, and the event
//! loop sleeps; where time runs but nothing looks other than before, nothing is painted or presented.

mod clock;
mod files;
mod keys;
mod overlay;
mod picture;
mod problem;
#[cfg_attr(not(test), expect(dead_code, reason = "no key asks for it yet"))]
mod record;
mod screen;
mod timings;
#[cfg_attr(not(test), expect(dead_code, reason = "no option asks for it yet"))]
mod watch;

use std::io::{self, Write};
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec2;
use tiny_skia::PremultipliedColorU8;
use winit::application::ApplicationHandler;
use winit::dpi::{LogicalSize, PhysicalPosition, PhysicalSize};
use winit::event::{ElementState, KeyEvent, MouseButton, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::keyboard::ModifiersState;
use winit::window::{Fullscreen, Icon, Window, WindowId};

use clock::{FrameClock, FrameRate};
use keys::Action;
use overlay::{Overlay, Sheet};
pub use problem::WindowError;
use screen::Screen;
use timings::Timings;

use crate::paint::{self, Painter};
use crate::scene::Scene;
use crate::session::{Command, Session};

/// How to open a window.
#[derive(Debug, Clone)]
#[expect(clippy::struct_excessive_bools, reason = "independent switches of the command line")]
pub struct Options {
    /// Fill the screen.
    pub fullscreen: bool,
    /// Start with time standing still.
    pub paused: bool,
    /// Simulated seconds per measured second.
    pub time_scale: f64,
    /// Present with the screen's refresh.
    pub vsync: bool,
    /// Print where the frames' time went when the window closes.
    pub timings: bool,
    /// The seed of balls added by key.
    pub seed: Option<u64>,
}

/// Velocity of a thrown ball per px that it was dragged, 1/s.
const THROW: f64 = 4.0;
/// Dragging less far than this is a click, px.
const CLICK: f64 = 4.0;
/// The widest window that is asked for, in pixels of the screen. No graphics adapter draws a wider one.
const WIDEST: f64 = 32_767.0;
/// How long to wait before looking whether a window that could not be seen can.
const LOOK_AGAIN: Duration = Duration::from_millis(250);
/// The longest that a frame simulates, in time of the wall's clock: with the time that painting takes, thirty frames a
/// second or so remain. Where more happens than can be computed in it, time runs slower and the window still answers.
const ADVANCE_MOST: Duration = Duration::from_millis(25);
/// How long to wait for the next frame where this one was not presented, which would have waited for the screen.
const STILL: Duration = Duration::from_micros(16_667);
/// How long a notice stands in the title bar.
const NOTICE: Duration = Duration::from_secs(3);

/// Opens a window on a scene and returns when it is closed.
///
/// # Errors
/// [`WindowError`] where there is no display or no graphics adapter, or they fail.
pub fn open(scene: &Scene, options: &Options) -> Result<(), WindowError> {
    let mut session = Session::new(scene, options.seed.unwrap_or(1))?;
    session.set_time_scale(options.time_scale);
    if options.paused {
        // Pausing cannot fail.
        let _ = session.apply(Command::TogglePause);
    }
    check_libraries(scene.argument())?;
    let event_loop = EventLoop::new().map_err(|error| WindowError::NoDisplay {
        reason: problem::plain(&error),
        scene: scene.argument().to_owned(),
    })?;
    event_loop.set_control_flow(ControlFlow::Wait);
    let mut app = App {
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
        pointer: DVec2::ZERO,
        drag: None,
        help: false,
        occluded: false,
        look_again: None,
        next_frame: None,
        notice: None,
        title: String::new(),
        failure: None,
    };
    event_loop.run_app(&mut app).map_err(|error| WindowError::System(error.to_string()))?;
    if let Some(timings) = &app.timings {
        let _ = writeln!(io::stderr(), "{timings}");
    }
    app.failure.map_or(Ok(()), Err)
}

/// winit aborts where the keyboard's library is missing under X11; this asks before it does.
#[cfg(target_os = "linux")]
fn check_libraries(scene: &str) -> Result<(), WindowError> {
    let missing = |library, package| WindowError::NoLibrary { library, package, scene: scene.to_owned() };
    if xkbcommon_dl::xkbcommon_option().is_none() {
        return Err(missing("libxkbcommon.so.0", "libxkbcommon0"));
    }
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let on_wayland = set("WAYLAND_DISPLAY") || set("WAYLAND_SOCKET");
    if !on_wayland && set("DISPLAY") && xkbcommon_dl::x11::xkbcommon_x11_option().is_none() {
        return Err(missing("libxkbcommon-x11.so.0", "libxkbcommon-x11-0"));
    }
    Ok(())
}

#[cfg(not(target_os = "linux"))]
fn check_libraries(_scene: &str) -> Result<(), WindowError> {
    Ok(())
}

/// Which frames are presented.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Present {
    /// All: the window may have lost what it showed.
    Always,
    /// Those that look other than the one before.
    Changes,
}

/// The window and what is shown in it.
struct App {
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
    /// Where the pointer is, px of the world.
    pointer: DVec2,
    /// Where the mouse button went down, while it is.
    drag: Option<DVec2>,
    help: bool,
    /// Whether other windows cover this one.
    occluded: bool,
    /// While nothing of the window can be seen: when to look again. The event that would tell may come too early.
    look_again: Option<Instant>,
    /// While nothing looks other than it did: when to take the next frame.
    next_frame: Option<Instant>,
    /// Something to say in the title bar, and since when.
    notice: Option<(String, Instant)>,
    /// The title as it was set last.
    title: String,
    /// Why the event loop was ended, where it was not the user.
    failure: Option<WindowError>,
}

impl ApplicationHandler for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.screen.is_none() {
            match self.create(event_loop) {
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
            WindowEvent::ModifiersChanged(modifiers) => self.modifiers = modifiers.state(),
            WindowEvent::KeyboardInput { event, is_synthetic: false, .. } => self.key(event_loop, &event),
            WindowEvent::CursorMoved { position, .. } => self.point_at(position),
            WindowEvent::MouseInput { state, button: MouseButton::Left, .. } => self.press(state),
            WindowEvent::RedrawRequested => {
                if let Err(error) = self.frame(Present::Always) {
                    self.fail(event_loop, error);
                }
            }
            _ => {}
        }
    }

    /// Sleeps until something happens, until the notice in the title bar has stood long enough, or until it is time for a
    /// frame that nothing asks for, or to look whether the window can be seen again.
    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let now = Instant::now();
        if self.notice.as_ref().is_some_and(|(_, since)| now >= *since + NOTICE) {
            self.notice = None;
            self.set_title();
        }
        if self.look_again.is_some_and(|at| now >= at) {
            self.look_again = None;
            self.request_redraw();
        }
        if self.next_frame.is_some_and(|at| now >= at)
            && let Err(error) = self.frame(Present::Changes)
        {
            self.fail(event_loop, error);
        }
        let notice_ends = self.notice.as_ref().map(|(_, since)| *since + NOTICE);
        let wake = notice_ends.into_iter().chain(self.look_again).chain(self.next_frame).min();
        event_loop.set_control_flow(wake.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
    }
}

impl App {
    fn create(&mut self, event_loop: &ActiveEventLoop) -> Result<(Arc<Window>, Screen), WindowError> {
        let size = self.session.simulation().world().size();
        let mut attributes = Window::default_attributes()
            .with_title("carom")
            .with_inner_size(LogicalSize::new(size.x, size.y))
            .with_window_icon(icon());
        #[cfg(target_os = "linux")]
        {
            use winit::platform::{wayland::WindowAttributesExtWayland, x11::WindowAttributesExtX11};
            attributes = WindowAttributesExtX11::with_name(attributes, "carom", "carom");
            attributes = WindowAttributesExtWayland::with_name(attributes, "carom", "carom");
        }
        if self.options.fullscreen {
            attributes = attributes.with_fullscreen(Some(Fullscreen::Borderless(None)));
        }
        // X11 counts a window's sides in 16 bits, and winit ends the program where they do not fit.
        let pixels = size * event_loop.primary_monitor().map_or(1.0, |monitor| monitor.scale_factor());
        if pixels.max_element() > WIDEST {
            return Err(WindowError::TooLarge { width: pixels.x as u32, height: pixels.y as u32 });
        }
        let window = event_loop.create_window(attributes).map_err(|error| WindowError::NoDisplay {
            reason: problem::plain(&error),
            scene: self.scene.clone(),
        })?;
        let window = Arc::new(window);
        let size = window.inner_size();
        let at_least_one = PhysicalSize::new(size.width.max(1), size.height.max(1));
        let screen = Screen::new(window.clone(), at_least_one, self.options.vsync, &self.scene)?;
        Ok((window, screen))
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

    fn key(&mut self, event_loop: &ActiveEventLoop, event: &KeyEvent) {
        if event.state != ElementState::Pressed {
            return;
        }
        match keys::action(&event.logical_key, self.modifiers, event.repeat) {
            None => return,
            Some(Action::Do(command)) => self.apply(command),
            Some(Action::ToggleHelp) => self.help = !self.help,
            Some(Action::ToggleFullscreen) => self.toggle_fullscreen(),
            Some(Action::SavePicture) => self.save_picture(),
            Some(Action::Quit) => return event_loop.exit(),
        }
        self.request_redraw();
    }

    fn apply(&mut self, command: Command) {
        let was_paused = self.session.is_paused();
        match self.session.apply(command) {
            Err(error) => self.say(error.to_string()),
            Ok(()) if matches!(command, Command::ToggleGravity | Command::TiltGravity(_)) => {
                self.notify(gravity_notice(self.session.simulation().world().gravity()));
            }
            Ok(()) => {}
        }
        // A frame that was painted while paused has started the clock again.
        if was_paused || self.session.is_paused() {
            self.stop_clock();
        }
        self.set_title();
    }

    fn toggle_fullscreen(&self) {
        if let Some((window, _)) = &self.screen {
            let fullscreen = window.fullscreen().is_none().then_some(Fullscreen::Borderless(None));
            window.set_fullscreen(fullscreen);
        }
    }

    fn save_picture(&mut self) {
        let Some((_, screen)) = &self.screen else { return };
        let Some(painted) = screen.painted() else { return };
        match picture::save(self.session.name(), painted) {
            Ok(path) => self.say(format!("saved {}", path.display())),
            Err(error) => self.say(format!("no picture saved: {error}")),
        }
    }

    fn point_at(&mut self, position: PhysicalPosition<f64>) {
        if let Some((window, _)) = &self.screen {
            let position = position.to_logical(window.scale_factor());
            self.pointer = DVec2::new(position.x, position.y);
            if self.drag.is_some() {
                self.request_redraw();
            }
        }
    }

    /// A click adds a ball at rest; a drag throws it from where it began, the faster the longer the line.
    fn press(&mut self, state: ElementState) {
        match (state, self.drag.take()) {
            (ElementState::Pressed, _) => self.drag = Some(self.pointer),
            (ElementState::Released, Some(position)) => {
                let line = self.pointer - position;
                let velocity = if line.length() < CLICK { DVec2::ZERO } else { line * THROW };
                self.apply(Command::AddBall { position, velocity });
            }
            (ElementState::Released, None) => {}
        }
        self.request_redraw();
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
        self.session.resize(world_size(size, scale))?;
        let start = Instant::now();
        let measured = self.clock.tick(start);
        self.session.advance_while(measured, || start.elapsed() < ADVANCE_MOST)?;
        let advanced = Instant::now();
        let changed = self.paint(scale);
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
        if let Some(timings) = &mut self.timings {
            timings.add([advanced - start, painted - advanced, presented.upload, presented.present]);
        }
        if !changed {
            self.stand_still(start);
            return Ok(());
        }
        if self.session.is_moving() {
            window.request_redraw();
        }
        if let Some(rate) = self.rate.count(Instant::now()) {
            self.frames_per_second = Some(rate);
            self.set_title();
        }
        Ok(())
    }

    /// Paints what looks other than it did last, and tells whether anything does.
    fn paint(&mut self, scale: f64) -> bool {
        let overlay = self.overlay();
        let Some((_, screen)) = &mut self.screen else { return false };
        let Some((mut pixmap, kept)) = screen.pixmap() else { return false };
        let (simulation, painter) = (self.session.simulation(), &mut self.painter);
        let same = std::mem::replace(&mut self.overlay, (overlay, scale)) == (overlay, scale);
        if !kept {
            painter.forget();
        }
        if same && overlay.is_empty() {
            return painter.repaint(simulation, scale, &mut pixmap);
        }
        if same && !painter.would_change(simulation, scale, (pixmap.width(), pixmap.height())) {
            return false;
        }
        painter.paint(simulation, scale, &mut pixmap);
        overlay.paint(&mut pixmap, scale);
        true
    }

    /// What is to be painted over the balls.
    fn overlay(&self) -> Overlay {
        let session = &self.session;
        let throw = self.drag.and_then(|from| Some((from, self.pointer, session.room_at(from)?)));
        let behind = session.is_behind() && !session.is_paused();
        let sheet = if self.help {
            Some(Sheet::Help)
        } else {
            behind.then(|| Sheet::Behind(session.simulation().solver()))
        };
        Overlay { throw, sheet }
    }

    /// After a frame that began at `start` and looked as the one before: asks for the next, where time runs, and says
    /// nothing of how many there are.
    fn stand_still(&mut self, start: Instant) {
        self.next_frame = self.session.is_moving().then_some(start + STILL);
        self.rate = FrameRate::default();
        self.frames_per_second = None;
        // Balls may have come where nobody sees them.
        self.set_title();
    }

    /// Says something in the title bar, and on standard error for whoever looks there.
    fn say(&mut self, text: String) {
        // A window outlives the terminal that it was started from.
        let _ = writeln!(io::stderr(), "carom: {text}");
        self.notify(text);
    }

    /// Says something in the title bar.
    fn notify(&mut self, text: String) {
        self.notice = Some((text, Instant::now()));
        self.set_title();
    }

    fn set_title(&mut self) {
        let Some((window, _)) = &self.screen else { return };
        let title = match &self.notice {
            Some((notice, _)) => format!("carom – {notice}"),
            None => title(&self.session, self.frames_per_second),
        };
        if title != self.title {
            window.set_title(&title);
            self.title = title;
        }
    }
}

/// Scene, solver, balls, and how time runs.
fn title(session: &Session, frames_per_second: Option<f64>) -> String {
    let (simulation, scale) = (session.simulation(), session.time_scale());
    let count = simulation.balls().len();
    let balls = if count == 1 { "ball" } else { "balls" };
    let mut title = format!("carom – {} · {} · {count} {balls}", session.name(), simulation.solver());
    if scale != 1.0 {
        let factor = if scale < 1.0 { format!("1/{}", 1.0 / scale) } else { scale.to_string() };
        title += &format!(" · speed {factor}");
    }
    match frames_per_second {
        _ if session.is_paused() => title += " · paused",
        Some(rate) => title += &format!(" · {rate:.0} fps"),
        None => {}
    }
    title
}

/// Gravity as it is now, in whole px/s².
fn gravity_notice(gravity: Option<DVec2>) -> String {
    let Some(gravity) = gravity else { return "gravity off".to_owned() };
    // Adding 0 makes a 0 of -0.
    let DVec2 { x, y } = gravity.round() + DVec2::ZERO;
    format!("gravity ({x}, {y}) px/s²")
}

fn world_size(size: PhysicalSize<u32>, scale_factor: f64) -> DVec2 {
    let size = size.to_logical(scale_factor);
    DVec2::new(size.width, size.height)
}

/// One of our balls.
fn icon() -> Option<Icon> {
    const SIDE: u32 = 64;
    let mut pixmap = tiny_skia::Pixmap::new(SIDE, SIDE)?;
    let middle = f64::from(SIDE) / 2.0;
    paint::fill_disc(&mut pixmap.as_mut(), DVec2::splat(middle), middle - 2.0, paint::BALL);
    let straight = pixmap.pixels().iter().map(PremultipliedColorU8::demultiply);
    let rgba = straight.flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue(), pixel.alpha()]);
    Icon::from_rgba(rgba.collect(), SIDE, SIDE).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_notice_gives_gravity_in_whole_numbers_without_a_minus_before_0() {
        assert_eq!(gravity_notice(None), "gravity off");
        assert_eq!(gravity_notice(Some(DVec2::new(98.0, 980.0))), "gravity (98, 980) px/s²");
        assert_eq!(gravity_notice(Some(DVec2::new(-0.3, -97.6))), "gravity (0, -98) px/s²");
    }
}
