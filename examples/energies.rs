//! Runs a scene and prints what becomes of its energy: `cargo run --example energies [SCENE]`.
//!
//! A scene is a built-in one or a file. Time passes only in `advance`, by as much as it is told, so a program decides
//! itself whether seconds are those of a clock, of a film or of nothing at all.

use carom::simulation::invariants::{kinetic_energy, potential_energy};
use carom::{Scene, Solver};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "inelastic".to_owned());
    let scene = Scene::load(&name)?;
    let (mut simulation, mut rain) = (scene.build()?, scene.rain());
    println!("{name}, {} balls, solver {}", simulation.balls().len(), simulation.solver());
    println!("{:>6} {:>14} {:>14} {:>8}", "s", "kinetic", "potential", "impacts");

    let mut before = f64::INFINITY;
    for second in 0..=10 {
        match &mut rain {
            _ if second == 0 => {}
            Some(rain) => rain.advance(&mut simulation, 1.0)?,
            None => simulation.advance(1.0)?,
        }
        let kinetic = kinetic_energy(simulation.balls());
        let potential = potential_energy(simulation.world(), simulation.balls());
        println!("{second:>6} {kinetic:>14.6e} {potential:>14.6e} {:>8}", simulation.tally().impacts);

        // Balls and walls may take energy, and never give any, unless others fall in; only this solver keeps to that to rounding.
        let total = kinetic + potential;
        let is_kept = rain.is_none() && simulation.solver() == Solver::Exact;
        assert!(total <= before * (1.0 + 1e-9) || !is_kept, "{total:e} > {before:e}");
        before = total;
    }
    Ok(())
}
