//! Laws of the application that need no screen; here, what they are shown on.

mod dropped;
mod held_keys;
mod mouse;
mod seen;
mod watched;

use std::path::{Path, PathBuf};

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

/// Looks at the file that is watched until what was saved is told.
fn look(app: &mut App) {
    for _ in 0..3 {
        let now = app.watch.as_ref().unwrap().next_poll();
        app.look_at_file(now);
    }
}

fn count(app: &App) -> usize {
    app.session.simulation().balls().len()
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

/// The left button goes down where no ball is, and the pointer moves on.
fn begin_throw(app: &mut App) {
    app.hands.point_at(DVec2::new(900.0, 300.0));
    press(app, MouseButton::Left, ElementState::Pressed);
    app.hands.point_at(DVec2::new(950.0, 300.0));
    assert!(app.hands.are_busy());
}
