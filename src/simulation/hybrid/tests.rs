//! When balls go from impact to impact, when in substeps, and that nobody notices.

use glam::DVec2;

use super::super::ledger::Ledger;
use super::super::{Simulation, Solver};
use super::*;

/// A light ball between a wall and one of so many times its mass, which comes nearer.
fn squeezed(mass: f64) -> Simulation {
    let world = World::new(DVec2::new(400.0, 100.0)).unwrap().with_walls(1.0).unwrap();
    let at = |x: f64| Ball::new(DVec2::new(x, 50.0), 10.0).unwrap();
    let heavy = at(350.0).with_mass(mass).unwrap().with_velocity(DVec2::new(-200.0, 0.0)).unwrap();
    Simulation::new(world.with_pairs(Pairs::Impulse), vec![at(30.0), heavy], Solver::Contact).unwrap()
}

fn energy(simulation: &Simulation) -> f64 {
    super::super::invariants::kinetic_energy(simulation.balls())
}

#[test]
fn impacts_are_taken_in_substeps_once_there_are_more_than_can_be_followed() {
    for (mass, many) in [(1e8, false), (1e18, true)] {
        let mut simulation = squeezed(mass);
        let start = energy(&simulation);
        for frame in 0..240 {
            simulation.advance(1.0 / 60.0).unwrap();
            let [light, heavy] = simulation.balls() else { panic!("two balls") };
            assert!(light.position.x < heavy.position.x, "frame {frame}: the light one was passed through");
            assert!((energy(&simulation) / start - 1.0).abs() < 1e-9, "frame {frame}");
        }
        assert_eq!(!simulation.parts().contains(&Part::Events), many, "{mass:e}");
    }
}

/// A world in elastic walls, and these balls in it.
fn boxed(width: f64, height: f64, balls: Vec<Ball>) -> Simulation {
    let world = World::new(DVec2::new(width, height)).unwrap().with_walls(1.0).unwrap();
    Simulation::new(world.with_pairs(Pairs::Impulse), balls, Solver::Contact).unwrap()
}

fn moving(x: f64, y: f64, velocity: DVec2) -> Ball {
    Ball::new(DVec2::new(x, y), 10.0).unwrap().with_velocity(velocity).unwrap()
}

#[test]
fn balls_that_fill_a_box_keep_their_energy() {
    for (columns, rows) in [(2, 1), (3, 1), (10, 1), (3, 3), (6, 6)] {
        let at = |k: u32| DVec2::new(f64::from(k % columns), f64::from(k / columns)) * 20.0 + 10.0;
        let speed = |k: u32| DVec2::new(f64::from(k * 7 % 11) - 5.0, f64::from(k * 5 % 7) - 3.0) * 10.0;
        let balls = (0..columns * rows).map(|k| moving(at(k).x, at(k).y, speed(k))).collect();
        let mut full = boxed(20.0 * f64::from(columns), 20.0 * f64::from(rows).max(1.5), balls);
        let start = energy(&full);
        for frame in 0..120 {
            full.advance(1.0 / 60.0).unwrap();
            let kept = energy(&full) / start;
            assert!((kept - 1.0).abs() < 1e-9, "{columns} times {rows}, frame {frame}: {kept}");
        }
    }
}

#[test]
fn a_ball_as_high_as_the_world_loses_nothing() {
    let balls =
        vec![moving(30.0, 10.0, DVec2::new(50.0, 30.0)), moving(100.0, 10.0, DVec2::new(-20.0, 10.0))];
    let mut channel = boxed(200.0, 20.0, balls);
    let start = energy(&channel);
    for _ in 0..120 {
        channel.advance(1.0 / 60.0).unwrap();
        assert!((energy(&channel) / start - 1.0).abs() < 1e-12);
    }
}

#[test]
fn others_do_not_notice_that_substeps_take_over() {
    let mut simulation = squeezed(1e18);
    let world = simulation.world().with_size(DVec2::new(4000.0, 400.0)).unwrap();
    let mut balls = simulation.balls().to_vec();
    // One flies, and two meet, 1.595 s after the beginning.
    balls.push(moving(200.0, 300.0, DVec2::new(977.0, 0.0)));
    balls.push(moving(1000.0, 200.0, DVec2::new(100.0, 0.0)));
    balls.push(moving(1020.0 + 159.5, 200.0, DVec2::ZERO));
    simulation = Simulation::new(world, balls, Solver::Contact).unwrap();
    let (mut events, mut met) = (true, false);
    for frame in 1..=200 {
        let was = events;
        simulation.advance(0.01).unwrap();
        events = simulation.parts().contains(&Part::Events);
        met |= simulation.touching()[4];
        if !events && was {
            assert_eq!(frame, 160);
            assert!(simulation.touching()[3] && simulation.touching()[4]);
        }
        let flown = simulation.balls()[2].position().x - 200.0;
        assert!((flown - 9.77 * f64::from(frame)).abs() < 1e-6, "frame {frame}: {flown} px");
    }
    assert!(!events && met);
}

#[test]
fn substeps_take_over_though_balls_come_and_are_thrown_in_every_frame() {
    for adds in [false, true] {
        let fixed = |x: f64| moving(x, 50.0, DVec2::ZERO).fixed();
        let rattler = moving(120.0, 50.0, DVec2::new(200.0, 0.0));
        let far = moving(30.0, 300.0, DVec2::ZERO);
        let mut rattling = boxed(4000.0, 400.0, vec![fixed(100.0), fixed(140.0 + 1e-6), rattler, far]);
        let mut frames = 0;
        while rattling.parts().contains(&Part::Events) {
            // So much as a frame of a window has time for.
            let mut looks = 0;
            let go_on = || {
                looks += 1;
                looks < 100
            };
            rattling.advance_while(1.0 / 60.0, go_on).unwrap();
            let at = 100.0 + 25.0 * f64::from(frames);
            if adds {
                rattling.add(&[moving(at, 300.0, DVec2::ZERO)]).unwrap();
            } else {
                rattling.set_velocity(3, DVec2::new(f64::from(frames % 2), 0.0)).unwrap();
            }
            frames += 1;
            assert!(frames < 100, "adds: {adds}");
        }
    }
}

#[test]
fn when_that_is_does_not_depend_on_frames() {
    let after = |rate: f64| {
        let mut simulation = squeezed(1e18);
        let mut left = 2.0_f64;
        while left > 1e-12 {
            // Some frames are cut short.
            let mut looks = 0;
            let mut go_on = || {
                looks += 1;
                looks < 5
            };
            left -= simulation.advance_while(left.min(1.0 / rate), &mut go_on).unwrap();
        }
        assert!(!simulation.parts().contains(&Part::Events));
        simulation.balls().to_vec()
    };
    let once = after(60.0);
    for rate in [24.0, 144.0, 240.0, 1000.0] {
        for (one, other) in once.iter().zip(after(rate)) {
            assert!(
                one.position.distance(other.position) < 1e-6,
                "{rate} frames a second: {one:?} {other:?}"
            );
        }
    }
}

#[test]
fn balls_that_begin_in_each_other_are_moved_apart_where_there_is_room() {
    for (side, apart, events) in [
        (100.0, 20.0, true),
        (100.0, 20.0 - 1e-12, true),
        (100.0, 15.0, true),
        (100.0, 0.0, true),
        (25.0, 3.0, false),
    ] {
        let at = |x: f64| Ball::new(DVec2::new(x, 0.5 * side), 10.0).unwrap();
        let balls = vec![at(10.0), at(10.0 + apart)];
        let mut simulation = boxed(side, side, balls);
        assert_eq!(simulation.parts().contains(&Part::Events), events, "{apart} px in {side} px");
        simulation.advance(1.0 / 60.0).unwrap();
        let [one, other] = simulation.balls() else { panic!("two balls") };
        let distance = one.position().distance(other.position());
        assert!(!events || distance > 20.0 - 1e-9, "{distance} px from {apart}");
        assert_eq!(energy(&simulation), 0.0);
    }
}

const EARTH: DVec2 = DVec2::new(0.0, 980.0);
const FRAME: f64 = 1.0 / 60.0;

/// Balls that fall in walls of this restitution, and take energy of each other; the first lies on the floor.
fn falling_balls(count: u32, walls: f64, solver: Solver) -> Simulation {
    let world = World::new(DVec2::new(600.0, 400.0)).unwrap().with_walls(walls).unwrap();
    let world = world.with_gravity(EARTH).unwrap().with_pairs(Pairs::Impulse);
    let falls = |k: u32| {
        let at = DVec2::new(60.0 + 95.0 * f64::from(k % 6), 380.0 - 80.0 * f64::from(k / 6));
        let ball = Ball::new(at, 20.0 + f64::from(k * 7 % 5)).unwrap().with_restitution(0.7).unwrap();
        let speed = DVec2::new(f64::from(k * 7 % 11) - 5.0, f64::from(k * 5 % 7) - 3.0) * 60.0;
        if k == 0 { ball } else { ball.with_velocity(speed).unwrap() }
    };
    Simulation::new(world, (0..count).map(falls).collect(), solver).unwrap()
}

fn has_events(simulation: &Simulation) -> bool {
    simulation.parts().contains(&Part::Events)
}

#[test]
fn few_that_fall_do_as_with_exact_as_long_as_nothing_presses_any() {
    // Where walls take energy, too, it bounces off them more slowly than `exact`.
    let [mut contact, mut exact] =
        [Solver::Contact, Solver::Exact].map(|solver| falling_balls(15, 1.0, solver));
    while has_events(&contact) && contact.time() < 5.0 {
        assert_eq!(contact.balls(), exact.balls(), "{} s", contact.time());
        assert_eq!(contact.tally(), exact.tally(), "{} s", contact.time());
        contact.advance(FRAME).unwrap();
        exact.advance(FRAME).unwrap();
    }
    assert!(contact.tally().impacts > 20, "{:?} in {} s", contact.tally(), contact.time());
}

#[test]
fn when_balls_that_fall_go_over_and_back_does_not_depend_on_frames() {
    let after = |rate: f64, stops: bool| {
        let mut simulation = falling_balls(12, 0.8, Solver::Contact);
        let mut turns = 0;
        while simulation.time() < 8.0 {
            let mut looks = 0;
            let go_on = || {
                looks += 1;
                !stops || looks % 2 == 1
            };
            let was = has_events(&simulation);
            let left = (8.0 - simulation.time()).min(1.0 / rate);
            simulation.advance_while(left, go_on).unwrap();
            turns += u32::from(has_events(&simulation) != was);
        }
        (simulation.balls().to_vec(), turns)
    };
    let (once, turns) = after(60.0, false);
    assert!(turns > 1, "{turns}");
    for (rate, stops) in [(24.0, false), (24.0, true), (144.0, true), (997.0, false)] {
        assert_eq!(after(rate, stops).0, once, "{rate} frames a second");
    }
}

#[test]
fn no_law_is_broken_in_any_frames_though_substeps_come_and_go() {
    for (count, rate) in (6..24).flat_map(|count| [37.0, 41.0, 97.0, 144.0].map(|rate| (count, rate))) {
        let mut simulation = falling_balls(count, 0.8, Solver::Contact);
        let mut ledger = Ledger::new(&simulation);
        while simulation.time() < 8.0 {
            simulation.advance(1.0 / rate).unwrap();
            let held = ledger.check(&simulation);
            assert!(held.is_ok(), "{count} balls, {rate} frames a second, {} s: {held:?}", simulation.time());
        }
    }
}

#[test]
fn where_balls_that_fall_are_thrown_and_come_does_not_depend_on_frames() {
    let after = |rate: u32| {
        let mut simulation = falling_balls(12, 0.8, Solver::Contact);
        for act in 0..30_u32 {
            for _ in 0..rate / 12 {
                simulation.advance(1.0 / f64::from(rate)).unwrap();
            }
            if act % 6 == 2 {
                simulation.set_velocity(act as usize % 12, DVec2::new(150.0, -300.0)).unwrap();
            } else if act % 6 == 5 {
                let above = DVec2::new(100.0 + 10.0 * f64::from(act), 20.0);
                simulation.add(&[Ball::new(above, 6.0).unwrap()]).unwrap();
            }
        }
        simulation.balls().to_vec()
    };
    let once = after(60);
    for rate in [24, 144, 240, 996] {
        assert_eq!(after(rate), once, "{rate} frames a second");
    }
}

#[test]
fn balls_that_fall_go_over_where_a_substep_begins() {
    let mut all = 0;
    for count in 8..24 {
        let mut simulation = falling_balls(count, 0.8, Solver::Contact);
        let (mut was, mut turns) = (true, 0);
        // So frames end beside where substeps begin.
        simulation.advance(0.5 / 960.0).unwrap();
        for frame in 1..=960 * 6 {
            simulation.advance(1.0 / 960.0).unwrap();
            if has_events(&simulation) != was {
                assert_eq!(frame % 4, 0, "{count} balls, {} s", simulation.time());
                (was, turns) = (!was, turns + 1);
            }
        }
        // Sixteen substeps at the least are taken each time.
        assert!(turns < 90, "{count} balls: {turns}");
        all += turns;
    }
    assert!(all > 8, "{all}");
}

/// One rattles between two fixed ones, and others fly far away.
#[test]
fn what_flies_elsewhere_does_not_notice_under_gravity_that_impacts_are_outrun() {
    for gap in [1e-6, 1e-5, 1e-4, 1e-3] {
        let world = World::new(DVec2::new(3000.0, 4000.0)).unwrap().with_walls(1.0).unwrap();
        let world = world.with_gravity(EARTH).unwrap().with_pairs(Pairs::Impulse);
        let fixed = |x: f64| moving(x, 200.0, DVec2::ZERO).fixed();
        let rattler = moving(120.0 + 0.5 * gap, 200.0, DVec2::new(200.0, 0.0));
        let thrown = DVec2::new(300.0, -400.0);
        let balls = vec![fixed(100.0), fixed(140.0 + gap), rattler, moving(1500.0, 1000.0, thrown)];
        let mut rattling = Simulation::new(world, balls, Solver::Contact).unwrap();
        assert!(has_events(&rattling));
        let mut events = true;
        for frame in 1..=60 {
            rattling.advance(FRAME).unwrap();
            events &= has_events(&rattling);
            let time = FRAME * f64::from(frame);
            let law = DVec2::new(1500.0, 1000.0) + (thrown + 0.5 * EARTH * time) * time;
            let off = rattling.balls()[3].position().distance(law);
            assert!(off < 1e-9, "{gap} px, frame {frame}: {off} px");
        }
        assert!(!events, "{gap} px");
    }
}

#[test]
fn more_than_few_balls_that_fall_take_substeps_whenever_they_come() {
    for frames in 0..240 {
        let mut growing = falling_balls(12, 0.8, Solver::Contact);
        growing.advance(f64::from(frames) / 37.0).unwrap();
        let place =
            |k: u32| DVec2::new(12.0 + 19.0 * f64::from(k % 30), 10.0 + f64::from(22 * (k / 30) + k % 3));
        let more = |k: u32| moving(place(k).x, place(k).y, DVec2::ZERO);
        growing.add(&(0..120).map(more).collect::<Vec<_>>()).unwrap();
        assert!(!has_events(&growing), "{frames} frames");
        growing.advance(0.2).unwrap();
        assert!(!has_events(&growing), "{frames} frames");
    }
}

#[test]
fn what_is_slow_is_left_to_substeps_in_which_it_may_sleep() {
    let world = World::new(DVec2::new(1600.0, 400.0)).unwrap().with_walls(0.5).unwrap();
    let world = world.with_gravity(EARTH).unwrap().with_pairs(Pairs::Impulse);
    for (speed, events) in [(30.0, true), (0.5, false)] {
        // Two lie beside each other.
        let at = |x: f64, speed: f64| moving(x, 390.0, DVec2::new(speed, 0.0));
        let balls = vec![at(100.0, 0.0), at(120.0, 0.0), at(800.0, speed)];
        let mut lying = Simulation::new(world, balls, Solver::Contact).unwrap();
        assert!(!has_events(&lying));
        lying.advance(3.0).unwrap();
        assert_eq!(has_events(&lying), events, "{speed} px/s");
        let still = lying.balls().iter().all(|ball| ball.velocity == DVec2::ZERO);
        assert_eq!(still, !events, "{speed} px/s");
    }
}

#[test]
fn balls_that_lie_on_each_other_take_substeps_until_nothing_presses_any() {
    let world = World::new(DVec2::new(1600.0, 400.0)).unwrap().with_walls(0.5).unwrap();
    let world = world.with_gravity(EARTH).unwrap().with_pairs(Pairs::Impulse);
    let at = |x: f64, y: f64| Ball::new(DVec2::new(x, y), 20.0).unwrap().with_restitution(0.5).unwrap();
    // One rolls off the other; a third slides.
    let off = at(800.0, 380.0).position + 40.0 / 13.0 * DVec2::new(5.0, -12.0);
    let slides = at(100.0, 380.0).with_velocity(DVec2::new(30.0, 0.0)).unwrap();
    let mut balls = vec![at(800.0, 380.0), at(off.x, off.y), slides];
    let mut parting = Simulation::new(world, balls.clone(), Solver::Contact).unwrap();
    assert!(!has_events(&parting));
    let least = |simulation: &Simulation| energy(simulation) - EARTH.y * height(simulation);
    let mut last = least(&parting);
    for frame in 0..180 {
        parting.advance(FRAME).unwrap();
        let now = least(&parting);
        assert!(now < last + 1e-3 * EARTH.y * 40.0, "frame {frame}: {now} after {last}");
        last = now;
    }
    assert!(has_events(&parting));
    assert!(parting.balls().iter().all(|ball| (ball.position.y - 380.0).abs() < 1e-9));
    // Upright it stays there, and where all that moves is slow, too.
    balls[1] = at(800.0, 340.0);
    let mut standing = Simulation::new(world, balls.clone(), Solver::Contact).unwrap();
    balls[1] = at(900.0, 380.0);
    balls[2] = balls[2].with_velocity(DVec2::new(0.5, 0.0)).unwrap();
    let mut slow = Simulation::new(world, balls, Solver::Contact).unwrap();
    standing.advance(3.0).unwrap();
    slow.advance(3.0).unwrap();
    assert!(!has_events(&standing) && has_events(&slow));
}

/// The sum of how far down balls are, px, by their masses.
fn height(simulation: &Simulation) -> f64 {
    simulation.balls().iter().map(|ball| ball.mass * ball.position.y).sum()
}
