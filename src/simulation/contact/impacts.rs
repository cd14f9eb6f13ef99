//! Balls that meet in a substep exchange momentum at their time of impact, in the order of these times.
//!
//! Each impulse follows Newton's law of restitution for one pair and takes energy or keeps it, so however many there are,
//! energy never rises. A ball that was hit at time τ goes on from a place from which it would have started to be where it
//! was at τ: later impacts of the same substep, and its end, come out right.
//!
//! A ball that was hit a few times in a substep is left to what supports it. A fast one could go through others then, so
//! it may be hit much more often, and where that is not enough, the substep ends for all fast balls there and then
//! (continuous collision detection): they lose time, never their speed, and go through nothing.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::find::{FEW, Pair};
use super::meeting::{Approach, Stage};
use super::walls::{bounce_off, first_wall, meet_walls, reaches_wall};
use super::{Body, Contact, SHIFT, Setting, Tally};

/// Impacts of a ball in one substep, at most: in a crowd what presses is better held than thrown to and fro.
const MOST: u32 = 8;
/// The same among few balls, where each counts.
const MOST_OF_FEW: u32 = 64;
/// The same of a fast ball.
const MOST_FAST: u32 = 256;
/// A ball that goes farther in a substep than so many times its radius is fast.
const FAST: f64 = 1.0;

/// What is known of the bodies' impacts in a substep.
#[derive(Debug, Default)]
pub(super) struct Course {
    /// When each body was last hit, s after the substep's beginning, and how often it was.
    times: Vec<f64>,
    hits: Vec<u32>,
    /// Bodies too slow to hit firmly those that they press on.
    slow: Vec<bool>,
    /// Bodies that are fast, and whether there are any.
    fast: Vec<bool>,
    any_fast: bool,
    /// How often a body may be hit that is not.
    most: u32,
    /// Whether a fast one was hit so often that the substep ends for all of them.
    exhausted: bool,
    /// Whether it has.
    ended: bool,
    /// Bodies that were hit after the substep's beginning: until its end they stand where they would have come from.
    pub(super) shifted: Vec<bool>,
    /// The same for those that are fast, or were hit by a fast one: that is far away.
    pub(super) far: Vec<bool>,
    queue: BinaryHeap<Event>,
}

/// An impact that is foreseen, while both bodies have been hit so often.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Event {
    /// s after the substep's beginning.
    time: f64,
    what: What,
    hits: (u32, u32),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum What {
    /// The ball at this place beside the walls reaches one.
    Wall(u32),
    /// This fast body meets a wall across this axis.
    FastWall(u32, u8),
    /// The pair of this place meets.
    Pair(u32),
}

impl Eq for Event {}

impl Ord for Event {
    /// The earliest is the greatest; those at one time come in the order of their places.
    fn cmp(&self, other: &Self) -> Ordering {
        other.time.total_cmp(&self.time).then_with(|| other.what.cmp(&self.what))
    }
}

impl PartialOrd for Event {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Contact {
    /// All impacts of a substep.
    pub(super) fn impacts(&mut self, tally: &mut Tally) {
        let Self { setting, bodies, restitutions, rests, near: Some(near), hit, course, .. } = self else {
            return;
        };
        if near.pairs.is_empty() && near.beside.is_empty() {
            return;
        }
        let stage = &mut Stage { setting, bodies, restitutions, near, rests, hit, tally };
        course.begin(stage);
        course.foresee_all(stage);
        if !course.queue.is_empty() {
            stage.near.link_pairs(stage.bodies.len());
        }
        while let Some(event) = course.queue.pop() {
            if course.exhausted && !course.ended {
                course.end_fast(stage, event.time);
            }
            course.take(event, stage);
        }
    }
}

impl Course {
    /// Whether a body was hit in the last substep.
    pub(super) fn was_hit(&self, body: usize) -> bool {
        self.hits.get(body).is_some_and(|&hits| hits > 0)
    }

    fn begin(&mut self, stage: &Stage<'_>) {
        let Stage { setting, bodies, .. } = stage;
        let Self { times, hits, slow, fast, shifted, far, .. } = self;
        times.clear();
        times.resize(bodies.len(), 0.0);
        hits.clear();
        hits.resize(bodies.len(), 0);
        for flags in [&mut *shifted, far] {
            flags.clear();
            flags.resize(bodies.len(), false);
        }
        let firm = 0.25 * setting.firm * setting.firm;
        slow.clear();
        slow.extend(bodies.iter().map(|body| body.velocity.length_squared() < firm));
        fast.clear();
        fast.extend(bodies.iter().map(|body| is_fast(setting, body)));
        self.any_fast = fast.contains(&true);
        self.most = if bodies.len() <= FEW { MOST_OF_FEW } else { MOST };
        (self.exhausted, self.ended) = (false, false);
        self.queue.clear();
    }

    /// Foresees impacts from the substep's beginning.
    #[inline]
    fn foresee_all(&mut self, stage: &mut Stage<'_>) {
        for at in 0..stage.near.beside.len() {
            self.foresee_wall(stage, at);
        }
        if self.any_fast {
            for body in 0..stage.bodies.len() {
                self.foresee_fast_wall(stage, body);
            }
        }
        for at in 0..stage.near.pairs.len() {
            self.foresee_pair(stage, at);
        }
    }

    /// Foresees the impacts of a body that was hit.
    fn foresee(&mut self, stage: &mut Stage<'_>, body: usize) {
        if self.fast[body] {
            self.foresee_fast_wall(stage, body);
        } else if self.hits[body] < self.most
            && let Some(at) = stage.near.place_beside(body as u32)
        {
            self.foresee_wall(stage, at);
        }
        let mut link = stage.near.links.last(body as u32);
        while let Some(at) = link {
            self.foresee_pair(stage, at.pair());
            link = stage.near.links.before(at);
        }
    }

    #[inline]
    fn foresee_wall(&mut self, stage: &Stage<'_>, at: usize) {
        let body = stage.near.beside[at].body as usize;
        if !self.fast[body]
            && stage.bodies[body].inverse_mass > 0.0
            && let Some(time) = reaches_wall(stage.setting, &stage.bodies[body])
        {
            let (time, hits) = (time.max(self.times[body]), (self.hits[body], 0));
            self.queue.push(Event { time, what: What::Wall(at as u32), hits });
        }
    }

    #[inline]
    fn foresee_fast_wall(&mut self, stage: &Stage<'_>, body: usize) {
        if self.fast[body]
            && !self.ended
            && let Some((time, axis)) = first_wall(stage.setting, &stage.bodies[body], self.times[body])
        {
            let hits = (self.hits[body], 0);
            self.queue.push(Event { time, what: What::FastWall(body as u32, axis as u8), hits });
        }
    }

    #[inline]
    fn foresee_pair(&mut self, stage: &mut Stage<'_>, at: usize) {
        let Stage { setting, bodies, near, .. } = stage;
        let Pair { first, second } = near.pairs[at];
        let (i, j) = (first as usize, second as usize);
        if near.idle[at] || (near.held.get(at) == Some(&true) && self.slow[i] && self.slow[j]) {
            near.close[at] = true;
            return;
        }
        let approach = Approach::of(setting, &bodies[i], &bodies[j]);
        near.close[at] = approach.closes_in;
        let fast = self.fast[i] || self.fast[j];
        let enough = if fast { self.ended } else { self.hits[i].max(self.hits[j]) >= self.most };
        if approach.may_meet
            && !enough
            && let Some(meeting) = stage.meeting(at as u32, self.times[i].max(self.times[j]))
        {
            let hits = (self.hits[i], self.hits[j]);
            self.queue.push(Event { time: meeting.time, what: What::Pair(at as u32), hits });
        }
    }

    /// Takes an impact, if none came between.
    fn take(&mut self, Event { time, what, hits }: Event, stage: &mut Stage<'_>) {
        match what {
            What::Pair(at) => {
                let (i, j) = stage.pair(at);
                let fast = self.fast[i] || self.fast[j];
                if hits != (self.hits[i], self.hits[j]) || (fast && self.ended) {
                    return;
                }
                let Some(meeting) = stage.meeting(at, self.times[i].max(self.times[j])) else { return };
                stage.exchange(at, &meeting);
                // A fixed ball goes on as it was: all that is foreseen of it still holds.
                let moved = [i, j].map(|body| (stage.bodies[body].inverse_mass > 0.0).then_some(body));
                for body in moved.into_iter().flatten() {
                    self.shifted[body] |= meeting.time * meeting.speed > SHIFT * stage.bodies[body].radius;
                    self.slow[body] = false;
                    self.note(stage, body, time);
                    self.far[body] |= fast;
                }
                for body in moved.into_iter().flatten() {
                    self.foresee(stage, body);
                }
            }
            What::Wall(at) => {
                let beside = stage.near.beside[at as usize];
                let body = beside.body as usize;
                if hits.0 == self.hits[body]
                    && let Some(met) =
                        meet_walls(stage.setting, &mut stage.bodies[body], &beside, stage.tally)
                {
                    self.shifted[body] |= met.shifts;
                    let time = met.time.max(self.times[body]);
                    self.note(stage, body, time);
                    self.foresee(stage, body);
                }
            }
            What::FastWall(body, axis) => {
                let body = body as usize;
                if hits.0 == self.hits[body] && !self.ended {
                    bounce_off(stage.setting, &mut stage.bodies[body], usize::from(axis), time, stage.tally);
                    self.note(stage, body, time);
                    self.foresee(stage, body);
                }
            }
        }
    }

    /// Notes that a body was hit, and looks for more pairs where it now goes farther than was looked for.
    fn note(&mut self, stage: &mut Stage<'_>, at: usize, time: f64) {
        let Stage { setting, bodies, near, .. } = stage;
        self.hits[at] += 1;
        self.times[at] = time;
        self.far[at] |= self.fast[at];
        self.fast[at] = is_fast(setting, &bodies[at]);
        self.far[at] |= self.fast[at];
        if self.fast[at] && self.ended {
            end(setting, &mut bodies[at], time);
        }
        self.exhausted |= self.fast[at] && self.hits[at] >= MOST_FAST;
        near.widen(at, time, bodies, setting);
    }

    /// Ends the substep at `time` for all fast balls.
    fn end_fast(&mut self, stage: &mut Stage<'_>, time: f64) {
        self.ended = true;
        for (body, _) in stage.bodies.iter_mut().zip(&self.fast).filter(|&(_, &fast)| fast) {
            end(stage.setting, body, time);
        }
    }
}

/// Ends a body's substep at `time`.
fn end(setting: &Setting, body: &mut Body, time: f64) {
    body.position -= body.velocity * (setting.substep - time);
}

fn is_fast(setting: &Setting, body: &Body) -> bool {
    let far = FAST * body.radius / setting.substep;
    body.velocity.length_squared() > far * far
}
