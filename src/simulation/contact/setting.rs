//! What all parts of a substep need to know of the world.

use glam::{BVec2, DVec2};

use super::super::ball::Ball;
use super::super::world::World;
use super::super::{Tuning, within};
use super::amount::Amount;
use super::energy::Keeping;
use super::softness::Softness;
use super::substeps::{BEATS, MOST, Substeps};
use super::support::Tolerance;
use super::unlike::{Crush, Unlike};
use super::wall_support::any_jams;
use super::wedges::FLAT_UNDER_SLEEPER;

/// Overlaps are taken away at this many sums of both radii a second at most, and faster where gravity or depth ask for shorter
/// substeps: what starts in an overlap parts, and is not shot away.
const MENDING: f64 = 4.0;

/// What all parts of a substep need to know of the world.
#[derive(Debug, Clone, Copy)]
pub(super) struct Setting {
    pub(super) size: DVec2,
    /// The walls' restitution.
    pub(super) walls: Option<f64>,
    pub(super) gravity: DVec2,
    /// The length of a substep, s.
    pub(super) substep: f64,
    /// By what gravity changes a velocity in a substep, px/s.
    pub(super) kick: DVec2,
    /// Whether balls can come to rest: there is gravity, or something takes energy.
    pub(super) can_rest: bool,
    /// The least restitution of any ball.
    pub(super) least_restitution: f64,
    /// Whether any ball is fixed.
    pub(super) has_fixed: bool,
    /// How many balls can be moved.
    pub(super) amount: Amount,
    /// Along which axes any ball that can be moved has no room between walls.
    pub(super) jammed: BVec2,
    /// How flat a wedge under a ball asleep counts as flat, as a cosine (`wedges`); none in deep piles, which come to rest later so.
    pub(super) flat_under_sleeper: Option<f64>,
    /// Whether something may carry balls in this substep that falls with none of them: a fixed one, or a wall near any.
    pub(super) grounded: bool,
    /// The velocity through the substep that all balls have in common, px/s, where nothing carries any: how fast they are
    /// against that alone counts. Else 0.
    pub(super) common: DVec2,
    /// A pair that holds each other bounces only where it meets faster than this, px/s, and than its load asks for.
    pub(super) firm: f64,
    /// Overlaps are taken away at so many sums of both radii a second, at most.
    pub(super) mending: f64,
    /// Impacts slower than this are not counted, px/s.
    pub(super) rest_speed: f64,
    /// How contacts give way.
    pub(super) softness: Softness,
    /// Whom balls could crush.
    pub(super) crush: Crush,
    /// In what any balls are unlike those around them.
    pub(super) unlike: Unlike,
    /// How what holds balls is kept from giving them energy.
    pub(super) keeping: Keeping,
    /// Where sweeps are followed to their end: what they may change yet when they have settled.
    pub(super) to_the_end: Option<Tolerance>,
}

impl Setting {
    pub(super) fn new(world: &World, balls: &[Ball], substeps: &Substeps, tuning: Tuning) -> Self {
        let gravity = world.gravity.unwrap_or_default();
        let has_fixed = balls.iter().any(Ball::is_fixed);
        let crush = Crush::among(balls);
        let setting = Self {
            size: world.size,
            walls: world.walls,
            gravity,
            substep: 0.0,
            kick: DVec2::ZERO,
            can_rest: can_rest(world, balls),
            least_restitution: least_restitution(balls),
            has_fixed,
            amount: substeps.amount,
            jammed: any_jams(world, balls),
            flat_under_sleeper: (!substeps.is_deep()).then_some(FLAT_UNDER_SLEEPER),
            grounded: has_fixed || world.walls.is_some(),
            common: DVec2::ZERO,
            firm: 0.0,
            mending: MENDING * (f64::from(substeps.per_second()) / f64::from(BEATS * MOST)).max(1.0),
            // Without gravity there is no chatter to be left out.
            rest_speed: if gravity == DVec2::ZERO { 0.0 } else { tuning.rest_speed },
            softness: substeps.softness(crush),
            crush,
            unlike: Unlike::Nothing,
            keeping: Keeping::Nothing,
            to_the_end: None,
        };
        setting.with_length(substeps)
    }

    /// The same for substeps of another length.
    pub(super) fn with_length(self, substeps: &Substeps) -> Self {
        let substep = substeps.seconds();
        let kick = self.gravity * substep;
        Self { substep, kick, firm: substeps.firm(kick), softness: substeps.softness(self.crush), ..self }
    }

    /// The place of a ball that is nearest to this one, between the walls where there are any.
    #[inline]
    pub(super) fn inside(&self, place: DVec2, radius: f64) -> DVec2 {
        if self.walls.is_some() { within(place, radius, self.size) } else { place }
    }
}

/// Whether balls can come to rest.
pub(in super::super) fn can_rest(world: &World, balls: &[Ball]) -> bool {
    world.gravity.is_some() || takes_energy(world.walls, least_restitution(balls))
}

/// Whether walls of this restitution, or balls of which the least has that, take energy where they are hit.
pub(super) fn takes_energy(walls: Option<f64>, least_restitution: f64) -> bool {
    least_restitution < 1.0 || walls.is_some_and(|e| e < 1.0)
}

/// The least restitution of any ball: where it is 1, they meet each other without loss.
pub(super) fn least_restitution(balls: &[Ball]) -> f64 {
    balls.iter().map(|ball| ball.restitution).fold(1.0, f64::min)
}
