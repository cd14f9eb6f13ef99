//! How contacts give way, by how many substeps a beat has.

use super::substeps::{FEWEST, MOST};
use super::unlike::{Crush, Unlike};

/// Where densities differ, contacts give way by so much less: a light ball that carries a heavy one carries many times its own
/// weight, and what it would give way by each substep, would be taken from the heavy one (`Stripe::carry_all`), which then
/// never came through.
const STIFFER: f64 = 0.1;
/// The same of one material: the firmer, the less small balls are pressed into each other, and the later thousands rest.
const STIFFER_OF_SIZES: f64 = 0.3;
/// Where some balls could crush others, so much of an overlap is taken away at least: a heavy ball goes through light ones as fast as
/// these are pushed out of it, and the less they are, the deeper they would have to be. With 0.3 it takes half as long again; with
/// 0.8 fewer piles come to rest. Not among more of them: thousands come to rest much later so.
const MENDED_OF_SOME: f64 = 0.6;

/// How contacts give way in a substep.
///
/// They are springs that are damped more than enough: a pair that carries the weight of N balls of its own mass overlaps by
/// about N·g·h²·(1/yielding − 1)/mended in substeps of h seconds. That is much the same for two to four a beat, and less for six
/// and eight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Softness {
    /// The part of an overlap that is taken away, by how unlike its balls are.
    mended: [f64; Unlike::KINDS],
    /// What is left of an impulse that gives way, by how unlike its balls are.
    yielding: [f64; Unlike::KINDS],
    /// The same where few of many are awake: what sleepers squeeze would overlap them too deeply to sleep, too.
    yielding_of_few: [f64; Unlike::KINDS],
}

impl Softness {
    /// That which suits so many substeps in a beat, and whom balls could crush.
    pub(super) fn of(count: u32, crush: Crush) -> Self {
        let (mended, soft): (f64, f64) = match count {
            ..=FEWEST => (0.8, 0.004),
            3 => (0.6, 0.006),
            MOST.. => (0.3, 0.006),
        };
        let yielding =
            |soft: f64| [1.0, STIFFER_OF_SIZES, STIFFER].map(|stiffer| 1.0 / (1.0 + stiffer * soft));
        let of_unlike = if crush == Crush::AmongSome { mended.max(MENDED_OF_SOME) } else { mended };
        let mended = [mended, mended, of_unlike];
        Self { mended, yielding: yielding(soft), yielding_of_few: yielding(0.25 * soft) }
    }

    /// The part of an overlap of such balls that is taken away.
    #[inline]
    pub(super) fn mended(&self, unlike: Unlike) -> f64 {
        self.mended[unlike as usize]
    }

    /// What is left, between such balls, of an impulse that gives way.
    #[inline]
    pub(super) fn yielding(&self, unlike: Unlike) -> f64 {
        self.yielding[unlike as usize]
    }

    /// The same where few of many are awake.
    pub(super) fn yielding_of_few(&self, unlike: Unlike) -> f64 {
        self.yielding_of_few[unlike as usize]
    }
}
