//! Runs a scene and prints what becomes of its energy: `cargo run --example energies [SCENE]`.
//!
//! A scene is a built-in one or a file. Time passes only in `advance`, by as much as it is told, so a program decides
//! itself whether seconds are those of a clock, of a film or of nothing at all.

use carom::simulation::invariants::{kinetic_energy, potential_energy};
use carom::{Scene, Solver};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "inelastic".to_owned());
    let mut simulation = Scene::load(&name)?.build()?;
    println!("{name}, {} balls, solver {}", simulation.balls().len(), simulation.solver());
    println!("{:>6} {:>14} {:>14} {:>8}", "s", "kinetic", "potential", "impacts");

    let mut before = f64::INFINITY;
    for second in 0..=10 {
        if second > 0 {
            simulation.advance(1.0)?;
        }
        let kinetic = kinetic_energy(simulation.balls());
        let potential = potential_energy(simulation.world(), simulation.balls());
        println!("{second:>6} {kinetic:>14.6e} {potential:>14.6e} {:>8}", simulation.tally().impacts);

        // Balls and walls may take energy, and never give any; only this solver keeps to that to rounding.
        let total = kinetic + potential;
        assert!(
            total <= before * (1.0 + 1e-9) || simulation.solver() != Solver::Exact,
            "{total:e} > {before:e}"
        );
        before = total;
    }
    Ok(())
}
