//! What is measured: time, overlap, energy, escapes, unrest.

use std::time::{Duration, Instant};

use carom::Ball;
use carom::simulation::grid::Grid;
use carom::simulation::invariants::{kinetic_energy, potential_energy};

use crate::engines::{Engine, Failure, Maker, State};
use crate::scenes::{FPS, Scene, Span};

/// What one engine did in one span of a scene.
#[derive(Debug)]
pub struct Figures {
    pub span: Span,
    /// Median nanoseconds per ball and frame.
    pub nanoseconds: f64,
    /// Over all pairs of balls that overlapped when looked at, in radii of the smaller; 0 where none did.
    pub mean_overlap: f64,
    pub largest_overlap: f64,
    /// Of the scene's total energy, from its start to the end of the span, %.
    pub energy_change: f64,
    /// Balls wholly outside the walls at the end, or nowhere.
    pub escaped: usize,
    /// At the end, px/s.
    pub fastest: f64,
    pub outcome: Option<String>,
}

/// The longest that few balls' runs are repeated for their time's sake.
const PATIENCE: Duration = Duration::from_secs(1);

/// Runs an engine through all spans of a scene.
pub fn measure(scene: &Scene, maker: Maker) -> Result<Vec<Figures>, Failure> {
    let start = Instant::now();
    let mut figures = follow(scene, maker)?;
    // Looking at the state after each frame is in the way of timing a few balls: that is done apart, unless a frame
    // takes so long that the look does not matter.
    let mut times = vec![Vec::new(); scene.spans.len()];
    for _ in 0..scene.runs {
        if start.elapsed() > PATIENCE {
            break;
        }
        let (mut engine, mut frame) = (maker.start(scene)?, 0);
        for (span, times) in scene.spans.iter().zip(&mut times) {
            advance(&mut *engine, span.from - frame)?;
            let frames = span.to - span.from;
            times.push(per_ball_and_frame(scene, advance(&mut *engine, frames)?, frames));
            frame = span.to;
        }
    }
    for (figures, times) in figures.iter_mut().zip(&mut times) {
        if !times.is_empty() {
            figures.nanoseconds = median(times);
        }
    }
    Ok(figures)
}

/// One run with a look at the state after each window.
fn follow(scene: &Scene, maker: Maker) -> Result<Vec<Figures>, Failure> {
    let mut engine = maker.start(scene)?;
    let mut look = Look::new(scene);
    let mut frame = 0;
    let mut figures = Vec::new();
    for &span in &scene.spans {
        advance(&mut *engine, span.from - frame)?;
        frame = span.from;
        look.forget();
        let mut times = Vec::new();
        while frame < span.to {
            let frames = span.window.min(span.to - frame);
            let time = advance(&mut *engine, frames)?;
            times.push(per_ball_and_frame(scene, time, frames));
            frame += frames;
            engine.state(&mut look.states)?;
            look.overlaps();
        }
        // Of a whole span the mean counts, as it does where it is timed without looks.
        let whole = scene.runs > 0;
        let nanoseconds = if whole { mean(&times) } else { median(&mut times) };
        figures.push(look.figures(span, nanoseconds));
    }
    Ok(figures)
}

fn advance(engine: &mut dyn Engine, frames: u32) -> Result<Duration, Failure> {
    let start = Instant::now();
    for _ in 0..frames {
        engine.step(1.0 / f64::from(FPS))?;
    }
    Ok(start.elapsed())
}

fn per_ball_and_frame(scene: &Scene, time: Duration, frames: u32) -> f64 {
    time.as_secs_f64() * 1e9 / (scene.balls.len() as f64 * f64::from(frames))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let (low, high) = (values.get(values.len().saturating_sub(1) / 2), values.get(values.len() / 2));
    low.zip(high).map_or(f64::NAN, |(low, high)| f64::midpoint(*low, *high))
}

/// Looks at states with carom's own eyes: its grid and its invariants.
struct Look<'a> {
    scene: &'a Scene,
    grid: Grid,
    energy: f64,
    states: Vec<State>,
    overlapping: u64,
    sum: f64,
    largest: f64,
}

impl<'a> Look<'a> {
    fn new(scene: &'a Scene) -> Self {
        let grid = Grid::new(&scene.balls, scene.world.size());
        let energy = energy(scene, &scene.balls);
        Self { scene, grid, energy, states: Vec::new(), overlapping: 0, sum: 0.0, largest: 0.0 }
    }

    fn forget(&mut self) {
        (self.overlapping, self.sum, self.largest) = (0, 0.0, 0.0);
    }

    /// The scene's balls in the engine's state; those that are nowhere, or beyond all measure, are left out.
    fn balls(&self) -> Vec<Ball> {
        let now = |(ball, state): (&Ball, &State)| {
            let moved = Ball::new(state.position, ball.radius())?.with_velocity(state.velocity)?;
            moved.with_mass(ball.mass())
        };
        self.scene.balls.iter().zip(&self.states).filter_map(|pair| now(pair).ok()).collect()
    }

    fn overlaps(&mut self) {
        let balls = self.balls();
        let Self { grid, overlapping, sum, largest, .. } = self;
        grid.for_each(&balls, |i, j| {
            let (a, b) = (&balls[i as usize], &balls[j as usize]);
            let depth = a.radius() + b.radius() - a.position().distance(b.position());
            let overlap = depth / a.radius().min(b.radius());
            if overlap > 0.0 {
                *overlapping += 1;
                *sum += overlap;
                *largest = largest.max(overlap);
            }
        });
    }

    fn figures(&self, span: Span, nanoseconds: f64) -> Figures {
        let balls = self.balls();
        let lost = self.scene.balls.len() - balls.len();
        let size = self.scene.world.size();
        let outside = |ball: &&Ball| {
            let (before, behind) = (-ball.position(), ball.position() - size);
            before.max(behind).max_element() > ball.radius()
        };
        Figures {
            span,
            nanoseconds,
            mean_overlap: if self.overlapping > 0 { self.sum / self.overlapping as f64 } else { 0.0 },
            largest_overlap: self.largest,
            energy_change: 100.0 * (energy(self.scene, &balls) / self.energy - 1.0),
            escaped: lost + balls.iter().filter(outside).count(),
            fastest: self.states.iter().map(|state| state.velocity.length()).fold(0.0, f64::max),
            outcome: self.scene.kind.outcome(self.scene, &self.states),
        }
    }
}

fn energy(scene: &Scene, balls: &[Ball]) -> f64 {
    kinetic_energy(balls) + potential_energy(&scene.world, balls)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_number_lies_between_the_middle_two() {
        assert_eq!(median(&mut [9.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&mut [9.0, 1.0, 2.0, 4.0]), 3.0);
        assert!(median(&mut []).is_nan());
    }
}
