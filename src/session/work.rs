//! What takes long where there are many balls: going back in time, and finding the next impact. It is done a bit in
//! each frame, so that whoever shows the frames can go on answering.

use super::command::CommandError;
use super::foresight::{Found, Search};
use super::pace::Pace;
use super::tape::Way;
use super::{LONGEST_FRAME, ROUNDING, STEP, Session};
use crate::simulation::Solver;

/// How far a step to the next impact looks ahead, s.
const LOOK_AHEAD: f64 = 10.0;

/// What is being done.
#[derive(Debug)]
pub(super) enum Work {
    /// Going back, by a frame or by some.
    Back(Box<Way>),
    /// Finding out how long a step to the next impact is.
    Impact(Box<Search>),
}

/// What a session does that takes longer than a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Working {
    /// It goes back in time.
    Back,
    /// It looks for the next impact.
    Impact,
}

impl Session {
    /// What was asked for and is not done yet; [`work_while`](Self::work_while) goes on with it, and until then time
    /// stands still.
    #[must_use]
    pub fn working(&self) -> Option<Working> {
        self.work.as_ref().map(|work| match work {
            Work::Back(_) => Working::Back,
            Work::Impact(_) => Working::Impact,
        })
    }

    /// Whether something that was asked for is not done yet.
    #[must_use]
    pub fn is_working(&self) -> bool {
        self.work.is_some()
    }

    /// Gives up what is not done yet, as if it had not been asked for.
    pub fn stop_working(&mut self) {
        self.work = None;
        (self.due, self.back) = (0.0, 0.0);
    }

    /// Goes on with what is not done yet, for as long as `go_on` says so.
    ///
    /// # Errors
    /// [`CommandError::NoImpact`] where a step to the next impact finds none.
    pub fn work_while(&mut self, mut go_on: impl FnMut() -> bool) -> Result<(), CommandError> {
        self.work_on(&mut go_on)
    }

    /// Goes back through what was seen in the last `measured` seconds, scaled by the time scale; whether there was
    /// anything. No more than [`LONGEST_FRAME`] count.
    pub fn rewind(&mut self, measured: f64) -> bool {
        self.rewind_while(measured, || true)
    }

    /// Goes back as [`rewind`](Self::rewind) does for as long as `go_on` says so; the next call goes on from there, and what
    /// there was no time for is not made up for.
    pub fn rewind_while(&mut self, measured: f64, mut go_on: impl FnMut() -> bool) -> bool {
        if self.is_working() {
            // The time that this takes is not gone back. Going back does not fail.
            let _ = self.work_on(&mut go_on);
        } else {
            if self.between.is_some() {
                // What of the frame is not yet shown need not be gone back.
                self.back += (-self.due).max(0.0);
                self.due = 0.0;
            }
            // What is not a number goes back by nothing.
            self.back += measured.clamp(0.0, LONGEST_FRAME).max(0.0) * self.time_scale;
        }
        while !self.is_working() && self.back > ROUNDING {
            if !go_on() {
                // Else it would go on growing, and all of it be gone back at once where that is quick again.
                self.back = 0.0;
                break;
            }
            let back = self.back;
            if !self.begin_back(back) {
                return false;
            }
            self.back = back;
            let _ = self.work_on(&mut go_on);
        }
        true
    }

    /// Begins to go back by a frame, or to before the changes since, or by so many simulated seconds; whether there are any.
    pub(super) fn begin_back(&mut self, seconds: f64) -> bool {
        (self.due, self.back) = (0.0, 0.0);
        let way = self.tape.back(seconds);
        let found = way.is_some();
        self.work = way.map(|way| Work::Back(Box::new(way)));
        found
    }

    /// Why one cannot go back any further, where one cannot.
    pub(crate) fn nothing_before(&self) -> CommandError {
        if self.tape.reaches_start() { CommandError::AtStart } else { CommandError::NoEarlier }
    }

    /// While paused: steps to just after the next impact, or by a frame where that cannot be known.
    pub(super) fn step_to_impact(&mut self) {
        let in_the_past = self.is_in_the_past() || self.between.is_some();
        if !self.is_paused() || self.state.solver() != Solver::Exact || in_the_past {
            self.step(STEP);
        } else if self.steps.is_empty() {
            // One at a time: where the next step begins is not known before the last has been taken.
            self.work = Some(Work::Impact(Box::new(Search::new(&self.state.simulation))));
        }
    }

    /// As [`work_while`](Self::work_while), whatever `go_on` is.
    pub(super) fn work_on(&mut self, go_on: &mut dyn FnMut() -> bool) -> Result<(), CommandError> {
        match self.work.take() {
            None => {}
            Some(Work::Back(mut way)) => {
                let left = self.tape.left();
                if self.tape.go(&mut way, go_on) {
                    // While one rewinds: what was gone back is no longer due, and less where it was more than that.
                    if self.back > 0.0 {
                        self.back -= self.tape.left() - left;
                    }
                    self.state = way.state;
                    self.between = None;
                    self.steps.clear();
                    self.pace = Pace::default();
                } else {
                    self.work = Some(Work::Back(way));
                }
            }
            Some(Work::Impact(mut search)) => match search.look_ahead(LOOK_AHEAD, go_on) {
                Found::After(seconds) => self.step(seconds),
                Found::Nothing => return Err(CommandError::NoImpact(LOOK_AHEAD)),
                Found::Unknown => self.work = Some(Work::Impact(search)),
            },
        }
        Ok(())
    }
}
