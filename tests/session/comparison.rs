//! The same balls moved by the exact solver, beside those that are played.

use carom::session::{Change, Command, CommandError, STEP};
use carom::{Scene, Solver};

use super::{delta, session};

#[test]
fn a_comparison_begins_without_error_shows_it_growing_and_goes_back_with_time() {
    let mut session = session("elastic", Solver::Canvas);
    session.advance(0.0).unwrap();
    assert!(session.truth().is_none() && session.errors().is_empty());
    session.apply(Command::ToggleComparison).unwrap();
    assert_eq!(session.truth().unwrap().balls(), session.simulation().balls());
    for _ in 0..60 {
        session.advance(STEP).unwrap();
    }
    let (time, error) = *session.errors().last().unwrap();
    assert!((time - 1.0).abs() < 1e-9 && error > 1e-3, "after {time} s canvas is {error} px off");
    let exact = Scene::load("elastic").unwrap().build().unwrap();
    let mut exact = carom::Simulation::new(*exact.world(), exact.balls().to_vec(), Solver::Exact).unwrap();
    exact.advance(1.0).unwrap();
    let apart = session.truth().unwrap().balls().iter().zip(exact.balls());
    // Not to the bit: the comparison began with a state that canvas wrote.
    assert!(apart.map(|(a, b)| a.position().distance(b.position())).fold(0.0, f64::max) < 1e-6);
    let count = session.errors().len();
    session.apply(Command::Back).unwrap();
    assert_eq!(session.errors().len(), count - 1);
    session.apply(Change::AddRandom(2).into()).unwrap();
    assert_eq!(session.truth().unwrap().balls().len(), 17);
    session.apply(Command::ToggleComparison).unwrap();
    assert!(session.truth().is_none());
    session.apply(Command::Scene(0)).unwrap();
    let mut rain = super::session("rain", Solver::Contact);
    assert!(matches!(rain.apply(Command::ToggleComparison), Err(CommandError::RainNotCompared)));
}

#[test]
fn exact_is_not_compared_with_itself_and_what_another_solver_did_stays_compared_until_a_reset() {
    let mut session = session("elastic", Solver::Exact);
    let refused = session.apply(Command::ToggleComparison);
    assert!(matches!(refused, Err(CommandError::ExactNotCompared)) && session.truth().is_none());
    let mut play = |commands: &[Command]| {
        for &command in commands {
            session.apply(command).unwrap();
        }
        (0..60).for_each(|frame| session.advance(delta(frame)).unwrap());
        session.errors().last().map(|&(_, error)| error)
    };
    let take = |solver| Command::Change(Change::Solver(solver));
    let by_canvas = play(&[take(Solver::Canvas), Command::ToggleComparison]).unwrap();
    assert!(by_canvas > 1e-3, "{by_canvas}");
    let after_exact = play(&[take(Solver::Exact)]).unwrap();
    assert!(after_exact > 1e-3, "{after_exact}");
    assert_eq!(play(&[Change::Reset.into()]), None);
    // So it is where another scene begins.
    assert!(play(&[take(Solver::Canvas), Command::ToggleComparison]).is_some());
    assert_eq!(play(&[Command::Scene(7)]), None);
}

#[test]
fn a_comparison_that_cannot_follow_ends_and_leaves_the_rest_alone() {
    let mut session = session("pile", Solver::Contact);
    session.advance(0.0).unwrap();
    session.apply(Command::ToggleComparison).unwrap();
    session.advance_while(0.05, || false).unwrap();
    for _ in 0..200 {
        // As much work as a few hundred looks at the watch allow.
        let mut looks = 40;
        session
            .advance_while(0.05, || {
                looks -= 1;
                looks > 0
            })
            .unwrap();
    }
    assert!(session.truth().is_none());
    assert!(session.simulation().time() > 1.0);
}
