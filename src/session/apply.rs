//! What commands do.

use super::command::{Change, Command, CommandError};
use super::pace::Pace;
use super::tape::{Entry, Taken};
use super::{STEP, Session};
use crate::scene::{self, Scene};

impl Session {
    /// Does what a command says.
    ///
    /// # Errors
    /// [`CommandError`] where it cannot be done, or only in part; the message is for people.
    pub fn apply(&mut self, command: Command) -> Result<(), CommandError> {
        self.apply_while(command, || true)
    }

    /// Does what a command says. Of what may take long, [`StepToImpact`](Command::StepToImpact) and
    /// [`Back`](Command::Back), only as much as `go_on` lets it; [`work_while`](Self::work_while) goes on with it, and
    /// so does the next command, to its end, before it is done itself.
    ///
    /// # Errors
    /// [`CommandError`] where it cannot be done, or only in part, or else where the work before it came to nothing; the message
    /// is for people.
    pub fn apply_while(
        &mut self,
        command: Command,
        mut go_on: impl FnMut() -> bool,
    ) -> Result<(), CommandError> {
        let before = self.work_on(&mut || true);
        self.take(command)?;
        self.work_on(&mut go_on)?;
        before
    }

    /// Does what a command says, or begins with it.
    fn take(&mut self, command: Command) -> Result<(), CommandError> {
        match command {
            Command::TogglePause => {
                self.paused = !self.paused;
                self.steps.clear();
                if self.between.is_none() {
                    self.due = 0.0;
                }
            }
            Command::Step => self.step(STEP),
            Command::StepToImpact => self.step_to_impact(),
            Command::Back => {
                if !self.begin_back(0.0) {
                    return Err(self.nothing_before());
                }
            }
            Command::Slower => self.set_time_scale(stopping_at_1(self.time_scale, self.time_scale / 2.0)),
            Command::Faster => self.set_time_scale(stopping_at_1(self.time_scale, self.time_scale * 2.0)),
            Command::Scene(number) => self.go_to(number)?,
            Command::NextScene => self.go_by(1)?,
            Command::PreviousScene => self.go_by(-1)?,
            Command::NextSolver => self.change(Change::Solver(self.state.solver().next()))?,
            Command::Reseed => self.reseed()?,
            Command::ToggleComparison => self.change(Change::Compare(self.state.truth.is_none()))?,
            Command::Change(change) => self.change(change)?,
        }
        Ok(())
    }

    /// Does what a change says, and notes it on the tape, whether it can be done or not: but for numbers that are none, which no
    /// replay holds.
    pub(super) fn change(&mut self, change: Change) -> Result<(), CommandError> {
        change.check()?;
        let window = self.window.filter(|&size| self.is_in_the_past() && size != self.state.size());
        if let Some(size) = window.filter(|_| !matches!(change, Change::Resize(_))) {
            // What is added now, or begun again, is for the window as it is now. A size that no world may have is told with the next
            // frame.
            let _ = self.change(Change::Resize(size));
        }
        (self.due, self.between) = (0.0, None);
        let done = self.state.apply(change);
        let entry = Entry::Change(Box::new(change));
        self.tape.add(Taken { entry, done: 0.0 }, 0.0, &self.state);
        if matches!(change, Change::Reset | Change::Reseed(_) | Change::Solver(_)) {
            self.pace = Pace::default();
        }
        if matches!(change, Change::Reset | Change::Reseed(_)) {
            self.steps.clear();
        }
        done
    }

    /// While paused: asks for a single step.
    pub(super) fn step(&mut self, seconds: f64) {
        if self.paused {
            self.steps.push_back(seconds);
        }
    }

    fn reseed(&mut self) -> Result<(), CommandError> {
        if !self.scene().has_random_parts() {
            return Err(CommandError::NothingRandom(self.name().to_owned()));
        }
        self.reseeded += 1;
        self.change(Change::Reseed(self.seed.wrapping_add(self.reseeded)))
    }

    /// Plays the built-in scene so many places on, or back.
    fn go_by(&mut self, steps: isize) -> Result<(), CommandError> {
        let names = scene::names();
        let count = names.len() as isize;
        // By what it is loaded by: a file of the user's own may have a built-in scene's name.
        let here = names.iter().position(|&name| name == self.scene().argument()).map(|index| index as isize);
        // From a scene of the user's own, forward is to the first and back is to the last.
        let here = here.unwrap_or(if steps > 0 { -1 } else { 0 });
        self.go_to((here + steps).rem_euclid(count) as usize)
    }

    /// Plays another built-in scene.
    fn go_to(&mut self, number: usize) -> Result<(), CommandError> {
        let Some(&name) = scene::names().get(number) else { return Ok(()) };
        Ok(self.open(&Scene::load(name)?)?)
    }
}

/// The time scale after this one: `next`, or 1 where that lies between. No doubles of 0.3 come to 1.
fn stopping_at_1(scale: f64, next: f64) -> f64 {
    if (scale - 1.0) * (next - 1.0) < 0.0 { 1.0 } else { next }
}
