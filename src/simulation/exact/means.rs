//! What becomes of the mean velocities of what is carried within a step, as it falls or rises: what it is shown with, and what hits it
//! finds.

use glam::DVec2;

use super::flights::Marks;
use super::{Exact, Needs};

impl Exact {
    /// Whether its velocity is a mean one, from which its flight goes off. Where nothing carries any ball from below they fall together,
    /// and each flight is what it seems: else they would not keep their momentum.
    pub(super) fn goes_off(&self, slot: usize) -> bool {
        self.carry.grounded && self.is_carried(slot)
    }

    /// The same of one that goes along a straight line.
    pub(super) fn goes_off_straight(&self, slot: usize) -> bool {
        self.goes_off(slot) && self.marks[slot].has(Marks::STRAIGHT)
    }

    /// How long after the middle of a step a time is, s.
    pub(super) fn since_middle(&self, now: f64) -> f64 {
        self.carry.next_since(self.origin).map_or(0.0, |next| 0.5 * self.carry.step() - (next - now))
    }

    /// A ball's velocity where that of its flight is this, so long after the middle of a step. That of one that goes off is
    /// its mean one, made as much faster or slower as it has fallen or risen since: it neither gains nor loses energy within a step, if
    /// it is not so slow that this would take more than it has.
    pub(super) fn true_velocity(&self, slot: usize, velocity: DVec2, since_middle: f64) -> DVec2 {
        if !self.goes_off(slot) {
            return velocity;
        }
        let mean = velocity - self.marks[slot].accelerated_part(self.gravity) * since_middle;
        let square = mean.length_squared();
        let gained = self.gained(mean, since_middle);
        if square == 0.0 { mean } else { mean * (1.0 + gained / square).max(0.0).sqrt() }
    }

    /// The square of what [`true_velocity`](Self::true_velocity) makes of a ball's velocity, if it goes straight, or of this: below 0
    /// where it is so slow that it has risen by more than it could.
    pub(super) fn true_square(&self, slot: usize, velocity: DVec2, since_middle: f64) -> f64 {
        let gained = if self.goes_off_straight(slot) { self.gained(velocity, since_middle) } else { 0.0 };
        velocity.length_squared() + gained
    }

    /// With what velocity a ball goes into the next step that waits from now on, where it goes straight so far, and off.
    pub(super) fn onward<N: Needs>(&self, slot: usize, now: f64) -> Option<DVec2> {
        self.goes_off_straight(slot)
            .then(|| self.state::<N>(slot, now).1 + self.gravity * self.since_middle(now))
    }

    /// By how much the square of a mean velocity has grown since the middle of a step, as the ball has fallen: where it is so slow that it
    /// has risen by more than it could, it has lost more than there was.
    fn gained(&self, mean: DVec2, since_middle: f64) -> f64 {
        2.0 * since_middle * self.gravity.dot(mean)
    }

    /// The part of its speed with which what goes off is shown so long after the middle of a step: where it goes straight, what slow
    /// balls have risen by others have given them, which all together are shown with as much less energy. Flights and impacts do not
    /// know of it.
    pub(super) fn shown_part<N: Needs>(&self, since_middle: f64) -> f64 {
        if !self.carry.goes_straight() || since_middle == 0.0 {
            return 1.0;
        }
        let (mut given, mut all) = (0.0, 0.0);
        for slot in (0..self.flights.len()).filter(|&slot| self.goes_off(slot)) {
            let square = self.true_square(slot, self.flights[slot].velocity, since_middle);
            let mass = self.matter::<N>(slot).mass;
            given += mass * (-square).max(0.0);
            all += mass * square.max(0.0);
        }
        if given > 0.0 { (1.0 - given / all.max(given)).sqrt() } else { 1.0 }
    }

    /// The velocity of the flight of a ball that has this one, and is carried from now on, so long after the middle of a step: what
    /// [`true_velocity`](Self::true_velocity) makes that one of again.
    pub(super) fn carried_velocity(&self, velocity: DVec2, since_middle: f64) -> DVec2 {
        if !self.carry.grounded {
            return velocity;
        }
        let direction = velocity.normalize_or_zero();
        let along = since_middle * self.gravity.dot(direction);
        let mean = direction * ((along * along + velocity.length_squared()).sqrt() - along);
        if self.carry.goes_straight() { mean } else { mean + self.gravity * since_middle }
    }

    /// Position and velocity of a ball now, where that of one that is carried is the one that it has.
    pub(super) fn true_state<N: Needs>(&self, slot: usize, now: f64) -> (DVec2, DVec2) {
        let (position, velocity) = self.state::<N>(slot, now);
        if N::HOLDS && self.goes_off(slot) {
            (position, self.true_velocity(slot, velocity, self.since_middle(now)))
        } else {
            (position, velocity)
        }
    }
}
