//! Balls that nothing carries keep their centre on its parabola, whatever time some of them lost.
//!
//! Where the substep was ended for some of them (`ending`), or they had no room (`room`), they did not go as far as they are
//! fast. So all that may have come to them are moved by what their centre lacks: against each other they stay as they are.

use glam::DVec2;

use super::Contact;
use super::islands::islands;

impl Contact {
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
            let fate = course.fates[at];
            fate.ended && fate.fast || room.short.binary_search_by_key(&at, |short| short.body).is_ok()
        };
        for island in islands(bodies.len(), near.pairs()) {
            if !island.iter().any(|&at| lost(at)) {
                continue;
            }
            let (mass, lacking) = island.iter().fold((0.0, DVec2::ZERO), |(mass, lacking), &at| {
                let (body, own) = (&bodies[at], rests[at].own.recip());
                let way = (body.velocity - setting.common) * setting.substep;
                (mass + own, lacking + (way - (body.position - room.starts[at])) * own)
            });
            for at in island {
                bodies[at].position += lacking / mass;
            }
        }
    }
}
