//! Measures how far a solver is from the truth: the same scene by `exact` and by the others, and the distance between
//! them.
//!
//! The truth has to be known longer than it is compared with. Where balls meet, errors grow about a hundredfold a second,
//! so trajectories are compared while they are young; later only energies and statistics can be.

use carom::{Scene, SceneError, Simulation, Solver};

const SECONDS: f64 = 0.5;

fn run(solver: Solver, rate: u32) -> Result<Simulation, SceneError> {
    let mut simulation = Scene::load("gravity")?.with_solver(solver).build()?;
    for _ in 0..(SECONDS * f64::from(rate)) as u32 {
        simulation.advance(1.0 / f64::from(rate)).expect("a frame's delta is in range");
    }
    Ok(simulation)
}

/// The largest distance between a ball and the same one in the other simulation, px.
fn distance(one: &Simulation, other: &Simulation) -> f64 {
    let pairs = one.balls().iter().zip(other.balls());
    pairs.map(|(one, other)| one.position().distance(other.position())).fold(0.0, f64::max)
}

fn main() -> Result<(), SceneError> {
    let truth = run(Solver::Exact, 60)?;
    println!("px from exact after {SECONDS} s of gravity");
    println!("{:>8} {:>12} {:>12} {:>12}", "frames/s", "canvas", "contact", "exact");
    for rate in [60, 240, 960, 3840] {
        let errors = [Solver::Canvas, Solver::Contact, Solver::Exact]
            .map(|solver| run(solver, rate).map(|simulation| distance(&truth, &simulation)));
        let [canvas, contact, exact] = errors;
        let (canvas, contact, exact) = (canvas?, contact?, exact?);
        println!("{rate:>8} {canvas:>12.2e} {contact:>12.2e} {exact:>12.2e}");

        // Impacts in their order in time leave rounding; a frame's step leaves more, however short.
        assert!(exact < 1e-10 && contact < 1e-6 && canvas > 1e-3);
    }
    Ok(())
}
