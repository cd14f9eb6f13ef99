//! The real window on Wayland: on weston without a screen, the protocol's reference. Nothing there can press keys; that a
//! window opens, shows its frames and ends is what can be tested. The rest is, on `sway`.

use std::process::{Child, Command, Stdio};

use tiny_skia::Pixmap;

use super::display::{BACKGROUND, BALL, program, wait};

/// A compositor of our own.
struct Compositor {
    weston: Child,
    folder: tempfile::TempDir,
}

impl Compositor {
    fn start() -> Self {
        // Its sockets are here, and its screenshots.
        let folder = tempfile::tempdir().unwrap();
        let mut weston = Command::new("weston");
        weston
            .args(["--backend=headless-backend.so", "--socket=carom", "--width=1400", "--height=900"])
            .args(["--use-pixman", "--idle-time=0", "--no-config", "--debug"])
            .env("XDG_RUNTIME_DIR", folder.path())
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        let weston = weston.spawn().expect("weston is installed");
        let compositor = Self { weston, folder };
        wait("the compositor's socket", || compositor.folder.path().join("carom").exists());
        compositor
    }

    fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command
            .env("XDG_RUNTIME_DIR", self.folder.path())
            .env("WAYLAND_DISPLAY", "carom")
            .env_remove("DISPLAY")
            .current_dir(self.folder.path());
        command
    }

    fn open(&self) -> Child {
        let mut carom = self.command(&program());
        carom.args(["elastic", "--quiet"]).stderr(Stdio::piped()).spawn().unwrap()
    }

    /// What is on its screen.
    fn screenshot(&self) -> Option<Pixmap> {
        let _ = self.command("weston-screenshooter").output().expect("weston has it");
        let files = std::fs::read_dir(self.folder.path()).unwrap();
        let mut pictures = files.map(|file| file.unwrap().path());
        let path = pictures.find(|path| path.extension().is_some_and(|end| end == "png"))?;
        let picture = Pixmap::load_png(&path).ok();
        std::fs::remove_file(path).unwrap();
        picture
    }
}

impl Drop for Compositor {
    fn drop(&mut self) {
        let _ = self.weston.kill();
        let _ = self.weston.wait();
    }
}

/// How many pixels have this colour.
pub fn count(picture: &Pixmap, colour: [u8; 3]) -> usize {
    let is = |pixel: &&tiny_skia::PremultipliedColorU8| [pixel.red(), pixel.green(), pixel.blue()] == colour;
    picture.pixels().iter().filter(is).count()
}

#[test]
#[ignore = "needs weston; run with --ignored"]
fn on_wayland_balls_are_shown_and_move_and_a_signal_ends_the_window() {
    let compositor = Compositor::start();
    let mut carom = compositor.open();
    let shows = |picture: &Pixmap| count(picture, BACKGROUND) > 500_000 && count(picture, BALL) > 10_000;
    let mut last = None;
    wait("balls on the screen", || {
        last = compositor.screenshot().filter(|picture| shows(picture));
        last.is_some()
    });
    wait("balls elsewhere", || {
        let now = compositor.screenshot();
        now.is_some_and(|now| shows(&now) && Some(now.data()) != last.as_ref().map(Pixmap::data))
    });
    assert!(carom.try_wait().unwrap().is_none());
    compositor.command("kill").args(["-s", "TERM", &carom.id().to_string()]).status().unwrap();
    wait("the end", || carom.try_wait().unwrap().is_some());
}

#[test]
#[ignore = "needs weston; run with --ignored"]
fn on_wayland_a_compositor_that_ends_is_told() {
    let mut compositor = Compositor::start();
    let mut carom = compositor.open();
    wait("balls on the screen", || {
        compositor.screenshot().is_some_and(|picture| count(&picture, BALL) > 10_000)
    });
    let _ = compositor.weston.kill();
    wait("the end", || carom.try_wait().unwrap().is_some());
    let output = carom.wait_with_output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("the display that the window was on is gone") && !said.contains("panic"), "{said}");
}
