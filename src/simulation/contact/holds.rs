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
}

/// How two balls hold each other: one cache line.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Hold {
    /// The accumulated impulse that holds them apart in a substep, mass·px/s along `normal`.
    pub(super) impulse: f64,
    /// From the second to the first, of length 1, where it was last needed.
    pub(super) normal: DVec2,
    /// What is left of what was given along earlier directions, mass·px/s.
    pub(super) grip: DVec2,
    /// The velocity, px/s along `normal`, with which they would just touch at the end of the substep.
    pub(super) least: f64,
    /// Whether they have come to touch in this substep.
    pub(super) met: bool,
    /// The effective mass of both along `normal`: 1 over the sum of their inverse masses.
    pub(super) mass: f64,
}

impl Hold {
    pub(super) const NONE: Self =
        Self { impulse: 0.0, normal: DVec2::ZERO, grip: DVec2::ZERO, least: 0.0, met: false, mass: 0.0 };
}

/// What is to be done with a pair.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::struct_excessive_bools, reason = "each is asked by itself")]
pub(super) struct Mark {
    /// Whether the two pressed on each other, or met, in the last substep.
    pub(super) held: bool,
    /// Whether its hold was looked after in the last substep, pressed or not, or the two have met since. The impulse of
    /// others is 0.
    pub(super) live: bool,
    /// Whether they may come close enough in this substep to be held apart.
    pub(super) close: bool,
    /// Whether neither of them can be moved.
    pub(super) idle: bool,
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
