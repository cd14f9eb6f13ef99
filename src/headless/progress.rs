//! A progress bar: on a terminal, and not before a second has passed.

use std::fmt;
use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};

/// How long something takes before it shows its progress.
const PATIENCE: Duration = Duration::from_secs(1);

/// How much is done of something, shown on standard error.
#[derive(Debug)]
pub(crate) struct Progress {
    begun: Instant,
    steps: u64,
    /// Whether there is a terminal to show it on.
    shows: bool,
    /// What the bar shows, in the words of `indicatif`; `left` is how long it will take.
    template: &'static str,
    bar: Option<ProgressBar>,
}

impl Progress {
    /// The progress of something that takes so many steps.
    pub(crate) fn new(steps: u64, template: &'static str) -> Self {
        Self { begun: Instant::now(), steps, shows: io::stderr().is_terminal(), template, bar: None }
    }

    /// Shows that so many steps are done, and the `name` of what is being done, if it has any.
    pub(crate) fn show(&mut self, done: u64, name: &str) {
        if self.bar.is_none() && self.shows && self.begun.elapsed() > PATIENCE {
            let begun = self.begun;
            let left = move |state: &ProgressState, text: &mut dyn fmt::Write| {
                if let Some(left) = left(begun.elapsed(), state.pos(), state.len()) {
                    // What cannot be shown is not.
                    let _ = write!(text, ", {:#} left", HumanDuration(left));
                }
            };
            let style = ProgressStyle::with_template(self.template).map(|style| style.with_key("left", left));
            let bar = ProgressBar::new(self.steps);
            self.bar = Some(bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar())));
        }
        if let Some(bar) = &self.bar {
            if !name.is_empty() {
                bar.set_message(name.to_owned());
            }
            bar.set_position(done);
        }
    }

    /// Says something beside it.
    pub(crate) fn say(&self, word: &str) {
        // Standard error may be gone; what is said is no result.
        let say = || drop(writeln!(io::stderr(), "carom: {word}"));
        match &self.bar {
            Some(bar) => bar.suspend(say),
            None => say(),
        }
    }
}

/// How long the steps that are left will take, if each takes as long as those that are done did on average. (The bar's own guess
/// begins with the bar, when many steps are done already.)
fn left(taken: Duration, done: u64, steps: Option<u64>) -> Option<Duration> {
    let to_do = steps?.saturating_sub(done);
    Duration::try_from_secs_f64(taken.as_secs_f64() * to_do as f64 / done as f64).ok()
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_takes_as_long_a_step_as_what_is_done() {
        let taken = Duration::from_secs(6);
        assert_eq!(left(taken, 3, Some(10)), Some(Duration::from_secs(14)));
        assert_eq!(left(taken, 10, Some(10)), Some(Duration::ZERO));
        assert_eq!(left(taken, 0, Some(10)), None);
    }
}
