//! Where outputs go: never over an input, whole or not at all, to devices and pipes, too.

use super::*;

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

#[cfg(unix)]
#[test]
fn nothing_that_goes_to_standard_output_is_appended_to_an_input() {
    let here = folder();
    let scene = succeed(&here, &["scene", "draw"]);
    fs::write(here.path().join("mine.toml"), &scene).unwrap();
    fs::write(here.path().join("deltas.txt"), "0.5\n").unwrap();
    let appending = |name: &str, args: &[&str]| {
        let file = fs::File::options().append(true).open(here.path().join(name)).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_carom"));
        command.current_dir(here.path()).args(args).stdout(file).output().unwrap()
    };
    let run = ["run", "mine.toml", "--deltas", "deltas.txt"];
    for name in ["mine.toml", "deltas.txt"] {
        for output in [&[][..], &["--image", "it.png"], &["--summary", "-"], &["--trace", "-"]] {
            let before = fs::read(here.path().join(name)).unwrap();
            let refused = appending(name, &[&run[..], output].concat());
            assert_eq!(refused.status.code(), Some(2), "{name} {output:?}");
            let says = "standard output goes to a file that is read, and would be changed; send it elsewhere";
            assert!(stderr(&refused).contains(says), "{}", stderr(&refused));
            assert_eq!(fs::read(here.path().join(name)).unwrap(), before, "{output:?}");
        }
        // Where the summary goes to a file, standard output stays empty.
        let output = appending(name, &[&run[..], &["--summary", "s.json"]].concat());
        assert!(output.status.success(), "{}", stderr(&output));
    }
    assert_eq!(names(here.path()), ["deltas.txt", "mine.toml", "s.json"]);
    // Nor is a scene printed into its own file, by whatever name.
    for name in ["mine.toml", "./mine.toml"] {
        let refused = appending("mine.toml", &["scene", name]);
        assert_eq!(refused.status.code(), Some(2), "{name}");
        let says = "standard output goes to a file that is read";
        assert!(stderr(&refused).contains(says), "{}", stderr(&refused));
        assert_eq!(fs::read_to_string(here.path().join("mine.toml")).unwrap(), scene);
    }
    assert!(appending("deltas.txt", &["scene", "mine.toml"]).status.success());
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
        "none/it.png: there is no folder none; this file was not written; make the folder first",
    );
    fail(&here, &["run", "draw", "--trace", "t.csv", "--image", "none/it.png"], 1, "none/it.png");
    #[cfg(target_os = "linux")]
    fail(&here, &["run", "draw", "--image", "/proc/it.png"], 1, "/proc/it.png: no file can be made in /proc");
    assert_eq!(names(here.path()), ["taken"], "nothing half-written stays behind");
    fs::write(here.path().join("t.csv"), "old").unwrap();
    succeed(&here, &["run", "draw", "--seconds", "0", "--trace", "t.csv"]);
    assert!(fs::read_to_string(here.path().join("t.csv")).unwrap().starts_with("frame,time,"));
}

#[cfg(unix)]
#[test]
fn a_path_where_no_file_can_be_is_known_before_the_run_with_what_would_do() {
    let here = folder();
    fs::create_dir(here.path().join("taken")).unwrap();
    fs::write(here.path().join("file"), "").unwrap();
    let long = "a".repeat(256);
    let slash = ": a path that ends with a slash or with a dot is that of a folder; this file was not written; end it \
                 with the name of a file";
    let cases = [
        ("none/".to_owned(), slash),
        ("./none/.".to_owned(), slash),
        ("none/it".to_owned(), ": there is no folder none; this file was not written; make the folder first"),
        ("taken".to_owned(), ": is a directory; this file was not written; name a file in it"),
        ("taken/".to_owned(), ": is a directory; this file was not written; name a file in it"),
        (".".to_owned(), ": is a directory; this file was not written; name a file in it"),
        ("file/".to_owned(), "; this file was not written; what should be its folder is a file"),
        ("file/it".to_owned(), "; this file was not written; what should be its folder is a file"),
        (long.clone(), "; this file was not written; give it a shorter name"),
        (format!("{long}/it"), "; this file was not written; give it a shorter name"),
        (format!("taken/{long}"), "; this file was not written; give it a shorter name"),
    ];
    for (path, says) in cases {
        for option in ["--trace", "--image", "--gif", "--summary"] {
            let begun = Instant::now();
            let args = ["run", "gravity", "--seconds", "1e6", option, &path];
            let output = carom(&here, &args);
            assert_eq!(output.status.code(), Some(1), "{args:?}");
            let said = stderr(&output);
            assert!(said.starts_with(&format!("carom: {path}: ")), "{said}");
            assert!(said.contains(says), "{said}");
            assert!(begun.elapsed() < Duration::from_secs(20), "known before what takes long");
        }
    }
    assert_eq!(names(here.path()), ["file", "taken"]);
}

#[cfg(unix)]
#[test]
fn an_output_to_a_link_stands_where_the_link_leads_whether_a_file_was_there_or_not() {
    use std::os::unix::fs::symlink;
    let here = folder();
    let link = |target: &str, name: &str| symlink(target, here.path().join(name)).unwrap();
    let is_link = |name: &str| here.path().join(name).is_symlink();
    fs::create_dir(here.path().join("to")).unwrap();
    fs::write(here.path().join("to/old.csv"), "old").unwrap();
    link("to/old.csv", "old");
    link("to/new.csv", "new");
    link(here.path().join("new").to_str().unwrap(), "twice");
    for name in ["old", "twice", "new"] {
        succeed(&here, &["run", "draw", "--seconds", "0", "--trace", name]);
        assert!(is_link(name) && fs::read_to_string(here.path().join(name)).unwrap().starts_with("frame,"));
    }
    assert_eq!(names(&here.path().join("to")), ["new.csv", "old.csv"]);
    // Two ways to a place where nothing is yet are two ways to one place.
    link("to/other", "other");
    let same = ["run", "draw", "--trace", "to/other", "--image", "other"];
    fail(&here, &same, 2, "two outputs go to other; give each a path of its own");
    link("none/it.csv", "astray");
    link("none/", "folder");
    link("round", "round");
    let says = "astray: this is a link to none/it.csv, and there is no folder none; this file was not written; make the \
                folder first, or give another";
    fail(&here, &["run", "gravity", "--seconds", "1e6", "--trace", "astray"], 1, says);
    let says = "folder: this is a link to none/, and a path that ends with a slash";
    fail(&here, &["run", "gravity", "--seconds", "1e6", "--trace", "folder"], 1, says);
    fail(&here, &["run", "gravity", "--seconds", "1e6", "--trace", "round"], 1, "round: ");
    assert!(is_link("astray") && is_link("round") && !here.path().join("none").exists());
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
fn of_two_outputs_one_of_which_fails_only_that_one_is_said_not_to_be_written() {
    let here = folder();
    let outputs = ["--trace", "ok.csv", "--image", "/dev/full", "--summary", "s.json"];
    let args = [&["run", "gravity", "--seconds", "1"][..], &outputs].concat();
    fail(&here, &args, 1, "; this file was not written; check");
    assert_eq!(names(here.path()), ["ok.csv", "s.json"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_scene_file_is_run_and_printed_whatever_bytes_its_name_has() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let here = folder();
    let name = OsStr::from_bytes(b"B\xe4lle.toml");
    let scene = succeed(&here, &["scene", "draw"]);
    fs::write(here.path().join(name), &scene).unwrap();
    let call = |args: &[&OsStr]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_carom"));
        command.args(args).current_dir(here.path()).output().unwrap()
    };
    let [run, print, seconds, zero, trace] = ["run", "scene", "--seconds", "0", "--trace"].map(OsStr::new);
    assert_eq!(stdout(&call(&[print, name])), scene);
    let ran = call(&[run, name, seconds, zero]);
    assert!(ran.status.success(), "{}", stderr(&ran));
    // Nor is it written over, by any path to it.
    assert_eq!(call(&[run, name, seconds, zero, trace, name]).status.code(), Some(2));
    let none = call(&[run, OsStr::from_bytes(b"no\xe4.toml")]);
    assert_eq!(none.status.code(), Some(2));
    assert!(stderr(&none).contains("no\u{fffd}.toml: No such file"), "{}", stderr(&none));
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
