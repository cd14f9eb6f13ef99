//! Balls that meet in a substep exchange momentum at their time of impact.
//!
//! Each impulse follows Newton's law of restitution for one pair and takes energy or keeps it, so however many there are,
//! and in whatever order, energy never rises. A ball that was hit at time τ goes on from a place from which it would have
//! started to be where it was at τ: later impacts of the same substep, and its end, come out right.

use glam::DVec2;

use super::fast::Fast;
use super::find::{Beside, Near};
use super::{Body, Contact, Setting, Tally};

/// Rounds in which balls that were hit may hit others in the same substep.
const ROUNDS: u32 = 8;
/// Bounces of a ball on a wall in one substep.
const BOUNCES: u32 = 32;
/// A ball whose next hop on a wall lasts less than this part of a substep rests there.
const SHORTEST_HOP: f64 = 1.0 / 64.0;
/// A ball that an impact shifts by less than this part of its radius counts as not shifted.
const SHIFT: f64 = 0.02;
/// Centres closer than this, px, have no direction to meet along.
const COINCIDENT: f64 = 1e-150;

/// What is known of the bodies' impacts in a substep.
#[derive(Debug, Default)]
pub(super) struct Course {
    /// In which round each body was last hit, from 1.
    rounds: Vec<u32>,
    /// Bodies too slow to hit firmly those that they press on.
    slow: Vec<bool>,
    /// Bodies that were hit after the substep's beginning: until its end they stand where they would have come from.
    pub(super) shifted: Vec<bool>,
    pub(super) fast: Fast,
}

impl Contact {
    /// All impacts of a substep.
    pub(super) fn impacts(&mut self, tally: &mut Tally) {
        let Self { setting, bodies, restitutions, near: Some(near), hit, course, .. } = self else { return };
        if near.pairs.is_empty() && near.beside.is_empty() {
            return;
        }
        let Course { rounds, slow, shifted, fast } = course;
        if fast.find(setting, bodies) {
            fast.impacts(setting, bodies, restitutions, near, hit, tally);
        }
        shifted.clear();
        shifted.resize(bodies.len(), false);
        rounds.clear();
        rounds.resize(bodies.len(), 0);
        let firm = 0.25 * setting.firm * setting.firm;
        slow.clear();
        slow.extend(bodies.iter().map(|body| body.velocity.length_squared() < firm));
        let Near { pairs, holds, held, beside, .. } = near;
        for round in 1..=ROUNDS {
            for beside in &*beside {
                let body = beside.body as usize;
                if (round == 1 || rounds[body] == round - 1) && !fast.has(body) {
                    shifted[body] |= meet_walls(setting, &mut bodies[body], beside, tally);
                }
            }
            let mut any = false;
            for (at, pair) in pairs.iter().enumerate() {
                let (i, j) = (pair.first as usize, pair.second as usize);
                if round > 1 && rounds[i].max(rounds[j]) < round - 1 {
                    continue;
                }
                let held = held.get(at) == Some(&true);
                if (held && slow[i] && slow[j]) || fast.has(i) || fast.has(j) {
                    continue;
                }
                // Slow ones are taken in any order: what an impact does to the past of a ball is less than what another will
                // do to its future.
                let since = fast.since(i, j);
                let Some(meeting) = Meeting::of(setting, &bodies[i], &bodies[j], held, since) else {
                    continue;
                };
                meeting.exchange(bodies, (i, j), restitutions[i].min(restitutions[j]));
                if let Some(hold) = holds.get_mut(at) {
                    hold.met |= meeting.time > 0.0;
                }
                tally.impacts += u64::from(meeting.speed > setting.rest_speed);
                for body in [i, j] {
                    hit[body] = true;
                    shifted[body] |= meeting.time * meeting.speed > SHIFT * bodies[body].radius;
                    rounds[body] = round;
                    slow[body] = false;
                }
                any = true;
            }
            if !any {
                break;
            }
        }
    }
}

/// Two balls meeting in a substep.
pub(super) struct Meeting {
    /// When, s after the substep's beginning.
    pub(super) time: f64,
    /// Where the first is then, seen from the second, px.
    distance: DVec2,
    length: f64,
    /// Speed of approach, px/s.
    pub(super) speed: f64,
}

impl Meeting {
    /// `None` where they do not meet in this substep after `since`.
    #[inline]
    pub(super) fn of(setting: &Setting, first: &Body, second: &Body, held: bool, since: f64) -> Option<Self> {
        let distance = first.position - second.position;
        let velocity = first.velocity - second.velocity;
        let closing = distance.dot(velocity);
        let reach = first.radius + second.radius;
        let gap = distance.length_squared() - reach * reach;
        // The squared distance lies above its tangent. Whether balls close in cannot be foreseen, so it is asked of few.
        if gap + 2.0 * closing.min(0.0) * setting.substep > 0.0 {
            return None;
        }
        if closing >= 0.0 || (held && -closing < setting.firm * reach) {
            return None;
        }
        // From where they are when the later one was hit.
        let distance = distance + velocity * since;
        let closing = distance.dot(velocity);
        let gap = distance.length_squared() - reach * reach;
        let wait = if gap <= 0.0 {
            0.0
        } else {
            let discriminant = closing * closing - velocity.length_squared() * gap;
            if discriminant < 0.0 || closing >= 0.0 {
                return None;
            }
            gap / (discriminant.sqrt() - closing)
        };
        let time = since + wait;
        if time > setting.substep {
            return None;
        }
        let distance = distance + velocity * wait;
        // By the velocity at the time of impact, or, where they pressed on each other before, by that without what presses
        // them together now; but by no more than the mean velocity in the substep, in which what they were given already
        // counts: none may give more than it finds.
        let change = first.change(setting.kick) - second.change(setting.kick);
        let then = velocity + change * if held { -1.0 } else { time / setting.substep - 0.5 };
        let closing = distance.dot(velocity).max(distance.dot(then));
        let length = distance.length();
        if closing >= 0.0 || length < COINCIDENT {
            return None;
        }
        Some(Self { time, distance, length, speed: -closing / length })
    }

    /// Gives both their impulse.
    #[inline]
    pub(super) fn exchange(&self, bodies: &mut [Body], (first, second): (usize, usize), e: f64) {
        let (one, other) = (bodies[first].inverse_mass, bodies[second].inverse_mass);
        let change = self.distance * ((1.0 + e) * self.speed / ((one + other) * self.length));
        strike(&mut bodies[first], change * one, self.time);
        strike(&mut bodies[second], -change * other, self.time);
    }
}

/// A sudden change of velocity, at a time of the substep.
#[inline]
pub(super) fn strike(body: &mut Body, change: DVec2, time: f64) {
    body.velocity += change;
    body.free += change;
    body.position -= change * time;
}

/// Bounces a ball off the walls that it meets in this substep. Whether that shifted it.
fn meet_walls(setting: &Setting, body: &mut Body, beside: &Beside, tally: &mut Tally) -> bool {
    let Some(e) = setting.walls else { return false };
    let mut met = false;
    let end = body.position + body.velocity * setting.substep;
    let (low, high) = (DVec2::splat(body.radius), setting.size - body.radius);
    for axis in 0..2 {
        let (gap, side) = if end[axis] < low[axis] {
            (body.position[axis] - low[axis], 1.0)
        } else if end[axis] > high[axis] {
            (high[axis] - body.position[axis], -1.0)
        } else {
            continue;
        };
        let change = body.change(setting.kick)[axis];
        // In closed form only where nothing but gravity acts on it.
        let rests = side * beside.push[axis] > 0.0;
        let lone = !rests && body.velocity == body.free;
        if rests && -side * body.velocity[axis] < setting.firm {
            continue;
        }
        let (acceleration, start) = if lone {
            (change / setting.substep, body.velocity[axis] - 0.5 * change)
        } else if rests {
            (0.0, body.velocity[axis])
        } else {
            let (mean, first) = (body.velocity[axis], body.velocity[axis] - 0.5 * change);
            (0.0, if side * first > side * mean { first } else { mean })
        };
        let hop = Hop { height: gap, speed: side * start, acceleration: side * acceleration };
        let landed = hop.bounce(setting.substep, e);
        // What it would have been, had nothing held it.
        let velocity = match landed.at {
            Some(at) if lone => side * at.speed - 0.5 * change,
            Some(at) => side * at.speed,
            None => change,
        };
        let height = landed.at.map_or(0.0, |at| at.height);
        let wall = if side > 0.0 { low[axis] } else { high[axis] };
        body.position[axis] = wall + side * height - velocity * setting.substep;
        let given = velocity - body.velocity[axis];
        body.velocity[axis] += given;
        body.free[axis] += given;
        if landed.fastest > setting.rest_speed {
            tally.wall_hits += u64::from(landed.bounces);
        }
        tally.wall_impulse[axis] += side * landed.impulse / body.inverse_mass;
        met |= landed.fastest * setting.substep > SHIFT * body.radius;
    }
    met
}

/// A ball above a wall, along one axis; up is away from the wall.
#[derive(Debug, Clone, Copy)]
struct Hop {
    height: f64,
    speed: f64,
    acceleration: f64,
}

/// What came of a ball's bounces on a wall.
struct Landed {
    /// Its state at the end; `None` where it rests on the wall.
    at: Option<Hop>,
    bounces: u32,
    /// The fastest of them, px/s.
    fastest: f64,
    /// The sum of the changes of velocity, px/s.
    impulse: f64,
}

impl Hop {
    /// Follows the ball for `time` s in closed form, through all its bounces.
    fn bounce(mut self, time: f64, e: f64) -> Landed {
        let (mut left, mut bounces, mut fastest, mut impulse) = (time, 0, 0.0_f64, 0.0);
        self.height = self.height.max(0.0);
        loop {
            let Self { height, speed, acceleration } = self;
            let squared = speed * speed - 2.0 * acceleration * height;
            let lands = (speed < 0.0 || acceleration < 0.0) && squared >= 0.0;
            let arrival = squared.max(0.0).sqrt();
            // Each form where it subtracts nothing.
            let wait = if speed <= 0.0 {
                2.0 * height / (arrival - speed)
            } else {
                -(speed + arrival) / acceleration
            };
            // 0/0 where it lies on the wall without speed.
            let wait = if wait.is_nan() { 0.0 } else { wait };
            if !lands || wait >= left || wait < 0.0 {
                let at = Self {
                    height: (height + left * (speed + 0.5 * acceleration * left)).max(0.0),
                    speed: speed + acceleration * left,
                    acceleration,
                };
                return Landed { at: Some(at), bounces, fastest, impulse };
            }
            left -= wait;
            bounces += 1;
            fastest = fastest.max(arrival);
            impulse += (1.0 + e) * arrival;
            self = Self { height: 0.0, speed: e * arrival, acceleration };
            let short = 2.0 * self.speed <= -acceleration * SHORTEST_HOP * time;
            if short || bounces == BOUNCES {
                return Landed { at: None, bounces, fastest, impulse };
            }
        }
    }
}
