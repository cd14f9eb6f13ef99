//! The turn of a stripe, or of a block of stripes: which impacts it takes by itself, and which it leaves to a later turn
//! (`turns`), since something outside could come into them.

use std::mem::take;

use super::Tally;
use super::cover::Home;
use super::events::Event;
use super::impacts::Stage;
use super::layout::{Layer, Layout};
use super::rewind::{Elsewhere, Past};
use super::stripes::{Stripe, Stripes};
use super::turns::Turn;

/// A stripe, or a block of them, that is worked on by itself.
pub(super) struct StripeTurn<'a> {
    pub(super) stage: Stage<'a>,
    /// That of all stripes.
    pub(super) layout: Layout,
    pub(super) stripes: Stripes<'a>,
    pub(super) homes: &'a [Home],
    pub(super) crossing: &'a [Layer],
    pub(super) turns: &'a mut [Turn],
    pub(super) past: Past<'a>,
    /// Bodies whose impacts are to be foreseen, from when on.
    pub(super) struck: Vec<(usize, f64)>,
}

impl StripeTurn<'_> {
    /// Begins a substep of a stripe.
    pub(super) fn begin(&mut self) {
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
        self.stage.foresee_all(&mut self.stripes);
    }

    /// Leaves all impacts of a seam, or of the rest, to a later turn, and all others of their balls.
    pub(super) fn leave_all(&mut self, later: Turn) {
        self.foresee_all();
        for event in self.stage.queue.iter() {
            for body in Stage::bodies_of(event, &self.stripes).into_iter().flatten() {
                self.turns[body] = later.max(self.turns[body]);
            }
        }
        self.stripes.list[0].left_events.extend(self.stage.queue.drain());
    }

    /// Takes the impacts that nothing outside can come into.
    pub(super) fn take_own(&mut self) {
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
