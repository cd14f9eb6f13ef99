//! What is known of each ball's impacts in a substep, and how many it may have.

use glam::DVec2;

use super::amount::Amount;
use super::meeting::strike;
use super::sleep::Rest;
use super::{Body, SHIFT, Setting};

/// Impacts of a ball in one substep, at most, where impacts take energy and there is no gravity.
const MOST: u16 = 8;
/// The same among few balls, where each counts; where nothing ever rests, since no support holds what is left there; and of
/// elastic balls, which would lose energy to a support.
const MOST_OF_FEW: u16 = 64;
/// The same of one that comes from far away: what supports it knows less of its way.
const MOST_FAR: u16 = 32;
/// The same of a fast ball.
const MOST_FAST: u16 = 256;
/// The same where balls are a crowd, of any, one from far away, and a fast one: after each impact all of a ball's pairs are
/// looked at again, and what comes of it is no flight.
const MOST_IN_CROWD: (u16, u16, u16) = (1, 1, 4);
/// Under gravity what presses is better held than thrown to and fro: a ball that is not from far away may be hit as often as
/// leaves this part of a speed, each time with its restitution, but so often at least, and no more often than one from far away. So
/// near-elastic balls bounce on as with `exact`, and of others no impacts are taken that change little.
const LEFT: f64 = 0.3;
const FEWEST: u16 = 4;
/// A ball that lies deep in more others than so many is in a crowd, as where a wall was moved over many that nothing slows
/// down. Where so many pairs of such ones were looked at for each ball, on average, all are taken as a crowd from then on:
/// what each of their impacts costs grows with their pairs.
pub(super) const DEEP_IN_CROWD: u32 = 8;
const LOOKS: usize = 64;
/// So many are taken to be there at least.
const FEWEST_WORKED_ON: usize = 40;
/// A ball that goes farther in a substep than so many times its radius is fast.
const FAST: f64 = 1.0;
/// Under gravity one that comes from far away and was hit so often is fast as long as it could ram others (`room`): it goes less far
/// than its radius, but may go over smaller ones. Where no more of its impacts were taken, it would go through the wall of a narrow
/// tube and let them by, or what holds it at the wall would put it upon them. With 8, what rains on a pile goes another way; with
/// 32, balls in tubes lie deep in each other three times as often.
const FOLLOWED: u16 = 16;
/// A ball that goes no farther in a substep than this part of its radius meets two walls in it at once.
const AT_ONCE: f64 = 0.25;

/// What is known of a body's impacts in a substep.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Fate {
    /// When it was last hit, s after the substep's beginning, and how often it was.
    pub(super) time: f64,
    pub(super) hits: u16,
    /// How often hits of it were taken back.
    undone: u16,
    /// Whether it is too slow to hit firmly those that it presses on.
    pub(super) slow: bool,
    pub(super) fast: bool,
    /// Whether the substep has ended for it, if it is fast (`ending`).
    pub(super) ended: bool,
    pub(super) shift: Shift,
    /// What walls on which it came to rest give it from now on in a substep, px/s; 0 across others.
    pub(super) borne: DVec2,
}

/// Where a body stands that was hit after the substep's beginning: until its end where it would have come from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Shift {
    /// Where it is, or near to it.
    #[default]
    None,
    /// Elsewhere.
    Some,
    /// Far away: it is fast, or was hit by a fast one.
    Far,
}

impl Fate {
    /// Notes what walls give it from now on where it came to rest on them.
    pub(super) fn bear(&mut self, borne: DVec2) {
        self.borne = DVec2::select(borne.cmpne(DVec2::ZERO), borne, self.borne);
    }

    /// That of a body that is slow, or fast, or neither.
    #[inline]
    pub(super) fn at_start(slow: bool, fast: bool) -> Self {
        Self { slow, fast, ..Self::default() }
    }

    /// What tells its course from all others that it had in this substep.
    #[inline]
    pub(super) fn course(&self) -> u32 {
        u32::from(self.hits) | u32::from(self.undone) << u16::BITS
    }

    /// Whether the substep is over for its body: it stands still since.
    #[inline]
    pub(super) fn is_over(&self) -> bool {
        self.fast && self.ended
    }

    /// Whether impacts of its body with another are over in this substep, since it has ended for one of them, and one is fast.
    #[inline]
    pub(super) fn is_over_with(&self, other: &Self) -> bool {
        (self.fast || other.fast) && (self.ended || other.ended)
    }

    /// What it was before some hits. What was foreseen of the body then does not hold any more.
    pub(super) fn back_to(&mut self, before: Self) {
        *self = Self { undone: self.undone.wrapping_add(1), ..before };
    }

    /// Changes the velocity of its body, after all impacts.
    pub(super) fn slow_down(&mut self, setting: &Setting, body: &mut Body, change: DVec2) {
        // A fast one may have had its last impact, and its end, at any time: it stays where it would be in the end.
        let time = if self.fast { setting.substep } else { self.time };
        strike(body, change, time);
        self.shift.raise(Shift::Some, change.length() * time > SHIFT * body.radius);
    }
}

impl Shift {
    /// At least `other`, where that is so.
    pub(super) fn raise(&mut self, other: Self, so: bool) {
        if so {
            *self = other.max(*self);
        }
    }
}

/// How often bodies may be hit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// How often a body may be at least that is not fast; that comes from far away; and that is fast.
    most: u16,
    pub(super) most_far: u16,
    most_fast: u16,
    /// How often one may be that is neither, as long as its impacts leave enough of a speed.
    most_by_loss: u16,
    /// Whether balls are a crowd.
    crowd: bool,
    /// How many pairs of balls in a crowd may be looked at.
    looks: usize,
    /// Whether a fast one was hit so often that the substep ends for it.
    pub(super) exhausted: bool,
    /// Whether it has ended for any.
    pub(super) ended: bool,
}

impl Limits {
    /// Those of so many bodies, which are a crowd or not; a share of them is `worked_on`.
    pub(super) fn of(worked_on: usize, crowd: bool, setting: &Setting) -> Self {
        let (each, far, fast) = (MOST_OF_FEW, MOST_OF_FEW, MOST_FAST);
        let ((most, most_far, most_fast), most_by_loss) = if setting.amount == Amount::Few {
            ((each, far, fast), MOST_OF_FEW)
        } else if crowd {
            (MOST_IN_CROWD, MOST_IN_CROWD.0)
        } else if !setting.can_rest {
            ((each, far, fast), MOST_OF_FEW)
        } else if setting.kick != DVec2::ZERO {
            ((FEWEST, MOST_FAR, MOST_FAST), MOST_FAR)
        } else {
            ((MOST, MOST_FAR, MOST_FAST), MOST)
        };
        let looks = LOOKS * worked_on.max(FEWEST_WORKED_ON);
        Self { most, most_far, most_fast, most_by_loss, crowd, looks, exhausted: false, ended: false }
    }

    /// Counts the pairs of a ball in a crowd that were looked at.
    pub(super) fn count(&mut self, pairs: usize) {
        self.looks = self.looks.saturating_sub(pairs);
        if self.looks == 0 {
            (self.most, self.most_far, self.most_fast) = MOST_IN_CROWD;
            self.crowd = true;
        }
    }

    /// Whether a body is fast and was hit as often as such a one may be.
    pub(super) fn exhausts(&self, fate: &Fate) -> bool {
        fate.fast && fate.hits >= self.most_fast
    }

    /// How often a body may be hit at least that is shifted so, and not fast.
    #[inline]
    pub(super) fn least(&self, shift: Shift) -> u16 {
        if shift == Shift::Far { self.most_far } else { self.most }
    }

    /// Whether a body is followed as a fast one, since it comes from far away, was hit often, and still goes on. Not without gravity,
    /// and not of unlike balls: those go no farther than there is room. Nor in a crowd, where what comes of an impact is no flight.
    pub(super) fn follows(&self, setting: &Setting, (body, rest): (&Body, &Rest), fate: &Fate) -> bool {
        let often = fate.shift == Shift::Far && fate.hits >= FOLLOWED && !self.crowd;
        often && setting.kick != DVec2::ZERO && !rest.unlike.differs() && setting.rams(body)
    }

    /// Whether a body that is not fast may not be hit any more with this restitution, by what is so many times smaller, so
    /// that there are more of these around it.
    pub(super) fn is_spent(&self, fate: &Fate, shift: Shift, restitution: f64, size: f64) -> bool {
        let least = self.least(shift);
        if fate.hits < least || self.crowd {
            return fate.hits >= least;
        }
        let most = if restitution == 1.0 { least.max(MOST_OF_FEW) } else { self.most(shift, restitution) };
        f64::from(fate.hits) >= f64::from(most) * size.max(1.0)
    }

    /// Whether a body that is not fast was hit as often as it may be with this restitution, unless by what is smaller, or without
    /// any loss.
    pub(super) fn may_be_spent(&self, fate: &Fate, restitution: f64) -> bool {
        !fate.fast && fate.hits >= self.least(fate.shift) && fate.hits >= self.most(fate.shift, restitution)
    }

    /// How often a body may be hit that is shifted so, and not fast, with a restitution that takes energy.
    fn most(&self, shift: Shift, restitution: f64) -> u16 {
        self.least(shift).max(hits_that_leave(LEFT, restitution, self.most_by_loss))
    }
}

/// How many impacts of this restitution leave no more than a part of a speed, if no more than `most` do.
fn hits_that_leave(part: f64, restitution: f64, most: u16) -> u16 {
    let (mut hits, mut left) = (1, restitution);
    while hits < most && left > part {
        (hits, left) = (hits + 1, left * restitution);
    }
    hits
}

/// Whether a body goes so far in a substep that it could go through others.
pub(super) fn is_fast(setting: &Setting, body: &Body) -> bool {
    goes_beyond(FAST, setting, body)
}

/// Whether a body goes so far in a substep that it is to meet walls one after the other: what turns it at the second, before it is
/// there, puts it where it would have come from, and past what is in its way.
pub(super) fn meets_one_wall(setting: &Setting, body: &Body, fate: &Fate) -> bool {
    fate.shift == Shift::Far || goes_beyond(AT_ONCE, setting, body)
}

/// Whether a body goes farther in a substep than so many times its radius.
fn goes_beyond(radii: f64, setting: &Setting, body: &Body) -> bool {
    let far = radii * body.radius / setting.substep;
    body.velocity.distance_squared(setting.common) > far * far
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_more_an_impact_takes_the_fewer_are_taken() {
        let hits =
            [0.0, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.97, 0.999].map(|e| hits_that_leave(LEFT, e, MOST_FAR));
        assert_eq!(hits, [1, 1, 2, 4, 6, 12, 24, 32, 32]);
    }
}
