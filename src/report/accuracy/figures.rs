//! The work-precision diagrams.

use super::{Measured, Point};
use crate::report::ReportError;
use crate::report::chart::{Axis, ChartError, Curve, Dot, Figure, Guide, Panel, Style};
use crate::report::problems::Problem;
use crate::simulation::Solver;

/// Errors below this are drawn at it, 0 among them, px.
const LEAST_ERROR: f64 = 1e-14;
/// How many panels of a figure stand beside each other.
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
    let panels = group.iter().map(|(problem, points)| panel(problem, points, at_end)).collect();
    Figure { name, columns: COLUMNS, panels }
}

/// A solver's points as a curve, and how many are missing.
fn curve(points: &[Point], solver: Solver, at_end: bool) -> (Curve, usize) {
    let own: Vec<&Point> = points.iter().filter(|point| point.setting.solver() == solver).collect();
    let dots: Vec<Dot> = own
        .iter()
        .filter_map(|point| point.outcome.as_ref().ok())
        .filter(|measured| measured.run.is_finite())
        .map(|Measured { end, run, times, .. }| Dot {
            x: times.median,
            y: if at_end { *end } else { *run }.max(LEAST_ERROR),
            spread: Some(times.quartiles),
        })
        .collect();
    let missing = own.len() - dots.len();
    (
        Curve { label: solver.name().to_owned(), style: Style::of(solver), dots, marked: 1, lined: true },
        missing,
    )
}

fn panel(problem: &Problem, points: &[Point], at_end: bool) -> Panel {
    let (curves, missing): (Vec<Curve>, Vec<usize>) =
        Solver::ALL.iter().map(|&solver| curve(points, solver, at_end)).unzip();
    let given_up: Vec<String> = (Solver::ALL.iter().zip(missing))
        .filter(|(_, missing)| *missing > 0)
        .map(|(solver, missing)| format!("{solver}: {missing} given up"))
        .collect();
    let dots = || curves.iter().flat_map(|curve| &curve.dots);
    // Steps are coarsest at the first point of `canvas`: guides begin there.
    // Where that is right by chance, they would say nothing.
    let first = curves[0].dots.first().filter(|dot| dot.y > 1e3 * LEAST_ERROR);
    let through = first.map(|dot| (dot.x, dot.y));
    let guide = |order: i32| {
        let label = format!("order {order}");
        through.map(|through| Guide { label, through, slope: -f64::from(order) })
    };
    Panel {
        title: problem.title.to_owned(),
        x: Axis::log("run time, s", dots().map(|dot| dot.x)),
        y: Axis::log("error, px", dots().map(|dot| dot.y)),
        guides: [1, 2].into_iter().filter_map(guide).collect(),
        curves,
        note: given_up.join("; "),
    }
}

impl From<ChartError> for ReportError {
    fn from(error: ChartError) -> Self {
        Self::Chart(error)
    }
}
