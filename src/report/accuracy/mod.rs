//! Error against run time: each problem, each solver, each of its settings.

mod figures;
mod tables;

use super::document::{Csv, Section};
use super::fit::order;
use super::problems::Problem;
use super::setting::{GivenUp, Setting};
use super::timing::{Effort, Spread, repeat};
use super::{Context, ReportError};
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

/// Errors between which an order is fitted, px: above is no order any more, below is rounding.
const FITTED: (f64, f64) = (1e-9, 30.0);

/// Runs a problem with one setting: once looking at it, and several times for its time.
pub(super) fn measure(problem: &Problem, setting: Setting, effort: &Effort) -> Result<Measured, GivenUp> {
    let Problem { world, balls, seconds, .. } = problem;
    let (mut end, mut run, mut look) = (0.0, 0.0_f64, 0);
    let last = setting.watch(world, balls, *seconds, effort.limit, |_, simulation| {
        end = problem.error(look, simulation.balls());
        run = if end.is_nan() || run.is_nan() { f64::NAN } else { run.max(end) };
        look += 1;
    })?;
    let times = repeat(effort, || setting.time(world, balls, *seconds, effort.limit))?;
    let impacts = last.tally().impacts + last.tally().wall_hits;
    Ok(Measured { end, run, impacts, times })
}

/// All solvers over their ladders.
pub(super) fn measure_all(problem: &Problem, context: &mut Context) -> Vec<Point> {
    let quick = context.quick;
    let point = |setting| {
        context.progress.step(problem.name);
        Point { setting, outcome: measure(problem, setting, &context.effort) }
    };
    Setting::all(quick).into_iter().map(point).collect()
}

/// How many steps of the progress bar this takes.
pub(super) fn steps(context: &Context, problems: usize) -> usize {
    problems * Setting::all(context.quick).len()
}

/// The order of a solver in its step: the slope of its errors at the end.
pub(super) fn order_of(points: &[Point], solver: Solver) -> Option<f64> {
    let of_solver = points.iter().filter(|point| point.setting.solver() == solver);
    let errors =
        of_solver.filter_map(|point| Some((point.setting.size()?, point.outcome.as_ref().ok()?.end)));
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
         1, … 10⁻⁶ px/s. Ringed is the one that is used where nothing is said. That of `contact` has a mark of its own, with no line to \
         it: as long as nothing presses balls together, as in most of these problems, it takes no substeps then, but does as \
         `exact`, and as many as suit what presses where anything does. Where nothing \
         comes to rest, `exact` does the same whatever its rest speed, and its marks lie on each other. An error below \
         10⁻¹⁴ px, none at all too, is drawn there. The order is the slope of the \
         error at the end over the step, fitted between 10⁻⁹ and 30 px where the errors lie on a \
         line (their correlation is above 0.95). Lines in grey have the slopes of order 1 and \
         2.",
    );
    let mut measured: Vec<(&Problem, Vec<Point>)> = Vec::new();
    for problem in problems {
        let points = measure_all(problem, context);
        for point in &points {
            tables::write_row(&mut csv, problem, point);
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
    if let Some(figure) = figures::main(&measured) {
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
    section.say(tables::costs(&measured).markdown());
    for (closed, heading, name) in [
        (true, "Problems with a closed form", "closed"),
        (false, "Problems with a reference run", "referenced"),
    ] {
        let group: Vec<&(&Problem, Vec<Point>)> =
            measured.iter().filter(|(problem, _)| problem.closed == closed).collect();
        if group.is_empty() {
            continue;
        }
        section.say(format!("### {heading}"));
        for (problem, points) in &group {
            section.say(format!("**{}** (`{}`). {}", problem.title, problem.name, problem.about));
            section.say(tables::table(problem, points).markdown());
        }
        for (at_end, part, caption) in
            [(true, "end", "Error at the end of the run"), (false, "run", "Largest error over the whole run")]
        {
            let figure = figures::all(format!("{name}-{part}"), &group, at_end);
            section.picture(&figure.name, &format!("{caption} against run time."));
            section.files.extend(figure.files()?);
        }
    }
    section.in_short.extend(tables::in_short(&measured));
    section.files.push(csv.file("points.csv"));
    Ok(section)
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
    fn contact_is_at_rounding_whatever_the_substep_where_balls_fly_or_meet_in_pairs() {
        for name in ["free-flight", "head-on", "oblique", "cradle"] {
            for point in points(name, Solver::Contact) {
                let run = point.outcome.unwrap().run;
                assert!(run < 1e-8, "{name}, {}: {run:e} px", point.setting);
            }
        }
    }

    #[test]
    fn contact_as_it_is_used_is_at_rounding_where_nothing_presses() {
        let effort = Effort { runs: 1, most: 1, ..Effort::full() };
        for problem in Problem::all().unwrap() {
            // What a demo's chaos makes of rounding.
            let most = if problem.name.ends_with("-2s") { 1e-6 } else { 1e-8 };
            let measured = measure(&problem, Setting::default_of(Solver::Contact), &effort).unwrap();
            assert!(measured.run <= most, "{}: {:e} px", problem.name, measured.run);
        }
    }

    #[test]
    fn exact_is_at_rounding_on_closed_forms() {
        for problem in Problem::all().unwrap().iter().filter(|problem| problem.closed) {
            let effort = Effort { runs: 1, most: 1, ..Effort::full() };
            // What an f64 resolves of paths of some hundred px, of 920,000 px, and of 3,141 impacts with a mass ratio
            // of 10⁶.
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
                assert!(
                    run <= most || point.setting.size().is_some_and(|size| size > 1.0),
                    "{name}, {}: {run:e} px",
                    point.setting
                );
            }
        }
    }
}
