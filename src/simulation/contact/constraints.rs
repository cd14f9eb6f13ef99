//! What is known of balls that are near each other, or near a wall: who they are, and how they hold each other.

use glam::DVec2;

/// Two balls that may touch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair {
    pub(super) first: u32,
    pub(super) second: u32,
}

impl Pair {
    /// The same pair where balls are counted from `start` balls before.
    #[inline]
    pub(super) fn from(self, start: usize) -> Self {
        Self { first: self.first + start as u32, second: self.second + start as u32 }
    }

    /// The other one of the two.
    #[inline]
    pub(super) fn other(self, ball: u32) -> u32 {
        if self.first == ball { self.second } else { self.first }
    }

    /// The same pair where balls are counted from `start` on.
    #[inline]
    pub(super) fn within(self, start: usize) -> Self {
        Self { first: self.first - start as u32, second: self.second - start as u32 }
    }
}

/// The contact constraint of two balls, which holds them apart: one cache line.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Constraint {
    /// The accumulated impulse that holds them apart in a substep, mass·px/s along `normal`.
    pub(super) impulse: f64,
    /// From the second to the first, of length 1, where it was last needed.
    pub(super) normal: DVec2,
    /// What is left of what was given along earlier directions, mass·px/s.
    pub(super) grip: DVec2,
    /// The velocity, px/s along `normal`, with which they would just touch at the end of the substep.
    pub(super) least: f64,
    /// The effective mass of both along `normal`: 1 over the sum of their inverse masses.
    pub(super) mass: f64,
    /// Who they are.
    pub(super) pair: Pair,
}

impl Constraint {
    /// That of two balls that do not press on each other yet.
    pub(super) fn none(pair: Pair, mass: f64) -> Self {
        Self { impulse: 0.0, normal: DVec2::ZERO, grip: DVec2::ZERO, least: 0.0, mass, pair }
    }
}

/// What is known of a pair: a set, in one byte, since all pairs are gone through a few times in a substep.
#[derive(Debug, Clone, Copy)]
pub(super) struct Marks(u8);

impl Marks {
    /// Nothing is so.
    pub(super) const NONE: Self = Self(0);
    /// The two pressed on each other, or met, in the last substep.
    pub(super) const HELD: Self = Self(1);
    /// Its constraint was looked after in the last substep, pressed or not, or the two have met since. The impulse of
    /// others is 0.
    pub(super) const LIVE: Self = Self(2);
    /// They may come close enough in this substep to be held apart.
    pub(super) const CLOSE: Self = Self(4);
    /// They have come to touch in this substep.
    pub(super) const MET: Self = Self(8);
    /// One of them cannot be moved.
    pub(super) const STILL: Self = Self(16);
    /// Neither can.
    pub(super) const IDLE: Self = Self(32);
    /// Both are unlike those around them, in size or in density (`unlike`).
    pub(super) const UNLIKE_IN_SIZE: Self = Self(64);
    pub(super) const UNLIKE_IN_DENSITY: Self = Self(128);

    /// Whether any of these is so.
    #[inline]
    pub(super) fn has(self, any: Self) -> bool {
        self.0 & any.0 != 0
    }

    /// Whether the two are held apart in this substep.
    #[inline]
    pub(super) fn touch(self) -> bool {
        // Without a branch, which a processor could not foresee.
        self.has(Self::LIVE) & !self.has(Self::IDLE)
    }

    /// Notes whether all of these are so.
    #[inline]
    pub(super) fn set(&mut self, which: Self, on: bool) {
        self.0 = self.0 & !which.0 | (which.0 * u8::from(on));
    }

    /// Notes which of the two, by their inverse masses, can be moved.
    #[inline]
    pub(super) fn weigh(&mut self, first: f64, second: f64) {
        self.set(Self::STILL, first == 0.0 || second == 0.0);
        self.set(Self::IDLE, first == 0.0 && second == 0.0);
    }
}

impl std::ops::BitOr for Marks {
    type Output = Self;

    #[inline]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl std::ops::BitXor for Marks {
    type Output = Self;

    #[inline]
    fn bitxor(self, other: Self) -> Self {
        Self(self.0 ^ other.0)
    }
}

/// What holds a ball in a substep, px/s.
pub(super) struct Given {
    /// The sum.
    pub(super) velocity: DVec2,
    /// The sum of the sizes, whatever their directions.
    pub(super) pressed: f64,
}

/// A ball that may touch a wall.
#[derive(Debug, Clone, Copy)]
pub(super) struct Beside {
    pub(super) body: u32,
    /// The velocity that the walls give it in a substep, px/s.
    pub(super) push: DVec2,
}
