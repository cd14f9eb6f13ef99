//! Laws of the application that need no screen.

use winit::event::{ElementState, MouseButton};

use super::super::keys::Action;
use super::super::overlay::Room;
use super::*;
use crate::session::{Change, Command, STEP};

const OPTIONS: Options = Options {
    fullscreen: false,
    paused: false,
    time_scale: 1.0,
    vsync: false,
    timings: None,
    watch: false,
    quiet: false,
    seed: None,
};

/// An application without a screen that has played a scene for two seconds.
fn app(scene: &str) -> App {
    let scene = Scene::load(scene).unwrap();
    let mut session = Session::new(&scene, 1).unwrap();
    for _ in 0..120 {
        session.advance(STEP).unwrap();
    }
    App::new(&scene, &OPTIONS, session)
}

/// Goes back by so little that the session is not done with it.
fn begin_work(app: &mut App) {
    app.session.apply_while(Command::Back, || false).unwrap();
    assert!(app.session.is_working());
}

/// Finishes that, and does what waits.
fn end_work(app: &mut App) {
    app.session.work_while(|| true).unwrap();
    while !app.waiting.is_empty() {
        app.catch_up();
    }
}

/// A key that is down, in a turn of the event loop that has only begun.
fn hold(app: &mut App, action: Action, repeat: bool) {
    app.turn = Turn::begin(Instant::now());
    app.ask(action, repeat);
}

#[test]
fn time_runs_back_no_longer_than_the_key_is_held_however_busy_the_session_was() {
    let mut app = app("gravity");
    hold(&mut app, Action::Rewind, false);
    assert_eq!(app.rewinding, Rewinding::Back);
    begin_work(&mut app);
    for _ in 0..20 {
        hold(&mut app, Action::Rewind, true);
    }
    app.stop_rewinding();
    end_work(&mut app);
    assert_eq!(app.rewinding, Rewinding::No);
    // Pressed while the session is busy, and still held when its turn comes.
    for (released, rewinding) in [(false, Rewinding::Back), (true, Rewinding::No)] {
        begin_work(&mut app);
        hold(&mut app, Action::Rewind, false);
        assert_eq!(app.rewinding, Rewinding::No);
        if released {
            app.lose_focus();
        }
        end_work(&mut app);
        assert_eq!(app.rewinding, rewinding);
        app.stop_rewinding();
    }
}

#[test]
fn a_key_that_is_held_leaves_nothing_to_do_after_it() {
    let mut app = app("gravity");
    begin_work(&mut app);
    let add = Action::Do(Change::AddRandom(1).into());
    hold(&mut app, add, false);
    for _ in 0..20 {
        hold(&mut app, add, true);
    }
    end_work(&mut app);
    assert_eq!(app.session.simulation().balls().len(), 16);
}

#[test]
fn time_that_ran_back_to_the_start_stands_there_until_the_key_is_released() {
    let mut app = app("elastic");
    let size = app.session.simulation().world().size();
    let mut now = Instant::now();
    let mut frame = |app: &mut App| {
        now += Duration::from_millis(50);
        app.advance(now, size).unwrap();
        app.session.simulation().time()
    };
    frame(&mut app);
    hold(&mut app, Action::Rewind, false);
    while frame(&mut app) > 0.0 {}
    for count in 0..20 {
        // Keys repeat less often than frames come.
        if count % 3 == 2 {
            hold(&mut app, Action::Rewind, true);
        }
        assert_eq!(frame(&mut app), 0.0);
    }
    app.stop_rewinding();
    frame(&mut app);
    assert!(frame(&mut app) > 0.0, "time runs on");
}

/// A click of the right button on the ball of this index.
fn right_click(app: &mut App, index: usize) {
    app.turn = Turn::begin(Instant::now());
    app.hands.point_at(app.session.simulation().balls()[index].position());
    app.press(MouseButton::Right, ElementState::Pressed);
}

#[test]
fn right_clicks_take_the_balls_away_that_they_were_on_also_where_they_wait() {
    let mut app = app("gravity");
    begin_work(&mut app);
    for index in [1, 2, 13] {
        right_click(&mut app, index);
    }
    app.session.work_while(|| true).unwrap();
    let mut left = app.session.simulation().balls().to_vec();
    for index in [13, 2, 1] {
        left.remove(index);
    }
    end_work(&mut app);
    assert_eq!(app.session.simulation().balls(), left);
}

#[test]
fn a_ball_that_is_held_and_taken_away_is_not_held() {
    let mut app = app("gravity");
    app.hands.point_at(app.session.simulation().balls()[4].position());
    app.press(MouseButton::Left, ElementState::Pressed);
    assert!(app.hands.are_busy());
    right_click(&mut app, 4);
    assert_eq!(app.session.simulation().balls().len(), 14);
    assert!(!app.hands.are_busy());
}

/// The left button goes down where no ball is, and the pointer moves on.
fn begin_throw(app: &mut App) {
    app.hands.point_at(DVec2::new(900.0, 300.0));
    app.press(MouseButton::Left, ElementState::Pressed);
    app.hands.point_at(DVec2::new(950.0, 300.0));
    assert!(app.hands.are_busy());
}

#[test]
fn a_throw_ends_where_its_release_would_not_be_seen() {
    let mut app = app("draw");
    begin_throw(&mut app);
    app.open_browser();
    app.press(MouseButton::Left, ElementState::Released);
    app.close_browser();
    assert!(!app.hands.are_busy());
    begin_throw(&mut app);
    app.lose_focus();
    assert!(!app.hands.are_busy());
}

#[test]
fn escape_ends_the_program_only_where_nothing_else_is_to_be_left() {
    let mut app = app("draw");
    let now = Instant::now();
    begin_throw(&mut app);
    assert!(!app.leave(now) && !app.hands.are_busy());
    app.help = true;
    assert!(!app.leave(now) && !app.help);
    begin_work(&mut app);
    assert!(!app.leave(now) && !app.session.is_working());
    // It comes just after what it was to stop has ended.
    app.busy = Some(now);
    assert!(!app.leave(now + Duration::from_millis(500)));
    assert!(app.leave(now + Duration::from_secs(1)));
}

#[test]
fn a_click_on_the_help_closes_it_and_adds_no_ball_behind_it() {
    let mut app = app("draw");
    app.help = true;
    app.hands.point_at(DVec2::new(900.0, 300.0));
    for state in [ElementState::Pressed, ElementState::Released] {
        app.press(MouseButton::Left, state);
    }
    assert!(!app.help);
    assert_eq!(app.session.simulation().balls().len(), 1);
}

#[test]
fn what_the_hand_is_on_or_holds_is_not_drawn_over_the_help_or_the_list_of_scenes() {
    let mut app = app("gravity");
    let ball = app.session.simulation().balls()[4].position();
    let room = Room { picture: app.session.simulation().world().size(), scale: 1.0 };
    for begin in [|_: &mut App| {}, |app: &mut App| app.press(MouseButton::Left, ElementState::Pressed)] {
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
fn to_watch_a_scene_without_a_file_is_told_to_do_nothing() {
    let scene = Scene::load("draw").unwrap();
    for watch in [false, true] {
        let options = Options { watch, ..OPTIONS };
        let app = App::new(&scene, &options, Session::new(&scene, 1).unwrap());
        let message = app.messages.shown(Instant::now()).unwrap();
        assert_eq!(message.text.contains("built in"), watch, "{}", message.text);
    }
}
