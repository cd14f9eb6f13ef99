//! The velocity that balls have in common which nothing carries: they are fast against that alone.

use glam::DVec2;

use super::Contact;

impl Contact {
    /// Finds the velocity that all balls have in common, where nothing carries any; else there is none.
    pub(super) fn note_common(&mut self) {
        let Self { setting, bodies, rests, near: Some(_), .. } = self else { return };
        setting.common = if setting.grounded || bodies.is_empty() {
            DVec2::ZERO
        } else {
            mean(bodies.iter().zip(&*rests).map(|(body, rest)| (rest.own.recip(), body.velocity)))
        };
    }
}

/// The mean of what so much mass has of something, each: of positions the centre, of velocities the one in common.
pub(super) fn mean(weighed: impl Iterator<Item = (f64, DVec2)>) -> DVec2 {
    let (mass, sum) = weighed.fold((0.0, DVec2::ZERO), |(mass, sum), (own, of)| (mass + own, sum + of * own));
    sum / mass
}
