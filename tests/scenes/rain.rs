//! Rain falls the same whatever the frames, until the box is full.

use carom::simulation::invariants::max_wall_overlap;
use carom::{DVec2, Scene, Simulation, Solver};

/// Rain into a small box.
const RAIN: &str = "solver = \"contact\"\nsize = [200, 200]\ngravity = [0, 980]\n[walls]\nrestitution = 0.3\n[pairs]\n\
                    [rain]\nrate = 60\nradius = [5, 8]\nrestitution = 0.3\n";

fn rained(solver: Solver, seconds: f64, frame: f64) -> Simulation {
    let scene = Scene::parse("rain", RAIN).unwrap().with_solver(solver);
    let (mut simulation, mut rain) = (scene.build().unwrap(), scene.rain().unwrap());
    while simulation.time() < seconds - 1e-9 {
        let delta = frame.min(seconds - simulation.time());
        rain.advance(&mut simulation, delta).unwrap();
    }
    simulation
}

#[test]
fn rain_is_the_same_whatever_the_frames() {
    for (solver, seconds) in [(Solver::Contact, 2.0), (Solver::Exact, 1.5), (Solver::Exact, 2.0)] {
        let once = rained(solver, seconds, seconds);
        assert!(once.balls().len() > 60);
        // Which of these sums round to where the last spell is, and which to a moment after it, is chance.
        for frame in [1.0 / 24.0, 1.0 / 50.0, 1.0 / 60.0, 1.0 / 100.0, 1.0 / 144.0] {
            let frames = rained(solver, seconds, frame);
            assert!(frames.balls() == once.balls(), "{solver}, frames of {frame} s");
        }
    }
}

#[test]
fn balls_that_met_before_the_last_spell_of_a_frame_count_as_touching_in_it() {
    let text = "size = [400, 400]\n[pairs]\n[[ball]]\nposition = [100, 300]\nradius = 10\nvelocity = [100, 0]\n\
                [[ball]]\nposition = [200, 300]\nradius = 10\nvelocity = [-100, 0]\n[rain]\nrate = 1\nradius = 2\n";
    for solver in [Solver::Exact, Solver::Contact] {
        let scene = Scene::parse("two", text).unwrap().with_solver(solver);
        let (mut simulation, mut rain) = (scene.build().unwrap(), scene.rain().unwrap());
        // They meet after 0.4 s.
        rain.advance(&mut simulation, 1.0).unwrap();
        assert_eq!((simulation.tally().impacts, simulation.balls().len()), (1, 3));
        assert_eq!(simulation.touching(), [true, true, false], "{solver}");
        rain.advance(&mut simulation, 1.0).unwrap();
        assert_eq!(simulation.touching(), [false; 4], "{solver}");
    }
}

#[test]
fn rain_ends_where_the_box_is_full_and_leaves_a_pile_at_rest() {
    let full = rained(Solver::Contact, 30.0, 1.0 / 60.0);
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
        assert!(rain.advance(&mut simulation, delta).is_err());
    }
    assert_eq!((simulation.time(), simulation.balls().len()), (0.0, 0));
}

#[test]
fn a_frame_that_ends_just_before_balls_come_and_one_of_next_to_no_time_take_place() {
    for short in [5e-13, 1e-13, 9e-13] {
        let scene = Scene::load("rain").unwrap();
        let (mut simulation, mut rain) = (scene.build().unwrap(), scene.rain().unwrap());
        for delta in [0.124_999_999_998_6, short, short, 0.01] {
            rain.advance(&mut simulation, delta).unwrap();
        }
        assert!(!simulation.balls().is_empty());
        assert!((simulation.time() - 0.135).abs() < 1e-9);
    }
}
