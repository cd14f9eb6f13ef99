//! However many threads share the work of `contact`, the result is the same to the bit.
#![cfg(feature = "parallel")]

use carom::{DVec2, Scene, Simulation};

const FRAME: f64 = 1.0 / 60.0;

/// Positions and velocities, and what happened, after so many frames of uneven length, the last of which ends within a
/// substep.
fn outcome(mut simulation: Simulation, frames: usize) -> Vec<[u64; 4]> {
    for frame in 0..frames {
        simulation.advance(FRAME * if frame % 3 == 0 { 0.7 } else { 1.1 }).unwrap();
    }
    simulation.advance(0.4 * FRAME).unwrap();
    let tally = simulation.tally();
    let bits = |a: DVec2, b: DVec2| [a.x, a.y, b.x, b.y].map(f64::to_bits);
    let mut outcome: Vec<_> =
        simulation.balls().iter().map(|ball| bits(ball.position(), ball.velocity())).collect();
    outcome.push(bits(tally.wall_impulse, DVec2::ZERO));
    outcome.push([tally.impacts, tally.wall_hits, 0, 0]);
    outcome.extend(simulation.touching().iter().map(|&touching| [u64::from(touching), 0, 0, 0]));
    outcome
}

/// Runs a scene with one thread and with more.
fn check(name: &str, text: &str, sleep: bool, frames: usize) {
    let scene = Scene::parse(name, text).unwrap();
    let run = |threads| {
        let mut simulation = scene.build().unwrap().with_sleep(sleep).with_threads(threads);
        if simulation.world().gravity().is_none() {
            // They take substeps only where they are asked for.
            simulation = simulation.with_substeps(240).unwrap();
        }
        outcome(simulation, frames)
    };
    let alone = run(1);
    assert!(alone.len() > 4000, "{name} is too small to be shared");
    for threads in [2, 3, 8] {
        // Not assert_eq!, which would print thousands of balls.
        assert!(
            run(threads) == alone,
            "{name}, sleep {sleep}: {threads} threads give another result than one"
        );
    }
}

const BALLS: &str = "
    solver = \"contact\"
    [walls]
    restitution = 0.7
    [pairs]
";

#[test]
fn a_pile_that_falls_and_settles_is_the_same_for_any_number_of_threads() {
    let fill = "[[fill]]\ncount = 3000\nradius = [3, 6]\nrestitution = 0.6\n";
    for (sleep, frames) in [(false, 45), (true, 150)] {
        let text = format!("size = [900, 500]\ngravity = [0, 980]\n{BALLS}{fill}");
        check("pile", &text, sleep, frames);
    }
    let text = format!("size = [500, 900]\ngravity = [-600, 100]\n{BALLS}{fill}");
    check("pile to the left", &text, false, 60);
}

#[test]
fn a_gas_is_the_same_for_any_number_of_threads() {
    let fill = "[[fill]]\ncount = 4000\nradius = 3\nspeed = 300\n";
    let text = format!("size = [900, 700]\nsolver = \"contact\"\n[walls]\n[pairs]\n{fill}");
    check("elastic gas", &text, true, 45);
    let granular = "[[fill]]\ncount = 4000\nradius = [1, 4]\nspeed = [100, 2000]\nrestitution = 0.8\n";
    check("granular gas", &format!("size = [700, 500]\n{BALLS}{granular}"), true, 45);
}

#[test]
fn giants_bullets_and_fixed_balls_among_thousands_are_the_same_for_any_number_of_threads() {
    let others = "
        [[ball]]
        position = [400, 380]
        radius = 120
        fixed = true
        [[ball]]
        position = [150, 200]
        radius = 100
        mass = 1e6
        [[ball]]
        position = [700, 60]
        radius = 5
        velocity = [-90000, 70000]
        mass = 50
        [[fill]]
        count = 3000
        radius = [2, 6]
        restitution = 0.7
        speed = 100
    ";
    for sleep in [false, true] {
        let text = format!("size = [1000, 560]\ngravity = [0, 980]\n{BALLS}{others}");
        check("giants", &text, sleep, 45);
    }
}

#[test]
fn balls_that_are_added_are_the_same_for_any_number_of_threads() {
    let text = format!(
        "size = [900, 500]\ngravity = [0, 980]\n{BALLS}[[fill]]\ncount = 2040\nradius = [3, 6]\nregion = [0, 200, 900, 500]\n"
    );
    let scene = Scene::parse("rain", &text).unwrap();
    let run = |threads| {
        let mut simulation = scene.build().unwrap().with_threads(threads);
        for drop in 0..30 {
            // From one stripe to some.
            let place = DVec2::new(20.0 + 28.0 * f64::from(drop), 50.0);
            simulation.add(&[carom::Ball::new(place, 5.0).unwrap()]).unwrap();
            for _ in 0..3 {
                simulation.advance(FRAME).unwrap();
            }
        }
        outcome(simulation, 30)
    };
    let alone = run(1);
    for threads in [2, 3, 8] {
        assert!(run(threads) == alone, "{threads} threads");
    }
}
