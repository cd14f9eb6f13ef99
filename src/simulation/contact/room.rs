//! Balls that have no room where a substep would take them go only as far as there is room.
//!
//! In a substep a ball is hit so often and no more (`fates`). What is left is held apart by impulses (`support`), which does
//! for balls of one mass, and not for a light one between a heavy and a fixed one: that would end in both. So those that
//! would end in others, and those that would end where these began, or beyond, go straight from where they began towards
//! where they were hit last, or would end, until they touch something. They lose time, and come into nothing.
//!
//! Under gravity, where overlaps follow loads, only where the substep was ended for fast ones, or where one of unlike balls was
//! hit as often as it may be and goes on, or where two that are unlike in density come deeper into each other whatever holds them:
//! nothing else keeps what these hit from going through then. What presses for long on one that has no room may press for ever so;
//! that one is left to what holds it, now and then, among few only where little comes of that. Of more than few that could crush
//! each other none is, but all may go a little into each other. What has had no room for long is slowed down.

use glam::DVec2;

use super::amount::Amount;
use super::constraints::{Constraint, Pair};
use super::fates::Limits;
use super::layout::{Layer, Layout};
use super::near::Near;
use super::sleep::Rest;
use super::stripes::{Stripe, Stripes};
use super::sweep::{Pass, Share};
use super::turns::Course;
use super::unlike::{Crush, Unlike};
use super::{Body, Contact, Setting};

/// A ball may end in another by this part of the smaller radius, or as deep as it began: that is mended.
const DEEPEST: f64 = 0.02;
/// Who may go through others is looked for where one constraint pushes a ball by more than this part of its radius in a
/// substep: many together may push it by all of it, which is far enough (`is_pushed_far`).
const PUSHED: f64 = 0.125;
/// Under gravity one of unlike balls that still goes farther in a substep than this part of its radius after as many impacts as
/// it may have, and is faster than so many of gravity's kicks, may go through others: they are too light to turn it back. What
/// only sinks among light ones is slower.
const RAMMING: (f64, f64) = (0.05, 50.0);
/// Under gravity what holds two balls that are unlike in density has not stopped them where they still come into each other faster
/// than so many of gravity's kicks, and so far that room is looked for: a light one at a wall or at others gives a heavy one its own
/// small momentum in each sweep, however slow that is. Not of one material: piles of large and small balls come to rest later.
const UNSTOPPED: f64 = 10.0;
/// Of few balls, and of more that could crush others, room is looked for already where two that are unlike in density would lie deep
/// in each other, and come nearer in a substep by more than so many kicks of gravity would move them: one that only slides along the
/// floor would crush a light one, however slowly. With 4, five times as many of few are crushed. Not of densities that differ less:
/// three thousand, ten to one, came to rest at half the speed.
const SINKING: f64 = 1.0;
/// Under gravity, where a ball had no room in so many substeps in a row in which any was looked for, its pairs with balls that do
/// not ram it are not looked at in the next. If all always are, ten piles of unlike balls in 120 find no rest; with 4, two of
/// them, and more balls go through others ...
const LONG_STUCK: u8 = 16;
/// ... nor those with balls that ram it. If all always are, five piles in 240 find no rest; with 48, a quarter more tubes let one
/// through.
const LONG_RAMMED: u8 = 96;
/// Of few balls those that would come nearer by more than this part of the smaller radius are looked at nevertheless: what is driven
/// against one at a wall, and not only heavy, would be through it before long. With 0.02, six times as many light balls are crushed.
const LEFT: f64 = 0.005;
/// Of few those that would lie deeper than this part of the smaller radius always are, however slowly they come: that would go on.
const TOO_DEEP: f64 = 0.05;
/// Of more than few balls that could crush each other only those are looked at that would lie deeper than this, and those without
/// room go on until they are so deep: what sinks through hundreds of light ones pushes them aside meanwhile. Held as among few, it
/// takes two and a half times as long.
const TOO_DEEP_OF_SOME: f64 = 0.04;
/// The same of more than some: with 0.04, a third of three thousand, half of them a thousand times as dense, are awake after 40 s.
const TOO_DEEP_OF_MANY: f64 = 0.12;
/// What had no room in so many substeps in a row in which any was looked for is slowed down in each further one, by this
/// part of how much less far it comes than its velocity would take it: a heavy ball that light ones stop would be ever faster where
/// it stands. Without that, three times as many piles get a thousandth of their energy back, of few three times as many three
/// thousandths, and those without end take twice the time.
const HELD_BACK: (u8, f64) = (8, 0.5);
/// Balls without room try so often to go on: what was in their way may have gone on itself.
const TURNS: u32 = 4;

/// Who has how much room.
#[derive(Debug, Clone, Default)]
pub(super) struct Room {
    /// Where each body began the substep, or would be if it had moved as all do.
    pub(super) starts: Vec<DVec2>,
    /// Those that may not go all their way, in the order of their numbers.
    pub(super) short: Vec<Short>,
    /// For each body, whether it is one of them.
    is_short: Vec<bool>,
    /// How deep they may go.
    depths: Depths,
}

/// How deep balls may go into each other where room is looked for, in parts of the smaller radius.
#[derive(Debug, Clone, Copy)]
struct Depths {
    /// Those that would end deeper are looked at.
    looked_at: f64,
    /// Those without room go on until they are so deep in others.
    entered: f64,
}

impl Default for Depths {
    fn default() -> Self {
        Self { looked_at: DEEPEST, entered: 0.0 }
    }
}

/// A body that may not go all its way.
#[derive(Debug, Clone, Copy)]
pub(super) struct Short {
    pub(super) body: usize,
    /// Where it goes if it can, and where it would have ended, px.
    target: DVec2,
    end: DVec2,
}

impl Contact {
    /// Notes where bodies that may meet begin a substep. They stand in the order that they have in it.
    pub(super) fn note_room(&mut self) {
        let Self { setting, bodies, room, team, pairs: true, .. } = self else { return };
        let layout = Layout::of(bodies.len());
        room.short.clear();
        room.depths = setting.depths();
        room.starts.resize(bodies.len(), DVec2::ZERO);
        let shares = layout.share(Layer::Own, &mut room.starts).zip(layout.share_read(Layer::Own, bodies));
        team.each(shares, |(starts, bodies)| {
            for (start, body) in starts.iter_mut().zip(bodies) {
                *start = body.position + setting.common * setting.substep;
            }
        });
    }

    /// Has bodies that would end in others go only as far as there is room. All have moved.
    pub(super) fn keep_to_room(&mut self) {
        self.sweep(&[Pass::FIND_DEEP]);
        let Self { setting, bodies, restitutions, rests, near: Some(near), course, room, .. } = self else {
            return;
        };
        let deep: usize = near.stripes.iter().map(|stripe| stripe.deep.len()).sum();
        if near.crowd || deep > bodies.len() {
            // Wherever they went, most would lie in others.
            near.stripes.iter_mut().for_each(|stripe| stripe.deep.clear());
            for rest in rests {
                rest.stuck = 0;
            }
            return;
        }
        room.find_short(setting, (bodies, restitutions, rests), near, course);
        room.go_on(setting, bodies, &near.all());
        for (at, (rest, body)) in rests.iter_mut().zip(&*bodies).enumerate() {
            let stays = body.position.distance(room.starts[at]) < DEEPEST * body.radius;
            rest.stuck = if room.is_short[at] && stays { rest.stuck.saturating_add(1) } else { 0 };
        }
        if setting.kick != DVec2::ZERO && setting.grounded {
            room.hold_back(setting, bodies, rests);
            room.pay_for_height(setting, bodies);
        }
    }

    /// Whether any body may go where nothing was looked for in its way.
    pub(super) fn any_unfollowed(&self) -> bool {
        let Self { setting, bodies, restitutions, rests, course, near: Some(near), pairs: true, .. } = self
        else {
            return false;
        };
        if course.ended {
            return true;
        }
        if setting.kick != DVec2::ZERO && !setting.unlike.differs() {
            return false;
        }
        let limits = Limits::of(bodies.len(), near.crowd, setting);
        let hit = course.fates.iter().zip(restitutions).enumerate();
        let mut spent = hit.filter(|(_, (fate, own))| limits.may_be_spent(fate, **own)).map(|(at, _)| at);
        if setting.kick != DVec2::ZERO {
            return spent.any(|at| rests[at].unlike.differs() && setting.rams(&bodies[at]))
                || setting.unlike == Unlike::Density && self.any_sinks();
        }
        spent.next().is_some()
            || near.holding().any(|(first, second, constraint)| {
                [first, second].iter().any(|&at| {
                    let push = constraint.impulse * bodies[at].inverse_mass;
                    push > PUSHED * bodies[at].radius / setting.substep
                })
            })
    }

    /// Whether two balls that are unlike in density come deeper into each other whatever holds them.
    fn any_sinks(&self) -> bool {
        let Self { setting, bodies, rests, near: Some(near), room, .. } = self else { return false };
        let differ = |pair: [usize; 2]| pair.iter().all(|&at| rests[at].unlike == Unlike::Density);
        if setting.amount == Amount::Few || setting.crush_now() != Crush::Nobody {
            near.pairs()
                .any(|(first, second)| differ([first, second]) && room.sinks(setting, bodies, first, second))
        } else {
            near.holding().any(|(first, second, constraint)| {
                differ([first, second]) && setting.goes_on(&bodies[first], &bodies[second], constraint)
            })
        }
    }
}

impl Setting {
    /// Whether a ball that goes on like this after its impacts may go through others.
    pub(super) fn rams(&self, body: &Body) -> bool {
        let (part, kicks) = RAMMING;
        let slow = (part * body.radius / self.substep).max(kicks * self.kick.length());
        body.velocity.distance_squared(self.common) > slow * slow
    }

    /// Whether what holds two balls has not stopped them.
    fn goes_on(&self, first: &Body, second: &Body, held: &Constraint) -> bool {
        let part = DEEPEST * first.radius.min(second.radius) / self.substep;
        let slow = part.max(UNSTOPPED * self.kick.length());
        (first.velocity - second.velocity).dot(held.normal) < held.least.min(0.0) - slow
    }

    /// Whom balls may crush now: under gravity, and while any are unlike those near them in density.
    fn crush_now(&self) -> Crush {
        let may = self.unlike == Unlike::Density && self.kick != DVec2::ZERO;
        if may { self.crush } else { Crush::Nobody }
    }

    /// How deep balls may go into each other.
    fn depths(&self) -> Depths {
        let until = |deep: f64| Depths { looked_at: deep, entered: deep };
        match self.crush_now() {
            Crush::Nobody => Depths::default(),
            Crush::AmongSome => until(TOO_DEEP_OF_SOME),
            Crush::AmongMany => until(TOO_DEEP_OF_MANY),
        }
    }
}

impl Room {
    /// Finds those that may not go all their way, and puts them back to where they began.
    fn find_short(
        &mut self,
        setting: &Setting,
        (bodies, restitutions, rests): (&mut [Body], &[f64], &[Rest]),
        near: &mut Near,
        course: &Course,
    ) {
        near.link_pairs(bodies.len());
        let mut found: Vec<usize> = Vec::new();
        let may_leave = setting.kick != DVec2::ZERO && setting.crush_now() == Crush::Nobody;
        let is_left = |at: usize, other: usize| {
            let long = if setting.rams(&bodies[other]) { LONG_RAMMED } else { LONG_STUCK };
            may_leave
                && rests[at].stuck >= long
                && (setting.amount > Amount::Few || self.come_little_nearer(bodies, at, other))
        };
        let is_deeper = |&Pair { first, second }: &Pair| {
            let (first, second) = (first as usize, second as usize);
            !(is_left(first, second) || is_left(second, first))
                && self.come_into_each_other(bodies, (first, bodies[first].position), second)
        };
        for (number, stripe) in near.stripes.iter_mut().enumerate() {
            let start = near.layout.start(number);
            let deep = stripe.deep.drain(..).map(|pair| pair.from(start));
            found.extend(deep.filter(is_deeper).flat_map(|pair| [pair.first as usize, pair.second as usize]));
        }
        found.extend((0..bodies.len()).filter(|&at| is_pushed_far(setting, &bodies[at])));
        self.is_short.clear();
        self.is_short.resize(bodies.len(), false);
        let limits = Limits::of(bodies.len(), near.crowd, setting);
        while let Some(at) = found.pop() {
            if bodies[at].inverse_mass == 0.0 || std::mem::replace(&mut self.is_short[at], true) {
                continue;
            }
            let (start, end, fate) = (self.starts[at], bodies[at].position, &course.fates[at]);
            near.cover_way(at, (start, end), bodies, setting);
            // What it would have met after it was hit for the last time it may have been, is not known.
            let unknown = if limits.may_be_spent(fate, restitutions[at]) {
                bodies[at].velocity * setting.substep
                    - bodies[at].free * fate.time
                    - setting.common * (setting.substep - fate.time)
            } else {
                DVec2::ZERO
            };
            let target = setting.inside(end - unknown, bodies[at].radius);
            // What held it since it was hit may have turned it round: it was hit elsewhere than on the way to its end.
            near.cover_way(at, (start, target), bodies, setting);
            self.short.push(Short { body: at, target, end });
            bodies[at].position = start;
            found.extend(near.all().around(at).filter(|&other| {
                !self.is_short[other]
                    && (self.come_into_each_other(bodies, (other, bodies[other].position), at)
                        || self.crosses(bodies, other, at))
            }));
        }
        self.short.sort_unstable_by_key(|short| short.body);
    }

    /// Moves those towards where they go, as far as they can.
    fn go_on(&self, setting: &Setting, bodies: &mut [Body], stripes: &Stripes<'_>) {
        for _ in 0..TURNS {
            let mut any = false;
            for &Short { body, target, .. } in &self.short {
                let way = target - bodies[body].position;
                let go = way * free_share(body, way, bodies, stripes, self.depths.entered);
                any |= go.length() > DEEPEST * bodies[body].radius;
                let to = bodies[body].position + go;
                bodies[body].position = setting.inside(to, bodies[body].radius);
            }
            if !any {
                break;
            }
        }
    }

    /// Slows down those that had no room for long, as far as they do not go where their velocity would take them.
    fn hold_back(&self, setting: &Setting, bodies: &mut [Body], rests: &[Rest]) {
        let (long, part) = HELD_BACK;
        for &Short { body: at, .. } in self.short.iter().filter(|short| rests[short.body].stuck >= long) {
            let body = &mut bodies[at];
            let (way, went) = (body.velocity * setting.substep, body.position - self.starts[at]);
            if way != DVec2::ZERO {
                let lost = 1.0 - (went.dot(way) / way.length_squared()).clamp(0.0, 1.0);
                let change = body.velocity * (-part * lost);
                body.velocity += change;
                body.free += change;
            }
        }
    }

    /// Slows down those that are higher now than they would have ended, as far as they have the speed to pay with.
    fn pay_for_height(&self, setting: &Setting, bodies: &mut [Body]) {
        for &Short { body, end, .. } in &self.short {
            let body = &mut bodies[body];
            let work = setting.gravity.dot(end - body.position);
            let square = body.velocity.length_squared();
            if work > 0.0 && square > 0.0 {
                let change = body.velocity * (((square - 2.0 * work).max(0.0) / square).sqrt() - 1.0);
                body.velocity += change;
                body.free += change;
            }
        }
    }

    /// Whether a body at this place would lie in another, where that is, deeper than it began, and than it may.
    fn come_into_each_other(&self, bodies: &[Body], (at, place): (usize, DVec2), other: usize) -> bool {
        let distance = place.distance(bodies[other].position);
        let out = bodies[at].radius + bodies[other].radius - distance;
        out > self.depths.looked_at * bodies[at].radius.min(bodies[other].radius)
            && self.nearer_by(at, other, distance) > 0.0
    }

    /// Whether two bodies that have moved lie in each other not too deeply, and came so little nearer that this may go on for once.
    fn come_little_nearer(&self, bodies: &[Body], first: usize, second: usize) -> bool {
        let (one, other) = (&bodies[first], &bodies[second]);
        let nearer = self.nearer_by(first, second, one.position.distance(other.position));
        nearer < LEFT * one.radius.min(other.radius) && !one.overlaps(other, TOO_DEEP)
    }

    /// Whether two bodies that have not moved yet would come deeper into each other than what weight does in a substep, or than they
    /// may ever.
    fn sinks(&self, setting: &Setting, bodies: &[Body], first: usize, second: usize) -> bool {
        let (one, other) = (&bodies[first], &bodies[second]);
        let (reach, smaller) = (one.radius + other.radius, one.radius.min(other.radius));
        let squared = (one.end(setting.substep) - other.end(setting.substep)).length_squared();
        let deep = reach - self.depths.looked_at * smaller;
        if squared >= deep * deep {
            return false;
        }
        let end = squared.sqrt();
        let by_weight = SINKING * setting.kick.length() * setting.substep;
        let most = if reach - end > TOO_DEEP * smaller { 0.0 } else { by_weight };
        self.nearer_by(first, second, end) > most
    }

    /// By how much nearer to each other two bodies are at this distance than where they began.
    fn nearer_by(&self, first: usize, second: usize, distance: f64) -> f64 {
        self.starts[first].distance(self.starts[second]) - distance
    }

    /// Whether a body goes from where it began over another, where that is.
    fn crosses(&self, bodies: &[Body], at: usize, other: usize) -> bool {
        let from = self.starts[at] - bodies[other].position;
        let way = bodies[at].position - self.starts[at];
        let reach = (1.0 - DEEPEST) * (bodies[at].radius + bodies[other].radius);
        let share = -from.dot(way) / way.length_squared();
        share > 0.0 && (from + way * share.min(1.0)).length_squared() < reach * reach
    }
}

impl Pass<'_> {
    /// Finds the pairs that lie deep in each other.
    const FIND_DEEP: Self = Self {
        layers: Layer::OUTWARD,
        only_busy: true,
        work: &|_, stripe, share| {
            let (Stripe { pairs, deep, .. }, Share { bodies, .. }) = (stripe, share);
            deep.extend(pairs.iter().filter(|pair| {
                let (first, second) = (&bodies[pair.first as usize], &bodies[pair.second as usize]);
                first.overlaps(second, DEEPEST)
            }));
        },
    };
}

/// Whether what holds a ball pushes it so far in a substep that it could go through others.
fn is_pushed_far(setting: &Setting, body: &Body) -> bool {
    let far = body.radius / setting.substep;
    (body.velocity - body.free).length_squared() > far * far
}

/// What part of its way a body can go until it is so deep in another, in parts of the smaller radius.
fn free_share(at: usize, way: DVec2, bodies: &[Body], stripes: &Stripes<'_>, deep: f64) -> f64 {
    let body = &bodies[at];
    let until_touched = |other: usize| {
        let other = &bodies[other];
        let offset = body.position - other.position;
        let reach = body.radius + other.radius - deep * body.radius.min(other.radius);
        let (closing, gap) = (offset.dot(way), offset.length_squared() - reach * reach);
        let discriminant = closing * closing - way.length_squared() * gap;
        if closing >= 0.0 || discriminant < 0.0 {
            1.0
        } else if gap <= 0.0 {
            0.0
        } else {
            gap / (discriminant.sqrt() - closing)
        }
    };
    stripes.around(at).map(until_touched).fold(1.0, f64::min)
}
