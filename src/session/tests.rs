//! Laws of a session that need to look inside of it.

use super::*;
use crate::simulation::Solver;
use crate::simulation::limits::GRAVITY;

const EARTH: DVec2 = DVec2::new(0.0, 980.0);

fn session(scene: &str) -> Session {
    let mut session = Session::new(&Scene::load(scene).unwrap(), 1).unwrap();
    session.advance(0.5).unwrap();
    session
}

fn positions(session: &Session) -> Vec<DVec2> {
    session.simulation().balls().iter().map(Ball::position).collect()
}

#[test]
fn the_first_frame_takes_no_time_even_while_paused() {
    let mut session = Session::new(&Scene::load("gravity").unwrap(), 1).unwrap();
    session.apply(Command::TogglePause).unwrap();
    session.advance(0.5).unwrap();
    assert_eq!(session.simulation().time(), 0.0);
    assert!(session.simulation().touching()[1] && session.simulation().touching()[12]);
    session.advance(0.5).unwrap();
    assert_eq!(session.simulation().time(), 0.0);
}

#[test]
fn a_hitch_advances_no_more_than_the_longest_frame() {
    let mut session = session("gravity");
    session.advance(3600.0).unwrap();
    assert_eq!(session.simulation().time(), LONGEST_FRAME);
    session.apply(Command::Slower).unwrap();
    session.advance(0.01).unwrap();
    assert_eq!(session.simulation().time(), LONGEST_FRAME + 0.005);
}

#[test]
fn from_any_time_scale_slower_and_faster_come_by_1() {
    let mut session = session("draw");
    for begun in [0.3, 1.0 / 3.0, 0.5, 0.99, 1.01, 1.5, 2.0, 7.0] {
        session.set_time_scale(begun);
        let towards = if begun < 1.0 { Command::Faster } else { Command::Slower };
        let came_by = (0..5).any(|_| {
            session.apply(towards).unwrap();
            session.time_scale() == 1.0
        });
        assert!(came_by, "{begun}");
        for (command, scale) in [(Command::Faster, 2.0), (Command::Slower, 1.0), (Command::Slower, 0.5)] {
            session.apply(command).unwrap();
            assert_eq!(session.time_scale(), scale, "from {begun}");
        }
    }
}

#[test]
fn steps_are_taken_only_while_paused_each_as_a_frame_of_its_own() {
    let mut session = session("gravity");
    session.apply(Command::Step).unwrap();
    assert!(session.steps.is_empty() && session.simulation().time() == 0.0);
    let mut stepped = Scene::load("gravity").unwrap().build().unwrap();
    for seconds in [0.0, STEP, STEP] {
        stepped.advance(seconds).unwrap();
    }
    session.apply(Command::TogglePause).unwrap();
    assert!(!session.is_moving());
    for _ in 0..2 {
        session.apply(Command::Step).unwrap();
    }
    assert!(session.is_moving());
    session.advance(0.5).unwrap();
    assert!(!session.is_moving());
    assert_eq!(session.simulation().time(), 2.0 * STEP);
    assert_eq!(session.simulation().balls(), stepped.balls());
    session.apply(Command::Step).unwrap();
    for _ in 0..2 {
        session.apply(Command::TogglePause).unwrap();
    }
    assert!(!session.is_moving(), "to let time run and stop it again forgets steps");
}

#[test]
fn what_was_behind_is_not_when_something_else_is_played() {
    for command in
        [Command::Change(Change::Reset), Command::NextSolver, Command::NextScene, Command::Scene(3)]
    {
        let mut session = session("gravity");
        (0..3).for_each(|_| session.pace.note(0.1, 0.1, 0.05));
        assert!(session.is_behind());
        session.apply(command).unwrap();
        assert!(!session.is_behind(), "{command:?}");
    }
}

#[test]
fn canvas_always_finishes_and_is_never_behind() {
    let mut session = session("gravity");
    session.apply(Command::Change(Change::Solver(Solver::Canvas))).unwrap();
    let mut asked = 0;
    session
        .advance_while(0.1, || {
            asked += 1;
            false
        })
        .unwrap();
    assert_eq!((asked, session.is_behind(), session.simulation().time()), (0, false, 0.1));
}

#[test]
fn time_that_was_not_simulated_is_not_gone_back_and_not_played_again() {
    let mut session = session("pile");
    for _ in 0..4 {
        let mut looks = 0;
        session
            .advance_while(0.1, || {
                looks += 1;
                looks < 2
            })
            .unwrap();
    }
    let time = session.simulation().time();
    assert!(session.is_behind() && time < 0.3, "{time}");
    while session.rewind(LONGEST_FRAME) {}
    assert_eq!(session.simulation().time(), 0.0);
    assert!((session.seconds_ago() - time).abs() < 1e-9, "{} is not {time}", session.seconds_ago());
    // In as much time as it is, all of it.
    let mut left = time;
    while left > 0.0 {
        session.advance(left.min(LONGEST_FRAME)).unwrap();
        left -= LONGEST_FRAME;
    }
    assert!(!session.is_in_the_past(), "{} s are left", session.seconds_ago());
}

#[test]
fn reset_restores_the_scene_in_the_window_as_it_is() {
    let mut session = session("gravity");
    let start = positions(&session);
    for command in [
        Command::Change(Change::AddRandom(3)),
        Command::Change(Change::ToggleGravity),
        Command::Change(Change::RemoveLast),
    ] {
        session.apply(command).unwrap();
    }
    session.advance(0.1).unwrap();
    assert_ne!(positions(&session), start);
    session.apply(Command::Change(Change::Reset)).unwrap();
    session.advance(0.1).unwrap();
    assert_eq!(positions(&session), start);
    assert_eq!(session.simulation().world().gravity(), Some(EARTH));

    session.resize(DVec2::new(400.0, 300.0)).unwrap();
    session.apply(Command::Change(Change::Reset)).unwrap();
    assert_eq!(session.simulation().world().size(), DVec2::new(400.0, 300.0));
    assert!(positions(&session).iter().all(|p| p.cmplt(DVec2::new(400.0, 300.0)).all()));
}

#[test]
fn added_balls_are_others_each_time_and_overlap_nothing() {
    let mut session = session("elastic");
    session.apply(Command::Change(Change::AddRandom(1))).unwrap();
    session.apply(Command::Change(Change::AddRandom(1))).unwrap();
    let balls = session.simulation().balls();
    assert_eq!(balls.len(), 17);
    assert_ne!(balls[15], balls[16]);
    assert_eq!(balls[16].restitution(), 1.0, "in an elastic scene, added balls are elastic");
    let mut grid = crate::simulation::grid::Grid::new(balls, session.simulation().world().size());
    assert!(crate::simulation::invariants::max_overlap(&mut grid, balls) < 1e-9);
}

#[test]
fn a_clicked_ball_fits_its_place_or_is_refused() {
    let mut session = session("gravity");
    let add =
        |position| Change::AddBall { position, velocity: DVec2::new(5.0, 6.0), radius: CLICK_RADIUS }.into();
    session.apply(add(DVec2::new(1000.0, 500.0))).unwrap();
    let ball = *session.simulation().balls().last().unwrap();
    assert_eq!((ball.radius(), ball.velocity()), (CLICK_RADIUS, DVec2::new(5.0, 6.0)));
    session.apply(add(DVec2::new(1275.0, 500.0))).unwrap();
    assert_eq!(session.simulation().balls().last().unwrap().radius(), 5.0);
    assert!(matches!(session.apply(add(DVec2::new(120.0, 100.0))), Err(CommandError::NoRoomHere)));
    assert!(matches!(session.apply(add(DVec2::new(-50.0, 100.0))), Err(CommandError::NoRoomHere)));
    assert!(session.apply(add(DVec2::splat(f64::NAN))).is_err());
    assert_eq!(session.simulation().balls().len(), 17);
}

#[test]
fn scenes_go_round_and_keep_the_windows_size() {
    let mut session = session("gravity");
    session.resize(DVec2::new(900.0, 500.0)).unwrap();
    session.apply(Command::NextScene).unwrap();
    assert_eq!(session.name(), scene::names()[scene::STAGES % scene::names().len()]);
    session.apply(Command::PreviousScene).unwrap();
    assert_eq!(session.name(), "gravity");
    for number in 0..scene::names().len() {
        session.apply(Command::Scene(number)).unwrap();
        assert_eq!(session.name(), scene::names()[number]);
        assert_eq!(session.simulation().world().size(), DVec2::new(900.0, 500.0));
    }
    session.apply(Command::Scene(99)).unwrap();
}

#[test]
fn a_file_of_ones_own_is_no_built_in_scene_whatever_its_name() {
    let mine = "[[ball]]\nposition = [50, 50]\nradius = 9\n";
    let names = scene::names();
    for (command, name) in [(Command::NextScene, names[0]), (Command::PreviousScene, names[names.len() - 1])]
    {
        let scene = Scene::parse("gravity.toml", mine).unwrap();
        let mut session = Session::new(&scene, 1).unwrap();
        session.apply(command).unwrap();
        assert_eq!(session.name(), name);
    }
}

#[test]
fn a_ball_is_carried_to_no_place_that_is_none() {
    let mut session = session("gravity");
    let before = session.simulation().balls().to_vec();
    for to in [DVec2::splat(f64::NAN), DVec2::new(5.0, f64::NAN), DVec2::new(f64::INFINITY, 5.0)] {
        let refused = session.apply(Change::Carry { ball: 2, to }.into());
        assert!(matches!(refused, Err(CommandError::OutOfRange(_))), "{to}: {refused:?}");
        assert_eq!(session.simulation().balls(), before);
    }
}

#[test]
fn gravity_comes_back_as_it_was() {
    let mut session = session("gravity");
    session.apply(Command::Change(Change::ToggleGravity)).unwrap();
    assert_eq!(session.simulation().world().gravity(), None);
    session.apply(Command::Change(Change::ToggleGravity)).unwrap();
    assert_eq!(session.simulation().world().gravity(), Some(EARTH));
}

#[test]
fn gravity_is_tilted_in_clean_steps_from_none_and_back_to_none() {
    let mut session = session("gravity");
    let right = Command::Change(Change::TiltGravity(DVec2::new(98.0, 0.0)));
    let up = Command::Change(Change::TiltGravity(DVec2::new(0.0, -98.0)));
    session.apply(right).unwrap();
    assert_eq!(session.simulation().world().gravity(), Some(DVec2::new(98.0, 980.0)));
    // G brings back what was tilted, and a tilt while it is off begins from none.
    session.apply(Command::Change(Change::ToggleGravity)).unwrap();
    session.apply(Command::Change(Change::ToggleGravity)).unwrap();
    assert_eq!(session.simulation().world().gravity(), Some(DVec2::new(98.0, 980.0)));
    session.apply(Command::Change(Change::ToggleGravity)).unwrap();
    session.apply(right).unwrap();
    assert_eq!(session.simulation().world().gravity(), Some(DVec2::new(98.0, 0.0)));

    session.apply(Command::Change(Change::Reset)).unwrap();
    for _ in 0..10 {
        session.apply(up).unwrap();
    }
    assert_eq!(session.simulation().world().gravity(), None);
    session.apply(up).unwrap();
    assert_eq!(session.simulation().world().gravity(), Some(DVec2::new(0.0, -98.0)));

    session.state.simulation.set_gravity(DVec2::new(0.1, 9.81)).unwrap();
    let (there, back) = (DVec2::new(98.0, -98.0), DVec2::new(-98.0, 98.0));
    for by in [[there; 100], [back; 100]].concat() {
        session.apply(Change::TiltGravity(by).into()).unwrap();
    }
    assert_eq!(session.simulation().world().gravity(), Some(DVec2::new(0.1, 9.81)));
}

#[test]
fn gravity_is_tilted_no_further_than_its_range() {
    let mut session = session("gravity");
    for _ in 0..3 {
        session.apply(Change::TiltGravity(DVec2::new(GRAVITY.low, GRAVITY.high)).into()).unwrap();
    }
    assert_eq!(session.simulation().world().gravity(), Some(DVec2::new(GRAVITY.low, GRAVITY.high)));
    assert!(session.apply(Change::TiltGravity(DVec2::new(f64::NAN, 0.0)).into()).is_err());
    assert_eq!(session.simulation().world().gravity(), Some(DVec2::new(GRAVITY.low, GRAVITY.high)));
}

#[test]
fn frames_in_which_time_stood_still_are_gone_back_at_once() {
    let mut session = session("elastic");
    (0..200).for_each(|_| session.advance(STEP).unwrap());
    let stood = session.simulation().time();
    (0..300).for_each(|_| session.advance(0.0).unwrap());
    let mut looks = 0;
    session.rewind_while(STEP, || {
        looks += 1;
        true
    });
    assert!((stood - session.simulation().time() - STEP).abs() < 1e-9, "{}", session.seconds_ago());
    // From the key before, and not from one to another of the frames that stood.
    assert!(looks < 70, "{looks} frames were played again");
}

#[test]
fn time_runs_on_at_once_after_a_rewind_that_did_not_keep_up() {
    for scale in [1.0 / 64.0, 1.0, 16.0] {
        let mut session = session("elastic");
        session.set_time_scale(16.0);
        (0..60).for_each(|_| session.advance(STEP).unwrap());
        // There is time for hardly more than a frame of those that were played in each.
        while session.seconds_ago() < 10.0 {
            let mut looks = 0;
            session.rewind_while(LONGEST_FRAME, || {
                looks += 1;
                looks < 2
            });
        }
        let ago = session.seconds_ago();
        session.set_time_scale(scale);
        session.advance(STEP).unwrap();
        assert!(session.seconds_ago() < ago, "at {scale}, time stands still");
    }
}

#[test]
fn what_there_was_no_time_to_go_back_is_not_gone_back_later() {
    let mut session = session("elastic");
    (0..600).for_each(|_| session.advance(STEP).unwrap());
    while session.seconds_ago() < 1.0 {
        let mut looks = 0;
        session.rewind_while(LONGEST_FRAME, || {
            looks += 1;
            looks < 2
        });
    }
    let ago = session.seconds_ago();
    session.rewind(STEP);
    assert!(session.seconds_ago() - ago < 3.0 * STEP, "{} s more", session.seconds_ago() - ago);
}

#[test]
fn slow_motion_in_the_past_shows_states_between_the_frames_and_comes_to_the_same_bits() {
    for (scene, solver) in [
        ("gravity", Solver::Exact),
        ("gravity", Solver::Contact),
        ("pile", Solver::Contact),
        ("rain", Solver::Contact),
    ] {
        let scene = Scene::load(scene).unwrap().with_solver(solver);
        let mut session = Session::new(&scene, 1).unwrap();
        (0..40).for_each(|_| session.advance(STEP).unwrap());
        let (end, replay) = (session.simulation().balls().to_vec(), session.replay());
        (0..10).for_each(|_| assert!(session.rewind(STEP)));
        session.set_time_scale(1.0 / 8.0);
        let (mut frames, mut before) = (0, session.simulation().time());
        while session.is_in_the_past() || session.between.is_some() {
            session.advance(STEP).unwrap();
            let time = session.simulation().time();
            assert!((time - before - STEP / 8.0).abs() < 1e-9, "{solver}: from {before} s to {time} s");
            (frames, before) = (frames + 1, time);
        }
        assert_eq!(frames, 80, "{solver}");
        assert_eq!(session.simulation().balls(), end, "{solver}");
        assert_eq!(session.replay(), replay, "{solver}");
    }
}

#[test]
fn what_is_shown_between_two_frames_is_where_the_balls_were() {
    let scene = Scene::load("gravity").unwrap();
    let mut session = Session::new(&scene, 1).unwrap();
    (0..40).for_each(|_| session.advance(STEP).unwrap());
    (0..10).for_each(|_| assert!(session.rewind(STEP)));
    session.set_time_scale(1.0 / 64.0);
    (0..100).for_each(|_| session.advance(STEP).unwrap());
    // Paused, it stays where it is, until a step goes on to the end of the frame.
    session.apply(Command::TogglePause).unwrap();
    session.advance(STEP).unwrap();
    let mut same = scene.build().unwrap();
    same.advance(session.simulation().time()).unwrap();
    for (ball, expected) in session.simulation().balls().iter().zip(same.balls()) {
        assert!(ball.position().distance(expected.position()) < 1e-6, "{ball:?} is not {expected:?}");
    }
    let balls = session.state.simulation.balls().to_vec();
    assert_ne!(session.simulation().balls(), balls);
    session.apply(Command::Step).unwrap();
    session.advance(0.0).unwrap();
    assert_eq!(session.simulation().balls(), balls);
    assert!(session.is_in_the_past());
}

#[test]
fn what_is_done_between_two_frames_is_done_to_the_end_of_the_frame() {
    let mut session = session("gravity");
    (0..40).for_each(|_| session.advance(STEP).unwrap());
    (0..10).for_each(|_| assert!(session.rewind(STEP)));
    session.set_time_scale(1.0 / 64.0);
    session.advance(STEP).unwrap();
    let time = session.state.simulation.time();
    assert!(session.simulation().time() < time);
    session.apply(Change::RemoveLast.into()).unwrap();
    assert_eq!(session.simulation().time(), time);
    assert_eq!(session.seconds_ago(), 0.0);
}

#[test]
fn a_rewind_begins_with_what_is_shown_also_between_two_frames() {
    let mut session = session("gravity");
    (0..40).for_each(|_| session.advance(STEP).unwrap());
    (0..10).for_each(|_| assert!(session.rewind(STEP)));
    let ago = session.seconds_ago();
    session.set_time_scale(1.0 / 64.0);
    (0..16).for_each(|_| session.advance(STEP).unwrap());
    assert!((ago - session.seconds_ago() - STEP / 4.0).abs() < 1e-9, "{ago} s, {} s", session.seconds_ago());
    // To the start of the frame, a quarter of it, and no further until that has passed.
    (0..15).for_each(|_| assert!(session.rewind(STEP)));
    assert!((session.seconds_ago() - ago).abs() < 1e-9, "{} s", session.seconds_ago());
    (0..2).for_each(|_| assert!(session.rewind(STEP)));
    assert!((session.seconds_ago() - ago - STEP).abs() < 1e-9, "{} s", session.seconds_ago());
}
