//! What a case is: a start, how time is cut, and what must hold.

use crate::report::document::rounded;
use crate::simulation::{Ball, World};
use glam::DVec2;

/// A scene of the stability table.
pub(super) struct Case {
    pub(super) name: &'static str,
    /// What it is, in a few words.
    pub(super) what: String,
    pub(super) setup: Box<dyn Fn() -> Result<Setup, String>>,
    pub(super) criteria: Vec<Criterion>,
}

/// What a case starts from.
pub(super) enum Setup {
    /// A simulation, and what is done with it.
    Run { world: World, balls: Vec<Ball>, steps: Vec<Step> },
    /// Input of which all was refused, as it must be: nothing to run.
    Refused(String),
}

/// What is done to a simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Step {
    /// Time goes on, s.
    Advance(f64),
    /// The window takes another size, px.
    Resize(DVec2),
}

/// The simulated time of all these steps, s.
pub(super) fn seconds(steps: &[Step]) -> f64 {
    steps.iter().map(|step| if let Step::Advance(delta) = step { *delta } else { 0.0 }).sum()
}

/// A figure that must be small.
pub(super) struct Criterion {
    pub(super) measure: Measure,
    /// Up to this it holds ...
    pub(super) held: f64,
    /// ... and above this it has failed.
    pub(super) failed: f64,
}

/// A figure of balls as they are.
pub(super) type OfBalls = Box<dyn Fn(&[Ball]) -> f64>;

/// Something of a run that is measured.
pub(super) enum Measure {
    /// How far a ball was over a wall, in its radii.
    Escape,
    /// How deep two balls were in each other, in radii of the smaller.
    Overlap,
    /// The same at the end.
    OverlapAtEnd,
    /// How much energy came from nowhere, as a part of that at the start.
    EnergyGain,
    /// By how much energy changed, as a part of that at the start.
    EnergyChange,
    /// By how much momentum changed, as a part of the sum of its sizes at the start.
    MomentumChange,
    /// How far a ball, by its place in the list, was below its start, in its radii.
    Sinking(usize),
    /// How fast the fastest ball is at the end, px/s.
    FastestAtEnd,
    /// How often balls that stood in a row, in their order, were out of it.
    OutOfOrder,
    /// How far the balls are, px, from where the same solver has them in even frames of 1/60 s.
    AgainstEvenFrames,
    /// Something of the end, with its name.
    AtEnd(&'static str, OfBalls),
}

impl Measure {
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Escape => "beyond a wall",
            Self::Overlap => "overlap",
            Self::OverlapAtEnd => "overlap at the end",
            Self::EnergyGain => "energy gained",
            Self::EnergyChange => "energy changed by",
            Self::MomentumChange => "momentum changed by",
            Self::Sinking(_) => "sunk by",
            Self::FastestAtEnd => "fastest at the end, px/s",
            Self::OutOfOrder => "balls out of order",
            Self::AgainstEvenFrames => "px from even frames",
            Self::AtEnd(name, _) => name,
        }
    }

    /// Whether it must be looked at while the run goes on.
    pub(super) fn is_watched(&self) -> bool {
        matches!(
            self,
            Self::Escape
                | Self::Overlap
                | Self::EnergyGain
                | Self::EnergyChange
                | Self::MomentumChange
                | Self::Sinking(_)
                | Self::OutOfOrder
        )
    }
}

impl Case {
    pub(super) fn new(
        name: &'static str,
        what: impl Into<String>,
        setup: impl Fn() -> Result<Setup, String> + 'static,
    ) -> Self {
        Self { name, what: what.into(), setup: Box::new(setup), criteria: Vec::new() }
    }

    /// With another criterion: up to `held` it is met, above `failed` it is missed by far.
    pub(super) fn holds(mut self, measure: Measure, held: f64, failed: f64) -> Self {
        self.criteria.push(Criterion { measure, held, failed });
        self
    }

    /// Balls are to stay inside and apart from each other.
    pub(super) fn stays_inside_and_apart(self) -> Self {
        self.holds(Measure::Escape, 1e-9, 1.0).holds(Measure::Overlap, 0.02, 0.5)
    }

    /// Nothing takes energy, and none may come.
    pub(super) fn keeps_energy(self) -> Self {
        self.holds(Measure::EnergyChange, 1e-9, 1e-2)
    }

    /// Nothing but balls pushes balls.
    pub(super) fn keeps_momentum(self) -> Self {
        self.holds(Measure::MomentumChange, 1e-9, 1e-2)
    }

    /// Energy may go, but not come.
    pub(super) fn gains_no_energy(self) -> Self {
        self.holds(Measure::EnergyGain, 1e-4, 0.1)
    }

    /// The criteria, as the table says them.
    pub(super) fn criteria_text(&self) -> String {
        let mut texts = vec!["finite".to_owned()];
        texts.extend(self.criteria.iter().map(|criterion| {
            let (name, held) = (criterion.measure.name(), criterion.held);
            if held == 0.0 { format!("no {name}") } else { format!("{name} ≤ {}", rounded(held)) }
        }));
        texts.join(", ")
    }
}
