//! Balls so fast that they could go through others in a substep (continuous collision detection).
//!
//! Their impacts are taken in their order in time, one after the other, before all others of the substep: each ball's
//! path is straight from one to the next, and whatever lies on it is hit. Where one is hit too often, the substep ends for
//! all fast balls there and then: they lose time, never their speed, and go through nothing.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec2;

use super::find::Near;
use super::impacts::{Meeting, strike};
use super::{Body, Setting, Tally};

/// A ball that goes farther in a substep than so many times its radius is fast.
const FAST: f64 = 1.0;
/// Impacts of a ball in one substep, at most.
const MOST: u32 = 256;

/// The fast balls of a substep, and what they hit.
#[derive(Debug, Default)]
pub(super) struct Fast {
    /// Whether there are any; otherwise all that follows is of an earlier substep.
    any: bool,
    which: Vec<bool>,
    /// When each body was last hit, s after the substep's beginning, and how often it was.
    times: Vec<f64>,
    hits: Vec<u32>,
    /// Whether one was hit so often that the substep ends for all of them.
    exhausted: bool,
    queue: BinaryHeap<Event>,
    /// Where the pairs of each body begin in `pairs`; one more than there are bodies.
    starts: Vec<u32>,
    pairs: Vec<u32>,
}

/// An impact that is foreseen, while both bodies have been hit so often.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Event {
    time: f64,
    what: What,
    hits: (u32, u32),
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum What {
    /// The pair of this place meets.
    Pair(u32),
    /// This body meets a wall across this axis.
    Wall(u32, usize),
}

impl Eq for Event {}

impl Ord for Event {
    /// The earliest is the greatest.
    fn cmp(&self, other: &Self) -> Ordering {
        other.time.total_cmp(&self.time)
    }
}

impl PartialOrd for Event {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Fast {
    /// Whether there are fast balls in this substep.
    pub(super) fn find(&mut self, setting: &Setting, bodies: &[Body]) -> bool {
        self.any = bodies.iter().any(|body| is_fast(setting, body));
        self.exhausted = false;
        if self.any {
            self.which.clear();
            self.which.extend(bodies.iter().map(|body| is_fast(setting, body)));
            self.times.clear();
            self.times.resize(bodies.len(), 0.0);
            self.hits.clear();
            self.hits.resize(bodies.len(), 0);
        }
        self.any
    }

    #[inline]
    pub(super) fn has(&self, body: usize) -> bool {
        self.any && self.which[body]
    }

    /// When one of two bodies was last hit by a fast one, s after the substep's beginning.
    #[inline]
    pub(super) fn since(&self, first: usize, second: usize) -> f64 {
        if self.any { self.times[first].max(self.times[second]) } else { 0.0 }
    }

    /// Whether a body was hit by a fast one in this substep, or is one and hit something.
    #[inline]
    pub(super) fn was_hit(&self, body: usize) -> bool {
        self.any && self.hits[body] > 0
    }

    /// All impacts of fast balls in a substep.
    pub(super) fn impacts(
        &mut self,
        setting: &Setting,
        bodies: &mut [Body],
        restitutions: &[f64],
        near: &mut Near,
        hit: &mut [bool],
        tally: &mut Tally,
    ) {
        self.list_pairs(near, bodies.len());
        self.queue.clear();
        for body in 0..bodies.len() {
            if self.which[body] {
                self.foresee(setting, bodies, near, body);
            }
        }
        let mut last = setting.substep;
        while let Some(Event { time, what, hits }) = self.queue.pop() {
            if self.exhausted {
                last = time;
                break;
            }
            match what {
                What::Pair(at) => {
                    let pair = near.pairs[at as usize];
                    let (i, j) = (pair.first as usize, pair.second as usize);
                    if hits != (self.hits[i], self.hits[j]) {
                        continue;
                    }
                    let held = near.held.get(at as usize) == Some(&true);
                    let since = self.since(i, j);
                    let Some(meeting) = Meeting::of(setting, &bodies[i], &bodies[j], held, since) else {
                        continue;
                    };
                    meeting.exchange(bodies, (i, j), restitutions[i].min(restitutions[j]));
                    if let Some(hold) = near.holds.get_mut(at as usize) {
                        hold.met |= time > 0.0;
                    }
                    tally.impacts += u64::from(meeting.speed > setting.rest_speed);
                    (hit[i], hit[j]) = (true, true);
                    for body in [i, j] {
                        self.note(setting, bodies, near, body, time);
                    }
                    for body in [i, j] {
                        self.foresee(setting, bodies, near, body);
                    }
                }
                What::Wall(body, axis) => {
                    let at = body as usize;
                    if hits.0 == self.hits[at] {
                        bounce_off(setting, &mut bodies[at], axis, time, tally);
                        self.note(setting, bodies, near, at, time);
                        self.foresee(setting, bodies, near, at);
                    }
                }
            }
        }
        for (at, body) in bodies.iter_mut().enumerate() {
            if self.which[at] {
                body.position -= body.velocity * (setting.substep - last);
            }
        }
    }

    /// Notes that a body was hit, and looks for more pairs where it now goes farther than was looked for.
    fn note(&mut self, setting: &Setting, bodies: &[Body], near: &mut Near, at: usize, time: f64) {
        self.hits[at] += 1;
        self.times[at] = time;
        self.exhausted |= self.hits[at] == MOST;
        self.which[at] = is_fast(setting, &bodies[at]);
        let end = bodies[at].position + bodies[at].velocity * setting.substep;
        if self.which[at] && near.widen(at, end, bodies, setting.rests) {
            self.list_pairs(near, bodies.len());
        }
    }

    /// Foresees the impacts of a body with fast ones, or of a fast one with all.
    fn foresee(&mut self, setting: &Setting, bodies: &[Body], near: &Near, body: usize) {
        for &at in &self.pairs[self.starts[body] as usize..self.starts[body + 1] as usize] {
            let pair = near.pairs[at as usize];
            let (i, j) = (pair.first as usize, pair.second as usize);
            if !(self.which[i] || self.which[j]) {
                continue;
            }
            let held = near.held.get(at as usize) == Some(&true);
            let since = self.times[i].max(self.times[j]);
            if let Some(meeting) = Meeting::of(setting, &bodies[i], &bodies[j], held, since) {
                let hits = (self.hits[i], self.hits[j]);
                self.queue.push(Event { time: meeting.time, what: What::Pair(at), hits });
            }
        }
        if self.which[body]
            && let Some((time, axis)) = first_wall(setting, &bodies[body], self.times[body])
        {
            self.queue.push(Event { time, what: What::Wall(body as u32, axis), hits: (self.hits[body], 0) });
        }
    }

    /// Lists the pairs of each body.
    fn list_pairs(&mut self, near: &Near, count: usize) {
        let Self { starts, pairs, .. } = self;
        starts.clear();
        starts.resize(count + 1, 0);
        for pair in &near.pairs {
            starts[pair.first as usize] += 1;
            starts[pair.second as usize] += 1;
        }
        let mut end = 0;
        for start in starts.iter_mut() {
            end += *start;
            *start = end;
        }
        pairs.clear();
        pairs.resize(end as usize, 0);
        for (at, pair) in near.pairs.iter().enumerate() {
            for body in [pair.first, pair.second] {
                let start = &mut starts[body as usize];
                *start -= 1;
                pairs[*start as usize] = at as u32;
            }
        }
    }
}

fn is_fast(setting: &Setting, body: &Body) -> bool {
    let far = FAST * body.radius / setting.substep;
    body.velocity.length_squared() > far * far
}

/// The time and the axis of the first wall that a fast ball meets after `since`. What gravity bends its path by is left
/// out.
fn first_wall(setting: &Setting, body: &Body, since: f64) -> Option<(f64, usize)> {
    setting.walls?;
    let mut first = None;
    for axis in 0..2 {
        let (position, velocity) = (body.position[axis], body.velocity[axis]);
        let wall = if velocity < 0.0 { body.radius } else { setting.size[axis] - body.radius };
        let time = ((wall - position) / velocity).max(since);
        if velocity != 0.0 && time <= setting.substep && first.is_none_or(|(earlier, _)| time < earlier) {
            first = Some((time, axis));
        }
    }
    first
}

/// One bounce of a fast ball on a wall across `axis`, at `time`.
fn bounce_off(setting: &Setting, body: &mut Body, axis: usize, time: f64, tally: &mut Tally) {
    let e = setting.walls.unwrap_or_default();
    let bent = body.velocity[axis] + setting.kick[axis] * (time / setting.substep - 0.5);
    // Along this axis it may be slow: never turned round by gravity alone.
    let speed = if bent * body.velocity[axis] > 0.0 { bent } else { body.velocity[axis] };
    let mut change = DVec2::ZERO;
    change[axis] = -body.velocity[axis] - e * speed;
    strike(body, change, time);
    tally.wall_hits += 1;
    tally.wall_impulse += change / body.inverse_mass;
}
