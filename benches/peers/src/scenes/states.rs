//! The states that scenes start from.

use std::f64::consts::PI;

use carom::{Ball, DVec2, OutOfRange, Pairs, World};

use super::{FPS, Kind, Scene, Span};
use crate::engines::Failure;

/// The pull of the demo's gravity, px/s².
const GRAVITY: f64 = 980.0;

/// Balls of radius 3 at 200 px/s that cover a fifth of a square.
pub fn gas(kind: Kind, count: u32) -> Result<Scene, Failure> {
    let side = (f64::from(count) * 9.0 * PI / 0.2).sqrt().ceil();
    let file = format!(
        "size = [{side}, {side}]\n[walls]\n[pairs]\n[[fill]]\ncount = {count}\nradius = 3\nspeed = 200\n"
    );
    let filled = carom::Scene::parse("gas", &file)?.build()?;
    // After a second of warm-up, while all still move: Rapier and Box2D bring it to rest. Where that is soon done, ten seconds, too.
    let (moving, window) = match count {
        0..=100 => (2 * FPS, 15),
        101..=1000 => (2 * FPS, 3),
        1001..=10_000 => (2 * FPS, 2),
        _ => (FPS + FPS / 2, 2),
    };
    let mut spans = vec![Span { from: FPS, to: moving, window, settled: false }];
    if count <= 1000 {
        spans.push(Span { from: moving, to: 10 * FPS, window, settled: false });
    }
    let runs = if count <= 1000 { 50 } else { 0 };
    let (world, balls) = (*filled.world(), filled.balls().to_vec());
    Ok(Scene { kind, world, balls, spans, runs })
}

/// Balls of radius 3 to 6, at rest all over a box that they cover half of, 16:9.
pub fn pile(kind: Kind, count: u32) -> Result<Scene, Failure> {
    // Radii from 3 to 6 have a mean square of 21.
    let area = f64::from(count) * 21.0 * PI / 0.5;
    let (width, height) = ((area * 16.0 / 9.0).sqrt().ceil(), (area * 9.0 / 16.0).sqrt().ceil());
    let file = format!(
        "size = [{width}, {height}]\ngravity = [0, {GRAVITY}]\n[walls]\nrestitution = 0.7\n[pairs]\n\
         [[fill]]\ncount = {count}\nradius = [3, 6]\nrestitution = 0.7\n"
    );
    let filled = carom::Scene::parse("pile", &file)?.build()?;
    let spans = vec![
        Span { from: 0, to: 2 * FPS, window: 2, settled: false },
        Span { from: 8 * FPS, to: 10 * FPS, window: 2, settled: true },
    ];
    let (world, balls) = (*filled.world(), filled.balls().to_vec());
    Ok(Scene { kind, world, balls, spans, runs: 0 })
}

/// A ball of mass 1 on the floor, and one of the same size and of `mass` exactly on top of it.
pub fn heavy(kind: Kind, mass: f64) -> Result<Scene, OutOfRange> {
    let world = World::new(DVec2::splat(200.0))?
        .with_gravity(DVec2::new(0.0, GRAVITY))?
        .with_walls(0.7)?
        .with_pairs(Pairs::Impulse);
    let ball = |y, mass| Ball::new(DVec2::new(100.0, y), 10.0)?.with_restitution(0.7)?.with_mass(mass);
    Ok(Scene::short(kind, world, vec![ball(190.0, 1.0)?, ball(170.0, mass)?], 10 * FPS))
}

/// Equal balls exactly one on top of the other, from the floor up.
pub fn column(kind: Kind, count: u32) -> Result<Scene, OutOfRange> {
    let height = 20.0 * f64::from(count) + 100.0;
    let world = World::new(DVec2::new(200.0, height))?
        .with_gravity(DVec2::new(0.0, GRAVITY))?
        .with_walls(0.7)?
        .with_pairs(Pairs::Impulse);
    let ball = |index| {
        let centre = DVec2::new(100.0, height - 10.0 - 20.0 * f64::from(index));
        Ball::new(centre, 10.0)?.with_restitution(0.7)
    };
    let balls: Result<_, _> = (0..count).map(ball).collect();
    Ok(Scene::short(kind, world, balls?, 10 * FPS))
}

/// A small ball that flies past a large one within a frame unless an impact is looked for on its way: at no frame's end
/// is it near the other, neither at its own speed nor at the 20,000 px/s that some engines slow it down to. No wall is
/// near either.
pub fn bullet(kind: Kind) -> Result<Scene, OutOfRange> {
    let world = World::new(DVec2::new(40_000.0, 200.0))?.with_walls(1.0)?.with_pairs(Pairs::Impulse);
    let ball = |x, radius: f64| Ball::new(DVec2::new(x, 100.0), radius)?.with_mass(radius * radius);
    let balls = vec![ball(20_000.0, 3.0)?.with_velocity(DVec2::new(1e5, 0.0))?, ball(20_850.0, 20.0)?];
    // Six frames: time enough for those that slow it down.
    Ok(Scene::short(kind, world, balls, 6))
}

#[cfg(test)]
mod tests {
    use carom::simulation::grid::Grid;
    use carom::simulation::invariants::{max_overlap, max_wall_overlap};

    use super::super::Size;
    use super::*;

    #[test]
    fn scenes_are_the_same_each_time_and_start_without_overlaps_within_their_walls() {
        for kind in Kind::all(Size::Quick) {
            let scene = kind.build().unwrap();
            assert_eq!(scene.balls, kind.build().unwrap().balls);
            let size = scene.world.size();
            assert!(max_overlap(&mut Grid::new(&scene.balls, size), &scene.balls) < 1e-9, "{kind:?}");
            assert!(max_wall_overlap(&scene.world, &scene.balls) < 1e-9, "{kind:?}");
        }
    }

    #[test]
    fn a_gas_covers_a_fifth_of_its_box_and_a_pile_half() {
        for (kind, share) in [(Kind::Gas(1000), 0.2), (Kind::Pile(1000), 0.5)] {
            let scene = kind.build().unwrap();
            let covered: f64 = scene.balls.iter().map(|ball| PI * ball.radius().powi(2)).sum();
            let share_found = covered / scene.world.size().element_product();
            assert!((share_found / share - 1.0).abs() < 0.05, "{kind:?}: {share_found}");
        }
    }
}
