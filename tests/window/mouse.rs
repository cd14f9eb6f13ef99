//! The mouse: balls are taken, carried, flung, put down, taken away; the wheel sets the next one's size.

use std::thread::sleep;
use std::time::Duration;

use carom::DVec2;

use super::display::*;
use super::files::saved_balls;

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_ball_is_carried_in_time_and_flies_on_when_it_is_let_go() {
    let display = Display::start();
    let mut window = display.open(&["two"]);
    window.wait_title("2 balls");
    window.mouse(&["mousemove", "900", "300", "click", "1"]);
    window.wait_title("3 balls");
    window.mouse(&["mousemove", "905", "303", "mousedown", "1"]);
    for step in 1..=20 {
        window.mouse(&["mousemove", &(905 + 5 * step).to_string(), "303"]);
        sleep(Duration::from_millis(15));
    }
    sleep(Duration::from_millis(500));
    window.key("space");
    window.wait_title("paused");
    let held = saved_balls(&mut window, "two", 1)[2];
    // Where it was taken, 5 and 3 px from its middle.
    assert!(held.position().distance(DVec2::new(1000.0, 300.0)) < 1.0, "{}", held.position());
    window.mouse(&["mouseup", "1"]);
    let balls = saved_balls(&mut window, "two", 2).len();
    assert_eq!(balls, 3, "a ball that is let go is no new one");
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_ball_is_put_elsewhere_while_time_stands_still() {
    let display = Display::start();
    let mut window = display.open(&["gravity", "--paused"]);
    let before = saved_balls(&mut window, "gravity", 1);
    let at = before[2].position();
    window.mouse(&["mousemove", &at.x.to_string(), &at.y.to_string(), "mousedown", "1"]);
    window.mouse(&["mousemove", "800", "300"]);
    window.wait("the ball where the hand is", |window| window.screenshot().at(800, 300) != BACKGROUND);
    window.mouse(&["mouseup", "1"]);
    let after = saved_balls(&mut window, "gravity", 2);
    assert_eq!(after[2].position(), DVec2::new(800.0, 300.0));
    assert_eq!(after[2].velocity(), before[2].velocity());
    assert_eq!(after[3..], before[3..]);
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn the_right_button_takes_a_ball_away_and_the_wheel_sets_the_next_ones_radius() {
    let display = Display::start();
    let mut window = display.open(&["gravity", "--paused"]);
    let before = saved_balls(&mut window, "gravity", 1);
    let at = before[2].position();
    window.mouse(&["mousemove", &at.x.to_string(), &at.y.to_string(), "click", "3"]);
    window.wait_title("14 balls");
    // The server's test device counts each notch twice, other mice once.
    window.mouse(&[
        "mousemove",
        "900",
        "300",
        "click",
        "4",
        "click",
        "4",
        "click",
        "4",
        "click",
        "4",
        "click",
        "5",
    ]);
    window.mouse(&["click", "1"]);
    window.wait_title("15 balls");
    let after = saved_balls(&mut window, "gravity", 2);
    let without: Vec<_> =
        before.iter().enumerate().filter(|&(index, _)| index != 2).map(|(_, ball)| *ball).collect();
    assert_eq!(after[..14], without);
    let notches = (after[14].radius() / 20.0).ln() / 1.1_f64.ln();
    assert!((notches - 3.0).abs() < 1e-9 || (notches - 6.0).abs() < 1e-9, "{notches}");
}

/// Where there is no room.
const AMBER: [u8; 3] = [0xe0, 0xa0, 0x30];

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn an_amber_outline_with_a_cross_says_that_there_is_no_room() {
    let display = Display::start();
    let mut window = display.open(&["walls", "--paused"]);
    let balls = saved_balls(&mut window, "walls", 1);
    // Its opacity is 0.6, over the background.
    let expected: Vec<i32> = AMBER
        .iter()
        .zip(BACKGROUND)
        .map(|(&over, under)| (i32::from(over) * 6 + i32::from(under) * 4) / 10)
        .collect();
    let amber = |window: &Window<'_>| {
        let shown = window.screenshot();
        let near = |pixel: [u8; 3]| {
            pixel.iter().zip(&expected).all(|(&is, &wanted)| (i32::from(is) - wanted).abs() < 30)
        };
        (0..720).flat_map(|y| (0..1280).map(move |x| (x, y))).filter(|&(x, y)| near(shown.at(x, y))).count()
    };
    assert_eq!(amber(&window), 0);
    // A pixel from the wall, and farther from all balls than the outline reaches.
    let free =
        |y: f64| balls.iter().all(|ball| ball.position().distance(DVec2::new(1.0, y)) > ball.radius() + 30.0);
    let y = (50..650).map(f64::from).find(|&y| free(y)).unwrap();
    window.mouse(&["mousemove", "1", &y.to_string()]);
    window.wait("the outline", |window| amber(window) > 40);
    window.mouse(&["click", "1"]);
    window.wait_title("no room");
    assert_eq!(saved_balls(&mut window, "walls", 2), balls);
    // Farther in there is room: the outline is no warning there, and a click adds a ball.
    let free = |at: DVec2| balls.iter().all(|ball| ball.position().distance(at) > ball.radius() + 30.0);
    let at = (100..1200).map(|x| DVec2::new(f64::from(x), 300.0)).find(|&at| free(at)).unwrap();
    window.mouse(&["mousemove", &at.x.to_string(), &at.y.to_string()]);
    window.wait("no warning", |window| amber(window) == 0);
    window.mouse(&["click", "1"]);
    window.wait_title(&format!("{} balls", balls.len() + 1));
}
