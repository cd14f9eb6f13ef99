//! The turns in which impacts of a substep are taken.
//!
//! First each stripe takes its own, in the order of time. It leaves those of balls that are foreseen to meet one of another
//! stripe, or that were hit and have pairs there, and those that may come of these. They are taken by twos of stripes that
//! know the seam between them, first those of every other seam, then of the others; and what these leave, with all that
//! is asleep, was sent where it is not covered, or is hit without end, by all stripes together. Each turn takes its
//! impacts in the order of time, too, and takes back those of earlier turns that they forestall (`rewind`).

use std::collections::BinaryHeap;
use std::mem::take;

use super::cover::Home;
use super::events::{Event, Spot};
use super::fates::{Fate, Limits};
use super::impacts::Stage;
use super::layout::{Layer, Layout};
use super::legs::{Leg, Legs};
use super::near::Near;
use super::rewind::{Elsewhere, Past};
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
    /// Whether it was ended for fast bodies.
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
    fn of_seam(number: usize) -> Self {
        if Layout::twos_of_seam(number) == Layer::Even { Self::Even } else { Self::Odd }
    }
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
        let limits = Limits::of(bodies.len(), bodies.len(), near.crowd, setting);
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
            // For fast balls the substep was over then.
            legs.list.retain(|leg| !fates[leg.body as usize].fast);
        }
    }

    /// Works on each part of a layer by itself.
    fn turn(&mut self, now: Turn, layer: Layer, work: impl Fn(Work<'_>) + Sync + Send) {
        let Self { setting, bodies, restitutions, rests, near: Some(near), hit, course, team, .. } = self
        else {
            return;
        };
        let (layout, count, crowd) = (near.layout, bodies.len(), near.crowd);
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
            let limits = Limits::of(count, bodies.len(), crowd, setting);
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
            work(Work { stage, layout, stripes, homes, crossing, turns, past, struck: Vec::new() });
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

/// A stripe, or a block of them, that is worked on by itself.
struct Work<'a> {
    stage: Stage<'a>,
    /// That of all stripes.
    layout: Layout,
    stripes: Stripes<'a>,
    homes: &'a [Home],
    crossing: &'a [Layer],
    turns: &'a mut [Turn],
    past: Past<'a>,
    /// Bodies whose impacts are to be foreseen, from when on.
    struck: Vec<(usize, f64)>,
}

impl Work<'_> {
    /// Begins a substep of a stripe.
    fn begin(&mut self) {
        let stripe = &mut self.stripes.list[0];
        stripe.tally = Tally::default();
        stripe.taken.clear();
        let has_fast = self.stage.begin();
        self.foresee_all();
        if has_fast {
            (0..self.stage.bodies.len()).for_each(|body| self.stage.foresee_fast_wall(body));
        }
    }

    /// Foresees the impacts of a stripe from the substep's beginning.
    fn foresee_all(&mut self) {
        self.stripes.list[0].left_events.clear();
        self.stripes.list[0].left_bodies.clear();
        self.stage.queue.clear();
        self.stage.foresee_all(0, &mut self.stripes);
    }

    /// Leaves all impacts of a seam, or of the rest, to a later turn, and all others of their balls.
    fn leave_all(&mut self, later: Turn) {
        self.foresee_all();
        for event in self.stage.queue.iter() {
            for body in Stage::bodies_of(event, &self.stripes).into_iter().flatten() {
                self.turns[body] = later.max(self.turns[body]);
            }
        }
        self.stripes.list[0].left_events.extend(self.stage.queue.drain());
    }

    /// Takes the impacts that nothing outside can come into.
    fn take_own(&mut self) {
        let now = self.past.now;
        self.take_back();
        while let Some(event) = self.stage.queue.pop() {
            let met = Stage::bodies_of(&event, &self.stripes);
            if !self.stage.still_holds(&event, met) {
                continue;
            }
            let first_turn = |body: usize| match self.stage.fates[body] {
                _ if self.stage.rests[body].asleep => Turn::All,
                // While it waited to be seen by others it would have passed them.
                fate if fate.fast => self.turns[body].max(self.first_to_know(body)),
                _ => self.turns[body],
            };
            let met = met.into_iter().flatten();
            let later = met.clone().map(first_turn).max().unwrap_or(now);
            if later > now {
                self.leave(event, met, later);
                continue;
            }
            let hit = self.past.take(&event, &mut self.stage, &mut self.stripes);
            for body in hit.into_iter().flatten() {
                self.look_out(body);
            }
            let struck = hit.into_iter().flatten().filter(|&body| self.turns[body] <= now);
            if now == Turn::Stripes {
                struck.for_each(|body| self.stage.foresee(body, &mut self.stripes, |_, _| ()));
            } else {
                self.struck.extend(struck.map(|body| (body, event.time)));
                self.foresee_struck();
            }
        }
    }

    /// Foresees what comes of bodies that were struck, and takes back what they forestall.
    fn foresee_struck(&mut self) {
        while let Some((body, time)) = self.struck.pop() {
            let Self { stage, stripes, past, struck, .. } = self;
            let known = struck.len();
            if past.foresee(body, time, stage, stripes, struck) == Err(Elsewhere) {
                self.turns[body] = Turn::All;
                self.leave_body(body);
            }
            // Those that wait for a later turn since they were hit: what was left of them does not hold any more.
            let mut at = known;
            while let Some(&(body, _)) = self.struck.get(at) {
                if self.turns[body] > self.past.now {
                    self.leave_body(body);
                    self.struck.swap_remove(at);
                } else {
                    at += 1;
                }
            }
        }
    }

    /// Foresees what earlier turns left to this.
    fn take_back(&mut self) {
        let Self { stage, stripes, turns, past, .. } = self;
        let (now, count) = (past.now, stage.bodies.len());
        for number in 0..stripes.list.len() {
            let mut events = take(&mut stripes.list[number].left_events);
            events.retain(|event| {
                let event = event.of_stripe(number);
                let met = Stage::bodies_of(&event, stripes).into_iter().flatten();
                let later = met.clone().map(|body| turns[body]).max().unwrap_or(now);
                let later = if later > now { later_for(stripes.layout, Some(number), later) } else { later };
                // With it wait all others of its balls.
                met.for_each(|body| turns[body] = later.max(turns[body]));
                if later <= now {
                    stage.queue.push(event);
                }
                later > now
            });
            stripes.list[number].left_events = events;
        }
        let waiting = |stripe: &Stripe| !stripe.left_bodies.is_empty();
        if stage.queue.is_empty() && !stripes.list.iter().any(waiting) {
            return;
        }
        for (number, stripe) in stripes.list.iter_mut().enumerate() {
            stripe.link(stripes.layout.count(number, count));
        }
        let mut left = Vec::new();
        for (number, stripe) in stripes.list.iter_mut().enumerate() {
            let start = stripes.layout.start(number);
            stripe.left_bodies.retain(|&body| {
                let body = start + body as usize;
                let waits = turns[body] > now;
                if !waits {
                    left.push(body);
                }
                waits
            });
        }
        self.struck.extend(left.into_iter().map(|body| (body, stage.fates[body].time)));
        self.foresee_struck();
    }

    /// Leaves an impact to a later turn, and all others of its balls.
    fn leave(&mut self, event: Event, met: impl Iterator<Item = usize>, later: Turn) {
        let stripe = event.stripe();
        let later = later_for(self.stripes.layout, stripe, later);
        for body in met {
            self.turns[body] = later.max(self.turns[body]);
            if stripe.is_none() {
                self.leave_body(body);
            }
        }
        if let Some(number) = stripe {
            self.stripes.list[number].left_events.push(event);
        }
    }

    /// Leaves what a body will meet to a later turn.
    fn leave_body(&mut self, body: usize) {
        let (number, own) = self.stripes.layout.place_of(body);
        self.stripes.list[number].left_bodies.push(own);
    }

    /// Leaves what comes of a ball that was hit to a later turn where this one does not know all that it may meet.
    fn look_out(&mut self, body: usize) {
        let Self { stage, homes, .. } = self;
        let covered = homes[body].covers(stage.bodies[body].end(stage.setting.substep));
        let later = if stage.limits.exhausts(&stage.fates[body]) || !covered {
            Turn::All
        } else {
            self.first_to_know(body)
        };
        if later > self.past.now {
            self.turns[body] = later;
            self.leave_body(body);
        }
    }

    /// The first turn from now on that knows all pairs of a ball.
    fn first_to_know(&self, body: usize) -> Turn {
        let now = self.past.now;
        let seam = || self.layout.seam_of(self.past.start + body).map_or(Turn::All, Turn::of_seam);
        match self.crossing[body] {
            Layer::Own => now,
            Layer::Seams if seam() >= now => seam(),
            _ => Turn::All,
        }
    }
}

/// To which turn an impact of a stripe, or of none, has to be left that waits for this one: none but the last comes back to
/// a seam.
fn later_for(layout: Layout, stripe: Option<usize>, later: Turn) -> Turn {
    let is_own = |number| layout.layer(number) == Layer::Own;
    if stripe.is_none_or(is_own) { later } else { Turn::All }
}

/// Takes all impacts that are left by turns before.
fn take_left(stage: &mut Stage<'_>, near: &mut Near, mut past: Past<'_>) {
    let (layout, count) = (near.layout, stage.bodies.len());
    stage.queue.clear();
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
        let hit = stage.take(&event, &mut near.all());
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
        // When the substep was ended for fast bodies, none of them is where it was any more.
        if stage.limits.ended {
            stage.foresee(body, &mut near.all(), |_, _| ());
            continue;
        }
        // All is known here.
        let _ = past.foresee(body, time, stage, &mut near.all(), struck);
    }
}

/// Takes all impacts of a substep where all bodies are one stripe.
fn take_all(stage: &mut Stage<'_>, near: &mut Near) {
    let count = stage.bodies.len();
    if stage.begin() {
        (0..count).for_each(|body| stage.foresee_fast_wall(body));
    }
    stage.foresee_all(0, &mut near.all());
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
        if stage.limits.exhausted && !stage.limits.ended {
            stage.end_fast(event.time);
        }
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
    }
    for body in hit {
        stage.foresee(body, &mut near.all(), |_, _| ());
    }
}
