//! The command line, run as a process: here what is listed, printed and loaded, and what all are run with.

mod files;
mod gifs;
mod refused;
mod results;

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::TempDir;

fn carom(folder: &TempDir, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_carom")).args(args).current_dir(folder.path()).output().unwrap()
}

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Runs what must succeed, and returns what it printed.
fn succeed(folder: &TempDir, args: &[&str]) -> String {
    let output = carom(folder, args);
    assert!(output.status.success(), "{args:?}: {}", stderr(&output));
    stdout(&output)
}

/// Runs what must fail with `code` and say `message`, with nothing on standard output.
fn fail(folder: &TempDir, args: &[&str], code: i32, message: &str) {
    let output = carom(folder, args);
    assert_eq!(output.status.code(), Some(code), "{args:?}: {}", stderr(&output));
    assert!(stderr(&output).contains(message), "{args:?}: {}", stderr(&output));
    assert!(output.stdout.is_empty(), "{args:?}: {}", stdout(&output));
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

fn data(name: &str) -> String {
    format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_scenes_are_listed_in_columns() {
    let here = folder();
    let list = succeed(&here, &["scenes"]);
    let column = list.lines().next().unwrap().find("leaves out").unwrap();
    let rows: Vec<&str> = list.lines().skip(1).step_by(2).collect();
    assert!(rows.iter().any(|row| row.len() > column));
    for row in rows.iter().filter(|row| row.len() > column) {
        assert!(row[..column].ends_with("  ") && row.as_bytes()[column] != b' ', "{row}");
    }
    assert!(rows.iter().all(|row| row.len() > column || row.trim_end().len() <= column - 2), "{list}");
}

#[test]
fn a_file_with_the_name_of_no_scene_is_found_by_its_path() {
    let here = folder();
    fs::write(here.path().join("noext"), "").unwrap();
    fail(&here, &["run", "noext"], 2, "for the file of that name write ./noext");
    fail(&here, &["run", "other"], 2, "give the path of a .toml file");
    succeed(&here, &["run", "./noext", "--seconds", "0"]);
}

#[test]
fn scenes_lists_what_each_shows_uses_and_leaves_out() {
    let here = folder();
    let text = succeed(&here, &["scenes"]);
    let list: Value = serde_json::from_str(&succeed(&here, &["scenes", "--json"])).unwrap();
    let list = list.as_array().unwrap();
    assert!(list.len() >= 8);
    for scene in list {
        assert!(
            text.contains(scene["name"].as_str().unwrap()) && text.contains(scene["about"].as_str().unwrap())
        );
    }
    assert_eq!(list[0]["leaves_out"], serde_json::json!(["gravity", "walls", "pairs", "impulse"]));
    assert_eq!(
        list[7]["uses"],
        serde_json::json!(["motion", "gravity", "walls", "all pairs", "events", "impulse"])
    );
    assert_eq!(list[7]["leaves_out"], serde_json::json!([]));
    // As it is while it falls, not before its first ball.
    let rain = list.iter().find(|scene| scene["name"] == "rain").unwrap();
    assert_eq!((&rain["balls"], &rain["leaves_out"]), (&serde_json::json!(0), &serde_json::json!([])));
}

#[test]
fn a_printed_scene_is_a_scene_that_runs_the_same() {
    let here = folder();
    let file = succeed(&here, &["scene", "gravity"]);
    fs::write(here.path().join("mine.toml"), file).unwrap();
    let trace = |scene| succeed(&here, &["run", scene, "--seconds", "1", "--trace", "-"]);
    assert_eq!(trace("mine.toml"), trace("gravity"));
}

#[test]
fn random_balls_come_from_their_seed() {
    let here = folder();
    let trace = |seed| {
        succeed(&here, &["run", "elastic", "--balls", "60", "--seed", seed, "--seconds", "1", "--trace", "-"])
    };
    assert_eq!(trace("3"), trace("3"));
    assert_ne!(trace("3"), trace("4"));
}

#[test]
fn a_seed_that_no_added_ball_is_drawn_from_is_told_of_and_stops_no_script() {
    let here = folder();
    for (balls, told) in [(&["--balls", "2"][..], false), (&["--balls", "0"], true), (&[], true)] {
        let args = [&["run", "elastic", "--seed", "3", "--seconds", "0"], balls].concat();
        let output = carom(&here, &args);
        assert!(output.status.success(), "{balls:?}");
        assert_eq!(stderr(&output).contains("--seed is for the balls that --balls adds"), told, "{balls:?}");
    }
}

#[test]
fn every_command_has_help_with_examples() {
    let here = folder();
    for args in [&["--help"][..], &["run", "--help"], &["scenes", "--help"], &["scene", "--help"]] {
        assert!(succeed(&here, args).contains("Examples:"), "{args:?}");
    }
}

/// 100,000 balls, a table each: what a program would write.
#[test]
fn a_file_of_a_hundred_thousand_balls_loads() {
    let here = folder();
    let ball = |i: u32| {
        let (x, y) = (5.0 + f64::from(i % 1000) * 1.27, 5.0 + f64::from(i / 1000) * 7.1);
        format!(
            "[[ball]]\nposition = [{x}, {y}]\nradius = 0.5\nvelocity = [1.5, -2]\nmass = 3\nrestitution = 0.5\n"
        )
    };
    fs::write(here.path().join("many.toml"), (0..100_000).map(ball).collect::<String>()).unwrap();
    let json = succeed(&here, &["run", "many.toml", "--seconds", "0", "--summary", "-"]);
    assert_eq!(serde_json::from_str::<Value>(&json).unwrap()["balls"], 100_000);
}
