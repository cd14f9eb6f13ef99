//! carom beside Rapier and Box2D: the same scenes from the same states, one table on standard output.
//!
//! `cargo run --release --manifest-path benches/peers/Cargo.toml -- [scene…] [--quick | --large]` runs all scenes where
//! none is named; `--quick` leaves out those of more than a thousand balls, `--large` adds a pile of 100,000.

mod engines;
mod measure;
mod scenes;
mod table;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;
use std::time::Instant;

use engines::{Failure, Maker};
use measure::{Figures, measure};
use scenes::{Kind, NAMES, Scene, Size};

fn main() -> ExitCode {
    let (mut names, mut size) = (Vec::new(), Size::Normal);
    for argument in std::env::args().skip(1) {
        match argument.as_str() {
            "--quick" => size = Size::Quick,
            "--large" => size = Size::Large,
            name if NAMES.contains(&name) => names.push(argument),
            _ => {
                eprintln!("there is no \"{argument}\"; choose from: {}, --quick, --large", NAMES.join(", "));
                return ExitCode::from(2);
            }
        }
    }
    let asked = |kind: &Kind| names.is_empty() || names.iter().any(|name| name == kind.name());
    println!("{}", table::HEAD);
    for kind in Kind::all(size).into_iter().filter(asked) {
        match kind.build() {
            Ok(scene) => run(&scene),
            Err(failure) => println!("{}", table::empty_row(&kind.title(), "–", &failure.to_string())),
        }
    }
    println!("\n{}", table::caption());
    ExitCode::SUCCESS
}

/// All engines on one scene, span by span in the table.
fn run(scene: &Scene) {
    let title = scene.kind.title();
    let mut rows = vec![Vec::new(); scene.spans.len()];
    for maker in Maker::all() {
        let name = maker.name();
        let start = Instant::now();
        let measured = match maker.unsuited(scene.kind) {
            Some(why) => Err(format!("not run: {why}").into()),
            None => measure_or_fail(scene, maker),
        };
        eprintln!("{title}, {name}: {:.1} s", start.elapsed().as_secs_f64());
        match measured {
            Ok(figures) => {
                for (rows, figures) in rows.iter_mut().zip(figures) {
                    rows.push(table::row(&title, &name, &figures));
                }
            }
            Err(failure) => {
                rows[0].push(table::empty_row(&title, &name, &failure.to_string()));
            }
        }
    }
    rows.iter().flatten().for_each(|row| println!("{row}"));
}

/// The figures, where the engine neither gives up nor panics.
fn measure_or_fail(scene: &Scene, maker: Maker) -> Result<Vec<Figures>, Failure> {
    // What a panic leaves behind belongs to this run alone, and goes with it.
    let measured = catch_unwind(AssertUnwindSafe(|| measure(scene, maker))).unwrap_or_else(|panic| {
        let message = panic.downcast_ref::<String>().map(String::as_str);
        let message = message.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
        Err(format!("it panicked: {message}").into())
    });
    measured.map_err(|failure| format!("gave up: {failure}").into())
}
