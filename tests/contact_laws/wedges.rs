//! Balls that lie on others so flat beside them that they press with many times their weight: wedges, and flat arches between
//! walls. What sweeps had not found of that was stored in overlaps, and given back as speed, for ever.

use super::*;

/// A row on the floor from wall to wall, so narrow that its last ball wedges itself in above, with this slope, degrees, of
/// its contact with the one before.
fn row(count: u32, slope: f64, (radius, restitution): (f64, f64), gravity: f64) -> Simulation {
    let (width, rise) = (slope.to_radians().cos(), slope.to_radians().sin());
    let side = 2.0 * radius * (f64::from(count - 1) + width);
    let floor = |k: u32| ball(radius * f64::from(2 * k + 1), 7.0 * radius, radius);
    let last = ball(side - radius, 7.0 * radius - 2.0 * radius * rise - 0.1 * radius, radius);
    let balls = (0..count - 1).map(floor).chain([last]);
    let balls = balls.map(|ball| ball.with_restitution(restitution).unwrap()).collect();
    let world = world(side, 8.0 * radius, 0.5).with_gravity(DVec2::new(0.0, gravity)).unwrap();
    simulation(world, balls)
}

/// They sink in by a thousandth of a radius more than they should, and come out of that.
#[test]
fn balls_wedged_in_between_walls_come_to_rest() {
    let mut restless = Vec::new();
    for count in [2, 3, 4, 6] {
        for slope in [3.0, 5.0, 8.0, 10.0, 15.0, 20.0, 30.0] {
            for (kind, gravity) in [((60.0, 0.0), 980.0), ((60.0, 0.7), 30.0), ((10.0, 0.5), 980.0)] {
                let mut row = row(count, slope, kind, gravity);
                let deepest = overlap_in(&mut row, 10.0 * f64::sqrt(980.0 / gravity));
                if fastest(&row) > 0.0 || deepest > 0.02 {
                    restless.push((count, slope, kind, fastest(&row), deepest));
                }
            }
        }
    }
    assert!(restless.is_empty(), "{}: {restless:?}", restless.len());
}

/// The largest overlap at a frame in so many seconds.
fn overlap_in(simulation: &mut Simulation, seconds: f64) -> f64 {
    let frames = (seconds / FRAME) as u32;
    (0..frames).fold(0.0, |most, _| {
        simulation.advance(FRAME).unwrap();
        most.max(overlap(simulation))
    })
}

/// Three large ones wedge each other in, and the small ones lie between them.
#[test]
fn large_balls_wedged_in_among_small_ones_come_to_rest() {
    for seed in 0..6 {
        let fill = |count: u32, radius: &str, seed: u32| {
            format!("[[fill]]\ncount = {count}\nradius = {radius}\nrestitution = 0\nseed = {seed}\n")
        };
        let text = format!(
            "solver = \"contact\"\nsize = [400, 400]\ngravity = [0, 980]\n[walls]\nrestitution = 0.5\n[pairs]\n{}{}",
            fill(3, "[55, 75]", 17 + seed),
            fill(150, "[2.5, 5]", 1017 + seed)
        );
        let mut pile = Scene::parse("wedged", &text).unwrap().build().unwrap();
        pile.advance(20.0).unwrap();
        assert_eq!(fastest(&pile), 0.0, "seed {seed}");
    }
}

/// Balls that lie in wedges, or fall into them, lie still there, and not in others; where they may, they sleep.
fn lie_still(case: &str, wedges: Simulation) {
    let mut asleep = wedges.clone();
    asleep.advance(5.0).unwrap();
    assert_eq!(fastest(&asleep), 0.0, "{case}: some do not sleep");
    let mut wedges = wedges.with_sleep(false);
    wedges.advance(2.0).unwrap();
    let (mut fastest_of_all, mut deepest) = (0.0_f64, 0.0_f64);
    for _ in 0..60 {
        wedges.advance(FRAME).unwrap();
        (fastest_of_all, deepest) = (fastest_of_all.max(fastest(&wedges)), deepest.max(overlap(&wedges)));
    }
    assert!(fastest_of_all < 0.5, "{case}: {fastest_of_all} px/s");
    assert!(deepest < 0.01, "{case}: {deepest} of a radius deep");
}

/// So many balls, each so far above its place between two fixed ones on both sides that nearly face each other, so many degrees from
/// flat: each presses on both with many times its weight. They used to hop there for ever, and in flatter wedges fell through.
fn lie_still_in_wedges(count: u32, (slope, flatness): (f64, f64), above: f64) {
    let at = |degrees: f64| 10.0 * DVec2::from_angle(degrees.to_radians());
    let columns = 2 * count.isqrt();
    let wedge = |k: u32| {
        let here = DVec2::new(20.0 + 33.0 * f64::from(k % columns), 40.0 + 33.0 * f64::from(k / columns));
        let fixed = |place: DVec2| ball(place.x, place.y, 5.0).fixed();
        let falling = ball(here.x, here.y - above, 5.0).with_restitution(0.5).unwrap();
        [fixed(here + at(slope)), falling, fixed(here + at(180.0 + slope - flatness))]
    };
    let world = world(33.0 * f64::from(columns), 17.0 * f64::from(columns) + 53.0, 0.5);
    let world = world.with_gravity(EARTH).unwrap();
    let wedges = simulation(world, (0..count).flat_map(wedge).collect());
    lie_still(&format!("{count}, {flatness}° from flat, at a slope of {slope}°, from {above} px"), wedges);
}

#[test]
fn a_ball_in_a_flat_wedge_lies_still() {
    let slopes = [2.5, 6.0, 10.0, 20.0, 60.0].map(|slope| (slope, 5.0));
    let flatnesses = [1.0, 5.0, 9.0, 13.0, 17.0, 21.0, 25.0, 29.0, 33.0].map(|flatness| (20.0, flatness));
    flatnesses.into_iter().chain(slopes).for_each(|case| lie_still_in_wedges(200, case, 0.0));
}

/// So many balls are several stripes (`contact/layout.rs`).
#[test]
fn each_of_thousands_of_balls_in_flat_wedges_lies_still() {
    for case in [(20.0, 1.0), (20.0, 9.0), (20.0, 29.0), (2.5, 5.0), (60.0, 5.0)] {
        lie_still_in_wedges(1600, case, 0.0);
    }
}

/// Few, hundreds, thousands.
#[test]
fn a_ball_that_falls_into_a_flat_wedge_is_caught_there() {
    for count in [10, 200, 1600] {
        for flatness in [2.0, 5.0, 13.0, 25.0] {
            lie_still_in_wedges(count, (0.0, flatness), 5.0);
            lie_still_in_wedges(count, (0.0, flatness), 20.0);
        }
    }
}

#[test]
fn a_ball_in_a_flat_wedge_of_a_wall_and_a_fixed_ball_lies_still() {
    for count in [10, 300] {
        for flatness in [1.0, 5.0, 13.0, 25.0] {
            let wedge = |k: u32| {
                let here = DVec2::new(5.0, 20.0 + 33.0 * f64::from(k));
                let below = here + 10.0 * DVec2::from_angle(f64::to_radians(flatness));
                [ball(here.x, here.y, 5.0), ball(below.x, below.y, 5.0).fixed()]
            };
            let world = world(400.0, 33.0 * f64::from(count) + 40.0, 0.5).with_gravity(EARTH).unwrap();
            let wedges = simulation(world, (0..count).flat_map(wedge).collect());
            lie_still(&format!("{count}, {flatness}° from flat"), wedges);
        }
    }
}

/// A ball on two fixed ones, under a third that it nearly touches.
#[test]
fn a_ball_in_its_seat_under_a_lid_lies_still() {
    for gravity in [10.0, 980.0, 5000.0] {
        for gap in [0.0, 1e-9, 1e-3, 0.1, 1.0] {
            for slope in [20.0, 45.0, 70.0] {
                let at =
                    |degrees: f64| DVec2::new(100.0, 100.0) + 20.0 * DVec2::from_angle(degrees.to_radians());
                let fixed = |place: DVec2| ball(place.x, place.y, 10.0).fixed();
                let lid = ball(100.0, 80.0 - gap, 10.0).fixed();
                let seat = vec![ball(100.0, 100.0, 10.0), fixed(at(slope)), fixed(at(180.0 - slope)), lid];
                let world = world(200.0, 200.0, 0.5).with_gravity(DVec2::new(0.0, gravity)).unwrap();
                let case = format!("{gravity} px/s², {gap} px below the lid, at {slope}°");
                lie_still(&case, simulation(world, seat));
            }
        }
    }
}

/// Layers of balls of radius 5 above a row of fixed ones of this radius that leave each so much less room than it needs, as a part of
/// its size, and the height of the row.
fn sieve(gaps: u32, fixed: f64, narrower: f64, layers: u32, restitution: f64) -> (Simulation, f64) {
    let radius = 5.0;
    let pitch = 2.0 * fixed + 2.0 * radius * (1.0 - narrower);
    let width = pitch * f64::from(gaps);
    let row = 200.0 + 2.1 * radius * f64::from(layers);
    let soft = |ball: Ball| ball.with_restitution(restitution).unwrap();
    let sieve = (0..=gaps).map(|k| soft(ball(pitch * f64::from(k), row, fixed)).fixed());
    let columns = (width / (2.1 * radius)) as u32 - 1;
    let place = |k: u32| {
        let (column, layer) = (f64::from(k % columns), f64::from(k / columns));
        let aside = 0.005 * f64::from((k % columns * 7 + k / columns * 13) % 10) + 0.03 * (layer % 2.0);
        let x = radius * (1.1 + 2.1 * column + aside);
        soft(ball(x, row - fixed - 30.0 - 2.1 * radius * layer, radius))
    };
    let balls: Vec<_> = sieve.chain((0..columns * layers).map(place)).collect();
    let world = world(width, row + 2.0 * fixed + 100.0, 0.5).with_gravity(EARTH).unwrap();
    (simulation(world, balls), row)
}

/// How many of them are through after so many seconds.
fn fall_through((sieve, row): &mut (Simulation, f64), seconds: f64) -> usize {
    for _ in 0..(seconds / FRAME) as u32 {
        sieve.advance(FRAME).unwrap();
    }
    sieve.balls().iter().filter(|ball| !ball.is_fixed() && ball.position().y > *row + 2.0).count()
}

/// Hundreds of them fell through.
#[test]
fn no_ball_falls_through_a_gap_that_is_narrower_than_it_is() {
    for restitution in [0.0, 0.5, 0.9] {
        for fixed in [1.0, 5.0, 20.0] {
            for (narrower, layers) in [(0.1, 12), (0.02, 12), (0.005, 3)] {
                let through = fall_through(&mut sieve(30, fixed, narrower, layers, restitution), 4.0);
                assert_eq!(through, 0, "{narrower} narrower, between radii of {fixed}, e = {restitution}");
            }
        }
    }
}

/// A layer of them sleeps on such a row, and another ball, ten times as heavy, is thrown on it.
#[test]
fn no_ball_that_sleeps_on_a_gap_is_struck_through() {
    for speed in [200.0, 500.0] {
        for throw in 0..12 {
            let mut layer = sieve(12, 5.0, 0.005, 1, 0.5);
            assert_eq!(fall_through(&mut layer, 3.0), 0);
            let x = layer.0.world().size().x * (0.3 + f64::from(throw) / 30.0);
            let thrown = moving(ball(x, 60.0, 8.0), 0.0, speed).with_mass(10.0).unwrap();
            layer.0.add(&[thrown.with_restitution(0.5).unwrap()]).unwrap();
            assert_eq!(fall_through(&mut layer, 2.0), 0, "throw {throw} at {speed} px/s");
        }
    }
}
