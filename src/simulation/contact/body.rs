//! A ball as the `contact` solver moves it.

use glam::DVec2;

use super::super::ball::Ball;

/// What seems to hold a ball is rounding where it gives it less than the first part of its speed, or of gravity's kick, and less than
/// the second part of that kick in any case.
const ROUNDING: (f64, f64) = (1e-13, 1e-3);

/// A ball as the solver moves it: one cache line.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Body {
    /// Where it is; during a substep in which it was hit, where it would have started to end where it does.
    pub(super) position: DVec2,
    /// Its velocity through the substep, px/s: the mean of those at the substep's ends.
    pub(super) velocity: DVec2,
    /// What that would be without the forces that hold it: the difference acts in the next substep, too.
    pub(super) free: DVec2,
    /// What it counts with where it is held (`weights`); 0 where nothing moves it.
    pub(super) inverse_mass: f64,
    pub(super) radius: f64,
}

impl Body {
    pub(super) fn new(ball: &Ball, kick: DVec2) -> Self {
        // Half a substep before its beginning.
        let velocity = if ball.is_fixed() { DVec2::ZERO } else { ball.velocity - 0.5 * kick };
        Self {
            position: ball.position,
            velocity,
            free: velocity,
            inverse_mass: ball.mass.recip(),
            radius: ball.radius,
        }
    }

    /// Lets it be here, and this fast, where a substep is about to begin, held by nothing.
    pub(super) fn go(&mut self, position: DVec2, velocity: DVec2, kick: DVec2) {
        self.position = position;
        // Half a substep before.
        self.velocity = velocity - 0.5 * kick;
        self.free = self.velocity;
    }

    /// Where it is at the end of a substep.
    #[inline]
    pub(super) fn end(&self, substep: f64) -> DVec2 {
        self.position + self.velocity * substep
    }

    /// Whether it overlaps another by more than this part of the smaller radius.
    #[inline]
    pub(super) fn overlaps(&self, other: &Self, part: f64) -> bool {
        self.depth_in(other) > part
    }

    /// How deep it lies in another, in the smaller radius; less than 0 where it does not.
    #[inline]
    pub(super) fn depth_in(&self, other: &Self) -> f64 {
        let apart = self.position.distance(other.position);
        (self.radius + other.radius - apart) / self.radius.min(other.radius)
    }

    /// Whether nothing but gravity acts on it, or nothing moves it.
    #[inline]
    pub(super) fn is_free(&self) -> bool {
        self.inverse_mass == 0.0 || self.velocity == self.free
    }

    /// By what gravity and supports change its velocity from one substep to the next.
    #[inline]
    pub(super) fn change(&self, kick: DVec2) -> DVec2 {
        if self.inverse_mass > 0.0 { kick + (self.velocity - self.free) } else { DVec2::ZERO }
    }

    /// Has it be free where what seems to hold it is only what rounding has left of that.
    #[inline]
    pub(super) fn forget_rounding(&mut self, kick: DVec2) {
        let (of_any, of_kick) = ROUNDING;
        let given = self.velocity.distance_squared(self.free);
        let (speed, kick) = (self.velocity.length_squared(), kick.length_squared());
        if given <= of_any * of_any * (speed + kick) && given <= of_kick * of_kick * kick {
            self.free = self.velocity;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rounding_leaves_of_what_held_a_ball_does_not_hold_it_and_what_little_does_goes_on() {
        let kick = DVec2::new(0.0, 4.0);
        for (left, is_free) in [(4e-15, true), (1e-12, true), (1e-9, false), (-4.0, false)] {
            let mut body = Body::new(&Ball::new(DVec2::splat(50.0), 5.0).unwrap(), DVec2::ZERO);
            body.velocity = DVec2::new(-100.0, left);
            body.free = DVec2::new(-100.0, 0.0);
            body.forget_rounding(kick);
            assert_eq!(body.is_free(), is_free, "{left}");
            assert_eq!(body.velocity.y, left);
        }
        // Where gravity is so weak that rounding is more than its kick.
        let mut body = Body::new(&Ball::new(DVec2::splat(50.0), 5.0).unwrap(), DVec2::ZERO);
        (body.velocity, body.free) = (DVec2::new(1e8, 0.0), DVec2::new(1e8, 1e-9));
        body.forget_rounding(DVec2::new(0.0, 1e-9));
        assert!(!body.is_free());
    }
}
