//! Stiff and extreme cases: what each solver makes of them.
//!
//! A case says what it starts from, how time is cut, and what must hold, each criterion with the figure up to which it
//! holds and the one from which it has failed. A cell of the table is one case with one solver, run in a process of its
//! own where the program is known: what never returns, takes all memory or aborts is a figure of the table, too, and
//! not the end of the report.

mod case;
mod cases;
mod cell;
mod process;

use std::path::Path;
use std::time::Duration;

use case::Case;
pub(super) use cell::{Cell, Verdict};

use super::Context;
use super::document::{Csv, Section, Table, duration};
use crate::simulation::Solver;

/// How long a cell may run.
fn limit(quick: bool) -> Duration {
    if quick { Duration::from_millis(300) } else { Duration::from_secs(3) }
}

/// The names of all cases.
pub(super) fn names() -> Vec<&'static str> {
    cases::all().iter().map(|case| case.name).collect()
}

/// How many steps of the progress bar this takes.
pub(super) fn steps(only: Option<&str>) -> usize {
    chosen(only).len() * Solver::ALL.len()
}

fn chosen(only: Option<&str>) -> Vec<Case> {
    let mut cases = cases::all();
    cases.retain(|case| only.is_none_or(|name| name == case.name));
    cases
}

/// Runs one cell, named `case/solver`, in this process. `None` where there is no such cell.
pub(super) fn cell(name: &str, quick: bool) -> Option<Cell> {
    let (name, solver) = name.split_once('/')?;
    let case = cases::all().into_iter().find(|case| case.name == name)?;
    Some(cell::measure(&case, solver.parse().ok()?, limit(quick)))
}

fn run(case: &Case, solver: Solver, program: Option<&Path>, quick: bool) -> Cell {
    let limit = limit(quick);
    match program {
        Some(program) => process::cell(program, &format!("{}/{solver}", case.name), quick, limit),
        None => cell::measure(case, solver, limit),
    }
}

/// The section of the report: all cases, or one.
pub(super) fn section(only: Option<&str>, program: Option<&Path>, context: &mut Context) -> Section {
    let mut section = Section::default();
    section.heading("Stability");
    section.say(format!(
        "Each case is run with each solver as it is used ({} s of run time at most). **Held** means that every criterion \
         beside the case was met; **degraded**, that one was not, with its figure; **ran out of time**, that the run \
         was slower than that; **failed**, that a criterion was missed by far, that a number was not finite, or that \
         the program ended or took all memory, with what happened. Where nothing else is said, time goes in frames of 1/60 s. Overlaps and escapes are in radii of the smaller ball, energies \
         and momenta in parts of what there is at the start (of momenta, the sum of their sizes). Slower than the time \
         that it simulates is degraded, too, if it takes longer than 0.1 s.",
        limit(context.quick).as_secs_f64()
    ));
    let mut header = vec!["case", "held if"];
    header.extend(Solver::ALL.iter().map(|solver| solver.name()));
    let mut table = Table::new(&header);
    let mut csv =
        Csv::new("case,solver,verdict,why,criterion,value,held_to,failed_from,run_seconds,simulated_seconds");
    // Of each solver, its verdicts.
    let mut counts = [[0_usize; 4]; Solver::ALL.len()];
    for case in chosen(only) {
        let mut cells = vec![format!("`{}`: {}", case.name, case.what), case.criteria_text()];
        for (column, &solver) in Solver::ALL.iter().enumerate() {
            context.progress.step(case.name);
            let cell = run(&case, solver, program, context.quick);
            cells.push(text(&cell));
            write(&mut csv, &case, solver, &cell);
            counts[column][cell.verdict as usize] += 1;
            match cell.verdict {
                Verdict::Held | Verdict::Degraded => {}
                Verdict::RanOut => {
                    section
                        .failures
                        .push(format!("{}: `{solver}` ran out of time: {}.", case.name, cell.why));
                }
                Verdict::Failed => section.failures.push(format!("{}: `{solver}`: {}.", case.name, cell.why)),
            }
        }
        table.row(cells);
    }
    for (&solver, [held, degraded, ran_out, failed]) in Solver::ALL.iter().zip(counts) {
        let all = held + degraded + ran_out + failed;
        let cases = if all == 1 { "case" } else { "cases" };
        section.in_short.push(format!(
            "Of {all} stiff and extreme {cases}, `{solver}` held {held}, was degraded in {degraded}, ran out of time in \
             {ran_out} and failed in {failed}."
        ));
    }
    let mut totals = vec!["**all**".to_owned(), "held, degraded, ran out of time, failed".to_owned()];
    totals.extend(
        counts
            .map(|[held, degraded, ran_out, failed]| format!("**{held}, {degraded}, {ran_out}, {failed}**")),
    );
    table.row(totals);
    section.say(table.markdown());
    section.files.push(csv.file("stability.csv"));
    section
}

fn text(cell: &Cell) -> String {
    let verdict = match cell.verdict {
        Verdict::Held | Verdict::Degraded => cell.verdict.name().to_owned(),
        Verdict::RanOut | Verdict::Failed => format!("**{}**", cell.verdict.name()),
    };
    let why = if cell.why.is_empty() { String::new() } else { format!(": {}", cell.why) };
    format!("{verdict}{why} ({})", duration(cell.run_seconds))
}

fn write(csv: &mut Csv, case: &Case, solver: Solver, cell: &Cell) {
    let Cell { verdict, why, values, run_seconds, simulated } = cell;
    let verdict = verdict.name();
    if values.is_empty() {
        csv.row(&[&case.name, &solver, &verdict, why, &"", &"", &"", &"", run_seconds, simulated]);
    }
    for (criterion, value) in case.criteria.iter().zip(values) {
        let (name, held, failed) = (criterion.measure.name(), criterion.held, criterion.failed);
        csv.row(&[&case.name, &solver, &verdict, why, &name, value, &held, &failed, run_seconds, simulated]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_have_names_of_their_own_and_something_to_hold() {
        let cases = cases::all();
        for (index, case) in cases.iter().enumerate() {
            assert!(cases[..index].iter().all(|other| other.name != case.name), "{}", case.name);
            assert!(
                case.criteria.iter().all(|criterion| criterion.held <= criterion.failed),
                "{}",
                case.name
            );
            assert!((case.setup)().is_ok(), "{}", case.name);
        }
        assert!(cell("no such case/exact", true).is_none() && cell("corner/no such solver", true).is_none());
    }

    /// Cases that take longer than a test may; the report runs them.
    const LONG: [&str; 6] =
        ["delta-3600", "hour-elastic", "hour-gravity", "packed-0.90", "one-point-1e5", "column-1000"];

    /// Every criterion of every short case must hold with this solver, except these.
    fn all_held_but(solver: Solver, missed: &[&str]) {
        for case in
            cases::all().iter().filter(|case| !LONG.contains(&case.name) && !missed.contains(&case.name))
        {
            let cell = cell::measure(case, solver, Duration::from_secs(20));
            assert_eq!(
                cell.values.len(),
                case.criteria.len() * usize::from(case.name != "refused"),
                "{cell:?}"
            );
            for (criterion, value) in case.criteria.iter().zip(&cell.values) {
                let name = criterion.measure.name();
                // Not what it took: a machine that does something else is no failure of a solver.
                assert!(*value <= criterion.held, "{} with {solver}: {name} {value:e}", case.name);
            }
        }
    }

    #[test]
    fn what_exact_holds_stays_held() {
        all_held_but(Solver::Exact, EXACT_MISSES);
    }

    #[test]
    fn what_contact_holds_stays_held() {
        all_held_but(Solver::Contact, &[]);
    }

    /// A window that shrinks over a pile takes longer than a test may, in overlaps and creeping, till all are apart and
    /// at rest.
    const EXACT_MISSES: &[&str] = &["shrinking-window"];

    #[test]
    fn what_takes_too_long_ran_out_of_time_and_broke_nothing() {
        let case = cases::all().into_iter().find(|case| case.name == "hour-elastic").unwrap();
        let cell = cell::measure(&case, Solver::Contact, Duration::ZERO);
        assert_eq!((cell.verdict, cell.values.len()), (Verdict::RanOut, 0), "{cell:?}");
        assert!(text(&cell).starts_with("**ran out of time**: came to "), "{}", text(&cell));
    }

    #[test]
    fn canvas_fails_where_the_demo_does() {
        for name in ["mass-rest-1e6/canvas", "speed-1e6/canvas", "collapse-demo/canvas"] {
            let cell = cell(name, false).unwrap();
            assert_eq!(cell.verdict, Verdict::Failed, "{name}: {cell:?}");
        }
    }
}
