//! Scenes: what a simulation starts from, as data.
//!
//! A scene is a TOML file, built in or the user's own. It says which physics it wants; what it leaves out does not
//! exist for it. [`Scene::build`] makes a [`Simulation`] of it and decides there, once, which parts run; [`write()`]
//! makes a scene file of a simulation.
//!
//! All that a file may say, with the numbers that it has where it says nothing:
//!
//! ```
//! # let text = r#"
//! about = ""                     # one line on what it shows
//! solver = "exact"               # canvas, exact or contact
//! size = [1280, 720]             # px
//! gravity = [0, 0]               # px/s², y down
//!
//! [walls]                        # left out: no walls
//! restitution = 1                # 0 to 1; the balls' own do not count at walls
//!
//! [pairs]                        # left out: balls fly through each other
//! response = "impulse"           # or "detect"
//!
//! [[ball]]                       # as often as there are balls
//! position = [30, 50]            # px; must be said
//! radius = 30                    # px; must be said
//! velocity = [0, 0]              # px/s
//! mass = 1
//! restitution = 1                # 0 to 1; of two balls that meet, the smaller one counts
//! wide = false                   # true: meant to be wider than a world without walls
//!
//! [[ball]]
//! position = [640, 500]
//! radius = 30
//! fixed = true                   # nothing moves it; it has no velocity and no mass
//!
//! [[fill]]                       # random balls that overlap nothing; as often as wanted
//! count = 100                    # must be said
//! radius = [3, 6]                # px, one number or a range; must be said
//! speed = 0                      # px/s, one number or a range; the direction is random
//! density = 1                    # mass per px²; or mass = …
//! restitution = 1
//! seed = 1
//! region = [0, 0, 1280, 720]     # left, top, right, bottom: the whole world
//!
//! [rain]                         # random balls that fall in while there is room
//! rate = 200                     # balls a second; must be said
//! radius = [6, 12]               # and speed, density or mass, restitution, seed as in a fill
//! region = [0, 0, 1280, 48]      # four of the largest radii wide, where gravity comes from
//! # "#;
//! # assert_eq!(carom::Scene::parse("docs", text)?.build()?.balls().len(), 102);
//! # Ok::<(), carom::SceneError>(())
//! ```

mod advice;
mod catalogue;
mod error;
mod file;
mod fill;
mod listing;
mod places;
mod rain;
mod values;
mod write;

use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::thread;

use glam::DVec2;

pub use catalogue::{STAGES, names};
pub(crate) use error::shown;
pub use error::{Fault, SceneError};
pub use fill::Fill;
pub(crate) use fill::{filling, like_the_last};
pub use listing::Listing;
pub use rain::Rain;
pub use write::write;
pub(crate) use write::write_signed;

use crate::simulation::limits::MAX_BALLS;
use crate::simulation::{Ball, Simulation, Solver, World};

/// The world's size where a scene does not give one, px.
pub const DEFAULT_SIZE: DVec2 = DVec2::new(1280.0, 720.0);
/// The scene that the program opens with.
pub const DEFAULT_SCENE: &str = "gravity";
/// The longest scene file, bytes: that of two million balls. The parser takes up to fifty times as much memory.
const LONGEST_FILE: u64 = 1 << 27;
/// What a [replay](crate::session::Replay) begins with, which is no scene.
pub(crate) const REPLAY: &str = "carom replay ";
/// The most characters of a scene's name, which may be a path, that a message quotes.
pub(crate) const LONGEST_NAME: usize = 200;

/// A scene: a world, balls, random fills, and the solver that suits them.
///
/// ```
/// use carom::Scene;
///
/// let mut simulation = Scene::load("gravity")?.build()?;
/// assert_eq!(simulation.balls().len(), 15);
/// simulation.advance(1.0 / 60.0).expect("a frame's delta is in range");
/// # Ok::<(), carom::SceneError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The built-in scene's name, or the file's path, as far as that is text.
    origin: String,
    /// The file that it was loaded from.
    path: Option<PathBuf>,
    /// The text of the file.
    source: String,
    about: String,
    solver: Solver,
    world: World,
    balls: Vec<Ball>,
    fills: Vec<Fill>,
    rain: Option<Rain>,
    /// How many random balls to add, and their seed.
    added: Option<(usize, u64)>,
}

impl Scene {
    /// The built-in scene of this name, or the scene file at this path.
    ///
    /// # Errors
    /// [`SceneError`] where there is neither, or the file cannot be read or is not a scene.
    pub fn load(name: &str) -> Result<Self, SceneError> {
        Self::load_os(OsStr::new(name))
    }

    /// The same, of a name that may be a path whose bytes are not all text.
    ///
    /// # Errors
    /// [`SceneError`] as for [`load`](Self::load).
    pub fn load_os(name: &OsStr) -> Result<Self, SceneError> {
        let (path, name) = (Path::new(name), name.to_string_lossy());
        if let Some(builtin) = catalogue::find(&name) {
            return Self::parse(builtin.name, builtin.source);
        }
        if path.extension().is_none() && path.components().count() <= 1 {
            return Err(SceneError::Unknown { name: name.into_owned(), is_file: path.is_file() });
        }
        let source = read(path)?;
        if source.starts_with(REPLAY) {
            let scene = source.lines().find_map(|line| line.strip_prefix("scene ")).unwrap_or("SCENE");
            return Err(SceneError::Replay { path: path.to_owned(), scene: shown(scene, LONGEST_NAME) });
        }
        Self::of_file(path, &source)
    }

    /// A scene from the text of the file at this path, whose bytes may not all be text.
    pub(crate) fn of_file(path: &Path, source: &str) -> Result<Self, SceneError> {
        Ok(Self { path: Some(path.to_owned()), ..Self::parse(&path.to_string_lossy(), source)? })
    }

    /// A scene from the text of a scene file; messages call it `origin`.
    ///
    /// # Errors
    /// [`SceneError::Wrong`], with the line and what to write instead.
    pub fn parse(origin: &str, source: &str) -> Result<Self, SceneError> {
        let scene = file::parse(origin, source).map_err(SceneError::Wrong)?;
        Ok(Self { source: source.to_owned(), ..scene })
    }

    /// The same scene, moved on by another solver.
    #[must_use]
    pub fn with_solver(self, solver: Solver) -> Self {
        Self { solver, ..self }
    }

    /// The same scene in a world of another size, px. Of a fill's region and of rain's, what is within the new world counts: in the
    /// file, a region beyond the world is an error, but here it may be the screen that is too small, and what has room is drawn
    /// in what is left. [`build`](Self::build) says so where it has none.
    ///
    /// # Errors
    /// [`OutOfRange`](crate::OutOfRange) where a side is not in the range of sizes.
    pub fn with_size(self, size: DVec2) -> Result<Self, crate::OutOfRange> {
        Ok(Self { world: self.world.with_size(size)?, ..self })
    }

    /// The same scene with `count` random balls beside its own, the same for the same seed; no seed is seed 1. They take the
    /// place of balls that were added so before. [`build`](Self::build) places them, and fails where they find no room, or where
    /// all together are more than [`MAX_BALLS`].
    #[must_use]
    pub fn with_added(self, count: usize, seed: Option<u64>) -> Self {
        Self { added: Some((count, seed.unwrap_or(file::DEFAULT_SEED))), ..self }
    }

    /// The solver that moves it on.
    #[must_use]
    pub fn solver(&self) -> Solver {
        self.solver
    }

    /// How many random balls were [added](Self::with_added), and their seed.
    #[must_use]
    pub fn added(&self) -> Option<(usize, u64)> {
        self.added
    }

    /// The same scene with other random balls: fills, rain and added balls are all drawn anew, the same for the same
    /// seed. Where [nothing is random](Self::has_random_parts) it is the same scene.
    ///
    /// A fill so dense that it fits by chance may not fit with another seed, which [`build`](Self::build) then tells.
    #[must_use]
    pub fn reseeded(self, seed: u64) -> Self {
        let mut seeds = fill::seeds(seed);
        let mut next = || seeds.next().unwrap_or(seed);
        // In this order, so that what is added to a scene changes nothing of the scene itself.
        let fills = self.fills.into_iter().map(|fill| Fill { seed: next(), ..fill }).collect();
        let rain = self.rain.map(|rain| rain.reseeded(next()));
        let added = self.added.map(|(count, _)| (count, next()));
        Self { fills, rain, added, ..self }
    }

    /// Whether some of its balls are random: whether another seed would make it another scene.
    #[must_use]
    pub fn has_random_parts(&self) -> bool {
        let mut drawn = self.fills.iter().map(|fill| fill.count).chain(self.added.map(|(count, _)| count));
        self.rain.is_some() || drawn.any(|count| count > 0)
    }

    /// Whether it has a ball, or gets one: of a fill, [added](Self::with_added), or of its rain.
    #[must_use]
    pub fn has_balls(&self) -> bool {
        let placed = self.balls.len() + self.fills.iter().map(|fill| fill.count).sum::<usize>();
        placed > 0 || self.added.is_some_and(|(count, _)| count > 0) || self.rain.is_some()
    }

    /// The name to show: a built-in scene's own, or the file's without folder and ending.
    #[must_use]
    pub fn name(&self) -> &str {
        Path::new(&self.origin).file_stem().and_then(|stem| stem.to_str()).unwrap_or(&self.origin)
    }

    /// What [`load`](Self::load) finds this scene by: a built-in scene's name, or the file's path; or what whoever
    /// [parsed](Self::parse) its text called it. What is no text in a path stands there as U+FFFD; [`file`](Self::file) is the
    /// path itself.
    #[must_use]
    pub fn argument(&self) -> &str {
        &self.origin
    }

    /// The file that it was loaded from, or what whoever [parsed](Self::parse) its text called that; [`None`] where that is the
    /// name of a built-in scene.
    #[must_use]
    pub fn file(&self) -> Option<&Path> {
        let parsed = || catalogue::find(&self.origin).is_none().then(|| Path::new(&self.origin));
        self.path.as_deref().or_else(parsed)
    }

    /// One line on what the scene shows; may be empty.
    #[must_use]
    pub fn about(&self) -> &str {
        &self.about
    }

    /// The text of the scene file.
    #[must_use]
    pub fn source(&self) -> &str {
        &self.source
    }

    /// The world that the scene asks for.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The balls that fall in while it runs, if any do: at its beginning. Where there are any, [`Rain::advance`] takes the place of
    /// [`Simulation::advance`]:
    ///
    /// ```
    /// # use carom::Scene;
    /// let scene = Scene::load("rain")?;
    /// let mut simulation = scene.build()?;
    /// let mut rain = scene.rain().expect("it rains in this scene");
    /// rain.advance(&mut simulation, 2.0)?;
    /// assert!(simulation.balls().len() > 100);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn rain(&self) -> Option<Rain> {
        self.rain.clone()
    }

    /// What is said of a built-in scene in whose world only so many of a fill's balls find room: there is no file to mend.
    fn in_a_small_world(&self, placed: usize, count: usize) -> Option<SceneError> {
        catalogue::find(&self.origin).filter(|builtin| builtin.source == self.source)?;
        Some(SceneError::SmallWorld { scene: self.origin.clone(), size: self.world.size(), placed, count })
    }

    /// The simulation that this scene describes, at time 0, with its fills placed and its balls added. It may use all cores
    /// ([`Simulation::with_threads`]).
    ///
    /// Its rain is not in it: where [`rain`](Self::rain) is `Some`, move the simulation on with [`Rain::advance`]. With
    /// [`Simulation::advance`], no ball falls in.
    ///
    /// # Errors
    /// [`SceneError`] where balls do not fit, or are more than [`MAX_BALLS`].
    pub fn build(&self) -> Result<Simulation, SceneError> {
        let mut balls = self.balls.clone();
        for (stream, fill) in (0..).zip(&self.fills) {
            let placed = fill.place(&self.world, &balls, stream);
            if placed.len() < fill.count {
                if let Some(error) = self.in_a_small_world(placed.len(), fill.count) {
                    return Err(error);
                }
                let found = match fill.count {
                    1 => "the fill's ball found no room".to_owned(),
                    count => format!("only {} of the fill's {count} balls found room", placed.len()),
                };
                let size = self.world.size();
                // A file's regions lie in the world that it asks for; `with_size` may ask for another.
                let message = if fill.region.is_some_and(|(_, high)| !high.cmple(size).all()) {
                    format!(
                        "{found}: its region reaches beyond this world of {}x{} px; ask for a larger one, or write \
                         another region",
                        size.x, size.y
                    )
                } else {
                    format!("{found}; write a smaller count or radius, or a larger region or size")
                };
                return Err(SceneError::Wrong(Fault::at(&self.origin, &self.source, fill.offset, &message)));
            }
            balls.extend(placed);
        }
        if let Some((count, seed)) = self.added {
            let total = balls.len().saturating_add(count);
            if total > MAX_BALLS {
                return Err(crate::BuildError::TooManyBalls { count: total }.into());
            }
            let added = filling(count, &self.world, &balls, seed).place(&self.world, &balls, ADDED_STREAM);
            if added.len() < count {
                return Err(SceneError::NoRoom { placed: added.len(), count });
            }
            balls.extend(added);
        }
        Ok(Simulation::new(self.world, balls, self.solver)?.with_threads(cores()))
    }
}

/// The number of cores, found out once: that reads files.
fn cores() -> u32 {
    static CORES: OnceLock<u32> = OnceLock::new();
    *CORES.get_or_init(|| thread::available_parallelism().map_or(1, |cores| cores.get() as u32))
}

/// The stream of random numbers of added balls, apart from those of a file's fills of the same seed.
const ADDED_STREAM: u64 = 1 << 32;

/// The text of a scene file, which is at most [`LONGEST_FILE`] bytes long.
pub(crate) fn read(path: &Path) -> Result<String, SceneError> {
    let bytes = bytes_up_to(LONGEST_FILE, path)
        .map_err(|source| SceneError::Unreadable { path: path.to_owned(), source })?
        .ok_or_else(|| SceneError::TooLong { path: path.to_owned(), most: LONGEST_FILE })?;
    String::from_utf8(bytes).map_err(|error| {
        let origin = path.display().to_string();
        if is_utf_16(error.as_bytes()) {
            let message = "this is UTF-16; save the file as UTF-8";
            return SceneError::Wrong(Fault::at(&origin, "", None, message));
        }
        let (text, valid) = (String::from_utf8_lossy(error.as_bytes()), error.utf8_error().valid_up_to());
        let message = "this is not UTF-8; save the file in that encoding";
        SceneError::Wrong(Fault::at(&origin, &text, Some(valid), message))
    })
}

/// The text of a file; none where it is longer than so many bytes, and then no more than these are read.
pub(crate) fn read_up_to(most: u64, path: &Path) -> io::Result<Option<String>> {
    let text = bytes_up_to(most, path)?.map(String::from_utf8).transpose();
    text.map_err(|error| {
        let before = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = before.split(|&byte| byte == b'\n').count();
        let what = if is_utf_16(error.as_bytes()) {
            "this is UTF-16, not UTF-8".to_owned()
        } else {
            format!("line {line} is not UTF-8")
        };
        io::Error::new(io::ErrorKind::InvalidData, what)
    })
}

/// Whether a file's first bytes are the mark of UTF-16, which no UTF-8 begins with.
fn is_utf_16(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff")
}

fn bytes_up_to(most: u64, path: &Path) -> io::Result<Option<Vec<u8>>> {
    let mut bytes = Vec::new();
    // One byte more than allowed tells a file that is too long from one that just is not.
    File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= most).then_some(bytes))
}
