//! What is shown between two frames of a tape that is played again in slow motion.
//!
//! Each frame is played whole, as it was then, and as soon as any of it is due; a copy of the state before it goes the same way
//! bit by bit, and is shown until the frame is due to its end. Nothing is taken from the copy.

use super::state::State;
use crate::simulation::Solver;

/// A frame that lasts this many times as long as what is asked for of it at once has states between shown.
const LONG: f64 = 1.5;

/// A copy on its way through a frame.
#[derive(Debug)]
pub(super) struct Between {
    pub(super) state: State,
    /// The simulated seconds of the frame, s, and how many of them the copy has gone.
    length: f64,
    gone: f64,
}

impl Between {
    /// A copy of the state before a frame that moves it on by `length` seconds, `asked` of which are shown at a time; `None`
    /// where all frames are shown as they are: they are short enough, or the solver's are.
    pub(super) fn of(state: &State, length: f64, asked: f64) -> Option<Box<Self>> {
        // A frame of `canvas` in parts is not the same frame: what it does depends on the delta.
        let is_shown = length > LONG * asked && state.solver() != Solver::Canvas;
        is_shown.then(|| {
            let mut state = state.clone();
            state.begin_frame();
            Box::new(Self { state, length, gone: 0.0 })
        })
    }

    /// Moves on to where `left` seconds of the frame are left.
    pub(super) fn go(&mut self, left: f64) {
        let seconds = self.length - left - self.gone;
        if seconds > 0.0 {
            // The whole frame took no longer than there was time for, then as now. What cannot be done could not be either.
            let done = self.state.advance(seconds, &mut || true);
            self.gone += done.unwrap_or(seconds);
        }
    }
}
