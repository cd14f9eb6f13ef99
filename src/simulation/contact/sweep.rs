//! The order in which stripes are gone through: pass by pass, or, on one thread, several passes on one stripe after the
//! other while the caches hold it.
//!
//! What is done with a stripe must follow what earlier passes do with those that share balls with it, and nothing else: any
//! such order gives the same bits.

use super::cover::Home;
use super::fates::Fate;
use super::layout::{Layer, Layout};
use super::near::Near;
use super::sleep::Rest;
use super::stripes::{Stripe, of_layer};
use super::{Body, Contact, Setting};

/// What is done with stripes of some layers, one layer after the other.
#[derive(Clone, Copy)]
pub(super) struct Pass<'a> {
    pub(super) layers: &'a [Layer],
    /// Whether it passes over stripes that have no pairs and nothing beside walls.
    pub(super) only_busy: bool,
    pub(super) work: &'a (dyn Fn(&Setting, &mut Stripe, &mut Share<'_>) + Sync),
}

impl Pass<'_> {
    /// Works on one stripe.
    #[inline]
    fn work_on(&self, setting: &Setting, stripe: &mut Stripe, share: &mut Share<'_>) {
        if !(self.only_busy && stripe.is_idle()) {
            (self.work)(setting, stripe, share);
        }
    }
}

/// The bodies of a stripe, and what is known of them.
pub(super) struct Share<'a> {
    pub(super) bodies: &'a mut [Body],
    pub(super) fates: &'a [Fate],
    pub(super) rests: &'a [Rest],
    pub(super) homes: &'a [Home],
}

impl Contact {
    /// Goes through all stripes, so that each pass finds what those before it left.
    pub(super) fn sweep(&mut self, passes: &[Pass<'_>]) {
        let Self { setting, bodies, rests, near: Some(near), course, team, .. } = self else { return };
        course.fates.resize(bodies.len(), Fate::default());
        let Near { layout, stripes, homes, .. } = near;
        let fates = &course.fates[..];
        if let [stripe] = &mut stripes[..] {
            let share = &mut Share { bodies, fates, rests, homes };
            for pass in passes {
                let times = pass.layers.iter().filter(|&&layer| layer == Layer::Own).count();
                (0..times).for_each(|_| pass.work_on(setting, stripe, share));
            }
            return;
        }
        if stripes.is_empty() {
            // There are no balls yet.
            return;
        }
        let none_rest = of_layer(stripes, *layout, Layer::Rest).all(|stripe| stripe.is_idle());
        let steps = passes.iter().flat_map(|pass| pass.layers.iter().map(move |&layer| (layer, pass)));
        let steps: Vec<_> = steps.filter(|&(layer, _)| !(none_rest && layer == Layer::Rest)).collect();
        if team.is_one() && none_rest {
            let whole = Share { bodies, fates, rests, homes };
            flow(setting, *layout, stripes, whole, &steps);
            return;
        }
        for steps in steps.chunk_by(|(one, _), (other, _)| one == other) {
            let layer = steps[0].0;
            let shares = of_layer(stripes, *layout, layer).zip(layout.share(layer, bodies));
            let shares = shares.zip(layout.share_read(layer, fates));
            let shares = shares.zip(layout.share_read(layer, rests));
            let shares = shares.zip(layout.share_read(layer, homes));
            team.each(shares, |((((stripe, bodies), fates), rests), homes)| {
                let share = &mut Share { bodies, fates, rests, homes };
                for (_, pass) in steps {
                    pass.work_on(setting, stripe, share);
                }
            });
        }
    }
}

/// Does all steps with one stripe after the other, each as soon as what it follows is done: a stripe is in the caches
/// still when the next step comes to it. No step may be one of the rest.
fn flow(
    setting: &Setting,
    layout: Layout,
    stripes: &mut [Stripe],
    mut whole: Share<'_>,
    steps: &[(Layer, &Pass<'_>)],
) {
    // A seam follows the stripes before and behind it, so it may come right after the latter, one later than the former. A
    // stripe follows the seams at both its edges: it comes one later than the one behind it.
    let mut lag = 0;
    let mut lags = Vec::new();
    for (at, &(layer, _)) in steps.iter().enumerate() {
        lag += usize::from(layer == Layer::Own && at > 0 && steps[at - 1].0 == Layer::Seams);
        lags.push(lag);
    }
    for turn in 0..=layout.stripes() + lag {
        for (&(layer, pass), lag) in steps.iter().zip(&lags) {
            let lag = lag + usize::from(layer == Layer::Seams);
            let Some(number) = turn.checked_sub(lag).and_then(|at| layout.numbers(layer).nth(at)) else {
                continue;
            };
            let share = &mut whole.of(layout, number);
            pass.work_on(setting, &mut stripes[number], share);
        }
    }
}

impl Share<'_> {
    /// That of one stripe, where this is that of all.
    fn of(&mut self, layout: Layout, number: usize) -> Share<'_> {
        let start = layout.start(number).min(self.bodies.len());
        let range = start..start + layout.count(number, self.bodies.len());
        Share {
            bodies: &mut self.bodies[range.clone()],
            fates: &self.fates[range.clone()],
            rests: &self.rests[range.clone()],
            homes: &self.homes[range],
        }
    }
}
