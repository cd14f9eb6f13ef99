//! Two balls that meet in a substep: when (time of impact), and what they do to each other (impulse).

use glam::DVec2;

use super::super::lesser::lesser;
use super::events::Spot;
use super::impacts::Stage;
use super::sleep::Rest;
use super::stripes::Stripes;
use super::wake::wake_by_hit;
use super::{Body, Setting};

/// Balls whose squared distance is more than this part of that at which they touch are not close.
const CLOSE: f64 = 1.05;
/// Centres closer than this, px, have no direction from one to the other.
pub(super) const COINCIDENT: f64 = 1e-150;

/// Two that come nearer by less than this part of their speed do not: by rounding, those that have just met without restitution
/// would meet again, for ever.
const ROUNDING: f64 = 1e-13;

/// A ball wakes of what gives it more than so many kicks of gravity; one that is lighter than what hits it, of less in that
/// ratio: else that would turn back as if off a wall. (With a quarter, piles of ten thousand come to rest half a second later.)
const GIVEN: f64 = 1.0;
/// The part of that at which one wakes that walls alone carry: what a row takes without waking, from ball to ball, is lost to it.
const GIVEN_LOOSE: f64 = 0.02;

/// Steps of Newton's method from the straight way to the parabola, which are g·h²/8 apart: 2e-3 px as a rule.
const STEPS: u32 = 2;

/// How near two balls may come in a substep, by the tangent of their squared distance, which lies above it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Approach {
    /// Whether they close in, fast enough where they press on each other, and may touch.
    pub(super) may_meet: bool,
    /// Whether they touch, or nearly do, or may come to.
    pub(super) closes_in: bool,
    /// Whether they stand nearer than half as far from each other as where they touch.
    pub(super) is_deep: bool,
}

impl Approach {
    #[inline]
    #[expect(clippy::needless_bitwise_bool, reason = "a branch here cannot be foreseen by a processor")]
    pub(super) fn of(setting: &Setting, first: &Body, second: &Body, held: bool) -> Self {
        let offset = first.position - second.position;
        let closing = offset.dot(first.velocity - second.velocity);
        let reach = first.radius + second.radius;
        // The least that a pair bounces at that presses on each other: a load may ask for more.
        let firm = if held { setting.firm * reach } else { 0.0 };
        let reach = reach * reach;
        let squared = offset.length_squared();
        let least = squared + 2.0 * closing.min(0.0) * setting.substep;
        let may_meet = (least <= reach) & (closing < 0.0) & (-closing >= firm);
        Self { may_meet, closes_in: least <= reach * CLOSE, is_deep: squared < 0.25 * reach }
    }
}

/// Two balls meeting in a substep.
pub(super) struct Meeting {
    /// When, s after the substep's beginning.
    pub(super) time: f64,
    /// Where the first is then, seen from the second, px.
    pub(super) offset: DVec2,
    length: f64,
    /// Speed of approach, px/s.
    pub(super) speed: f64,
}

impl Meeting {
    /// `None` where they do not meet in this substep after `since`, or meet more slowly than `firm`, px/s, where they
    /// press on each other.
    pub(super) fn of(
        setting: &Setting,
        first: &Body,
        second: &Body,
        firm: Option<f64>,
        since: f64,
    ) -> Option<Self> {
        let offset = first.position - second.position;
        let velocity = first.velocity - second.velocity;
        let closing = offset.dot(velocity);
        let reach = first.radius + second.radius;
        if closing >= 0.0 || firm.is_some_and(|firm| -closing < firm * reach) {
            return None;
        }
        // From where they are when the later one was hit.
        let offset = offset + velocity * since;
        let closing = offset.dot(velocity);
        let gap = offset.length_squared() - reach * reach;
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
        let touch = (time, offset + velocity * wait);
        let change = first.change(setting.kick) - second.change(setting.kick);
        let (time, offset, closing) = if first.is_free() && second.is_free() {
            let (time, offset, then) = on_parabola(setting, touch, (velocity, change), since);
            (time, offset, offset.dot(then))
        } else {
            // By the velocity at the time of impact, or, where they pressed on each other before, by that without what
            // presses them together now; but by no more than the mean velocity in the substep, in which what they were
            // given already counts: none may give more than it finds.
            let then = velocity + change * if firm.is_some() { -1.0 } else { time / setting.substep - 0.5 };
            let (time, offset) = touch;
            (time, offset, offset.dot(velocity).max(offset.dot(then)))
        };
        let length = offset.length();
        let fastest = first.velocity.length_squared().max(second.velocity.length_squared());
        let rounding = fastest * (ROUNDING * length) * (ROUNDING * length);
        let meets = closing < 0.0 && closing * closing > rounding && length >= COINCIDENT;
        meets.then(|| Self { time, offset, length, speed: -closing / length })
    }

    /// Gives both their impulse.
    #[inline]
    pub(super) fn exchange(
        &self,
        bodies: &mut [Body],
        rests: &[Rest],
        (first, second): (usize, usize),
        e: f64,
    ) {
        let (one, other) = (rests[first].in_impacts(), rests[second].in_impacts());
        let change = self.offset * ((1.0 + e) * self.speed / ((one + other) * self.length));
        strike(&mut bodies[first], change * one, self.time);
        strike(&mut bodies[second], -change * other, self.time);
    }
}

/// When two meet on which nothing but gravity acts, where the first is then, seen from the second, and how fast it goes; by when
/// and where they touch on the straight way through the substep. If gravity acts on both, that is how each goes, seen from the
/// other. One that a fixed ball turns back goes on a parabola above it, between the same ends: when they touch on that follows
/// by Newton's method.
fn on_parabola(
    setting: &Setting,
    (straight, touch): (f64, DVec2),
    (velocity, change): (DVec2, DVec2),
    since: f64,
) -> (f64, DVec2, DVec2) {
    let reach = touch.length();
    let at = |time: f64| {
        let part = time / setting.substep;
        let offset = touch + velocity * (time - straight) + change * (0.5 * time * (part - 1.0));
        (offset, velocity + change * (part - 0.5))
    };
    let mut time = straight;
    if change != DVec2::ZERO && straight > since {
        for _ in 0..STEPS {
            let (offset, then) = at(time);
            let closing = offset.dot(then);
            if closing < 0.0 {
                let late = (reach - offset.length()) * offset.length() / closing;
                time = (time + late).clamp(since, setting.substep);
            }
        }
    }
    let (offset, then) = at(time);
    (time, offset, then)
}

/// Whether a ball wakes that another hits at this speed, px/s, with this restitution: where the hit is firm, or gives it, or what
/// hits it, more than a little, which is less if it `is_loose`, carried by walls alone. What stays asleep is hit as if it were fixed: a
/// row at rest on the floor would be a wall to what comes slowly.
fn wakes(
    setting: &Setting,
    speed: f64,
    e: f64,
    [sleeper, by]: [&Rest; 2],
    is_loose: impl FnOnce() -> bool,
) -> bool {
    let given = (1.0 + e) * speed * sleeper.own / (sleeper.own + by.own);
    let most = GIVEN * setting.kick.length() * (by.own / sleeper.own).min(1.0);
    let of_loose = lesser(GIVEN_LOOSE * most, setting.rest_speed);
    speed > setting.firm || given > most || given > of_loose && is_loose()
}

/// Gives a pair its impulses, and wakes it where they are not small. Pairs must be linked.
pub(super) fn exchange(
    stage: &mut Stage<'_>,
    stripes: &mut Stripes<'_>,
    spot: Spot,
    (i, j): (usize, usize),
    meeting: &Meeting,
) {
    let e = stage.restitutions[i].min(stage.restitutions[j]);
    for (body, by) in [(i, j), (j, i)] {
        let [sleeper, by] = [&stage.rests[body], &stage.rests[by]];
        let is_loose = || stripes.is_carried_by_walls_alone(body, sleeper, stage.setting.kick);
        if sleeper.asleep && wakes(stage.setting, meeting.speed, e, [sleeper, by], is_loose) {
            let part = meeting.time / stage.setting.substep;
            wake_by_hit(body, part, stage.setting, stage.bodies, stage.rests, stripes);
        }
    }
    meeting.exchange(stage.bodies, stage.rests, (i, j), e);
    stripes.list[spot.stripe as usize].note_met(spot.at as usize, meeting.time > 0.0);
    stage.tally.impacts += u64::from(meeting.speed > stage.setting.rest_speed);
    (stage.hit[i], stage.hit[j]) = (true, true);
}

/// A sudden change of velocity, at a time of the substep.
#[inline]
pub(super) fn strike(body: &mut Body, change: DVec2, time: f64) {
    body.velocity += change;
    body.free += change;
    body.position -= change * time;
}
