//! What was done in a window, saved as a scene and as a replay, and read back: states, not only pictures.

use std::path::Path;
use std::process::Command;
use std::thread::sleep;
use std::time::Duration;

use carom::{Ball, DVec2, Scene};

use super::display::*;

/// The balls of the scene that Ctrl+S saves now, under this number.
pub fn saved_balls(window: &mut Window<'_>, scene: &str, number: u32) -> Vec<Ball> {
    let name = format!("carom-{scene}-{number}.toml");
    window.key("ctrl+s");
    window.wait_title(&format!("saved {name}"));
    balls_in(&window.folder.path().join(name))
}

/// The balls of this scene file.
pub fn balls_in(file: &Path) -> Vec<Ball> {
    Scene::load(file.to_str().unwrap()).unwrap().build().unwrap().balls().to_vec()
}

/// The balls at the end of the replay that Ctrl+Shift+S saves now, as `carom run --commands` has them; and its summary.
pub fn replayed(
    window: &mut Window<'_>,
    scene: &str,
    number: u32,
) -> (Vec<(DVec2, DVec2)>, serde_json::Value) {
    let name = format!("carom-{scene}-{number}.replay");
    window.key("ctrl+shift+s");
    window.wait_title(&format!("saved {name}"));
    run_replay(window.folder.path(), scene, &name)
}

/// The same of this replay in a folder.
pub fn run_replay(folder: &Path, scene: &str, name: &str) -> (Vec<(DVec2, DVec2)>, serde_json::Value) {
    let run = ["run", scene, "--commands", name, "--trace", "t.csv", "--summary", "-"];
    let output = Command::new(env!("CARGO_BIN_EXE_carom")).args(run).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let trace = std::fs::read_to_string(folder.join("t.csv")).unwrap();
    let last = format!("{},", summary["frames"]);
    let balls = trace.lines().filter(|line| line.starts_with(&last)).map(|line| {
        let numbers: Vec<f64> = line.split(',').skip(3).take(4).map(|word| word.parse().unwrap()).collect();
        (DVec2::new(numbers[0], numbers[1]), DVec2::new(numbers[2], numbers[3]))
    });
    (balls.collect(), summary)
}

/// Positions and velocities.
pub fn states(balls: &[Ball]) -> Vec<(DVec2, DVec2)> {
    balls.iter().map(|ball| (ball.position(), ball.velocity())).collect()
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_replay_of_keys_and_mouse_ends_in_the_state_that_was_shown_to_the_bit() {
    let display = Display::start();
    let mut window = display.open(&["gravity"]);
    for keys in ["a", "ctrl+Right", "s", "shift+a", "x", "bracketleft", "g", "BackSpace", "s"] {
        window.key(keys);
    }
    window.mouse(&["mousemove", "900", "200", "mousedown", "1", "mousemove", "1000", "150", "mouseup", "1"]);
    window.mouse(&["mousemove", "910", "210", "click", "3"]);
    window.resize("1000", "600");
    window.wait("the smaller window", |window| window.screenshot().at(1100, 300) == NOTHING);
    window.key("space");
    window.wait_title("paused");
    window.key("period");
    // Only what a frame has shown is in a trace: the step's.
    window.wait("the step", |window| !window.moves());
    let shown = saved_balls(&mut window, "gravity", 1);
    let (balls, _) = replayed(&mut window, "gravity", 1);
    assert!(balls.len() > 100, "{}", balls.len());
    assert_eq!(balls, states(&shown));
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_saved_scene_opens_as_it_was_seen() {
    let display = Display::start();
    let mut window = display.open(&["elastic"]);
    window.key("space");
    window.wait_title("paused");
    let balls = saved_balls(&mut window, "elastic", 1);
    let seen = window.still_screenshot();
    window.key("Escape");
    let folder = window.keep_folder();
    let path = folder.path().join("carom-elastic-1.toml");
    let again = display.open(&[path.to_str().unwrap(), "--paused"]);
    // But for balls that touched in the last frame, which no scene file tells.
    let colourless = |shown: &Screenshot| shown.ball_pixels();
    assert_eq!(colourless(&again.screenshot()), colourless(&seen));
    assert_eq!(balls.len(), 15);
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_recording_is_a_gif_of_what_moved_and_overwrites_nothing() {
    let display = Display::start();
    let mut window = display.open(&["elastic"]);
    std::fs::write(window.folder.path().join("carom-elastic-1.gif"), "mine").unwrap();
    window.key("v");
    // Not for a time: a busy machine shows few pictures a second.
    (0..10).for_each(|_| assert!(window.moves()));
    window.key("v");
    window.wait_title("saved carom-elastic-2.gif");
    assert_eq!(std::fs::read(window.folder.path().join("carom-elastic-1.gif")).unwrap(), b"mine");
    let file = std::fs::File::open(window.folder.path().join("carom-elastic-2.gif")).unwrap();
    let mut decoder = gif::DecodeOptions::new().read_info(file).unwrap();
    assert_eq!((decoder.width(), decoder.height()), (1280, 720));
    let mut frames = 0;
    while decoder.read_next_frame().unwrap().is_some() {
        frames += 1;
    }
    assert!(frames >= 5, "{frames} frames");
    // Escape ends it, not the program ...
    window.key("v");
    sleep(Duration::from_millis(300));
    window.key("Escape");
    window.wait_title("saved carom-elastic-3.gif");
    assert!(window.runs() && window.moves());
    // ... and one that is being written when the window is closed is finished.
    window.key("v");
    sleep(Duration::from_millis(300));
    window.key("Escape");
    window.key("Escape");
    let folder = window.keep_folder();
    let kept = folder.path().join("carom-elastic-4.gif");
    assert!(std::fs::read(kept).unwrap().ends_with(b";"), "a GIF ends so");
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_recording_that_is_asked_for_while_the_last_is_being_written_begins_after_that() {
    let display = Display::start();
    let mut window = display.open(&["elastic"]);
    window.key("v");
    (0..10).for_each(|_| assert!(window.moves()));
    // At once, as one who films take after take.
    window.key("v");
    window.key("v");
    let saved = |window: &Window<'_>, number: u32| {
        window.folder.path().join(format!("carom-elastic-{number}.gif")).exists()
    };
    window.wait("the first", |window| saved(window, 1));
    sleep(Duration::from_millis(300));
    assert!(window.moves());
    window.key("Escape");
    window.wait("the second", |window| saved(window, 2));
    assert!(window.runs());
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn the_list_of_scenes_is_recorded_where_it_is_open_and_the_dot_tells_so() {
    let display = Display::start();
    let mut window = display.open(&["elastic", "--paused"]);
    // The red dot in the lower right corner.
    let dot = |window: &Window<'_>| {
        let shown = window.screenshot();
        (670..705).any(|y| (1180..1264).any(|x| shown.at(x, y) == [0xf0, 0x3c, 0x3c]))
    };
    let list = |window: &Window<'_>| window.screenshot().at(5, 5) == [0x12; 3];
    // Begun in the list, or before it was opened; both ended there.
    for (number, keys) in [(1, ["m", "v"]), (2, ["v", "m"])] {
        for key in keys {
            window.key(key);
        }
        window.wait("a recording of the list", |window| list(window) && dot(window));
        window.key("Right");
        // Small pictures come one by one; the dot's time, below them, goes on.
        let cards = |window: &Window<'_>| window.screenshot().0[..3 * SCREEN.0 * 660].to_vec();
        let mut last = cards(&window);
        window.wait("all cards", |window| {
            sleep(Duration::from_millis(700));
            let before = std::mem::replace(&mut last, cards(window));
            last == before
        });
        window.key("v");
        window.wait_title(&format!("saved carom-elastic-{number}.gif"));
        window.wait("no dot", |window| !dot(window));
        let shown = window.still_screenshot();
        let path = window.folder.path().join(format!("carom-elastic-{number}.gif"));
        let last = last_picture(&path);
        // A GIF has few colours.
        let differs = |&(x, y): &(usize, usize)| {
            shown
                .at(x, y)
                .iter()
                .zip(&last[4 * (1280 * y + x)..])
                .any(|(one, other)| one.abs_diff(*other) > 40)
        };
        let places = (0..720).flat_map(|y| (0..1280).map(move |x| (x, y)));
        assert_eq!(places.filter(differs).count(), 0, "what was recorded last is what is seen");
        window.key("m");
        window.wait("the scene", |window| window.screenshot().at(5, 5) == BACKGROUND);
        assert!(!dot(&window));
    }
}

/// What the last frame of a recording shows, four bytes a pixel.
fn last_picture(path: &Path) -> Vec<u8> {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(std::fs::File::open(path).unwrap()).unwrap();
    let width = usize::from(decoder.width());
    let mut shown = vec![0; 4 * width * usize::from(decoder.height())];
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        let [left, top, across] = [frame.left, frame.top, frame.width].map(usize::from);
        for (row, pixels) in frame.buffer.chunks_exact(4 * across).enumerate() {
            for (column, pixel) in pixels.chunks_exact(4).enumerate().filter(|(_, pixel)| pixel[3] > 0) {
                let at = 4 * ((top + row) * width + left + column);
                shown[at..at + 4].copy_from_slice(pixel);
            }
        }
    }
    shown
}

/// The size of a recording in the window's folder.
fn size_of(window: &Window<'_>, name: &str) -> (u16, u16) {
    let file = std::fs::File::open(window.folder.path().join(name)).unwrap();
    let decoder = gif::DecodeOptions::new().read_info(file).unwrap();
    (decoder.width(), decoder.height())
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_window_that_is_resized_in_the_instant_in_which_a_recording_begins_goes_on_with_it() {
    let display = Display::start();
    let mut window = display.open(&["elastic"]);
    // Whether the key comes before the frame that follows the size is chance.
    for (number, size) in (1..).zip([800, 1000, 700, 900, 600, 800]) {
        let id = window.id.clone();
        window.mouse(&["windowsize", &id, &size.to_string(), "500", "key", "v"]);
        assert!((0..3).all(|_| window.moves()));
        window.key("v");
        let name = format!("carom-elastic-{number}.gif");
        window.wait_title(&format!("saved {name}"));
        assert!(!window.said().contains("size changed"), "{}", window.said());
        assert_eq!(size_of(&window, &name), (size, 500));
    }
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_folder_that_cannot_be_written_to_is_told_on_screen_and_the_window_goes_on() {
    let display = Display::start();
    let mut window = display.open(&["elastic", "--paused"]);
    // Gone, it takes no file, whoever asks.
    std::fs::remove_dir(window.folder.path()).unwrap();
    for (key, said) in [
        ("ctrl+s", "no scene saved: carom-elastic-1.toml"),
        ("F12", "no picture saved: carom-elastic-1.png"),
        ("v", "no recording: carom-elastic-1.gif"),
        ("ctrl+shift+s", "no replay saved: carom-elastic-1.replay"),
    ] {
        window.key(key);
        window.wait_title(said);
    }
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_watched_file_is_loaded_again_when_it_is_saved_and_kept_where_it_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    let scene = |balls: usize| {
        let ball = |index: usize| format!("[[ball]]\nposition = [{}, 200]\nradius = 10\n", 50 + 40 * index);
        format!("solver = \"exact\"\n{}", (0..balls).map(ball).collect::<String>())
    };
    std::fs::write(&path, scene(2)).unwrap();
    let display = Display::start();
    let mut window = display.open(&[path.to_str().unwrap(), "--watch", "--paused"]);
    window.wait_title("mine · exact · 2 balls");
    std::fs::write(&path, scene(5)).unwrap();
    window.wait_title("mine loaded again");
    window.wait_title("mine · exact · 5 balls");
    std::fs::write(&path, "gravity = \"down\"").unwrap();
    window.wait_title("mine.toml:1");
    window.wait_title("mine · exact · 5 balls");
    std::fs::write(&path, scene(3)).unwrap();
    window.wait_title("mine · exact · 3 balls");
}
