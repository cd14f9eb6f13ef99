//! Sessions: what is done can be gone back from, played again and compared, to the bit.

use std::path::Path;

use carom::session::{Change, Command, CommandError, Replay, STEP, Session, Working};
use carom::{Ball, DVec2, Scene, Solver};
use proptest::prelude::*;

fn session(scene: &str, solver: Solver) -> Session {
    Session::new(&Scene::load(scene).unwrap().with_solver(solver), 1).unwrap()
}

fn balls(session: &Session) -> Vec<Ball> {
    session.simulation().balls().to_vec()
}

/// Frames of the length that a window measures: never twice the same.
fn delta(frame: u32) -> f64 {
    0.016 + f64::from(frame % 7) * 1.3e-4
}

#[test]
fn going_back_and_on_again_gives_the_same_bits_with_every_solver_and_through_changes() {
    for (scene, solver) in [
        ("gravity", Solver::Exact),
        ("gravity", Solver::Canvas),
        ("gravity", Solver::Contact),
        ("galton", Solver::Contact),
        ("rain", Solver::Contact),
    ] {
        let mut session = session(scene, solver);
        let mut seen = Vec::new();
        for frame in 0..200 {
            match frame {
                50 => session.apply(Change::AddRandom(5).into()).unwrap(),
                90 => session.apply(Change::TiltGravity(DVec2::new(300.0, 0.0)).into()).unwrap(),
                120 => {
                    let ball = balls(&session).iter().position(|ball| !ball.is_fixed()).unwrap();
                    session.apply(Change::Carry { ball, to: DVec2::new(600.0, 100.0) }.into()).unwrap();
                }
                150 => session.apply(Change::RemoveLast.into()).unwrap(),
                _ => {}
            }
            session.advance(delta(frame)).unwrap();
            seen.push(balls(&session));
        }
        session.apply(Command::TogglePause).unwrap();
        for expected in seen.iter().rev().skip(1) {
            session.apply(Command::Back).unwrap();
            assert_eq!(&balls(&session), expected, "{scene}, {solver}: back");
        }
        assert!(matches!(session.apply(Command::Back), Err(CommandError::NoEarlier)));
        for expected in &seen[1..] {
            session.apply(Command::Step).unwrap();
            session.advance(0.0).unwrap();
            assert_eq!(&balls(&session), expected, "{scene}, {solver}: on again");
        }
        assert_eq!(session.seconds_ago(), 0.0);
    }
}

#[test]
fn time_that_runs_again_plays_what_was_played_and_then_goes_on() {
    let mut session = session("gravity", Solver::Canvas);
    for _ in 0..120 {
        session.advance(STEP).unwrap();
    }
    let now = balls(&session);
    for _ in 0..30 {
        assert!(session.rewind(2.0 * STEP));
    }
    assert!((session.seconds_ago() - 60.0 * STEP).abs() < 1e-9, "{}", session.seconds_ago());
    for _ in 0..60 {
        assert_ne!(balls(&session), now);
        session.advance(STEP).unwrap();
    }
    assert_eq!(balls(&session), now);
    session.advance(STEP).unwrap();
    assert_ne!(balls(&session), now);
}

#[test]
fn a_rewind_ends_at_the_first_frame() {
    let mut session = session("elastic", Solver::Exact);
    for frame in 0..20 {
        session.advance(delta(frame)).unwrap();
    }
    let mut count = 0;
    while session.rewind(0.05) {
        count += 1;
    }
    assert!((4..=8).contains(&count), "{count}");
    assert_eq!(session.simulation().time(), 0.0);
    let first = balls(&session);
    session.rewind(f64::NAN);
    assert!(!session.rewind(0.05) && balls(&session) == first);
}

#[test]
fn a_change_in_the_past_replaces_what_came_after_it() {
    let mut session = session("elastic", Solver::Exact);
    for _ in 0..60 {
        session.advance(STEP).unwrap();
    }
    let before = balls(&session);
    for _ in 0..10 {
        session.apply(Command::Back).unwrap();
    }
    session.apply(Change::RemoveLast.into()).unwrap();
    assert_eq!(session.seconds_ago(), 0.0);
    for _ in 0..10 {
        session.advance(STEP).unwrap();
    }
    assert_eq!(balls(&session).len(), before.len() - 1);
}

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
    let mut rain = self::session("rain", Solver::Contact);
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

#[test]
fn a_ball_that_is_carried_comes_to_the_hand_and_is_flung_with_its_speed() {
    for solver in [Solver::Canvas, Solver::Exact, Solver::Contact] {
        let mut session = session("gravity", solver);
        session.advance(0.0).unwrap();
        let last = balls(&session).len() - 1;
        for _ in 0..last {
            session.apply(Change::Remove(0).into()).unwrap();
        }
        let hand = DVec2::new(900.0, 200.0);
        for _ in 0..60 {
            session.apply(Change::Carry { ball: 0, to: hand }.into()).unwrap();
            session.advance(STEP).unwrap();
        }
        let held = balls(&session)[0];
        assert!(held.position().distance(hand) < 1.5, "{solver}: {}", held.position());
        // 600 px/s to the left.
        for frame in 1..=30 {
            let to = hand - DVec2::new(10.0 * f64::from(frame), 0.0);
            session.apply(Change::Carry { ball: 0, to }.into()).unwrap();
            session.advance(STEP).unwrap();
        }
        let flung = balls(&session)[0].velocity();
        assert!((flung.x + 600.0).abs() < 1.0, "{solver}: {flung}");
    }
}

#[test]
fn a_ball_that_is_carried_pushes_others_and_passes_through_none() {
    for solver in [Solver::Exact, Solver::Contact] {
        let mut session = session("column", solver);
        session.advance(0.0).unwrap();
        let count = balls(&session).len();
        for _ in 1..count {
            session.apply(Change::RemoveLast.into()).unwrap();
        }
        let at = balls(&session)[0].position();
        let beside = at + DVec2::new(100.0, 0.0);
        let radius = balls(&session)[0].radius();
        session.apply(Change::AddBall { position: beside, velocity: DVec2::ZERO, radius }.into()).unwrap();
        for _ in 0..120 {
            session.apply(Change::Carry { ball: 1, to: at - DVec2::new(150.0, 0.0) }.into()).unwrap();
            session.advance(STEP).unwrap();
            let [pushed, hand] = balls(&session)[..] else { panic!() };
            assert!(pushed.position().x < hand.position().x, "{solver}");
        }
        assert!(balls(&session)[0].position().x < at.x - 50.0, "{solver}");
    }
}

#[test]
fn a_ball_is_put_down_only_where_it_overlaps_no_other() {
    let mut session = session("gravity", Solver::Exact);
    session.advance(0.0).unwrap();
    let before = balls(&session);
    let onto = before[3].position();
    assert!(matches!(
        session.apply(Change::Place { ball: 0, at: onto }.into()),
        Err(CommandError::NoRoomHere)
    ));
    assert_eq!(balls(&session), before);
    session.apply(Change::Place { ball: 0, at: DVec2::new(1e4, 600.0) }.into()).unwrap();
    let placed = balls(&session)[0];
    assert_eq!(placed.position(), DVec2::new(1280.0 - placed.radius(), 600.0), "walls hold it");
    assert_eq!(placed.velocity(), before[0].velocity());
    assert!(session.apply(Change::Place { ball: 0, at: DVec2::NAN }.into()).is_err());
}

#[test]
fn a_fixed_ball_is_not_carried_and_one_that_is_not_there_is_refused() {
    let mut session = session("galton", Solver::Contact);
    let peg = balls(&session).iter().position(Ball::is_fixed).unwrap();
    let to = DVec2::new(100.0, 100.0);
    assert!(matches!(session.apply(Change::Carry { ball: peg, to }.into()), Err(CommandError::Fixed)));
    let before = balls(&session);
    for change in
        [Change::Carry { ball: 99_999, to }, Change::Place { ball: 99_999, at: to }, Change::Remove(99_999)]
    {
        assert!(matches!(session.apply(change.into()), Err(CommandError::NoBall(99_999))), "{change:?}");
    }
    assert_eq!(balls(&session), before);
}

#[test]
fn the_ball_under_the_pointer_is_the_one_on_top() {
    let mut session = session("draw", Solver::Canvas);
    let count = balls(&session).len();
    let at = balls(&session)[0].position();
    assert_eq!(session.ball_at(at), Some(0));
    assert_eq!(session.ball_at(DVec2::splat(-500.0)), None);
    session.apply(Change::AddBall { position: at, velocity: DVec2::ZERO, radius: 20.0 }.into()).ok();
    if balls(&session).len() > count {
        assert_eq!(session.ball_at(at), Some(count));
    }
}

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

#[test]
fn one_goes_back_to_before_the_window_had_its_size_and_on_again() {
    let mut session = session("gravity", Solver::Exact);
    let small = DVec2::new(700.0, 500.0);
    let mut seen = Vec::new();
    for frame in 0..40 {
        // As a window does, in each frame.
        session.resize(if frame < 20 { DVec2::new(1280.0, 720.0) } else { small }).unwrap();
        session.advance(STEP).unwrap();
        seen.push(balls(&session));
    }
    session.apply(Command::TogglePause).unwrap();
    for expected in seen.iter().rev().skip(1) {
        session.apply(Command::Back).unwrap();
        session.resize(small).unwrap();
        session.advance(0.0).unwrap();
        assert_eq!(&balls(&session), expected);
    }
    session.apply(Command::TogglePause).unwrap();
    for _ in 0..45 {
        session.resize(small).unwrap();
        session.advance(STEP).unwrap();
    }
    assert!(!session.is_in_the_past());
    assert_eq!(session.simulation().world().size(), small);
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
fn a_step_to_the_next_impact_that_is_looked_for_bit_by_bit_is_the_same_step() {
    let mut session = session("elastic", Solver::Exact);
    session.advance(0.0).unwrap();
    session.apply(Command::TogglePause).unwrap();
    let mut other = self::session("elastic", Solver::Exact);
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
fn a_step_back_that_is_gone_bit_by_bit_shows_the_old_frame_until_it_is_there() {
    let mut session = session("gravity", Solver::Exact);
    let mut shown = Vec::new();
    for _ in 0..60 {
        session.advance(STEP).unwrap();
        shown.push(balls(&session));
    }
    session.apply(Command::TogglePause).unwrap();
    session.apply_while(Command::Back, || false).unwrap();
    let mut parts = 0;
    while session.working() == Some(Working::Back) {
        assert_eq!(balls(&session), shown[59]);
        assert!(!session.is_in_the_past());
        session.work_while(|| false).unwrap();
        parts += 1;
    }
    assert!(parts > 10 && balls(&session) == shown[58], "{parts}");
    // Held, too: no more than there is time for, and nothing is left out.
    session.apply(Command::TogglePause).unwrap();
    let mut left = 0;
    while balls(&session) != shown[40] {
        let mut looks = 3;
        assert!(session.rewind_while(STEP, || {
            looks -= 1;
            looks > 0
        }));
        left += 1;
        assert!(left < 2_000, "it does go back");
    }
}
