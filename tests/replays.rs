//! Replays on the command line: what was done in a session, done again without a window.

use std::path::Path;
use std::process::{Command, Output};

use carom::headless::{self, Course, Run, RunError};
use carom::session::Replay;
use carom::{Change, Scene, Session};
use serde_json::Value;

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_carom")).arg("run").args(args).output().unwrap()
}

fn refused(args: &[&str], message: &str) {
    let output = run(args);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains(message), "{said}");
}

fn save(session: &Session, folder: &Path) -> String {
    let path = folder.join("a.replay");
    std::fs::write(&path, session.replay().unwrap()).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_replay_runs_to_the_bits_of_the_session_that_it_was_saved_from() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = Session::new(&Scene::load("gravity").unwrap(), 3).unwrap();
    for frame in 0..90 {
        match frame {
            20 => session.apply(Change::AddRandom(4).into()).unwrap(),
            40 => session.apply(carom::Command::NextSolver).unwrap(),
            60 => session.apply(Change::RemoveLast.into()).unwrap(),
            _ => {}
        }
        session.advance(0.013).unwrap();
    }
    let path = save(&session, folder.path());
    let output = run(&["gravity", "--commands", &path, "--trace", "-", "--every", "90"]);
    let trace = String::from_utf8(output.stdout).unwrap();
    let last = trace.lines().filter_map(|line| line.strip_prefix("90,"));
    let last: Vec<&str> = last.map(|line| line.rsplit_once(',').unwrap().0).collect();
    let time = session.simulation().time();
    let expected = session.simulation().balls().iter().enumerate().map(|(index, ball)| {
        let (p, v) = (ball.position(), ball.velocity());
        format!("{time},{index},{},{},{},{}", p.x, p.y, v.x, v.y)
    });
    assert_eq!(last, expected.collect::<Vec<_>>());
}

#[test]
fn a_replay_that_is_none_or_of_another_scene_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let session = Session::new(&Scene::load("elastic").unwrap(), 3).unwrap();
    let path = save(&session, folder.path());
    refused(&["gravity", "--commands", &path], "carom run elastic --commands");
    refused(&["gravity", "--commands", "nowhere.replay"], "a replay that the window saved");
    refused(&["elastic", "--commands", &path, "--seconds", "3"], "cannot be used with");
    std::fs::write(&path, b"carom replay 1\nframe \xff\n").unwrap();
    refused(&["elastic", "--commands", &path], "UTF-8");
}

#[test]
fn a_reset_in_a_replay_ends_no_count_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let frames = "frame 0.1\n".repeat(20);
    let play = |name: &str, commands: &str| {
        let (replay, json) = (path("a.replay"), path("a.json"));
        std::fs::write(&replay, format!("carom replay 1\nscene gravity\n{commands}")).unwrap();
        let (gif, trace) = (path(&format!("{name}.gif")), path(&format!("{name}.csv")));
        let call = ["gravity", "--commands", &replay, "--summary", &json, "--gif", &gif, "--trace", &trace];
        assert!(run(&call).status.success());
        let summary: Value = serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
        let times = std::fs::read_to_string(&trace).unwrap();
        let times = times.lines().skip(1).map(|row| row.split(',').nth(1).unwrap().parse().unwrap());
        (summary, times.collect::<Vec<f64>>(), shown(&gif))
    };
    let (once, _, once_shown) = play("once", &frames);
    for reset in ["reset", "reseed 5"] {
        let (twice, times, shown) = play("twice", &format!("{frames}{reset}\n{frames}"));
        for key in ["frames", "collisions", "wall_hits"] {
            let counts = [&once, &twice].map(|summary| summary[key].as_u64().unwrap());
            assert!(counts[0] > 0 && counts[1] == 2 * counts[0], "{key}: {counts:?}");
        }
        let seconds = twice["seconds"].as_f64().unwrap();
        assert!((seconds - 4.0).abs() < 1e-9, "{seconds}");
        assert_eq!(twice["kinetic_energy"], once["kinetic_energy"]);
        assert!(
            times.is_sorted() && times.last() == Some(&seconds),
            "the trace's times are those of the run"
        );
        assert_eq!(shown, once_shown + 200, "nor does the picture stand still after it");
    }
}

/// How long a GIF lasts, in hundredths of a second.
fn shown(gif: &str) -> u32 {
    let mut decoder = gif::DecodeOptions::new().read_info(std::fs::File::open(gif).unwrap()).unwrap();
    let mut shown = 0;
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        shown += u32::from(frame.delay);
    }
    shown
}

#[test]
fn a_replay_is_played_that_an_editor_has_put_a_byte_order_mark_before() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.replay");
    std::fs::write(&path, "\u{feff}carom replay 1\nframe 0\nframe 0.1\n").unwrap();
    let output = run(&["gravity", "--commands", path.to_str().unwrap()]);
    assert_eq!((output.status.code(), output.stderr.len()), (Some(0), 0));
}

#[test]
fn a_picture_of_a_world_that_a_replay_has_made_too_large_is_refused_and_not_of_something_else() {
    let folder = tempfile::tempdir().unwrap();
    let (path, picture) = (folder.path().join("a.replay"), folder.path().join("a.png"));
    std::fs::write(&path, "carom replay 1\nframe 0\nresize 100000 100000\nframe 0.1\n").unwrap();
    let command = ["gravity", "--commands", path.to_str().unwrap(), "--image", picture.to_str().unwrap()];
    let output = run(&command);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(String::from_utf8(output.stderr).unwrap().contains("memory"));
    assert!(!picture.exists());
}

#[test]
fn changes_of_a_replay_that_do_nothing_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.replay");
    let play = |changes: &str| {
        std::fs::write(&path, format!("carom replay 1\nscene gravity\nframe 0\n{changes}frame 0.1\n"))
            .unwrap();
        let output = run(&["gravity", "--commands", path.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(0));
        String::from_utf8(output.stderr).unwrap()
    };
    assert_eq!(play("remove 14\n"), "");
    let one = "carom: 1 change of the replay did nothing or less than asked, as when it was recorded unless the file was changed since; the first, after frame 1: there is no ball 15, counted from 0\n";
    assert_eq!(play("remove 15\n"), one);
    let three = play("remove 3\nadd-ball 100 100 0 0 -1\ncarry 14 1 2\nplace 99 3 4\n");
    assert!(three.starts_with("carom: 3 changes of the replay"), "{three}");
    assert!(three.ends_with("the first, after frame 1: no room for a ball here\n"), "{three}");
}

#[test]
fn a_replay_that_was_played_in_part_runs_from_its_start_and_is_held_against_no_law() {
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::load("gravity").unwrap();
    let mut session = Session::new(&scene, 3).unwrap();
    for _ in 0..10 {
        session.advance(0.013).unwrap();
    }
    let mut replay = Replay::parse(Path::new("a"), &session.replay().unwrap(), &scene).unwrap();
    let run = |replay: &Replay, name: &str, check: bool| {
        let trace = folder.path().join(name);
        let run = Run {
            course: Course::Replay(Box::new(replay.clone())),
            inputs: Vec::new(),
            trace: Some(trace.clone()),
            every: 1,
            image: None,
            gif: None,
            check,
            summary: Some(folder.path().join("summary")),
        };
        headless::run(&run).map(|summary| (summary, std::fs::read(trace).unwrap()))
    };
    let (whole, trace) = run(&replay, "whole", false).unwrap();
    for _ in 0..4 {
        replay.advance().unwrap();
    }
    let (again, same) = run(&replay, "again", false).unwrap();
    assert!(trace == same && whole.frames == again.frames);
    assert!(matches!(run(&replay, "checked", true), Err(RunError::ReplayChecked)));
}
