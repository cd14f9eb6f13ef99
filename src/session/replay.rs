//! A session as a file: every frame and every change since the scene began, to be played again to the bit.
//!
//! A replay is text, an entry a line: first what it starts from, then what happened, in order. Numbers are written in
//! the shortest form that reads back to the same `f64`.

use std::fmt::{Display, Write};
use std::fs::File;
use std::io::{self, Read};
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use std::str::{FromStr, SplitWhitespace};

use glam::DVec2;
use thiserror::Error;

use super::command::Change;
use super::state::State;
use super::tape::{Entry, Frame};
use crate::scene::{Scene, SceneError};
use crate::simulation::limits::DELTA;
use crate::simulation::{Ball, Simulation, World};

/// The first line of every replay.
const FIRST_LINE: &str = "carom replay 1";
/// The longest file, bytes: a day at 60 frames per second.
const LONGEST_FILE: u64 = 1 << 27;

/// What was played, to be played again.
#[derive(Debug, Clone)]
pub struct Replay {
    scene: Scene,
    state: State,
    entries: Vec<Entry>,
    at: usize,
}

/// Why a replay cannot be played.
#[derive(Debug, Error)]
pub enum ReplayError {
    /// The file cannot be read.
    #[error("{}: {source}; give a replay that the window saved with Ctrl+Shift+S", path.display())]
    Unreadable {
        /// The file's path.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The file is longer than any replay.
    #[error("{} is longer than {LONGEST_FILE} bytes: too long for a replay", path.display())]
    TooLong {
        /// The file's path.
        path: PathBuf,
    },
    /// A line is not what it should be.
    #[error("{}:{line}: {message}", path.display())]
    Line {
        /// The file's path.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong, and what to write instead.
        message: String,
    },
    /// It was recorded with another scene.
    #[error(
        "{} was recorded in the scene {recorded}, from other balls than {given} has now; \
         run carom run {recorded} --commands {0}",
        path.display()
    )]
    OtherScene {
        /// The replay's path.
        path: PathBuf,
        /// The scene that it was recorded with.
        recorded: String,
        /// The scene that was given.
        given: String,
    },
    /// The scene's balls do not fit.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

/// The text of a replay that began with `scene`.
pub(super) fn write<'a>(scene: &Scene, seed: u64, entries: impl Iterator<Item = &'a Entry>) -> String {
    let mut text = format!("{FIRST_LINE}\nscene {}\nsolver {}\n", scene.argument(), scene.solver());
    let DVec2 { x, y } = scene.world().size();
    text += &format!("size {x} {y}\n");
    if let Some((count, seed)) = scene.added() {
        text += &format!("balls {count} {seed}\n");
    }
    text += &format!("seed {seed}\n");
    if let Ok(simulation) = scene.build() {
        text += &format!("start {:016x}\n", fingerprint(&simulation));
    }
    for entry in entries {
        match entry {
            Entry::Frame(Frame { seconds, cut: None }) => text += &format!("frame {seconds}"),
            Entry::Frame(Frame { seconds, cut: Some(cut) }) => text += &format!("frame {seconds} {cut}"),
            Entry::Change(change) => write_change(&mut text, change),
        }
        text.push('\n');
    }
    text
}

fn write_change(text: &mut String, change: &Change) {
    // Writing to a string does not fail.
    let _ = match *change {
        Change::Reset => write!(text, "reset"),
        Change::Reseed(seed) => write!(text, "reseed {seed}"),
        Change::AddRandom(count) => write!(text, "add-random {count}"),
        Change::AddBall { position: p, velocity: v, radius } => {
            write!(text, "add-ball {} {} {} {} {radius}", p.x, p.y, v.x, v.y)
        }
        Change::RemoveLast => write!(text, "remove-last"),
        Change::Remove(index) => write!(text, "remove {index}"),
        Change::Carry { ball, to } => write!(text, "carry {ball} {} {}", to.x, to.y),
        Change::Place { ball, at } => write!(text, "place {ball} {} {}", at.x, at.y),
        Change::Solver(solver) => write!(text, "solver {solver}"),
        Change::ToggleGravity => write!(text, "toggle-gravity"),
        Change::TiltGravity(by) => write!(text, "tilt-gravity {} {}", by.x, by.y),
        Change::Resize(size) => write!(text, "resize {} {}", size.x, size.y),
        Change::Compare(on) => write!(text, "compare {}", if on { "on" } else { "off" }),
    };
}

/// A line that is being read, word by word.
struct Line<'a> {
    words: SplitWhitespace<'a>,
}

impl Line<'_> {
    /// The next word, as `what` it should be.
    fn next<T: FromStr>(&mut self, what: &str) -> Result<T, String> {
        let word = self.words.next().ok_or_else(|| format!("{what} is missing"))?;
        word.parse().map_err(|_| format!("\"{word}\" is not {what}"))
    }

    /// The next word as a finite number.
    fn number(&mut self, what: &str) -> Result<f64, String> {
        let number: f64 = self.next(what)?;
        if number.is_finite() { Ok(number) } else { Err(format!("{number} is not {what}")) }
    }

    fn vector(&mut self, what: &str) -> Result<DVec2, String> {
        Ok(DVec2::new(self.number(what)?, self.number(what)?))
    }

    /// That nothing more is there.
    fn end(&mut self) -> Result<(), String> {
        self.words.next().map_or(Ok(()), |word| Err(format!("\"{word}\" is one word too many")))
    }
}

fn read_entry(keyword: &str, line: &mut Line<'_>) -> Result<Entry, String> {
    let change = match keyword {
        "frame" => {
            let seconds = DELTA.check(line.number("a delta in seconds")?).map_err(in_words)?;
            let cut = line.words.next().map(|word| word.parse::<NonZeroU32>().map_err(|_| word));
            let cut = cut.transpose().map_err(|word| format!("\"{word}\" is not a count from 1"))?;
            return Ok(Entry::Frame(Frame { seconds, cut }));
        }
        "reset" => Change::Reset,
        "reseed" => Change::Reseed(line.next("a seed")?),
        "add-random" => Change::AddRandom(line.next("a number of balls")?),
        "add-ball" => Change::AddBall {
            position: line.vector("a position in px")?,
            velocity: line.vector("a velocity in px/s")?,
            radius: line.number("a radius in px")?,
        },
        "remove-last" => Change::RemoveLast,
        "remove" => Change::Remove(line.next("a ball's index")?),
        "carry" => Change::Carry { ball: line.next("a ball's index")?, to: line.vector("a place in px")? },
        "place" => Change::Place { ball: line.next("a ball's index")?, at: line.vector("a place in px")? },
        "solver" => Change::Solver(line.next("a solver")?),
        "toggle-gravity" => Change::ToggleGravity,
        "tilt-gravity" => Change::TiltGravity(line.vector("an acceleration in px/s²")?),
        "resize" => Change::Resize(line.vector("a size in px")?),
        "compare" => match line.next::<String>("on or off")?.as_str() {
            "on" => Change::Compare(true),
            "off" => Change::Compare(false),
            word => return Err(format!("\"{word}\" is not on or off")),
        },
        _ => return Err(format!("\"{keyword}\" is nothing that can happen; write frame, reset, add-ball …")),
    };
    Ok(Entry::Change(Box::new(change)))
}

fn in_words(error: impl Display) -> String {
    error.to_string()
}

/// What a replay starts from, as far as it differs from the scene.
#[derive(Default)]
struct Header {
    scene: String,
    seed: u64,
    fingerprint: Option<u64>,
}

impl Replay {
    /// Reads a replay of this scene: solver, size and added balls are those that it was recorded with.
    ///
    /// # Errors
    /// [`ReplayError`] where the file cannot be read, is not a replay, or begins with other balls than the scene has.
    pub fn read(path: &Path, scene: &Scene) -> Result<Self, ReplayError> {
        let unreadable = |source| ReplayError::Unreadable { path: path.to_owned(), source };
        let mut text = String::new();
        let file = File::open(path).map_err(unreadable)?;
        file.take(LONGEST_FILE + 1).read_to_string(&mut text).map_err(unreadable)?;
        if text.len() as u64 > LONGEST_FILE {
            return Err(ReplayError::TooLong { path: path.to_owned() });
        }
        Self::parse(path, &text, scene)
    }

    /// A replay from its text; messages call it `path`.
    ///
    /// # Errors
    /// [`ReplayError`] as for [`read`](Self::read).
    pub fn parse(path: &Path, text: &str, scene: &Scene) -> Result<Self, ReplayError> {
        let wrong = |line, message| ReplayError::Line { path: path.to_owned(), line, message };
        let mut lines = (1..).zip(text.lines());
        if lines.next().is_none_or(|(_, first)| first.trim_end() != FIRST_LINE) {
            return Err(wrong(1, format!("this is not a replay, which begins with \"{FIRST_LINE}\"")));
        }
        let (mut header, mut start, mut entries) = (Header::default(), scene.clone(), Vec::new());
        let mut in_header = true;
        for (number, text) in lines {
            let mut line = Line { words: text.split_whitespace() };
            let Some(keyword) = line.words.next().filter(|word| !word.starts_with('#')) else { continue };
            if in_header {
                let read = read_header(keyword, text, &mut line, &mut header, &mut start);
                in_header = read.map_err(|message| wrong(number, message))?;
            }
            if !in_header {
                let entry = read_entry(keyword, &mut line).map_err(|message| wrong(number, message))?;
                line.end().map_err(|message| wrong(number, message))?;
                entries.push(entry);
            }
        }
        let state = State::new(&start, header.seed)?;
        if header.fingerprint.is_some_and(|recorded| recorded != fingerprint(&state.simulation)) {
            return Err(ReplayError::OtherScene {
                path: path.to_owned(),
                recorded: header.scene,
                given: scene.argument().to_owned(),
            });
        }
        Ok(Self { scene: start, state, entries, at: 0 })
    }

    /// The scene that is played, as the replay wants it.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The simulation as it is now.
    #[must_use]
    pub fn simulation(&self) -> &Simulation {
        &self.state.simulation
    }

    /// The number of frames.
    #[must_use]
    pub fn frames(&self) -> u64 {
        self.entries.iter().filter(|entry| matches!(entry, Entry::Frame(_))).count() as u64
    }

    /// Plays on to the end of the next frame; whether there was one. Changes behind the last frame take place, too.
    ///
    /// # Errors
    /// [`OutOfRange`](crate::OutOfRange) where a delta is refused.
    pub fn advance(&mut self) -> Result<bool, crate::OutOfRange> {
        while let Some(entry) = self.entries.get(self.at) {
            self.at += 1;
            match entry {
                Entry::Frame(frame) => return frame.repeat(&mut self.state).map(|_| true),
                // What was refused then is refused again.
                Entry::Change(change) => drop(self.state.apply(**change)),
            }
        }
        Ok(false)
    }
}

/// Reads a line of the header, where it is one; whether it was.
fn read_header(
    keyword: &str,
    text: &str,
    line: &mut Line<'_>,
    header: &mut Header,
    scene: &mut Scene,
) -> Result<bool, String> {
    let changed = match keyword {
        // It may have spaces.
        "scene" => {
            text.trim_start().trim_start_matches("scene").trim().clone_into(&mut header.scene);
            return Ok(true);
        }
        "solver" => scene.clone().with_solver(line.next("a solver")?),
        "size" => scene.clone().with_size(line.vector("a size in px")?).map_err(in_words)?,
        "balls" => scene.clone().with_added(line.next("a number of balls")?, Some(line.next("a seed")?)),
        "seed" => {
            header.seed = line.next("a seed")?;
            scene.clone()
        }
        "start" => {
            let word: String = line.next("a fingerprint")?;
            let number = u64::from_str_radix(&word, 16);
            header.fingerprint = Some(number.map_err(|_| format!("\"{word}\" is not a fingerprint"))?);
            scene.clone()
        }
        _ => return Ok(false),
    };
    line.end()?;
    *scene = changed;
    Ok(true)
}

/// A number that other balls, or another world, hardly share (Fowler, Noll, Vo 1991: FNV-1a).
fn fingerprint(simulation: &Simulation) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |number: f64| {
        for byte in number.to_bits().to_le_bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    let world: &World = simulation.world();
    let (size, gravity) = (world.size(), world.gravity().unwrap_or_default());
    for number in [size.x, size.y, gravity.x, gravity.y, world.walls().unwrap_or(-1.0)] {
        add(number);
    }
    for ball in simulation.balls() {
        let (position, velocity): (DVec2, DVec2) = (Ball::position(ball), ball.velocity());
        for number in [position.x, position.y, velocity.x, velocity.y] {
            add(number);
        }
        for number in [ball.radius(), ball.mass(), ball.restitution()] {
            add(number);
        }
    }
    hash
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Solver;
    use crate::session::{Command, Session};

    const EVERYTHING: [Change; 15] = [
        Change::AddBall { position: DVec2::new(900.5, 300.0), velocity: DVec2::new(0.1, -1e3), radius: 12.5 },
        Change::AddRandom(7),
        Change::Carry { ball: 3, to: DVec2::new(1.0 / 3.0, 200.0) },
        Change::Place { ball: 14, at: DVec2::new(1000.0 + 1.0 / 3.0, 5.0) },
        Change::TiltGravity(DVec2::new(98.0, 0.0)),
        Change::ToggleGravity,
        Change::Solver(Solver::Contact),
        Change::Compare(true),
        Change::Remove(2),
        Change::RemoveLast,
        Change::Resize(DVec2::new(800.0, 600.0)),
        Change::Compare(false),
        Change::Reset,
        Change::Reseed(5),
        // Refused, then as now.
        Change::AddBall { position: DVec2::new(-900.5, 300.0), velocity: DVec2::ZERO, radius: 12.5 },
    ];

    #[test]
    fn what_is_written_and_read_plays_the_same_to_the_bit() {
        for name in ["gravity", "elastic"] {
            let scene = Scene::load(name).unwrap().with_added(3, Some(9));
            let mut session = Session::new(&scene, 4).unwrap();
            for change in EVERYTHING {
                session.advance(1.0 / 60.0).unwrap();
                let _ = session.apply(Command::Change(change));
                session.advance(0.05).unwrap();
            }
            let text = session.replay().unwrap();
            // The header's solver, size and balls count, not those of the scene at hand.
            let plain = Scene::load(name).unwrap().with_solver(Solver::Canvas);
            let mut replay = Replay::parse(Path::new("a"), &text, &plain).unwrap();
            assert_eq!(replay.frames(), 2 * EVERYTHING.len() as u64);
            while replay.advance().unwrap() {}
            assert_eq!(replay.simulation().balls(), session.simulation().balls(), "{name}");
            assert_eq!(replay.simulation().world(), session.simulation().world());
            assert_eq!(replay.simulation().time(), session.simulation().time());
        }
    }

    #[test]
    fn a_replay_of_another_scene_is_refused_by_name() {
        let session = Session::new(&Scene::load("gravity").unwrap(), 1).unwrap();
        let text = session.replay().unwrap();
        let error = Replay::parse(Path::new("a"), &text, &Scene::load("elastic").unwrap()).unwrap_err();
        assert!(error.to_string().contains("carom run gravity --commands a"), "{error}");
    }

    #[test]
    fn what_is_not_a_replay_is_refused_with_its_line() {
        let scene = Scene::load("gravity").unwrap();
        for (text, line) in [
            ("", 1),
            ("carom replay 2\n", 1),
            ("carom replay 1\nframe\n", 2),
            ("carom replay 1\n\n# a comment\nframe nan\n", 4),
            ("carom replay 1\nframe -1\n", 2),
            ("carom replay 1\nframe 0 0\n", 2),
            ("carom replay 1\nframe 0 1 2\n", 2),
            ("carom replay 1\nframe 0\nsize 3 4\n", 3),
            ("carom replay 1\nsize 3\n", 2),
            ("carom replay 1\nsize 3 1e300\n", 2),
            ("carom replay 1\nstart xyz\n", 2),
            ("carom replay 1\nadd-ball 1 2 3 4 inf\n", 2),
            ("carom replay 1\nremove -1\n", 2),
            ("carom replay 1\ncompare maybe\n", 2),
            ("carom replay 1\nexplode\n", 2),
        ] {
            let error = Replay::parse(Path::new("a"), text, &scene).unwrap_err().to_string();
            assert!(error.starts_with(&format!("a:{line}: ")), "{text:?}: {error}");
        }
    }
}
