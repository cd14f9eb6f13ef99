//! A simulation of bouncing balls in two dimensions, with the window, pictures and command line that show it.
//!
//! Balls are discs in a rectangle, with gravity, walls and impacts where they are asked for. One of three solvers moves them on:
//! the step of a JavaScript canvas demo, bit for bit; one from impact to impact that is exact; and one with substeps that holds
//! piles.
//!
//! ```
//! use carom::Scene;
//!
//! let mut simulation = Scene::load("gravity")?.build()?;
//! for _ in 0..600 {
//!     simulation.advance(1.0 / 60.0)?;
//! }
//! assert!(simulation.balls().iter().all(|ball| ball.position().is_finite()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! In a scene with rain ([`Scene::rain`] is `Some`), [`Rain::advance`](scene::Rain::advance) takes the place of
//! [`Simulation::advance`], with which no ball falls in.
//!
//! # The story of a frame
//!
//! ```text
//!  gravity.toml
//!       |  Scene::load         the text is parsed, and every number checked where it stands
//!       v
//!     Scene                    data: a world, balls, random parts, and the solver that suits them
//!       |  Scene::build        random balls find their places; which parts of the solver run is decided, once
//!       v
//!   Simulation  <------------  Session in a window: seconds of its clock, and commands from keys and mouse;
//!       |                      headless: a list of deltas; a program: what it likes
//!       |  advance(seconds)    the solver (canvas, exact, contact) moves the balls: the only door into time
//!       v
//!  balls(), touching()         the state at the end of the frame
//!       |  Painter::repaint    what looks other than in the frame before is painted, by tiny-skia or in its arithmetic
//!       v
//!     Pixmap                   premultiplied RGBA bytes
//!       |
//!       +--> the window, a PNG, a GIF; or nothing at all, where only figures are wanted
//! ```
//!
//! The folders of the source are this story, and imports run one way only, from its beginning to its end; a test sees
//! to it:
//!
//! ```text
//! simulation  <-  scene  <-  session  <-  headless  <-  report, window  <-  the program
//! simulation  <-  paint               <-  headless
//! ```
//!
//! So the physics knows no files, clocks, random numbers or windows, and painting reads a simulation but never moves
//! it.
//!
//! # Where to begin
//!
//! - [`Scene`]: a built-in scene or a file; [`scene`] tells what one may say, and [`scene::write`] makes one of a
//!   simulation.
//! - [`Ball`], [`World`] and [`Simulation::new`]: without files. Numbers are checked when these are made, each against
//!   its range in [`limits`](simulation::limits), and never again.
//! - [`Solver`]: `exact` for what flies, `contact` for what lies on other things, `canvas` for the demo as it is.
//! - [`invariants`](simulation::invariants): energy, momentum and overlap, to look at what a solver has done.
//! - [`paint`]: pictures and animations of a simulation.
//! - [`Session`]: a scene that is played, with commands, pause and time scale; what stands behind a window.
//! - [`headless`]: `carom run` as a function. `report`, with the feature of that name: what the solvers are worth and
//!   cost.
//!
//! The folder `examples` has a program of a page for each of the first: `energies`, `pile`, `error` and `picture`.
//!
//! Lengths are in px with y growing downward, times in seconds, speeds in px/s; masses are in any unit that all balls
//! share.
//!
//! # Features
//!
//! All are on by default: `window` is the window and its graphics libraries, `report` the report with its plots, and
//! `parallel` lets a simulation use [more than one thread](Simulation::with_threads). Without them there is everything
//! else.

pub mod headless;
pub mod paint;
#[cfg(feature = "report")]
pub mod report;
pub mod scene;
pub mod session;
pub mod simulation;
#[cfg(feature = "window")]
pub mod window;

pub use glam::DVec2;
pub use scene::{Scene, SceneError};
pub use session::{Change, Command, Session};
pub use simulation::limits::OutOfRange;
pub use simulation::{Ball, BuildError, EditError, Pairs, Part, Simulation, Solver, Tally, World};
