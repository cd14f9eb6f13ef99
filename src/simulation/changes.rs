//! What is done to a simulation from outside, between frames.

use std::fmt;

use glam::DVec2;

use super::Simulation;
use super::ball::Ball;
use super::fit::{BuildError, check_fit, within};
use super::limits::{self, OutOfRange};
use super::separate::{bring_in, bring_strays_in};
use super::solver::{Edit, Solver};

/// Why a ball was not given another velocity, or another place.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum EditError {
    /// There is no ball of this index.
    NoBall {
        /// The index that was given.
        index: usize,
        /// How many balls there are.
        count: usize,
    },
    /// A number is out of range.
    OutOfRange(OutOfRange),
}

impl fmt::Display for EditError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoBall { index, count } => {
                write!(f, "there is no ball {index}, counted from 0; there are {count}")
            }
            Self::OutOfRange(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for EditError {}

impl From<OutOfRange> for EditError {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}

impl Simulation {
    /// Adds balls after those that are there. Those outside of the walls are brought in as by [`new`](Self::new).
    ///
    /// # Errors
    /// [`BuildError`] where one does not fit between the walls, or they are too many; none is added then.
    pub fn add(&mut self, balls: &[Ball]) -> Result<(), BuildError> {
        check_fit(&self.world, balls, self.balls.len())?;
        if balls.is_empty() {
            // A solver that cannot take balls up is made anew, and rounds otherwise then.
            return Ok(());
        }
        self.balls.extend_from_slice(balls);
        self.touching.resize(self.balls.len(), false);
        let moved = bring_strays_in(&self.world, &mut self.balls, self.solver);
        if moved {
            self.rebuild();
        } else {
            self.tell(Edit::Added);
        }
        Ok(())
    }

    /// Takes the last ball away.
    pub fn remove_last(&mut self) -> Option<Ball> {
        self.remove(self.balls.len().checked_sub(1)?)
    }

    /// Takes the ball of this index away, from 0; those after it move up. `None` where there is none.
    pub fn remove(&mut self, index: usize) -> Option<Ball> {
        if index >= self.balls.len() {
            return None;
        }
        let ball = self.balls.remove(index);
        self.touching.remove(index);
        self.tell(Edit::Removed(index));
        Some(ball)
    }

    /// Gives the ball of this index, from 0, another velocity, px/s; its place stays.
    ///
    /// # Errors
    /// [`EditError`] where there is no such ball, or where a component is not in the range of velocities, which for a fixed ball
    /// is 0 alone; nothing has changed then.
    pub fn set_velocity(&mut self, index: usize, velocity: DVec2) -> Result<(), EditError> {
        let ball = self.ball_mut(index)?;
        *ball = ball.with_velocity(velocity)?;
        self.tell(Edit::Thrown(index));
        Ok(())
    }

    /// Moves the ball of this index, from 0, to another place, px, or to the nearest one inside the walls, where there are any. Its
    /// velocity stays. The place may be taken: the balls overlap then, as balls may at the beginning.
    ///
    /// # Errors
    /// [`EditError`] where there is no such ball, or where a coordinate is not in its range; nothing has changed then.
    pub fn set_position(&mut self, index: usize, position: DVec2) -> Result<(), EditError> {
        let (walls, size) = (self.world.walls, self.world.size);
        let ball = self.ball_mut(index)?;
        *ball = ball.with_position(position)?;
        if walls.is_some() {
            ball.position = within(ball.position, ball.radius, size);
        }
        self.tell(Edit::Placed(index));
        Ok(())
    }

    /// Moves the walls, and brings balls that are then outside back in, keeping their velocities; what these are pushed
    /// into gives way, as far as there is room and balls bounce off each other, but not with [`Solver::Canvas`], as in the demo. Where
    /// no ball is fixed, and this would crush some or there is no room for all, the places of all are squeezed together instead, and a
    /// pile rises as a liquid would. Fixed balls stay where they are. The world never becomes narrower than its widest ball, so that
    /// every size a window may take is allowed.
    ///
    /// # Errors
    /// [`OutOfRange`] where a side is NaN, infinite or larger than a world may be; nothing has changed then.
    pub fn resize(&mut self, size: DVec2) -> Result<(), OutOfRange> {
        // A maximum would make a number of a NaN.
        if !size.is_finite() {
            self.world.with_size(size)?;
        }
        let mut size = size.max(DVec2::splat(limits::SIZE.low));
        if self.world.walls.is_some() {
            let widest = self.balls.iter().map(|ball| 2.0 * ball.radius).fold(0.0, f64::max);
            size = size.max(DVec2::splat(widest));
        }
        let from = self.world.size;
        self.world = self.world.with_size(size)?;
        let gives_way = self.solver != Solver::Canvas;
        let moved = self.world.walls.is_some() && bring_in(&self.world, from, &mut self.balls, gives_way);
        if moved || self.world.size != from {
            self.tell(Edit::Walls);
        }
        Ok(())
    }

    /// Sets gravity, px/s²; zero takes it away.
    ///
    /// # Errors
    /// [`OutOfRange`] where a component is not in the range of gravity; nothing has changed then.
    pub fn set_gravity(&mut self, gravity: DVec2) -> Result<(), OutOfRange> {
        let world = self.world.with_gravity(gravity)?;
        if std::mem::replace(&mut self.world, world) != world {
            self.tell(Edit::Gravity);
        }
        Ok(())
    }

    /// Goes on with another solver from the state as it is, except that balls outside of the walls are brought in as by
    /// [`new`](Self::new).
    pub fn set_solver(&mut self, solver: Solver) {
        self.solver = solver;
        bring_strays_in(&self.world, &mut self.balls, solver);
        self.rebuild();
    }

    /// The ball of this index.
    fn ball_mut(&mut self, index: usize) -> Result<&mut Ball, EditError> {
        let count = self.balls.len();
        self.balls.get_mut(index).ok_or(EditError::NoBall { index, count })
    }

    /// Tells the solver what was done, or makes it anew where it can't take that up.
    fn tell(&mut self, edit: Edit) {
        if !self.engine.take_up(&self.world, &self.balls, edit) {
            self.rebuild();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Pairs, World};
    use super::*;

    const EARTH: DVec2 = DVec2::new(0.0, 980.0);

    /// A fixed ball and one that has fallen on it.
    fn simulation(solver: Solver) -> Simulation {
        let world = World::new(DVec2::splat(200.0)).and_then(|world| world.with_gravity(EARTH));
        let world = world.and_then(|world| world.with_walls(0.5)).unwrap().with_pairs(Pairs::Impulse);
        let ball = |y| Ball::new(DVec2::new(100.0, y), 10.0).unwrap();
        let mut simulation = Simulation::new(world, vec![ball(120.0).fixed(), ball(80.0)], solver).unwrap();
        (0..40).for_each(|_| simulation.advance(1.0 / 60.0).unwrap());
        simulation
    }

    #[test]
    fn an_edit_that_cannot_be_done_is_an_error_and_changes_nothing() {
        for &solver in Solver::ALL {
            let (mut simulation, mut untouched) = (simulation(solver), simulation(solver));
            let none = EditError::NoBall { index: 2, count: 2 };
            assert_eq!(simulation.set_velocity(2, DVec2::ZERO), Err(none), "{solver}");
            assert_eq!(simulation.set_position(2, DVec2::ZERO), Err(none), "{solver}");
            assert_eq!(none.to_string(), "there is no ball 2, counted from 0; there are 2");
            assert_eq!(simulation.remove(2), None);
            for wrong in [DVec2::new(0.0, f64::NAN), DVec2::new(f64::INFINITY, 0.0), DVec2::new(2e9, 0.0)] {
                let out_of_range = |done| matches!(done, Err(EditError::OutOfRange(_)));
                for index in [0, 1] {
                    assert!(out_of_range(simulation.set_velocity(index, wrong)), "{solver}: {wrong}");
                    assert!(out_of_range(simulation.set_position(index, wrong)), "{solver}: {wrong}");
                }
                assert!(simulation.set_gravity(wrong).is_err() && simulation.resize(wrong).is_err());
            }
            assert!(simulation.set_velocity(0, DVec2::X).is_err(), "{solver}: the ball is fixed");
            assert!(simulation.add(&[Ball::new(DVec2::ZERO, 101.0).unwrap()]).is_err(), "{solver}");
            assert_eq!(simulation.add(&[]), Ok(()));
            for frame in 0..30 {
                assert_eq!(simulation.balls(), untouched.balls(), "{solver}: frame {frame}");
                simulation.advance(1.0 / 60.0).unwrap();
                untouched.advance(1.0 / 60.0).unwrap();
            }
        }
    }
}
