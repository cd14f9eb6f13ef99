//! The table and what has to be said below it.

use std::fs;

use crate::measure::Figures;
use crate::scenes::FPS;

/// What the columns mean, and the line below them.
pub const HEAD: &str = "\
| scene | s | engine | ns per ball and frame | mean overlap | largest | energy, % | escaped | fastest, px/s | outcome |
|---|---|---|---|---|---|---|---|---|---|";

/// A row of figures.
pub fn row(scene: &str, engine: &str, figures: &Figures) -> String {
    let Figures { span, .. } = figures;
    let seconds = |frame: u32| format!("{}", (f64::from(frame) * 100.0 / f64::from(FPS)).round() / 100.0);
    let fastest = if span.settled { digits(figures.fastest) } else { "–".to_owned() };
    format!(
        "| {scene} | {}–{} | {engine} | {} | {} | {} | {} | {} | {fastest} | {} |",
        seconds(span.from),
        seconds(span.to),
        digits(figures.nanoseconds),
        digits(figures.mean_overlap),
        digits(figures.largest_overlap),
        signed(figures.energy_change),
        figures.escaped,
        figures.outcome.as_deref().unwrap_or("–"),
    )
}

/// A row without figures.
pub fn empty_row(scene: &str, engine: &str, why: &str) -> String {
    format!("| {scene} | – | {engine} | – | – | – | – | – | – | {why} |")
}

/// What is below the table.
pub fn caption() -> String {
    format!(
        "ns: one thread, the median of windows of a few frames, or of the whole span in up to fifty runs where there are few balls. Overlaps: of \
         pairs of balls that overlap, in radii of the smaller one, looked at after each window (after each frame where \
         there are few balls). Energy: change of the total, kinetic and potential, from the start to the end of the \
         span; only the gas and the bullet should keep it. Escaped: balls wholly outside the walls at the end. Fastest: \
         the largest speed at the end of spans in which all should lie still. Outcome: height of the heavy ball's \
         underside above the floor after ten seconds; how far the column's top sank; whether the bullet moved its target, \
         and its own speed after a tenth of a second (right: hit, then {:.0} px/s).\n\n\
         Frames of 1/60 s; friction 0, no sleeping. Rapier and Box2D: 50 px are 1 m, all else as by default (Box2D with 4 \
         substeps), so their speed limit is 20,000 px/s and Box2D takes no restitution below 50 px/s; in `bullet, CCD` \
         both are asked for continuous collision detection of the fast ball. Between balls of different restitution (one of \
         `demo`) Box2D takes the larger, the others the smaller.\n\n\
         carom {}, rapier2d {}, boxdd {} (Box2D {}); {}; \
         `cargo run --release --manifest-path benches/peers/Cargo.toml{}`",
        BULLET_SPEED,
        version("carom"),
        version("rapier2d"),
        version("boxdd"),
        box2d(),
        machine(),
        arguments(),
    )
}

/// Of masses as 9 to 400, head-on and elastic: v·(400 − 9)/(400 + 9).
const BULLET_SPEED: f64 = 1e5 * 391.0 / 409.0;

/// The version in the lock file that this program was built with.
fn version(package: &str) -> &'static str {
    let line = format!("name = \"{package}\"");
    let mut lines = include_str!("../Cargo.lock").lines().skip_while(|&other| other != line);
    let version = lines.nth(1).and_then(|next| next.strip_prefix("version = \""));
    version.map_or("?", |version| version.trim_end_matches('"'))
}

fn box2d() -> String {
    boxdd::version().map_or_else(|_| "?".to_owned(), |v| format!("{}.{}.{}", v.major, v.minor, v.revision))
}

fn machine() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{}, {cores} cores", model.map_or("unknown processor", |(_, model)| model))
}

/// What this run was called with.
fn arguments() -> String {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.is_empty() { String::new() } else { format!(" -- {}", arguments.join(" ")) }
}

/// About three digits, and what is far below all that matters in powers of ten.
fn digits(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if size < 5e-4 => format!("{value:.0e}"),
        size if size < 1.0 => format!("{value:.3}"),
        size if size < 100.0 => format!("{value:.1}"),
        _ => format!("{value:.0}"),
    }
}

/// A change in per cent; round-off in powers of ten.
fn signed(value: f64) -> String {
    let size = match value.abs() {
        0.0 => return "0".to_owned(),
        size if size < 0.05 => format!("{size:.0e}"),
        size => format!("{size:.1}"),
    };
    if value < 0.0 { format!("−{size}") } else { format!("+{size}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_come_from_the_lock_file() {
        for package in ["carom", "rapier2d", "boxdd"] {
            assert!(version(package).starts_with(|first: char| first.is_ascii_digit()), "{package}");
        }
        assert_eq!(version("no such package"), "?");
    }

    #[test]
    fn numbers_keep_what_matters_of_them() {
        assert_eq!(
            [0.0, 3.2e-15, 0.0912, 16.52, 3002.4].map(digits),
            ["0", "3e-15", "0.091", "16.5", "3002"]
        );
        assert_eq!([0.0, 4e-13, -99.98, 254.0].map(signed), ["0", "+4e-13", "−100.0", "+254.0"]);
    }
}
