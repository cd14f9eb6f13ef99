//! The laws that the `exact` solver keeps: trajectories against 60-digit arithmetic, published counts, conservation,
//! and independence of the frame rate.

use std::fs;
use std::path::Path;

use carom::simulation::grid::Grid;
use carom::simulation::invariants::{
    kinetic_energy, max_overlap, max_wall_overlap, momentum, non_finite, potential_energy,
};
use carom::{Ball, DVec2, Pairs, Scene, Simulation, Solver, World};

#[path = "common/at_impacts.rs"]
mod at_impacts;

use at_impacts::Looks;

fn exact(scene: &str) -> Simulation {
    Scene::load(scene).unwrap().with_solver(Solver::Exact).build().unwrap()
}

fn world(width: f64, height: f64) -> World {
    World::new(DVec2::new(width, height)).unwrap()
}

fn ball(x: f64, y: f64, radius: f64, vx: f64, vy: f64) -> Ball {
    Ball::new(DVec2::new(x, y), radius).unwrap().with_velocity(DVec2::new(vx, vy)).unwrap()
}

fn gas(count: usize, speed: f64, seed: u64) -> Simulation {
    let side = (count as f64 * 9.0 * std::f64::consts::PI / 0.2).sqrt().ceil();
    let file = format!(
        "solver = \"exact\"\nsize = [{side}, {side}]\n[walls]\n[pairs]\n\
         [[fill]]\ncount = {count}\nradius = 3\nspeed = [0, {speed}]\nseed = {seed}\n"
    );
    Scene::parse("gas", &file).unwrap().build().unwrap()
}

fn state(simulation: &Simulation) -> Vec<u64> {
    let of = |ball: &Ball| {
        let (p, v) = (ball.position(), ball.velocity());
        [p.x, p.y, v.x, v.y].map(f64::to_bits)
    };
    simulation.balls().iter().flat_map(of).collect()
}

/// What momenta are small against.
fn sum_of_momenta(simulation: &Simulation) -> f64 {
    simulation.balls().iter().map(|ball| ball.mass() * ball.velocity().length()).sum()
}

fn energy(simulation: &Simulation) -> f64 {
    kinetic_energy(simulation.balls()) + potential_energy(simulation.world(), simulation.balls())
}

/// Advances by so many frames, and looks at impacts and at the end of each frame.
fn look_in_frames(looks: &mut Looks, simulation: &mut Simulation, frames: u32, seconds: f64) {
    for frame in 1..=frames {
        let end = f64::from(frame) * seconds;
        while simulation.time() < end {
            looks.advance(simulation, end - simulation.time());
        }
    }
}

/// The largest distance from the trajectories computed in 60-digit arithmetic, by time, with the impact counts equal.
fn errors_against_reference(scene: &str) -> Vec<(f64, f64)> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/data/exact-{scene}-1280x720.csv"));
    let mut simulation = exact(scene);
    let mut errors: Vec<(f64, f64)> = Vec::new();
    for line in fs::read_to_string(path).unwrap().lines().skip(1) {
        let row: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        if simulation.time() < row[0] {
            simulation.advance(row[0] - simulation.time()).unwrap();
            // The reference counts impacts on walls too.
            let hits = simulation.tally().impacts + simulation.tally().wall_hits;
            assert_eq!(hits, row[6] as u64, "{scene}: impacts at {} s", row[0]);
            errors.push((row[0], 0.0));
        }
        let error = (simulation.balls()[row[1] as usize].position() - DVec2::new(row[2], row[3])).length();
        let last = errors.last_mut().unwrap();
        last.1 = last.1.max(error);
    }
    errors
}

#[test]
fn trajectories_agree_with_sixty_digit_arithmetic_until_chaos_hides_them() {
    for scene in ["elastic", "gravity"] {
        for (time, error) in errors_against_reference(scene) {
            let most = match time {
                ..=0.25 => 1e-12,
                ..=0.5 => 5e-12,
                ..=1.0 => 2e-9,
                ..=1.5 => 2e-7,
                _ => 3e-6,
            };
            assert!(error <= most, "{scene}: {error:e} px at {time} s");
        }
    }
}

#[test]
fn the_state_at_five_seconds_is_the_same_to_the_last_bit_however_time_is_cut_into_frames() {
    for scene in ["elastic", "inelastic", "gravity"] {
        let run = |deltas: &[f64]| {
            let mut simulation = exact(scene);
            for &delta in deltas {
                simulation.advance(delta).unwrap();
            }
            state(&simulation)
        };
        let once = run(&[5.0]);
        assert_eq!(once, run(&[1.0 / 24.0; 120]), "{scene}");
        assert_eq!(once, run(&[1.0 / 60.0; 300]), "{scene}");
        assert_eq!(once, run(&[1.0 / 144.0; 720]), "{scene}");
        assert_eq!(once, run(&[0.0, 0.001, 1.249, 0.5, 0.0, 3.25]), "{scene}");
    }
}

#[test]
fn galperins_billiard_counts_the_digits_of_pi() {
    // Galperin (2003): a wall, a ball of mass 1, one of mass 100ⁿ that comes in: ⌊π·10ⁿ⌋ impacts in all.
    for (n, digits) in [(0, 3), (1, 31), (2, 314), (3, 3141), (4, 31_415), (5, 314_159), (6, 3_141_592)] {
        let light = ball(300.0, 50.0, 10.0, 0.0, 0.0);
        let heavy = ball(500.0, 50.0, 10.0, -100.0, 0.0).with_mass(100_f64.powi(n)).unwrap();
        let world = world(1e6, 100.0).with_walls(1.0).unwrap().with_pairs(Pairs::Impulse);
        let mut simulation = Simulation::new(world, vec![light, heavy], Solver::Exact).unwrap();
        // Both must have gone away for good, but not yet have reached the far wall.
        simulation.advance(200.0).unwrap();
        assert_eq!(simulation.tally().impacts + simulation.tally().wall_hits, digits, "n = {n}");
    }
}

/// Impacts that follow each other within a femtosecond counted as at one time, however fast balls are, and lost their energy.
#[test]
fn galperins_billiard_counts_the_digits_of_pi_in_any_room_and_at_any_speed() {
    for (n, digits) in [(4, 31_415), (5, 314_159)] {
        for (gap, speed) in [(1.0, 1e3), (0.01, 1e3), (1e-3, 1e5), (1e3, 1.0)] {
            let light = ball(10.0 + gap, 50.0, 10.0, 0.0, 0.0);
            let heavy = ball(30.0 + 2.0 * gap, 50.0, 10.0, -speed, 0.0).with_mass(100_f64.powi(n)).unwrap();
            let world = world(1e6, 100.0).with_walls(1.0).unwrap().with_pairs(Pairs::Impulse);
            let mut simulation = Simulation::new(world, vec![light, heavy], Solver::Exact).unwrap();
            simulation.advance(100.0 * gap.max(1.0) / speed).unwrap();
            let hits = simulation.tally().impacts + simulation.tally().wall_hits;
            assert_eq!(hits, digits, "n = {n}, {gap} px, {speed} px/s");
        }
    }
}

#[test]
fn a_ball_in_a_box_follows_the_unfolded_straight_line_for_a_million_bounces() {
    let world = world(1000.0, 700.0).with_walls(1.0).unwrap();
    let start = ball(200.0, 300.0, 10.0, 812_500.0, -431_250.0);
    let mut simulation = Simulation::new(world, vec![start], Solver::Exact).unwrap();
    simulation.advance(1024.0).unwrap();
    let fold = |at: f64, span: f64| {
        let within = at.rem_euclid(2.0 * span);
        if within > span { 2.0 * span - within } else { within }
    };
    let end = simulation.balls()[0].position();
    let x = 10.0 + fold(190.0 + 812_500.0 * 1024.0, 980.0);
    let y = 10.0 + fold(290.0 - 431_250.0 * 1024.0, 680.0);
    // 1e-14 of the path of nine hundred million pixels.
    assert!((end - DVec2::new(x, y)).length() < 1e-5, "{end} is not ({x}, {y})");
    assert!(simulation.tally().wall_hits > 1_000_000);
}

#[test]
fn a_dropped_ball_comes_to_rest_when_the_closed_form_says_so_within_the_tolerance() {
    let (height, gravity, e): (f64, f64, f64) = (400.0, 980.0, 0.8);
    let world = world(100.0, 500.0).with_walls(e).unwrap().with_gravity(DVec2::new(0.0, gravity)).unwrap();
    let mut simulation =
        Simulation::new(world, vec![ball(50.0, 90.0, 10.0, 0.0, 0.0)], Solver::Exact).unwrap();
    let rest = (2.0 * height / gravity).sqrt() * (1.0 + e) / (1.0 - e);
    // Hops slower than 1 px/s are left out: they would have taken 2u/g/(1 − e) at most. The last that is not begins
    // at less than 1/e px/s.
    simulation.advance(rest - 2.0 / gravity / (1.0 - e)).unwrap();
    assert!((simulation.balls()[0].position().y - 490.0).abs() < 1.0 / gravity);
    simulation.advance(2.0 / gravity / (1.0 - e)).unwrap();
    let end = simulation.balls()[0];
    assert_eq!((end.position(), end.velocity()), (DVec2::new(50.0, 490.0), DVec2::ZERO));
    simulation.advance(1e3).unwrap();
    assert_eq!(simulation.balls()[0], end);
}

#[test]
fn a_dropped_ball_comes_to_rest_in_place_of_its_first_hop_below_the_rest_speed_however_small_that_is() {
    let (height, gravity, e): (f64, f64, f64) = (400.0, 980.0, 0.8);
    let world = world(100.0, 500.0).with_walls(e).unwrap().with_gravity(DVec2::new(0.0, gravity)).unwrap();
    let rest = (2.0 * height / gravity).sqrt() * (1.0 + e) / (1.0 - e);
    for rest_speed in [10.0, 1.0, 1e-2, 1e-4, 1e-6, 1e-8] {
        let drop = Simulation::new(world, vec![ball(50.0, 90.0, 10.0, 0.0, 0.0)], Solver::Exact).unwrap();
        let mut drop = drop.with_rest_speed(rest_speed).unwrap();
        // The first hop slower than the rest speed u is left out, with those that would follow it: with v its speed it
        // rests 2v/g·(1 + e + e² + …) too early, less than 2u/g/(1 − e).
        let (mut speed, mut bounces) = (e * (2.0 * gravity * height).sqrt(), 1);
        while speed >= rest_speed {
            (speed, bounces) = (e * speed, bounces + 1);
        }
        let at_rest = rest - 2.0 * speed / gravity / (1.0 - e);
        // 1e-13 s: the rounding of a hundred hops' times.
        drop.advance(at_rest - 1e-13).unwrap();
        assert_ne!(drop.balls()[0].velocity().y, 0.0, "rest speed {rest_speed}: too early");
        drop.advance(2e-13).unwrap();
        assert_eq!(drop.balls()[0].velocity().y, 0.0, "rest speed {rest_speed}: too late");
        assert_eq!(drop.tally().wall_hits, bounces, "rest speed {rest_speed}");
    }
}

#[test]
fn where_balls_collapse_the_motion_converges_with_the_square_of_the_rest_speed() {
    // Frames so short that they show the smallest hops.
    let four_seconds = |rest_speed: f64| {
        let mut simulation = exact("gravity").with_rest_speed(rest_speed).unwrap();
        let show = |_| {
            simulation.advance(1e-4).unwrap();
            simulation.balls().iter().map(Ball::position).collect()
        };
        (0..40_000).map(show).collect::<Vec<Vec<DVec2>>>()
    };
    let error = |places: &Vec<DVec2>, limit: &Vec<DVec2>| {
        places.iter().zip(limit).map(|(place, limit)| place.distance(*limit)).fold(0.0, f64::max)
    };
    let limit = four_seconds(1e-7);
    for rest_speed in [8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125] {
        let frames = four_seconds(rest_speed);
        // Of a ball that lies where it would hop, the first hop is up to u²/2g high, and at least 0.8² times that, the
        // floor's restitution being 0.8; nothing hits it meanwhile.
        let hop = rest_speed * rest_speed / 2.0 / 980.0;
        let most = frames.iter().zip(&limit).map(|(frame, limit)| error(frame, limit)).fold(0.0, f64::max);
        assert!((0.64..1.0).contains(&(most / hop)), "rest speed {rest_speed}: {most:e} px");
    }
    // Once the hops would be over, too, nothing is left of that; but at 10 px/s one is hit before, and chaos multiplies
    // what is left out.
    for (rest_speed, most) in [(10.0, 2.0), (1.0, 1e-10), (1e-3, 1e-10), (1e-5, 1e-12)] {
        let error = error(&four_seconds(rest_speed)[39_999], &limit[39_999]);
        assert!(error < most, "rest speed {rest_speed}: {error:e} px");
    }
}

#[test]
fn an_advance_that_is_cut_short_goes_on_to_the_same_bits() {
    let whole = || gas(500, 400.0, 5);
    let mut once = whole();
    once.advance(3.0).unwrap();
    let mut pieces = whole();
    let mut looks = 0_u64;
    let mut cuts = 0;
    while pieces.time() < 3.0 {
        let asked = 3.0 - pieces.time();
        let before = pieces.time();
        let done = pieces
            .advance_while(asked, || {
                looks += 1;
                !looks.is_multiple_of(5)
            })
            .unwrap();
        assert!(done <= asked && pieces.time() == before + done);
        cuts += u32::from(done < asked);
    }
    assert!(cuts > 5, "{cuts}");
    assert_eq!(state(&once), state(&pieces));
}

#[test]
fn grains_among_boulders_overlap_nowhere_and_keep_their_energy() {
    // Radii over two decades: cells in levels.
    let file = "solver = \"exact\"\nsize = [600, 400]\n[walls]\n[pairs]\n\
                [[fill]]\ncount = 4\nradius = [40, 60]\nspeed = 100\n\
                [[fill]]\ncount = 30\nradius = [5, 12]\nspeed = 200\nseed = 2\n\
                [[fill]]\ncount = 1500\nradius = [0.5, 1.5]\nspeed = [100, 400]\nseed = 3\n";
    for gravity in [0.0, 200.0] {
        let mut simulation = Scene::parse("grains", file).unwrap().build().unwrap();
        simulation.set_gravity(DVec2::new(0.0, gravity)).unwrap();
        let start = energy(&simulation);
        let mut looks = Looks::new(&simulation);
        look_in_frames(&mut looks, &mut simulation, 150, 1.0 / 50.0);
        assert!(looks.seen > 100 && simulation.tally().impacts > 10_000, "{:?}", simulation.tally());
        // The rounding of coordinates of 600 px is 2·10⁻¹³ of a grain's radius.
        assert!(looks.overlap < 5e-13, "gravity {gravity}: {:e}", looks.overlap);
        assert!(looks.escape < 5e-13, "gravity {gravity}: {:e}", looks.escape);
        let drift = (energy(&simulation) / start - 1.0).abs();
        assert!(drift < 1e-14, "gravity {gravity}: {drift:e}");
    }
}

#[test]
fn balls_that_rest_on_each_other_are_shown_touching_in_every_frame_however_short() {
    // Two on the floor between the walls, one in the valley that they form.
    let world = world(42.0, 100.0).with_walls(0.5).unwrap().with_gravity(DVec2::new(0.0, 980.0)).unwrap();
    let soft = |x, y| ball(x, y, 10.0, 0.0, 0.0).with_restitution(0.5).unwrap();
    let balls = vec![soft(10.5, 90.0), soft(31.5, 90.0), soft(20.0, 50.0)];
    let pile = Simulation::new(world.with_pairs(Pairs::Impulse), balls, Solver::Exact);
    let mut pile = pile.unwrap();
    pile.advance(3.0).unwrap();
    for delta in [1.0 / 60.0, 1.0 / 144.0, 1e-3, 1e-4] {
        pile.advance(delta).unwrap();
        for frame in 0..500 {
            pile.advance(delta).unwrap();
            assert_eq!(pile.touching(), [true, true, true], "frame {frame} of {delta} s");
        }
    }
    let lowest = pile.balls()[2].position().y;
    assert!((lowest - (90.0 - (400.0_f64 - 121.0).sqrt())).abs() < 5e-4, "{lowest}");
}

#[test]
fn newtons_cradle_of_five_hands_the_velocity_on_exactly() {
    let world = world(1000.0, 100.0).with_pairs(Pairs::Impulse);
    let mut balls = vec![ball(100.0, 50.0, 10.0, 300.0, 0.0)];
    balls.extend((0..4).map(|i| ball(400.0 + 20.0 * f64::from(i), 50.0, 10.0, 0.0, 0.0)));
    let mut simulation = Simulation::new(world, balls, Solver::Exact).unwrap();
    simulation.advance(2.0).unwrap();
    let speeds: Vec<f64> = simulation.balls().iter().map(|ball| ball.velocity().x).collect();
    assert_eq!(speeds, [0.0, 0.0, 0.0, 0.0, 300.0]);
    assert_eq!(simulation.tally().impacts, 4);
}

#[test]
fn an_elastic_gas_keeps_its_energy_and_overlaps_nowhere() {
    let mut simulation = gas(1000, 200.0, 7);
    let start = energy(&simulation);
    let mut looks = Looks::new(&simulation);
    look_in_frames(&mut looks, &mut simulation, 600, 1.0 / 60.0);
    let drift = (energy(&simulation) / start - 1.0).abs();
    assert!(looks.seen > 100 && simulation.tally().impacts > 20_000, "{:?}", simulation.tally());
    // The rounding of coordinates of 1200 px is 8·10⁻¹⁴ of the radius.
    assert!(looks.overlap < 1e-13, "overlap {:e}", looks.overlap);
    assert!(looks.escape < 1e-13, "escape {:e}", looks.escape);
    assert!(drift < 1e-14, "{drift:e}");
}

#[test]
fn energy_never_rises_and_balls_under_gravity_come_to_rest_for_good() {
    // Without gravity two slow ones go to and fro between walls still.
    for (scene, most) in [("inelastic", 30), ("gravity", 0)] {
        let mut simulation = exact(scene);
        let mut before = energy(&simulation);
        // What hops at half the rest speed may add, for all balls together.
        let tolerance: f64 = simulation.balls().iter().map(|ball| 0.5 * ball.mass() * 0.5_f64.powi(2)).sum();
        let mut grid = Grid::new(simulation.balls(), simulation.world().size());
        for frame in 0..60 * 60 {
            simulation.advance(1.0 / 60.0).unwrap();
            let now = energy(&simulation);
            assert!(now <= before + tolerance, "{scene}, frame {frame}: {before} rose to {now}");
            before = before.min(now);
            assert_eq!(non_finite(simulation.balls()), 0);
            let overlap = max_overlap(&mut grid, simulation.balls());
            assert!(overlap < 1e-13, "{scene}, frame {frame}: overlap {overlap:e}");
        }
        let hits = |simulation: &Simulation| simulation.tally().impacts + simulation.tally().wall_hits;
        let settled = hits(&simulation);
        assert!(settled < 30_000, "{scene}: {settled} in a minute");
        simulation.advance(10.0).unwrap();
        assert!(hits(&simulation) - settled <= most, "{scene}: {} in 10 s", hits(&simulation) - settled);
    }
}

#[test]
fn a_crowd_under_oblique_gravity_stays_inside_and_gains_no_energy_and_keeps_it_where_it_is_elastic() {
    for (index, e) in [0.0, 1e-12, 0.3, 0.7, 0.999, 1.0].into_iter().enumerate() {
        for gravity in ["0, 980", "-300, -700"] {
            let file = format!(
                "solver = \"exact\"\nsize = [400, 300]\ngravity = [{gravity}]\n[walls]\nrestitution = {e}\n[pairs]\n\
                 [[fill]]\ncount = 30\nradius = [4, 12]\nspeed = [0, 300]\nrestitution = {e}\nseed = {index}\n"
            );
            let mut simulation = Scene::parse("crowd", &file).unwrap().build().unwrap();
            let mut grid = Grid::new(simulation.balls(), simulation.world().size());
            let start = energy(&simulation);
            let mut before = start;
            let mass: f64 = simulation.balls().iter().map(Ball::mass).sum();
            for _ in 0..120 {
                simulation.advance(1.0 / 60.0).unwrap();
                let now = energy(&simulation);
                // What hops at half the rest speed may add, where a ball loses enough to come to rest.
                let hops = if e < 0.5 { 0.125 * mass } else { 0.0 };
                assert!(now <= before + 1e-14 * start + hops, "e = {e}: {before} rose to {now}");
                assert!(e < 1.0 || now >= start * (1.0 - 1e-14), "{start} became {now}");
                before = before.min(now);
                assert_eq!(non_finite(simulation.balls()), 0);
                assert!(max_overlap(&mut grid, simulation.balls()) < 1e-13, "e = {e}");
                assert!(max_wall_overlap(simulation.world(), simulation.balls()) < 1e-13, "e = {e}");
            }
        }
    }
}

#[test]
fn momentum_is_kept_without_walls() {
    let file = "solver = \"exact\"\nsize = [400, 400]\n[pairs]\n[[fill]]\ncount = 300\nradius = [3, 9]\nspeed = [0, 300]\ndensity = 1\n";
    let mut simulation = Scene::parse("free", file).unwrap().build().unwrap();
    let start = momentum(simulation.balls());
    simulation.advance(5.0).unwrap();
    assert!(simulation.tally().impacts > 1000);
    assert!((momentum(simulation.balls()) - start).length() < 1e-15 * sum_of_momenta(&simulation));
}

#[test]
fn momentum_with_the_share_of_the_walls_is_kept() {
    let mut simulation = gas(1000, 200.0, 3);
    let start = momentum(simulation.balls());
    simulation.advance(20.0).unwrap();
    assert!(simulation.tally().impacts > 50_000 && simulation.tally().wall_hits > 5_000);
    let change = momentum(simulation.balls()) - start - simulation.tally().wall_impulse;
    // After 10⁷ impacts: `exact_gas.rs`.
    assert!(change.length() < 2e-15 * sum_of_momenta(&simulation), "{change}");
}

#[test]
fn unequal_masses_come_to_equal_mean_energies() {
    // Equipartition (Maxwell 1860).
    let file = "solver = \"exact\"\nsize = [300, 300]\n[walls]\n[pairs]\n\
                [[fill]]\ncount = 100\nradius = 4\nspeed = 200\nmass = 1\n\
                [[fill]]\ncount = 100\nradius = 4\nspeed = 200\nmass = 16\nseed = 2\n";
    let mut simulation = Scene::parse("mixture", file).unwrap().build().unwrap();
    simulation.advance(20.0).unwrap();
    let (mut light, mut heavy) = (0.0, 0.0);
    for _ in 0..2000 {
        simulation.advance(0.05).unwrap();
        light += kinetic_energy(&simulation.balls()[..100]);
        heavy += kinetic_energy(&simulation.balls()[100..]);
    }
    assert!((light / heavy - 1.0).abs() < 0.03, "{}", light / heavy);
}

#[test]
fn in_detect_a_ball_is_flagged_from_its_entry_to_its_exit_and_in_no_other_frame() {
    let world = world(1000.0, 400.0).with_walls(1.0).unwrap().with_pairs(Pairs::Detect);
    let balls = vec![
        ball(100.0, 100.0, 30.0, 200.0, 0.0),
        ball(502.0, 130.0, 20.0, -100.0, 0.0),
        // Bounces off the floor into a third and out of it again.
        ball(700.0, 299.0, 10.0, 0.0, 300.0),
        ball(700.0, 200.0, 20.0, 0.0, 0.0),
    ];
    // |Δ| = 50 with Δ = (402 − 300t, 30): 300t = 402 ∓ 40. The third has 91 px to fall, and 160 … 220 to rise.
    let overlaps = [(362.0 / 300.0, 442.0 / 300.0), (251.0 / 300.0, 311.0 / 300.0)];
    for rate in [7.0, 60.0, 1000.0] {
        let mut simulation = Simulation::new(world, balls.clone(), Solver::Exact).unwrap();
        let frames = (1.6 * rate) as u32;
        for frame in 1..=frames {
            simulation.advance(1.0 / rate).unwrap();
            let (from, to) = (f64::from(frame - 1) / rate, f64::from(frame) / rate);
            let expected = overlaps.map(|(entry, exit)| entry <= to && exit >= from);
            let [first, second] = expected;
            assert_eq!(simulation.touching(), [first, first, second, second], "frame {frame} at {rate} Hz");
        }
        assert_eq!(simulation.tally().impacts, 0);
    }
}

#[test]
fn in_detect_what_overlaps_at_the_moment_of_a_frame_is_flagged_with_gravity_too() {
    for gravity in [0.0, 980.0] {
        let mut simulation = exact("walls");
        simulation.set_gravity(DVec2::new(0.0, gravity)).unwrap();
        let mut grid = Grid::new(simulation.balls(), simulation.world().size());
        let (mut flagged, mut overlapping) = (0, 0);
        for _ in 0..20_000 {
            simulation.advance(1e-3).unwrap();
            let mut now = vec![false; simulation.balls().len()];
            grid.for_each(simulation.balls(), |i, j| (now[i as usize], now[j as usize]) = (true, true));
            for (ball, (now, flag)) in now.iter().zip(simulation.touching()).enumerate() {
                assert!(*flag || !now, "ball {ball} at {}", simulation.time());
                flagged += u32::from(*flag);
                overlapping += u32::from(*now);
            }
        }
        // A frame in which balls part counts too, and little else.
        assert!(overlapping > 20_000 && flagged < overlapping + overlapping / 50, "{flagged} {overlapping}");
    }
}

#[test]
fn a_window_that_becomes_narrower_gives_a_gas_no_energy() {
    for frames in [1, 7, 28] {
        let mut gas = Scene::load("gas").unwrap().with_solver(Solver::Exact).build().unwrap();
        let start = kinetic_energy(gas.balls());
        for frame in 1..=frames {
            gas.resize(DVec2::new(1280.0 - 280.0 * f64::from(frame) / f64::from(frames), 720.0)).unwrap();
            gas.advance(1.0 / 60.0).unwrap();
        }
        let overlap = max_overlap(&mut Grid::new(gas.balls(), gas.world().size()), gas.balls());
        assert!(overlap < 1e-13, "{overlap} after {frames} frames");
        let kept = kinetic_energy(gas.balls()) / start - 1.0;
        assert!(kept.abs() < 2e-14, "{kept:e} after {frames} frames");
    }
}
