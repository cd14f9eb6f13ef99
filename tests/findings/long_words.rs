//! A key or a number as long as the file came back whole in the message, and with it what a terminal obeys.

use std::path::Path;

use carom::Scene;
use carom::headless::Frames;

#[test]
fn messages_quote_a_part_of_what_is_long_and_nothing_that_a_terminal_obeys() {
    let long = "x".repeat(1_000_000);
    let scenes = [
        format!("{long} = 1"),
        format!("solver = \"{long}\""),
        format!("[walls]\n{long} = 1"),
        format!("size = [{long}"),
        "\"\u{1b}[2J\" = 1".to_owned(),
        "solver = \"\\u001b[2J\"".to_owned(),
        "# \u{1b}[2J".to_owned(),
    ];
    let scenes = scenes.iter().map(|text| Scene::parse("long.toml", text).unwrap_err().to_string());
    let deltas = [long.clone(), "\u{1b}[2J".to_owned(), format!("0\n{long}\n")];
    let deltas =
        deltas.iter().map(|text| Frames::parse(Path::new("long.txt"), text).unwrap_err().to_string());
    for message in scenes.chain(deltas) {
        assert!(message.chars().count() < 1000, "{} characters", message.chars().count());
        assert!(!message.contains(|c: char| c.is_control() && c != '\n'), "{message:?}");
    }
}

#[test]
fn a_description_is_a_line_and_no_book() {
    let about = |count| Scene::parse("long.toml", &format!("about = \"{}\"", "é".repeat(count)));
    assert_eq!(about(1000).unwrap().about().chars().count(), 1000);
    let message = about(1001).unwrap_err().to_string();
    assert!(message.contains("about has 1001 characters; write at most 1000"), "{message}");
}
