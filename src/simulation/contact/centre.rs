//! How balls that nothing carries keep their centre on its parabola, whatever time some of them lost.
//!
//! Where the substep was ended for some of them (`ending`), or they had no room (`room`), or nothing was looked for in their way
//! (`cover`), they did not go as far as they are fast. So all that may have come to them are moved by what their centre lacks:
//! against each other they stay as they are.

use super::Contact;
use super::common::mean;
use super::fates::Fate;
use super::islands::islands;
use super::near::Near;

impl Contact {
    /// Moves balls of which some have lost time to where their centre has come. All have moved, and islands of them have the
    /// momentum with which they did.
    pub(super) fn keep_centres(&mut self) {
        let Self { setting, bodies, rests, near: Some(near), course, room, pairs: true, .. } = self else {
            return;
        };
        if setting.grounded || !(course.ended || !room.short.is_empty() || near.strays().next().is_some()) {
            return;
        }
        let mut lost: Vec<bool> = course.fates.iter().map(Fate::is_over).collect();
        room.short.iter().map(|short| short.body).chain(near.strays()).for_each(|at| lost[at] = true);
        for island in islands(bodies.len(), near.pairs()) {
            if !island.iter().any(|&at| lost[at]) {
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

impl Near {
    /// The balls that were kept from going where they are not covered.
    fn strays(&self) -> impl Iterator<Item = usize> {
        self.stripes.iter().enumerate().flat_map(|(number, stripe)| {
            let start = self.layout.start(number);
            stripe.strays.iter().map(move |&at| start + at as usize)
        })
    }
}
