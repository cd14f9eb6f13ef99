//! Run times: the median of several runs, and how far they differ.

use std::time::{Duration, Instant};

/// How often a run is repeated for its time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Effort {
    /// At least so many runs ...
    pub(super) runs: usize,
    /// ... and more, until this much time has been spent ...
    pub(super) time: Duration,
    /// ... but not more than these.
    pub(super) most: usize,
    /// A run that takes longer is not repeated.
    pub(super) long: Duration,
    /// A run that takes longer is given up.
    pub(super) limit: Duration,
}

impl Effort {
    pub(super) fn full() -> Self {
        let (ms, s) = (Duration::from_millis, Duration::from_secs);
        Self { runs: 5, time: ms(100), most: 101, long: s(2), limit: s(10) }
    }

    pub(super) fn quick() -> Self {
        let ms = Duration::from_millis;
        Self { runs: 3, time: ms(10), most: 31, long: ms(150), limit: ms(600) }
    }
}

/// The times that several equal runs took, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spread {
    pub(super) median: f64,
    pub(super) least: f64,
    pub(super) most: f64,
    /// Half of the runs took a time between these.
    pub(super) quartiles: (f64, f64),
    pub(super) runs: usize,
}

impl Spread {
    /// Of times in any order; there must be one.
    pub(super) fn of(mut seconds: Vec<f64>) -> Self {
        seconds.sort_by(f64::total_cmp);
        let (runs, last) = (seconds.len(), seconds.len() - 1);
        let median = f64::midpoint(seconds[last / 2], seconds[runs / 2]);
        let quartiles = (seconds[last / 4], seconds[last - last / 4]);
        Self { median, least: seconds[0], most: seconds[last], quartiles, runs }
    }

    /// The same of something that takes a part of it.
    pub(super) fn scaled(self, by: f64) -> Self {
        let (first, third) = self.quartiles;
        let quartiles = (first * by, third * by);
        Self { median: self.median * by, least: self.least * by, most: self.most * by, quartiles, ..self }
    }
}

/// Repeats a run that returns the seconds it took, or why it was given up.
pub(super) fn repeat<E>(effort: &Effort, mut run: impl FnMut() -> Result<f64, E>) -> Result<Spread, E> {
    let begun = Instant::now();
    let mut seconds = vec![run()?];
    let enough = |seconds: &Vec<f64>| {
        seconds[0] > effort.long.as_secs_f64()
            || seconds.len() >= effort.most
            || (seconds.len() >= effort.runs && begun.elapsed() >= effort.time)
    };
    while !enough(&seconds) {
        seconds.push(run()?);
    }
    Ok(Spread::of(seconds))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_number_lies_between_the_two_in_the_middle() {
        assert_eq!(Spread::of(vec![3.0]).median, 3.0);
        let spread = Spread::of(vec![4.0, 1.0, 3.0, 2.0]);
        assert_eq!((spread.median, spread.least, spread.most, spread.runs), (2.5, 1.0, 4.0, 4));
        assert_eq!(Spread::of(vec![5.0, 1.0, 2.0]).median, 2.0);
    }

    #[test]
    fn short_runs_are_repeated_and_long_ones_are_not() {
        let effort = Effort::quick();
        assert_eq!(repeat(&effort, || Ok::<_, ()>(1.0)).map(|spread| spread.runs), Ok(1));
        assert!(repeat(&effort, || Ok::<_, ()>(1e-9)).is_ok_and(|spread| spread.runs >= effort.runs));
        assert_eq!(repeat(&effort, || Err::<f64, _>("given up")), Err("given up"));
    }
}
