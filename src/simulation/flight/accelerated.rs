//! The flight of a pair of which one rests on a wall: the relative motion is accelerated, and the times of contact are
//! roots of an equation of fourth degree.

use glam::DVec2;

use super::super::lesser::lesser;
use super::pair::{ROUNDING, SUNK};
use super::{NEVER, Pair, position, reach};

/// An acceleration that counts as none, px/s²: in the eleven days of the longest frame it moves nothing by 10⁻²⁸ px.
const WEAK: f64 = 1e-40;

impl Pair {
    /// When they meet, where the other is accelerated by `acceleration` relative to the one (one of them rests on a
    /// wall). [`NEVER`] where that is not within `limit`.
    pub(in crate::simulation) fn meet_accelerated(&self, acceleration: DVec2, limit: f64) -> f64 {
        if acceleration.length_squared() < WEAK * WEAK {
            return within(self.meet(), limit);
        }
        let gap = self.offset.length() - self.reach;
        let span = limit.min(self.horizon(acceleration));
        // Most pairs are too far from each other to meet before something else happens.
        if gap > (self.velocity.length() + 0.5 * acceleration.length() * span) * span {
            return NEVER;
        }
        if self.enters(acceleration) {
            return 0.0;
        }
        let time = self.meet_along(&Path { pair: self, acceleration }, span);
        if self.dull > 0.0 && self.are_within(ROUNDING) {
            // Whether rounding puts a little between them or not.
            return within(time.max(self.sinks_in(acceleration, self.offset, self.velocity)), limit);
        }
        time
    }

    /// The same for what does not meet at once.
    fn meet_along(&self, path: &Path<'_>, span: f64) -> f64 {
        if let Some(time) = path.meets_soon(span) {
            return time;
        }
        for (from, to) in path.turns(span).spans() {
            // Overlapping from before: they meet as soon as they approach.
            let (start, end) = (path.depth(from), path.depth(to));
            let approaching = end > start;
            if approaching && start >= 0.0 && (from > 0.0 || self.dull > 0.0) {
                // Or a little later, if there is no room: what is pressed together from now on, too.
                let (offset, velocity) = path.at(from);
                let time = from + self.sinks_in(path.acceleration, offset, velocity);
                if time <= to {
                    return time;
                }
            }
            if approaching && start < 0.0 && end >= 0.0 {
                return root(from, to, |t| (path.depth(t), path.deepening(t)));
            }
        }
        NEVER
    }

    /// How long it takes at least, where there is no room, until what touches, with this offset and velocity, and is pressed together
    /// approaches too fast, or has sunk too far.
    fn sinks_in(&self, acceleration: DVec2, offset: DVec2, velocity: DVec2) -> f64 {
        let (strength, far) = (acceleration.length(), SUNK * self.reach);
        let approach = (-velocity.dot(offset) / offset.length()).max(0.0);
        lesser((self.dull - approach).max(0.0) / strength, reach(far, approach, strength))
    }

    /// When they stop overlapping, where the other is accelerated by `acceleration` relative to the one, if they
    /// overlap now or touch and approach; 0 where they do neither and part. [`NEVER`] where that is not within `limit`.
    pub(in crate::simulation) fn part_accelerated(&self, acceleration: DVec2, limit: f64) -> f64 {
        if acceleration.length_squared() < WEAK * WEAK {
            return within(self.part(), limit);
        }
        let entering = self.enters(acceleration);
        let path = Path { pair: self, acceleration };
        for (from, to) in path.turns(limit.min(self.horizon(acceleration))).spans() {
            let (start, end) = (path.depth(from), path.depth(to));
            // Where they enter now, parting at first is the rounding of their approach.
            if end < start && end < 0.0 && !(entering && from == 0.0) {
                // Grazing may round to no overlap at all.
                return if start > 0.0 {
                    root(from, to, |t| (-path.depth(t), -path.deepening(t)))
                } else {
                    from
                };
            }
        }
        NEVER
    }

    /// Whether they touch or overlap, and approach or are, at relative rest along their centres, pressed together.
    fn enters(&self, acceleration: DVec2) -> bool {
        if self.offset.length() - self.reach > ROUNDING * self.reach {
            return false;
        }
        let b = self.offset.dot(self.velocity);
        // Half the second derivative of d²: what slides off fast enough is not held by the acceleration.
        let square = self.velocity.length_squared();
        let pressed = self.dull == 0.0;
        self.approaches(b)
            || (pressed
                && !self.approaches(-b)
                && square + self.offset.dot(acceleration) < -ROUNDING * square)
    }

    /// The time from which on the acceleration has carried them apart for good.
    fn horizon(&self, acceleration: DVec2) -> f64 {
        let (a, w) = (acceleration.length(), self.velocity.length());
        let far = self.offset.length() + self.reach;
        // ½at² = wt + far, and a little more.
        1.01 * (w + (w * w + 2.0 * a * far).sqrt()) / a
    }
}

/// A time up to `limit`, else [`NEVER`].
fn within(time: f64, limit: f64) -> f64 {
    if time <= limit { time } else { NEVER }
}

/// Relative motion under acceleration: a parabola. The square of the distance along it is of fourth degree in time.
struct Path<'a> {
    pair: &'a Pair,
    acceleration: DVec2,
}

impl Path<'_> {
    fn at(&self, time: f64) -> (DVec2, DVec2) {
        let Pair { offset, velocity, .. } = *self.pair;
        (position(offset, velocity, self.acceleration, time), velocity + self.acceleration * time)
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

    /// The answer where it is plain: where the square of the distance, over the whole span or over the next hop, bends
    /// one way only. Nearly all pairs of a pile are so, and need no search for turns.
    ///
    /// With h = (|r|² − s²)/2: h′ = r·r′ and h″ = w² + a·d + 3 (a·w) t + 1.5 a² t².
    fn meets_soon(&self, span: f64) -> Option<f64> {
        let Pair { offset: d, velocity: w, reach, .. } = *self.pair;
        let a = self.acceleration;
        let (bend, slope) = (w.length_squared() + a.dot(d), d.dot(w));
        let height = 0.5 * (d.length_squared() - reach * reach);
        if height < -ROUNDING * reach * reach {
            return None;
        }
        let bend_at = |t: f64| bend + (3.0 * a.dot(w) + 1.5 * a.length_squared() * t) * t;
        if bend >= 0.0 {
            // While it bends upward, what does not approach now never will.
            let upward = a.dot(w) >= 0.0 || bend_at(span.min(-a.dot(w) / a.length_squared())) > 0.0;
            return (upward && slope >= 0.0).then_some(NEVER);
        }
        // It bends downward until the parabola of its bend comes back to 0: rise and fall as in a hop, twice as long to
        // be sure.
        let hop = 2.0 * (slope.max(0.0) + (slope * slope - 2.0 * bend * height.max(0.0)).sqrt()) / -bend;
        let end = span.min(hop);
        if bend_at(end) >= 0.0 {
            return None;
        }
        let mut time = end;
        if self.depth(end) < 0.0 {
            return (end == span).then_some(NEVER);
        }
        // From beyond the root, Newton's method comes down to it from one side: a step back up is rounding.
        for _ in 0..ROUNDS {
            let (depth, deepening) = (self.depth(time), self.deepening(time));
            if deepening <= 0.0 {
                return None;
            }
            let step = depth / deepening;
            if step < 0.0 {
                return Some(time);
            }
            time -= step;
            if time <= 0.0 {
                return None;
            }
            if step <= LAST_STEP * time {
                return Some(time);
            }
        }
        None
    }

    /// The times from 0 to `span` at which approach turns into parting or back: the roots of the cubic r·r′, which
    /// are separated by those of its derivative, a quadratic.
    fn turns(&self, span: f64) -> Turns {
        let Pair { offset: d, velocity: w, .. } = *self.pair;
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
            if start.min(end) < 0.0 && start.max(end) > 0.0 {
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

/// More than enough halvings to find the last bit of a microsecond in the longest span that [`WEAK`] leaves.
const ROUNDS: usize = 256;

/// How short a step of Newton's, as a fraction of the time, is its last: the next, about its square, would be lost in
/// the rounding, even where a grazing contact makes both larger.
const LAST_STEP: f64 = 1e-9;

/// The root of a function that rises from below 0 at `low` to 0 or above at `high`: Newton's method while its steps
/// stay in the bracket and halve, else bisection. `function` returns value and derivative.
fn root(mut low: f64, mut high: f64, function: impl Fn(f64) -> (f64, f64)) -> f64 {
    let mut time = 0.5 * (low + high);
    let mut step = high - low;
    for _ in 0..ROUNDS {
        let (value, slope) = function(time);
        if value < 0.0 {
            low = time;
        } else {
            high = time;
        }
        let newton = value / slope;
        let next = time - newton;
        if newton.abs() <= LAST_STEP * time {
            return next.clamp(low, high);
        }
        let halves = newton.abs() <= 0.5 * step && low < next && next < high;
        let next = if halves { next } else { 0.5 * (low + high) };
        if next <= low || next >= high {
            break;
        }
        step = (next - time).abs();
        time = next;
    }
    time
}
