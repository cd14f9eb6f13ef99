//! What is done to balls from outside is done to them as they are shown, also within a substep.

use carom::simulation::ledger::Ledger;

use super::*;

/// Frames a second that end within substeps, and one that does not.
const RATES: [u32; 5] = [60, 75, 144, 250, 1000];

/// Balls that lie on the floor of a wide world with gravity, from its left on, and these.
fn lying(count: usize, others: Vec<Ball>) -> Simulation {
    let world = world(4000.0, 2000.0, 0.5).with_gravity(EARTH).unwrap();
    let mut balls: Vec<Ball> = (0..count).map(|k| ball(20.0 + 30.0 * k as f64, 1990.0, 10.0)).collect();
    balls.extend(others);
    simulation(world, balls)
}

#[test]
fn a_ball_that_is_given_its_own_velocity_again_and_again_falls_as_if_nobody_had() {
    for (few, rate) in [true, false].into_iter().flat_map(|few| RATES.map(|rate| (few, rate))) {
        let falling = vec![moving(ball(2000.0, 100.0, 10.0), 300.0, 0.0)];
        let mut simulation = lying(if few { 0 } else { 41 }, falling);
        if few {
            simulation = simulation.with_substeps(240).unwrap();
        }
        let last = simulation.balls().len() - 1;
        for _ in 0..rate {
            simulation.advance(1.0 / f64::from(rate)).unwrap();
            let velocity = simulation.balls()[last].velocity();
            simulation.set_velocity(last, velocity).unwrap();
        }
        let ball = simulation.balls()[last];
        let (off, by) =
            (ball.position() - DVec2::new(2300.0, 590.0), ball.velocity() - DVec2::new(300.0, 980.0));
        assert!(off.length() < 1e-6 && by.length() < 1e-6, "{rate} frames a second: {off} px, {by} px/s");
    }
}

#[test]
fn a_fast_ball_that_is_stopped_by_hand_stands_where_it_was_seen() {
    let mut simulation = lying(41, vec![moving(ball(100.0, 50.0, 10.0), 1e5, 0.0)]);
    simulation.advance(0.009).unwrap();
    let seen = simulation.balls()[41].position();
    simulation.set_velocity(41, DVec2::ZERO).unwrap();
    simulation.advance(0.001).unwrap();
    assert!(simulation.balls()[41].position().distance(seen) < 1e-3);
}

#[test]
fn a_ball_that_is_added_or_thrown_within_a_substep_flies_from_where_it_was_seen() {
    for rate in RATES {
        let frame = 1.0 / f64::from(rate);
        let mut simulation = lying(41, vec![ball(2000.0, 1200.0, 10.0)]);
        (0..7).for_each(|_| simulation.advance(frame).unwrap());
        let seen = simulation.balls()[41];
        simulation.set_velocity(41, DVec2::new(-700.0, -2000.0)).unwrap();
        simulation.add(&[moving(ball(3000.0, 600.0, 8.0), 500.0, -900.0)]).unwrap();
        for n in 1..=40 {
            simulation.advance(frame).unwrap();
            let t = f64::from(n) * frame;
            for (ball, from, velocity) in [
                (simulation.balls()[41], seen.position(), DVec2::new(-700.0, -2000.0)),
                (simulation.balls()[42], DVec2::new(3000.0, 600.0), DVec2::new(500.0, -900.0)),
            ] {
                let want = from + velocity * t + 0.5 * EARTH * t * t;
                let off = ball.position().distance(want);
                assert!(off < 1e-6, "{rate} frames a second, the {n}th: {off} px beside its path");
            }
        }
    }
}

#[test]
fn what_is_put_before_a_fast_ball_is_hit_by_it_also_within_a_substep() {
    for (rate, fixed) in RATES.into_iter().flat_map(|rate| [(rate, false), (rate, true)]) {
        for case in 0..40 {
            let speed = [1e4, 2e4, 5e4][case % 3];
            let mut simulation = lying(41, vec![moving(ball(100.0, 800.0, 5.0), speed, 0.0)]);
            for _ in 0..=case % 5 {
                simulation.advance(1.0 / f64::from(rate)).unwrap();
            }
            let bullet = simulation.balls()[41];
            // A bullet that has come to a wall already flies the other way.
            let ahead = (26.0 + 3.0 * case as f64).copysign(bullet.velocity().x);
            let place = bullet.position() + DVec2::new(ahead, 0.0);
            if !(30.0..3970.0).contains(&place.x) {
                continue;
            }
            let target = ball(place.x, place.y, 20.0).with_mass(1e6).unwrap();
            simulation.add(&[if fixed { target.fixed() } else { target }]).unwrap();
            simulation.advance(1.0 / f64::from(rate)).unwrap();
            let (now, side) = (simulation.balls()[41], bullet.velocity().x.signum());
            let before = (simulation.balls()[42].position().x - now.position().x) * side;
            assert!(
                before > 0.0,
                "{rate} frames a second, {speed} px/s, {ahead} px ahead: it is {before} px before"
            );
        }
    }
}

#[test]
fn elastic_balls_keep_their_energy_while_one_after_the_other_is_given_its_own_velocity() {
    for rate in RATES {
        let world = world(400.0, 400.0, 1.0).with_gravity(EARTH).unwrap();
        let balls = (0..60).map(|k| {
            let (column, row) = (f64::from(k % 8), f64::from(k / 8));
            let ball = moving(ball(30.0 + 45.0 * column, 30.0 + 45.0 * row, 8.0), 90.0 - 23.0 * column, 40.0);
            ball.with_restitution(1.0).unwrap()
        });
        let mut simulation = simulation(world, balls.collect());
        let energy = |simulation: &Simulation| {
            kinetic_energy(simulation.balls()) + potential_energy(simulation.world(), simulation.balls())
        };
        let start = energy(&simulation);
        for frame in 0..2 * rate as usize {
            simulation.advance(1.0 / f64::from(rate)).unwrap();
            let index = frame % 60;
            simulation.set_velocity(index, simulation.balls()[index].velocity()).unwrap();
            if frame % 8 == 7 {
                // Within a substep it may not be told what balls have that hold each other.
                simulation.advance(0.0).unwrap();
            }
        }
        let change = energy(&simulation) / start - 1.0;
        assert!(change.abs() < 1e-3, "{rate} frames a second: {change}");
    }
}

#[test]
fn balls_that_overlap_by_less_than_can_be_seen_do_not_jump_apart_without_gravity() {
    for depth in [1e-10, 1e-8, 2e-7, 9e-7, 1.1e-6, 2e-6, 1e-5, 1e-3] {
        let balls = vec![ball(50.0, 50.0, 10.0), ball(70.0 - 10.0 * depth, 50.0, 10.0)];
        let before = balls.clone();
        let mut simulation = simulation(world(200.0, 100.0, 1.0), balls);
        let mut ledger = Ledger::new(&simulation);
        simulation.advance(FRAME).unwrap();
        let held = ledger.check(&simulation);
        assert!(held.is_ok(), "{depth}: {held:?}");
        for (before, after) in before.iter().zip(simulation.balls()) {
            assert!(before.position().distance(after.position()) <= 60.0 * depth, "{depth}");
        }
    }
}
