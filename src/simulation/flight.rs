//! Closed-form flight and its roots: when does a ball reach a wall, when do two balls meet.
//!
//! Every time is seconds from now; [`NEVER`] says that it does not happen. Roots are written so that nearly equal
//! numbers are never subtracted, and the rule for contact is that of Bannerman, Strobl, Formella and Pöschel (2014,
//! arXiv:1211.6718): what overlaps and approaches meets now, what overlaps and parts does not meet.

use glam::DVec2;

/// The time of what does not happen.
pub(super) const NEVER: f64 = f64::INFINITY;

/// Where something is after `time` seconds, with constant acceleration.
#[inline]
pub(super) fn position(position: DVec2, velocity: DVec2, acceleration: DVec2, time: f64) -> DVec2 {
    position + (velocity + 0.5 * acceleration * time) * time
}

/// When something that is `gap` away from a line, approaches it at `speed` and is accelerated toward it by
/// `acceleration` (both negative for away) next meets it while approaching.
///
/// Behind the line (a negative gap) it meets as soon as it approaches.
#[inline]
pub(super) fn reach(gap: f64, speed: f64, acceleration: f64) -> f64 {
    if acceleration == 0.0 {
        return if speed > 0.0 { gap.max(0.0) / speed } else { NEVER };
    }
    if gap <= 0.0 && speed >= 0.0 && (speed > 0.0 || acceleration > 0.0) {
        return 0.0;
    }
    let discriminant = speed * speed + 2.0 * acceleration * gap;
    if acceleration < 0.0 {
        // It slows down: it comes in time, or turns back.
        return if speed > 0.0 && discriminant >= 0.0 {
            2.0 * gap / (speed + discriminant.sqrt())
        } else {
            NEVER
        };
    }
    if speed > 0.0 {
        2.0 * gap / (speed + discriminant.sqrt())
    } else if discriminant >= 0.0 {
        // It goes away first and returns.
        (discriminant.sqrt() - speed) / acceleration
    } else {
        // It never comes out from behind the line; it approaches again from its turning point on.
        -speed / acceleration
    }
}

/// Rounding of the relative distance and velocity, as a fraction of the sizes they were computed from.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Two balls as one sees the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pair {
    /// The position of the other, px.
    pub distance: DVec2,
    /// Its velocity, px/s.
    pub velocity: DVec2,
    /// The distance at which they touch, px.
    pub reach: f64,
    /// The velocity of the one, px/s: its size blurs the relative velocity.
    pub own: DVec2,
}

impl Pair {
    /// When they meet, in straight flight: t = c / (−b + √(b² − w²c)) with b = d·w and c = d² − s².
    #[inline]
    pub(super) fn meet(&self) -> f64 {
        let b = self.distance.dot(self.velocity);
        if b >= 0.0 {
            return NEVER;
        }
        let c = self.distance.length_squared() - self.reach * self.reach;
        if c <= ROUNDING * self.reach * self.reach {
            return if self.approaches(b) { 0.0 } else { NEVER };
        }
        let discriminant = b * b - self.velocity.length_squared() * c;
        if discriminant < 0.0 { NEVER } else { c / (discriminant.sqrt() - b) }
    }

    /// Whether the scalar product `b` of distance and velocity is an approach, not the rounding of none.
    fn approaches(&self, b: f64) -> bool {
        let speed = self.own.length() + (self.own + self.velocity).length();
        b < -ROUNDING * speed * self.distance.length()
    }

    /// When they meet, where the other is accelerated by `acceleration` relative to the one (one of them rests on a
    /// wall). [`NEVER`] where that is not within `limit`.
    pub(super) fn meet_accelerated(&self, acceleration: DVec2, limit: f64) -> f64 {
        let gap = self.distance.length() - self.reach;
        let span = limit.min(self.horizon(acceleration));
        // Most pairs are too far from each other to meet before something else happens.
        if gap > (self.velocity.length() + 0.5 * acceleration.length() * span) * span {
            return NEVER;
        }
        if gap <= ROUNDING * self.reach {
            let b = self.distance.dot(self.velocity);
            if self.approaches(b) {
                return 0.0;
            }
            // At relative rest they meet where the acceleration presses them together.
            if !self.approaches(-b) && self.distance.dot(acceleration) < 0.0 {
                return 0.0;
            }
        }
        let path = Path { pair: self, acceleration };
        let turns = path.turns(span);
        for (from, to) in turns.spans() {
            // Overlapping from before: they meet as soon as they approach.
            let (start, end) = (path.depth(from), path.depth(to));
            let approaching = end > start;
            if approaching && start >= 0.0 && from > 0.0 {
                return from;
            }
            if approaching && start < 0.0 && end >= 0.0 {
                return root(from, to, |t| (path.depth(t), path.deepening(t)));
            }
        }
        NEVER
    }

    /// From when on the acceleration has carried them apart for good.
    fn horizon(&self, acceleration: DVec2) -> f64 {
        let (a, w) = (acceleration.length(), self.velocity.length());
        let far = self.distance.length() + self.reach;
        // ½at² = wt + far, and a little more.
        1.01 * (w + (w * w + 2.0 * a * far).sqrt()) / a
    }
}

/// Relative motion under acceleration: a parabola. The square of the distance along it is of fourth degree in time.
struct Path<'a> {
    pair: &'a Pair,
    acceleration: DVec2,
}

impl Path<'_> {
    fn at(&self, time: f64) -> (DVec2, DVec2) {
        let Pair { distance, velocity, .. } = *self.pair;
        (position(distance, velocity, self.acceleration, time), velocity + self.acceleration * time)
    }

    /// s² − |r|²: positive while they overlap.
    fn depth(&self, time: f64) -> f64 {
        let (r, _) = self.at(time);
        self.pair.reach * self.pair.reach - r.length_squared()
    }

    /// Its derivative, −2 r·r′.
    fn deepening(&self, time: f64) -> f64 {
        let (r, w) = self.at(time);
        -2.0 * r.dot(w)
    }

    /// The times from 0 to `span` at which approach turns into parting or back: the roots of the cubic r·r′, which
    /// are separated by those of its derivative, a quadratic.
    fn turns(&self, span: f64) -> Turns {
        let Pair { distance: d, velocity: w, .. } = *self.pair;
        let a = self.acceleration;
        let mut bends = Turns::new();
        // r·r′ has the derivative w² + a·d + 3 (a·w) t + 1.5 a² t².
        let (constant, half, square) =
            (w.length_squared() + a.dot(d), 1.5 * a.dot(w), 1.5 * a.length_squared());
        let discriminant = half * half - square * constant;
        if discriminant > 0.0 {
            let sum = -(half + discriminant.sqrt().copysign(half));
            let (one, other) = (sum / square, if sum == 0.0 { 0.0 } else { constant / sum });
            bends.add(one.min(other), span);
            bends.add(one.max(other), span);
        }
        bends.add_end(span);
        let mut turns = Turns::new();
        for (from, to) in bends.spans() {
            let (start, end) = (self.deepening(from), self.deepening(to));
            if (start < 0.0) != (end < 0.0) {
                let sign = if start < end { 1.0 } else { -1.0 };
                let turn = root(from, to, |t| {
                    let (r, v) = self.at(t);
                    (-2.0 * sign * r.dot(v), -2.0 * sign * (v.length_squared() + r.dot(a)))
                });
                turns.add(turn, span);
            }
        }
        turns.add_end(span);
        turns
    }
}

/// Up to five times in rising order, the first of them 0.
struct Turns {
    times: [f64; 5],
    count: usize,
}

impl Turns {
    fn new() -> Self {
        Self { times: [0.0; 5], count: 1 }
    }

    fn add(&mut self, time: f64, span: f64) {
        if time > self.times[self.count - 1] && time < span {
            self.add_end(time);
        }
    }

    fn add_end(&mut self, time: f64) {
        self.times[self.count] = time;
        self.count += 1;
    }

    fn spans(&self) -> impl Iterator<Item = (f64, f64)> {
        self.times[..self.count].windows(2).map(|pair| (pair[0], pair[1]))
    }
}

/// The root of a function that rises from below 0 at `low` to 0 or above at `high`: Newton's method, kept inside the
/// bracket by bisection. `function` returns value and derivative.
fn root(mut low: f64, mut high: f64, function: impl Fn(f64) -> (f64, f64)) -> f64 {
    let mut time = 0.5 * (low + high);
    // Bisection alone would need as many rounds as an f64 has bits; Newton needs a handful.
    for _ in 0..128 {
        let (value, slope) = function(time);
        if value < 0.0 {
            low = time;
        } else {
            high = time;
        }
        let newton = time - value / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if next == time || next <= low || next >= high {
            break;
        }
        time = next;
    }
    high
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn pair(distance: DVec2, velocity: DVec2, reach: f64) -> Pair {
        Pair { distance, velocity, reach, own: DVec2::ZERO }
    }

    #[test]
    fn a_line_is_reached_when_the_closed_form_says_so() {
        // Dropped from 10 px at 20 px/s²; thrown up first; never, since it turns back.
        assert_eq!(reach(10.0, 0.0, 20.0), 1.0);
        assert_eq!(reach(0.0, -10.0, 20.0), 1.0);
        assert_eq!(reach(10.0, 5.0, -20.0), NEVER);
        assert_eq!(reach(10.0, 5.0, 0.0), 2.0);
        assert_eq!(reach(10.0, -5.0, 0.0), NEVER);
        // Behind the line: now where it approaches, else from the turning point on, else never.
        assert_eq!(reach(-1.0, 5.0, -3.0), 0.0);
        assert_eq!(reach(-100.0, -5.0, 10.0), 0.5);
        assert_eq!(reach(-1.0, -5.0, 0.0), NEVER);
    }

    #[test]
    fn a_tiny_gap_keeps_all_its_digits() {
        // t = g/v·(1 − ag/2v² + …): 1e-9 px at 1e3 px/s. The naive root has no digit of it right.
        for gravity in [980.0, -980.0] {
            let series = 1e-12 * (1.0 - gravity * 1e-9 / 2e6);
            assert!((reach(1e-9, 1e3, gravity) / series - 1.0).abs() < 4.0 * f64::EPSILON);
        }
        assert!((reach(1e-200, 1.0, 1.0) / 1e-200 - 1.0).abs() < 4.0 * f64::EPSILON);
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
    fn a_ball_that_falls_straight_on_one_at_rest_meets_it_when_the_closed_form_says_so() {
        let pair = pair(DVec2::new(0.0, -510.0), DVec2::ZERO, 20.0);
        assert!((pair.meet_accelerated(DVec2::new(0.0, 980.0), NEVER) - 1.0).abs() < 1e-15);
        assert_eq!(pair.meet_accelerated(DVec2::new(0.0, 980.0), 0.9), NEVER);
        assert_eq!(pair.meet_accelerated(DVec2::new(0.0, -980.0), NEVER), NEVER);
    }

    fn vector(most: f64) -> impl Strategy<Value = DVec2> {
        (-most..most, -most..most).prop_map(|(x, y)| DVec2::new(x, y))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn balls_touch_at_the_time_found_and_not_before(
            distance in vector(200.0), velocity in vector(500.0), acceleration in vector(980.0), reach in 1.0..60.0,
        ) {
            prop_assume!(distance.length() > reach);
            let pair = pair(distance, velocity, reach);
            for (acceleration, time) in
                [(DVec2::ZERO, pair.meet()), (acceleration, pair.meet_accelerated(acceleration, NEVER))]
            {
                let gap = |t| position(distance, velocity, acceleration, t).length() - reach;
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
    }
}
