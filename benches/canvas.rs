//! What the `canvas` solver costs: nanoseconds per ball and frame are the inverse of the throughput that criterion shows.
//!
//! - `stages`: ten seconds of each of the demo's stages at 60 Hz, with its own balls, so that what a stage adds to the
//!   one before can be seen.
//! - `gas`: balls of radius 3 at up to 200 px/s that cover a fifth of the world, elastic, without gravity.
//! - `search`: the same gas's search for touching pairs alone, and with the pairs put into the demo's order: what
//!   keeping the order costs.

use std::time::Duration;

use carom::simulation::grid::Grid;
use carom::{Scene, Simulation, Solver, scene};
use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

const FRAME: f64 = 1.0 / 60.0;
/// Frames of a stage: ten seconds.
const STAGE_FRAMES: u32 = 600;
const GAS: [u32; 4] = [100, 1000, 10_000, 100_000];

fn advance(simulation: &mut Simulation) {
    simulation.advance(FRAME).expect("a frame's delta is in range");
}

/// A gas of `count` balls that has run for a second.
fn gas(count: u32) -> Simulation {
    let area = f64::from(count) * 9.0 * std::f64::consts::PI / 0.2;
    let (width, height) = ((area * 16.0 / 9.0).sqrt().ceil(), (area * 9.0 / 16.0).sqrt().ceil());
    let file = format!(
        "solver = \"canvas\"\nsize = [{width}, {height}]\n[walls]\n[pairs]\n[[fill]]\ncount = {count}\nradius = 3\nspeed = [0, 200]\n"
    );
    let mut simulation =
        Scene::parse("gas", &file).and_then(|scene| scene.build()).expect("a fifth of the area fits");
    (0..60).for_each(|_| advance(&mut simulation));
    simulation
}

fn stages(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("stages");
    for name in &scene::names()[..scene::STAGES] {
        let scene = Scene::load(name).expect("a built-in scene is right").with_solver(Solver::Canvas);
        let build = || scene.build().expect("a built-in scene fits");
        group.throughput(Throughput::Elements(u64::from(STAGE_FRAMES) * build().balls().len() as u64));
        group.bench_function(*name, |bencher| {
            let run = |mut simulation: Simulation| {
                (0..STAGE_FRAMES).for_each(|_| advance(&mut simulation));
                simulation
            };
            bencher.iter_batched(build, run, BatchSize::SmallInput);
        });
    }
}

fn gases(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("gas");
    for count in GAS {
        let mut simulation = gas(count);
        group.throughput(Throughput::Elements(count.into()));
        group.bench_function(BenchmarkId::from_parameter(count), |bencher| {
            bencher.iter(|| advance(&mut simulation));
        });
    }
}

fn search(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("search");
    for count in GAS {
        let simulation = gas(count);
        let mut grid = Grid::new(simulation.balls(), simulation.world().size());
        group.throughput(Throughput::Elements(count.into()));
        group.bench_function(BenchmarkId::new("any order", count), |bencher| {
            bencher.iter(|| grid.find(simulation.balls()));
        });
        group.bench_function(BenchmarkId::new("the demo's order", count), |bencher| {
            bencher.iter(|| {
                grid.find(simulation.balls());
                grid.sort();
            });
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2));
    targets = stages, gases, search
}
criterion_main!(benches);
