//! `carom report`: which solver to trust, for what, and at what cost.
//!
//! - `problems` are scenes of which it is known where their balls are; `accuracy` sets each solver's error against its
//!   run time, over a ladder of settings (`setting`, `timing`, `fit`);
//! - `reference` is what is known where there is no closed form, and `growth` follows errors as chaos makes them grow;
//! - `gas` and `pile` measure what has no trajectory to compare with;
//! - `stability` are stiff and extreme cases, `parts` what a scene leaves out;
//! - `chart` draws, and `document` writes.
//!
//! # Methods
//!
//! *Work-precision diagrams* show the error over the run time, both logarithmic, one mark a setting (Hairer, Nørsett &
//! Wanner, Solving Ordinary Differential Equations I, 1993, section II.10). A method of order p falls by hᵖ where time
//! grows by 1/h, so its marks lie on a line of slope −p; a method without steps is a point. The error is the largest
//! distance of a ball from its true place: at the end of the run, and over the whole of it. The run time is the median
//! of repeated runs of [`Simulation::advance`](crate::Simulation::advance) alone; the quartiles show how far the
//! machine can be trusted.
//!
//! *Closed forms*: the parabola; the hops of a dropped ball, which rests after √(2h/g)·(1+e)/(1−e); the law of impact
//! for a pair; Newton's cradle; the unfolded straight line of a ball in a box; the number of impacts in Galperin's
//! billiard, ⌊π·10ⁿ⌋ (Galperin, Playing pool with π, 2003).
//!
//! *The reference* is event-driven in its plainest form (Alder & Wainwright, Studies in molecular dynamics I, 1959):
//! all pairs and walls are searched for the earliest impact, all balls are moved there. Its numbers are pairs of f64
//! (Dekker 1971; Hida, Li & Bailey 2001), 32 digits. It shares no code with `exact`: where one ball rests and another
//! flies, for instance, it bisects between the turns of a polynomial of fourth degree. It agrees with trajectories of
//! 60 digits to 10⁻²¹ px, and a nudge of 10⁻²⁸ px shows for how long it means anything. With inelastic balls under
//! gravity infinitely many impacts come in finite time (`McNamara` & Young, Inelastic collapse in two dimensions,
//! 1992): a ball that bounces to rest on the floor rests in closed form; where balls come to rest on each other, the
//! reference ends and says so.
//!
//! *A gas* has the compressibility of hard discs (Clisby & `McCoy`, Ninth and tenth order virial coefficients, 2006),
//! measured by the hits on its walls and corrected for them (Helfand, Frisch & Lebowitz 1961), and Maxwell's speeds,
//! measured by the distance of Kolmogorov and Smirnov.
//!
//! *Stability*: each case states what must hold and up to which figure; a cell has held, is degraded with its figure,
//! ran out of time, or has failed with what happened. Each runs in a process of its own, so that what hangs, aborts or takes all memory
//! is measured, too.

mod accuracy;
mod chart;
mod document;
mod fit;
mod gas;
mod growth;
mod machine;
mod parts;
mod pile;
mod problems;
mod progress;
mod reference;
mod setting;
mod stability;
mod timing;

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use thiserror::Error;

pub use chart::ChartError;
use document::{Csv, Section, Table};
use problems::{Problem, Unposed};
use progress::Progress;
use timing::Effort;

use crate::headless::{MadeFolders, Output, OutputError};

/// What to report, and where.
#[derive(Debug, Clone)]
pub struct Options {
    /// The folder for its files; it is made where there is none.
    pub folder: PathBuf,
    /// Every second setting, fewer runs and less patience.
    pub quick: bool,
    /// One section, problem or case alone.
    pub only: Option<String>,
    /// The program itself, which [`cell`]s of the stability table are run by, each in a process of its own. Without it
    /// they run in this process, which ends with a solver that aborts.
    pub program: Option<PathBuf>,
}

/// Why there is no report.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReportError {
    /// There is no section, problem or case of this name.
    #[error("there is nothing named \"{name}\" in the report; choose from: {}", known.join(", "))]
    Unknown {
        /// The name.
        name: String,
        /// All names.
        known: Vec<&'static str>,
    },
    /// The folder cannot be made.
    #[error("{}: {source}; give a folder that can be made", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A figure cannot be drawn.
    #[error(transparent)]
    Chart(#[from] ChartError),
    /// A problem cannot be posed: a defect.
    #[error("a problem of the report is wrong: {0}")]
    Unposed(String),
}

impl From<Unposed> for ReportError {
    fn from(error: Unposed) -> Self {
        Self::Unposed(error.to_string())
    }
}

/// What all sections share.
struct Context {
    quick: bool,
    effort: Effort,
    progress: Progress,
}

/// The names of the sections, in their order.
const SECTIONS: [&str; 6] = ["accuracy", "growth", "gas", "pile", "stability", "parts"];

impl Context {
    #[cfg(test)]
    fn quick() -> Self {
        Self { quick: true, effort: Effort::quick(), progress: Progress::new(0) }
    }
}

/// One cell of the stability table, `case/solver`: what the report runs itself for. Returns the cell as one line of JSON.
///
/// # Errors
/// [`ReportError::Unknown`] where there is no such cell.
pub fn cell(name: &str, quick: bool) -> Result<String, ReportError> {
    let cell = stability::cell(name, quick);
    let json = cell.and_then(|cell| serde_json::to_string(&cell).ok());
    json.ok_or_else(|| ReportError::Unknown { name: name.to_owned(), known: stability::names() })
}

/// Measures, and writes the report. Returns the path of its page, `report.md` in the folder of the options.
///
/// # Errors
/// [`ReportError`]; what failed in a solver is no error, but stands in the report.
pub fn write(options: &Options) -> Result<PathBuf, ReportError> {
    let wanted = Wanted::new(options.only.as_deref())?;
    let _made = MadeFolders::make(&options.folder)
        .map_err(|source| ReportError::Folder { folder: options.folder.clone(), source })?;
    // Opened before what takes minutes, so that a folder that may not be written to is known at once.
    let page = options.folder.join("report.md");
    let page = (Output::create(&page)?, page);
    let effort = if options.quick { Effort::quick() } else { Effort::full() };
    let mut context = Context { quick: options.quick, effort, progress: Progress::new(0) };
    context.progress = Progress::new(wanted.steps(&context));
    let sections = wanted.measure(options.program.as_deref(), &mut context)?;
    write_all(options, &sections, page)
}

/// What is to be reported.
struct Wanted<'a> {
    /// The one section, problem or case, where not all are.
    only: Option<&'a str>,
    /// The problems that are measured.
    problems: Vec<Problem>,
    /// The one case of the stability table, where not all are.
    case: Option<&'a str>,
}

impl<'a> Wanted<'a> {
    fn new(only: Option<&'a str>) -> Result<Self, ReportError> {
        let (mut problems, cases) = (Problem::all()?, stability::names());
        if let Some(name) = only {
            let known: Vec<&'static str> = SECTIONS
                .into_iter()
                .chain(problems.iter().map(|problem| problem.name))
                .chain(cases.clone())
                .collect();
            if !known.contains(&name) {
                return Err(ReportError::Unknown { name: name.to_owned(), known });
            }
            if name != "accuracy" {
                problems.retain(|problem| problem.name == name);
            }
        }
        let case = only.filter(|name| cases.contains(name));
        Ok(Self { only, problems, case })
    }

    /// Whether this section is wanted whole.
    fn has(&self, section: &str) -> bool {
        self.only.is_none_or(|name| name == section)
    }

    /// Whether cases of the stability table are wanted.
    fn has_stability(&self) -> bool {
        self.has("stability") || self.case.is_some()
    }

    /// How many steps of the progress bar this takes.
    fn steps(&self, context: &Context) -> usize {
        let mut steps = accuracy::steps(context, self.problems.len());
        if self.has("growth") {
            steps += growth::steps();
        }
        if self.has("gas") {
            steps += gas::steps();
        }
        if self.has("pile") {
            steps += pile::steps(context.quick);
        }
        if self.has_stability() {
            steps += stability::steps(self.case);
        }
        if self.has("parts") {
            steps += parts::steps();
        }
        steps
    }

    /// The sections, in their order; `program` is the one that cells of the stability table are run by.
    fn measure(&self, program: Option<&Path>, context: &mut Context) -> Result<Vec<Section>, ReportError> {
        let mut sections = Vec::new();
        if !self.problems.is_empty() {
            sections.push(accuracy::section(&self.problems, context)?);
        }
        if self.has("growth") {
            sections.push(growth::section(context)?);
        }
        if self.has("gas") {
            sections.push(gas::section(context)?);
        }
        if self.has("pile") {
            sections.push(pile::section(context)?);
        }
        if self.has_stability() {
            sections.push(stability::section(self.case, program, context));
        }
        if self.has("parts") {
            sections.push(parts::section(context)?);
        }
        Ok(sections)
    }
}

/// The names of all figures, and of all tables.
const FIGURES: [&str; 9] = [
    "main",
    "closed-end",
    "closed-run",
    "referenced-end",
    "referenced-run",
    "growth",
    "gas",
    "pile",
    "parts",
];
const TABLES: [&str; 6] = ["points", "growth", "gas", "pile", "stability", "parts"];

/// The files that a report writes beside its page which are in this folder and not among those of these sections.
fn left(folder: &Path, sections: &[Section]) -> Vec<String> {
    let figures = FIGURES.iter().flat_map(|name| [format!("{name}.png"), format!("{name}.svg")]);
    let all: Vec<String> = figures.chain(TABLES.iter().map(|name| format!("{name}.csv"))).collect();
    let written: Vec<&String> =
        sections.iter().flat_map(|section| &section.files).map(|(name, _)| name).collect();
    debug_assert!(written.iter().all(|name| all.contains(name)), "{written:?}");
    all.into_iter().filter(|name| !written.contains(&name) && folder.join(name).exists()).collect()
}

/// Writes the page, which was opened before at its path, and the files beside it.
fn write_all(
    options: &Options,
    sections: &[Section],
    (page, path): (Output, PathBuf),
) -> Result<PathBuf, ReportError> {
    let left = left(&options.folder, sections);
    let mut text = introduction(options, sections, &left);
    for section in sections {
        text += &section.text;
        for (name, content) in &section.files {
            Output::create(&options.folder.join(name))?.complete(content)?;
        }
    }
    text += &failures(sections);
    let mut machine = Csv::new("name,value");
    for (name, value) in machine::lines() {
        machine.row(&[&name, &value]);
    }
    let (name, content) = machine.file("machine.csv");
    Output::create(&options.folder.join(name))?.complete(&content)?;
    page.complete(text.as_bytes())?;
    if !left.is_empty() {
        // Standard error may be gone; the page says it, too.
        let _ = writeln!(
            io::stderr(),
            "carom: {} still has files of another report, not of this one: {}",
            options.folder.display(),
            left.join(", ")
        );
    }
    Ok(path)
}

/// What stands first; `left` are the files of another report in its folder.
fn introduction(options: &Options, sections: &[Section], left: &[String]) -> String {
    let mut section = Section::default();
    section.say("# Which solver to trust, for what, and at what cost");
    section.say("Written by `carom report`. Numbers here are rounded; the CSV files beside this page have them whole.");
    let mut table = Table::new(&["", ""]);
    for (name, value) in machine::lines() {
        table.row(vec![name.to_owned(), value]);
    }
    let settings =
        if options.quick { "quick: every second setting, few runs, little patience" } else { "full" };
    table.row(vec!["report".to_owned(), settings.to_owned()]);
    section.say(table.markdown());
    if !left.is_empty() {
        section.say(format!(
            "These files in this folder are of another report, not of this one: `{}`.",
            left.join("`, `")
        ));
    }
    let sentences: Vec<String> = sections
        .iter()
        .flat_map(|section| &section.in_short)
        .map(|sentence| format!("- {sentence}"))
        .collect();
    if !sentences.is_empty() {
        section.heading("In short");
        section.say(sentences.join("\n"));
    }
    section.text
}

fn failures(sections: &[Section]) -> String {
    let mut section = Section::default();
    section.heading("What failed or ran out of time");
    let failures: Vec<&String> = sections.iter().flat_map(|section| &section.failures).collect();
    if failures.is_empty() {
        section.say("Nothing that was measured here failed, and all came to its end.");
    } else {
        let lines: Vec<String> = failures.iter().map(|failure| format!("- {failure}")).collect();
        section.say(lines.join("\n"));
    }
    section.text
}
