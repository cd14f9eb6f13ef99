//! What keys and the mouse do.

use super::display::*;

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn space_stops_time_and_lets_it_go_on_and_r_restores_the_scene() {
    let display = Display::start();
    let mut window = display.open(&["elastic"]);
    assert!(window.moves());
    window.key("space");
    window.wait_title("paused");
    window.wait_still();
    let start = picture(&["elastic"]);
    assert!(window.screenshot().difference(&start).is_some());
    window.key("r");
    window.wait("the first picture again", |window| window.screenshot().difference(&start).is_none());
    window.key("period");
    window.wait("one step", |window| window.screenshot().difference(&start).is_some());
    assert!(!window.moves(), "one step is one step");
    window.key("space");
    assert!(window.moves());
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn keys_add_and_remove_balls_and_go_through_the_scenes() {
    let display = Display::start();
    let mut window = display.open(&["gravity", "--paused"]);
    window.wait_title("gravity · exact · 15 balls · paused");
    let before = window.screenshot().ball_pixels();
    window.key("a");
    window.wait_title("16 balls");
    window.wait("a ball more in the picture", |window| window.screenshot().ball_pixels() > before + 50);
    window.key("shift+a");
    window.wait_title("116 balls");
    window.key("BackSpace");
    window.wait_title("115 balls");
    for (key, part) in [
        ("1", "draw · canvas · 1 ball ·"),
        ("Tab", "move"),
        ("Tab", "two · canvas · 2 balls"),
        ("shift+Tab", "move"),
        ("8", "gravity · exact · 15 balls"),
        ("s", "gravity · contact · 15 balls"),
        ("s", "gravity · canvas · 15 balls"),
        ("s", "gravity · exact · 15 balls"),
        ("bracketleft", "speed 1/2"),
        ("bracketright", "15 balls · paused"),
    ] {
        window.key(key);
        window.wait_title(part);
    }
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_click_adds_a_ball_and_a_drag_throws_one() {
    let display = Display::start();
    let mut window = display.open(&["two", "--paused"]);
    window.wait_title("2 balls");
    window.mouse(&["mousemove", "900", "300", "click", "1"]);
    window.wait_title("3 balls");
    window.wait("the ball under the pointer", |window| window.screenshot().at(900, 300) == BALL);
    window.mouse(&["mousemove", "600", "500", "mousedown", "1", "mousemove", "700", "500"]);
    window.wait("a line that shows the velocity", |window| window.screenshot().at(660, 500) == [0xe6; 3]);
    window.mouse(&["mouseup", "1"]);
    window.wait_title("4 balls");
    window.wait("the thrown ball", |window| window.screenshot().at(600, 500) == BALL);
    window.key("space");
    window.wait("the thrown ball on its way", |window| window.screenshot().at(600, 500) == BACKGROUND);
    window.wait("the ball at rest where it was", |window| window.screenshot().at(900, 300) == BALL);
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn arrows_with_control_tilt_gravity_and_a_ball_at_rest_falls_that_way() {
    let display = Display::start();
    let mut window = display.open(&["draw", "--paused"]);
    for (key, notice) in [
        ("ctrl+Right", "gravity (98, 0) px/s²"),
        ("ctrl+Up", "gravity (98, -98) px/s²"),
        ("ctrl+Down", "gravity (98, 0) px/s²"),
        ("g", "gravity off"),
        ("g", "gravity (98, 0) px/s²"),
    ] {
        window.key(key);
        window.wait_title(notice);
    }
    let start = picture(&["draw"]);
    assert_eq!(window.screenshot().difference(&start), None, "an arrow with control is no step");
    // The title is its own again when the notice has stood long enough.
    window.wait_title("draw");
    let centre = |window: &Window<'_>| {
        let shown = window.screenshot();
        let ball = |&x: &usize| (0..SCREEN.1).any(|y| shown.at(x, y) == BALL);
        let (left, right) = ((0..SCREEN.0).find(ball), (0..SCREEN.0).rfind(ball));
        left.zip(right).map(|(left, right)| usize::midpoint(left, right))
    };
    let before = centre(&window).unwrap();
    window.key("space");
    window.wait("the ball further right", |window| centre(window).is_some_and(|x| x > before + 20));
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn help_covers_the_balls_and_goes_away() {
    let display = Display::start();
    let mut window = display.open(&["gravity", "--paused"]);
    let before = window.screenshot();
    window.key("h");
    window.wait("the sheet", |window| window.screenshot().at(640, 215) != BACKGROUND);
    window.key("F1");
    window.wait("no sheet", |window| window.screenshot().0 == before.0);
}
