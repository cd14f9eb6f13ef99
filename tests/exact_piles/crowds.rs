//! Crowds that press on each other: more balls than are left to impacts alone while they do.

use carom::simulation::ledger::Ledger;

use super::*;

/// Balls that fall into a narrow box, where they slide over each other for seconds.
fn crowd(radius: &str, seed: u32) -> Simulation {
    let text = format!(
        "solver = \"exact\"\nsize = [300, 400]\ngravity = [0, {EARTH:?}]\n[walls]\nrestitution = 0.8\n[pairs]\n\
         [[fill]]\ncount = 100\nradius = {radius}\nspeed = [0, 300]\nrestitution = 0.7\nseed = {seed}\n"
    );
    Scene::parse("crowd", &text).unwrap().build().unwrap()
}

#[test]
fn a_crowd_that_presses_settles_in_few_events_and_gains_no_energy_and_overlaps_nowhere() {
    for (radius, seed) in [("[6, 14]", 1), ("[6, 14]", 2), ("[6, 14]", 3), ("10.1", 1), ("10.1", 2)] {
        let mut crowd = crowd(radius, seed);
        let mass: f64 = crowd.balls().iter().map(Ball::mass).sum();
        let mut least = energy(&crowd);
        while crowd.time() < 8.0 {
            crowd.advance(1.0 / 60.0).unwrap();
            let now = energy(&crowd);
            // Hops at half the rest speed, and as much for velocities that steps find.
            assert!(now <= least + 0.25 * mass, "seed {seed}: {least} rose to {now}");
            least = least.min(now);
            assert!(overlap(&crowd) < 1e-13, "seed {seed}, {} s: {}", crowd.time(), overlap(&crowd));
            assert!(max_wall_overlap(crowd.world(), crowd.balls()) < 1e-13);
        }
        // Impact by impact 1.8 to 10 million where they are of many sizes.
        assert!(hits(&crowd) < 200_000, "seed {seed}: {}", hits(&crowd));
        assert!(fastest(&crowd) < 100.0, "seed {seed}: {}", fastest(&crowd));
    }
}

#[test]
fn what_is_carried_counts_as_touching_in_the_frame_in_which_it_is_let_go_of_and_all_else_flies_by_itself() {
    for (radius, seed, seconds) in [("[6, 14]", 1, 3.0), ("[6, 14]", 2, 3.0), ("10.1", 1, 3.0)] {
        let mut crowd = crowd(radius, seed);
        let mut ledger = Ledger::new(&crowd);
        while crowd.time() < seconds {
            crowd.advance(1.0 / 60.0).unwrap();
            ledger.check(&crowd).unwrap();
        }
    }
}

/// Follows rows until they lie, which takes less than `seconds` and so many hits, and none is deeper in another than `deep`.
fn rows_come_to_rest(mut rows: Simulation, seed: u32, deep: f64, most_hits: u64, seconds: f64) {
    let mass: f64 = rows.balls().iter().map(Ball::mass).sum();
    let mut least = energy(&rows);
    while fastest(&rows) > 0.0 {
        rows.advance(1.0 / 60.0).unwrap();
        let now = energy(&rows);
        assert!(now <= least + 0.25 * mass, "seed {seed}: {least} rose to {now}");
        least = least.min(now);
        assert!(overlap(&rows) < deep, "seed {seed}, {} s: {}", rows.time(), overlap(&rows));
        assert!(hits(&rows) < most_hits, "seed {seed}, {} s", rows.time());
        assert!(rows.time() < seconds, "seed {seed}: {}", fastest(&rows));
    }
}

#[test]
fn rows_that_fit_between_the_walls_to_the_last_digit_come_to_rest_in_few_events_and_hardly_overlap() {
    // Fifteen of them are as wide as the box.
    for seed in 1..=4 {
        // The overlap is nearly always a thousandth of that. Impact by impact 4e-6, and 15 to 60 million hits.
        rows_come_to_rest(crowd("10", seed), seed, 5e-7, 1_000_000, 6.0);
    }
}

#[test]
fn hundreds_in_rows_that_fit_to_the_last_digit_come_to_rest_and_do_not_wait_without_end() {
    // Twenty-five of them are as wide as the box: one above the others presses them on the walls with thousands of times its weight.
    for seed in [1, 3] {
        let text = format!(
            "solver = \"exact\"\nsize = [300, 400]\ngravity = [0, {EARTH:?}]\n[walls]\nrestitution = 0.8\n[pairs]\n\
             [[fill]]\ncount = 200\nradius = 6\nspeed = [0, 300]\nrestitution = 0.7\nseed = {seed}\n"
        );
        let rows = Scene::parse("rows", &text).unwrap().build().unwrap();
        rows_come_to_rest(rows, seed, 1e-9, 500_000, 5.0);
    }
}

#[test]
fn nearly_elastic_rows_that_fit_to_the_last_digit_come_to_rest_in_few_events_where_gravity_presses_them_along()
 {
    for seed in [1, 2] {
        let text = format!(
            "solver = \"exact\"\nsize = [300, 400]\ngravity = [490, 849]\n[walls]\nrestitution = 0.8\n[pairs]\n\
             [[fill]]\ncount = 100\nradius = 10\nspeed = [0, 300]\nrestitution = 0.9\nseed = {seed}\n"
        );
        let rows = Scene::parse("rows", &text).unwrap().build().unwrap();
        // Thirty million until the third second while what had no room to hop did, and waited in hops.
        rows_come_to_rest(rows, seed, 1e-10, 300_000, 5.0);
    }
}

/// Hundreds of one size that fall onto each other.
fn heap() -> Simulation {
    let text = format!(
        "solver = \"exact\"\nsize = [400, 500]\ngravity = [0, {EARTH:?}]\n[walls]\nrestitution = 0.8\n[pairs]\n\
         [[fill]]\ncount = 400\nradius = 7\nspeed = [0, 300]\nrestitution = 0.7\nseed = 1\n"
    );
    Scene::parse("heap", &text).unwrap().build().unwrap()
}

#[test]
fn a_heap_of_hundreds_of_one_size_comes_to_rest_in_few_events_and_gains_no_energy() {
    // They lie in rows that leave no room here and there, with more contacts than balls can answer to.
    let mut heap = heap();
    let mass: f64 = heap.balls().iter().map(Ball::mass).sum();
    let mut least = energy(&heap);
    while fastest(&heap) > 0.0 {
        heap.advance(1.0 / 60.0).unwrap();
        let now = energy(&heap);
        assert!(now <= least + 0.25 * mass, "{least} rose to {now} at {} s", heap.time());
        least = least.min(now);
        assert!(overlap(&heap) < 1e-10, "{} s: {}", heap.time(), overlap(&heap));
        assert!(max_wall_overlap(heap.world(), heap.balls()) < 1e-10);
        // With velocities that are found less nearly 2.7 million.
        assert!(hits(&heap) < 500_000 && heap.time() < 6.0, "{} s: {} hits", heap.time(), hits(&heap));
    }
}

#[test]
fn hundreds_that_fit_between_the_walls_to_the_last_digit_hardly_overlap_as_they_are_pressed_together() {
    let text = format!(
        "solver = \"exact\"\nsize = [400, 700]\ngravity = [0, {EARTH:?}]\n[walls]\nrestitution = 0.8\n[pairs]\n\
         [[fill]]\ncount = 300\nradius = 10\nspeed = [0, 200]\nrestitution = 0.7\ndensity = 1\nseed = 1\n"
    );
    let mut rows = Scene::parse("rows", &text).unwrap().build().unwrap();
    while rows.time() < 1.0 {
        rows.advance(1.0 / 60.0).unwrap();
        // With velocities that are always found nearly only 4e-7, after 4.5 million hits.
        assert!(overlap(&rows) < 1e-9, "{} s: {}", rows.time(), overlap(&rows));
        assert!(hits(&rows) < 400_000, "{} s: {}", rows.time(), hits(&rows));
    }
}

#[test]
fn a_crystal_of_balls_that_have_hardly_any_room_gains_no_energy() {
    // Rows of ten and of nine, a millionth of a pixel from each other and the walls, each ball with a speed of its own.
    let (radius, gap) = (8.0, 1e-6);
    let across = 2.0 * radius + gap;
    let down = across * 0.75_f64.sqrt();
    let mut balls = Vec::new();
    for row in 0..12 {
        for column in 0..10 - row % 2 {
            let x = radius + 0.5 * gap + across * (f64::from(column) + 0.5 * f64::from(row % 2));
            let y = 200.0 - radius - gap - down * f64::from(row);
            let speeds = [(37 * column + 91 * row) % 21 - 10, (53 * column + 29 * row) % 17 - 12];
            balls.push(moving(ball(x, y, radius), f64::from(speeds[0]), f64::from(speeds[1])));
        }
    }
    let mut crystal = exact(boxed(10.0 * across, 200.0, EARTH), balls);
    let mass: f64 = crystal.balls().iter().map(Ball::mass).sum();
    let mut least = energy(&crystal);
    while crystal.time() < 2.0 {
        crystal.advance(1.0 / 60.0).unwrap();
        let now = energy(&crystal);
        // Hops at half the rest speed. Kept 1e-4 px from each other the rows rose by 0.6 to 1 of these units.
        assert!(now <= least + 0.125 * mass, "{least} rose to {now} at {} s", crystal.time());
        least = least.min(now);
        assert!(overlap(&crystal) < 1e-13, "{}", overlap(&crystal));
    }
    assert!(hits(&crystal) < 200_000, "{}", hits(&crystal));
}

#[test]
fn a_crowd_that_presses_is_the_same_to_the_last_bit_however_time_is_cut_into_frames() {
    let mut at_once = crowd("[6, 14]", 4);
    let (mut in_frames, mut cut) = (at_once.clone(), at_once.clone());
    at_once.advance(2.0).unwrap();
    for _ in 0..120 {
        in_frames.advance(1.0 / 60.0).unwrap();
    }
    let mut cuts = 0;
    while cut.time() < 2.0 {
        let left = 2.0 - cut.time();
        cuts += u32::from(cut.advance_while(left, || false).unwrap() < left);
    }
    assert!(cuts > 100 && fastest(&at_once) > 0.0, "{cuts} cuts");
    assert_eq!(in_frames.balls(), at_once.balls());
    assert_eq!(cut.balls(), at_once.balls());
}

#[test]
fn hundreds_that_fall_onto_each_other_keep_energy_and_room_at_every_time_and_are_the_same_however_it_is_cut()
{
    let (mut at_once, mut in_frames, mut cut) = (heap(), heap(), heap());
    at_once.advance(1.2).unwrap();
    while cut.time() < 1.2 {
        let left = 1.2 - cut.time();
        cut.advance_while(left, || false).unwrap();
    }
    assert_eq!(cut.balls(), at_once.balls());
    // So short that what hit the heap within a step is shown before that ends.
    let mass: f64 = in_frames.balls().iter().map(Ball::mass).sum();
    let mut least = energy(&in_frames);
    for _ in 0..4800 {
        in_frames.advance(0.25e-3).unwrap();
        let now = energy(&in_frames);
        assert!(now <= least + 0.25 * mass, "{least} rose to {now} at {} s", in_frames.time());
        least = least.min(now);
        assert!(overlap(&in_frames) < 1e-12, "{} s: {}", in_frames.time(), overlap(&in_frames));
    }
    assert!(fastest(&at_once) > 100.0);
}

#[test]
fn what_hits_a_heap_of_hundreds_parts_from_it_as_fast_as_its_restitution_has_it() {
    let mut heap = heap();
    heap.advance(1.2).unwrap();
    let places = [90.0, 150.0, 200.0, 260.0, 310.0];
    let mut others = 0;
    // Never twice at the same place: the heap lies still in the end.
    for (round, place) in (0..10).flat_map(|round| places.map(|place| (round, place))) {
        let x = place + 0.9 * f64::from(round);
        if place == places[0] {
            heap.advance(0.05).unwrap();
        }
        let (world, mut balls) = (*heap.world(), heap.balls().to_vec());
        // What still flies would be in its way.
        balls.retain(|ball| ball.position().y > 280.0);
        balls.push(moving(ball(x, 150.0, 7.0).with_restitution(0.5).unwrap(), 0.0, 800.0));
        let mut hit = exact(world, balls);
        let relative = |hit: &Simulation| {
            let (last, others) = hit.balls().split_last().unwrap();
            let distance = |ball: &Ball| ball.position().distance(last.position());
            let nearest =
                others.iter().min_by(|one, other| distance(one).total_cmp(&distance(other))).unwrap();
            let way = (last.position() - nearest.position()).normalize();
            (last.velocity() - nearest.velocity()).dot(way)
        };
        let mut approach = 0.0;
        let mut parts = -1.0;
        // What it only flies past it approaches ever more slowly.
        while parts <= 0.0 || approach < 100.0 {
            assert!(hit.time() < 0.3, "it has met nothing at {x} px");
            approach = -relative(&hit);
            hit.advance(1e-4).unwrap();
            parts = relative(&hit);
        }
        assert!(parts < 0.7 * approach, "at {x} px {approach}, then {parts}");
        others += u32::from((parts / approach - 0.5).abs() >= 0.01);
    }
    // Some hit two at one time, or another comes nearer just then.
    assert!(others <= 3, "{others} of fifty parted otherwise");
}

#[test]
fn what_is_carried_from_a_time_within_a_step_on_gains_no_energy_by_that() {
    for (name, text) in [
        ("dull", include_str!("../data/crowds/dull.toml")),
        ("sideways", include_str!("../data/crowds/sideways.toml")),
    ] {
        let mut crowd = Scene::parse(name, text).unwrap().build().unwrap();
        let (mass, mut least) = (crowd.balls().iter().map(Ball::mass).sum::<f64>(), energy(&crowd));
        for frame in 0..180 {
            crowd.advance(1.0 / 60.0).unwrap();
            let now = energy(&crowd);
            // It was 2.5 and 1.1 for the rest speed of 1 px/s: falling balls got half a step's fall at once.
            assert!(now <= least + 0.2 * mass, "{name}, frame {frame}: {} more", (now - least) / mass);
            least = least.min(now);
        }
    }
}

#[test]
fn walls_give_a_crowd_no_more_momentum_than_it_can_have_got() {
    for (name, text) in [
        ("against walls", include_str!("../data/crowds/against-walls.toml")),
        ("the other", include_str!("../data/crowds/against-walls-2.toml")),
    ] {
        let mut crowd = Scene::parse(name, text).unwrap().build().unwrap();
        crowd.advance(6.0).unwrap();
        let (mass, given) = (crowd.balls().iter().map(Ball::mass).sum::<f64>(), crowd.tally().wall_impulse);
        // Gravity gives so much in that time, and all have hit walls at up to this speed some times. It was 10¹² and more.
        let most = mass * (6.0 * EARTH + 20.0 * 1000.0);
        assert!(given.abs().max_element() < most, "{name}: {given}, at most {most}");
    }
}

/// Their velocities were shown as much faster or slower as each had fallen in a step: that keeps energy, and not momentum.
#[test]
fn a_crowd_that_nothing_carries_keeps_its_momentum_as_it_falls() {
    for seed in 1..=6_u32 {
        let angle = |k: u32| f64::from(k * (2 * seed + 1)) * 2.4;
        let balls = (0..60).map(|k| {
            let (place, radius) =
                (40.0 * f64::from(k + 1).sqrt() * DVec2::from_angle(angle(k)), 6.0 + f64::from(k * seed % 7));
            let ball = ball(2000.0 + place.x, 1500.0 + place.y, radius)
                .with_restitution(f64::from(seed % 3) * 0.1)
                .unwrap();
            moving(ball.with_mass(radius * radius).unwrap(), -1.5 * place.x, -1.5 * place.y)
        });
        let world = World::new(DVec2::splat(4000.0)).unwrap().with_gravity(DVec2::new(0.0, EARTH)).unwrap();
        let mut crowd = exact(world.with_pairs(Pairs::Impulse), balls.collect());
        let (start, mass) = (momentum(crowd.balls()), crowd.balls().iter().map(Ball::mass).sum::<f64>());
        for frame in 0..60 {
            crowd.advance(1.0 / 60.0).unwrap();
            let off = momentum(crowd.balls()) - start - DVec2::new(0.0, EARTH * crowd.time() * mass);
            assert!(off.length() < 1e-6 * mass, "seed {seed}, frame {frame}: by {} px/s", off / mass);
        }
        assert!(crowd.tally().impacts > 500, "seed {seed}: {} impacts", crowd.tally().impacts);
    }
}
