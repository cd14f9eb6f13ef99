//! Rain falls the same whatever the frames, until the box is full.

use carom::simulation::invariants::max_wall_overlap;
use carom::{DVec2, Scene, Simulation};

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
