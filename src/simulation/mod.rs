//! The physics: balls in a world, moved on by a solver.
//!
//! It imports glam and `std` and nothing else (but rayon in one file, `contact/team.rs`, with the feature `parallel`):
//! no clock, no random numbers, no files, no window. Whoever owns a [`Simulation`] measures the time and hands it to
//! [`Simulation::advance`], the only door into time.

mod ball;
mod canvas;
mod changes;
mod cholesky;
mod clock;
mod contact;
mod exact;
mod fit;
mod flight;
pub mod grid;
mod hybrid;
mod impulse;
pub mod invariants;
pub mod ledger;
mod lesser;
pub mod limits;
mod separate;
mod simultaneous;
mod solver;
mod squeeze;
mod tally;
mod world;

pub use ball::Ball;
pub use changes::EditError;
use clock::Clock;
pub use fit::BuildError;
pub(crate) use fit::within;
use fit::{check_fit, jams};
use limits::{DEFAULT_REST_SPEED, DELTA, MAX_THREADS, OutOfRange, REST_SPEED, SUBSTEPS};
use separate::bring_strays_in;
use solver::{Advance, Edit, Frame, Tuning};
pub use solver::{Part, Solver, UnknownSolver};
pub use tally::Tally;
pub use world::{Pairs, World};

/// Balls, the world that they move in, and the solver that moves them.
///
/// ```
/// use carom::{Ball, DVec2, Simulation, Solver, World};
///
/// let world = World::new(DVec2::new(200.0, 100.0))?.with_walls(1.0)?;
/// let ball = Ball::new(DVec2::new(180.0, 50.0), 10.0)?.with_velocity(DVec2::new(20.0, 0.0))?;
/// let mut simulation = Simulation::new(world, vec![ball], Solver::Canvas)?;
/// simulation.advance(1.0)?;
/// assert_eq!(simulation.balls()[0].velocity(), DVec2::new(-20.0, 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// A clone goes on exactly as its original does: what the solver remembers is cloned, too.
#[derive(Debug, Clone)]
pub struct Simulation {
    world: World,
    balls: Vec<Ball>,
    touching: Vec<bool>,
    solver: Solver,
    tuning: Tuning,
    /// The solver itself, made for this world and these balls, with what it remembers between frames.
    engine: Box<dyn Advance>,
    clock: Clock,
    tally: Tally,
}

impl Simulation {
    /// A simulation at time 0. Balls outside of the walls are brought in, as by [`resize`](Self::resize), except with
    /// [`Solver::Canvas`], which does so itself, and where they would fill more than half of the world.
    ///
    /// # Errors
    /// [`BuildError`] where a ball does not fit between the walls, or where there are too many balls.
    pub fn new(world: World, mut balls: Vec<Ball>, solver: Solver) -> Result<Self, BuildError> {
        check_fit(&world, &balls, 0)?;
        bring_strays_in(&world, &mut balls, solver);
        let touching = vec![false; balls.len()];
        let tuning = Tuning { rest_speed: DEFAULT_REST_SPEED, substeps: None, sleep: true, threads: 1 };
        let engine = solver.engine(&world, &balls, tuning);
        let (clock, tally) = (Clock::default(), Tally::default());
        Ok(Self { world, balls, touching, solver, tuning, engine, clock, tally })
    }

    /// Sets the rest speed u, the speed below which bouncing counts as rest: from 10⁻⁹ to 10⁹ px/s, and
    /// [`DEFAULT_REST_SPEED`], 1 px/s, unless told otherwise. A smaller one costs more and leaves out less.
    ///
    /// What it does with [`Solver::Exact`], under gravity g (without gravity, the demo's 980 px/s² counts):
    ///
    /// - A ball comes to rest on a wall off which it would bounce more slowly than u.
    /// - Balls that hold each other in balance, to a thousandth of g, come to rest together, until something hits them
    ///   faster than 2u. What leans on a ball at rest hops off it at u/2 at least.
    /// - Balls that chatter lose no energy: those that hit each other more slowly than u and within 2u/g of an impact
    ///   before, or faster, under gravity, but within 2u²/1000g of its place.
    /// - Without gravity, a crush, whose impacts have no end, stops all that is in it.
    /// - Where g is more than 980 px/s², u counts as larger in proportion; where hops of more than a hundredth of the
    ///   smallest radius would be left out, as smaller.
    ///
    /// What that costs in accuracy, for a restitution e and balls of mass M together:
    ///
    /// | | at most |
    /// |---|---|
    /// | height of a hop that is left out | u²/2g |
    /// | how much too early a ball comes to rest | 2u/g/(1 − e) |
    /// | energy that hops add, as a rule | ½Mu²/4 |
    /// | the same, where two dozen balls or more press on each other | ½Mu²/2; in towers of equal balls four times ½Mu² |
    /// | the same, where masses differ by many powers of ten, or balls are fixed | about ½Mu² |
    ///
    /// The number of chattering impacts of balls that lie on each other grows as 1/u.
    ///
    /// The other solvers:
    ///
    /// - [`Solver::Contact`] in its substeps leaves impacts slower than u out of the [tally](Self::tally) under gravity, and what
    ///   slides on walls faster than u does not fall asleep. Where it takes no substeps, it does as [`Solver::Exact`], but a ball
    ///   rests on a wall that it comes to more slowly than u, however strong gravity is, and balls that chatter are left to substeps.
    /// - [`Solver::Canvas`] has no rest speed.
    ///
    /// # Errors
    /// [`OutOfRange`] where the speed is not in the range of rest speeds.
    pub fn with_rest_speed(mut self, rest_speed: f64) -> Result<Self, OutOfRange> {
        self.tuning.rest_speed = REST_SPEED.check(rest_speed)?;
        self.rebuild();
        Ok(self)
    }

    /// Sets the number of substeps in a second, from 24 to 245,760, for [`Solver::Contact`]; other solvers take none.
    ///
    /// Unless told otherwise, the solver chooses:
    ///
    /// | balls | substeps in a second |
    /// |---|---|
    /// | under gravity, as a rule | 240 |
    /// | many like balls under gravity that are hardly hit, and of which none carries hundreds | 120 or 180 |
    /// | 500 and more that may lie in many layers: these times g·h² are more than 0.11 of a ball's size | 360 |
    /// | the same, more than 0.2 of it, where they may [sleep](Self::with_sleep) | 480 |
    /// | under gravity that is strong beside the smallest radius r | a multiple of these, so that g·h² is under r/100 |
    /// | without gravity; up to 128 that can be moved, while none lies on others; all that do not notice each other | none |
    ///
    /// There, g is gravity, and h are the seconds of a substep where 240 are taken, or that multiple of 240. Balls that take none
    /// go from impact to impact, as with [`Solver::Exact`]; where a number is given, they take substeps, too.
    ///
    /// Balls that fly, and meet one after the other, do so to rounding whatever the number. With fewer substeps than the solver
    /// would choose, piles sink in by up to a few times g·h², and what lies on a wall of restitution 1 hops as high; with more,
    /// cost grows in proportion.
    ///
    /// # Errors
    /// [`OutOfRange`] where the number is not in the range of [`limits::SUBSTEPS`].
    pub fn with_substeps(mut self, per_second: u32) -> Result<Self, OutOfRange> {
        SUBSTEPS.check(f64::from(per_second))?;
        self.tuning.substeps = Some(per_second);
        self.rebuild();
        Ok(self)
    }

    /// The same simulation in which balls at rest may sleep, or not. They may unless told otherwise, and only
    /// [`Solver::Contact`] lets them: a ball that for half a second was held, in balance, and slower than g·h/4 (for
    /// the shortest substeps, of h seconds, under gravity g: about 1 px/s, or 0.7) stands still, until something hits it firmly,
    /// it loses a support or a load, or what acts on it is no longer in balance. Pairs asleep cost little; where all
    /// sleep, a frame costs nothing.
    #[must_use]
    pub fn with_sleep(mut self, sleep: bool) -> Self {
        self.tuning.sleep = sleep;
        self.rebuild();
        self
    }

    /// The same simulation with so many threads for [`Solver::Contact`], the only solver that shares its work: it does
    /// where there are some thousands of balls, and where it takes substeps. The result is the same, to the bit, whatever
    /// the number. There is one unless told otherwise, but as many as there are cores where a [scene](crate::Scene::build)
    /// made it, and always one where carom is built without its feature `parallel`; 0 counts as 1, and more than [`limits::MAX_THREADS`] as that.
    #[must_use]
    pub fn with_threads(mut self, threads: u32) -> Self {
        self.tuning.threads = threads.clamp(1, MAX_THREADS);
        self.rebuild();
        self
    }

    /// The speed below which bouncing counts as rest, px/s.
    #[must_use]
    pub fn rest_speed(&self) -> f64 {
        self.tuning.rest_speed
    }

    /// Moves on by `seconds`, from 0 to 10⁶ ([`limits::DELTA`]). A delta of 0 is a frame, too: `canvas` looks for
    /// contacts, as the demo does in its first frame; `exact`, and `contact` where it goes from impact to impact, take the
    /// impacts that are due at this time.
    ///
    /// Rain does not fall by itself: see [`Rain::advance`](crate::scene::Rain::advance).
    ///
    /// # Errors
    /// [`OutOfRange`] for a delta that is negative, too large or not a number; nothing has moved then.
    pub fn advance(&mut self, seconds: f64) -> Result<(), OutOfRange> {
        self.advance_while(seconds, || true).map(drop)
    }

    /// Moves on by up to `seconds`, as [`advance`](Self::advance) does, for as long as `go_on` says so, and returns the
    /// seconds that it has moved on. What is left out is time that was not simulated, not physics that was skipped: the
    /// state is the one at the time returned, and the next call goes on from there.
    ///
    /// A solver whose work grows with what happens (`exact`, and `contact` where it goes from impact to impact) asks
    /// `go_on` now and then, and `contact` after each of its substeps; one whose frame always costs about the same
    /// (`canvas`) never asks, and finishes.
    ///
    /// # Errors
    /// [`OutOfRange`] as for [`advance`](Self::advance); nothing has moved then.
    pub fn advance_while(
        &mut self,
        seconds: f64,
        mut go_on: impl FnMut() -> bool,
    ) -> Result<f64, OutOfRange> {
        DELTA.check(seconds)?;
        let Self { world, balls, touching, tally, .. } = self;
        let mut frame = Frame { world, balls, touching, tally };
        let done = self.engine.advance(&mut frame, seconds, &mut go_on);
        debug_assert!((0.0..=seconds).contains(&done), "a solver moved on by {done} s of {seconds}");
        self.clock = self.clock.after(done);
        Ok(done)
    }

    /// The balls as they are now.
    #[must_use]
    pub fn balls(&self) -> &[Ball] {
        &self.balls
    }

    /// For each ball, whether it touched another in the last frame; what leans on another touches it, too. All `false` before
    /// the first frame, and where the world has no pairs. Where pairs are only detected ([`Pairs::Detect`]), `contact` tells who
    /// overlaps at the frame's end.
    #[must_use]
    pub fn touching(&self) -> &[bool] {
        &self.touching
    }

    /// Notes which of the first balls have touched others in the last frame, too, where that was cut into several.
    pub(crate) fn note_touching(&mut self, touched: &[bool]) {
        for (touching, &touched) in self.touching.iter_mut().zip(touched) {
            *touching |= touched;
        }
    }

    /// The world as it is now.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The solver in use.
    #[must_use]
    pub fn solver(&self) -> Solver {
        self.solver
    }

    /// The time simulated so far, s: the sum of all deltas, less what was left out of them. Nothing is lost in rounding,
    /// however many they are.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.clock.seconds_since(Clock::default())
    }

    /// What has happened so far.
    #[must_use]
    pub fn tally(&self) -> Tally {
        self.tally
    }

    /// The parts of the solver that run for this world and these balls.
    #[must_use]
    pub fn parts(&self) -> Vec<Part> {
        self.engine.parts(&self.world)
    }

    fn rebuild(&mut self) {
        self.engine = self.solver.engine(&self.world, &self.balls, self.tuning);
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    fn boxed(width: f64, height: f64, radius: f64) -> Result<Simulation, BuildError> {
        let world = World::new(DVec2::new(width, height)).unwrap().with_walls(1.0).unwrap();
        let ball = Ball::new(DVec2::new(width, height) / 2.0, radius).unwrap();
        Simulation::new(world, vec![ball], Solver::Canvas)
    }

    #[test]
    fn a_ball_as_wide_as_the_world_fits_and_a_wider_one_does_not() {
        assert!(boxed(100.0, 50.0, 25.0).is_ok());
        assert!(matches!(boxed(100.0, 50.0, 25.1), Err(BuildError::BallWiderThanWorld { index: 0, .. })));
        let mut simulation = boxed(100.0, 50.0, 10.0).unwrap();
        let wide = Ball::new(DVec2::splat(20.0), 26.0).unwrap();
        assert!(matches!(simulation.add(&[wide]), Err(BuildError::BallWiderThanWorld { index: 1, .. })));
        assert_eq!(simulation.balls().len(), 1);
    }

    #[test]
    fn shrinking_walls_bring_balls_inside_and_stop_at_the_widest() {
        let mut simulation = boxed(1000.0, 600.0, 40.0).unwrap();
        simulation.resize(DVec2::new(300.0, 200.0)).unwrap();
        assert_eq!(simulation.balls()[0].position(), DVec2::new(260.0, 160.0));
        for tiny in [DVec2::ZERO, DVec2::splat(-5.0), DVec2::new(1.0, 3.0)] {
            simulation.resize(tiny).unwrap();
            assert_eq!(simulation.world().size(), DVec2::splat(80.0));
            assert_eq!(simulation.balls()[0].position(), DVec2::splat(40.0));
        }
        for wrong in [f64::INFINITY, f64::NAN] {
            let before = simulation.world().size();
            assert!(simulation.resize(DVec2::new(wrong, 100.0)).is_err());
            assert_eq!(simulation.world().size(), before);
        }
        assert_eq!(simulation.world().size(), DVec2::splat(80.0));
    }

    #[test]
    fn without_walls_a_resize_moves_no_ball() {
        let world = World::new(DVec2::splat(500.0)).unwrap();
        let ball = Ball::new(DVec2::splat(400.0), 30.0).unwrap();
        let mut simulation = Simulation::new(world, vec![ball], Solver::Canvas).unwrap();
        simulation.resize(DVec2::splat(10.0)).unwrap();
        assert_eq!(simulation.balls()[0].position(), DVec2::splat(400.0));
    }

    #[test]
    fn a_ball_whose_partner_is_removed_touches_nothing() {
        let world = World::new(DVec2::splat(100.0)).unwrap().with_pairs(Pairs::Detect);
        let ball = |x| Ball::new(DVec2::new(x, 50.0), 10.0).unwrap();
        let mut simulation = Simulation::new(world, vec![ball(40.0), ball(55.0)], Solver::Canvas).unwrap();
        simulation.advance(0.0).unwrap();
        assert_eq!(simulation.touching(), [true, true]);
        simulation.remove_last();
        simulation.advance(0.0).unwrap();
        assert_eq!(simulation.touching(), [false]);
    }

    /// A solver that moves on by half of what it is asked for where it may not go on.
    #[derive(Debug)]
    struct Halting;

    impl Advance for Halting {
        fn advance(&mut self, _: &mut Frame<'_>, seconds: f64, go_on: &mut dyn FnMut() -> bool) -> f64 {
            if go_on() { seconds } else { seconds / 2.0 }
        }

        fn parts(&self, _: &World) -> Vec<Part> {
            Vec::new()
        }

        fn clone_boxed(&self) -> Box<dyn Advance> {
            Box::new(Self)
        }
    }

    #[test]
    fn time_grows_by_what_was_simulated_and_canvas_finishes_whatever_it_is_told() {
        let mut simulation = boxed(100.0, 50.0, 5.0).unwrap();
        assert_eq!(simulation.advance_while(0.5, || false), Ok(0.5));
        assert_eq!(simulation.time(), 0.5);
        assert!(simulation.advance_while(-0.5, || true).is_err());
        simulation.engine = Box::new(Halting);
        assert_eq!(simulation.advance_while(0.5, || false), Ok(0.25));
        assert_eq!(simulation.time(), 0.75);
        simulation.advance(0.5).unwrap();
        assert_eq!(simulation.time(), 1.25);
    }

    #[test]
    fn an_hour_of_frames_is_an_hour_to_the_last_digit() {
        let world = World::new(DVec2::splat(100.0)).unwrap();
        for rate in [24.0, 60.0, 144.0] {
            let mut simulation = Simulation::new(world, Vec::new(), Solver::Canvas).unwrap();
            (0..3600 * rate as u32).for_each(|_| simulation.advance(1.0 / rate).unwrap());
            assert!(
                (simulation.time() - 3600.0).abs() <= 4.6e-13,
                "{rate}: {:e}",
                simulation.time() - 3600.0
            );
        }
    }

    #[test]
    fn a_delta_that_is_no_time_is_refused_and_moves_nothing() {
        let mut simulation = boxed(100.0, 50.0, 5.0).unwrap();
        for delta in [-1e-9, f64::NAN, f64::INFINITY, 2e6] {
            assert!(simulation.advance(delta).is_err());
        }
        assert_eq!((simulation.time(), simulation.balls()[0].position()), (0.0, DVec2::new(50.0, 25.0)));
    }
}
