//! Balls in the hand: carried, flung, put down and pointed at.

use carom::session::{Change, Command, CommandError, STEP, Session};
use carom::{Ball, DVec2, Scene, Solver};

use super::{balls, session};

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
fn a_ball_is_not_put_into_another_beside_a_wall_by_who_points_beyond_that() {
    let text = "size = [200, 100]\n[walls]\n[pairs]\n[[ball]]\nposition = [10, 50]\nradius = 10\n\
                [[ball]]\nposition = [150, 50]\nradius = 10\n";
    let mut session = Session::new(&Scene::parse("two.toml", text).unwrap(), 1).unwrap();
    session.advance(0.0).unwrap();
    let before = balls(&session);
    let refused = session.apply(Change::Place { ball: 1, at: DVec2::new(-100.0, 50.0) }.into());
    assert!(matches!(refused, Err(CommandError::NoRoomHere)), "{refused:?}");
    assert_eq!(balls(&session), before);
    session.apply(Change::Place { ball: 1, at: DVec2::new(-100.0, 90.0) }.into()).unwrap();
    assert_eq!(balls(&session)[1].position(), DVec2::new(10.0, 90.0));
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
fn it_is_told_of_each_frame_whether_a_hand_carried_a_ball_also_where_it_is_played_again() {
    let mut session = session("gravity", Solver::Exact);
    session.advance(0.0).unwrap();
    let carried = [false, true, true, false];
    let frames = |session: &mut Session, parts: u32| {
        let part = |session: &mut Session| {
            session.advance(STEP).unwrap();
            session.is_carrying()
        };
        (0..4 * parts).map(|_| part(session)).collect::<Vec<_>>()
    };
    for carries in carried {
        if carries {
            session.apply(Change::Carry { ball: 3, to: DVec2::new(400.0, 300.0) }.into()).unwrap();
        }
        session.advance(STEP).unwrap();
        assert_eq!(session.is_carrying(), carries);
    }
    for parts in [1, 4] {
        (0..4).for_each(|_| session.apply(Command::Back).unwrap());
        session.set_time_scale(1.0 / f64::from(parts));
        let each = carried.into_iter().flat_map(|carries| (0..parts).map(move |_| carries));
        assert_eq!(frames(&mut session, parts), each.collect::<Vec<_>>(), "in {parts} parts");
    }
    session.apply(Change::Carry { ball: 3, to: DVec2::new(400.0, 300.0) }.into()).unwrap();
    session.advance(STEP).unwrap();
    session.apply(Change::Reset.into()).unwrap();
    assert!(!session.is_carrying());
}
