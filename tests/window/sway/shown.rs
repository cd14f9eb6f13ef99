//! Full screen, other sizes, and what nobody sees.

use carom::DVec2;
use carom::session::LONGEST_FRAME;

use super::*;

/// The size of the world at the end of a replay.
fn world(lines: &[String]) -> &str {
    let mut sizes =
        lines.iter().filter_map(|line| line.strip_prefix("resize ").or(line.strip_prefix("size ")));
    sizes.next_back().unwrap()
}

#[test]
#[ignore = "needs sway, wtype and grim; run with --ignored"]
fn on_wayland_f11_fills_the_output_and_gives_the_window_its_size_back() {
    let sway = Sway::start();
    let mut window = sway.open(&["draw", "--size", "640x360"]);
    for number in 0..3 {
        sway.key("F11");
        window.wait("the whole output", |window| window.fills(FIRST, (1400, 800)));
        assert_eq!(world(&window.saved_replay("draw", 2 * number + 1).1), "1400 800");
        sway.key("F11");
        window.wait("the window", |window| window.fills(FIRST, (640, 360)));
        assert_eq!(world(&window.saved_replay("draw", 2 * number + 2).1), "640 360");
    }
    sway.point(1200.0, 700.0);
    sway.key("F11");
    window.wait("the whole output", |window| window.fills(FIRST, (1400, 800)));
    sway.click(LEFT);
    window.wait_title("2 balls");
    assert_eq!(window.saved_balls("draw", 1)[1].position(), DVec2::new(1200.0, 700.0));
    sway.key("Escape");
    assert!(window.end().success());
    let mut window = sway.open(&["draw", "--fullscreen"]);
    window.wait("the whole output", |window| window.fills(FIRST, (1400, 800)));
}

#[test]
#[ignore = "needs sway, wtype and grim; run with --ignored"]
fn on_wayland_the_picture_follows_every_size_that_the_window_is_given() {
    let sway = Sway::start();
    let mut window = sway.open(&["elastic"]);
    let give = |width, height| {
        sway.tell(&format!("[app_id=carom] resize set {width} {height}, move absolute position 0 0"));
    };
    for size in [(900, 600), (400, 300), (1000, 250), (1380, 790)] {
        give(size.0, size.1);
        window.wait("the picture", |window| window.fills(FIRST, size));
    }
    // Faster than there are frames, and too small for the balls. sway takes the size of what is shown late for one that
    // was asked for, so the last is asked for until it is there.
    for (width, height) in [(75, 50), (100, 700), (1380, 60), (900, 600)].repeat(5) {
        give(width, height);
    }
    window.wait("the picture", |window| {
        give(900, 600);
        window.fills(FIRST, (900, 600))
    });
    sway.tell("[app_id=carom] floating disable");
    window.wait("the picture", |window| window.fills(FIRST, (1400, 800)));
    window.wait_title("15 balls");
    window.wait_rate(1..1000);
}

#[test]
#[ignore = "needs sway, wtype and grim; run with --ignored"]
fn on_wayland_a_hidden_window_stands_still_goes_on_from_there_and_can_be_closed() {
    let sway = Sway::start();
    let mut window = sway.open(&["elastic", "--size", "640x360"]);
    window.wait_rate(1..1000);
    let simulated = |window: &mut Window<'_>, number| -> f64 {
        deltas(&window.saved_replay("elastic", number).1).iter().sum()
    };
    for (number, (hide, show)) in
        (1..).zip([("workspace 2", "workspace 1"), ("[app_id=carom] move scratchpad", "scratchpad show")])
    {
        let (start, before) = (Instant::now(), simulated(&mut window, 2 * number - 1));
        sway.tell(hide);
        sleep(Duration::from_millis(200));
        let (hidden, used) = (Instant::now(), window.processor_time());
        sleep(Duration::from_secs(1));
        let (hidden, used) = (hidden.elapsed().as_secs_f64(), window.processor_time() - used);
        assert!(used <= 0.02, "{used} s of processor time in {hidden} s after {hide}");
        sway.tell(show);
        window.wait_rate(1..1000);
        let run = simulated(&mut window, 2 * number) - before;
        // The frame that nobody saw end counts as the longest.
        let shown = start.elapsed().as_secs_f64() - hidden;
        assert!(run > 0.0 && run <= shown + LONGEST_FRAME, "{run} s simulated in {shown} s after {hide}");
    }
    sway.tell("workspace 2");
    sway.tell("[app_id=carom] kill");
    assert!(window.end().success());
}

/// A ball that is not in the picture for its first second.
const COMES: &str =
    "solver = \"exact\"\n[[ball]]\nposition = [-130, 200]\nvelocity = [100, 0]\nradius = 30\n";

#[test]
#[ignore = "needs sway, wtype and grim; run with --ignored"]
fn on_wayland_a_picture_that_changes_while_it_is_hidden_does_not_hold_the_window_up() {
    let scene = tempfile::Builder::new().suffix(".toml").tempfile().unwrap();
    std::fs::write(scene.path(), COMES).unwrap();
    let sway = Sway::start();
    let mut window = sway.open(&[scene.path().to_str().unwrap(), "--paused", "--size", "640x360"]);
    window.wait("the picture", |window| window.fills(FIRST, (640, 360)));
    sway.key("space");
    sway.tell("workspace 2");
    sleep(Duration::from_secs(2));
    // A driver that is given a picture before the last one was seen waits for that.
    sway.tell("[app_id=carom] kill");
    assert!(window.end().success());
}
