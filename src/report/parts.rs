//! What a scene leaves out, and what each part of a solver costs where it runs.
//!
//! A scene's balls are run with nothing but motion, and then with one part after the other until all of the scene's own
//! run: what each adds is its cost, and what a scene does not ask for is never run.

use std::time::Instant;

use super::chart::{Axis, Curve, Dot, Figure, Panel, Style};
use super::document::{Csv, Section, Table, rounded};
use super::problems::{Unposed, demo};
use super::timing::{Spread, repeat};
use super::{Context, ReportError};
use crate::simulation::limits::OutOfRange;
use crate::simulation::{Ball, BuildError, Pairs, Simulation, Solver, World};

/// The demo's stages, and scenes of more balls.
const SCENES: [&str; 11] =
    ["draw", "move", "two", "detect", "walls", "elastic", "inelastic", "gravity", "bullet", "gas", "pile"];
/// How long a run is, in frames times balls ...
const BALL_FRAMES: usize = 60_000;
/// ... and in frames, at most.
const MOST_FRAMES: usize = 600;
/// The delta of a frame, s.
const FRAME: f64 = 1.0 / 60.0;

/// Parts that are switched on one after the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    Motion,
    Gravity,
    Walls,
    Detect,
    Impulse,
}

impl Stage {
    const ALL: [Self; 5] = [Self::Motion, Self::Gravity, Self::Walls, Self::Detect, Self::Impulse];

    fn name(self) -> &'static str {
        match self {
            Self::Motion => "motion alone",
            Self::Gravity => "+ gravity",
            Self::Walls => "+ walls",
            Self::Detect => "+ pairs found",
            Self::Impulse => "+ impulses",
        }
    }

    /// Whether a world asks for it.
    fn is_in(self, world: &World) -> bool {
        match self {
            Self::Motion => true,
            Self::Gravity => world.gravity().is_some(),
            Self::Walls => world.walls().is_some(),
            Self::Detect => world.pairs().is_some(),
            Self::Impulse => world.pairs() == Some(Pairs::Impulse),
        }
    }
}

/// A world with no more than the parts up to `last`.
fn reduced(world: &World, last: Stage) -> Result<World, OutOfRange> {
    let mut reduced = World::new(world.size())?;
    let runs = |stage: Stage| stage as usize <= last as usize && stage.is_in(world);
    if let Some(gravity) = world.gravity().filter(|_| runs(Stage::Gravity)) {
        reduced = reduced.with_gravity(gravity)?;
    }
    if let Some(restitution) = world.walls().filter(|_| runs(Stage::Walls)) {
        reduced = reduced.with_walls(restitution)?;
    }
    Ok(if runs(Stage::Impulse) {
        reduced.with_pairs(Pairs::Impulse)
    } else if runs(Stage::Detect) {
        reduced.with_pairs(Pairs::Detect)
    } else {
        reduced
    })
}

/// What a run with some of a scene's parts costs.
struct Cost {
    stage: Stage,
    /// ns for a ball and a frame; why there is none, where there is none.
    nanoseconds: Result<Spread, String>,
    /// The parts that say they run.
    parts: Vec<String>,
}

/// The frames of a run of so many balls.
fn frames(balls: usize) -> usize {
    (BALL_FRAMES / balls.max(1)).clamp(10, MOST_FRAMES)
}

/// The seconds that the frames of one run take.
fn seconds(world: &World, balls: &[Ball], solver: Solver, context: &Context) -> Result<f64, String> {
    let mut simulation =
        Simulation::new(*world, balls.to_vec(), solver).map_err(|error: BuildError| error.to_string())?;
    let frames = frames(balls.len());
    let begun = Instant::now();
    for frame in 0..frames {
        let mut looks = 0_u32;
        let go_on = || {
            looks += 1;
            !looks.is_multiple_of(64) || begun.elapsed() < context.effort.limit
        };
        let done = simulation.advance_while(FRAME, go_on).map_err(|error| error.to_string())?;
        if done < FRAME {
            return Err(format!(
                "{frame} of {frames} frames in {} s",
                rounded(context.effort.limit.as_secs_f64())
            ));
        }
    }
    Ok(begun.elapsed().as_secs_f64())
}

fn costs(scene: &str, solver: Solver, context: &Context) -> Result<Vec<Cost>, Unposed> {
    let (world, balls) = demo(scene)?;
    let mut costs = Vec::new();
    for stage in Stage::ALL.into_iter().filter(|stage| stage.is_in(&world)) {
        let reduced = reduced(&world, stage)?;
        let parts = Simulation::new(reduced, balls.clone(), solver).map(|simulation| simulation.parts());
        let parts = parts.unwrap_or_default().iter().map(ToString::to_string).collect();
        let scale = 1e9 / (balls.len().max(1) * frames(balls.len())) as f64;
        let spread = repeat(&context.effort, || seconds(&reduced, &balls, solver, context));
        costs.push(Cost { stage, nanoseconds: spread.map(|spread| spread.scaled(scale)), parts });
    }
    Ok(costs)
}

/// How many steps of the progress bar this takes.
pub(super) fn steps() -> usize {
    SCENES.len() * Solver::ALL.len()
}

/// The section of the report.
pub(super) fn section(context: &mut Context) -> Result<Section, ReportError> {
    let mut section = Section::default();
    section.heading("What a scene leaves out");
    section.say(
        "The balls of each scene, first with nothing but motion (the floor: what cannot be left out), then with one part \
         of the scene after the other, in ns per ball and frame at 60 frames a second, from the scene's start: medians of \
         several runs. A dash means that the scene does not ask for the part, so that it does not run and costs nothing. \
         Parts change what happens, not only what is computed: with walls balls stay and meet, and what foresees impacts \
         works for each of them, so that a part may also make others cheaper. The last column is what the solver says \
         that it runs with all of them.",
    );
    let mut header = vec!["scene", "balls", "solver"];
    header.extend(Stage::ALL.map(Stage::name));
    header.extend(["all over floor", "runs"]);
    let mut table = Table::new(&header);
    let mut csv = Csv::new("scene,balls,solver,part,ns_per_ball_frame,least,most,runs,outcome");
    let mut all = Vec::new();
    for scene in SCENES {
        let count = demo(scene)?.1.len();
        for &solver in Solver::ALL {
            context.progress.step(scene);
            let costs = costs(scene, solver, context)?;
            table.row(row(scene, count, solver, &costs));
            for Cost { stage, nanoseconds, .. } in &costs {
                let name = stage.name();
                match nanoseconds {
                    Ok(Spread { median, least, most, runs, .. }) => {
                        csv.row(&[&scene, &count, &solver, &name, median, least, most, runs, &"done"]);
                    }
                    Err(why) => {
                        csv.row(&[&scene, &count, &solver, &name, &"", &"", &"", &"", why]);
                        section.failures.push(format!("{scene}: `{solver}`, {name}: {why}."));
                    }
                }
            }
            all.push((scene, solver, costs));
        }
    }
    section.say(table.markdown());
    section.in_short.extend(in_short(&all));
    let figure = figure(&all);
    section.picture(&figure.name, &caption(&all));
    section.files.extend(figure.files()?);
    section.files.push(csv.file("parts.csv"));
    Ok(section)
}

/// What the figure shows, and which of its marks are not there.
fn caption(all: &[(&str, Solver, Vec<Cost>)]) -> String {
    let mut text = "Cost of a scene with all of its parts: the demo's stages, each of which adds an idea to those before, and \
                    three other scenes."
        .to_owned();
    for (scene, solver, costs) in all {
        if let Some(Cost { nanoseconds: Err(why), .. }) = costs.last() {
            text += &format!(" `{solver}` has no mark for `{scene}`, where it was given up: {why}.");
        }
    }
    text
}

/// What all parts of the demo's last stage cost, beside its floor.
fn in_short(all: &[(&str, Solver, Vec<Cost>)]) -> Option<String> {
    let median = |cost: &Cost| Some(cost.nanoseconds.as_ref().ok()?.median);
    let own: Vec<_> = all.iter().filter(|(scene, ..)| *scene == "gravity").collect();
    let floor = own.iter().filter_map(|(.., costs)| median(costs.first()?)).min_by(f64::total_cmp)?;
    let costs = own.iter().filter_map(|(_, solver, costs)| {
        Some(format!("{} ns with `{solver}`", rounded(median(costs.last()?)?)))
    });
    let costs: Vec<String> = costs.collect();
    Some(format!(
        "A ball and frame of the demo's `gravity` costs {}; only moved, {} ns.",
        costs.join(", "),
        rounded(floor)
    ))
}

fn row(scene: &str, count: usize, solver: Solver, costs: &[Cost]) -> Vec<String> {
    let mut cells = vec![scene.to_owned(), count.to_string(), solver.to_string()];
    for stage in Stage::ALL {
        let cost = costs.iter().find(|cost| cost.stage == stage);
        cells.push(cost.map_or_else(
            || "–".to_owned(),
            |cost| cost.nanoseconds.as_ref().map_or_else(Clone::clone, |spread| rounded(spread.median)),
        ));
    }
    let median = |cost: Option<&Cost>| cost.and_then(|cost| Some(cost.nanoseconds.as_ref().ok()?.median));
    let (floor, whole) = (median(costs.first()), median(costs.last()));
    cells.push(
        floor
            .zip(whole)
            .map_or_else(|| "–".to_owned(), |(floor, whole)| format!("{}×", rounded(whole / floor))),
    );
    cells.push(costs.last().map_or_else(String::new, |cost| cost.parts.join(", ")));
    cells
}

/// The cost of each scene, and the floor below it.
fn figure(all: &[(&str, Solver, Vec<Cost>)]) -> Figure {
    let median = |cost: Option<&Cost>| cost.and_then(|cost| Some(cost.nanoseconds.as_ref().ok()?.median));
    let place = |scene: &str| SCENES.iter().position(|name| *name == scene).map_or(0.0, |index| index as f64);
    let mut curves = Vec::new();
    for &solver in Solver::ALL {
        let own = || all.iter().filter(|(_, of, _)| *of == solver);
        let dots = |pick: fn(&[Cost]) -> Option<&Cost>| {
            let dots =
                own().filter_map(|(scene, _, costs)| Some(Dot::at(place(scene), median(pick(costs))?)));
            dots.collect::<Vec<Dot>>()
        };
        curves.push(Curve {
            label: solver.name().to_owned(),
            style: Style::of(solver),
            dots: dots(<[Cost]>::last),
            marked: 1,
            lined: false,
        });
        if solver == Solver::Canvas {
            let (label, style) = ("only moved, by canvas".to_owned(), Style::plain(Some((2, 3))));
            curves.push(Curve { label, style, dots: dots(<[Cost]>::first), marked: 1, lined: true });
        }
    }
    let values: Vec<f64> = curves.iter().flat_map(|curve| curve.dots.iter().map(|dot| dot.y)).collect();
    let panel = Panel {
        title: "Cost of a scene".to_owned(),
        x: Axis::named("", &SCENES),
        y: Axis::log("ns per ball and frame", values),
        curves,
        guides: Vec::new(),
        note: String::new(),
    };
    Figure { name: "parts".to_owned(), columns: 1, panels: vec![panel] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mark_that_is_not_there_is_spoken_of() {
        let cost = |nanoseconds| vec![Cost { stage: Stage::Motion, nanoseconds, parts: Vec::new() }];
        let spread = repeat(&Context::quick().effort, || Ok::<f64, String>(1.0)).unwrap();
        let late = Err("3 of 30 frames in 0.30 s".to_owned());
        let text = caption(&[("gas", Solver::Exact, cost(Ok(spread))), ("pile", Solver::Exact, cost(late))]);
        assert!(
            text.ends_with(
                "`exact` has no mark for `pile`, where it was given up: 3 of 30 frames in 0.30 s."
            ),
            "{text}"
        );
        assert!(!text.contains("`gas`"), "{text}");
    }

    #[test]
    fn what_a_scene_does_not_ask_for_does_not_run() {
        let context = Context::quick();
        for (scene, runs) in [
            ("move", vec!["motion"]),
            ("detect", vec!["motion", "all pairs"]),
            ("walls", vec!["motion", "walls", "all pairs"]),
            ("gravity", vec!["motion", "gravity", "walls", "all pairs", "impulse"]),
        ] {
            let costs = costs(scene, Solver::Canvas, &context).unwrap();
            assert_eq!(costs[0].parts, ["motion"], "{scene}");
            assert_eq!(costs.last().unwrap().parts, runs, "{scene}");
            assert!(costs.iter().all(|cost| cost.nanoseconds.is_ok()));
        }
    }
}
