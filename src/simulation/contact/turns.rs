//! The turns in which impacts of a substep are taken.
//!
//! First each stripe takes its own, in the order of time. It leaves those of balls that are foreseen to meet one of another
//! stripe, or that were hit and have pairs there, and those that may come of these. They are taken by twos of stripes that
//! know the seam between them, first those of every other seam, then of the others; and what these leave, with all that
//! is asleep, was sent where it is not covered, or is hit without end, by all stripes together. Each turn takes its
//! impacts in the order of time, too, and takes back those of earlier turns that they forestall (`rewind`).

use std::collections::BinaryHeap;
use std::mem::take;

use super::ending::{end_exhausted, end_with_others};
use super::events::{Event, Spot};
use super::fates::{Fate, Limits};
use super::impacts::Stage;
use super::layout::{Layer, Layout};
use super::legs::{Leg, Legs};
use super::near::Near;
use super::rewind::Past;
use super::stripe_turn::StripeTurn;
use super::stripes::{Stripe, Stripes};
use super::{Contact, Tally};

/// What is known of the bodies' impacts in a substep.
#[derive(Debug, Clone, Default)]
pub(super) struct Course {
    /// For each body.
    pub(super) fates: Vec<Fate>,
    /// For each body, the first turn that may take its impacts.
    turns: Vec<Turn>,
    /// For each body, its last impact of this substep, if it had any.
    lasts: Vec<Spot>,
    /// Those that are foreseen in the last.
    queue: BinaryHeap<Event>,
    /// Whether it was ended for any fast bodies.
    pub(super) ended: bool,
    /// What they have bodies go along, where a frame asks for it.
    pub(super) legs: Legs,
}

/// Who takes impacts, in the order in which they do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Turn {
    Stripes,
    Even,
    Odd,
    All,
}

impl Turn {
    /// Those that know the pairs of a seam.
    pub(super) fn of_seam(number: usize) -> Self {
        if Layout::twos_of_seam(number) == Layer::Even { Self::Even } else { Self::Odd }
    }
}

impl Course {
    /// Whether a body was hit in the last substep.
    pub(super) fn was_hit(&self, body: usize) -> bool {
        self.fates.get(body).is_some_and(|fate| fate.hits > 0)
    }

    /// Forgets a body that is taken away: those after it move up.
    pub(super) fn forget(&mut self, body: usize) {
        if body < self.fates.len() {
            self.fates.remove(body);
        }
        self.legs.forget(body);
    }
}

impl Contact {
    /// All impacts of a substep.
    pub(super) fn impacts(&mut self, tally: &mut Tally) {
        let Some(near) = &mut self.near else { return };
        // One that began late is shorter than others: where in it a frame ends is not looked for.
        let noted = !self.before.is_empty() && self.late == 0.0;
        self.course.legs.begin(noted);
        self.course.ended = false;
        if near.stripes.iter().all(Stripe::is_idle) {
            self.course.fates.clear();
            return;
        }
        self.course.fates.resize(self.bodies.len(), Fate::default());
        if near.layout.is_cut() {
            self.course.turns.clear();
            self.course.turns.resize(self.bodies.len(), Turn::Stripes);
            self.course.lasts.clear();
            self.course.lasts.resize(self.bodies.len(), Past::NOTHING);
            self.turn(Turn::Stripes, Layer::Own, |mut work| work.begin());
            self.turn(Turn::Stripes, Layer::Seams, |mut work| {
                work.leave_all(Turn::of_seam(work.past.stripes.start));
            });
            self.turn(Turn::Stripes, Layer::Rest, |mut work| work.leave_all(Turn::All));
            self.turn(Turn::Stripes, Layer::Own, |mut work| work.take_own());
            self.turn(Turn::Even, Layer::Even, |mut work| work.take_own());
            self.turn(Turn::Odd, Layer::Odd, |mut work| work.take_own());
        }
        let Self { setting, bodies, restitutions, rests, near: Some(near), hit, course, .. } = self else {
            return;
        };
        let Course { fates, queue, lasts, legs, ended, .. } = course;
        let limits = Limits::of(bodies.len(), near.crowd, setting);
        let noted = legs.noted.then_some(&mut legs.list);
        let mut stage =
            Stage { setting, bodies, fates, restitutions, rests, hit, tally, queue, limits, legs: noted };
        if near.layout.is_cut() {
            let stripes = 0..near.stripes.len();
            let past = Past { now: Turn::All, stripes, start: 0, lasts, later: Vec::new() };
            take_left(&mut stage, near, past);
        } else {
            take_all(&mut stage, near);
        }
        *ended = stage.limits.ended;
        if *ended {
            // For fast ones there the substep was over then.
            legs.list.retain(|leg| !fates[leg.body as usize].is_over());
        }
    }

    /// Works on each part of a layer by itself.
    fn turn(&mut self, now: Turn, layer: Layer, work: impl Fn(StripeTurn<'_>) + Sync + Send) {
        let Self { setting, bodies, restitutions, rests, near: Some(near), hit, course, team, .. } = self
        else {
            return;
        };
        let (layout, crowd) = (near.layout, near.crowd);
        let noted = course.legs.noted;
        let shares = layout.share_stripes(layer, &mut near.stripes);
        let shares = shares.zip(layout.share(layer, bodies)).zip(layout.share(layer, &mut course.fates));
        let shares = shares.zip(layout.share_read(layer, restitutions)).zip(layout.share(layer, rests));
        let shares = shares.zip(layout.share(layer, hit)).zip(layout.share_read(layer, &near.homes));
        let shares = shares.zip(layout.share_read(layer, &near.crossing));
        let shares = shares.zip(layout.share(layer, &mut course.turns));
        let shares = shares.zip(layout.share(layer, &mut course.lasts));
        team.each(shares, |(share, lasts)| {
            let ((((((((stripes, bodies), fates), restitutions), rests), hit), homes), crossing), turns) =
                share;
            let (first, list) = stripes;
            let (mut tally, mut queue) = (Tally::default(), take(&mut list[0].queue));
            let (counts, events) = (&mut tally, &mut queue);
            let mut legs = take(&mut list[0].legs);
            let limits = Limits::of(bodies.len(), crowd, setting);
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
                legs: noted.then_some(&mut legs),
            };
            let stripes = Stripes {
                layout: if list.len() == 1 { Layout::ONE } else { layout.of_block() },
                list: &mut *list,
            };
            let numbers = first..first + stripes.list.len();
            let past = Past { now, stripes: numbers, start: layout.start(first), lasts, later: Vec::new() };
            work(StripeTurn { stage, layout, stripes, homes, crossing, turns, past, struck: Vec::new() });
            list[0].tally.add(&tally);
            list[0].queue = queue;
            list[0].legs = legs;
        });
        for (number, stripe) in near.stripes.iter_mut().enumerate() {
            let start = layout.start(number) as u32;
            let legs = stripe.legs.drain(..).map(|leg| Leg { body: start + leg.body, ..leg });
            course.legs.list.extend(legs);
        }
    }
}

/// Takes all impacts that are left by turns before.
fn take_left(stage: &mut Stage<'_>, near: &mut Near, mut past: Past<'_>) {
    let (layout, count) = (near.layout, stage.bodies.len());
    let mut left = Vec::new();
    for (number, stripe) in near.stripes.iter().enumerate() {
        stage.queue.extend(stripe.left_events.iter().map(|event| event.of_stripe(number)));
        if layout.layer(number) == Layer::Own {
            left.extend(stripe.left_bodies.iter().map(|&body| layout.start(number) + body as usize));
        }
    }
    if !(stage.queue.is_empty() && left.is_empty()) {
        near.link_pairs(count);
    }
    let mut struck: Vec<_> = left.into_iter().map(|body| (body, stage.fates[body].time)).collect();
    go_on(stage, near, &mut past, &mut struck);
    while let Some(event) = next(stage, near) {
        let hit = past.take(&event, stage, &mut near.all());
        struck.extend(hit.into_iter().flatten().map(|body| (body, event.time)));
        go_on(stage, near, &mut past, &mut struck);
    }
    for number in layout.numbers(Layer::Own) {
        stage.tally.add(&near.stripes[number].tally);
    }
}

/// Foresees what comes of bodies that were struck, from when on, and takes back what they forestall.
fn go_on(stage: &mut Stage<'_>, near: &mut Near, past: &mut Past<'_>, struck: &mut Vec<(usize, f64)>) {
    for &(body, _) in &*struck {
        near.widen(body, stage.fates[body].time, stage.bodies, stage.setting);
    }
    while let Some((body, time)) = struck.pop() {
        end_with_others(stage, near, body, time);
        // Nothing is elsewhere.
        let _ = past.foresee(body, time, stage, &mut near.all(), struck);
    }
}

/// Takes all impacts of a substep where all bodies are one stripe.
fn take_all(stage: &mut Stage<'_>, near: &mut Near) {
    let count = stage.bodies.len();
    if stage.begin() {
        (0..count).for_each(|body| stage.foresee_fast_wall(body));
    }
    stage.foresee_all(&mut near.all());
    if !stage.queue.is_empty() {
        near.link_pairs(count);
    }
    while let Some(event) = next(stage, near) {
        let stripes = &mut near.all();
        if let Some(hit) = stage.take_together(&event, stripes) {
            foresee(stage, near, hit.iter().copied());
        } else {
            let hit = stage.take(&event, stripes);
            foresee(stage, near, hit.into_iter().flatten());
        }
    }
}

/// The next impact that holds.
fn next(stage: &mut Stage<'_>, near: &mut Near) -> Option<Event> {
    while let Some(event) = stage.queue.pop() {
        end_exhausted(stage, near, event.time);
        if stage.still_holds(&event, Stage::bodies_of(&event, &near.all())) {
            return Some(event);
        }
    }
    None
}

/// Foresees what comes of bodies that were hit.
fn foresee(stage: &mut Stage<'_>, near: &mut Near, hit: impl Iterator<Item = usize> + Clone) {
    for body in hit.clone() {
        near.widen(body, stage.fates[body].time, stage.bodies, stage.setting);
        end_with_others(stage, near, body, stage.fates[body].time);
    }
    for body in hit {
        stage.foresee(body, &mut near.all(), |_, _| ());
    }
}
