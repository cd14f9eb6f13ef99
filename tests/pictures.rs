//! What painting shows: exact colours, true areas, and pictures that stay as they were judged good.
//!
//! After a change that is meant to change pictures, `CAROM_BLESS=1 cargo test --test pictures` writes them anew; look at
//! them before they are committed.

use std::path::Path;

use carom::paint::{self, BACKGROUND, BALL, CONTACT, Colour, FIXED};
use carom::{Ball, DVec2, Pairs, Scene, Simulation, Solver, World};
use tiny_skia::Pixmap;

fn colour(pixmap: &Pixmap, x: u32, y: u32) -> Colour {
    let pixel = pixmap.pixel(x, y).unwrap();
    assert_eq!(pixel.alpha(), 255);
    Colour(pixel.red(), pixel.green(), pixel.blue())
}

fn one_disc(position: DVec2, radius: f64) -> Simulation {
    let world = World::new(DVec2::new(100.0, 80.0)).unwrap();
    Simulation::new(world, vec![Ball::new(position, radius).unwrap()], Solver::Canvas).unwrap()
}

#[test]
fn the_demos_three_colours_arrive_byte_for_byte() {
    assert_eq!((BACKGROUND, BALL, CONTACT), (Colour(26, 26, 26), Colour(0, 255, 212), Colour(255, 102, 255)));
    let mut simulation = Scene::load("gravity").unwrap().build().unwrap();
    simulation.advance(0.0).unwrap();
    let picture = paint::picture(&simulation).unwrap();
    assert_eq!((picture.width(), picture.height()), (1280, 720));
    assert_eq!(colour(&picture, 1000, 300), BACKGROUND);
    assert_eq!(colour(&picture, 120, 100), BALL);
    assert_eq!(colour(&picture, 60, 180), CONTACT);
    assert_eq!(colour(&picture, 60, 150), CONTACT);
}

#[test]
fn a_fixed_ball_is_grey_touched_or_not() {
    let world = World::new(DVec2::new(100.0, 80.0)).unwrap().with_pairs(Pairs::Detect);
    let ball = |x| Ball::new(DVec2::new(x, 40.0), 10.0).unwrap();
    for (x, free) in [(45.0, CONTACT), (75.0, BALL)] {
        let mut simulation =
            Simulation::new(world, vec![ball(30.0).fixed(), ball(x)], Solver::Canvas).unwrap();
        simulation.advance(0.0).unwrap();
        let picture = paint::picture(&simulation).unwrap();
        assert_eq!((colour(&picture, 25, 40), colour(&picture, x as u32 + 5, 40)), (FIXED, free));
    }
}

#[test]
fn a_disc_covers_the_area_of_a_circle_wherever_it_lies_between_pixels() {
    // What is left is tiny-skia's sampling of four rows a pixel: at most 1.2 %, 0.2 % and 0.1 % measured.
    for (radius, tolerance) in [(3.0, 0.015), (10.0, 0.003), (30.0, 0.0015)] {
        for (dx, dy) in [(0.0, 0.0), (0.5, 0.5), (0.25, 0.7), (0.9, 0.1)] {
            let picture = paint::picture(&one_disc(DVec2::new(50.0 + dx, 40.0 + dy), radius)).unwrap();
            let coverage = |pixel: &tiny_skia::PremultipliedColorU8| {
                (f64::from(pixel.green()) - f64::from(BACKGROUND.1)) / f64::from(BALL.1 - BACKGROUND.1)
            };
            let area: f64 = picture.pixels().iter().map(coverage).sum();
            let exact = std::f64::consts::PI * radius * radius;
            assert!((area / exact - 1.0).abs() < tolerance, "r {radius} at {dx}, {dy}: {area} of {exact}");
        }
    }
}

#[test]
fn balls_outside_of_the_picture_and_at_its_edge_are_cut_off() {
    for (x, y) in [(-500.0, 40.0), (50.0, 1e9), (1e9, -1e9)] {
        let picture = paint::picture(&one_disc(DVec2::new(x, y), 20.0)).unwrap();
        assert!(picture.pixels().iter().all(|pixel| pixel.red() == 26));
    }
    let picture = paint::picture(&one_disc(DVec2::ZERO, 20.0)).unwrap();
    assert_eq!((colour(&picture, 0, 0), colour(&picture, 30, 30)), (BALL, BACKGROUND));
}

#[test]
fn a_world_too_large_to_paint_is_refused() {
    let world = World::new(DVec2::splat(1e6)).unwrap();
    let simulation = Simulation::new(world, Vec::new(), Solver::Canvas).unwrap();
    let error = paint::picture(&simulation).unwrap_err().to_string();
    assert!(error.contains("1000000x1000000 px") && error.contains("134217728 px in all"), "{error}");
}

/// The scene after some frames at 60 Hz, painted at a scale, against the picture of that name in tests/data.
fn assert_picture(name: &str, scene: &str, frames: u32, scale: f64) {
    let mut simulation =
        Scene::load(scene).unwrap().with_size(DVec2::new(640.0, 480.0)).unwrap().build().unwrap();
    simulation.advance(0.0).unwrap();
    for _ in 0..frames {
        simulation.advance(1.0 / 60.0).unwrap();
    }
    let mut picture = paint::blank(simulation.world().size() * scale).unwrap();
    paint::paint(&simulation, scale, &mut picture.as_mut());
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    if std::env::var_os("CAROM_BLESS").is_some() {
        picture.save_png(&path).unwrap();
    }
    let golden = Pixmap::load_png(&path).unwrap();
    assert_eq!((picture.width(), picture.height()), (golden.width(), golden.height()), "{name}");
    let differing = picture.pixels().iter().zip(golden.pixels()).filter(|(a, b)| a != b).count();
    assert_eq!(differing, 0, "{name}: pixels that differ");
}

#[test]
fn the_first_stage_looks_as_it_did() {
    assert_picture("draw.png", "draw", 0, 1.0);
}

#[test]
fn overlapping_balls_look_as_they_did() {
    assert_picture("detect.png", "detect", 30, 1.0);
}

#[test]
fn falling_balls_look_as_they_did() {
    assert_picture("gravity.png", "gravity", 60, 1.0);
}

#[test]
fn twice_the_scale_is_sharp() {
    assert_picture("gravity-2x.png", "gravity", 60, 2.0);
}
