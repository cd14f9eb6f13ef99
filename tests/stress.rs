//! Long runs: the laws hold in every frame, for a minute of each scene, and for an hour where that is asked for:
//! `cargo test --release --test stress -- --ignored --nocapture` prints what each came to.

use std::time::Instant;

use carom::simulation::grid::Grid;
use carom::simulation::invariants::{kinetic_energy, max_overlap, potential_energy};
use carom::simulation::ledger::Ledger;
use carom::{Scene, Simulation, Solver};

#[path = "common/suits.rs"]
mod suits;

const FRAME: f64 = 1.0 / 60.0;

fn energy(simulation: &Simulation) -> f64 {
    kinetic_energy(simulation.balls()) + potential_energy(simulation.world(), simulation.balls())
}

/// Runs a scene for so many frames; what it came to, or the law that broke.
fn held(name: &str, solver: Solver, frames: u32) -> Result<String, String> {
    let scene = Scene::load(name).unwrap().with_solver(solver);
    let (mut simulation, mut rain) = (scene.build().unwrap(), scene.rain());
    let (begun, start) = (Instant::now(), energy(&simulation));
    let ledger = Ledger::new(&simulation);
    let mut ledger = if rain.is_some() { ledger.without_flights() } else { ledger };
    let (mut deepest, mut grid) = (0.0_f64, Grid::new(simulation.balls(), simulation.world().size()));
    for frame in 1..=frames {
        match &mut rain {
            Some(rain) => rain.advance(&mut simulation, FRAME).unwrap(),
            None => simulation.advance(FRAME).unwrap(),
        }
        let told = |error| format!("{name} with {solver}, frame {frame}: {error}");
        ledger.check(&simulation).map_err(told)?;
        if frame.is_multiple_of(60) {
            deepest = deepest.max(max_overlap(&mut grid, simulation.balls()));
        }
    }
    assert!((simulation.time() - f64::from(frames) * FRAME).abs() < 1e-6, "{name}: no time was lost");
    let tally = simulation.tally();
    Ok(format!(
        "{name:<10} {solver:<8} {:>5} balls {:>10} impacts {:>10} on walls  energy {:.6e} after {start:.6e}  overlap {deepest:.3}  {:.1} s",
        simulation.balls().len(),
        tally.impacts,
        tally.wall_hits,
        energy(&simulation),
        begun.elapsed().as_secs_f64()
    ))
}

fn all_held(frames: u32) {
    let results: Vec<_> = suits::runs()
        .map(|(scene, solver)| {
            let result = held(scene, solver, frames);
            println!("{}", result.as_ref().unwrap_or_else(|broken| broken));
            result
        })
        .collect();
    let broken: Vec<_> = results.into_iter().filter_map(Result::err).collect();
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn a_minute_of_every_scene_keeps_the_laws() {
    all_held(60 * 60);
}

#[test]
#[ignore = "minutes, with optimisation"]
fn an_hour_of_every_scene_keeps_the_laws() {
    all_held(60 * 60 * 60);
}
