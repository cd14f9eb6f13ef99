//! The command line, run as a process: outputs, formats, messages, exit codes.

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
fn a_trace_of_the_demo_is_the_golden_trace() {
    let here = folder();
    let deltas = data("deltas-irregular.txt");
    let run =
        ["run", "gravity", "--solver", "canvas", "--deltas", &deltas, "--trace", "t.csv", "--every", "10"];
    succeed(&here, &run);
    let trace = fs::read_to_string(here.path().join("t.csv")).unwrap();
    let golden = fs::read_to_string(data("canvas-gravity-1280x720-irregular.csv")).unwrap();
    assert_eq!(trace.lines().count(), golden.lines().count());
    assert_eq!(trace.lines().next(), Some("frame,time,ball,x,y,vx,vy,colliding"));
    for (ours, theirs) in trace.lines().zip(golden.lines()).skip(1) {
        let mut fields: Vec<&str> = ours.split(',').collect();
        fields.remove(1);
        for (column, (ours, theirs)) in fields.iter().zip(theirs.split(',')).enumerate() {
            let number = |text: &str| text.parse::<f64>().unwrap();
            assert_eq!(number(ours).to_bits(), number(theirs).to_bits(), "column {column} of {fields:?}");
        }
    }
}

#[test]
fn a_trace_has_frame_1_and_every_kth_with_the_sum_of_deltas() {
    let here = folder();
    fs::write(here.path().join("d.txt"), "# a comment\n0\n\n0.5\n 0.25 \n1e-3\n").unwrap();
    let trace = succeed(&here, &["run", "two", "--deltas", "d.txt", "--trace", "-", "--every", "2"]);
    let rows: Vec<&str> = trace.lines().skip(1).collect();
    assert_eq!(
        rows,
        [
            "1,0,0,100,100,12,25,0",
            "1,0,1,180,180,70,45,0",
            "2,0.5,0,106,112.5,12,25,0",
            "2,0.5,1,215,202.5,70,45,0",
            "4,0.751,0,109.012,118.775,12,25,0",
            "4,0.751,1,232.57,213.795,70,45,0",
        ]
    );
}

#[test]
fn a_summary_has_every_figure_that_scripts_rely_on() {
    let here = folder();
    let json = succeed(&here, &["run", "elastic", "--seconds", "2", "--summary", "-"]);
    let summary: Value = serde_json::from_str(&json).unwrap();
    for (key, expected) in [("balls", 15), ("frames", 121), ("non_finite", 0)] {
        assert_eq!(summary[key], expected, "{key}");
    }
    assert_eq!((&summary["scene"], &summary["solver"]), (&"elastic".into(), &"exact".into()));
    assert!((summary["seconds"].as_f64().unwrap() - 2.0).abs() < 1e-12);
    let (kinetic, start) =
        (summary["kinetic_energy"].as_f64().unwrap(), summary["energy_start"].as_f64().unwrap());
    assert!((kinetic / start - 1.0).abs() < 1e-12);
    assert_eq!(summary["potential_energy"], 0.0);
    assert_eq!(summary["momentum"].as_array().unwrap().len(), 2);
    for key in
        ["wall_seconds", "ns_per_ball_frame", "max_overlap", "max_wall_overlap", "collisions", "wall_hits"]
    {
        assert!(summary[key].as_f64().unwrap() >= 0.0, "{key}");
    }
    assert!(summary["collisions"].as_u64().unwrap() > 0 && summary["wall_hits"].as_u64().unwrap() > 0);
}

#[test]
fn zero_seconds_are_one_frame_and_the_summary_is_readable() {
    let here = folder();
    let text = succeed(&here, &["run", "gravity", "--seconds", "0"]);
    assert!(text.contains("gravity with 15 balls, solver exact"), "{text}");
    assert!(text.contains("0.000000 s in 1 frame\n"), "{text}");
    assert!(
        text.contains("at most 0.0000 of a radius between balls, 0.0000 with walls, over the run"),
        "{text}"
    );
    assert!(text.contains(" %)\n"), "{text}");
}

#[test]
fn results_on_standard_output_are_not_mixed_with_the_summary() {
    let here = folder();
    let output = carom(&here, &["run", "draw", "--seconds", "0", "--image", "-"]);
    assert!(output.stdout.starts_with(b"\x89PNG\r\n\x1a\n") && output.stdout.ends_with(b"IEND\xaeB`\x82"));
    assert!(stderr(&output).contains("draw with 1 ball,"), "{}", stderr(&output));
    fail(&here, &["run", "draw", "--image", "-", "--trace", "-"], 2, "two outputs go to standard output");
    fail(
        &here,
        &["run", "draw", "--image", "-", "--trace", "/dev/stdout"],
        2,
        "two outputs go to standard output",
    );
    fail(&here, &["run", "draw", "--image", "it", "--trace", "./it"], 2, "two outputs go to it;");
}

#[test]
fn standard_output_has_one_output_by_whatever_name() {
    let here = folder();
    for name in ["/dev/fd/1", "/proc/self/fd/1"] {
        let run = ["run", "draw", "--trace", "-", "--summary", name];
        fail(&here, &run, 2, "two outputs go to standard output");
        assert!(succeed(&here, &["run", "draw", "--trace", name]).starts_with("frame,time,ball,"));
    }
}

#[cfg(unix)]
#[test]
fn the_file_that_standard_output_goes_to_is_no_place_for_another_output() {
    let here = folder();
    let into = |name: &str, args: &[&str]| {
        let file = fs::File::create(here.path().join(name)).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_carom"));
        command.current_dir(here.path()).args(args).stdout(file).output().unwrap()
    };
    let output = into("all.txt", &["run", "draw", "--trace", "-", "--summary", "all.txt"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("two outputs go to all.txt;"), "{}", stderr(&output));
    let output = into("all.txt", &["run", "draw", "--trace", "-", "--summary", "other.txt"]);
    assert!(output.status.success(), "{}", stderr(&output));
}

#[test]
fn energy_that_fell_in_is_no_error_of_the_solver() {
    let here = folder();
    let rained = succeed(&here, &["run", "rain", "--seconds", "1"]);
    let energy = rained.lines().find(|line| line.starts_with("energy")).unwrap();
    assert!(energy.ends_with("; balls fell in meanwhile") && !energy.contains('%'), "{energy}");
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
fn no_output_takes_the_place_of_an_input() {
    let here = folder();
    let (scene, deltas) = (here.path().join("mine.toml"), here.path().join("deltas.txt"));
    fs::write(&scene, succeed(&here, &["scene", "draw"])).unwrap();
    fs::write(&deltas, "0.5\n").unwrap();
    let replay = here.path().join("mine.replay");
    fs::write(&replay, "carom replay 1\n").unwrap();
    let before = [&scene, &deltas, &replay].map(|path| fs::read(path).unwrap());
    for option in ["--trace", "--image", "--gif", "--summary"] {
        let message = "is read, and would be written over; give the output a path of its own";
        fail(&here, &["run", "mine.toml", "--seconds", "0", option, "./mine.toml"], 2, message);
        fail(&here, &["run", "draw", "--deltas", "deltas.txt", option, "deltas.txt"], 2, message);
        fail(&here, &["run", "draw", "--commands", "mine.replay", option, "mine.replay"], 2, message);
    }
    assert_eq!([&scene, &deltas, &replay].map(|path| fs::read(path).unwrap()), before);
    // A scene that is built in is read from no file of its name.
    succeed(&here, &["run", "draw", "--seconds", "0", "--trace", "draw"]);
}

#[test]
fn a_gif_lasts_as_long_as_the_simulated_time_at_any_frame_rate() {
    let here = folder();
    for fps in ["24", "60", "144", "7.5"] {
        succeed(
            &here,
            &["run", "walls", "--size", "320x240", "--seconds", "2", "--fps", fps, "--gif", "it.gif"],
        );
        let file = fs::File::open(here.path().join("it.gif")).unwrap();
        let mut decoder = gif::DecodeOptions::new().read_info(file).unwrap();
        assert_eq!((decoder.width(), decoder.height()), (320, 240));
        let (mut shown, mut shortest) = (0, u16::MAX);
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            shown += u32::from(frame.delay);
            shortest = shortest.min(frame.delay);
        }
        // In hundredths of a second; the last frame is shown for two of them when the time is over.
        assert!((200..=202).contains(&shown), "{fps} fps: {shown}");
        assert!(shortest >= 2, "browsers slow down frames of 1/100 s");
    }
}

#[test]
fn a_gif_of_an_hour_lasts_an_hour() {
    let here = folder();
    succeed(
        &here,
        &["run", "draw", "--size", "200x200", "--seconds", "3600", "--fps", "1", "--gif", "it.gif"],
    );
    let file = fs::File::open(here.path().join("it.gif")).unwrap();
    let mut decoder = gif::DecodeOptions::new().read_info(file).unwrap();
    let mut shown = 0;
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        shown += u32::from(frame.delay);
    }
    assert_eq!(shown, 360_000);
}

#[test]
fn a_gif_shows_the_last_frame_in_the_pictures_own_colours() {
    let here = folder();
    let args =
        ["run", "gravity", "--size", "320x240", "--seconds", "1", "--gif", "it.gif", "--image", "it.png"];
    succeed(&here, &args);
    let picture = tiny_skia::Pixmap::load_png(here.path().join("it.png")).unwrap();
    let file = fs::File::open(here.path().join("it.gif")).unwrap();
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(file).unwrap();
    let mut shown = vec![[0_u8; 4]; 320 * 240];
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        let (left, top, width) = (usize::from(frame.left), usize::from(frame.top), usize::from(frame.width));
        for (at, &pixel) in frame.buffer.as_chunks().0.iter().enumerate() {
            if pixel[3] > 0 {
                shown[(top + at / width) * 320 + left + at % width] = pixel;
            }
        }
    }
    for ([red, green, blue, _], pixel) in shown.into_iter().zip(picture.pixels()) {
        let (gif, png) = ([red, green, blue], [pixel.red(), pixel.green(), pixel.blue()]);
        if [[26, 26, 26], [0, 255, 212], [255, 102, 255]].contains(&png) {
            assert_eq!(gif, png, "the three colours are exact");
        }
        let distance = gif.iter().zip(png).map(|(&a, b)| a.abs_diff(b)).max().unwrap();
        assert!(distance <= 10, "edges are near: {gif:?} {png:?}");
    }
}

#[test]
fn outputs_are_written_whole_or_not_at_all() {
    let here = folder();
    fs::create_dir(here.path().join("taken")).unwrap();
    fail(&here, &["run", "draw", "--trace", "taken"], 1, "taken: is a directory");
    fail(
        &here,
        &["run", "draw", "--image", "none/it.png"],
        1,
        "none/it.png: there is no folder none; no file was written; make the folder first",
    );
    fail(&here, &["run", "draw", "--trace", "t.csv", "--image", "none/it.png"], 1, "none/it.png");
    assert_eq!(names(here.path()), ["taken"], "nothing half-written stays behind");
    fs::write(here.path().join("t.csv"), "old").unwrap();
    succeed(&here, &["run", "draw", "--seconds", "0", "--trace", "t.csv"]);
    assert!(fs::read_to_string(here.path().join("t.csv")).unwrap().starts_with("frame,time,"));
}

#[cfg(unix)]
#[test]
fn a_device_is_written_to_and_not_replaced() {
    use std::os::unix::fs::FileTypeExt;
    let here = folder();
    succeed(&here, &["run", "draw", "--seconds", "0", "--trace", "/dev/null"]);
    assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_an_error_and_a_closed_pipe_is_not() {
    let here = folder();
    fail(&here, &["run", "gravity", "--trace", "/dev/full"], 1, "/dev/full: ");
    let mut child = Command::new(env!("CARGO_BIN_EXE_carom"))
        .args(["run", "gravity", "--seconds", "100", "--trace", "-"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty(), "{}", stderr(&output));
}

#[cfg(target_os = "linux")]
#[test]
fn a_reader_that_goes_away_takes_no_file_with_it() {
    let here = folder();
    let mut child = Command::new(env!("CARGO_BIN_EXE_carom"))
        .args(["run", "gravity", "--seconds", "20", "--trace", "-", "--image", "last.png"])
        .current_dir(here.path())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert!(child.wait().unwrap().success());
    assert!(tiny_skia::Pixmap::load_png(here.path().join("last.png")).is_ok());
}

#[cfg(target_os = "linux")]
#[test]
fn the_exit_code_tells_even_where_standard_error_is_full() {
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let status =
        Command::new(env!("CARGO_BIN_EXE_carom")).args(["run", "nosuch"]).stderr(full).status().unwrap();
    assert_eq!(status.code(), Some(2));
}

#[cfg(unix)]
#[test]
fn a_replaced_file_keeps_its_mode_and_a_new_one_has_the_usual() {
    use std::os::unix::fs::PermissionsExt;
    let here = folder();
    let mode = |name| fs::metadata(here.path().join(name)).unwrap().permissions().mode() & 0o777;
    fs::write(here.path().join("usual"), "").unwrap();
    fs::write(here.path().join("private"), "").unwrap();
    fs::set_permissions(here.path().join("private"), fs::Permissions::from_mode(0o600)).unwrap();
    succeed(&here, &["run", "draw", "--seconds", "0", "--trace", "new", "--image", "private"]);
    assert_eq!((mode("private"), mode("new")), (0o600, mode("usual")));
}

#[test]
fn calls_that_make_no_sense_exit_with_2_and_say_what_would() {
    let here = folder();
    fs::write(here.path().join("bad.toml"), "[[ball]]\nposition = [1, 2]\nradius = -1\n").unwrap();
    fs::write(here.path().join("bad.txt"), "0\n0.1\nsoon\n").unwrap();
    fs::write(here.path().join("negative.txt"), "-1\n").unwrap();
    fs::write(here.path().join("empty.txt"), "# nothing\n").unwrap();
    fs::write(here.path().join("a.replay"), "carom replay 1\nscene gravity\nframe 0\n").unwrap();
    fs::write(here.path().join("binary.toml"), [0xff, 0xfe, 0x00]).unwrap();
    let cases: &[(&[&str], &str)] = &[
        (&["run", "nosuch"], "there is no scene \"nosuch\"; choose from: draw"),
        (&["run", "nosuch.toml"], "nosuch.toml: "),
        (&["run", "bad.toml"], "bad.toml:3: radius is -1 px"),
        (&["run", "binary.toml"], "binary.toml: "),
        (&["scene", "bad.toml"], "bad.toml:3"),
        (&["run"], "<SCENE>"),
        (&["run", "draw", "--seconds", "-1"], "--seconds"),
        (&["run", "draw", "--seconds", "nan"], "--seconds is NaN"),
        (&["run", "draw", "--fps", "0"], "--fps is 0"),
        (&["run", "draw", "--deltas", "none.txt"], "none.txt: "),
        (&["run", "draw", "--deltas", "bad.txt"], "bad.txt:3: \"soon\" is not a number"),
        (&["run", "draw", "--deltas", "negative.txt"], "negative.txt:1: delta is -1 s; it must be from 0"),
        (&["run", "draw", "--deltas", "empty.txt"], "empty.txt has no deltas"),
        (&["run", "draw", "--deltas", "bad.txt", "--fps", "30"], "cannot be used with"),
        (&["run", "draw", "--size", "0x10"], "size is 0 px; it must be from 1"),
        (&["run", "draw", "--size", "wide"], "such as 1280x720"),
        (&["run", "draw", "--every", "0", "--trace", "-"], "write a whole number from 1, such as 10"),
        (&["run", "draw", "--every", "3"], "--trace <FILE.csv>"),
        (&["run", "draw", "--image", "it.jpg"], "what is written is a png; name it it.png"),
        (&["run", "draw", "--image", "it.gif"], "what is written is a png; name it it.png"),
        (&["run", "draw", "--gif", "it.mp4"], "what is written is a gif; name it it.gif"),
        (&["run", "draw", "--seed", "-1"], "write a whole number from 0 to 18446744073709551615"),
        (&["run", "draw", "--seconds", "soon"], "write a number of seconds, such as 2.5"),
        (&["run", "draw", "--fps", "fast"], "write a number of frames per second, such as 60"),
        (
            &["run", "a.replay"],
            "a.replay is a replay, not a scene; play it with carom run gravity --commands \"a.replay\"",
        ),
        (&["a.replay"], "carom run gravity --commands \"a.replay\""),
        (&["run", "draw", "--solver", "magic"], "there is no solver \"magic\""),
        (&["run", "draw", "--balls", "-5"], "write a whole number from 0 to 10000000, such as 50"),
        (&["run", "draw", "--balls", "99999999999"], "balls are too many; the most is 10000000"),
        (&["run", "gravity", "--size", "100x100"], "wider than the world (100x100 px)"),
        (&["run", "draw", "--size", "100000x100000", "--image", "it.png"], "give a smaller --size"),
        (&["run", "draw", "--size", "70000x10", "--gif", "it.gif"], "at most 65535x65535 px"),
        #[cfg(feature = "window")]
        (&["gravity", "--size", "100x100"], "wider than the world (100x100 px)"),
        (&["nosuch"], "there is no scene \"nosuch\""),
        (&["--scale", "0"], "such as 0.5"),
    ];
    for (args, message) in cases {
        fail(&here, args, 2, message);
    }
}

#[test]
fn more_than_there_may_be_is_refused_before_it_is_made() {
    let here = folder();
    let write = |name: &str, text: &str| fs::write(here.path().join(name), text).unwrap();
    write("one.toml", "[[fill]]\ncount = 1000000000\nradius = 0.001\n");
    write("sum.toml", &"[[fill]]\ncount = 4000000\nradius = 0.001\n".repeat(3));
    let keys: Vec<String> = (0..100_000).map(|key| format!("key{key} = 1\n")).collect();
    write("keys.toml", &keys.concat());
    write("digits.txt", &"9".repeat(1_000_000));
    fs::create_dir(here.path().join("folder.toml")).unwrap();
    // Longer than any may be, and all of it nothing.
    fs::File::create(here.path().join("long.toml")).unwrap().set_len((1 << 27) + 1).unwrap();
    fs::File::create(here.path().join("long.txt")).unwrap().set_len((1 << 28) + 1).unwrap();
    let cases: &[(&[&str], &str)] = &[
        (&["run", "one.toml"], "one.toml:2: count is 1000000000; a simulation takes at most 10000000 balls"),
        (
            &["run", "sum.toml"],
            "sum.toml:8: the scene has 12000000 balls; a simulation takes at most 10000000",
        ),
        (&["run", "draw", "--balls", "1000000000"], "1000000001 balls are too many; the most is 10000000"),
        (&["run", "draw", "--balls", "18446744073709551615"], "balls are too many; the most is 10000000"),
        (&["run", "keys.toml"], "keys.toml:1: unknown field `key0`, expected one of"),
        (&["run", "long.toml"], "long.toml has more than 134217728 bytes"),
        (&["run", "draw", "--deltas", "long.txt"], "long.txt: the file has more than 268435456 bytes"),
        (&["run", "draw", "--deltas", "digits.txt"], "digits.txt:1: delta is inf s"),
        (&["run", "draw", "--deltas", "folder.toml"], "folder.toml: Is a directory"),
        (&["run", "folder.toml"], "folder.toml: Is a directory"),
        (&["run", "draw", "--seconds", "1e9", "--fps", "1e9"], "ask for at most 1e15"),
    ];
    for (args, message) in cases {
        let begun = Instant::now();
        fail(&here, args, 2, message);
        assert!(begun.elapsed() < Duration::from_secs(20), "{args:?} took {:?}", begun.elapsed());
    }
}

#[test]
fn a_run_that_is_checked_keeps_the_laws_and_says_no_more() {
    let here = folder();
    for (scene, solver) in
        [("gravity", "canvas"), ("gravity", "exact"), ("gravity", "contact"), ("rain", "contact")]
    {
        let run = ["run", scene, "--solver", solver, "--seconds", "3"];
        succeed(&here, &[&run[..], &["--check", "--trace", "checked.csv"]].concat());
        succeed(&here, &[&run[..], &["--trace", "unchecked.csv"]].concat());
        let trace = |name| fs::read(here.path().join(name)).unwrap();
        assert!(
            trace("checked.csv") == trace("unchecked.csv"),
            "{scene} with {solver}: a check changes nothing"
        );
    }
    assert_eq!(names(here.path()), ["checked.csv", "unchecked.csv"]);
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
