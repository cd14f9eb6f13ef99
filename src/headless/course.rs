//! What a run plays: a scene by frames that are given, or what was done in a window, again.

use super::frames::Frames;
use crate::scene::{Rain, Scene, SceneError};
use crate::session::{Played, Refused, Replay};
use crate::simulation::{Simulation, Solver};

/// What moves in a run, and by which frames.
#[derive(Debug, Clone)]
pub enum Course {
    /// A scene, by these frames.
    Frames(Box<Scene>, Frames),
    /// The frames and changes of a session, from its start, however far this has been played.
    Replay(Box<Replay>),
}

impl Course {
    /// How long it takes at least, s, as far as that is known before it is played.
    pub(super) fn least_seconds(&self) -> f64 {
        match self {
            Self::Frames(_, frames) => frames.seconds(),
            Self::Replay(replay) => replay.least_seconds(),
        }
    }

    /// The scene that is played.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        match self {
            Self::Frames(scene, _) => scene,
            Self::Replay(replay) => replay.scene(),
        }
    }
}

/// A course under way.
pub(super) enum Player<'a> {
    Frames { simulation: Box<Simulation>, rain: Option<Rain>, frames: &'a Frames },
    Replay(Box<Replay>),
}

impl<'a> Player<'a> {
    pub(super) fn new(course: &'a Course) -> Result<Self, SceneError> {
        Ok(match course {
            Course::Frames(scene, frames) => {
                Self::Frames { simulation: Box::new(scene.build()?), rain: scene.rain(), frames }
            }
            Course::Replay(replay) => Self::Replay(Box::new(replay.rewound()?)),
        })
    }

    pub(super) fn simulation(&self) -> &Simulation {
        match self {
            Self::Frames { simulation, .. } => simulation,
            Self::Replay(replay) => replay.simulation(),
        }
    }

    /// What was played since the run's start, whatever a replay reset.
    pub(super) fn played(&self) -> Played {
        match self {
            Self::Frames { simulation, .. } => Played::default().and(simulation),
            Self::Replay(replay) => replay.played(),
        }
    }

    /// The number of frames.
    pub(super) fn frames(&self) -> u64 {
        match self {
            Self::Frames { frames, .. } => frames.count(),
            Self::Replay(replay) => replay.frames(),
        }
    }

    /// The seconds that the frame of this number, from 0, is to move on by; of a replay, only its file knows.
    pub(super) fn delta(&self, frame: u64) -> f64 {
        match self {
            Self::Frames { frames, .. } => frames.delta(frame),
            Self::Replay(_) => 0.0,
        }
    }

    /// Takes the frame of this number, from 0; they must be taken in their order. Frames of `exact` may take any time: now and
    /// then in them it calls `wait`, but not where it plays again what was done in a window, where none took long.
    pub(super) fn advance(&mut self, frame: u64, wait: &mut dyn FnMut()) -> Result<(), crate::OutOfRange> {
        let is_exact = self.simulation().solver() == Solver::Exact;
        let go_on = || {
            if is_exact {
                wait();
            }
            true
        };
        match self {
            Self::Frames { simulation, rain: Some(rain), frames } => {
                rain.advance_while(simulation, frames.delta(frame), go_on).map(drop)
            }
            Self::Frames { simulation, rain: None, frames } => {
                simulation.advance_while(frames.delta(frame), go_on).map(drop)
            }
            Self::Replay(replay) => replay.advance().map(drop),
        }
    }

    /// What has changed the balls' energy, beside the solver.
    pub(super) fn fed(&self) -> Option<&'static str> {
        match self {
            Self::Frames { rain, .. } => {
                rain.as_ref().filter(|rain| rain.energy() != 0.0).map(|_| "balls fell in meanwhile")
            }
            Self::Replay(_) => Some("what was done in the window is played, too"),
        }
    }

    /// Plays what comes after the last frame, changes of a replay, and tells what was refused of them all.
    pub(super) fn finish(&mut self) -> Result<Option<&Refused>, crate::OutOfRange> {
        let Self::Replay(replay) = self else { return Ok(None) };
        while replay.advance()? {}
        Ok(replay.refused())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn in_frames_of_exact_alone_it_is_told_that_they_are_under_way() {
        let text = "size = [300, 300]\n[walls]\n[pairs]\n[[fill]]\ncount = 200\nradius = 4\nspeed = 300\n";
        for (solver, told) in [(Solver::Exact, true), (Solver::Contact, false), (Solver::Canvas, false)] {
            let scene = Scene::parse("gas", text).unwrap().with_solver(solver);
            let course = Course::Frames(scene.into(), Frames::even(1.0, 1.0).unwrap());
            let mut player = Player::new(&course).unwrap();
            let mut times = 0;
            for frame in 0..player.frames() {
                player.advance(frame, &mut || times += 1).unwrap();
            }
            assert_eq!(times > 0, told, "{solver:?}: {times} times");
        }
    }
}
