//! Time as the window measures it: the delta of each frame, and how many there are in a second.

use std::time::{Duration, Instant};

/// Measures the time from frame to frame on the monotonic clock.
#[derive(Debug, Default)]
pub(super) struct FrameClock {
    last: Option<Instant>,
}

impl FrameClock {
    /// The seconds since the frame before; 0 for the first, and for the first after [`stop`](Self::stop).
    pub(super) fn tick(&mut self, now: Instant) -> f64 {
        let delta = self.last.map_or(0.0, |last| now.saturating_duration_since(last).as_secs_f64());
        self.last = Some(now);
        delta
    }

    /// Forgets the frame before: time that passes without frames is not simulated.
    pub(super) fn stop(&mut self) {
        self.last = None;
    }
}

/// Counts frames, and tells their rate now and then.
#[derive(Debug, Default)]
pub(super) struct FrameRate {
    /// When the first frame of those that are counted was shown.
    since: Option<Instant>,
    frames: u32,
}

/// How often the rate is told.
const TOLD_EVERY: Duration = Duration::from_millis(500);

impl FrameRate {
    /// Counts a frame; the rate in frames per second where it is time to tell it.
    pub(super) fn count(&mut self, now: Instant) -> Option<f64> {
        let Some(since) = self.since else {
            self.since = Some(now);
            return None;
        };
        self.frames += 1;
        let span = now.saturating_duration_since(since);
        if span < TOLD_EVERY {
            return None;
        }
        let rate = f64::from(self.frames) / span.as_secs_f64();
        *self = Self { since: Some(now), frames: 0 };
        Some(rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_frame_and_the_first_after_a_stop_take_no_time() {
        let (start, mut clock) = (Instant::now(), FrameClock::default());
        assert_eq!(clock.tick(start), 0.0);
        assert_eq!(clock.tick(start + Duration::from_millis(250)), 0.25);
        clock.stop();
        assert_eq!(clock.tick(start + Duration::from_secs(60)), 0.0);
        assert_eq!(clock.tick(start), 0.0, "a clock that steps back takes no time either");
    }

    #[test]
    fn the_rate_is_frames_over_time() {
        let start = Instant::now();
        let mut rate = FrameRate::default();
        for frame in 0..30 {
            assert_eq!(rate.count(start + Duration::from_millis(frame * 17)), None);
        }
        assert_eq!(rate.count(start + Duration::from_millis(600)), Some(50.0));
    }
}
