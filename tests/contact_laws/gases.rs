//! Balls that fly and hit each other: their energy and momentum, and that none lies in another.

use super::*;

#[test]
fn an_elastic_gas_keeps_its_energy_and_leaves_no_overlap() {
    let text =
        "size = [400, 400]\n[walls]\n[pairs]\n[[fill]]\ncount = 300\nradius = [3, 8]\nspeed = [0, 300]\n";
    let scene = Scene::parse("gas", text).unwrap().with_solver(Solver::Contact);
    for mut simulation in both_ways(&scene.build().unwrap()) {
        let start = energy(&simulation);
        for _ in 0..600 {
            simulation.advance(FRAME).unwrap();
            assert!((energy(&simulation) / start - 1.0).abs() < 1e-9);
        }
        assert!(simulation.tally().impacts > 10_000);
        assert!(max_wall_overlap(simulation.world(), simulation.balls()) < 1e-9);
        assert!(overlap(&simulation) < 1e-9, "{}", overlap(&simulation));
    }
}

#[test]
fn elastic_balls_that_hardly_have_room_hit_each_other_however_often_and_lie_in_none() {
    // Neighbours a thousandth of a diameter apart, each hit some ten times in a substep.
    let (side, pitch) = (16_u32, 6.0 * 1.001);
    let rise = pitch * 0.75_f64.sqrt();
    let place = |k: u32| {
        let (column, row) = (f64::from(k % side), f64::from(k / side));
        let turn = DVec2::from_angle(2.4 * f64::from(k));
        let at = ball(3.003 + pitch * (column + 0.5 * (row % 2.0)), 3.003 + rise * row, 3.0);
        moving(at, 10.0 * turn.x, 10.0 * turn.y)
    };
    let height = 6.0 + rise * f64::from(side - 1) + 0.006;
    let world = world(pitch * (f64::from(side) + 0.5), height, 1.0);
    for mut simulation in both_ways(&simulation(world, (0..side * side).map(place).collect())) {
        let start = energy(&simulation);
        for _ in 0..24 {
            simulation.advance(1.0 / 240.0).unwrap();
            assert!(overlap(&simulation) < 1e-9, "{:e}", overlap(&simulation));
            assert!((energy(&simulation) / start - 1.0).abs() < 1e-12);
        }
        let impacts = simulation.tally().impacts;
        assert!(impacts > 24 * 5 * u64::from(side * side), "{impacts}");
    }
}

#[test]
fn thousands_of_elastic_balls_keep_their_energy_and_get_their_momentum_from_the_walls_alone() {
    let text =
        "size = [1300, 1200]\n[walls]\n[pairs]\n[[fill]]\ncount = 3000\nradius = [3, 8]\nspeed = [0, 300]\n";
    let scene = Scene::parse("gas", text).unwrap().with_solver(Solver::Contact);
    for mut simulation in both_ways(&scene.build().unwrap()) {
        let (start, before) = (energy(&simulation), momentum(simulation.balls()));
        let scale: f64 = simulation.balls().iter().map(|ball| ball.mass() * 300.0).sum();
        for _ in 0..200 {
            simulation.advance(FRAME).unwrap();
            assert!((energy(&simulation) / start - 1.0).abs() < 1e-9);
            let from_walls = before + simulation.tally().wall_impulse;
            assert!((momentum(simulation.balls()) - from_walls).length() < 1e-9 * scale);
        }
        assert!(simulation.tally().impacts > 30_000);
        assert!(max_wall_overlap(simulation.world(), simulation.balls()) < 1e-9);
        assert!(overlap(&simulation) < 1e-9, "{}", overlap(&simulation));
    }
}

#[test]
fn thousands_of_balls_in_a_substep_meet_each_other_in_the_order_of_time_as_with_exact() {
    let fill = "[[fill]]\ncount = 4000\nradius = [2, 6]\nspeed = [0, 300]";
    let cases = [
        ("elastic", 800.0, fill.to_owned()),
        ("granular", 800.0, format!("{fill}\nrestitution = 0.95")),
        // Stripes are narrower than this one: what it meets belongs to none of them.
        (
            "giant",
            950.0,
            format!("[[ball]]\nposition = [450, 300]\nradius = 150\nvelocity = [200, 50]\n{fill}"),
        ),
        (
            "bullet",
            800.0,
            format!("[[ball]]\nposition = [450, 300]\nradius = 5\nvelocity = [9000, 5000]\n{fill}"),
        ),
        ("fast", 900.0, "[[fill]]\ncount = 3000\nradius = [2, 6]\nspeed = [0, 2000]".to_owned()),
        ("fixed", 850.0, format!("[[ball]]\nposition = [450, 300]\nradius = 90\nfixed = true\n{fill}")),
    ];
    let peg = |k: u32| {
        format!(
            "[[ball]]\nposition = [{}, {}]\nradius = 6\nfixed = true\n",
            20 + k % 23 * 40,
            20 + k / 23 * 40
        )
    };
    let pegs: String = (0..345).map(peg).collect();
    for (case, width, balls) in cases.into_iter().chain([("pegs", 920.0, pegs + fill)]) {
        let text = format!("size = [{width}, 600]\n[walls]\n[pairs]\n{balls}");
        let scene = Scene::parse(case, &text).unwrap().with_solver(Solver::Contact);
        let mut simulation = scene.build().unwrap().with_substeps(240).unwrap();
        let mut all = 0;
        for substep in 0..24 {
            let (world, balls) = (*simulation.world(), simulation.balls().len());
            let mut exact = Simulation::new(world, simulation.balls().to_vec(), Solver::Exact).unwrap();
            let before = simulation.tally();
            // On their way, too, wherever in the substep they are looked at.
            let look = f64::from(1 + substep) / 25.0 / 240.0;
            let mut touching = [vec![false; balls], vec![false; balls]];
            for part in [look, 1.0 / 240.0 - look] {
                simulation.advance(part).unwrap();
                exact.advance(part).unwrap();
                let (apart, faster) = apart(&simulation, &exact);
                assert!(apart < 1e-6, "{case}, substep {substep}: {apart} px from where exact has it");
                assert!(faster < 1e-4, "{case}, substep {substep}: by {faster} px/s");
                for (touching, simulation) in touching.iter_mut().zip([&simulation, &exact]) {
                    touching.iter_mut().zip(simulation.touching()).for_each(|(all, now)| *all |= now);
                }
            }
            let impacts = simulation.tally().impacts - before.impacts;
            assert_eq!(impacts, exact.tally().impacts, "{case}, substep {substep}");
            assert_eq!(simulation.tally().wall_hits - before.wall_hits, exact.tally().wall_hits);
            assert!(touching[0] == touching[1], "{case}, substep {substep}");
            assert!(overlap(&simulation) < 1e-9, "{case}, substep {substep}: {}", overlap(&simulation));
            all += impacts;
        }
        assert!(all > 6000, "{case} is too thin: {all} impacts");
    }
}

#[test]
fn without_gravity_balls_go_from_impact_to_impact_as_with_exact_to_the_bit() {
    let fill = "radius = [2, 6]\nspeed = [0, 300]";
    for (case, balls) in [
        ("thin", format!("[[fill]]\ncount = 200\n{fill}\nrestitution = 0.5")),
        ("dense", format!("[[fill]]\ncount = 1500\n{fill}\nrestitution = 0.8")),
        (
            "mixed",
            format!(
                "[[fill]]\ncount = 200\n{fill}\nrestitution = 0\n[[fill]]\ncount = 200\n{fill}\nmass = 100\nrestitution = 0.9"
            ),
        ),
    ] {
        let text = format!("size = [500, 400]\n[walls]\nrestitution = 0.7\n[pairs]\n{balls}");
        let scene = Scene::parse(case, &text).unwrap();
        let [mut contact, mut exact] =
            [Solver::Contact, Solver::Exact].map(|solver| scene.clone().with_solver(solver).build().unwrap());
        let start = energy(&contact);
        for frame in 0..600 {
            contact.advance(FRAME).unwrap();
            exact.advance(FRAME).unwrap();
            assert!(contact.balls() == exact.balls(), "{case}, frame {frame}");
        }
        assert!(contact.tally() == exact.tally() && contact.tally().impacts > 400, "{case}");
        assert!(energy(&contact) < 0.1 * start, "{case}");
        assert!(overlap(&contact) < 1e-9, "{case}: {}", overlap(&contact));
    }
}

#[test]
fn momentum_is_kept_where_nothing_holds_the_balls() {
    let text = "size = [400, 400]\n[pairs]\n[[fill]]\ncount = 200\nradius = [3, 8]\nspeed = 300\nrestitution = 0.5\n";
    let scene = Scene::parse("cloud", text).unwrap().with_solver(Solver::Contact);
    for mut simulation in both_ways(&scene.build().unwrap()) {
        let scale: f64 = simulation.balls().iter().map(|ball| ball.mass() * 300.0).sum();
        let start = momentum(simulation.balls());
        for _ in 0..120 {
            simulation.advance(FRAME).unwrap();
        }
        assert!(simulation.tally().impacts > 50);
        assert!((momentum(simulation.balls()) - start).length() < 1e-12 * scale);
    }
}

#[test]
fn balls_of_a_fast_gas_are_never_in_each_other_at_the_end_of_a_substep() {
    // Each goes nearly three radii in a substep, in which a hundred others may come near.
    for (restitution, speed) in [(1.0, 2000.0), (0.95, 5000.0)] {
        let balls = (0..300).map(|k| {
            let ball = ball(11.0 * f64::from(k % 18) + 6.0, 11.0 * f64::from(k / 18) + 6.0, 3.0);
            let turn = f64::from(k) * 2.3;
            moving(ball.with_restitution(restitution).unwrap(), speed * turn.cos(), speed * turn.sin())
        });
        let gas = simulation(world(206.0, 206.0, 1.0), balls.collect());
        let mut gas = gas.with_substeps(240).unwrap();
        for substep in 0..120 {
            gas.advance(1.0 / 240.0).unwrap();
            let deepest = overlap(&gas);
            assert!(deepest < 1e-6, "restitution {restitution}, substep {substep}: {deepest} of a radius");
        }
    }
}

#[test]
fn elastic_balls_that_a_wall_sweeps_together_have_few_impacts_in_a_substep() {
    // Half of them lie in a strip along the wall, deep in others.
    let balls = (0..3000).map(|k| {
        let (k, column, row) = (f64::from(k), f64::from(k % 75), f64::from(k / 75));
        let place = if k % 2.0 == 0.0 {
            DVec2::new(3.0 + 0.01 * column, 7.0 * row + 5.0)
        } else {
            DVec2::new(8.0 * column + 12.0, 7.0 * row + 5.0)
        };
        moving(ball(place.x, place.y, 3.0), 200.0 * (1.7 * k).sin(), 200.0 * (2.3 * k).sin())
    });
    let mut simulation = simulation(world(640.0, 300.0, 1.0), balls.collect());
    let start = energy(&simulation);
    for _ in 0..20 {
        let before = simulation.tally().impacts;
        simulation.advance(1.0 / 240.0).unwrap();
        let impacts = simulation.tally().impacts - before;
        assert!(impacts < 4 * 3000, "{impacts} impacts");
        assert!((energy(&simulation) / start - 1.0).abs() < 1e-9);
    }
}

#[test]
fn thousands_of_elastic_balls_that_fall_upon_each_other_keep_their_energy_and_lie_in_none() {
    let text = "size = [700, 560]\ngravity = [0, 980]\n[walls]\n[pairs]\n[[fill]]\ncount = 3000\nradius = [2, 5]\nspeed = [0, 300]\n";
    let mut simulation = Scene::parse("fall", text).unwrap().with_solver(Solver::Contact).build().unwrap();
    let start = energy(&simulation);
    for frame in 0..60 {
        // Whether or not a substep is over.
        simulation.advance(0.9 * FRAME).unwrap();
        let energy = energy(&simulation) / start - 1.0;
        // Three that meet within a substep, or graze each other, may be held: how they go there is not known.
        assert!(energy.abs() < 1e-3, "frame {frame}: {energy}");
        simulation.advance(0.1 * FRAME).unwrap();
        assert!(overlap(&simulation) < 1e-9, "frame {frame}: {}", overlap(&simulation));
    }
    assert!(simulation.tally().impacts > 200_000);
    // What holds them has no restitution.
    assert!((energy(&simulation) / start - 1.0).abs() < 1e-6, "{}", energy(&simulation) / start - 1.0);
}

#[test]
fn elastic_balls_that_fall_and_bounce_in_a_box_keep_their_energy() {
    let mut changes: Vec<f64> = (0..10).map(elastic_box).collect();
    changes.sort_by(f64::total_cmp);
    // Three that meet at a wall within a substep, or graze each other there, may be held without restitution.
    assert!(changes[7] < 1e-13 && changes[9] < 1e-3, "{changes:?}");
}

/// By how much of itself the energy of thirty elastic balls changes in ten seconds in a box that they fill to two
/// fifths, px; each number is another game.
fn elastic_box(number: u32) -> f64 {
    let world = World::new(DVec2::splat(170.0)).unwrap().with_walls(1.0).unwrap();
    let world = world.with_gravity(DVec2::new(0.0, 980.0)).unwrap().with_pairs(Pairs::Impulse);
    let of = |k: u32| {
        let position = 15.0 + 28.0 * DVec2::new(f64::from(k % 6), f64::from(k / 6));
        let velocity = 150.0 * DVec2::from_angle(f64::from(2 * k + number));
        Ball::new(position, 10.0).unwrap().with_velocity(velocity).unwrap()
    };
    let mut simulation = Simulation::new(world, (0..30).map(of).collect(), Solver::Contact).unwrap();
    let start = energy(&simulation);
    (0..600).for_each(|_| simulation.advance(FRAME).unwrap());
    (energy(&simulation) / start - 1.0).abs()
}

#[test]
fn elastic_balls_that_begin_in_each_other_part_and_gain_nothing() {
    let pairs = [(100.0, 100.0), (100.0, 110.0), (100.0, 139.0)];
    for (one, other) in pairs {
        for speed in [0.0, 50.0] {
            let balls = vec![ball(one, 100.0, 20.0), moving(ball(other, 100.0, 20.0), 0.0, speed)];
            let mut parting = simulation(world(400.0, 400.0, 1.0), balls);
            let start = energy(&parting);
            (0..300).for_each(|_| parting.advance(FRAME).unwrap());
            assert!(overlap(&parting) < 1e-3, "{other} px, {speed} px/s: {}", overlap(&parting));
            assert!(energy(&parting) <= start * (1.0 + 1e-9), "{other} px, {speed} px/s");
            assert!(energy(&parting) >= start * (1.0 - 1e-9), "{other} px, {speed} px/s");
        }
    }
}

#[test]
fn what_falls_without_walls_keeps_its_momentum_however_it_meets() {
    let kept = |balls: Vec<Ball>| {
        let under = World::new(DVec2::splat(600.0)).unwrap().with_gravity(EARTH).unwrap();
        for mut falling in both_ways(&simulation(under.with_pairs(Pairs::Impulse), balls)) {
            let start = momentum(falling.balls());
            (0..180).for_each(|_| falling.advance(FRAME).unwrap());
            let law = start + EARTH * 3.0 * falling.balls().iter().map(Ball::mass).sum::<f64>();
            let off = momentum(falling.balls()).distance(law);
            assert!(off < 1e-9 * law.length(), "{off} of {law}");
            assert!(falling.tally().impacts > 0);
        }
    };
    let still = |x: f64, y: f64| ball(x, y, 20.0).with_restitution(0.0).unwrap();
    kept(vec![
        moving(still(488.0, 132.0), -224.0, 201.0),
        moving(still(114.0, 412.0), 198.0, -120.0),
        moving(still(278.0, 246.0), 26.0, 63.0),
    ]);
    // A heap that a heavy one falls upon.
    let heap = (0..20).map(|k| still(100.0 + 40.0 * f64::from(k % 5), 200.0 + 40.0 * f64::from(k / 5)));
    let heavy = moving(still(190.0, 100.0).with_mass(50.0).unwrap(), 0.0, 300.0);
    kept(heap.chain([heavy]).collect());
}

/// They were hit eight times in a substep at most, as any others, which left more of their speed than that of these.
#[test]
fn near_elastic_balls_that_fall_lose_as_much_energy_as_with_exact() {
    let left = |solver: Solver| {
        let mut left = [0.0; 2];
        for seed in 1..=3 {
            let fill = format!("[[fill]]\ncount = 200\nradius = [3, 6]\nrestitution = 0.97\nseed = {seed}\n");
            let text = format!(
                "size = [217, 122]\ngravity = [0, 980]\n[walls]\nrestitution = 0.97\n[pairs]\n{fill}"
            );
            let mut falling = Scene::parse("falling", &text).unwrap().with_solver(solver).build().unwrap();
            let start = energy(&falling);
            for left in &mut left {
                (0..45).for_each(|_| falling.advance(FRAME).unwrap());
                *left += energy(&falling) / start / 3.0;
            }
        }
        left
    };
    let (exact, contact) = (left(Solver::Exact), left(Solver::Contact));
    for (exact, contact) in exact.into_iter().zip(contact) {
        assert!((exact - contact).abs() < 8e-3, "{contact} of all, {exact} with exact");
    }
}

/// They stood still, and kept their speed: six times as much energy as with `exact`.
#[test]
fn crowds_of_unlike_masses_without_gravity_lose_their_energy_as_with_exact() {
    let text = |density: u32, seed: u32| {
        format!(
            "[[fill]]\ncount = 250\nradius = 5\nspeed = [100, 300]\nrestitution = 0\ndensity = {density}\nseed = {seed}\n"
        )
    };
    let text =
        format!("size = [361, 361]\n[walls]\nrestitution = 1\n[pairs]\n{}{}", text(1, 1), text(1000, 2));
    let scene = Scene::parse("crowd", &text).unwrap();
    let [contact, exact] = [Solver::Contact, Solver::Exact].map(|solver| {
        let mut crowd = scene.clone().with_solver(solver).build().unwrap();
        let start = kinetic_energy(crowd.balls());
        crowd.advance(3.0).unwrap();
        kinetic_energy(crowd.balls()) / start
    });
    assert!(contact < 2.0 * exact && exact < 2.0 * contact, "{contact}, {exact} with exact");
}

/// Elastic balls that slide on the floor, or hop on it for less than a substep, so slowly that others of their speed would be held.
#[test]
fn elastic_balls_in_a_layer_on_the_floor_keep_their_energy() {
    for height in [0.0, 0.0034] {
        let mut random = numbers::random(7);
        let balls = (0..100).map(|at| {
            let place = DVec2::new(5.0 + 10.0 * f64::from(at), 496.0 - height * random());
            moving(ball(place.x, place.y, 4.0), 40.0 * random() - 20.0, 0.0)
        });
        let world = world(1000.0, 500.0, 1.0).with_gravity(EARTH).unwrap();
        let mut layer = simulation(world, balls.collect());
        let (start, moves) = (energy(&layer), kinetic_energy(layer.balls()));
        let rise = rise(&mut layer, 600) / moves;
        let change = (energy(&layer) - start) / moves;
        assert!(
            rise < 1e-3 && change.abs() < 3e-3,
            "from {height} px above: by {rise:e}, {change:e} in the end"
        );
    }
}
