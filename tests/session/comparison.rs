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
fn exact_is_where_exact_says_also_from_the_middle_of_settling() {
    let mut session = session("gravity", Solver::Exact);
    // Balls chatter, lean and come to rest from 2.2 s on.
    (0..150).for_each(|frame| session.advance(delta(frame)).unwrap());
    session.apply(Command::ToggleComparison).unwrap();
    (0..150).for_each(|frame| session.advance(delta(frame)).unwrap());
    assert_eq!(session.truth().unwrap().balls(), session.simulation().balls());
    assert!(session.errors().len() > 100 && session.errors().iter().all(|&(_, error)| error == 0.0));
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
