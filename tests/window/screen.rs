//! The screen that the window is on: full, of another scale, of another size.

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStdout, Stdio};
use std::thread::sleep;
use std::time::Duration;

use super::display::*;
use super::files::saved_balls;

/// A window manager, until it is dropped.
struct Manager {
    child: Child,
    /// Kept open: it may say something later.
    _says: BufReader<ChildStdout>,
}

impl Manager {
    fn start(display: &Display) -> Self {
        let mut openbox = display.command("openbox");
        // A window that is opened before it has started may stay unmapped for ever.
        openbox.args(["--startup", "echo started"]).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = openbox.spawn().expect("openbox is installed");
        let mut says = BufReader::new(child.stdout.take().unwrap());
        assert!(says.by_ref().lines().any(|line| line.unwrap() == "started"), "openbox starts");
        Self { child, _says: says }
    }
}

impl Drop for Manager {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
#[ignore = "needs Xvfb, xdotool, openbox and ImageMagick; run with --ignored"]
fn f11_fills_the_screen_and_gives_it_back_and_the_walls_follow() {
    let display = Display::start();
    let _manager = Manager::start(&display);
    let mut window = display.open(&["walls", "--paused", "--size", "600x400"]);
    let full = |window: &Window<'_>| {
        let shown = window.screenshot();
        [(0, 0), (SCREEN.0 - 1, 0), (0, SCREEN.1 - 1), (SCREEN.0 - 1, SCREEN.1 - 1)]
            .iter()
            .all(|&(x, y)| shown.at(x, y) == BACKGROUND)
    };
    assert!(!full(&window));
    for number in 0..2 {
        window.key("F11");
        window.wait("a full screen", |window| full(window));
        // A ball that is dropped now finds the floor of the whole screen: the scene that is saved tells its size.
        saved_balls(&mut window, "walls", 2 * number + 1);
        let path = window.folder.path().join(format!("carom-walls-{}.toml", 2 * number + 1));
        let saved = std::fs::read_to_string(path).unwrap();
        assert!(saved.contains("size = [1400, 800]"), "{saved}");
        window.key("F11");
        window.wait("the window as it was", |window| !full(window));
        saved_balls(&mut window, "walls", 2 * number + 2);
        let path = window.folder.path().join(format!("carom-walls-{}.toml", 2 * number + 2));
        let saved = std::fs::read_to_string(path).unwrap();
        assert!(saved.contains("size = [600, 400]"), "{saved}");
    }
}

#[test]
#[ignore = "needs Xvfb, xdotool, xrandr and ImageMagick; run with --ignored"]
fn a_screen_that_changes_its_size_under_the_window_does_it_no_harm() {
    let display = Display::start();
    let mut window = display.open(&["elastic"]);
    // Modes of Xvfb have no clock.
    for [width, height] in [["800", "600"], ["320", "240"]] {
        let mode = [&format!("{width}x{height}"), "0", width, "0", "0", width, height, "0", "0", height];
        display.ask("xrandr", &[&["--newmode"], &mode.map(|word| word as &str)[..]].concat());
        display.ask("xrandr", &["--addmode", "screen", mode[0]]);
        display.ask("xrandr", &["--output", "screen", "--mode", mode[0]]);
        let is = display.ask("xrandr", &[]);
        let now = format!("current {width} x {height}");
        assert!(String::from_utf8_lossy(&is).contains(&now), "{now}: {}", String::from_utf8_lossy(&is));
        let before = window.processor_time();
        sleep(Duration::from_millis(500));
        assert!(window.runs() && window.processor_time() > before, "it goes on at {now}");
    }
    display.ask("xrandr", &["--output", "screen", "--mode", &format!("{}x{}", SCREEN.0, SCREEN.1)]);
    window.wait("the whole screen again", |window| window.screenshot().at(1279, 719) == BACKGROUND);
    assert!(window.moves());
    window.key("space");
    window.wait_title("paused");
}
