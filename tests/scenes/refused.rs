//! Wrong scene files are refused with line, reason and remedy.

use carom::{DVec2, Scene, SceneError};

/// A wrong scene file, the line that the message must name, and what it must say.
const WRONG: &[(&str, usize, &str)] = &[
    ("gravty = [0, 980]", 1, "did you mean gravity?"),
    ("[[ball]]\nposition = [1, 2]\nradus = 3", 3, "did you mean radius?"),
    ("[[fill]]\ncount = 1\nspede = 3", 3, "did you mean speed?"),
    ("[wals]", 1, "did you mean walls?"),
    ("[[balls]]", 1, "did you mean ball?"),
    ("gravty = [0, 980]", 1, "unknown field `gravty`, expected one of `about`, `solver`, `size`, `gravity`"),
    ("size = [1280, 720]\ngravity = 980", 2, "expected two numbers, such as [0, 980]"),
    ("gravity = [0, 1, 2]", 1, "expected two numbers, such as [0, 980]"),
    ("size = 1280", 1, "expected two numbers, such as [1280, 720]"),
    ("[[ball]]\nposition = 3\nradius = 3", 2, "expected two numbers, such as [30, 50]"),
    ("ball = [{ radius = 3, position = [1, 2], velocity = 5 }]", 1, "such as [-100, 390]"),
    ("gravity = [0, nan]", 1, "y of gravity is NaN px/s²; it must be from -1e9 to 1e9 px/s²"),
    ("size = [0, 720]", 1, "width of size is 0 px; it must be from 1 to 1e6 px"),
    ("size = [1280, 0.5]", 1, "height of size is 0.5 px; it must be from 1 to 1e6 px"),
    (
        "solver = \"magic\"",
        1,
        "there is no solver \"magic\" in this version; choose from: canvas, exact, contact",
    ),
    ("\n[walls]\nrestitution = 1.5", 3, "restitution is 1.5; it must be from 0 to 1"),
    ("[walls]\nbounce = 1", 2, "unknown field `bounce`, expected `restitution`"),
    ("walls = true", 1, "expected a table: [walls]"),
    ("[ball]\nposition = [1, 2]\nradius = 3", 1, "write its name in two brackets: [[ball]], [[fill]]"),
    ("[pairs]\nresponse = \"stick\"", 2, "unknown variant `stick`, expected `impulse` or `detect`"),
    ("walls = [0.5]", 1, "expected a table: [walls]"),
    (
        "[[rain]]\nrate = 2\nradius = 3",
        1,
        "invalid type: array, expected a table: [rain], or leave it out for none",
    ),
    ("ball = [[[1, 2], 3]]", 1, "expected a table: [[ball]]"),
    (
        "[[ball]]\nposition = [1, 2]",
        1,
        "missing field `radius`; add radius = 30, in px; in a world less than",
    ),
    ("[[ball]]\nradius = 5", 1, "missing field `position`; add position = [30, 50]"),
    ("[[fill]]\nradius = 5", 1, "missing field `count`; add count = 1000"),
    ("[rain]\nradius = 5", 1, "missing field `rate`; add rate = 200"),
    (
        "[[ball]]\nposition = [30 50]\nradius = 3",
        2,
        "this is no value that position may have; write position = [30, 50]",
    ),
    ("[[ball]]\nposition = (30, 50)\nradius = 3", 2, "write position = [30, 50]"),
    (
        "[[ball]]\nposition = [30, 50\nradius = 3",
        3,
        "an array that began before is still open here; close it with ]",
    ),
    ("size = [1280, 720", 1, "unclosed array, expected `]`; write size = [1280, 720]"),
    ("[[ball]]\nposition = [30, 50]\nradius =", 3, "radius has no value; write radius = 30"),
    ("[[ball]]\nposition = [30, 50]\nradius = 10px", 3, "write radius = 30"),
    ("[[ball]]\nposition = [30, 50]\nradius = .5", 3, "expected digits; write radius = 30"),
    (
        "[walls]\nrestitution = 0,7",
        2,
        "something stands after the value, where the line should end; write restitution = 0.7",
    ),
    ("solver = exact", 1, "text stands in quotes; write solver = \"exact\""),
    ("colour = red", 1, "neither a number, nor text in quotes, nor an array"),
    ("walls", 1, "neither a key with its value, such as radius = 30, nor a table's name"),
    ("// two balls", 1, "nor a comment after #"),
    (
        "[[ball]]\nposition = [1, 2]\nradius = 3\ngravity = [0, 980]",
        4,
        "write it at the top of the file, before the first name",
    ),
    ("[walls]\n[walls]", 2, "the table [walls] comes once"),
    ("[gravity]\ny = 980", 1, "expected two numbers, such as [0, 980]"),
    (
        "[ball]\nposition = [1, 2]\nradius = 3\n[ball]\nposition = [9, 9]\nradius = 3",
        4,
        "write its name in two brackets",
    ),
    (
        "[[ball]]\nposition = [1, 2]\nradius = 3\n[ball]\nposition = [9, 9]\nradius = 3",
        4,
        "write its name in two brackets",
    ),
    (
        "[ball]\nposition = [1, 2]\nradius = 3\n[[ball]]\nposition = [9, 9]\nradius = 3",
        4,
        "write its name in two brackets",
    ),
    ("[pairs]\nresponse = impulse", 2, "text stands in quotes; write response = \"impulse\""),
    ("[pairs]\nresponse = detect", 2, "text stands in quotes; write response = \"detect\""),
    ("[pairs]\nresponse = 1", 2, "write response = \"impulse\"; choose from: impulse, detect"),
    ("[pairs]\nresponse = true", 2, "write response = \"impulse\"; choose from: impulse, detect"),
    ("[pairs]\nresponse = bounce", 2, "write response = \"impulse\"; choose from: impulse, detect"),
    ("solver = 1", 1, "expected a string; write solver = \"exact\"; choose from: canvas, exact, contact"),
    (
        "solver = [1]",
        1,
        "invalid type: array, expected a string; write solver = \"exact\"; choose from: canvas",
    ),
    ("solver = verlet", 1, "write solver = \"exact\"; choose from: canvas, exact, contact"),
    ("solver =", 1, "solver has no value; write solver = \"exact\"; choose from: canvas, exact, contact"),
    ("solver = contact # for piles", 1, "text stands in quotes; write solver = \"contact\""),
    (
        "[[ball]]\nposition = [1, 2]\nradius = 3\nfixed = False",
        4,
        "this is no value that fixed may have; write fixed = true or fixed = false",
    ),
    ("[[ball]]\nposition = [1, 2]\nradius = 3\nfixed = no", 4, "write fixed = true or fixed = false"),
    (
        "[[ball]]\nposition = [1, 2]\nradius = 3\nmass = none",
        4,
        "this is no value that mass may have; write mass = 30",
    ),
    (
        "[[ball]]\nposition = [1, 2]\nradius = 3\nsize = 30",
        4,
        "a ball's size is its radius; write radius = 30",
    ),
    ("walls = false", 1, "expected a table: [walls], or leave it out for none"),
    ("walls = none", 1, "this is a table; write [walls], or leave it out for none"),
    ("walls = 1979-05-27", 1, "this is a date; write [walls]"),
    ("[[ball]]\nposition = [30, 50,\nradius = 3", 3, "an array that began before is still open here"),
    ("walls = { restitution = .7 }", 1, "expected digits; write restitution = 0.7"),
    ("[walls] # floor\n[walls] # floor", 2, "the table [walls] comes once"),
    (
        "ball = [{ position = [1, 2], radius = 3, position = [1, 2] }]",
        1,
        "duplicate key: position comes once in a table",
    ),
    ("\u{feff}solver = exact", 1, "text stands in quotes; write solver = \"exact\""),
    ("//gravity = [0, 980]", 1, "nor a comment after #"),
    ("[[ball]]\nradius = 30 // px", 2, "write radius = 30; a comment begins with #"),
    ("[[ball]] position = [1, 2]", 1, "something stands after the table's name"),
    ("radius = 30", 1, "radius does not belong here; write it below [[ball]], [[fill]] or [rain]"),
    ("[walls]\nposition = [1, 2]", 2, "position does not belong here; write it below [[ball]]"),
    (
        "[[fill]]\ncount = 3\nradius = 3\nseed = random",
        4,
        "this is no value that seed may have; write seed = 7",
    ),
    ("rain = yes", 1, "this is a table; write [rain]"),
    ("recursive = 1", 1, "unknown field `recursive`, expected one of"),
    ("gravity = { y = 980 }", 1, "invalid type: table, expected two numbers"),
    ("[[fill]]\ncount = 1e3\nradius = 3", 2, "invalid type: number `1000.0`, expected a whole number"),
    ("[[ball]]\nposition = [1, 2]\nradius = 0", 3, "radius is 0 px; it must be from 1e-6 to 1e9 px"),
    ("[[ball]]\nposition = [1, 2]\nradius = -3", 3, "radius is -3 px"),
    (
        "[[ball]]\nposition = [1, inf]\nradius = 3",
        2,
        "y of position is inf px; it must be from -1e9 to 1e9 px",
    ),
    (
        "[[ball]]\nposition = [nan, 2]\nradius = 3",
        2,
        "x of position is NaN px; it must be from -1e9 to 1e9 px",
    ),
    ("[[ball]]\nposition = [1, 2]\nradius = \"3\"", 3, "expected a number, such as 12 or 0.5"),
    ("[[ball]]\nposition = [1, 2]\nradius = 3\nmass = 0", 4, "mass is 0; it must be from 1e-30 to 1e30"),
    ("[[ball]]\nposition = [1, 2]\nradius = 3\nvelocity = [1e300, 0]", 4, "x of velocity is 1e300 px/s"),
    ("[[ball]]\nposition = [1, 2]\nradius = 3\nrestitution = -0.1", 4, "restitution is -0.1"),
    ("[[ball]]\nposition = [1, 2]\nradius = 3\ncolour = 1", 4, "unknown field `colour`"),
    (
        "[[ball]]\nposition = [1, 2]\nradius = 3\nfixed = true\nvelocity = [0, 5]",
        5,
        "a fixed ball never moves; leave out its velocity, or write fixed = false",
    ),
    (
        "[[ball]]\nposition = [1, 2]\nradius = 3\nmass = 4\nfixed = true",
        4,
        "a fixed ball has no mass to choose: nothing moves it; leave out its mass, or write fixed = false",
    ),
    ("[[ball]]\nposition = [1, 2]\nradius = 3\nfixed = 1", 4, "expected a boolean: true or false"),
    ("[[ball]]\nposition = [1, 2]\nradius = 3\nfixed = yes", 4, "write fixed = true"),
    (
        "[[fill]]\ncount = 5\nradius = 3\nfixed = true",
        4,
        "fixed does not belong here; write it below [[ball]]",
    ),
    (
        "size = [100, 50]\n[[ball]]\nposition = [1, 2]\nradius = 26",
        4,
        "larger than the world (100x50 px); write at most 25, or a larger size, or wide = true",
    ),
    (
        "size = [100, 50]\n[walls]\n[[ball]]\nposition = [1, 2]\nradius = 26\nwide = true",
        5,
        "larger than the world (100x50 px); write at most 25",
    ),
    ("[[ball]]\nposition = [1, 2]\nradius = 3\nradius = 4", 4, "duplicate key: radius comes once in a table"),
    ("about = \"open", 1, "invalid basic string"),
    ("[[fill]]\ncount = -1\nradius = 3", 2, "expected a whole number from 0 up, such as 1000"),
    ("[[fill]]\ncount = 2.5\nradius = 3", 2, "expected a whole number from 0 up, such as 1000"),
    ("[[fill]]\ncount = 1000000000\nradius = 3", 2, "a simulation takes at most 10000000 balls"),
    ("[[fill]]\ncount = 9000000\nradius = 1\n[[fill]]\ncount = 9000000\nradius = 1", 5, "at most 10000000"),
    ("[[fill]]\ncount = 5\nradius = [6, 3]", 3, "write the smaller number first: [3, 6]"),
    ("[[fill]]\ncount = 5\nradius = [3]", 3, "expected a number or a range, such as 5 or [3, 6]"),
    ("[[fill]]\ncount = 5\nradius = 3\nspeed = -1", 4, "speed is -1 px/s; it must be from 0"),
    ("[[fill]]\ncount = 5\nradius = 3\nmass = 1\ndensity = 1", 4, "a density or a mass, not both"),
    ("[[fill]]\ncount = 5\nradius = 3\nseed = -1", 4, "expected a whole number from 0 up"),
    (
        "[[fill]]\ncount = 5\nradius = 3\nregion = [0, 0, 2000, 10]",
        4,
        "must lie in the world, [0, 0, 1280, 720]",
    ),
    ("[[fill]]\ncount = 5\nradius = 3\nregion = [0, 0, 5, 10]", 4, "no room for a ball of radius 3"),
    (
        "[[fill]]\ncount = 5\nradius = 3\nregion = [900, 10, 500, 300]",
        4,
        "the smaller number first: [500, 10, 900, 300]",
    ),
    (
        "[[fill]]\ncount = 5\nradius = 3\nmass = [1, 2]",
        4,
        "expected a number, such as 12 or 0.5; random balls whose masses differ have a density instead: density = 1",
    ),
    ("[[fill]]\ncount = 5\nradius = 3\nregion = [0, 0, 5]", 4, "four numbers, left, top, right and bottom"),
    (
        "[[ball]]\nposition = [640, 360]\nradius = 1000\nwide = true\n[[fill]]\ncount = 1\nradius = 3",
        5,
        "the fill's ball found no room; write a smaller count",
    ),
    ("\n\n[[fill]]\ncount = 100000\nradius = 20", 3, "found room; write a smaller count or radius"),
];

#[test]
fn wrong_scenes_are_refused_with_line_reason_and_remedy() {
    for &(text, line, message) in WRONG {
        let error = Scene::parse("bad.toml", text).and_then(|scene| scene.build()).map(drop).unwrap_err();
        let said = error.to_string();
        assert!(said.starts_with(&format!("bad.toml:{line}: ")), "{text:?}: {said}");
        assert!(said.contains(message), "{text:?}: {said}");
        assert!(matches!(error, SceneError::Wrong(_)));
    }
}

#[test]
fn keys_that_nothing_is_like_are_not_guessed_at() {
    for key in ["colour", "recursive", "abut", "x", "size2d"] {
        let error = Scene::parse("bad.toml", &format!("{key} = 1")).unwrap_err().to_string();
        let guessed = if key == "abut" { "; did you mean about?" } else { "`rain`" };
        assert!(error.lines().next().unwrap().ends_with(guessed), "{error}");
    }
}

#[test]
fn a_fill_whose_region_the_world_has_lost_says_so() {
    let text = "[[fill]]\ncount = 20\nradius = 5\nregion = [700, 0, 1280, 360]\n";
    let scene = Scene::parse("it.toml", text).unwrap();
    let error = scene.clone().with_size(DVec2::new(400.0, 300.0)).unwrap().build().unwrap_err().to_string();
    assert!(
        error.contains("its region reaches beyond this world of 400x300 px; ask for a larger one"),
        "{error}"
    );
    assert!(scene.with_size(DVec2::new(900.0, 300.0)).unwrap().build().is_ok(), "what is left has room");
}

#[test]
fn names_that_are_no_scenes_are_refused_with_those_that_are() {
    let unknown = Scene::load("gravitas").unwrap_err().to_string();
    assert!(
        unknown.contains("there is no scene \"gravitas\"") && unknown.contains("draw, move, two"),
        "{unknown}"
    );
    let missing = Scene::load("no/such/file.toml").unwrap_err().to_string();
    assert!(missing.starts_with("no/such/file.toml: "), "{missing}");
}
