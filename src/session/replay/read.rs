//! Replays as text: reading their lines.

use std::fmt::Display;
use std::num::NonZeroU32;
use std::str::{FromStr, SplitWhitespace};

use glam::DVec2;

use crate::scene::{LONGEST_NAME, Scene, shown};
use crate::session::command::Change;
use crate::session::tape::{Entry, Frame};
use crate::simulation::limits::DELTA;

/// What a replay starts from, and what happened.
pub(super) struct Read {
    pub(super) header: Header,
    /// The scene that was given, with the solver, the size and the added balls of the header.
    pub(super) scene: Scene,
    pub(super) entries: Vec<Entry>,
}

/// Reads what follows the first line, where `scene` is the one that the replay is of.
///
/// # Errors
/// The number of the line that is not what it should be, from 1, and what to write instead.
pub(super) fn read(text: &str, scene: &Scene) -> Result<Read, (usize, String)> {
    let mut read = Read { header: Header::default(), scene: scene.clone(), entries: Vec::new() };
    let mut in_header = true;
    let unended = (!text.ends_with('\n')).then(|| text.lines().count());
    for (number, text) in (1..).zip(text.lines()).skip(1) {
        let mut line = Line { words: text.split_whitespace() };
        let Some(keyword) = line.words.next().filter(|word| !word.starts_with('#')) else { continue };
        if in_header {
            let taken = read_header(keyword, text, &mut line, &mut read);
            in_header = taken.map_err(|message| (number, message))?;
        }
        if in_header {
            // Its last line: what comes next may be a change of the solver, which the header has, too.
            in_header = keyword != "start";
        } else {
            let entry = read_entry(keyword, &mut line).map_err(|message| (number, message))?;
            line.end().map_err(|message| (number, message))?;
            read.entries.push(entry);
        }
        if unended == Some(number) {
            // What is left of a number may be one, too.
            let message =
                "the file ends within this line: it was cut off, or the line break at its end is missing";
            return Err((number, message.to_owned()));
        }
    }
    Ok(read)
}

/// The most characters of a word that a message quotes.
const LONGEST_WORD: usize = 60;

/// A word of a replay, as a message may quote it.
fn quoted(word: &str) -> String {
    format!("\"{}\"", shown(word, LONGEST_WORD))
}

/// A line that is being read, word by word.
struct Line<'a> {
    words: SplitWhitespace<'a>,
}

impl Line<'_> {
    /// The next word, as `what` it should be.
    fn next<T: FromStr>(&mut self, what: &str) -> Result<T, String> {
        let word = self.words.next().ok_or_else(|| format!("{what} is missing"))?;
        word.parse().map_err(|_| format!("{} is not {what}", quoted(word)))
    }

    /// The next word as a finite number.
    fn number(&mut self, what: &str) -> Result<f64, String> {
        let number: f64 = self.next(what)?;
        if number.is_finite() { Ok(number) } else { Err(format!("{number} is not {what}")) }
    }

    fn vector(&mut self, what: &str) -> Result<DVec2, String> {
        Ok(DVec2::new(self.number(what)?, self.number(what)?))
    }

    /// Checks that nothing more is there.
    fn end(&mut self) -> Result<(), String> {
        self.words.next().map_or(Ok(()), |word| Err(format!("{} is one word too many", quoted(word))))
    }
}

fn read_entry(keyword: &str, line: &mut Line<'_>) -> Result<Entry, String> {
    let change = match keyword {
        "frame" => {
            let seconds = DELTA.check(line.number("a delta in seconds")?).map_err(in_words)?;
            let cut = line.words.next().map(|word| word.parse::<NonZeroU32>().map_err(|_| word));
            let cut = cut.transpose().map_err(|word| format!("{} is not a count from 1", quoted(word)))?;
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
            word => return Err(format!("{} is not on or off", quoted(word))),
        },
        _ => {
            return Err(format!(
                "{} is nothing that can happen; write frame, reset, add-ball …",
                quoted(keyword)
            ));
        }
    };
    Ok(Entry::Change(Box::new(change)))
}

fn in_words(error: impl Display) -> String {
    error.to_string()
}

/// What a replay starts from, apart from the scene.
#[derive(Default)]
pub(super) struct Header {
    /// What the scene was called.
    pub(super) scene: String,
    /// For the random balls that changes add.
    pub(super) seed: u64,
    /// Of the balls and the world at the start.
    pub(super) fingerprint: Option<u64>,
}

/// Reads a line of the header, where it is one; whether it was.
fn read_header(
    keyword: &str,
    text: &str,
    line: &mut Line<'_>,
    Read { header, scene, .. }: &mut Read,
) -> Result<bool, String> {
    let changed = match keyword {
        // It may have spaces.
        "scene" => {
            let name = text.trim().strip_prefix(keyword).unwrap_or_default();
            header.scene = shown(name.trim(), LONGEST_NAME);
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
            header.fingerprint = Some(number.map_err(|_| format!("{} is not a fingerprint", quoted(&word)))?);
            scene.clone()
        }
        _ => return Ok(false),
    };
    line.end()?;
    *scene = changed;
    Ok(true)
}
