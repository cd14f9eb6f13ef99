//! Replays as text: writing them.

use std::fmt::Write;

use glam::DVec2;

use super::{FIRST_LINE, fingerprint};
use crate::session::command::Change;
use crate::session::state::Start;
use crate::session::tape::{Entry, Frame};

/// The text of a replay that began with `start`.
pub(in crate::session) fn write<'a>(
    start: &Start,
    seed: u64,
    entries: impl Iterator<Item = &'a Entry>,
) -> String {
    let Start { scene, simulation } = start;
    // It is the rest of a line, and a path may have line breaks in it.
    let name = scene.argument().replace(char::is_control, " ");
    let mut text = format!("{FIRST_LINE}\nscene {name}\nsolver {}\n", scene.solver());
    let DVec2 { x, y } = scene.world().size();
    text += &format!("size {x} {y}\n");
    if let Some((count, seed)) = scene.added() {
        text += &format!("balls {count} {seed}\n");
    }
    text += &format!("seed {seed}\n");
    text += &format!("start {:016x}\n", fingerprint(simulation, scene.rain().as_ref()));
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
