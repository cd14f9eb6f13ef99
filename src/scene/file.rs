//! The scene file: TOML to a [`Scene`], every number checked where it stands.

use std::fmt;
use std::ops::Range;

use glam::DVec2;
use serde::Deserialize;
use toml::Spanned;

use super::advice::advice;
use super::error::{Fault, place_of};
use super::fill::{Fill, Material};
use super::rain::{RAIN_RATE, Rain};
use super::values::{Corners, Count, Interval, Named, Number, Pair, Table};
use super::{DEFAULT_SIZE, Scene};
use crate::simulation::limits::{
    COORDINATE, GRAVITY, MASS, MAX_BALLS, Quantity, RADIUS, RESTITUTION, SIZE, VELOCITY,
};
use crate::simulation::{Ball, Pairs, Solver, UnknownSolver, World};

/// A speed of random balls: in the range of a component of a velocity, but never negative.
static SPEED: Quantity = Quantity { name: "speed", low: 0.0, ..VELOCITY };
/// Mass per area of random balls.
static DENSITY: Quantity = Quantity { name: "density", unit: "per px²", ..MASS };
/// The seed where nobody asks for one.
pub(super) const DEFAULT_SEED: u64 = 1;

/// Reads a scene from its text. `origin` is what messages call it.
pub(super) fn parse(origin: &str, source: &str) -> Result<Scene, Fault> {
    let fault = |at: At| Fault::at(origin, source, at.offset, &at.message);
    let file: File = toml::from_str(source).map_err(|error| {
        let offset = error.span().map(|span| span.start);
        let (line, column) = offset.map_or(("", 0), |offset| {
            let place = place_of(source, offset);
            (place.line, place.column)
        });
        fault(At { offset, message: advice(error.message(), line, column) })
    })?;
    file.into_scene(origin).map_err(fault)
}

/// The most characters of a scene's description.
pub(super) const LONGEST_ABOUT: usize = 1000;
/// The most fills of a scene: each looks at all balls before it.
const MOST_FILLS: usize = 1000;

/// A message and the byte that it is about.
struct At {
    offset: Option<usize>,
    message: String,
}

fn at(span: Range<usize>, message: impl fmt::Display) -> At {
    At { offset: Some(span.start), message: message.to_string() }
}

/// A value that remembers where it stands.
trait Place<T: Copy> {
    /// The result of `check`, or its error with the place.
    fn checked<U, E: fmt::Display>(&self, check: impl FnOnce(T) -> Result<U, E>) -> Result<U, At>;
}

impl<T: Copy> Place<T> for Spanned<T> {
    fn checked<U, E: fmt::Display>(&self, check: impl FnOnce(T) -> Result<U, E>) -> Result<U, At> {
        check(*self.get_ref()).map_err(|error| at(self.span(), error))
    }
}

/// What moves a scene on that does not say: the solver that is right for all but piles.
const DEFAULT_SOLVER: Solver = Solver::Exact;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    about: Option<Spanned<String>>,
    solver: Option<Spanned<String>>,
    size: Option<Spanned<Pair>>,
    gravity: Option<Spanned<Pair>>,
    walls: Option<Table<WallsTable>>,
    pairs: Option<Table<PairsTable>>,
    #[serde(default, rename = "ball")]
    balls: Vec<Spanned<Table<BallTable>>>,
    #[serde(default, rename = "fill")]
    fills: Vec<Spanned<Table<FillTable>>>,
    rain: Option<Table<RainTable>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WallsTable {
    restitution: Option<Spanned<Number>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PairsTable {
    #[serde(default)]
    response: Response,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "lowercase", expecting = "\"impulse\" or \"detect\"")]
enum Response {
    #[default]
    Impulse,
    Detect,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BallTable {
    position: Spanned<Pair>,
    radius: Spanned<Number>,
    velocity: Option<Spanned<Pair>>,
    mass: Option<Spanned<Number>>,
    restitution: Option<Spanned<Number>>,
    fixed: Option<bool>,
    /// Whether it is meant to be wider than the world, where there are no walls that it has to fit between.
    wide: Option<bool>,
}

/// What a fill and rain have in common.
struct RandomBalls<'a> {
    radius: &'a Spanned<Interval>,
    speed: Option<&'a Spanned<Interval>>,
    density: Option<&'a Spanned<Number>>,
    mass: Option<&'a Spanned<Number>>,
    restitution: Option<&'a Spanned<Number>>,
    seed: Option<&'a Count>,
    region: Option<&'a Spanned<Corners>>,
}

/// A table of random balls, with one key of its own. (Serde's `flatten` would neither refuse unknown keys nor know
/// where a value stands.)
macro_rules! random_balls {
    ($table:ident, $own:ident: $type:ty) => {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct $table {
            $own: Spanned<$type>,
            radius: Spanned<Interval>,
            speed: Option<Spanned<Interval>>,
            density: Option<Spanned<Number>>,
            mass: Option<Spanned<Number>>,
            restitution: Option<Spanned<Number>>,
            seed: Option<Count>,
            region: Option<Spanned<Corners>>,
        }

        impl $table {
            fn balls(&self) -> RandomBalls<'_> {
                RandomBalls {
                    radius: &self.radius,
                    speed: self.speed.as_ref(),
                    density: self.density.as_ref(),
                    mass: self.mass.as_ref(),
                    restitution: self.restitution.as_ref(),
                    seed: self.seed.as_ref(),
                    region: self.region.as_ref(),
                }
            }
        }
    };
}

random_balls!(FillTable, count: Count);
random_balls!(RainTable, rate: Number);

impl Named for WallsTable {
    const NAME: &str = "[walls]";
}

impl Named for PairsTable {
    const NAME: &str = "[pairs]";
}

impl Named for BallTable {
    const NAME: &str = "[[ball]]";
}

impl Named for FillTable {
    const NAME: &str = "[[fill]]";
}

impl Named for RainTable {
    const NAME: &str = "[rain]";
}

impl File {
    fn into_scene(self, origin: &str) -> Result<Scene, At> {
        let solver = match &self.solver {
            None => DEFAULT_SOLVER,
            Some(name) => name.get_ref().parse().map_err(|error: UnknownSolver| at(name.span(), error))?,
        };
        let size = match &self.size {
            None => DEFAULT_SIZE,
            Some(size) => vector(size, &SIZE, ["width", "height"])?,
        };
        let world = self.world(size)?;
        let balls = self.balls(size)?;
        let fills = self.fills(size, balls.len())?;
        let rain = self.rain.map(|Table(rain)| rain.rain(size)).transpose()?;
        let about = self.about.map_or(Ok(String::new()), checked_about)?;
        Ok(Scene {
            origin: origin.to_owned(),
            path: None,
            source: String::new(),
            about,
            solver,
            world,
            balls,
            fills,
            rain,
            added: None,
        })
    }

    fn world(&self, size: DVec2) -> Result<World, At> {
        let mut world = World::new(size).map_err(|error| At { offset: None, message: error.to_string() })?;
        if let Some(gravity) = &self.gravity {
            let gravity = vector(gravity, &GRAVITY, ["x", "y"])?;
            world = world.with_gravity(gravity).expect("gravity was checked");
        }
        if let Some(Table(walls)) = &self.walls {
            let restitution = optional(walls.restitution.as_ref(), &RESTITUTION, 1.0)?;
            world = world.with_walls(restitution).expect("the walls' restitution was checked");
        }
        if let Some(Table(pairs)) = &self.pairs {
            world = world.with_pairs(match pairs.response {
                Response::Impulse => Pairs::Impulse,
                Response::Detect => Pairs::Detect,
            });
        }
        Ok(world)
    }

    fn balls(&self, size: DVec2) -> Result<Vec<Ball>, At> {
        let mut balls = Vec::with_capacity(self.balls.len());
        for table in &self.balls {
            let Table(table) = table.get_ref();
            let ball = table.ball()?;
            if self.walls.is_some() {
                check_width(table.radius.span(), ball.radius(), size, "")?;
            } else if table.wide != Some(true) {
                check_width(table.radius.span(), ball.radius(), size, OR_WIDE)?;
            }
            balls.push(ball);
        }
        Ok(balls)
    }

    /// The fills, which come after so many balls.
    fn fills(&self, size: DVec2, balls: usize) -> Result<Vec<Fill>, At> {
        if let Some(table) = self.fills.get(MOST_FILLS) {
            let message =
                format!("the scene has more than {MOST_FILLS} fills; write fewer, of more balls each");
            return Err(at(table.span(), message));
        }
        let mut fills = Vec::with_capacity(self.fills.len());
        let mut total = balls;
        for table in &self.fills {
            let Table(fill) = table.get_ref();
            let count_at = fill.count.span();
            let fill = fill.fill(size, table.span().start)?;
            total = total.saturating_add(fill.count);
            if total > MAX_BALLS {
                let message = format!("the scene has {total} balls; a simulation takes at most {MAX_BALLS}");
                return Err(at(count_at, message));
            }
            fills.push(fill);
        }
        Ok(fills)
    }
}

fn checked_about(about: Spanned<String>) -> Result<String, At> {
    let count = about.get_ref().chars().count();
    if count <= LONGEST_ABOUT {
        return Ok(about.into_inner());
    }
    Err(at(about.span(), format!("about has {count} characters; write at most {LONGEST_ABOUT}")))
}

impl BallTable {
    fn ball(&self) -> Result<Ball, At> {
        let position = vector(&self.position, &COORDINATE, ["x", "y"])?;
        let mut ball = self.radius.checked(|Number(radius)| Ball::new(position, radius))?;
        if self.fixed == Some(true) {
            self.check_fixed()?;
            ball = ball.fixed();
        }
        if let Some(velocity) = &self.velocity {
            let checked = vector(velocity, &VELOCITY, ["x", "y"])?;
            ball = ball.with_velocity(checked).map_err(|error| at(velocity.span(), error))?;
        }
        if let Some(mass) = &self.mass {
            ball = mass.checked(|Number(mass)| ball.with_mass(mass))?;
        }
        if let Some(restitution) = &self.restitution {
            ball = restitution.checked(|Number(restitution)| ball.with_restitution(restitution))?;
        }
        Ok(ball)
    }

    /// Checks that nothing is said beside `fixed = true` that a fixed ball does not have.
    fn check_fixed(&self) -> Result<(), At> {
        match (&self.velocity, &self.mass) {
            (Some(velocity), _) => Err(at(velocity.span(), FIXED_MOVES)),
            (_, Some(mass)) => Err(at(mass.span(), FIXED_WEIGHS)),
            (None, None) => Ok(()),
        }
    }
}

impl FillTable {
    fn fill(&self, size: DVec2, offset: usize) -> Result<Fill, At> {
        let count = self.count.get_ref().0;
        let count = usize::try_from(count).ok().filter(|&count| count <= MAX_BALLS).ok_or_else(|| {
            at(self.count.span(), format!("count is {count}; a simulation takes at most {MAX_BALLS} balls"))
        })?;
        Ok(Fill { count, offset: Some(offset), ..self.balls().fill(size)? })
    }
}

impl RainTable {
    fn rain(&self, size: DVec2) -> Result<Rain, At> {
        let rate = self.rate.checked(|Number(rate)| RAIN_RATE.check(rate))?;
        Ok(Rain::new(self.balls().fill(size)?, rate))
    }
}

impl RandomBalls<'_> {
    /// A fill of such balls, whose count is yet to be set.
    fn fill(&self, size: DVec2) -> Result<Fill, At> {
        let radius = self.radius.checked(|interval| interval.check(&RADIUS))?;
        let speed = match self.speed {
            None => (0.0, 0.0),
            Some(speed) => speed.checked(|interval| interval.check(&SPEED))?,
        };
        let material = match (self.density, self.mass) {
            (Some(_), Some(mass)) => {
                return Err(at(
                    mass.span(),
                    "random balls have a density or a mass, not both; leave one out",
                ));
            }
            (None, Some(mass)) => Material::Mass(mass.checked(|Number(mass)| MASS.check(mass))?),
            (density, None) => Material::Density(optional(density, &DENSITY, 1.0)?),
        };
        let restitution = optional(self.restitution, &RESTITUTION, 1.0)?;
        let region = match self.region {
            None => None,
            Some(region) => Some(region.checked(|corners| corners.check(size, radius.1))?),
        };
        check_width(self.radius.span(), radius.1, size, "")?;
        let seed = self.seed.map_or(DEFAULT_SEED, |seed| seed.0);
        Ok(Fill { count: 0, radius, speed, material, restitution, seed, region, offset: None })
    }
}

/// What is said of a velocity beside `fixed = true`.
const FIXED_MOVES: &str = "a fixed ball never moves; leave out its velocity, or write fixed = false";
/// What is said of a mass beside `fixed = true`.
const FIXED_WEIGHS: &str =
    "a fixed ball has no mass to choose: nothing moves it; leave out its mass, or write fixed = false";

/// A number that may be left out, in the range of `quantity`.
fn optional(number: Option<&Spanned<Number>>, quantity: &'static Quantity, default: f64) -> Result<f64, At> {
    number.map_or(Ok(default), |number| number.checked(|Number(value)| quantity.check(value)))
}

/// A pair of numbers in the range of `quantity`. Where one is not, the message says which of the two.
fn vector(pair: &Spanned<Pair>, quantity: &'static Quantity, names: [&str; 2]) -> Result<DVec2, At> {
    pair.checked(|Pair(pair)| {
        for (name, value) in names.into_iter().zip(pair.to_array()) {
            quantity.check(value).map_err(|error| format!("{name} of {error}"))?;
        }
        Ok::<_, String>(pair)
    })
}

/// What else the author of a ball that is too wide may want, where there are no walls.
const OR_WIDE: &str = ", or wide = true if it is meant to be";

/// Checks that a ball fits into a world of `size`; where its radius stands is `span`.
fn check_width(span: Range<usize>, radius: f64, size: DVec2, or_else: &str) -> Result<(), At> {
    let most = size.min_element() / 2.0;
    if radius <= most {
        return Ok(());
    }
    let message = format!(
        "a ball of radius {radius} px is larger than the world ({}x{} px); write at most {most}, or a larger \
         size{or_else}",
        size.x, size.y
    );
    Err(at(span, message))
}
