//! Scenes: the built-in ones are what the demo has, and run; files make the balls and the worlds that they say.

mod rain;
mod refused;

use carom::simulation::grid::Grid;
use carom::simulation::invariants::{max_overlap, max_wall_overlap, non_finite};
use carom::{Ball, DVec2, Part, Scene, Solver, scene};

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
        rain.advance(&mut simulation, 1.0).unwrap();
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

#[test]
fn the_readmes_scene_file_is_a_scene() {
    let readme = include_str!("../../README.md");
    let (_, file) = readme.split_once("```toml\n").unwrap();
    let (file, _) = file.split_once("```").unwrap();
    let simulation = Scene::parse("README", file).unwrap().build().unwrap();
    assert_eq!(simulation.balls().len(), 1001);
}

#[test]
fn a_scene_in_a_smaller_world_begins_between_its_walls_with_nothing_in_anything_else() {
    for solver in [Solver::Exact, Solver::Contact] {
        for name in ["walls", "elastic", "gravity", "cradle"] {
            let scene =
                Scene::load(name).unwrap().with_size(DVec2::splat(300.0)).unwrap().with_solver(solver);
            let full = Scene::load(name).unwrap().build().unwrap();
            let beyond = |ball: &Ball| (ball.position() + ball.radius()).max_element() > 300.0;
            assert!(full.balls().iter().any(beyond), "{name}");
            let mut simulation = scene.build().unwrap();
            for _ in 0..60 {
                let (world, balls) = (simulation.world(), simulation.balls());
                assert!(max_wall_overlap(world, balls) < 1e-9, "{name}, {solver}");
                let overlap = max_overlap(&mut Grid::new(balls, world.size()), balls);
                // Those of `walls` fly through each other.
                assert!(name == "walls" || overlap < 0.01, "{name}, {solver}: {overlap}");
                simulation.advance(1.0 / 60.0).unwrap();
            }
        }
    }
}
