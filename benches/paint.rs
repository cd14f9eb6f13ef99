//! What painting costs: a picture of 1280x720 px, by carom's painter and by tiny-skia's `fill_path`, a path a ball.
//!
//! - `paint`: random balls that may overlap, of these numbers and radii, everything painted anew in each frame; the painter
//!   goes through several scenes, since one whose balls stay where they are would find more in the caches than a film does.
//!   On as many cores as the painter likes; `taskset -c 0` before the command shows one core alone.
//! - `repaint`: as the window paints: fifteen balls of which all, or one, have moved by a pixel, and none.
//! - `clear`: the background alone.
//! - `animate`: a frame of a GIF, encoded and thrown away, in which all balls have moved: what a recording costs its thread;
//!   and `copy`, what it costs the window.

use std::time::Duration;

use carom::paint::{self, Animation, BACKGROUND, BALL, Painter, fill_disc};
use carom::{Ball, DVec2, Simulation, Solver, World};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use tiny_skia::Pixmap;

const SIZE: DVec2 = DVec2::new(1280.0, 720.0);
/// Numbers of balls and their radii, px.
const SCENES: [(u32, f64, f64); 9] = [
    (15, 30.0, 30.0),
    (15, 20.0, 120.0),
    (1000, 10.0, 10.0),
    (10_000, 3.0, 3.0),
    (10_000, 10.0, 10.0),
    (10_000, 10.0, 11.0),
    (50_000, 3.0, 6.0),
    (100_000, 3.0, 3.0),
    (100_000, 6.0, 6.0),
];
/// Scenes that the painter goes through.
const FRAMES: u64 = 4;

/// Balls in places that look random, moved by `moved` px.
fn balls(count: u32, radii: (f64, f64), seed: u64, moved: f64) -> Simulation {
    let mut state = (seed + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut ball = || {
        let radius = radii.0 + (radii.1 - radii.0) * random();
        let place = radius + (SIZE - 2.0 * radius) * DVec2::new(random(), random());
        Ball::new(place + moved, radius).expect("a ball in the picture is right")
    };
    let balls = (0..count).map(|_| ball()).collect();
    let world = World::new(SIZE).expect("the size is right");
    Simulation::new(world, balls, Solver::Canvas).expect("they are few enough")
}

fn blank() -> Pixmap {
    paint::blank(SIZE).expect("the size is right")
}

fn all(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("paint");
    for (count, low, high) in SCENES {
        let scenes: Vec<_> = (0..FRAMES).map(|seed| balls(count, (low, high), seed, 0.0)).collect();
        let radii = if low == high { low.to_string() } else { format!("{low}-{high}") };
        let id = |painter| BenchmarkId::new(painter, format!("{count} x r {radii}"));
        group.throughput(Throughput::Elements(count.into()));
        let (mut picture, mut painter, mut frames) = (blank(), Painter::default(), scenes.iter().cycle());
        group.bench_function(id("carom"), |bencher| {
            bencher.iter(|| {
                if let Some(scene) = frames.next() {
                    painter.paint(scene, 1.0, &mut picture.as_mut());
                }
            });
        });
        group.bench_function(id("fill_path"), |bencher| {
            bencher.iter(|| {
                picture.fill(BACKGROUND.into());
                for ball in scenes[0].balls() {
                    fill_disc(&mut picture.as_mut(), ball.position(), ball.radius(), BALL);
                }
            });
        });
    }
    group.finish();
    criterion.bench_function("clear", |bencher| {
        let mut picture = blank();
        bencher.iter(|| picture.fill(BACKGROUND.into()));
    });
}

fn changes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("repaint");
    let scenes = [0.0, 1.0].map(|moved| balls(15, (30.0, 30.0), 0, moved));
    let mut one = scenes[0].balls().to_vec();
    one[7] = scenes[1].balls()[7];
    let one = Simulation::new(*scenes[0].world(), one, Solver::Canvas).expect("they are few enough");
    for (name, frames) in [
        ("all moved", [&scenes[0], &scenes[1]]),
        ("one moved", [&scenes[0], &one]),
        ("none moved", [&one, &one]),
    ] {
        let (mut picture, mut painter) = (blank(), Painter::default());
        let mut frames = frames.into_iter().cycle();
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                frames.next().is_some_and(|scene| painter.repaint(scene, 1.0, &mut picture.as_mut()))
            });
        });
    }
}

fn animate(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("animate");
    for (count, radius) in [(15, 30.0), (1000, 10.0), (10_000, 3.0)] {
        let pictures = [0.0, 1.0].map(|moved| {
            paint::picture(&balls(count, (radius, radius), 0, moved)).expect("the size is right")
        });
        let (width, height) = (pictures[0].width(), pictures[0].height());
        let mut animation = Animation::new(std::io::sink(), width, height).expect("the size is right");
        let (mut frames, mut time) = (pictures.iter().cycle(), 0.0);
        group.bench_function(BenchmarkId::new("gif", format!("{count} x r {radius}")), |bencher| {
            bencher.iter(|| {
                time += 0.02;
                frames.next().map(|picture| animation.add(time, picture))
            });
        });
    }
    let (picture, mut copy) = (blank(), blank());
    group.bench_function("copy", |bencher| {
        bencher.iter(|| copy.data_mut().copy_from_slice(std::hint::black_box(picture.data())));
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    targets = all, changes, animate
}
criterion_main!(benches);
