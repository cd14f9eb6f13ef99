//! What people may do, as data.

use glam::DVec2;
use thiserror::Error;

use crate::OutOfRange;
use crate::scene::SceneError;
use crate::simulation::limits::{COORDINATE, GRAVITY, Quantity, RADIUS, SIZE, VELOCITY};
use crate::simulation::{BuildError, EditError, Solver};

/// Something to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command {
    /// Stop time, or let it go on.
    TogglePause,
    /// While paused: advance by [`STEP`](super::STEP), in the frames that follow.
    Step,
    /// While paused: advance to just after the next impact, where the solver is `exact`; else as [`Step`](Self::Step).
    StepToImpact,
    /// Go back to the frame before, as it was.
    Back,
    /// Halve the time scale; where that would pass over 1, make it 1.
    Slower,
    /// Double the time scale; where that would pass over 1, make it 1.
    Faster,
    /// Go to the built-in scene of this number, from 0; nothing happens where there is none.
    Scene(usize),
    /// Go to the next built-in scene.
    NextScene,
    /// Go to the built-in scene before.
    PreviousScene,
    /// Go on with the next solver.
    NextSolver,
    /// Begin the scene again, with other random balls.
    Reseed,
    /// Compare with the exact solver from now on, or do so no longer.
    ToggleComparison,
    /// Change what is simulated.
    Change(Change),
}

/// What changes the simulation apart from time: with the frames between, all that a replay holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// Begin the scene again.
    Reset,
    /// Begin the scene again, its random balls drawn from this seed.
    Reseed(u64),
    /// Add this many random balls, as far as there is room.
    AddRandom(usize),
    /// Add a ball here, smaller where there is less room, but no smaller than 2 px, or than it is to be if that is less: of the
    /// density and restitution of the last ball that is not fixed.
    AddBall {
        /// Its centre, px.
        position: DVec2,
        /// Its velocity, px/s.
        velocity: DVec2,
        /// Its radius, px.
        radius: f64,
    },
    /// Take the last ball away.
    RemoveLast,
    /// Take the ball of this index away, from 0.
    Remove(usize),
    /// Pull a ball by the hand that holds it.
    Carry {
        /// The ball's index, from 0.
        ball: usize,
        /// Where the hand wants it, px.
        to: DVec2,
    },
    /// Put a ball down here, px, or as near as the walls allow, where it overlaps no other.
    Place {
        /// The ball's index, from 0.
        ball: usize,
        /// Its new centre, px.
        at: DVec2,
    },
    /// Go on with another solver.
    Solver(Solver),
    /// Take gravity away, or bring it back.
    ToggleGravity,
    /// Add this to gravity, px/s², or to none where it is off; kept within the range of gravity.
    TiltGravity(DVec2),
    /// Make the world as large as this, px, as far as its balls allow.
    Resize(DVec2),
    /// Compare with the exact solver from now on, or do so no longer.
    Compare(bool),
}

impl Change {
    /// Checks that all its numbers are finite.
    pub(super) fn check(&self) -> Result<(), OutOfRange> {
        let finite = |quantity: &'static Quantity, numbers: DVec2| {
            if numbers.is_finite() { Ok(()) } else { quantity.check_vector(numbers).map(drop) }
        };
        match *self {
            Self::AddBall { position, velocity, radius } => {
                finite(&COORDINATE, position)?;
                finite(&VELOCITY, velocity)?;
                finite(&RADIUS, DVec2::splat(radius))
            }
            Self::Carry { to: place, .. } | Self::Place { at: place, .. } => finite(&COORDINATE, place),
            Self::TiltGravity(by) => finite(&GRAVITY, by),
            Self::Resize(size) => finite(&SIZE, size),
            Self::Reset
            | Self::Reseed(_)
            | Self::AddRandom(_)
            | Self::RemoveLast
            | Self::Remove(_)
            | Self::Solver(_)
            | Self::ToggleGravity
            | Self::Compare(_) => Ok(()),
        }
    }
}

impl From<Change> for Command {
    fn from(change: Change) -> Self {
        Self::Change(change)
    }
}

/// What is said where so few random balls found a place.
fn no_room(placed: usize, count: usize) -> String {
    match (placed, count) {
        (0, 1) => "no room for another ball".to_owned(),
        (0, _) => format!("no room for any of {count} balls"),
        _ => format!("only {placed} of {count} balls found room"),
    }
}

/// Why a command did nothing, or less than it should.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CommandError {
    /// Some of the random balls found no place.
    #[error("{}", no_room(*placed, *count))]
    NoRoom {
        /// How many were added.
        placed: usize,
        /// How many were asked for.
        count: usize,
    },
    /// A ball cannot be added at this place.
    #[error("no room for a ball here")]
    NoRoomHere,
    /// There is no ball of this index.
    #[error("there is no ball {0}, counted from 0")]
    NoBall(usize),
    /// There is no ball to take away.
    #[error("there is no ball to remove")]
    NoBalls,
    /// The ball cannot be moved.
    #[error("this ball is fixed")]
    Fixed,
    /// There is no earlier frame to go back to: the scene begins here.
    #[error("this is the start")]
    AtStart,
    /// What was before is forgotten.
    #[error("this is as far back as is remembered")]
    NoEarlier,
    /// Nothing meets for a long time.
    #[error("no impact within {0} s")]
    NoImpact(f64),
    /// The scene has no random balls.
    #[error("{0} has no random balls to draw anew")]
    NothingRandom(String),
    /// Where balls fall in by chance, there is no one truth.
    #[error("rain cannot be compared: where balls find room depends on the others")]
    RainNotCompared,
    /// What is played is the truth.
    #[error("exact is the solver already: S takes another, to compare with it")]
    ExactNotCompared,
    /// The scene cannot be shown.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The balls do not go into this world.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A number is out of range.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
}

impl From<EditError> for CommandError {
    fn from(error: EditError) -> Self {
        match error {
            EditError::NoBall { index, .. } => Self::NoBall(index),
            EditError::OutOfRange(error) => Self::OutOfRange(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_adds_balls_is_told_how_many_found_room() {
        let said = |placed, count| CommandError::NoRoom { placed, count }.to_string();
        assert_eq!(said(0, 1), "no room for another ball");
        assert_eq!(said(0, 100), "no room for any of 100 balls");
        assert_eq!(said(7, 100), "only 7 of 100 balls found room");
    }
}
