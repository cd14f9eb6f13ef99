//! What is taken away, put elsewhere or changed around balls from outside moves no more of them than it concerns, and gives them no
//! energy.

use super::edits::{RATES, lying};
use super::numbers::random;
use super::*;

/// Does something to a simulation, and tells what.
fn edit(simulation: &mut Simulation, random: &mut impl FnMut() -> f64) -> String {
    // The last ball, which is fixed, may go as well.
    let index = (random() * simulation.balls().len() as f64) as usize;
    let size = simulation.world().size();
    match (random() * 6.0) as u32 {
        0 => {
            simulation.remove(index);
            format!("ball {index} was taken away")
        }
        1 => {
            let place = DVec2::new(random(), random()) * size;
            simulation.set_position(index, place).unwrap();
            format!("ball {index} was put to {place}")
        }
        2 => {
            let angle = 0.6 * (random() - 0.5);
            let pull = 980.0 * (0.7 + 0.6 * random());
            simulation.set_gravity(DVec2::from_angle(angle).perp() * pull).unwrap();
            format!("gravity was turned by {angle}")
        }
        3 => {
            let more = DVec2::new(random() - 0.2, random() - 0.2) * 20.0;
            simulation.resize(size + more).unwrap();
            format!("walls went away by {more}")
        }
        4 => {
            let velocity = DVec2::new(random() - 0.5, random() - 0.5) * 800.0;
            let is_fixed = simulation.balls()[index].is_fixed();
            simulation.set_velocity(index, if is_fixed { DVec2::ZERO } else { velocity }).unwrap();
            format!("ball {index} was thrown at {velocity}")
        }
        _ => {
            let added = ball(20.0 + random() * (size.x - 40.0), 20.0, 4.0 + 4.0 * random());
            simulation.add(&[added]).unwrap();
            "a ball was added".into()
        }
    }
}

#[test]
fn whatever_is_done_all_balls_are_seen_where_they_were_then_at_any_frame_rate() {
    let mut random = random(3);
    for round in 0..60 {
        let (rate, count) = (RATES[round % 5], [30, 60, 150][round % 3]);
        let text = format!(
            "solver = \"contact\"\nsize = [400, 300]\ngravity = [0, 980]\n[walls]\nrestitution = 0.5\n[pairs]\n\
             [[fill]]\ncount = {count}\nradius = [5, 9]\nspeed = [0, 300]\nrestitution = 0.6\nseed = {round}\n\
             [[ball]]\nposition = [200, 200]\nradius = 12\nfixed = true\n"
        );
        let mut simulation = Scene::parse("pile", &text).unwrap().build().unwrap();
        simulation.advance(0.3 * round as f64).unwrap();
        for _ in 0..40 {
            (0..(random() * 8.0) as u32).for_each(|_| simulation.advance(1.0 / f64::from(rate)).unwrap());
            let what = edit(&mut simulation, &mut random);
            let shown = simulation.balls().to_vec();
            simulation.advance(0.0).unwrap();
            for (index, (now, then)) in simulation.balls().iter().zip(&shown).enumerate() {
                let moved = now.position().distance(then.position());
                assert!(
                    now.radius() == then.radius() && moved < 1e-9,
                    "round {round}, {rate} frames a second, {what}: ball {index} moved by {moved} px"
                );
            }
            let beyond = max_wall_overlap(simulation.world(), simulation.balls());
            assert!(beyond < 1e-9, "{what}: {beyond}");
        }
    }
}

/// Of how many balls, at most, any have moved in a second after something was done to a pile of which all sleep; and of how many.
fn disturbed(rate: u32, edit: impl Fn(&mut Simulation, usize)) -> (usize, usize) {
    let text = "solver = \"contact\"\nsize = [600, 400]\ngravity = [0, 980]\n[walls]\nrestitution = 0.5\n[pairs]\n\
                [[fill]]\ncount = 600\nradius = [5, 8]\nrestitution = 0.5\n";
    let mut simulation = Scene::parse("pile", text).unwrap().build().unwrap();
    while fastest(&simulation) > 0.0 || simulation.time() < 1.0 {
        simulation.advance(FRAME).unwrap();
        assert!(simulation.time() < 20.0);
    }
    // Also within a substep.
    simulation.advance(0.3 / f64::from(rate)).unwrap();
    let height = |ball: &Ball| ball.position().y - ball.radius();
    let top =
        (0..600).min_by(|&i, &j| height(&simulation.balls()[i]).total_cmp(&height(&simulation.balls()[j])));
    let before: Vec<Ball> = simulation.balls().to_vec();
    edit(&mut simulation, top.unwrap());
    (0..rate).for_each(|_| simulation.advance(1.0 / f64::from(rate)).unwrap());
    let stands = |was: &Ball| simulation.balls().iter().any(|ball| ball.position() == was.position());
    (before.iter().filter(|was| !stands(was)).count(), before.len())
}

#[test]
fn a_pile_at_rest_is_not_shaken_by_what_is_done_to_the_ball_on_its_top() {
    for rate in RATES {
        let taken = disturbed(rate, |simulation, top| {
            simulation.remove(top);
        });
        let put = disturbed(rate, |simulation, top| {
            let place = simulation.balls()[top].position() - DVec2::new(0.0, 0.01);
            simulation.set_position(top, place).unwrap();
        });
        let same = disturbed(rate, |simulation, _| simulation.set_gravity(EARTH).unwrap());
        let size = disturbed(rate, |simulation, _| simulation.resize(DVec2::new(600.0, 400.0)).unwrap());
        assert_eq!([same.0, size.0], [0, 0], "{rate} frames a second");
        // Those that lose a load may give way: a tenth.
        assert!(taken.0 <= 60 && put.0 <= 60, "{rate} frames a second: {taken:?}, {put:?}");
    }
}

#[test]
fn a_level_pile_stays_level_when_the_floor_rises_under_it() {
    /// The heights of a pile over eight parts of its floor, px.
    fn heights(simulation: &Simulation) -> [f64; 8] {
        let size = simulation.world().size();
        let mut heights = [0.0_f64; 8];
        for ball in simulation.balls() {
            let part = (8.0 * ball.position().x / size.x) as usize;
            heights[part.min(7)] = heights[part.min(7)].max(size.y - ball.position().y + ball.radius());
        }
        heights
    }
    for steps in [1, 22] {
        let mut simulation = Scene::load("pile").unwrap().build().unwrap();
        simulation.advance(5.0).unwrap();
        let before = heights(&simulation);
        for step in 1..=steps {
            let up = 220.0 * f64::from(step) / f64::from(steps);
            simulation.resize(DVec2::new(1280.0, 720.0 - up)).unwrap();
            simulation.advance(FRAME).unwrap();
        }
        simulation.advance(5.0).unwrap();
        for (now, then) in heights(&simulation).into_iter().zip(before) {
            // Three balls, of a pile two dozen high.
            assert!((now - then).abs() < 40.0, "in {steps} steps: {now} px high, {then} before");
        }
    }
}

#[test]
fn a_pile_in_a_window_drawn_narrow_rises_and_has_parted_within_two_seconds() {
    let text = "solver = \"contact\"\nsize = [600, 400]\ngravity = [0, 980]\n[walls]\nrestitution = 0.5\n[pairs]\n\
                [[fill]]\ncount = 600\nradius = [5, 9]\nrestitution = 0.5\n";
    let mut begun = Scene::parse("pile", text).unwrap().build().unwrap();
    begun.advance(4.0).unwrap();
    for steps in [1, 20] {
        let mut simulation = begun.clone();
        let deepest = |simulation: &Simulation| {
            max_overlap(&mut Grid::new(simulation.balls(), simulation.world().size()), simulation.balls())
        };
        for step in 1..=steps {
            let narrower = 270.0 * f64::from(step) / f64::from(steps);
            simulation.resize(DVec2::new(600.0 - narrower, 400.0)).unwrap();
            simulation.advance(FRAME).unwrap();
        }
        let (mut energies, mut overlaps) = (vec![energy(&simulation)], vec![deepest(&simulation)]);
        for frame in 0..120 {
            simulation.advance(FRAME).unwrap();
            energies.push(energy(&simulation));
            overlaps.push(deepest(&simulation));
            // From the height by which the uppermost rises, a ball falls at 600 px/s.
            assert!(fastest(&simulation) < 300.0, "frame {frame}: {} px/s", fastest(&simulation));
        }
        let gained = energies.iter().fold(0.0, |most: f64, &now| most.max(now / energies[0] - 1.0));
        assert!(gained < 0.005, "in {steps} steps: {gained}");
        assert!(overlaps[60] < 0.1 && overlaps[120] < 0.05, "in {steps} steps: {overlaps:.2?}");
        assert!(max_wall_overlap(simulation.world(), simulation.balls()) < 1e-9);
    }
}

#[test]
fn what_sleeps_falls_when_what_carries_it_is_taken_away() {
    type Edit<'a> = &'a dyn Fn(&mut Simulation);

    /// How far from where it falls to, in a tenth of a second, the upper of two stacked balls is, both of which slept: as a part of
    /// that way.
    fn beside(rate: u32, pull: DVec2, edit: Edit<'_>) -> f64 {
        // It differs from the others, of which forty lie elsewhere: then it is no scene of few.
        let stack = [ball(3000.0, 1990.0, 10.0), ball(3000.0, 1971.0, 9.0)];
        let mut simulation = lying(40, stack.to_vec());
        (0..2 * rate).for_each(|_| simulation.advance(1.0 / f64::from(rate)).unwrap());
        let upper =
            |simulation: &Simulation| *simulation.balls().iter().find(|ball| ball.radius() == 9.0).unwrap();
        let from = upper(&simulation);
        assert_eq!(from.velocity(), DVec2::ZERO);
        edit(&mut simulation);
        (0..rate / 10).for_each(|_| simulation.advance(1.0 / f64::from(rate)).unwrap());
        let t = f64::from(rate / 10) / f64::from(rate);
        let way = 0.5 * pull * t * t;
        (upper(&simulation).position() - from.position() - way).length() / way.length()
    }
    let cases: [(&str, DVec2, Edit); 5] = [
        ("the lower is taken away", EARTH, &|simulation| {
            simulation.remove(40);
        }),
        ("the lower is put elsewhere", EARTH, &|simulation| {
            simulation.set_position(40, DVec2::new(3500.0, 1000.0)).unwrap();
        }),
        ("the floor is", EARTH, &|simulation| simulation.resize(DVec2::new(4000.0, 2300.0)).unwrap()),
        ("gravity pulls upwards", -EARTH, &|simulation| simulation.set_gravity(-EARTH).unwrap()),
        ("gravity pulls to the side", EARTH.perp(), &|simulation| {
            simulation.set_gravity(EARTH.perp()).unwrap();
        }),
    ];
    for rate in [60, 250, 1000] {
        for (what, pull, edit) in cases {
            let off = beside(rate, pull, edit);
            // What held it may do so for the rest of a substep.
            assert!(off < 0.09, "{what}, {rate} frames a second: off by {off} of the way");
        }
    }
}

/// They woke a layer in each substep: the top of a column hung in the air for a quarter of a second, and some were thrown.
#[test]
fn what_sleeps_on_each_other_falls_as_one_when_the_floor_is_gone() {
    let column = || {
        (0..60).map(|at| ball(10.0 + 0.1 * f64::from(at % 2), 1490.0 - 20.0 * f64::from(at), 10.0)).collect()
    };
    let of_two =
        |size: DVec2, balls| simulation(world(size.x, size.y, 0.5).with_gravity(EARTH).unwrap(), balls);
    let narrow = of_two(DVec2::new(20.1, 1500.0), column());
    // How much farther or less far than it falls a ball may be after a tenth of a second, as a part of that way: what lay in each other
    // parts.
    for (what, mut lying, most) in [("a column", narrow, 0.09), ("a pile", pile(600), 0.5)] {
        lying.advance(8.0).unwrap();
        assert_eq!(fastest(&lying), 0.0, "{what}");
        let from = lying.balls().to_vec();
        let size = lying.world().size();
        lying.resize(size + DVec2::new(0.0, 200.0)).unwrap();
        (0..6).for_each(|_| lying.advance(FRAME).unwrap());
        let way = 0.5 * EARTH.y * 0.1 * 0.1;
        let off =
            lying.balls().iter().zip(&from).map(|(now, then)| now.position().y - then.position().y - way);
        let off: Vec<f64> = off.map(|off| (off / way).abs()).collect();
        assert!(off.iter().all(|&off| off < most), "{what}: {off:?}");
    }
}

#[test]
fn an_impact_is_counted_once_whatever_is_done_elsewhere_between_frames() {
    for rate in RATES {
        // It falls for that long, and bounces on the fixed one every two times that: within substeps.
        let (time, elastic) = (1.0021, |y: f64| ball(3900.0, y, 10.0).with_restitution(1.0).unwrap());
        let above = 490.0 * time * time + 20.0;
        let mut simulation = lying(61, vec![elastic(1500.0).fixed(), elastic(1500.0 - above)]);
        let bouncing = simulation.balls().len() - 1;
        for frame in 0..8 * rate {
            simulation.advance(1.0 / f64::from(rate)).unwrap();
            let removed = frame as usize / 4;
            match frame % 4 {
                0 if removed < 20 => drop(simulation.remove(0)),
                1 => simulation.set_position(5, simulation.balls()[5].position()).unwrap(),
                2 => simulation.set_velocity(20, DVec2::ZERO).unwrap(),
                _ => (),
            }
        }
        let bounced = simulation.balls()[bouncing - 20];
        assert_eq!(simulation.tally().impacts, 4, "{rate} frames a second");
        let late = 8.0 * time - 8.0;
        let off = bounced.position().distance(DVec2::new(3900.0, 1500.0 - above + 490.0 * late * late));
        assert!(off < 1e-3, "{rate} frames a second: {off} px");
    }
}

#[test]
fn a_pile_gains_next_to_no_energy_where_gravity_becomes_weaker_or_walls_are_moved() {
    let text = "solver = \"contact\"\nsize = [500, 400]\ngravity = [0, 980]\n[walls]\nrestitution = 0.5\n[pairs]\n\
                [[fill]]\ncount = 400\nradius = [5, 8]\nrestitution = 0.5\n";
    for (sleep, edit) in [true, false].into_iter().flat_map(|sleep| (0..4).map(move |edit| (sleep, edit))) {
        let mut simulation = Scene::parse("pile", text).unwrap().build().unwrap().with_sleep(sleep);
        simulation.advance(6.0).unwrap();
        match edit {
            0 => simulation.set_gravity(DVec2::new(0.0, 98.0)).unwrap(),
            1 => simulation.set_gravity(DVec2::new(0.0, 1.0)).unwrap(),
            2 => simulation.resize(DVec2::new(520.0, 400.0)).unwrap(),
            _ => {
                simulation.remove(0);
            }
        }
        let start = energy(&simulation);
        let rise = rise(&mut simulation, 180);
        assert!(rise < 3e-3 * start, "edit {edit}, sleep {sleep}: {rise} of {start}");
    }
}

#[test]
fn what_was_put_elsewhere_is_hit_by_nothing_where_it_was_also_within_a_substep() {
    let balls = [(450.0, 1000.0), (550.0, -1000.0)];
    let balls =
        balls.map(|(x, speed)| moving(ball(x, 500.0, 10.0), speed, 0.0).with_restitution(1.0).unwrap());
    let mut simulation = simulation(world(1000.0, 1000.0, 1.0).with_gravity(EARTH).unwrap(), balls.to_vec());
    simulation = simulation.with_substeps(24).unwrap();
    // They would meet 0.04 s from the beginning: in a substep that ends later.
    simulation.advance(0.03).unwrap();
    let seen = simulation.balls()[0];
    simulation.set_position(1, DVec2::new(100.0, 100.0)).unwrap();
    simulation.advance(0.02).unwrap();
    let off = simulation.balls()[0].position().x - (seen.position().x + 20.0);
    assert!(off.abs() < 1e-6, "{off} px");
}

#[test]
fn walls_that_are_moved_at_a_substeps_end_move_no_ball_that_is_clear_of_them() {
    for short in [0.0, 1e-13, 3e-13, 1e-12, 1e-11, 1e-9] {
        let mut simulation = lying(41, vec![moving(ball(100.0, 100.0, 10.0), 1000.0, 0.0)]);
        simulation = simulation.with_substeps(24).unwrap();
        simulation.advance(1.0 / 24.0 - short).unwrap();
        simulation.resize(DVec2::new(4100.0, 2000.0)).unwrap();
        simulation.advance(1.0 / 24.0).unwrap();
        let off = simulation.balls()[41].position().x - (100.0 + 1000.0 / 12.0);
        assert!(off.abs() < 1e-3, "{short} s before: {off} px");
    }
}
