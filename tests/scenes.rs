//! Scenes: the built-in ones are what the demo has, and run; wrong ones are refused with line, reason and remedy.

use carom::simulation::grid::Grid;
use carom::simulation::invariants::{max_overlap, max_wall_overlap, non_finite};
use carom::{DVec2, Part, Scene, SceneError, Simulation, Solver, scene};

#[test]
fn every_scene_runs_ten_seconds_with_nothing_non_finite_and_nothing_outside_its_walls() {
    for name in scene::names() {
        let mut simulation = Scene::load(name).unwrap().build().unwrap();
        for _ in 0..600 {
            simulation.advance(1.0 / 60.0).unwrap();
            assert_eq!(non_finite(simulation.balls()), 0, "{name}");
            assert!(max_wall_overlap(simulation.world(), simulation.balls()) < 1e-9, "{name}");
        }
    }
}

#[test]
fn every_scene_says_what_it_shows() {
    for name in scene::names() {
        let scene = Scene::load(name).unwrap();
        assert!(!scene.about().is_empty() && !scene.about().ends_with('.'), "{name}");
        assert_eq!(scene.name(), name);
    }
}

#[test]
fn stages_run_what_they_show_and_no_more() {
    use Part::{AllPairs, Events, Gravity, Impulse, Motion, Walls};
    let expected: [(&str, &[Part]); 8] = [
        ("draw", &[Motion]),
        ("move", &[Motion]),
        ("two", &[Motion]),
        ("detect", &[Motion, AllPairs]),
        ("walls", &[Motion, Walls, AllPairs, Events]),
        ("elastic", &[Motion, Walls, AllPairs, Events, Impulse]),
        ("inelastic", &[Motion, Walls, AllPairs, Events, Impulse]),
        ("gravity", &[Motion, Gravity, Walls, AllPairs, Events, Impulse]),
    ];
    assert_eq!(scene::names()[..scene::STAGES], expected.map(|(name, _)| name));
    for (name, parts) in expected {
        assert_eq!(Scene::load(name).unwrap().build().unwrap().parts(), parts, "{name}");
    }
    let crowd = Scene::load("gravity").unwrap().with_added(100, None).build().unwrap();
    assert!(crowd.parts().contains(&Part::Grid) && !crowd.parts().contains(&AllPairs));
}

#[test]
fn the_first_stages_balls_fly_as_the_demo_says() {
    let mut simulation = Scene::load("two").unwrap().build().unwrap();
    simulation.advance(0.0).unwrap();
    simulation.advance(2.0).unwrap();
    let positions: Vec<DVec2> = simulation.balls().iter().map(carom::Ball::position).collect();
    assert_eq!(positions, [DVec2::new(124.0, 150.0), DVec2::new(320.0, 270.0)]);
    assert_eq!(simulation.touching(), [false, false], "no contact between them");
}

#[test]
fn added_balls_are_the_same_for_the_same_seed() {
    let balls =
        |seed| Scene::load("elastic").unwrap().with_added(50, Some(seed)).build().unwrap().balls().to_vec();
    assert_eq!(balls(7).len(), 65);
    assert_eq!(balls(7), balls(7));
    assert_ne!(balls(7), balls(8));
}

/// Everything that may be random, two fills of one seed among it.
const RANDOM: &str = "[walls]\n[pairs]\n[[ball]]\nposition = [30, 40]\nradius = 5\n\
                      [[fill]]\ncount = 20\nradius = [3, 6]\nspeed = [0, 9]\n\
                      [[fill]]\ncount = 20\nradius = [3, 6]\nspeed = [0, 9]\n\
                      [rain]\nrate = 100\nradius = [2, 4]\n";

#[test]
fn a_reseeded_scene_has_other_random_balls_in_all_of_its_parts_the_same_for_the_same_seed() {
    let scene = || Scene::parse("it", RANDOM).unwrap().with_added(20, Some(3));
    // One ball of the file's, two fills, added ones, and what has rained in.
    let parts = |scene: Scene| -> Vec<Vec<carom::Ball>> {
        let (mut simulation, mut rain) = (scene.build().unwrap(), scene.rain().unwrap());
        let start = simulation.balls().to_vec();
        rain.advance_while(&mut simulation, 1.0, || true).unwrap();
        let rained = simulation.balls()[61..].to_vec();
        [&start[..1], &start[1..21], &start[21..41], &start[41..61], &rained].map(<[_]>::to_vec).into()
    };
    let (own, one, other) = (parts(scene()), parts(scene().reseeded(7)), parts(scene().reseeded(8)));
    assert_eq!(one, parts(scene().reseeded(7)));
    assert_eq!(one, parts(scene().reseeded(99).reseeded(7)), "whatever the seeds before");
    assert!(own[0] == one[0] && one[0] == other[0]);
    for part in 1..5 {
        assert_eq!(own[part].len(), one[part].len());
        assert!(own[part] != one[part] && one[part] != other[part], "part {part}");
    }
    let radii = |balls: &[carom::Ball]| balls.iter().map(carom::Ball::radius).collect::<Vec<f64>>();
    assert_ne!(radii(&one[1]), radii(&one[2]), "each fill has a seed of its own");
}

#[test]
fn scenes_say_whether_anything_of_them_is_random_and_those_without_stay_as_they_are() {
    let random: Vec<_> = ["pile", "rain", "gas", "galton"].into();
    for name in scene::names() {
        let scene = Scene::load(name).unwrap();
        assert_eq!(scene.has_random_parts(), random.contains(&name), "{name}");
        if !random.contains(&name) {
            assert_eq!(scene.clone().reseeded(5), scene);
        }
        assert!(scene.clone().with_added(1, None).has_random_parts());
        assert_eq!(scene.clone().with_added(0, None).has_random_parts(), scene.has_random_parts());
    }
    assert!(!Scene::parse("it", "[[fill]]\ncount = 0\nradius = 3\n").unwrap().has_random_parts());
}

#[test]
fn built_in_scenes_find_room_for_their_balls_with_other_seeds() {
    for name in ["pile", "gas", "galton"] {
        for seed in 0..20 {
            let built = Scene::load(name).unwrap().reseeded(seed).build();
            assert!(built.is_ok(), "{name} with seed {seed}: {}", built.unwrap_err());
        }
    }
}

#[test]
fn numbers_may_be_written_with_and_without_a_point_and_defaults_hold() {
    let scene = Scene::parse(
        "it",
        "[[ball]]\nposition = [3, 4.5]\nradius = 1\n[walls]\n[pairs]\n[[fill]]\ncount = 3\nradius = 5\n",
    );
    let simulation = scene.unwrap().build().unwrap();
    let ball = simulation.balls()[0];
    assert_eq!((ball.position(), ball.velocity()), (DVec2::new(3.0, 4.5), DVec2::ZERO));
    assert_eq!((ball.mass(), ball.restitution()), (1.0, 1.0));
    assert_eq!(simulation.world().walls(), Some(1.0));
    assert_eq!(simulation.world().pairs(), Some(carom::Pairs::Impulse));
    assert_eq!(simulation.world().size(), DVec2::new(1280.0, 720.0));
    for ball in &simulation.balls()[1..] {
        assert_eq!((ball.radius(), ball.velocity(), ball.restitution()), (5.0, DVec2::ZERO, 1.0));
        assert!((ball.mass() - 25.0 * std::f64::consts::PI).abs() < 1e-9, "density is 1 per px²");
    }
    assert!(Scene::parse("it", "").unwrap().build().unwrap().balls().is_empty());
}

#[test]
fn fills_keep_to_their_region() {
    let text = "[[fill]]\ncount = 200\nradius = [2, 4]\nregion = [100, 50, 300, 250]\nmass = 7\n";
    for ball in Scene::parse("it", text).unwrap().build().unwrap().balls() {
        let (low, high) = (ball.position() - ball.radius(), ball.position() + ball.radius());
        assert!(low.cmpge(DVec2::new(100.0, 50.0)).all() && high.cmple(DVec2::new(300.0, 250.0)).all());
        assert_eq!(ball.mass(), 7.0);
    }
}

#[test]
fn a_ball_is_fixed_where_its_file_says_so() {
    let table = |more: &str| format!("[[ball]]\nposition = [30, 40]\nradius = 5\n{more}\n");
    let text =
        table("fixed = true\nrestitution = 0.4") + &table("fixed = false\nmass = 3\nvelocity = [1, 2]");
    let simulation = Scene::parse("it", &text).unwrap().build().unwrap();
    let [fixed, free] = simulation.balls() else { panic!("{:?}", simulation.balls()) };
    assert!(fixed.is_fixed() && !free.is_fixed());
    assert_eq!((fixed.mass(), fixed.velocity(), fixed.restitution()), (f64::INFINITY, DVec2::ZERO, 0.4));
    assert_eq!((free.mass(), free.velocity()), (3.0, DVec2::new(1.0, 2.0)));
}

#[test]
fn added_balls_are_of_the_material_of_the_last_that_is_free() {
    let text = "[[ball]]\nposition = [30, 40]\nradius = 10\nmass = 50\nrestitution = 0.4\n\
                [[ball]]\nposition = [300, 400]\nradius = 5\nfixed = true\n";
    let simulation = Scene::parse("it", text).unwrap().with_added(20, None).build().unwrap();
    for ball in &simulation.balls()[2..] {
        assert!(!ball.is_fixed());
        assert_eq!(ball.restitution(), 0.4);
        let by_area = 50.0 * (ball.radius() / 10.0).powi(2);
        assert!((ball.mass() / by_area - 1.0).abs() < 1e-12, "{}", ball.mass());
    }
}

#[test]
fn galtons_board_piles_up_a_bell_in_its_middle() {
    let mut simulation = Scene::load("galton").unwrap().build().unwrap();
    for _ in 0..1200 {
        simulation.advance(1.0 / 60.0).unwrap();
    }
    let free = || simulation.balls().iter().filter(|ball| !ball.is_fixed()).map(carom::Ball::position);
    let fallen: Vec<DVec2> = free().filter(|position| position.y > 520.0).collect();
    // One or another may come to rest on top of a fixed one.
    assert!(fallen.len() >= 585 && free().count() == 600, "{} are in the bins", fallen.len());
    let count = fallen.len() as f64;
    let mean = fallen.iter().map(|position| position.x - 640.0).sum::<f64>() / count;
    let deviation =
        (fallen.iter().map(|position| (position.x - 640.0 - mean).powi(2)).sum::<f64>() / count).sqrt();
    // Measured with forty seeds: −8 to 5 px and 125 to 138 px. Three standard errors are 16 and 11 px.
    assert!(mean.abs() < 16.0, "the mean is {mean} px from the middle");
    assert!((115.0..150.0).contains(&deviation), "the standard deviation is {deviation} px");
    // The binomial distribution's shares within one and two standard deviations tend to 0.68 and 0.95.
    for (deviations, low, high) in [(1.0, 0.62, 0.82), (2.0, 0.9, 0.99)] {
        let within = |position: &&DVec2| (position.x - 640.0).abs() < deviations * deviation;
        let share = fallen.iter().filter(within).count() as f64 / count;
        assert!((low..high).contains(&share), "{share} within {deviations} standard deviations");
    }
}

/// A wrong scene file, the line that the message must name, and what it must say.
const WRONG: &[(&str, usize, &str)] = &[
    ("gravty = [0, 980]", 1, "did you mean gravity?"),
    ("[[ball]]\nposition = [1, 2]\nradus = 3", 3, "did you mean radius?"),
    ("[wals]", 1, "did you mean walls?"),
    ("[[balls]]", 1, "did you mean ball?"),
    ("gravty = [0, 980]", 1, "unknown field `gravty`, expected one of `about`, `solver`, `size`, `gravity`"),
    ("size = [1280, 720]\ngravity = 980", 2, "expected two numbers, such as [0, 980]"),
    ("gravity = [0, 1, 2]", 1, "expected two numbers, such as [0, 980]"),
    ("size = 1280", 1, "expected two numbers, such as [1280, 720]"),
    ("[[ball]]\nposition = 3\nradius = 3", 2, "expected two numbers, such as [30, 50]"),
    ("ball = [{ radius = 3, position = [1, 2], velocity = 5 }]", 1, "such as [-100, 390]"),
    ("gravity = [0, nan]", 1, "gravity is NaN px/s²; it must be from -1e9 to 1e9 px/s²"),
    ("size = [0, 720]", 1, "size is 0 px; it must be from 1 to 1e6 px"),
    ("size = [1280, 0.5]", 1, "size is 0.5 px; it must be from 1 to 1e6 px"),
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
    ("[[rain]]\nrate = 2\nradius = 3", 1, "expected a table: [rain]"),
    ("ball = [[[1, 2], 3]]", 1, "expected a table: [[ball]]"),
    ("[[ball]]\nposition = [1, 2]", 1, "missing field `radius`; add radius = 30"),
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
        "something stands behind the value, where the line should end; write restitution = 0.7",
    ),
    ("solver = exact", 1, "text stands in quotes; write solver = \"exact\""),
    ("colour = red", 1, "neither a number, nor text in quotes, nor an array"),
    ("walls", 1, "neither a key with its value, such as radius = 30, nor a table's name"),
    ("// two balls", 1, "nor a comment behind #"),
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
    ("//gravity = [0, 980]", 1, "nor a comment behind #"),
    ("[[ball]]\nradius = 30 // px", 2, "write radius = 30; a comment begins with #"),
    ("[[ball]] position = [1, 2]", 1, "something stands behind the table's name"),
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
    ("[[ball]]\nposition = [1, inf]\nradius = 3", 2, "position is inf px; it must be from -1e9 to 1e9 px"),
    ("[[ball]]\nposition = [1, 2]\nradius = \"3\"", 3, "expected a number, such as 12 or 0.5"),
    ("[[ball]]\nposition = [1, 2]\nradius = 3\nmass = 0", 4, "mass is 0; it must be from 1e-30 to 1e30"),
    ("[[ball]]\nposition = [1, 2]\nradius = 3\nvelocity = [1e300, 0]", 4, "velocity is 1e300 px/s"),
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
        error.contains("its region reaches beyond this world of 400x300 px; ask for a larger --size"),
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

#[test]
fn the_readmes_scene_file_is_a_scene() {
    let readme = include_str!("../README.md");
    let (_, file) = readme.split_once("```toml\n").unwrap();
    let (file, _) = file.split_once("```").unwrap();
    let simulation = Scene::parse("README", file).unwrap().build().unwrap();
    assert_eq!(simulation.balls().len(), 1001);
}

/// Rain into a small box.
const RAIN: &str = "solver = \"contact\"\nsize = [200, 200]\ngravity = [0, 980]\n[walls]\nrestitution = 0.3\n[pairs]\n\
                    [rain]\nrate = 60\nradius = [5, 8]\nrestitution = 0.3\n";

fn rained(seconds: f64, frame: f64) -> Simulation {
    let scene = Scene::parse("rain", RAIN).unwrap();
    let (mut simulation, mut rain) = (scene.build().unwrap(), scene.rain().unwrap());
    while simulation.time() < seconds - 1e-9 {
        let delta = frame.min(seconds - simulation.time());
        rain.advance_while(&mut simulation, delta, || true).unwrap();
    }
    simulation
}

#[test]
fn rain_is_the_same_whatever_the_frames() {
    let once = rained(2.0, 2.0);
    assert!(once.balls().len() > 100);
    for frame in [1.0 / 24.0, 1.0 / 60.0, 1.0 / 144.0] {
        assert!(rained(2.0, frame).balls() == once.balls(), "frames of {frame} s");
    }
}

#[test]
fn rain_ends_where_the_box_is_full_and_leaves_a_pile_at_rest() {
    let full = rained(30.0, 1.0 / 60.0);
    let area: f64 = full.balls().iter().map(|ball| std::f64::consts::PI * ball.radius().powi(2)).sum();
    assert!(area > 0.7 * 200.0 * 200.0, "filled to {}", area / 40_000.0);
    assert!(full.balls().iter().all(|ball| ball.velocity() == DVec2::ZERO));
    assert_eq!(max_wall_overlap(full.world(), full.balls()), 0.0);
}

#[test]
fn rain_says_what_is_wrong_with_it() {
    for (rain, message) in [
        ("rate = 0\nradius = 3", "rate is 0"),
        ("rate = 10\nradius = [6, 3]", "write the smaller number first"),
        ("rate = 10\nradius = 3\ncount = 5", "count does not belong here; write it below [[fill]]"),
        ("radius = 3", "missing field `rate`"),
        ("rate = 10\nradius = 400", "larger than the world"),
    ] {
        let error = Scene::parse("wet.toml", &format!("[rain]\n{rain}\n")).unwrap_err();
        assert!(error.to_string().contains(message), "{rain}: {error}");
    }
}

#[test]
fn rain_refuses_a_delta_that_is_no_time_before_anything_moves() {
    let scene = Scene::parse("rain", RAIN).unwrap();
    let (mut simulation, mut rain) = (scene.build().unwrap(), scene.rain().unwrap());
    for delta in [-1.0, f64::NAN, f64::INFINITY, 2e6] {
        assert!(rain.advance_while(&mut simulation, delta, || true).is_err());
    }
    assert_eq!((simulation.time(), simulation.balls().len()), (0.0, 0));
}

#[test]
fn a_scene_in_a_smaller_world_begins_between_its_walls_with_nothing_in_anything_else() {
    for solver in [Solver::Exact, Solver::Contact] {
        for name in ["walls", "elastic", "gravity", "cradle"] {
            let scene =
                Scene::load(name).unwrap().with_size(DVec2::splat(300.0)).unwrap().with_solver(solver);
            let mut simulation = scene.build().unwrap();
            for _ in 0..60 {
                simulation.advance(1.0 / 60.0).unwrap();
                let (world, balls) = (simulation.world(), simulation.balls());
                assert!(max_wall_overlap(world, balls) < 1e-9, "{name}, {solver}");
                let overlap = max_overlap(&mut Grid::new(balls, world.size()), balls);
                assert!(name == "walls" || overlap < 0.01, "{name}, {solver}: {overlap}");
            }
        }
    }
}
