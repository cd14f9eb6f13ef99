//! The command line.

use std::env;
use std::ffi::OsString;
use std::path::PathBuf;
use std::str::FromStr;

use carom::simulation::limits::{MAX_BALLS, SIZE};
use carom::{DVec2, Solver};
use clap::builder::{PathBufValueParser, TypedValueParser};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Args, CommandFactory, Parser, Subcommand};

const EXAMPLES: &str = "\
Examples:
  carom                                 open the demo's last stage
  carom elastic --balls 50 --seed 7     another scene, with fifty random balls more
  carom mine.toml --size 800x600        a scene file of your own
  carom run gravity --gif fall.gif      the same without a window

In the window, H lists the keys.";

const RUN_EXAMPLES: &str = "\
Examples:
  carom run gravity --seconds 5 --gif gravity.gif
  carom run elastic --seconds 60 --fps 240 --summary -
  carom run gravity --deltas frames.txt --trace states.csv --every 10
  carom run gravity --commands carom-gravity-1.replay --trace states.csv
  carom run walls --size 800x600 --seconds 0 --image first.png";

const REPORT_EXAMPLES: &str = "\
Examples:
  carom report                          everything, in report/report.md, in some minutes
  carom report --quick --out quick      a shorter one
  carom report --only gravity-1s        one problem, section or case alone";

/// Bouncing balls in a window: the canvas physics demo, native.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES, args_conflicts_with_subcommands = true)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
    #[command(flatten)]
    pub window: WindowArgs,
}

/// Words that are more like each other than this may be meant for each other.
const ALIKE: f64 = 0.6;

impl Cli {
    /// What the program was called with.
    ///
    /// # Errors
    /// What is to be said instead of running: help or the version where it was asked for, or why the call makes no sense.
    pub fn of_this_call() -> Result<Self, clap::Error> {
        let words: Vec<_> = env::args_os().collect();
        let refused = |message| Self::command().error(ErrorKind::UnknownArgument, message);
        match Self::try_parse_from(&words) {
            Ok(Self { command: None, window }) if commands().iter().any(|name| window.scene == **name) => {
                Err(refused(comes_first(&window.scene.to_string_lossy())))
            }
            Err(error) if error.kind() == ErrorKind::ArgumentConflict => {
                // With a scene of its own, the program takes what comes behind it for a command that does not go with that.
                let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else {
                    return Err(error);
                };
                let words: Vec<_> = words.iter().map(|word| word.to_string_lossy()).collect();
                Err(refused(misplaced(word, &words)))
            }
            call => call,
        }
    }
}

/// The names of the commands that there are.
fn commands() -> Vec<String> {
    let cli = Cli::command();
    let shown = cli.get_subcommands().filter(|command| !command.is_hide_set());
    shown.map(|command| command.get_name().to_owned()).collect()
}

fn comes_first(command: &str) -> String {
    format!("{command} comes first: carom {command} …")
}

/// What is wrong in a call with these words, where this one stands behind a scene.
fn misplaced(word: &str, words: &[impl AsRef<str>]) -> String {
    let commands = commands();
    if let Some(command) = commands.iter().find(|name| words.iter().any(|word| word.as_ref() == **name)) {
        return comes_first(command);
    }
    let at = words.iter().position(|known| known.as_ref() == word).unwrap_or_default();
    let before =
        words[..at].iter().map(AsRef::as_ref).rfind(|word| !word.starts_with('-')).unwrap_or_default();
    let likeness = |name: &str| strsim::normalized_damerau_levenshtein(before, name);
    let meant = commands.iter().max_by(|one, other| likeness(one).total_cmp(&likeness(other)));
    match meant.filter(|name| likeness(name) > ALIKE) {
        Some(name) => format!("there is no command '{before}'; did you mean '{name}'?"),
        None => format!("'{word}' is one word too many; the window shows one scene"),
    }
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scene without a window
    #[command(after_help = RUN_EXAMPLES)]
    Run(Box<RunArgs>),
    /// Measure the solvers: error against run time, extreme cases, what each part costs
    #[command(after_help = REPORT_EXAMPLES, hide = cfg!(not(feature = "report")))]
    Report(ReportArgs),
    /// List the built-in scenes: what each shows, uses and leaves out
    #[command(after_help = "Examples:\n  carom scenes\n  carom scenes --json")]
    Scenes {
        /// As JSON
        #[arg(long)]
        json: bool,
    },
    /// Print a scene as a scene file, a start for one's own
    #[command(after_help = "Examples:\n  carom scene gravity > mine.toml\n  carom mine.toml")]
    Scene {
        /// A built-in scene's name or a .toml file
        scene: OsString,
    },
}

/// What starts a scene, with a window and without.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// How balls are moved on: canvas, exact or contact [default: the scene's own]
    #[arg(long)]
    pub solver: Option<Solver>,
    /// Add N random balls, smaller ones where there is no room for larger
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        hide_default_value = true,
        value_parser = balls,
        allow_negative_numbers = true
    )]
    pub balls: usize,
    /// The seed of the random balls that are added: the same seed, the same balls [default: 1]
    #[arg(long, value_name = "N", value_parser = seed, allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// The world's size in px, such as 1280x720; regions of random balls that reach beyond it end there
    /// [default: the scene's own]
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<DVec2>,
}

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "independent switches of the command line")]
pub struct WindowArgs {
    /// A built-in scene's name or a .toml file
    #[arg(default_value = carom::scene::DEFAULT_SCENE)]
    pub scene: OsString,
    #[command(flatten)]
    pub start: SceneArgs,
    /// Fill the screen
    #[arg(long)]
    pub fullscreen: bool,
    /// Start paused; Space goes on
    #[arg(long)]
    pub paused: bool,
    /// Time scale: 0.5 is half speed
    #[arg(long, value_name = "F", default_value_t = 1.0, value_parser = scale, allow_negative_numbers = true)]
    pub scale: f64,
    /// Load the scene file again whenever it is saved
    #[arg(long)]
    pub watch: bool,
    /// Neither hint nor messages over the picture
    #[arg(long)]
    pub quiet: bool,
    /// Present frames at once instead of with the screen's refresh
    #[arg(long)]
    pub no_vsync: bool,
    /// Print, when the window closes, where the frames' time went; docs/command-line.md says what each word means
    #[arg(long)]
    pub timings: bool,
}

#[derive(Debug, Args)]
pub struct RunArgs {
    /// A built-in scene's name or a .toml file
    pub scene: OsString,
    #[command(flatten)]
    pub start: SceneArgs,
    /// Simulated time in seconds; the first frame has 0, so 0 seconds is one frame [default: 10]
    #[arg(
        long,
        value_name = "T",
        default_value_t = 10.0,
        hide_default_value = true,
        value_parser = seconds,
        allow_negative_numbers = true
    )]
    pub seconds: f64,
    /// Frames per second of simulated time
    #[arg(long, value_name = "F", default_value_t = 60.0, value_parser = rate, allow_negative_numbers = true)]
    pub fps: f64,
    /// Take the frames' deltas from a file: seconds, one a line
    #[arg(long, value_name = "FILE", conflicts_with_all = ["seconds", "fps"])]
    pub deltas: Option<PathBuf>,
    /// Do again what was done in a window, frame by frame: a replay that it saved with Ctrl+Shift+S, with its own frames,
    /// solver, balls and size, and unchecked
    #[arg(long, value_name = "FILE", conflicts_with_all = ["seconds", "fps", "deltas", "solver", "balls", "seed", "size", "check"])]
    pub commands: Option<PathBuf>,
    /// Write every ball's state after each frame as CSV
    #[arg(long, value_name = "FILE.csv")]
    pub trace: Option<PathBuf>,
    /// Trace frame 1 and every K-th
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = every, allow_negative_numbers = true, requires = "trace")]
    pub every: u64,
    /// Write the last frame as a picture
    #[arg(long, value_name = "FILE.png", value_parser = PathBufValueParser::new().try_map(|path| ending_in(path, "png")))]
    pub image: Option<PathBuf>,
    /// Write the run as an animated GIF
    #[arg(long, value_name = "FILE.gif", value_parser = PathBufValueParser::new().try_map(|path| ending_in(path, "gif")))]
    pub gif: Option<PathBuf>,
    /// Hold every frame against the laws (numbers, walls, overlap, energy, momentum, free flight); the first that
    /// breaks one ends the run, and leaves the scene of the frame before
    #[arg(long)]
    pub check: bool,
    /// Write the figures of the run as JSON, instead of a readable summary on standard output
    #[arg(long, value_name = "FILE.json")]
    pub summary: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct ReportArgs {
    /// The folder to write the report to
    #[arg(long, value_name = "DIR", default_value = "report")]
    pub out: PathBuf,
    /// Every second setting, fewer runs and less patience
    #[arg(long)]
    pub quick: bool,
    /// One section, problem or case alone; a wrong name lists all
    #[arg(long, value_name = "NAME")]
    pub only: Option<String>,
    /// Run one cell of the stability table, as the report does in a process of its own
    #[arg(long, value_name = "CASE/SOLVER", hide = true)]
    pub cell: Option<String>,
}

fn balls(text: &str) -> Result<usize, String> {
    // How many are too many, only the scene knows.
    parsed(text, &format!("write a whole number from 0 to {MAX_BALLS}, such as 50"))
}

fn seed(text: &str) -> Result<u64, String> {
    parsed(text, &format!("write a whole number from 0 to {}, such as 7", u64::MAX))
}

fn seconds(text: &str) -> Result<f64, String> {
    parsed(text, "write a number of seconds, such as 2.5")
}

fn rate(text: &str) -> Result<f64, String> {
    parsed(text, "write a number of frames per second, such as 60")
}

fn every(text: &str) -> Result<u64, String> {
    const WRITE: &str = "write a whole number from 1, such as 10";
    parsed(text, WRITE).and_then(|every| if every > 0 { Ok(every) } else { Err(WRITE.to_owned()) })
}

fn parsed<T: FromStr>(text: &str, write: &str) -> Result<T, String> {
    text.parse().map_err(|_| write.to_owned())
}

/// The endings of pictures and films, one of which does not do for another.
const ENDINGS: [&str; 14] =
    ["png", "gif", "apng", "avif", "bmp", "jpeg", "jpg", "mkv", "mp4", "pdf", "svg", "tif", "tiff", "webp"];

/// A path that does not promise another kind of file than the one that will be there.
fn ending_in(path: PathBuf, wanted: &str) -> Result<PathBuf, String> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    match ending {
        Some(ending) if ending != wanted && ENDINGS.contains(&ending.as_str()) => {
            Err(format!("what is written is a {wanted}; name it {}", path.with_extension(wanted).display()))
        }
        _ => Ok(path),
    }
}

fn size(text: &str) -> Result<DVec2, String> {
    let parse = || {
        let (width, height) = text.split_once(['x', 'X'])?;
        Some((width.parse::<u64>().ok()?, height.parse::<u64>().ok()?))
    };
    let (width, height) = parse().ok_or("write width and height in whole px, such as 1280x720")?;
    let size = DVec2::new(width as f64, height as f64);
    SIZE.check_vector(size).map_err(|error| error.to_string())
}

fn scale(text: &str) -> Result<f64, String> {
    let (low, high) = carom::session::TIME_SCALES;
    let parsed = text.parse().ok().filter(|scale| (low..=high).contains(scale));
    parsed.ok_or_else(|| format!("write a factor from {low} to {high}, such as 0.5"))
}
