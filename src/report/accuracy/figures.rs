//! The work-precision diagrams.

use super::{Measured, Point};
use crate::report::chart::{Dot, Figure, Guide, Panel, given_up};
use crate::report::problems::Problem;
use crate::simulation::Solver;

/// Errors below this are drawn at it, 0 among them, px.
const LEAST_ERROR: f64 = 1e-14;
/// How many panels of a figure stand beside each other, where there are as many.
const COLUMNS: usize = 2;

/// The problems of the diagram that stands for all.
const MAIN: [&str; 4] = ["drop", "oblique", "elastic-1s", "gravity-1s"];

/// That diagram, where all of its problems were measured.
pub(super) fn main(measured: &[(&Problem, Vec<Point>)]) -> Option<Figure> {
    let find = |name: &&str| measured.iter().find(|(problem, _)| problem.name == *name);
    let chosen: Option<Vec<_>> = MAIN.iter().map(find).collect();
    let panels = chosen?.into_iter().map(|(problem, points)| panel(problem, points, true)).collect();
    Some(Figure { name: "main".to_owned(), columns: COLUMNS, panels })
}

/// The diagrams of these problems: of errors at the end, or over the whole run.
pub(super) fn all(name: String, group: &[&(&Problem, Vec<Point>)], at_end: bool) -> Figure {
    let panels: Vec<Panel> = group.iter().map(|(problem, points)| panel(problem, points, at_end)).collect();
    Figure { name, columns: COLUMNS.min(panels.len()), panels }
}

/// A solver's points.
fn own(points: &[Point], solver: Solver) -> impl Iterator<Item = &Point> {
    points.iter().filter(move |point| point.setting.solver() == solver)
}

/// A solver's points, as far as they can be drawn.
fn dots(points: &[Point], solver: Solver, at_end: bool) -> Vec<Dot> {
    own(points, solver)
        .filter_map(|point| Some((point.setting, point.outcome.as_ref().ok()?)))
        .filter(|(_, measured)| measured.run.is_finite())
        .map(|(setting, Measured { end, run, times, .. })| Dot {
            spread: Some(times.quartiles),
            ..setting.dot(times.median, if at_end { *end } else { *run }.max(LEAST_ERROR))
        })
        .collect()
}

fn panel(problem: &Problem, points: &[Point], at_end: bool) -> Panel {
    let dots = |solver| dots(points, solver, at_end);
    let note = given_up(|solver| own(points, solver).count() - dots(solver).len());
    let panel = Panel::of_solvers(problem.title, "error, px", note, dots);
    // Steps are coarsest at the first point of `canvas`: guides begin there.
    // Where that is right by chance, they would say nothing.
    let first = panel.curves[0].dots.first().filter(|dot| dot.y > 1e3 * LEAST_ERROR);
    let through = first.map(|dot| (dot.x, dot.y));
    let guide = |order: i32| {
        let label = format!("order {order}");
        through.map(|through| Guide { label, through, slope: -f64::from(order) })
    };
    Panel { guides: [1, 2].into_iter().filter_map(guide).collect(), ..panel }
}
