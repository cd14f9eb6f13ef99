//! A ten-thousandth of a microsecond after a substep of `contact`, its picture was taken for a state that was computed:
//! what bounces in the substep that has begun is shown a little slower, and the ledger missed that energy.

use carom::simulation::ledger::Ledger;
use carom::{Scene, Solver};

#[test]
fn a_picture_a_moment_after_a_substep_is_no_state_that_was_computed() {
    let simulation = Scene::load("gas").unwrap().with_solver(Solver::Contact).build().unwrap();
    let mut simulation = simulation.with_substeps(240).unwrap();
    for _ in 0..60 {
        simulation.advance(1.0 / 60.0).unwrap();
        let (mut ledger, mut shown) = (Ledger::new(&simulation), simulation.clone());
        shown.advance(1.1e-10).unwrap();
        ledger.check(&shown).unwrap();
    }
}
