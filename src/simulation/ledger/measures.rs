//! What is measured of balls, and how far rounding blurs it.

use glam::DVec2;

use crate::simulation::ball::Ball;
use crate::simulation::clock;
use crate::simulation::grid::Grid;
use crate::simulation::invariants::{free, kinetic_energy, potential_energy};
use crate::simulation::world::World;
use crate::simulation::{Simulation, Solver};

/// The deepest overlap that counts as rounding, as a part of the smaller radius.
pub(super) const TOUCH: f64 = 1e-6;
/// What a few operations round a number by, as a part of it.
pub(super) const EPSILON: f64 = 8.0 * f64::EPSILON;
/// Times are known to this, s, whatever their size: twice the time at multiples of which frames are shown.
const INSTANT: f64 = 2.0 * clock::INSTANT;

/// The solver whose laws are claimed: `contact` claims those of `exact` as long as it has taken no substeps.
pub(super) fn claimed(simulation: &Simulation) -> Solver {
    match simulation.solver {
        Solver::Contact if simulation.engine.substeps().is_none() => Solver::Exact,
        solver => solver,
    }
}

/// Whether the state is one that the solver has computed: `contact` only shows what lies between two of its substeps.
pub(super) fn is_whole(simulation: &Simulation) -> bool {
    simulation.engine.within_substep() <= instant(simulation)
}

/// What times are known to, s.
pub(super) fn instant(simulation: &Simulation) -> f64 {
    INSTANT + EPSILON * simulation.time()
}

/// The fewest substeps that the solver takes in a second; infinite where it needs none.
pub(super) fn fewest_substeps(simulation: &Simulation) -> f64 {
    simulation.engine.substeps().map_or(f64::INFINITY, |[fewest, _]| f64::from(fewest))
}

/// Whether a ball that flies freely touches no wall for so many seconds: it is never nearer to one than a small part of
/// its radius.
pub(super) fn stays_inside(world: &World, ball: &Ball, gravity: DVec2, seconds: f64) -> bool {
    if world.walls.is_none() {
        return true;
    }
    let margin = ball.radius * (1.0 + TOUCH) + EPSILON * world.size.max_element();
    (0..2).all(|axis| {
        let (at, velocity, pull) = (ball.position[axis], ball.velocity[axis], gravity[axis]);
        let (low, high) = (margin, world.size[axis] - margin);
        let inside = |way: f64| at + way > low && at + way < high;
        let flown = |time: f64| inside((velocity + 0.5 * pull * time) * time);
        let turn = -velocity / pull;
        let turns = turn > 0.0 && turn < seconds;
        // The demo's step goes beyond the parabola.
        let beyond = (velocity + pull * seconds) * seconds;
        inside(0.0) && flown(seconds) && (!turns || flown(turn)) && inside(beyond)
    })
}

/// The pair that overlaps most, by the first of the two, and by how much of the smaller radius; what rounding makes of
/// touching balls does not count.
pub(super) fn deepest_overlap(grid: &mut Grid, balls: &[Ball]) -> Option<(usize, f64)> {
    let mut deepest = None;
    grid.for_each(balls, |i, j| keep_deeper(&mut deepest, balls, i, j));
    deepest
}

/// The same, but of a crowd no more pairs than show that it is one
/// ([`max_overlap`](crate::simulation::invariants::max_overlap)): a hundred thousand balls at one point have five billion.
pub(super) fn deepest_overlap_of_few(grid: &mut Grid, balls: &[Ball]) -> Option<(usize, f64)> {
    let mut deepest = None;
    grid.for_each_of_few(balls, |i, j| keep_deeper(&mut deepest, balls, i, j));
    deepest
}

/// Puts this pair into the place of the deepest so far, where it overlaps more.
fn keep_deeper(deepest: &mut Option<(usize, f64)>, balls: &[Ball], i: u32, j: u32) {
    let (a, b) = (&balls[i as usize], &balls[j as usize]);
    if a.is_fixed() && b.is_fixed() {
        return;
    }
    let rounding = EPSILON * a.position.abs().max_element();
    let depth = a.radius + b.radius - a.position.distance(b.position) - rounding;
    let depth = depth / a.radius.min(b.radius);
    if depth > deepest.map_or(0.0, |(_, deepest)| deepest) {
        *deepest = Some((i as usize, depth));
    }
}

/// How far rounding lets a ball reach beyond a wall, px.
pub(super) fn wall_tolerance(world: &World, ball: &Ball) -> f64 {
    TOUCH * ball.radius + EPSILON * world.size.max_element()
}

/// The sum of the balls' energies, each without its sign: what rounding is a part of.
pub(super) fn energy_scale(world: &World, balls: &[Ball]) -> f64 {
    let potential = |&ball: &Ball| potential_energy(world, &[ball]).abs();
    kinetic_energy(balls) + balls.iter().map(potential).sum::<f64>()
}

/// The sum of the balls' momenta, each without its direction: what rounding is a part of.
pub(super) fn momentum_scale(balls: &[Ball]) -> f64 {
    free(balls).map(|ball| ball.mass * ball.velocity.length()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_of_whole_substeps_are_states_that_were_computed_for_an_hour() {
        let world = World::new(DVec2::splat(100.0)).unwrap();
        for frames in [24.0, 60.0, 240.0] {
            let mut still =
                Simulation::new(world, vec![Ball::new(DVec2::splat(50.0), 1.0).unwrap()], Solver::Contact)
                    .unwrap()
                    // By itself it takes none.
                    .with_substeps(240)
                    .unwrap();
            for _ in 0..3600 * frames as u32 {
                still.advance(1.0 / frames).unwrap();
                assert!(is_whole(&still), "{frames}: {} s", still.time());
            }
            still.advance(1e-10).unwrap();
            assert!(!is_whole(&still));
        }
    }

    /// A hundred thousand in one place are five billion pairs; as many as are looked at here take no time.
    #[test]
    fn of_a_crowd_in_one_place_few_pairs_tell_how_deep_it_is_and_of_others_all() {
        let size = DVec2::splat(1000.0);
        let at = |x: f64| Ball::new(DVec2::new(x, 500.0), 5.0).unwrap();
        let crowd = vec![at(500.0); 100_000];
        let found = deepest_overlap_of_few(&mut Grid::new(&crowd, size), &crowd).unwrap();
        assert!((found.1 - 2.0).abs() < 1e-9, "{found:?}");
        let row: Vec<Ball> =
            (0..100_u32).map(|k| at(9.0 * f64::from(k) + 0.02 * f64::from(k * k % 10))).collect();
        let mut grid = Grid::new(&row, size);
        assert_eq!(deepest_overlap_of_few(&mut grid, &row), deepest_overlap(&mut grid, &row));
        assert_eq!(deepest_overlap_of_few(&mut grid, &row[..1]), None);
    }
}
