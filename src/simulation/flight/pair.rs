//! Two balls: when they meet and part in straight flight, and what counts as touching and approaching.

use glam::DVec2;

use super::NEVER;

/// Rounding of the offset and the relative velocity, as a fraction of the sizes they were computed from.
pub(super) const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Balls that touch approach each other faster than this part of their speeds, or not at all: where three are pressed
/// together and their masses are very unequal, rounding hands less than this on from one to the next for ever.
const BLUR: f64 = 64.0 * f64::EPSILON;

/// The depth of an overlap that is no rounding, as a part of the distance at which two balls touch.
pub(in crate::simulation) const DEEP: f64 = 1e-7;

/// Balls that overlap at relative rest part so fast that they would be apart after this time, s. Nothing in the law of
/// impact says how fast: slower would hardly be seen as parting, and faster as an explosion.
const PARTING_TIME: f64 = 0.02;
/// ... but by no more in a second than this many times the distance at which they touch.
const FASTEST_PARTING: f64 = 4.0;

/// What has no room, and approaches so slowly that it does not meet at once, does so when it has come nearer by this part of the
/// distance at which it touches: little enough to be seen by no one, and enough for time to pass.
pub(super) const SUNK: f64 = 2e-7;

/// Balls touch, or may as good as touch, that are nearer to each other than the distance at which they touch times this.
const NEARLY: f64 = 1.0 + 1e-6;

/// The slowest speed that counts, px/s: halved on and on, speeds end in numbers that cannot be halved.
const SLOWEST: f64 = 1e-100;

/// The least speed, px/s, at which two balls are to part that overlap at relative rest, by their distance and that at
/// which they touch, px; 0 where they do not overlap by more than rounding.
pub(in crate::simulation) fn least_parting(distance: f64, reach: f64) -> f64 {
    let depth = reach - distance;
    let fastest = reach * FASTEST_PARTING;
    if depth > DEEP * reach { (depth / PARTING_TIME).min(fastest) } else { 0.0 }
}

/// Two balls as one sees the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::simulation) struct Pair {
    /// The position of the other relative to the one, px.
    pub offset: DVec2,
    /// The velocity of the other relative to the one, px/s.
    pub velocity: DVec2,
    /// The distance at which they touch, px.
    pub reach: f64,
    /// The velocity of the one, px/s: its size blurs the relative velocity.
    pub own: DVec2,
    /// The speed of parting, px/s, below which balls that overlap are at rest.
    pub slow: f64,
    /// The speed of approach, px/s, up to which balls that touch do not meet, pressed together or not: 0 unless they
    /// have no room to part.
    pub dull: f64,
}

impl Pair {
    /// When they meet, in straight flight: t = c / (−b + √(b² − w²c)) with b = d·w and c = d² − s².
    ///
    /// The discriminant is w²s² − (d×w)² by Lagrange's identity: how far they pass each other by against how far they
    /// reach. So written, its rounding grows with the distance they come from; as b² − w²c, with the square of that.
    ///
    /// What overlaps and is at rest neither approaches nor parts, and would stay so for ever: it meets now, too.
    #[inline]
    pub(in crate::simulation) fn meet(&self) -> f64 {
        if self.are_within(ROUNDING) {
            return self.meet_at_once(self.offset.dot(self.velocity));
        }
        self.meet_from_afar()
    }

    /// The same where they do not touch.
    #[inline]
    pub(in crate::simulation) fn meet_from_afar(&self) -> f64 {
        let b = self.offset.dot(self.velocity);
        let square = self.reach * self.reach;
        let c = self.offset.length_squared() - square;
        let across = self.offset.perp_dot(self.velocity);
        let discriminant = self.velocity.length_squared() * square - across * across;
        // Whether they meet is a toss that no processor can foretell: there is no branch for it.
        let parts = if b < 0.0 { 0.0 } else { NEVER };
        let misses = if discriminant >= 0.0 { 0.0 } else { NEVER };
        let (time, least) = (c / (discriminant.sqrt() - b), parts + misses);
        // Not `max`, which takes longer to do the same: of a NaN and another number, it is the other.
        if time > least { time } else { least }
    }

    /// Whether they touch, or nearly so: the square of their distance exceeds that at which they touch by at most this
    /// part of it.
    #[inline]
    pub(in crate::simulation) fn are_within(&self, part: f64) -> bool {
        let square = self.reach * self.reach;
        self.offset.length_squared() - square <= part * square
    }

    /// Whether they overlap by more than rounding.
    pub(in crate::simulation) fn overlap_deeply(&self) -> bool {
        self.offset.length() < (1.0 - DEEP) * self.reach
    }

    /// Whether they surely do not come to touch within this time, s, where the other is accelerated by this relative to the one:
    /// whether they stay apart along one axis. That takes no root.
    #[inline]
    pub(in crate::simulation) fn keeps_away(&self, acceleration: DVec2, time: f64) -> bool {
        let way = (self.velocity.abs() + acceleration.abs() * (0.5 * time)) * time;
        // Of a way without end, or of NaN, nothing is said.
        (self.offset.abs() - way).cmpgt(DVec2::splat(self.reach * NEARLY)).any()
    }

    /// Whether they approach each other: what rounding makes of none is none.
    pub(in crate::simulation) fn closes_in(&self) -> bool {
        self.approaches(self.offset.dot(self.velocity))
    }

    /// Whether they touch, or are apart, and do not approach each other: then they never meet in straight flight.
    #[inline]
    pub(in crate::simulation) fn parts_from_touch(&self) -> bool {
        let square = self.reach * self.reach;
        // What overlaps deeply may be at rest.
        let touches = self.offset.length_squared() - square > -DEEP * square;
        touches && self.offset.dot(self.velocity) >= 0.0
    }

    /// When they stop overlapping, in straight flight, if they overlap now or touch and approach: the later root of
    /// |d + wt| = s. 0 where they do not overlap and part; [`NEVER`] where they overlap at relative rest.
    #[inline]
    pub(in crate::simulation) fn part(&self) -> f64 {
        let b = self.offset.dot(self.velocity);
        let c = self.offset.length_squared() - self.reach * self.reach;
        if b >= 0.0 && c >= 0.0 {
            return 0.0;
        }
        let square = self.velocity.length_squared();
        // While they overlap this is a sum; below 0 it is the rounding of a grazing entry.
        let root = (b * b - square * c).max(0.0).sqrt();
        if b < 0.0 { (root - b) / square } else { -c / (root + b) }
    }

    /// When they meet, where they touch or overlap: now or never; or soon, where they have no room and approach slowly.
    #[cold]
    fn meet_at_once(self, b: f64) -> f64 {
        let meets = if b < 0.0 { self.approaches(b) } else { self.stays_inside() };
        if meets {
            0.0
        } else if self.approaches_faster_than(0.0, b) {
            SUNK * self.reach * self.offset.length() / -b
        } else {
            NEVER
        }
    }

    /// Whether they overlap, and part so slowly that it counts as rest.
    fn stays_inside(&self) -> bool {
        let length = self.offset.length();
        let parting =
            if length > 0.0 { self.offset.dot(self.velocity) / length } else { self.velocity.length() };
        parting < self.slow.min(0.5 * least_parting(length, self.reach))
    }

    /// Whether the scalar product `b` of offset and velocity is an approach that counts.
    pub(super) fn approaches(&self, b: f64) -> bool {
        self.approaches_faster_than(self.dull, b)
    }

    /// Whether it is one at more than this, px/s, not the rounding of that.
    fn approaches_faster_than(&self, least: f64, b: f64) -> bool {
        let speed = self.own.length() + (self.own + self.velocity).length() + SLOWEST;
        b < -(BLUR * speed + least) * self.offset.length()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{position, reach};
    use super::*;

    fn pair(offset: DVec2, velocity: DVec2, reach: f64) -> Pair {
        Pair { offset, velocity, reach, own: DVec2::ZERO, slow: 1.0, dull: 0.0 }
    }

    #[test]
    fn what_hops_off_a_ball_at_rest_comes_back_to_it_however_short_the_hop() {
        let gravity = DVec2::new(0.0, 980.0);
        for (step, digits) in (0..4000).flat_map(|step| (2..18).map(move |digits| (step, digits))) {
            let any = |times: f64| (times * f64::from(step)).fract();
            // Up is where y is less; the ball stands up to half a radian beside the other's top.
            let up = DVec2::from_angle(any(0.618) - 0.5).perp() * -1.0;
            let reach = 1.0 + 60.0 * any(0.755);
            let speed = 10_f64.powi(-digits);
            // They touch, up to some rounding; or overlap.
            let gap = [0.0, 1e-16, -1e-16, 4e-16, -4e-16, -1e-14, -1e-12, -1e-9][step as usize % 8];
            let hops = pair(up * (reach * (1.0 + gap)), up * speed + 1e-3 * up.perp(), reach);
            let back = hops.meet_accelerated(gravity, 1.0);
            let lasts = 2.0 * speed / gravity.dot(-up);
            // What overlaps meets where it turns, half-way.
            assert!(
                (0.49 * lasts - 1e-7..=1.01 * lasts + 1e-7).contains(&back),
                "1e-{digits} px/s, {up}, {reach}: {back:e}, not {lasts:e}"
            );
        }
    }

    #[test]
    fn overlapping_and_approaching_is_now_and_overlapping_and_parting_never() {
        let towards = pair(DVec2::new(9.0, 0.0), DVec2::new(-1.0, 0.0), 10.0);
        let apart = pair(DVec2::new(9.0, 0.0), DVec2::new(1.0, 0.0), 10.0);
        assert_eq!((towards.meet(), apart.meet()), (0.0, NEVER));
        assert_eq!(towards.meet_accelerated(DVec2::Y, NEVER), 0.0);
        assert_eq!(apart.meet_accelerated(DVec2::X, NEVER), NEVER);
    }

    #[test]
    fn what_touches_and_approaches_by_rounding_alone_does_not_meet() {
        let touching = |approach: f64| Pair {
            own: DVec2::new(35.0, 0.0),
            ..pair(DVec2::new(10.0, 0.0), DVec2::new(-approach, 0.0), 10.0)
        };
        assert_eq!((touching(1e-13).meet(), touching(1e-11).meet()), (NEVER, 0.0));
    }

    #[test]
    fn what_overlaps_at_rest_meets_now_unless_it_parts_as_fast_as_its_depth_asks() {
        let parting = |speed| pair(DVec2::new(9.0, 0.0), DVec2::new(speed, 0.0), 10.0);
        // 1 px deep: 40 px/s, which is four times the distance at which they touch, and not 50.
        assert_eq!(least_parting(9.0, 10.0), 40.0);
        assert_eq!((parting(0.0).meet(), parting(0.9).meet(), parting(1.1).meet()), (0.0, 0.0, NEVER));
        // A thousandth of a pixel deep: 0.05 px/s, of which half is enough.
        let shallow = |speed| pair(DVec2::new(9.999, 0.0), DVec2::new(speed, 0.0), 10.0);
        assert_eq!((shallow(0.0).meet(), shallow(0.024).meet(), shallow(0.026).meet()), (0.0, 0.0, NEVER));
        // What touches, up to rounding, does not overlap; at one point any speed is one of parting.
        let touching = pair(DVec2::new(10.0 - 1e-9, 0.0), DVec2::ZERO, 10.0);
        assert_eq!((least_parting(10.0 - 1e-9, 10.0), touching.meet()), (0.0, NEVER));
        let at_one_point = |speed| pair(DVec2::ZERO, DVec2::new(0.0, speed), 10.0).meet();
        assert_eq!((at_one_point(0.0), at_one_point(2.0)), (0.0, NEVER));
    }

    #[test]
    fn a_ball_that_falls_straight_on_one_at_rest_meets_it_when_the_closed_form_says_so() {
        let pair = pair(DVec2::new(0.0, -510.0), DVec2::ZERO, 20.0);
        assert!((pair.meet_accelerated(DVec2::new(0.0, 980.0), NEVER) - 1.0).abs() < 1e-15);
        assert_eq!(pair.meet_accelerated(DVec2::new(0.0, 980.0), 0.9), NEVER);
        assert_eq!(pair.meet_accelerated(DVec2::new(0.0, -980.0), NEVER), NEVER);
    }

    #[test]
    fn discs_that_overlap_part_at_the_later_root() {
        // From the middle, half way in, half way out; at relative rest never; apart already now.
        let parts = |x, velocity| pair(DVec2::new(x, 0.0), DVec2::new(velocity, 0.0), 10.0).part();
        assert_eq!((parts(0.0, 2.0), parts(5.0, -1.0), parts(5.0, 1.0)), (5.0, 15.0, 5.0));
        assert_eq!(
            (parts(5.0, 0.0), parts(0.0, 0.0), parts(10.0, 1.0), parts(11.0, 1.0)),
            (NEVER, NEVER, 0.0, 0.0)
        );
        // Thrown up out of a ball that rests, one comes down and crosses it again.
        let thrown = pair(DVec2::new(0.0, -8.0), DVec2::new(0.0, -1.0), 10.0);
        let pull = DVec2::new(0.0, 0.2);
        assert!((thrown.part_accelerated(pull, NEVER) - (5.0 - 5.0_f64.sqrt())).abs() < 1e-14);
        assert_eq!(thrown.part_accelerated(pull, 2.0), NEVER);
        let risen = pair(DVec2::new(0.0, -9.0), DVec2::new(0.0, -0.5), 10.0);
        assert!((risen.part_accelerated(pull, NEVER) - (2.5 + 196.25_f64.sqrt())).abs() < 1e-13);
    }

    #[test]
    fn what_slides_off_a_ball_at_rest_fast_enough_is_not_pressed_on_it() {
        // On top of it, at rest or slower than √(as) it is; faster, it flies off.
        let on_top = |speed| pair(DVec2::new(0.0, -10.0), DVec2::new(speed, 0.0), 10.0);
        let pull = DVec2::new(0.0, 10.0);
        assert_eq!(
            (on_top(0.0).meet_accelerated(pull, NEVER), on_top(9.0).meet_accelerated(pull, NEVER)),
            (0.0, 0.0)
        );
        assert_eq!(on_top(11.0).meet_accelerated(pull, NEVER), NEVER);
        assert!(
            on_top(0.0).part_accelerated(pull, NEVER) > 1.9
                && on_top(9.0).part_accelerated(pull, NEVER) > 0.5
        );
        assert_eq!(on_top(11.0).part_accelerated(pull, NEVER), 0.0);
    }

    #[test]
    fn what_has_no_room_and_approaches_slowly_meets_when_it_has_sunk_a_little() {
        let without_room =
            |speed: f64| Pair { dull: 2.0, ..pair(DVec2::new(0.0, -10.0), DVec2::new(0.0, speed), 10.0) };
        // By the 2e-6 px that are SUNK of the distance at which they touch.
        assert_eq!([3.0, 1.0, 0.0, -1.0].map(|speed| without_room(speed).meet()), [0.0, 2e-6, NEVER, NEVER]);
        // Pressed together, it comes to that at rest, too, whatever rounding puts between them: ½at².
        for gap in [0.0, 4e-15, -4e-15] {
            let pair = Pair { offset: DVec2::new(0.0, -10.0 - gap), ..without_room(0.0) };
            let at_rest = |pull: f64, limit: f64| pair.meet_accelerated(DVec2::new(0.0, pull), limit);
            assert!((at_rest(4.0, NEVER) - 1e-3).abs() < 1e-15, "{gap}");
            assert_eq!([at_rest(4.0, 9e-4), at_rest(-4.0, NEVER)], [NEVER; 2], "{gap}");
            // ... and sooner where it approaches besides: vt + ½at², by the golden section.
            let approaching = Pair { velocity: DVec2::new(0.0, 2e-3), ..pair };
            let time = approaching.meet_accelerated(DVec2::new(0.0, 4.0), NEVER);
            assert!((time - 0.618_033_988_75e-3).abs() < 1e-14, "{gap}: {time}");
        }
    }

    #[test]
    fn what_rounding_moves_apart_while_it_is_pressed_on_a_ball_does_not_part_from_it() {
        // At 1e9 px/s 1e-6 px/s is rounding, and lifts it by more than the last bit before it falls.
        let pair =
            Pair { own: DVec2::new(1e9, 0.0), ..pair(DVec2::new(0.0, -10.0), DVec2::new(0.0, -1e-6), 10.0) };
        let pull = DVec2::new(0.0, 10.0);
        assert_eq!(pair.meet_accelerated(pull, NEVER), 0.0);
        assert!((pair.part_accelerated(pull, NEVER) - 2.0).abs() < 1e-6);
    }

    #[test]
    fn an_acceleration_too_small_to_be_squared_is_none() {
        let weak = DVec2::new(1e-200, 0.0);
        let approaching = pair(DVec2::new(30.0, 0.0), DVec2::new(-10.0, 0.0), 10.0);
        assert_eq!(approaching.meet_accelerated(weak, NEVER), 2.0);
        assert_eq!(approaching.meet_accelerated(weak, 1.9), NEVER);
        let within = pair(DVec2::new(5.0, 0.0), DVec2::new(-10.0, 0.0), 10.0);
        assert_eq!(within.part_accelerated(weak, NEVER), 1.5);
        assert_eq!(within.part_accelerated(weak, 1.4), NEVER);
    }

    /// Anything that limits.rs allows, evenly over the powers of ten, and 0.
    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![
            Just(0.0),
            (-12.0..9.0, any::<bool>()).prop_map(|(power, negative): (f64, bool)| {
                10.0_f64.powf(power).copysign(if negative { -1.0 } else { 1.0 })
            }),
            (-300.0..9.0).prop_map(|power| 10.0_f64.powf(power)),
            Just(-1e9),
        ]
    }

    fn vector(most: f64) -> impl Strategy<Value = DVec2> {
        (-most..most, -most..most).prop_map(|(x, y)| DVec2::new(x, y))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn every_time_is_a_number_from_0_on(
            x in number(), y in number(), u in number(), v in number(), own in number(), ax in number(), ay in number(),
            power in -6.0..9.0, limit in 0.0..1e6, far in any::<bool>(),
        ) {
            let (acceleration, limit) = (DVec2::new(ax, ay), if far { NEVER } else { limit });
            let pair = Pair {
                offset: DVec2::new(x, y),
                velocity: DVec2::new(u, v),
                reach: 10.0_f64.powf(power),
                own: DVec2::new(own, 0.0),
                slow: 1.0,
                dull: 0.0,
            };
            // The same pair where its edges touch, up to rounding.
            let touching = Pair { reach: pair.offset.length().max(1e-6), ..pair };
            for pair in [pair, touching] {
                let (meets, parts) =
                    (pair.meet_accelerated(acceleration, limit), pair.part_accelerated(acceleration, limit));
                for time in [reach(x, u, ax), pair.meet(), pair.part(), meets, parts] {
                    prop_assert!(time >= 0.0);
                }
                prop_assert!((meets <= limit || meets == NEVER) && (parts <= limit || parts == NEVER));
            }
        }

        #[test]
        fn balls_touch_at_the_time_found_and_not_before(
            offset in vector(200.0), velocity in vector(500.0), acceleration in vector(980.0), reach in 1.0..60.0,
        ) {
            prop_assume!(offset.length() > reach);
            let pair = pair(offset, velocity, reach);
            for (acceleration, time) in
                [(DVec2::ZERO, pair.meet()), (acceleration, pair.meet_accelerated(acceleration, NEVER))]
            {
                let gap = |t| position(offset, velocity, acceleration, t).length() - reach;
                // Nothing touches later than some seconds here, unless the acceleration is next to nothing.
                let end = time.min(10.0);
                for step in 0..2000 {
                    prop_assert!(gap(end * f64::from(step) / 2000.0) > -1e-9);
                }
                if time < NEVER {
                    prop_assert!(gap(time).abs() < 1e-10 * (1.0 + velocity.length() * time + 1e3 * time * time));
                }
            }
        }

        #[test]
        fn what_keeps_away_does_not_meet_until_then(
            offset in vector(200.0), velocity in vector(500.0), acceleration in vector(980.0), reach in 1.0..60.0,
            seconds in 0.0..0.5,
        ) {
            let pair = pair(offset, velocity, reach);
            if pair.keeps_away(acceleration, seconds) {
                prop_assert_eq!(pair.meet_accelerated(acceleration, seconds), NEVER);
            }
            prop_assert!(!pair.keeps_away(acceleration, NEVER));
        }

        #[test]
        fn balls_that_fly_through_each_other_enter_and_leave_in_turn(
            offset in vector(200.0), velocity in vector(500.0), acceleration in vector(980.0), reach in 1.0..60.0,
        ) {
            prop_assume!(offset.length() > reach);
            let after = |pair: Pair, acceleration, time| Pair {
                offset: position(pair.offset, pair.velocity, acceleration, time),
                velocity: pair.velocity + acceleration * time,
                ..pair
            };
            let apart = pair(offset, velocity, reach);
            let enters = apart.meet();
            if enters < NEVER {
                let inside = after(apart, DVec2::ZERO, enters);
                let leaves = inside.part();
                // The chord, whose middle is where they are closest.
                let middle = -inside.offset.dot(velocity) / velocity.length_squared();
                prop_assert!((leaves - 2.0 * middle).abs() < 1e-9 * (1.0 + enters));
                prop_assert_eq!(after(inside, DVec2::ZERO, leaves).meet(), NEVER);
            }
            let mut now = apart;
            for _ in 0..3 {
                let enters = now.meet_accelerated(acceleration, NEVER);
                if enters == NEVER {
                    break;
                }
                let inside = after(now, acceleration, enters);
                let leaves = inside.part_accelerated(acceleration, NEVER);
                prop_assert!(leaves > 0.0 && leaves < NEVER);
                let gap = |t| position(inside.offset, inside.velocity, acceleration, t).length() - reach;
                for step in 1..100 {
                    prop_assert!(gap(leaves * f64::from(step) / 100.0) < 1e-8);
                }
                now = after(inside, acceleration, leaves);
            }
            // The square of the distance is of fourth degree: they are in each other twice at most.
            prop_assert_eq!(now.meet_accelerated(acceleration, NEVER), NEVER);
        }
    }
}
