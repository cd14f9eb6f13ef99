//! `carom run`: the same simulation without a window.

mod check;
mod course;
mod frames;
mod output;
mod outputs;
mod patience;
mod progress;
mod summary;
mod unfinished;

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use thiserror::Error;

pub use check::Broken;
use check::Check;
pub use course::Course;
use course::Player;
pub use frames::{Frames, FramesError};
pub use output::{Output, OutputError};
use outputs::Outputs;
use patience::Patience;
pub(crate) use progress::Progress;
pub use summary::Summary;
use summary::Watched;
#[cfg(feature = "report")]
pub(crate) use unfinished::MadeFolders;
#[cfg(feature = "window")]
pub(crate) use unfinished::Unfinished;
pub use unfinished::discard_unfinished;

use crate::paint::{AnimationError, PictureTooLarge};
use crate::scene::SceneError;
use crate::session::ReplayError;
use crate::simulation::Simulation;
use crate::simulation::grid::Grid;
use crate::simulation::invariants::{energy, max_overlap, max_wall_overlap};

/// What to run and what to write of it.
#[derive(Debug)]
pub struct Run {
    /// What moves, and by which frames.
    pub course: Course,
    /// The files that the course was read from: no output takes their place.
    pub inputs: Vec<PathBuf>,
    /// A CSV of every ball's state at each traced frame.
    pub trace: Option<PathBuf>,
    /// Frame 1 and every `every`-th are traced; at least 1.
    pub every: u64,
    /// A PNG of the last frame.
    pub image: Option<PathBuf>,
    /// The run as an animated GIF.
    pub gif: Option<PathBuf>,
    /// Whether every frame is held against the laws ([`ledger`](crate::simulation::ledger)), and the first that breaks
    /// one ends the run, and leaves the frame before it as a scene file in the current folder. Not for a replay: the laws know
    /// nothing of what was done to its balls.
    pub check: bool,
    /// The summary as JSON. Without it, a readable one goes to standard output, or to standard error where another
    /// output is there.
    pub summary: Option<PathBuf>,
}

/// Why a run failed.
#[derive(Debug, Error)]
#[non_exhaustive]
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
    /// A replay is to be held against the laws.
    #[error(
        "a replay cannot be held against the laws, which know nothing of what was done to its balls; run it unchecked"
    )]
    ReplayChecked,
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
    #[error("two outputs go to {}; give each a path of its own", in_words(path))]
    SameOutput {
        /// Where both should go.
        path: PathBuf,
    },
    /// An output goes where an input is.
    #[error("{}", over_input(path))]
    OverInput {
        /// Where it should go.
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

/// That an output would go where an input is, and what to do.
fn over_input(path: &Path) -> String {
    if output::is_stdout(path) {
        "standard output goes to a file that is read, and would be changed; send it elsewhere".to_owned()
    } else {
        format!("{} is read, and would be written over; give the output a path of its own", path.display())
    }
}

/// Refuses to print what was read from this file into the same file, which standard output may have been sent to.
///
/// # Errors
/// [`RunError::OverInput`] where it was.
pub fn check_stdout(input: &Path) -> Result<(), RunError> {
    let stdout = Path::new("-");
    if input.is_file() && output::canonical(input) == stdout {
        return Err(RunError::OverInput { path: stdout.to_owned() });
    }
    Ok(())
}

/// A path as a message says it.
fn in_words(path: &Path) -> String {
    if output::is_stdout(path) { "standard output".to_owned() } else { path.display().to_string() }
}

/// Runs a scene and writes what is asked for: figures to standard output where no file is named for them, and how far it has come
/// to standard error, where that is a terminal.
///
/// # Errors
/// [`RunError`]; outputs that could not be completed are not there then.
pub fn run(run: &Run) -> Result<Summary, RunError> {
    run_by(run, |player, frame, wait| player.advance(frame, wait))
}

/// Runs a course whose frames `advance` takes; it calls now and then what shows that it is at work.
fn run_by(
    run: &Run,
    mut advance: impl FnMut(&mut Player<'_>, u64, &mut dyn FnMut()) -> Result<(), crate::OutOfRange>,
) -> Result<Summary, RunError> {
    if run.check && matches!(run.course, Course::Replay(_)) {
        return Err(RunError::ReplayChecked);
    }
    let mut player = Player::new(&run.course)?;
    let mut check = run.check.then(|| Check::new(run, player.simulation()));
    let mut outputs = Outputs::create(run, player.simulation())?;
    let (world, balls) = (player.simulation().world(), player.simulation().balls());
    let mut watched = Watched { energy_start: energy(world, balls), ..Watched::default() };
    let made_for = |simulation: &Simulation| (simulation.balls().len(), simulation.world().size());
    let (mut grid, mut made) = (Grid::new(balls, world.size()), made_for(player.simulation()));
    let clock_cost = clock_cost();
    let mut progress = Progress::new(player.frames(), "{wide_bar} {pos}/{len} frames{left}");
    let mut patience = Patience::new();

    for frame in 0..player.frames() {
        let start = Instant::now();
        patience.begin(frame + 1);
        advance(&mut player, frame, &mut || {
            progress.show(frame, "");
            if let Some(word) = patience.look() {
                progress.say(&word);
            }
        })?;
        watched.wall_seconds += start.elapsed().saturating_sub(clock_cost).as_secs_f64();
        watched.frames += 1;
        let simulation = player.simulation();
        if let Some(check) = &mut check {
            check.hold(run, frame + 1, player.delta(frame), simulation)?;
        }
        let (count, size) = made_for(simulation);
        if count > 2 * made.0 || size != made.1 {
            // Its cells suit neither many more balls nor another world.
            made = (count, size);
            grid = Grid::new(simulation.balls(), size);
        }
        watched.max_overlap = watched.max_overlap.max(max_overlap(&mut grid, simulation.balls()));
        let at_walls = max_wall_overlap(simulation.world(), simulation.balls());
        watched.max_wall_overlap = watched.max_wall_overlap.max(at_walls);
        outputs.add(run, frame + 1, player.played().seconds, simulation)?;
        progress.show(frame + 1, "");
    }
    drop(progress);

    if let Some(refused) = player.finish()? {
        // Standard error may be gone; the results are not there.
        let _ = writeln!(io::stderr(), "carom: {refused}");
    }
    watched.played = player.played();
    let summary = Summary::new(run.course.scene().name(), player.simulation(), &watched, player.fed());
    outputs.finish(player.simulation(), &summary)?;
    Ok(summary)
}

/// What reading the clock adds to a span that it measures: with few balls, as much as a tenth of a frame.
fn clock_cost() -> Duration {
    let span = |_| {
        let start = Instant::now();
        start.elapsed()
    };
    (0..1000).map(span).min().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::simulation::ledger::Law;

    fn checked(scene: &str) -> Run {
        Run {
            inputs: Vec::new(),
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
    fn a_scene_left_behind_takes_the_place_of_no_file_and_of_no_output() {
        let here = tempfile::tempdir().unwrap();
        let name = here.path().join("scene-frame-9").to_str().unwrap().to_owned();
        let path = |ending: &str| std::path::PathBuf::from(format!("{name}{ending}"));
        let run = Run { trace: Some(path("-2.toml")), ..checked("") };
        assert_eq!(check::free_path(&run, &name), path(".toml"));
        std::fs::write(path(".toml"), "mine").unwrap();
        assert_eq!(check::free_path(&run, &name), path("-3.toml"));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("nowhere", path("-3.toml")).unwrap();
            assert_eq!(check::free_path(&run, &name), path("-4.toml"));
        }
    }

    #[test]
    fn a_frame_left_behind_says_that_the_rain_is_not_in_it() {
        let rain = "size = [400, 300]\n[walls]\n[[ball]]\nposition = [200, 150]\nradius = 5\n[rain]\nrate = 1\n\
                    radius = 2\n";
        let mut doctored = checked(rain);
        let Course::Frames(scene, _) = &mut doctored.course else { panic!("no replay") };
        **scene = Scene::parse("it rains.toml", rain).unwrap();
        let faster = rain.replace("radius = 5", "radius = 5\nvelocity = [31, 0]");
        let mut other = Some(Scene::parse("faster.toml", &faster).unwrap().build().unwrap());
        let result = run_by(&doctored, |player, frame, wait| {
            let Player::Frames { simulation, .. } = player else { panic!("no replay") };
            if frame == 1 {
                **simulation = other.take().unwrap();
            }
            player.advance(frame, wait)
        });
        let Err(RunError::Broken(broken)) = result else { panic!("{result:?}") };
        let path = broken.file.as_ref().unwrap();
        let text = std::fs::read_to_string(path).unwrap();
        std::fs::remove_file(path).unwrap();
        for part in [
            "`carom run 'it rains.toml' --solver exact --check`",
            "carom run 'it rains-frame-1.toml'",
            "the rain is not",
        ] {
            assert!(text.contains(part), "{part} is not in: {text}");
        }
        assert!(Scene::parse("left.toml", &text).is_ok());
    }

    // Other systems have no such names.
    #[cfg(unix)]
    #[test]
    fn a_frame_is_left_behind_as_a_scene_file_whatever_the_scene_is_called() {
        let scene = "size = [400, 300]\n[[ball]]\nposition = [200, 150]\nradius = 5\nvelocity = [30, 0]\n";
        let faster = scene.replace("[30, 0]", "[31, 0]");
        for (name, left) in [
            ("a\nb\u{1b}[1m\u{7f}", "a\nb\u{1b}[1m\u{7f}-frame-1.toml".to_owned()),
            (&*"n".repeat(249), format!("{}-frame-1.toml", "n".repeat(200))),
        ] {
            let scene = Scene::parse(&format!("{name}.toml"), scene).unwrap();
            let checked =
                Run { course: Course::Frames(scene.into(), Frames::even(1.0, 60.0).unwrap()), ..checked("") };
            let mut other = Some(Scene::parse("faster.toml", &faster).unwrap().build().unwrap());
            let result = run_by(&checked, |player, frame, wait| {
                let Player::Frames { simulation, .. } = player else { panic!("no replay") };
                if frame == 1 {
                    **simulation = other.take().unwrap();
                }
                player.advance(frame, wait)
            });
            let Err(RunError::Broken(broken)) = result else { panic!("{result:?}") };
            let path = broken.file.as_ref().unwrap_or_else(|error| panic!("{error}"));
            let text = std::fs::read_to_string(path).unwrap();
            std::fs::remove_file(path).unwrap();
            assert_eq!(path, Path::new(&left));
            assert!(Scene::parse("left.toml", &text).is_ok(), "{text}");
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
        let result = run_by(&checked(scene), |player, frame, wait| {
            other.advance(player.delta(frame))?;
            let Player::Frames { simulation, .. } = player else { panic!("no replay") };
            if frame == 9 {
                std::mem::swap(&mut **simulation, &mut other);
                return Ok(());
            }
            player.advance(frame, wait)
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
