//! Going back in time, and on again, gives the same bits.

use std::path::Path;

use carom::session::{Change, Command, CommandError, Replay, STEP, Working};
use carom::{Ball, DVec2, Scene, Solver};

use super::{balls, delta, session};

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
        assert!(matches!(session.apply(Command::Back), Err(CommandError::AtStart)));
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
fn a_change_in_the_past_is_made_in_the_window_as_it_is_now() {
    let [small, large] = [DVec2::new(330.0, 240.0), DVec2::new(1280.0, 720.0)];
    for (before, now) in [(small, large), (large, small)] {
        let past = |scene: &str| {
            let mut session = session(scene, Solver::Exact);
            for frame in 0..40 {
                session.resize(if frame < 20 { before } else { now }).unwrap();
                session.advance(STEP).unwrap();
            }
            (0..30).for_each(|_| session.apply(Command::Back).unwrap());
            session.resize(now).unwrap();
            assert_eq!(session.simulation().world().size(), before);
            session
        };
        let mut added = past("elastic");
        added.apply(Change::AddRandom(100).into()).unwrap();
        let reached = balls(&added).iter().map(Ball::position).fold(DVec2::ZERO, DVec2::max);
        assert!(reached.cmplt(now).all() && reached.cmpgt(0.8 * now).all(), "{now}: {reached}");
        let mut reset = past("walls");
        reset.apply(Change::Reset.into()).unwrap();
        let mut fresh = session("walls", Solver::Exact);
        fresh.resize(now).unwrap();
        assert_eq!(balls(&reset), balls(&fresh), "{now}");
        let (mut opened, scene) = (past("draw"), Scene::load("walls").unwrap());
        for session in [&mut opened, &mut fresh] {
            session.open(&scene).unwrap();
        }
        assert_eq!(opened.simulation().world().size(), now);
        assert_eq!(balls(&opened), balls(&fresh), "{now}");
        // It is done again with all else.
        let mut replay = Replay::parse(Path::new("a"), &added.replay().unwrap(), added.scene()).unwrap();
        while replay.advance().unwrap() {}
        assert_eq!(replay.simulation().balls(), balls(&added));
    }
}

#[test]
fn where_nobody_has_a_window_a_change_in_the_past_is_made_in_the_world_of_then() {
    let mut session = session("draw", Solver::Exact);
    let size = session.simulation().world().size();
    session.advance(STEP).unwrap();
    session.apply(Change::Resize(size / 2.0).into()).unwrap();
    session.advance(STEP).unwrap();
    session.apply(Command::Back).unwrap();
    assert_eq!(session.simulation().world().size(), size);
    session.apply(Change::AddRandom(1).into()).unwrap();
    assert_eq!(session.simulation().world().size(), size);
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

#[test]
fn to_go_back_begins_at_once_whatever_was_played_again_before() {
    let mut session = session("elastic", Solver::Exact);
    session.set_time_scale(1.0 / 64.0);
    (0..640).for_each(|_| session.advance(STEP).unwrap());
    (0..20).for_each(|_| session.apply(Command::Back).unwrap());
    session.set_time_scale(16.0);
    session.advance(0.1).unwrap();
    assert!(!session.is_in_the_past());
    session.set_time_scale(1.0 / 64.0);
    for _ in 0..3 {
        session.rewind(STEP);
    }
    assert!(session.is_in_the_past());
    // Nor does it go back by what was due of frames that are long gone.
    let mut session = super::session("elastic", Solver::Exact);
    session.set_time_scale(16.0);
    (0..10).for_each(|_| session.advance(0.1).unwrap());
    session.apply(Command::Back).unwrap();
    session.set_time_scale(1.0);
    // The one frame is shown for as long as it lasts; then come new ones.
    (0..160).for_each(|_| session.advance(STEP).unwrap());
    session.rewind(STEP);
    assert!(session.seconds_ago() < 0.1, "{} s", session.seconds_ago());
}
