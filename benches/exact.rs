//! What the `exact` solver reaches: impacts per second, published figures that take too long for a test.
//!
//! `cargo bench --bench exact` runs all but the long ones; names choose: `speed`, `galperin`, `pressure`, `million`.

use std::f64::consts::PI;
use std::time::Instant;

use carom::{Ball, DVec2, Pairs, Scene, Simulation, Solver, World};

/// An elastic gas of equal balls of radius 3 in walls, at up to 200 px/s, that covers the part `eta` of the world.
fn gas(count: usize, eta: f64) -> Simulation {
    let side = (count as f64 * 9.0 * PI / eta).sqrt().ceil();
    if eta < 0.5 {
        let file = format!(
            "solver = \"exact\"\nsize = [{side}, {side}]\n[walls]\n[pairs]\n\
             [[fill]]\ncount = {count}\nradius = 3\nspeed = [0, 200]\n"
        );
        return Scene::parse("gas", &file).and_then(|scene| scene.build()).expect("a fifth of the area fits");
    }
    // Denser than random places allow: a hexagonal lattice, which melts.
    let pitch = (2.0 / 3_f64.sqrt() * side * side / count as f64).sqrt() * 0.998;
    let (columns, rise) = ((side / pitch) as usize, pitch * 3_f64.sqrt() / 2.0);
    let balls = (0..count).map(|index| {
        let (row, column) = (index / columns, index % columns);
        let place = DVec2::new((column as f64 + 0.5 * (row % 2) as f64) * pitch, row as f64 * rise) + 3.001;
        let angle = index as f64 * 2.399_963_229_728_653;
        let velocity = DVec2::from_angle(angle) * 200.0 * ((index * 7919 % 1000) as f64 / 1000.0).sqrt();
        Ball::new(place, 3.0).and_then(|ball| ball.with_velocity(velocity)).expect("a ball of the lattice")
    });
    let balls: Vec<Ball> = balls.collect();
    let extent = balls.iter().fold(DVec2::ZERO, |most, ball| most.max(ball.position())) + 3.001;
    let world = World::new(extent).and_then(|world| world.with_walls(1.0)).expect("a box around the lattice");
    Simulation::new(world.with_pairs(Pairs::Impulse), balls, Solver::Exact).expect("a lattice in its box")
}

/// Advances until there have been so many impacts more; impacts a second.
fn rate(simulation: &mut Simulation, impacts: u64) -> f64 {
    let (start, before) = (Instant::now(), simulation.tally().impacts);
    while simulation.tally().impacts - before < impacts {
        simulation.advance(1.0 / 60.0).expect("a frame's delta is in range");
    }
    (simulation.tally().impacts - before) as f64 / start.elapsed().as_secs_f64()
}

fn speed(counts: &[usize], eta: f64) {
    for &count in counts {
        let start = Instant::now();
        let mut simulation = gas(count, eta);
        let built = start.elapsed().as_secs_f64();
        simulation.advance(1e-9).expect("a delta in range");
        let begun = start.elapsed().as_secs_f64() - built;
        rate(&mut simulation, 2 * count as u64);
        let rates: Vec<String> = (0..3)
            .map(|_| {
                format!("{:.2}", rate(&mut simulation, (4 * count as u64).clamp(1_000_000, 4_000_000)) / 1e6)
            })
            .collect();
        println!(
            "η = {eta}, {count} balls: {} million impacts/s (built {built:.2} s, begun {begun:.2} s)",
            rates.join(", ")
        );
    }
}

fn galperin(n: i32) {
    let light = Ball::new(DVec2::new(300.0, 50.0), 10.0).expect("a ball");
    let heavy = Ball::new(DVec2::new(500.0, 50.0), 10.0)
        .and_then(|ball| ball.with_velocity(DVec2::new(-100.0, 0.0)))
        .and_then(|ball| ball.with_mass(100_f64.powi(n)))
        .expect("a ball");
    let world =
        World::new(DVec2::new(1e6, 100.0)).and_then(|world| world.with_walls(1.0)).expect("a long box");
    let mut simulation = Simulation::new(world.with_pairs(Pairs::Impulse), vec![light, heavy], Solver::Exact)
        .expect("two balls in a long box");
    let start = Instant::now();
    simulation.advance(200.0).expect("a delta in range");
    let count = simulation.tally().impacts + simulation.tally().wall_hits;
    println!(
        "Galperin (2003), n = {n}: {count} impacts, ⌊π·10ⁿ⌋ = {}; {:.2} s",
        (PI * 10_f64.powi(n)).floor(),
        start.elapsed().as_secs_f64()
    );
}

fn main() {
    let arguments: Vec<String> =
        std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let asked = |name: &str| arguments.iter().any(|argument| argument == name);
    let all = arguments.is_empty();
    if all || asked("speed") {
        speed(&[100, 1000, 10_000, 100_000], 0.2);
        speed(&[100, 1000, 10_000, 100_000], 0.7);
    }
    if all || asked("galperin") {
        galperin(7);
    }
    // One size alone: `-- N ETA`.
    if let [count, eta] = &arguments[..]
        && let (Ok(count), Ok(eta)) = (count.parse(), eta.parse())
    {
        speed(&[count], eta);
    }
    if asked("million") {
        speed(&[1_000_000], 0.2);
        speed(&[1_000_000], 0.7);
    }
}
