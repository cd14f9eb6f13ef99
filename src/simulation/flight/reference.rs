//! Every time of flight against its true value for the very same inputs, found with 60 digits:
//! `tests/data/flight_reference.py` says how, and what a condition is.

use std::collections::BTreeMap;

use super::*;

/// The fields of a file's lines, by the names in its first line.
fn rows(text: &str) -> impl Iterator<Item = BTreeMap<&str, &str>> {
    let mut lines = text.lines();
    let names: Vec<_> = lines.next().unwrap().split(',').collect();
    lines.map(move |line| names.iter().copied().zip(line.split(',')).collect())
}

/// Of how many roundings `flight_reference.py` takes the effect: so much may move the time where it is in doubt.
const WIDTH: f64 = 8.0;

/// The largest error of a function in each case, in roundings ε·(time + condition): how far the time moves where it
/// and the terms that it comes from are rounded once.
#[derive(Default)]
struct Errors<'a>(BTreeMap<&'a str, f64>);

impl<'a> Errors<'a> {
    fn add(&mut self, row: &BTreeMap<&str, &'a str>, name: &str, found: f64) {
        let field = |suffix: &str| row[format!("{name}{suffix}").as_str()];
        let [time, condition]: [f64; 2] = ["", "_condition"].map(|suffix| field(suffix).parse().unwrap());
        let doubt = field("_sure") == "no";
        let error = if found == time || doubt && found == NEVER {
            0.0
        } else {
            // Infinite or not a number where one of the times is, or there is nothing to be wrong by.
            (found - time).abs() / (f64::EPSILON * (time + condition)) / if doubt { WIDTH } else { 1.0 }
        };
        assert!(error <= 1.0, "{name}: {found} s, not {time} s, wrong by {error} roundings: {row:?}");
        let worst = self.0.entry(row["case"]).or_default();
        *worst = worst.max(error);
    }
}

fn number(row: &BTreeMap<&str, &str>, name: &str) -> f64 {
    row[name].parse().unwrap()
}

fn vector(row: &BTreeMap<&str, &str>, x: &str, y: &str) -> DVec2 {
    DVec2::new(number(row, x), number(row, y))
}

fn pair(row: &BTreeMap<&str, &str>) -> Pair {
    let (offset, velocity) = (vector(row, "dx", "dy"), vector(row, "wx", "wy"));
    Pair { offset, velocity, reach: number(row, "reach"), own: DVec2::ZERO, slow: 0.0, dull: 0.0 }
}

#[test]
fn lines_are_reached_at_the_true_time() {
    let mut errors = Errors::default();
    for row in rows(include_str!("../../../tests/data/flight-lines.csv")) {
        let [gap, speed, acceleration] = ["gap", "speed", "acceleration"].map(|name| number(&row, name));
        errors.add(&row, "reach", reach(gap, speed, acceleration));
    }
    println!("{:#.2?}", errors.0);
}

#[test]
fn pairs_meet_and_part_at_the_true_time() {
    let (mut meet, mut part) = (Errors::default(), Errors::default());
    for row in rows(include_str!("../../../tests/data/flight-pairs.csv")) {
        meet.add(&row, "meet", pair(&row).meet());
        if !row["part"].is_empty() {
            part.add(&row, "part", pair(&row).part());
        }
    }
    println!("{:#.2?}", meet.0);
    println!("{:#.2?}", part.0);
}

#[test]
fn accelerated_pairs_meet_and_part_at_the_true_time() {
    let (mut meet, mut part) = (Errors::default(), Errors::default());
    for row in rows(include_str!("../../../tests/data/flight-accelerated.csv")) {
        let acceleration = vector(&row, "ax", "ay");
        if !row["meet"].is_empty() {
            meet.add(&row, "meet", pair(&row).meet_accelerated(acceleration, NEVER));
        }
        if !row["part"].is_empty() {
            part.add(&row, "part", pair(&row).part_accelerated(acceleration, NEVER));
        }
    }
    println!("{:#.2?}", meet.0);
    println!("{:#.2?}", part.0);
}
