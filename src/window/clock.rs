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
    /// When the last one was.
    last: Option<Instant>,
    frames: u32,
}

/// How often the rate is told.
const TOLD_EVERY: Duration = Duration::from_millis(500);
/// Frames with more between them belong to different runs: the machine slept, or nobody could see the window.
const GAP: Duration = Duration::from_secs(2);

impl FrameRate {
    /// Counts a frame; the rate in frames per second where it is time to tell it.
    pub(super) fn count(&mut self, now: Instant) -> Option<f64> {
        let gap = self.last.replace(now).is_none_or(|last| now.saturating_duration_since(last) > GAP);
        let Some(since) = self.since.filter(|_| !gap) else {
            *self = Self { since: Some(now), last: Some(now), frames: 0 };
            return None;
        };
        self.frames += 1;
        let span = now.saturating_duration_since(since);
        if span < TOLD_EVERY {
            return None;
        }
        let rate = f64::from(self.frames) / span.as_secs_f64();
        *self = Self { since: Some(now), last: Some(now), frames: 0 };
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

    /// The rate that is told last, when frames come at these rates for a second each.
    fn told(rates: &[u32]) -> Vec<f64> {
        let (mut rate, mut now, mut told) = (FrameRate::default(), Instant::now(), Vec::new());
        for &per_second in rates {
            let mut last = None;
            for _ in 0..per_second {
                now += Duration::from_secs(1) / per_second;
                last = rate.count(now).or(last);
            }
            told.extend(last);
        }
        told
    }

    #[test]
    fn the_rate_follows_a_window_that_goes_to_another_monitor() {
        let rates = [60, 144, 30, 240, 60];
        for (told, rate) in told(&rates).iter().zip(rates) {
            assert!((told / f64::from(rate) - 1.0).abs() < 0.02, "{told} for {rate}");
        }
    }

    #[test]
    fn hours_of_sleep_are_a_long_delta_once_and_leave_the_rate_as_it_was() {
        let (mut clock, mut rate) = (FrameClock::default(), FrameRate::default());
        let (mut now, mut told) = (Instant::now(), Vec::new());
        for frame in 0..300 {
            let slept = if frame == 150 { Duration::from_secs(8 * 3600) } else { Duration::ZERO };
            now += Duration::from_millis(20) + slept;
            let delta = clock.tick(now);
            assert_eq!(delta > 0.021, frame == 150, "{delta} s");
            told.extend(rate.count(now));
        }
        assert!(told.len() > 8 && told.iter().all(|rate| (rate - 50.0).abs() < 1e-6), "{told:?}");
    }

    #[test]
    fn a_clock_that_stands_or_steps_back_neither_panics_nor_moves_time() {
        let (mut clock, mut rate, start) = (FrameClock::default(), FrameRate::default(), Instant::now());
        let later = start + Duration::from_secs(1);
        for now in [later, later, start, start, later, start] {
            let delta = clock.tick(now);
            assert!(delta == 0.0 || delta == 1.0, "{delta}");
            assert!(rate.count(now).is_none_or(f64::is_finite));
        }
    }
}
