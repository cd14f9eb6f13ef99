//! The way back: a simulation as the text of a scene file.

use std::fmt;

use glam::DVec2;

use super::file::LONGEST_ABOUT;
use super::fill::{Fill, Material};
use super::rain::Rain;
use crate::simulation::limits::{COORDINATE, Quantity, VELOCITY};
use crate::simulation::{Ball, Pairs, Simulation, World};

/// A simulation as it is now, as a scene file that [`Scene::parse`](super::Scene::parse) takes: read and built, it
/// gives the same world, solver and balls, to the bit, and in the same order. `rain` is what falls into it, if anything
/// does, and `about` one line on what it shows.
///
/// A scene file has no place for some of what a simulation is, so this is not in it: the time so far and the tally of
/// impacts, which begin at 0 again; which balls touched in the last frame, which the first one finds anew; what
/// `with_rest_speed`, `with_substeps` and `with_sleep` have set; and what a solver remembers, such as which balls sleep
/// and what is left of a substep. So what is read goes on as the simulation would after
/// [`set_solver`](Simulation::set_solver). Rain begins again with its first balls.
///
/// A ball takes 256 bytes at most, so a file of half a million balls is never longer than one that is read; ten million
/// may be.
///
/// Four things are written other than they are, so that the file can be read. Coordinates and velocities that a run
/// has taken [beyond their limits](crate::simulation::limits) become the nearest that a file may hold, which a comment
/// at the top of the file counts. Where the world was made too small for the rain's region, the region is cut to it,
/// and where that leaves no room for its balls, the rain is left out, which a comment says. The velocity −0 is 0. Of `about`
/// the first thousand characters are written.
///
/// ```
/// use carom::{Scene, scene};
///
/// let mut simulation = Scene::load("gravity")?.build()?;
/// simulation.advance(2.5).expect("a delta in range");
/// let text = scene::write(&simulation, None, "the demo after two and a half seconds");
/// let again = Scene::parse("later.toml", &text)?.build()?;
/// assert_eq!(again.balls(), simulation.balls());
/// # Ok::<(), carom::SceneError>(())
/// ```
#[must_use]
pub fn write(simulation: &Simulation, rain: Option<&Rain>, about: &str) -> String {
    File { simulation, rain, about, signed: false }.to_string()
}

/// The same without `about`, with −0 told from 0: what a replay knows its scene by, which is not to change.
pub(crate) fn write_signed(simulation: &Simulation, rain: Option<&Rain>) -> String {
    File { simulation, rain, about: "", signed: true }.to_string()
}

struct File<'a> {
    simulation: &'a Simulation,
    rain: Option<&'a Rain>,
    about: &'a str,
    /// Whether −0 is written where a velocity is that.
    signed: bool,
}

impl fmt::Display for File<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (world, balls) = (self.simulation.world(), self.simulation.balls());
        let beyond = balls.iter().filter(|ball| is_beyond(ball)).count();
        if beyond > 0 {
            let verb = if beyond == 1 { "ball was" } else { "balls were" };
            writeln!(
                f,
                "# {beyond} {verb} farther or faster than a scene file may say, and brought to its limits"
            )?;
        }
        if !self.about.is_empty() {
            let end = self.about.char_indices().nth(LONGEST_ABOUT).map_or(self.about.len(), |(end, _)| end);
            writeln!(f, "about = {}", Quoted(&self.about[..end]))?;
        }
        writeln!(f, "solver = {}", Quoted(self.simulation.solver().name()))?;
        write_world(f, world)?;
        if let Some(rain) = self.rain {
            write_rain(f, rain, world)?;
        }
        let wide = |ball: &Ball| world.walls().is_none() && 2.0 * ball.radius() > world.size().min_element();
        balls.iter().try_for_each(|ball| write_ball(f, ball, wide(ball), self.signed))
    }
}

fn write_world(f: &mut fmt::Formatter<'_>, world: &World) -> fmt::Result {
    writeln!(f, "size = {}", Pair(world.size()))?;
    if let Some(gravity) = world.gravity() {
        writeln!(f, "gravity = {}", Pair(gravity))?;
    }
    if let Some(restitution) = world.walls() {
        writeln!(f, "\n[walls]")?;
        write_unless(f, "restitution", restitution, 1.0)?;
    }
    match world.pairs() {
        None => Ok(()),
        Some(Pairs::Impulse) => writeln!(f, "\n[pairs]"),
        Some(Pairs::Detect) => writeln!(f, "\n[pairs]\nresponse = \"detect\""),
    }
}

fn write_ball(f: &mut fmt::Formatter<'_>, ball: &Ball, wide: bool, signed: bool) -> fmt::Result {
    let (position, velocity) = allowed(ball);
    // Adding 0 makes a 0 of −0.
    let velocity = if signed { velocity } else { velocity + DVec2::ZERO };
    writeln!(f, "\n[[ball]]\nposition = {}\nradius = {}", Pair(position), Number(ball.radius()))?;
    if ball.is_fixed() {
        writeln!(f, "fixed = true")?;
    } else {
        // Not by ==, which takes −0 for 0.
        if velocity.to_array().map(f64::to_bits) != [0, 0] {
            writeln!(f, "velocity = {}", Pair(velocity))?;
        }
        write_unless(f, "mass", ball.mass(), 1.0)?;
    }
    write_unless(f, "restitution", ball.restitution(), 1.0)?;
    if wide {
        writeln!(f, "wide = true")?;
    }
    Ok(())
}

fn write_rain(f: &mut fmt::Formatter<'_>, rain: &Rain, world: &World) -> fmt::Result {
    let (fill, rate) = rain.written();
    let Fill { radius, speed, material, restitution, seed, region, .. } = *fill;
    let region = region.map(|(low, high)| (low, high.min(world.size())));
    let room = region.map_or(world.size(), |(low, high)| high - low).min(world.size());
    if room.min_element() < 2.0 * radius.1 {
        return writeln!(
            f,
            "\n# The rain is left out: its largest balls are wider than the room that it falls in."
        );
    }
    writeln!(f, "\n[rain]\nrate = {}\nradius = {}", Number(rate), Interval(radius))?;
    if speed != (0.0, 0.0) {
        writeln!(f, "speed = {}", Interval(speed))?;
    }
    match material {
        Material::Mass(mass) => writeln!(f, "mass = {}", Number(mass))?,
        Material::Density(density) => write_unless(f, "density", density, 1.0)?,
    }
    write_unless(f, "restitution", restitution, 1.0)?;
    writeln!(f, "seed = {seed}")?;
    if let Some((low, high)) = region {
        let [left, top, right, bottom] = [low.x, low.y, high.x, high.y].map(Number);
        writeln!(f, "region = [{left}, {top}, {right}, {bottom}]")?;
    }
    Ok(())
}

fn write_unless(f: &mut fmt::Formatter<'_>, key: &str, value: f64, default: f64) -> fmt::Result {
    if value == default { Ok(()) } else { writeln!(f, "{key} = {}", Number(value)) }
}

/// A ball's position and velocity, each coordinate brought into the range of what a file may say.
fn allowed(ball: &Ball) -> (DVec2, DVec2) {
    // In this order a NaN, which no solver makes of what it is given, becomes the lower end.
    let nearest = |range: &Quantity, value: f64| value.max(range.low).min(range.high);
    let (position, velocity) = (ball.position(), ball.velocity());
    (
        DVec2::new(nearest(&COORDINATE, position.x), nearest(&COORDINATE, position.y)),
        DVec2::new(nearest(&VELOCITY, velocity.x), nearest(&VELOCITY, velocity.y)),
    )
}

fn is_beyond(ball: &Ball) -> bool {
    allowed(ball) != (ball.position(), ball.velocity())
}

/// A number in the shortest form that reads back as the same one, without a decimal point where it is whole.
struct Number(f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = *self;
        // TOML's integers have no −0, and no more than 64 bits.
        let is_integer =
            value == value.trunc() && value.abs() < 1e15 && value.to_bits() != (-0.0_f64).to_bits();
        if is_integer { write!(f, "{value}") } else { write!(f, "{value:?}") }
    }
}

struct Pair(DVec2);

impl fmt::Display for Pair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}, {}]", Number(self.0.x), Number(self.0.y))
    }
}

/// One number where both ends are the same.
struct Interval((f64, f64));

impl fmt::Display for Interval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (low, high) = self.0;
        if low == high { Number(low).fmt(f) } else { write!(f, "[{}, {}]", Number(low), Number(high)) }
    }
}

/// A TOML basic string: quotes, backslashes and control characters escaped, all else as it is.
struct Quoted<'a>(&'a str);

impl fmt::Display for Quoted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("\"")?;
        for character in self.0.chars() {
            match character {
                '"' => f.write_str("\\\"")?,
                '\\' => f.write_str("\\\\")?,
                '\n' => f.write_str("\\n")?,
                '\t' => f.write_str("\\t")?,
                control if control.is_ascii_control() => write!(f, "\\u{:04X}", u32::from(control))?,
                other => write!(f, "{other}")?,
            }
        }
        f.write_str("\"")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::Solver;

    #[test]
    fn a_velocity_of_minus_0_is_written_as_0_but_for_what_a_replay_knows_its_scene_by() {
        let ball = |x, y| Ball::new(DVec2::ONE, 1.0).unwrap().with_velocity(DVec2::new(x, y)).unwrap();
        let balls = vec![ball(-0.0, -0.0), ball(-0.0, 2.5)];
        let simulation =
            Simulation::new(World::new(DVec2::splat(9.0)).unwrap(), balls, Solver::Exact).unwrap();
        let text = write(&simulation, None, "");
        assert!(text.contains("velocity = [0, 2.5]"), "{text}");
        assert_eq!(text.matches("velocity").count(), 1, "none where it is 0: {text}");
        let text = write_signed(&simulation, None);
        assert!(
            text.contains("velocity = [-0.0, -0.0]") && text.contains("velocity = [-0.0, 2.5]"),
            "{text}"
        );
    }
}
