//! The reference for scenes without a closed form: a plain event-driven run in numbers of twice the digits.
//!
//! All pairs and all walls are looked at for the earliest impact, all balls are moved there, the impact is taken, and
//! so on: no cells, no queue, nothing kept from one impact to the next, and no code of the `exact` solver. The same run
//! with `f64` for its numbers shows for how long these can be trusted, whoever computes with them.

mod real;
mod roots;

use glam::DVec2;
pub(super) use qd::Quad;
pub(super) use real::Real;

use crate::simulation::{Ball, World};

/// A ball that bounces off the floor more slowly than this rests there, px/s: its hops are 10⁻²⁷ px high.
const REST_SPEED: f64 = 1e-12;
/// The same in `f64`, whose rounding hides such hops.
const REST_SPEED_F64: f64 = 1e-7;
/// So many impacts within [`AT_ONCE`] are a collapse: an infinite number in finite time, which no event-driven run gets
/// beyond without a rule for it.
const COLLAPSE: usize = 400;
/// Impacts that are no farther apart come at once, s.
const AT_ONCE: f64 = 1e-9;

/// Two numbers, across and down.
type Pair<R> = [R; 2];

#[derive(Debug, Clone, Copy)]
struct Body<R> {
    position: Pair<R>,
    velocity: Pair<R>,
    radius: R,
    mass: R,
    restitution: R,
    /// Whether it lies on the floor, which carries it.
    rests: bool,
}

#[derive(Debug, Clone, Copy)]
enum Event {
    Wall { body: usize, axis: usize, high: bool },
    Pair { one: usize, other: usize },
}

/// A plain event-driven run.
#[derive(Debug, Clone)]
pub(super) struct Reference<R> {
    size: Pair<R>,
    /// Straight down, px/s².
    gravity: R,
    walls: Option<R>,
    pairs: bool,
    bodies: Vec<Body<R>>,
    time: R,
    impacts: u64,
    /// Since when impacts have come at once, and how many.
    storm: (R, usize),
}

/// Where a run ends: balls hit each other ever faster, infinitely often before this time, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Collapse(pub(super) f64);

fn dot<R: Real>(a: Pair<R>, b: Pair<R>) -> R {
    a[0] * b[0] + a[1] * b[1]
}

fn minus<R: Real>(a: Pair<R>, b: Pair<R>) -> Pair<R> {
    [a[0] - b[0], a[1] - b[1]]
}

impl<R: Real> Reference<R> {
    /// A run from these balls. The world's gravity must point straight down.
    pub(super) fn new(world: &World, balls: &[Ball]) -> Self {
        let pair = |vector: DVec2| [R::of(vector.x), R::of(vector.y)];
        let body = |ball: &Ball| Body {
            position: pair(ball.position()),
            velocity: pair(ball.velocity()),
            radius: R::of(ball.radius()),
            mass: R::of(ball.mass()),
            restitution: R::of(ball.restitution()),
            rests: false,
        };
        let gravity = world.gravity().unwrap_or_default();
        debug_assert!(gravity.x == 0.0 && gravity.y >= 0.0, "gravity of {gravity} is not straight down");
        Self {
            size: pair(world.size()),
            gravity: R::of(gravity.y),
            walls: world.walls().map(R::of),
            pairs: world.pairs() == Some(crate::simulation::Pairs::Impulse),
            bodies: balls.iter().map(body).collect(),
            time: R::of(0.0),
            impacts: 0,
            storm: (R::of(0.0), 0),
        }
    }

    /// Impacts so far, on balls and on walls.
    pub(super) fn impacts(&self) -> u64 {
        self.impacts
    }

    /// Where the balls are, rounded.
    pub(super) fn positions(&self) -> Vec<DVec2> {
        self.bodies.iter().map(|body| DVec2::from(body.position.map(Real::rounded))).collect()
    }

    /// How far each ball is from where it is in another run, px: without the rounding of either position.
    pub(super) fn distances(&self, other: &Self) -> Vec<f64> {
        let apart = |(a, b): (&Body<R>, &Body<R>)| {
            let apart = minus(a.position, b.position).map(Real::rounded);
            apart[0].hypot(apart[1])
        };
        self.bodies.iter().zip(&other.bodies).map(apart).collect()
    }

    /// Moves one ball by so little, px: what grows of it shows the chaos.
    pub(super) fn nudge(&mut self, ball: usize, by: f64) {
        let x = &mut self.bodies[ball].position[0];
        *x = *x + R::of(by);
    }

    /// Moves on to a time, s.
    ///
    /// # Errors
    /// [`Collapse`] where the balls do not let it.
    pub(super) fn advance_to(&mut self, time: f64) -> Result<(), Collapse> {
        let until = R::of(time);
        while let Some((wait, event)) = self.next(until - self.time) {
            self.fly(wait);
            self.take(event);
            self.impacts += 1;
            if self.time > self.storm.0 + R::of(AT_ONCE) {
                self.storm = (self.time, 0);
            }
            self.storm.1 += 1;
            if self.storm.1 > COLLAPSE {
                return Err(Collapse(self.time.rounded()));
            }
        }
        self.fly(until - self.time);
        self.time = until;
        Ok(())
    }

    /// A body's acceleration, downward.
    fn pull(&self, body: &Body<R>) -> R {
        if body.rests { R::of(0.0) } else { self.gravity }
    }

    /// Moves all on by so many seconds of free flight.
    fn fly(&mut self, wait: R) {
        let gravity = self.gravity;
        for body in &mut self.bodies {
            let pull = if body.rests { R::of(0.0) } else { gravity };
            body.position[0] = body.position[0] + body.velocity[0] * wait;
            body.position[1] = body.position[1] + (body.velocity[1] + R::of(0.5) * pull * wait) * wait;
            body.velocity[1] = body.velocity[1] + pull * wait;
        }
        self.time = self.time + wait;
    }

    /// The earliest impact within so many seconds.
    fn next(&self, within: R) -> Option<(R, Event)> {
        let mut first: Option<(R, Event)> = None;
        let earliest = |first: Option<(R, Event)>| first.map_or(within, |(wait, _)| wait);
        // Takes an impact instead where it is earlier; the time after which none is any more.
        let mut offer = |wait: Option<R>, event: Event| {
            if let Some(wait) = wait.filter(|&wait| wait < earliest(first)) {
                first = Some((wait, event));
            }
            earliest(first)
        };
        let mut end = within;
        for (index, body) in self.bodies.iter().enumerate() {
            for (axis, high) in [(0, false), (0, true), (1, false), (1, true)] {
                end = offer(self.wall(body, axis, high), Event::Wall { body: index, axis, high });
            }
        }
        for one in 0..if self.pairs { self.bodies.len() } else { 0 } {
            for other in one + 1..self.bodies.len() {
                let wait = self.meeting(&self.bodies[one], &self.bodies[other], end);
                end = offer(wait, Event::Pair { one, other });
            }
        }
        first
    }

    /// When a ball meets a wall; one that is behind it and comes nearer meets it now.
    fn wall(&self, body: &Body<R>, axis: usize, high: bool) -> Option<R> {
        let zero = R::of(0.0);
        self.walls?;
        let sign = R::of(if high { 1.0 } else { -1.0 });
        let gap = if high {
            self.size[axis] - body.radius - body.position[axis]
        } else {
            body.position[axis] - body.radius
        };
        let speed = sign * body.velocity[axis];
        let pull = if axis == 1 { sign * self.pull(body) } else { zero };
        if gap <= zero && speed > zero {
            return Some(zero);
        }
        let square = speed * speed + R::of(2.0) * pull * gap;
        if pull == zero {
            (speed > zero).then(|| gap / speed)
        } else if speed > zero {
            (square >= zero).then(|| R::of(2.0) * gap / (speed + square.root()))
        } else if pull > zero {
            // Behind the wall by rounding, the root may not be there: it comes back at the speed it left with.
            Some((if square > zero { square.root() } else { zero - speed } - speed) / pull)
        } else {
            None
        }
    }

    /// When two balls meet within `end`; two that overlap and approach meet now.
    fn meeting(&self, one: &Body<R>, other: &Body<R>, end: R) -> Option<R> {
        let zero = R::of(0.0);
        let distance = minus(other.position, one.position);
        let velocity = minus(other.velocity, one.velocity);
        let reach = one.radius + other.radius;
        let (b, c) = (dot(distance, velocity), dot(distance, distance) - reach * reach);
        if c <= zero && b < zero {
            return Some(zero);
        }
        let square = dot(velocity, velocity);
        let half = R::of(0.5) * (self.pull(other) - self.pull(one));
        if half != zero {
            // One flies, one rests: the square of their distance is of fourth degree in time. Balls that have just met
            // are apart by rounding, to either side: that is no meeting before they have come apart.
            let two = R::of(2.0);
            let apart = if c < R::of(8.0 * R::ROUNDING) * reach * reach { zero } else { c };
            let polynomial =
                [apart, two * b, square + two * half * distance[1], two * half * velocity[1], half * half];
            return roots::first_fall(&polynomial, end);
        }
        let discriminant = b * b - square * c;
        (c > zero && b < zero && discriminant > zero).then(|| c / (discriminant.root() - b))
    }

    fn take(&mut self, event: Event) {
        match event {
            Event::Wall { body, axis, high } => self.bounce(body, axis, high),
            Event::Pair { one, other } => self.collide(one, other),
        }
    }

    fn bounce(&mut self, body: usize, axis: usize, high: bool) {
        let rest_speed = if R::ROUNDING < 1e-20 { REST_SPEED } else { REST_SPEED_F64 };
        let restitution = self.walls.unwrap_or(R::of(1.0));
        let pressed = axis == 1 && high && self.gravity > R::of(0.0);
        let ball = &mut self.bodies[body];
        ball.velocity[axis] = -(ball.velocity[axis] * restitution);
        ball.position[axis] = if high { self.size[axis] - ball.radius } else { ball.radius };
        if pressed && -ball.velocity[1] < R::of(rest_speed) {
            ball.velocity[1] = R::of(0.0);
            ball.rests = true;
        }
    }

    fn collide(&mut self, one: usize, other: usize) {
        let (a, b) = (self.bodies[one], self.bodies[other]);
        let distance = minus(b.position, a.position);
        let approach = dot(minus(b.velocity, a.velocity), distance);
        let e = if a.restitution < b.restitution { a.restitution } else { b.restitution };
        let scale = (R::of(1.0) + e) * approach / dot(distance, distance) / (a.mass + b.mass);
        for (axis, &along) in distance.iter().enumerate() {
            self.bodies[one].velocity[axis] = a.velocity[axis] + scale * b.mass * along;
            self.bodies[other].velocity[axis] = b.velocity[axis] - scale * a.mass * along;
        }
        for body in [one, other] {
            let body = &mut self.bodies[body];
            body.rests &= body.velocity[1] == R::of(0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;
    use crate::scene::Scene;
    use crate::simulation::Pairs;

    fn start<R: Real>(scene: &str) -> Reference<R> {
        let simulation = Scene::load(scene).unwrap().build().unwrap();
        Reference::new(simulation.world(), simulation.balls())
    }

    /// A decimal number with all its digits.
    fn decimal(text: &str) -> Quad {
        let (whole, part) = text.split_once('.').unwrap_or((text, ""));
        let ten = Quad::of(10.0);
        let digits = whole.bytes().chain(part.bytes()).map(|digit| Quad::of(f64::from(digit - b'0')));
        let number = digits.fold(Quad::of(0.0), |number, digit| number * ten + digit);
        part.bytes().fold(number, |number, _| number / ten)
    }

    #[test]
    fn positions_agree_with_sixty_digit_arithmetic_in_every_digit_that_is_kept_of_it() {
        for scene in ["elastic", "gravity"] {
            let path = format!("tests/data/exact-{scene}-1280x720.csv");
            let data = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap();
            let mut reference = start::<Quad>(scene);
            for line in data.lines().skip(1) {
                let fields: Vec<&str> = line.split(',').collect();
                reference.advance_to(fields[0].parse().unwrap()).unwrap();
                assert_eq!(
                    reference.impacts(),
                    fields[6].parse::<u64>().unwrap(),
                    "{scene} at {} s",
                    fields[0]
                );
                let body = reference.bodies[fields[1].parse::<usize>().unwrap()];
                for (axis, field) in [fields[2], fields[3]].into_iter().enumerate() {
                    // They are kept to 22 digits after the point, less what chaos makes of the 32nd.
                    let error = (decimal(field) - body.position[axis]).rounded().abs();
                    assert!(error < 2e-21, "{scene} at {} s: {error:e}", fields[0]);
                }
            }
        }
    }

    #[test]
    fn an_f64_is_trusted_for_seconds_and_twice_its_digits_for_longer() {
        for (scene, f64_until, double_until) in
            [("elastic", 4.0, 10.0), ("inelastic", 10.0, 10.0), ("gravity", 2.5, 4.4)]
        {
            let (mut f64_run, mut run) = (start::<f64>(scene), start::<Quad>(scene));
            let mut nudged = run.clone();
            nudged.nudge(0, 1e-30);
            let apart = |a: DVec2, b: &DVec2| a.distance(*b);
            run.advance_to(f64_until).unwrap();
            f64_run.advance_to(f64_until).unwrap();
            let errors = run
                .positions()
                .into_iter()
                .zip(&f64_run.positions())
                .map(|(a, b)| apart(a, b))
                .collect::<Vec<_>>();
            assert!(errors.iter().all(|&error| error < 0.01), "{scene}: {errors:?}");
            run.advance_to(double_until).unwrap();
            nudged.advance_to(double_until).unwrap();
            let grown = run.distances(&nudged).into_iter().fold(0.0, f64::max);
            assert!((1e-26..1e-5).contains(&grown), "{scene}: {grown:e}");
        }
    }

    #[test]
    fn the_demo_under_gravity_collapses_where_balls_come_to_lie_on_each_other() {
        let Err(Collapse(time)) = start::<Quad>("gravity").advance_to(10.0) else { panic!("it went on") };
        assert!((4.2..4.7).contains(&time), "{time}");
    }

    #[test]
    fn a_dropped_ball_rests_when_the_closed_form_says_so_and_a_hit_lifts_it() {
        let world = World::new(DVec2::new(100.0, 500.0)).unwrap().with_walls(0.8).unwrap();
        let world = world.with_gravity(DVec2::new(0.0, 980.0)).unwrap().with_pairs(Pairs::Impulse);
        let dropped = Ball::new(DVec2::new(50.0, 90.0), 10.0).unwrap();
        let mut drop = Reference::<Quad>::new(&world, &[dropped]);
        let rest = (2.0 * 400.0 / 980.0_f64).sqrt() * 9.0;
        drop.advance_to(rest - 1e-9).unwrap();
        assert!(!drop.bodies[0].rests);
        drop.advance_to(rest + 1e-9).unwrap();
        assert!(drop.bodies[0].rests && drop.positions()[0] == DVec2::new(50.0, 490.0));

        // From above and a little aside onto one at rest, whose way to their meeting is of fourth degree in time.
        let above = Ball::new(DVec2::new(58.0, 400.0), 10.0).unwrap();
        let lying = Ball::new(DVec2::new(50.0, 490.0), 10.0).unwrap();
        let mut pair = Reference::<Quad>::new(&world, &[lying, above]);
        // They touch at a height of 490 − √(20² − 8²) px.
        let meeting = (2.0 * (90.0 - 336.0_f64.sqrt()) / 980.0).sqrt();
        pair.advance_to(meeting - 1e-12).unwrap();
        assert!(pair.bodies[0].rests);
        pair.advance_to(meeting + 1e-12).unwrap();
        assert!(!pair.bodies[0].rests && pair.bodies[0].velocity[1].rounded() < 0.0);
    }
}
