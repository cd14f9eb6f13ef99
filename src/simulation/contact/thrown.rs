//! Balls that are thrown by what holds them.
//!
//! What held a ball goes on holding it in the next substep, which is right where it rests, or nearly so. Between others of
//! many times its mass it may be given more than any rest needs: given again, that would be speed from nowhere, which
//! impacts would pass on. Such balls are let go of, and start anew.

use glam::DVec2;

use super::layout::Layer;
use super::stripes::{Stripes, of_layer};
use super::support::two;
use super::take_up::let_go;
use super::{Body, Contact};

/// A ball is thrown by what changes its velocity in a substep by more than so many kicks of gravity.
pub(super) const THROWN: f64 = 100.0;

impl Contact {
    /// Forgets what held the balls that it has thrown.
    pub(super) fn let_go_of_thrown(&mut self) {
        let Self { setting, bodies, near: Some(near), team, .. } = self else { return };
        if setting.kick == DVec2::ZERO {
            return;
        }
        let most = THROWN * THROWN * setting.kick.length_squared();
        let layout = near.layout;
        let shares = layout.share_read(Layer::Own, bodies);
        team.each(shares.zip(of_layer(&mut near.stripes, layout, Layer::Own)), |(bodies, stripe)| {
            let thrown = |body: &Body| (body.velocity - body.free).length_squared() > most;
            stripe.thrown.extend((0..).zip(bodies).filter(|(_, body)| thrown(body)).map(|(at, _)| at));
        });
        if near.stripes.iter().all(|stripe| stripe.thrown.is_empty()) {
            return;
        }
        near.link_pairs(bodies.len());
        for number in layout.numbers(Layer::Own) {
            while let Some(body) = near.stripes[number].thrown.pop() {
                let at = layout.start(number) + body as usize;
                near.all().let_go_of(at, bodies);
                bodies[at].free = bodies[at].velocity;
            }
        }
    }
}

impl Stripes<'_> {
    /// Forgets what others and walls give a ball, and it them. Its pairs must be linked.
    pub(super) fn let_go_of(&mut self, body: usize, bodies: &mut [Body]) {
        for number in self.layout.of_body(body) {
            let start = self.layout.start(number);
            let (stripe, own) = (&mut self.list[number], (body - start) as u32);
            let mut cursor = stripe.links.begin(own);
            while let Some(at) = stripe.links.next(&mut cursor) {
                let (pair, hold) = (stripe.pairs[at], &mut stripe.holds[at]);
                if hold.impulse > 0.0 {
                    let other = if pair.first == own { pair.second } else { pair.first };
                    stripe.disturbed.push((other, hold.impulse));
                }
                let (first, second) = two(&mut bodies[start..], pair);
                let_go(hold, first, second);
            }
            if let Some(at) = stripe.place_beside(own) {
                stripe.beside[at].push = DVec2::ZERO;
            }
        }
    }
}
