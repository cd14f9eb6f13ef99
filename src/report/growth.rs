//! How errors grow with time: for how long a trajectory means anything.

use std::time::Duration;

use super::chart::{Axis, Curve, Dot, Figure, Panel, Style};
use super::document::{Csv, Section, Table, rounded};
use super::problems::{demo, farthest, growth_scenes};
use super::reference::{Collapse, Quad, Real, Reference};
use super::setting::{LOOKS, Setting, looks};
use super::{Context, ReportError};
use crate::simulation::{Ball, World};

/// How long errors are followed, s.
const SECONDS: f64 = 10.0;
/// A ball that is so far from where it should be, px, is somewhere else.
const LOST: f64 = 1.0;
/// The smallest and the largest error that are drawn, px.
const DRAWN: (f64, f64) = (1e-16, 1e3);
/// What one ball is moved by to see how chaos makes it grow, px: far below the last digit of an f64.
const NUDGE: f64 = 1e-28;

/// The errors of one run at each look.
struct Growth {
    label: String,
    style: Style,
    errors: Vec<(f64, f64)>,
}

impl Growth {
    /// When its balls are lost for good, s.
    fn lost(&self) -> Option<f64> {
        self.errors.iter().find(|(_, error)| *error > LOST).map(|(time, _)| *time)
    }
}

/// The runs that are followed: each solver as it is used, and at the end of its ladder.
fn settings() -> [Setting; 5] {
    [
        Setting::Frames(60),
        Setting::Frames(7680),
        Setting::OwnSubsteps,
        Setting::Substeps(7680),
        Setting::RestSpeed(1.0),
    ]
}

/// How many steps of the progress bar this takes.
pub(super) fn steps() -> usize {
    growth_scenes().count()
}

/// The reference, for as long as there is one: its states at each look.
fn reference_run<R: Real>(
    world: &World,
    balls: &[Ball],
    nudge: f64,
) -> (Vec<(f64, Reference<R>)>, Option<Collapse>) {
    let mut run = Reference::<R>::new(world, balls);
    run.nudge(0, nudge);
    let mut states = Vec::new();
    for time in looks(SECONDS) {
        match run.advance_to(time) {
            Ok(()) => states.push((time, run.clone())),
            Err(collapse) => return (states, Some(collapse)),
        }
    }
    (states, None)
}

/// All runs of a scene against its reference, and when the reference ends.
fn follow(world: &World, balls: &[Ball], limit: Duration) -> (Vec<Growth>, Option<Collapse>) {
    let (truth, collapse) = reference_run::<Quad>(world, balls, 0.0);
    let places: Vec<Vec<_>> = truth.iter().map(|(_, run)| run.positions()).collect();
    let mut growths = Vec::new();
    for setting in settings() {
        let (mut errors, mut look) = (Vec::new(), 0);
        // A run that is given up has errors up to there.
        let _ = setting.watch(world, balls, SECONDS, limit, |time, simulation| {
            if let Some(places) = places.get(look) {
                let pairs = simulation.balls().iter().zip(places);
                errors.push((time, farthest(pairs.map(|(ball, place)| ball.position().distance(*place)))));
            }
            look += 1;
        });
        let mut style = Style::of(setting.solver());
        if matches!(setting, Setting::Frames(7680) | Setting::Substeps(7680)) {
            style.dash = None;
        }
        growths.push(Growth { label: format!("{}, {setting}", setting.solver()), style, errors });
    }
    let (plain, _) = reference_run::<f64>(world, balls, 0.0);
    let errors = plain.iter().zip(&places).map(|((time, run), places)| {
        (*time, farthest(run.positions().into_iter().zip(places).map(|(a, b)| a.distance(*b))))
    });
    let label = "the reference's method in f64".to_owned();
    growths.push(Growth { label, style: Style::plain(Some((2, 3))), errors: errors.collect() });
    let (nudged, _) = reference_run::<Quad>(world, balls, NUDGE);
    // What a nudge grows to is proportional to it, until it is no longer small: this is what one of an f64 would be.
    let scale = f64::EPSILON * 100.0 / NUDGE;
    let errors = nudged
        .iter()
        .zip(&truth)
        .map(|((time, run), (_, truth))| (*time, (scale * farthest(run.distances(truth))).min(DRAWN.1)));
    let label = "what chaos makes of one rounding".to_owned();
    growths.push(Growth { label, style: Style::plain(Some((8, 5))), errors: errors.collect() });
    (growths, collapse)
}

/// The section of the report.
pub(super) fn section(context: &mut Context) -> Result<Section, ReportError> {
    let mut section = Section::default();
    section.heading("How errors grow");
    section.say(format!(
        "The demo's balls are chaotic: whatever moves one of them is multiplied at each impact. The reference is a \
         plain event-driven run (all pairs, nothing kept between impacts, no code of `exact`) with twice the digits of \
         an f64, which agrees with trajectories of 60 digits to 10⁻²¹ px. The same method in f64 shows for how long an \
         f64 can be trusted, whoever computes with it; and a ball that is moved by {NUDGE:e} px shows, scaled to the \
         last digit of an f64 at 100 px, what no method with such numbers gets below. A time is given when a ball is \
         {LOST} px from where it should be.",
    ));
    let mut csv = Csv::new("scene,run,time_s,error_px");
    let mut panels = Vec::new();
    let mut table = Table::new(&["scene", "run", "error at 1 s, px", "at 2 s", "at 4 s", "lost at, s"]);
    let mut ends = String::new();
    for scene in growth_scenes() {
        context.progress.step(scene);
        let (world, balls) = demo(scene)?;
        let (growths, collapse) = follow(&world, &balls, context.effort.limit);
        for growth in &growths {
            for (time, error) in &growth.errors {
                csv.row(&[&scene, &growth.label, time, error]);
            }
            let at = |wanted: f64| {
                let found = growth.errors.iter().find(|(time, _)| (time - wanted).abs() < 1e-6);
                found.map_or_else(|| "–".to_owned(), |(_, error)| rounded(*error))
            };
            let last = growth.errors.last().map_or(0.0, |(time, _)| *time);
            let lost = growth.lost().map_or_else(|| format!("not by {last:.1}"), |time| format!("{time:.2}"));
            table.row(vec![scene.to_owned(), growth.label.clone(), at(1.0), at(2.0), at(4.0), lost]);
        }
        if let Some(Collapse(time)) = collapse {
            ends += &format!(
                "In `{scene}` balls come to lie on each other at {time:.2} s, after infinitely many impacts: no \
                 event-driven run goes on from there without a rule of its own, and the reference ends. "
            );
        }
        let curves = growths.iter().map(|growth| Curve {
            label: growth.label.clone(),
            style: growth.style,
            dots: growth.errors.iter().map(|&(time, error)| Dot::at(time, error)).collect(),
            marked: LOOKS as usize,
            lined: true,
        });
        panels.push(Panel {
            title: format!("The demo's {scene}"),
            x: Axis::linear("simulated time, s", (0.0, SECONDS)),
            y: Axis::log("error, px", [DRAWN.0, DRAWN.1]),
            curves: curves.collect(),
            guides: Vec::new(),
            note: collapse
                .map_or_else(String::new, |Collapse(time)| format!("reference ends at {time:.2} s")),
        });
    }
    section.say(table.markdown());
    if !ends.is_empty() {
        section.say(ends.trim_end());
    }
    let figure = Figure { name: "growth".to_owned(), columns: 2, panels };
    section.picture(&figure.name, "How the error grows with simulated time.");
    section.files.extend(figure.files()?);
    section.files.push(csv.file("growth.csv"));
    Ok(section)
}
