//! Few balls that fit between the walls to the last digit: round numbers in a scene file do.

use carom::simulation::ledger::{Law, Ledger};

use super::*;

/// So many balls of this radius in a box, which fall and come to rest.
fn fit((width, height): (u32, u32), radius: u32, count: u32, seed: u32) -> Simulation {
    let restitution = [0.0, 0.3, 0.5, 0.7][seed as usize % 4];
    let text = format!(
        "solver = \"exact\"\nsize = [{width}, {height}]\ngravity = [0, {EARTH:?}]\n[walls]\nrestitution = 0.5\n[pairs]\n\
         [[fill]]\ncount = {count}\nradius = {radius}\nspeed = [0, 200]\nrestitution = {restitution}\nseed = {seed}\n"
    );
    Scene::parse("fit", &text).unwrap().build().unwrap()
}

#[test]
fn few_balls_whose_widths_divide_that_of_their_box_come_to_rest_in_few_events_and_lawfully() {
    for (size, radius, count) in [
        ((300, 300), 50, 5),
        ((400, 300), 50, 6),
        ((640, 480), 40, 12),
        ((500, 500), 25, 16),
        ((90, 300), 15, 5),
        ((150, 400), 15, 8),
        ((240, 400), 15, 16),
    ] {
        for seed in 0..6 {
            let mut balls = fit(size, radius, count, seed);
            let (mut ledger, mut before) = (Ledger::new(&balls), 0);
            for frame in 0..6 * 60 {
                balls.advance(1.0 / 60.0).unwrap();
                let found = hits(&balls);
                // Up to seven million while hits had no end.
                assert!(found - before < 200_000, "{size:?}, {count} balls, seed {seed}: {}", found - before);
                before = found;
                let held = ledger.check(&balls);
                assert!(held.is_ok(), "{size:?}, {count} balls, seed {seed}, frame {frame}: {held:?}");
            }
            assert_eq!(fastest(&balls), 0.0, "{size:?}, {count} balls, seed {seed}");
            assert!(overlap(&balls) < 1e-6, "{size:?}, {count} balls, seed {seed}: {}", overlap(&balls));
        }
    }
}

/// Balls of this radius in rows from the floor up, x where they are fixed.
fn in_rows(rows: &[&str], height: f64, radius: f64, as_it_is: impl Fn(Ball) -> Ball) -> Vec<Ball> {
    let row = |(row, at): (&&str, u32)| {
        let y = height - radius - 2.0 * radius * f64::from(at);
        let place = |(kind, at): (char, u32)| {
            let ball = as_it_is(ball(radius + 2.0 * radius * f64::from(at), y, radius));
            (kind != '.').then(|| if kind == 'x' { ball.fixed() } else { ball })
        };
        row.chars().zip(0..).filter_map(place).collect::<Vec<_>>()
    };
    rows.iter().zip(0..).flat_map(row).collect()
}

/// Elastic balls of radius 10 in rows as wide as the box but for so much room, px.
fn elastic_rows(rows: &[&str], room: f64, height: f64, walls: f64) -> Simulation {
    let width = 20.0 * rows[0].len() as f64 + room;
    let world = World::new(DVec2::new(width, height)).unwrap().with_walls(walls).unwrap();
    let world = world.with_gravity(DVec2::new(0.0, EARTH)).unwrap().with_pairs(Pairs::Impulse);
    exact(world, in_rows(rows, height, 10.0, |ball| ball.with_restitution(1.0).unwrap()))
}

/// Frames of up to a hundred million hits: balls went to and fro in less room than they are known to.
#[test]
fn elastic_rows_that_fit_to_the_last_digit_fall_in_few_events() {
    for (rows, room, height, walls) in [
        (&["oooo", "o.o.", ".o.o", "o.o.", "oooo", "oooo"][..], 1e-9, 320.0, 1.0),
        (&["ooo", "..o", "o..", "ooo", "ooo", "ooo"][..], 0.0, 170.0, 0.0),
        (&["oo", ".o", "oo", "o.", "oo"][..], 1e-9, 100.0, 1.0),
    ] {
        let mut balls = elastic_rows(rows, room, height, walls);
        let mut before = 0;
        for frame in 0..60 {
            balls.advance(1.0 / 60.0).unwrap();
            let found = hits(&balls) - before;
            assert!(found < 4_000_000, "{rows:?}, frame {frame}: {found}");
            before += found;
        }
        assert!(before < 10_000_000, "{rows:?}: {before}");
        assert!(overlap(&balls) < 1e-5, "{rows:?}: {}", overlap(&balls));
    }
}

#[test]
fn an_elastic_ball_in_a_tube_of_hardly_more_than_its_width_falls_as_if_it_were_alone() {
    let mut balls = elastic_rows(&["o"], 5e-10, 1e6, 1.0);
    balls.set_velocity(0, DVec2::new(74.0, -980.0)).unwrap();
    balls.advance(2.0).unwrap();
    assert!(hits(&balls) < 10_000, "{}", hits(&balls));
    let ball = balls.balls()[0];
    assert!(
        (ball.velocity().y - 980.0).abs() < 1e-9 && (ball.position().y - (1e6 - 10.0)).abs() < 1e-6,
        "{ball:?}"
    );
}

/// Of gravity it kept the one half, along an axis on which others had stopped it, for as long as they hit it straight from below.
#[test]
fn what_others_have_stopped_and_one_sends_off_again_falls_along_both_axes() {
    let rows = [
        ".ooo.o", "oooo..", "oooooo", "oo.ooo", "oooooo", "oxoooo", "oooooo", "ooo.oo", "ooooo.", "oooooo",
        "oooooo", "oooooo",
    ];
    let world = World::new(DVec2::new(150.01, 300.0)).unwrap().with_walls(0.8).unwrap();
    let world = world.with_gravity(DVec2::new(1e-3, EARTH)).unwrap().with_pairs(Pairs::Impulse);
    let balls = in_rows(&rows, 300.0, 12.5, |ball| ball.with_restitution(0.0).unwrap());
    let mut balls = exact(world, balls);
    for frame in 0..30 {
        let mut ledger = Ledger::new(&balls);
        balls.advance(1.0 / 60.0).unwrap();
        // What has no room may overlap by more than the law allows.
        let beside = ledger.check(&balls).err().filter(|violation| violation.law != Law::Overlap);
        assert_eq!(beside, None, "frame {frame}");
    }
}
