//! One cell of the table: a case run with a solver, and judged.

use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::case::{Case, Criterion, Measure, Setup, Step, seconds};
use crate::report::document::{duration, rounded};
use crate::simulation::grid::Grid;
use crate::simulation::invariants::{self, max_overlap, max_wall_overlap, momentum, non_finite};
use crate::simulation::{Ball, Simulation, Solver, World};

/// How a solver did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(in crate::report) enum Verdict {
    Held,
    Degraded,
    /// It did not come to its end in the time that it had.
    RanOut,
    Failed,
}

impl Verdict {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Held => "held",
            Self::Degraded => "degraded",
            Self::RanOut => "ran out of time",
            Self::Failed => "failed",
        }
    }
}

/// What was measured of a case with a solver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(in crate::report) struct Cell {
    pub(in crate::report) verdict: Verdict,
    /// What happened; empty where it held and there is nothing to say.
    pub(in crate::report) why: String,
    /// A figure for each criterion; none where the run did not come so far.
    pub(super) values: Vec<f64>,
    /// The time that `advance` took, s.
    pub(super) run_seconds: f64,
    /// What it simulated, s.
    pub(super) simulated: f64,
}

impl Cell {
    pub(super) fn failed(why: impl Into<String>) -> Self {
        Self {
            verdict: Verdict::Failed,
            why: why.into(),
            values: Vec::new(),
            run_seconds: 0.0,
            simulated: 0.0,
        }
    }

    pub(super) fn ran_out(why: impl Into<String>) -> Self {
        Self { verdict: Verdict::RanOut, ..Self::failed(why) }
    }
}

/// A run is looked at so often at most, evenly, beside its end.
const MOST_LOOKS: usize = 300;
/// Shorter runs may take longer than what they simulate, s.
const SHORT: f64 = 0.1;

/// Runs a case with a solver, for so much run time at most.
pub(super) fn measure(case: &Case, solver: Solver, limit: Duration) -> Cell {
    let (world, balls, steps) = match (case.setup)() {
        Ok(Setup::Run { world, balls, steps }) => (world, balls, steps),
        Ok(Setup::Refused(why)) => {
            return Cell { verdict: Verdict::Held, why, ..Cell::failed("") };
        }
        Err(why) => return Cell::failed(why),
    };
    let mut simulation = match Simulation::new(world, balls, solver) {
        Ok(simulation) => simulation,
        Err(error) => return Cell::failed(error.to_string()),
    };
    let mut watch = Watch::new(case, &simulation);
    let every = steps.len().div_ceil(MOST_LOOKS);
    let (mut used, mut asked) = (Duration::ZERO, 0.0);
    for (index, step) in steps.iter().enumerate() {
        match *step {
            Step::Resize(size) => {
                if let Err(error) = simulation.resize(size) {
                    return Cell::failed(error.to_string());
                }
            }
            Step::Advance(delta) => {
                asked += delta;
                let begun = Instant::now();
                let mut looks = 0_u32;
                let go_on = || {
                    looks += 1;
                    !looks.is_multiple_of(8) || used + begun.elapsed() < limit
                };
                let done = simulation.advance_while(delta, go_on);
                used += begun.elapsed();
                match done {
                    Ok(done) if done < delta => return late(&simulation, &steps, used),
                    Ok(_) => {}
                    Err(error) => return Cell::failed(error.to_string()),
                }
            }
        }
        if index.is_multiple_of(every) || index + 1 == steps.len() {
            watch.look(&simulation);
            let lost = non_finite(simulation.balls());
            if lost > 0 {
                let why = format!("{lost} balls are not finite at {} s", rounded(simulation.time()));
                return Cell { run_seconds: used.as_secs_f64(), simulated: asked, ..Cell::failed(why) };
            }
        }
        if used > limit && index + 1 < steps.len() {
            return late(&simulation, &steps, used);
        }
    }
    let values = watch.finish(&world, &simulation, &steps);
    judge(case, values, used.as_secs_f64(), asked)
}

/// The cell of a run that was given up after so much run time.
fn late(simulation: &Simulation, steps: &[Step], used: Duration) -> Cell {
    let (all, used) = (seconds(steps), used.as_secs_f64());
    let why = format!("came to {} s of {} s in {}", rounded(simulation.time()), rounded(all), duration(used));
    Cell { run_seconds: used, simulated: simulation.time(), ..Cell::ran_out(why) }
}

/// The verdict on a run that came to its end.
fn judge(case: &Case, values: Vec<f64>, run_seconds: f64, simulated: f64) -> Cell {
    let told =
        |(criterion, value): (&Criterion, &f64)| format!("{} {}", criterion.measure.name(), rounded(*value));
    let beyond = |limit: fn(&Criterion) -> f64| {
        let missed = case.criteria.iter().zip(&values).filter(|(criterion, value)| {
            // A NaN is not below its limit.
            value.is_nan() || **value > limit(criterion)
        });
        missed.map(told).collect::<Vec<_>>()
    };
    let (failed, mut degraded) = (beyond(|criterion| criterion.failed), beyond(|criterion| criterion.held));
    if run_seconds > simulated.max(SHORT) {
        degraded.push(format!("{} s took {}", rounded(simulated), duration(run_seconds)));
    }
    let (verdict, why) = if !failed.is_empty() {
        (Verdict::Failed, failed)
    } else if !degraded.is_empty() {
        (Verdict::Degraded, degraded)
    } else {
        (Verdict::Held, Vec::new())
    };
    Cell { verdict, why: why.join(", "), values, run_seconds, simulated }
}

/// Watches a run for what its criteria ask of it.
struct Watch<'a> {
    case: &'a Case,
    /// The balls at the start, their energy, their momentum, and the sum of the sizes of their momenta.
    start: Vec<Ball>,
    energy: f64,
    momentum: glam::DVec2,
    momenta: f64,
    grid: Grid,
    /// The largest of each so far.
    worst: Vec<f64>,
    solver: Solver,
}

/// Those that something may move.
fn free(balls: &[Ball]) -> impl Iterator<Item = &Ball> {
    balls.iter().filter(|ball| !ball.is_fixed())
}

fn energy(simulation: &Simulation) -> f64 {
    invariants::energy(simulation.world(), simulation.balls())
}

impl<'a> Watch<'a> {
    fn new(case: &'a Case, simulation: &Simulation) -> Self {
        let balls = simulation.balls();
        Self {
            case,
            start: balls.to_vec(),
            energy: energy(simulation),
            momentum: momentum(balls),
            momenta: free(balls).map(|ball| ball.mass() * ball.velocity().length()).sum(),
            grid: Grid::new(balls, simulation.world().size()),
            worst: vec![0.0; case.criteria.len()],
            solver: simulation.solver(),
        }
    }

    fn look(&mut self, simulation: &Simulation) {
        let case = self.case;
        for (index, criterion) in case.criteria.iter().enumerate().filter(|(_, one)| one.measure.is_watched())
        {
            let value = self.now(&criterion.measure, simulation);
            if value > self.worst[index] || value.is_nan() {
                self.worst[index] = value;
            }
        }
    }

    /// What a measure is now.
    fn now(&mut self, measure: &Measure, simulation: &Simulation) -> f64 {
        let balls = simulation.balls();
        // Without energy at the start, that of 1 px/s.
        let unit =
            if self.energy > 0.0 { self.energy } else { free(balls).map(|ball| 0.5 * ball.mass()).sum() };
        match measure {
            Measure::Escape => max_wall_overlap(simulation.world(), balls),
            Measure::Overlap | Measure::OverlapAtEnd => max_overlap(&mut self.grid, balls),
            Measure::EnergyGain => ((energy(simulation) - self.energy) / unit).max(0.0),
            Measure::EnergyChange => ((energy(simulation) - self.energy) / unit).abs(),
            Measure::MomentumChange => (momentum(balls) - self.momentum).length() / self.momenta.max(1e-300),
            &Measure::Sinking(ball) => {
                (balls[ball].position().y - self.start[ball].position().y) / balls[ball].radius()
            }
            Measure::FastestAtEnd => balls.iter().map(|ball| ball.velocity().length()).fold(0.0, f64::max),
            Measure::OutOfOrder => {
                balls.windows(2).filter(|pair| pair[0].position().x >= pair[1].position().x).count() as f64
            }
            Measure::AgainstEvenFrames => 0.0,
            Measure::AtEnd(_, at_end) => at_end(balls),
        }
    }

    /// All values, with those of the end.
    fn finish(mut self, world: &World, simulation: &Simulation, steps: &[Step]) -> Vec<f64> {
        let case = self.case;
        for (index, criterion) in
            case.criteria.iter().enumerate().filter(|(_, one)| !one.measure.is_watched())
        {
            self.worst[index] = match criterion.measure {
                Measure::AgainstEvenFrames => self.against_even_frames(world, simulation, steps),
                ref measure => self.now(measure, simulation),
            };
        }
        self.worst
    }

    fn against_even_frames(&self, world: &World, simulation: &Simulation, steps: &[Step]) -> f64 {
        let Ok(mut even) = Simulation::new(*world, self.start.clone(), self.solver) else { return f64::NAN };
        let seconds = seconds(steps);
        let whole = (60.0 * seconds).floor();
        let deltas =
            std::iter::repeat_n(1.0 / 60.0, whole as usize).chain([(seconds - whole / 60.0).max(0.0)]);
        for delta in deltas {
            if even.advance(delta).is_err() {
                return f64::NAN;
            }
        }
        if non_finite(even.balls()) > 0 {
            return f64::NAN;
        }
        let pairs = even.balls().iter().zip(simulation.balls());
        pairs.map(|(even, ball)| even.position().distance(ball.position())).fold(0.0, f64::max)
    }
}
