//! Balls that fall in for ever, as long as there is room.

use glam::DVec2;

use super::fill::Fill;
use crate::simulation::invariants::energy;
use crate::simulation::limits::{DELTA, OutOfRange, Quantity};
use crate::simulation::{Ball, Simulation, World};

/// How many balls come in a second.
pub(super) static RAIN_RATE: Quantity = Quantity { name: "rate", unit: "balls/s", low: 1e-3, high: 1e4 };

/// Seconds between the moments at which balls come, however many: a number that binary fractions hold exactly.
const SPELL: f64 = 0.125;
/// Frames may end so much before a spell does, s, and still see its balls.
const ROUNDING: f64 = 1e-12;
/// After so many spells in a row of which no ball found room, the world is full.
const FULL: u32 = 16;
/// The default region is a strip of the world where gravity comes from, so many of the largest radii wide; the top, where there
/// is none.
const STRIP: f64 = 4.0;

/// Rain of random balls. It falls at set moments of the simulated time, so that it is the same whatever the frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Rain {
    /// What the balls are like; its count is not used.
    fill: Fill,
    /// Balls a second.
    rate: f64,
    /// The time that has passed, s: a sum, and what was lost in rounding it.
    time: (f64, f64),
    /// How many spells are over.
    spells: u64,
    /// How many of the last spells found no room for any of their balls.
    in_vain: u32,
    /// The energy that its balls came with, mass·px²/s².
    energy: f64,
}

impl Rain {
    pub(super) fn new(fill: Fill, rate: f64) -> Self {
        Self { fill, rate, time: (0.0, 0.0), spells: 0, in_vain: 0, energy: 0.0 }
    }

    /// The same rain from its beginning, of other balls.
    pub(super) fn reseeded(self, seed: u64) -> Self {
        Self::new(Fill { seed, ..self.fill }, self.rate)
    }

    /// What a file says of it: what the balls are like, and their rate.
    pub(super) fn written(&self) -> (&Fill, f64) {
        (&self.fill, self.rate)
    }

    /// Moves a simulation on by `seconds`, as [`Simulation::advance`] does, and lets balls fall in when it is their time.
    ///
    /// # Errors
    /// [`OutOfRange`] where no frame may be so long; nothing has moved then.
    pub fn advance(&mut self, simulation: &mut Simulation, seconds: f64) -> Result<(), OutOfRange> {
        self.advance_while(simulation, seconds, || true).map(drop)
    }

    /// Moves a simulation on by up to `seconds`, as [`Simulation::advance_while`] does, and lets balls fall in when it
    /// is their time.
    ///
    /// # Errors
    /// [`OutOfRange`] where no frame may be so long; nothing has moved then.
    pub fn advance_while(
        &mut self,
        simulation: &mut Simulation,
        seconds: f64,
        go_on: impl FnMut() -> bool,
    ) -> Result<f64, OutOfRange> {
        let mut touched = Vec::new();
        let done = self.advance_by_spells(simulation, DELTA.check(seconds)?, go_on, &mut touched)?;
        simulation.note_touching(&touched);
        Ok(done)
    }

    /// The same, and notes which balls have touched others before the last spell.
    fn advance_by_spells(
        &mut self,
        simulation: &mut Simulation,
        seconds: f64,
        mut go_on: impl FnMut() -> bool,
        touched: &mut Vec<bool>,
    ) -> Result<f64, OutOfRange> {
        let mut left = seconds;
        let mut stopped = false;
        // It is not asked again after a no.
        let mut go_on = || {
            stopped = stopped || !go_on();
            !stopped
        };
        // Frames that end with a spell, up to rounding, see its balls.
        while let Some(wait) = self.wait().filter(|&wait| wait <= left + ROUNDING) {
            let done = simulation.advance_while(wait, &mut go_on)?;
            self.pass(done);
            left -= done;
            if done < wait {
                return Ok(seconds - left);
            }
            touched.resize(simulation.balls().len(), false);
            for (touched, &now) in touched.iter_mut().zip(simulation.touching()) {
                *touched |= now;
            }
            self.fall(simulation);
            // Not every solver asks, and a long frame has many spells.
            if left > 0.0 && !go_on() {
                return Ok(seconds - left);
            }
        }
        if left < 0.0 || left <= ROUNDING && seconds > ROUNDING {
            // It ends with a spell: what came with it is as it came, whether rounding has left any time or not.
            return Ok(seconds);
        }
        let done = simulation.advance_while(left, go_on)?;
        self.pass(done);
        Ok(seconds - left + done)
    }

    /// Lets balls fall in again that may find room now, after many found none.
    pub(crate) fn try_again(&mut self) {
        if self.in_vain >= FULL {
            // Those that would have come in the meantime do not.
            let now = (self.time.0 / SPELL).floor() as u64;
            (self.in_vain, self.spells) = (0, self.spells.max(now));
        }
    }

    /// The kinetic and potential energy that its balls have come with so far, mass·px²/s².
    #[must_use]
    pub fn energy(&self) -> f64 {
        self.energy
    }

    /// The time until balls come again, s; `None` where the world is full.
    fn wait(&self) -> Option<f64> {
        let next = (self.spells + 1) as f64 * SPELL;
        (self.in_vain < FULL).then(|| (next - self.time.0 - self.time.1).max(0.0))
    }

    /// Adds to the time without losing any (the two-sum of Knuth 1969), so that all frames come to the same moments.
    fn pass(&mut self, seconds: f64) {
        let (sum, lost) = self.time;
        let next = sum + seconds;
        let added = next - sum;
        self.time = (next, lost + ((sum - (next - added)) + (seconds - added)));
    }

    /// Adds the balls of the spell that is over.
    fn fall(&mut self, simulation: &mut Simulation) {
        let by = |spells: u64| (spells as f64 * SPELL * self.rate).floor() as usize;
        let count = by(self.spells + 1) - by(self.spells);
        self.spells += 1;
        if count == 0 {
            return;
        }
        let balls = self.drops(count, simulation.world(), simulation.balls());
        let added = !balls.is_empty() && simulation.add(&balls).is_ok();
        self.in_vain = if added { 0 } else { self.in_vain + 1 };
        if added {
            self.energy += energy(simulation.world(), &balls);
        }
    }

    /// Where balls fall in by default.
    fn strip(&self, world: &World) -> (DVec2, DVec2) {
        let (size, gravity) = (world.size(), world.gravity().unwrap_or_default());
        let axis = usize::from(gravity.y.abs() >= gravity.x.abs());
        let width = (STRIP * self.fill.radius.1).min(size[axis]);
        let (mut low, mut high) = (DVec2::ZERO, size);
        if gravity[axis] < 0.0 {
            low[axis] = size[axis] - width;
        } else {
            high[axis] = width;
        }
        (low, high)
    }

    /// As many of `count` balls as find room where the rain falls.
    fn drops(&self, count: usize, world: &World, present: &[Ball]) -> Vec<Ball> {
        let region = self.fill.region.unwrap_or_else(|| self.strip(world));
        let fill = Fill { count, region: Some(region), ..self.fill.clone() };
        fill.place_at_random(world, present, self.spells)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Scene;
    use super::*;

    #[test]
    fn rain_falls_in_where_gravity_comes_from() {
        let scene =
            |gravity: &str| format!("size = [400, 300]\n{gravity}\n[rain]\nrate = 8\nradius = [1, 5]\n");
        for (gravity, low, high) in [
            ("", [0.0, 0.0], [400.0, 20.0]),
            ("gravity = [3, 5]", [0.0, 0.0], [400.0, 20.0]),
            ("gravity = [0, -980]", [0.0, 280.0], [400.0, 300.0]),
            ("gravity = [980, -5]", [0.0, 0.0], [20.0, 300.0]),
            ("gravity = [-980, 5]", [380.0, 0.0], [400.0, 300.0]),
        ] {
            let scene = Scene::parse("rain", &scene(gravity)).unwrap();
            let strip = scene.rain().unwrap().strip(scene.build().unwrap().world());
            assert_eq!(strip, (DVec2::from(low), DVec2::from(high)), "{gravity}");
        }
    }
}
