//! Laws of the application that need no screen.

use std::path::Path;

use winit::dpi::PhysicalPosition;
use winit::event::{ElementState, MouseButton, MouseScrollDelta};
use winit::keyboard::{Key, NamedKey};

use super::super::keys::{self, Action, Stroke};
use super::super::overlay::Room;
use super::super::waiting::Input;
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

/// A turn of the event loop that has only begun, however slow the machine is.
fn begin_turn(app: &mut App) {
    app.turn = Turn::begin(Instant::now() + Duration::from_secs(60));
}

/// A turn in which there is no time for anything more.
fn end_turn(app: &mut App) {
    app.turn = Turn::begin(Instant::now().checked_sub(Duration::from_secs(1)).unwrap());
}

/// A key that is down, in a turn of the event loop that has only begun.
fn hold(app: &mut App, action: Action, repeat: bool) {
    begin_turn(app);
    app.ask(Input::Key(Stroke { action: Some(action), choice: None }), repeat);
}

/// A key that is pressed, whatever it is for.
fn strike(app: &mut App, key: &Key) {
    app.ask(Input::Key(keys::stroke(key, ModifiersState::empty(), false).unwrap()), false);
}

fn letter(text: &str) -> Key {
    Key::Character(text.into())
}

/// A button goes down or up, in a turn that has only begun.
fn press(app: &mut App, button: MouseButton, state: ElementState) {
    begin_turn(app);
    app.press(button, state);
}

fn count(app: &App) -> usize {
    app.session.simulation().balls().len()
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
    app.hands.point_at(app.session.simulation().balls()[index].position());
    press(app, MouseButton::Right, ElementState::Pressed);
}

/// A click of the left button where the pointer is.
fn click(app: &mut App) {
    for state in [ElementState::Pressed, ElementState::Released] {
        press(app, MouseButton::Left, state);
    }
}

/// The list of scenes, opened and laid out.
fn open_list(app: &mut App) {
    app.open_browser();
    let room = Room { picture: DVec2::new(1280.0, 720.0), scale: 1.0 };
    app.browser.as_mut().unwrap().lay_out(room);
}

#[test]
fn after_the_list_of_scenes_was_closed_the_mouse_acts_where_the_pointer_is() {
    let mut app = app("draw");
    app.point_at(PhysicalPosition::new(200.0, 600.0));
    open_list(&mut app);
    app.point_at(PhysicalPosition::new(900.0, 300.0));
    app.close_browser();
    click(&mut app);
    assert_eq!(app.session.simulation().balls()[1].position(), DVec2::new(900.0, 300.0));
}

#[test]
fn a_double_click_on_a_card_plays_its_scene_and_adds_no_ball() {
    let mut app = app("draw");
    open_list(&mut app);
    // On the second card.
    app.point_at(PhysicalPosition::new(350.0, 150.0));
    click(&mut app);
    assert_eq!((app.session.name(), app.browser.is_some()), ("move", false));
    click(&mut app);
    assert_eq!(count(&app), 1);
    app.clicked = Instant::now().checked_sub(Duration::from_secs(1));
    click(&mut app);
    assert_eq!(count(&app), 2, "a click that is none of both");
}

#[test]
fn what_comes_after_the_list_of_scenes_was_asked_for_is_for_the_list_also_where_both_wait() {
    for waits in [false, true] {
        let open = |keys: &[Key]| {
            let mut app = app("draw");
            begin_turn(&mut app);
            if waits {
                end_turn(&mut app);
            }
            for key in keys {
                strike(&mut app, key);
            }
            assert_eq!(app.waiting.is_empty(), !waits);
            end_work(&mut app);
            (app.session.name().to_owned(), count(&app), app.browser.is_some())
        };
        let (m, a, r) = (letter("m"), letter("a"), letter("r"));
        let (right, enter) = (Key::Named(NamedKey::ArrowRight), Key::Named(NamedKey::Enter));
        let is = |scene: &str, balls, open| (scene.to_owned(), balls, open);
        assert_eq!(open(&[m.clone(), a.clone(), a.clone()]), is("draw", 1, true));
        assert_eq!(open(&[a.clone(), m.clone(), r]), is("draw", 2, true));
        assert_eq!(open(&[m.clone(), m.clone(), a]), is("draw", 2, false));
        let next = [m, right, enter];
        assert_eq!(open(&next), is("move", 1, false));
        assert_eq!(open(&[next.clone(), next].concat()), is("two", 2, false));
    }
}

#[test]
fn a_click_that_waits_is_for_what_is_open_when_its_turn_comes() {
    let mut app = app("draw");
    app.hands.point_at(DVec2::new(900.0, 300.0));
    begin_work(&mut app);
    strike(&mut app, &letter("m"));
    click(&mut app);
    end_work(&mut app);
    assert!(app.browser.is_some() && !app.hands.are_busy());
    assert_eq!(count(&app), 1);
}

#[test]
fn a_click_that_waits_is_where_the_pointer_was_and_as_large_as_the_wheel_had_said() {
    let mut app = app("draw");
    let [first, second] = [300.0, 500.0].map(|y| DVec2::new(900.0, y));
    begin_work(&mut app);
    app.hands.point_at(first);
    click(&mut app);
    app.turn_wheel(MouseScrollDelta::LineDelta(0.0, 1.0));
    app.hands.point_at(second);
    click(&mut app);
    app.hands.point_at(DVec2::ZERO);
    end_work(&mut app);
    let places: Vec<_> = app.session.simulation().balls()[1..]
        .iter()
        .map(|ball| (ball.position(), ball.radius().round()))
        .collect();
    assert_eq!(places, [(first, 20.0), (second, 22.0)]);
}

#[test]
fn a_wheel_that_turns_sideways_does_nothing() {
    let mut app = app("draw");
    let before = app.messages.shown(Instant::now()).unwrap().text;
    for delta in [
        MouseScrollDelta::LineDelta(1.0, 0.0),
        MouseScrollDelta::PixelDelta(PhysicalPosition::new(30.0, -0.0)),
    ] {
        begin_turn(&mut app);
        app.turn_wheel(delta);
        assert_eq!(app.messages.shown(Instant::now()).unwrap().text, before);
    }
}

#[test]
fn escape_waits_for_nothing_and_what_waits_before_it_is_forgotten() {
    let mut app = app("draw");
    for open in [false, true] {
        begin_turn(&mut app);
        if open {
            strike(&mut app, &letter("m"));
        }
        end_turn(&mut app);
        for key in [letter("m"), Key::Named(NamedKey::Enter), letter("a")] {
            strike(&mut app, &key);
        }
        assert!(!app.leave(Instant::now()));
        assert!(app.waiting.is_empty() && app.browser.is_none());
    }
    assert_eq!(count(&app), 1);
}

#[test]
fn what_was_dropped_with_the_focus_is_not_taken_by_a_press_before_it() {
    let mut app = app("draw");
    begin_work(&mut app);
    app.hands.point_at(DVec2::new(900.0, 300.0));
    app.press(MouseButton::Left, ElementState::Pressed);
    app.lose_focus();
    end_work(&mut app);
    assert!(!app.hands.are_busy());
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
    press(&mut app, MouseButton::Left, ElementState::Pressed);
    assert!(app.hands.are_busy());
    right_click(&mut app, 4);
    assert_eq!(app.session.simulation().balls().len(), 14);
    assert!(!app.hands.are_busy());
}

/// The left button goes down where no ball is, and the pointer moves on.
fn begin_throw(app: &mut App) {
    app.hands.point_at(DVec2::new(900.0, 300.0));
    press(app, MouseButton::Left, ElementState::Pressed);
    app.hands.point_at(DVec2::new(950.0, 300.0));
    assert!(app.hands.are_busy());
}

#[test]
fn a_ball_that_is_held_goes_where_it_is_let_go_also_where_no_frame_came_since_it_was_taken() {
    for (paused, speed) in [(true, 0.0), (false, 3000.0)] {
        let mut app = app("draw");
        if paused {
            app.session.apply(Command::TogglePause).unwrap();
        }
        let from = app.session.simulation().balls()[0].position();
        let to = from + DVec2::new(100.0, 0.0);
        app.point_at(PhysicalPosition::new(from.x, from.y));
        press(&mut app, MouseButton::Left, ElementState::Pressed);
        app.point_at(PhysicalPosition::new(to.x, to.y));
        press(&mut app, MouseButton::Left, ElementState::Released);
        let ball = app.session.simulation().balls()[0];
        let place = if paused { to } else { from };
        assert!(ball.position().distance(place) < 1e-9, "{}", ball.position());
        assert!((ball.velocity().length() - speed).abs() < 1e-6, "{}", ball.velocity());
    }
}

#[test]
fn a_throw_ends_where_its_release_would_not_be_seen() {
    let mut app = app("draw");
    begin_throw(&mut app);
    app.open_browser();
    press(&mut app, MouseButton::Left, ElementState::Released);
    app.close_browser();
    assert!(!app.hands.are_busy());
    begin_throw(&mut app);
    hold(&mut app, Action::ToggleHelp, false);
    press(&mut app, MouseButton::Left, ElementState::Released);
    assert_eq!(count(&app), 1);
    assert!(app.help);
    assert!(!app.leave(Instant::now()));
    assert!(!app.help, "there is nothing else to be left first");
    begin_throw(&mut app);
    end_turn(&mut app);
    app.lose_focus();
    assert!(!app.hands.are_busy() && !app.is_busy());
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
    click(&mut app);
    assert!(!app.help);
    assert_eq!(app.session.simulation().balls().len(), 1);
}

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
        let [mut one, mut other] = ["elastic", "draw"].map(app);
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

/// The text of a scene of so many balls.
fn text(balls: u32) -> String {
    let ball = |index| format!("[[ball]]\nposition = [{}, 200]\nradius = 10\n", 50 + 40 * index);
    (0..balls).map(ball).collect()
}

/// An application that watches this file, in which a ball is.
fn watching(path: &Path) -> App {
    std::fs::write(path, text(1)).unwrap();
    let scene = Scene::load(path.to_str().unwrap()).unwrap();
    let options = Options { watch: true, ..OPTIONS };
    App::new(&scene, &options, Session::new(&scene, 1).unwrap())
}

/// Looks at the file until what was saved is told.
fn look(app: &mut App) {
    for _ in 0..3 {
        let now = app.watch.as_ref().unwrap().next_poll();
        app.look_at_file(now);
    }
}

#[test]
fn a_file_that_is_saved_while_the_list_of_scenes_is_open_is_what_its_card_plays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    let mut app = watching(&path);
    open_list(&mut app);
    std::fs::write(&path, text(2)).unwrap();
    look(&mut app);
    app.open_selected();
    assert_eq!(count(&app), 2);
    // Saved after the last look: told after the choice.
    open_list(&mut app);
    std::fs::write(&path, text(3)).unwrap();
    app.open_selected();
    look(&mut app);
    assert_eq!(count(&app), 3);
}

#[test]
fn a_built_in_scene_ends_the_watch_however_it_is_chosen() {
    let folder = tempfile::tempdir().unwrap();
    for command in [Command::Scene(1), Command::NextScene, Command::PreviousScene] {
        let mut app = watching(&folder.path().join("mine.toml"));
        hold(&mut app, Action::Do(Command::Step), false);
        assert!(app.watch.is_some());
        hold(&mut app, Action::Do(command), false);
        assert!(app.watch.is_none(), "{command:?}");
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
