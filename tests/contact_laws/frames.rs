//! Frames evaluate substeps: whatever they are, the result is one, and in free flight that of `exact`.

use carom::simulation::ledger::Ledger;

use super::numbers::random;
use super::*;

#[test]
fn free_flight_follows_the_parabola_whatever_the_frames() {
    let world = World::new(DVec2::splat(1000.0)).unwrap().with_gravity(EARTH).unwrap();
    let mut simulation = simulation(world, vec![moving(ball(0.0, 0.0, 5.0), 100.0, -300.0)]);
    for delta in [0.013, 1.0 / 144.0, 0.5, 0.0, 0.25, 0.003] {
        simulation.advance(delta).unwrap();
        let t = simulation.time();
        let want = DVec2::new(100.0 * t, -300.0 * t + 490.0 * t * t);
        assert!(simulation.balls()[0].position().distance(want) < 1e-9);
        assert!((simulation.balls()[0].velocity() - DVec2::new(100.0, -300.0 + 980.0 * t)).length() < 1e-9);
    }
}

/// The state of a scene after some seconds in frames of these deltas.
fn after(seconds: f64, scene: &Scene, deltas: impl IntoIterator<Item = f64>) -> Vec<Ball> {
    let mut simulation = scene.build().unwrap();
    for delta in deltas {
        simulation.advance(delta).unwrap();
    }
    assert!((simulation.time() - seconds).abs() < 1e-9);
    simulation.balls().to_vec()
}

#[test]
fn the_result_does_not_depend_on_how_time_is_cut_into_frames() {
    let scene = Scene::load("gravity").unwrap().with_solver(Solver::Contact);
    // Substeps are taken from 4.5 s on.
    let once = after(6.0, &scene, [6.0]);
    for rate in [24, 60, 75, 144, 240, 1000] {
        let frames = std::iter::repeat_n(1.0 / f64::from(rate), 6 * rate as usize);
        assert_eq!(after(6.0, &scene, frames), once, "{rate} frames a second");
    }
    let irregular = [0.0, 4.3, 0.001, 0.699, 1e-9, 1.0 - 1e-9];
    assert_eq!(after(6.0, &scene, irregular), once);
}

/// Many that fall: substeps are halved while many are hit, and whole before and after.
fn many() -> Scene {
    many_that("")
}

/// The same where the balls are also as this says.
fn many_that(are: &str) -> Scene {
    let text = "solver = \"contact\"\nsize = [400, 300]\ngravity = [0, 980]\n[walls]\nrestitution = 0.7\n[pairs]\n\
                [[fill]]\ncount = 300\nradius = [4, 8]\nrestitution = 0.7\n";
    Scene::parse("many", &format!("{text}{are}")).unwrap()
}

#[test]
fn the_result_for_many_does_not_depend_on_frames_that_end_within_substeps() {
    let scene = many();
    for seconds in [0.25, 1.0 + 1.0 / 240.0, 3.0] {
        let once = after(seconds, &scene, [seconds]);
        for rate in [24.0, 60.0, 144.0, 240.0, 1000.0] {
            let whole = (seconds * rate) as usize;
            let rest = seconds - whole as f64 / rate;
            let frames = std::iter::repeat_n(1.0 / rate, whole).chain([rest]);
            assert_eq!(after(seconds, &scene, frames), once, "{seconds} s at {rate} frames a second");
        }
    }
}

#[test]
fn within_a_substep_no_ball_is_shown_in_a_wall_or_far_from_where_it_was() {
    let tilted = "solver = \"contact\"\nsize = [400, 300]\ngravity = [140, 980]\n[walls]\n[pairs]\n\
                  [[fill]]\ncount = 300\nradius = [4, 8]\nspeed = 500\nseed = 2\n";
    // Where many are held, what impacts gave a ball may be taken from it: it is not shown where that would have led.
    for scene in [many_that("speed = 500"), Scene::parse("tilted", tilted).unwrap()] {
        let mut simulation = scene.build().unwrap();
        let frame = 1.0 / 3777.0;
        for _ in 0..3777 {
            let before = simulation.balls().to_vec();
            simulation.advance(frame).unwrap();
            assert!(max_wall_overlap(simulation.world(), simulation.balls()) < 1e-9);
            for (old, new) in before.iter().zip(simulation.balls()) {
                let way = frame * old.velocity().length().max(new.velocity().length());
                let jump = old.position().distance(new.position()) - way;
                assert!(jump < 0.15, "{jump} px at {} s", simulation.time());
            }
        }
    }
}

#[test]
fn a_run_that_is_stopped_goes_on_from_there() {
    for scene in [Scene::load("gravity").unwrap().with_solver(Solver::Contact), many()] {
        let whole = after(2.0, &scene, [2.0]);
        let mut simulation = scene.build().unwrap();
        let mut left = 2.0;
        while left > 1e-9 {
            let mut looks = 0;
            let done = simulation
                .advance_while(left, || {
                    looks += 1;
                    looks < 7
                })
                .unwrap();
            assert!(done > 0.0);
            left -= done;
        }
        let apart = whole.iter().zip(simulation.balls()).map(|(a, b)| a.position().distance(b.position()));
        assert!(apart.fold(0.0, f64::max) < 1e-6);
    }
}

#[test]
fn contact_agrees_with_exact_until_chaos_parts_them() {
    let mut exact = Scene::load("elastic").unwrap().build().unwrap();
    let mut contact = Scene::load("elastic").unwrap().with_solver(Solver::Contact).build().unwrap();
    assert_eq!(exact.solver(), Solver::Exact);
    for _ in 0..60 {
        exact.advance(FRAME).unwrap();
        contact.advance(FRAME).unwrap();
    }
    let apart = exact.balls().iter().zip(contact.balls()).map(|(a, b)| a.position().distance(b.position()));
    assert!(apart.fold(0.0, f64::max) < 1e-6);
    assert_eq!(exact.tally().impacts, contact.tally().impacts);
}

#[test]
fn within_a_substep_flying_balls_are_where_exact_has_them_as_fast_as_they_are_there() {
    for (scene, seconds) in [("walls", 1.0), ("elastic", 1.0), ("inelastic", 1.0), ("gravity", 0.5)] {
        let build = |solver| Scene::load(scene).unwrap().with_solver(solver).build().unwrap();
        // Elastic balls take substeps only where they are asked for. Frames end in every part of them.
        let (mut exact, mut contact) =
            (build(Solver::Exact), build(Solver::Contact).with_substeps(240).unwrap());
        let mut impacts = 0;
        while contact.time() < seconds {
            contact.advance(1.0 / 1009.0).unwrap();
            exact.advance(1.0 / 1009.0).unwrap();
            let (apart, faster) = apart(&contact, &exact);
            assert!(apart < 1e-5, "{scene} after {} s: {apart} px", contact.time());
            assert!(faster < 1e-4, "{scene} after {} s: {faster} px/s", contact.time());
            impacts = contact.tally().impacts + contact.tally().wall_hits;
        }
        assert!(impacts >= 10, "{scene}: {impacts} impacts");
    }
}

/// A second click of the mouse does so before the next frame. The solver did not know it yet, and panicked.
#[test]
fn a_ball_that_was_added_is_thrown_before_anything_moves() {
    for added in [1_u32, 2, 5] {
        let begun = vec![ball(50.0, 290.0, 10.0), ball(70.0, 290.0, 10.0)];
        let mut simulation = simulation(world(400.0, 300.0, 0.5).with_gravity(EARTH).unwrap(), begun);
        simulation.advance(1.0).unwrap();
        let place = |k: u32| DVec2::new(120.0 + 25.0 * f64::from(k), 100.0);
        let more: Vec<_> = (0..added).map(|k| ball(place(k).x, place(k).y, 10.0)).collect();
        simulation.add(&more).unwrap();
        let thrown = DVec2::new(0.0, -200.0);
        (0..added as usize).for_each(|k| simulation.set_velocity(2 + k, thrown).unwrap());
        simulation.advance(0.25).unwrap();
        for (ball, k) in simulation.balls()[2..].iter().zip(0..) {
            let law = place(k) + 0.25 * thrown + 0.5 * 0.25 * 0.25 * EARTH;
            assert!(ball.position().distance(law) < 1e-9, "{} is not {law}", ball.position());
        }
    }
}

#[test]
fn a_ball_that_lies_is_thrown_from_where_it_lies_and_flies_as_in_exact() {
    let on_floor = |radius: f64| ball(200.0, 300.0 - radius, radius);
    let thrown_ball = |below: f64| ball(200.0, 290.0 - 2.0 * below, 10.0);
    for under in [None, Some(on_floor(15.0)), Some(on_floor(15.0).fixed())] {
        for (begun, thrown) in [(0.0, -300.0), (1.0, -300.0), (1.0, -20.0), (3.0, -100.0), (1.004, -300.0)] {
            let balls = [Some(thrown_ball(under.map_or(0.0, |ball| ball.radius()))), under];
            let world = world(400.0, 300.0, 0.5).with_gravity(EARTH).unwrap();
            let mut simulation = simulation(world, balls.into_iter().flatten().collect());
            simulation.advance(begun).unwrap();
            simulation.set_velocity(0, DVec2::new(50.0, thrown)).unwrap();
            let from = simulation.balls()[0].position();
            simulation.advance(0.0).unwrap();
            let shown = simulation.balls()[0].velocity();
            assert!((shown - DVec2::new(50.0, thrown)).length() < 1e-9, "{under:?}, {begun}: {shown}");
            // At once, also within a substep.
            let seconds = 0.03;
            simulation.advance(seconds).unwrap();
            let (place, velocity) = (simulation.balls()[0].position(), simulation.balls()[0].velocity());
            let flown = thrown * seconds + 490.0 * seconds * seconds;
            assert!(
                (place.y - from.y - flown).abs() < 1e-3,
                "{under:?}, {begun}, {thrown}: {place} from {from}"
            );
            let slower = velocity.y - thrown;
            assert!((slower - 980.0 * seconds).abs() < 1e-3, "{under:?}, {begun}, {thrown}: {velocity}");
        }
    }
}

#[test]
fn flying_balls_fly_as_in_exact_whatever_the_substep() {
    for (scene, time, slowest, bound) in
        [("elastic", 1.0, 30, 1e-5), ("inelastic", 1.0, 60, 1e-7), ("gravity", 0.5, 30, 1e-8)]
    {
        let build = |solver| Scene::load(scene).unwrap().with_solver(solver).build().unwrap();
        let mut exact = build(Solver::Exact).with_rest_speed(1e-6).unwrap();
        exact.advance(time).unwrap();
        for doublings in 0..7 {
            let mut contact = build(Solver::Contact).with_substeps(slowest << doublings).unwrap();
            contact.advance(time).unwrap();
            let (error, _) = apart(&contact, &exact);
            assert!(error < bound, "{scene} in substeps of 1/{}: {error:e}", slowest << doublings);
            assert_eq!(contact.tally().impacts, exact.tally().impacts);
        }
    }
}

#[test]
fn one_ball_and_any_that_do_not_notice_each_other_fly_and_bounce_to_the_bits_of_exact() {
    let box_of = world(900.0, 600.0, 0.9).with_gravity(EARTH).unwrap();
    let unnoticed = World::new(box_of.size()).unwrap().with_walls(0.9).unwrap().with_gravity(EARTH).unwrap();
    let mut random = random(7);
    let mut any = || {
        let place = ball(20.0 + 860.0 * random(), 20.0 + 560.0 * random(), 10.0);
        moving(place, 800.0 * random() - 400.0, 800.0 * random() - 400.0)
    };
    let one = vec![any()];
    // Many lie in each other.
    let crowd: Vec<Ball> = (0..500).map(|_| any()).collect();
    // One wide, into whose corner gravity presses them.
    let shaft = World::new(DVec2::new(20.1, 600.0)).unwrap().with_walls(0.5).unwrap();
    let shaft = shaft.with_gravity(DVec2::new(300.0, 980.0)).unwrap();
    let in_shaft = |k: u32| moving(ball(10.05, 20.0 + 9.0 * f64::from(k), 10.0), f64::from(k) - 30.0, 50.0);
    let row: Vec<Ball> = (0..60).map(in_shaft).collect();
    for (world, balls, frames) in [(box_of, one, 240), (unnoticed, crowd, 3600), (shaft, row, 3600)] {
        let [mut contact, mut exact] = [Solver::Contact, Solver::Exact]
            .map(|solver| Simulation::new(world, balls.clone(), solver).unwrap());
        for _ in 0..frames {
            contact.advance(1.0 / 60.0).unwrap();
            exact.advance(1.0 / 60.0).unwrap();
            assert_eq!(contact.balls(), exact.balls(), "{} of them at {} s", balls.len(), exact.time());
        }
        assert!(exact.tally().wall_hits > 3 * balls.len() as u64);
        assert_eq!(contact.tally(), exact.tally());
    }
}

/// What had pushed it once, until then, was taken to hold it: it was shown with the mean velocity of the substep before. A push that is
/// no more than what holds some may go on.
#[test]
fn what_flies_off_is_shown_with_what_gravity_gave_it_until_then_but_for_one_in_four_hundred() {
    const FRAME: f64 = 1.0 / 60.0;
    let (fell, half_a_substep) = (FRAME * EARTH, EARTH / 480.0);
    let (mut seen, mut without) = (0, 0);
    for seed in 0..20 {
        let mut random = random(100 + seed);
        let mut any = |k: u32| {
            let (x, y) = (30.0 + 55.0 * f64::from(k % 6), 30.0 + 55.0 * f64::from(k / 6));
            let ball =
                moving(ball(x, y, 8.0 + 18.0 * random()), 400.0 * random() - 200.0, 400.0 * random() - 200.0);
            ball.with_mass(10_f64.powf(4.0 * random() - 2.0)).unwrap().with_restitution(0.3).unwrap()
        };
        let world = world(340.0, 260.0, 0.3).with_gravity(EARTH).unwrap();
        let mut simulation = simulation(world, (0..24).map(&mut any).collect());
        let mut frames: Vec<Vec<Ball>> = Vec::new();
        for _ in 0..180 {
            simulation.advance(FRAME).unwrap();
            frames.push(simulation.balls().to_vec());
        }
        let balls = |three: &[Vec<Ball>]| {
            let three: [Vec<Ball>; 3] = three.to_vec().try_into().unwrap();
            (0..24).map(move |at| three.each_ref().map(|balls| balls[at]))
        };
        for [first, second, third] in frames.windows(3).flat_map(balls) {
            // It flies through both frames, by its places: they say how fast it was when the first began.
            let flown = |from: Ball, to: Ball| (to.position() - from.position()) / FRAME;
            let (before, after) = (flown(first, second), flown(second, third));
            if (after - before).distance(fell) < 1e-7 && first.velocity().length() > 40.0 {
                seen += 1;
                let was = before - 0.5 * fell;
                without += u32::from((first.velocity() + half_a_substep).distance(was) < 1e-3);
            }
        }
    }
    assert!(seen > 5000, "only {seen} flew");
    assert!(400 * without < seen, "{without} of {seen}");
}

#[test]
fn balls_are_shown_within_the_walls_between_substeps() {
    for substeps in [None, Some(30), Some(240)] {
        // Some come to the ceiling on the parabola and not on the straight way between substeps.
        let mut random = random(5);
        let mut thrown = |k: u32| {
            let (below, over) = (50.0 + 50.0 * random(), 0.1 * random());
            let place = ball(15.0 + 21.0 * f64::from(k), 10.0 + below, 10.0);
            moving(place, 0.0, -(2.0 * EARTH.y * (below + over)).sqrt())
        };
        let world = world(900.0, 150.0, 0.0).with_gravity(EARTH).unwrap();
        let simulation = simulation(world, (0..40).map(&mut thrown).collect());
        let mut simulation = match substeps {
            Some(count) => simulation.with_substeps(count).unwrap(),
            None => simulation,
        };
        for _ in 0..2000 {
            simulation.advance(1.0 / 997.0).unwrap();
            let outside = max_wall_overlap(simulation.world(), simulation.balls());
            assert!(outside < 1e-12, "{substeps:?}, {} s: {outside} of a radius", simulation.time());
        }
    }
}

/// On the line between the ends of a substep it had lost up to all of its speed, and had so after a change in it.
#[test]
fn a_ball_that_bounces_to_and_fro_in_a_substep_is_as_fast_within_it_as_before_and_after() {
    for (gap, speed) in [(0.1, 300.0), (0.3, 100.0), (1.0, 3000.0), (8.0, 2500.0)] {
        let world = world(40.0 + gap, 4000.0, 1.0).with_gravity(EARTH).unwrap();
        let slot = simulation(world, vec![moving(ball(20.0 + 0.5 * gap, 100.0, 20.0), speed, 0.0)]);
        for cut in 0..40 {
            let mut slot = slot.clone();
            slot.advance(0.01 + 0.0017 * f64::from(cut)).unwrap();
            let shown = slot.balls()[0].velocity().x.abs();
            slot.set_gravity(EARTH).unwrap();
            slot.advance(0.1).unwrap();
            for across in [shown, slot.balls()[0].velocity().x.abs()] {
                assert!((across / speed - 1.0).abs() < 1e-9, "{gap} px, {speed} px/s, cut {cut}: {across}");
            }
        }
    }
}

/// What a wall holds showed its mean velocity through a substep along the wall, too.
#[test]
fn a_ball_that_slides_along_a_wall_is_as_fast_as_gravity_has_made_it() {
    let world = world(400.0, 100.0, 0.0).with_gravity(DVec2::new(100.0, 980.0)).unwrap();
    let mut sliding = simulation(world, vec![ball(20.0, 90.0, 10.0)]);
    for frame in 1..=60 {
        sliding.advance(FRAME).unwrap();
        let expected = DVec2::new(100.0 * FRAME * f64::from(frame), 0.0);
        let found = sliding.balls()[0].velocity();
        assert!(found.distance(expected) < 1e-9, "frame {frame}: {found} is not {expected}");
    }
}

/// Those that hold each other showed their mean velocity through a substep, half a kick late.
#[test]
fn balls_that_hold_each_other_while_they_fall_are_as_fast_as_gravity_has_made_them() {
    let world = World::new(DVec2::splat(40.0)).unwrap().with_pairs(Pairs::Impulse);
    let mut falling = simulation(world, vec![ball(12.0, 18.0, 10.0).with_restitution(0.7).unwrap(); 2]);
    // They part, until they touch.
    (0..17).for_each(|_| falling.advance(FRAME).unwrap());
    falling.set_gravity(DVec2::new(125.0, -970.0)).unwrap();
    for frame in 1..=60 {
        falling.advance(FRAME).unwrap();
        let expected = DVec2::new(250.0, -1940.0) * FRAME * f64::from(frame);
        let found = momentum(falling.balls());
        assert!(
            found.distance(expected) < 1e-9 * expected.length(),
            "frame {frame}: {found} is not {expected}"
        );
    }
}

#[test]
fn a_ball_that_slides_and_hops_between_elastic_walls_keeps_the_laws_that_check_asks_for() {
    let world = world(20.0, 20.0, 1.0).with_gravity(DVec2::new(-360.0, 912.0)).unwrap();
    keeps_the_laws(simulation(world, vec![ball(5.0, 14.9, 5.0)]));
}

#[test]
fn elastic_balls_that_were_put_into_each_other_keep_the_laws_that_check_asks_for() {
    let world = World::new(DVec2::splat(28.0)).unwrap().with_pairs(Pairs::Impulse);
    keeps_the_laws(simulation(world, vec![ball(17.0, 15.0, 9.0), ball(9.0, 8.0, 8.0)]));
}

fn keeps_the_laws(mut simulation: Simulation) {
    let mut ledger = Ledger::new(&simulation);
    for _ in 0..180 {
        simulation.advance(FRAME).unwrap();
        ledger.check(&simulation).unwrap();
    }
}

#[test]
fn balls_at_rest_that_were_put_into_each_other_keep_the_laws_that_check_asks_for() {
    let balls = [
        (28.847_468_699_338_748, 45.387_990_547_139_31, 9.047_732_859_347_551, 81.861_469_894_117_42),
        (6.942_140_988_904_957, 31.576_246_173_226_735, 5.828_983_294_639_285, 33.977_046_249_183_86),
        (32.184_158_267_998_1, 31.015_315_324_633_267, 7.489_261_378_185_691, 56.089_035_990_783_835),
        (29.738_340_728_446_346, 31.015_315_324_633_267, 11.261_659_271_553_652, 126.824_969_548_570_34),
        (30.039_143_072_624_917, 13.713_655_797_206_977, 5.540_075_626_078_789, 30.692_437_942_672_28),
        (31.587_475_782_124_862, 31.015_315_324_633_267, 9.412_524_217_875_138, 88.595_612_152_085_98),
    ];
    let balls = balls.map(|(x, y, radius, mass)| {
        ball(x, y, radius).with_mass(mass).unwrap().with_restitution(0.7).unwrap()
    });
    let world = World::new(DVec2::new(41.0, 81.0)).unwrap().with_pairs(Pairs::Impulse);
    keeps_the_laws(simulation(world, balls.to_vec()));
}
