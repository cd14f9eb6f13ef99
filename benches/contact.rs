//! What the contact solver costs, and what it keeps: `cargo bench --bench contact -- [gas|granular|pile|fall|rest|mixed|demo|heavy|column|threads] [N]`.
//! With `--features parallel` the last compares numbers of threads.

use std::time::Instant;

use carom::simulation::grid::Grid;
use carom::simulation::invariants::{kinetic_energy, max_overlap, potential_energy};
use carom::{Ball, DVec2, Scene, Simulation, Solver, World};

const FRAME: f64 = 1.0 / 60.0;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let counts: Vec<usize> = words.iter().filter_map(|word| word.parse().ok()).collect();
    let wanted = |name: &str| {
        words.iter().all(|word| word.parse::<usize>().is_ok()) || words.iter().any(|word| word == name)
    };
    let counts = |default: &[usize]| if counts.is_empty() { default.to_vec() } else { counts.clone() };
    if wanted("gas") {
        for count in counts(&[100, 1000, 10_000, 100_000]) {
            gas(count);
        }
    }
    if wanted("granular") {
        for count in counts(&[100, 1000, 10_000]) {
            for restitution in [0.5, 0.8, 0.95, 0.99] {
                granular(count, restitution);
            }
        }
    }
    if wanted("pile") {
        for count in counts(&[1000, 10_000, 50_000]) {
            pile(count, true);
            pile(count, false);
        }
    }
    if wanted("rest") {
        for count in counts(&[2000, 10_000]) {
            (1..=8).for_each(|seed| rest(count, seed));
        }
    }
    if wanted("mixed") {
        for count in counts(&[300]) {
            for ratio in [1e2, 1e3, 1e4, 1e6] {
                mixed(&format!("{ratio} : 1"), 8, |seed| mixed_scene(count, &[1.0, ratio], "5", seed));
            }
            let decades: Vec<f64> = (-4..=4).map(|decade| 10_f64.powi(decade)).collect();
            mixed("eight powers of ten", 120, |seed| mixed_scene(count, &decades, "[3, 12]", seed));
        }
    }
    if wanted("threads") {
        for count in counts(&[10_000, 100_000]) {
            threads(count);
        }
    }
    if wanted("fall") {
        for count in counts(&[10_000]) {
            fall(count);
        }
    }
    if wanted("demo") {
        demo();
    }
    if wanted("heavy") {
        for mass in [1e2, 1e4, 1e6, 1e12] {
            heavy(mass);
        }
    }
    if wanted("column") {
        for (count, top) in [(20, 1.0), (20, 1000.0), (100, 1.0), (1000, 1.0)] {
            column(count, top);
        }
    }
}

fn seconds(simulation: &mut Simulation, seconds: f64) -> f64 {
    let frames = (seconds / FRAME).round() as usize;
    let start = Instant::now();
    for _ in 0..frames {
        simulation.advance(FRAME).unwrap();
    }
    start.elapsed().as_secs_f64() * 1e9 / frames as f64 / simulation.balls().len() as f64
}

fn energy(simulation: &Simulation) -> f64 {
    kinetic_energy(simulation.balls()) + potential_energy(simulation.world(), simulation.balls())
}

fn fastest(simulation: &Simulation) -> f64 {
    simulation.balls().iter().map(|ball| ball.velocity().length()).fold(0.0, f64::max)
}

/// By how much touching pairs overlap, as parts of the smaller radius.
fn overlaps(simulation: &Simulation) -> Vec<f64> {
    let (balls, mut overlaps) = (simulation.balls(), Vec::new());
    Grid::new(balls, simulation.world().size()).for_each(balls, |i, j| {
        let (a, b) = (&balls[i as usize], &balls[j as usize]);
        let overlap = a.radius() + b.radius() - a.position().distance(b.position());
        overlaps.push(overlap / a.radius().min(b.radius()));
    });
    overlaps
}

/// Mean overlap of touching pairs, the largest, the largest speed.
fn quality(simulation: &Simulation) -> (f64, f64, f64) {
    let overlaps = overlaps(simulation);
    let (balls, size) = (simulation.balls(), simulation.world().size());
    let most = max_overlap(&mut Grid::new(balls, size), balls);
    (overlaps.iter().sum::<f64>() / overlaps.len().max(1) as f64, most, fastest(simulation))
}

/// A gas, elastic or not.
fn gas_scene(count: usize, restitution: f64) -> Scene {
    let side = (count as f64 * std::f64::consts::PI * 9.0 / 0.2).sqrt().round();
    let text = format!(
        "solver = \"contact\"\nsize = [{side}, {side}]\n[walls]\n[pairs]\n[[fill]]\ncount = {count}\nradius = 3\nspeed = 200\nmass = 1\nrestitution = {restitution}\n"
    );
    Scene::parse("gas", &text).unwrap()
}

fn pile_scene(count: usize, seed: u64) -> Scene {
    // Half of the box is the area of balls of radius 3 to 6: a mean square of 21.
    let area = count as f64 * std::f64::consts::PI * 21.0 * 2.0;
    let (width, height) = ((area * 16.0 / 9.0).sqrt().round(), (area * 9.0 / 16.0).sqrt().round());
    let text = format!(
        "solver = \"contact\"\nsize = [{width}, {height}]\ngravity = [0, 980]\n[walls]\nrestitution = 0.7\n[pairs]\n[[fill]]\ncount = {count}\nradius = [3, 6]\nrestitution = 0.7\nseed = {seed}\n"
    );
    Scene::parse("pile", &text).unwrap()
}

/// One thread and all that there are, in turns, on the same frames, each of which follows the one before at once; of each
/// frame the best of some runs counts.
fn threads(count: usize) {
    let most = std::thread::available_parallelism().map_or(1, |most| most.get() as u32);
    let teams: Vec<u32> =
        std::iter::successors(Some(1), |team| Some(2 * team)).take_while(|&team| team <= most).collect();
    let settling = if count > 50_000 { 15.0 } else { 8.0 };
    for (name, scene, skipped, measured) in [
        // A gas is moved from impact to impact, by one thread.
        ("falling", pile_scene(count, 1), 0.0, 2.0),
        ("settled", pile_scene(count, 1), settling, 0.5),
    ] {
        let frames = (measured / FRAME).round() as usize;
        let mut best = vec![vec![f64::INFINITY; frames]; teams.len()];
        let begin = |&team: &u32| {
            let mut simulation = scene.build().unwrap().with_sleep(false).with_threads(team);
            seconds(&mut simulation, skipped);
            simulation
        };
        let begun: Vec<_> = teams.iter().map(begin).collect();
        for _ in 0..5 {
            for (begun, best) in begun.iter().zip(&mut best) {
                let mut run = begun.clone();
                for best in best {
                    *best = best.min(seconds(&mut run, FRAME));
                }
            }
        }
        let means: Vec<f64> = best.iter().map(|best| best.iter().sum::<f64>() / frames as f64).collect();
        for (team, mean) in teams.iter().zip(&means) {
            println!("{name} {count}, {team} threads: {mean:.1} ns, {:.2} times as fast", means[0] / mean);
        }
    }
}

fn gas(count: usize) {
    let mut simulation = gas_scene(count, 1.0).build().unwrap();
    let start = energy(&simulation);
    let warm = seconds(&mut simulation, 0.5);
    let ns = seconds(&mut simulation, 2.0);
    let long = if count <= 1000 { 60.0 } else { 2.0 };
    seconds(&mut simulation, long);
    let (mean, most, _) = quality(&simulation);
    println!(
        "gas {count}: {warm:.0} {ns:.1} ns a ball and frame; energy {:+.4} % after {long} s; overlap {mean:.4} {most:.3}; {:?}",
        (energy(&simulation) / start - 1.0) * 100.0,
        simulation.tally()
    );
}

/// A gas that loses energy, from impact to impact and in substeps.
fn granular(count: usize, restitution: f64) {
    const SECONDS: f64 = 10.0;
    let simulation = gas_scene(count, restitution).build().unwrap();
    let in_substeps = simulation.clone().with_substeps(240).unwrap();
    let start = energy(&simulation);
    let [(one, left, deepest), (other, left_in_substeps, deepest_in_substeps)] = [simulation, in_substeps]
        .map(|mut simulation| {
            let ns = seconds(&mut simulation, SECONDS);
            (ns, energy(&simulation) / start, quality(&simulation).1)
        });
    println!(
        "gas {count}, restitution {restitution}: {one:.1} ns a ball and frame, in substeps {other:.1} ({:.2}); energy left \
         after {SECONDS} s {left:.4}, {left_in_substeps:.4}; overlap {deepest:.4}, {deepest_in_substeps:.4}",
        one / other
    );
}

/// How soon a pile of these balls stands still, and how it lies then.
fn rest(count: usize, seed: u64) {
    const MOST: u32 = 3600;
    let mut simulation = pile_scene(count, seed).build().unwrap();
    let (mut ns, mut frames) = (0.0, 0);
    while frames == 0 || (frames < MOST && fastest(&simulation) > 0.0) {
        ns += seconds(&mut simulation, FRAME);
        frames += 1;
    }
    let (mean, most, fastest) = quality(&simulation);
    println!(
        "rest {count}, seed {seed}: {fastest:.3} px/s after {:.1} s, {:.0} ns a ball and frame; overlap {mean:.4} {most:.4}",
        simulation.time(),
        ns / f64::from(frames)
    );
}

/// As many balls of each of these masses, whatever their sizes.
fn mixed_scene(count: usize, masses: &[f64], radius: &str, seed: usize) -> Scene {
    let (width, height) = if masses.len() > 2 { (640, 480) } else { (324, 182) };
    let mut text = format!(
        "solver = \"contact\"\nsize = [{width}, {height}]\ngravity = [0, 980]\n[walls]\nrestitution = 0.7\n[pairs]\n"
    );
    for (place, mass) in masses.iter().enumerate() {
        let (count, seed) = (count / masses.len(), seed + 1000 * place);
        text += &format!(
            "[[fill]]\ncount = {count}\nradius = {radius}\nmass = {mass}\nrestitution = 0.7\nseed = {seed}\n"
        );
    }
    Scene::parse("mixed", &text).unwrap()
}

/// How many of some piles come to rest within 20 s, how deep balls lie in each other at most at the end, at rest or not, and
/// how much energy comes back at most, as a part of that at the start.
fn mixed(name: &str, seeds: usize, scene: impl Fn(usize) -> Scene) {
    let (mut rested, mut deepest, mut back) = (0, 0.0_f64, Vec::new());
    for seed in 1..=seeds {
        let mut simulation = scene(seed).build().unwrap();
        let start = energy(&simulation);
        let (mut least, mut most) = (start, 0.0_f64);
        for _ in 0..1200 {
            simulation.advance(FRAME).unwrap();
            let now = energy(&simulation);
            most = most.max((now - least) / start);
            least = least.min(now);
            if fastest(&simulation) == 0.0 {
                rested += 1;
                break;
            }
        }
        deepest = deepest.max(quality(&simulation).1);
        back.push(most);
    }
    back.sort_by(f64::total_cmp);
    println!(
        "masses {name}: {rested} of {seeds} at rest within 20 s, overlap up to {deepest:.3} of a radius, energy that came back: \
         {:.1e} in the middle, {:.1e} at most",
        back[seeds / 2],
        back[seeds - 1]
    );
}

fn pile(count: usize, sleep: bool) {
    let mut simulation = pile_scene(count, 1).build().unwrap().with_sleep(sleep);
    let mut energies = vec![energy(&simulation)];
    let mut rise = 0.0_f64;
    for second in 1..=10 {
        let ns = seconds(&mut simulation, 1.0);
        let now = energy(&simulation);
        rise = rise.max(now - energies.iter().copied().fold(f64::INFINITY, f64::min));
        energies.push(now);
        let (mean, most, fastest) = quality(&simulation);
        println!(
            "pile {count} {} {second} s: {ns:.0} ns; overlap mean {mean:.5}, most {most:.4}; fastest {fastest:.4} px/s; \
             energy {:.6} of that at the start; risen by {:.2e} of it at most",
            if sleep { "may sleep," } else { "awake," },
            now / energies[0],
            rise / energies[0]
        );
    }
}

fn demo() {
    let scene = Scene::load("gravity").unwrap().with_solver(Solver::Contact);
    let mut best = [f64::INFINITY; 5];
    for _ in 0..50 {
        let mut simulation = scene.build().unwrap();
        for best in &mut best {
            *best = best.min(seconds(&mut simulation, 2.0));
        }
    }
    println!("demo, two seconds each, the best of 50 runs: {best:.1?} ns");
}

fn stand(name: &str, balls: Vec<Ball>) {
    let height = balls.iter().map(|ball| 2.0 * ball.radius()).sum::<f64>();
    let world = World::new(DVec2::new(400.0, height + 100.0)).unwrap().with_walls(0.5).unwrap();
    let world = world.with_gravity(DVec2::new(0.0, 980.0)).unwrap().with_pairs(carom::Pairs::Impulse);
    let mut simulation = Simulation::new(world, balls, Solver::Contact).unwrap();
    let mut sunk = 0.0_f64;
    let from = simulation.balls().last().unwrap().position();
    let mut ns = 0.0;
    for _ in 0..10 {
        ns = seconds(&mut simulation, 1.0);
        sunk = sunk.max(simulation.balls().last().unwrap().position().y - from.y);
    }
    let (mean, most, fastest) = quality(&simulation);
    println!(
        "{name}: the top sank by {sunk:.2e} px; overlap {mean:.2e} {most:.2e}; fastest {fastest:.2e}; {ns:.0} ns"
    );
}

fn tower(count: usize, top: f64) -> Vec<Ball> {
    let floor = count as f64 * 20.0 + 100.0;
    let at = |k: usize| DVec2::new(200.0, floor - 10.0 - 20.0 * k as f64);
    let mass = |k: usize| if k + 1 == count { top } else { 1.0 };
    let ball = |k| Ball::new(at(k), 10.0).unwrap().with_mass(mass(k)).unwrap().with_restitution(0.5).unwrap();
    (0..count).map(ball).collect()
}

fn heavy(mass: f64) {
    stand(&format!("heavy {mass:e}"), tower(2, mass));
}

fn column(count: usize, top: f64) {
    stand(&format!("column {count}, top {top}"), tower(count, top));
}

/// What a pile costs while it falls, in each half of a second the best of some runs, and how many pairs lie in each other
/// by more than these parts of a radius meanwhile, in all frames.
fn fall(count: usize) {
    const HALVES: usize = 4;
    const DEEP: [f64; 3] = [0.2, 0.5, 1.0];
    let mut best = [f64::INFINITY; HALVES];
    let mut deep = [0; DEEP.len()];
    for run in 0..3 {
        let mut simulation = pile_scene(count, 1).build().unwrap().with_sleep(false);
        for best in &mut best {
            let mut ns = 0.0;
            for _ in 0..30 {
                ns += seconds(&mut simulation, FRAME) / 30.0;
                if run == 0 {
                    for (deep, least) in deep.iter_mut().zip(DEEP) {
                        *deep += overlaps(&simulation).iter().filter(|&&overlap| overlap > least).count();
                    }
                }
            }
            *best = best.min(ns);
        }
    }
    let mean = best.iter().sum::<f64>() / HALVES as f64;
    println!("fall {count}: {best:.0?} ns, {mean:.0} in the mean; deeper than {DEEP:?}: {deep:?} pairs");
}
