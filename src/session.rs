//! A scene being played: what people do to a simulation, as commands.
//!
//! Keys, mouse, and whatever else acts on a simulation says it as a [`Command`], so that all share one path. A session
//! knows nothing of windows; it stands between the scenes and those who show them.

use glam::DVec2;
use thiserror::Error;

use crate::scene::{self, Scene, SceneError};
use crate::simulation::{Ball, BuildError, Simulation, Solver, World};

/// The slowest and the fastest time scale.
pub const TIME_SCALES: (f64, f64) = (1.0 / 64.0, 16.0);
/// The longest delta that a frame may measure, s. A frame that took longer (a hitch, a suspended machine, a window that
/// was hidden) advances by this much times the time scale, so that the simulation pauses rather than leaps: `canvas`
/// would carry balls through each other.
pub const LONGEST_FRAME: f64 = 0.1;
/// The delta of a single step while paused, s.
pub const STEP: f64 = 1.0 / 60.0;
/// The radius of a ball that a click adds where there is room, px.
const CLICK_RADIUS: f64 = 20.0;
/// The smallest radius that a click makes do with, px.
const CLICK_RADIUS_LEAST: f64 = 2.0;
/// What G switches on where the scene has no gravity of its own, px/s².
const EARTH: DVec2 = DVec2::new(0.0, 980.0);

/// Something to do to the simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command {
    /// Stop time, or let it go on.
    TogglePause,
    /// While paused: advance by [`STEP`].
    Step,
    /// Begin the scene again.
    Reset,
    /// Add this many random balls, as far as there is room.
    AddRandom(usize),
    /// Add a ball here, px, with this velocity, px/s; smaller where there is less room.
    AddBall {
        /// Its centre.
        position: DVec2,
        /// Its velocity.
        velocity: DVec2,
    },
    /// Take the last ball away.
    RemoveLast,
    /// Go to the built-in scene of this number, from 0.
    Scene(usize),
    /// Go to the next built-in scene.
    NextScene,
    /// Go to the built-in scene before.
    PreviousScene,
    /// Go on with the next solver.
    NextSolver,
    /// Take gravity away, or bring it back.
    ToggleGravity,
    /// Halve the time scale.
    Slower,
    /// Double the time scale.
    Faster,
}

/// Why a command did nothing, or less than it should.
#[derive(Debug, Error)]
pub enum CommandError {
    /// Some of the random balls found no place.
    #[error("only {placed} of {count} balls found room")]
    NoRoom {
        /// How many were added.
        placed: usize,
        /// How many were asked for.
        count: usize,
    },
    /// A ball cannot be added at this place.
    #[error("no room for a ball here")]
    NoRoomHere,
    /// The scene cannot be shown.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The balls do not go into this world.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A number is out of range.
    #[error(transparent)]
    OutOfRange(#[from] crate::OutOfRange),
}

/// A scene, the simulation that came of it, and how its time runs.
#[derive(Debug)]
pub struct Session {
    name: String,
    simulation: Simulation,
    /// What a reset goes back to.
    start: (World, Vec<Ball>),
    /// The size that the world was last asked to have, px; wide balls may have made it larger.
    size: DVec2,
    paused: bool,
    time_scale: f64,
    /// Frame 1 has a delta of 0, whatever the clock says; this is true until it has been.
    fresh: bool,
    seed: u64,
    /// How often random balls were added, so that each time others come.
    additions: u64,
    /// What G brings back.
    gravity: DVec2,
}

impl Session {
    /// Begins to play a scene. `seed` is for the random balls that commands add.
    ///
    /// # Errors
    /// [`SceneError`] where the scene's balls do not fit.
    pub fn new(scene: &Scene, seed: u64) -> Result<Self, SceneError> {
        let simulation = scene.build()?;
        Ok(Self {
            name: scene.name().to_owned(),
            start: (*simulation.world(), simulation.balls().to_vec()),
            size: simulation.world().size(),
            gravity: simulation.world().gravity().unwrap_or(EARTH),
            simulation,
            paused: false,
            time_scale: 1.0,
            fresh: true,
            seed,
            additions: 0,
        })
    }

    /// The scene's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The simulation as it is now.
    #[must_use]
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Whether time stands still.
    #[must_use]
    pub fn is_paused(&self) -> bool {
        self.paused
    }

    /// Simulated seconds per measured second.
    #[must_use]
    pub fn time_scale(&self) -> f64 {
        self.time_scale
    }

    /// Sets the time scale, kept within [`TIME_SCALES`].
    pub fn set_time_scale(&mut self, scale: f64) {
        self.time_scale = scale.max(TIME_SCALES.0).min(TIME_SCALES.1);
    }

    /// A frame after `measured` seconds, scaled by the time scale; at most [`LONGEST_FRAME`] of them count. Nothing
    /// moves while paused, but a scene's first frame, which has a delta of 0, always takes place.
    ///
    /// # Errors
    /// [`OutOfRange`](crate::OutOfRange) where `measured` is negative or not a number.
    pub fn advance(&mut self, measured: f64) -> Result<(), crate::OutOfRange> {
        if self.fresh {
            self.fresh = false;
            self.simulation.advance(0.0)
        } else if self.paused {
            Ok(())
        } else {
            self.simulation.advance(measured.min(LONGEST_FRAME) * self.time_scale)
        }
    }

    /// Makes the world `size` px large, as far as its balls allow. Costs nothing where it was asked for before.
    ///
    /// # Errors
    /// [`OutOfRange`](crate::OutOfRange) where no world may have this size.
    pub fn resize(&mut self, size: DVec2) -> Result<(), crate::OutOfRange> {
        if size != self.size {
            self.simulation.resize(size)?;
            self.size = size;
        }
        Ok(())
    }

    /// The radius of the ball that a click at `position` would add: what fits between walls and other balls.
    #[must_use]
    pub fn room_at(&self, position: DVec2) -> Option<f64> {
        let world = self.simulation.world();
        let mut radius = CLICK_RADIUS;
        if world.walls().is_some() {
            radius = radius.min(position.min(world.size() - position).min_element());
        }
        if world.pairs().is_some() {
            let gap = |ball: &Ball| ball.position().distance(position) - ball.radius();
            radius = self.simulation.balls().iter().map(gap).fold(radius, f64::min);
        }
        (radius >= CLICK_RADIUS_LEAST).then_some(radius)
    }

    /// Does what a command says.
    ///
    /// # Errors
    /// [`CommandError`] where it cannot be done, or only in part; the message is for people.
    pub fn apply(&mut self, command: Command) -> Result<(), CommandError> {
        match command {
            Command::TogglePause => self.paused = !self.paused,
            Command::Step => {
                if self.paused {
                    self.simulation.advance(STEP)?;
                }
            }
            Command::Reset => self.reset()?,
            Command::AddRandom(count) => self.add_random(count)?,
            Command::AddBall { position, velocity } => self.add_ball(position, velocity)?,
            Command::RemoveLast => drop(self.simulation.remove_last()),
            Command::Scene(number) => self.go_to(number)?,
            Command::NextScene => self.go_by(1)?,
            Command::PreviousScene => self.go_by(-1)?,
            Command::NextSolver => self.simulation.set_solver(next_solver(self.simulation.solver())),
            Command::ToggleGravity => self.toggle_gravity()?,
            Command::Slower => self.set_time_scale(self.time_scale / 2.0),
            Command::Faster => self.set_time_scale(self.time_scale * 2.0),
        }
        Ok(())
    }

    fn reset(&mut self) -> Result<(), CommandError> {
        let (world, balls) = self.start.clone();
        self.simulation = Simulation::new(world, balls, self.simulation.solver())?;
        self.simulation.resize(self.size)?;
        self.fresh = true;
        Ok(())
    }

    fn add_random(&mut self, count: usize) -> Result<(), CommandError> {
        let (world, balls) = (self.simulation.world(), self.simulation.balls());
        let balls = scene::filling(count, world, balls, self.seed).place(world, balls, self.additions);
        self.additions += 1;
        self.simulation.add(&balls)?;
        let placed = balls.len();
        if placed < count { Err(CommandError::NoRoom { placed, count }) } else { Ok(()) }
    }

    fn add_ball(&mut self, position: DVec2, velocity: DVec2) -> Result<(), CommandError> {
        let radius = self.room_at(position).ok_or(CommandError::NoRoomHere)?;
        let ball = Ball::new(position, radius)?.with_velocity(velocity)?;
        let ball = scene::like_the_last(self.simulation.balls(), ball)?;
        self.simulation.add(&[ball])?;
        Ok(())
    }

    fn toggle_gravity(&mut self) -> Result<(), CommandError> {
        match self.simulation.world().gravity() {
            Some(gravity) => {
                self.gravity = gravity;
                self.simulation.set_gravity(DVec2::ZERO)?;
            }
            None => self.simulation.set_gravity(self.gravity)?,
        }
        Ok(())
    }

    fn go_by(&mut self, steps: isize) -> Result<(), CommandError> {
        let names = scene::names();
        let count = names.len() as isize;
        let here = names.iter().position(|&name| name == self.name).map(|index| index as isize);
        // From a scene of the user's own, forward is to the first and back is to the last.
        let here = here.unwrap_or(if steps > 0 { -1 } else { 0 });
        self.go_to((here + steps).rem_euclid(count) as usize)
    }

    /// Plays another built-in scene in a world of the same size, with pause and time scale as they are.
    fn go_to(&mut self, number: usize) -> Result<(), CommandError> {
        let Some(&name) = scene::names().get(number) else { return Ok(()) };
        let size = self.size;
        let scene = Scene::load(name)?;
        // Fills want the size at hand; what does not fit it is built as the scene would have it, then brought inside.
        let resized = scene.clone().with_size(size).ok().and_then(|scene| Self::new(&scene, self.seed).ok());
        let session = if let Some(session) = resized {
            session
        } else {
            let mut session = Self::new(&scene, self.seed)?;
            session.resize(size)?;
            session
        };
        *self =
            Self { paused: self.paused, time_scale: self.time_scale, additions: self.additions, ..session };
        Ok(())
    }
}

fn next_solver(solver: Solver) -> Solver {
    let here = Solver::ALL.iter().position(|&other| other == solver).unwrap_or(0);
    Solver::ALL[(here + 1) % Solver::ALL.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn session(scene: &str) -> Session {
        let mut session = Session::new(&Scene::load(scene).unwrap(), 1).unwrap();
        session.advance(0.5).unwrap();
        session
    }

    fn positions(session: &Session) -> Vec<DVec2> {
        session.simulation.balls().iter().map(Ball::position).collect()
    }

    #[test]
    fn the_first_frame_takes_no_time_even_while_paused() {
        let mut session = Session::new(&Scene::load("gravity").unwrap(), 1).unwrap();
        session.apply(Command::TogglePause).unwrap();
        session.advance(0.5).unwrap();
        assert_eq!(session.simulation.time(), 0.0);
        assert!(session.simulation.touching()[1] && session.simulation.touching()[12]);
        session.advance(0.5).unwrap();
        assert_eq!(session.simulation.time(), 0.0);
    }

    #[test]
    fn a_hitch_advances_no_more_than_the_longest_frame() {
        let mut session = session("gravity");
        session.advance(3600.0).unwrap();
        assert_eq!(session.simulation.time(), LONGEST_FRAME);
        session.apply(Command::Slower).unwrap();
        session.advance(0.01).unwrap();
        assert_eq!(session.simulation.time(), LONGEST_FRAME + 0.005);
    }

    #[test]
    fn steps_are_taken_only_while_paused() {
        let mut session = session("gravity");
        session.apply(Command::Step).unwrap();
        assert_eq!(session.simulation.time(), 0.0);
        session.apply(Command::TogglePause).unwrap();
        session.apply(Command::Step).unwrap();
        assert_eq!(session.simulation.time(), STEP);
    }

    #[test]
    fn reset_restores_the_scene_in_the_window_as_it_is() {
        let mut session = session("gravity");
        let start = positions(&session);
        for command in [Command::AddRandom(3), Command::ToggleGravity, Command::RemoveLast] {
            session.apply(command).unwrap();
        }
        session.advance(0.1).unwrap();
        assert_ne!(positions(&session), start);
        session.apply(Command::Reset).unwrap();
        session.advance(0.1).unwrap();
        assert_eq!(positions(&session), start);
        assert_eq!(session.simulation.world().gravity(), Some(EARTH));

        session.resize(DVec2::new(400.0, 300.0)).unwrap();
        session.apply(Command::Reset).unwrap();
        assert_eq!(session.simulation.world().size(), DVec2::new(400.0, 300.0));
        assert!(positions(&session).iter().all(|p| p.cmplt(DVec2::new(400.0, 300.0)).all()));
    }

    #[test]
    fn added_balls_are_others_each_time_and_overlap_nothing() {
        let mut session = session("elastic");
        session.apply(Command::AddRandom(1)).unwrap();
        session.apply(Command::AddRandom(1)).unwrap();
        let balls = session.simulation.balls();
        assert_eq!(balls.len(), 17);
        assert_ne!(balls[15], balls[16]);
        assert_eq!(balls[16].restitution(), 1.0, "in an elastic scene, added balls are elastic");
        let mut grid = crate::simulation::grid::Grid::new(balls, session.simulation.world().size());
        assert!(crate::simulation::invariants::max_overlap(&mut grid, balls) < 1e-9);
    }

    #[test]
    fn a_clicked_ball_fits_its_place_or_is_refused() {
        let mut session = session("gravity");
        let add = |position| Command::AddBall { position, velocity: DVec2::new(5.0, 6.0) };
        session.apply(add(DVec2::new(1000.0, 500.0))).unwrap();
        let ball = *session.simulation.balls().last().unwrap();
        assert_eq!((ball.radius(), ball.velocity()), (CLICK_RADIUS, DVec2::new(5.0, 6.0)));
        session.apply(add(DVec2::new(1275.0, 500.0))).unwrap();
        assert_eq!(session.simulation.balls().last().unwrap().radius(), 5.0);
        assert!(matches!(session.apply(add(DVec2::new(120.0, 100.0))), Err(CommandError::NoRoomHere)));
        assert!(matches!(session.apply(add(DVec2::new(-50.0, 100.0))), Err(CommandError::NoRoomHere)));
        assert!(session.apply(add(DVec2::splat(f64::NAN))).is_err());
        assert_eq!(session.simulation.balls().len(), 17);
    }

    #[test]
    fn scenes_go_round_and_keep_the_windows_size() {
        let mut session = session("gravity");
        session.resize(DVec2::new(900.0, 500.0)).unwrap();
        session.apply(Command::NextScene).unwrap();
        assert_eq!(session.name(), scene::names()[scene::STAGES % scene::names().len()]);
        session.apply(Command::PreviousScene).unwrap();
        assert_eq!(session.name(), "gravity");
        for number in 0..scene::names().len() {
            session.apply(Command::Scene(number)).unwrap();
            assert_eq!(session.name(), scene::names()[number]);
            assert_eq!(session.simulation.world().size(), DVec2::new(900.0, 500.0));
        }
        session.apply(Command::Scene(99)).unwrap();
    }

    #[test]
    fn gravity_comes_back_as_it_was() {
        let mut session = session("gravity");
        session.apply(Command::ToggleGravity).unwrap();
        assert_eq!(session.simulation.world().gravity(), None);
        session.apply(Command::ToggleGravity).unwrap();
        assert_eq!(session.simulation.world().gravity(), Some(EARTH));
    }
}
