//! The laws that every frame must keep, checked: finite numbers, walls, gaps, energy, momentum, free flight.
//!
//! Impacts do not tell what energy they took, so the energy is an inequality: it never rises above what was there by
//! more than the solver's documented bound, and stays where nothing takes any. Momentum is an equation wherever the
//! [`Tally`](super::Tally) knows all that walls gave. What each law leaves out, and why, stands at [`Law`].

mod accounts;
mod law;
mod measures;

use glam::DVec2;

use super::ball::Ball;
use super::exact::counted_rest_speed;
use super::flight::DEEP;
use super::grid::Grid;
use super::invariants::{self, beyond_edges, free, is_finite, momentum};
use super::world::Pairs;
use super::{Simulation, Solver};
use accounts::{Base, Before};
pub use law::{Law, Violation};
use measures::{
    EPSILON, TOUCH, claimed, deepest_overlap, energy_scale, fewest_substeps, instant, is_whole,
    momentum_scale, stays_inside, wall_tolerance,
};

/// How much [`Solver::Contact`] may add to the energy under gravity in frames in which no ball is fast, as a part of the largest
/// energy that there was.
pub const CONTACT_LIFT: f64 = 1e-2;
/// How much it may add in all frames together in which a ball is fast, as a part of the same. A ball is fast where it moves farther
/// than its radius in a substep, by its velocity at the end of the frame or at the end of the one before.
pub const CONTACT_LIFT_OF_FAST: f64 = 0.5;
/// What rounding may add to an energy or a momentum in a run of an hour, as a part of the largest that was seen.
const ROUNDING: f64 = 1e-9;
/// What each impact on a wall may add to that.
const ROUNDING_OF_IMPACT: f64 = 8.0 * f64::EPSILON;

/// Holds a simulation against the laws, frame by frame.
///
/// ```
/// use carom::Scene;
/// use carom::simulation::ledger::Ledger;
///
/// let mut simulation = Scene::load("gravity")?.build()?;
/// let mut ledger = Ledger::new(&simulation);
/// for _ in 0..60 {
///     simulation.advance(1.0 / 60.0)?;
///     ledger.check(&simulation)?;
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Ledger {
    before: Before,
    base: Base,
    grid: Grid,
    /// Whether [`Law::Flight`] is checked.
    flights: bool,
}

impl Ledger {
    /// Opens the accounts with the simulation as it is.
    #[must_use]
    pub fn new(simulation: &Simulation) -> Self {
        let mut grid = Grid::new(&simulation.balls, simulation.world.size);
        let base = Base::new(simulation, &mut grid);
        Self { before: Before::new(simulation, base.least_energy), base, grid, flights: true }
    }

    /// The same, without [`Law::Flight`]: where more than one advance lies between two checks, balls may have met
    /// others that the last of them did not flag.
    #[must_use]
    pub fn without_flights(self) -> Self {
        Self { flights: false, ..self }
    }

    /// The balls at the last frame that held.
    #[must_use]
    pub fn before(&self) -> &[Ball] {
        &self.before.balls
    }

    /// The time of the last frame that held, s.
    #[must_use]
    pub fn time_before(&self) -> f64 {
        self.before.time
    }

    /// Holds the simulation as it is against the laws; call it after every [`advance`](Simulation::advance). Where
    /// balls came or went, or the world or the solver is another, the accounts begin anew. They know nothing of balls that were
    /// thrown or moved by [`set_velocity`](Simulation::set_velocity) or [`set_position`](Simulation::set_position): after these,
    /// make a new ledger.
    ///
    /// # Errors
    /// The first [`Violation`]; the ledger then still has the frame before.
    pub fn check(&mut self, simulation: &Simulation) -> Result<(), Violation> {
        check_finite(simulation.balls())?;
        let before = &self.before;
        let changed = before.balls.len() != simulation.balls.len()
            || before.world != simulation.world
            || before.solver != simulation.solver;
        if !changed && is_whole(simulation) {
            self.check_walls(simulation)?;
        }
        if changed || before.unfit {
            // What walls do to balls that were put beyond them is no law of motion, and what `contact` shows within a
            // substep is no state to begin accounts with.
            *self = Self { flights: self.flights, ..Self::new(simulation) };
            return Ok(());
        }
        self.base.momentum_scale = self.base.momentum_scale.max(momentum_scale(&simulation.balls));
        let fast = self.any_fast(simulation);
        self.before.fast |= fast;
        if is_whole(simulation) {
            let energy = self.check_energy(simulation, fast)?;
            self.check_momentum(simulation)?;
            self.before.energy = energy;
            // What may rise without bound is no less than it was: it is accounted for from here on.
            let unbounded = simulation.solver != Solver::Canvas && self.parts_overlaps(simulation);
            if !unbounded && fast && energy > self.base.least_energy {
                self.base.lifted += energy - self.base.least_energy;
                self.base.least_energy = energy;
            }
            self.base.least_energy = if unbounded { energy } else { self.base.least_energy.min(energy) };
            self.base.energy_scale =
                self.base.energy_scale.max(energy_scale(&simulation.world, &simulation.balls));
        }
        let parts = self.parts_overlaps(simulation);
        self.check_overlap(simulation)?;
        // `contact` moves those that overlap, and shows none of that.
        if !(parts && simulation.solver == Solver::Contact) {
            self.check_flights(simulation, fast)?;
        }
        self.before.balls.copy_from_slice(&simulation.balls);
        (self.before.time, self.before.whole) = (simulation.time(), is_whole(simulation));
        Ok(())
    }

    fn check_walls(&self, simulation: &Simulation) -> Result<(), Violation> {
        let world = &simulation.world;
        if world.walls.is_none() {
            return Ok(());
        }
        for (index, (ball, before)) in simulation.balls.iter().zip(&self.before.balls).enumerate() {
            let allowed = beyond_edges(world, before).max(wall_tolerance(world, ball));
            let found = beyond_edges(world, ball);
            if !ball.is_fixed() && found > allowed {
                return Err(Violation { law: Law::Walls, ball: Some(index), found, allowed });
            }
        }
        Ok(())
    }

    fn check_overlap(&mut self, simulation: &Simulation) -> Result<(), Violation> {
        if simulation.world.pairs != Some(Pairs::Impulse) || claimed(simulation) != Solver::Exact {
            return Ok(());
        }
        let allowed = self.base.overlap + TOUCH;
        match deepest_overlap(&mut self.grid, &simulation.balls) {
            Some((ball, found)) if found > allowed => {
                Err(Violation { law: Law::Overlap, ball: Some(ball), found, allowed })
            }
            deepest => {
                // What has parted stays apart.
                self.base.overlap = deepest.map_or(0.0, |(_, found)| found);
                Ok(())
            }
        }
    }

    /// The energy, where it is lawful; more is where a ball is `fast`.
    fn check_energy(&self, simulation: &Simulation, fast: bool) -> Result<f64, Violation> {
        let (world, balls, base) = (&simulation.world, simulation.balls(), &self.base);
        let energy = invariants::energy(world, balls);
        let fall_of_all = world.gravity.unwrap_or_default().abs().dot(world.size) * base.mass;
        let rounding = ROUNDING * base.energy_scale.max(energy_scale(world, balls)) + EPSILON * fall_of_all;
        let allowed = rounding
            + match (claimed(simulation), world.gravity) {
                (Solver::Canvas, None) => self.before.energy,
                (Solver::Exact, _) | (Solver::Contact, Some(_)) if self.parts_overlaps(simulation) => {
                    f64::INFINITY
                }
                (Solver::Canvas, Some(gravity)) => {
                    self.before.energy + self.lifted(gravity, simulation.time())
                }
                (Solver::Exact, None) => base.least_energy,
                (Solver::Contact, None) => {
                    // Places that round give balls at rest next to no speed when they part.
                    let speed = EPSILON * world.size.max_element() * fewest_substeps(simulation);
                    base.least_energy + 0.5 * base.mass * speed * speed
                }
                (Solver::Exact, Some(gravity)) => {
                    let hop = counted_rest_speed(simulation.tuning.rest_speed, gravity, balls);
                    base.least_energy + 0.5 * base.mass * hop * hop
                }
                (Solver::Contact, Some(gravity)) => {
                    // What begins to be held may show two kicks for a substep.
                    let kicks = 2.0 * gravity.length() / fewest_substeps(simulation);
                    let lift = CONTACT_LIFT * base.energy_scale;
                    let left = CONTACT_LIFT_OF_FAST * base.energy_scale - base.lifted;
                    let lift = if fast { lift.max(left) } else { lift };
                    base.least_energy + lift + 0.5 * base.mass * kicks * kicks
                }
            };
        if energy > allowed {
            return Err(Violation { law: Law::Energy, ball: None, found: energy, allowed });
        }
        let least = base.energy_scale - rounding;
        if base.lossless && energy < least {
            return Err(Violation { law: Law::EnergyKept, ball: None, found: energy, allowed: least });
        }
        Ok(energy)
    }

    /// Whether balls overlap by as much as `exact` parts with energy from nowhere: it does so by the distance at which they touch,
    /// which is twice the smaller radius at least.
    fn parts_overlaps(&self, simulation: &Simulation) -> bool {
        self.base.overlap > DEEP && simulation.world.pairs == Some(Pairs::Impulse)
    }

    /// Whether a ball moves farther than its radius in a substep of `contact`, or did a frame ago.
    fn any_fast(&self, simulation: &Simulation) -> bool {
        let substeps = fewest_substeps(simulation);
        let fast = |ball: &Ball| ball.velocity.length() > ball.radius * substeps;
        simulation.balls.iter().any(fast) || self.before.balls.iter().any(fast)
    }

    /// By how much `canvas` may lift balls out of walls in this frame, mass·px²/s²: each by no more than it moved.
    fn lifted(&self, gravity: DVec2, now: f64) -> f64 {
        if self.before.world.walls.is_none() {
            return 0.0;
        }
        let seconds = now - self.before.time;
        let lift = |ball: &Ball| {
            let moved = (ball.velocity.abs() + gravity.abs() * seconds) * seconds;
            ball.mass * gravity.abs().dot(moved)
        };
        free(&self.before.balls).map(lift).sum()
    }

    fn check_momentum(&self, simulation: &Simulation) -> Result<(), Violation> {
        let (world, base) = (&simulation.world, &self.base);
        let all_told = match claimed(simulation) {
            Solver::Canvas => true,
            Solver::Exact => world.walls.is_none() || (world.gravity.is_none() && base.roomy),
            Solver::Contact => {
                let loses_time = self.before.fast && world.gravity.is_some();
                world.walls.is_none() && base.overlap <= DEEP && !loses_time
            }
        };
        if base.fixed || !all_told {
            return Ok(());
        }
        let seconds = simulation.time() - base.time;
        let fallen = world.gravity.unwrap_or_default() * (base.mass * seconds);
        let tallied = simulation.tally.wall_impulse.length() + base.tally.wall_impulse.length();
        let given = simulation.tally.wall_impulse - base.tally.wall_impulse;
        let found = momentum(simulation.balls()) - (base.momentum + fallen + given);
        // What is held shows its mean velocity through a substep, what flies the one at its end.
        let held = 2.0 / fewest_substeps(simulation);
        let hits = (simulation.tally.wall_hits - base.tally.wall_hits) as f64;
        let rounding = ROUNDING + ROUNDING_OF_IMPACT * hits;
        let allowed = rounding * (base.momentum_scale + fallen.length() + given.length())
            + EPSILON * tallied
            + base.mass * world.gravity.unwrap_or_default().length() * (instant(simulation) + held);
        let found = found.length();
        if found > allowed {
            return Err(Violation { law: Law::Momentum, ball: None, found, allowed });
        }
        Ok(())
    }

    fn check_flights(&self, simulation: &Simulation, fast: bool) -> Result<(), Violation> {
        let world = &simulation.world;
        let seconds = simulation.time() - self.before.time;
        let gravity = world.gravity.unwrap_or_default();
        let bounces = world.pairs == Some(Pairs::Impulse);
        let told = match claimed(simulation) {
            Solver::Canvas | Solver::Exact => true,
            Solver::Contact => !bounces && self.before.whole && is_whole(simulation) && !fast,
        };
        if !(self.flights && told) {
            return Ok(());
        }
        let instant = instant(simulation);
        // Every substep rounds the place, by half a unit in the last of its digits.
        let substeps_taken = simulation.engine.substeps().map_or(0.0, |[_, most]| seconds * f64::from(most));
        let drift = EPSILON + 0.5 * f64::EPSILON * substeps_taken;
        let balls = self.before.balls.iter().zip(&simulation.balls).zip(&simulation.touching);
        for (index, ((before, ball), &touching)) in balls.enumerate() {
            if before.is_fixed() || (bounces && touching) {
                continue;
            }
            if !stays_inside(world, before, gravity, seconds) {
                continue;
            }
            // The demo's step moves a ball by its velocity after the frame, not by the mean.
            let share = if simulation.solver == Solver::Canvas { 1.0 } else { 0.5 };
            let path = (before.velocity + gravity * (share * seconds)) * seconds;
            let found = ball.position.distance(before.position + path);
            let speed = before.velocity.length() + gravity.length() * seconds;
            let rounding = ROUNDING * (speed * seconds) + drift * before.position.length();
            let allowed = rounding + speed * instant;
            if found > allowed {
                return Err(Violation { law: Law::Flight, ball: Some(index), found, allowed });
            }
        }
        Ok(())
    }
}

fn check_finite(balls: &[Ball]) -> Result<(), Violation> {
    match balls.iter().position(|ball| !is_finite(ball)) {
        Some(ball) => Err(Violation { law: Law::Finite, ball: Some(ball), found: 1.0, allowed: 0.0 }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::{Advance, Frame, Part, World};

    /// A solver that does one thing wrong, and nothing else, in so many substeps.
    #[derive(Debug)]
    struct Doctored(fn(&mut Frame<'_>), Option<[u32; 2]>);

    impl Advance for Doctored {
        fn advance(&mut self, frame: &mut Frame<'_>, seconds: f64, _: &mut dyn FnMut() -> bool) -> f64 {
            for ball in &mut *frame.balls {
                ball.position += ball.velocity * seconds;
            }
            (self.0)(frame);
            seconds
        }

        fn parts(&self, _: &World) -> Vec<Part> {
            Vec::new()
        }

        fn clone_boxed(&self) -> Box<dyn Advance> {
            Box::new(Self(self.0, self.1))
        }

        fn substeps(&self) -> Option<[u32; 2]> {
            self.1
        }
    }

    /// What the ledger says of a frame of two balls in a box without gravity.
    fn judged(solver: Solver, wrong: fn(&mut Frame<'_>)) -> Result<(), Law> {
        judged_in(solver, (solver == Solver::Contact).then_some([240; 2]), wrong)
    }

    /// The same of one in so many substeps.
    fn judged_in(solver: Solver, substeps: Option<[u32; 2]>, wrong: fn(&mut Frame<'_>)) -> Result<(), Law> {
        let world = World::new(DVec2::splat(100.0)).unwrap().with_walls(1.0).unwrap();
        let ball =
            |x| Ball::new(DVec2::new(x, 50.0), 10.0).unwrap().with_velocity(DVec2::new(3.0, 4.0)).unwrap();
        let balls = vec![ball(30.0), ball(60.0)];
        let mut simulation = Simulation::new(world.with_pairs(Pairs::Impulse), balls, solver).unwrap();
        simulation.engine = Box::new(Doctored(wrong, substeps));
        let mut ledger = Ledger::new(&simulation);
        simulation.advance(0.25).unwrap();
        let judged = ledger.check(&simulation).map_err(|violation| violation.law);
        assert_eq!(ledger.time_before(), if judged.is_ok() { 0.25 } else { 0.0 });
        judged
    }

    #[test]
    fn each_law_is_broken_by_what_breaks_it_and_by_nothing_else() {
        assert_eq!(judged(Solver::Exact, |_| {}), Ok(()));
        assert_eq!(judged(Solver::Exact, |frame| frame.balls[1].velocity.x = f64::NAN), Err(Law::Finite));
        assert_eq!(judged(Solver::Exact, |frame| frame.balls[1].position.x = 90.1), Err(Law::Walls));
        assert_eq!(judged(Solver::Exact, |frame| frame.balls[0].position.x += 15.0), Err(Law::Overlap));
        assert_eq!(judged(Solver::Canvas, |frame| frame.balls[0].velocity *= 1.1), Err(Law::Energy));
        assert_eq!(judged(Solver::Exact, |frame| frame.balls[0].velocity *= 0.9), Err(Law::EnergyKept));
        assert_eq!(judged(Solver::Exact, |frame| frame.balls[0].velocity *= -1.0), Err(Law::Momentum));
        assert_eq!(judged(Solver::Exact, |frame| frame.balls[0].position.x += 1.0), Err(Law::Flight));
        // What a solver is not held to.
        assert_eq!(judged(Solver::Contact, |frame| frame.balls[0].position.x += 15.0), Ok(()));
        assert_eq!(judged(Solver::Contact, |frame| frame.balls[0].velocity *= -1.0), Ok(()));
        // But where it goes from impact to impact it is.
        let judged = |wrong| judged_in(Solver::Contact, None, wrong);
        assert_eq!(judged(|_| {}), Ok(()));
        assert_eq!(judged(|frame| frame.balls[0].position.x += 15.0), Err(Law::Overlap));
        assert_eq!(judged(|frame| frame.balls[0].velocity *= -1.0), Err(Law::Momentum));
        assert_eq!(judged(|frame| frame.balls[0].position.x += 1.0), Err(Law::Flight));
    }

    #[test]
    fn what_walls_give_is_in_the_account_of_the_momentum() {
        let turned = |frame: &mut Frame<'_>| {
            let change = -2.0 * frame.balls[0].velocity;
            frame.balls[0].velocity += change;
            frame.tally.wall_impulse += change;
        };
        assert_eq!(judged(Solver::Exact, turned), Ok(()));
    }

    #[test]
    fn another_world_begins_new_accounts() {
        let world = World::new(DVec2::splat(100.0)).unwrap().with_gravity(DVec2::new(0.0, 10.0)).unwrap();
        let ball = Ball::new(DVec2::splat(50.0), 1.0).unwrap();
        let mut simulation = Simulation::new(world, vec![ball], Solver::Exact).unwrap();
        let mut ledger = Ledger::new(&simulation);
        simulation.set_gravity(DVec2::new(0.0, 1000.0)).unwrap();
        simulation.advance(1.0).unwrap();
        assert_eq!(ledger.check(&simulation), Ok(()));
        simulation.add(&[ball]).unwrap();
        simulation.advance(1.0).unwrap();
        assert_eq!(ledger.check(&simulation), Ok(()));
    }
}
