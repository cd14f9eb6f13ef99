//! What rests falls asleep, and wakes when it has to.

use super::*;

/// A column of balls, and one that slides along the floor until it hits the lowest, after 4 s.
fn struck_column() -> Simulation {
    let mut balls: Vec<_> = (0..5).map(|k| ball(600.0, 590.0 - 20.0 * f64::from(k), 10.0)).collect();
    balls.push(moving(ball(100.0, 590.0, 10.0), 120.0, 0.0));
    simulation(world(1000.0, 600.0, 0.5).with_gravity(EARTH).unwrap(), balls)
}

#[test]
fn a_column_at_rest_sleeps_and_falls_when_its_foot_is_knocked_away() {
    let mut simulation = struck_column();
    simulation.advance(3.0).unwrap();
    let before = simulation.balls().to_vec();
    simulation.advance(0.5).unwrap();
    assert_eq!(simulation.balls()[..5], before[..5]);
    assert!(simulation.balls()[..5].iter().all(|ball| ball.velocity() == DVec2::ZERO));
    simulation.advance(6.0).unwrap();
    let after = simulation.balls();
    assert!(
        after[4].position().y > before[4].position().y + 19.0,
        "the top is still at {}",
        after[4].position()
    );
    for ball in after {
        let lies_on = |other: &Ball| {
            let apart = ball.position().distance(other.position());
            other.position().y > ball.position().y && apart < ball.radius() + other.radius() + 0.1
        };
        let at = ball.position();
        assert!(at.y > 589.9 || after.iter().any(lies_on), "one hangs in the air at {at}");
    }
}

#[test]
fn a_fixed_ball_that_is_put_into_a_sleeper_wakes_it_and_they_part() {
    let lying = |x: f64| ball(x, 285.0, 15.0).with_restitution(0.3).unwrap();
    let world = world(400.0, 300.0, 0.3).with_gravity(EARTH).unwrap();
    for mut floor in both_ways(&simulation(world, vec![lying(200.0), lying(100.0)])) {
        floor.advance(3.0).unwrap();
        assert!(floor.balls().iter().all(|ball| ball.velocity() == DVec2::ZERO));
        floor.add(&[ball(206.0, 262.0, 15.0).fixed()]).unwrap();
        assert!(overlap(&floor) > 0.4);
        floor.advance(3.0).unwrap();
        assert!(overlap(&floor) < 0.05, "{} of a radius", overlap(&floor));
    }
}

/// One that came slowly turned back, as off a wall, whatever its mass.
#[test]
fn a_slow_ball_gives_a_lighter_one_that_sleeps_its_impulse_and_goes_on() {
    for (mass, restitution) in [(1.0, 0.9), (1e2, 0.5), (1e4, 0.0), (1e6, 1.0)] {
        // What gives less than a kick of gravity, 4 px/s, to one as heavy leaves it asleep.
        for speed in [7.0, 5.0, 3.0].into_iter().filter(|&speed| mass > 1.0 || speed > 4.5) {
            let on_floor = |x: f64| ball(x, 90.0, 10.0).with_restitution(restitution).unwrap();
            let sleeper = on_floor(100.0);
            let coming = moving(on_floor(50.0).with_mass(mass).unwrap(), speed, 0.0);
            let world = world(400.0, 100.0, 0.5).with_gravity(EARTH).unwrap();
            for mut floor in both_ways(&simulation(world, vec![sleeper, coming])) {
                // Only just before they meet is it certain that the other sleeps.
                floor.advance(29.0 / speed).unwrap();
                assert_eq!(floor.balls()[0].velocity(), DVec2::ZERO);
                floor.advance(2.0 / speed).unwrap();
                let [struck, striking] = [0, 1].map(|k: usize| floor.balls()[k].velocity().x);
                let centre = speed * mass / (mass + 1.0);
                let laws = [centre * (1.0 + restitution), centre - restitution * speed / (mass + 1.0)];
                for (is, law) in [struck, striking].into_iter().zip(laws) {
                    assert!((is - law).abs() < 1e-6 * speed, "{mass} at {speed} px/s: {is}, not {law} px/s");
                }
            }
        }
    }
}

/// Two balls on each other, asleep.
fn sleeping_pair() -> Simulation {
    let balls = vec![ball(600.0, 590.0, 10.0), ball(600.0, 570.0, 10.0)];
    let mut simulation = simulation(world(4000.0, 600.0, 0.5).with_gravity(EARTH).unwrap(), balls);
    simulation.advance(2.0).unwrap();
    assert_eq!(fastest(&simulation), 0.0);
    simulation
}

#[test]
fn a_sleeper_falls_when_a_bullet_takes_its_support_away() {
    for speed in [1e3, 3e3, 6e3, 2e4] {
        let mut simulation = sleeping_pair();
        simulation.add(&[moving(ball(588.9, 590.0, 1.0), speed, 0.0)]).unwrap();
        simulation.advance(0.5).unwrap();
        let upper = simulation.balls()[1].position();
        assert!(upper.y > 589.0, "{speed}: it hangs at {upper}");
    }
}

#[test]
fn however_heavy_a_ball_that_is_put_on_sleepers_it_rests_there() {
    for mass in [1e3, 1e4, 1e6, 1e9, 1e12] {
        let mut simulation = sleeping_pair();
        simulation.add(&[ball(600.0, 550.0, 10.0).with_mass(mass).unwrap()]).unwrap();
        for _ in 0..300 {
            simulation.advance(FRAME).unwrap();
            assert!(fastest(&simulation) < 10.0, "{mass}: {} px/s", fastest(&simulation));
        }
        assert!(overlap(&simulation) < 0.05, "{mass}: {}", overlap(&simulation));
    }
}

/// Twenty balls on each other, the highest of this mass, asleep.
fn sleeping_tower(top: f64) -> Simulation {
    let mut masses = [1.0; 20];
    masses[19] = top;
    let mut simulation = tower(&masses);
    simulation.advance(2.0).unwrap();
    simulation
}

/// What is awake hits the floor again and again.
#[test]
fn what_carries_a_million_times_its_mass_falls_asleep() {
    let mut heavy = Scene::load("heavy").unwrap().build().unwrap();
    heavy.advance(2.0).unwrap();
    for mut simulation in [heavy, sleeping_tower(1e3), sleeping_tower(1e6)] {
        let (balls, tally) = (simulation.balls().to_vec(), simulation.tally());
        simulation.advance(4.0).unwrap();
        assert_eq!((simulation.balls(), simulation.tally()), (&balls[..], tally));
        assert_eq!(fastest(&simulation), 0.0);
    }
}

#[test]
fn what_a_heavy_ball_slept_on_falls_with_it_when_one_below_is_struck_away() {
    for top in [1.0, 1e2, 1e3, 1e6, 1e12] {
        let mut simulation = sleeping_tower(top);
        let before = simulation.balls().to_vec();
        simulation.set_velocity(5, DVec2::new(200.0, 0.0)).unwrap();
        let start = energy(&simulation);
        for _ in 0..60 {
            simulation.advance(FRAME).unwrap();
            let risen = (energy(&simulation) - start) / start;
            assert!(risen < 2e-3, "{top}: the energy rises by {risen} of itself");
        }
        for (now, then) in simulation.balls().iter().zip(&before).skip(6) {
            let (now, then) = (now.position(), then.position());
            assert!(now.y > then.y + 10.0, "{top}: one hangs at {now}");
        }
    }
}

/// One that is added outside a world without walls just before rest is looked at, which that was taken for a wall's.
#[test]
fn nothing_sleeps_on_a_wall_that_is_not_there() {
    let world = World::new(DVec2::new(400.0, 400.0)).unwrap().with_pairs(Pairs::Impulse);
    let mut simulation = simulation(world.with_gravity(EARTH).unwrap(), vec![ball(100.0, 100.0, 10.0)]);
    simulation.add(&[ball(200.0, 100.0, 10.0)]).unwrap();
    simulation.advance(0.5 - 1.0 / 240.0).unwrap();
    simulation.add(&[ball(300.0, 5000.0, 10.0)]).unwrap();
    simulation.advance(1.0).unwrap();
    let fallen = simulation.balls()[2].position().y - 5000.0;
    assert!((fallen - 490.0).abs() < 1.0, "it falls {fallen} px in a second");
}

#[test]
fn what_is_rid_of_a_heavy_ball_stays_where_it_slept() {
    for top in [1.0, 1e2, 1e3, 1e6, 1e12] {
        let mut simulation = sleeping_tower(top);
        simulation.remove_last().unwrap();
        for _ in 0..60 {
            simulation.advance(FRAME).unwrap();
            assert!(fastest(&simulation) < 0.5, "{top}: {} px/s", fastest(&simulation));
        }
    }
}

#[test]
fn a_ball_that_swings_against_a_wall_never_sleeps_at_its_turning_points() {
    for (across, start) in [(980.0, 30.717), (400.0, 12.55), (100.0, 3.156), (100.0, 12.5), (100.0, 50.0)] {
        let gravity = DVec2::new(across, 980.0);
        let lone = vec![ball(390.0 - start, 390.0, 10.0)];
        let mut simulation = simulation(world(400.0, 400.0, 1.0).with_gravity(gravity).unwrap(), lone);
        for second in 0..10 {
            let mut farthest = 390.0_f64;
            for _ in 0..60 {
                simulation.advance(FRAME).unwrap();
                farthest = farthest.min(simulation.balls()[0].position().x);
            }
            let reached = 390.0 - farthest;
            assert!(reached > 0.98 * start, "{across}, {start}: {reached} px in second {second}");
        }
    }
}

#[test]
fn what_lands_on_a_sleeping_pile_wakes_it_and_leaves_no_overlap() {
    for seed in [1, 2, 3, 4] {
        let text = format!(
            "solver = \"contact\"\nsize = [300, 6000]\ngravity = [0, 980]\n[walls]\nrestitution = 0.3\n[pairs]\n\
             [[ball]]\nposition = [150, 30]\nradius = 25\nmass = 100\nrestitution = 0.3\n\
             [[fill]]\ncount = 150\nradius = [6, 9]\nrestitution = 0.3\nseed = {seed}\nregion = [0, 5600, 300, 6000]\n"
        );
        let mut simulation = Scene::parse("drop", &text).unwrap().build().unwrap();
        simulation.advance(3.2).unwrap();
        let rest = simulation.balls().to_vec();
        let still = |ball: &&Ball| ball.velocity() == DVec2::ZERO;
        assert!(rest.iter().filter(still).count() > 100, "{seed}: the pile did not fall asleep");
        simulation.advance(0.3).unwrap();
        let moved =
            simulation.balls().iter().zip(&rest).filter(|(now, then)| now.position() != then.position());
        assert!(moved.count() > 50, "{seed}");
        simulation.advance(10.0).unwrap();
        assert_eq!(fastest(&simulation), 0.0, "{seed}");
        assert!(overlap(&simulation) < 0.05, "{seed}");
    }
}

/// Each of these squeezes balls between sleepers, or between them and a wall, where they overlapped or rattled for ever.
#[test]
fn every_ball_of_a_pile_comes_to_rest_whatever_squeezes_it() {
    for seed in [1, 2, 6, 8] {
        let mut pile = seeded_pile(2000, seed);
        pile.advance(10.0).unwrap();
        assert_eq!(fastest(&pile), 0.0, "seed {seed}");
        assert!(overlap(&pile) < 0.05, "seed {seed}: {}", overlap(&pile));
    }
}

#[test]
fn a_pile_that_fell_asleep_stands_still_to_the_bit() {
    let mut pile = pile(300);
    pile.advance(10.0).unwrap();
    assert_eq!(fastest(&pile), 0.0);
    assert!(overlap(&pile) < 0.05);
    let (before, touching) = (pile.balls().to_vec(), pile.touching().to_vec());
    for frame in [1.0 / 60.0, 1.0 / 144.0, 0.0, 100.0] {
        pile.advance(frame).unwrap();
    }
    assert_eq!((pile.balls(), pile.touching()), (&before[..], &touching[..]));
    assert!((pile.time() - 110.0).abs() < 0.1);
}

/// What slept was hit, and pushed, as if it were fixed: the row stood like a wall, and what came turned round; or all stood still, at a
/// quarter of what gravity gives in a substep.
#[test]
fn a_row_at_rest_takes_the_momentum_of_a_ball_that_comes_slowly_and_does_not_turn_it_round() {
    for (count, apart, restitution, speed, gravity) in [
        (5, 0.0, 0.5, 12.0, 980.0),
        (5, 0.5, 0.0, 30.0, 980.0),
        (20, 2.0, 0.0, 100.0, 980.0),
        (20, 0.0, 0.0, 50.0, 980.0),
        (20, 0.0, 0.0, 50.0, 98.0),
        (5, 0.0, 0.0, 50.0, 9800.0),
        (5, 0.0, 0.0, 200.0, 98_000.0),
    ] {
        for others in [0, 60] {
            let mut row = vec![moving(ball(200.0, 380.0, 20.0), speed, 0.0)];
            row.extend((0..count).map(|k| ball(300.0 + (40.0 + apart) * f64::from(k), 380.0, 20.0)));
            let mut balls: Vec<_> =
                row.iter().map(|ball| ball.with_restitution(restitution).unwrap()).collect();
            balls.extend((0..others).map(|k| ball(2500.0 + 45.0 * f64::from(k), 380.0, 20.0)));
            let world = world(6000.0, 400.0, 0.5).with_gravity(DVec2::new(0.0, gravity)).unwrap();
            let mut hit = simulation(world, balls);
            let speeds = |hit: &Simulation| -> Vec<f64> {
                hit.balls()[..=count as usize].iter().map(|ball| ball.velocity().x).collect()
            };
            let what = format!("{count}, {apart} px apart, {speed} px/s at {gravity}, {others} others");
            // It comes to a row that sleeps. (It was stopped, or turned round.)
            hit.advance(60.0 / speed + 0.2).unwrap();
            let momentum: f64 = speeds(&hit).iter().sum();
            assert!((momentum / speed - 1.0).abs() < 0.06, "{what}: {momentum}, {:?}", speeds(&hit));
            // The slowest fall asleep, at less than 1 px/s each.
            hit.advance(40.0 / speed + 0.8).unwrap();
            let momentum: f64 = speeds(&hit).iter().sum();
            assert!((0.6..1.2).contains(&(momentum / speed)), "{what}: {momentum}, {:?}", speeds(&hit));
            assert!(speeds(&hit).iter().all(|&v| v > -0.05 * speed), "{what}: {:?}", speeds(&hit));
        }
    }
}

/// One that is thrown up the side of a fixed one, and turns round in the middle of the half second after which its rest is looked at, was
/// where it had been then, and hung there for ever.
#[test]
fn no_ball_falls_asleep_on_the_side_of_a_fixed_one() {
    for highest in [0.6_f64, 0.7, 0.8] {
        for others in [0, 60] {
            let (reach, highest) = (110.0, highest.to_radians());
            // θ grows as a hyperbolic cosine from where it turns.
            let rate = f64::sqrt(EARTH.y / reach);
            let (angle, turning) = (highest * (0.25 * rate).cosh(), -highest * rate * (0.25 * rate).sinh());
            let up = DVec2::from_angle(angle - 0.5 * std::f64::consts::PI);
            let (at, along) = (DVec2::new(500.0, 500.0) + reach * up, reach * turning * up.perp());
            let mut balls =
                vec![moving(ball(at.x, at.y, 10.0), along.x, along.y), ball(500.0, 500.0, 100.0).fixed()];
            balls.extend((0..others).map(|k| ball(30.0 + 25.0 * f64::from(k), 990.0, 10.0)));
            let mut swing = simulation(world(2000.0, 1000.0, 0.5).with_gravity(EARTH).unwrap(), balls);
            swing.advance(4.0).unwrap();
            assert!(
                swing.balls()[0].position().y > 700.0,
                "{highest}, {others} others: {:?}",
                swing.balls()[0]
            );
        }
    }
}
