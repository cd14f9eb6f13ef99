//! The real window: opened on a virtual X server, sent real keys, looked at in screenshots.
//!
//! These tests need Xvfb, xdotool, xprop, the `import` of imagemagick and a Vulkan driver (README, "Tests"), so plain
//! `cargo test` leaves them out and says so. `cargo test --test window -- --ignored` runs them.
#![cfg(all(feature = "window", target_os = "linux"))]

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use tiny_skia::Pixmap;

/// How long a condition is waited for: software graphics on a busy machine are slow.
const PATIENCE: Duration = Duration::from_secs(20);
/// The virtual screen: wider and higher than the window, whose corner is at its corner.
const SCREEN: (usize, usize) = (1400, 800);
const BACKGROUND: [u8; 3] = [0x1a, 0x1a, 0x1a];
const BALL: [u8; 3] = [0, 255, 212];
const CONTACT: [u8; 3] = [0xff, 0x66, 0xff];
/// What Xvfb shows where there is no window.
const NOTHING: [u8; 3] = [0, 0, 0];

/// An X server of our own, and the right to be the only one with two cores' worth of software graphics.
struct Display {
    server: Child,
    name: String,
    _alone: MutexGuard<'static, ()>,
}

static ALONE: Mutex<()> = Mutex::new(());

impl Display {
    fn start() -> Self {
        // A test that failed has poisoned the lock; the others go on.
        let alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let screen = format!("{}x{}x24", SCREEN.0, SCREEN.1);
        // Without -noreset the server starts anew, and refuses connections meanwhile, whenever its last client leaves.
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", &screen, "-nolisten", "tcp", "-noreset"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb is installed");
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        Self { server, name: format!(":{}", number.trim()), _alone: alone }
    }

    fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("DISPLAY", &self.name).env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
        command
    }

    /// What a program prints.
    fn ask(&self, program: &str, args: &[&str]) -> Vec<u8> {
        let output = self.command(program).args(args).output();
        output.unwrap_or_else(|error| panic!("{program} is installed: {error}")).stdout
    }

    fn open(&self, args: &[&str]) -> Window<'_> {
        self.open_scaled(args, "1")
    }

    fn open_scaled(&self, args: &[&str], scale: &str) -> Window<'_> {
        let folder = tempfile::tempdir().unwrap();
        let child = self
            .command(env!("CARGO_BIN_EXE_carom"))
            .args(args)
            .env("WINIT_X11_SCALE_FACTOR", scale)
            .current_dir(folder.path())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut window = Window { display: self, child, id: String::new(), folder };
        window.wait("a window", |window| {
            let found = String::from_utf8(self.ask("xdotool", &["search", "--name", "^carom"])).unwrap();
            found.lines().next().unwrap_or_default().clone_into(&mut window.id);
            !window.id.is_empty()
        });
        window.wait("a first picture", |window| window.screenshot().at(1, 1) != NOTHING);
        self.ask("xdotool", &["windowfocus", "--sync", &window.id]);
        window
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// carom, running.
struct Window<'a> {
    display: &'a Display,
    child: Child,
    id: String,
    folder: tempfile::TempDir,
}

impl Window<'_> {
    fn wait(&mut self, what: &str, mut done: impl FnMut(&mut Self) -> bool) {
        let start = Instant::now();
        while !done(self) {
            if let Some(status) = self.child.try_wait().unwrap() {
                panic!("carom ended with {status} while the test waited for {what}: {}", self.said());
            }
            assert!(start.elapsed() < PATIENCE, "waited in vain for {what}; the title is {}", self.title());
            sleep(Duration::from_millis(30));
        }
    }

    fn said(&mut self) -> String {
        let mut said = String::new();
        if let Some(stderr) = &mut self.child.stderr {
            let _ = stderr.read_to_string(&mut said);
        }
        said
    }

    fn key(&self, key: &str) {
        self.display.ask("xdotool", &["key", key]);
    }

    fn mouse(&self, args: &[&str]) {
        self.display.ask("xdotool", args);
    }

    fn title(&self) -> String {
        String::from_utf8(self.display.ask("xdotool", &["getwindowname", &self.id]))
            .unwrap()
            .trim()
            .to_owned()
    }

    fn wait_title(&mut self, part: &str) {
        self.wait(&format!("{part:?} in the title"), |window| window.title().contains(part));
    }

    fn screenshot(&self) -> Screenshot {
        Screenshot(self.display.ask("import", &["-silent", "-window", "root", "-depth", "8", "rgb:-"]))
    }

    /// Whether the picture changes within a second.
    fn moves(&self) -> bool {
        let before = self.screenshot();
        (0..10).any(|_| {
            sleep(Duration::from_millis(100));
            self.screenshot().0 != before.0
        })
    }

    fn resize(&self, width: &str, height: &str) {
        self.display.ask("xdotool", &["windowsize", "--sync", &self.id, width, height]);
    }

    /// Waits for the end, and returns how it came.
    fn end(mut self) -> ExitStatus {
        let start = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status;
            }
            assert!(start.elapsed() < PATIENCE, "carom does not end");
            sleep(Duration::from_millis(20));
        }
    }

    /// Processor time used so far, s.
    fn processor_time(&self) -> f64 {
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", self.child.id())).unwrap();
        let fields: Vec<&str> = stat.rsplit(')').next().unwrap().split_whitespace().collect();
        // Fields 14 and 15 of proc(5), in ticks of 1/100 s.
        (fields[11].parse::<f64>().unwrap() + fields[12].parse::<f64>().unwrap()) / 100.0
    }
}

impl Drop for Window<'_> {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The screen, three bytes a pixel.
struct Screenshot(Vec<u8>);

impl Screenshot {
    fn at(&self, x: usize, y: usize) -> [u8; 3] {
        let offset = 3 * (y * SCREEN.0 + x);
        self.0.get(offset..offset + 3).map_or(NOTHING, |pixel| pixel.try_into().unwrap())
    }

    /// How many pixels of the screen have a ball's colour.
    fn ball_pixels(&self) -> usize {
        self.0.chunks_exact(3).filter(|&pixel| pixel == BALL || pixel == CONTACT).count()
    }

    /// The first pixel in which the screen differs from a picture in its corner.
    fn difference(&self, picture: &Pixmap) -> Option<(usize, usize, [u8; 3])> {
        let width = picture.width() as usize;
        picture.pixels().iter().enumerate().find_map(|(index, pixel)| {
            let (x, y) = (index % width, index / width);
            let expected = [pixel.red(), pixel.green(), pixel.blue()];
            (self.at(x, y) != expected).then_some((x, y, expected))
        })
    }
}

/// What `carom run` paints for the same arguments.
fn picture(args: &[&str]) -> Pixmap {
    let args = [&["run"], args, &["--seconds", "0", "--image", "-"]].concat();
    let output = Command::new(env!("CARGO_BIN_EXE_carom")).args(args).output().unwrap();
    Pixmap::decode_png(&output.stdout).unwrap()
}

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
fn space_stops_time_and_lets_it_go_on_and_r_restores_the_scene() {
    let display = Display::start();
    let mut window = display.open(&["elastic"]);
    assert!(window.moves());
    window.key("space");
    window.wait_title("paused");
    sleep(Duration::from_millis(300));
    assert!(!window.moves(), "nothing moves while paused");
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
fn a_paused_window_leaves_the_processor_alone() {
    let display = Display::start();
    let mut window = display.open(&["gravity", "--paused"]);
    window.wait_title("paused");
    sleep(Duration::from_millis(500));
    let before = window.processor_time();
    sleep(Duration::from_secs(2));
    let used = window.processor_time() - before;
    assert!(used <= 0.04, "{used} s of processor time in 2 s");
}

/// How many frames a window of two seconds with these arguments presents.
fn frames_presented(display: &Display, args: &[&str]) -> u32 {
    let mut window = display.open(&[args, &["--timings"]].concat());
    sleep(Duration::from_secs(2));
    window.key("Escape");
    let said = window.said();
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
    let window = display.open(&["elastic"]);
    assert!(window.moves());
    let set = ["-f", "_NET_WM_STATE", "32a", "-set", "_NET_WM_STATE", "_NET_WM_STATE_HIDDEN"];
    display.ask("xprop", &[&["-id", &window.id], &set[..]].concat());
    sleep(Duration::from_millis(300));
    let before = window.processor_time();
    assert!(!window.moves(), "nothing moves while minimised");
    let used = window.processor_time() - before;
    assert!(used <= 0.04, "{used} s of processor time while minimised");
    display.ask("xprop", &["-id", &window.id, "-remove", "_NET_WM_STATE"]);
    sleep(Duration::from_millis(300));
    assert!(window.moves(), "it goes on without a key or the mouse");
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

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn pictures_are_saved_and_overwrite_nothing() {
    let display = Display::start();
    let mut window = display.open(&["gravity", "--paused"]);
    window.key("F12");
    window.wait_title("saved carom-gravity-1.png");
    window.key("F12");
    window.wait_title("saved carom-gravity-2.png");
    let saved = Pixmap::load_png(window.folder.path().join("carom-gravity-1.png")).unwrap();
    assert_eq!(saved.data(), picture(&["gravity"]).data());
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

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn escape_ends_with_0() {
    let display = Display::start();
    let window = display.open(&[]);
    window.key("Escape");
    assert!(window.end().success());
}

/// What carom says without a display and with a display that does not answer.
#[test]
fn without_a_display_the_message_says_what_to_do_instead() {
    for display in [None, Some(":4321")] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_carom"));
        command
            .arg("elastic")
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET");
        if let Some(display) = display {
            command.env("DISPLAY", display);
        }
        let output = command.output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{said}");
        // Where the keyboard's library is missing, that is said first.
        assert!(
            said.contains("no display to open a window on") || said.contains("apt install libxkbcommon"),
            "{said}"
        );
        assert!(said.contains("carom run elastic --gif elastic.gif"), "{said}");
        assert!(!said.contains(".rs:"), "no place in somebody's source: {said}");
    }
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn without_a_graphics_adapter_the_message_says_what_to_install() {
    let display = Display::start();
    let mut command = display.command(env!("CARGO_BIN_EXE_carom"));
    // No Vulkan driver, and no other backend.
    let command = command.env("VK_DRIVER_FILES", "/dev/null").env("VK_ICD_FILENAMES", "/dev/null");
    let output = command.env("WGPU_BACKEND", "vulkan").output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("no graphics adapter") && said.contains("mesa-vulkan-drivers"), "{said}");
    assert!(said.contains("carom run gravity --gif gravity.gif"), "{said}");
}
