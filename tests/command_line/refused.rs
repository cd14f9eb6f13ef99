//! Calls that are refused, and what is said then.

use super::*;

#[test]
fn calls_that_make_no_sense_exit_with_2_and_say_what_would() {
    let here = folder();
    fs::write(here.path().join("bad.toml"), "[[ball]]\nposition = [1, 2]\nradius = -1\n").unwrap();
    fs::write(here.path().join("heavy.toml"), "gravity = [0, 99999999999999999999]\n").unwrap();
    let full = "size = [99, 99]\n[[ball]]\nposition = [50, 50]\nradius = 999\nwide = true\n";
    fs::write(here.path().join("full.toml"), full).unwrap();
    fs::write(here.path().join("bad.txt"), "0\n0.1\nsoon\n").unwrap();
    fs::write(here.path().join("negative.txt"), "-1\n").unwrap();
    fs::write(here.path().join("empty.txt"), "# nothing\n").unwrap();
    fs::write(here.path().join("a.replay"), "carom replay 1\nscene gravity\nframe 0\n").unwrap();
    fs::write(here.path().join("binary.toml"), [0xff, 0x00, 0xfe]).unwrap();
    fs::write(here.path().join("latin.toml"), b"size = [99, 99]\nabout = \"B\xe4lle\"\n").unwrap();
    fs::write(here.path().join("cut.replay"), "carom replay 1\nscene draw\nframe 0.").unwrap();
    let cases: &[(&[&str], &str)] = &[
        (&["run", "nosuch"], "there is no scene \"nosuch\"; choose from: draw"),
        (&["run", "nosuch.toml"], "nosuch.toml: "),
        (&["run", "bad.toml"], "bad.toml:3: radius is -1 px"),
        (&["run", "heavy.toml"], "heavy.toml:1: y of gravity is 1e20"),
        (&["run", "binary.toml"], "binary.toml:1: this is not UTF-8; save the file in that encoding"),
        (&["run", "latin.toml"], "latin.toml:2: this is not UTF-8"),
        (&["run", "draw", "--commands", "cut.replay"], "cut.replay:3: the file ends within this line"),
        (&["scene", "bad.toml"], "bad.toml:3"),
        (&["run"], "<SCENE>"),
        (&["run", "draw", "--seconds", "-1"], "--seconds"),
        (&["run", "draw", "--seconds", "nan"], "the time is NaN s; give 0 to 1e9 (--seconds)"),
        (&["run", "draw", "--seconds", "1e308"], "the time is 1e308 s; give 0 to 1e9 (--seconds)"),
        (&["run", "draw", "--fps", "0"], "the frame rate is 0 per second; give 1e-6 to 1e9 (--fps)"),
        (
            &["run", "draw", "--seconds", "1e9", "--fps", "1e9"],
            "1e9 s at 1e9 frames per second are 1e18 frames; ask for at most 1e15 (--seconds, --fps)",
        ),
        (&["run", "draw", "--deltas", "none.txt"], "none.txt: "),
        (&["run", "draw", "--deltas", "bad.txt"], "bad.txt:3: \"soon\" is not a number"),
        (&["run", "draw", "--deltas", "negative.txt"], "negative.txt:1: delta is -1 s; it must be from 0"),
        (&["run", "draw", "--deltas", "empty.txt"], "empty.txt has no deltas"),
        (&["run", "draw", "--deltas", "bad.txt", "--fps", "30"], "cannot be used with"),
        (&["run", "draw", "--size", "0x10"], "size is 0 px; it must be from 1"),
        (&["run", "draw", "--size", "99999999999x1"], "size is 9.9999999999e10 px; it must be from 1"),
        (&["run", "draw", "--size", "wide"], "such as 1280x720"),
        (&["run", "draw", "--size", "-1x5"], "write width and height in whole px, such as 1280x720"),
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
        (&["run", "draw", "--size", "100000x100000", "--image", "it.png"], "and at least 1x1 px (--size)"),
        (
            &["run", "draw", "--size", "70000x10", "--gif", "it.gif"],
            "at most 65535x65535 px, not 70000x10; ask for a smaller world (--size)",
        ),
        (
            &["run", "full.toml", "--balls", "3"],
            "found room; ask for fewer, or for a larger world (--balls, --size)",
        ),
        (
            &["run", "pile", "--size", "1000x500"],
            "carom: pile does not fit into a world of 1000x500 px: only 1968 of 2000 balls found room; ask for a larger \
             one, or for another scene (--size)\n",
        ),
        (&["run", "galton", "--size", "400x400"], "galton does not fit into a world of 400x400 px: only "),
        #[cfg(feature = "window")]
        (&["pile", "--size", "1000x500"], "ask for a larger one, or for another scene (--size)\n"),
        #[cfg(feature = "window")]
        (&["gravity", "--size", "100x100"], "wider than the world (100x100 px)"),
        (&["nosuch"], "there is no scene \"nosuch\""),
        (&["rnu", "elastic"], "there is no command 'rnu'; did you mean 'run'?"),
        (&["gravity", "elastic"], "'elastic' is one word too many"),
        (&["--solver", "exact", "run", "gravity"], "run comes first: carom run …"),
        (&["--balls", "5", "scenes"], "scenes comes first: carom scenes …"),
        (&["scen", "gravity"], "there is no command 'scen'; did you mean 'scene'?"),
        (&["--seed", "1", "rnu", "elastic"], "there is no command 'rnu'; did you mean 'run'?"),
        (&["--scale", "0"], "such as 0.5"),
    ];
    for (args, message) in cases {
        fail(&here, args, 2, message);
    }
}

#[test]
fn a_file_in_utf_16_is_told_so_with_what_to_save_it_as_and_none_of_its_noise() {
    let here = folder();
    let text = "\u{feff}size = [99, 99]\n";
    let write = |name: &str, bytes: fn(u16) -> [u8; 2]| {
        fs::write(here.path().join(name), text.encode_utf16().flat_map(bytes).collect::<Vec<u8>>()).unwrap();
    };
    write("little.toml", u16::to_le_bytes);
    write("big.toml", u16::to_be_bytes);
    for name in ["little.toml", "big.toml"] {
        let said = stderr(&carom(&here, &["run", name]));
        assert_eq!(said, format!("carom: {name}: this is UTF-16; save the file as UTF-8\n"));
        fail(&here, &["run", "draw", "--deltas", name], 2, &format!("{name}: this is UTF-16, not UTF-8; "));
        fail(&here, &["run", "draw", "--commands", name], 2, &format!("{name}: this is UTF-16, not UTF-8; "));
    }
}

#[test]
#[cfg(not(feature = "report"))]
fn a_program_without_its_report_says_so() {
    fail(&folder(), &["report"], 1, "this carom was built without its report");
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
