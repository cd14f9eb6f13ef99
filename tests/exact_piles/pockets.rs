//! What has no room: rows between walls, wedges and pockets.

use super::*;

#[test]
fn a_row_without_room_falls_and_lies_on_the_floor() {
    let place = |k: u32| {
        moving(ball(10.0 + 20.0 * f64::from(k), 380.0, 10.0), 20.0 * (f64::from(k) * 2.4).sin(), 0.0)
    };
    let mut row = exact(boxed(400.0, 400.0, EARTH), (0..20).map(place).collect());
    row.advance(3.0).unwrap();
    assert!(hits(&row) < 5000, "{:?}", row.tally());
    assert!(fastest(&row) < 1e-9, "{}", fastest(&row));
    for ball in row.balls() {
        assert_eq!(ball.position().y, 390.0, "{ball:?}");
    }
    assert!(overlap(&row) < 1e-13);
}

#[test]
fn a_ball_driven_into_a_wedge_ends_no_run() {
    // A gap between a fixed ball and the wall that is a little narrower than the ball that falls into it.
    for narrow in [1e-1, 1e-3, 1e-6, 1e-9, 1e-12] {
        for speed in [0.0, 500.0, 1e5] {
            let peg = ball(20.0 * (1.0 - narrow) + 30.0, 200.0, 30.0).fixed();
            let falling = moving(ball(10.5, 40.0, 10.0), 0.0, speed);
            let mut simulation = exact(boxed(300.0, 400.0, EARTH), vec![peg, falling]);
            simulation.advance(10.0).unwrap();
            assert!(hits(&simulation) < 300, "{narrow} at {speed} px/s: {:?}", simulation.tally());
            assert_eq!(non_finite(simulation.balls()), 0);
            assert!(overlap(&simulation) < 1e-14, "{narrow} at {speed} px/s");
        }
    }
}

/// A window's edge had pressed them into each other: they took 1.8 million impacts a second of computing, and no time passed.
#[test]
fn two_balls_in_each_other_in_a_pocket_end_no_run() {
    let world = World::new(DVec2::new(394.344_943_779_613, 396.658_629_754_767_4)).unwrap();
    let world = world.with_walls(0.5).unwrap().with_gravity(DVec2::new(0.0, EARTH)).unwrap();
    let rough = |x: f64, y: f64, radius: f64| ball(x, y, radius).with_restitution(0.3).unwrap();
    let balls = vec![
        ball(361.432_549_544_585_4, 380.889_605_726_578_34, 8.561_604_912_728_939).fixed(),
        moving(rough(376.719_492_814_430_74, 388.279_998_873_596_75, 8.378_630_881_171_322), 0.77, 0.0),
        moving(rough(389.010_598_152_685_36, 391.324_284_127_840_43, 5.334_345_626_927_651), 0.785, 0.0),
    ];
    let mut pocket = exact(world.with_pairs(Pairs::Impulse), balls);
    let mut looks = 0;
    // It is asked after every 256 events.
    let done = pocket.advance_while(5.0, || {
        looks += 1;
        looks < 1000
    });
    assert_eq!(done, Ok(5.0), "after {:?}", pocket.tally());
    assert_eq!(non_finite(pocket.balls()), 0);
}

/// Millions of impacts of a few balls, in which next to no time passed, and nobody went anywhere.
#[test]
fn balls_pressed_into_a_pocket_are_followed_in_time() {
    for (name, text) in [
        ("squeezed", include_str!("../data/pockets/squeezed.toml")),
        ("one gives way", include_str!("../data/pockets/one-gives-way.toml")),
        ("beside the floor", include_str!("../data/pockets/beside-the-floor.toml")),
        ("slides in place", include_str!("../data/pockets/slides-in-place.toml")),
    ] {
        let mut pocket = Scene::parse(name, text).unwrap().build().unwrap();
        let start = energy(&pocket);
        let mut looks = 0;
        // It is asked after every 256 events.
        let done = pocket.advance_while(5.0, || {
            looks += 1;
            looks < 4000
        });
        assert_eq!(done, Ok(5.0), "{name}: after {:?}", pocket.tally());
        assert_eq!(non_finite(pocket.balls()), 0, "{name}");
        assert!(energy(&pocket) < start, "{name}: {} after {start}", energy(&pocket));
    }
}

/// The energy rose by an eighth while one hopped in the wedge; and where it stayed there, it was not shown as touching them.
#[test]
fn a_ball_wedged_in_between_two_others_gains_no_energy_and_touches_them() {
    let mut wedge =
        Scene::parse("wedge", include_str!("../data/pockets/wedge.toml")).unwrap().build().unwrap();
    let mut before = energy(&wedge);
    for frame in 0..600 {
        let place = wedge.balls()[0].position();
        wedge.advance(1.0 / 60.0).unwrap();
        let now = energy(&wedge);
        assert!(now < before * (1.0 + 1e-14), "frame {frame}: {before} rises to {now}");
        before = now;
        assert!(wedge.balls()[0].position() != place || wedge.touching()[0], "frame {frame}");
    }
}

#[test]
fn a_ball_comes_to_rest_between_a_wall_and_a_fixed_ball_however_steep_their_wedge() {
    let mut restless = Vec::new();
    for restitution in [0.0, 0.5] {
        for steepness in [0.5, 0.1, 0.02] {
            for aside in [30.0, 300.0, 2000.0] {
                let gravity = DVec2::new(aside, EARTH);
                let world =
                    World::new(DVec2::splat(200.0)).and_then(|world| world.with_walls(restitution)).unwrap();
                let world = world.with_gravity(gravity).unwrap().with_pairs(Pairs::Impulse);
                // The contact's direction is as steep as this where the ball touches both.
                let apart = 30.0 * f64::sqrt(1.0 - steepness * steepness);
                let balls = vec![ball(190.0 - apart, 150.0, 20.0).fixed(), ball(189.0, 90.0, 10.0)];
                let mut simulation = exact(world, balls);
                simulation.advance(20.0).unwrap();
                let place = DVec2::new(190.0, 150.0 - 30.0 * steepness);
                let lies = simulation.balls()[1].position().distance(place) < 1e-3;
                if fastest(&simulation) > 0.0 || !lies || hits(&simulation) > 2000 {
                    restless.push((restitution, steepness, aside, simulation.tally()));
                }
            }
        }
    }
    assert!(restless.is_empty(), "{restless:?}");
}
