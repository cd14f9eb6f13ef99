//! The scene file: TOML to a [`Scene`], every number checked where it stands.

use std::fmt;
use std::ops::Range;

use glam::DVec2;
use serde::de::{Error as _, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use toml::Spanned;

use super::error::Fault;
use super::fill::{Fill, Material};
use super::{DEFAULT_SIZE, Scene};
use crate::simulation::limits::{
    COORDINATE, GRAVITY, MASS, MAX_BALLS, OutOfRange, Quantity, RADIUS, RESTITUTION, SIZE, VELOCITY,
};
use crate::simulation::{Ball, Pairs, Solver, UnknownSolver, World};

/// A speed of random balls; as a component of a velocity, but never negative.
static SPEED: Quantity = Quantity { name: "speed", low: 0.0, ..VELOCITY };
/// Mass per area of random balls.
static DENSITY: Quantity = Quantity { name: "density", unit: "per px²", ..MASS };
/// Where nobody asks for a seed.
pub(super) const SEED_DEFAULT: u64 = 1;

/// Reads a scene from its text. `origin` is what messages call it.
pub(super) fn parse(origin: &str, source: &str) -> Result<Scene, Fault> {
    let fault = |at: At| Fault::at(origin, source, at.offset, at.message);
    let file: File = toml::from_str(source).map_err(|error| {
        // The one message of the parser's that does not say what to write.
        let message = error.message().replace("invalid type: map, expected a sequence", ONE_BRACKET);
        fault(At { offset: error.span().map(|span| span.start), message })
    })?;
    file.into_scene(origin).map_err(fault)
}

/// What is said of `[ball]` and `[fill]`.
const ONE_BRACKET: &str =
    "this table may come more than once; write its name in two brackets: [[ball]], [[fill]]";

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

/// What moves a scene on that doesn't say: the solver that is right for all but piles.
const DEFAULT_SOLVER: Solver = Solver::Exact;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    about: Option<String>,
    solver: Option<Spanned<String>>,
    size: Option<Spanned<Pair>>,
    gravity: Option<Spanned<Pair>>,
    walls: Option<WallsTable>,
    pairs: Option<PairsTable>,
    #[serde(default, rename = "ball")]
    balls: Vec<Spanned<BallTable>>,
    #[serde(default, rename = "fill")]
    fills: Vec<Spanned<FillTable>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table: [walls]")]
struct WallsTable {
    restitution: Option<Spanned<Number>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table: [pairs]")]
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
#[serde(deny_unknown_fields, expecting = "a table: [[ball]]")]
struct BallTable {
    position: Spanned<Pair>,
    radius: Spanned<Number>,
    velocity: Option<Spanned<Pair>>,
    mass: Option<Spanned<Number>>,
    restitution: Option<Spanned<Number>>,
    fixed: Option<bool>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table: [[fill]]")]
struct FillTable {
    count: Spanned<Count>,
    radius: Spanned<Interval>,
    speed: Option<Spanned<Interval>>,
    density: Option<Spanned<Number>>,
    mass: Option<Spanned<Number>>,
    restitution: Option<Spanned<Number>>,
    seed: Option<Count>,
    region: Option<Spanned<Corners>>,
}

impl File {
    fn into_scene(self, origin: &str) -> Result<Scene, At> {
        let solver = match &self.solver {
            None => DEFAULT_SOLVER,
            Some(name) => name.get_ref().parse().map_err(|error: UnknownSolver| at(name.span(), error))?,
        };
        let size = match &self.size {
            None => DEFAULT_SIZE,
            Some(size) => size.checked(whole_size)?,
        };
        let mut world = World::new(size).map_err(|error| At { offset: None, message: error.to_string() })?;
        if let Some(gravity) = &self.gravity {
            let gravity = gravity.checked(|Pair(gravity)| GRAVITY.check_vector(gravity))?;
            world = world.with_gravity(gravity).expect("gravity was checked");
        }
        if let Some(walls) = &self.walls {
            let restitution = optional(walls.restitution.as_ref(), &RESTITUTION, 1.0)?;
            world = world.with_walls(restitution).expect("the walls' restitution was checked");
        }
        if let Some(pairs) = &self.pairs {
            world = world.with_pairs(match pairs.response {
                Response::Impulse => Pairs::Impulse,
                Response::Detect => Pairs::Detect,
            });
        }
        let mut balls = Vec::with_capacity(self.balls.len());
        for table in &self.balls {
            let ball = table.get_ref().ball()?;
            check_width(table.get_ref().radius.span(), ball.radius(), size)?;
            balls.push(ball);
        }
        let mut fills = Vec::with_capacity(self.fills.len());
        let mut total = balls.len();
        for table in &self.fills {
            let fill = table.get_ref().fill(size, table.span().start)?;
            total = total.saturating_add(fill.count);
            if total > MAX_BALLS {
                let message = format!("the scene has {total} balls; a simulation takes at most {MAX_BALLS}");
                return Err(at(table.get_ref().count.span(), message));
            }
            fills.push(fill);
        }
        let about = self.about.unwrap_or_default();
        Ok(Scene {
            origin: origin.to_owned(),
            source: String::new(),
            about,
            solver,
            world,
            balls,
            fills,
            added: None,
        })
    }
}

impl BallTable {
    fn ball(&self) -> Result<Ball, At> {
        let position = self.position.checked(|Pair(position)| COORDINATE.check_vector(position))?;
        let mut ball = self.radius.checked(|Number(radius)| Ball::new(position, radius))?;
        if self.fixed == Some(true) {
            self.check_fixed()?;
            ball = ball.fixed();
        }
        if let Some(velocity) = &self.velocity {
            ball = velocity.checked(|Pair(velocity)| ball.with_velocity(velocity))?;
        }
        if let Some(mass) = &self.mass {
            ball = mass.checked(|Number(mass)| ball.with_mass(mass))?;
        }
        if let Some(restitution) = &self.restitution {
            ball = restitution.checked(|Number(restitution)| ball.with_restitution(restitution))?;
        }
        Ok(ball)
    }

    /// Whether nothing is said beside `fixed = true` that a fixed ball does not have.
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
        let radius = self.radius.checked(|interval| interval.check(&RADIUS))?;
        let speed = match &self.speed {
            None => (0.0, 0.0),
            Some(speed) => speed.checked(|interval| interval.check(&SPEED))?,
        };
        let material = match (&self.density, &self.mass) {
            (Some(_), Some(mass)) => {
                return Err(at(mass.span(), "a fill has a density or a mass, not both; leave one out"));
            }
            (None, Some(mass)) => Material::Mass(mass.checked(|Number(mass)| MASS.check(mass))?),
            (density, None) => Material::Density(optional(density.as_ref(), &DENSITY, 1.0)?),
        };
        let restitution = optional(self.restitution.as_ref(), &RESTITUTION, 1.0)?;
        let region = match &self.region {
            None => None,
            Some(region) => Some(region.checked(|corners| corners.check(size, radius.1))?),
        };
        check_width(self.radius.span(), radius.1, size)?;
        let seed = self.seed.as_ref().map_or(SEED_DEFAULT, |seed| seed.0);
        Ok(Fill { count, radius, speed, material, restitution, seed, region, offset: Some(offset) })
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

fn whole_size(Pair(size): Pair) -> Result<DVec2, String> {
    let size = SIZE.check_vector(size).map_err(|error: OutOfRange| error.to_string())?;
    if size == size.trunc() {
        Ok(size)
    } else {
        Err(format!("size is [{}, {}]; write whole numbers of px, such as [1280, 720]", size.x, size.y))
    }
}

fn check_width(span: Range<usize>, radius: f64, size: DVec2) -> Result<(), At> {
    let most = size.min_element() / 2.0;
    if radius <= most {
        return Ok(());
    }
    let message = format!(
        "a ball of radius {radius} px is larger than the world ({}x{} px); write at most {most}, or a larger size",
        size.x, size.y
    );
    Err(at(span, message))
}

/// Any TOML number.
#[derive(Clone, Copy)]
struct Number(f64);

/// Two numbers: x and y.
#[derive(Clone, Copy)]
struct Pair(DVec2);

/// One number, or the two ends of a range.
#[derive(Clone, Copy)]
struct Interval(f64, f64);

/// Left, top, right, bottom.
#[derive(Clone, Copy)]
struct Corners([f64; 4]);

/// A whole number from 0 up.
struct Count(u64);

impl Interval {
    fn check(self, quantity: &'static Quantity) -> Result<(f64, f64), String> {
        let check = |value| quantity.check(value).map_err(|error| error.to_string());
        let (low, high) = (check(self.0)?, check(self.1)?);
        if low <= high {
            Ok((low, high))
        } else {
            Err(format!(
                "{} is [{low}, {high}]; write the smaller number first: [{high}, {low}]",
                quantity.name
            ))
        }
    }
}

impl Corners {
    fn check(self, size: DVec2, radius: f64) -> Result<(DVec2, DVec2), String> {
        let [left, top, right, bottom] = self.0;
        let (low, high) = (DVec2::new(left, top), DVec2::new(right, bottom));
        let world = format!("[0, 0, {}, {}]", size.x, size.y);
        if !(low.cmpge(DVec2::ZERO).all() && high.cmple(size).all()) {
            return Err(format!(
                "region is [{left}, {top}, {right}, {bottom}]; left, top, right and bottom must lie in the world, {world}"
            ));
        }
        if !(high - low).cmpge(DVec2::splat(2.0 * radius)).all() {
            return Err(format!(
                "region is [{left}, {top}, {right}, {bottom}], which has no room for a ball of radius {radius}; \
                 write left, top, right, bottom at least {} apart",
                2.0 * radius
            ));
        }
        Ok((low, high))
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NumberVisitor;

        impl Visitor<'_> for NumberVisitor {
            type Value = Number;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, such as 12 or 0.5")
            }

            fn visit_f64<E>(self, value: f64) -> Result<Number, E> {
                Ok(Number(value))
            }

            fn visit_i64<E>(self, value: i64) -> Result<Number, E> {
                Ok(Number(value as f64))
            }

            fn visit_u64<E>(self, value: u64) -> Result<Number, E> {
                Ok(Number(value as f64))
            }
        }

        deserializer.deserialize_any(NumberVisitor)
    }
}

impl<'de> Deserialize<'de> for Count {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct CountVisitor;

        impl Visitor<'_> for CountVisitor {
            type Value = Count;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number from 0 up, such as 1000")
            }

            fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<Count, E> {
                let wrong = || E::invalid_value(serde::de::Unexpected::Signed(value), &self);
                u64::try_from(value).map(Count).map_err(|_| wrong())
            }

            fn visit_u64<E>(self, value: u64) -> Result<Count, E> {
                Ok(Count(value))
            }
        }

        deserializer.deserialize_any(CountVisitor)
    }
}

impl<'de> Deserialize<'de> for Pair {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let [x, y] = deserializer.deserialize_any(Numbers("two numbers, such as [30, 50]"))?;
        Ok(Self(DVec2::new(x, y)))
    }
}

impl<'de> Deserialize<'de> for Corners {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        const EXPECTED: &str = "four numbers, left, top, right and bottom, such as [0, 0, 1280, 360]";
        deserializer.deserialize_any(Numbers(EXPECTED)).map(Self)
    }
}

impl<'de> Deserialize<'de> for Interval {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        const INTERVAL: &str = "a number or a range, such as 5 or [3, 6]";
        struct IntervalVisitor;

        impl<'de> Visitor<'de> for IntervalVisitor {
            type Value = Interval;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(INTERVAL)
            }

            fn visit_f64<E>(self, value: f64) -> Result<Interval, E> {
                Ok(Interval(value, value))
            }

            fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<Interval, E> {
                self.visit_f64(value as f64)
            }

            fn visit_u64<E: serde::de::Error>(self, value: u64) -> Result<Interval, E> {
                self.visit_f64(value as f64)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Interval, A::Error> {
                let [low, high] = Numbers(INTERVAL).visit_seq(seq)?;
                Ok(Interval(low, high))
            }
        }

        deserializer.deserialize_any(IntervalVisitor)
    }
}

/// Exactly `N` numbers in an array; the text says what is expected.
struct Numbers<const N: usize>(&'static str);

impl<'de, const N: usize> Visitor<'de> for Numbers<N> {
    type Value = [f64; N];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<[f64; N], A::Error> {
        let mut numbers = [0.0; N];
        for (found, number) in numbers.iter_mut().enumerate() {
            *number = seq.next_element::<Number>()?.ok_or_else(|| A::Error::invalid_length(found, &self))?.0;
        }
        match seq.next_element::<Number>()? {
            None => Ok(numbers),
            Some(_) => Err(A::Error::invalid_length(N + 1, &self)),
        }
    }
}
