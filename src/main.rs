//! The program: parse, run, print one error, set the exit code.

mod cli;
#[cfg(feature = "window")]
mod panics;
#[cfg(unix)]
mod signals;

use std::ffi::OsStr;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use carom::headless::{self, Course, Frames, FramesError, Run, RunError};
use carom::paint::AnimationError;
#[cfg(feature = "report")]
use carom::report::{self, ReportError};
use carom::session::Replay;
#[cfg(feature = "window")]
use carom::window::WindowError;
use carom::{Scene, SceneError};
use thiserror::Error;

use crate::cli::{Cli, Command, RunArgs, SceneArgs, WindowArgs};

fn main() -> ExitCode {
    let done = match Cli::of_this_call() {
        Ok(cli) => follow(cli),
        Err(refusal) if refusal.use_stderr() => refusal.exit(),
        Err(help) => print_help(&help),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) if failure.is_broken_pipe() => ExitCode::SUCCESS,
        Err(failure) => {
            // Where standard error is gone, too, the exit code still tells.
            let _ = writeln!(io::stderr(), "carom: {failure}{}", failure.options());
            failure.exit_code()
        }
    }
}

/// Does what the program was called for.
fn follow(cli: Cli) -> Result<(), Failure> {
    let Some(command) = cli.command else { return open_window(&cli.window) };
    #[cfg(unix)]
    signals::watch(|| {});
    match command {
        Command::Run(args) => run(*args),
        Command::Report(args) => write_report(args),
        Command::Scenes { json } => list_scenes(json),
        Command::Scene { scene } => print_scene(&scene),
    }
}

/// Why the program ends with an error.
#[derive(Debug, Error)]
enum Failure {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    OutOfRange(#[from] carom::OutOfRange),
    #[error(transparent)]
    Run(#[from] RunError),
    #[error("standard output: {0}")]
    Stdout(#[from] io::Error),
    #[cfg(feature = "report")]
    #[error(transparent)]
    Report(#[from] ReportError),
    #[cfg(feature = "window")]
    #[error(transparent)]
    Window(#[from] WindowError),
    #[cfg(not(feature = "window"))]
    #[error(
        "this carom was built without its window; build it with the default features, or call carom run {0:?}"
    )]
    NoWindow(std::ffi::OsString),
    #[cfg(not(feature = "report"))]
    #[error("this carom was built without its report; build it with the default features")]
    NoReport,
}

impl Failure {
    /// 2 where the call or a file that it names is wrong, 1 where it failed while running.
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Scene(_)
            | Self::OutOfRange(_)
            | Self::Run(
                RunError::Scene(_)
                | RunError::Frames(_)
                | RunError::Replay(_)
                | RunError::SameOutput { .. }
                | RunError::OverInput { .. }
                | RunError::Picture(_)
                | RunError::Animation {
                    source: AnimationError::TooLarge { .. } | AnimationError::TooLong(_),
                    ..
                },
            ) => ExitCode::from(2),
            #[cfg(feature = "report")]
            Self::Report(ReportError::Unknown { .. }) => ExitCode::from(2),
            #[cfg(feature = "window")]
            Self::Window(WindowError::Scene(_) | WindowError::TooLarge { .. }) => ExitCode::from(2),
            _ => ExitCode::from(1),
        }
    }

    /// The options that ask for what the library says to ask for, which knows of none.
    fn options(&self) -> &'static str {
        match self {
            Self::Run(RunError::Scene(SceneError::NoRoom { .. })) => " (--balls, --size)",
            Self::Run(RunError::Scene(SceneError::SmallWorld { .. })) => " (--size)",
            #[cfg(feature = "window")]
            Self::Window(WindowError::Scene(SceneError::SmallWorld { .. })) => " (--size)",
            #[cfg(feature = "window")]
            Self::Window(WindowError::Scene(SceneError::NoRoom { .. })) => " (--balls, --size)",
            #[cfg(feature = "window")]
            Self::Window(WindowError::TooLarge { .. } | WindowError::GraphicsMemory { .. }) => " (--size)",
            Self::Run(
                RunError::Picture(_) | RunError::Animation { source: AnimationError::TooLarge { .. }, .. },
            ) => " (--size)",
            Self::Run(RunError::Animation { source: AnimationError::TooLong(_), .. }) => {
                " (--seconds, --deltas or --commands, --gif)"
            }
            Self::Run(RunError::Frames(FramesError::Seconds(_))) => " (--seconds)",
            Self::Run(RunError::Frames(FramesError::Rate(_))) => " (--fps)",
            Self::Run(RunError::Frames(FramesError::TooMany { .. })) => " (--seconds, --fps)",
            _ => "",
        }
    }

    fn is_broken_pipe(&self) -> bool {
        match self {
            Self::Run(error) => error.is_broken_pipe(),
            Self::Stdout(error) => error.kind() == io::ErrorKind::BrokenPipe,
            _ => false,
        }
    }
}

/// The scene that the command line names, as it wants it.
fn load(name: &OsStr, start: &SceneArgs) -> Result<Scene, Failure> {
    let mut scene = Scene::load_os(name)?;
    if let Some(solver) = start.solver {
        scene = scene.with_solver(solver);
    }
    if let Some(size) = start.size {
        scene = scene.with_size(size)?;
    }
    if start.balls > 0 {
        scene = scene.with_added(start.balls, start.seed);
    }
    Ok(scene)
}

#[cfg(feature = "window")]
fn open_window(args: &WindowArgs) -> Result<(), Failure> {
    let scene = load(&args.scene, &args.start)?;
    let timings = args.timings.then(carom::window::Timings::default);
    #[cfg(unix)]
    {
        let timings = timings.clone();
        signals::watch(move || {
            if let Some(timings) = timings {
                let _ = writeln!(io::stderr(), "{timings}");
            }
        });
    }
    panics::watch();
    let options = carom::window::Options {
        fullscreen: args.fullscreen,
        paused: args.paused,
        time_scale: args.scale,
        vsync: !args.no_vsync,
        watch: args.watch,
        quiet: args.quiet,
        timings,
        seed: args.start.seed,
    };
    Ok(carom::window::open(&scene, &options)?)
}

#[cfg(not(feature = "window"))]
fn open_window(args: &WindowArgs) -> Result<(), Failure> {
    load(&args.scene, &args.start)?;
    Err(Failure::NoWindow(args.scene.clone()))
}

fn run(args: RunArgs) -> Result<(), Failure> {
    let scene = load(&args.scene, &args.start)?;
    if args.start.seed.is_some() && args.start.balls == 0 {
        // Standard error may be gone; the run is not less for it.
        let _ = writeln!(
            io::stderr(),
            "carom: --seed is for the balls that --balls adds, and there are none; random balls of the scene's own \
             have their seed in the scene file"
        );
    }
    if args.commands.is_none() && !scene.has_balls() {
        let _ = writeln!(
            io::stderr(),
            "carom: {} has no balls, and nothing will happen; write a [[ball]] or a [[fill]] into it, or add some with \
             --balls",
            scene.argument()
        );
    }
    let file = scene.file().map(Path::to_owned);
    let course = match (&args.commands, &args.deltas) {
        (Some(path), _) => Course::Replay(Replay::read(path, &scene).map_err(RunError::from)?.into()),
        (None, Some(path)) => Course::Frames(scene.into(), Frames::read(path).map_err(RunError::from)?),
        (None, None) => {
            Course::Frames(scene.into(), Frames::even(args.seconds, args.fps).map_err(RunError::from)?)
        }
    };
    headless::run(&Run {
        course,
        inputs: file.into_iter().chain(args.deltas).chain(args.commands).collect(),
        trace: args.trace,
        every: args.every,
        image: args.image,
        gif: args.gif,
        check: args.check,
        summary: args.summary,
    })?;
    Ok(())
}

#[cfg(feature = "report")]
fn write_report(args: cli::ReportArgs) -> Result<(), Failure> {
    if let Some(cell) = args.cell {
        return Ok(write_stdout(&report::cell(&cell, args.quick)?)?);
    }
    let program = std::env::current_exe().ok();
    let options = report::Options { folder: args.out, quick: args.quick, only: args.only, program };
    let written = report::write(&options)?;
    Ok(write_stdout(&format!("{}\n", written.display()))?)
}

#[cfg(not(feature = "report"))]
fn write_report(_: cli::ReportArgs) -> Result<(), Failure> {
    Err(Failure::NoReport)
}

fn list_scenes(json: bool) -> Result<(), Failure> {
    let list = carom::scene::Listing::all()?;
    let text = if json {
        serde_json::to_string_pretty(&list).map_err(io::Error::from)? + "\n"
    } else {
        table(&list)
    };
    Ok(write_stdout(&text)?)
}

/// The scenes as a table for people.
fn table(list: &[carom::scene::Listing]) -> String {
    let uses: Vec<String> = list.iter().map(|scene| scene.uses.join(", ")).collect();
    let width = uses.iter().map(String::len).max().unwrap_or_default();
    let mut text =
        format!("{:<10} {:>5}  {:<8} {:<width$}  leaves out\n", "scene", "balls", "solver", "uses");
    for (scene, uses) in list.iter().zip(uses) {
        let (name, leaves_out) = (&scene.name, scene.leaves_out.join(", "));
        let line = format!("{name:<10} {:>5}  {:<8} {uses:<width$}  {leaves_out}", scene.balls, scene.solver);
        text += &format!("{}\n{:<16}  {}\n", line.trim_end(), "", scene.about);
    }
    text
}

fn print_scene(name: &OsStr) -> Result<(), Failure> {
    let scene = Scene::load_os(name)?;
    scene.file().map_or(Ok(()), headless::check_stdout)?;
    Ok(write_stdout(scene.source())?)
}

/// Prints help or the version, in the colours of a terminal where there is one.
fn print_help(help: &clap::Error) -> Result<(), Failure> {
    help.print()?;
    Ok(io::stdout().flush()?)
}

fn write_stdout(text: &str) -> io::Result<()> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes())?;
    stdout.flush()
}
