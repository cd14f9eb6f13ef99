//! Where balls lie on each other, are pressed together or begin in each other: how `exact` lays them to rest, and what wakes
//! them. Most of these cases once took events without end.

use carom::simulation::grid::Grid;
use carom::simulation::invariants::{
    kinetic_energy, max_overlap, max_wall_overlap, momentum, non_finite, potential_energy,
};
use carom::{Ball, DVec2, Pairs, Scene, Simulation, Solver, World};

const EARTH: f64 = 980.0;

fn ball(x: f64, y: f64, radius: f64) -> Ball {
    Ball::new(DVec2::new(x, y), radius).and_then(|ball| ball.with_restitution(0.5)).unwrap()
}

fn moving(ball: Ball, x: f64, y: f64) -> Ball {
    ball.with_velocity(DVec2::new(x, y)).unwrap()
}

fn boxed(width: f64, height: f64, gravity: f64) -> World {
    let world = World::new(DVec2::new(width, height)).unwrap().with_walls(0.5).unwrap();
    world.with_gravity(DVec2::new(0.0, gravity)).unwrap().with_pairs(Pairs::Impulse)
}

fn exact(world: World, balls: Vec<Ball>) -> Simulation {
    Simulation::new(world, balls, Solver::Exact).unwrap()
}

fn hits(simulation: &Simulation) -> u64 {
    simulation.tally().impacts + simulation.tally().wall_hits
}

fn energy(simulation: &Simulation) -> f64 {
    kinetic_energy(simulation.balls()) + potential_energy(simulation.world(), simulation.balls())
}

fn overlap(simulation: &Simulation) -> f64 {
    max_overlap(&mut Grid::new(simulation.balls(), simulation.world().size()), simulation.balls())
}

fn fastest(simulation: &Simulation) -> f64 {
    simulation.balls().iter().map(|ball| ball.velocity().length()).fold(0.0, f64::max)
}

/// Balls of three sizes in rows, that fall.
fn rows(count: u32, columns: u32) -> Vec<Ball> {
    let place = |i: u32| {
        let (column, row) = (f64::from(i % columns), f64::from(i / columns));
        ball(14.0 + 25.0 * column + row, 20.0 + 26.0 * row, 9.0 + f64::from(i * 7 % 3))
    };
    (0..count).map(place).collect()
}

/// A column of balls of radius 3.5 that stands on the floor.
fn column(count: u32) -> Simulation {
    let height = 7.0 * f64::from(count) + 100.0;
    let place = |k: u32| ball(200.0, height - 3.5 - 7.0 * f64::from(k), 3.5);
    exact(boxed(400.0, height, EARTH), (0..count).map(place).collect())
}

#[test]
fn a_column_of_any_height_stands_and_has_events_in_the_first_moment_alone() {
    for count in [2, 20, 200, 2000] {
        let mut column = column(count);
        let top = column.balls()[count as usize - 1].position();
        column.advance(0.1).unwrap();
        let first = hits(&column);
        assert!(first < 20 * u64::from(count), "{count} balls: {first} hits");
        column.advance(100.0).unwrap();
        assert_eq!((hits(&column), fastest(&column)), (first, 0.0), "{count} balls");
        assert_eq!(column.balls()[count as usize - 1].position(), top, "{count} balls");
    }
}

#[test]
fn a_pile_comes_to_rest_for_good_and_shows_which_balls_touch() {
    // The last touches nothing.
    let mut balls = rows(20, 5);
    balls.push(ball(125.0, 5.0, 5.0).fixed());
    let mut pile = exact(boxed(130.0, 300.0, EARTH), balls);
    let start = energy(&pile);
    pile.advance(10.0).unwrap();
    let (settled, balls) = (hits(&pile), pile.balls().to_vec());
    assert_eq!(fastest(&pile), 0.0);
    assert!(energy(&pile) < start && overlap(&pile) < 1e-13);
    let mut compared = [0, 0];
    for _ in 0..100 {
        pile.advance(1.0 / 60.0).unwrap();
        for (index, one) in balls.iter().enumerate() {
            let gaps =
                balls.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, other)| {
                    one.position().distance(other.position()) - one.radius() - other.radius()
                });
            let nearest = gaps.fold(f64::INFINITY, f64::min);
            // Those that are nearly as near as held ones are may lean on each other or not.
            if !(1e-5..0.1).contains(&nearest) {
                compared[usize::from(pile.touching()[index])] += 1;
                assert_eq!(pile.touching()[index], nearest < 1e-5, "ball {index}, {nearest} px from others");
            }
        }
    }
    let [free, touching] = compared;
    assert!(free >= 100 && touching >= 400, "{compared:?} were compared");
    assert_eq!((hits(&pile), pile.balls()), (settled, &balls[..]));
}

#[test]
fn a_pile_at_rest_is_the_same_to_the_last_bit_however_time_is_cut_into_frames() {
    let pile = || exact(boxed(110.0, 300.0, EARTH), rows(12, 4));
    let mut once = pile();
    once.advance(6.0).unwrap();
    for rate in [24_u32, 60, 144] {
        let mut frames = pile();
        for _ in 0..6 * rate {
            frames.advance(1.0 / f64::from(rate)).unwrap();
        }
        assert_eq!(once.balls(), frames.balls(), "{rate} Hz");
        assert_eq!(once.tally(), frames.tally(), "{rate} Hz");
    }
}

#[test]
fn what_lies_on_a_ball_that_is_knocked_away_falls() {
    let mut column: Vec<Ball> = (0..5).map(|k| ball(300.0, 390.0 - 20.0 * f64::from(k), 10.0)).collect();
    column.push(moving(ball(20.0, 390.0, 10.0), 100.0, 0.0));
    let mut simulation = exact(boxed(600.0, 400.0, EARTH), column);
    simulation.advance(1.0).unwrap();
    // The column rests; what comes is still on its way.
    assert_eq!(simulation.balls()[4].position().y, 310.0);
    assert_eq!(simulation.balls()[4].velocity(), DVec2::ZERO);
    simulation.advance(9.0).unwrap();
    for ball in simulation.balls() {
        assert_eq!(ball.position().y, 390.0, "{ball:?}");
    }
    assert!(overlap(&simulation) < 1e-13);
}

#[test]
fn a_ball_that_falls_on_a_pile_at_rest_moves_what_it_hits_and_adds_no_energy() {
    let settled = {
        let mut pile = exact(boxed(130.0, 300.0, EARTH), rows(15, 5));
        pile.advance(10.0).unwrap();
        assert_eq!(fastest(&pile), 0.0);
        pile.balls().to_vec()
    };
    let mut pile = exact(boxed(130.0, 300.0, EARTH), settled.clone());
    pile.advance(1.0).unwrap();
    assert_eq!(fastest(&pile), 0.0);
    pile.add(&[moving(ball(65.0, 20.0, 10.0).with_mass(20.0).unwrap(), 0.0, 500.0)]).unwrap();
    let mass: f64 = pile.balls().iter().map(Ball::mass).sum();
    let mut least = energy(&pile);
    for _ in 0..600 {
        pile.advance(1.0 / 60.0).unwrap();
        let now = energy(&pile);
        // Hops at half the rest speed.
        assert!(now <= least + 0.125 * mass, "{least} rose to {now}");
        least = least.min(now);
        assert!(overlap(&pile) < 1e-13 && max_wall_overlap(pile.world(), pile.balls()) < 1e-13);
    }
    let moved = |(now, before): (&Ball, &Ball)| now.position().distance(before.position());
    assert!(pile.balls().iter().zip(&settled).map(moved).fold(0.0, f64::max) > 1.0);
    assert_eq!(fastest(&pile), 0.0);
}

#[test]
fn balls_that_are_not_in_balance_slide_however_slowly_they_begin() {
    // In the valley of two that nothing holds together, and on top of one, a hundredth of the radius off its middle.
    let valley = vec![ball(390.0, 390.0, 10.0), ball(410.0, 390.0, 10.0), ball(400.0, 372.6, 10.0)];
    let top = vec![ball(400.0, 390.0, 10.0), ball(400.1, 369.9, 10.0)];
    for balls in [valley, top] {
        let mut simulation = exact(boxed(800.0, 400.0, EARTH), balls);
        simulation.advance(3.0).unwrap();
        for ball in simulation.balls() {
            assert!(ball.position().y > 389.9, "{ball:?}");
        }
    }
}

#[test]
fn two_balls_at_rest_that_touch_do_not_bear_a_heavy_one_between_them() {
    let mut balls = vec![ball(390.0, 390.0, 10.0), ball(410.0, 390.0, 10.0)];
    balls.push(ball(400.0, 355.0, 10.0).with_mass(1e4).unwrap());
    let mut simulation = exact(boxed(800.0, 400.0, EARTH), balls);
    simulation.advance(5.0).unwrap();
    for ball in simulation.balls() {
        assert!(ball.position().y > 389.9, "{ball:?}");
    }
}

#[test]
fn however_strong_gravity_is_balls_settle_with_as_many_impacts_and_gain_no_energy() {
    for gravity in [1e3, 1e4, 1e5, 1e6, 1e7, 1e9] {
        let place = |index: u32| {
            let (column, row) = (f64::from(index % 8), f64::from(index / 8));
            let turn = 2.4 * f64::from(index);
            moving(
                ball(40.0 + 45.0 * column, 40.0 + 45.0 * row, 10.0),
                150.0 * turn.cos(),
                150.0 * turn.sin(),
            )
        };
        let mut simulation = exact(boxed(600.0, 400.0, gravity), (0..30).map(place).collect());
        // What hops at half the rest speed, which is larger where gravity is, but not by hops of more than a hundredth of
        // the radius.
        let rest_speed = f64::min(gravity / EARTH, (2.0 * gravity * 0.1).sqrt());
        let hops = 0.5 * 30.0 * (0.5 * rest_speed).powi(2);
        let start = energy(&simulation);
        let mut least = start;
        for _ in 0..100 {
            simulation.advance(0.03).unwrap();
            let now = energy(&simulation);
            let most = (least + hops).min(start * (1.0 + 1e-12));
            assert!(now <= most, "gravity {gravity}: {least} rose to {now}");
            least = least.min(now);
            assert!(overlap(&simulation) < 1e-13, "gravity {gravity}");
            assert!(max_wall_overlap(simulation.world(), simulation.balls()) < 1e-13, "gravity {gravity}");
        }
        assert!((2000..60_000).contains(&hits(&simulation)), "gravity {gravity}: {:?}", simulation.tally());
        // Under the weakest of these they roll to and fro for longer.
        assert!(fastest(&simulation) == 0.0 || gravity < 1e4, "gravity {gravity}: {}", fastest(&simulation));
    }
}

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
        ("squeezed", include_str!("data/pockets/squeezed.toml")),
        ("one gives way", include_str!("data/pockets/one-gives-way.toml")),
        ("beside the floor", include_str!("data/pockets/beside-the-floor.toml")),
        ("slides in place", include_str!("data/pockets/slides-in-place.toml")),
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
    let mut wedge = Scene::parse("wedge", include_str!("data/pockets/wedge.toml")).unwrap().build().unwrap();
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

/// Balls of several sizes and one of `mass` times theirs, all of this restitution, that fall aslant.
fn among_lighter_ones(count: u32, mass: f64, restitution: f64, walls: f64, seed: u32) -> Simulation {
    let text = format!(
        "solver = \"exact\"\nsize = [300, 720]\ngravity = [300, 900]\n[walls]\nrestitution = {walls}\n[pairs]\n\
         [[ball]]\nposition = [150, 37.5]\nradius = 36.5\nmass = {mass}\nrestitution = {restitution}\n\
         [[fill]]\ncount = {count}\nradius = [6.3, 21.4]\nspeed = [0, 1000]\nmass = 1\n\
         restitution = {restitution}\nseed = {seed}\n"
    );
    Scene::parse("among lighter ones", &text).unwrap().build().unwrap()
}

/// Follows a heavy ball among lighter ones for six seconds.
fn assert_that_none_sinks_and_few_events_are_needed(mut simulation: Simulation, name: &str) {
    let mut before = energy(&simulation);
    let heaviest = simulation.balls().iter().map(Ball::mass).fold(0.0, f64::max);
    let scale = kinetic_energy(simulation.balls()) + heaviest * EARTH * 720.0;
    for frame in 0..360 {
        simulation.advance(1.0 / 60.0).unwrap();
        let (deepest, now) = (overlap(&simulation), energy(&simulation));
        assert!(deepest < 1e-13, "{name}: {deepest} of a radius in frame {frame}");
        assert!(now < before + 1e-6 * scale, "{name}: {before} rises to {now}");
        before = now;
    }
    assert!(hits(&simulation) < 200_000, "{name}: {}", hits(&simulation));
}

/// Where the heavy ball slides over a light one on the floor, that hopped between the two by the million, and then let others
/// sink into it.
#[test]
fn elastic_balls_between_walls_that_take_energy_have_few_events_and_never_lie_in_each_other() {
    for (count, mass, walls, seed) in
        [(10, 1e3, 0.0, 1), (10, 1e3, 0.0, 7), (30, 1e3, 0.0, 3), (30, 1.0, 0.5, 2), (10, 1e4, 0.5, 5)]
    {
        let name = format!("{count}, {mass}, {walls}");
        let simulation = among_lighter_ones(count, mass, 1.0, walls, seed);
        assert_that_none_sinks_and_few_events_are_needed(simulation, &name);
    }
}

#[test]
fn an_elastic_ball_hops_on_an_elastic_one_for_ever_unless_walls_take_energy() {
    for walls in [None, Some(1.0), Some(0.5)] {
        let world = World::new(DVec2::splat(400.0)).unwrap();
        let world = if let Some(walls) = walls { world.with_walls(walls).unwrap() } else { world };
        let world = world.with_gravity(DVec2::new(0.0, EARTH)).unwrap().with_pairs(Pairs::Impulse);
        let elastic = |y: f64| ball(200.0, y, 10.0).with_restitution(1.0).unwrap();
        // At half the rest speed, 2000 hops.
        let mut simulation = exact(world, vec![elastic(300.0).fixed(), moving(elastic(280.0), 0.0, -0.5)]);
        simulation.advance(2.05).unwrap();
        let speed = simulation.balls()[1].velocity().length();
        assert_eq!(speed > 0.0, walls != Some(0.5), "walls {walls:?}: {speed} px/s");
        let hops = simulation.tally().impacts;
        assert_eq!(hops > 2000, walls != Some(0.5), "walls {walls:?}: {hops}");
    }
}

/// Elastic balls in a box of 4000 x 2000 with these walls: place, velocity and mass of each, along a line.
fn on_a_line(walls: f64, gravity: DVec2, balls: &[(f64, f64, f64)]) -> Simulation {
    let world = World::new(DVec2::new(4000.0, 2000.0)).and_then(|world| world.with_walls(walls)).unwrap();
    let world = if gravity == DVec2::ZERO { world } else { world.with_gravity(gravity).unwrap() };
    let elastic = |&(x, speed, mass): &(f64, f64, f64)| {
        let ball = moving(ball(x, 1000.0, 10.0), speed, 0.0).with_restitution(1.0).unwrap();
        if mass.is_finite() { ball.with_mass(mass).unwrap() } else { ball.fixed() }
    };
    exact(world.with_pairs(Pairs::Impulse), balls.iter().map(elastic).collect())
}

/// What chattered among elastic balls was stopped as in a wedge, however fast, where any wall took energy.
#[test]
fn elastic_balls_chatter_without_loss_however_dull_walls_are_that_they_do_not_hit() {
    let between_heavy_ones = [(2000.0 + 1e-9, 0.0, 1e3), (1980.0, 0.0, 1.0), (1900.0, 100.0, 1e3)];
    let on_a_fixed_one = [(2000.0, 0.0, f64::INFINITY), (1979.95, 0.0, 1.0), (1959.9, 100.0, 1e8)];
    for (balls, gravity) in [
        (between_heavy_ones, DVec2::ZERO),
        (between_heavy_ones, 0.1 * DVec2::Y),
        (on_a_fixed_one, DVec2::ZERO),
    ] {
        let mut followed = [1.0, 0.99, 0.0].map(|walls| on_a_line(walls, gravity, &balls));
        let start = energy(&followed[0]);
        for simulation in &mut followed {
            simulation.advance(1.0).unwrap();
        }
        let [elastic, others @ ..] = &followed;
        assert!((energy(elastic) / start - 1.0).abs() < 1e-11, "{start} becomes {}", energy(elastic));
        for other in others {
            assert_eq!(other.balls(), elastic.balls());
            assert_eq!(other.tally(), elastic.tally());
        }
    }
}

/// All of the energy was lost where the light ball was so near the wall that it hit it thirty times and more in a moment.
#[test]
fn a_heavy_ball_drives_a_light_one_against_a_nearly_elastic_wall_and_comes_back() {
    for (mass, walls, least) in [(300.0, 0.999, 0.998), (1e4, 0.99999, 0.999_999)] {
        let balls = [(3990.0 - 1e-6, 0.0, 1.0), (3900.0, 300.0, mass)];
        let mut simulation = on_a_line(walls, DVec2::ZERO, &balls);
        let start = energy(&simulation);
        simulation.advance(1.0).unwrap();
        let left = energy(&simulation) / start;
        assert!((least..1.0).contains(&left), "{mass}, {walls}: {left}");
        assert!(simulation.balls()[1].velocity().x < 0.0);
    }
}

/// One after the other, it would take as many impacts to stop it as it is times as heavy, in each of its pockets.
#[test]
fn a_ball_of_a_million_times_the_mass_is_stopped_on_those_that_it_crushes_in_few_events() {
    for (restitution, walls, seed) in [(0.5, 0.5, 2), (0.0, 0.5, 12), (0.9, 0.0, 7)] {
        let simulation = among_lighter_ones(20, 1e6, restitution, walls, seed);
        let name = format!("restitution {restitution}, of walls {walls}");
        assert_that_none_sinks_and_few_events_are_needed(simulation, &name);
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

#[test]
fn a_ball_that_another_has_slid_off_is_not_shown_as_touching_it() {
    let (corner, slope) = (DVec2::new(20.0, 180.0), DVec2::new(0.5_f64.sin(), -(0.5_f64.cos())));
    let balls = [(corner, 20.0), (corner + 35.0 * slope, 15.0)].map(|(at, radius)| ball(at.x, at.y, radius));
    let mut simulation = exact(boxed(800.0, 200.0, EARTH), balls.to_vec());
    simulation.advance(10.0).unwrap();
    let apart = simulation.balls()[0].position().distance(simulation.balls()[1].position());
    assert!(apart > 100.0, "{apart}");
    simulation.advance(1.0 / 60.0).unwrap();
    assert_eq!(simulation.touching(), [false; 2]);
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
