//! A ball's bounces on the walls within one substep: in closed form, or one by one where it is fast.

use glam::DVec2;

use super::constraints::Beside;
use super::meeting::strike;
use super::sleep::Rest;
use super::unlike::Unlike;
use super::wall_support::ROUNDING;
use super::{Body, SHIFT, Setting, Tally};

/// Bounces of a ball on a wall in one substep.
const BOUNCES: u32 = 32;
/// A ball whose next hop on a wall lasts less than this part of a substep rests there.
const SHORTEST_HOP: f64 = 1.0 / 64.0;
/// The same of one that others press on it, or hold up in part: what presses is known for whole substeps. With a quarter, piles
/// tremble twice as much. Not on elastic walls, which take no energy.
const SHORTEST_PRESSED_HOP: f64 = 1.0;
/// What others give a ball that is unlike them, on an elastic wall, is slight up to this part of gravity's kick. With ten times as much,
/// fewer piles of unlike balls come to rest on such walls.
const SLIGHT: f64 = 1e-4;

/// When a ball comes to a wall, if it does in this substep, s after its beginning; by its mean velocity.
#[inline]
pub(super) fn reaches_wall(setting: &Setting, body: &Body) -> Option<f64> {
    setting.walls?;
    let end = body.end(setting.substep);
    let (low, high) = (DVec2::splat(body.radius), setting.size - body.radius);
    let beyond = (low - end).max(end - high);
    let time = |axis: usize| {
        let time = setting.substep - beyond[axis] / body.velocity[axis].abs();
        // 0/0, or an infinity, where it does not move and is inside a wall.
        if time > 0.0 { time } else { 0.0 }
    };
    match (beyond.x > 0.0, beyond.y > 0.0) {
        (false, false) => None,
        (true, false) => Some(time(0)),
        (false, true) => Some(time(1)),
        (true, true) => Some(time(0).min(time(1))),
    }
}

/// What walls did to a ball in a substep.
pub(super) struct Met {
    /// When it bounced again for the last time, s after the substep's beginning; what foresaw it knows of the first.
    pub(super) time: f64,
    /// Whether it then stands far from where it was.
    pub(super) shifts: bool,
    /// When it bounced first across each axis; never, where it did not.
    pub(super) first: [f64; 2],
    /// Whether it bounced again across one.
    pub(super) again: bool,
    /// What they give it from now on in a substep, px/s, where it came to rest on them.
    pub(super) borne: DVec2,
}

impl Met {
    pub(super) const NOTHING: Self =
        Self { time: 0.0, shifts: false, first: [f64::INFINITY; 2], again: false, borne: DVec2::ZERO };
}

/// Bounces a ball off the walls that it meets in this substep after `since`, when it was last hit; or off the `first` alone: on its
/// way to the other it may meet balls yet.
pub(super) fn meet_walls(
    setting: &Setting,
    (body, rest): (&mut Body, &Rest),
    beside: &Beside,
    (since, first): (f64, bool),
    tally: &mut Tally,
) -> Option<Met> {
    let e = setting.walls?;
    let mut met: Option<Met> = None;
    let end = body.end(setting.substep);
    let (low, high) = (DVec2::splat(body.radius), setting.size - body.radius);
    // How long before the substep's end it meets each, if it does.
    let left = (low - end).max(end - high) / body.velocity.abs();
    for axis in if first && left.y > left.x { [1, 0] } else { [0, 1] } {
        let (wall, side) = if end[axis] < low[axis] {
            (low[axis], 1.0)
        } else if end[axis] > high[axis] {
            (high[axis], -1.0)
        } else {
            continue;
        };
        let ball = (&mut *body, rest.unlike);
        let Some(landed) = meet_wall(setting, ball, beside, (axis, wall, side), since, e) else { continue };
        tally.wall_hits += u64::from(landed.counted);
        tally.wall_impulse[axis] += side * landed.impulse / rest.in_impacts();
        let met = met.get_or_insert(Met::NOTHING);
        met.time = met.time.max(since + landed.time);
        met.shifts |= landed.fastest * setting.substep > SHIFT * body.radius;
        met.first[axis] = since + landed.first;
        met.again |= landed.bounces > 1;
        met.borne[axis] = landed.borne;
        if first {
            break;
        }
    }
    met
}

/// Bounces a ball off a wall across an axis, where its centre is when it touches it, px; `side` is 1 or −1, away from
/// the wall. [`None`] where it rests there.
fn meet_wall(
    setting: &Setting,
    (body, unlike): (&mut Body, Unlike),
    beside: &Beside,
    (axis, wall, side): (usize, f64, f64),
    since: f64,
    e: f64,
) -> Option<Landed> {
    let change = body.change(setting.kick)[axis];
    let rests = side * beside.push[axis] > 0.0;
    let mean = body.velocity[axis];
    let load = mean - body.free[axis];
    let lone = !rests && load == 0.0;
    // In closed form where nothing but gravity acts on it along this axis, or all that does presses it on the wall: that never ends
    // where each substep takes the speed for an impact's that it gives it anew. Not where balls are unlike: what a heavy one presses
    // on a light one may be gone in the next substep, and what the light one is to lose to it would stay; but where that is slight on
    // an elastic wall: speeds in the middle of a substep would be turned round, up to half a kick more than it has, and a row that
    // leans on itself would hop ever higher. Nor where a wall gives it some of that: the opposite one does not press on it once it has
    // left that, and would give it as much anew each time that it came back.
    let opposite = -side * beside.push[axis] > ROUNDING * change.abs();
    let slight = e >= 1.0 && load.abs() <= SLIGHT * setting.kick[axis].abs();
    let closed = lone || !(rests || opposite || unlike.differs() && !slight) && side * change < 0.0;
    // Where it stands at the substep's beginning is where it would have come from: it may be behind the wall.
    let left = setting.substep - since;
    let (acceleration, start, fallen) = if closed {
        let acceleration = change / setting.substep;
        (acceleration, mean - 0.5 * change + acceleration * since, -0.5 * acceleration * since * left)
    } else {
        // One that others press on the wall comes to it by what presses, which is no impact: without it, it came as
        // fast as it moved before.
        let first = mean - change * if rests { 1.0 } else { 0.5 };
        (0.0, if side * first > side * mean { first } else { mean }, 0.0)
    };
    if rests && -side * start < setting.firm {
        return None;
    }
    let position = body.position[axis] + mean * since + fallen;
    let height = if side > 0.0 { position - wall } else { wall - position };
    let hop = Hop { height, speed: side * start, acceleration: side * acceleration };
    let slow = SHIFT * body.radius / setting.substep;
    let shortest = if lone || e >= 1.0 { SHORTEST_HOP } else { SHORTEST_PRESSED_HOP } * setting.substep;
    let landed = hop.bounce(left, shortest, (slow, setting.rest_speed), e);
    if landed.at.is_none() && closed {
        // It stands where it is, and the wall bears it from now on (`lay_on_walls`). Were it left to fall on the wall from where
        // it would just come to it, rounding would decide whether that holds it or it hops on.
        body.position[axis] = wall;
        (body.velocity[axis], body.free[axis]) = (0.0, change - load);
        return Some(Landed { borne: -change, ..landed });
    }
    // What it would have been, had nothing held it.
    let velocity = match landed.at {
        Some(at) if closed => side * at.speed - 0.5 * change,
        Some(at) => side * at.speed,
        None => change,
    };
    let height = landed.at.map_or(0.0, |at| at.height);
    body.position[axis] = wall + side * height - velocity * setting.substep;
    let given = velocity - body.velocity[axis];
    body.velocity[axis] += given;
    body.free[axis] += given;
    Some(landed)
}

/// The time and the axis of the first wall that a fast ball meets after `since`. What gravity bends its path by is left
/// out.
pub(super) fn first_wall(setting: &Setting, body: &Body, since: f64) -> Option<(f64, usize)> {
    setting.walls?;
    let mut first = None;
    for axis in 0..2 {
        let (position, velocity) = (body.position[axis], body.velocity[axis]);
        let wall = if velocity < 0.0 { body.radius } else { setting.size[axis] - body.radius };
        let time = ((wall - position) / velocity).max(since);
        if velocity != 0.0 && time <= setting.substep && first.is_none_or(|(earlier, _)| time < earlier) {
            first = Some((time, axis));
        }
    }
    first
}

/// One bounce of a fast ball of this inverse mass on a wall across `axis`, at `time`.
pub(super) fn bounce_off(
    setting: &Setting,
    (body, own): (&mut Body, f64),
    axis: usize,
    time: f64,
    tally: &mut Tally,
) {
    let e = setting.walls.unwrap_or_default();
    let mean = body.velocity[axis];
    let bent = mean + setting.kick[axis] * (time / setting.substep - 0.5);
    // Along this axis it may be slow: gravity alone neither turns it round nor keeps it at the wall.
    let turns = bent * mean > 0.0 && (mean - (1.0 + e) * bent) * mean < 0.0;
    let mut change = DVec2::ZERO;
    change[axis] = -(1.0 + e) * if turns { bent } else { mean };
    strike(body, change, time);
    tally.wall_hits += 1;
    tally.wall_impulse += change / own;
}

/// A ball above a wall, along one axis; up is away from the wall.
#[derive(Debug, Clone, Copy)]
struct Hop {
    height: f64,
    speed: f64,
    acceleration: f64,
}

/// What came of a ball's bounces on a wall.
struct Landed {
    /// Its state at the end; `None` where it rests on the wall.
    at: Option<Hop>,
    /// What the wall gives it from now on in a substep, px/s, where it rests and was laid there.
    borne: f64,
    /// When it bounced again for the last time, s, except for hops in which it hardly moves; 0 where it did not.
    time: f64,
    bounces: u32,
    /// How many of them count as impacts.
    counted: u32,
    /// When it bounced first; never, where it did not.
    first: f64,
    /// The fastest of them, px/s.
    fastest: f64,
    /// The sum of the changes of velocity, px/s.
    impulse: f64,
}

impl Hop {
    /// Takes a ball that is behind the wall to it. How long that takes, s.
    ///
    /// One that flies away from the wall has left it since, in a hop too short to be noted: it left it more slowly than it seems to have
    /// gone behind it.
    fn rise_to_wall(&mut self) -> f64 {
        let Self { height, speed, acceleration } = *self;
        if height >= 0.0 {
            return 0.0;
        }
        self.height = 0.0;
        if speed <= 0.0 || acceleration >= 0.0 {
            return 0.0;
        }
        self.speed = (speed * speed - 2.0 * acceleration * height).max(0.0).sqrt();
        (self.speed - speed) / acceleration
    }

    /// Follows the ball for `time` s, a substep or what is left of it, in closed form, through all its bounces, until it would hop for
    /// less than `shortest` s; those slower than `slow`, px/s, hardly move it, and those no faster than `rest_speed` are not counted.
    fn bounce(mut self, time: f64, shortest: f64, (slow, rest_speed): (f64, f64), e: f64) -> Landed {
        let (mut left, mut bounces, mut counted, mut fastest, mut impulse) = (time, 0, 0, 0.0_f64, 0.0);
        let (mut first, mut last) = (f64::INFINITY, 0.0);
        left = (left - self.rise_to_wall()).max(0.0);
        let at = loop {
            let Self { height, speed, acceleration } = self;
            let squared = speed * speed - 2.0 * acceleration * height;
            let lands = (speed < 0.0 || acceleration < 0.0) && squared >= 0.0;
            let arrival = squared.max(0.0).sqrt();
            // Each form where it subtracts nothing.
            let wait = if speed <= 0.0 {
                2.0 * height / (arrival - speed)
            } else {
                -(speed + arrival) / acceleration
            };
            // 0/0 where it lies on the wall without speed.
            let wait = if wait.is_nan() { 0.0 } else { wait };
            if !lands || wait >= left || wait < 0.0 {
                break Some(Self {
                    height: (height + left * (speed + 0.5 * acceleration * left)).max(0.0),
                    speed: speed + acceleration * left,
                    acceleration,
                });
            }
            left -= wait;
            first = first.min(time - left);
            if bounces > 0 && arrival > slow {
                last = time - left;
            }
            bounces += 1;
            counted += u32::from(arrival > rest_speed);
            fastest = fastest.max(arrival);
            impulse += (1.0 + e) * arrival;
            self = Self { height: 0.0, speed: e * arrival, acceleration };
            let short = 2.0 * self.speed <= -acceleration * shortest;
            if short || bounces == BOUNCES {
                break None;
            }
        };
        Landed { at, borne: 0.0, time: last, bounces, counted, first, fastest, impulse }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::ball::Ball;
    use super::super::Contact;
    use super::super::testing::{TUNING, boxed_world};
    use super::*;

    /// How high above the floor a ball is after each of so many substeps, px, that falls from `height` while others press it down, or hold
    /// it up in part, by this part of its weight; it has to come to rest within them.
    fn hops(height: f64, load: f64, substeps: u32) -> Vec<f64> {
        let floor = 90.0;
        let ball = Ball::new(DVec2::new(50.0, floor - height), 10.0).unwrap();
        let Contact { setting, bodies, rests, .. } =
            Contact::new(&boxed_world(DVec2::splat(100.0)), &[ball], TUNING);
        let (mut body, beside) = (bodies[0], Beside { body: 0, push: DVec2::ZERO });
        let load = load * setting.kick;
        (body.velocity, body.free) = (-0.5 * (setting.kick + load), -0.5 * (setting.kick + load) - load);
        let mut heights = Vec::new();
        for _ in 0..substeps {
            let change = body.change(setting.kick);
            body.free = body.velocity + setting.kick;
            body.velocity += change;
            if reaches_wall(&setting, &body).is_some() {
                let met = meet_walls(
                    &setting,
                    (&mut body, &rests[0]),
                    &beside,
                    (0.0, false),
                    &mut Tally::default(),
                );
                if let Some(Met { borne, .. }) = met
                    && borne != DVec2::ZERO
                {
                    // What presses it is as before, is stopped by the floor, and is no impact any more.
                    assert_eq!((body.position.y, body.velocity.y, borne), (floor, 0.0, -change));
                    assert!((body.velocity - body.free).abs_diff_eq(load + borne, 1e-9));
                    assert!(reaches_wall(&setting, &body).is_none());
                    return heights;
                }
            }
            body.position = body.end(setting.substep);
            heights.push(floor - body.position.y);
        }
        panic!("it hops for ever: {heights:?}");
    }

    /// How high a ball is that falls from a height and bounces, each time half as fast.
    fn bounced(height: f64, gravity: f64, time: f64) -> f64 {
        let arrival = (2.0 * gravity * height).sqrt();
        let (mut left, mut speed) = (time - arrival / gravity, 0.5 * arrival);
        if left < 0.0 {
            return height - 0.5 * gravity * time * time;
        }
        while left > 2.0 * speed / gravity {
            left -= 2.0 * speed / gravity;
            speed *= 0.5;
        }
        speed * left - 0.5 * gravity * left * left
    }

    #[test]
    fn what_others_press_on_a_wall_hops_on_it_as_if_gravity_were_stronger_and_comes_to_rest() {
        for (height, load) in [(3.0, 50.0), (2.0, 5.0), (0.3, 0.1), (0.02, -0.3), (1.0, -0.9)] {
            let heights = hops(height, load, 200);
            let substep = 1.0 / 240.0;
            assert!(!heights.is_empty(), "{height} px, {load}");
            for (number, found) in (1..).zip(&heights) {
                let law = bounced(height, (1.0 + load) * 980.0, f64::from(number) * substep);
                assert!((found - law).abs() < 1e-9, "{height} px, {load}: {found}, not {law} after {number}");
            }
        }
    }

    #[test]
    fn what_seems_to_come_from_behind_a_wall_has_left_it_with_the_energy_that_it_has_now() {
        for (height, speed) in [(-0.5, 60.0), (-1e-3, 12.0), (-2.0, 100.0)] {
            let mut hop = Hop { height, speed, acceleration: -980.0 };
            let late = hop.rise_to_wall();
            assert_eq!(hop.height, 0.0);
            assert!((hop.speed * hop.speed - speed * speed - 2.0 * 980.0 * height).abs() < 1e-9);
            let there = height + speed * late - 0.5 * 980.0 * late * late;
            assert!(late > 0.0 && there.abs() < 1e-12, "{there} px after {late} s");
        }
        // One that does not come so far, and one that flies towards the wall, lie on it.
        for (height, speed) in [(-2.0, 10.0), (-0.5, -60.0)] {
            let mut hop = Hop { height, speed, acceleration: -980.0 };
            let late = hop.rise_to_wall();
            assert!(hop.height == 0.0 && hop.speed <= 0.0 && late >= 0.0, "{hop:?} after {late} s");
        }
    }
}
