//! Output files, whatever happens to them: whole or not at all, with a message and an exit code that say which.
#![cfg(unix)]

use std::fs;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use tempfile::TempDir;

const CAROM: &str = env!("CARGO_BIN_EXE_carom");

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn assert_fails(output: &Output, message: &str) {
    assert_eq!(output.status.code(), Some(1), "{}", stderr(output));
    assert!(stderr(output).contains(message), "{}", stderr(output));
}

/// Runs the program through a shell that does `before` first.
fn through_shell(here: &Path, before: &str, args: &str) -> Output {
    let script = format!("{before}; exec \"$0\" {args}");
    Command::new("sh").args(["-c", &script, CAROM]).current_dir(here).output().unwrap()
}

/// A run that would go on for days, as soon as its outputs are begun.
fn begin(here: &Path, before: &str) -> Child {
    let run = "run gravity --seconds 1e6 --fps 1e3 --trace t.csv --every 1000 --gif it.gif --image last.png";
    begin_call(here, before, run, 3)
}

/// The same of any call, with so many outputs.
fn begin_call(here: &Path, before: &str, args: &str, outputs: usize) -> Child {
    let script = format!("{before}; exec \"$0\" {args}");
    let child = Command::new("sh").args(["-c", &script, CAROM]).current_dir(here).spawn().unwrap();
    wait_for_outputs(here, outputs);
    child
}

/// Waits until so many outputs are begun in a folder.
fn wait_for_outputs(folder: &Path, outputs: usize) {
    let begun = Instant::now();
    let is_output = |name: &String| name.starts_with(".carom-");
    while !folder.exists() || names(folder).into_iter().filter(is_output).count() < outputs {
        assert!(begun.elapsed() < Duration::from_secs(60), "no outputs were begun in {}", folder.display());
        thread::sleep(Duration::from_millis(5));
    }
}

fn send(child: &Child, signal: &str) {
    let status = Command::new("kill").args(["-s", signal, &child.id().to_string()]).status().unwrap();
    assert!(status.success());
}

/// Whether this signal is to be ignored here, as by nohup: then it is in all that is begun here, too.
fn is_ignored(number: i32) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.is_some_and(|mask| u64::from_str_radix(mask.trim(), 16).unwrap() & (1 << (number - 1)) != 0)
}

#[test]
fn a_signal_ends_a_run_as_it_says_and_leaves_nothing_half_written() {
    let signals = [("HUP", 1), ("INT", 2), ("QUIT", 3), ("TERM", 15), ("XCPU", 24)];
    for (name, number) in signals.into_iter().filter(|&(_, it)| !is_ignored(it)) {
        let here = folder();
        fs::write(here.path().join("t.csv"), "old").unwrap();
        // Some of them leave a core where they may.
        let mut child = begin(here.path(), "ulimit -c 0");
        send(&child, name);
        assert_eq!(child.wait().unwrap().signal(), Some(number));
        assert_eq!(names(here.path()), ["t.csv"], "after SIG{name}");
        assert_eq!(fs::read_to_string(here.path().join("t.csv")).unwrap(), "old");
    }
}

#[cfg(feature = "report")]
#[test]
fn a_signal_ends_a_report_and_leaves_nothing_half_written() {
    let here = folder();
    let mut child = begin_call(here.path(), ":", "report --out .", 1);
    // As a shell does for what it runs in the background.
    let (name, number) = if is_ignored(2) { ("TERM", 15) } else { ("INT", 2) };
    send(&child, name);
    assert_eq!(child.wait().unwrap().signal(), Some(number));
    assert!(names(here.path()).is_empty(), "{:?}", names(here.path()));
}

#[cfg(feature = "report")]
#[test]
fn a_report_that_ends_before_it_is_written_leaves_no_folder_that_it_made_and_every_other() {
    let here = folder();
    let (name, number) = if is_ignored(2) { ("TERM", 15) } else { ("INT", 2) };
    for (out, left) in [("new", &[][..]), ("new/and/deep", &[]), ("mine", &["mine"]), ("mine/new", &["mine"])]
    {
        if !left.is_empty() && !here.path().join("mine").exists() {
            fs::create_dir(here.path().join("mine")).unwrap();
        }
        let mut command = Command::new(CAROM);
        let mut child = command.args(["report", "--out", out]).current_dir(here.path()).spawn().unwrap();
        wait_for_outputs(&here.path().join(out), 1);
        send(&child, name);
        assert_eq!(child.wait().unwrap().signal(), Some(number));
        assert_eq!(names(here.path()), left, "after a report to {out}");
    }
    assert!(names(&here.path().join("mine")).is_empty());
    // Nor does one that fails.
    fs::write(here.path().join("mine/file"), "").unwrap();
    let failed =
        Command::new(CAROM).args(["report", "--out", "mine/file/deep"]).current_dir(here.path()).output();
    assert_fails(&failed.unwrap(), "mine/file/deep: Not a directory");
    assert_eq!(names(&here.path().join("mine")), ["file"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_signal_that_was_to_be_ignored_is() {
    let here = folder();
    // As nohup does, and a shell for what it runs in the background.
    let mut child = begin(here.path(), "trap '' HUP INT");
    send(&child, "HUP");
    send(&child, "INT");
    thread::sleep(Duration::from_millis(300));
    assert_eq!(child.try_wait().unwrap(), None);
    send(&child, "TERM");
    assert_eq!(child.wait().unwrap().signal(), Some(15));
    assert!(names(here.path()).is_empty(), "{:?}", names(here.path()));
}

#[test]
fn files_that_may_not_grow_are_errors_that_leave_what_was_there() {
    // Whether the shell wants its signal to be ignored or not.
    let outputs =
        [("--trace", "t.csv"), ("--gif", "it.gif"), ("--image", "last.png"), ("--summary", "s.json")];
    for ((option, name), first) in outputs.into_iter().flat_map(|it| [(it, "trap '' XFSZ"), (it, ":")]) {
        let here = folder();
        fs::write(here.path().join(name), "old").unwrap();
        let before = format!("{first}; ulimit -c 0; ulimit -f {}", if option == "--summary" { 0 } else { 8 });
        let args = format!("run galton --seconds 2 {option} {name}");
        let output = through_shell(here.path(), &before, &args);
        assert_fails(&output, &format!("{name}: File too large"));
        assert!(
            stderr(&output).contains("; this file was not written; allow larger files (ulimit -f)"),
            "{}",
            stderr(&output)
        );
        assert_eq!(names(here.path()), [name]);
        assert_eq!(fs::read_to_string(here.path().join(name)).unwrap(), "old");
    }
}

#[test]
fn one_output_that_fails_takes_no_other_with_it() {
    let here = folder();
    // The picture of one ball is small, the trace is not.
    let args = "run draw --size 40x40 --seconds 100 --trace t.csv --image last.png --summary s.json";
    let output = through_shell(here.path(), "trap '' XFSZ; ulimit -f 8", args);
    assert_fails(&output, "t.csv: File too large");
    assert!(!names(here.path()).iter().any(|name| name == "t.csv" || name.starts_with('.')));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error_that_leaves_nothing_half_written() {
    let here = folder();
    // A disk of 64 kB in a namespace of its own, where the system lets anyone have one.
    let script = "mount -t tmpfs -o size=64k none . && cd \"$PWD\" && \"$0\" run gravity --seconds 60 --trace t.csv; \
                  echo \"exit $?\"; ls -A";
    let mut command = Command::new("unshare");
    let output = command.args(["-rm", "sh", "-c", script, CAROM]).current_dir(here.path()).output();
    let Some(output) = output.ok().filter(|output| !stderr(output).contains("unshare:")) else {
        eprintln!("skipped: this system lets nobody mount a disk of their own");
        return;
    };
    if stderr(&output).contains("mount:") {
        eprintln!("skipped: this system lets nobody mount a disk of their own");
        return;
    }
    assert!(stderr(&output).contains("t.csv: No space left on device"), "{}", stderr(&output));
    assert_eq!(String::from_utf8_lossy(&output.stdout), "exit 1\n");
}

/// The program, as a user who is not allowed everything.
fn as_anyone() -> Command {
    let mut command = Command::new(CAROM);
    let root = Command::new("id").arg("-u").output().is_ok_and(|output| output.stdout == b"0\n");
    if root {
        const NOBODY: u32 = 65534;
        command.uid(NOBODY).gid(NOBODY);
    }
    command
}

#[test]
fn a_folder_that_may_only_be_read_is_an_error_at_once() {
    use std::os::unix::fs::PermissionsExt;
    let here = folder();
    fs::set_permissions(here.path(), fs::Permissions::from_mode(0o555)).unwrap();
    let calls: &[&[&str]] = &[
        &["run", "gravity", "--seconds", "1e7", "--trace", "t.csv"],
        #[cfg(feature = "report")]
        &["report", "--out", "."],
        #[cfg(feature = "report")]
        &["report", "--out", "new"],
    ];
    for args in calls {
        let begun = Instant::now();
        let output = match as_anyone().args(*args).current_dir(here.path()).output() {
            Ok(output) => output,
            Err(error) => {
                eprintln!("skipped: nobody else may run the program here: {error}");
                return;
            }
        };
        assert_fails(&output, "ermission denied");
        assert!(begun.elapsed() < Duration::from_secs(20), "known before what takes long");
        assert!(names(here.path()).is_empty());
    }
}

#[test]
fn a_write_protected_file_is_kept_and_known_before_the_run() {
    use std::os::unix::fs::PermissionsExt;
    let here = folder();
    let set_mode = |path: &Path, mode| fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
    set_mode(here.path(), 0o777);
    let trace = |seconds, path| {
        let args = ["run", "gravity", "--seconds", seconds, "--trace", path];
        as_anyone().args(args).current_dir(here.path()).output()
    };
    // Their own file, in a folder where they may replace it.
    let file = here.path().join("t.csv");
    if let Err(error) = trace("0", "t.csv") {
        eprintln!("skipped: nobody else may run the program here: {error}");
        return;
    }
    let before = fs::read(&file).unwrap();
    std::os::unix::fs::symlink("t.csv", here.path().join("link")).unwrap();
    set_mode(&file, 0o444);
    for path in ["t.csv", "link"] {
        let begun = Instant::now();
        let says =
            format!("{path}: the file that is there is write-protected; this file was not written; allow");
        assert_fails(&trace("1e6", path).unwrap(), &says);
        assert!(begun.elapsed() < Duration::from_secs(20), "known before what takes long");
    }
    assert_eq!((fs::read(&file).unwrap(), names(here.path())), (before, vec!["link".into(), "t.csv".into()]));
    // Where they may write, it is replaced.
    set_mode(&file, 0o644);
    assert!(trace("1", "t.csv").unwrap().status.success());
}

#[cfg(feature = "report")]
#[test]
fn a_report_into_a_file_is_an_error_that_names_it() {
    let here = folder();
    fs::write(here.path().join("taken"), "old").unwrap();
    let output = Command::new(CAROM).args(["report", "--out", "taken"]).current_dir(here.path()).output();
    assert_fails(&output.unwrap(), "taken: File exists");
    fs::create_dir_all(here.path().join("folder/report.md")).unwrap();
    let output = Command::new(CAROM).args(["report", "--out", "folder"]).current_dir(here.path()).output();
    assert_fails(&output.unwrap(), "folder/report.md: is a directory");
    assert_eq!(fs::read_to_string(here.path().join("taken")).unwrap(), "old");
}

#[cfg(target_os = "linux")]
#[test]
fn whatever_prints_says_so_where_standard_output_is_full() {
    let here = folder();
    for args in [
        "--help",
        "--version",
        "run --help",
        "scenes",
        "scenes --json",
        "scene galton",
        "run draw --seconds 0",
        "run draw --seconds 0 --trace -",
        "run draw --seconds 0 --image -",
        "run draw --seconds 0 --summary -",
        "run draw --gif -",
        #[cfg(feature = "report")]
        "report --cell coincident/exact --quick",
    ] {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let mut command = Command::new(CAROM);
        let output = command.args(args.split(' ')).current_dir(here.path()).stdout(full).output().unwrap();
        assert_fails(&output, "standard output: No space left on device");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn whatever_prints_ends_quietly_where_nobody_reads() {
    let here = folder();
    for args in [
        "--help",
        "--version",
        "scenes",
        "scene galton",
        "run draw --seconds 0",
        "run galton --seconds 1 --trace -",
        "run galton --seconds 1 --gif -",
        "run galton --seconds 1 --image -",
        "run galton --seconds 1 --summary -",
    ] {
        let mut command = Command::new(CAROM);
        command.args(args.split(' ')).current_dir(here.path()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        // Beside a picture on standard output, the summary is on standard error.
        assert!(
            output.status.success() && !stderr(&output).contains("carom:"),
            "{args}: {}",
            stderr(&output)
        );
    }
}
