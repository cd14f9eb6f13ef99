//! A session as a file: every frame and every change since the scene began, to be played again to the bit.
//!
//! A replay is text, an entry a line: first what it starts from, then what happened, in order. Numbers are written in
//! the shortest form that reads back to the same `f64`.

mod read;
mod write;

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use thiserror::Error;

pub(super) use write::write;

use super::command::CommandError;
use super::state::{Played, Start, State};
use super::tape::{Entry, Frame};
use crate::scene::{self, Rain, Scene, SceneError};
use crate::simulation::Simulation;

/// The first line of every replay.
const FIRST_LINE: &str = "carom replay 1";
/// The longest file, bytes: a day at 60 frames per second.
const LONGEST_FILE: u64 = 1 << 27;

/// What was played, to be played again. Its [`Display`](fmt::Display) is its text, which [`parse`](Self::parse) reads.
#[derive(Debug, Clone)]
pub struct Replay {
    start: Arc<Start>,
    /// For the random balls that changes add.
    seed: u64,
    state: State,
    entries: Vec<Entry>,
    /// The entry that is played next.
    at: usize,
    refused: Option<Refused>,
}

/// What of a replay did nothing, or less than it says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refused {
    /// How many changes.
    pub changes: u64,
    /// The first: how many frames came before it.
    pub frame: u64,
    /// Why.
    pub reason: String,
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { changes, frame, reason } = self;
        let (changes, s) = (*changes, if *changes == 1 { "" } else { "s" });
        write!(
            f,
            "{changes} change{s} of the replay did nothing or less than asked, as when it was recorded unless the file \
             was changed since; the first, after frame {frame}: {reason}"
        )
    }
}

/// Why a replay cannot be played.
#[derive(Debug, Error)]
#[non_exhaustive]
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
    /// It was recorded with another scene, or with this one before that was changed.
    #[error("{}", other_scene(path, recorded, given))]
    OtherScene {
        /// The replay's path.
        path: PathBuf,
        /// The scene that it was recorded with.
        recorded: String,
        /// The scene that was given.
        given: String,
    },
    /// The scene's balls do not fit into the world that it asks for.
    #[error("{}: {source}", path.display())]
    Scene {
        /// The replay's path.
        path: PathBuf,
        /// What does not fit.
        source: Box<SceneError>,
    },
}

/// That a replay is of another scene, and what to do.
fn other_scene(path: &Path, recorded: &str, given: &str) -> String {
    let what = format!(
        "{} was recorded in the scene {recorded}, from other balls than {given} has now; ",
        path.display()
    );
    if recorded == given {
        what + "give the scene as it was then"
    } else {
        format!("{what}run carom run {recorded} --commands {}", path.display())
    }
}

impl Replay {
    /// Reads a replay of this scene: solver, size and added balls are those that it was recorded with.
    ///
    /// # Errors
    /// [`ReplayError`] where the file cannot be read, is not a replay, or begins with other balls than the scene has.
    pub fn read(path: &Path, scene: &Scene) -> Result<Self, ReplayError> {
        let unreadable = |source| ReplayError::Unreadable { path: path.to_owned(), source };
        let text = scene::read_up_to(LONGEST_FILE, path)
            .map_err(unreadable)?
            .ok_or_else(|| ReplayError::TooLong { path: path.to_owned() })?;
        Self::parse(path, &text, scene)
    }

    /// A replay from its text; messages call it `path`.
    ///
    /// # Errors
    /// [`ReplayError`] as for [`read`](Self::read).
    pub fn parse(path: &Path, text: &str, scene: &Scene) -> Result<Self, ReplayError> {
        let wrong = |line, message| ReplayError::Line { path: path.to_owned(), line, message };
        // Some editors begin a file with a mark that nobody sees.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        if text.lines().next().is_none_or(|first| first.trim_end() != FIRST_LINE) {
            return Err(wrong(1, format!("this is not a replay, which begins with \"{FIRST_LINE}\"")));
        }
        let read::Read { header, scene: start, entries } =
            read::read(text, scene).map_err(|(line, message)| wrong(line, message))?;
        let state = State::new(&start, header.seed)
            .map_err(|source| ReplayError::Scene { path: path.to_owned(), source: Box::new(source) })?;
        if header.fingerprint.is_some_and(|recorded| recorded != fingerprint(&state.simulation, state.rain()))
        {
            return Err(ReplayError::OtherScene {
                path: path.to_owned(),
                recorded: header.scene,
                given: scene.argument().to_owned(),
            });
        }
        let start = Arc::clone(state.start());
        Ok(Self { start, seed: header.seed, state, entries, at: 0, refused: None })
    }

    /// The same replay before its first frame.
    pub(crate) fn rewound(&self) -> Result<Self, SceneError> {
        let Self { seed, ref entries, .. } = *self;
        let state = State::new(&self.start.scene, seed)?;
        let start = Arc::clone(state.start());
        Ok(Self { start, seed, state, entries: entries.clone(), at: 0, refused: None })
    }

    /// The scene that is played, as the replay wants it.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.start.scene
    }

    /// The simulation as it is now.
    #[must_use]
    pub fn simulation(&self) -> &Simulation {
        &self.state.simulation
    }

    /// What was played since the beginning, whatever was reset.
    #[must_use]
    pub fn played(&self) -> Played {
        self.state.played()
    }

    /// The number of frames.
    #[must_use]
    pub fn frames(&self) -> u64 {
        frames(&self.entries)
    }

    /// The seconds that all of its frames take but those that were cut short, of which only playing tells how far they came.
    pub(crate) fn least_seconds(&self) -> f64 {
        let whole = self.entries.iter().filter_map(|entry| match entry {
            Entry::Frame(Frame { seconds, cut: None }) => Some(seconds),
            _ => None,
        });
        whole.sum()
    }

    /// What was refused so far, if anything was: as it was when it was recorded, unless the file has been changed since.
    #[must_use]
    pub fn refused(&self) -> Option<&Refused> {
        self.refused.as_ref()
    }

    /// Plays on to the end of the next frame; whether there was one. Changes after the last frame take place, too.
    ///
    /// # Errors
    /// [`OutOfRange`](crate::OutOfRange) where a delta is refused.
    pub fn advance(&mut self) -> Result<bool, crate::OutOfRange> {
        while let Some(entry) = self.entries.get(self.at) {
            self.at += 1;
            match entry {
                Entry::Frame(frame) => return frame.repeat(&mut self.state).map(|_| true),
                // What was refused then is refused again.
                Entry::Change(change) => {
                    if let Err(error) = self.state.apply(**change) {
                        self.note(&error);
                    }
                }
            }
        }
        Ok(false)
    }

    /// Notes that the entry before the next one was refused.
    fn note(&mut self, error: &CommandError) {
        let before = &self.entries[..self.at];
        let first = || Refused { changes: 0, frame: frames(before), reason: error.to_string() };
        self.refused.get_or_insert_with(first).changes += 1;
    }
}

/// How many of these are frames.
fn frames(entries: &[Entry]) -> u64 {
    entries.iter().filter(|entry| matches!(entry, Entry::Frame(_))).count() as u64
}

impl fmt::Display for Replay {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&write(&self.start, self.seed, self.entries.iter()))
    }
}

/// A number that other balls, another world or other rain hardly share (FNV-1a: Fowler, Noll & Vo 1991).
fn fingerprint(simulation: &Simulation, rain: Option<&Rain>) -> u64 {
    // The file that the scene would be written as has all of it, numbers to the last bit. But for the solver: what was
    // chosen before the first frame stands with what a replay starts from.
    let text = scene::write_signed(simulation, rain);
    let lines = text.lines().filter(|line| !line.starts_with("solver"));
    let hash = |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    lines.flat_map(str::bytes).fold(0xcbf2_9ce4_8422_2325, hash)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::Solver;
    use crate::session::{Change, Command, Session};

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
            assert_eq!(replay.to_string(), text);
            assert_eq!(replay.frames(), 2 * EVERYTHING.len() as u64);
            while replay.advance().unwrap() {}
            assert_eq!(replay.simulation().balls(), session.simulation().balls(), "{name}");
            assert_eq!(replay.simulation().world(), session.simulation().world());
            assert_eq!(replay.simulation().time(), session.simulation().time());
        }
    }

    #[test]
    fn a_replay_begins_with_what_no_scene_may_begin_with() {
        assert!(FIRST_LINE.starts_with(scene::REPLAY));
    }

    #[test]
    fn a_replay_of_another_scene_is_refused_by_name() {
        let session = Session::new(&Scene::load("gravity").unwrap(), 1).unwrap();
        let text = session.replay().unwrap();
        let error = Replay::parse(Path::new("a"), &text, &Scene::load("elastic").unwrap()).unwrap_err();
        assert!(error.to_string().contains("carom run gravity --commands a"), "{error}");
    }

    #[test]
    fn a_replay_of_a_scene_that_was_changed_since_is_refused() {
        let pairs = "[pairs]\n[[ball]]\nposition = [50, 50]\nradius = 5\n";
        let rain = "[walls]\n[pairs]\n[rain]\nrate = 10\nradius = 3\n";
        for (text, from, to) in [
            (pairs, "[pairs]", "[pairs]\nresponse = \"detect\""),
            (pairs, "radius = 5", "radius = 5.000000000000001"),
            (rain, "rate = 10", "rate = 11"),
            (rain, "radius = 3", "radius = [3, 4]"),
            (rain, "[rain]", "[rain]\nseed = 2"),
        ] {
            let [scene, changed] = [text.to_owned(), text.replace(from, to)]
                .map(|text| Scene::parse("mine", &format!("size = [200, 100]\n{text}")).unwrap());
            let replay = Session::new(&scene, 1).unwrap().replay().unwrap();
            assert!(Replay::parse(Path::new("a"), &replay, &scene).is_ok());
            let refused = Replay::parse(Path::new("a"), &replay, &changed);
            assert!(matches!(refused, Err(ReplayError::OtherScene { .. })), "{to}");
            let says = refused.unwrap_err().to_string();
            assert!(says.ends_with("mine has now; give the scene as it was then"), "{says}");
        }
    }

    #[test]
    fn a_solver_chosen_before_the_first_frame_makes_no_other_scene() {
        let scene = Scene::load("gravity").unwrap();
        let mut session = Session::new(&scene, 1).unwrap();
        session.apply(Change::Solver(Solver::Canvas).into()).unwrap();
        session.advance_while(0.01, || true).unwrap();
        let mut replay = Replay::parse(Path::new("a"), &session.replay().unwrap(), &scene).unwrap();
        while replay.advance().unwrap() {}
        assert_eq!(replay.simulation().balls(), session.simulation().balls());
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
