//! All that frames and changes move: what going back in time restores.

use std::sync::Arc;

use glam::DVec2;

use super::command::{Change, CommandError};
use super::truth::Truth;
use crate::scene::{self, Rain, Scene, SceneError};
use crate::simulation::invariants;
use crate::simulation::limits::{COORDINATE, GRAVITY, MAX_BALLS, RADIUS, VELOCITY};
use crate::simulation::{Ball, BuildError, Simulation, Solver, within};

/// The smallest radius that whoever wants a larger ball makes do with, px.
const LEAST_FITTED: f64 = 2.0;
/// What G switches on where the scene has no gravity of its own, px/s².
const EARTH: DVec2 = DVec2::new(0.0, 980.0);
/// Gravity that was tilted is a multiple of one part in so many of 1 px/s².
const GRAVITY_DIGITS: f64 = 1e9;
/// A hand brings a ball to where it wants it in about this time, s: two frames, so that it does not swing.
const CARRY_TIME: f64 = 1.0 / 30.0;
/// Memory that a ball takes in a solver, in bytes, at most about.
const BYTES_A_BALL: usize = 700;

/// What is played, at a moment. What is done to a clone of it gives the same bits as when it is done to the original.
#[derive(Debug, Clone)]
pub(super) struct State {
    pub(super) simulation: Simulation,
    /// The same balls moved by the exact solver, where they are compared with that.
    pub(super) truth: Option<Truth>,
    /// The balls that fall in, if any do.
    rain: Option<Rain>,
    /// What a reset goes back to.
    start: Arc<Start>,
    /// The size that the world was last asked to have, px; wide balls may have made it larger.
    size: DVec2,
    /// Whether frame 1 is still to come, which has a delta of 0, whatever the clock says.
    pub(super) fresh: bool,
    /// For the random balls that changes add.
    seed: u64,
    /// How often random balls were added, so that each time others come.
    additions: u64,
    /// What G brings back.
    gravity: DVec2,
    /// The energy that balls had at the start and that changes have given them since, mass·px²/s²; counted anew where what came
    /// before would hide all that comes.
    given: f64,
    /// Whether a hand has pulled a ball since the last frame, ...
    pulled: bool,
    /// ... and whether one did before that frame, which carried the ball then.
    carried: bool,
    /// What was played before the last reset.
    before: Played,
}

/// How long something was played, and what happened meanwhile: resets end neither.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Played {
    /// Simulated seconds.
    pub seconds: f64,
    /// Impacts between balls.
    pub impacts: u64,
    /// Impacts on walls.
    pub wall_hits: u64,
}

impl Played {
    /// The same, and then a simulation as far as it is.
    #[must_use]
    pub fn and(self, simulation: &Simulation) -> Self {
        let tally = simulation.tally();
        Self {
            seconds: self.seconds + simulation.time(),
            impacts: self.impacts + tally.impacts,
            wall_hits: self.wall_hits + tally.wall_hits,
        }
    }
}

/// A scene at its beginning.
#[derive(Debug)]
pub(super) struct Start {
    pub(super) scene: Scene,
    pub(super) simulation: Simulation,
}

impl State {
    /// A scene at its beginning. `seed` is for the random balls that changes add.
    pub(super) fn new(scene: &Scene, seed: u64) -> Result<Self, SceneError> {
        let simulation = scene.build()?;
        let world = simulation.world();
        Ok(Self {
            given: energy(&simulation),
            truth: None,
            rain: scene.rain(),
            size: world.size(),
            gravity: remembered(&simulation),
            start: Arc::new(Start { scene: scene.clone(), simulation: simulation.clone() }),
            simulation,
            fresh: true,
            seed,
            additions: 0,
            pulled: false,
            carried: false,
            before: Played::default(),
        })
    }

    /// The scene that a reset goes back to.
    pub(super) fn scene(&self) -> &Scene {
        &self.start.scene
    }

    /// What a reset goes back to.
    pub(super) fn start(&self) -> &Arc<Start> {
        &self.start
    }

    /// The size that the world was last asked to have, px.
    pub(super) fn size(&self) -> DVec2 {
        self.size
    }

    /// The balls that fall in, if any do.
    pub(super) fn rain(&self) -> Option<&Rain> {
        self.rain.as_ref()
    }

    /// The energy that the balls would have if impacts took none, mass·px²/s².
    pub(super) fn given(&self) -> f64 {
        self.given + self.rained()
    }

    /// Whether a hand carried a ball in the last frame.
    pub(super) fn is_carrying(&self) -> bool {
        self.carried
    }

    /// A frame begins, in which [`advance`](Self::advance) moves on.
    pub(super) fn begin_frame(&mut self) {
        self.carried = std::mem::take(&mut self.pulled);
    }

    /// The energy that rain has brought so far, mass·px²/s².
    fn rained(&self) -> f64 {
        self.rain.as_ref().map_or(0.0, Rain::energy)
    }

    /// What was played since the beginning, whatever was reset.
    pub(super) fn played(&self) -> Played {
        self.before.and(&self.simulation)
    }

    /// About how much memory a clone takes, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let solvers = 1 + usize::from(self.truth.is_some());
        size_of::<Self>() + solvers * self.simulation.balls().len() * BYTES_A_BALL
    }

    /// Moves on by up to `seconds` for as long as `go_on` says so, and returns the seconds that it has moved on. A
    /// truth that cannot follow is given up.
    pub(super) fn advance(
        &mut self,
        seconds: f64,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<f64, crate::OutOfRange> {
        let Self { simulation, rain, truth, .. } = self;
        let done = match rain {
            Some(rain) => rain.advance_while(simulation, seconds, &mut *go_on)?,
            None => simulation.advance_while(seconds, &mut *go_on)?,
        };
        if let Some(compared) = truth
            && !compared.advance(done, simulation, go_on)?
        {
            *truth = None;
        }
        self.fresh = false;
        Ok(done)
    }

    /// Does what a change says. The same change in the same state does the same, whether it can be done or not.
    pub(super) fn apply(&mut self, change: Change) -> Result<(), CommandError> {
        let before = energy(&self.simulation);
        let done = match change {
            Change::Reset => return self.reset(),
            Change::Reseed(seed) => return self.reseed(seed),
            Change::AddRandom(count) => self.add_random(count),
            Change::AddBall { position, velocity, radius } => self.add_ball(position, velocity, radius),
            Change::RemoveLast => {
                let last = self.simulation.balls().len().checked_sub(1);
                last.map_or(Err(CommandError::NoBalls), |last| self.remove(last))
            }
            Change::Remove(index) => self.remove(index),
            Change::Carry { ball, to } => self.carry(ball, to),
            Change::Place { ball, at } => self.place(ball, at),
            Change::Solver(solver) => {
                self.simulation.set_solver(solver);
                Ok(())
            }
            Change::ToggleGravity => self.toggle_gravity(),
            Change::TiltGravity(by) => self.tilt_gravity(by),
            Change::Resize(size) => self.resize(size),
            Change::Compare(on) => self.compare(on),
        };
        let after = energy(&self.simulation);
        // A hand that drags a ball through others gives thousands of times what they have, and they take it.
        let anew = self.simulation.balls().is_empty()
            || matches!(change, Change::Carry { .. } | Change::ToggleGravity | Change::TiltGravity(_));
        self.given = if anew { after - self.rained() } else { self.given + after - before };
        self.pulled |= done.is_ok() && matches!(change, Change::Carry { .. });
        let makes_room = matches!(
            change,
            Change::Remove(_) | Change::RemoveLast | Change::Place { .. } | Change::Resize(_)
        );
        if let Some(rain) = self.rain.as_mut().filter(|_| makes_room && done.is_ok()) {
            rain.try_again();
        }
        done
    }

    fn reset(&mut self) -> Result<(), CommandError> {
        let solver = self.solver();
        self.before = self.played();
        self.simulation = self.start.simulation.clone();
        if solver != self.solver() {
            self.simulation.set_solver(solver);
        }
        self.rain = self.scene().rain();
        self.simulation.resize(self.size)?;
        self.gravity = remembered(&self.simulation);
        self.fresh = true;
        (self.pulled, self.carried) = (false, false);
        self.given = energy(&self.simulation);
        // What another solver did before stays compared while `exact` goes on with it; from here on it did nothing.
        let compares = self.truth.is_some() && solver != Solver::Exact;
        self.truth = compares.then(|| Truth::of(&self.simulation));
        Ok(())
    }

    fn reseed(&mut self, seed: u64) -> Result<(), CommandError> {
        let scene = self.start.scene.clone().reseeded(seed);
        let simulation = scene.build()?;
        self.start = Arc::new(Start { scene, simulation });
        self.reset()
    }

    fn add_random(&mut self, count: usize) -> Result<(), CommandError> {
        let (world, balls) = (self.simulation.world(), self.simulation.balls());
        let total = balls.len().saturating_add(count);
        if total > MAX_BALLS {
            return Err(BuildError::TooManyBalls { count: total }.into());
        }
        let balls = scene::filling(count, world, balls, self.seed).place(world, balls, self.additions);
        self.additions += 1;
        self.add(&balls)?;
        let placed = balls.len();
        if placed < count { Err(CommandError::NoRoom { placed, count }) } else { Ok(()) }
    }

    fn add_ball(&mut self, position: DVec2, velocity: DVec2, radius: f64) -> Result<(), CommandError> {
        let radius = self.room_at(position, radius).ok_or(CommandError::NoRoomHere)?;
        let ball = Ball::new(position, radius)?.with_velocity(velocity)?;
        let ball = scene::like_the_last(self.simulation.balls(), ball)?;
        self.add(&[ball])
    }

    /// The simulation, and after it the one that it is compared with, if any: what is done to the one is done to the
    /// other.
    fn simulations(&mut self) -> impl Iterator<Item = &mut Simulation> {
        let truth = self.truth.as_mut().map(|truth| &mut truth.simulation);
        [Some(&mut self.simulation), truth].into_iter().flatten()
    }

    fn add(&mut self, balls: &[Ball]) -> Result<(), CommandError> {
        for simulation in self.simulations() {
            simulation.add(balls)?;
        }
        Ok(())
    }

    /// The ball of this index.
    fn ball(&self, index: usize) -> Result<&Ball, CommandError> {
        self.simulation.balls().get(index).ok_or(CommandError::NoBall(index))
    }

    fn remove(&mut self, index: usize) -> Result<(), CommandError> {
        self.ball(index)?;
        for simulation in self.simulations() {
            simulation.remove(index);
        }
        Ok(())
    }

    /// The radius, at most `wished`, of a ball that fits at `position` between walls and other balls, px.
    pub(super) fn room_at(&self, position: DVec2, wished: f64) -> Option<f64> {
        if !(position.is_finite() && wished.is_finite()) {
            return None;
        }
        let (world, mut radius) = (self.simulation.world(), wished);
        if world.walls().is_some() {
            radius = radius.min(position.min(world.size() - position).min_element());
        }
        if world.pairs().is_some() {
            let gap = |ball: &Ball| ball.position().distance(position) - ball.radius();
            radius = self.simulation.balls().iter().map(gap).fold(radius, f64::min);
        }
        (radius >= LEAST_FITTED.min(wished).max(RADIUS.low)).then_some(radius)
    }

    /// Gives a ball the velocity that brings it to where the hand is.
    fn carry(&mut self, ball: usize, to: DVec2) -> Result<(), CommandError> {
        if self.ball(ball)?.is_fixed() {
            return Err(CommandError::Fixed);
        }
        // To clamp what is not a number would throw the ball as fast as any may be.
        let to = COORDINATE.check_vector(to)?;
        for simulation in self.simulations() {
            let Some(carried) = simulation.balls().get(ball) else { continue };
            let velocity = (to - carried.position()) / CARRY_TIME;
            let velocity = velocity.clamp(DVec2::splat(VELOCITY.low), DVec2::splat(VELOCITY.high));
            simulation.set_velocity(ball, velocity)?;
        }
        Ok(())
    }

    fn place(&mut self, index: usize, at: DVec2) -> Result<(), CommandError> {
        let mut placed = self.ball(index)?.with_position(at)?;
        let world = self.simulation.world();
        if world.walls().is_some() {
            placed = placed.with_position(within(at, placed.radius(), world.size()))?;
        }
        if self.simulation.world().pairs().is_some() && !self.is_free(index, &placed) {
            return Err(CommandError::NoRoomHere);
        }
        for simulation in self.simulations() {
            simulation.set_position(index, at)?;
        }
        Ok(())
    }

    /// Whether the ball of this index, `placed` elsewhere, overlaps no other, or none more than it does now.
    fn is_free(&self, index: usize, placed: &Ball) -> bool {
        let now = self.simulation.balls()[index].position();
        self.simulation.balls().iter().enumerate().all(|(other, ball)| {
            let distance = ball.position().distance(placed.position());
            let enough = (ball.radius() + placed.radius()).min(ball.position().distance(now));
            other == index || distance >= enough
        })
    }

    fn toggle_gravity(&mut self) -> Result<(), CommandError> {
        let gravity = match self.simulation.world().gravity() {
            Some(gravity) => {
                self.gravity = gravity;
                DVec2::ZERO
            }
            None => self.gravity,
        };
        self.set_gravity(gravity)
    }

    fn tilt_gravity(&mut self, by: DVec2) -> Result<(), CommandError> {
        let by = GRAVITY.check_vector(by)?;
        let gravity = self.simulation.world().gravity().unwrap_or_default() + by;
        // Rounded, so that there and back is where it was: 0.1 + 98 - 98 is not 0.1.
        let gravity = (gravity * GRAVITY_DIGITS).round() / GRAVITY_DIGITS;
        self.set_gravity(gravity.clamp(DVec2::splat(GRAVITY.low), DVec2::splat(GRAVITY.high)))
    }

    fn set_gravity(&mut self, gravity: DVec2) -> Result<(), CommandError> {
        for simulation in self.simulations() {
            simulation.set_gravity(gravity)?;
        }
        Ok(())
    }

    fn resize(&mut self, size: DVec2) -> Result<(), CommandError> {
        for simulation in self.simulations() {
            simulation.resize(size)?;
        }
        self.size = size;
        Ok(())
    }

    fn compare(&mut self, on: bool) -> Result<(), CommandError> {
        if on && self.rain.is_some() {
            return Err(CommandError::RainNotCompared);
        }
        if on && self.solver() == Solver::Exact {
            return Err(CommandError::ExactNotCompared);
        }
        self.truth = on.then(|| Truth::of(&self.simulation));
        Ok(())
    }

    /// The solver in use.
    pub(super) fn solver(&self) -> Solver {
        self.simulation.solver()
    }
}

/// The gravity that G brings back after it was taken away at the beginning.
fn remembered(simulation: &Simulation) -> DVec2 {
    simulation.world().gravity().unwrap_or(EARTH)
}

/// Kinetic and potential energy, mass·px²/s².
fn energy(simulation: &Simulation) -> f64 {
    invariants::energy(simulation.world(), simulation.balls())
}
