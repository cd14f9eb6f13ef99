//! Accounts that were opened while `contact` was within a substep took the energy of a picture for that of the balls,
//! and the next frame for one in which energy came from nowhere.

use carom::simulation::ledger::Ledger;
use carom::{Scene, Solver};

#[test]
fn accounts_begin_with_a_state_that_was_computed() {
    let mut simulation = Scene::load("bullet").unwrap().with_solver(Solver::Contact).build().unwrap();
    simulation.advance(0.081_376_242_902_751_75).unwrap();
    let mut ledger = Ledger::new(&simulation);
    // To the end of the substep, and then frames of four.
    simulation.advance_while(1.0, || false).unwrap();
    ledger.check(&simulation).unwrap();
    for _ in 0..60 {
        simulation.advance(1.0 / 60.0).unwrap();
        ledger.check(&simulation).unwrap();
    }
}
