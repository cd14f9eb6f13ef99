//! A scene being played: what people do to a simulation, as commands.
//!
//! Keys, mouse, and whatever else acts on a simulation says it as a [`Command`], so that all share one path. A session
//! knows nothing of windows; it stands between the scenes and those who show them.

use std::collections::VecDeque;

use glam::DVec2;
use thiserror::Error;

use crate::scene::{self, Rain, Scene, SceneError};
use crate::simulation::limits::{GRAVITY, MAX_BALLS};
use crate::simulation::{Ball, BuildError, Simulation, Solver, World};

/// The slowest and the fastest time scale.
pub const TIME_SCALES: (f64, f64) = (1.0 / 64.0, 16.0);
/// The longest delta that a frame may measure, s. A frame that took longer (a hitch, a suspended machine, a window that
/// was hidden) advances by this much times the time scale, so that the simulation pauses rather than leaps: `canvas`
/// would carry balls through each other.
pub const LONGEST_FRAME: f64 = 0.1;
/// The delta of a single step while paused, s.
pub const STEP: f64 = 1.0 / 60.0;
/// How many measured seconds of frames must go through whole before a session that fell behind has caught up, s. Were
/// it less, what is said of falling behind would flicker.
const CAUGHT_UP: f64 = 1.0;
/// The radius of a ball that a click adds where there is room, px.
const CLICK_RADIUS: f64 = 20.0;
/// The smallest radius that a click makes do with, px.
const CLICK_RADIUS_LEAST: f64 = 2.0;
/// What G switches on where the scene has no gravity of its own, px/s².
const EARTH: DVec2 = DVec2::new(0.0, 980.0);

/// Gravity that was tilted is a multiple of one part in so many of 1 px/s².
const GRAVITY_DIGITS: f64 = 1e9;

/// Something to do to the simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command {
    /// Stop time, or let it go on.
    TogglePause,
    /// While paused: advance by [`STEP`], in the frames that follow.
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
    /// Add this to gravity, px/s², or to none where it is off; kept within the range of gravity.
    TiltGravity(DVec2),
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
    /// The balls that fall in, if any do.
    rain: Option<Rain>,
    /// What a reset goes back to.
    start: (World, Vec<Ball>, Option<Rain>),
    /// The size that the world was last asked to have, px; wide balls may have made it larger.
    size: DVec2,
    paused: bool,
    /// What is left of each single step that was asked for while paused, s.
    steps: VecDeque<f64>,
    time_scale: f64,
    pace: Pace,
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
            start: (*simulation.world(), simulation.balls().to_vec(), scene.rain()),
            rain: scene.rain(),
            size: simulation.world().size(),
            gravity: simulation.world().gravity().unwrap_or(EARTH),
            simulation,
            paused: false,
            steps: VecDeque::new(),
            time_scale: 1.0,
            pace: Pace::default(),
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

    /// Whether a frame now would move anything: time runs, or single steps are still to be taken.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        !self.paused || !self.steps.is_empty()
    }

    /// Whether frames were cut short, so that time runs slower than it should. Stays so until a second of frames has
    /// gone through whole, or until something else is played: another scene, another solver, the scene from its start.
    #[must_use]
    pub fn is_behind(&self) -> bool {
        self.pace.behind
    }

    /// Simulated seconds per measured second, where the session is not behind.
    #[must_use]
    pub fn time_scale(&self) -> f64 {
        self.time_scale
    }

    /// Sets the time scale, kept within [`TIME_SCALES`].
    pub fn set_time_scale(&mut self, scale: f64) {
        self.time_scale = scale.max(TIME_SCALES.0).min(TIME_SCALES.1);
    }

    /// A frame after `measured` seconds, scaled by the time scale; at most [`LONGEST_FRAME`] of them count. Nothing
    /// moves while paused but single steps, and a scene's first frame, which has a delta of 0, always takes place.
    ///
    /// # Errors
    /// [`OutOfRange`](crate::OutOfRange) where `measured` is negative or not a number.
    pub fn advance(&mut self, measured: f64) -> Result<(), crate::OutOfRange> {
        self.advance_while(measured, || true)
    }

    /// A frame as [`advance`](Self::advance) takes it, which is cut short where `go_on` says no: then the time that is
    /// left is not simulated, the session [is behind](Self::is_behind), and the next frame goes on from there. What is
    /// left of a single step is left for the next frame.
    ///
    /// # Errors
    /// [`OutOfRange`](crate::OutOfRange) where `measured` is negative or not a number.
    pub fn advance_while(
        &mut self,
        measured: f64,
        mut go_on: impl FnMut() -> bool,
    ) -> Result<(), crate::OutOfRange> {
        let Self { simulation, rain, .. } = self;
        let mut advance = |seconds| match rain {
            Some(rain) => rain.advance_while(simulation, seconds, &mut go_on),
            None => simulation.advance_while(seconds, &mut go_on),
        };
        if self.fresh {
            self.fresh = false;
            advance(0.0).map(drop)
        } else if self.paused {
            take(&mut self.steps, advance)
        } else {
            let measured = measured.min(LONGEST_FRAME);
            let asked = measured * self.time_scale;
            let done = advance(asked)?;
            self.pace.note(measured, asked, done);
            Ok(())
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
            Command::TogglePause => {
                self.paused = !self.paused;
                self.steps.clear();
            }
            Command::Step => {
                if self.paused {
                    self.steps.push_back(STEP);
                }
            }
            Command::Reset => self.reset()?,
            Command::AddRandom(count) => self.add_random(count)?,
            Command::AddBall { position, velocity } => self.add_ball(position, velocity)?,
            Command::RemoveLast => drop(self.simulation.remove_last()),
            Command::Scene(number) => self.go_to(number)?,
            Command::NextScene => self.go_by(1)?,
            Command::PreviousScene => self.go_by(-1)?,
            Command::NextSolver => {
                self.simulation.set_solver(next_solver(self.simulation.solver()));
                self.pace = Pace::default();
            }
            Command::ToggleGravity => self.toggle_gravity()?,
            Command::TiltGravity(by) => self.tilt_gravity(by)?,
            Command::Slower => self.set_time_scale(self.time_scale / 2.0),
            Command::Faster => self.set_time_scale(self.time_scale * 2.0),
        }
        Ok(())
    }

    fn reset(&mut self) -> Result<(), CommandError> {
        let (world, balls, rain) = self.start.clone();
        self.rain = rain;
        self.simulation = Simulation::new(world, balls, self.simulation.solver())?;
        self.simulation.resize(self.size)?;
        self.steps.clear();
        self.pace = Pace::default();
        self.fresh = true;
        Ok(())
    }

    fn add_random(&mut self, count: usize) -> Result<(), CommandError> {
        let (world, balls) = (self.simulation.world(), self.simulation.balls());
        let total = balls.len().saturating_add(count);
        if total > MAX_BALLS {
            return Err(BuildError::TooManyBalls { count: total }.into());
        }
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

    fn tilt_gravity(&mut self, by: DVec2) -> Result<(), CommandError> {
        let by = GRAVITY.check_vector(by)?;
        let gravity = self.simulation.world().gravity().unwrap_or_default() + by;
        // Rounded, so that there and back is where it was: 0.1 + 98 - 98 is not 0.1.
        let gravity = (gravity * GRAVITY_DIGITS).round() / GRAVITY_DIGITS;
        let gravity = gravity.clamp(DVec2::splat(GRAVITY.low), DVec2::splat(GRAVITY.high));
        self.simulation.set_gravity(gravity)?;
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

/// Whether the simulation keeps up with the time that is measured.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Pace {
    behind: bool,
    /// Measured seconds since the last frame that was cut short, s; counted only while behind.
    whole: f64,
}

impl Pace {
    /// Notes a frame of `measured` seconds that was `asked` to simulate so many seconds and has `done` so many.
    fn note(&mut self, measured: f64, asked: f64, done: f64) {
        if done < asked {
            *self = Self { behind: true, whole: 0.0 };
        } else if self.behind {
            self.whole += measured;
            self.behind = self.whole < CAUGHT_UP;
        }
    }
}

/// Takes single steps, of which so many seconds are left, with `advance`, which returns the seconds that it got on by;
/// ends with the first that is cut short. Each is an advance of its own: `canvas` would not move the same by their sum.
fn take(
    steps: &mut VecDeque<f64>,
    mut advance: impl FnMut(f64) -> Result<f64, crate::OutOfRange>,
) -> Result<(), crate::OutOfRange> {
    while let Some(left) = steps.front_mut() {
        let done = advance(*left)?;
        if done < *left {
            *left -= done;
            break;
        }
        steps.pop_front();
    }
    Ok(())
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
    fn steps_are_taken_only_while_paused_each_as_a_frame_of_its_own() {
        let mut session = session("gravity");
        session.apply(Command::Step).unwrap();
        assert!(session.steps.is_empty() && session.simulation.time() == 0.0);
        let mut stepped = Scene::load("gravity").unwrap().build().unwrap();
        for seconds in [0.0, STEP, STEP] {
            stepped.advance(seconds).unwrap();
        }
        session.apply(Command::TogglePause).unwrap();
        assert!(!session.is_moving());
        for _ in 0..2 {
            session.apply(Command::Step).unwrap();
        }
        assert!(session.is_moving());
        session.advance(0.5).unwrap();
        assert!(!session.is_moving());
        assert_eq!(session.simulation.time(), 2.0 * STEP);
        assert_eq!(session.simulation.balls(), stepped.balls());
        session.apply(Command::Step).unwrap();
        for _ in 0..2 {
            session.apply(Command::TogglePause).unwrap();
        }
        assert!(!session.is_moving(), "to let time run and stop it again forgets steps");
    }

    #[test]
    fn a_step_that_is_cut_short_is_finished_by_the_next_frames() {
        let mut steps = VecDeque::from([0.5, 0.5]);
        take(&mut steps, |_| Ok(0.125)).unwrap();
        assert_eq!(steps, [0.375, 0.5]);
        take(&mut steps, |_| Ok(0.0)).unwrap();
        assert_eq!(steps, [0.375, 0.5]);
        take(&mut steps, Ok).unwrap();
        assert!(steps.is_empty());
    }

    #[test]
    fn a_pace_is_behind_from_a_frame_cut_short_until_a_second_has_gone_through_whole() {
        let mut pace = Pace::default();
        pace.note(0.25, 0.25, 0.25);
        assert!(!pace.behind);
        // At four times the speed; however much was done, some was not.
        pace.note(0.25, 1.0, 0.75);
        assert!(pace.behind);
        for _ in 0..3 {
            pace.note(0.25, 1.0, 1.0);
            assert!(pace.behind);
        }
        pace.note(0.25, 1.0, 0.0);
        for _ in 0..3 {
            pace.note(0.25, 1.0, 1.0);
            assert!(pace.behind, "the second begins anew with each frame cut short");
        }
        pace.note(0.25, 1.0, 1.0);
        assert!(!pace.behind);
        pace.note(0.0, 0.0, 0.0);
        assert!(!pace.behind, "a frame of no time leaves nothing out");
    }

    #[test]
    fn what_was_behind_is_not_when_something_else_is_played() {
        for command in [Command::Reset, Command::NextSolver, Command::NextScene, Command::Scene(3)] {
            let mut session = session("gravity");
            session.pace.note(0.1, 0.1, 0.05);
            assert!(session.is_behind());
            session.apply(command).unwrap();
            assert!(!session.is_behind(), "{command:?}");
        }
    }

    #[test]
    fn a_session_that_is_not_cut_short_is_not_behind() {
        let mut session = session("gravity");
        session.advance_while(0.1, || false).unwrap();
        assert!(!session.is_behind(), "canvas always finishes");
        assert_eq!(session.simulation.time(), 0.1);
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

    #[test]
    fn gravity_is_tilted_in_clean_steps_from_none_and_back_to_none() {
        let mut session = session("gravity");
        let right = Command::TiltGravity(DVec2::new(98.0, 0.0));
        let up = Command::TiltGravity(DVec2::new(0.0, -98.0));
        session.apply(right).unwrap();
        assert_eq!(session.simulation.world().gravity(), Some(DVec2::new(98.0, 980.0)));
        // G brings back what was tilted, and a tilt while it is off begins from none.
        session.apply(Command::ToggleGravity).unwrap();
        session.apply(Command::ToggleGravity).unwrap();
        assert_eq!(session.simulation.world().gravity(), Some(DVec2::new(98.0, 980.0)));
        session.apply(Command::ToggleGravity).unwrap();
        session.apply(right).unwrap();
        assert_eq!(session.simulation.world().gravity(), Some(DVec2::new(98.0, 0.0)));

        session.apply(Command::Reset).unwrap();
        for _ in 0..10 {
            session.apply(up).unwrap();
        }
        assert_eq!(session.simulation.world().gravity(), None);
        session.apply(up).unwrap();
        assert_eq!(session.simulation.world().gravity(), Some(DVec2::new(0.0, -98.0)));

        session.simulation.set_gravity(DVec2::new(0.1, 9.81)).unwrap();
        let (there, back) = (DVec2::new(98.0, -98.0), DVec2::new(-98.0, 98.0));
        for by in [[there; 100], [back; 100]].concat() {
            session.apply(Command::TiltGravity(by)).unwrap();
        }
        assert_eq!(session.simulation.world().gravity(), Some(DVec2::new(0.1, 9.81)));
    }

    #[test]
    fn gravity_is_tilted_no_further_than_its_range() {
        let mut session = session("gravity");
        for _ in 0..3 {
            session.apply(Command::TiltGravity(DVec2::new(GRAVITY.low, GRAVITY.high))).unwrap();
        }
        assert_eq!(session.simulation.world().gravity(), Some(DVec2::new(GRAVITY.low, GRAVITY.high)));
        assert!(session.apply(Command::TiltGravity(DVec2::new(f64::NAN, 0.0))).is_err());
        assert_eq!(session.simulation.world().gravity(), Some(DVec2::new(GRAVITY.low, GRAVITY.high)));
    }
}
