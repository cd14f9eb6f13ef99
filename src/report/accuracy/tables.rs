//! The tables of errors and run times.

use super::{Measured, Point, order_of};
use crate::report::document::{Csv, Table, duration, rounded};
use crate::report::problems::Problem;
use crate::report::setting::Setting;
use crate::simulation::Solver;

/// Errors that a caller might ask for, px: what is not seen, and what is not noticed.
const ASKED: [(f64, &str); 3] = [(1.0, "1 px"), (1e-3, "0.001 px"), (1e-6, "10⁻⁶ px")];

/// The run time of the cheapest setting with which an error is never larger than asked for.
fn cheapest(points: &[Point], solver: Solver, asked: f64) -> Option<f64> {
    let own = points.iter().filter(|point| point.setting.solver() == solver);
    let good = own.filter_map(|point| point.outcome.as_ref().ok()).filter(|measured| measured.run <= asked);
    good.map(|measured| measured.times.median).min_by(f64::total_cmp)
}

/// The costs of all problems.
pub(super) fn costs(measured: &[(&Problem, Vec<Point>)]) -> Table {
    let mut header = vec!["problem".to_owned()];
    for (_, name) in ASKED {
        header.extend(Solver::ALL.iter().map(|solver| format!("{name}: {solver}")));
    }
    let mut table = Table::new(&header.iter().map(String::as_str).collect::<Vec<_>>());
    for (problem, points) in measured {
        let mut cells = vec![format!("`{}`", problem.name)];
        for (asked, _) in ASKED {
            cells.extend(
                Solver::ALL
                    .iter()
                    .map(|&solver| cheapest(points, solver, asked).map_or_else(|| "–".to_owned(), duration)),
            );
        }
        table.row(cells);
    }
    table
}

/// A point in whole numbers.
pub(super) fn write_row(csv: &mut Csv, problem: &Problem, Point { setting, outcome }: &Point) {
    let (name, solver, quantity, size) =
        (problem.name, setting.solver(), setting.quantity(), setting.written_size());
    match outcome {
        Ok(Measured { end, run, impacts, times }) => csv.row(&[
            &name,
            &solver,
            &quantity,
            &size,
            end,
            run,
            impacts,
            &times.median,
            &times.least,
            &times.quartiles.0,
            &times.quartiles.1,
            &times.most,
            &times.runs,
            &"done",
        ]),
        Err(why) => {
            let no = "";
            csv.row(&[&name, &solver, &quantity, &size, &no, &no, &no, &no, &no, &no, &no, &no, &no, why]);
        }
    }
}

/// A line for each solver: with the setting that it is used with, and with its best.
pub(super) fn table(problem: &Problem, points: &[Point]) -> Table {
    let mut header = vec![
        "solver",
        "as it is used",
        "error at the end, px",
        "over the run, px",
        "run time",
        "least error at the end, px",
        "its run time",
        "order",
    ];
    if problem.impacts.is_some() {
        header.insert(5, "impacts");
    }
    let mut table = Table::new(&header);
    for &solver in Solver::ALL {
        let default = Setting::default_of(solver);
        let mut own = points.iter().filter(|point| point.setting.solver() == solver);
        let used = own.clone().find(|point| point.setting == default).or_else(|| own.next());
        let Some(used) = used else { continue };
        let done = points.iter().filter(|point| point.setting.solver() == solver);
        let done = done.filter_map(|point| point.outcome.as_ref().ok());
        let best = done.min_by(|a, b| a.end.total_cmp(&b.end));
        let mut cells = vec![solver.to_string(), used.setting.to_string()];
        match &used.outcome {
            Ok(Measured { end, run, times, impacts }) => {
                cells.extend([rounded(*end), rounded(*run), duration(times.median)]);
                cells.extend(problem.impacts.map(|wanted| format!("{impacts} of {wanted}")));
            }
            Err(why) => {
                cells.extend([format!("given up: {why}"), "–".to_owned(), "–".to_owned()]);
                cells.extend(problem.impacts.map(|_| "–".to_owned()));
            }
        }
        cells.extend(best.map_or(["–".to_owned(), "–".to_owned()], |best| {
            [rounded(best.end), duration(best.times.median)]
        }));
        let steps = solver != Solver::Exact;
        let order = order_of(points, solver).filter(|_| steps);
        cells.push(order.map_or_else(|| "–".to_owned(), |order| format!("{order:.1}")));
        table.row(cells);
    }
    table
}

/// A sentence for each solver: with how many problems it is near the truth, as it is used.
pub(super) fn in_short(measured: &[(&Problem, Vec<Point>)]) -> Vec<String> {
    let sentence = |&solver: &Solver| {
        let used = Setting::default_of(solver);
        let runs = || {
            let points = measured.iter().flat_map(|(_, points)| points);
            points.filter(|point| point.setting == used).filter_map(|point| point.outcome.as_ref().ok())
        };
        let within = |most: f64| runs().filter(|measured| measured.run <= most).count();
        format!(
            "`{solver}` with {used} stays within 1 px of the truth in {} of {} problems, and within 10⁻⁶ px in {}.",
            within(1.0),
            measured.len(),
            within(1e-6)
        )
    };
    Solver::ALL.iter().map(sentence).collect()
}
