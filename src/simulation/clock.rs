//! Time as an exact sum.

/// A fixed-point clock in units of 2⁻⁸⁰ s: deltas add up without rounding, so that the same deltas in any order, and
/// an hour of them, come to the same time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Clock(u128);

/// Units in a second: 2 to the power of this.
const SECOND_BITS: u32 = 80;
const SECOND: f64 = (1_u128 << SECOND_BITS) as f64;
/// Frames are shown at multiples of 2⁻⁴⁶ s, so that sums that differ by the rounding of their deltas (120 times 1/24
/// and 300 times 1/60) show the same state.
const SHOWN: u128 = 1 << 34;
/// The same in seconds: times no farther apart than this are one, since a frame's time is not known better.
pub(super) const INSTANT: f64 = SHOWN as f64 / SECOND;

impl Clock {
    /// The time `seconds` later; `seconds` is not negative.
    pub(super) fn after(self, seconds: f64) -> Self {
        Self(self.0 + (seconds * SECOND) as u128)
    }

    /// The nearest time at which a frame is shown.
    pub(super) fn shown(self) -> Self {
        Self((self.0 + SHOWN / 2) / SHOWN * SHOWN)
    }

    /// The nearest time at which a frame is shown, in seconds since `origin`, a time before.
    pub(super) fn shown_since(self, origin: Self) -> f64 {
        self.shown().seconds_since(origin)
    }

    /// The last time at which a frame is shown that is not later than `seconds` after this one.
    pub(super) fn shown_before(self, seconds: f64) -> Self {
        Self(self.after(seconds).0 / SHOWN * SHOWN)
    }

    /// The whole steps of 1/`rate` s that are over when a frame is shown at this time, and the seconds since the last
    /// of them ended: 0 where these are within the rounding of what is shown.
    pub(super) fn steps(self, rate: u32) -> (u64, f64) {
        let Self(shown) = self.shown();
        let steps = ((shown + SHOWN) * u128::from(rate)) >> SECOND_BITS;
        let begun = (steps << SECOND_BITS) / u128::from(rate);
        let rest = shown.saturating_sub(begun);
        (steps as u64, if rest <= SHOWN { 0.0 } else { rest as f64 / SECOND })
    }

    /// The time at which the first step of 1/`rate` s begins that is not over when a frame is shown at this time.
    pub(super) fn next_step(self, rate: u32) -> Self {
        let (over, rest) = self.steps(rate);
        Self::at_step(over + u64::from(rest > 0.0), rate)
    }

    /// The time at which so many steps of 1/`rate` s are over.
    pub(super) fn at_step(steps: u64, rate: u32) -> Self {
        Self((u128::from(steps) << SECOND_BITS).div_ceil(u128::from(rate)))
    }

    /// Seconds since an earlier time.
    pub(super) fn seconds_since(self, earlier: Self) -> f64 {
        self.0.saturating_sub(earlier.0) as f64 / SECOND
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deltas_that_differ_by_rounding_alone_come_to_the_same_time() {
        for (rate, count) in [(24.0, 120), (60.0, 300), (144.0, 720)] {
            let clock = (0..count).fold(Clock::default(), |clock, _| clock.after(1.0 / rate));
            assert_eq!(clock.shown_since(Clock::default()), 5.0);
        }
    }

    #[test]
    fn a_clock_that_stops_before_an_event_does_not_show_it() {
        let start = Clock::default().after(3.0);
        for seconds in [0.0, 1e-15, 0.1, 1.0 / 3.0, 7.0] {
            let stopped = start.shown_before(seconds);
            let shown = stopped.shown_since(start);
            assert!(shown <= seconds && seconds - shown < 2e-14, "{seconds}: {shown}");
        }
    }
}
