//! Quiet substeps of few balls: what happens in them happens by itself, and nothing but walls holds any.
//!
//! Where few balls fly, bounce and slide, most substeps are such. All that is looked for and worked out in others would
//! come to nothing in them: each ball goes on as it does, or bounces off walls, or two meet and fly apart. What the search for pairs
//! found may stand for longer so, and what balls count with: the next whole substep finds these anew, before anything presses.

use super::super::lesser::lesser;
use super::constraints::{Beside, Marks};
use super::fates::{Fate, is_fast};
use super::find::FEW_IN_ALL;
use super::legs::Leg;
use super::meeting::Meeting;
use super::near::Near;
use super::wall_support::is_borne;
use super::walls::{meet_walls, reaches_wall};
use super::{Body, Contact, DVec2, Setting, Tally};

/// Few balls in the order in which their ways begin across the world, as it was when that was last looked at.
#[derive(Debug, Clone, Default)]
pub(super) struct Across(Vec<u8>);

/// What happens in a quiet substep.
#[derive(Default)]
struct Happens {
    /// The balls that are hit, with how they go on and the legs that they are on then.
    hit: Vec<(usize, Body, [Option<Leg>; 2])>,
    /// Two that hit each other.
    met: Option<[usize; 2]>,
    tally: Tally,
}

impl Contact {
    /// Takes this substep, at whose beginning gravity has changed all velocities, if it is a quiet one; whether it was.
    pub(super) fn pass_quietly(&mut self, tally: &mut Tally) -> bool {
        let Some(Happens { hit, met, tally: counted }) = self.happens() else { return false };
        self.note_start();
        if let Some(near) = &mut self.near {
            near.forget_pressing();
        }
        let Self { setting, bodies, course, before, hit: touched, .. } = self;
        course.ended = false;
        course.fates.clear();
        course.legs.begin(!before.is_empty());
        if !hit.is_empty() {
            course.fates.resize(bodies.len(), Fate::default());
        }
        for (at, body, legs) in hit {
            if course.legs.noted {
                course.legs.list.extend(legs.into_iter().flatten());
            }
            bodies[at] = body;
            course.fates[at].hits = 1;
        }
        met.into_iter().flatten().for_each(|at| touched[at] = true);
        tally.add(&counted);
        for body in bodies.iter_mut().filter(|body| body.inverse_mass > 0.0) {
            body.position = setting.inside(body.end(setting.substep), body.radius);
        }
        true
    }

    /// Whether a substep in which nothing but walls holds any begins, of few balls that can be moved and others. It is taken as a
    /// whole one: there are too many balls to look for what may happen.
    pub(super) fn is_quiet_among_fixed(&self) -> bool {
        let Self { setting, bodies, near, hands_back, parting, .. } = self;
        let steady = || near.as_ref().is_some_and(|near| near.holds_steadily(setting, bodies));
        *hands_back && bodies.len() > FEW_IN_ALL && !parting.goes_on() && steady()
    }

    /// What happens in this substep; [`None`] where it is not a quiet one. None is that began late, or in which balls part that were
    /// put into each other.
    fn happens(&mut self) -> Option<Happens> {
        let Self { setting, bodies, near: Some(near), parting, late, pairs, across, .. } = self else {
            return None;
        };
        if bodies.len() > FEW_IN_ALL
            || *late > 0.0
            || parting.goes_on()
            || near.homes.len() != bodies.len()
            || !near.holds_steadily(setting, bodies)
        {
            return None;
        }
        let close = if *pairs { across.close(setting, bodies).ok()? } else { None };
        let mut happens = Happens::default();
        if let Some(both) = close {
            self.meet(both, &mut happens)?;
        }
        for (at, body) in self.bodies.iter().enumerate().filter(|(_, body)| body.inverse_mass > 0.0) {
            if let Some(time) = reaches_wall(&self.setting, body) {
                self.bounce(at, time, &mut happens)?;
            }
        }
        Some(happens)
    }

    /// Adds how a ball bounces off the walls to which it comes at this time, which do not hold it: if it does not come to rest
    /// there, and comes to no other, wherever it goes.
    fn bounce(&self, at: usize, time: f64, happens: &mut Happens) -> Option<()> {
        let Self { setting, bodies, rests, .. } = self;
        let mut body = bodies[at];
        // Where nothing is known to be near a wall, none is followed to it. (What is fast against what all had in common in the last
        // whole substep, or not, is followed as far.)
        if !setting.grounded || is_fast(setting, &body) || !self.keeps_away(&[at], body.velocity.length()) {
            return None;
        }
        let beside = Beside { body: at as u32, push: DVec2::ZERO };
        let met = meet_walls(setting, (&mut body, &rests[at]), &beside, (0.0, false), &mut happens.tally)?;
        let legs = Leg::of(at, &body, time.max(met.time)).after_walls(&bodies[at], &body, &met);
        happens.hit.push((at, body, legs));
        (met.borne == DVec2::ZERO).then_some(())
    }

    /// Adds how two balls meet, if they do: if both fly, far from walls and from others, and apart again, fast.
    fn meet(&self, both: [usize; 2], happens: &mut Happens) -> Option<()> {
        let Self { setting, bodies, rests, restitutions, .. } = self;
        let mut after = both.map(|at| bodies[at]);
        let [first, second] = &after;
        let reach = first.radius + second.radius;
        let apart = |one: DVec2, other: DVec2| one.distance_squared(other) > reach * reach;
        let flies = |body: &Body| body.inverse_mass > 0.0 && body.is_free() && !is_fast(setting, body);
        if !(flies(first) && flies(second) && apart(first.position, second.position)) {
            return None;
        }
        let Some(meeting) = Meeting::of(setting, first, second, None, 0.0) else {
            return apart(first.end(setting.substep), second.end(setting.substep)).then_some(());
        };
        let e = lesser(restitutions[both[0]], restitutions[both[1]]);
        meeting.exchange(&mut after, &both.map(|at| rests[at]), (0, 1), e);
        let fastest = both.iter().map(|&at| &bodies[at]).chain(&after);
        let fastest = fastest.map(|body| body.velocity.length()).fold(0.0, f64::max);
        let go_on = after.iter().all(|body| flies(body) && reaches_wall(setting, body).is_none());
        if !(go_on && e * meeting.speed > setting.firm && self.keeps_away(&both, fastest)) {
            return None;
        }
        happens.tally.impacts += u64::from(meeting.speed > setting.rest_speed);
        happens.met = Some(both);
        for (at, body) in both.into_iter().zip(after) {
            happens.hit.push((at, body, [Some(Leg::of(at, &body, meeting.time)), None]));
        }
        Some(())
    }

    /// Whether balls that are no faster than this come to no other in this substep, wherever they go.
    fn keeps_away(&self, these: &[usize], fastest: f64) -> bool {
        let Self { setting, bodies, pairs, .. } = self;
        let way = |speed: f64| (speed + setting.kick.length()) * setting.substep;
        let others = || bodies.iter().enumerate().filter(|(other, _)| !these.contains(other));
        !*pairs
            || these.iter().map(|&at| &bodies[at]).all(|body| {
                others().all(|(_, other)| {
                    let gap = body.position.distance(other.position) - body.radius - other.radius;
                    gap > way(fastest) + way(other.velocity.length())
                })
            })
    }
}

impl Near {
    /// Notes that no pair of which one can be moved presses any more, nor met.
    fn forget_pressing(&mut self) {
        for marks in self.stripes.iter_mut().flat_map(|stripe| &mut stripe.marks) {
            if !marks.has(Marks::IDLE) {
                marks.set(Marks::HELD | Marks::MET, false);
            }
        }
    }

    /// Whether nothing but walls holds any of few balls that can be moved, and these leave it as it is.
    fn holds_steadily(&self, setting: &Setting, bodies: &[Body]) -> bool {
        // None before the first search.
        let [stripe] = &self.stripes[..] else { return false };
        let moves = |at: u32| bodies[at as usize].inverse_mass > 0.0;
        let holds = stripe.constraints.iter().any(|constraint| {
            let pair = constraint.pair;
            (constraint.impulse > 0.0 || constraint.grip != DVec2::ZERO)
                && (moves(pair.first) || moves(pair.second))
        });
        if holds || !stripe.disturbed.is_empty() {
            return false;
        }
        let mut borne =
            stripe.beside.iter().filter(|beside| beside.push != DVec2::ZERO && moves(beside.body));
        let held = bodies.iter().filter(|body| !body.is_free()).count();
        held == borne.clone().count() && borne.all(|beside| is_borne(setting, bodies, beside))
    }
}

/// More than two balls may touch others.
struct Many;

impl Across {
    /// The two balls that may touch in this substep, if no others may, too. Only those are compared whose ways overlap across the
    /// world (sweep and prune; Cohen, Lin, Manocha & Ponamgi 1995).
    fn close(&mut self, setting: &Setting, bodies: &[Body]) -> Result<Option<[usize; 2]>, Many> {
        let Self(order) = self;
        if order.len() != bodies.len() {
            order.clear();
            order.extend(0..bodies.len() as u8);
        }
        let mut spans = [(0.0, 0.0); FEW_IN_ALL];
        for (span, body) in spans.iter_mut().zip(bodies) {
            let (one, other) = (body.position.x, body.end(setting.substep).x);
            *span = (lesser(one, other) - body.radius, body.radius - lesser(-one, -other));
        }
        // They hardly change it from one substep to the next (insertion sort).
        for place in 1..order.len() {
            let ball = order[place];
            let (low, mut free) = (spans[usize::from(ball)].0, place);
            while free > 0 && spans[usize::from(order[free - 1])].0 > low {
                order[free] = order[free - 1];
                free -= 1;
            }
            order[free] = ball;
        }
        let mut close = None;
        for (place, &ball) in order.iter().enumerate() {
            let (ball, high) = (usize::from(ball), spans[usize::from(ball)].1);
            let others = order[place + 1..].iter().map(|&other| usize::from(other));
            for other in others.take_while(|&other| spans[other].0 <= high) {
                let (first, second) = (&bodies[ball], &bodies[other]);
                let any_moves = first.inverse_mass > 0.0 || second.inverse_mass > 0.0;
                if any_moves
                    && may_meet(setting, first, second)
                    && close.replace([ball.min(other), ball.max(other)]).is_some()
                {
                    return Err(Many);
                }
            }
        }
        Ok(close)
    }
}

/// Whether two balls may touch in this substep, by the tangent of their squared distance, which lies above it.
fn may_meet(setting: &Setting, first: &Body, second: &Body) -> bool {
    let offset = first.position - second.position;
    let closing = offset.dot(first.velocity - second.velocity);
    let reach = first.radius + second.radius;
    offset.length_squared() + 2.0 * setting.substep * lesser(0.0, closing) <= reach * reach
}

#[cfg(test)]
mod tests {
    use super::super::super::ball::Ball;
    use super::super::super::world::{Pairs, World};
    use super::super::testing::TUNING;
    use super::*;

    /// Numbers from 0 to 1 that look random (Steele, Lea & Flood 2014).
    struct Numbers(u64);

    impl Numbers {
        fn between(&mut self, low: f64, high: f64) -> f64 {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            low + (high - low) * ((mixed ^ (mixed >> 31)) as f64 / u64::MAX as f64)
        }
    }

    /// Few balls, in a box or not, of like or unlike masses, under a gravity of any direction, or none.
    fn few(seed: u64) -> Contact {
        let mut numbers = Numbers(seed);
        let size = DVec2::new(600.0, 400.0);
        let tilt = [0.0, 0.0, 0.3, 2.5][seed as usize % 4];
        let gravity = DVec2::from_angle(tilt).perp() * if seed % 5 == 4 { 0.0 } else { 980.0 };
        let mut world = World::new(size).unwrap();
        if seed % 7 < 6 {
            world = world.with_walls(numbers.between(0.0, 1.0)).unwrap();
        }
        let world = world.with_gravity(gravity).unwrap().with_pairs(Pairs::Impulse);
        let count = 1 + seed % 16;
        let ball = |k: u64, numbers: &mut Numbers| {
            let place = DVec2::new(75.0 + 150.0 * (k % 4) as f64, 50.0 + 100.0 * (k / 4) as f64);
            let radius = numbers.between(5.0, 45.0);
            let velocity = DVec2::new(numbers.between(-400.0, 400.0), numbers.between(-400.0, 400.0));
            let mass = if seed.is_multiple_of(3) {
                10_f64.powf(numbers.between(-2.0, 2.0))
            } else {
                radius * radius
            };
            let ball = Ball::new(place, radius).unwrap().with_velocity(velocity).unwrap();
            let ball = ball.with_mass(mass).unwrap().with_restitution(numbers.between(0.0, 0.99)).unwrap();
            if seed % 4 == 1 && k % 5 == 3 { ball.fixed() } else { ball }
        };
        let balls: Vec<Ball> = (0..count).map(|k| ball(k, &mut numbers)).collect();
        Contact::new(&world, &balls, TUNING)
    }

    /// A substep that a frame ends in, taken as a quiet one if it is one, or in any case as any other. Whether it was.
    fn take(contact: &mut Contact, tally: &mut Tally, quietly: bool) -> bool {
        let team = contact.team.clone();
        contact.find_held(&team);
        contact.before = (0..contact.bodies.len()).map(|at| contact.start_of(at)).collect();
        contact.change_length();
        contact.accelerate();
        let quiet = quietly && contact.pass_quietly(tally);
        if !quiet {
            contact.meet_and_hold(tally);
        }
        contact.end_step();
        quiet
    }

    #[test]
    fn what_a_quiet_substep_comes_to_is_what_it_comes_to_as_any_other() {
        let (mut quiet, mut all, mut left_out, mut beside_fixed, mut counts) = (0, 0, 0, 0, Tally::default());
        for seed in 0..60 {
            let mut contact = few(seed);
            while contact.steps < 4 * u64::from(contact.substeps.rate) && !contact.all_asleep {
                let (mut whole, mut tallies) = (contact.clone(), [Tally::default(); 2]);
                let is_quiet = take(&mut contact, &mut tallies[0], true);
                (quiet, all) = (quiet + u64::from(is_quiet), all + 1);
                beside_fixed += u64::from(is_quiet && contact.setting.has_fixed);
                if !is_quiet {
                    continue;
                }
                take(&mut whole, &mut tallies[1], false);
                let weights = [&contact, &whole]
                    .map(|contact| contact.bodies.iter().map(|body| body.inverse_mass).collect::<Vec<_>>());
                if weights[0] != weights[1] {
                    // What balls count with, where it is found anew, is put off: it may let go of what lies on a wall.
                    left_out += 1;
                    continue;
                }
                let [counted, as_whole] = tallies;
                counts.add(&counted);
                let at = format!("seed {seed}, step {}", contact.steps);
                let numbers = [counted, as_whole].map(|tally| (tally.impacts, tally.wall_hits));
                assert_eq!(numbers[0], numbers[1], "{at}");
                assert_eq!(contact.hit, whole.hit, "{at}");
                let mass = contact.rests.iter().map(|rest| rest.own.recip()).fold(0.0, f64::max);
                assert!(counted.wall_impulse.distance(as_whole.wall_impulse) < 1e-9 * mass, "{at}");
                assert_eq!(contact.ids, whole.ids, "{at}");
                let stripes = [&contact, &whole].map(|contact| &contact.near.as_ref().unwrap().stripes[0]);
                let searches = [&contact, &whole].map(|contact| contact.near.as_ref().unwrap().searches);
                // Two that meet press, as a whole substep has it, until the next: too fast apart for that to count.
                if searches[0] == searches[1] && counted.impacts == 0 {
                    let pressing = stripes.map(|stripe| {
                        stripe
                            .marks
                            .iter()
                            .map(|marks| marks.has(Marks::HELD | Marks::MET))
                            .collect::<Vec<_>>()
                    });
                    assert_eq!(pressing[0], pressing[1], "{at}");
                    for (own, other) in stripes[0].beside.iter().zip(&stripes[1].beside) {
                        assert!(own.push.distance(other.push) < 1e-9, "{at}, {own:?} and {other:?}");
                    }
                }
                let legs = [&contact, &whole].map(|contact| {
                    let mut legs = contact.course.legs.list.clone();
                    legs.sort_by_key(|leg| leg.body);
                    legs
                });
                assert_eq!(legs[0].len(), legs[1].len(), "{at}");
                for (own, other) in legs[0].iter().zip(&legs[1]) {
                    let late = (own.since - other.since).abs();
                    assert!(
                        late < 1e-12 && own.place.distance(other.place) < 1e-9,
                        "{at}, {own:?} and {other:?}"
                    );
                }
                for (body, (own, other)) in contact.bodies.iter().zip(&whole.bodies).enumerate() {
                    let apart = [
                        own.position.distance(other.position),
                        own.velocity.distance(other.velocity),
                        own.free.distance(other.free),
                    ];
                    assert!(apart.iter().all(|&apart| apart < 1e-9), "{at}, {own:?} and {other:?}");
                    assert_eq!(contact.course.was_hit(body), whole.course.was_hit(body), "{at}");
                    assert_eq!(contact.rests[body].asleep, whole.rests[body].asleep, "{at}");
                }
            }
        }
        assert!(20 * left_out < quiet, "{left_out} of {quiet} were left out");
        assert!(
            2 * quiet > all && 10 * beside_fixed > all && counts.wall_hits > 100 && counts.impacts > 100,
            "{quiet} of {all}, {beside_fixed} with fixed ones: {counts:?}"
        );
    }
}
