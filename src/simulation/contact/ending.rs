//! Where a fast ball was hit as often as it may be (`fates`), the substep ends for it there and then, and for all fast ones
//! that may still come to it, directly or through others: they lose time, never their speed, and go through nothing. What is
//! elsewhere goes on.

use glam::DVec2;

use super::fates::Shift;
use super::impacts::Stage;
use super::near::Near;
use super::{Body, Setting};

/// Balls may still meet that come as near to each other as this part of their radii: rounding is less.
const NEARLY: f64 = 1e-3;

/// Ends the substep for fast balls that were hit as often as they may be, if there are any, and for what is around them. Pairs
/// must be linked.
#[inline]
pub(super) fn end_exhausted(stage: &mut Stage<'_>, near: &mut Near, time: f64) {
    if std::mem::take(&mut stage.limits.exhausted) {
        for body in 0..stage.fates.len() {
            if stage.limits.exhausts(&stage.fates[body]) {
                end_around(stage, near, body, time);
            }
        }
    }
}

/// Has a ball that was hit at `time`, and may come to others now than before, share their fate: where the substep has ended
/// for some of them, it ends for all. Pairs must be linked.
#[inline]
pub(super) fn end_with_others(stage: &mut Stage<'_>, near: &mut Near, body: usize, time: f64) {
    if stage.limits.ended {
        let ended = stage.fates[body].ended;
        let others = near.all();
        let unlike: Vec<usize> = others
            .around(body)
            .filter(|&other| stage.fates[other].ended != ended && stage.may_still_meet(body, other, time))
            .collect();
        for other in unlike {
            end_around(stage, near, if ended { other } else { body }, time);
        }
    }
}

/// Ends the substep at `time` for a ball and all that may still come to it: those that are fast, and those that fast ones have
/// hit again and again. A heavy one that went on would go through what is about to turn it back.
#[cold]
fn end_around(stage: &mut Stage<'_>, near: &mut Near, body: usize, time: f64) {
    stage.limits.ended = true;
    let mut reached = vec![body];
    while let Some(body) = reached.pop() {
        let fate = &mut stage.fates[body];
        if std::mem::replace(&mut fate.ended, true) {
            continue;
        }
        fate.fast |= fate.shift == Shift::Far && fate.hits >= stage.limits.most_far;
        if fate.fast {
            // Not before it was last hit, by a stripe by itself.
            end(stage.setting, &mut stage.bodies[body], time.max(fate.time));
        }
        reached.extend(near.all().around(body).filter(|&other| stage.may_still_meet(body, other, time)));
    }
}

impl Stage<'_> {
    /// Whether two balls could meet after `time` as they move then, wherever they go. Nothing goes to a fixed one, and through
    /// it to others.
    fn may_still_meet(&self, one: usize, other: usize, time: f64) -> bool {
        if [one, other].iter().any(|&at| self.rests[at].in_impacts() == 0.0) {
            return false;
        }
        if [one, other].iter().any(|&at| self.fates[at].time > time) {
            // Where it is now, is not known any more.
            return true;
        }
        let [(from, way), (to, their_way)] = [one, other].map(|at| self.left_to(at, time));
        let reach = (1.0 + NEARLY) * (self.bodies[one].radius + self.bodies[other].radius);
        from.distance(to) <= reach + way + their_way
    }

    /// Where a ball is at `time`, and how far it still goes in this substep, seen from what moves with all.
    fn left_to(&self, at: usize, time: f64) -> (DVec2, f64) {
        let (body, fate, substep) = (&self.bodies[at], &self.fates[at], self.setting.substep);
        if fate.is_over() {
            (body.end(substep) - self.setting.common * (substep - time), 0.0)
        } else {
            (body.end(time), body.velocity.distance(self.setting.common) * (substep - time))
        }
    }
}

/// Ends a body's substep at `time`. Gravity does not work on it any more either: it would gain what it does not fall; unless it
/// falls with all others.
pub(super) fn end(setting: &Setting, body: &mut Body, time: f64) {
    let place = body.end(time) + setting.common * (setting.substep - time);
    if body.inverse_mass > 0.0 && setting.grounded {
        let left_out = setting.kick * (1.0 - time / setting.substep);
        body.velocity -= left_out;
        body.free -= left_out;
    }
    body.position = place - body.velocity * setting.substep;
}
