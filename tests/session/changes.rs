//! What changes do to balls and energy, and that a replay does it again.

use std::path::Path;

use carom::session::{Change, CommandError, Replay, STEP, Session};
use carom::{DVec2, Scene, Solver};
use proptest::prelude::*;

use super::{balls, session};

#[test]
fn energy_that_commands_give_is_told_from_what_impacts_take() {
    let mut session = session("gravity", Solver::Exact);
    let energy = |session: &Session| {
        use carom::simulation::invariants::{kinetic_energy, potential_energy};
        let simulation = session.simulation();
        kinetic_energy(simulation.balls()) + potential_energy(simulation.world(), simulation.balls())
    };
    let start = session.given_energy();
    assert_eq!(start, energy(&session));
    session.apply(Change::AddRandom(3).into()).unwrap();
    session.apply(Change::TiltGravity(DVec2::new(0.0, -490.0)).into()).unwrap();
    assert!((session.given_energy() - energy(&session)).abs() < 1e-9 * start);
    for _ in 0..120 {
        session.advance(STEP).unwrap();
    }
    assert!(session.given_energy() > energy(&session), "impacts took some");
    session.apply(Change::Reset.into()).unwrap();
    assert!((session.given_energy() - start).abs() < 1e-9 * start);
}

#[test]
fn energy_is_counted_anew_where_no_ball_is_left_and_what_a_hand_has_spent_is_not_held_against_it() {
    let mut session = session("gravity", Solver::Exact);
    let energy = |session: &Session| {
        use carom::simulation::invariants::{kinetic_energy, potential_energy};
        let simulation = session.simulation();
        kinetic_energy(simulation.balls()) + potential_energy(simulation.world(), simulation.balls())
    };
    for frame in 0..120 {
        let to = DVec2::new(200.0 + 7.0 * f64::from(frame), 600.0);
        session.apply(Change::Carry { ball: 3, to }.into()).unwrap();
        assert_eq!(session.given_energy(), energy(&session));
        session.advance(STEP).unwrap();
    }
    while !session.simulation().balls().is_empty() {
        session.apply(Change::RemoveLast.into()).unwrap();
    }
    assert_eq!(session.given_energy(), 0.0);
    session.apply(Change::AddRandom(5).into()).unwrap();
    assert!((session.given_energy() / energy(&session) - 1.0).abs() < 1e-9);
    (0..120).for_each(|_| session.advance(STEP).unwrap());
    session.apply(Change::ToggleGravity.into()).unwrap();
    assert_eq!(session.given_energy(), energy(&session));
}

#[test]
fn hundreds_of_times_a_hundred_balls_are_as_many_as_find_room_and_time_goes_on() {
    let scene = Scene::load("elastic").unwrap().with_size(DVec2::new(240.0, 160.0)).unwrap();
    let mut session = Session::new(&scene, 1).unwrap();
    session.advance(0.0).unwrap();
    let mut refused = 0;
    for _ in 0..300 {
        if let Err(error) = session.apply(Change::AddRandom(100).into()) {
            assert!(matches!(error, CommandError::NoRoom { count: 100, .. }), "{error}");
            refused += 1;
        }
    }
    let count = balls(&session).len();
    assert!(refused > 200 && (20..2_000).contains(&count), "{refused} refused, {count} balls");
    session.advance(STEP).unwrap();
    assert_eq!(session.simulation().time(), STEP);
    session.apply(Change::Reset.into()).unwrap();
    assert_eq!(balls(&session).len(), 15);
}

#[test]
fn numbers_that_are_none_are_refused_and_are_in_no_replay() {
    let mut session = session("gravity", Solver::Exact);
    let before = session.replay();
    let none = [f64::NAN, f64::INFINITY, -f64::INFINITY].map(|number| DVec2::new(number, 5.0));
    let (at, velocity) = (DVec2::new(640.0, 360.0), DVec2::ZERO);
    let changes = none.into_iter().flat_map(|none| {
        [
            Change::AddBall { position: none, velocity, radius: 5.0 },
            Change::AddBall { position: at, velocity: none, radius: 5.0 },
            Change::AddBall { position: at, velocity, radius: none.x },
            Change::Carry { ball: 0, to: none },
            Change::Place { ball: 0, at: none },
            Change::TiltGravity(none),
            Change::Resize(none),
        ]
    });
    for change in changes {
        let refused = session.apply(change.into());
        assert!(matches!(refused, Err(CommandError::OutOfRange(_))), "{change:?}: {refused:?}");
    }
    assert!(session.resize(DVec2::NAN).is_err());
    assert_eq!(session.replay(), before);
}

#[test]
fn a_ball_that_is_to_be_small_is_as_small_and_a_large_one_makes_do_with_2_px_where_there_is_no_more_room() {
    let mut session = session("draw", Solver::Exact);
    let mut add = |x: f64, radius: f64| {
        let position = DVec2::new(x, 700.0);
        session.apply(Change::AddBall { position, velocity: DVec2::ZERO, radius }.into())?;
        Ok::<f64, CommandError>(balls(&session).last().unwrap().radius())
    };
    assert_eq!(add(100.0, 1.0).unwrap(), 1.0);
    assert_eq!(add(200.0, 30.0).unwrap(), 30.0);
}

#[test]
fn a_replay_that_begins_with_another_solver_is_read_as_it_was_written() {
    // A ball beyond the walls: `canvas` leaves it there, which the others do not.
    let text = |solver| {
        format!(
            "solver = \"{solver}\"\nsize = [200, 100]\n[walls]\n[pairs]\n[[ball]]\nposition = [250, 50]\nradius = 10\n"
        )
    };
    for (first, then) in [("canvas", Solver::Exact), ("exact", Solver::Canvas), ("exact", Solver::Contact)] {
        let scene = Scene::parse("stray.toml", &text(first)).unwrap();
        let mut session = Session::new(&scene, 1).unwrap();
        session.apply(Change::Solver(then).into()).unwrap();
        session.advance(0.01).unwrap();
        let text = session.replay().unwrap();
        let mut replay = Replay::parse(Path::new("replay"), &text, &scene).unwrap();
        assert_eq!(replay.to_string(), text);
        while replay.advance().unwrap() {}
        assert_eq!(replay.simulation().balls(), session.simulation().balls());
    }
}

#[test]
fn rain_falls_again_where_room_was_made_in_a_full_box() {
    let text = "solver = \"contact\"\nsize = [60, 60]\ngravity = [0, 980]\n[walls]\n[pairs]\n[rain]\nrate = 100\nradius = 5\n";
    let mut session = Session::new(&Scene::parse("rain.toml", text).unwrap(), 1).unwrap();
    let play = |session: &mut Session| (0..240).for_each(|_| session.advance(STEP).unwrap());
    (0..3).for_each(|_| play(&mut session));
    let full = balls(&session).len();
    play(&mut session);
    assert_eq!(balls(&session).len(), full);
    session.resize(DVec2::new(400.0, 300.0)).unwrap();
    session.advance(0.05).unwrap();
    assert!(balls(&session).len() < full + 20, "those that would have come in the meantime do not");
    play(&mut session);
    assert!(balls(&session).len() > full + 50, "{full}, then {}", balls(&session).len());
}

#[test]
fn a_reset_forgets_the_gravity_that_was_switched_off() {
    for (scene, gravity) in [("elastic", 980.0), ("gravity", 980.0)] {
        let mut session = session(scene, Solver::Exact);
        session.apply(Change::TiltGravity(DVec2::new(196.0, 0.0)).into()).unwrap();
        session.apply(Change::ToggleGravity.into()).unwrap();
        session.apply(Change::Reset.into()).unwrap();
        if session.simulation().world().gravity().is_some() {
            session.apply(Change::ToggleGravity.into()).unwrap();
        }
        session.apply(Change::ToggleGravity.into()).unwrap();
        assert_eq!(session.simulation().world().gravity(), Some(DVec2::new(0.0, gravity)), "{scene}");
    }
}

fn change() -> impl Strategy<Value = Change> {
    let place = || (-100.0..1400.0, -100.0..900.0).prop_map(|(x, y)| DVec2::new(x, y));
    let velocity = || (-3e3..3e3, -3e3..3e3).prop_map(|(x, y)| DVec2::new(x, y));
    prop_oneof![
        Just(Change::Reset),
        (0..9_usize).prop_map(Change::AddRandom),
        (place(), velocity(), 1.0..60.0).prop_map(|(position, velocity, radius)| Change::AddBall {
            position,
            velocity,
            radius
        }),
        Just(Change::RemoveLast),
        (0..20_usize).prop_map(Change::Remove),
        (0..20_usize, place()).prop_map(|(ball, to)| Change::Carry { ball, to }),
        (0..20_usize, place()).prop_map(|(ball, at)| Change::Place { ball, at }),
        prop::sample::select(Solver::ALL).prop_map(Change::Solver),
        Just(Change::ToggleGravity),
        velocity().prop_map(Change::TiltGravity),
        any::<bool>().prop_map(Change::Compare),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn whatever_was_done_a_replay_does_it_again_to_the_bit(
        done in prop::collection::vec((prop::option::weighted(0.3, change()), 0.0..0.05_f64, 1..30_u32), 1..60)
    ) {
        let mut session = session("gravity", Solver::Exact);
        for (change, seconds, most) in done {
            if let Some(change) = change {
                let _ = session.apply(change.into());
            }
            let mut looks = 0;
            session.advance_while(seconds, || { looks += 1; looks < most }).unwrap();
        }
        let text = session.replay().unwrap();
        let mut replay = Replay::parse(Path::new("replay"), &text, session.scene()).unwrap();
        while replay.advance().unwrap() {}
        prop_assert_eq!(replay.simulation().balls(), session.simulation().balls());
        prop_assert_eq!(replay.simulation().tally(), session.simulation().tally());
    }
}
