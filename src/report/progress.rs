//! How far a report has come: by steps, each with its name.

use crate::headless;

/// What is being measured, and how much of it is left.
#[derive(Debug)]
pub(super) struct Progress {
    bar: headless::Progress,
    done: u64,
}

impl Progress {
    pub(super) fn new(steps: usize) -> Self {
        let template = "{wide_bar} {pos}/{len} {msg:<20}{left}";
        Self { bar: headless::Progress::new(steps as u64, template), done: 0 }
    }

    /// Begins the next step.
    pub(super) fn step(&mut self, name: &str) {
        self.bar.show(self.done, name);
        self.done += 1;
    }
}
