//! The ways of balls within a substep that a frame ends in, leg by leg, from impact to impact.
//!
//! Only noted where a frame asks for them: between the substeps that are taken, what flies is shown where it is, as fast as
//! it goes there, and not on the line from where the substep begins to where it ends.

use glam::DVec2;

use super::Body;
use super::fates::Fate;
use super::walls::Met;

/// Legs begin at one time that begin no later than this after each other, s.
const AT_ONE_TIME: f64 = 1e-9;

/// What a ball goes along after an impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Leg {
    pub(super) body: u32,
    /// What tells the impact before it from others of this ball: of two, the greater was taken later.
    course: u32,
    /// When it begins, s after the substep's beginning, and where.
    pub(super) since: f64,
    pub(super) place: DVec2,
    /// As fast as through a whole substep, px/s; [`None`] where that is not known.
    pub(super) velocity: Option<DVec2>,
}

impl Leg {
    /// That of a body which was hit at this time.
    pub(super) fn of(at: usize, body: &Body, fate: &Fate, since: f64) -> Self {
        let velocity = Some(body.velocity);
        Self { body: at as u32, course: fate.course(), since, place: body.end(since), velocity }
    }

    /// Those of a body that met walls: one after each bounce, or, where it bounced on one again, one that is not known,
    /// whatever it hits after.
    pub(super) fn after_walls(self, before: &Body, after: &Body, met: &Met) -> [Option<Self>; 2] {
        if met.again {
            return [Some(Self { course: u32::MAX, velocity: None, ..self }), None];
        }
        met.first.map(|since| {
            let turned = met.first.map(|first| first <= since);
            let ways = [before, after].map(|body| (body.end(since), body.velocity));
            let of_axis = |axis: usize| ways[usize::from(turned[axis])];
            let (place, velocity) =
                (DVec2::new(of_axis(0).0.x, of_axis(1).0.y), DVec2::new(of_axis(0).1.x, of_axis(1).1.y));
            since.is_finite().then_some(Self { since, place, velocity: Some(velocity), ..self })
        })
    }

    /// Whether one of the two was taken later and begins before the other all the same, with nothing taken back between: a
    /// ball that meets two walls in a substep meets both at once, whatever hits it between.
    fn contradicts(&self, other: &Self) -> bool {
        let (earlier, later) = if self.is_later(other) { (other, self) } else { (self, other) };
        let same = earlier.course >> u16::BITS == later.course >> u16::BITS;
        same && later.since < earlier.since - AT_ONE_TIME
    }

    /// Whether its ball came on it later than on another one.
    fn is_later(&self, other: &Self) -> bool {
        (self.course, self.since) > (other.course, other.since)
    }
}

/// The legs of all balls in a substep.
#[derive(Debug, Clone, Default)]
pub(super) struct Legs {
    /// In any order, those of impacts that were taken back, too: then that which goes on instead came to be later.
    pub(super) list: Vec<Leg>,
    /// Whether they are noted: a frame ends in the substep.
    pub(super) noted: bool,
    /// For each body the places of that which it is on at a time, and of its last; or [`Self::NONE`].
    places: Vec<[u32; 2]>,
}

impl Legs {
    const NONE: u32 = u32::MAX;
    /// The place of the last leg of a body whose way is not known.
    const LOST: u32 = u32::MAX - 1;

    /// Begins a substep in which they are noted, or not.
    pub(super) fn begin(&mut self, noted: bool) {
        self.list.clear();
        self.noted = noted;
    }

    /// Finds out on which each of so many bodies is at this time.
    pub(super) fn look_up(&mut self, bodies: usize, time: f64) {
        let Self { list, places, .. } = self;
        places.clear();
        places.resize(bodies, [Self::NONE; 2]);
        for (place, leg) in (0..).zip(&*list) {
            let [on, last] = &mut places[leg.body as usize];
            if *last == Self::LOST || list.get(*last as usize).is_some_and(|other| leg.contradicts(other)) {
                *last = Self::LOST;
                continue;
            }
            let replace = |known: &mut u32| {
                if list.get(*known as usize).is_none_or(|other| leg.is_later(other)) {
                    *known = place;
                }
            };
            replace(last);
            if leg.since <= time {
                replace(on);
            }
        }
    }

    /// That which a body is on, [`None`] before its first impact, and its last, if it was hit.
    #[inline]
    pub(super) fn of_body(&self, at: usize) -> Option<(Option<&Leg>, &Leg)> {
        let [on, last] = self.places.get(at)?.map(|place| self.list.get(place as usize));
        Some((on, last?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_is_on_the_last_leg_that_has_begun_and_was_not_taken_back() {
        let leg = |body, hits: u32, undone: u32, since| Leg {
            body,
            course: hits | undone << u16::BITS,
            since,
            place: DVec2::ZERO,
            velocity: Some(DVec2::new(f64::from(hits), f64::from(undone))),
        };
        // The second ball is hit at 1, 2 and 4; the last two are taken back, and it is hit at 3 instead.
        let list = vec![leg(1, 1, 0, 1.0), leg(1, 2, 1, 3.0), leg(1, 2, 0, 2.0), leg(1, 3, 0, 4.0)];
        let mut legs = Legs { list: [list, vec![leg(1, 1, 1, 1.0)]].concat(), ..Legs::default() };
        for (time, want) in
            [(0.5, None), (1.5, Some((1.0, 1.0))), (2.5, Some((1.0, 1.0))), (4.5, Some((2.0, 1.0)))]
        {
            legs.look_up(3, time);
            let (on, last) = legs.of_body(1).unwrap();
            let on = on.and_then(|leg| leg.velocity);
            assert_eq!(on.map(|velocity| (velocity.x, velocity.y)), want, "at {time}");
            assert_eq!(last.since, 3.0);
            assert!([0, 2].iter().all(|&other| legs.of_body(other).is_none()));
        }
    }
}
