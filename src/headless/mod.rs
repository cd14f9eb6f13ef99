//! `carom run`: the same simulation without a window.

mod check;
mod course;
mod frames;
mod output;
mod summary;
mod unfinished;

use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use thiserror::Error;
use tiny_skia::Pixmap;

pub use check::Broken;
use check::Check;
pub use course::Course;
use course::Player;
pub use frames::{Frames, FramesError};
pub use output::{Output, OutputError};
pub use summary::Summary;
use summary::{Watched, energy};
#[cfg(feature = "window")]
pub(crate) use unfinished::Unfinished;
pub use unfinished::discard_unfinished;

use crate::paint::{self, Animation, AnimationError, Painter, PictureTooLarge};
use crate::scene::SceneError;
use crate::session::ReplayError;
use crate::simulation::Simulation;
use crate::simulation::grid::Grid;
use crate::simulation::invariants::{max_overlap, max_wall_overlap};

/// What to run and what to write of it.
#[derive(Debug)]
pub struct Run {
    /// What moves, and by which frames.
    pub course: Course,
    /// A CSV of every ball's state at each traced frame.
    pub trace: Option<PathBuf>,
    /// Frame 1 and every `every`-th are traced; at least 1.
    pub every: u64,
    /// A PNG of the last frame.
    pub image: Option<PathBuf>,
    /// The run as an animated GIF.
    pub gif: Option<PathBuf>,
    /// Whether every frame is held against the laws ([`ledger`](crate::simulation::ledger)), and the first that breaks
    /// one ends the run.
    pub check: bool,
    /// The summary as JSON. Without it, a readable one goes to standard output, or to standard error where another
    /// output is there.
    pub summary: Option<PathBuf>,
}

/// Why a run failed.
#[derive(Debug, Error)]
pub enum RunError {
    /// The scene is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The frames are wrong.
    #[error(transparent)]
    Frames(#[from] FramesError),
    /// The replay cannot be played.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// A delta was refused.
    #[error(transparent)]
    Delta(#[from] crate::OutOfRange),
    /// A frame broke a law.
    #[error(transparent)]
    Broken(#[from] Box<Broken>),
    /// An output cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The picture is too large.
    #[error(transparent)]
    Picture(#[from] PictureTooLarge),
    /// The animation cannot be made.
    #[error("{}: {source}", path.display())]
    Animation {
        /// Where it should have gone.
        path: PathBuf,
        /// What is wrong.
        source: AnimationError,
    },
    /// Two outputs go to the same place.
    #[error("two outputs go to {}; give each a path of its own", place(path))]
    SameOutput {
        /// Where both should go.
        path: PathBuf,
    },
}

impl RunError {
    /// Whether the reader of standard output went away, as `head` does: a reason to stop, not to complain.
    #[must_use]
    pub fn is_broken_pipe(&self) -> bool {
        match self {
            Self::Output(error) => error.is_broken_pipe(),
            _ => false,
        }
    }

    /// What went wrong with the animation at `path`: where it could not be written, the same as with any output.
    fn of_animation(path: &Path, source: AnimationError) -> Self {
        let path = path.to_owned();
        match source {
            AnimationError::Encoding(gif::EncodingError::Io(source)) => OutputError { path, source }.into(),
            source => Self::Animation { path, source },
        }
    }
}

/// A path as a message says it.
fn place(path: &Path) -> String {
    if output::is_stdout(path) { "standard output".to_owned() } else { path.display().to_string() }
}

/// How long a run takes before it shows its progress.
const PATIENCE: Duration = Duration::from_secs(1);

/// Runs a scene and writes what is asked for.
///
/// # Errors
/// [`RunError`]; outputs that could not be completed are not there then.
pub fn run(run: &Run) -> Result<Summary, RunError> {
    // The method itself is too particular about lifetimes.
    #[expect(clippy::redundant_closure_for_method_calls)]
    run_by(run, |player, frame| player.advance(frame))
}

/// Runs a course whose frames `advance` takes.
fn run_by(
    run: &Run,
    mut advance: impl FnMut(&mut Player<'_>, u64) -> Result<(), crate::OutOfRange>,
) -> Result<Summary, RunError> {
    let mut player = Player::new(&run.course)?;
    let mut check = run.check.then(|| Check::new(run, player.simulation()));
    let mut outputs = Outputs::create(run, player.simulation())?;
    let sorted_for = |simulation: &Simulation| (simulation.balls().len(), simulation.world().size());
    let mut grid = Grid::new(player.simulation().balls(), player.simulation().world().size());
    let mut sorted = sorted_for(player.simulation());
    let mut watched = Watched { energy_start: energy(player.simulation()), ..Watched::default() };
    let clock_cost = clock_cost();
    let mut progress = Progress::new(player.frames());

    for frame in 0..player.frames() {
        let start = Instant::now();
        advance(&mut player, frame)?;
        watched.wall_seconds += start.elapsed().saturating_sub(clock_cost).as_secs_f64();
        watched.frames += 1;
        let simulation = player.simulation();
        if let Some(check) = &mut check {
            check.hold(run, frame + 1, player.delta(frame), simulation)?;
        }
        let now = sorted_for(simulation);
        if now.0 > 2 * sorted.0 || now.1 != sorted.1 {
            // Cells for what has come since.
            sorted = now;
            grid = Grid::new(simulation.balls(), simulation.world().size());
        }
        watched.max_overlap = watched.max_overlap.max(max_overlap(&mut grid, simulation.balls()));
        let at_walls = max_wall_overlap(simulation.world(), simulation.balls());
        watched.max_wall_overlap = watched.max_wall_overlap.max(at_walls);
        outputs.add(run, frame + 1, simulation)?;
        progress.show(frame + 1);
    }
    drop(progress);

    player.finish()?;
    let summary = Summary::new(run.course.scene().name(), player.simulation(), &watched);
    outputs.finish(player.simulation(), &summary)?;
    Ok(summary)
}

/// The outputs of a run, opened before it so that a wrong path is known at once.
struct Outputs {
    trace: Option<Output>,
    image: Option<Output>,
    gif: Option<(Animation<Output>, PathBuf)>,
    summary: Option<Output>,
    /// What frames are painted on, where any are.
    canvas: Option<Pixmap>,
    painter: Painter,
    stdout_taken: bool,
}

impl Outputs {
    fn create(run: &Run, simulation: &Simulation) -> Result<Self, RunError> {
        let mut places = Vec::new();
        for path in [&run.trace, &run.image, &run.gif, &run.summary].into_iter().flatten() {
            let place = output::place(path);
            if places.contains(&place) {
                return Err(RunError::SameOutput { path: path.clone() });
            }
            places.push(place);
        }
        let create = |path: &Option<PathBuf>| path.as_deref().map(Output::create).transpose();
        let (trace, image) = (create(&run.trace)?, create(&run.image)?);
        let (gif, summary) = (create(&run.gif)?, create(&run.summary)?);
        let stdout_taken = places.iter().any(|place| output::is_stdout(place));
        let canvas = (image.is_some() || gif.is_some()).then(|| paint::blank(simulation.world().size()));
        let canvas = canvas.transpose()?;
        let gif = match (gif, &canvas, &run.gif) {
            (Some(output), Some(canvas), Some(path)) => {
                let animation = Animation::new(output, canvas.width(), canvas.height())
                    .map_err(|source| RunError::of_animation(path, source))?;
                Some((animation, path.clone()))
            }
            _ => None,
        };
        let mut outputs =
            Self { trace, image, gif, summary, canvas, painter: Painter::default(), stdout_taken };
        outputs.write_trace(|trace| writeln!(trace, "frame,time,ball,x,y,vx,vy,colliding"))?;
        Ok(outputs)
    }

    /// Writes what a frame, from 1, adds.
    fn add(&mut self, run: &Run, frame: u64, simulation: &Simulation) -> Result<(), RunError> {
        if frame == 1 || frame.is_multiple_of(run.every.max(1)) {
            let time = simulation.time();
            self.write_trace(|trace| {
                let states = simulation.balls().iter().zip(simulation.touching()).enumerate();
                for (index, (ball, &touching)) in states {
                    let (p, v, colliding) = (ball.position(), ball.velocity(), u8::from(touching));
                    writeln!(trace, "{frame},{time},{index},{},{},{},{},{colliding}", p.x, p.y, v.x, v.y)?;
                }
                Ok(())
            })?;
        }
        if let (Some((animation, path)), Some(canvas)) = (&mut self.gif, &mut self.canvas) {
            self.painter.repaint(simulation, 1.0, &mut canvas.as_mut());
            let added = animation.add(simulation.time(), canvas);
            added.map_err(|source| RunError::of_animation(path, source))?;
        }
        Ok(())
    }

    fn write_trace(&mut self, write: impl FnOnce(&mut Output) -> io::Result<()>) -> Result<(), OutputError> {
        let Some(trace) = &mut self.trace else { return Ok(()) };
        let Err(error) = write(trace) else { return Ok(()) };
        let error = trace.error(error);
        if error.is_broken_pipe() && (self.image.is_some() || self.gif.is_some() || self.summary.is_some()) {
            // Nobody reads on, but the files are still wanted.
            self.trace = None;
            return Ok(());
        }
        Err(error)
    }

    /// Completes every output that can be, and then tells of the first that could not.
    fn finish(self, simulation: &Simulation, summary: &Summary) -> Result<(), RunError> {
        let Self { trace, image, gif, summary: json, canvas, mut painter, stdout_taken } = self;
        let traced = trace.map_or(Ok(()), Output::finish);
        let animated: Result<(), RunError> = gif.map_or(Ok(()), |(animation, path)| {
            let finished = animation.finish(simulation.time());
            Ok(finished.map_err(|source| RunError::of_animation(&path, source))?.finish()?)
        });
        let painted = image.zip(canvas).map_or(Ok(()), |(image, mut canvas)| {
            if let Ok(blank) = paint::blank(simulation.world().size())
                && (blank.width(), blank.height()) != (canvas.width(), canvas.height())
            {
                // The world has been resized.
                canvas = blank;
            }
            painter.repaint(simulation, 1.0, &mut canvas.as_mut());
            let png = canvas.encode_png().map_err(|error| image.error(io::Error::other(error)))?;
            image.complete(&png)
        });
        let summarised = match json {
            Some(output) => match serde_json::to_string_pretty(summary) {
                Ok(json) => output.complete(format!("{json}\n").as_bytes()),
                Err(error) => Err(output.error(error.into())),
            },
            None if stdout_taken => {
                // Standard error may be gone; the results are not there.
                let _ = writeln!(io::stderr(), "{summary}");
                Ok(())
            }
            None => {
                let text = format!("{summary}\n");
                Output::create("-".as_ref()).and_then(|stdout| stdout.complete(text.as_bytes()))
            }
        };
        traced?;
        animated?;
        painted?;
        summarised?;
        Ok(())
    }
}

/// What reading the clock adds to a span that it measures: with few balls, as much as a tenth of a frame.
fn clock_cost() -> Duration {
    let span = |_| {
        let start = Instant::now();
        start.elapsed()
    };
    (0..1000).map(span).min().unwrap_or_default()
}

/// A progress bar that shows itself only in long runs, and only on a terminal.
struct Progress {
    start: Instant,
    frames: u64,
    bar: Option<ProgressBar>,
}

impl Progress {
    fn new(frames: u64) -> Self {
        Self { start: Instant::now(), frames, bar: None }
    }

    fn show(&mut self, frame: u64) {
        if let Some(bar) = &self.bar {
            bar.set_position(frame);
        } else if self.start.elapsed() > PATIENCE && io::stderr().is_terminal() {
            let style = ProgressStyle::with_template("{wide_bar} {pos}/{len} frames, {eta} left");
            let bar = ProgressBar::new(self.frames);
            self.bar = Some(bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar())));
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::simulation::ledger::Law;

    fn checked(scene: &str) -> Run {
        Run {
            course: Course::Frames(
                Scene::parse("doctored.toml", scene).unwrap().into(),
                Frames::even(1.0, 60.0).unwrap(),
            ),
            trace: None,
            every: 1,
            image: None,
            gif: None,
            check: true,
            summary: Some("/dev/null".into()),
        }
    }

    #[test]
    fn the_first_frame_that_breaks_a_law_ends_the_run_and_leaves_the_frame_before() {
        let scene =
            "size = [400, 300]\n[walls]\n[[ball]]\nposition = [200, 150]\nradius = 5\nvelocity = [30, 0]\n";
        let faster = scene.replace("[30, 0]", "[31, 0]");
        assert!(run(&checked(scene)).is_ok());
        // From frame 10 on, the frames of a ball that flies faster.
        let mut other = Scene::parse("faster.toml", &faster).unwrap().build().unwrap();
        let result = run_by(&checked(scene), |player, frame| {
            other.advance(player.delta(frame))?;
            let Player::Frames { simulation, .. } = player else { panic!("no replay") };
            if frame == 9 {
                std::mem::swap(&mut **simulation, &mut other);
                return Ok(());
            }
            player.advance(frame)
        });
        let Err(RunError::Broken(broken)) = result else { panic!("{result:?}") };
        assert_eq!((broken.frame, broken.violation.law), (10, Law::Energy));
        assert!((broken.time - 9.0 / 60.0).abs() < 1e-12);
        let path = broken.file.as_ref().unwrap();
        assert_eq!(path, Path::new("doctored-frame-9.toml"));
        let left = Scene::load("./doctored-frame-9.toml").unwrap().build().unwrap();
        std::fs::remove_file(path).unwrap();
        assert!((left.balls()[0].position().x - (200.0 + 30.0 * 8.0 / 60.0)).abs() < 1e-9);
        let message = broken.to_string();
        for part in ["frame 10, at 0.1", "the law of energy", "rose to 4.805", "doctored-frame-9.toml"] {
            assert!(message.contains(part), "{part} is not in: {message}");
        }
    }
}
