//! Laws that the `canvas` solver keeps, and the demo's own loop, written plainly, that it must equal.

use carom::simulation::invariants::{kinetic_energy, max_wall_overlap, momentum, non_finite};
use carom::{Ball, DVec2, Pairs, Simulation, Solver, World};
use proptest::prelude::*;

/// The demo's frame as it stands on its page: no grid, nothing left out, every pair in order.
fn demo_frame(world: &World, balls: &mut [Reference], seconds: f64) {
    for ball in &mut *balls {
        if let Some(gravity) = world.gravity() {
            ball.vx += gravity.x * seconds;
            ball.vy += gravity.y * seconds;
        }
        ball.x += ball.vx * seconds;
        ball.y += ball.vy * seconds;
    }
    if let Some(e) = world.walls() {
        let size = world.size();
        for ball in &mut *balls {
            if ball.x < ball.r {
                (ball.vx, ball.x) = (-ball.vx * e, ball.r);
            } else if ball.x > size.x - ball.r {
                (ball.vx, ball.x) = (-ball.vx * e, size.x - ball.r);
            }
            if ball.y < ball.r {
                (ball.vy, ball.y) = (-ball.vy * e, ball.r);
            } else if ball.y > size.y - ball.r {
                (ball.vy, ball.y) = (-ball.vy * e, size.y - ball.r);
            }
        }
    }
    let Some(pairs) = world.pairs() else { return };
    let elastic = balls.iter().all(|ball| ball.e == 1.0);
    for ball in &mut *balls {
        ball.colliding = false;
    }
    for i in 0..balls.len() {
        for j in i + 1..balls.len() {
            let (dx, dy) = (balls[i].x - balls[j].x, balls[i].y - balls[j].y);
            let reach = balls[i].r + balls[j].r;
            if dx * dx + dy * dy <= reach * reach {
                (balls[i].colliding, balls[j].colliding) = (true, true);
                if pairs == Pairs::Impulse {
                    demo_impact(elastic, balls, i, j);
                }
            }
        }
    }
}

fn demo_impact(elastic: bool, balls: &mut [Reference], i: usize, j: usize) {
    let (a, b) = (balls[i], balls[j]);
    let length = ((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y)).sqrt();
    let (nx, ny) = if length == 0.0 { (1.0, 0.0) } else { ((a.x - b.x) / length, (a.y - b.y) / length) };
    let (tx, ty) = (-ny, nx);
    let (v1n, v1t) = (a.vx * nx + a.vy * ny, a.vx * tx + a.vy * ty);
    let (v2n, v2t) = (b.vx * nx + b.vy * ny, b.vx * tx + b.vy * ty);
    let (m1, m2) = (a.m, b.m);
    let (after1, after2) = if elastic {
        ((v1n * (m1 - m2) + 2.0 * m2 * v2n) / (m1 + m2), (v2n * (m2 - m1) + 2.0 * m1 * v1n) / (m1 + m2))
    } else {
        let e = a.e.min(b.e);
        (
            (m1 * v1n + m2 * v2n + e * m2 * (v2n - v1n)) / (m1 + m2),
            (m1 * v1n + m2 * v2n + e * m1 * (v1n - v2n)) / (m1 + m2),
        )
    };
    if after1 < after2 {
        return;
    }
    (balls[i].vx, balls[i].vy) = (nx * after1 + tx * v1t, ny * after1 + ty * v1t);
    (balls[j].vx, balls[j].vy) = (nx * after2 + tx * v2t, ny * after2 + ty * v2t);
}

#[derive(Debug, Clone, Copy)]
struct Reference {
    x: f64,
    y: f64,
    vx: f64,
    vy: f64,
    r: f64,
    m: f64,
    e: f64,
    colliding: bool,
}

impl Reference {
    fn new(ball: &Ball) -> Self {
        let (p, v) = (ball.position(), ball.velocity());
        let (r, m, e) = (ball.radius(), ball.mass(), ball.restitution());
        Self { x: p.x, y: p.y, vx: v.x, vy: v.y, r, m, e, colliding: false }
    }
}

/// What a random scene may be: restitutions of walls and balls, gravity, masses.
#[derive(Debug, Clone)]
struct Setup {
    world: World,
    balls: Vec<Ball>,
    deltas: Vec<f64>,
}

fn balls(
    count: std::ops::Range<usize>,
    size: DVec2,
    restitution: impl Strategy<Value = f64>,
) -> impl Strategy<Value = Vec<Ball>> {
    let ball =
        (0.0..1.0_f64, 0.0..1.0_f64, 1.0..12.0_f64, -500.0..500.0_f64, -500.0..500.0_f64, -6.0..6.0_f64);
    (prop::collection::vec(ball, count), restitution).prop_map(move |(states, e)| {
        let ball = |&(x, y, r, vx, vy, mass): &(f64, f64, f64, f64, f64, f64)| {
            let room = size - 2.0 * r;
            Ball::new(DVec2::new(r + x * room.x, r + y * room.y), r)
                .and_then(|ball| ball.with_velocity(DVec2::new(vx, vy)))
                .and_then(|ball| ball.with_mass(10_f64.powf(mass)))
                .and_then(|ball| ball.with_restitution(e))
                .unwrap()
        };
        states.iter().map(ball).collect()
    })
}

fn deltas() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(prop_oneof![Just(0.0), Just(1.0 / 60.0), 0.0..0.05_f64, Just(3.0)], 1..40)
}

/// Restitutions of balls: often all 1, where the demo's `elastic` formula counts.
fn restitution() -> impl Strategy<Value = f64> {
    prop_oneof![Just(1.0), Just(0.0), 0.0..1.0_f64]
}

fn setups() -> impl Strategy<Value = Setup> {
    let gravity =
        prop_oneof![Just(DVec2::ZERO), Just(DVec2::new(0.0, 980.0)), Just(DVec2::new(-300.0, -50.0))];
    let pairs = prop_oneof![Just(None), Just(Some(Pairs::Detect)), Just(Some(Pairs::Impulse))];
    let worlds = (100.0..600.0_f64, 100.0..600.0_f64, gravity, prop::option::of(0.0..=1.0_f64), pairs);
    worlds.prop_flat_map(|(width, height, gravity, walls, pairs)| {
        let size = DVec2::new(width, height);
        let mut world = World::new(size).and_then(|world| world.with_gravity(gravity)).unwrap();
        if let Some(e) = walls {
            world = world.with_walls(e).unwrap();
        }
        if let Some(pairs) = pairs {
            world = world.with_pairs(pairs);
        }
        (balls(0..160, size, restitution()), deltas()).prop_map(move |(balls, deltas)| Setup {
            world,
            balls,
            deltas,
        })
    })
}

fn total(balls: &[Ball]) -> f64 {
    balls.iter().map(|ball| ball.mass() * ball.velocity().length()).sum()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(250) })]

    /// Few balls and many, with and without each part; with more than forty the solver's search is a grid.
    #[test]
    fn canvas_equals_the_plain_demo_loop_bit_for_bit(setup in setups()) {
        let Setup { world, balls, deltas } = setup;
        let mut reference: Vec<Reference> = balls.iter().map(Reference::new).collect();
        let mut simulation = Simulation::new(world, balls, Solver::Canvas).unwrap();
        for delta in deltas {
            demo_frame(&world, &mut reference, delta);
            simulation.advance(delta).unwrap();
            for ((ball, &touching), reference) in simulation.balls().iter().zip(simulation.touching()).zip(&reference) {
                let (p, v) = (ball.position(), ball.velocity());
                let bits = [p.x, p.y, v.x, v.y].map(f64::to_bits);
                let same = bits == [reference.x, reference.y, reference.vx, reference.vy].map(f64::to_bits);
                prop_assert!(same, "{ball:?} {reference:?}");
                prop_assert_eq!(touching, reference.colliding);
            }
        }
    }

    #[test]
    fn elastic_impacts_keep_momentum_and_kinetic_energy(
        balls in balls(2..120, DVec2::splat(300.0), Just(1.0)), deltas in deltas(),
    ) {
        let world = World::new(DVec2::splat(300.0)).unwrap().with_pairs(Pairs::Impulse);
        let (energy, before, scale) = (kinetic_energy(&balls), momentum(&balls), total(&balls));
        let mut simulation = Simulation::new(world, balls, Solver::Canvas).unwrap();
        for delta in deltas {
            simulation.advance(delta).unwrap();
            let (now, after) = (kinetic_energy(simulation.balls()), momentum(simulation.balls()));
            prop_assert!((now - energy).abs() <= 1e-11 * energy);
            prop_assert!((after - before).length() <= 1e-11 * scale);
        }
    }

    #[test]
    fn without_gravity_kinetic_energy_never_rises(
        balls in balls(1..120, DVec2::new(400.0, 200.0), restitution()), deltas in deltas(), walls in 0.0..=1.0_f64,
    ) {
        let world = World::new(DVec2::new(400.0, 200.0)).unwrap().with_walls(walls).unwrap();
        let mut energy = kinetic_energy(&balls);
        let mut simulation = Simulation::new(world.with_pairs(Pairs::Impulse), balls, Solver::Canvas).unwrap();
        for delta in deltas {
            simulation.advance(delta).unwrap();
            let now = kinetic_energy(simulation.balls());
            prop_assert!(now <= energy * (1.0 + 1e-12));
            energy = now;
        }
    }

    /// Masses over twelve decades, gravity, deltas up to 3 s, resizes between frames.
    #[test]
    fn whatever_happens_balls_stay_finite_and_inside_their_walls(
        setup in setups(), sizes in prop::collection::vec((0.0..700.0_f64, 0.0..700.0_f64), 1..40),
    ) {
        let walls = setup.world.walls().unwrap_or(0.5);
        let world = setup.world.with_walls(walls).unwrap();
        let mut simulation = Simulation::new(world, setup.balls, Solver::Canvas).unwrap();
        for (delta, (width, height)) in setup.deltas.into_iter().zip(sizes) {
            simulation.advance(delta).unwrap();
            simulation.resize(DVec2::new(width, height)).unwrap();
            simulation.advance(delta).unwrap();
            prop_assert_eq!(non_finite(simulation.balls()), 0);
            prop_assert!(max_wall_overlap(simulation.world(), simulation.balls()) < 1e-9);
        }
    }
}

#[test]
fn two_centres_in_one_place_part_and_stay_finite() {
    let world = World::new(DVec2::splat(100.0)).unwrap().with_pairs(Pairs::Impulse);
    let ball = Ball::new(DVec2::splat(50.0), 10.0).unwrap();
    let moving = ball.with_velocity(DVec2::new(-30.0, 4.0)).unwrap();
    let mut simulation = Simulation::new(world, vec![moving, ball], Solver::Canvas).unwrap();
    for _ in 0..60 {
        simulation.advance(1.0 / 60.0).unwrap();
    }
    assert_eq!(non_finite(simulation.balls()), 0);
    assert!(simulation.balls()[0].position().distance(simulation.balls()[1].position()) > 20.0);
}

#[test]
fn an_hour_of_the_demo_stays_finite_and_inside() {
    let mut simulation = carom::Scene::load("gravity").unwrap().with_solver(Solver::Canvas).build().unwrap();
    for _ in 0..60 * 3600 {
        simulation.advance(1.0 / 60.0).unwrap();
    }
    assert_eq!(non_finite(simulation.balls()), 0);
    assert_eq!(max_wall_overlap(simulation.world(), simulation.balls()), 0.0);
}
