//! The real window on sway without a screen: a Wayland compositor whose outputs, keyboard and mouse the test has in hand.

mod hands;
mod mouse;
mod outputs;
mod shown;

use std::io::Read;
use std::ops::Range;
use std::os::unix::fs::{MetadataExt, chown};
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::MutexGuard;
use std::thread::sleep;
use std::time::{Duration, Instant};

use carom::Ball;
use serde_json::Value;
use tiny_skia::Pixmap;
use wayland_client::protocol::wl_pointer::{Axis, AxisSource, ButtonState};
use wayland_protocols_wlr::virtual_pointer::v1::client::zwlr_virtual_pointer_v1::ZwlrVirtualPointerV1;

use super::display::{BACKGROUND, PATIENCE, alone, processor_time, program, wait};
use super::files::balls_in;
use mouse::Mouse;

/// The output that there is from the beginning.
const FIRST: &str = "HEADLESS-1";

/// The first output, at 60 Hz; carom's window floats in its corner.
const CONFIG: &str = "
xwayland disable
output HEADLESS-1 mode --custom 1400x800@60Hz
output HEADLESS-1 position 0 0
default_border none
focus_follows_mouse no
for_window [app_id=\"carom\"] floating enable, border none, move absolute position 0 0
";

/// Whom sway runs as where the test runs as root, which it refuses to: nobody.
const NOBODY: u32 = 65_534;

/// Buttons of a mouse, by their numbers in Linux.
const LEFT: u32 = 0x110;
const RIGHT: u32 = 0x111;

/// A compositor of our own with a keyboard and a mouse.
struct Sway {
    child: Child,
    folder: tempfile::TempDir,
    /// A seat has a keyboard for as long as this runs; other keyboards come and go with each key.
    keyboard: Option<Child>,
    mouse: Option<Mouse>,
    _alone: MutexGuard<'static, ()>,
}

impl Sway {
    fn start() -> Self {
        let alone = alone();
        // Its sockets are here.
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("config"), CONFIG).unwrap();
        let mut command = Command::new("sway");
        command
            .args(["-c", "config"])
            .current_dir(folder.path())
            .env("XDG_RUNTIME_DIR", folder.path())
            .env("SWAYSOCK", folder.path().join("ipc"))
            .envs([
                ("WLR_BACKENDS", "headless"),
                ("WLR_LIBINPUT_NO_DEVICES", "1"),
                ("WLR_RENDERER", "pixman"),
            ])
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        if folder.path().metadata().unwrap().uid() == 0 {
            chown(folder.path(), Some(NOBODY), Some(NOBODY)).unwrap();
            command.uid(NOBODY).gid(NOBODY);
        }
        let child = command.spawn().expect("sway is installed");
        let mut sway = Self { child, folder, keyboard: None, mouse: None, _alone: alone };
        wait("the compositor", || sway.answers("get_outputs")[0]["active"] == true);
        sway.mouse = Some(Mouse::plug_in(&sway.folder.path().join("wayland-1")));
        sway.keyboard =
            Some(sway.command("wtype").args(["-s", "3600000"]).spawn().expect("wtype is installed"));
        wait("a keyboard and a mouse", || sway.answers("get_seats")[0]["capabilities"] == 3);
        sway
    }

    fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command
            .env("XDG_RUNTIME_DIR", self.folder.path())
            .env("WAYLAND_DISPLAY", "wayland-1")
            .env("SWAYSOCK", self.folder.path().join("ipc"))
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_SOCKET");
        command
    }

    /// What it answers to a question of `swaymsg`; null where it does not yet.
    fn answers(&self, question: &str) -> Value {
        let output = self.command("swaymsg").args(["-r", "-t", question]).output().unwrap();
        serde_json::from_slice(&output.stdout).unwrap_or_default()
    }

    /// Has it do this.
    fn tell(&self, order: &str) {
        let output = self.command("swaymsg").args(["-r", "--", order]).output().unwrap();
        assert!(output.status.success(), "{order}: {}", String::from_utf8_lossy(&output.stdout));
    }

    /// What an output shows, in its own pixels.
    fn screenshot(&self, output: &str) -> Pixmap {
        let shot = self.command("grim").args(["-o", output, "-l", "0", "-"]).output();
        Pixmap::decode_png(&shot.expect("grim is installed").stdout).unwrap()
    }

    /// Presses keys together and lets them go: `ctrl+shift+s`.
    fn key(&self, keys: &str) {
        let (modifiers, key) = keys.rsplit_once('+').unwrap_or(("", keys));
        let mut wtype = self.command("wtype");
        for modifier in modifiers.split_terminator('+') {
            wtype.args(["-M", modifier]);
        }
        assert!(wtype.args(["-k", key]).status().unwrap().success(), "{keys}");
    }

    /// Presses a key on a keyboard of its own, which lets it go when its input ends.
    fn hold(&self, key: &str) -> Child {
        let mut wtype = self.command("wtype");
        wtype.args(["-P", key, "-", "-p", key]).stdin(Stdio::piped()).spawn().unwrap()
    }

    /// Moves the pointer to a whole px of the layout of outputs.
    fn point(&self, x: f64, y: f64) {
        let outputs = self.answers("get_outputs");
        let extent = |from, extent| {
            let end = |output: &Value| {
                output["rect"][from].as_u64().unwrap() + output["rect"][extent].as_u64().unwrap()
            };
            outputs.as_array().unwrap().iter().map(end).max().unwrap() as u32
        };
        let (width, height) = (extent("x", "width"), extent("y", "height"));
        self.mouse(|pointer| pointer.motion_absolute(0, x as u32, y as u32, width, height));
    }

    fn button(&self, button: u32, state: ButtonState) {
        self.mouse(|pointer| pointer.button(0, button, state));
    }

    fn press(&self) {
        self.button(LEFT, ButtonState::Pressed);
    }

    fn release(&self) {
        self.button(LEFT, ButtonState::Released);
    }

    fn click(&self, button: u32) {
        self.button(button, ButtonState::Pressed);
        self.button(button, ButtonState::Released);
    }

    /// Turns the wheel by so many notches away from the hand.
    fn turn_wheel(&self, notches: i32) {
        self.mouse(|pointer| {
            pointer.axis_source(AxisSource::Wheel);
            pointer.axis_discrete(0, Axis::VerticalScroll, -15.0 * f64::from(notches), -notches);
        });
    }

    fn mouse(&self, does: impl FnOnce(&ZwlrVirtualPointerV1)) {
        self.mouse.as_ref().unwrap().does(does);
    }

    /// A window that says nothing over the picture.
    fn open(&self, args: &[&str]) -> Window<'_> {
        let folder = tempfile::tempdir().unwrap();
        let mut command = self.command(&program());
        command.args(args).arg("--quiet").current_dir(folder.path()).stderr(Stdio::piped());
        let mut window = Window { sway: self, child: command.spawn().unwrap(), folder };
        window.wait("a focused window with a title", |window| {
            let node = window.node();
            node["focused"] == true && node["name"].as_str().is_some_and(|name| name.contains('·'))
        });
        window
    }
}

impl Drop for Sway {
    fn drop(&mut self) {
        for child in self.keyboard.iter_mut().chain([&mut self.child]) {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// carom, running on sway.
struct Window<'a> {
    sway: &'a Sway,
    child: Child,
    folder: tempfile::TempDir,
}

impl Window<'_> {
    /// What sway knows of it.
    fn node(&self) -> Value {
        fn find(node: &Value) -> Option<&Value> {
            let inside = ["nodes", "floating_nodes"].iter().filter_map(|kind| node[kind].as_array());
            if node["app_id"] == "carom" { Some(node) } else { inside.flatten().find_map(find) }
        }
        find(&self.sway.answers("get_tree")).cloned().unwrap_or_default()
    }

    fn title(&self) -> String {
        self.node()["name"].as_str().unwrap_or_default().to_owned()
    }

    fn wait(&mut self, what: &str, mut done: impl FnMut(&mut Self) -> bool) {
        let start = Instant::now();
        while !done(self) {
            if let Some(status) = self.child.try_wait().unwrap() {
                let mut said = String::new();
                let _ = self.child.stderr.take().unwrap().read_to_string(&mut said);
                panic!("carom ended with {status} while the test waited for {what}: {said}");
            }
            assert!(start.elapsed() < PATIENCE, "waited in vain for {what}; the title is {}", self.title());
            sleep(Duration::from_millis(20));
        }
    }

    fn wait_title(&mut self, part: &str) {
        self.wait(&format!("{part:?} in the title"), |window| window.title().contains(part));
    }

    /// The balls of the scene that Ctrl+S saves now, under this number.
    fn saved_balls(&mut self, scene: &str, number: u32) -> Vec<Ball> {
        let name = format!("carom-{scene}-{number}.toml");
        self.sway.key("ctrl+s");
        self.wait_title(&format!("saved {name}"));
        balls_in(&self.folder.path().join(name))
    }

    /// The name of the replay that Ctrl+Shift+S saves now, under this number, and its lines.
    fn saved_replay(&mut self, scene: &str, number: u32) -> (String, Vec<String>) {
        let name = format!("carom-{scene}-{number}.replay");
        self.sway.key("ctrl+shift+s");
        self.wait_title(&format!("saved {name}"));
        let text = std::fs::read_to_string(self.folder.path().join(&name)).unwrap();
        (name, text.lines().map(str::to_owned).collect())
    }

    /// Waits for the end, and returns how it came.
    fn end(&mut self) -> ExitStatus {
        wait("the end", || self.child.try_wait().unwrap().is_some());
        self.child.wait().unwrap()
    }

    /// Frames per second, once this is their number.
    fn wait_rate(&mut self, rates: Range<u32>) {
        self.wait(&format!("{rates:?} frames per second"), |window| {
            let title = window.title();
            let rate = title.strip_suffix(" fps").and_then(|title| title.rsplit(' ').next());
            rate.is_some_and(|rate| rates.contains(&rate.parse().unwrap()))
        });
    }

    /// Whether the window is so many of its output's pixels large and the picture fills it: background up to its
    /// corners, where scaling may blend the last pixels, and none behind them.
    fn fills(&self, output: &str, (width, height): (u32, u32)) -> bool {
        let shown = self.sway.screenshot(output);
        let is_ours = |x, y| colour(&shown, x, y) == Some(BACKGROUND);
        let corners = [(2, 2), (width - 2, 2), (2, height - 2), (width - 2, height - 2)];
        let behind = [(width + 1, 2), (2, height + 1)];
        corners.iter().all(|&(x, y)| is_ours(x, y)) && !behind.iter().any(|&(x, y)| is_ours(x, y))
    }

    /// Processor time used so far, s.
    fn processor_time(&self) -> f64 {
        processor_time(&self.child)
    }
}

impl Drop for Window<'_> {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A pixel's colour, where there is one.
fn colour(picture: &Pixmap, x: u32, y: u32) -> Option<[u8; 3]> {
    let pixel = picture.pixel(x, y).filter(|_| x < picture.width())?;
    Some([pixel.red(), pixel.green(), pixel.blue()])
}

/// The seconds of each frame in a replay's lines.
fn deltas(lines: &[String]) -> Vec<f64> {
    let frames = lines.iter().filter_map(|line| line.strip_prefix("frame "));
    frames.map(|frame| frame.split(' ').next().unwrap().parse().unwrap()).collect()
}
