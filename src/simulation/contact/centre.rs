//! Balls that nothing carries: what velocity they have in common, against which alone they are fast, and how they keep their
//! centre on its parabola, whatever time some of them lost.
//!
//! Where the substep was ended for some of them (`ending`), or they had no room (`room`), they did not go as far as they are
//! fast. So all that may have come to them are moved by what their centre lacks: against each other they stay as they are.

use glam::DVec2;

use super::Contact;
use super::islands::islands;

impl Contact {
    /// Finds the velocity that all balls have in common, where nothing carries any.
    pub(super) fn note_common(&mut self) {
        let Self { setting, bodies, rests, near: Some(_), .. } = self else { return };
        if !(setting.is_grounded() || bodies.is_empty()) {
            let each = bodies.iter().zip(&*rests);
            setting.common = mean(each.map(|(body, rest)| (rest.own.recip(), body.velocity)));
        }
    }

    /// Moves balls of which some have lost time to where their centre has come. All have moved, and none has more momentum than
    /// it had then.
    pub(super) fn keep_centres(&mut self) {
        let Self { setting, bodies, rests, near: Some(near), course, room, pairs: true, .. } = self else {
            return;
        };
        if setting.is_grounded() || (!course.ended && room.short.is_empty()) {
            return;
        }
        let lost = |at: usize| {
            course.fates[at].is_over() || room.short.binary_search_by_key(&at, |short| short.body).is_ok()
        };
        for island in islands(bodies.len(), near.pairs()) {
            if !island.iter().any(|&at| lost(at)) {
                continue;
            }
            let lacking = mean(island.iter().map(|&at| {
                let way = (bodies[at].velocity - setting.common) * setting.substep;
                (rests[at].own.recip(), way - (bodies[at].position - room.starts[at]))
            }));
            for at in island {
                bodies[at].position += lacking;
            }
        }
    }
}

/// The mean of what so much mass has of something, each: of positions the centre, of velocities the one in common.
pub(super) fn mean(weighed: impl Iterator<Item = (f64, DVec2)>) -> DVec2 {
    let (mass, sum) = weighed.fold((0.0, DVec2::ZERO), |(mass, sum), (own, of)| (mass + own, sum + of * own));
    sum / mass
}
