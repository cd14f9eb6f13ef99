//! Single impacts, and few balls between walls, at any speed and of any mass.

use super::numbers::random;
use super::*;

#[test]
fn a_ball_gives_back_its_restitution_from_a_wall_at_any_speed() {
    for e in [0.1, 0.7, 0.999, 1.0] {
        for speed in [1.0, 30.0, 1e3, 1e5, 1e8] {
            let start = ball(50.0, 50.0, 10.0).with_restitution(e).unwrap();
            let mut simulation = simulation(world(1000.0, 100.0, e), vec![moving(start, -speed, 0.0)]);
            while simulation.tally().wall_hits == 0 {
                simulation.advance(1.0 / 240.0).unwrap();
                assert!(simulation.time() < 50.0);
            }
            let hits = i32::try_from(simulation.tally().wall_hits).unwrap();
            let left = simulation.balls()[0].velocity().length();
            assert!((left / (speed * e.powi(hits)) - 1.0).abs() < 1e-12, "{e} {speed}: {left} after {hits}");
        }
    }
}

/// One wall's push was an impact on the other, and it moved to and fro without going anywhere, for ever: what touched it was hit.
#[test]
fn a_ball_as_wide_as_the_box_throws_nothing_that_rolls_off_it() {
    for (place, gravity) in [(167.5, DVec2::new(0.0, 300.0)), (100.0, DVec2::new(20.0, 300.0))] {
        let world = world(65.0, 200.0, 0.16).with_gravity(gravity).unwrap();
        let bouncing = |ball: Ball, mass| ball.with_restitution(0.8).unwrap().with_mass(mass).unwrap();
        let balls = vec![bouncing(ball(32.5, place, 32.5), 1000.0), bouncing(ball(6.0, 50.0, 5.0), 25.0)];
        let mut wide = simulation(world, balls);
        let scale = 25.0 * gravity.y * 5.0;
        let rises = rise(&mut wide, 1800);
        assert!(rises < 1e-3 * scale, "by {} of what lifts the small one by its radius", rises / scale);
        assert_eq!(fastest(&wide), 0.0);
    }
}

/// By rounding, these two pairs met again at once, and at each end of a substep, and stayed where they were for ever.
#[test]
#[expect(clippy::unreadable_literal, reason = "as they were found")]
fn balls_that_meet_fast_and_take_all_energy_fly_on_and_come_to_rest() {
    type Thrown = (f64, f64, f64, f64, f64, f64);
    let dull = |(x, y, radius, mass, right, down): Thrown| {
        let ball = ball(x, y, radius).with_restitution(0.0).unwrap().with_mass(mass).unwrap();
        moving(ball, right, down)
    };
    let equal = [
        (1028.853362252802, 947.3931231994469, 10.0, 1.0, -4808.893708800356, 8767.812800092184),
        (1001.7969979755821, 1000.9856018207201, 10.0, 1.0, 0.0, 0.0),
    ];
    let unlike = [
        (
            16.333291436419557,
            22.877180624059196,
            5.967276741286605,
            8.385120588337827,
            -2502.3519277765386,
            1417.3876832784815,
        ),
        (
            24.837880210750857,
            12.994216718357453,
            7.07116663903627,
            2.859472467195735,
            -2749.6759847059143,
            1204.5578664084492,
        ),
    ];
    let small = world(253.10901122375097, 199.9957697858967, 0.8).with_gravity(DVec2::new(300.0, 500.0));
    let cases = [(world(2000.0, 2000.0, 0.5).with_gravity(EARTH).unwrap(), equal), (small.unwrap(), unlike)];
    for (world, balls) in cases {
        for mut pair in both_ways(&simulation(world, balls.map(dull).to_vec())) {
            pair.advance(30.0).unwrap();
            assert!(pair.tally().impacts > 0);
            for ball in pair.balls() {
                let above = world.size().y - ball.position().y - ball.radius();
                assert!(above < 0.1, "one hangs {above} px above the floor at {}", ball.velocity());
            }
        }
    }
}

#[test]
fn two_balls_give_back_their_restitution_at_any_speed() {
    for e in [0.0, 0.1, 0.7, 1.0] {
        for speed in [1.0, 30.0, 1e3, 1e5] {
            let world = World::new(DVec2::splat(1000.0)).unwrap().with_pairs(Pairs::Impulse);
            let one = moving(ball(400.0, 500.0, 10.0), speed, 0.0).with_restitution(e).unwrap();
            let other = ball(430.0, 500.0, 10.0).with_mass(3.0).unwrap();
            for mut simulation in both_ways(&simulation(world, vec![one, other])) {
                // At least a substep, so that it is over.
                simulation.advance((20.0 / speed).max(1.0 / 240.0)).unwrap();
                let parting = simulation.balls()[1].velocity().x - simulation.balls()[0].velocity().x;
                assert!((parting - e * speed).abs() < 1e-12 * speed, "{e} {speed}: {parting}");
                assert_eq!(simulation.tally().impacts, 1);
            }
        }
    }
}

/// It was turned back by its mean velocity in the substep, at a place on the straight way: an elastic one lost 4 % of its energy
/// in some thirty bounces.
#[test]
fn a_ball_that_bounces_on_a_fixed_one_under_gravity_does_as_with_exact_and_keeps_its_energy() {
    let mut number = random(1);
    for gravity in [DVec2::new(0.0, 980.0), DVec2::new(60.0, 100.0)] {
        for _ in 0..10 {
            let (x, y) = (175.0 + 50.0 * number(), 50.0 + 150.0 * number());
            let falling = moving(ball(x, y, 5.0 + 15.0 * number()), 60.0 * number() - 30.0, 0.0);
            let balls = vec![ball(200.0, 300.0, 30.0).fixed(), falling];
            let world = world(400.0, 400.0, 1.0).with_gravity(gravity).unwrap();
            let mut exact = Simulation::new(world, balls.clone(), Solver::Exact).unwrap();
            while exact.tally().impacts == 0 && exact.time() < 10.0 {
                exact.advance(FRAME).unwrap();
            }
            for mut contact in both_ways(&simulation(world, balls)) {
                let start = energy(&contact);
                while contact.time() < exact.time() {
                    contact.advance(FRAME).unwrap();
                }
                let (place, velocity) = apart(&exact, &contact);
                assert!(place < 1e-9 && velocity < 1e-8, "from {x}, {y}: {place} px, {velocity} px/s");
                contact.advance(50.0).unwrap();
                let change = energy(&contact) / start - 1.0;
                assert!(
                    change.abs() < 1e-9,
                    "from {x}, {y}: {change} of the energy after {:?}",
                    contact.tally()
                );
            }
        }
    }
}

/// Between a wall and a fixed ball one that met either in the substep before was turned back as if they pressed on each other.
#[test]
fn an_elastic_ball_keeps_its_energy_in_a_gap_where_it_hits_something_in_every_substep() {
    let mut number = random(2);
    for _ in 0..40 {
        let radius = 10.0 + 20.0 * number();
        let peg = ball(28.5 + 2.0 * number() + radius, 150.0, radius).fixed();
        let beside = ball(14.1, 150.0 + 10.0 * number(), 14.0);
        let rattling = moving(beside, 200.0 + 500.0 * number(), 600.0 * number() - 600.0);
        let world = world(440.0, 440.0, 1.0).with_gravity(EARTH).unwrap();
        for mut gap in both_ways(&simulation(world, vec![peg, rattling])) {
            let start = energy(&gap);
            for _ in 0..120 {
                gap.advance(FRAME).unwrap();
                let change = energy(&gap) / start - 1.0;
                assert!(change.abs() < 1e-9, "{change} of the energy after {:?}", gap.tally());
            }
        }
    }
}

#[test]
fn a_dropped_ball_bounces_as_high_as_its_restitution_says_and_comes_to_rest() {
    // h·e² after the first bounce, in closed form within the substep; at rest after √(2h/g)·(1+e)/(1−e).
    let (e, fall) = (0.8, 200.0);
    let start = ball(100.0, 400.0 - 10.0 - fall, 10.0);
    let mut simulation = simulation(world(200.0, 400.0, e).with_gravity(EARTH).unwrap(), vec![start]);
    let down = (2.0 * fall / EARTH.y).sqrt();
    let top = down * (1.0 + e);
    simulation.advance(top).unwrap();
    let height = 390.0 - simulation.balls()[0].position().y;
    assert!((height - fall * e * e).abs() < 1e-3 * fall, "{height}");
    let rest = down * (1.0 + e) / (1.0 - e);
    simulation.advance(rest - top - 0.1).unwrap();
    assert!(simulation.balls()[0].velocity().length() > 1.0);
    simulation.advance(0.2).unwrap();
    assert_eq!(simulation.balls()[0].velocity(), DVec2::ZERO);
    assert_eq!(simulation.balls()[0].position().y, 390.0);
}

#[test]
fn a_bullet_passes_through_nothing_at_any_speed() {
    for speed in [1e3, 1e4, 1e5, 1e6, 1e8] {
        // A row of light discs across its way: it must move the first of them, whatever the substep.
        let mut balls = vec![moving(ball(30.0, 200.0, 3.0), speed, 0.0)];
        balls
            .extend((0..5).map(|k| ball(400.0 + 100.0 * f64::from(k), 200.0, 20.0).with_mass(50.0).unwrap()));
        for mut simulation in both_ways(&simulation(world(1000.0, 400.0, 1.0), balls)) {
            let start = energy(&simulation);
            let mut order_kept = true;
            for _ in 0..60 {
                simulation.advance(FRAME).unwrap();
                assert!(max_wall_overlap(simulation.world(), simulation.balls()) < 1e-9);
                // All on one line, and none can go round another.
                let xs: Vec<f64> = simulation.balls().iter().map(|ball| ball.position().x).collect();
                order_kept &= xs.windows(2).all(|pair| pair[0] < pair[1]);
            }
            assert!(order_kept, "{speed}");
            assert!((energy(&simulation) / start - 1.0).abs() < 1e-9, "{speed}");
            assert!(simulation.tally().impacts > 0);
        }
    }
}

/// Galperin's billiard (2003): ⌊π·10ⁿ⌋ impacts, the wall's included, where the heavy ball has 100ⁿ times the light one's mass.
/// More than n = 4 are more than a substep takes: time goes more slowly then for those two, and they stay in their order.
#[test]
fn a_light_ball_turns_a_heavy_one_back_before_the_wall_whatever_its_mass() {
    for (mass, impacts) in
        [(1e4, Some(314)), (1e6, Some(3141)), (1e8, Some(31415)), (1e12, None), (1e18, None)]
    {
        let heavy = ball(350.0, 50.0, 10.0).with_mass(mass).unwrap();
        let balls = vec![ball(30.0, 50.0, 10.0), moving(heavy, -200.0, 0.0)];
        for mut simulation in both_ways(&simulation(world(400.0, 100.0, 1.0), balls)) {
            let start = energy(&simulation);
            for frame in 0..240 {
                simulation.advance(FRAME).unwrap();
                let [light, heavy] = simulation.balls() else { panic!("there are two balls") };
                let gap = heavy.position().x - light.position().x - 20.0;
                assert!(gap > -1e-6, "{mass:e}, frame {frame}: {gap} px between them");
                assert!((energy(&simulation) / start - 1.0).abs() < 1e-9, "{mass:e}, frame {frame}");
                // Until it is back at the wall on the other side.
                if heavy.velocity().x > 0.0 && heavy.position().x > 380.0 {
                    break;
                }
            }
            let tally = simulation.tally();
            if let Some(impacts) = impacts {
                assert_eq!(tally.impacts + tally.wall_hits, impacts, "{mass:e}");
            }
        }
    }
}

#[test]
fn a_heavy_ball_that_falls_on_a_light_one_gains_nothing_and_does_not_pass_it() {
    for e in [1.0, 0.9] {
        for (mass, others) in [1e2, 1e4, 1e6, 1e8, 1e10, 1e12].into_iter().flat_map(|m| [(m, 0), (m, 50)]) {
            let heavy = moving(ball(50.0, 300.0, 10.0).with_mass(mass).unwrap(), 0.0, 200.0);
            let mut balls = vec![ball(50.0, 485.0, 10.0), heavy];
            balls.extend(
                (0..others)
                    .map(|k| ball(200.0 + f64::from(k % 10 * 30), 100.0 + f64::from(k / 10 * 30), 10.0)),
            );
            let balls = balls.into_iter().map(|ball| ball.with_restitution(e).unwrap()).collect();
            let world = world(600.0, 500.0, e).with_gravity(EARTH).unwrap();
            for mut simulation in both_ways(&simulation(world, balls)) {
                let start = energy(&simulation);
                for frame in 0..600 {
                    simulation.advance(FRAME).unwrap();
                    let now = energy(&simulation) / start;
                    assert!(now < 1.01, "{mass:e} beside {others}, restitution {e}, frame {frame}: {now}");
                    if (mass, e) == (1e2, 1.0) && others == 0 {
                        assert!(now > 0.9999, "frame {frame}: {now}");
                    }
                    let [light, heavy, ..] = simulation.balls() else { panic!("there are two balls") };
                    let gap = light.position().y - heavy.position().y - 20.0;
                    assert!(gap > -0.2, "{mass:e} beside {others}, restitution {e}, frame {frame}: {gap} px");
                }
            }
        }
    }
}

#[test]
fn a_ball_that_has_come_to_rest_on_the_floor_meets_it_no_more_whatever_gravity() {
    for pull in (4..=40).map(|k| 49.0 * f64::from(k)) {
        let under = world(1280.0, 720.0, 0.8).with_gravity(DVec2::new(0.0, pull)).unwrap();
        let balls =
            vec![moving(ball(100.0, 710.0, 10.0), 20.0, 0.0), moving(ball(300.0, 650.0, 10.0), 20.0, 0.0)];
        for mut bouncing in both_ways(&simulation(under, balls)) {
            bouncing.advance(12.0).unwrap();
            let hits = bouncing.tally().wall_hits;
            for _ in 0..60 {
                bouncing.advance(FRAME).unwrap();
                for ball in bouncing.balls() {
                    assert_eq!(ball.velocity(), DVec2::new(20.0, 0.0), "under {pull} px/s²");
                    assert!((ball.position().y - 710.0).abs() < 1e-9, "under {pull} px/s²");
                }
            }
            assert_eq!(bouncing.tally().wall_hits, hits, "under {pull} px/s²");
            // One that fell 60 px comes to the speed below which impacts are not counted after so many.
            let landing = (2.0 * pull * 60.0).sqrt();
            let law = (landing.ln() / -0.8_f64.ln()).floor() as u64 + 1;
            assert!(hits.abs_diff(law) <= 1, "{hits} impacts under {pull} px/s², not {law}");
        }
    }
}

/// Where nothing carries balls, what they all have in common counts as no speed; where something does, it does. Two thirds went
/// through.
#[test]
fn what_drifts_goes_through_no_row_of_fixed_balls_that_is_put_in_its_way() {
    for speed in [1000.0, 10_000.0] {
        let place = |k: u32| DVec2::new(f64::from(k % 8), f64::from(k / 8)) * 10.5;
        let drifting = (0..48).map(|k| {
            let place = place(k) + 100.0;
            moving(ball(place.x, place.y, 5.0), speed, 0.0).with_restitution(0.0).unwrap()
        });
        let space = World::new(DVec2::splat(500.0)).unwrap().with_pairs(Pairs::Impulse);
        for mut cloud in both_ways(&simulation(space, drifting.collect())) {
            cloud.advance(FRAME).unwrap();
            let wall = cloud.balls().iter().map(|ball| ball.position().x).fold(0.0, f64::max) + 60.0;
            let row: Vec<Ball> = (0..40).map(|k| ball(wall, 10.0 * f64::from(k), 6.0).fixed()).collect();
            cloud.add(&row).unwrap();
            for frame in 0..60 {
                cloud.advance(FRAME).unwrap();
                // Those that fly away past the ends of the row may go on.
                let through =
                    |ball: &&Ball| ball.position().x > wall && (0.0..390.0).contains(&ball.position().y);
                let through = cloud.balls()[..48].iter().filter(through).count();
                assert_eq!(through, 0, "{speed} px/s, frame {frame}");
            }
        }
    }
}

/// A hundred million times as heavy, it comes so near to the wall with the light one in between that a substep does not take all
/// of their impacts. They lose time then, and what is elsewhere does not: all fast balls stood still meanwhile.
/// Each was near more than sixty-four others on its way, of which the rest were left out.
#[test]
fn of_many_that_are_fast_none_is_ever_deep_in_a_fixed_ball() {
    let mut number = random(3);
    for _ in 0..4 {
        let row = (0..27).map(|k| ball(15.0 * f64::from(k), 300.0, 10.0).fixed());
        let above = (0..160_u32).map(|k| {
            let at = DVec2::new(15.0 + 24.0 * f64::from(k % 16), 15.0 + 26.0 * f64::from(k / 16));
            moving(ball(at.x, at.y, 6.0), 2e5 * number() - 1e5, 2e5 * number() - 1e5)
        });
        let balls: Vec<_> = row.chain(above).collect();
        let mut closed = simulation(world(390.0, 600.0, 0.5).with_gravity(EARTH).unwrap(), balls);
        for _ in 0..200 {
            closed.advance(1.0 / 4096.0).unwrap();
            let (row, flying) = closed.balls().split_at(27);
            let nearest = |ball: &Ball| {
                let to = row.iter().map(|fixed| fixed.position().distance(ball.position()));
                to.fold(f64::INFINITY, f64::min)
            };
            let nearest = flying.iter().map(nearest).fold(f64::INFINITY, f64::min);
            assert!(nearest > 15.0, "{nearest} px from a centre after {} s", closed.time());
        }
    }
}

#[test]
fn a_jam_costs_no_time_where_it_is_not() {
    let light = ball(20.0, 100.0, 5.0);
    let heavy = moving(ball(200.0, 100.0, 20.0), -500.0, 0.0).with_mass(1e8).unwrap();
    let (height, speed, radius) = (200.0, 7000.0, 5.0);
    let fast = moving(ball(1500.0, radius, radius), 0.0, speed);
    for gravity in [0.0, 1e-9] {
        // Across the line on which two of them are, the light one would fall off it.
        let world = world(2000.0, height, 1.0).with_gravity(DVec2::new(gravity, 0.0)).unwrap();
        let begun = simulation(world, vec![light, heavy, fast]);
        for mut simulation in both_ways(&begun) {
            for frame in 1..=60 {
                simulation.advance(FRAME).unwrap();
                // Unfolded at the walls.
                let (way, room) = (speed * FRAME * f64::from(frame), height - 2.0 * radius);
                let from_turn = way.rem_euclid(2.0 * room);
                let law = radius + from_turn.min(2.0 * room - from_turn);
                let y = simulation.balls()[2].position().y;
                assert!((y - law).abs() < 1e-3, "frame {frame}: {y} for {law}");
            }
            assert!(simulation.balls()[1].velocity().x > 0.0, "it was turned back");
        }
    }
}

/// It was not fast when the substep began, so that no room was looked for: it ended in another one, 2.6 of its radii deep.
#[test]
fn what_becomes_fast_in_a_substep_of_a_jam_ends_in_no_other() {
    let places = [
        (175.419_476_471_996_18, 109.337_089_084_926_78, 3.770_813_485_509_162),
        (312.568_775_330_064_7, 74.537_139_674_950_2, 71.686_494_534_692_49),
        (546.578_938_945_367_2, 40.703_937_591_731_865, 1.048_739_794_336_077_4),
        (347.957_807_945_292_2, 222.930_579_920_820_86, 1.878_811_911_816_329_8),
        (76.796_890_162_570_83, 77.866_529_179_093_06, 56.393_356_216_442_54),
    ];
    let velocities = [
        (-895.501_368_037_201, 28.200_213_591_875_652),
        (7_337.375_513_671_24, 15_371.277_371_662_874),
        (154.298_853_153_914_48, -195.659_967_646_995_46),
        (-386.279_273_927_959_1, 223.755_180_220_072_76),
        (11_519.448_310_277_401, -6_843.767_823_360_492),
    ];
    let balls = places.iter().zip(velocities).map(|(&(x, y, radius), (along, down))| {
        let ball = moving(ball(x, y, radius), along, down).with_restitution(0.9).unwrap();
        ball.with_mass(radius * radius).unwrap()
    });
    let world = world(611.458_242_846_804_6, 227.391_331_353_486_15, 0.5).with_gravity(EARTH).unwrap();
    for mut simulation in both_ways(&simulation(world, balls.collect())) {
        for substep in 1..=60 {
            simulation.advance(1.0 / 240.0).unwrap();
            assert!(overlap(&simulation) < 0.1, "{} after {substep}", overlap(&simulation));
        }
    }
}

#[test]
fn a_ball_that_meets_two_walls_at_once_hits_what_is_before_the_second() {
    // It meets the right wall at once, and would come to the floor in the same substep.
    let large = moving(ball(359.9, 340.0, 40.0), 1000.0, 6000.0);
    let small = ball(360.0, 397.0, 3.0);
    let mut corner = simulation(world(400.0, 400.0, 1.0).with_gravity(EARTH).unwrap(), vec![large, small]);
    corner.advance(1.0 / 240.0).unwrap();
    assert!(corner.tally().impacts > 0, "{:?}", corner.balls());
}

/// What pushed them all at once was taken for what throws balls, and most of it was taken away: among many, up to six tenths.
#[test]
fn a_row_that_is_hit_fast_without_restitution_keeps_its_momentum() {
    for (count, speed) in [(5, 2000.0), (5, 5000.0), (10, 2000.0), (10, 20_000.0)] {
        for others in [0, 60] {
            let mut balls = vec![moving(ball(200.0, 380.0, 20.0), speed, 0.0)];
            balls.extend((0..count).map(|k| ball(245.0 + 40.1 * f64::from(k), 380.0, 20.0)));
            balls.extend((0..others).map(|k| ball(2500.0 + 45.0 * f64::from(k), 380.0, 20.0)));
            let balls = balls.into_iter().map(|ball| ball.with_restitution(0.0).unwrap()).collect();
            let mut hit = simulation(world(6000.0, 400.0, 0.5).with_gravity(EARTH).unwrap(), balls);
            hit.advance(0.05).unwrap();
            let row = &hit.balls()[..=count as usize];
            let (each, all) = (speed / f64::from(count + 1), momentum(row).x);
            let what = format!("{count} hit at {speed} px/s, {others} others");
            assert!((all / speed - 1.0).abs() < 0.02, "{what}: {all} of it is left");
            for ball in row {
                let now = ball.velocity().x;
                assert!((now / each - 1.0).abs() < 0.15, "{what}: {now}, not {each}");
            }
        }
    }
}
