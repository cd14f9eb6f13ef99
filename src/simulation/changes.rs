//! What is done to a simulation from outside, between frames.

use glam::DVec2;

use super::Simulation;
use super::ball::Ball;
use super::fit::{BuildError, check_fit, within};
use super::limits::{self, OutOfRange};
use super::separate::{bring_in, bring_strays_in};
use super::solver::{Edit, Solver};

impl Simulation {
    /// Adds balls after those that are there. Those outside of the walls are brought in as by [`new`](Self::new).
    ///
    /// # Errors
    /// [`BuildError`] where one does not fit between the walls, or they are too many; none is added then.
    pub fn add(&mut self, balls: &[Ball]) -> Result<(), BuildError> {
        check_fit(&self.world, balls, self.balls.len())?;
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

    /// Gives the ball of this index, from 0, another velocity, px/s; its place stays. Where there is no such ball, nothing happens,
    /// and that is no error.
    ///
    /// # Errors
    /// [`OutOfRange`] where a component is not in the range of velocities, which for a fixed ball is 0 alone; nothing
    /// has changed then.
    pub fn set_velocity(&mut self, index: usize, velocity: DVec2) -> Result<(), OutOfRange> {
        let Some(ball) = self.balls.get_mut(index) else { return Ok(()) };
        *ball = ball.with_velocity(velocity)?;
        self.tell(Edit::Thrown(index));
        Ok(())
    }

    /// Moves the ball of this index, from 0, to another place, px, or to the nearest one inside the walls, where there are any. Its
    /// velocity stays. The place may be taken: the balls overlap then, as balls may at the beginning. Where there is no such ball,
    /// nothing happens, and that is no error.
    ///
    /// # Errors
    /// [`OutOfRange`] where a coordinate is not in its range; nothing has changed then.
    pub fn set_position(&mut self, index: usize, position: DVec2) -> Result<(), OutOfRange> {
        let Some(ball) = self.balls.get_mut(index) else { return Ok(()) };
        *ball = ball.with_position(position)?;
        if self.world.walls.is_some() {
            ball.position = within(ball.position, ball.radius, self.world.size);
        }
        self.tell(Edit::Placed(index));
        Ok(())
    }

    /// Moves the walls, and brings balls that are then outside back in, keeping their velocities; what these are pushed
    /// into gives way, as far as there is room, but not with [`Solver::Canvas`], as in the demo. Fixed balls stay where
    /// they are. The world never becomes narrower than its widest ball, so that every size a window may take is allowed.
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

    /// Tells the solver what was done, or makes it anew where it can't take that up.
    fn tell(&mut self, edit: Edit) {
        if !self.engine.take_up(&self.world, &self.balls, edit) {
            self.rebuild();
        }
    }
}
