//! Axes: where values lie on them, and what is written beside them.

use std::ops::Range;

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};

/// An axis with its label, from its lowest to its highest value.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::report) struct Axis {
    pub(super) label: &'static str,
    log: bool,
    low: f64,
    high: f64,
    /// What stands at 0, 1, … instead of numbers, where anything does.
    names: &'static [&'static str],
}

impl Axis {
    /// An axis with a name at each whole number from 0.
    pub(in crate::report) fn named(label: &'static str, names: &'static [&'static str]) -> Self {
        Self { label, log: false, low: 0.0, high: names.len() as f64 - 1.0, names }
    }

    /// A logarithmic axis of whole decades that holds all of these values but those that are not positive.
    pub(in crate::report) fn log(label: &'static str, values: impl IntoIterator<Item = f64>) -> Self {
        let positive = values.into_iter().filter(|&value| value > 0.0 && value.is_finite());
        let (low, high) =
            positive.fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
        let (low, high) = if low <= high { (low.log10().floor(), high.log10().ceil()) } else { (0.0, 1.0) };
        Self { label, log: true, low, high: high.max(low + 1.0), names: &[] }
    }

    /// A linear axis between two values.
    pub(in crate::report) fn linear(label: &'static str, (low, high): (f64, f64)) -> Self {
        Self { label, log: false, low, high, names: &[] }
    }

    /// Whether names stand at it instead of numbers.
    pub(super) fn is_named(&self) -> bool {
        !self.names.is_empty()
    }

    /// The axis as the plotting library takes it, which is told places.
    pub(super) fn places(&self) -> Places {
        Places { ends: self.ends(), ticks: self.ticks() }
    }

    /// Where its ends are drawn.
    pub(super) fn ends(&self) -> (f64, f64) {
        // Marks at the ends are not cut off.
        let margin = 0.02 * (self.high - self.low);
        (self.low - margin, self.high + margin)
    }

    /// Where a value is drawn; what is less than a logarithmic axis shows, zero too, at its lower end.
    pub(super) fn place(&self, value: f64) -> f64 {
        let place = if self.log { value.max(f64::MIN_POSITIVE).log10() } else { value };
        place.clamp(self.low, self.high)
    }

    /// Places with a line and a number.
    pub(super) fn ticks(&self) -> Vec<f64> {
        let span = self.high - self.low;
        if self.is_named() {
            return (0..self.names.len()).map(|place| place as f64).collect();
        }
        let least = if self.log { 1.0 } else { 0.0 };
        let steps = [1.0, 2.0, 3.0, 4.0, 5.0, 10.0, 20.0, 50.0, 100.0];
        let step = steps.into_iter().find(|&step| step >= least && span / step <= 9.0).unwrap_or(span / 8.0);
        let (first, last) = ((self.low / step).ceil() as i64, (self.high / step).floor() as i64);
        (first..=last).map(|tick| tick as f64 * step).collect()
    }

    /// The number at a tick, and the exponent that it is raised to, if any.
    pub(super) fn number(&self, place: f64) -> (String, String) {
        if let Some(name) = self.names.get(place.round() as usize) {
            return ((*name).to_owned(), String::new());
        }
        if !self.log {
            return (format!("{place}"), String::new());
        }
        ("10".to_owned(), format!("{}", place.round()).replace('-', "−"))
    }
}

/// An axis with its places counted evenly from end to end.
#[derive(Debug, Clone)]
pub(super) struct Places {
    ends: (f64, f64),
    ticks: Vec<f64>,
}

impl Ranged for Places {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, &place: &f64, (first, last): (i32, i32)) -> i32 {
        let share = (place - self.ends.0) / (self.ends.1 - self.ends.0);
        first + (share * f64::from(last - first)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        // Light lines between those with numbers would be too many.
        if hint.weight().allow_light_points() { Vec::new() } else { self.ticks.clone() }
    }

    fn range(&self) -> Range<f64> {
        self.ends.0..self.ends.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_logarithmic_axis_has_whole_decades() {
        let axis = Axis::log("t", [3e-4, 0.0, 2.0]);
        assert_eq!(axis.ticks(), [-4.0, -3.0, -2.0, -1.0, 0.0, 1.0]);
        assert_eq!(axis.number(-4.0), ("10".to_owned(), "−4".to_owned()));
        assert_eq!(axis.place(0.0), -4.0);
        assert_eq!(axis.place(100.0), 1.0);
        assert_eq!(Axis::log("t", [0.0]).ticks(), [0.0, 1.0]);
        assert!(Axis::log("t", [1e-16, 1e3]).ticks().len() <= 10);
    }

    #[test]
    fn a_linear_axis_counts() {
        let axis = Axis::linear("t", (0.0, 10.0));
        assert_eq!(axis.ticks(), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!(axis.number(2.0), ("2".to_owned(), String::new()));
    }
}
