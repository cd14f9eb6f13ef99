//! What becomes of a ball that is crushed: it hits a fixed one, and others, endlessly at one time, since it has no room between them and
//! none of them gives way.

use glam::DVec2;

use crate::simulation::Tally;

use super::flights::{Marks, Way};
use super::impacts::Meeting;
use super::together::AT_HAND;
use super::{Exact, Needs};

/// The part of an approach of balls that are wedged in that may be left of it where it was taken: what was found is no nearer.
const NOT_TAKEN: f64 = 1e-3;

impl Exact {
    /// Stops a ball that hits a fixed one, and others, endlessly at one time: it has no room between them. It goes on along them, if
    /// that can be found and nothing presses it on the fixed one from then on; else it is laid to rest: it would be hit as often again
    /// and again, while time crept on.
    pub(super) fn stop_on_fixed<N: Needs>(
        &mut self,
        tally: &mut Tally,
        [one, other]: [usize; 2],
        before: &Meeting,
        now: f64,
    ) {
        let moves = if self.matter::<N>(one).is_fixed() { other } else { one };
        let pull = self.pull::<N>(one) - self.pull::<N>(other);
        // Another ball may press it on that one, and be pressed in turn.
        let goes_on = (pull == DVec2::ZERO || !self.touches_any_that_moves::<N>(moves, now)) && {
            self.settle::<N>(tally, moves, now);
            let ((_, v1), (_, v2)) = (self.state::<N>(one, now), self.state::<N>(other, now));
            let (left, taken) = (v1 - v2, before.velocity.dot(before.offset));
            // What goes round a ball fast enough is not held on it.
            let pressed = pull.dot(before.offset) < -left.length_squared();
            !pressed && left.dot(before.offset) >= NOT_TAKEN * taken
        };
        if goes_on {
            tally.impacts += 1;
            self.foresee_both::<N>(one, other, now);
        } else {
            let places = [one, other].map(|slot| (slot, self.state::<N>(slot, now).0));
            self.hold::<N>(tally, places, now);
        }
    }

    /// Whether a ball touches another one that is not fixed.
    fn touches_any_that_moves<N: Needs>(&self, slot: usize, now: f64) -> bool {
        let Some(cells) = &self.cells else { return false };
        let (position, _) = self.state::<N>(slot, now);
        let (radius, mut touches) = (self.matter::<N>(slot).radius, false);
        cells.for_each_near::<N>(slot, self.flights[slot].place, None, |other| {
            let matter = self.matter::<N>(other);
            let (place, _) = self.state::<N>(other, now);
            let near = place.distance(position) <= (1.0 + AT_HAND) * (radius + matter.radius);
            touches |= near && other != slot && !matter.is_fixed();
        });
        touches
    }

    /// Lays a ball to rest that hits a fixed one, and others, endlessly at one time: it has no room between them, and
    /// none of them gives way. An impact of another ball may free it.
    fn hold<N: Needs>(&mut self, tally: &mut Tally, two: [(usize, DVec2); 2], now: f64) {
        for (slot, position) in two {
            self.set_out(slot, (position, DVec2::ZERO), now);
            let marks = &mut self.marks[slot];
            marks.go(Way::Flies);
            marks.rest(3);
            marks.set(Marks::HIT, true);
            marks.set(Marks::LEANS, true);
        }
        tally.impacts += 1;
        let [(one, _), (other, _)] = two;
        self.foresee_both::<N>(one, other, now);
    }
}
