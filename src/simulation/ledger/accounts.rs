//! What the accounts begin with, and what the frame before was.

use glam::DVec2;

use crate::simulation::ball::Ball;
use crate::simulation::flight::DEEP;
use crate::simulation::grid::Grid;
use crate::simulation::invariants::{beyond_edges, energy, free, momentum};
use crate::simulation::world::{Pairs, World};
use crate::simulation::{Simulation, Solver, Tally};

use super::measures::{
    deepest_overlap, deepest_overlap_of_few, energy_scale, is_whole, momentum_scale, wall_tolerance,
};

/// The most of the world that the squares round the balls may cover together, and of its shorter side that one of them
/// may, for balls to get out of each other's way: others may be jammed, and a jam takes energy and leans on the walls.
const ROOMY: f64 = 0.5;

/// A frame that held.
#[derive(Debug)]
pub(super) struct Before {
    pub(super) world: World,
    pub(super) solver: Solver,
    pub(super) balls: Vec<Ball>,
    pub(super) time: f64,
    pub(super) energy: f64,
    /// Whether the state was one that the solver had computed.
    pub(super) whole: bool,
    /// Whether any ball was fast for `contact`, in it or earlier.
    pub(super) fast: bool,
    /// Whether accounts cannot begin with it: a ball was not wholly between the walls, or it was within a substep.
    pub(super) unfit: bool,
}

/// What the accounts begin with.
#[derive(Debug)]
pub(super) struct Base {
    pub(super) momentum: DVec2,
    pub(super) tally: Tally,
    pub(super) time: f64,
    /// The mass of all balls that move.
    pub(super) mass: f64,
    /// The largest sum of the balls' energies that was seen, each without its sign.
    pub(super) energy_scale: f64,
    /// The lowest energy that was seen, or the last in a frame in which more was allowed.
    pub(super) least_energy: f64,
    /// By how much it has risen in such frames, in all.
    pub(super) lifted: f64,
    /// The largest sum of the balls' momenta that was seen, each without its direction.
    pub(super) momentum_scale: f64,
    /// The deepest overlap at first, and with `exact` since, as a fraction of the smaller radius.
    pub(super) overlap: f64,
    /// Whether any ball is fixed.
    pub(super) fixed: bool,
    /// Whether balls can always get out of each other's way.
    pub(super) roomy: bool,
    /// Whether nothing takes energy.
    pub(super) lossless: bool,
}

impl Before {
    pub(super) fn new(simulation: &Simulation, energy: f64) -> Self {
        let Simulation { world, solver, ref balls, .. } = *simulation;
        let out = |ball: &Ball| !ball.is_fixed() && beyond_edges(&world, ball) > wall_tolerance(&world, ball);
        Self {
            world,
            solver,
            time: simulation.time(),
            energy,
            whole: is_whole(simulation),
            fast: false,
            unfit: !is_whole(simulation) || (world.walls.is_some() && balls.iter().any(out)),
            balls: balls.clone(),
        }
    }
}

impl Base {
    pub(super) fn new(simulation: &Simulation, grid: &mut Grid) -> Self {
        let Simulation { world, tally, ref balls, .. } = *simulation;
        // Overlaps that are too deep for the laws of `contact` and `canvas` are told from others by few pairs of a crowd, too; those
        // of `exact` must not come to be deeper than the deepest.
        let overlap = match simulation.solver {
            Solver::Exact => deepest_overlap(grid, balls),
            Solver::Canvas | Solver::Contact => deepest_overlap_of_few(grid, balls),
        };
        let covered: f64 = balls.iter().map(|ball| 4.0 * ball.radius * ball.radius).sum();
        let widest = balls.iter().map(|ball| 2.0 * ball.radius).fold(0.0, f64::max);
        let roomy = covered < ROOMY * world.size.x * world.size.y
            && widest < ROOMY * world.size.min_element()
            && (overlap.is_none_or(|(_, depth)| depth <= DEEP) || world.pairs != Some(Pairs::Impulse));
        let elastic = balls.iter().all(|ball| ball.restitution == 1.0)
            && world.walls.is_none_or(|restitution| restitution == 1.0)
            && world.gravity.is_none();
        Self {
            momentum: momentum(balls),
            tally,
            time: simulation.time(),
            mass: free(balls).map(|ball| ball.mass).sum(),
            energy_scale: energy_scale(&world, balls),
            least_energy: energy(&world, balls),
            lifted: 0.0,
            momentum_scale: momentum_scale(balls),
            overlap: overlap.map_or(0.0, |(_, depth)| depth),
            fixed: balls.iter().any(Ball::is_fixed),
            roomy,
            lossless: elastic && roomy,
        }
    }
}
