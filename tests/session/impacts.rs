//! Steps to the next impact.

use carom::session::{Command, CommandError, STEP, Session, Working};
use carom::{Change, Scene, Solver};

use super::{balls, session};

#[test]
fn a_step_to_the_next_impact_counts_one_more() {
    let mut session = session("elastic", Solver::Exact);
    session.advance(0.0).unwrap();
    session.apply(Command::TogglePause).unwrap();
    for _ in 0..20 {
        let before = session.simulation().tally();
        session.apply(Command::StepToImpact).unwrap();
        session.advance(0.0).unwrap();
        let after = session.simulation().tally();
        assert_eq!(after.impacts + after.wall_hits, before.impacts + before.wall_hits + 1);
    }
}

#[test]
fn a_step_to_the_next_impact_that_is_looked_for_bit_by_bit_is_the_same_step() {
    let mut session = session("elastic", Solver::Exact);
    session.advance(0.0).unwrap();
    session.apply(Command::TogglePause).unwrap();
    let mut other = super::session("elastic", Solver::Exact);
    other.advance(0.0).unwrap();
    other.apply(Command::TogglePause).unwrap();
    for _ in 0..5 {
        let before = balls(&session);
        session.apply_while(Command::StepToImpact, || false).unwrap();
        let mut parts = 0;
        while session.working() == Some(Working::Impact) {
            session.advance(STEP).unwrap();
            assert_eq!(balls(&session), before, "time stands still meanwhile");
            session.work_while(|| false).unwrap();
            parts += 1;
        }
        assert!(parts > 10, "{parts}");
        session.advance(STEP).unwrap();
        other.apply(Command::StepToImpact).unwrap();
        other.advance(STEP).unwrap();
        assert_eq!(balls(&session), balls(&other));
    }
    // Given up, it is as if it had not been asked for.
    let before = balls(&session);
    session.apply_while(Command::StepToImpact, || false).unwrap();
    session.stop_working();
    session.advance(STEP).unwrap();
    assert!(balls(&session) == before && !session.is_moving());
    // Another command waits for it.
    session.apply_while(Command::StepToImpact, || false).unwrap();
    session.apply(Command::Slower).unwrap();
    assert!(session.working().is_none() && session.is_moving());
}

#[test]
fn a_search_for_an_impact_that_ends_in_vain_leaves_the_command_after_it_to_be_done() {
    let still = "size = [100, 100]\n[walls]\n[[ball]]\nposition = [50, 50]\nradius = 5\n";
    let mut session = Session::new(&Scene::parse("still.toml", still).unwrap(), 1).unwrap();
    session.advance(0.0).unwrap();
    session.apply(Command::TogglePause).unwrap();
    session.apply_while(Command::StepToImpact, || false).unwrap();
    let told = session.apply(Change::ToggleGravity.into());
    assert!(matches!(told, Err(CommandError::NoImpact(_))), "{told:?}");
    assert!(session.simulation().world().gravity().is_some());
    // Of two that come to nothing, the one that was asked for last.
    session.apply(Change::ToggleGravity.into()).unwrap();
    session.apply_while(Command::StepToImpact, || false).unwrap();
    let told = session.apply(Change::Remove(7).into());
    assert!(matches!(told, Err(CommandError::NoBall(7))), "{told:?}");
}
