//! A step to the next impact looked a whole thousandth of a second ahead, and in a jam there are so many impacts in it
//! that the window stood still for half a minute.

use std::time::{Duration, Instant};

use carom::{Command, DVec2, Scene, Session, Solver};

#[test]
fn a_step_to_the_next_impact_takes_a_moment_in_a_jam_too() {
    let began = Instant::now();
    let scene = Scene::load("gravity").unwrap().with_solver(Solver::Exact);
    let mut session = Session::new(&scene, 1).unwrap();
    session.resize(DVec2::splat(100.0)).unwrap();
    session.advance(0.0).unwrap();
    session.apply(Command::TogglePause).unwrap();
    for _ in 0..10 {
        session.apply(Command::StepToImpact).unwrap();
        let before = session.simulation().tally();
        session.advance_while(0.0, || false).unwrap();
        let after = session.simulation().tally();
        assert!(after.impacts + after.wall_hits > before.impacts + before.wall_hits);
    }
    assert!(began.elapsed() < Duration::from_secs(30), "{:?}", began.elapsed());
}
