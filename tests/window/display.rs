//! A virtual X server, carom's window on it, keys and mouse for it, and screenshots of it.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use tiny_skia::Pixmap;

/// How long a condition is waited for: software graphics on a busy machine are slow.
pub const PATIENCE: Duration = Duration::from_secs(20);
/// The virtual screen: wider and higher than the window, whose corner is at its corner.
pub const SCREEN: (usize, usize) = (1400, 800);
pub const BACKGROUND: [u8; 3] = [0x1a, 0x1a, 0x1a];
pub const BALL: [u8; 3] = [0, 255, 212];
pub const CONTACT: [u8; 3] = [0xff, 0x66, 0xff];
/// What Xvfb shows where there is no window.
pub const NOTHING: [u8; 3] = [0, 0, 0];

/// The program that is tested: the one that was built with the tests, or another that `CAROM_PROGRAM` names.
pub fn program() -> String {
    std::env::var("CAROM_PROGRAM").unwrap_or_else(|_| env!("CARGO_BIN_EXE_carom").to_owned())
}

/// Waits until something is done.
pub fn wait(what: &str, mut done: impl FnMut() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(start.elapsed() < PATIENCE, "waited in vain for {what}");
        sleep(Duration::from_millis(30));
    }
}

/// An X server of our own, and the right to be the only one with two cores' worth of software graphics.
pub struct Display {
    server: Mutex<Child>,
    name: String,
    _alone: MutexGuard<'static, ()>,
}

static ALONE: Mutex<()> = Mutex::new(());

/// Waits until no other test has a display.
pub fn alone() -> MutexGuard<'static, ()> {
    // A test that failed has poisoned the lock; the others go on.
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Display {
    pub fn start() -> Self {
        let alone = alone();
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
        Self { server: Mutex::new(server), name: format!(":{}", number.trim()), _alone: alone }
    }

    pub fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("DISPLAY", &self.name).env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
        command
    }

    /// What a program prints.
    pub fn ask(&self, program: &str, args: &[&str]) -> Vec<u8> {
        let output = self.command(program).args(args).output();
        output.unwrap_or_else(|error| panic!("{program} is installed: {error}")).stdout
    }

    /// A window that says nothing over the picture, so that only what is played is seen.
    pub fn open(&self, args: &[&str]) -> Window<'_> {
        self.open_scaled(args, "1")
    }

    pub fn open_scaled(&self, args: &[&str], scale: &str) -> Window<'_> {
        let mut window = self.open_talking(&[args, &["--quiet"]].concat(), scale);
        if args.contains(&"--paused") {
            window.still_screenshot();
        }
        window
    }

    /// A window as users open it.
    pub fn open_talking(&self, args: &[&str], scale: &str) -> Window<'_> {
        self.open_with(args, &[("WINIT_X11_SCALE_FACTOR", scale)])
    }

    /// A window with these variables in its environment.
    pub fn open_with(&self, args: &[&str], variables: &[(&str, &str)]) -> Window<'_> {
        let folder = tempfile::tempdir().unwrap();
        // A pipe that nobody reads would fill, and stop who writes to it.
        let said = tempfile::NamedTempFile::new().unwrap();
        let child = self
            .command(&program())
            .args(args)
            .envs(variables.iter().copied())
            .current_dir(folder.path())
            .stderr(Stdio::from(said.reopen().unwrap()))
            .spawn()
            .unwrap();
        let mut window = Window { display: self, child, id: String::new(), folder, said };
        window.wait("a window", |window| {
            let found = String::from_utf8(self.ask("xdotool", &["search", "--name", "^carom"])).unwrap();
            found.lines().next().unwrap_or_default().clone_into(&mut window.id);
            !window.id.is_empty()
        });
        // Wherever a window manager has put it.
        window.wait("a first picture", |window| {
            let shown = window.screenshot();
            (0..SCREEN.1).any(|at| shown.at(at, at) != NOTHING)
        });
        self.ask("xdotool", &["windowfocus", "--sync", &window.id]);
        window
    }
}

impl Display {
    /// What X clients call it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Ends the server under its clients.
    pub fn fail(&self) {
        let mut server = self.server.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = server.kill();
        let _ = server.wait();
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        self.fail();
    }
}

/// carom, running.
pub struct Window<'a> {
    display: &'a Display,
    child: Child,
    pub id: String,
    pub folder: tempfile::TempDir,
    /// What it has said.
    said: tempfile::NamedTempFile,
}

impl Window<'_> {
    pub fn wait(&mut self, what: &str, mut done: impl FnMut(&mut Self) -> bool) {
        let start = Instant::now();
        while !done(self) {
            if let Some(status) = self.child.try_wait().unwrap() {
                panic!("carom ended with {status} while the test waited for {what}: {}", self.said());
            }
            assert!(start.elapsed() < PATIENCE, "waited in vain for {what}; the title is {}", self.title());
            sleep(Duration::from_millis(30));
        }
    }

    /// What it has said so far.
    pub fn said(&self) -> String {
        std::fs::read_to_string(self.said.path()).unwrap()
    }

    /// Waits for the end, and returns how it came and what was said.
    pub fn end_saying(&mut self) -> (ExitStatus, String) {
        let start = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                return (status, self.said());
            }
            assert!(start.elapsed() < PATIENCE, "carom does not end");
            sleep(Duration::from_millis(20));
        }
    }

    /// The names of the files in the folder that it runs in.
    pub fn files(&self) -> Vec<String> {
        let files = std::fs::read_dir(self.folder.path()).unwrap();
        files.map(|file| file.unwrap().file_name().into_string().unwrap()).collect()
    }

    /// Whether it runs.
    pub fn runs(&mut self) -> bool {
        self.child.try_wait().unwrap().is_none()
    }

    pub fn key(&self, key: &str) {
        self.display.ask("xdotool", &["key", key]);
    }

    pub fn mouse(&self, args: &[&str]) {
        self.display.ask("xdotool", args);
    }

    pub fn title(&self) -> String {
        String::from_utf8(self.display.ask("xdotool", &["getwindowname", &self.id]))
            .unwrap()
            .trim()
            .to_owned()
    }

    pub fn wait_title(&mut self, part: &str) {
        self.wait(&format!("{part:?} in the title"), |window| window.title().contains(part));
    }

    pub fn screenshot(&self) -> Screenshot {
        Screenshot(self.display.ask("import", &["-silent", "-window", "root", "-depth", "8", "rgb:-"]))
    }

    /// Waits until it leaves the processor alone, and checks that it goes on to do so. What it did before may still be
    /// under way, on a busy machine for long.
    pub fn wait_idle(&mut self) {
        let used = |window: &mut Self| {
            let before = window.processor_time();
            sleep(Duration::from_secs(2));
            window.processor_time() - before
        };
        self.wait("two seconds in which the processor is left alone", |window| used(window) <= 0.04);
        let used = used(self);
        assert!(used <= 0.04, "{used} s of processor time in 2 s, after it was idle");
    }

    /// Of a window whose picture stands still. A picture comes to the screen in parts: one that has just begun to be shown
    /// may be half of it.
    pub fn still_screenshot(&mut self) -> Screenshot {
        let mut last = self.screenshot();
        self.wait("the same picture twice", |window| {
            let before = std::mem::replace(&mut last, window.screenshot());
            last.0 == before.0
        });
        last
    }

    /// Waits until the picture stands still, and checks that it stays so.
    pub fn wait_still(&mut self) {
        self.wait("a picture that stands still", |window| !window.moves());
        assert!(!self.moves(), "it moves again");
    }

    /// Whether the picture changes within a second.
    pub fn moves(&self) -> bool {
        let before = self.screenshot();
        (0..10).any(|_| {
            sleep(Duration::from_millis(100));
            self.screenshot().0 != before.0
        })
    }

    pub fn resize(&self, width: &str, height: &str) {
        self.display.ask("xdotool", &["windowsize", "--sync", &self.id, width, height]);
    }

    /// Waits for the end, and returns how it came.
    pub fn end(mut self) -> ExitStatus {
        self.end_saying().0
    }

    /// Sends it a signal, by its name.
    pub fn signal(&self, name: &str) {
        self.display.ask("kill", &["-s", name, &self.child.id().to_string()]);
    }

    /// Resident memory, MB.
    pub fn memory(&self) -> f64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
        line.trim().trim_end_matches(" kB").parse::<f64>().unwrap() / 1024.0
    }

    /// Waits for the end, and keeps the folder that it ran in.
    pub fn keep_folder(mut self) -> tempfile::TempDir {
        let folder = std::mem::replace(&mut self.folder, tempfile::tempdir().unwrap());
        assert!(self.end().success());
        folder
    }

    /// Processor time used so far, s.
    pub fn processor_time(&self) -> f64 {
        processor_time(&self.child)
    }
}

/// Processor time that a program has used so far, s.
pub fn processor_time(child: &Child) -> f64 {
    let stat = std::fs::read_to_string(format!("/proc/{}/stat", child.id())).unwrap();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap().split_whitespace().collect();
    // Fields 14 and 15 of proc(5), in ticks of 1/100 s.
    (fields[11].parse::<f64>().unwrap() + fields[12].parse::<f64>().unwrap()) / 100.0
}

impl Drop for Window<'_> {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The screen, three bytes a pixel.
pub struct Screenshot(pub Vec<u8>);

impl Screenshot {
    pub fn at(&self, x: usize, y: usize) -> [u8; 3] {
        let offset = 3 * (y * SCREEN.0 + x);
        self.0.get(offset..offset + 3).map_or(NOTHING, |pixel| pixel.try_into().unwrap())
    }

    /// How many pixels of the screen have a ball's colour.
    pub fn ball_pixels(&self) -> usize {
        self.0.chunks_exact(3).filter(|&pixel| pixel == BALL || pixel == CONTACT).count()
    }

    /// The first pixel in which the screen differs from a picture in its corner.
    pub fn difference(&self, picture: &Pixmap) -> Option<(usize, usize, [u8; 3])> {
        let width = picture.width() as usize;
        picture.pixels().iter().enumerate().find_map(|(index, pixel)| {
            let (x, y) = (index % width, index / width);
            let expected = [pixel.red(), pixel.green(), pixel.blue()];
            (self.at(x, y) != expected).then_some((x, y, expected))
        })
    }
}

/// What `carom run` paints for the same arguments.
pub fn picture(args: &[&str]) -> Pixmap {
    let args = [&["run"], args, &["--seconds", "0", "--image", "-"]].concat();
    let output = Command::new(env!("CARGO_BIN_EXE_carom")).args(args).output().unwrap();
    Pixmap::decode_png(&output.stdout).unwrap()
}
