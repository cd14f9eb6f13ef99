//! A progress bar: on a terminal, and not before a second has passed.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

const PATIENCE: Duration = Duration::from_secs(1);

/// What is being measured, and how much of it is left.
#[derive(Debug)]
pub(super) struct Progress {
    begun: Instant,
    steps: usize,
    done: u64,
    bar: Option<ProgressBar>,
}

impl Progress {
    pub(super) fn new(steps: usize) -> Self {
        Self { begun: Instant::now(), steps, done: 0, bar: None }
    }

    /// Begins the next step.
    pub(super) fn step(&mut self, name: &str) {
        if self.bar.is_none() && self.begun.elapsed() > PATIENCE && io::stderr().is_terminal() {
            let style = ProgressStyle::with_template("{wide_bar} {pos}/{len} {msg:<20} {eta} left");
            let bar = ProgressBar::new(self.steps as u64);
            self.bar = Some(bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar())));
        }
        if let Some(bar) = &self.bar {
            bar.set_message(name.to_owned());
            bar.set_position(self.done);
        }
        self.done += 1;
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
