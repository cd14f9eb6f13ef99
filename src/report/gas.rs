//! A gas, measured by its statistics: no trajectory of it means anything after a few seconds.

use std::f64::consts::PI;

use super::chart::{Dot, Figure, Guide, Panel};
use super::document::{Csv, Section, Table, duration, rounded};
use super::problems::Unposed;
use super::setting::{GivenUp, Setting};
use super::timing::{Spread, repeat};
use super::{Context, ReportError};
use crate::scene::Scene;
use crate::simulation::invariants::kinetic_energy;
use crate::simulation::{Ball, Simulation, World};

/// How many balls.
const COUNT: usize = 500;
/// Their radius, px.
const RADIUS: f64 = 3.0;
/// The part of the area that they cover.
const ETA: f64 = 0.3;
/// The compressibility of hard discs at that density (Clisby & `McCoy` 2006).
const PUBLISHED: f64 = 2.0633;
/// How long the gas runs before it is measured, s.
const WARM_UP: f64 = 5.0;
/// Every so many looks, speeds are collected.
const LOOKS_PER_SPEEDS: usize = 6;

/// What a gas came to.
#[derive(Debug, Clone, Copy)]
struct Statistics {
    /// By which part its energy changed.
    energy: f64,
    /// Its compressibility, from the hits on the walls.
    compressibility: f64,
    /// How far the distribution of its speeds is from Maxwell's at most (Kolmogorov and Smirnov).
    speeds: f64,
    /// The run times.
    times: Spread,
}

/// The gas at the start of each run: in equilibrium, by `exact`.
fn start() -> Result<(World, Vec<Ball>), Unposed> {
    let wrong = |error: &dyn std::fmt::Display| Unposed::Scene(error.to_string());
    let side = (COUNT as f64 * PI * RADIUS * RADIUS / ETA).sqrt().round();
    let text = format!(
        "solver = \"exact\"\nsize = [{side}, {side}]\n[walls]\n[pairs]\n[[fill]]\ncount = {COUNT}\n\
         radius = {RADIUS}\nspeed = 200\nmass = 1\n"
    );
    let scene = Scene::parse("gas", &text).map_err(|error| wrong(&error))?;
    let mut simulation = scene.build().map_err(|error| wrong(&error))?;
    simulation.advance(WARM_UP).map_err(|error| wrong(&error))?;
    Ok((*simulation.world(), simulation.balls().to_vec()))
}

/// How long a gas is measured, s.
fn seconds(quick: bool) -> f64 {
    if quick { 2.0 } else { 30.0 }
}

/// Z = PA/NkT from the hits on the four walls. A ball of a Maxwellian gas brings √(2πmkT) to a wall on average, so h
/// hits a second push each with F = h√(2πmkT)/4; by the virial theorem F·(L − 2r) = NkT·Z; and between walls Z is
/// larger than in an endless gas by the factor 1 + 2rη/L (scaled particle theory; Helfand, Frisch & Lebowitz 1961).
fn compressibility(simulation: &Simulation) -> f64 {
    let (balls, side) = (simulation.balls(), simulation.world().size().x);
    let kt = kinetic_energy(balls) / balls.len() as f64;
    let hits = simulation.tally().wall_hits as f64 / simulation.time();
    let measured = hits * (2.0 * PI * kt).sqrt() / 4.0 * (side - 2.0 * RADIUS) / (balls.len() as f64 * kt);
    measured / (1.0 + 2.0 * RADIUS * ETA / side)
}

/// The largest distance between the distribution of these speeds and Maxwell's, 1 − exp(−v²/⟨v²⟩).
fn from_maxwell(mut squares: Vec<f64>) -> f64 {
    squares.sort_by(f64::total_cmp);
    let count = squares.len() as f64;
    let mean = squares.iter().sum::<f64>() / count;
    let distances = squares.iter().enumerate().map(|(index, square)| {
        let law = 1.0 - (-square / mean).exp();
        (law - index as f64 / count).abs().max((law - (index + 1) as f64 / count).abs())
    });
    distances.fold(0.0, f64::max)
}

fn measure(
    world: &World,
    balls: &[Ball],
    setting: Setting,
    context: &Context,
) -> Result<Statistics, GivenUp> {
    let seconds = seconds(context.quick);
    let (mut squares, mut looks) = (Vec::new(), 0);
    let last = setting.watch(world, balls, seconds, context.effort.limit, |_, simulation| {
        looks += 1;
        if looks % LOOKS_PER_SPEEDS == 0 {
            squares.extend(simulation.balls().iter().map(|ball| ball.velocity().length_squared()));
        }
    })?;
    let times = repeat(&context.effort, || setting.time(world, balls, seconds, context.effort.limit))?;
    Ok(Statistics {
        energy: (kinetic_energy(last.balls()) / kinetic_energy(balls) - 1.0).abs(),
        compressibility: compressibility(&last),
        speeds: from_maxwell(squares),
        times,
    })
}

/// The settings that are run: all of a ladder, up to what a gas needs.
fn settings() -> Vec<Setting> {
    let all = Setting::all(false).into_iter();
    all.filter(|setting| match setting {
        Setting::Frames(_) | Setting::OwnSubsteps => true,
        Setting::Substeps(rate) => *rate <= 1920,
        // Nothing comes to rest: all rest speeds are one.
        Setting::RestSpeed(speed) => *speed == 1.0,
    })
    .collect()
}

/// How many steps of the progress bar this takes.
pub(super) fn steps() -> usize {
    settings().len()
}

/// The section of the report.
pub(super) fn section(context: &mut Context) -> Result<Section, ReportError> {
    let (world, balls) = start()?;
    let mut section = Section::default();
    // About 1100 hits a second.
    let chance = (1100.0 * seconds(context.quick)).sqrt().recip();
    section.heading("A gas, by its statistics");
    section.say(format!(
        "{COUNT} elastic balls of radius {RADIUS} px cover {ETA} of a box and have come to equilibrium; each run goes on \
         from there for {} s. Energy must not change except by rounding. The compressibility Z = PA/NkT, from the hits on the walls, must be \
         {PUBLISHED} (Clisby & McCoy 2006), and speeds must be Maxwell's; the runs are so short that chance alone moves \
         both: the pressure by about {} %, which is the root of the number of hits. `canvas` lets balls overlap, which takes room away from \
         none of them: its pressure is too low where frames are long.",
        seconds(context.quick),
        rounded(100.0 * chance),
    ));
    let mut csv = Csv::new(
        "solver,quantity,setting,energy_change,compressibility,published,speeds_off,seconds_median,runs,outcome",
    );
    let mut table =
        Table::new(&["solver", "setting", "energy changed by", "Z", "off by", "speeds off by", "run time"]);
    let mut found = Vec::new();
    for setting in settings() {
        context.progress.step("gas");
        let (solver, quantity, size) = (setting.solver(), setting.quantity(), setting.written_size());
        match measure(&world, &balls, setting, context) {
            Ok(statistics) => {
                let Statistics { energy, compressibility, speeds, times } = statistics;
                let off = compressibility / PUBLISHED - 1.0;
                table.row(vec![
                    solver.to_string(),
                    setting.to_string(),
                    rounded(energy),
                    format!("{compressibility:.3}"),
                    format!("{:+.1} %", 100.0 * off),
                    rounded(speeds),
                    duration(times.median),
                ]);
                csv.row(&[
                    &solver,
                    &quantity,
                    &size,
                    &energy,
                    &compressibility,
                    &PUBLISHED,
                    &speeds,
                    &times.median,
                    &times.runs,
                    &"done",
                ]);
                found.push((setting, statistics));
            }
            Err(why) => {
                csv.row(&[&solver, &quantity, &size, &"", &"", &PUBLISHED, &"", &"", &"", &why]);
                section.failures.push(format!("gas: `{solver}` with {setting}: {why}."));
            }
        }
    }
    section.say(table.markdown());
    let used = found.iter().filter(|(setting, _)| setting.is_default());
    section.in_short.extend(used.map(|(setting, statistics)| {
        let off = in_words(statistics.compressibility / PUBLISHED - 1.0);
        format!(
            "The pressure of a gas is {off} with `{}`, {setting}; chance alone moves it by about {} %.",
            setting.solver(),
            rounded(100.0 * chance)
        )
    }));
    let figure = figure(&found, chance);
    let about = format!(
        "A gas: error of its pressure against run time. What is below {}, the grey line, is chance.",
        rounded(chance)
    );
    section.picture(&figure.name, &about);
    section.files.extend(figure.files()?);
    section.files.push(csv.file("gas.csv"));
    Ok(section)
}

/// How far off a quantity is, a part of it, as people say it.
fn in_words(off: f64) -> String {
    format!("{:.1} % too {}", 100.0 * off.abs(), if off < 0.0 { "low" } else { "high" })
}

/// The errors of the pressure, with the line below which chance alone makes them.
fn figure(found: &[(Setting, Statistics)], chance: f64) -> Figure {
    let mut panel =
        Panel::of_solvers("A gas: its pressure", "relative error of Z", String::new(), |solver| {
            let own = found.iter().filter(|(setting, _)| setting.solver() == solver);
            let dot = |(setting, statistics): &(Setting, Statistics)| Dot {
                spread: Some(statistics.times.quartiles),
                ..setting.dot(
                    statistics.times.median,
                    (statistics.compressibility / PUBLISHED - 1.0).abs().max(1e-4),
                )
            };
            own.map(dot).collect()
        });
    if let Some((_, statistics)) = found.first() {
        let through = (statistics.times.median, chance);
        panel.guides.push(Guide { label: "chance".to_owned(), through, slope: 0.0 });
    }
    Figure { name: "gas".to_owned(), columns: 1, panels: vec![panel] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gas_that_exact_moves_has_the_pressure_and_the_speeds_of_the_textbooks() {
        let (world, balls) = start().unwrap();
        let statistics = measure(&world, &balls, Setting::RestSpeed(1.0), &Context::quick()).unwrap();
        assert!(statistics.energy < 1e-12);
        assert!((statistics.compressibility / PUBLISHED - 1.0).abs() < 0.05, "{statistics:?}");
        assert!(statistics.speeds < 0.05, "{statistics:?}");
    }

    #[test]
    fn a_pressure_is_too_low_or_too_high() {
        assert_eq!(in_words(-0.335), "33.5 % too low");
        assert_eq!(in_words(0.027), "2.7 % too high");
    }

    #[test]
    fn the_distance_from_maxwell_is_small_for_his_speeds_and_large_for_equal_ones() {
        let count = 10_000;
        let maxwell = (0..count).map(|k| -(1.0 - (f64::from(k) + 0.5) / f64::from(count)).ln()).collect();
        assert!(from_maxwell(maxwell) < 1e-3);
        assert!(from_maxwell(vec![1.0; 100]) > 0.5);
    }
}
