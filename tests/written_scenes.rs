//! A simulation that is written as a scene file and read again is the same simulation, to the bit.

use carom::scene::{self, Rain};
use carom::simulation::limits::{COORDINATE, SIZE, VELOCITY};
use carom::{Ball, DVec2, Pairs, Scene, Simulation, Solver, World};
use proptest::prelude::*;

fn read(text: &str) -> (Scene, Simulation) {
    let scene = Scene::parse("written.toml", text).unwrap_or_else(|error| panic!("{error}"));
    let simulation = scene.build().unwrap_or_else(|error| panic!("{error}"));
    (scene, simulation)
}

fn written_and_read(simulation: &Simulation) -> Simulation {
    read(&scene::write(simulation, None, "")).1
}

/// All of a ball, as bits: == takes −0 for 0. Of a velocity, that is written as 0.
fn bits(ball: &Ball) -> [u64; 7] {
    let (p, v) = (ball.position(), ball.velocity());
    [p.x, p.y, v.x + 0.0, v.y + 0.0, ball.radius(), ball.mass(), ball.restitution()].map(f64::to_bits)
}

fn world_bits(world: &World) -> (Vec<u64>, Option<Pairs>) {
    let gravity = world.gravity().map(|gravity| gravity.to_array());
    let numbers = [world.size().x, world.size().y].into_iter().chain(gravity.into_iter().flatten());
    let walls = world.walls().map_or(u64::MAX, f64::to_bits);
    (numbers.map(f64::to_bits).chain([walls]).collect(), world.pairs())
}

#[track_caller]
fn assert_same(one: &Simulation, other: &Simulation) {
    assert_eq!(world_bits(one.world()), world_bits(other.world()));
    assert_eq!(one.solver(), other.solver());
    assert_eq!(one.balls().len(), other.balls().len());
    for (index, (one, other)) in one.balls().iter().zip(other.balls()).enumerate() {
        assert_eq!(bits(one), bits(other), "ball {index}: {one:?} and {other:?}");
    }
}

/// Numbers from a closed range: plain ones, ones of any size, the ends, and both zeros where they are in it.
fn number(low: f64, high: f64) -> impl Strategy<Value = f64> {
    let any = any::<f64>().prop_filter_map("in range", move |value| {
        [value, 1.0 / value].into_iter().find(|value| (low..=high).contains(value))
    });
    let zeros =
        prop_oneof![Just(0.0), Just(-0.0)].prop_map(move |zero: f64| if low <= 0.0 { zero } else { low });
    prop_oneof![4 => low..=high, 4 => low.max(-1e4)..=high.min(1e4), 2 => any, 1 => zeros, 1 => Just(low), 1 => Just(high)]
}

fn vector(low: f64, high: f64) -> impl Strategy<Value = DVec2> {
    (number(low, high), number(low, high)).prop_map(|(x, y)| DVec2::new(x, y))
}

prop_compose! {
    fn ball()(
        position in vector(-1e9, 1e9),
        radius in number(1e-6, 1e9),
        velocity in vector(-1e9, 1e9),
        mass in number(1e-30, 1e30),
        restitution in number(0.0, 1.0),
        kind in 0..6,
    ) -> Ball {
        let plain = Ball::new(position, radius).unwrap();
        let whole = plain.with_velocity(velocity).unwrap().with_mass(mass).unwrap();
        match kind {
            0 => plain,
            1 => plain.fixed(),
            2 => plain.with_restitution(restitution).unwrap().fixed(),
            _ => whole.with_restitution(restitution).unwrap(),
        }
    }
}

prop_compose! {
    fn simulation()(
        size in vector(1.0, 1e6),
        gravity in vector(-1e9, 1e9),
        with_gravity in any::<bool>(),
        walls in prop::option::of(number(0.0, 1.0)),
        pairs in prop_oneof![Just(None), Just(Some(Pairs::Detect)), Just(Some(Pairs::Impulse))],
        solver in prop::sample::select(Solver::ALL),
        balls in prop::collection::vec(ball(), 0..8),
    ) -> Simulation {
        let mut world = World::new(size).unwrap();
        if with_gravity {
            world = world.with_gravity(gravity).unwrap();
        }
        if let Some(restitution) = walls {
            world = world.with_walls(restitution).unwrap();
        }
        if let Some(pairs) = pairs {
            world = world.with_pairs(pairs);
        }
        // Between walls there are only balls that fit.
        let fits = |ball: &Ball| walls.is_none() || 2.0 * ball.radius() <= size.min_element();
        Simulation::new(world, balls.into_iter().filter(fits).collect(), solver).unwrap()
    }
}

proptest! {
    #[test]
    fn any_simulation_reads_back_to_the_bit(simulation in simulation()) {
        assert_same(&simulation, &written_and_read(&simulation));
    }

    #[test]
    fn any_text_reads_back(about in any::<String>(), controls in "[\\x00-\\x1f\\x7f\"'\\\\é\u{85}\u{2028}\u{feff}]{0,40}") {
        let simulation = Simulation::new(World::new(DVec2::ONE).unwrap(), Vec::new(), Solver::Exact).unwrap();
        for about in [about, controls] {
            let (scene, _) = read(&scene::write(&simulation, None, &about));
            prop_assert_eq!(scene.about(), about);
        }
    }
}

#[test]
fn every_built_in_scene_reads_back_as_the_same_simulation() {
    for name in scene::names() {
        let scene = Scene::load(name).unwrap();
        let simulation = scene.build().unwrap();
        let (again, read) = read(&scene::write(&simulation, scene.rain().as_ref(), scene.about()));
        assert_same(&simulation, &read);
        assert_eq!((again.about(), again.rain()), (scene.about(), scene.rain()), "{name}");
    }
}

#[test]
fn every_built_in_scene_reads_back_after_it_has_run_in_a_window_of_another_size() {
    for name in scene::names() {
        for solver in [Solver::Canvas, Solver::Contact] {
            let scene = Scene::load(name).unwrap().with_solver(solver);
            let mut simulation = scene.build().unwrap();
            // 1000×500 pixels of a screen with a scale factor of 1.5.
            simulation.resize(DVec2::new(1000.0, 500.0) / 1.5).unwrap();
            for _ in 0..30 {
                simulation.advance(1.0 / 60.0).unwrap();
            }
            assert_same(&simulation, &written_and_read(&simulation));
        }
    }
}

#[test]
fn what_goes_on_from_a_file_goes_on_as_with_a_solver_made_anew() {
    for solver in Solver::ALL {
        let mut simulation = Scene::load("gravity").unwrap().with_solver(*solver).build().unwrap();
        simulation.advance(0.7).unwrap();
        let mut again = written_and_read(&simulation);
        simulation.set_solver(*solver);
        for _ in 0..30 {
            simulation.advance(1.0 / 60.0).unwrap();
            again.advance(1.0 / 60.0).unwrap();
        }
        assert_same(&simulation, &again);
    }
}

#[test]
fn balls_wider_than_a_world_without_walls_read_back() {
    let world = World::new(DVec2::new(100.0, 10.0)).unwrap();
    let ball = |radius| Ball::new(DVec2::new(50.0, 8.0), radius).unwrap();
    let balls = vec![ball(5.0), ball(5.0_f64.next_up()), ball(1e9), ball(300.0).fixed()];
    let simulation = Simulation::new(world, balls, Solver::Exact).unwrap();
    assert_same(&simulation, &written_and_read(&simulation));
}

#[test]
fn balls_beyond_the_limits_are_brought_to_them_and_counted() {
    let world = World::new(DVec2::splat(SIZE.high)).unwrap().with_gravity(DVec2::new(0.0, 1e9)).unwrap();
    let ball = Ball::new(DVec2::new(3.0, 4.0), 1.0).unwrap();
    let mut simulation = Simulation::new(world, vec![ball, ball.fixed()], Solver::Exact).unwrap();
    assert!(!scene::write(&simulation, None, "").starts_with('#'));
    simulation.advance(1e6).unwrap();
    assert!(simulation.balls()[0].velocity().y > VELOCITY.high && simulation.balls()[0].position().y > 1e20);
    let text = scene::write(&simulation, None, "");
    assert!(text.starts_with("# 1 ball was farther or faster"), "{text}");
    let (_, read) = read(&text);
    let [gone, fixed] = read.balls() else { panic!("{text}") };
    assert_eq!(
        (gone.position(), gone.velocity()),
        (DVec2::new(3.0, COORDINATE.high), DVec2::new(0.0, VELOCITY.high))
    );
    assert_eq!(bits(fixed), bits(&ball.fixed()));
}

const RAIN: &str = "size = [400, 300]\n[walls]\n[rain]\nrate = 2.5\nradius = [5, 8]\nspeed = [0, 7]\nmass = 3\n\
                    restitution = 0.3\nseed = 9\nregion = [100, 20, 400, 120]\n";

/// The rain in a world that was made smaller, written and read.
fn rain_in(width: f64, height: f64) -> (String, Option<Rain>) {
    let (scene, mut simulation) = read(RAIN);
    simulation.resize(DVec2::new(width, height)).unwrap();
    let text = scene::write(&simulation, scene.rain().as_ref(), "");
    let rain = read(&text).0.rain();
    (text, rain)
}

#[test]
fn rain_reads_back_and_is_cut_to_a_smaller_world() {
    let rain = read(RAIN).0.rain();
    assert_eq!(rain_in(400.0, 300.0).1, rain);
    assert_eq!(rain_in(400.0, 120.0).1, rain);
    let (text, cut) = rain_in(350.5, 60.0);
    assert!(cut.is_some() && text.contains("\nregion = [100, 20, 350.5, 60]\n"), "{text}");
    let (text, none) = rain_in(110.0, 60.0);
    assert!(none.is_none() && text.contains("\n# The rain is left out"), "{text}");
}

#[test]
fn any_seed_of_rain_that_a_file_may_have_reads_back() {
    for seed in [0, 1, u64::MAX] {
        let text = RAIN.replace("seed = 9", &format!("seed = {seed}"));
        let (scene, simulation) = read(&text);
        assert_eq!(read(&scene::write(&simulation, scene.rain().as_ref(), "")).0.rain(), scene.rain());
    }
}

#[test]
fn no_ball_takes_more_than_256_bytes() {
    // Numbers of the most digits: a sign, 17 digits with a point, and three of an exponent.
    let digits = -1.234_567_890_123_456_7e-300;
    let world = World::new(DVec2::ONE).unwrap();
    let ball = Ball::new(DVec2::splat(digits), 123_456.789_012_345_67).unwrap();
    let ball = ball.with_velocity(DVec2::splat(digits)).unwrap().with_restitution(-digits).unwrap();
    let ball = ball.with_mass(1.234_567_890_123_456_7e-29).unwrap();
    let length = |count: usize| {
        let simulation = Simulation::new(world, vec![ball; count], Solver::Exact).unwrap();
        scene::write(&simulation, None, "").len()
    };
    assert!((240..=256).contains(&(length(2) - length(1))), "{} bytes", length(2) - length(1));
}

#[test]
fn what_is_not_said_is_left_out() {
    let mut simulation = Scene::load("two").unwrap().build().unwrap();
    simulation.advance(0.5).unwrap();
    assert_eq!(
        scene::write(&simulation, None, "Two \"balls\"\n"),
        "about = \"Two \\\"balls\\\"\\n\"\nsolver = \"canvas\"\nsize = [1280, 720]\n\n\
         [[ball]]\nposition = [106, 112.5]\nradius = 60\nvelocity = [12, 25]\n\n\
         [[ball]]\nposition = [215, 202.5]\nradius = 30\nvelocity = [70, 45]\n"
    );
}
