//! The laws themselves, and what is said where one is broken.

use std::fmt;

/// The laws, in the order in which a frame is held against them. Where `contact` moves balls from impact to
/// impact, it is held to all that `exact` is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Law {
    /// Positions and velocities are finite.
    Finite,
    /// Balls stay between the walls; one that was put beyond a wall goes no farther. px.
    Walls,
    /// Balls that bounce off each other overlap by no more than at first, or by rounding. The demo's step lets balls
    /// overlap, and in a crowd that is pressed together `contact` does: only `exact` is held to it. Fractions of the
    /// smaller radius.
    Overlap,
    /// Energy, mass·px²/s², does not rise, except by what solvers add under gravity, for all balls together (of mass M):
    /// - `canvas`, in each frame, what its step lifts a ball by where gravity took it into a wall;
    /// - `exact`, ½Mu² for hops at the rest speed u, as it counts under this gravity
    ///   ([`with_rest_speed`](crate::Simulation::with_rest_speed));
    /// - `contact`, [`CONTACT_LIFT`](super::CONTACT_LIFT) of the most that was there, for overlaps that are taken back,
    ///   and what a speed of two substeps' gravity has; and [`CONTACT_LIFT_OF_FAST`](super::CONTACT_LIFT_OF_FAST) in all
    ///   while one moves farther than its radius in a substep, as gravity within a substep is only about right at its
    ///   impacts then.
    ///
    /// `exact` is not held to it while balls overlap, which it parts with energy from nowhere; nor is `contact` under
    /// gravity where balls overlapped to begin with, as it lifts them off each other.
    Energy,
    /// Energy does not fall where nothing takes any: elastic balls, elastic walls, no gravity, and room to move.
    EnergyKept,
    /// The momentum, mass·px/s, is what it was, with gravity's share and that of the walls. Not where fixed balls give
    /// any, nor where walls carry balls (`exact` with walls and gravity or no room to move, `contact` with walls):
    /// neither is tallied. Nor with `contact` where balls overlapped to begin with, nor under gravity once one moved farther
    /// than its radius in a substep: where that has no end of impacts, the substep ends early, and gravity with it.
    Momentum,
    /// A ball that met nothing flew its parabola; found is how far beside it the ball is, px. Not with `contact` where
    /// balls bounce off each other, as what they press on each other is not flagged; nor in its frames that begin or
    /// end within a substep, as what is shown there knows of what happens in all of it; nor where a ball moves farther
    /// than its radius in one: where one has no end of impacts, the substep ends early for all of these.
    Flight,
}

/// A law that a frame has broken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Violation {
    /// Which.
    pub law: Law,
    /// The ball, from 0, or the first of the two, where single balls are meant.
    pub ball: Option<usize>,
    /// What was found, in the law's unit.
    pub found: f64,
    /// What it may be at most, in the same unit; for [`Law::EnergyKept`], at least.
    pub allowed: f64,
}

impl Law {
    /// Its name, for messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Finite => "finite",
            Self::Walls => "walls",
            Self::Overlap => "overlap",
            Self::Energy | Self::EnergyKept => "energy",
            Self::Momentum => "momentum",
            Self::Flight => "flight",
        }
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { law, ball, found, allowed } = *self;
        let ball = ball.unwrap_or_default();
        match law {
            Law::Finite => write!(f, "ball {ball} has a position or a velocity that is not finite"),
            Law::Walls => {
                write!(f, "ball {ball} is {found:.3e} px beyond a wall; {allowed:.3e} px is rounding")
            }
            Law::Overlap => {
                write!(f, "ball {ball} overlaps another by {found:.3e} of the smaller radius, ")?;
                write!(f, "by {:.3e} more than is allowed", found - allowed)
            }
            Law::Energy => write!(
                f,
                "the energy rose to {found:.9e}, by {:.3e} more than the {allowed:.9e} that is allowed",
                found - allowed
            ),
            Law::EnergyKept => write!(
                f,
                "the energy fell to {found:.9e} where nothing takes any, by {:.3e} more than rounding may",
                allowed - found
            ),
            Law::Momentum => write!(
                f,
                "the momentum is {found:.3e} beside what gravity and walls account for; {allowed:.3e} is rounding"
            ),
            Law::Flight => write!(
                f,
                "ball {ball} met nothing and is {found:.3e} px beside its path; {allowed:.3e} px is allowed"
            ),
        }
    }
}

impl std::error::Error for Violation {}
