//! Keys and the mouse on Wayland.

use carom::{DVec2, Scene, Solver};

use super::super::display::BALL;
use super::super::files::{run_replay, states};
use super::*;

#[test]
#[ignore = "needs sway, wtype and grim; run with --ignored"]
fn on_wayland_keys_do_what_they_do_elsewhere() {
    let sway = Sway::start();
    let mut window = sway.open(&["gravity", "--paused"]);
    for (key, part) in [
        ("a", "16 balls"),
        ("shift+a", "116 balls"),
        ("BackSpace", "115 balls"),
        ("s", "gravity · contact · 115 balls · paused"),
        ("bracketleft", "speed 1/2"),
        ("ctrl+Right", "gravity (98, 980) px/s²"),
        ("g", "gravity off"),
        ("8", "gravity · exact · 15 balls"),
        ("shift+Tab", "inelastic"),
        ("Tab", "gravity · exact · 15 balls"),
        ("s", "gravity · contact · 15 balls"),
    ] {
        sway.key(key);
        window.wait_title(part);
    }
    let start = window.saved_balls("gravity", 1);
    let saved = Scene::load(window.folder.path().join("carom-gravity-1.toml").to_str().unwrap()).unwrap();
    assert_eq!(saved.solver(), Solver::Contact);
    assert_eq!(start.len(), 15);
    sway.key("r");
    sway.key("a");
    sway.key("bracketright");
    sway.key("space");
    window.wait_title("fps");
    sway.key("space");
    window.wait_title("paused");
    let shown = window.saved_balls("gravity", 2);
    let (replay, _) = window.saved_replay("gravity", 1);
    let (balls, _) = run_replay(window.folder.path(), "gravity", &replay);
    assert_eq!(balls.len(), 16);
    assert_eq!(balls, states(&shown), "what is shown is what a replay of the keys ends in");
    sway.key("Escape");
    assert!(window.end().success());
}

#[test]
#[ignore = "needs sway, wtype and grim; run with --ignored"]
fn on_wayland_left_runs_time_back_for_as_long_as_it_is_held() {
    let sway = Sway::start();
    let mut window = sway.open(&["elastic"]);
    window.wait_title("fps");
    let mut replays = 1..;
    let mut second = |window: &mut Window<'_>| {
        deltas(&window.saved_replay("elastic", replays.next().unwrap()).1).iter().sum::<f64>() > 1.0
    };
    window.wait("the first second", &mut second);
    let mut left = sway.hold("Left");
    window.wait_title("this is the start");
    assert!(!second(&mut window));
    drop(left.stdin.take());
    left.wait().unwrap();
    window.wait("the first second, again", second);
}

#[test]
#[ignore = "needs sway, wtype and grim; run with --ignored"]
fn on_wayland_the_mouse_adds_throws_carries_takes_away_and_sets_a_radius() {
    let sway = Sway::start();
    let mut window = sway.open(&["two", "--paused"]);
    let before = window.saved_balls("two", 1);
    sway.point(900.0, 300.0);
    sway.click(LEFT);
    window.wait_title("3 balls");
    // Beside the pointer, which is in screenshots.
    window.wait("the ball under the pointer", |window| {
        colour(&window.sway.screenshot(FIRST), 890, 300) == Some(BALL)
    });
    // Thrown: 4 px/s for each px of the line.
    sway.point(600.0, 500.0);
    sway.press();
    sway.point(700.0, 450.0);
    sway.release();
    window.wait_title("4 balls");
    // Carried, by where it was taken.
    sway.point(905.0, 303.0);
    sway.press();
    sway.point(1005.0, 203.0);
    window.wait("the ball where the hand is", |window| {
        colour(&window.sway.screenshot(FIRST), 990, 200) == Some(BALL)
    });
    sway.release();
    // Up is larger, down is smaller.
    for notches in [1, 2, -1] {
        sway.turn_wheel(notches);
    }
    sway.point(300.0, 600.0);
    sway.click(LEFT);
    window.wait_title("5 balls");
    let at = before[0].position();
    sway.point(at.x, at.y);
    sway.click(RIGHT);
    window.wait_title("4 balls");
    let after = window.saved_balls("two", 2);
    assert_eq!(after[0], before[1]);
    let (place, flung) = (DVec2::new(1000.0, 200.0), DVec2::new(600.0, 500.0));
    assert_eq!(states(&after[1..3]), [(place, DVec2::ZERO), (flung, DVec2::new(400.0, -200.0))]);
    assert_eq!(after[3].position(), DVec2::new(300.0, 600.0));
    let notches = (after[3].radius() / after[1].radius()).ln() / 1.1_f64.ln();
    assert!((notches - 2.0).abs() < 1e-9, "{notches}");
}
