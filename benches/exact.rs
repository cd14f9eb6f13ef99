//! What the `exact` solver reaches: impacts per second, published figures that take too long for a test.
//!
//! `cargo bench --bench exact` runs all but the long ones; names choose: `speed`, `galperin`, `pressure` (many minutes;
//! with densities, those alone: `pressure 0.2 0.5`), `million`.

use std::f64::consts::{PI, TAU};
use std::fs;
use std::time::Instant;

use carom::simulation::invariants::kinetic_energy;
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

/// What is advanced at once, s: so long that showing the balls, which is the frames' cost and not the impacts', hardly
/// counts.
const STEP: f64 = 0.05;

/// Advances until there have been so many impacts more; impacts a second.
fn rate(simulation: &mut Simulation, impacts: u64) -> f64 {
    let (start, before) = (Instant::now(), simulation.tally().impacts);
    while simulation.tally().impacts - before < impacts {
        simulation.advance(STEP).expect("a delta in range");
    }
    (simulation.tally().impacts - before) as f64 / start.elapsed().as_secs_f64()
}

/// A size in `/proc/self/status`, bytes; Linux alone has it.
fn memory(field: &str) -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let size = status.lines().find_map(|line| line.strip_prefix(field)?.strip_prefix(':'))?;
    size.split_whitespace().next()?.parse().ok().map(|kibibytes: f64| 1024.0 * kibibytes)
}

fn million(eta: f64) {
    let count = 1_000_000;
    let before = memory("VmRSS");
    let per_ball = |field: &str| {
        let bytes = memory(field).zip(before).map(|(now, before)| (now - before) / count as f64);
        bytes.map_or_else(|| "n/a".to_owned(), |bytes| format!("{bytes:.0}"))
    };
    let mut simulation = gas(count, eta);
    let built = per_ball("VmRSS");
    simulation.advance(1e-9).expect("a delta in range");
    let begun = per_ball("VmRSS");
    rate(&mut simulation, 2 * count as u64);
    let (running, most) = (per_ball("VmRSS"), per_ball("VmHWM"));
    println!(
        "η = {eta}, {count} balls: {built} bytes a ball when built, {begun} when begun, {running} after two million \
         impacts; {most} at most so far"
    );
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

/// `side`² discs of radius 1 that cover the part `eta` of a square box: a square lattice, which melts at once.
fn discs(side: usize, eta: f64) -> Simulation {
    let pitch = (PI / eta).sqrt();
    let disc = |index: usize| {
        let place = DVec2::new((index % side) as f64 + 0.5, (index / side) as f64 + 0.5) * pitch;
        let bits = ((index * index) as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let velocity = DVec2::from_angle(TAU * bits as f64 / u64::MAX as f64) * 1000.0;
        Ball::new(place, 1.0).and_then(|ball| ball.with_velocity(velocity)).expect("a disc of the lattice")
    };
    let world = World::new(DVec2::splat(side as f64 * pitch)).and_then(|world| world.with_walls(1.0));
    let world = world.expect("a box around the lattice").with_pairs(Pairs::Impulse);
    Simulation::new(world, (0..side * side).map(disc).collect(), Solver::Exact).expect("a lattice in its box")
}

/// Z = PA/NkT of hard discs by ten virial coefficients over powers of the second (Clisby & `McCoy` 2006), continued by the
/// Padé approximant [5/4] that has the same ten.
///
/// At η = 0.5 that is 4.10637; the approximants [4/5], [6/3] and [3/6] differ from it by at most 0.004 %. A geometric tail
/// after the tenth term comes to 4.10715, 0.02 % more: the ratio of the terms still falls.
fn virial_series(eta: f64) -> f64 {
    const COEFFICIENTS: [f64; 10] = [
        1.0,
        1.0,
        0.782_004,
        0.532_231_80,
        0.333_556_04,
        0.198_842_5,
        0.114_867_28,
        0.064_993_0,
        0.036_219_3,
        0.019_953_7,
    ];
    let mut sum = 0.0;
    let partial_sums = COEFFICIENTS.iter().zip(0..).map(|(coefficient, power)| {
        sum += coefficient * (2.0 * eta).powi(power);
        sum
    });
    pade(&partial_sums.skip(1).collect::<Vec<_>>())
}

/// The Padé approximant of a series by an odd number of its partial sums: the epsilon algorithm (Wynn 1956).
fn pade(partial_sums: &[f64]) -> f64 {
    let (mut before, mut column) = (vec![0.0; partial_sums.len() + 1], partial_sums.to_vec());
    while column.len() > 1 {
        if column.windows(2).any(|pair| pair[0] == pair[1]) {
            // At such a density it has converged already.
            return partial_sums[partial_sums.len() - 1];
        }
        let next =
            column.windows(2).zip(&before[1..]).map(|(pair, before)| before + 1.0 / (pair[1] - pair[0]));
        (before, column) = (column.clone(), next.collect());
    }
    column[0]
}

/// Z between walls by the rate of impacts (see `tests/exact_gas.rs`), with its standard error from the averages of
/// blocks.
fn pressure_between_walls(side: usize, eta: f64, impacts: u64) -> (f64, f64) {
    const BLOCKS: u32 = 40;
    let mut simulation = discs(side, eta);
    let count = (side * side) as f64;
    // A hundred impacts a disc.
    rate(&mut simulation, 50 * (side * side) as u64);
    let kt = kinetic_energy(simulation.balls()) / count;
    let blocks: Vec<f64> = (0..BLOCKS)
        .map(|_| {
            let (start, before) = (simulation.time(), simulation.tally().impacts);
            rate(&mut simulation, impacts / u64::from(BLOCKS));
            let hits = (simulation.tally().impacts - before) as f64;
            1.0 + PI.sqrt() * hits / (count * (simulation.time() - start) * kt.sqrt())
        })
        .collect();
    let mean = blocks.iter().sum::<f64>() / f64::from(BLOCKS);
    let squares = blocks.iter().map(|block| (block - mean).powi(2)).sum::<f64>();
    (mean, (squares / f64::from(BLOCKS * (BLOCKS - 1))).sqrt())
}

/// The pressure of hard discs, without what the walls add to it: that goes as 1/L, so it falls out of four times the Z of
/// 16N discs less the Z of N. The larger gas counts four times in the noise, and has four times the impacts.
fn pressure(eta: f64) {
    const IMPACTS: u64 = 40_000_000;
    let published = virial_series(eta);
    let show = |name: &str, (z, error): (f64, f64)| {
        let percent = 100.0 / published;
        println!(
            "  {name}: Z = {z:.5} ± {error:.5}, {:+.4} ± {:.4} % off the series",
            percent * (z - published),
            percent * error
        );
    };
    println!("η = {eta}: Z = {published:.5} by the virial series (Clisby & McCoy 2006)");
    let [small, large] = [(100, IMPACTS), (400, 4 * IMPACTS)].map(|(side, impacts)| {
        let measured = pressure_between_walls(side, eta, impacts);
        show(&format!("{} discs between walls", side * side), measured);
        measured
    });
    let extrapolated = ((4.0 * large.0 - small.0) / 3.0, (4.0 * large.1).hypot(small.1) / 3.0);
    show("extrapolated to no walls", extrapolated);
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
        // First, while nothing that was freed is still resident.
        million(0.2);
        million(0.7);
        speed(&[1_000_000], 0.2);
        speed(&[1_000_000], 0.7);
    }
    if asked("pressure") {
        let chosen: Vec<f64> = arguments.iter().filter_map(|argument| argument.parse().ok()).collect();
        let densities = if chosen.is_empty() { vec![0.1, 0.2, 0.3, 0.4, 0.5] } else { chosen };
        densities.into_iter().for_each(pressure);
    }
}
