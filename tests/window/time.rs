//! Time in the window: back, on, by steps, to the next impact.

use std::thread::sleep;
use std::time::Duration;

use carom::Scene;

use super::display::*;
use super::files::{replayed, saved_balls};

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn left_goes_back_frame_by_frame_and_right_shows_the_same_again() {
    let display = Display::start();
    let mut window = display.open(&["elastic", "--paused"]);
    let mut seen = vec![window.screenshot()];
    for _ in 0..4 {
        window.key("Right");
        let before = seen.last().unwrap().0.clone();
        window.wait("a step", |window| window.screenshot().0 != before);
        seen.push(window.still_screenshot());
    }
    for expected in seen.iter().rev().skip(1) {
        window.key("Left");
        window.wait("the frame before", |window| window.screenshot().0 == expected.0);
    }
    window.key("Left");
    window.wait_title("this is the start");
    for expected in &seen[1..] {
        window.key("Right");
        window.wait("the same frame again", |window| window.screenshot().0 == expected.0);
    }
    let last = saved_balls(&mut window, "elastic", 1);
    let (balls, _) = replayed(&mut window, "elastic", 1);
    assert!(balls.iter().zip(&last).all(|(&(p, v), ball)| p == ball.position() && v == ball.velocity()));
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn left_held_runs_time_back_to_the_first_picture_and_let_go_it_runs_on() {
    let display = Display::start();
    let mut window = display.open(&["elastic"]);
    let start = picture(&["elastic"]);
    window.wait("another picture", |window| window.screenshot().difference(&start).is_some());
    sleep(Duration::from_secs(1));
    window.mouse(&["keydown", "Left"]);
    window.wait_title("this is the start");
    window.mouse(&["keyup", "Left"]);
    window.wait("time to run on", |window| window.screenshot().difference(&start).is_some());
    // From the first picture, on purpose: paused, there is nothing before it but a few frames.
    window.key("space");
    window.wait_title("paused");
    window.mouse(&["keydown", "Left"]);
    window.wait("the first picture", |window| window.screenshot().difference(&start).is_none());
    window.mouse(&["keyup", "Left"]);
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn the_title_counts_the_balls_that_the_last_of_single_steps_let_in() {
    let display = Display::start();
    let mut window = display.open(&["rain", "--paused"]);
    window.mouse(&["key", "--repeat", "30", "--delay", "1", "period"]);
    window.wait_still();
    let title = window.title();
    let balls = saved_balls(&mut window, "rain", 1).len();
    assert!(balls > 50, "{balls}");
    assert!(title.contains(&format!(" · {balls} balls · ")), "{title}: {balls}");
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn shift_and_right_go_to_the_next_impact_each_time() {
    let display = Display::start();
    let mut window = display.open(&["elastic", "--paused"]);
    for _ in 0..7 {
        let before = window.still_screenshot();
        window.key("shift+Right");
        window.wait("a step", |window| window.screenshot().0 != before.0);
    }
    let (_, summary) = replayed(&mut window, "elastic", 1);
    // Some touch from the beginning.
    let at_start = Scene::load("elastic").unwrap().build().map(|mut simulation| {
        simulation.advance(0.0).unwrap();
        simulation.tally().impacts + simulation.tally().wall_hits
    });
    let hits = summary["collisions"].as_u64().unwrap() + summary["wall_hits"].as_u64().unwrap();
    assert_eq!(hits, 7 + at_start.unwrap());
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn shift_and_r_draw_other_random_balls_where_there_are_any() {
    let display = Display::start();
    let mut window = display.open(&["gas", "--paused"]);
    let before = window.screenshot();
    window.key("shift+r");
    window.wait("other balls", |window| window.screenshot().0 != before.0);
    let first = saved_balls(&mut window, "gas", 1);
    window.key("shift+r");
    window.wait("other balls", |window| saved_differs(window, &first));
    window.key("8");
    window.wait_title("gravity");
    window.key("shift+r");
    window.wait_title("gravity has no random balls");
}

fn saved_differs(window: &mut Window<'_>, first: &[carom::Ball]) -> bool {
    let number = 2 + std::fs::read_dir(window.folder.path())
        .unwrap()
        .filter(|entry| entry.as_ref().unwrap().path().extension().is_some_and(|end| end == "toml"))
        .count() as u32
        - 1;
    saved_balls(window, "gas", number) != first
}
