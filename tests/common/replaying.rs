//! Any text as a replay: read, written, read again and played, with the laws held against its frames.
//!
//! The tests and the fuzz target share it.

use std::path::Path;

use carom::Scene;
use carom::session::Replay;
use carom::simulation::ledger::Ledger;

/// The scenes that are replayed, the first where the text names none of them: those that are built at once.
const SCENES: &[&str] = &["gravity", "elastic", "detect", "cradle", "rain", "bullet"];
/// The most frames, and the most random balls in an entry, that are played: what bounds the work.
const MOST: usize = 60;
/// How often a solver may ask whether to go on, in a frame that says nothing of it.
const LOOKS: u32 = 20;

/// The text with every frame cut short somewhere; `None` where to play it might take long.
fn bounded(text: &str) -> Option<String> {
    let mut frames = 0;
    let mut bounded = String::new();
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        bounded.push_str(line);
        match words[..] {
            ["frame", ..] => {
                frames += 1;
                match words[..] {
                    [_, _] => bounded += &format!(" {LOOKS}"),
                    [_, _, cut] if cut.parse().is_ok_and(|cut: u32| cut > LOOKS) => return None,
                    _ => {}
                }
            }
            ["add-random" | "balls", count, ..] if count.parse().is_ok_and(|count: usize| count > MOST) => {
                return None;
            }
            _ => {}
        }
        bounded.push('\n');
    }
    (frames <= MOST).then_some(bounded)
}

/// What happens before each frame: whether anything but time does. From the text that a replay is written as.
fn changes(written: &str) -> Vec<bool> {
    let entries = written.lines().skip_while(|line| !line.starts_with("start ")).skip(1);
    let mut changed = false;
    let mut changes = Vec::new();
    for line in entries {
        if line.starts_with("frame ") {
            changes.push(std::mem::take(&mut changed));
        } else {
            changed = true;
        }
    }
    changes
}

/// Panics where the text is neither refused with a word of where and why, nor a replay that is written as it is read
/// and comes to the same bits again, its frames lawful.
pub fn judge(text: &str) {
    let Some(text) = bounded(text) else { return };
    let named = text.lines().find_map(|line| line.strip_prefix("scene "));
    let name = SCENES.iter().find(|&&name| Some(name) == named).unwrap_or(&SCENES[0]);
    let scene = Scene::load(name).expect("a built-in scene");
    let path = Path::new("fuzzed.replay");
    let mut replay = match Replay::parse(path, &text, &scene) {
        Ok(replay) => replay,
        Err(error) => {
            let message = error.to_string();
            assert!(message.starts_with("fuzzed.replay") && message.len() > 20, "{message}");
            assert!(message.len() < 1000 && !message.contains('\u{1b}'), "{message:?}");
            return;
        }
    };
    let written = replay.to_string();
    let mut again =
        Replay::parse(path, &written, &scene).unwrap_or_else(|error| panic!("{error}\n{written}"));
    assert_eq!(again.to_string(), written);
    let mut ledger = Ledger::new(replay.simulation()).without_flights();
    for changed in changes(&written) {
        let before = replay.simulation().time();
        assert!(replay.advance().expect("a delta in range"), "{written}");
        let simulation = replay.simulation();
        if changed {
            ledger = Ledger::new(simulation).without_flights();
        } else {
            assert!(simulation.time() >= before, "{written}");
            if let Err(violation) = ledger.check(simulation) {
                panic!("{} at {} s: {violation}\n{written}", simulation.solver(), simulation.time());
            }
        }
        assert!(again.advance().expect("a delta in range"));
        assert_eq!(again.simulation().balls(), simulation.balls(), "{written}");
        assert_eq!(again.simulation().time().to_bits(), simulation.time().to_bits(), "{written}");
    }
    assert!(!replay.advance().expect("no more frames"), "{written}");
}
