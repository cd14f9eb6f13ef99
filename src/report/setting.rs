//! The settings that each solver is run with, and a run with one of them.

use std::fmt;
use std::time::{Duration, Instant};

use super::chart::Dot;
use crate::simulation::limits::{DEFAULT_REST_SPEED, OutOfRange};
use crate::simulation::{Ball, BuildError, Simulation, Solver, World};

/// Frames or substeps in a second: the ladder of the solvers that take steps.
const RATES: [u32; 9] = [30, 60, 120, 240, 480, 960, 1920, 3840, 7680];
/// Rest speeds, px/s: the ladder of `exact`, which knows events alone.
const REST_SPEEDS: [f64; 8] = [10.0, 1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
/// How often a run is looked at, 1/s; every rate is a multiple.
pub(super) const LOOKS: u32 = 30;
/// What is left of a time is nothing where it is less than this part of a step.
const ROUNDING: f64 = 1e-6;

/// A solver and what it is told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Setting {
    /// `canvas`, with so many frames a second.
    Frames(u32),
    /// `contact`, with so many substeps a second.
    Substeps(u32),
    /// `contact`, with as many as it takes where it is told nothing: none where nothing presses balls together.
    OwnSubsteps,
    /// `exact`, with this rest speed, px/s.
    RestSpeed(f64),
}

/// Why a run has no result.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum GivenUp {
    /// It came to this time, s, and not further, in the time that it had.
    Late {
        /// What it came to, s.
        at: f64,
    },
    /// It was refused.
    Refused(String),
}

impl fmt::Display for GivenUp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Late { at } => write!(f, "it had come to {at:.3} s when its time was up"),
            Self::Refused(why) => f.write_str(why),
        }
    }
}

impl From<OutOfRange> for GivenUp {
    fn from(error: OutOfRange) -> Self {
        Self::Refused(error.to_string())
    }
}

impl From<BuildError> for GivenUp {
    fn from(error: BuildError) -> Self {
        Self::Refused(error.to_string())
    }
}

impl Setting {
    /// A solver's ladder, from its coarsest setting to its finest; in a quick report every second of them, its default
    /// among them.
    pub(super) fn ladder(solver: Solver, quick: bool) -> Vec<Self> {
        let (first, every) = if quick { (1, 2) } else { (0, 1) };
        match solver {
            Solver::Canvas => RATES.into_iter().skip(first).step_by(every).map(Self::Frames).collect(),
            Solver::Contact => RATES.into_iter().skip(first).step_by(every).map(Self::Substeps).collect(),
            Solver::Exact => {
                REST_SPEEDS.into_iter().skip(first).step_by(every).map(Self::RestSpeed).collect()
            }
        }
    }

    /// All settings that solvers are run with: of each its ladder, and its default where that is no rung of it.
    pub(super) fn all(quick: bool) -> Vec<Self> {
        let of_solver = |&solver: &Solver| {
            let mut all = Self::ladder(solver, quick);
            let default = Self::default_of(solver);
            if !all.contains(&default) {
                all.push(default);
            }
            all
        };
        Solver::ALL.iter().flat_map(of_solver).collect()
    }

    /// Where it stands in a figure.
    pub(super) fn dot(self, x: f64, y: f64) -> Dot {
        Dot { used: self.is_default(), joined: self.size().is_some(), ..Dot::at(x, y) }
    }

    /// What a solver does where it is told nothing: the demo's frames, and each solver's own default.
    pub(super) fn default_of(solver: Solver) -> Self {
        match solver {
            Solver::Canvas => Self::Frames(60),
            Solver::Contact => Self::OwnSubsteps,
            Solver::Exact => Self::RestSpeed(DEFAULT_REST_SPEED),
        }
    }

    /// Whether a solver does this where it is told nothing.
    pub(super) fn is_default(self) -> bool {
        self == Self::default_of(self.solver())
    }

    pub(super) fn solver(self) -> Solver {
        match self {
            Self::Frames(_) => Solver::Canvas,
            Self::Substeps(_) | Self::OwnSubsteps => Solver::Contact,
            Self::RestSpeed(_) => Solver::Exact,
        }
    }

    /// What is small where the setting is fine: the step, s, or the rest speed, px/s. None where it is no rung of a ladder.
    pub(super) fn size(self) -> Option<f64> {
        match self {
            Self::Frames(rate) | Self::Substeps(rate) => Some(1.0 / f64::from(rate)),
            Self::OwnSubsteps => None,
            Self::RestSpeed(speed) => Some(speed),
        }
    }

    /// The same as it stands in a table of numbers: empty where there is none.
    pub(super) fn written_size(self) -> String {
        self.size().map_or_else(String::new, |size| size.to_string())
    }

    /// The name of the quantity that is set, with its unit.
    pub(super) fn quantity(self) -> &'static str {
        match self {
            Self::Frames(_) => "frame_s",
            Self::Substeps(_) | Self::OwnSubsteps => "substep_s",
            Self::RestSpeed(_) => "rest_speed_px_per_s",
        }
    }

    /// A simulation of these balls with this setting.
    pub(super) fn build(self, world: &World, balls: &[Ball]) -> Result<Simulation, GivenUp> {
        let simulation = Simulation::new(*world, balls.to_vec(), self.solver())?;
        Ok(match self {
            Self::Frames(_) | Self::OwnSubsteps => simulation,
            Self::Substeps(rate) => simulation.with_substeps(rate)?,
            Self::RestSpeed(speed) => simulation.with_rest_speed(speed)?,
        })
    }

    /// Runs for `seconds` as a caller would who wants the end alone, and returns the seconds that this took.
    pub(super) fn time(
        self,
        world: &World,
        balls: &[Ball],
        seconds: f64,
        limit: Duration,
    ) -> Result<f64, GivenUp> {
        let mut simulation = self.build(world, balls)?;
        let start = Instant::now();
        self.advance(&mut simulation, seconds, start + limit)?;
        Ok(start.elapsed().as_secs_f64())
    }

    /// Runs for `seconds`, and lets `look` see the balls 30 times a second and at the end.
    pub(super) fn watch(
        self,
        world: &World,
        balls: &[Ball],
        seconds: f64,
        limit: Duration,
        mut look: impl FnMut(f64, &Simulation),
    ) -> Result<Simulation, GivenUp> {
        let mut simulation = self.build(world, balls)?;
        let deadline = Instant::now() + limit;
        let times = looks(seconds);
        let mut before = 0.0;
        for &time in &times {
            self.advance(&mut simulation, time - before, deadline)?;
            look(time, &simulation);
            before = time;
        }
        Ok(simulation)
    }

    /// Moves on by `seconds`: in frames where the solver has any, with the rest in a shorter one; else at once.
    fn advance(self, simulation: &mut Simulation, seconds: f64, deadline: Instant) -> Result<(), GivenUp> {
        let late = |simulation: &Simulation| GivenUp::Late { at: simulation.time() };
        let Self::Frames(rate) = self else {
            let mut looks = 0_u32;
            let go_on = || {
                looks += 1;
                !looks.is_multiple_of(16) || Instant::now() < deadline
            };
            let done = simulation.advance_while(seconds, go_on)?;
            return if done < seconds { Err(late(simulation)) } else { Ok(()) };
        };
        if simulation.time() == 0.0 {
            // The demo's first frame has no seconds.
            simulation.advance(0.0)?;
        }
        let delta = 1.0 / f64::from(rate);
        let frames = seconds * f64::from(rate);
        let whole = (frames + ROUNDING).floor();
        for frame in 0..whole as u64 {
            simulation.advance(delta)?;
            if frame.is_multiple_of(16) && Instant::now() > deadline {
                return Err(late(simulation));
            }
        }
        if frames - whole > ROUNDING {
            simulation.advance((frames - whole) * delta)?;
        }
        Ok(())
    }
}

/// When a run of so many seconds is looked at: 30 times a second, and at its end.
pub(super) fn looks(seconds: f64) -> Vec<f64> {
    let whole = (seconds * f64::from(LOOKS) + ROUNDING).floor() as u32;
    let mut times: Vec<f64> = (1..=whole).map(|look| f64::from(look) / f64::from(LOOKS)).collect();
    if times.last().is_none_or(|&last| seconds - last > ROUNDING / f64::from(LOOKS)) {
        times.push(seconds);
    }
    times
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Frames(rate) => write!(f, "frames of 1/{rate} s"),
            Self::Substeps(rate) => write!(f, "substeps of 1/{rate} s"),
            Self::OwnSubsteps => f.write_str("as many substeps as it takes"),
            Self::RestSpeed(speed) if *speed < 1.0 => write!(f, "rest speed {speed:e} px/s"),
            Self::RestSpeed(speed) => write!(f, "rest speed {speed} px/s"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_is_looked_at_evenly_and_at_its_end() {
        assert_eq!(looks(0.1), [1.0 / 30.0, 2.0 / 30.0, 0.1]);
        assert_eq!(looks(0.05).len(), 2);
        assert_eq!(looks(1.01).len(), 31);
        assert_eq!(looks(0.001), [0.001]);
    }

    #[test]
    fn ladders_go_from_coarse_to_fine_and_solvers_run_with_their_defaults_once() {
        for &solver in Solver::ALL {
            let ladder = Setting::ladder(solver, false);
            assert!(ladder.windows(2).all(|pair| pair[0].size() > pair[1].size()));
            let quick = Setting::ladder(solver, true);
            assert!(quick.len() * 2 <= ladder.len());
            for (ladder, quick) in [(ladder, false), (quick, true)] {
                let all: Vec<Setting> =
                    Setting::all(quick).into_iter().filter(|setting| setting.solver() == solver).collect();
                assert!(all.starts_with(&ladder));
                assert_eq!(all.iter().filter(|setting| setting.is_default()).count(), 1);
            }
        }
    }

    #[test]
    fn contact_takes_no_substeps_where_nothing_presses_unless_it_is_told_how_many() {
        let world = World::new(glam::DVec2::splat(100.0)).unwrap();
        let world = world.with_pairs(crate::simulation::Pairs::Impulse);
        let balls: Vec<Ball> =
            [20.0, 80.0].map(|x| Ball::new(glam::DVec2::new(x, 50.0), 5.0).unwrap()).into();
        let takes = |setting: Setting| {
            let simulation = setting.build(&world, &balls).unwrap();
            !simulation.parts().contains(&crate::simulation::Part::Events)
        };
        assert!(takes(Setting::Substeps(240)) && !takes(Setting::default_of(Solver::Contact)));
    }
}
