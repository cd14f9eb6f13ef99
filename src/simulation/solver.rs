//! What a solver is, and which there are.

use std::fmt;
use std::str::FromStr;

use super::Tally;
use super::ball::Ball;
use super::canvas::Canvas;
use super::contact::Contact;
use super::exact::Exact;
use super::grid::Grid;
use super::hybrid::Hybrid;
use super::world::World;

/// The ways of moving a simulation on. What each of them is held to, [`Law`](super::ledger::Law) tells law by law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Solver {
    /// The canvas demo's frame step, bit for bit: one step a frame, of whatever length.
    ///
    /// - For the demo as it is, and for comparison with it.
    /// - Not for physics: the result depends on the frame rate, fast balls pass through each other, and balls in a pile
    ///   overlap.
    /// - The same deltas give the same bits as the demo's JavaScript.
    Canvas,
    /// Event-driven: from impact to impact, each at its very time.
    ///
    /// - For what flies and bounces: gases, cradles, single shots.
    /// - Not for large piles in real time: its work grows with the number of impacts.
    /// - Exact to rounding between and at impacts, with the same result at every frame rate; no ball passes through anything.
    Exact,
    /// Substeps in which all contacts are solved together. Where nothing presses balls together, as without gravity and among
    /// few that fly, bounce and slide, they are moved from impact to impact, as by `Exact`.
    ///
    /// - For what lies on other things: piles of thousands of balls in real time, on several threads if it may.
    /// - Not for exact times of impacts in a crowd under gravity: within a substep they are only about right, and balls overlap a
    ///   little where they are pressed together.
    /// - The same result at every frame rate and for any number of threads; no ball passes through a wall, nor through another, but
    ///   where fast ones press on much lighter ones under gravity.
    Contact,
}

/// A part of a solver's work that a simulation may need or leave out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Balls move.
    Motion,
    /// Gravity accelerates them.
    Gravity,
    /// Walls turn them back.
    Walls,
    /// Touching pairs are found by comparing all of them.
    AllPairs,
    /// Touching pairs are found on a grid.
    Grid,
    /// Impacts are foreseen, and taken in their order in time.
    Events,
    /// Touching pairs exchange momentum.
    Impulse,
}

/// What solvers may be told beside the physics.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tuning {
    /// The speed below which bouncing counts as rest, px/s.
    pub(super) rest_speed: f64,
    /// Substeps in a second; `None` where the solver is to choose.
    pub(super) substeps: Option<u32>,
    /// Whether balls at rest may sleep.
    pub(super) sleep: bool,
    /// How many threads share the work of a substep.
    pub(super) threads: u32,
}

/// What is done to a simulation from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Edit {
    /// Balls were added after those that were there.
    Added,
    /// The ball of this index was taken away: those after it have moved up.
    Removed(usize),
    /// That of this index was given another velocity ...
    Thrown(usize),
    /// ... or another place.
    Placed(usize),
    /// There is another gravity.
    Gravity,
    /// Walls were moved, and may have moved balls.
    Walls,
}

/// What a solver is: something that moves a frame's balls on.
///
/// A solver is made for one world and one set of balls, and decides then which of its parts run; whoever changes
/// either tells it so ([`Edit`]), or makes it anew. It keeps what it needs between frames, and leaves in `frame` what is to be shown.
pub(super) trait Advance: fmt::Debug + Send + Sync {
    /// Moves on by up to `seconds`, which is finite and not negative, and returns the seconds that it has moved on:
    /// less than asked for only where `go_on` said no. `go_on` is asked now and then where the work may be long, and
    /// not before some of it is done, so that every call gets on. `frame` then holds the state at the time returned.
    fn advance(&mut self, frame: &mut Frame<'_>, seconds: f64, go_on: &mut dyn FnMut() -> bool) -> f64;

    /// Takes up what was done from outside, and returns whether it could; if not, it is made anew. The world and the balls are as
    /// they are after that.
    fn take_up(&mut self, _world: &World, _balls: &[Ball], _edit: Edit) -> bool {
        false
    }

    /// The fewest and the most substeps in a second that it takes, or last took. [`None`] where it has taken none: each state that
    /// it shows is computed then, as `exact` does or, with `canvas`, as the demo does.
    fn substeps(&self) -> Option<[u32; 2]> {
        None
    }

    /// How far the time that was shown last is from one for which a state was computed, s: not 0 within a substep.
    fn within_substep(&self) -> f64 {
        0.0
    }

    /// A clone, which goes on exactly as this one does.
    fn clone_boxed(&self) -> Box<dyn Advance>;

    /// The parts that run.
    fn parts(&self, world: &World) -> Vec<Part>;
}

impl Clone for Box<dyn Advance> {
    fn clone(&self) -> Self {
        self.as_ref().clone_boxed()
    }
}

/// What a solver works on: the simulation less the solver itself.
pub(super) struct Frame<'a> {
    pub(super) world: &'a World,
    pub(super) balls: &'a mut [Ball],
    pub(super) touching: &'a mut [bool],
    pub(super) tally: &'a mut Tally,
}

impl Frame<'_> {
    /// Flags the balls that overlap; fixed ones, where there are any, do not notice each other. Flags are the same in
    /// any order, so no pair is kept.
    pub(super) fn show_overlaps<const FIXED: bool>(&mut self, grid: &mut Grid) {
        let Frame { balls, touching, .. } = self;
        grid.for_each(balls, |i, j| {
            let (i, j) = (i as usize, j as usize);
            if !(FIXED && balls[i].is_fixed() && balls[j].is_fixed()) {
                (touching[i], touching[j]) = (true, true);
            }
        });
    }
}

impl Solver {
    /// All solvers, in the order in which the window goes through them.
    pub const ALL: &'static [Self] = &[Self::Canvas, Self::Exact, Self::Contact];

    /// The name that scene files and the command line use.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Canvas => "canvas",
            Self::Exact => "exact",
            Self::Contact => "contact",
        }
    }

    /// The one after it, in the order in which the window goes through them.
    pub(crate) fn next(self) -> Self {
        let here = Self::ALL.iter().position(|&other| other == self).unwrap_or(0);
        Self::ALL[(here + 1) % Self::ALL.len()]
    }

    /// A solver of this kind, made for a world and its balls.
    pub(super) fn engine(self, world: &World, balls: &[Ball], tuning: Tuning) -> Box<dyn Advance> {
        match self {
            Self::Canvas => Box::new(Canvas::new(world, balls)),
            Self::Exact => Box::new(Exact::new(world, balls, tuning.rest_speed)),
            Self::Contact => match Hybrid::new(world, balls, tuning) {
                Some(hybrid) => Box::new(hybrid),
                None => Box::new(Contact::new(world, balls, tuning)),
            },
        }
    }
}

impl fmt::Display for Solver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that no solver has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownSolver(String);

impl FromStr for Solver {
    type Err = UnknownSolver;

    fn from_str(name: &str) -> Result<Self, UnknownSolver> {
        let found = Self::ALL.iter().find(|solver| solver.name() == name);
        found.copied().ok_or_else(|| UnknownSolver(name.to_owned()))
    }
}

impl fmt::Display for UnknownSolver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<_> = Solver::ALL.iter().map(|solver| solver.name()).collect();
        write!(f, "there is no solver \"{}\" in this version; choose from: {}", self.0, names.join(", "))
    }
}

impl std::error::Error for UnknownSolver {}

impl Part {
    /// The parts that move single balls.
    pub(super) fn of_motion(world: &World) -> Vec<Self> {
        let parts = [
            (true, Self::Motion),
            (world.gravity.is_some(), Self::Gravity),
            (world.walls.is_some(), Self::Walls),
        ];
        parts.into_iter().filter_map(|(runs, part)| runs.then_some(part)).collect()
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Motion => "motion",
            Self::Gravity => "gravity",
            Self::Walls => "walls",
            Self::AllPairs => "all pairs",
            Self::Grid => "grid",
            Self::Events => "events",
            Self::Impulse => "impulse",
        })
    }
}
