//! The ways of balls within a substep that a frame ends in, leg by leg, from impact to impact.
//!
//! Only noted where a frame asks for them: between the substeps that are taken, what flies is shown where it is, as fast as
//! it goes there, and not on the line from where the substep begins to where it ends.

use glam::{BVec2, DVec2};

use super::Body;
use super::walls::Met;

/// Legs begin at one time that begin no later than this after each other, s.
const AT_ONE_TIME: f64 = 1e-9;

/// What a ball goes along after an impact, or again where that is taken back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Leg {
    pub(super) body: u32,
    /// Whether it comes of an impact that was taken back: it may begin before the one noted before it.
    pub(super) goes_back: bool,
    /// When it begins, s after the substep's beginning, and where.
    pub(super) since: f64,
    pub(super) place: DVec2,
    /// As fast as through a whole substep, px/s; [`None`] where that is not known.
    pub(super) velocity: Option<DVec2>,
}

impl Leg {
    /// That of a body from this time on.
    pub(super) fn of(at: usize, body: &Body, since: f64) -> Self {
        let (place, velocity) = (body.end(since), Some(body.velocity));
        Self { body: at as u32, goes_back: false, since, place, velocity }
    }

    /// Those of a body that met walls, in their order: one after each bounce, or, where it bounced on one again, one that
    /// is not known.
    pub(super) fn after_walls(self, before: &Body, after: &Body, met: &Met) -> [Option<Self>; 2] {
        if met.again {
            return [Some(Self { velocity: None, ..self }), None];
        }
        let [x, y] = met.first;
        [x.min(y), x.max(y)].map(|since| {
            let turned = BVec2::new(x <= since, y <= since);
            let place = DVec2::select(turned, after.end(since), before.end(since));
            let velocity = Some(DVec2::select(turned, after.velocity, before.velocity));
            since.is_finite().then_some(Self { since, place, velocity, ..self })
        })
    }

    /// Whether it begins before the one that was noted before it, though nothing was taken back: a ball that meets two walls
    /// in a substep meets both at once, unless it goes far between them, whatever hits it there.
    fn contradicts(&self, before: &Self) -> bool {
        !self.goes_back && self.since < before.since - AT_ONE_TIME
    }
}

/// The legs of all balls in a substep.
#[derive(Debug, Clone, Default)]
pub(super) struct Legs {
    /// Those of each ball in the order in which its impacts were taken.
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

    /// Forgets a body that is taken away: those after it move up. Then legs are to be looked up again.
    pub(super) fn forget(&mut self, at: usize) {
        let at = at as u32;
        self.list.retain(|leg| leg.body != at);
        self.list.iter_mut().filter(|leg| leg.body > at).for_each(|leg| leg.body -= 1);
    }

    /// Finds out on which each of so many bodies is at this time: the last noted of those that have begun. What was noted
    /// before an impact was taken back, and has begun, comes before what goes on instead, which has begun, too.
    pub(super) fn look_up(&mut self, bodies: usize, time: f64) {
        let Self { list, places, .. } = self;
        places.clear();
        places.resize(bodies, [Self::NONE; 2]);
        for (place, leg) in (0..).zip(&*list) {
            let [on, last] = &mut places[leg.body as usize];
            let before = list.get(*last as usize);
            let lost = leg.velocity.is_none() || before.is_some_and(|before| leg.contradicts(before));
            if lost || *last == Self::LOST {
                *last = Self::LOST;
                continue;
            }
            *last = place;
            if leg.since <= time {
                *on = place;
            }
        }
    }

    /// That which a body is on, [`None`] before its first impact, and its last; nothing where it was not hit, or its way is
    /// not known.
    #[inline]
    pub(super) fn of_body(&self, at: usize) -> Option<(Option<&Leg>, &Leg)> {
        let [on, last] = self.places.get(at)?.map(|place| self.list.get(place as usize));
        Some((on, last?))
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::ball::Ball;
    use super::*;

    /// A leg of the second ball, which its number tells from others.
    fn leg(number: f64, since: f64) -> Leg {
        let velocity = Some(DVec2::X * number);
        Leg { body: 1, goes_back: false, since, place: DVec2::ZERO, velocity }
    }

    /// On which of these legs the second of three balls is at a time, and which is its last.
    fn on(list: &[Leg], time: f64) -> Option<(Option<f64>, f64)> {
        let mut legs = Legs { list: list.to_vec(), ..Legs::default() };
        legs.look_up(3, time);
        assert!([0, 2].iter().all(|&other| legs.of_body(other).is_none()));
        let number = |leg: &Leg| leg.velocity.map_or(f64::NAN, |velocity| velocity.x);
        legs.of_body(1).map(|(on, last)| (on.map(number), number(last)))
    }

    #[test]
    fn a_ball_is_on_the_last_leg_that_has_begun_and_was_not_taken_back() {
        // It is hit at 1, 2 and 4; the last two are taken back, and it is hit at 3 instead.
        let back = Leg { goes_back: true, ..leg(4.0, 1.0) };
        let list = [leg(1.0, 1.0), leg(2.0, 2.0), leg(3.0, 4.0), back, leg(5.0, 3.0)];
        for (time, want) in [(0.5, None), (1.5, Some(4.0)), (2.5, Some(4.0)), (4.5, Some(5.0))] {
            assert_eq!(on(&list, time), Some((want, 5.0)), "at {time}");
        }
    }

    #[test]
    fn where_impacts_were_not_taken_in_their_order_no_way_is_known() {
        let list = [leg(1.0, 1.0), leg(2.0, 3.0), leg(3.0, 2.0), leg(4.0, 4.0)];
        assert!([0.5, 1.5, 2.5, 3.5, 4.5].iter().all(|&time| on(&list, time).is_none()));
        let bounces = [Leg { velocity: None, ..leg(1.0, 1.0) }, leg(2.0, 2.0)];
        assert!([0.5, 1.5, 2.5].iter().all(|&time| on(&bounces, time).is_none()));
    }

    #[test]
    fn a_ball_in_a_corner_turns_round_at_each_wall_in_turn() {
        let start = Body::new(&Ball::new(DVec2::splat(50.0), 5.0).unwrap(), DVec2::ZERO);
        let before = Body { velocity: DVec2::new(30.0, -20.0), ..start };
        // At the right wall at 2, at the upper one at 1.
        let after = Body {
            velocity: DVec2::new(-30.0, 20.0),
            position: DVec2::new(50.0 + 120.0, 50.0 - 40.0),
            ..start
        };
        let met = Met { first: [2.0, 1.0], ..Met::NOTHING };
        let [one, other] = Leg::of(0, &after, 1.0).after_walls(&before, &after, &met).map(Option::unwrap);
        assert_eq!((one.since, one.place), (1.0, DVec2::new(80.0, 30.0)));
        assert_eq!(one.velocity, Some(DVec2::new(30.0, 20.0)));
        assert_eq!((other.since, other.place), (2.0, DVec2::new(110.0, 50.0)));
        assert_eq!(other.velocity, Some(after.velocity));
        let again = Leg::of(0, &after, 1.0).after_walls(&before, &after, &Met { again: true, ..met });
        assert!(again[0].is_some_and(|leg| leg.velocity.is_none()) && again[1].is_none());
    }
}
