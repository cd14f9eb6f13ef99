//! What should be conserved or never exceeded, measured: energy, momentum, overlap, escape.
//!
//! Fixed balls stand where they were put: they have no energy and no momentum, and that they overlap each other or a
//! wall is nobody's fault and does not count.

use glam::DVec2;

use super::ball::Ball;
use super::grid::Grid;
use super::world::World;

/// The balls that move.
pub(super) fn free(balls: &[Ball]) -> impl Iterator<Item = &Ball> {
    balls.iter().filter(|ball| !ball.is_fixed())
}

/// The kinetic energy of all balls, mass·px²/s².
#[must_use]
pub fn kinetic_energy(balls: &[Ball]) -> f64 {
    // From 0: the sum of no numbers at all is −0.
    free(balls).fold(0.0, |sum, ball| sum + 0.5 * ball.mass * ball.velocity.length_squared())
}

/// The potential energy of all balls under the world's gravity, mass·px²/s²: 0 for a ball that lies on the edge (or
/// in the corner) that gravity pulls it to, positive above it. 0 without gravity.
#[must_use]
pub fn potential_energy(world: &World, balls: &[Ball]) -> f64 {
    let Some(gravity) = world.gravity else { return 0.0 };
    // Height along one axis above the edge that gravity points at.
    let height = |pull: f64, at: f64, radius: f64, side: f64| {
        if pull > 0.0 { side - radius - at } else { at - radius }
    };
    let work = |ball: &Ball| {
        let across = height(gravity.x, ball.position.x, ball.radius, world.size.x);
        let down = height(gravity.y, ball.position.y, ball.radius, world.size.y);
        ball.mass * (gravity.x.abs() * across + gravity.y.abs() * down)
    };
    free(balls).map(work).fold(0.0, |sum, work| sum + work)
}

/// The kinetic and the potential energy of all balls, mass·px²/s².
#[must_use]
pub fn energy(world: &World, balls: &[Ball]) -> f64 {
    kinetic_energy(balls) + potential_energy(world, balls)
}

/// The total momentum, mass·px/s.
#[must_use]
pub fn momentum(balls: &[Ball]) -> DVec2 {
    free(balls).map(|ball| ball.mass * ball.velocity).sum()
}

/// The deepest overlap of two balls as a fraction of the smaller one's radius: 0 where none overlap, 2 and more where
/// a ball lies wholly inside another. Two fixed balls may overlap.
///
/// Where hundreds of balls lie in each other, one that touches more than 64 of its size in a group of neighbouring cells is
/// compared with 64 of them, and no deeper overlap of it is told: a hundred thousand at one point have five billion pairs.
#[must_use]
pub fn max_overlap(grid: &mut Grid, balls: &[Ball]) -> f64 {
    let mut deepest = 0.0_f64;
    grid.for_each_of_few(balls, |i, j| {
        let (a, b) = (&balls[i as usize], &balls[j as usize]);
        if !(a.is_fixed() && b.is_fixed()) {
            let depth = a.radius + b.radius - a.position.distance(b.position);
            deepest = deepest.max(depth / a.radius.min(b.radius));
        }
    });
    deepest
}

/// How far a ball reaches beyond the world's edges, px; negative inside.
pub(super) fn beyond_edges(world: &World, ball: &Ball) -> f64 {
    let before = DVec2::splat(ball.radius) - ball.position;
    let behind = ball.position + ball.radius - world.size;
    before.max(behind).max_element()
}

/// The deepest that a ball reaches over a wall, as a fraction of its radius; 0 without walls. Fixed balls may stand in
/// one.
#[must_use]
pub fn max_wall_overlap(world: &World, balls: &[Ball]) -> f64 {
    if world.walls.is_none() {
        return 0.0;
    }
    free(balls).map(|ball| beyond_edges(world, ball) / ball.radius).fold(0.0, f64::max)
}

/// Whether a ball's position and velocity are numbers.
pub(super) fn is_finite(ball: &Ball) -> bool {
    ball.position.is_finite() && ball.velocity.is_finite()
}

/// How many balls have a NaN or an infinity in their state. Anything but 0 is a defect of the solver.
#[must_use]
pub fn non_finite(balls: &[Ball]) -> usize {
    balls.iter().filter(|ball| !is_finite(ball)).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(x: f64, y: f64, radius: f64) -> Ball {
        Ball::new(DVec2::new(x, y), radius).unwrap()
    }

    #[test]
    fn a_ball_on_the_floor_has_no_potential_energy_wherever_the_floor_is() {
        let world = World::new(DVec2::new(100.0, 50.0)).unwrap();
        for (pull, x, y) in [
            (DVec2::new(0.0, 10.0), 40.0, 45.0),
            (DVec2::new(0.0, -10.0), 40.0, 5.0),
            (DVec2::new(10.0, 0.0), 95.0, 20.0),
            (DVec2::new(-10.0, 5.0), 5.0, 45.0),
        ] {
            let world = world.with_gravity(pull).unwrap();
            assert_eq!(potential_energy(&world, &[ball(x, y, 5.0)]), 0.0);
            assert!(potential_energy(&world, &[ball(50.0, 25.0, 5.0)]) > 0.0);
        }
        assert_eq!(potential_energy(&world, &[ball(50.0, 25.0, 5.0)]), 0.0);
    }

    #[test]
    fn overlap_is_a_fraction_of_the_smaller_radius() {
        let balls = [ball(0.0, 0.0, 10.0), ball(13.0, 0.0, 4.0), ball(100.0, 0.0, 1.0)];
        let mut grid = Grid::new(&balls, DVec2::splat(200.0));
        assert_eq!(max_overlap(&mut grid, &balls), 0.25);
        assert_eq!(max_overlap(&mut grid, &balls[2..]), 0.0);
    }

    #[test]
    fn a_hundred_thousand_balls_at_one_point_have_an_overlap() {
        let balls = vec![ball(50.0, 50.0, 4.0); 100_000];
        assert_eq!(max_overlap(&mut Grid::new(&balls, DVec2::splat(100.0)), &balls), 2.0);
    }

    #[test]
    fn wall_overlap_counts_only_where_there_are_walls() {
        let world = World::new(DVec2::splat(100.0)).unwrap();
        let balls = [ball(8.0, 50.0, 10.0), ball(50.0, 97.0, 6.0)];
        assert_eq!(max_wall_overlap(&world, &balls), 0.0);
        assert_eq!(max_wall_overlap(&world.with_walls(1.0).unwrap(), &balls), 0.5);
    }

    #[test]
    fn fixed_balls_have_no_energy_and_no_momentum_and_only_free_ones_overlap_them() {
        let world = World::new(DVec2::splat(100.0)).unwrap().with_walls(1.0).unwrap();
        let world = world.with_gravity(DVec2::new(3.0, 4.0)).unwrap();
        let free = ball(50.0, 50.0, 5.0).with_velocity(DVec2::new(2.0, 1.0)).unwrap();
        let alone = [free];
        let among = [ball(2.0, 90.0, 10.0).fixed(), free, ball(8.0, 90.0, 10.0).fixed()];
        assert_eq!((kinetic_energy(&among), momentum(&among)), (kinetic_energy(&alone), momentum(&alone)));
        assert_eq!(potential_energy(&world, &among), potential_energy(&world, &alone));
        let mut grid = Grid::new(&among, world.size());
        assert_eq!((max_overlap(&mut grid, &among), max_wall_overlap(&world, &among)), (0.0, 0.0));
        let inside = [ball(2.0, 90.0, 10.0).fixed(), ball(15.0, 90.0, 10.0)];
        assert_eq!(max_overlap(&mut grid, &inside), 0.7);
    }
}
