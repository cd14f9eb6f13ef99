//! Sessions: what is done can be gone back from, played again and compared, to the bit. Here is what they are played with.

mod back;
mod changes;
mod comparison;
mod hand;
mod impacts;

use carom::session::Session;
use carom::{Ball, Scene, Solver};

fn session(scene: &str, solver: Solver) -> Session {
    Session::new(&Scene::load(scene).unwrap().with_solver(solver), 1).unwrap()
}

fn balls(session: &Session) -> Vec<Ball> {
    session.simulation().balls().to_vec()
}

/// Frames of the length that a window measures: never twice the same.
fn delta(frame: u32) -> f64 {
    0.016 + f64::from(frame % 7) * 1.3e-4
}
