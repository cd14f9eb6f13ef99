//! Elastic balls, and those that much heavier ones crush, between walls that take energy.

use super::*;

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

/// All of the energy was lost where the light ball was so near the wall that it hit it thirty times and more in a moment; later
/// none was. What is left, and how fast the heavy one comes back, is what arithmetic of sixty digits comes to, impact by impact.
#[test]
fn a_heavy_ball_drives_a_light_one_against_a_nearly_elastic_wall_and_comes_back() {
    for (mass, walls, kept, back) in [
        (300.0, 0.999, 0.973_117_295_370_904, -295.829_223_806_650),
        (1e4, 0.99999, 0.998_430_376_646_611, -299.764_032_197_177),
    ] {
        let balls = [(3990.0 - 1e-6, 0.0, 1.0), (3900.0, 300.0, mass)];
        let mut simulation = on_a_line(walls, DVec2::ZERO, &balls);
        let start = energy(&simulation);
        simulation.advance(1.0).unwrap();
        let left = energy(&simulation) / start;
        assert!((left - kept).abs() < 1e-9, "{mass}, {walls}: {left}");
        let speed = simulation.balls()[1].velocity().x;
        assert!((speed - back).abs() < 1e-6, "{mass}, {walls}: {speed} px/s");
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
