//! carom (scaffold)
#![forbid(unsafe_code)]
pub mod scene;
pub mod simulation;
pub use glam::DVec2;
pub use scene::{Scene, SceneError};
pub use simulation::limits::OutOfRange;
pub use simulation::{Ball, BuildError, Pairs, Part, Simulation, Solver, Tally, World};
