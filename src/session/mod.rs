//! A scene being played: what people do to a simulation, as commands.
//!
//! Keys, mouse, and whatever else acts on a simulation says it as a [`Command`], so that all share one path. A session
//! knows nothing of windows; it stands between the scenes and those who show them. It remembers what was done, so that
//! time can run back, and the whole can be written down and played again, to the bit.
//!
//! - `command`, `apply`: what there is to do, and what it does;
//! - `state`: what changes and frames move;
//! - `tape`: what happened, and the way back;
//! - `between`: what is shown between its frames in slow motion;
//! - `truth`: the same balls, moved by the exact solver;
//! - `foresight`: when balls next meet, and where a throw will go;
//! - `replay`: a tape as a file;
//! - `work`: what takes long, done a bit in each frame;
//! - `pace`: whether frames keep up with the time that is asked of them;
//! - `thin`: how what grows with time keeps to its room.

mod apply;
mod between;
mod command;
mod foresight;
mod pace;
mod replay;
mod state;
mod tape;
#[cfg(test)]
mod tests;
mod thin;
mod truth;
mod work;

use std::collections::VecDeque;
use std::sync::Arc;

use glam::DVec2;

use between::Between;
pub use command::{Change, Command, CommandError};
use pace::Pace;
pub use replay::{Refused, Replay, ReplayError};
pub use state::Played;
use state::{Start, State};
use tape::{Entry, Frame, Taken, Tape};
use work::Work;
pub use work::Working;

use crate::scene::{self, Scene, SceneError};
use crate::simulation::{Ball, Simulation};

/// The slowest and the fastest time scale.
pub const TIME_SCALES: (f64, f64) = (1.0 / 64.0, 16.0);
/// The longest delta that a frame may measure, s. A frame that took longer (a hitch, a suspended machine, a window that
/// was hidden) advances by this much times the time scale, so that the simulation pauses rather than leaps: `canvas`
/// would carry balls through each other.
pub const LONGEST_FRAME: f64 = 0.1;
/// The delta of a single step while paused, s.
pub const STEP: f64 = 1.0 / 60.0;
/// The radius of a ball that a click adds where there is room and nothing else is said, px.
pub const CLICK_RADIUS: f64 = 20.0;
/// Frames of a tape are due where no more than this is left until they are, s.
const ROUNDING: f64 = 1e-9;
/// Balls of a smaller radius than this, px, can be pointed at as if they had this one.
const LEAST_TARGET: f64 = 6.0;

/// A scene, the simulation that came of it, and how its time runs.
#[derive(Debug)]
pub struct Session {
    /// The scene as it was opened: random balls may have been drawn anew since.
    opened: Arc<Start>,
    state: State,
    tape: Tape,
    /// The size that whoever owns a window said last, px; in the past the world has that which it had then.
    window: Option<DVec2>,
    /// For the random balls that commands add, and those that are drawn anew.
    seed: u64,
    /// How often random balls were drawn anew.
    reseeded: u64,
    paused: bool,
    /// What is left of each single step that was asked for while paused, s.
    steps: VecDeque<f64>,
    time_scale: f64,
    pace: Pace,
    /// Simulated seconds of the tape that are due, where it is played again; negative where it is ahead, s.
    due: f64,
    /// Simulated seconds that are still to be gone back, while one rewinds; negative where that is ahead, s. It ends with the
    /// rewinding: time that runs on begins where that came to.
    back: f64,
    /// What is shown where a frame of the tape is played that is not yet due to its end.
    between: Option<Box<Between>>,
    /// What was asked for and takes longer than a frame.
    work: Option<Work>,
}

impl Session {
    /// Begins to play a scene. `seed` is for the random balls that commands add.
    ///
    /// # Errors
    /// [`SceneError`] where the scene's balls do not fit.
    pub fn new(scene: &Scene, seed: u64) -> Result<Self, SceneError> {
        let state = State::new(scene, seed)?;
        Ok(Self {
            opened: Arc::clone(state.start()),
            tape: Tape::new(&state),
            state,
            window: None,
            seed,
            reseeded: 0,
            paused: false,
            steps: VecDeque::new(),
            time_scale: 1.0,
            pace: Pace::default(),
            due: 0.0,
            back: 0.0,
            between: None,
            work: None,
        })
    }

    /// The scene's name.
    #[must_use]
    pub fn name(&self) -> &str {
        self.state.scene().name()
    }

    /// The scene that is played.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        self.state.scene()
    }

    /// The simulation as it is now. Where what was played is played again in slow motion, by `exact` or `contact`, that is a
    /// moment between two frames; commands act on the end of the frame.
    #[must_use]
    pub fn simulation(&self) -> &Simulation {
        &self.shown().simulation
    }

    /// The state that is shown.
    fn shown(&self) -> &State {
        self.between.as_ref().map_or(&self.state, |between| &between.state)
    }

    /// The same balls moved by the exact solver, where the two are compared.
    #[must_use]
    pub fn truth(&self) -> Option<&Simulation> {
        self.shown().truth.as_ref().map(|truth| &truth.simulation)
    }

    /// How far the balls were from their places in [`truth`](Self::truth): simulated seconds since the comparison
    /// began, and the largest distance, px. Empty where nothing is compared.
    #[must_use]
    pub fn errors(&self) -> &[(f64, f64)] {
        self.shown().truth.as_ref().map_or(&[], |truth| &truth.errors)
    }

    /// The energy, mass·px²/s², that the balls would have if nothing but commands and rain had changed it since the
    /// scene began, or since no ball was left, gravity was changed, or a hand carried a ball.
    #[must_use]
    pub fn given_energy(&self) -> f64 {
        self.shown().given()
    }

    /// Whether a hand carried a ball in the last frame. What it gives and what impacts take are not told apart then: the [given
    /// energy](Self::given_energy) is counted anew in each such frame.
    #[must_use]
    pub fn is_carrying(&self) -> bool {
        self.shown().is_carrying()
    }

    /// Whether time stands still.
    #[must_use]
    pub fn is_paused(&self) -> bool {
        self.paused
    }

    /// Whether a frame now would move anything: time runs, or something that was asked for is still to be done.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        !self.paused || !self.steps.is_empty() || self.is_working()
    }

    /// Whether so many frames were cut short that time runs slower than it should: more than a tenth of the last second of
    /// frames was lost. Stays so until hardly any is, or until something else is played: another scene, another solver, the
    /// scene from its start.
    #[must_use]
    pub fn is_behind(&self) -> bool {
        self.pace.behind
    }

    /// Where the session [is behind](Self::is_behind): the simulated seconds that there were in a measured second.
    #[must_use]
    pub fn speed(&self) -> Option<f64> {
        self.pace.speed()
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

    /// Whether one has gone back in time. What was played since is played again, until a change puts something else in
    /// its place.
    #[must_use]
    pub fn is_in_the_past(&self) -> bool {
        self.tape.next().is_some()
    }

    /// How long ago what is shown was, in simulated seconds.
    #[must_use]
    pub fn seconds_ago(&self) -> f64 {
        let of_this_frame = self.between.as_ref().map_or(0.0, |_| -self.due);
        self.tape.left() + of_this_frame.max(0.0)
    }

    /// A frame after `measured` seconds, scaled by the time scale; at most [`LONGEST_FRAME`] of them count. Nothing
    /// moves while paused except single steps, and a scene's first frame, which has a delta of 0, always takes place.
    ///
    /// # Errors
    /// [`OutOfRange`](crate::OutOfRange) where `measured` is negative or not a number.
    pub fn advance(&mut self, measured: f64) -> Result<(), crate::OutOfRange> {
        self.advance_while(measured, || true)
    }

    /// A frame as [`advance`](Self::advance) takes it, which is cut short where `go_on` says no: then the time that is
    /// left is not simulated, the session [is behind](Self::is_behind), and the next frame goes on from there. What is
    /// left of a single step is left for the next frame. While a session [is working](Self::is_working), time stands
    /// still.
    ///
    /// # Errors
    /// [`OutOfRange`](crate::OutOfRange) where `measured` is negative or not a number.
    pub fn advance_while(
        &mut self,
        measured: f64,
        mut go_on: impl FnMut() -> bool,
    ) -> Result<(), crate::OutOfRange> {
        let measured = crate::simulation::limits::DELTA.check(measured)?.min(LONGEST_FRAME);
        self.back = 0.0;
        if self.is_working() {
            return Ok(());
        }
        if self.is_in_the_past() || self.between.is_some() {
            self.play_again(measured, &mut go_on);
            Ok(())
        } else if self.state.fresh {
            self.frame(0.0, 0.0, &mut go_on).map(drop)
        } else if self.paused {
            while let Some(left) = self.steps.front().copied() {
                let done = self.frame(left, STEP, &mut go_on)?;
                if done < left {
                    self.steps[0] -= done;
                    break;
                }
                self.steps.pop_front();
            }
            Ok(())
        } else {
            let asked = measured * self.time_scale;
            let done = self.frame(asked, measured, &mut go_on)?;
            self.pace.note(measured, asked, done);
            Ok(())
        }
    }

    /// Takes a scene's first frame, which has a delta of 0, where that is still to come: only then is it known which
    /// balls touch.
    ///
    /// # Errors
    /// [`OutOfRange`](crate::OutOfRange): never, for a delta of 0.
    pub fn begin(&mut self) -> Result<(), crate::OutOfRange> {
        if self.state.fresh && !self.is_working() && !self.is_in_the_past() {
            self.frame(0.0, 0.0, &mut || true)?;
        }
        Ok(())
    }

    /// Takes a frame of something new, which is `watched` for so many seconds, and returns the seconds that it moved
    /// on.
    fn frame(
        &mut self,
        seconds: f64,
        watched: f64,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<f64, crate::OutOfRange> {
        self.due = 0.0;
        let (frame, done) = Frame::take(&mut self.state, seconds, go_on)?;
        self.tape.add(Taken { entry: Entry::Frame(frame), done }, watched, &self.state);
        Ok(done)
    }

    /// Plays what was played before: the frames that are due, or that were asked for as single steps. What is shown between
    /// two stays while paused; the first step goes on to the end of that frame.
    fn play_again(&mut self, measured: f64, go_on: &mut dyn FnMut() -> bool) {
        let asked = measured * self.time_scale;
        if !self.paused {
            self.due += asked;
        } else if self.between.is_none() || self.steps.pop_front().is_some() {
            (self.due, self.between) = (0.0, None);
        }
        while let Some(next) = self.tape.next() {
            let is_due = if self.paused { !self.steps.is_empty() } else { self.due >= ROUNDING };
            // A change after a frame waits for the next frame.
            if !is_due {
                break;
            }
            self.between = None;
            if matches!(next.entry, Entry::Frame(_)) {
                if !self.paused && !go_on() {
                    self.due = 0.0;
                    break;
                }
                self.due -= next.done;
                self.steps.pop_front();
                if !self.paused && self.due < -ROUNDING {
                    self.between = Between::of(&self.state, next.done, asked);
                }
            }
            self.tape.play(&mut self.state);
        }
        match &mut self.between {
            Some(between) if self.due < -ROUNDING => between.go(-self.due),
            _ => self.between = None,
        }
        if self.tape.next().is_none() && self.between.is_none() {
            // What is due of the future is new.
            self.due = 0.0;
        }
    }

    /// Makes the world `size` px large, as far as its balls allow. It costs nothing where that is what was asked for
    /// last. In the past the world stays as it was then: whoever owns a window says its size in each frame, and that is
    /// not to take the place of what was played. The next change there, which does, makes it so large first.
    ///
    /// # Errors
    /// [`CommandError`] where no world may have this size.
    pub fn resize(&mut self, size: DVec2) -> Result<(), CommandError> {
        self.window = Some(size);
        if size == self.state.size() || self.is_in_the_past() || self.is_working() {
            Ok(())
        } else {
            self.change(Change::Resize(size))
        }
    }

    /// The radius of the ball that a click at `position` would add, px: `radius`, or what fits between walls and other
    /// balls. `None` where not even one of 2 px does, or what is asked for is no number.
    #[must_use]
    pub fn room_at(&self, position: DVec2, radius: f64) -> Option<f64> {
        self.state.room_at(position, radius)
    }

    /// The index of the ball at `position`, px: the one on top.
    #[must_use]
    pub fn ball_at(&self, position: DVec2) -> Option<usize> {
        let reach = |ball: &Ball| ball.radius().max(LEAST_TARGET);
        let at = |ball: &Ball| ball.position().distance_squared(position) <= reach(ball).powi(2);
        self.simulation().balls().iter().rposition(at)
    }

    /// Where a ball would fly for a second, px, if it were added with this command now; with more than 500 balls, as if
    /// there were only walls and fixed ones.
    #[must_use]
    pub fn path(&self, position: DVec2, velocity: DVec2, radius: f64) -> Vec<DVec2> {
        let ball = Ball::new(position, radius).and_then(|ball| ball.with_velocity(velocity));
        let ball = ball.and_then(|ball| scene::like_the_last(self.simulation().balls(), ball));
        ball.map_or_else(|_| Vec::new(), |ball| foresight::path(self.simulation(), ball))
    }

    /// The balls as they are now, and all around them, as the text of a scene file.
    #[must_use]
    pub fn scene_file(&self) -> String {
        scene::write(&self.state.simulation, self.state.rain(), self.scene().about())
    }

    /// What was played since the scene began, as the text of a replay; `None` where that is too long ago to be all
    /// remembered.
    #[must_use]
    pub fn replay(&self) -> Option<String> {
        Some(replay::write(&self.opened, self.seed, self.tape.whole()?))
    }

    /// Plays another scene in a world of the same size, with pause, time scale and comparison as they are; where `exact` plays, or
    /// rain falls, nothing is compared. From there one cannot go back to what was played before.
    ///
    /// # Errors
    /// [`SceneError`] where the scene's balls do not fit; what is played is as before then.
    pub fn open(&mut self, scene: &Scene) -> Result<(), SceneError> {
        let size = self.window.filter(|_| self.is_in_the_past()).unwrap_or(self.state.size());
        // Fills want the size at hand; what does not fit it is built as the scene would have it, then brought inside.
        let resized = scene.clone().with_size(size).ok();
        let mut session = match resized.and_then(|scene| Self::new(&scene, self.seed).ok()) {
            Some(session) => session,
            None => Self::new(scene, self.seed)?,
        };
        // No world refuses the size of another, and rain and `exact` refuse to be compared.
        let _ = session.resize(size);
        if self.state.truth.is_some() {
            let _ = session.change(Change::Compare(true));
        }
        *self = Self { paused: self.paused, time_scale: self.time_scale, window: self.window, ..session };
        Ok(())
    }
}
