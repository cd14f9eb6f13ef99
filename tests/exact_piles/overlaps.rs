//! What begins in each other, or is brought into each other by a window that shrinks, or by what closes in.

use super::*;

#[test]
fn balls_at_rest_in_each_other_part_without_momentum_and_are_apart_soon() {
    for count in [2, 3, 5] {
        for gravity in [0.0, EARTH] {
            let mut simulation = exact(boxed(400.0, 400.0, gravity), vec![ball(200.0, 200.0, 10.0); count]);
            simulation.advance(0.25).unwrap();
            let expected = DVec2::new(0.0, 0.25 * gravity * count as f64);
            assert!((momentum(simulation.balls()) - expected).length() < 1e-12, "{count} balls");
            simulation.advance(4.75).unwrap();
            assert_eq!(overlap(&simulation), 0.0, "{count} balls, gravity {gravity}");
            assert!(fastest(&simulation) < 100.0, "{count} balls, gravity {gravity}");
        }
    }
}

#[test]
fn what_overlaps_and_approaches_is_turned_back_by_the_law_of_impact_and_what_parts_flies_on() {
    for (speed, after) in [(-30.0, 15.0), (30.0, 30.0)] {
        let balls =
            vec![moving(ball(200.0, 200.0, 10.0), -speed, 0.0), moving(ball(215.0, 200.0, 10.0), speed, 0.0)];
        let mut simulation = exact(boxed(400.0, 400.0, 0.0), balls);
        simulation.advance(1.0 / 60.0).unwrap();
        let velocities = [0, 1].map(|index| simulation.balls()[index].velocity().x);
        assert_eq!(velocities, [-after, after], "{speed} px/s");
        assert_eq!(simulation.tally().impacts, u64::from(speed < 0.0));
    }
}

#[test]
fn a_pile_in_a_window_that_shrinks_over_it_comes_to_rest_without_overlap() {
    let mut simulation = exact(boxed(400.0, 300.0, EARTH), rows(15, 15));
    simulation.advance(2.0).unwrap();
    for narrower in 1..=30 {
        simulation.resize(DVec2::new(400.0 - 10.0 * f64::from(narrower), 300.0)).unwrap();
        simulation.advance(1.0 / 60.0).unwrap();
    }
    simulation.advance(8.0).unwrap();
    assert_eq!(fastest(&simulation), 0.0);
    assert!(overlap(&simulation) < 2e-14, "{}", overlap(&simulation));
    assert!(max_wall_overlap(simulation.world(), simulation.balls()) < 2e-14);
}

#[test]
fn a_row_that_a_window_leaves_too_little_room_stays_in_it_and_ends_no_run() {
    for width in [199.99, 190.0] {
        let row = (0..10).map(|k| ball(10.0 + 20.0 * f64::from(k), 90.0, 10.0)).collect();
        let mut simulation = exact(boxed(220.0, 100.0, EARTH), row);
        simulation.advance(1.0).unwrap();
        simulation.resize(DVec2::new(width, 100.0)).unwrap();
        simulation.advance(10.0).unwrap();
        assert!(hits(&simulation) < 5000, "{width} px: {:?}", simulation.tally());
        assert!(max_wall_overlap(simulation.world(), simulation.balls()) < 1e-13, "{width} px");
        assert_eq!(non_finite(simulation.balls()), 0);
    }
}

/// A row on the floor is a little too short for them, as soon as all have come down to it. Where those at its ends were held, the
/// others hit each other a thousand times at one moment, and were given speed each time.
#[test]
fn balls_that_come_down_into_a_row_without_room_gain_no_energy() {
    let places = [
        (35.379_071_638_961_11, 985.0),
        (65.379_071_638_961_11, 985.0),
        (95.378_071_638_961_1, 985.0),
        (125.378_071_638_961_1, 985.0),
        (50.379_071_638_961_11, 959.0093),
        (110.378_071_638_961_1, 959.0093),
        (65.378_571_638_961_1, 933.0186),
        (95.378_571_638_961_1, 933.0186),
    ];
    let balls = places.map(|(x, y)| ball(x, y, 15.0).with_restitution(0.8).unwrap());
    let world = boxed(179.999, 1000.0, EARTH).with_walls(0.8).unwrap();
    let mut simulation = exact(world, balls.to_vec());
    let mut least = energy(&simulation);
    let mass: f64 = balls.iter().map(Ball::mass).sum();
    for _ in 0..240 {
        simulation.advance(1.0 / 60.0).unwrap();
        let now = energy(&simulation);
        assert!(now < least + 0.5 * mass, "{} at {} s", (now - least) / mass, simulation.time());
        least = least.min(now);
    }
}

/// It goes to and fro between them some thousand times, in no time at all: that is not for want of room.
#[test]
fn a_light_ball_in_two_heavy_ones_that_close_on_it_sends_them_back_as_fast_as_they_came() {
    for mass in [1e4, 1e5, 1e6, 1e8] {
        for depth in [0.001, 0.1, 5.0] {
            let heavy =
                |x, v| moving(Ball::new(DVec2::new(x, 5000.0), 50.0).unwrap(), v, 0.0).with_mass(mass);
            let light = Ball::new(DVec2::new(5000.0, 5000.0), 10.0).unwrap().with_mass(1.0);
            let balls =
                [heavy(4940.0 + depth, 100.0), light, heavy(5060.0 - depth, -100.0)].map(Result::unwrap);
            let world = World::new(DVec2::splat(1e4)).unwrap().with_pairs(Pairs::Impulse);
            let mut simulation = exact(world, balls.to_vec());
            let start = kinetic_energy(simulation.balls());
            simulation.advance(1.0).unwrap();
            let drift = (kinetic_energy(simulation.balls()) / start - 1.0).abs();
            // The rounding of up to 22,000 impacts.
            assert!(drift < 1e-11, "{mass:e}, {depth}: {drift:e}");
            let speeds = [0, 2].map(|k| simulation.balls()[k].velocity().x);
            let error = (speeds[0] + 100.0).abs().max((speeds[1] - 100.0).abs());
            assert!(error < 0.1, "{mass:e}, {depth}: {speeds:?}");
        }
    }
}
