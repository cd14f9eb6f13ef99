//! The rounds in which impacts of a substep are taken.
//!
//! In the first each stripe takes its own, in the order of time. It leaves those of balls that are foreseen to meet one
//! of another stripe, that were hit and have pairs there, or that are fast or asleep, and those that may come of these.
//! They are taken in the second round, in the order of time too, but after those of the first: near an edge a ball that
//! is hit more than once in a substep may be hit in another order than in time. What it then meets it still meets, from
//! when it was last hit: nothing is passed through, and no impact gives energy.

use std::collections::BinaryHeap;
use std::mem::take;

use super::cover::Home;
use super::events::Event;
use super::find::Near;
use super::impacts::{Fate, Limits, Stage};
use super::layout::{Layer, Layout};
use super::stripes::{Stripe, Stripes, of_layer};
use super::{Contact, Tally};

/// What is known of the bodies' impacts in a substep.
#[derive(Debug, Clone, Default)]
pub(super) struct Course {
    /// For each body.
    pub(super) fates: Vec<Fate>,
    /// For each body, whether its impacts are left to the second round.
    left: Vec<bool>,
    /// Those that are foreseen there.
    queue: BinaryHeap<Event>,
}

impl Course {
    /// Whether a body was hit in the last substep.
    pub(super) fn was_hit(&self, body: usize) -> bool {
        self.fates.get(body).is_some_and(|fate| fate.hits > 0)
    }
}

impl Contact {
    /// All impacts of a substep.
    pub(super) fn impacts(&mut self, tally: &mut Tally) {
        let Some(near) = &self.near else { return };
        if near.stripes.iter().all(Stripe::is_idle) {
            return;
        }
        self.course.fates.resize(self.bodies.len(), Fate::default());
        if near.layout.is_cut() {
            self.course.left.clear();
            self.course.left.resize(self.bodies.len(), false);
            self.round(Layer::Own, |mut work| {
                *work.stage.tally = Tally::default();
                work.stripe.has_fast = work.stage.begin();
                work.foresee_all();
            });
            for layer in [Layer::Seams, Layer::Rest] {
                self.round(layer, |mut work| {
                    work.stage.queue.clear();
                    work.foresee_all();
                    work.leave_all();
                });
            }
            self.round(Layer::Own, take_own);
        }
        let Self { setting, bodies, restitutions, rests, near: Some(near), hit, course, .. } = self else {
            return;
        };
        let Course { fates, queue, .. } = course;
        let limits = Limits::of(bodies.len(), near.crowd, setting);
        second_round(Stage { setting, bodies, fates, restitutions, rests, hit, tally, queue, limits }, near);
    }

    /// Works on each stripe of a layer by itself.
    fn round(&mut self, layer: Layer, work: impl Fn(Work<'_>) + Sync + Send) {
        let Self { setting, bodies, restitutions, rests, near: Some(near), hit, course, team, .. } = self
        else {
            return;
        };
        let (layout, limits) = (near.layout, Limits::of(bodies.len(), near.crowd, setting));
        let shares = of_layer(&mut near.stripes, layout, layer).iter_mut();
        let shares = shares.zip(layout.share(layer, bodies)).zip(layout.share(layer, &mut course.fates));
        let shares = shares.zip(layout.share_read(layer, restitutions)).zip(layout.share(layer, rests));
        let shares = shares.zip(layout.share(layer, hit)).zip(layout.share_read(layer, &near.homes));
        let shares = shares.zip(layout.share_read(layer, &near.crossing));
        let shares = shares.zip(layout.share(layer, &mut course.left));
        team.each(shares, |share| {
            let ((((((((stripe, bodies), fates), restitutions), rests), hit), homes), crossing), left) =
                share;
            let (mut tally, mut queue) = (stripe.tally, take(&mut stripe.queue));
            let (counts, events) = (&mut tally, &mut queue);
            let stage = Stage {
                setting,
                bodies,
                fates,
                restitutions,
                rests,
                hit,
                tally: counts,
                queue: events,
                limits,
            };
            work(Work { stage, stripe, homes, crossing, left });
            (stripe.tally, stripe.queue) = (tally, queue);
        });
    }
}

/// A stripe that is worked on by itself.
struct Work<'a> {
    stage: Stage<'a>,
    stripe: &'a mut Stripe,
    homes: &'a [Home],
    crossing: &'a [bool],
    left: &'a mut [bool],
}

impl Work<'_> {
    fn foresee_all(&mut self) {
        self.stage.foresee_all(0, &mut alone(self.stripe));
    }

    /// Leaves the impacts of all balls that are foreseen to meet here.
    fn leave_all(&mut self) {
        let stripes = alone(self.stripe);
        for event in self.stage.queue.iter() {
            Stage::bodies_of(event, &stripes).into_iter().flatten().for_each(|body| self.left[body] = true);
        }
    }
}

/// Takes the impacts that nothing outside the stripe can come into.
fn take_own(work: Work<'_>) {
    let Work { mut stage, stripe, homes, crossing, left } = work;
    let (mut events, mut bodies) = (take(&mut stripe.left_events), take(&mut stripe.left_bodies));
    events.clear();
    bodies.clear();
    if !stage.queue.is_empty() {
        stripe.link(stage.bodies.len());
    }
    let mut stripes = alone(stripe);
    while let Some(event) = stage.queue.pop() {
        let met = Stage::bodies_of(&event, &stripes);
        if !stage.still_holds(&event, met) {
            continue;
        }
        let met = met.into_iter().flatten();
        if met.clone().any(|body| left[body] || stage.fates[body].fast || stage.rests[body].asleep) {
            met.for_each(|body| left[body] = true);
            events.push(event);
            continue;
        }
        let hit = stage.take(&event, &mut stripes);
        for body in hit.into_iter().flatten() {
            let covered = homes[body].covers(stage.bodies[body].end(stage.setting.substep));
            if stage.fates[body].fast || crossing[body] || !covered {
                left[body] = true;
                bodies.push(body as u32);
            }
        }
        for body in hit.into_iter().flatten().filter(|&body| !left[body]) {
            stage.foresee(body, &mut stripes);
        }
    }
    (stripe.left_events, stripe.left_bodies) = (events, bodies);
}

/// A stripe as if it were all there is.
fn alone(stripe: &mut Stripe) -> Stripes<'_> {
    Stripes { layout: Layout::ONE, list: std::slice::from_mut(stripe) }
}

/// Takes all impacts that are left.
fn second_round(mut stage: Stage<'_>, near: &mut Near) {
    let (layout, count) = (near.layout, stage.bodies.len());
    if layout.is_cut() {
        stage.queue.clear();
        let seams = layout.numbers(Layer::Own).end;
        for (number, stripe) in near.stripes[..seams].iter().enumerate() {
            stage.tally.add(&stripe.tally);
            stage.queue.extend(stripe.left_events.iter().map(|event| event.of_stripe(number)));
            if stripe.has_fast {
                let start = layout.start(number);
                (start..start + layout.count(number, count)).for_each(|body| stage.foresee_fast_wall(body));
            }
        }
        for (number, stripe) in near.stripes.iter().enumerate().skip(seams) {
            stage.queue.extend(stripe.queue.iter().map(|event| event.of_stripe(number)));
        }
    } else {
        if stage.begin() {
            (0..count).for_each(|body| stage.foresee_fast_wall(body));
        }
        stage.foresee_all(0, &mut near.all());
    }
    let left = |stripe: &Stripe| !stripe.left_bodies.is_empty();
    if !stage.queue.is_empty() || near.stripes.iter().any(left) {
        near.link_pairs(count);
    }
    if layout.is_cut() {
        for number in 0..layout.numbers(Layer::Own).end {
            for at in 0..near.stripes[number].left_bodies.len() {
                let body = layout.start(number) + near.stripes[number].left_bodies[at] as usize;
                near.widen(body, stage.fates[body].time, stage.bodies, stage.setting);
                stage.foresee(body, &mut near.all());
            }
        }
    }
    while let Some(event) = stage.queue.pop() {
        if stage.limits.exhausted && !stage.limits.ended {
            stage.end_fast(event.time);
        }
        let stripes = &mut near.all();
        if !stage.still_holds(&event, Stage::bodies_of(&event, stripes)) {
            continue;
        }
        let together = if layout.is_cut() { None } else { stage.take_together(&event, stripes) };
        if let Some(hit) = together {
            go_on(&mut stage, near, hit.iter().copied());
        } else {
            let hit = stage.take(&event, stripes);
            go_on(&mut stage, near, hit.into_iter().flatten());
        }
    }
}

/// Looks at what comes of bodies that were hit.
fn go_on(stage: &mut Stage<'_>, near: &mut Near, hit: impl Iterator<Item = usize> + Clone) {
    for body in hit.clone() {
        near.widen(body, stage.fates[body].time, stage.bodies, stage.setting);
    }
    for body in hit {
        stage.foresee(body, &mut near.all());
    }
}
