//! Balls of very different masses where they hold each other.

use super::*;

#[test]
fn a_wide_heavy_ball_squeezes_no_two_of_the_pile_that_it_lies_on_into_each_other() {
    let fill = "count = 2500\nradius = 4\nrestitution = 0.3\nregion = [0, 150, 600, 550]\n";
    let text = format!("size = [600, 550]\ngravity = [0, 980]\n[walls]\n[pairs]\n[[fill]]\n{fill}");
    let mut simulation = Scene::parse("bed", &text).unwrap().with_solver(Solver::Contact).build().unwrap();
    let run = |simulation: &mut Simulation, seconds: usize| {
        (0..60 * seconds).for_each(|_| simulation.advance(FRAME).unwrap());
    };
    run(&mut simulation, 4);
    // As wide as some stripes, and of ten times the mass of all others.
    let heavy = ball(300.0, 60.0, 50.0).with_mass(2.5e4).unwrap().with_restitution(0.0).unwrap();
    simulation.add(&[heavy]).unwrap();
    for _ in 0..2 {
        run(&mut simulation, 5);
        assert!(overlap(&simulation) < 0.1, "{}", overlap(&simulation));
    }
}

/// When a ball of so many times the density of the 300 that it lies on has come through them to the floor, s.
fn time_to_the_floor(density: f64, seed: u64) -> f64 {
    let fill = format!("count = 300\nradius = [4, 6]\nmass = 1\nrestitution = 0.5\nseed = {seed}\n");
    let text = format!(
        "size = [200, 400]\ngravity = [0, 980]\n[walls]\nrestitution = 0.5\n[pairs]\n[[fill]]\n{fill}"
    );
    let bed = Scene::parse("bed", &text).unwrap().with_solver(Solver::Contact);
    let mut simulation = bed.build().unwrap();
    simulation.advance(5.0).unwrap();
    let heavy = ball(100.0, 180.0, 18.0).with_mass(13.0 * density).unwrap().with_restitution(0.5).unwrap();
    simulation.add(&[heavy]).unwrap();
    let at_floor = |simulation: &Simulation| simulation.balls()[300].position().y > 400.0 - 18.0 - 3.0;
    let frames = (1..=1200).find(|_| simulation.advance(FRAME).is_ok() && at_floor(&simulation));
    frames.map_or(f64::INFINITY, |frames| f64::from(frames) * FRAME)
}

/// It took a quarter of a minute, or stayed on them.
#[test]
fn a_heavy_ball_sinks_through_light_ones_to_the_floor() {
    for (density, most) in [(1e2, 6.2), (1e3, 4.0)] {
        let mut times = [1, 2, 3, 4, 5, 6, 7, 8].map(|seed| time_to_the_floor(density, seed));
        times.sort_by(f64::total_cmp);
        // Two of 120 stay on the last layer for ever, pressed sideways by what lies around it.
        assert!(times[..7].iter().sum::<f64>() < 7.0 * most, "{density}: {times:?} s");
    }
}

/// Thousands were held as unlike ones are where any two differed, wherever they were: that never came to rest.
#[test]
fn a_light_ball_does_not_keep_thousands_from_rest() {
    let mut simulation = pile(4500);
    let size = simulation.world().size();
    simulation.add(&[ball(0.5 * size.x, 20.0, 5.0).with_mass(1.0).unwrap()]).unwrap();
    (0..60 * 8).for_each(|_| simulation.advance(FRAME).unwrap());
    assert!(fastest(&simulation) == 0.0 && overlap(&simulation) < 0.06, "{}", overlap(&simulation));
}

/// A box of this size with balls of two kinds: how many, their radius and mass, and a seed for their places.
fn two_kinds([width, height]: [u32; 2], kinds: [(u32, u32, f64, u32); 2]) -> Simulation {
    let fills = kinds.map(|(count, radius, mass, seed)| {
        format!(
            "[[fill]]\ncount = {count}\nradius = {radius}\nmass = {mass}\nrestitution = 0.7\nseed = {seed}\n"
        )
    });
    filled([width, height], &fills.concat())
}

/// A box of this size under gravity with what these tables of a scene file say.
fn filled([width, height]: [u32; 2], fills: &str) -> Simulation {
    let text = format!(
        "solver = \"contact\"\nsize = [{width}, {height}]\ngravity = [0, 980]\n[walls]\nrestitution = 0.7\n[pairs]\n{fills}"
    );
    Scene::parse("mixed", &text).unwrap().build().unwrap()
}

/// They ended up in one place, by twos, squeezed by what they could not push aside; in one of four piles for ever.
#[test]
fn light_balls_among_large_and_heavy_ones_do_not_end_up_in_each_other() {
    for seed in [1, 2, 8, 23] {
        let mut pile = two_kinds([400, 300], [(60, 9, 1e4, seed), (500, 5, 1.0, seed + 100)]);
        pile.advance(25.0).unwrap();
        assert_eq!(fastest(&pile), 0.0, "seed {seed}");
        assert!(overlap(&pile) < 0.05, "seed {seed}: {}", overlap(&pile));
    }
}

/// They lay in each other, and rattled for ever: what light ones pass on from one heavy ball to another is found in steps of
/// their own mass.
#[test]
fn light_balls_between_heavy_ones_come_to_rest_beside_them() {
    for ratio in [1e2, 1e3, 1e4, 1e6] {
        let mut pile = two_kinds([324, 182], [(150, 5, 1.0, 1), (150, 5, ratio, 1001)]);
        let at_rest = (0..1800).any(|_| {
            pile.advance(FRAME).is_ok() && pile.balls().iter().all(|ball| ball.velocity() == DVec2::ZERO)
        });
        assert!(at_rest, "{ratio}: {} px/s after {} s", fastest(&pile), pile.time());
        assert!(overlap(&pile) < 0.05, "{ratio}: {}", overlap(&pile));
    }
}

/// A pile of balls of radius 6 to 12 whose masses, whatever their sizes, span four powers of ten.
fn mixed_pile(seed: u64) -> Simulation {
    let mut random = numbers::random(seed);
    let balls = (0..300_u32).map(|k| {
        let (radius, mass) = (6.0 + 6.0 * random(), 10.0_f64.powf(4.0 * (random() - 0.5)));
        let (column, row) = (f64::from(k % 20), f64::from(k / 20));
        let ball = ball(20.0 + 30.0 * column + 2.0 * random(), 20.0 + 30.0 * row, radius);
        ball.with_mass(mass).unwrap().with_restitution(0.5).unwrap()
    });
    simulation(world(640.0, 480.0, 0.5).with_gravity(EARTH).unwrap(), balls.collect())
}

/// What held light balls between heavy ones threw them, and each substep again: up to a sixth of all energy in a frame.
#[test]
fn a_pile_whose_masses_do_not_follow_its_sizes_gets_no_energy_from_nowhere() {
    for seed in [3, 11, 37, 41, 45, 51] {
        let mut pile = mixed_pile(seed);
        let start = energy(&pile);
        let mut before = start;
        for frame in 0..900 {
            pile.advance(FRAME).unwrap();
            let now = energy(&pile);
            // Balls that are moved out of each other are lifted.
            assert!(now < before + 5e-3 * start, "seed {seed}, frame {frame}: {before} rises to {now}");
            before = now;
        }
    }
}

/// Light balls that heavy ones press on kept all fast ones where they were, in each substep again, for ever; in the fourth and the
/// fifth, one that had no room for long was kept where it was, and nothing else could move; in the last two, balls fell asleep out
/// of balance, and woke of it.
#[test]
fn piles_whose_masses_span_eight_powers_of_ten_come_to_rest() {
    for seed in [24, 42, 98, 80, 97, 27, 111] {
        let fill = |decade: i32| {
            let (mass, seed) = (10_f64.powi(decade), seed + 1000 * (decade + 4));
            format!(
                "[[fill]]\ncount = 33\nradius = [3, 12]\nmass = {mass}\nrestitution = 0.7\nseed = {seed}\n"
            )
        };
        let fills: String = (-4..=4).map(fill).collect();
        let mut pile = filled([640, 480], &fills);
        (0..1200).for_each(|_| pile.advance(FRAME).unwrap());
        assert_eq!(fastest(&pile), 0.0, "seed {seed}");
        assert!(overlap(&pile) < 0.02, "seed {seed}: {}", overlap(&pile));
    }
}

/// Where few balls press, sweeps ended before they knew what each bears: the balls hopped in each other for ever, at up to 250 px/s,
/// and some passed others.
#[test]
fn unlike_balls_that_fall_into_a_narrow_tube_come_to_rest_in_their_order() {
    for (seed, width) in (1..=6).zip([30.0, 30.0, 30.0, 34.0, 34.0, 34.0]) {
        let mut random = numbers::random(seed);
        let balls = (0..80_u32).map(|k| {
            let (x, y) = (10.0 + (width - 20.0) * random(), 2420.0 - 30.0 * f64::from(k));
            ball(x, y, 10.0).with_mass(1e3_f64.powf(random())).unwrap().with_restitution(0.5).unwrap()
        });
        let mut tube = simulation(world(width, 2430.0, 0.5).with_gravity(EARTH).unwrap(), balls.collect());
        tube.advance(12.0).unwrap();
        assert_eq!(fastest(&tube), 0.0, "seed {seed}");
        assert!(overlap(&tube) < 0.04, "seed {seed}: {}", overlap(&tube));
        let heights: Vec<f64> = tube.balls().iter().map(|ball| -ball.position().y).collect();
        assert!(heights.is_sorted(), "seed {seed}: one has passed another");
    }
}

/// The small ones beside it counted as heavy, sank there, and lifted others that did not, round and round for ever.
#[test]
fn a_pile_around_a_ball_of_many_times_its_weight_comes_to_rest() {
    for (density, radius) in [(100.0, 100), (1000.0, 50), (1000.0, 100)] {
        let mass = density * f64::from(radius * radius);
        let mut pit = filled(
            [520, 700],
            &format!(
                "[[ball]]\nposition = [200, {radius}]\nradius = {radius}\nmass = {mass}\nrestitution = 0.5\n\
                 [[fill]]\ncount = 350\nradius = [6, 8]\ndensity = 0.3183\nrestitution = 0.5\nseed = 1\n\
                 region = [0, 300, 520, 700]\n"
            ),
        );
        pit.advance(15.0).unwrap();
        assert_eq!(fastest(&pit), 0.0, "of density {density}, radius {radius}");
        assert!(overlap(&pit) < 0.05, "of density {density}, radius {radius}: {}", overlap(&pit));
    }
}

/// A heavy ball on the floor, or two side by side, and a light one on top that slips off, or wedges them apart.
#[test]
fn what_lies_on_heavy_balls_gives_them_no_more_than_it_has() {
    for mass in [1e2, 1e4, 1e6] {
        let heavy = |x: f64| ball(x, 280.0, 20.0).with_mass(mass).unwrap().with_restitution(0.0).unwrap();
        let light = |x: f64, y: f64| ball(x, y, 20.0).with_restitution(0.0).unwrap();
        let slips = vec![light(308.0, 240.79), heavy(300.0)];
        let wedges = vec![light(300.0, 245.35), heavy(280.0), heavy(320.0)];
        for balls in [slips, wedges] {
            let world = world(600.0, 300.0, 0.5).with_gravity(EARTH).unwrap();
            let mut simulation = simulation(world, balls);
            let start = energy(&simulation);
            // What it has after it fell as far as it is wide; and what its weight gives each of two that it wedges apart, beside it.
            let fallen = (2.0 * EARTH.y * 40.0).sqrt();
            for _ in 0..120 {
                simulation.advance(FRAME).unwrap();
                let now = energy(&simulation);
                assert!(now < start, "{mass}: {now} after {start}");
                let (speed, now) = (simulation.balls()[1].velocity().length(), simulation.balls());
                let momentum = now.get(2).map_or(fallen, |other| {
                    let apart = (0.5 * (other.position().x - now[1].position().x)).min(39.0);
                    // The tangent grows as they part.
                    0.5 * EARTH.y * simulation.time() * apart / (40.0 * 40.0 - apart * apart).sqrt()
                });
                assert!(speed * mass < momentum, "{mass}: {speed} px/s");
            }
        }
    }
}

/// Between two heavy balls that come together in the air it is hit ever more often, and ever faster. What is left of its
/// hits is held; where it counted as a quarter of their mass then, their energy came out fourfold.
#[test]
fn a_light_ball_that_rattles_between_heavy_ones_gives_them_no_energy() {
    for (gap, tilt) in [3.0, 6.0].into_iter().flat_map(|gap| [-1.0, 0.0, 1.0].map(|tilt| (gap, tilt))) {
        let bed = (0..100).map(|k| ball(15.0 + 10.0 * f64::from(k % 100), 995.0, 5.0));
        let mut simulation =
            simulation(world(1030.0, 1000.0, 0.5).with_gravity(EARTH).unwrap(), bed.collect());
        simulation.advance(2.0).unwrap();
        let heavy = |x: f64, y: f64, speed: f64| moving(ball(x, y, 10.0), speed, 0.0).with_mass(1e4).unwrap();
        let (left, right) = (heavy(484.95, 200.0, 50.0), heavy(515.0 + gap, 200.0 + tilt, -50.0));
        simulation.add(&[left, ball(500.0, 200.0, 5.0), right]).unwrap();
        let start = energy(&simulation);
        for _ in 0..60 {
            simulation.advance(FRAME).unwrap();
            let now = energy(&simulation);
            // Of their motion towards each other, which is a small part of all.
            assert!(now < start + 0.01 * 1e4 * 50.0 * 50.0, "{gap}, {tilt}: {now} after {start}");
        }
    }
}

/// It counts as no less than a quarter as dense as they: what falls with it weighs no more than it does. They came apart with
/// up to seven times the energy that all began with.
#[test]
fn a_light_ball_that_drives_heavy_ones_apart_gives_them_no_more_energy_than_it_has() {
    for (light, restitution) in
        [0.2, 0.5, 1.0, 3.0, 10.0].into_iter().flat_map(|mass| [(mass, 0.0), (mass, 0.5)])
    {
        let on_floor = |x: f64| ball(x, 290.0, 10.0).with_mass(25.0).unwrap();
        let lies = |x: f64, y: f64| ball(x, y, 22.0).with_mass(light).unwrap();
        let between_two = vec![on_floor(180.0), on_floor(220.0), lies(200.0, 265.0)];
        let at_the_wall = vec![on_floor(40.0), lies(22.0, 263.5)];
        for balls in [between_two, at_the_wall] {
            let balls = balls.into_iter().map(|ball| ball.with_restitution(restitution).unwrap()).collect();
            let begun = simulation(world(400.0, 300.0, restitution).with_gravity(EARTH).unwrap(), balls);
            for mut simulation in both_ways(&begun) {
                let mut least = energy(&simulation);
                for frame in 0..180 {
                    simulation.advance(FRAME).unwrap();
                    let now = energy(&simulation);
                    assert!(now < 1.01 * least, "{light}, {restitution}, frame {frame}: {now} after {least}");
                    least = least.min(now);
                }
            }
        }
    }
}

/// It counts as heavier there, but nothing holds it.
#[test]
fn a_light_ball_that_flies_by_a_heavy_one_or_off_it_goes_as_in_exact() {
    let heavy = |x: f64, y: f64, radius: f64, speed: f64| {
        moving(ball(x, y, radius), 0.0, speed).with_mass(1e6).unwrap()
    };
    let by = (vec![ball(357.5, 215.0, 5.0), heavy(300.0, 250.0, 50.0, 0.0)], 0.38);
    let off = (vec![moving(ball(100.0, 100.0, 5.0), 0.0, 150.0), heavy(100.0, 84.0, 10.0, 200.0)], 0.3);
    for (balls, seconds) in [by, off] {
        let world = world(600.0, 300.0, 0.5).with_gravity(EARTH).unwrap();
        let after = |solver: Solver| {
            let mut simulation = Simulation::new(world, balls.clone(), solver).unwrap();
            simulation.advance(seconds).unwrap();
            simulation.balls()[0]
        };
        let (contact, exact) = (after(Solver::Contact), after(Solver::Exact));
        assert!(contact.position().distance(exact.position()) < 1e-3, "{contact:?}, {exact:?}");
        assert!(contact.velocity().distance(exact.velocity()) < 1e-2, "{contact:?}, {exact:?}");
    }
}

/// What had to go up for want of room pays for that with its speed. Where it does not, these get 4 to 46 % of their energy back.
#[test]
fn lively_balls_whose_masses_span_six_powers_of_ten_get_little_energy_from_where_they_find_room() {
    for seed in [2, 3, 5, 8] {
        let mut text =
            String::from("size = [170, 170]\ngravity = [0, 980]\n[walls]\nrestitution = 0.5\n[pairs]\n");
        for decade in 0..7 {
            text += &format!(
                "[[fill]]\ncount = 9\nradius = [3, 9]\nmass = {}\nrestitution = 0.95\nseed = {}\n",
                10_f64.powi(decade - 3),
                8 * seed + decade
            );
        }
        let mut simulation =
            Scene::parse("lively", &text).unwrap().with_solver(Solver::Contact).build().unwrap();
        let start = energy(&simulation);
        let back = rise(&mut simulation, 360) / start;
        // Measured: at most 2 %.
        assert!(back < 0.03, "seed {seed}: {back:e} of it came back");
    }
}

/// What four balls in a row on an elastic floor, between walls that just leave room for them, gave each other across the row was next to
/// nothing; but each hop began with the speed in the middle of a substep: up to 9 px/s, where none had begun with 1.
#[test]
fn unlike_balls_in_a_row_that_fits_hop_no_higher_on_an_elastic_floor_than_they_began() {
    let (radius, floor) = (8.479_868_984_424_785, 50.879_213_906_548_71);
    let places = [8.479_868_984_424_785, 25.439_606_953_274_357, 42.399_344_922_123_92, 59.359_082_890_973_5];
    let velocities = [(0.497, 0.553), (-0.524, -0.28), (-0.691, -0.901), (-0.081, 0.271)];
    let balls: Vec<Ball> = (0..4)
        .map(|k| {
            let (ball, (x, y)) = (ball(places[k], floor, radius), velocities[k]);
            let mass = [19.0, 0.342, 0.07, 32.1][k];
            moving(ball, x, y).with_restitution(0.2).unwrap().with_mass(mass).unwrap()
        })
        .collect();
    let mass: f64 = balls.iter().map(Ball::mass).sum();
    let world = world(67.838_951_875_398_28, 59.359_082_890_973_5, 1.0).with_gravity(EARTH).unwrap();
    let mut row = simulation(world, balls);
    let mut most = 0.0_f64;
    for _ in 0..600 {
        row.advance(FRAME).unwrap();
        most = most.max(energy(&row));
    }
    // One that touches others is shown with its speed in the middle of a substep: up to half a kick of gravity, 2 px/s, more than it has.
    let speed = (2.0 * most / mass).sqrt();
    assert!(speed < 3.0, "{speed} px/s");
}
