//! Balls that meet at one time: `exact` and `contact` take such impacts as one, whatever the order of the balls.

use carom::simulation::invariants::{kinetic_energy, momentum};
use carom::{Ball, DVec2, Pairs, Simulation, Solver, World};
use proptest::prelude::*;

fn ball(position: DVec2, velocity: DVec2) -> Ball {
    Ball::new(position, 10.0).unwrap().with_velocity(velocity).unwrap()
}

/// The solvers that take them so.
const SOLVERS: [Solver; 2] = [Solver::Exact, Solver::Contact];

fn open(balls: Vec<Ball>, solver: Solver) -> Simulation {
    let world = World::new(DVec2::new(1000.0, 600.0)).unwrap().with_pairs(Pairs::Impulse);
    let simulation = Simulation::new(world, balls, solver).unwrap();
    // Elastic balls without gravity take substeps only where they are asked for.
    if solver == Solver::Contact { simulation.with_substeps(240).unwrap() } else { simulation }
}

/// A ball that flies at 300 px/s into the gap between two that touch each other.
fn three(masses: [f64; 3]) -> Vec<Ball> {
    let places = [DVec2::new(100.0, 300.0), DVec2::new(200.0, 290.0), DVec2::new(200.0, 310.0)];
    let speeds = [300.0, 0.0, 0.0];
    let of = |k: usize| ball(places[k], DVec2::new(speeds[k], 0.0)).with_mass(masses[k]).unwrap();
    (0..3).map(of).collect()
}

#[test]
fn a_ball_that_hits_two_equal_ones_at_once_comes_back_with_a_fifth_of_its_speed() {
    for solver in SOLVERS {
        // Both normals are 30° off the line of flight: energy and momentum with equal impulses leave one answer.
        for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            let balls = three([1.0; 3]);
            let mut simulation = open(order.map(|k| balls[k]).to_vec(), solver);
            simulation.advance(1.0).unwrap();
            let velocity =
                |k: usize| simulation.balls()[order.iter().position(|&at| at == k).unwrap()].velocity();
            let along = 300.0 * 2.0 * 3_f64.sqrt() / 5.0;
            assert!(velocity(0).distance(DVec2::new(-60.0, 0.0)) < 1e-11, "{}", velocity(0));
            for (k, sign) in [(1, -1.0), (2, 1.0)] {
                let expected = along * DVec2::new(0.75_f64.sqrt(), 0.5 * sign);
                assert!(velocity(k).distance(expected) < 1e-11, "{} is not {expected}", velocity(k));
            }
            assert_eq!(simulation.tally().impacts, 2);
        }
    }
}

#[test]
fn what_two_balls_get_at_once_is_its_own_mirror_image_whatever_the_masses() {
    for solver in SOLVERS {
        for mass in [1e-6, 1e-3, 0.1, 10.0, 1e3, 1e6] {
            let mut simulation = open(three([mass, 1.0, 1.0]), solver);
            let before = kinetic_energy(simulation.balls());
            simulation.advance(0.4).unwrap();
            let v: Vec<DVec2> = simulation.balls().iter().map(Ball::velocity).collect();
            assert!(v[0].y.abs() < 1e-11 && (v[1].y + v[2].y).abs() < 1e-11, "{mass}: {v:?}");
            assert!((kinetic_energy(simulation.balls()) / before - 1.0).abs() < 1e-13, "{mass}");
        }
    }
}

#[test]
fn a_rack_that_is_hit_head_on_breaks_into_its_own_mirror_image() {
    // Rows as far apart as numbers say, and, for `contact`, as somebody would write it: each in the next by 7e-6 px, which
    // `exact` takes for an overlap that is to go.
    let written = 17.3205;
    let cases =
        [(Solver::Exact, 300_f64.sqrt()), (Solver::Contact, 300_f64.sqrt()), (Solver::Contact, written)];
    for (solver, step) in cases {
        let mut balls = vec![ball(DVec2::new(100.0, 300.0), DVec2::new(500.0, 0.0))];
        for row in 0..4 {
            for place in 0..=row {
                let (x, y) = (f64::from(row) * step, 20.0 * f64::from(place) - 10.0 * f64::from(row));
                balls.push(ball(DVec2::new(400.0 + x, 300.0 + y), DVec2::ZERO));
            }
        }
        let mut simulation = open(balls, solver);
        let (energy, given) = (kinetic_energy(simulation.balls()), momentum(simulation.balls()));
        simulation.advance(0.6).unwrap();
        let broken = simulation.balls();
        for one in broken {
            let image = DVec2::new(one.position().x, 600.0 - one.position().y);
            let nearest =
                broken.iter().map(|other| other.position().distance(image)).fold(f64::MAX, f64::min);
            assert!(
                nearest < 1e-8,
                "{solver:?}, {step}: nothing at the image of {}: {nearest:e}",
                one.position()
            );
        }
        assert!(broken.iter().skip(1).filter(|ball| ball.velocity() != DVec2::ZERO).count() >= 8);
        assert!((kinetic_energy(broken) / energy - 1.0).abs() < 1e-13);
        assert!(momentum(broken).distance(given) < 1e-13 * given.length());
    }
}

#[test]
fn a_ball_that_falls_between_two_pegs_jumps_straight_up() {
    for solver in SOLVERS {
        let earth = DVec2::new(0.0, 980.0);
        let world = World::new(DVec2::new(400.0, 400.0)).unwrap().with_pairs(Pairs::Impulse);
        let peg = |x: f64| ball(DVec2::new(x, 300.0), DVec2::ZERO).fixed();
        for restitution in [1.0, 0.5] {
            let falls = ball(DVec2::new(200.0, 100.0), DVec2::ZERO).with_restitution(restitution).unwrap();
            let balls = vec![falls, peg(188.0), peg(212.0)];
            let mut simulation = Simulation::new(world.with_gravity(earth).unwrap(), balls, solver).unwrap();
            // It touches both where its centre is 16 px above theirs.
            let fallen = 184_f64;
            let speed = (2.0 * 980.0 * fallen).sqrt();
            simulation.advance(speed / 980.0 + 0.1).unwrap();
            let velocity = simulation.balls()[0].velocity();
            let up = DVec2::new(0.0, -restitution * speed + 98.0);
            // Within a substep `contact` follows the chord of the parabola.
            let near = if solver == Solver::Exact { 1e-9 } else { 1e-2 };
            assert!(velocity.x.abs() < 1e-9 && velocity.distance(up) < near, "{velocity} is not {up}");
            assert_eq!(simulation.tally().impacts, 2);
        }
    }
}

#[test]
fn impacts_at_one_time_that_share_no_ball_stay_two() {
    for solver in SOLVERS {
        let mut balls = three([1.0; 3]);
        let apart = DVec2::new(500.0, 0.0);
        balls.extend(three([1.0; 3]).iter().map(|one| ball(one.position() + apart, one.velocity())));
        let mut simulation = open(balls, solver);
        simulation.advance(1.0).unwrap();
        for (one, other) in simulation.balls().iter().zip(&simulation.balls()[3..]) {
            assert!(one.velocity().distance(other.velocity()) < 1e-10);
        }
        assert_eq!(simulation.tally().impacts, 4);
    }
}

#[test]
fn an_impact_stands_where_rounding_hides_it_among_others_at_the_same_time() {
    // A ball of a hundredth of a pixel flies into the midst of three, where 1e-13 px are the last digit: whether it has
    // come to touch one of them when its time is there depends on the rounding of their places.
    let radius = 0.01;
    let tiny = |position: DVec2, velocity: DVec2, mass: f64| {
        let ball = Ball::new(position, radius).and_then(|ball| ball.with_velocity(velocity));
        ball.and_then(|ball| ball.with_mass(mass)).unwrap()
    };
    for trial in 0..1000 {
        let any = |step: f64| (step * f64::from(trial)).fract();
        let touching = DVec2::new(900.0 + 50.0 * any(0.618), 500.0 + 50.0 * any(0.755));
        let along = DVec2::from_angle(std::f64::consts::TAU * any(0.57));
        let mut balls = vec![tiny(touching - 0.25 * along, along, 1.0)];
        balls.extend([(80_f64, 1.0), (0.0, 3.0), (-70.0, 3.0)].map(|(degrees, mass)| {
            let direction = along.rotate(DVec2::from_angle(degrees.to_radians()));
            tiny(touching + 2.0 * radius * direction, DVec2::ZERO, mass)
        }));
        let before: Vec<DVec2> = balls.iter().map(Ball::velocity).collect();
        let mut simulation = open(balls, Solver::Exact);
        simulation.advance(0.25 + 1e-6).unwrap();
        for (index, ball) in simulation.balls().iter().enumerate() {
            let hit = simulation.touching()[index];
            assert_eq!(hit, ball.velocity() != before[index], "ball {index} of trial {trial}");
        }
    }
}

/// When they do, s: within a substep of `contact`. On the edge of two, rounding says in which of them a pair meets.
const MEET: f64 = 0.251;

/// Balls that come from all sides and touch the one in the middle at one time: their directions, speeds and masses.
fn star() -> impl Strategy<Value = Vec<(DVec2, f64, f64)>> {
    let arm = (0.0..0.15_f64, 50.0..500.0_f64, -1.0..1.0_f64);
    (prop::collection::vec(arm, 2..6), 0.0..1.0_f64).prop_map(|(arms, turn)| {
        let count = arms.len() as f64;
        let of = |(k, (beside, speed, mass)): (usize, (f64, f64, f64))| {
            let part = (k as f64 + beside) / count.max(5.0) + turn;
            (DVec2::from_angle(std::f64::consts::TAU * part), speed, 10_f64.powf(mass))
        };
        arms.into_iter().enumerate().map(of).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(1000) })]

    #[test]
    fn the_order_of_the_balls_does_not_matter_where_all_meet_at_once(arms in star(), e in 0.0..=1.0_f64, first in 0..6_usize, solver in prop::sample::select(&SOLVERS[..])) {
        let middle = DVec2::new(500.0, 300.0);
        let mut balls = vec![ball(middle, DVec2::ZERO).with_restitution(e).unwrap()];
        for &(direction, speed, mass) in &arms {
            let from = middle + direction * (20.0 + MEET * speed);
            balls.push(ball(from, -direction * speed).with_mass(mass).unwrap());
        }
        let mut turned = balls.clone();
        turned.rotate_left(first % balls.len());
        let [mut one, mut other] = [balls, turned].map(|balls| open(balls, solver));
        let before = kinetic_energy(one.balls());
        let given = momentum(one.balls());
        for simulation in [&mut one, &mut other] {
            simulation.advance(MEET + 1e-6).unwrap();
        }
        let mut back = other.balls().to_vec();
        back.rotate_right(first % (arms.len() + 1));
        for (one, other) in one.balls().iter().zip(&back) {
            prop_assert!(one.velocity().distance(other.velocity()) < 1e-9, "{} or {}", one.velocity(), other.velocity());
        }
        let after = kinetic_energy(one.balls());
        prop_assert!(after <= before * (1.0 + 1e-13));
        prop_assert!(e < 1.0 || after >= before * (1.0 - 1e-13));
        prop_assert!(momentum(one.balls()).distance(given) < 1e-9);
        prop_assert_eq!(one.tally().impacts, other.tally().impacts);
    }
}
