//! What balls sweep until their next impacts: boxes, where they are so few that there is one cell alone.
//!
//! A meeting counts only if it comes before the next impact of either ball. So two whose boxes do not overlap need not be looked
//! at: of few balls in a wide world, most others are left out so, for four comparisons each.

use glam::DVec2;

use crate::simulation::flight::{self, NEVER};

use super::{Exact, Needs};

/// Boxes are so much wider than what is in them: this part of a ball's radius, and of the size of the coordinates, since both are
/// rounded, and balls may as good as touch.
const WIDER: (f64, f64) = (1e-6, 1e-12);

/// A box along the axes; where it sweeps nothing, or is not to be met, none that overlaps any.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Swept {
    low: DVec2,
    high: DVec2,
}

impl Swept {
    pub(super) const NOTHING: Self = Self { low: DVec2::INFINITY, high: DVec2::NEG_INFINITY };
    pub(super) const ALL: Self = Self { low: DVec2::NEG_INFINITY, high: DVec2::INFINITY };

    /// What something sweeps that flies so long, s.
    fn of((position, velocity): (DVec2, DVec2), acceleration: DVec2, time: f64) -> Self {
        let end = flight::position(position, velocity, acceleration, time);
        let (mut low, mut high) = (position.min(end), position.max(end));
        for axis in 0..2 {
            let (speed, pull) = (velocity[axis], acceleration[axis]);
            // Where it turns back.
            if speed * pull < 0.0 && speed.abs() < pull.abs() * time {
                let turn = position[axis] - 0.5 * speed * speed / pull;
                (low[axis], high[axis]) = (low[axis].min(turn), high[axis].max(turn));
            }
        }
        Self { low, high }
    }

    /// The same by so much wider on each side.
    fn widened(self, by: f64) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    #[inline]
    pub(super) fn overlaps(&self, other: &Self) -> bool {
        (self.low.cmplt(other.high) & other.low.cmplt(self.high)).all()
    }
}

impl Exact {
    /// What a ball sweeps from now to its next impact.
    pub(super) fn sweep<N: Needs>(&self, slot: usize, now: f64) -> Swept {
        let time = self.flights[slot].impact - now;
        if time == NEVER {
            return Swept::ALL;
        }
        let swept = Swept::of(self.state::<N>(slot, now), self.pull::<N>(slot), time);
        let (of_radius, of_coordinates) = WIDER;
        let farthest = swept.low.abs().max(swept.high.abs()).max_element();
        swept.widened(self.matter::<N>(slot).radius * (1.0 + of_radius) + of_coordinates * farthest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_holds_all_that_is_swept_and_nothing_beyond() {
        let gravity = DVec2::new(0.0, 980.0);
        for step in 0..4000 {
            let any = |times: f64| (times * f64::from(step)).fract();
            let start = DVec2::new(800.0 * any(0.618), 600.0 * any(0.755));
            let velocity = DVec2::new(any(0.569) - 0.5, any(0.671) - 0.5) * 1000.0;
            let acceleration = [gravity, DVec2::ZERO, DVec2::new(300.0, -700.0)][step as usize % 3];
            let time = 1.5 * any(0.439);
            let swept = Swept::of((start, velocity), acceleration, time);
            let places = (0..=1000)
                .map(|part| flight::position(start, velocity, acceleration, time * f64::from(part) / 1000.0));
            let (low, high) = places.fold((start, start), |(low, high), place| {
                assert!(place.cmpge(swept.low - 1e-9).all() && place.cmple(swept.high + 1e-9).all());
                (low.min(place), high.max(place))
            });
            assert!(low.distance(swept.low) < 1e-2 && high.distance(swept.high) < 1e-2, "{swept:?}");
        }
    }

    #[test]
    fn boxes_overlap_where_they_share_more_than_their_edges() {
        let of = |low: [f64; 2], high: [f64; 2]| Swept { low: low.into(), high: high.into() };
        let one = of([0.0, 0.0], [2.0, 1.0]);
        for (other, overlaps) in [
            (of([1.0, -1.0], [3.0, 0.5]), true),
            (of([2.0, 1.0], [3.0, 3.0]), false),
            (of([1.9, 0.9], [3.0, 3.0]), true),
            (of([0.5, 0.25], [1.0, 0.5]), true),
            (of([2.1, 0.0], [3.0, 1.0]), false),
            (of([0.0, 1.1], [2.0, 2.0]), false),
            (Swept::ALL, true),
            (Swept::NOTHING, false),
        ] {
            assert_eq!((one.overlaps(&other), other.overlaps(&one)), (overlaps, overlaps), "{other:?}");
        }
        assert!(Swept::ALL.overlaps(&Swept::ALL) && !Swept::ALL.overlaps(&Swept::NOTHING));
    }
}
