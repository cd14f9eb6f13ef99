//! What a run prints and writes: traces, summaries, standard output.

use super::*;

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

#[test]
fn energy_that_fell_in_is_no_error_of_the_solver() {
    let here = folder();
    let rained = succeed(&here, &["run", "rain", "--seconds", "1"]);
    let energy = rained.lines().find(|line| line.starts_with("energy")).unwrap();
    assert!(energy.ends_with("; balls fell in meanwhile") && !energy.contains('%'), "{energy}");
}

#[test]
fn a_run_without_balls_says_so_and_a_run_with_any_does_not() {
    let here = folder();
    fs::write(here.path().join("empty.toml"), "").unwrap();
    fs::write(here.path().join("drop.replay"), "carom replay 1\nadd-random 1\nframe 0.1\n").unwrap();
    let says = "carom: empty.toml has no balls, and nothing will happen; write a [[ball]] or a [[fill]] into it, or add \
                some with --balls\n";
    let told = |args: &[&str]| {
        let output = carom(&here, &[&["run"][..], args].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(stdout(&output).starts_with("scene "), "{}", stdout(&output));
        stderr(&output)
    };
    assert_eq!(told(&["empty.toml", "--seconds", "0"]), says);
    assert_eq!(told(&["empty.toml", "--seconds", "0", "--check"]), says);
    assert_eq!(told(&["empty.toml", "--seconds", "0", "--balls", "1"]), "");
    assert_eq!(told(&["empty.toml", "--commands", "drop.replay"]), "");
    for scene in ["rain", "gas", "draw"] {
        assert_eq!(told(&[scene, "--seconds", "0"]), "");
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
