//! Scenes of which it is known where their balls are: what solvers are measured against.

mod closed;
mod referenced;

use glam::DVec2;

pub(super) use referenced::{demo, growth_scenes};

use super::reference::{Collapse, Quad, Reference};
use super::setting::looks;
use crate::simulation::limits::OutOfRange;
use crate::simulation::{Ball, World};

/// A scene and the true motion of its balls.
#[derive(Debug, Clone)]
pub(super) struct Problem {
    /// The name that `--only` and the tables use.
    pub(super) name: &'static str,
    /// The heading of its plot.
    pub(super) title: &'static str,
    /// A sentence on what happens, and on where the truth comes from.
    pub(super) about: String,
    pub(super) world: World,
    pub(super) balls: Vec<Ball>,
    /// How long it runs, s.
    pub(super) seconds: f64,
    /// Where the balls are at each of its looks.
    truth: Vec<Vec<DVec2>>,
    /// How many impacts there are, on balls and on walls, where that is known.
    pub(super) impacts: Option<u64>,
    /// Whether it belongs to those with a closed form.
    pub(super) closed: bool,
}

/// Why a problem cannot be posed: a defect of the report that its tests look for.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Unposed {
    OutOfRange(OutOfRange),
    Collapse(Collapse),
    Scene(String),
}

impl From<OutOfRange> for Unposed {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}

impl From<Collapse> for Unposed {
    fn from(error: Collapse) -> Self {
        Self::Collapse(error)
    }
}

impl std::fmt::Display for Unposed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::OutOfRange(error) => write!(f, "{error}"),
            Self::Collapse(Collapse(time)) => write!(f, "its reference run ends at {time} s"),
            Self::Scene(why) => f.write_str(why),
        }
    }
}

/// What a problem is made of, beside its truth.
struct Setup {
    name: &'static str,
    title: &'static str,
    about: String,
    world: World,
    balls: Vec<Ball>,
    seconds: f64,
}

impl Setup {
    /// With the places of all balls at a time, in closed form.
    fn with_truth(self, truth: impl Fn(f64) -> Vec<DVec2>) -> Problem {
        let truth = looks(self.seconds).into_iter().map(truth).collect();
        self.problem(truth, true)
    }

    /// With a reference run for the truth.
    fn with_reference(self) -> Result<Problem, Unposed> {
        let mut reference = Reference::<Quad>::new(&self.world, &self.balls);
        let mut truth = Vec::new();
        for time in looks(self.seconds) {
            reference.advance_to(time)?;
            truth.push(reference.positions());
        }
        let impacts = Some(reference.impacts());
        Ok(Problem { impacts, ..self.problem(truth, false) })
    }

    fn problem(self, truth: Vec<Vec<DVec2>>, closed: bool) -> Problem {
        let Self { name, title, about, world, balls, seconds } = self;
        Problem { name, title, about, world, balls, seconds, truth, impacts: None, closed }
    }
}

impl Problem {
    /// All of them, those with a closed form first.
    pub(super) fn all() -> Result<Vec<Self>, Unposed> {
        let mut problems = closed::problems()?;
        problems.extend(referenced::problems()?);
        Ok(problems)
    }

    /// How far the balls are at most from where they should be at this look, px.
    pub(super) fn error(&self, look: usize, balls: &[Ball]) -> f64 {
        let truth = &self.truth[look.min(self.truth.len() - 1)];
        farthest(balls.iter().zip(truth).map(|(ball, truth)| ball.position().distance(*truth)))
    }
}

/// The largest of errors, from 0 up; a NaN does not vanish in it.
pub(super) fn farthest(errors: impl IntoIterator<Item = f64>) -> f64 {
    errors.into_iter().fold(0.0, |most: f64, error| if error > most || error.is_nan() { error } else { most })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn problems_have_names_of_their_own_and_a_truth_for_every_look() {
        let problems = Problem::all().unwrap();
        for (index, problem) in problems.iter().enumerate() {
            assert!(problems[..index].iter().all(|other| other.name != problem.name), "{}", problem.name);
            assert_eq!(problem.truth.len(), looks(problem.seconds).len());
            assert!(problem.truth.iter().all(|places| places.len() == problem.balls.len()));
            assert!(problem.about.ends_with('.'), "{}", problem.about);
        }
    }

    #[test]
    fn closed_forms_agree_with_the_reference_run() {
        for problem in closed::problems().unwrap().iter().filter(|problem| problem.closed) {
            let mut reference = Reference::<Quad>::new(&problem.world, &problem.balls);
            for (truth, time) in problem.truth.iter().zip(looks(problem.seconds)) {
                reference.advance_to(time).unwrap();
                // The rounding of the longest path, a thousand seconds at ten thousand px/s.
                let most = if problem.name == "box" { 1e-9 } else { 1e-10 };
                for (closed, run) in truth.iter().zip(reference.positions()) {
                    let apart = closed.distance(run);
                    assert!(apart < most, "{} at {time} s: {apart:e} px", problem.name);
                }
            }
            assert!(problem.impacts.is_none_or(|impacts| reference.impacts() == impacts), "{}", problem.name);
        }
    }
}
