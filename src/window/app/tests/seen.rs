//! What is seen over the balls, and saved with them.

use super::super::super::overlay::Sheet;
use super::*;
use crate::simulation::Solver;

#[test]
fn what_the_hand_is_on_or_holds_is_not_drawn_over_the_help_or_the_list_of_scenes() {
    let mut app = app("gravity");
    let ball = app.session.simulation().balls()[4].position();
    let room = Room { picture: app.session.simulation().world().size(), scale: 1.0 };
    for begin in [|_: &mut App| {}, |app: &mut App| press(app, MouseButton::Left, ElementState::Pressed)] {
        for action in [Action::ToggleHelp, Action::ToggleBrowser] {
            app.hands.point_at(ball);
            app.pointed = Some(Instant::now());
            begin(&mut app);
            let shown = |app: &mut App| app.overlay(room, 0.0, Instant::now()).hand.is_some();
            assert!(shown(&mut app));
            hold(&mut app, action, false);
            assert!(!shown(&mut app), "{action:?}");
            app.help = false;
            app.close_browser();
            app.hands.drop_all();
        }
    }
}

/// The picture that is saved now.
fn saved(app: &mut App) -> Vec<u8> {
    let room = Room { picture: app.session.simulation().world().size(), scale: 1.0 };
    app.picture_in(room, Instant::now()).unwrap().take()
}

#[test]
fn a_picture_saved_in_the_same_instant_as_another_key_shows_what_that_key_has_done() {
    let press = |app: &mut App, action: Action| hold(app, action, false);
    let (reset, draw) = (Action::Do(Change::Reset.into()), Action::Do(Command::Scene(0)));
    for over in [Action::ToggleFigures, Action::Do(Command::ToggleComparison), Action::ToggleTrails] {
        let [mut one, mut other] = ["detect", "draw"].map(app);
        for app in [&mut one, &mut other] {
            press(app, over);
            saved(app);
            app.session.advance(STEP).unwrap();
            saved(app);
        }
        press(&mut one, draw);
        press(&mut other, reset);
        assert!(saved(&mut one) == saved(&mut other), "{over:?}");
    }
    // Two of its balls touch from the start.
    let [mut at_once, mut shown] = ["elastic"; 2].map(app);
    for app in [&mut at_once, &mut shown] {
        press(app, reset);
    }
    shown.session.advance(0.0).unwrap();
    assert!(saved(&mut at_once) == saved(&mut shown));
    let mut app = app("draw");
    let closed = saved(&mut app);
    press(&mut app, Action::ToggleBrowser);
    assert!(saved(&mut app) != closed);
    app.leave(Instant::now());
    assert!(saved(&mut app) == closed, "the list of scenes was left");
}

#[test]
fn it_is_said_that_time_runs_slower_where_frames_are_cut_short_and_not_where_they_are_only_long() {
    let room = Room { picture: DVec2::new(1280.0, 720.0), scale: 1.0 };
    for present in [Duration::ZERO, Duration::from_millis(70), Duration::from_millis(400)] {
        let sheet = |cut: bool| {
            let mut app = app("pile");
            app.split = [Duration::from_millis(25), Duration::ZERO, present];
            for _ in 0..20 {
                app.session.advance_while(present.as_secs_f64().max(STEP), || !cut).unwrap();
            }
            app.overlay(room, 0.0, Instant::now()).sheet
        };
        assert_eq!(sheet(false), None, "{present:?}");
        assert_eq!(sheet(true), Some(Sheet::Behind(Solver::Contact)), "{present:?}");
    }
}

#[test]
fn that_time_stands_still_is_said_for_as_long_as_it_does_and_in_no_picture() {
    let room = Room { picture: DVec2::new(1280.0, 720.0), scale: 1.0 };
    let mut app = app("gravity");
    let picture = saved(&mut app);
    for paused in [true, false] {
        hold(&mut app, Action::Do(Command::TogglePause), false);
        let hour = Instant::now() + Duration::from_secs(3600);
        assert_eq!(app.overlay(room, 0.0, hour).paused, paused);
        assert!(saved(&mut app) == picture, "{paused}");
    }
    hold(&mut app, Action::Do(Command::TogglePause), false);
    open_list(&mut app);
    assert!(!app.overlay(room, 0.0, Instant::now()).paused, "the list of scenes covers what stands still");
    app.close_browser();
    app.options.quiet = true;
    assert!(!app.overlay(room, 0.0, Instant::now()).paused);
}

#[test]
fn walls_inside_of_the_picture_are_seen() {
    let mut app = app("gravity");
    let size = app.session.simulation().world().size();
    let mut edge = |picture: DVec2| {
        let room = Room { picture, scale: 1.0 };
        app.overlay(room, 0.0, Instant::now()).edge
    };
    assert_eq!(edge(size), None);
    assert_eq!(edge(size + DVec2::new(100.0, 0.0)), Some(size));
    assert_eq!(edge(size - DVec2::new(100.0, 0.0)), None);
}

#[test]
fn the_hint_goes_where_what_it_hints_at_is_seen() {
    for action in [Action::ToggleHelp, Action::ToggleBrowser] {
        let mut app = app("draw");
        assert!(app.messages.shown(Instant::now()).is_some());
        hold(&mut app, action, false);
        assert!(app.messages.shown(Instant::now()).is_none());
    }
}

#[test]
fn while_a_hand_carries_a_ball_nothing_is_said_of_what_impacts_take() {
    let mut app = app("gravity");
    hold(&mut app, Action::ToggleFigures, false);
    let size = app.session.simulation().world().size();
    let mut now = Instant::now();
    let mut change = |app: &mut App| {
        now += Duration::from_secs_f64(STEP);
        app.advance(now, size).unwrap();
        // So long that figures are taken anew.
        app.overlay(Room { picture: size, scale: 1.0 }, 1.0, now);
        app.gauge.as_ref().unwrap().change()
    };
    assert!(change(&mut app).unwrap() < -0.01, "impacts have taken some");
    app.hands.point_at(app.session.simulation().balls()[4].position());
    press(&mut app, MouseButton::Left, ElementState::Pressed);
    for _ in 0..20 {
        app.hands.point_at(app.hands.pointer().unwrap() - DVec2::new(3.0, 5.0));
        assert_eq!(change(&mut app), None);
    }
    press(&mut app, MouseButton::Left, ElementState::Released);
    assert!(change(&mut app).is_some());
}
