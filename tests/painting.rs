//! That pictures are those of tiny-skia's `fill_path`, only painted faster: what differs, by how much, and what must not.

#[path = "common/numbers.rs"]
mod numbers;

use std::f64::consts::PI;

use carom::paint::{self, BACKGROUND, BALL, CONTACT, Painter, fill_disc};
use carom::{Ball, DVec2, Pairs, Simulation, Solver, World};
use numbers::random;
use proptest::prelude::*;
use tiny_skia::{Pixmap, PremultipliedColorU8};

const SIZE: DVec2 = DVec2::new(640.0, 360.0);

fn simulation(balls: &[(DVec2, f64)]) -> Simulation {
    let balls = balls.iter().map(|&(centre, radius)| Ball::new(centre, radius).unwrap()).collect();
    let world = World::new(SIZE).unwrap().with_pairs(Pairs::Detect);
    let mut simulation = Simulation::new(world, balls, Solver::Canvas).unwrap();
    // Balls that touch have another colour.
    simulation.advance(0.0).unwrap();
    simulation
}

/// Balls in random places; `inside`, or cut off by the borders, too.
fn scene(count: usize, radii: (f64, f64), inside: bool, seed: u64) -> Simulation {
    let mut random = random(seed);
    let balls: Vec<_> = (0..count)
        .map(|_| {
            let radius = radii.0 + (radii.1 - radii.0) * random();
            let margin = if inside { radius + 0.1 } else { -radius };
            (margin + (SIZE - 2.0 * margin) * DVec2::new(random(), random()), radius)
        })
        .collect();
    simulation(&balls)
}

fn by_fill_path(simulation: &Simulation, scale: f64) -> Pixmap {
    let mut picture = paint::blank(SIZE * scale).unwrap();
    picture.fill(BACKGROUND.into());
    for (ball, &touching) in simulation.balls().iter().zip(simulation.touching()) {
        let colour = if touching { CONTACT } else { BALL };
        fill_disc(&mut picture.as_mut(), ball.position() * scale, ball.radius() * scale, colour);
    }
    picture
}

fn painted(simulation: &Simulation, scale: f64) -> Pixmap {
    let mut picture = paint::blank(SIZE * scale).unwrap();
    paint::paint(simulation, scale, &mut picture.as_mut());
    picture
}

/// The mean difference of two pictures' red, green and blue, of 255, and the largest.
fn difference(a: &Pixmap, b: &Pixmap) -> (f64, u8) {
    let bytes = || a.data().iter().zip(b.data()).map(|(&a, &b)| a.abs_diff(b));
    let sum: f64 = bytes().map(f64::from).sum();
    (sum / (0.75 * a.data().len() as f64), bytes().max().unwrap())
}

#[test]
fn a_disc_of_any_size_covers_what_lies_inside_it_and_nothing_else() {
    let size = DVec2::new(64.0, 48.0);
    let filled = |centre: DVec2, radius: f64| {
        let mut picture = paint::blank(size).unwrap();
        fill_disc(&mut picture.as_mut(), centre, radius, BALL);
        picture.pixels().iter().map(|pixel| f64::from(pixel.alpha()) / 255.0).sum::<f64>()
    };
    for radius in [1e2, 9.9e3, 1.1e4, 1e6, 1e9, 1e12, 1e30] {
        assert_eq!(filled(size / 2.0, radius), size.x * size.y, "{radius}");
        // Half of the picture, as far as f64 has the places between.
        if radius <= 1e6 {
            let half = filled(DVec2::new(32.0 - radius, 24.0), radius) / (size.x * size.y);
            assert!((half - 0.5).abs() < 0.02 + 6.0 / radius, "{radius}: {half}");
        }
        assert_eq!(filled(DVec2::new(0.0, -2.0 * radius), radius), 0.0, "{radius}");
    }
    for (centre, radius) in [(size, f64::NAN), (DVec2::NAN, 5.0), (size / 2.0, 0.0), (size / 2.0, -5.0)] {
        assert_eq!(filled(centre, radius), 0.0, "{centre} {radius}");
    }
}

#[test]
fn discs_from_10_px_on_are_those_of_fill_path_to_the_bit() {
    for (count, radii) in [(15, (10.0, 120.0)), (400, (10.0, 10.0)), (400, (10.0, 30.0))] {
        let scene = scene(count, radii, true, count as u64);
        for scale in [1.0, 1.25, 2.0] {
            assert_eq!(painted(&scene, scale).data(), by_fill_path(&scene, scale).data(), "{radii:?}");
        }
    }
}

#[test]
fn discs_that_borders_cut_differ_from_fill_path_by_less_than_a_thousandth() {
    for (count, radii) in [(30, (10.0, 170.0)), (2000, (10.0, 12.0))] {
        let scene = scene(count, radii, false, count as u64);
        let (mean, most) = difference(&painted(&scene, 1.0), &by_fill_path(&scene, 1.0));
        assert!(mean < 0.001 && most <= 32, "{radii:?}: {mean}, {most}");
    }
}

#[test]
fn smaller_discs_differ_from_fill_path_by_no_more_than_its_samples() {
    for (radii, most_mean) in [((1.0, 3.0), 0.5), ((3.0, 6.0), 0.5), ((9.0, 9.99), 0.5)] {
        let scene = scene(600, radii, true, 7);
        let (mean, most) = difference(&painted(&scene, 1.0), &by_fill_path(&scene, 1.0));
        assert!(mean < most_mean && most <= 64, "{radii:?}: {mean}, {most}");
    }
}

/// The area of a disc's picture, px².
fn area(centre: DVec2, radius: f64) -> f64 {
    let picture = painted(&simulation(&[(centre, radius)]), 1.0);
    let (none, whole) = (f64::from(BACKGROUND.1), f64::from(BALL.1));
    picture.pixels().iter().map(|pixel| (f64::from(pixel.green()) - none) / (whole - none)).sum()
}

#[test]
fn a_disc_that_moves_by_a_64th_of_a_pixel_keeps_its_area_within_a_fifth_of_a_percent() {
    for radius in [2.0, 3.0, 4.71, 6.0, 9.99, 10.0, 12.0, 30.0] {
        for direction in [DVec2::X, DVec2::Y, DVec2::ONE, DVec2::new(1.0, 0.37)] {
            let at = |step: u32| DVec2::new(70.3, 60.2) + direction * f64::from(step) / 64.0;
            let areas: Vec<f64> = (0..=64).map(|step| area(at(step), radius)).collect();
            let step = areas.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
            assert!(step < 0.002 * PI * radius * radius, "r {radius} along {direction}: {step} px²");
        }
    }
}

#[test]
fn a_disc_of_any_radius_has_its_area() {
    for radius in [0.75, 1.01, 2.5, 3.1, 5.55, 9.9, 10.0, 25.0, 150.0] {
        let shown = area(DVec2::new(320.2, 180.7), radius);
        let error = shown / (PI * radius * radius) - 1.0;
        // A small radius is rounded to a 32nd of a pixel.
        assert!(error.abs() < 0.004 + 1.0 / 32.0 / radius, "r {radius}: {error}");
    }
}

#[test]
fn borders_cut_discs_off_and_change_nothing_else() {
    // The same balls in a picture that is larger to the right and below.
    for (radii, seed) in [((1.0, 9.0), 1), ((10.0, 60.0), 2)] {
        let scene = scene(300, radii, false, seed);
        let small = painted(&scene, 1.0);
        let mut large = paint::blank(SIZE + 50.0).unwrap();
        paint::paint(&scene, 1.0, &mut large.as_mut());
        let (width, wide) = (small.width() as usize, large.width() as usize);
        for (row, larger) in small.pixels().chunks_exact(width).zip(large.pixels().chunks_exact(wide)) {
            assert_eq!(row, &larger[..width]);
        }
    }
    // And moved to the right and down, so that the left and the upper border cut them off no more.
    let moved: Vec<_> = [(2.0, 0.5), (9.5, -4.0), (3.0, 1.25), (9.0, 100.0)]
        .map(|(radius, at)| [(DVec2::new(at, 100.0), radius), (DVec2::new(100.0, at), radius)])
        .concat();
    let cut = painted(&simulation(&moved), 1.0);
    let moved: Vec<_> = moved.into_iter().map(|(centre, radius)| (centre + 32.0, radius)).collect();
    let whole = painted(&simulation(&moved), 1.0);
    for (x, y) in (0..150).flat_map(|y| (0..150).map(move |x| (x, y))) {
        assert_eq!(cut.pixel(x, y), whole.pixel(x + 32, y + 32), "at {x}, {y}");
    }
}

#[test]
fn discs_far_larger_than_the_picture_cover_what_they_should() {
    let covered = |centre: DVec2, radius: f64| {
        let picture = painted(&simulation(&[(centre, radius)]), 1.0);
        picture.pixels().iter().map(|pixel| pixel.green() == BALL.1).collect::<Vec<_>>()
    };
    assert!(covered(DVec2::new(5e8, -2e8), 9e8).iter().all(|&pixel| pixel));
    assert!(covered(DVec2::new(-3e8, 100.0), 2e8).iter().all(|&pixel| !pixel));
    for radius in [1900.0, 2100.0, 1e5, 1e8] {
        let columns = covered(DVec2::new(200.0 + radius, 180.0), radius);
        let row = &columns[180 * 640..181 * 640];
        assert_eq!(row.iter().position(|&pixel| pixel), Some(200), "r {radius}");
        assert!(row[200..].iter().all(|&pixel| pixel), "r {radius}");
    }
}

/// What happens between two pictures.
#[derive(Debug, Clone)]
enum Change {
    Nothing,
    Move(usize, DVec2),
    Add(DVec2, f64),
    RemoveLast,
    Scale(f64),
    Forget,
}

fn change() -> impl Strategy<Value = Change> {
    let place = || (-30.0..670.0, -30.0..390.0).prop_map(|(x, y)| DVec2::new(x, y));
    prop_oneof![
        1 => Just(Change::Nothing),
        6 => (0_usize..64, place()).prop_map(|(index, place)| Change::Move(index, place)),
        2 => (place(), 0.3..80.0).prop_map(|(place, radius)| Change::Add(place, radius)),
        1 => Just(Change::RemoveLast),
        1 => (0.5..2.0).prop_map(Change::Scale),
        1 => Just(Change::Forget),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn painting_what_changed_equals_painting_all_to_the_bit(
        start in prop::collection::vec(((-30.0..670.0, -30.0..390.0), 0.3..60.0), 0..24),
        changes in prop::collection::vec(change(), 1..12),
    ) {
        let mut balls: Vec<_> = start.into_iter().map(|((x, y), radius)| (DVec2::new(x, y), radius)).collect();
        let (mut painter, mut picture) = (Painter::default(), paint::blank(SIZE).unwrap());
        let mut scale = 1.0;
        painter.repaint(&simulation(&balls), scale, &mut picture.as_mut());
        for change in changes {
            match change {
                Change::Nothing => {
                    let changed = painter.repaint(&simulation(&balls), scale, &mut picture.as_mut());
                    prop_assert!(!changed);
                }
                // To its place, or by a little.
                Change::Move(index, place) => if let Some(ball) = balls.get_mut(index / 2) {
                    ball.0 = if index % 2 == 0 { place } else { ball.0 + place / 100.0 };
                }
                Change::Add(place, radius) => balls.push((place, radius)),
                Change::RemoveLast => drop(balls.pop()),
                Change::Scale(to) => scale = to,
                Change::Forget => {
                    picture.fill(CONTACT.into());
                    painter.forget();
                }
            }
            painter.repaint(&simulation(&balls), scale, &mut picture.as_mut());
            let mut anew = paint::blank(SIZE).unwrap();
            paint::paint(&simulation(&balls), scale, &mut anew.as_mut());
            prop_assert_eq!(picture.data(), anew.data());
        }
    }
}

#[test]
fn a_picture_painted_aside_is_whole_and_leaves_what_is_known_of_the_other() {
    let (scene, other) = (scene(50, (2.0, 20.0), false, 3), scene(60, (2.0, 20.0), false, 4));
    let blank = || Pixmap::new(SIZE.x as u32, SIZE.y as u32).unwrap();
    let (mut painter, mut picture, mut aside) = (Painter::default(), blank(), blank());
    painter.paint(&scene, 1.0, &mut picture.as_mut());
    painter.paint_aside(&other, 1.0, &mut aside.as_mut());
    assert!(aside.data() == painted(&other, 1.0).data());
    assert!(!painter.repaint(&scene, 1.0, &mut picture.as_mut()), "nothing has changed there");
}

#[test]
fn a_picture_of_another_size_is_painted_whole() {
    let scene = scene(20, (5.0, 40.0), false, 3);
    let mut painter = Painter::default();
    for size in [SIZE, SIZE / 2.0, SIZE * 1.5, DVec2::ONE] {
        let mut picture = paint::blank(size).unwrap();
        assert!(painter.repaint(&scene, 1.0, &mut picture.as_mut()));
        let mut anew = paint::blank(size).unwrap();
        paint::paint(&scene, 1.0, &mut anew.as_mut());
        assert_eq!(picture.data(), anew.data());
    }
}

#[test]
fn only_what_changed_is_painted_while_few_balls_have_moved() {
    let still = [(DVec2::new(40.0, 40.0), 12.0), (DVec2::new(300.0, 200.0), 5.0)];
    let moved = [still[0], (DVec2::new(301.5, 200.0), 5.0)];
    let mut painter = Painter::default();
    let mut picture = paint::blank(DVec2::new(640.0, 360.0)).unwrap();
    painter.paint(&simulation(&still), 1.0, &mut picture.as_mut());
    // A pixel that somebody spoils far from what moves stays spoiled.
    picture.pixels_mut()[0] = PremultipliedColorU8::from_rgba(9, 8, 7, 255).unwrap();
    assert!(painter.repaint(&simulation(&moved), 1.0, &mut picture.as_mut()));
    assert_eq!(picture.pixels()[0].red(), 9);
    // Where many have moved, all is painted.
    let crowd = |shift: f64| -> Vec<_> {
        (0..80).map(|k| (DVec2::new(50.0 + 7.0 * f64::from(k) + shift, 100.0), 1.0)).collect()
    };
    painter.paint(&simulation(&crowd(0.0)), 1.0, &mut picture.as_mut());
    picture.pixels_mut()[0] = PremultipliedColorU8::from_rgba(9, 8, 7, 255).unwrap();
    assert!(painter.repaint(&simulation(&crowd(0.5)), 1.0, &mut picture.as_mut()));
    assert_eq!(picture.pixels()[0].red(), 26);
}
