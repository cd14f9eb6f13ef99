//! What is painted and presented, and when it is not.

use std::thread::sleep;
use std::time::Duration;

use super::display::*;

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn the_first_picture_is_the_demos_byte_for_byte() {
    let display = Display::start();
    let window = display.open(&["--paused"]);
    let shown = window.screenshot();
    assert_eq!(shown.at(1000, 300), BACKGROUND);
    assert_eq!(shown.at(120, 100), BALL);
    assert_eq!(shown.at(60, 180), CONTACT);
    assert_eq!((shown.at(1279, 719), shown.at(1280, 720)), (BACKGROUND, NOTHING));
    assert_eq!(shown.difference(&picture(&["gravity"])), None);
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_paused_window_leaves_the_processor_alone() {
    let display = Display::start();
    let mut window = display.open(&["gravity", "--paused"]);
    window.wait_title("paused");
    window.wait_idle();
}

/// How many frames a window of two seconds with these arguments presents.
fn frames_presented(display: &Display, args: &[&str]) -> u32 {
    let mut window = display.open(&[args, &["--timings"]].concat());
    sleep(Duration::from_secs(2));
    window.key("Escape");
    let (_, said) = window.end_saying();
    let frames = said.split_once(" ms, ").and_then(|(_, rest)| rest.split_once(" frames"));
    frames.unwrap_or_else(|| panic!("{said}")).0.parse().unwrap()
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_window_in_which_nothing_moves_presents_its_first_frames_only() {
    let display = Display::start();
    // The first pictures, and those that the system asks for as the window appears and gets the focus.
    let most = 6;
    for args in [&["elastic", "--paused"][..], &["draw"]] {
        let frames = frames_presented(&display, args);
        assert!((1..=most).contains(&frames), "{args:?}: {frames} frames");
    }
    let frames = frames_presented(&display, &["move"]);
    assert!(frames > 2 * most, "what moves is presented: {frames} frames");
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn what_comes_back_into_the_picture_is_painted_whole() {
    let display = Display::start();
    let mut window = display.open(&["elastic", "--paused"]);
    let start = picture(&["elastic"]);
    let sheet = |shown: &Screenshot| shown.difference(&start).is_some();
    for _ in 0..3 {
        window.key("h");
        window.wait("the help", |window| sheet(&window.screenshot()));
        window.key("h");
        window.wait("the picture behind the help", |window| !sheet(&window.screenshot()));
    }
    window.resize("900", "600");
    window.wait("the smaller window", |window| window.screenshot().at(1000, 650) == NOTHING);
    window.resize("1280", "720");
    window.key("r");
    window.wait("the whole picture", |window| !sheet(&window.screenshot()));
}

/// There is no window manager to minimise the window, so the test does to it what one would.
#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_minimised_window_stands_still_and_goes_on_when_it_is_back() {
    let display = Display::start();
    let mut window = display.open(&["elastic"]);
    assert!(window.moves());
    let set = ["-f", "_NET_WM_STATE", "32a", "-set", "_NET_WM_STATE", "_NET_WM_STATE_HIDDEN"];
    display.ask("xprop", &[&["-id", &window.id], &set[..]].concat());
    window.wait_still();
    window.wait_idle();
    display.ask("xprop", &["-id", &window.id, "-remove", "_NET_WM_STATE"]);
    window.wait("it to go on without a key or the mouse", |window| window.moves());
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn resizing_moves_the_walls_and_no_ball_is_lost() {
    let display = Display::start();
    let mut window = display.open(&["elastic", "--paused"]);
    let all = window.screenshot().ball_pixels();
    window.resize("400", "300");
    window.wait("the smaller window", |window| {
        let shown = window.screenshot();
        shown.at(399, 2) == BACKGROUND && shown.at(420, 2) == NOTHING && shown.at(2, 320) == NOTHING
    });
    // The ball at (70, 430), of radius 45, was below the new floor.
    window.wait("the stranded ball inside", |window| window.screenshot().at(70, 255) == BALL);
    // While frames are presented: a resize in the middle of one must not hang the window (parasyte/pixels #460 did).
    window.key("space");
    for _ in 0..5 {
        for (width, height) in [("1", "1"), ("3", "700"), ("700", "2"), ("1280", "720")] {
            window.resize(width, height);
            sleep(Duration::from_millis(150));
        }
        window.wait("the window at its old size", |window| window.screenshot().at(1279, 719) != NOTHING);
    }
    window.wait_title("15 balls");
    window.key("space");
    window.key("r");
    window.wait("all balls again", |window| window.screenshot().ball_pixels() == all);
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn at_twice_the_scale_the_world_is_as_large_and_the_picture_twice() {
    let display = Display::start();
    let window = display.open_scaled(&["gravity", "--paused", "--size", "640x360"], "2");
    let shown = window.screenshot();
    assert_eq!((shown.at(240, 200), shown.at(120, 360)), (BALL, CONTACT));
    assert_eq!((shown.at(1279, 700), shown.at(1281, 700)), (BACKGROUND, NOTHING));
}
