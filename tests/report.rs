//! `carom report`, run as a process: its files, its names, its errors.
#![cfg(feature = "report")]

use std::fs;
use std::process::{Command, Output};

use tempfile::TempDir;

fn report(folder: &TempDir, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_carom"));
    command.arg("report").args(args).current_dir(folder.path()).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

#[test]
fn one_problem_alone_is_a_report_with_its_tables_pictures_and_points() {
    let here = tempfile::tempdir().unwrap();
    let output = report(&here, &["--quick", "--only", "free-flight", "--out", "some/where"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(output.stderr.is_empty(), "{}", text(&output.stderr));
    let folder = here.path().join("some/where");
    assert_eq!(text(&output.stdout).trim(), "some/where/report.md");
    let page = fs::read_to_string(folder.join("report.md")).unwrap();
    for wanted in
        ["# Which solver", "| processor |", "## Error against run time", "`free-flight`", "## What failed"]
    {
        assert!(page.contains(wanted), "{wanted} is not in {page}");
    }
    // Every picture that the page shows is there, and every file is one that it speaks of or a table.
    for linked in page.split("](").skip(1).map(|rest| rest.split(')').next().unwrap()) {
        assert!(folder.join(linked).exists(), "{linked}");
    }
    let points = fs::read_to_string(folder.join("points.csv")).unwrap();
    let header = points.lines().next().unwrap();
    assert!(header.starts_with("problem,solver,quantity,setting,error_end_px,error_run_px,"), "{header}");
    for line in points.lines().skip(1) {
        assert_eq!(line.split(',').count(), header.split(',').count(), "{line}");
        assert!(line.starts_with("free-flight,") && line.ends_with(",done"), "{line}");
    }
    for solver in ["canvas", "exact", "contact"] {
        assert!(points.contains(&format!(",{solver},")));
    }
    assert!(fs::read_to_string(folder.join("closed-end.svg")).unwrap().contains("order 1"));
}

#[test]
fn one_case_alone_has_a_cell_for_each_solver() {
    let here = tempfile::tempdir().unwrap();
    let output = report(&here, &["--quick", "--only", "mass-rest-1e6"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let table = fs::read_to_string(here.path().join("report/stability.csv")).unwrap();
    assert!(table.contains("mass-rest-1e6,canvas,failed"), "{table}");
    assert!(table.contains("mass-rest-1e6,exact,held"), "{table}");
    let page = fs::read_to_string(here.path().join("report/report.md")).unwrap();
    assert!(page.contains("- mass-rest-1e6: `canvas`: "), "{page}");
}

#[test]
fn files_of_another_report_in_its_folder_are_told_and_left() {
    let here = tempfile::tempdir().unwrap();
    let read = |name: &str| fs::read(here.path().join("report").join(name)).unwrap();
    let page = || String::from_utf8(read("report.md")).unwrap();
    let (first, second) = (&["--quick", "--only", "free-flight"][..], &["--quick", "--only", "struck"][..]);
    let first = report(&here, first);
    assert_eq!((text(&first.stderr), page().contains("another report")), ("", false));
    fs::write(here.path().join("report/mine.png"), "mine").unwrap();
    let before = [read("closed-run.png"), read("points.csv")];
    let second = report(&here, second);
    let told = "closed-end.png, closed-end.svg, closed-run.png, closed-run.svg";
    let told_of = "carom: report still has files of another report, not of this one";
    assert_eq!(text(&second.stderr), format!("{told_of}: {told}\n"));
    assert_eq!(text(&second.stdout).trim(), "report/report.md");
    assert!(page().contains(&format!("not of this one: `{}`.", told.replace(", ", "`, `"))), "{}", page());
    assert!(
        read("closed-run.png") == before[0] && read("points.csv") != before[1] && read("mine.png") == b"mine"
    );
}

#[test]
fn a_name_that_is_not_there_is_refused_with_those_that_are() {
    let here = tempfile::tempdir().unwrap();
    for args in [&["--only", "nonsense"][..], &["--cell", "nonsense/exact"], &["--cell", "corner/nonsense"]] {
        let output = report(&here, args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(text(&output.stderr).contains("choose from: ") && output.stdout.is_empty());
        assert!(text(&output.stderr).contains("corner"), "{}", text(&output.stderr));
    }
    assert_eq!(fs::read_dir(here.path()).unwrap().count(), 0);
}

#[test]
fn a_folder_that_cannot_be_made_is_an_error_before_anything_is_measured() {
    let here = tempfile::tempdir().unwrap();
    fs::write(here.path().join("file"), "").unwrap();
    let output = report(&here, &["--out", "file/report"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("file/report"), "{}", text(&output.stderr));
}
