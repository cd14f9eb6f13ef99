//! What can be laid over the balls, and what is said there.

use std::ops::Range;
use std::thread::sleep;
use std::time::Duration;

use super::display::*;

/// The ink of text and lines over the picture.
const INK: [u8; 3] = [0xe6; 3];

/// What compares.
const TRUE: [u8; 3] = [0xff, 0xd0, 0x6a];

/// How many pixels there are, about of a colour, in a part of the screen.
fn count(shown: &Screenshot, colour: [u8; 3], columns: Range<usize>, rows: Range<usize>) -> usize {
    let near = |pixel: [u8; 3]| pixel.iter().zip(colour).all(|(&one, other)| one.abs_diff(other) < 40);
    rows.map(|y| columns.clone().filter(|&x| near(shown.at(x, y))).count()).sum()
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn figures_come_and_go_and_stand_still_while_paused() {
    let display = Display::start();
    let mut window = display.open(&["gravity"]);
    let figures = |shown: &Screenshot| count(shown, INK, 0..250, 0..480) > 300;
    assert!(!figures(&window.screenshot()));
    window.key("d");
    window.wait("figures", |window| figures(&window.screenshot()));
    window.key("space");
    window.wait_title("paused");
    window.wait_still();
    window.key("d");
    window.wait("none", |window| !figures(&window.screenshot()));
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn canvas_leaves_the_exact_solver_and_one_sees_it() {
    let display = Display::start();
    let mut window = display.open(&["elastic", "--solver", "canvas", "--paused"]);
    let lines = |window: &Window<'_>| count(&window.screenshot(), TRUE, 970..1270, 0..210);
    window.key("x");
    window.wait("the plot's value", |window| lines(window) > 5);
    let before = lines(&window);
    window.key("space");
    window.wait("an error that grows", |window| lines(window) > before + 100);
    window.key("x");
    window.wait("no plot", |window| lines(window) == 0);
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn trails_show_where_balls_went_and_cost_nothing_while_paused() {
    let display = Display::start();
    let mut window = display.open(&["elastic", "--paused"]);
    let is_faint = |[red, green, _]: [u8; 3]| red < BACKGROUND[0] && (60..200).contains(&green);
    let all = || (0..SCREEN.1).flat_map(|y| (0..SCREEN.0).map(move |x| (x, y)));
    // The rims of balls are faint too: about as many pixels wherever the balls are.
    let faint = |shown: &Screenshot| all().filter(|&(x, y)| is_faint(shown.at(x, y))).count();
    let without = faint(&window.screenshot());
    window.key("t");
    window.key("space");
    window.wait("a trail", |window| faint(&window.screenshot()) > without + 300);
    window.key("space");
    window.wait_title("paused");
    window.wait_idle();
    let with = window.screenshot();
    window.key("t");
    window.wait("no trail", |window| {
        let now = window.screenshot();
        let gone = |&(x, y): &(usize, usize)| is_faint(with.at(x, y)) && now.at(x, y) == BACKGROUND;
        all().filter(gone).count() > 100
    });
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_hint_stands_at_the_start_and_fades_and_messages_come_and_go() {
    let display = Display::start();
    let mut window = display.open_talking(&["draw"], "1");
    let said = |window: &Window<'_>| count(&window.screenshot(), INK, 400..880, 660..720) > 20;
    window.wait("the hint", |window| said(window));
    window.wait("no hint", |window| !said(window));
    window.key("bracketleft");
    window.wait("the message", |window| said(window));
    window.wait("no message", |window| !said(window));
    let without = picture(&["draw"]);
    window.wait("the picture without a message", |window| window.screenshot().difference(&without).is_none());
    // Time that stands still is said for longer than messages are.
    let paused = |window: &Window<'_>| count(&window.screenshot(), INK, 1150..1280, 660..720) > 20;
    window.key("space");
    window.wait("the message", |window| said(window) && paused(window));
    window.wait("no message", |window| !said(window));
    assert!(paused(&window));
    window.wait_idle();
    window.key("space");
    window.wait("the picture without it", |window| window.screenshot().difference(&without).is_none());
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn with_everything_on_a_paused_window_leaves_the_processor_alone() {
    let display = Display::start();
    let mut window = display.open_talking(&["gravity", "--solver", "canvas"], "1");
    for key in ["d", "x", "t"] {
        window.key(key);
    }
    sleep(Duration::from_millis(500));
    window.key("space");
    window.wait_title("paused");
    // A message stands still before it fades.
    sleep(Duration::from_secs(4));
    window.wait_idle();
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn in_a_small_window_a_message_stands_clear_of_the_figures() {
    let display = Display::start();
    let mut window = display.open_talking(&["gravity", "--paused", "--size", "200x150"], "1");
    let corner = |window: &Window<'_>| window.screenshot().at(30, 13);
    let without = corner(&window);
    window.key("d");
    window.wait("figures", |window| corner(window) != without);
    // Below them is the place of messages: the hint, and then none.
    let low = 115;
    let rows = |shown: &Screenshot, rows: Range<usize>| {
        rows.flat_map(|y| (0..200).map(move |x| (x, y))).map(|(x, y)| shown.at(x, y)).collect::<Vec<_>>()
    };
    // Not in the corner, which says that time stands still.
    let said = |shown: &Screenshot| count(shown, INK, 0..130, low..150) > 5;
    window.wait("no hint", |window| !said(&window.screenshot()));
    let before = window.still_screenshot();
    window.key("bracketleft");
    window.wait("the message", |window| said(&window.screenshot()));
    assert!(rows(&window.screenshot(), 0..low) == rows(&before, 0..low), "it lies over the figures");
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn in_a_small_window_the_help_comes_page_by_page_and_then_goes() {
    let display = Display::start();
    let mut window = display.open(&["gravity", "--paused", "--size", "320x240"]);
    let without = window.still_screenshot();
    let mut seen = vec![without.0.clone()];
    for _ in 0..4 {
        window.key("h");
        window.wait("another page", |window| !seen.contains(&window.screenshot().0));
        seen.push(window.still_screenshot().0);
    }
    window.key("h");
    window.wait("the scene", |window| window.screenshot().0 == without.0);
    // It begins with the first page again.
    window.key("F1");
    window.wait("the first page", |window| window.screenshot().0 == seen[1]);
    window.key("Escape");
    window.wait("the scene", |window| window.screenshot().0 == without.0);
}

/// Until the list of scenes lies over the corner of the picture.
fn wait_for_cards(window: &mut Window<'_>) {
    window.wait("the cards", |window| window.screenshot().at(5, 5) == [0x12; 3]);
}

/// Until the scene is seen there.
fn wait_for_scene(window: &mut Window<'_>) {
    window.wait("the scene", |window| window.screenshot().at(5, 5) == BACKGROUND);
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn all_scenes_are_shown_and_opened_by_key_and_mouse() {
    let display = Display::start();
    let mut window = display.open(&["draw"]);
    window.wait_title("draw");
    let closed = window.still_screenshot();
    window.key("m");
    wait_for_cards(&mut window);
    // From the first card to the second.
    window.key("Right");
    window.key("Return");
    window.wait_title("move · canvas · 1 ball");
    // The title comes before the picture: these cards may still be the old ones.
    wait_for_scene(&mut window);
    window.key("m");
    wait_for_cards(&mut window);
    // The first card is the first stage.
    window.mouse(&["mousemove", "120", "150", "click", "1"]);
    window.wait_title("draw · canvas · 1 ball");
    wait_for_scene(&mut window);
    window.key("2");
    window.wait_title("move");
    window.key("m");
    wait_for_cards(&mut window);
    // Without moving the pointer from where it was before the cards.
    window.mouse(&["click", "1"]);
    window.wait_title("draw · canvas · 1 ball");
    wait_for_scene(&mut window);
    window.key("m");
    wait_for_cards(&mut window);
    window.key("Escape");
    window.wait("the scene again", |window| window.screenshot().0 == closed.0);
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn keys_and_clicks_that_come_before_the_list_of_scenes_is_painted_are_for_it() {
    let display = Display::start();
    let mut window = display.open(&["move"]);
    window.wait_title("move");
    // All before the next picture, or nearly.
    window.mouse(&["key", "m", "mousemove", "120", "150", "click", "1"]);
    window.wait_title("draw · canvas · 1 ball");
    wait_for_scene(&mut window);
    window.mouse(&["key", "m", "Down", "Return"]);
    // A row below the first stage; where the rows were unknown, it was the next one.
    window.wait("a scene below", |window| !window.title().contains("draw"));
    assert!(!window.title().contains("move"), "{}", window.title());
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_dial_shows_where_gravity_was_tilted_and_goes_away() {
    let display = Display::start();
    let mut window = display.open_talking(&["draw", "--paused"], "1");
    // The ink of the dial in the lower left corner: how much, and its mean place, from the dial's middle.
    let dial = |window: &Window<'_>| {
        let shown = window.screenshot();
        let ink = |&(x, y): &(usize, usize)| shown.at(x, y).iter().all(|&part| part > 0xb0);
        let places: Vec<_> = (632..704).flat_map(|y| (16..88).map(move |x| (x, y))).filter(ink).collect();
        let mean = |along: fn(&(usize, usize)) -> usize, middle: f64| {
            places.iter().map(along).sum::<usize>() as f64 / places.len() as f64 - middle
        };
        (places.len(), mean(|at| at.0, 51.5), mean(|at| at.1, 667.5))
    };
    window.wait("no dial", |window| dial(window).0 == 0);
    // An arrow's head is heavier than its tail.
    window.key("ctrl+Right");
    window.wait("to the right", |window| matches!(dial(window), (40.., x, y) if x > 1.0 && y.abs() < 1.0));
    window.key("ctrl+Left");
    window.wait(
        "a dot for none",
        |window| matches!(dial(window), (10..40, x, y) if x.abs() < 1.0 && y.abs() < 1.0),
    );
    window.key("ctrl+Up");
    window.wait("up", |window| matches!(dial(window), (40.., x, y) if y < -1.0 && x.abs() < 1.0));
    window.key("ctrl+Left");
    window.wait("up and left", |window| matches!(dial(window), (40.., x, y) if x < -0.7 && y < -0.7));
    window.key("ctrl+s");
    window.wait_title("saved carom-draw-1.toml");
    let saved = std::fs::read_to_string(window.folder.path().join("carom-draw-1.toml")).unwrap();
    assert!(saved.contains("gravity = [-98, -98]"), "{saved}");
    window.wait("no dial", |window| dial(window).0 == 0);
}
