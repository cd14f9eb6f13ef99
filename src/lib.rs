//! Bouncing balls: a JavaScript canvas physics demo, native and bit for bit, an event-driven solver that is exact, and one
//! with substeps that holds piles.
//!
//! The folders are the story of a frame. A [`scene`] file becomes a [`Simulation`]; the simulation is advanced by a
//! measured delta; what it holds is painted ([`paint`]); the picture is shown in a window, or written by [`headless`]. What
//! the solvers are worth, and what they cost, is measured by `report`.
//! Imports run one way only:
//!
//! ```text
//! simulation  <-  scene  <-  session  <-  paint, headless  <-  report, window  <-  the program
//! ```
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
pub use session::{Command, Session};
pub use simulation::limits::OutOfRange;
pub use simulation::{Ball, BuildError, Pairs, Part, Simulation, Solver, Tally, World};
