//! What is done to balls from outside is done to them as they are shown, also within a substep.

use carom::simulation::ledger::Ledger;

use super::numbers::random;
use super::*;

/// Frames a second that end within substeps, and one that does not.
pub(super) const RATES: [u32; 5] = [60, 75, 144, 250, 1000];

/// Balls that lie on the floor of a wide world with gravity, from its left on, and these.
pub(super) fn lying(count: usize, others: Vec<Ball>) -> Simulation {
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
fn a_ball_that_is_added_to_or_thrown_from_a_pile_of_which_all_sleep_flies_from_where_it_was_seen() {
    for rate in RATES {
        let frame = 1.0 / f64::from(rate);
        let mut simulation = lying(41, Vec::new());
        (0..2 * rate).for_each(|_| simulation.advance(frame).unwrap());
        let (seen, thrown) = (simulation.balls()[20], DVec2::new(400.0, -1300.0));
        simulation.add(&[moving(ball(3000.0, 600.0, 8.0), 500.0, -900.0)]).unwrap();
        simulation.set_velocity(20, thrown).unwrap();
        (0..20).for_each(|_| simulation.advance(frame).unwrap());
        let t = 20.0 * frame;
        for (ball, from, velocity) in [
            (simulation.balls()[20], seen.position(), thrown),
            (simulation.balls()[41], DVec2::new(3000.0, 600.0), DVec2::new(500.0, -900.0)),
        ] {
            let off = ball.position().distance(from + velocity * t + 0.5 * EARTH * t * t);
            assert!(off < 1e-6, "{rate} frames a second: {off} px beside its path");
        }
    }
}

#[test]
fn what_was_thrown_is_seen_where_it_was_and_as_fast_as_it_was_thrown() {
    let mut random = random(7);
    for round in 0..400 {
        let (few, rate) = (round % 2 == 0, RATES[round % 5]);
        let world = world(300.0, 300.0, 0.8).with_gravity(EARTH).unwrap();
        let place = |k: u32| (20.0 + 30.0 * f64::from(k % 9), 290.0 - 25.0 * f64::from(k / 9));
        let balls = (0..if few { 12 } else { 60 })
            .map(place)
            .map(|(x, y)| moving(ball(x, y, 10.0), 400.0 * (random() - 0.5), 400.0 * (random() - 0.5)));
        let mut simulation = simulation(world, balls.collect()).with_substeps(240).unwrap();
        for _ in 0..3 + round % 20 {
            simulation.advance(1.0 / f64::from(rate)).unwrap();
        }
        let index = round % simulation.balls().len();
        let seen = simulation.balls()[index].position();
        let thrown = [DVec2::new(0.0, 300.0), DVec2::ZERO, simulation.balls()[index].velocity()][round % 3];
        simulation.set_velocity(index, thrown).unwrap();
        simulation.advance(0.0).unwrap();
        let now = simulation.balls()[index];
        let (moved, turned) = (now.position().distance(seen), now.velocity().distance(thrown));
        assert!(moved < 1e-9 && turned < 1e-9, "round {round}: {moved} px, {turned} px/s");
    }
}

/// One ball among few that know of it only since the last search was thrown far: that ended the program.
#[test]
fn a_ball_is_thrown_after_another_was_added() {
    for count in [3, 20, 39, 40, 60] {
        let mut simulation = lying(count, vec![moving(ball(2000.0, 1000.0, 10.0), 0.0, 0.0)]);
        simulation = simulation.with_substeps(240).unwrap();
        (0..5).for_each(|_| simulation.advance(1.0 / 144.0).unwrap());
        simulation.add(&[ball(1000.0, 500.0, 10.0)]).unwrap();
        let seen = simulation.balls()[count].position();
        simulation.set_velocity(count, DVec2::new(-5e4, 0.0)).unwrap();
        simulation.advance(0.01).unwrap();
        let off = simulation.balls()[count].position().distance(seen + DVec2::new(-500.0, 0.049));
        assert!(off < 1e-6, "{count}: {off} px beside its path");
    }
}

#[test]
fn the_top_of_a_stack_that_is_told_to_stand_still_does_and_a_ball_that_is_thrown_and_stopped_at_once() {
    for rate in RATES {
        let frame = 1.0 / f64::from(rate);
        let stack = (0..14).map(|k| ball(200.0, 390.0 - 20.0 * f64::from(k), 10.0)).collect();
        let world = world(400.0, 400.0, 0.5).with_gravity(EARTH).unwrap();
        let mut simulation = simulation(world, stack);
        simulation.advance(2.0).unwrap();
        let before = simulation.balls()[13].position();
        for _ in 0..rate {
            simulation.set_velocity(13, DVec2::new(0.0, -1000.0)).unwrap();
            simulation.set_velocity(13, DVec2::ZERO).unwrap();
            simulation.advance(frame).unwrap();
        }
        let moved = simulation.balls()[13].position().distance(before);
        // A hundredth of its radius.
        assert!(moved < 0.1, "{rate} frames a second: {moved} px");
    }
}

#[test]
fn a_pile_sleeps_on_around_a_ball_that_is_carried_through_it_at_any_frame_rate() {
    let still = |rate: f64| {
        let text = "solver = \"contact\"\nsize = [400, 400]\ngravity = [0, 980]\n[walls]\nrestitution = 0.5\n[pairs]\n\
                    [[fill]]\ncount = 300\nradius = [6, 9]\nrestitution = 0.5\n";
        let mut simulation = Scene::parse("pile", text).unwrap().build().unwrap();
        simulation.advance(10.0).unwrap();
        let asleep = |simulation: &Simulation| {
            simulation.balls().iter().filter(|ball| ball.velocity() == DVec2::ZERO).count()
        };
        assert_eq!(asleep(&simulation), 300);
        let from = simulation.balls()[0].position();
        let mut sum = 0;
        for frame in 0..(2.0 * rate) as u32 {
            // Slowly to and fro, as a hand does.
            let wanted = from + DVec2::new(40.0 * (0.5 * f64::from(frame) / rate).sin(), 0.0);
            let velocity = (wanted - simulation.balls()[0].position()) * 30.0;
            simulation.set_velocity(0, velocity).unwrap();
            simulation.advance(1.0 / rate).unwrap();
            sum += asleep(&simulation);
        }
        f64::from(sum as u32) / (2.0 * rate)
    };
    let at_60 = still(60.0);
    assert!(at_60 > 60.0, "{at_60}");
    for rate in [59.94, 75.0, 144.0] {
        let found = still(rate);
        assert!(found > 0.5 * at_60, "{rate} frames a second: {found} asleep on average, {at_60} at 60");
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
