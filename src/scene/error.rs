//! What can be wrong with a scene, said so that its author can mend it.

use std::fmt;
use std::io;
use std::path::PathBuf;

use glam::DVec2;
use thiserror::Error;

use crate::simulation::BuildError;

/// Why there is no scene to show.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// Neither a built-in scene nor a scene file has this name.
    #[error(
        "there is no scene \"{name}\"; choose from: {}; or {}",
        super::catalogue::names().join(", "),
        or_a_file(name, *is_file)
    )]
    Unknown {
        /// The name as it was given.
        name: String,
        /// Whether a file is called so: without folder and ending, a name is that of a built-in scene.
        is_file: bool,
    },
    /// The file cannot be read.
    #[error("{}: {source}; give the path of a scene file, or a built-in scene's name", path.display())]
    Unreadable {
        /// The file's path.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The file is larger than any scene may be.
    #[error("{} has more than {most} bytes, the most a scene file may have; write [[fill]] for many balls", path.display())]
    TooLong {
        /// The file's path.
        path: PathBuf,
        /// The largest length allowed.
        most: u64,
    },
    /// The file is a replay.
    #[error("{0} is a replay, not a scene; play it with carom run {scene} --commands \"{0}\"", path.display())]
    Replay {
        /// The file's path.
        path: PathBuf,
        /// The scene that it is of.
        scene: String,
    },
    /// The text is not a scene.
    #[error("{0}")]
    Wrong(Fault),
    /// A built-in scene's own random balls do not fit into a world of this size.
    #[error(
        "{scene} does not fit into a world of {}x{} px: only {placed} of {count} balls found room; ask for a larger one, or \
         for another scene",
        size.x, size.y
    )]
    SmallWorld {
        /// The scene's name.
        scene: String,
        /// The size asked for, px.
        size: DVec2,
        /// How many of the balls of one of its fills found a place.
        placed: usize,
        /// How many there are to be.
        count: usize,
    },
    /// Balls that were asked for outside of a file do not fit.
    #[error("{placed} of the {count} balls to add found room; ask for fewer, or for a larger world")]
    NoRoom {
        /// How many found a place.
        placed: usize,
        /// How many were asked for.
        count: usize,
    },
    /// The world and its balls do not go together.
    #[error(transparent)]
    Build(#[from] BuildError),
}

/// What to write instead of a name that is no scene's, for a file.
fn or_a_file(name: &str, is_file: bool) -> String {
    if is_file {
        format!("for the file of that name write ./{name}")
    } else {
        "give the path of a .toml file".to_owned()
    }
}

/// Something wrong in a scene's text: where, what, and what to write instead.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// The file's path or the built-in scene's name.
    pub origin: String,
    /// The line, from 1; `None` where the whole text is meant.
    pub line: Option<usize>,
    /// That line's text.
    pub text: String,
    /// What is wrong and what to write instead.
    pub message: String,
}

/// The most characters of a line that a message quotes.
const LONGEST_LINE: usize = 100;
/// The most characters of a message: the parser's own quote keys, which may be as long as the file.
const LONGEST_MESSAGE: usize = 500;

/// What a file says, as a message may quote it: at most so many characters, and none that a terminal would obey.
pub(crate) fn shown(text: &str, most: usize) -> String {
    let plain = |c: char| if c.is_control() && c != '\n' { char::REPLACEMENT_CHARACTER } else { c };
    let mut shown: String = text.chars().take(most).map(plain).collect();
    if text.chars().nth(most).is_some() {
        shown.push('…');
    }
    shown
}

/// A place in a text.
pub(super) struct Place<'a> {
    /// The line, from 1.
    pub(super) number: usize,
    /// That line's text.
    pub(super) line: &'a str,
    /// How many of its bytes stand before the place.
    pub(super) column: usize,
}

/// The place of the byte `offset`.
pub(super) fn place_of(source: &str, offset: usize) -> Place<'_> {
    // An offset within a character, which the parser never gives, counts as the text's end.
    let before = source.get(..offset).unwrap_or(source);
    let number = 1 + before.matches('\n').count();
    let line = source.lines().nth(number - 1).unwrap_or_default().trim_end();
    Place { number, line, column: before.len() - before.rfind('\n').map_or(0, |at| at + 1) }
}

impl Fault {
    /// A fault at the byte `offset` of `source`, or in the whole of it.
    pub(super) fn at(origin: &str, source: &str, offset: Option<usize>, message: &str) -> Self {
        let (origin, message) = (origin.to_owned(), shown(message, LONGEST_MESSAGE));
        let Some(offset) = offset else {
            return Self { origin, line: None, text: String::new(), message };
        };
        let Place { number, line, .. } = place_of(source, offset);
        Self { origin, line: Some(number), text: shown(line, LONGEST_LINE), message }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { origin, line, text, message } = self;
        match line {
            Some(line) => {
                write!(f, "{origin}:{line}: {message}")?;
                if !text.is_empty() {
                    write!(f, "\n{line:>6} | {text}")?;
                }
                Ok(())
            }
            None => write!(f, "{origin}: {message}"),
        }
    }
}
