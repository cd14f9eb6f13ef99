//! Balls that meet in a substep exchange momentum at their time of impact, in the order of these times.
//!
//! Each impulse follows Newton's law of restitution for one pair and takes energy or keeps it, so however many there
//! are, energy never rises. A ball that was hit at time τ goes on from a place from which it would have started to be
//! where it was at τ: later impacts of the same substep, and its end, come out right.
//!
//! A ball that was hit a few times in a substep is left to what supports it (`fates`). A fast one could go through others
//! then, so it may be hit much more often, and where that is not enough, the substep ends for it and for those around it
//! (continuous collision detection; `ending`).

use std::collections::BinaryHeap;

use super::constraints::Marks;
use super::ending::end;
use super::events::{Event, Spot, What};
use super::fates::{DEEP_IN_CROWD, Fate, Limits, Shift, is_fast, meets_one_wall};
use super::legs::Leg;
use super::meeting::{Approach, Meeting, exchange};
use super::sleep::Rest;
use super::stripes::{Stripe, Stripes};
use super::wall_support::hold_jammed;
use super::walls::{bounce_off, first_wall, meet_walls, reaches_wall};
use super::{Body, SHIFT, Setting, Tally};

/// What impacts act on: all bodies, or those of one stripe.
pub(super) struct Stage<'a> {
    pub(super) setting: &'a Setting,
    pub(super) bodies: &'a mut [Body],
    pub(super) fates: &'a mut [Fate],
    pub(super) restitutions: &'a [f64],
    pub(super) rests: &'a mut [Rest],
    pub(super) hit: &'a mut [bool],
    pub(super) tally: &'a mut Tally,
    /// Impacts that are foreseen.
    pub(super) queue: &'a mut BinaryHeap<Event>,
    pub(super) limits: Limits,
    /// The legs that bodies are on after their impacts, where they are noted.
    pub(super) legs: Option<&'a mut Vec<Leg>>,
}

impl Stage<'_> {
    /// Begins a substep. Whether any body is fast.
    pub(super) fn begin(&mut self) -> bool {
        let firm = 0.25 * self.setting.firm * self.setting.firm;
        let mut any_fast = false;
        for (fate, body) in self.fates.iter_mut().zip(&*self.bodies) {
            *fate = Fate::at_start(body.velocity.length_squared() < firm, is_fast(self.setting, body));
            any_fast |= fate.fast;
        }
        any_fast
    }

    /// Foresees the impacts of the only stripe from the substep's beginning.
    #[inline]
    pub(super) fn foresee_all(&mut self, stripes: &mut Stripes<'_>) {
        for at in 0..stripes.list[0].beside.len() {
            self.foresee_wall(Spot { stripe: 0, at: at as u32 }, stripes);
        }
        let stripe = &mut stripes.list[0];
        let mut nearing = std::mem::take(&mut stripe.nearing);
        self.find_nearing(stripe, &mut nearing);
        for &at in &nearing {
            self.foresee_meeting(Spot { stripe: 0, at }, stripe, 0);
        }
        stripe.nearing = nearing;
    }

    /// Looks at the pairs of the only stripe, and gathers the places of those that may meet: most do not, and which do
    /// cannot be foreseen by a processor, so there is no branch.
    fn find_nearing(&self, stripe: &mut Stripe, nearing: &mut Vec<u32>) {
        self.leave_pressing(stripe, nearing);
        let bodies = &*self.bodies;
        let mut found = 0;
        for place in 0..nearing.len() {
            let at = nearing[place];
            let pair = stripe.pairs[at as usize];
            let (first, second) = (&bodies[pair.first as usize], &bodies[pair.second as usize]);
            let mark = &mut stripe.marks[at as usize];
            let approach = Approach::of(self.setting, first, second, mark.has(Marks::HELD));
            mark.set(Marks::CLOSE, approach.closes_in);
            nearing[found] = at;
            found += usize::from(approach.may_meet);
        }
        nearing.truncate(found);
    }

    /// Gathers the places of all pairs but those that only press on each other, or sleep: in a pile that is nearly all.
    /// They are held apart whether they are close or not.
    fn leave_pressing(&self, stripe: &Stripe, places: &mut Vec<u32>) {
        let Stripe { pairs, marks, .. } = stripe;
        places.clear();
        if !self.setting.can_rest {
            places.extend(0..pairs.len() as u32);
            return;
        }
        places.resize(pairs.len(), 0);
        let fates = &*self.fates;
        let mut left = 0;
        for (at, (pair, mark)) in (0..).zip(pairs.iter().zip(marks)) {
            let presses =
                mark.has(Marks::HELD) & fates[pair.first as usize].slow & fates[pair.second as usize].slow;
            places[left] = at;
            left += usize::from(!(presses | mark.has(Marks::IDLE)));
        }
        places.truncate(left);
    }

    /// Foresees the impacts of a body that was hit. Its pairs must be linked. Each is handed to `look` with its two bodies,
    /// too.
    pub(super) fn foresee(
        &mut self,
        body: usize,
        stripes: &mut Stripes<'_>,
        mut look: impl FnMut(Spot, [&Fate; 2]),
    ) {
        let layout = stripes.layout;
        if self.setting.has_fixed {
            self.keep_between(body, stripes);
        }
        if self.fates[body].fast {
            self.foresee_fast_wall(body);
        } else if !self.limits.is_spent(
            &self.fates[body],
            self.fates[body].shift,
            self.setting.walls.unwrap_or_default(),
            1.0,
        ) {
            let (number, own) = layout.place_of(body);
            if let Some(at) = stripes.list[number].place_beside(own) {
                self.foresee_wall(Spot { stripe: number as u32, at: at as u32 }, stripes);
            }
        }
        let (mut pairs, mut deep) = (0, 0);
        for number in stripes.of_body(body) {
            let (stripe, start) = (&mut stripes.list[number], layout.start(number));
            let mut cursor = stripe.links.begin((body - start) as u32);
            while let Some(at) = stripe.links.next(&mut cursor) {
                let spot = Spot { stripe: number as u32, at: at as u32 };
                let bodies = stripe.pairs[at].from(start);
                look(spot, [bodies.first, bodies.second].map(|body| &self.fates[body as usize]));
                deep += u32::from(self.foresee_pair(spot, stripe, start));
                pairs += 1;
            }
        }
        if deep > DEEP_IN_CROWD {
            self.limits.count(pairs);
        }
    }

    #[inline]
    fn foresee_wall(&mut self, spot: Spot, stripes: &Stripes<'_>) {
        let body = beside(spot, stripes);
        let fate = self.fates[body];
        if !fate.fast
            && self.bodies[body].inverse_mass > 0.0
            && let Some(time) = reaches_wall(self.setting, &self.bodies[body])
        {
            self.queue.push(Event {
                time: time.max(fate.time),
                what: What::Wall(spot),
                courses: [fate.course(), 0],
            });
        }
    }

    #[inline]
    pub(super) fn foresee_fast_wall(&mut self, body: usize) {
        let fate = self.fates[body];
        if fate.fast
            && !fate.ended
            && let Some((time, axis)) = first_wall(self.setting, &self.bodies[body], fate.time)
        {
            let what = What::FastWall(body as u32, axis as u8);
            self.queue.push(Event { time, what, courses: [fate.course(), 0] });
        }
    }

    /// Foresees the impact of a pair. Whether one of the two lies deep in the other.
    #[inline]
    fn foresee_pair(&mut self, spot: Spot, stripe: &mut Stripe, start: usize) -> bool {
        let at = spot.at as usize;
        let pair = stripe.pairs[at];
        let (i, j) = (start + pair.first as usize, start + pair.second as usize);
        let mark = &mut stripe.marks[at];
        let approach = Approach::of(self.setting, &self.bodies[i], &self.bodies[j], mark.has(Marks::HELD));
        mark.set(Marks::CLOSE, approach.closes_in);
        if approach.may_meet {
            self.foresee_meeting(spot, stripe, start);
        }
        approach.is_deep
    }

    /// Foresees the impact of a pair that may meet, of a stripe that begins with this body.
    #[inline]
    fn foresee_meeting(&mut self, spot: Spot, stripe: &Stripe, start: usize) {
        let at = spot.at as usize;
        let pair = stripe.pairs[at].from(start);
        let (i, j) = (pair.first as usize, pair.second as usize);
        let [first, second] = [i, j].map(|body| (&self.bodies[body], &self.fates[body]));
        let since = first.1.time.max(second.1.time);
        if let Some(meeting) = self.meeting_of(stripe, at, (i, j), [first, second], since) {
            let courses = [first.1.course(), second.1.course()];
            self.queue.push(Event { time: meeting.time, what: What::Pair(spot), courses });
        }
    }

    /// Whether, and how, a pair meets after `since` while its two balls move like this.
    #[inline]
    pub(super) fn meeting_of(
        &self,
        stripe: &Stripe,
        at: usize,
        bodies: (usize, usize),
        states: [(&Body, &Fate); 2],
        since: f64,
    ) -> Option<Meeting> {
        let marks = stripe.marks[at];
        let [(one, first), (other, second)] = states;
        let presses = marks.has(Marks::HELD) && first.slow && second.slow;
        let fast = first.fast || second.fast;
        let least = self.limits.least(first.shift.max(second.shift));
        let enough = !fast && first.hits.max(second.hits) >= least && self.is_either_spent(bodies, states);
        if marks.has(Marks::IDLE) || presses || enough || first.is_over_with(second) {
            return None;
        }
        Meeting::of(self.setting, one, other, stripe.firm(at, self.setting), since)
    }

    /// Whether one of two balls may not hit the other any more.
    #[cold]
    pub(super) fn is_either_spent(&self, (i, j): (usize, usize), states: [(&Body, &Fate); 2]) -> bool {
        let restitution = self.restitutions[i].min(self.restitutions[j]);
        let [(one, first), (other, second)] = states;
        let shift = first.shift.max(second.shift);
        // One that is twice as large has not many more others around it.
        let size = |own: &Body, other: &Body| own.radius / (2.0 * other.radius);
        self.limits.is_spent(first, shift, restitution, size(one, other))
            || self.limits.is_spent(second, shift, restitution, size(other, one))
    }

    /// Whether, and how, two bodies meet in this substep after both were hit.
    pub(super) fn meeting(&self, (i, j): (usize, usize), firm: Option<f64>) -> Option<Meeting> {
        let since = self.fates[i].time.max(self.fates[j].time);
        Meeting::of(self.setting, &self.bodies[i], &self.bodies[j], firm, since)
    }

    /// The bodies of an impact that is foreseen.
    pub(super) fn bodies_of(event: &Event, stripes: &Stripes<'_>) -> [Option<usize>; 2] {
        match event.what {
            What::Pair(spot) => {
                let (first, second) = pair(spot, stripes);
                [Some(first), Some(second)]
            }
            What::Wall(spot) => [Some(beside(spot, stripes)), None],
            What::FastWall(body, _) => [Some(body as usize), None],
        }
    }

    /// Whether neither of an impact's bodies was hit since it was foreseen.
    pub(super) fn still_holds(&self, event: &Event, bodies: [Option<usize>; 2]) -> bool {
        event.courses == bodies.map(|body| body.map_or(0, |body| self.fates[body].course()))
    }

    /// Takes an impact of bodies that were not hit since it was foreseen. Those that were hit.
    pub(super) fn take(&mut self, event: &Event, stripes: &mut Stripes<'_>) -> [Option<usize>; 2] {
        match event.what {
            What::Pair(spot) => {
                let (i, j) = pair(spot, stripes);
                let [one, other] = [i, j].map(|body| self.fates[body]);
                let fast = one.fast || other.fast;
                if one.is_over_with(&other) {
                    return [None; 2];
                }
                let firm = stripes.list[spot.stripe as usize].firm(spot.at as usize, self.setting);
                let Some(meeting) = self.meeting((i, j), firm) else { return [None; 2] };
                exchange(self, stripes, spot, (i, j), &meeting);
                // A fixed ball goes on as it was: all that is foreseen of it still holds.
                let moved = [i, j].map(|body| (self.bodies[body].inverse_mass > 0.0).then_some(body));
                for body in moved.into_iter().flatten() {
                    let far = meeting.time * meeting.speed > SHIFT * self.bodies[body].radius;
                    self.note_hit(body, event.time, if far { Shift::Some } else { Shift::None });
                    self.fates[body].shift.raise(Shift::Far, fast);
                }
                moved
            }
            What::Wall(spot) => {
                let beside = stripes.list[spot.stripe as usize].beside[spot.at as usize];
                let body = stripes.layout.start(spot.stripe as usize) + beside.body as usize;
                let fate = self.fates[body];
                if fate.is_over() {
                    return [None; 2];
                }
                let before = self.bodies[body];
                let first = meets_one_wall(self.setting, &before, &fate);
                let ball = (&mut self.bodies[body], &self.rests[body]);
                let Some(met) = meet_walls(self.setting, ball, &beside, (fate.time, first), self.tally)
                else {
                    return [None; 2];
                };
                self.fates[body].shift.raise(Shift::Some, met.shifts);
                self.fates[body].bear(met.borne);
                self.note(body, met.time.max(event.time));
                if let Some(legs) = &mut self.legs
                    && let Some(leg) = legs.pop()
                {
                    legs.extend(leg.after_walls(&before, &self.bodies[body], &met).into_iter().flatten());
                }
                [Some(body), None]
            }
            What::FastWall(body, axis) => {
                let body = body as usize;
                if self.fates[body].is_over() {
                    return [None; 2];
                }
                let ball = (&mut self.bodies[body], self.rests[body].in_impacts());
                bounce_off(self.setting, ball, usize::from(axis), event.time, self.tally);
                self.note(body, event.time);
                [Some(body), None]
            }
        }
    }

    /// Notes that a body was hit by another, and how that shifts it.
    pub(super) fn note_hit(&mut self, body: usize, time: f64, shift: Shift) {
        let fate = &mut self.fates[body];
        fate.shift.raise(shift, true);
        fate.slow = false;
        self.note(body, time);
    }

    /// Notes that a body was hit.
    fn note(&mut self, at: usize, time: f64) {
        let Self { setting, bodies, rests, fates, limits, .. } = self;
        if setting.jammed.any() {
            hold_jammed(setting, &mut bodies[at]);
        }
        let fate = &mut fates[at];
        fate.hits += 1;
        fate.time = time;
        let was_fast = fate.fast;
        fate.fast = is_fast(setting, &bodies[at]) || (was_fast && fate.ended);
        fate.shift.raise(Shift::Far, was_fast || fate.fast);
        fate.fast |= limits.follows(setting, (&bodies[at], &rests[at]), fate);
        if fate.is_over() {
            end(setting, &mut bodies[at], time);
        }
        limits.exhausted |= limits.exhausts(fate);
        if let Some(legs) = &mut self.legs {
            legs.push(Leg::of(at, &bodies[at], time));
        }
    }
}

/// The bodies of a pair.
#[inline]
pub(super) fn pair(spot: Spot, stripes: &Stripes<'_>) -> (usize, usize) {
    let pair = stripes.list[spot.stripe as usize].pairs[spot.at as usize];
    let start = stripes.layout.start(spot.stripe as usize);
    (start + pair.first as usize, start + pair.second as usize)
}

/// The body beside a wall.
#[inline]
fn beside(spot: Spot, stripes: &Stripes<'_>) -> usize {
    let beside = stripes.list[spot.stripe as usize].beside[spot.at as usize];
    stripes.layout.start(spot.stripe as usize) + beside.body as usize
}
