//! Error against run time: each problem, each solver, each of its settings.

use super::Context;
use super::chart::{Axis, Curve, Dot, Figure, Guide, Panel, Style};
use super::document::{Csv, Section, Table, duration, rounded};
use super::fit::order;
use super::problems::Problem;
use super::setting::{GivenUp, Setting};
use super::timing::{Effort, Spread, repeat};
use super::{ReportError, chart};
use crate::simulation::Solver;

/// What a run with one setting came to.
#[derive(Debug, Clone)]
pub(super) struct Point {
    pub(super) setting: Setting,
    pub(super) outcome: Result<Measured, GivenUp>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Measured {
    /// How far balls are from where they should be at the end, at most, px.
    pub(super) end: f64,
    /// The same at any look at the run.
    pub(super) run: f64,
    /// Impacts on balls and walls.
    pub(super) impacts: u64,
    times: Spread,
}

/// Errors below this are drawn at it, 0 among them, px.
const LEAST_ERROR: f64 = 1e-14;
/// Errors between which an order is fitted, px: above is no order any more, below is rounding.
const FITTED: (f64, f64) = (1e-9, 30.0);
/// How many panels of a figure stand beside each other.
const COLUMNS: usize = 2;

/// Runs a problem with one setting: once looking at it, and several times for its time.
pub(super) fn measure(problem: &Problem, setting: Setting, effort: &Effort) -> Result<Measured, GivenUp> {
    let Problem { world, balls, seconds, .. } = problem;
    let (mut end, mut run, mut look) = (0.0, 0.0_f64, 0);
    let last = setting.watch(world, balls, *seconds, effort.limit, |_, simulation| {
        end = problem.error(look, simulation.balls());
        run = if end.is_nan() { end } else { run.max(end) };
        look += 1;
    })?;
    let times = repeat(effort, || setting.time(world, balls, *seconds, effort.limit))?;
    let impacts = last.tally().impacts + last.tally().wall_hits;
    Ok(Measured { end, run, impacts, times })
}

/// All solvers over their ladders.
pub(super) fn measure_all(problem: &Problem, context: &mut Context) -> Vec<Point> {
    let settings = Solver::ALL.iter().flat_map(|&solver| Setting::ladder(solver, context.quick));
    let settings: Vec<Setting> = settings.collect();
    let point = |setting| {
        context.progress.step(problem.name);
        Point { setting, outcome: measure(problem, setting, &context.effort) }
    };
    settings.into_iter().map(point).collect()
}

/// How many steps of the progress bar this takes.
pub(super) fn steps(context: &Context, problems: usize) -> usize {
    let settings: usize =
        Solver::ALL.iter().map(|&solver| Setting::ladder(solver, context.quick).len()).sum();
    problems * settings
}

/// The order of a solver in its step: the slope of its errors at the end.
pub(super) fn order_of(points: &[Point], solver: Solver) -> Option<f64> {
    let of_solver = points.iter().filter(|point| point.setting.solver() == solver);
    let errors = of_solver.filter_map(|point| Some((point.setting.size(), point.outcome.as_ref().ok()?.end)));
    let fitted = errors.filter(|(_, error)| (FITTED.0..=FITTED.1).contains(error));
    order(&fitted.collect::<Vec<_>>())
}

/// The section of the report, for these problems.
pub(super) fn section(problems: &[Problem], context: &mut Context) -> Result<Section, ReportError> {
    let mut section = Section::default();
    let mut csv = Csv::new(
        "problem,solver,quantity,setting,error_end_px,error_run_px,impacts,seconds_median,\
         seconds_least,seconds_quartile1,seconds_quartile3,seconds_most,runs,outcome",
    );
    section.heading("Error against run time");
    section.say(
        "An error is the largest distance of a ball's centre from where it should be, in px: at the end of the run, \
         and over the whole of it (looked at 30 times a second). A run time is the median of several runs, with \
         their quartiles as a line through the mark; it is the time of `advance` alone. Each mark is one \
         setting: frames (`canvas`) or substeps (`contact`) of 1/30, 1/60, … 1/7680 s, rest speeds (`exact`) of 10, \
         1, … 10⁻⁶ px/s. Where nothing comes to rest, `exact` does the same whatever its rest speed, and its marks \
         lie on each other. An error below 10⁻¹⁴ px, none at all too, is drawn there. The order is the slope of the \
         error at the end over the step, fitted between 10⁻⁹ and 30 px where the errors lie on a \
         line (their correlation is above 0.95). Lines in grey have the slopes of order 1 and \
         2.",
    );
    let mut measured: Vec<(&Problem, Vec<Point>)> = Vec::new();
    for problem in problems {
        let points = measure_all(problem, context);
        for point in &points {
            write_row(&mut csv, problem, point);
            if let Err(given_up) = &point.outcome {
                let Point { setting, .. } = point;
                section.failures.push(format!(
                    "{}: `{}` with {setting}: {given_up}.",
                    problem.name,
                    setting.solver()
                ));
            }
        }
        measured.push((problem, points));
    }
    if let Some(figure) = main_figure(&measured) {
        section.picture(
            &figure.name,
            "Error at the end of the run against run time, for four of the problems below.",
        );
        section.files.extend(figure.files()?);
    }
    section.say("### What accuracy costs");
    section.say(
        "The least run time of any setting with which no ball is ever farther than this from where it should be. A dash: no \
         setting of the ladder comes so near.",
    );
    section.say(costs(&measured).markdown());
    for (closed, heading, name) in [
        (true, "Problems with a closed form", "closed"),
        (false, "Problems with a reference run", "referenced"),
    ] {
        let group: Vec<_> = measured.iter().filter(|(problem, _)| problem.closed == closed).collect();
        if group.is_empty() {
            continue;
        }
        section.say(format!("### {heading}"));
        for (problem, points) in &group {
            section.say(format!("**{}** (`{}`). {}", problem.title, problem.name, problem.about));
            section.say(table(problem, points).markdown());
        }
        for (at_end, part, caption) in
            [(true, "end", "Error at the end of the run"), (false, "run", "Largest error over the whole run")]
        {
            let figure = Figure {
                name: format!("{name}-{part}"),
                columns: COLUMNS,
                panels: group.iter().map(|(problem, points)| panel(problem, points, at_end)).collect(),
            };
            section.picture(&figure.name, &format!("{caption} against run time."));
            section.files.extend(figure.files()?);
        }
    }
    section.files.push(csv.file("points.csv"));
    Ok(section)
}

/// Errors that a caller might ask for, px: what is not seen, and what is not noticed.
const ASKED: [(f64, &str); 3] = [(1.0, "1 px"), (1e-3, "0.001 px"), (1e-6, "10⁻⁶ px")];

/// The run time of the cheapest setting with which an error is never larger than asked for.
fn cheapest(points: &[Point], solver: Solver, asked: f64) -> Option<f64> {
    let own = points.iter().filter(|point| point.setting.solver() == solver);
    let good = own.filter_map(|point| point.outcome.as_ref().ok()).filter(|measured| measured.run <= asked);
    good.map(|measured| measured.times.median).min_by(f64::total_cmp)
}

fn costs(measured: &[(&Problem, Vec<Point>)]) -> Table {
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

/// The problems of the diagram that stands for all.
const MAIN: [&str; 4] = ["drop", "oblique", "elastic-1s", "gravity-1s"];

fn main_figure(measured: &[(&Problem, Vec<Point>)]) -> Option<Figure> {
    let find = |name: &&str| measured.iter().find(|(problem, _)| problem.name == *name);
    let chosen: Option<Vec<_>> = MAIN.iter().map(find).collect();
    let panels = chosen?.into_iter().map(|(problem, points)| panel(problem, points, true)).collect();
    Some(Figure { name: "main".to_owned(), columns: COLUMNS, panels })
}

fn write_row(csv: &mut Csv, problem: &Problem, Point { setting, outcome }: &Point) {
    let (name, solver, quantity, size) = (problem.name, setting.solver(), setting.quantity(), setting.size());
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
fn table(problem: &Problem, points: &[Point]) -> Table {
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
                cells.extend([format!("failed: {why}"), "–".to_owned(), "–".to_owned()]);
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
    let through = curves[0].dots.first().map(|dot| (dot.x, dot.y));
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

impl From<chart::ChartError> for ReportError {
    fn from(error: chart::ChartError) -> Self {
        Self::Chart(error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A problem's points of one solver, without caring for times.
    fn points(name: &str, solver: Solver) -> Vec<Point> {
        let problem = Problem::all().unwrap().into_iter().find(|problem| problem.name == name).unwrap();
        let effort = Effort { runs: 1, most: 1, ..Effort::full() };
        let point = |setting| Point { setting, outcome: measure(&problem, setting, &effort) };
        Setting::ladder(solver, false).into_iter().map(point).collect()
    }

    #[test]
    fn canvas_is_of_first_order_where_it_converges() {
        for name in ["free-flight", "drop"] {
            let order = order_of(&points(name, Solver::Canvas), Solver::Canvas);
            assert!(order.is_some_and(|order| (0.8..1.2).contains(&order)), "{name}: {order:?}");
        }
    }

    #[test]
    fn contact_is_of_second_order_in_free_flight() {
        let order = order_of(&points("free-flight", Solver::Contact), Solver::Contact);
        assert!(order.is_some_and(|order| (1.9..2.1).contains(&order)), "{order:?}");
    }

    #[test]
    fn exact_is_at_rounding_on_closed_forms() {
        for problem in Problem::all().unwrap().iter().filter(|problem| problem.closed) {
            let effort = Effort { runs: 1, most: 1, ..Effort::full() };
            // What an f64 resolves of paths of some hundred px, of 920,000 px, and of 3,141 impacts with a mass ratio of 10⁶.
            let most = match problem.name {
                "box" | "galperin" => 1e-9,
                _ => 2e-11,
            };
            // Where a ball bounces to rest, the hops that are left out are up to u²/2g high.
            let setting = Setting::RestSpeed(1e-6);
            let measured = measure(problem, setting, &effort).unwrap();
            assert!(measured.run <= most, "{}: {:e} px", problem.name, measured.run);
            assert!(problem.impacts.is_none_or(|impacts| measured.impacts == impacts), "{}", problem.name);
        }
    }

    #[test]
    fn exact_follows_the_demo_as_far_as_an_f64_does() {
        for (name, most) in [
            ("elastic-1s", 1e-8),
            ("elastic-2s", 1e-7),
            ("inelastic-1s", 1e-9),
            ("inelastic-2s", 1e-8),
            ("gravity-1s", 1e-7),
            ("gravity-2s", 1e-4),
        ] {
            for point in points(name, Solver::Exact) {
                let run = point.outcome.unwrap().run;
                // At 10 px/s what is left out of a bounce to rest is 0.05 px high.
                assert!(run <= most || point.setting.size() > 1.0, "{name}, {}: {run:e} px", point.setting);
            }
        }
    }
}
