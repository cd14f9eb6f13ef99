//! What a replay says came back whole in the message, and with it what a terminal obeys.

use std::path::Path;

use carom::Scene;
use carom::session::Replay;

#[test]
fn messages_quote_a_part_of_what_is_long_and_nothing_that_a_terminal_obeys() {
    let scene = Scene::load("gravity").unwrap();
    for word in ["x".repeat(1_000_000), "\u{1b}[2J".to_owned()] {
        for line in [
            word.clone(),
            format!("frame {word}"),
            format!("frame 0 {word}"),
            format!("frame 0 1 {word}"),
            format!("compare {word}"),
            format!("start {word}"),
            format!("seed 1 {word}"),
            format!("solver {word}"),
            format!("add-ball 1 {word}"),
            format!("scene {word}\nstart 0"),
        ] {
            let text = format!("carom replay 1\n{line}\n");
            let message = Replay::parse(Path::new("long"), &text, &scene).unwrap_err().to_string();
            assert!(message.starts_with("long"), "{message:.100}");
            assert!(message.chars().count() < 1000, "{} characters", message.chars().count());
            assert!(!message.contains(char::is_control), "{message:?}");
        }
    }
}
