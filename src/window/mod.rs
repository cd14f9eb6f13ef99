//! The window: winit and pixels, and the only folder that knows them.
//!
//! Each frame measures the time since the one before, advances the session by it, paints straight into pixels'
//! framebuffer and presents it. Where nothing moves (paused, hidden, minimised) no frame is asked for, and the event
//! loop sleeps; where time runs but nothing looks other than before, nothing is painted or presented.
//!
//! - `app`: events, and the frame;
//! - `create`, `screen`: the window, and the picture on its way to it, with `recovery` where that fails;
//! - `keys`, `hands`: what keys and the mouse ask for, and `waiting`: what of it could not be done yet;
//! - `overlay`, `messages`, `words`: what is shown and said over the balls;
//! - `picture`, `record`, `files`: what is saved, and `watch`: what others save;
//! - `clock`, `timings`: time as the window measures it.

mod app;
mod clock;
mod create;
mod files;
mod hands;
mod keys;
mod messages;
mod overlay;
mod picture;
mod problem;
mod record;
mod recovery;
mod screen;
mod timings;
mod waiting;
mod watch;
mod words;

use std::io::{self, Write};

use winit::error::EventLoopError;
use winit::event_loop::{ControlFlow, EventLoop};

use app::App;
pub use problem::WindowError;
pub use record::end_recording;
pub use timings::Timings;

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
    /// Take down where the frames' time goes, and print it when the window closes.
    pub timings: Option<Timings>,
    /// Load the scene file again whenever it is saved.
    pub watch: bool,
    /// Neither hint nor messages over the picture.
    pub quiet: bool,
    /// The seed of balls added by key.
    pub seed: Option<u64>,
}

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
    create::check_libraries(scene.argument())?;
    let event_loop = EventLoop::new().map_err(|error| WindowError::NoDisplay {
        reason: problem::plain(&error),
        scene: scene.argument().to_owned(),
    })?;
    event_loop.set_control_flow(ControlFlow::Wait);
    let mut app = App::new(scene, options, session);
    event_loop.run_app(&mut app).map_err(|error| match error {
        EventLoopError::ExitFailure(_) => WindowError::DisplayGone,
        error => WindowError::System(error.to_string()),
    })?;
    let failure = app.end();
    if let Some(timings) = &options.timings {
        let _ = writeln!(io::stderr(), "{timings}");
    }
    failure.map_or(Ok(()), Err)
}
