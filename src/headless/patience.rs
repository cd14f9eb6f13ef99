//! A word for those who wait: where a frame takes so long that another solver may be wanted, that is said once.

use std::time::{Duration, Instant};

/// How long a frame takes before that is said.
const PATIENCE: Duration = Duration::from_secs(10);

/// Since when a frame is under way.
pub(super) struct Patience {
    frame: u64,
    begun: Instant,
    /// Whether it was said of a frame that it takes long.
    said: bool,
}

impl Patience {
    pub(super) fn new() -> Self {
        Self { frame: 0, begun: Instant::now(), said: false }
    }

    /// The frame of this number, from 1, begins.
    pub(super) fn begin(&mut self, frame: u64) {
        (self.frame, self.begun) = (frame, Instant::now());
    }

    /// What there is to say of the frame of `exact` under way.
    pub(super) fn look(&mut self) -> Option<String> {
        self.look_after(self.begun.elapsed())
    }

    fn look_after(&mut self, taken: Duration) -> Option<String> {
        if self.said || taken < PATIENCE {
            return None;
        }
        self.said = true;
        Some(format!(
            "frame {} has taken more than {} s and goes on: exact takes every impact at its time, and there are very \
             many; where balls lie on each other or in each other, --solver contact is faster",
            self.frame,
            PATIENCE.as_secs()
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_frame_of_exact_that_takes_long_a_faster_solver_is_named_once() {
        let long = PATIENCE + Duration::from_millis(1);
        let mut patience = Patience::new();
        patience.begin(7);
        assert_eq!(patience.look_after(PATIENCE / 2), None);
        let word = patience.look_after(long).unwrap();
        assert!(word.starts_with("frame 7 has taken more than 10 s") && word.contains("--solver contact"));
        patience.begin(8);
        assert_eq!(patience.look_after(long), None);
    }
}
