//! What the solver knows of each ball: its flight, and what will end it.

use glam::DVec2;

use crate::simulation::ball::Ball;
use crate::simulation::flight::{self, NEVER};

use super::cells::{Border, Place};

/// A ball's flight since its last impact, and what will end it: one cache line.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Flight {
    /// Where the flight began.
    pub position: DVec2,
    /// The velocity that it began with.
    pub velocity: DVec2,
    /// When it began, s since the origin.
    pub time: f64,
    /// The earliest impact foreseen.
    pub impact: f64,
    /// The next event: that impact, or before it the crossing of a border between cells.
    pub event: f64,
    pub against: Against,
    pub place: Place,
}

/// What a ball will hit, in four bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Against(u32);

/// An [`Against`] taken apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Target {
    Nothing,
    /// A wall across an axis, at the high or the low end.
    Wall {
        axis: usize,
        high: bool,
    },
    Ball(usize),
}

impl Against {
    pub(super) const NOTHING: Self = Self(u32::MAX);
    /// There are fewer balls than this; the four numbers from here on are walls.
    const WALLS: u32 = u32::MAX - 4;

    pub(super) fn wall(axis: usize, high: bool) -> Self {
        Self(Self::WALLS + 2 * axis as u32 + u32::from(high))
    }

    pub(super) fn ball(index: usize) -> Self {
        Self(index as u32)
    }

    pub(super) fn target(self) -> Target {
        match self {
            Self::NOTHING => Target::Nothing,
            Self(number) if number < Self::WALLS => Target::Ball(number as usize),
            Self(number) => {
                let wall = (number - Self::WALLS) as usize;
                Target::Wall { axis: wall / 2, high: wall % 2 == 1 }
            }
        }
    }
}

impl Flight {
    pub(super) fn new(position: DVec2, velocity: DVec2) -> Self {
        Self {
            position,
            velocity,
            time: 0.0,
            impact: NEVER,
            event: NEVER,
            against: Against::NOTHING,
            place: Place::default(),
        }
    }

    /// Position and velocity at a time, without acceleration.
    #[inline]
    pub(super) fn straight(&self, time: f64) -> (DVec2, DVec2) {
        (self.position + self.velocity * (time - self.time), self.velocity)
    }

    /// Position and velocity at a time, under an acceleration.
    #[inline]
    pub(super) fn at(&self, time: f64, acceleration: DVec2) -> (DVec2, DVec2) {
        let since = time - self.time;
        (
            flight::position(self.position, self.velocity, acceleration, since),
            self.velocity + acceleration * since,
        )
    }
}

/// What a solver needs of a ball beside its motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Matter {
    pub radius: f64,
    pub mass: f64,
    pub restitution: f64,
}

impl Matter {
    pub(super) fn of(ball: &Ball) -> Self {
        Self { radius: ball.radius, mass: ball.mass, restitution: ball.restitution }
    }

    /// Whether nothing moves the ball.
    pub(super) fn is_fixed(&self) -> bool {
        self.mass == f64::INFINITY
    }
}

/// How a ball gets on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Way {
    /// By itself.
    Flies,
    /// Not at all: it is [`Marks::HELD`].
    Held,
    /// It is [`Marks::CARRIED`].
    Carried,
    /// It is one of those that are [`Marks::WAITS`].
    Waits,
}

/// What a ball is doing. The bits, from the lowest up:
///
/// - 0 and 1: [`rests`](Self::rests), one for each axis;
/// - 2, 3, 4 and 7: [`HIT`](Self::HIT), [`STRUCK`](Self::STRUCK), [`LEANS`](Self::LEANS) and [`HELD`](Self::HELD);
/// - 5 and 6: the axis and the side of the [`border`](Self::border);
/// - 8 to 11: [`quick_hits`](Self::quick_hits);
/// - 12 to 15: [`chatter`](Self::chatter);
/// - 16: [`CARRIED`](Self::CARRIED);
/// - 17 to 20: [`hits_in_step`](Self::hits_in_step);
/// - 21: [`TIGHT`](Self::TIGHT);
/// - 22, 23 and 24: [`WAITS`](Self::WAITS), [`AMONG_MANY`](Self::AMONG_MANY) and [`STRAIGHT`](Self::STRAIGHT);
/// - 25 to 31: the impacts of a [`storm`](Self::storm).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Marks(u32);

impl Marks {
    /// It hit another ball, or touched it, since the last frame.
    pub(super) const HIT: Self = Self(4);
    /// It has had an impact, so that its flight's beginning is the time of one.
    pub(super) const STRUCK: Self = Self(8);
    /// Its last impact was on another ball, and slow: it leans on it.
    pub(super) const LEANS: Self = Self(16);
    /// It is held by others, and stands still (see `settle`).
    pub(super) const HELD: Self = Self(128);
    /// It is carried by others, in steps (see `carry`).
    pub(super) const CARRIED: Self = Self(1 << 16);
    /// It is carried where there was no room to part, a step ago or a few.
    pub(super) const TIGHT: Self = Self(1 << 21);
    /// It has hit what is carried, and waits for the next step (see `blows`).
    pub(super) const WAITS: Self = Self(1 << 22);
    /// It was of a group of many that was carried on in the last step, if it was of any.
    pub(super) const AMONG_MANY: Self = Self(1 << 23);
    /// It is carried along straight lines, since it has no room to hop, or is one of many; or it waits beside such a one.
    pub(super) const STRAIGHT: Self = Self(1 << 24);
    /// It is carried, or waits.
    pub(super) const GOES_ALONG: Self = Self(Self::CARRIED.0 | Self::WAITS.0);
    /// All ways but that of what flies by itself.
    const WAYS: Self = Self(Self::HELD.0 | Self::GOES_ALONG.0);
    /// As many quick hits as are counted, in four bits.
    const MOST_QUICK: u32 = 15;
    /// As many hits in a step as are counted, in four bits.
    const MOST_IN_STEP: u32 = 15;
    /// As many hits in a storm as are counted, in seven bits.
    const STORM: u32 = 127;
    /// As much chatter as is counted, in four bits.
    pub(super) const MOST_CHATTER: u32 = 15;

    /// It rests on a wall across this axis.
    pub(super) fn rests_on(axis: usize) -> Self {
        Self(1 << axis)
    }

    /// On which axes it rests, a bit each: a number from 0 to 3.
    #[inline]
    pub(super) fn rests(self) -> usize {
        (self.0 & 3) as usize
    }

    /// Along which axes nothing accelerates it, a bit each.
    #[inline]
    pub(super) fn unaccelerated(self) -> usize {
        if self.has(Self::STRAIGHT) { 3 } else { self.rests() }
    }

    /// The border of its cell that it crosses next, under gravity.
    #[inline]
    pub(super) fn border(self) -> Border {
        Border { axis: (self.0 >> 5 & 1) as usize, up: self.0 >> 6 & 1 == 1 }
    }

    #[inline]
    pub(super) fn set_border(&mut self, Border { axis, up }: Border) {
        self.0 = self.0 & !0x60 | (axis as u32) << 5 | u32::from(up) << 6;
    }

    /// How many impacts it has had one soon after the other, up to [`MOST_QUICK`](Self::MOST_QUICK).
    #[inline]
    pub(super) fn quick_hits(self) -> u32 {
        self.0 >> 8 & Self::MOST_QUICK
    }

    /// Goes on in this way from now on, and in no other.
    #[inline]
    pub(super) fn go(&mut self, way: Way) {
        let mark = match way {
            Way::Flies => Self(0),
            Way::Held => Self::HELD,
            Way::Carried => Self::CARRIED,
            Way::Waits => Self::WAITS,
        };
        self.0 = self.0 & !(Self::WAYS.0 | Self::STRAIGHT.0) | mark.0;
        if way == Way::Held {
            // Along both axes; and what it was before says nothing any more.
            self.0 |= 3;
            self.set(Self::TIGHT, false);
            self.count_hits(false);
            self.calm_down();
        }
    }

    /// Rests on these axes from now on, a bit each.
    pub(super) fn rest(&mut self, axes: usize) {
        self.0 = self.0 & !3 | axes as u32;
    }

    /// Forgets how soon impacts followed each other so far: another flight begins, and not with an impact.
    pub(super) fn forget_quick_hits(&mut self) {
        self.0 &= !(Self::MOST_QUICK << 8);
    }

    /// How many impacts it has had in a row that followed each other at once, up to [`STORM`](Self::STORM).
    #[inline]
    fn storm(self) -> u32 {
        self.0 >> 25
    }

    /// Whether so many have that this may have no end.
    pub(super) fn is_in_storm(self) -> bool {
        self.storm() == Self::STORM
    }

    /// Notes an impact, soon after the one before, or at once after it, or not.
    #[inline]
    pub(super) fn strike(&mut self, soon: bool, at_once: bool) {
        let hits = if soon { (self.quick_hits() + 1).min(Self::MOST_QUICK) } else { 0 };
        let storm = if at_once { (self.storm() + 1).min(Self::STORM) } else { 0 };
        self.0 =
            self.0 & !(Self::MOST_QUICK << 8 | Self::STORM << 25) | hits << 8 | storm << 25 | Self::STRUCK.0;
        if (1..Self::MOST_IN_STEP).contains(&self.hits_in_step()) {
            self.0 += 1 << 17;
        }
    }

    /// How many impacts it has had since the last step of what is carried, or the end of its last flurry since, and one more, up to
    /// [`MOST_IN_STEP`](Self::MOST_IN_STEP), if it was of a group that was carried on in that step; else 0.
    #[inline]
    pub(super) fn hits_in_step(self) -> u32 {
        self.0 >> 17 & Self::MOST_IN_STEP
    }

    /// Counts impacts from now on, or does not.
    #[inline]
    pub(super) fn count_hits(&mut self, counts: bool) {
        self.0 = self.0 & !(Self::MOST_IN_STEP << 17) | u32::from(counts) << 17;
    }

    /// How many impacts it has had in a row that were chatter, up to [`MOST_CHATTER`](Self::MOST_CHATTER).
    #[inline]
    pub(super) fn chatter(self) -> u32 {
        self.0 >> 12 & Self::MOST_CHATTER
    }

    /// Notes whether an impact was chatter.
    #[inline]
    pub(super) fn note_chatter(&mut self, chatters: bool) {
        let hits = if chatters { (self.chatter() + 1).min(Self::MOST_CHATTER) } else { 0 };
        self.0 = self.0 & !(Self::MOST_CHATTER << 12) | hits << 12;
    }

    /// Whether it has chattered for half as long as what asks for its group.
    pub(super) fn is_restless(self) -> bool {
        2 * self.chatter() >= Self::MOST_CHATTER
    }

    /// The part of this along which it does not rest.
    pub(super) fn free_part(self, of: DVec2) -> DVec2 {
        part(of, self.rests())
    }

    /// The part of what gravity gives along which that accelerates it.
    pub(super) fn accelerated_part(self, of: DVec2) -> DVec2 {
        part(of, self.unaccelerated())
    }

    /// Whether it was of a group of many that was carried on in the last step, or waits: beside such, or in place.
    pub(super) fn is_among_many(self) -> bool {
        self.has(Self::WAITS) || self.has(Self::AMONG_MANY) && self.hits_in_step() > 0
    }

    /// Whether it waits, and stands still until then.
    pub(super) fn waits_in_place(self) -> bool {
        self.has(Self::WAITS) && self.rests() == 3
    }

    /// Forgets the chatter so far.
    pub(super) fn calm_down(&mut self) {
        self.note_chatter(false);
    }

    #[inline]
    pub(super) fn has(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    #[inline]
    pub(super) fn set(&mut self, other: Self, on: bool) {
        if on { self.0 |= other.0 } else { self.0 &= !other.0 }
    }
}

/// The part of this along all axes but these, a bit each.
fn part(of: DVec2, without: usize) -> DVec2 {
    let along = |axis: usize| if without >> axis & 1 == 1 { 0.0 } else { of[axis] };
    DVec2::new(along(0), along(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flight_fills_one_cache_line() {
        assert_eq!(size_of::<Flight>(), 64);
    }

    #[test]
    fn what_a_ball_will_hit_comes_apart_as_it_was_put_together() {
        assert_eq!(Against::NOTHING.target(), Target::Nothing);
        assert_eq!(Against::ball(9_999_999).target(), Target::Ball(9_999_999));
        for (axis, high) in [(0, false), (0, true), (1, false), (1, true)] {
            assert_eq!(Against::wall(axis, high).target(), Target::Wall { axis, high });
        }
    }
}
