//! `--check`: every frame held against the laws, and what is left behind where one is broken.

use std::path::PathBuf;

use thiserror::Error;

use super::Run;
use super::output::{Output, OutputError};
use crate::scene;
use crate::simulation::ledger::{Ledger, Violation};
use crate::simulation::{Ball, Simulation};

/// A frame that broke a law.
#[derive(Debug, Error)]
#[error(
    "frame {frame}, at {time} s, breaks the law of {}: {violation}; {}",
    violation.law.name(),
    left(file)
)]
pub struct Broken {
    /// The frame, from 1.
    pub frame: u64,
    /// The time at its end, s.
    pub time: f64,
    /// Which law, and by how much.
    pub violation: Violation,
    /// The scene as it was a frame before, if it could be written.
    pub file: Result<PathBuf, OutputError>,
}

/// What a message says of the scene that is left behind.
fn left(file: &Result<PathBuf, OutputError>) -> String {
    match file {
        Ok(path) => {
            format!("{} is the scene one frame before, and says how to go on from there", path.display())
        }
        Err(error) => format!("the scene one frame before cannot be left for you: {error}"),
    }
}

/// The ledger of a run.
pub(super) struct Check {
    ledger: Ledger,
}

impl Check {
    pub(super) fn new(run: &Run, simulation: &Simulation) -> Self {
        let ledger = Ledger::new(simulation);
        // What falls in cuts frames into several advances.
        Self { ledger: if run.course.scene().rain().is_some() { ledger.without_flights() } else { ledger } }
    }

    /// Holds the frame of this number, from 1, that `delta` seconds led to against the laws, and leaves the scene of
    /// the frame before behind where one is broken.
    pub(super) fn hold(
        &mut self,
        run: &Run,
        frame: u64,
        delta: f64,
        simulation: &Simulation,
    ) -> Result<(), Box<Broken>> {
        self.ledger.check(simulation).map_err(|violation| {
            let name = shortened(run.course.scene().name());
            let path = free_path(run, &format!("{name}-frame-{}", frame - 1));
            let rain = if run.course.scene().rain().is_some() { RAIN_IS_LEFT_OUT } else { "" };
            let text = format!(
                "# `carom run {} --solver {} --check`, with the other options that it had, broke the law of {} in\n\
                 # frame {frame}: {violation}.\n\
                 # This is the frame before, at {:?} s. The frame that follows:\n\
                 # echo {delta:?} | carom run {} --check --deltas /dev/stdin\n\
                 # What a solver remembers beside the balls (who rests, who sleeps) is not in it: where that frame\n\
                 # keeps the laws, the first command breaks them still.\n{rain}\n{}",
                in_shell(run.course.scene().argument()),
                simulation.solver(),
                violation.law.name(),
                self.ledger.time_before(),
                in_shell(&path.to_string_lossy()),
                scene_file(simulation, self.ledger.before()),
            );
            let written = Output::create(&path).and_then(|output| output.complete(text.as_bytes()));
            Box::new(Broken { frame, time: simulation.time(), violation, file: written.map(|()| path) })
        })
    }
}

/// The path of a scene file of this name, with the first number behind it, if it takes one, that no other file has, nor one that the
/// run writes.
pub(super) fn free_path(run: &Run, name: &str) -> PathBuf {
    let outputs = || [&run.trace, &run.image, &run.gif, &run.summary].into_iter().flatten();
    // A link to nothing is a file, too.
    let is_free = |path: &PathBuf| path.symlink_metadata().is_err() && outputs().all(|output| output != path);
    let (mut path, mut number) = (PathBuf::from(format!("{name}.toml")), 1);
    while !is_free(&path) {
        number += 1;
        path = PathBuf::from(format!("{name}-{number}.toml"));
    }
    path
}

/// What is said of rain, which a scene file can only begin anew, from its first balls.
const RAIN_IS_LEFT_OUT: &str =
    "# The balls that had rained in are in it, the rain is not: what falls in with that frame is missing.\n";

/// The most bytes of a scene's name in that of a file: file systems take 255, with a frame's number and one of the file's own.
const LONGEST_NAME: usize = 200;

/// As much of a scene's name as the name of a file has room for.
fn shortened(name: &str) -> &str {
    let ends = name.char_indices().map(|(at, c)| at + c.len_utf8());
    &name[..ends.take_while(|&end| end <= LONGEST_NAME).last().unwrap_or_default()]
}

/// A word of a command as a shell takes it: in quotes where it has characters that mean something there. Control characters, which
/// no comment of a scene file may have, are written by their bytes.
fn in_shell(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./+,:@%".contains(c);
    if word.chars().all(is_plain) {
        return word.to_owned();
    }
    if !word.contains(char::is_control) {
        return format!("'{}'", word.replace('\'', "'\\''"));
    }
    let mut quoted = "$'".to_owned();
    for c in word.chars() {
        match c {
            '\'' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => {
                let bytes = c.to_string().into_bytes();
                quoted.extend(bytes.into_iter().map(|byte| format!("\\{byte:03o}")));
            }
            c => quoted.push(c),
        }
    }
    quoted + "'"
}

/// The world and the solver of `simulation`, with `balls`, as a scene file.
fn scene_file(simulation: &Simulation, balls: &[Ball]) -> String {
    let before = Simulation::new(*simulation.world(), balls.to_vec(), simulation.solver());
    // The same balls fitted into the same world a frame ago.
    before.map_or_else(|_| String::new(), |before| scene::write(&before, None, ""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;

    #[test]
    fn a_command_is_one_that_a_shell_takes() {
        for (word, taken) in [
            ("scenes/a-1.toml", "scenes/a-1.toml"),
            ("two words.toml", "'two words.toml'"),
            ("it's.toml", "'it'\\''s.toml'"),
            ("$(ls).toml", "'$(ls).toml'"),
            ("a\nb\u{1b}1\tc.toml", "$'a\\012b\\0331\\011c.toml'"),
            ("it's \\ \u{85}\r.toml", "$'it\\'s \\\\ \\302\\205\\015.toml'"),
        ] {
            assert_eq!(in_shell(word), taken);
        }
    }

    #[test]
    fn a_name_is_shortened_where_no_file_could_have_it_and_at_whole_characters() {
        assert_eq!(shortened("mine"), "mine");
        assert_eq!(shortened(&"a".repeat(249)), "a".repeat(200));
        assert_eq!(shortened(&format!("a{}", "é".repeat(120))), format!("a{}", "é".repeat(99)));
    }

    #[test]
    fn a_scene_left_behind_is_the_frame_to_the_last_bit() {
        for scene in ["galton", "detect", "draw", "heavy", "gas"] {
            let mut simulation = Scene::load(scene).unwrap().build().unwrap();
            simulation.advance(0.3).unwrap();
            let text = scene_file(&simulation, simulation.balls());
            let again = Scene::parse("left.toml", &text).unwrap().build().unwrap();
            assert_eq!((again.world(), again.balls()), (simulation.world(), simulation.balls()), "{scene}");
            assert_eq!(again.solver(), simulation.solver());
        }
    }
}
