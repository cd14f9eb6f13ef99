//! Which solvers suit which built-in scenes: all but piles for `exact`, which would follow each of their hops, and all
//! but crowds for `canvas`, which lets them overlap.

use carom::Solver::{self, Canvas, Contact, Exact};
use carom::scene::names;

/// Every built-in scene with each solver that suits it.
pub fn runs() -> impl Iterator<Item = (&'static str, Solver)> {
    names().into_iter().flat_map(|scene| {
        let solvers: &[Solver] = match scene {
            "pile" | "rain" | "column" | "galton" => &[Contact],
            _ => &[Canvas, Exact, Contact],
        };
        solvers.iter().map(move |&solver| (scene, solver))
    })
}
