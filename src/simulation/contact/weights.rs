//! What balls weigh where they are held.
//!
//! What a light ball below a heavy one, or beside it, passes on is found in steps of its own mass: where it weighs a
//! thousandth of it, that would take thousands of sweeps, and they would meet in it meanwhile. So a ball counts as no lighter
//! than a part of those that press on it so. Not of a heavy one that it lies on: it is all that moves that one then, and would
//! push it aside. And not of one that walls or others as heavy carry: what counts as heavier beside that one only, and not far
//! from it, would sink there with more energy than it takes to be lifted elsewhere, round and round.
//!
//! Balls of one material weigh what they do: none is less than half as dense as another. So do all while nothing carries any, so
//! that they keep their momentum.
//!
//! Each counts so for all that hold it, not for each pair alike: what comes of it is what balls of these weights would do, which
//! takes energy or keeps it as long as they are the same. Impacts know what each really weighs.

use super::amount::Amount;
use super::constraints::Constraint;
use super::near::Near;
use super::sleep::Rest;
use super::unlike::Unlike;
use super::{Body, Contact, DVec2, Setting};

/// Among many no ball counts as less than half as dense as one above or beside it counts, or as heavy where that is less. With a
/// quarter, light balls are pressed into each other in corners in one pile out of four, and stay there.
const HEAVIER: f64 = 2.0;
/// The same among few balls, where sweeps find more, and light ones are pushed aside as they should be; unless any has more than so
/// many times the mass of another.
const HEAVIER_OF_FEW: f64 = 6.0;
const MOST_UNLIKE_OF_FEW: f64 = 1e4;
/// A ball presses on lighter ones where what walls and others as heavy give it leaves more than this part of its weight.
const LEFT: f64 = 0.25;
/// Balls are weighed anew after so many of the shortest substeps, in the next that is not quiet, and where pairs were searched.
const PERIOD: u64 = 8;
/// A ball lies on another where their heights differ by more than this part of what they reach: what slides off one that
/// stands still leaves it there. Balls side by side pass weight on to each other.
const LEVEL: f64 = 2.0 / 3.0;

/// Which balls weigh what.
#[derive(Debug, Clone, Default)]
pub(super) struct Weights {
    /// In what any two are unlike, wherever they are.
    possible: Unlike,
    /// Whether any counts as heavier than it is.
    heavier: bool,
    /// From which step on they are weighed anew.
    due: u64,
    /// What they counted with before, and what they count with.
    before: Vec<f64>,
    counted: Vec<f64>,
    /// What gravity gives each ball in a substep and walls and others as heavy do not take, px/s.
    left: Vec<DVec2>,
    /// Pairs in which the first may make the second heavier.
    loads: Vec<(u32, u32)>,
}

impl Contact {
    /// Finds which balls are unlike those around them, and what balls weigh where they are held, where pairs were `searched`, what may
    /// carry balls has come or gone (`landed`), or that was long ago. Whether any weighs something else than before.
    pub(super) fn weigh_balls(&mut self, searched: bool, landed: bool) -> bool {
        let Self { setting, bodies, rests, near: Some(near), .. } = self else { return false };
        let before = near.weights.possible;
        if searched {
            // Without gravity nothing presses for long.
            let presses = setting.kick != DVec2::ZERO;
            near.weights.possible =
                if presses { Unlike::among(setting.amount, bodies, rests) } else { Unlike::Nothing };
        }
        let period = PERIOD * self.substeps.shortest();
        if !searched && !landed && self.steps < near.weights.due {
            return false;
        }
        near.weights.due = (self.steps / period + 1) * period;
        let possible = near.weights.possible;
        if before.differs() || possible.differs() {
            setting.unlike = near.find_unlike(bodies, rests, possible);
        }
        // Where none is unlike any more, or nothing carries any, all weigh what they do again.
        let weighs = near.weights.heavier || setting.grounded && setting.unlike == Unlike::Density;
        weighs && near.weigh(bodies, rests, setting)
    }

    /// Slows down what counts as heavier than it is, is faster than one that falls as far as it is wide, and will be held by
    /// others in this substep: as that, it would strike with more energy than it has. Relative to them, it keeps what it has.
    pub(super) fn slow_counted(&mut self) {
        let Self { setting, bodies, rests, near: Some(near), course, .. } = self else { return };
        let is_fast = |(body, rest): (&Body, &Rest)| {
            body.inverse_mass < rest.in_impacts()
                && body.velocity.length_squared() > fall(setting, 2.0 * body.radius)
        };
        if !near.weights.heavier || !bodies.iter().zip(&*rests).any(is_fast) {
            return;
        }
        let times = times_of(setting, rests);
        let fast: Vec<bool> = bodies.iter().zip(&*rests).map(is_fast).collect();
        // The momentum and the mass of those that hold it.
        let mut holding = vec![(DVec2::ZERO, 0.0_f64); bodies.len()];
        for (i, j) in near.pairs() {
            for (one, other) in [(i, j), (j, i)].into_iter().filter(|&(one, _)| fast[one]) {
                let (ball, its) = (&bodies[one], &bodies[other]);
                if will_press(setting, ball, its) {
                    // None counts for more than what made this one heavier would, if it is as large.
                    let mass = rests[other].in_impacts().max(ball.inverse_mass / times).recip();
                    holding[one] = (holding[one].0 + its.velocity * mass, holding[one].1 + mass);
                }
            }
        }
        for (at, (momentum, mass)) in holding.into_iter().enumerate().filter(|(_, (_, mass))| *mass > 0.0) {
            let (body, own, fate) = (&mut bodies[at], rests[at].own, &mut course.fates[at]);
            let common = (momentum + body.velocity / own) / (mass + own.recip());
            let change = (common - body.velocity) * (1.0 - (body.inverse_mass / own).sqrt());
            // The others may be as light, and faster.
            if (body.velocity + change).length_squared() < body.velocity.length_squared() {
                fate.slow_down(setting, body, change);
            }
        }
    }
}

impl Near {
    /// Finds what balls weigh where they are held, and keeps what holds them. Whether any weighs something else than before.
    fn weigh(&mut self, bodies: &mut [Body], rests: &mut [Rest], setting: &Setting) -> bool {
        let mut weights = std::mem::take(&mut self.weights);
        let Weights { before, counted, left, loads, heavier, .. } = &mut weights;
        let times = times_of(setting, rests);
        before.clear();
        before.extend(bodies.iter().map(|body| body.inverse_mass));
        counted.clear();
        counted.extend(rests.iter().map(|rest| rest.own));
        self.find_left(rests, setting, times, left);
        let least = LEFT * setting.kick.length();
        let presses = |at: usize| left[at].length() > least;
        loads.clear();
        if setting.grounded && setting.unlike == Unlike::Density {
            let of_pair = |(i, j)| loads_of(bodies, setting, i as u32, j as u32);
            loads.extend(self.pairs().flat_map(of_pair).flatten());
        }
        // Mostly from above: what passes weight on has it already then.
        while loads.iter().rev().fold(false, |any, &(upper, lower)| {
            let (upper, lower) = (upper as usize, lower as usize);
            let down = presses(upper) && make_heavier(times, bodies, counted, upper, lower);
            // What counts as heavier passes that on upwards, too; what only is so carries what lies on it.
            let passes_on = counted[lower] < rests[lower].own && presses(lower);
            let up = passes_on && make_heavier(times, bodies, counted, lower, upper);
            down || up || any
        }) {}
        // Sleepers rest on what they weighed when they fell asleep.
        for ((body, rest), &counted) in
            bodies.iter_mut().zip(&mut *rests).zip(&*counted).filter(|((_, rest), _)| !rest.asleep)
        {
            (body.inverse_mass, rest.counted) = (counted, counted);
        }
        *heavier = rests.iter().any(|rest| rest.counted < rest.own);
        let differ = before.iter().zip(&*bodies).any(|(before, body)| *before != body.inverse_mass);
        if differ {
            self.hold_as_weighed(bodies, before);
        }
        self.weights = weights;
        differ
    }

    /// Finds what is left of each ball's weight.
    fn find_left(&self, rests: &[Rest], setting: &Setting, times: f64, left: &mut Vec<DVec2>) {
        left.clear();
        left.resize(rests.len(), setting.kick);
        for (number, stripe) in self.stripes.iter().enumerate() {
            let start = self.layout.start(number);
            for constraint in stripe.constraints.iter().filter(|constraint| constraint.impulse > 0.0) {
                let pair = constraint.pair.from(start);
                let (first, second) = (pair.first as usize, pair.second as usize);
                let push = constraint.normal * constraint.impulse + constraint.grip;
                for (ball, by, push) in [(first, second, push), (second, first, -push)] {
                    if rests[by].own <= times * rests[ball].counted {
                        left[ball] += push * rests[ball].counted;
                    }
                }
            }
            for beside in &stripe.beside {
                left[start + beside.body as usize] += beside.push;
            }
        }
    }

    /// Keeps what holds balls that weigh something else than `before`.
    fn hold_as_weighed(&mut self, bodies: &[Body], before: &[f64]) {
        for (number, stripe) in self.stripes.iter_mut().enumerate() {
            let start = self.layout.start(number);
            for constraint in &mut stripe.constraints {
                if constraint.impulse == 0.0 {
                    // It has been taken from both already.
                    constraint.grip = DVec2::ZERO;
                }
                let own = [constraint.pair.first, constraint.pair.second];
                let balls = own.map(|ball| start + ball as usize);
                let (old, new) =
                    (balls.map(|ball| before[ball]), balls.map(|ball| bodies[ball].inverse_mass));
                if old != new {
                    let carried = constraint.impulse;
                    constraint.weigh(old, new);
                    let lost = carried - constraint.impulse;
                    let sleepers = own.into_iter().zip(new).filter(|&(_, new)| lost > 0.0 && new == 0.0);
                    stripe.disturbed.extend(sleepers.map(|(own, _)| (own, lost)));
                }
            }
            for beside in &mut stripe.beside {
                let ball = start + beside.body as usize;
                let (old, new) = (before[ball], bodies[ball].inverse_mass);
                if old != new {
                    // A velocity, not an impulse.
                    beside.push = if new > old { DVec2::ZERO } else { beside.push * (new / old) };
                }
            }
        }
    }
}

impl Constraint {
    /// Takes it that its balls, which had the `old` inverse masses, have `new` ones.
    fn weigh(&mut self, old: [f64; 2], new: [f64; 2]) {
        // A heavier ball is held by the same impulse: it may be what carries the other. But what held a heavier one would
        // shoot a lighter one away, and a part that suits this pair would not balance what others give.
        if new[0] > old[0] || new[1] > old[1] {
            (self.impulse, self.grip) = (0.0, DVec2::ZERO);
        }
        self.mass = (new[0] + new[1]).recip();
    }
}

/// By how many times less dense than what presses on it one of these balls may be, and still weigh what it does.
fn times_of(setting: &Setting, rests: &[Rest]) -> f64 {
    if setting.amount > Amount::Few {
        return HEAVIER;
    }
    let moved = rests.iter().map(|rest| rest.own).filter(|&own| own > 0.0);
    let (least, most) =
        moved.fold((f64::INFINITY, 0.0_f64), |(least, most), own| (least.min(own), most.max(own)));
    if most <= MOST_UNLIKE_OF_FEW * least { HEAVIER_OF_FEW } else { HEAVIER }
}

/// The square of the speed, px/s, of what falls so far, px.
fn fall(setting: &Setting, far: f64) -> f64 {
    2.0 * setting.kick.length() / setting.substep * far
}

/// Which of two balls may make the other heavier, and which: the one that lies on the other, or each, or neither where they
/// pass each other faster than one that falls as far as they reach: then they meet in impacts.
fn loads_of(bodies: &[Body], setting: &Setting, one: u32, other: u32) -> [Option<(u32, u32)>; 2] {
    let (first, second) = (&bodies[one as usize], &bodies[other as usize]);
    let reach = first.radius + second.radius;
    if first.velocity.distance_squared(second.velocity) > fall(setting, reach) {
        return [None; 2];
    }
    let below = (first.position - second.position).dot(setting.kick);
    let level = LEVEL * reach * setting.kick.length();
    [(below < level).then_some((one, other)), (-below < level).then_some((other, one))]
}

/// Whether two balls come to lie in each other in this substep as they go.
fn will_press(setting: &Setting, first: &Body, second: &Body) -> bool {
    let closing = (first.position - second.position).dot(first.velocity - second.velocity);
    let reach = first.radius + second.radius;
    let end = first.end(setting.substep) - second.end(setting.substep);
    closing < 0.0 && end.length_squared() < reach * reach
}

/// Lets one ball count as heavier where it is too light for what another counts with. Whether it was.
fn make_heavier(times: f64, bodies: &[Body], counted: &mut [f64], heavy: usize, light: usize) -> bool {
    let ratio = (bodies[heavy].radius / bodies[light].radius).max(1.0);
    let most = times * ratio * ratio * counted[heavy];
    let too_light = most > 0.0 && counted[light] > most;
    if too_light {
        counted[light] = most;
    }
    too_light
}

#[cfg(test)]
mod tests {
    use super::super::super::ball::Ball;
    use super::super::Tally;
    use super::super::constraints::Pair;
    use super::super::testing::{TUNING, boxed_world};
    use super::*;

    fn ball(x: f64, y: f64, (radius, mass): (f64, f64)) -> Ball {
        Ball::new(DVec2::new(x, y), radius).unwrap().with_mass(mass).unwrap()
    }

    /// These balls, and one at a wall: where something may be carried, balls count as heavier. They are taken as so many.
    fn contact_of(amount: Amount, balls: &[Ball]) -> Contact {
        let balls = [balls, &[ball(5.0, 5.0, (5.0, 1.0))]].concat();
        let mut contact = Contact::new(&boxed_world(DVec2::splat(200.0)), &balls, TUNING);
        contact.setting.amount = amount;
        contact
    }

    fn contact(balls: &[Ball]) -> Contact {
        contact_of(Amount::Many, balls)
    }

    /// What each ball counts with.
    fn weights(contact: &Contact) -> Vec<f64> {
        let count = contact.bodies.len() - 1;
        contact.bodies[..count].iter().map(|body| body.inverse_mass.recip()).collect()
    }

    /// What balls on top of each other, from the highest down, count with.
    fn weights_in_column(of: &[(f64, f64)]) -> Vec<f64> {
        let mut y = 50.0;
        let mut place = |&(radius, mass): &(f64, f64)| {
            y += 2.0 * radius;
            ball(100.0, y - radius, (radius, mass))
        };
        let balls: Vec<Ball> = of.iter().map(&mut place).collect();
        let mut contact = contact(&balls);
        contact.find();
        weights(&contact)
    }

    #[test]
    fn a_ball_counts_as_no_less_than_half_as_dense_as_one_above_it_or_as_heavy() {
        assert_eq!(weights_in_column(&[(5.0, 1000.0), (5.0, 1.0)]), [1000.0, 500.0]);
        assert_eq!(weights_in_column(&[(5.0, 1000.0), (5.0, 600.0)]), [1000.0, 600.0]);
        // A hundred times as dense and a tenth of the size: a two-hundredth of the mass is enough.
        assert_eq!(weights_in_column(&[(10.0, 1e4), (1.0, 1.0)]), [1e4, 50.0]);
        // However large it is itself.
        assert_eq!(weights_in_column(&[(1.0, 1000.0), (10.0, 1.0)]), [1000.0, 500.0]);
    }

    #[test]
    fn among_few_it_counts_as_no_less_than_a_sixth_unless_any_has_ten_thousand_times_the_mass_of_another() {
        for (mass, counted) in [(6.0, 1.0), (60.0, 10.0), (1e4, 1e4 / 6.0), (2e4, 1e4)] {
            let balls = [ball(100.0, 55.0, (5.0, mass)), ball(100.0, 65.0, (5.0, 1.0))];
            let mut contact = contact_of(Amount::Few, &balls);
            contact.find();
            let law = [mass, counted];
            let near = |(is, law): (&f64, f64)| (is / law - 1.0).abs() < 1e-12;
            assert!(weights(&contact).iter().zip(law).all(near), "{:?}, not {law:?}", weights(&contact));
        }
    }

    #[test]
    fn weight_is_passed_on_to_what_is_below_and_not_to_what_lies_on_a_ball_that_only_is_heavy() {
        let column = [(5.0, 1.0), (5.0, 4096.0), (5.0, 1.0), (5.0, 1.0), (5.0, 1.0)];
        assert_eq!(weights_in_column(&column), [1.0, 4096.0, 2048.0, 1024.0, 512.0]);
    }

    #[test]
    fn weight_is_passed_on_sideways_and_up_to_what_lies_on_balls_that_count_as_heavier() {
        let places = [(100.0, 1000.0), (110.0, 1.0), (90.0, 1.0)];
        let mut balls: Vec<Ball> = places.iter().map(|&(x, mass)| ball(x, 100.0, (5.0, mass))).collect();
        balls.push(ball(110.0, 90.0, (5.0, 1.0)));
        balls.push(ball(100.0, 90.0, (5.0, 1.0)));
        let mut contact = contact(&balls);
        contact.find();
        // The last lies on the heavy one, and beside one that lies on a ball that counts as heavier.
        assert_eq!(weights(&contact), [1000.0, 500.0, 500.0, 250.0, 125.0]);
    }

    #[test]
    fn what_the_floor_carries_makes_nothing_heavier_and_what_a_light_ball_carries_does() {
        for (below, counted) in [(195.0, 1.0), (185.0, 500.0)] {
            let heavy = ball(100.0, below, (5.0, 1000.0));
            // Beside it, or under it.
            let light =
                if below > 190.0 { ball(110.0, below, (5.0, 1.0)) } else { ball(100.0, 195.0, (5.0, 1.0)) };
            let mut contact = contact(&[heavy, light]);
            contact.find();
            assert_eq!(weights(&contact), [1000.0, 500.0], "before anything carries it");
            for _ in 0..60 {
                contact.step(&mut Tally::default());
            }
            assert_eq!(weights(&contact), [1000.0, counted], "{below}");
        }
    }

    #[test]
    fn balls_of_one_material_or_of_one_mass_weigh_what_they_do() {
        for of in [[(10.0, 100.0), (1.0, 1.0)], [(10.0, 1.0), (1.0, 1.0)], [(5.0, 4.0), (5.0, 1.0)]] {
            assert_eq!(weights_in_column(&of), of.map(|(_, mass)| mass));
        }
    }

    #[test]
    fn balls_that_pass_each_other_weigh_what_they_do_until_one_is_slow() {
        let falls = ball(100.0, 100.0, (5.0, 1000.0)).with_velocity(DVec2::new(0.0, 500.0)).unwrap();
        let mut contact = contact(&[falls, ball(100.0, 111.0, (5.0, 1.0))]);
        contact.find();
        assert_eq!(weights(&contact), [1000.0, 1.0]);
        contact.bodies[0].velocity = DVec2::ZERO;
        // Not before it is time.
        contact.steps = PERIOD;
        contact.find();
        assert_eq!(weights(&contact), [1000.0, 1.0]);
        contact.steps = PERIOD * contact.substeps.shortest();
        contact.find();
        assert_eq!(weights(&contact), [1000.0, 500.0]);
    }

    #[test]
    fn in_flight_balls_weigh_what_they_do() {
        let world = boxed_world(DVec2::splat(2000.0));
        let balls = [ball(100.0, 100.0, (5.0, 1000.0)), ball(100.0, 110.0, (5.0, 1.0))];
        for fall in [DVec2::ZERO, DVec2::new(0.0, 1884.9)] {
            let mut contact = Contact::new(&world, &balls, TUNING);
            contact.setting.amount = Amount::Many;
            for body in &mut contact.bodies {
                body.position += fall;
            }
            contact.find();
            let light = contact.bodies[1].inverse_mass.recip();
            assert_eq!(light, if fall == DVec2::ZERO { 1.0 } else { 500.0 });
            // Once they fly again, too.
            for body in &mut contact.bodies {
                body.position.y = 500.0;
            }
            contact.find();
            assert_eq!(contact.bodies[1].inverse_mass, 1.0);
        }
    }

    #[test]
    fn sleepers_rest_on_what_they_weighed_and_pass_on_what_is_above_them_now() {
        let column = [1000.0, 1.0, 1.0].map(|mass| (5.0, mass));
        let balls: Vec<Ball> =
            column.iter().zip([100.0, 110.0, 120.0]).map(|(of, y)| ball(100.0, y, *of)).collect();
        let mut contact = contact(&balls);
        contact.rests[1].asleep = true;
        contact.bodies[1].inverse_mass = 0.0;
        contact.find();
        assert_eq!(contact.rests[1].counted, 1.0);
        assert_eq!(weights(&contact), [1000.0, f64::INFINITY, 250.0]);
        assert_eq!(contact.rests[2].in_impacts(), 1.0);
    }

    #[test]
    fn a_constraint_of_a_heavier_ball_keeps_its_impulse_and_that_of_a_lighter_one_lets_go() {
        let constraint = Constraint { impulse: 8.0, ..Constraint::none(Pair { first: 0, second: 1 }, 0.5) };
        let mut heavier = constraint;
        heavier.weigh([1.0, 0.25], [0.25, 0.25]);
        assert_eq!((heavier.impulse, heavier.mass), (8.0, 2.0));
        let mut lighter = constraint;
        lighter.weigh([1.0, 1.0], [3.0, 1.0]);
        assert_eq!((lighter.impulse, lighter.mass), (0.0, 0.25));
        // One becomes as heavy as the other was, and the other as light.
        let mut swapped = constraint;
        swapped.weigh([1.0, 0.01], [0.01, 1.0]);
        assert_eq!(swapped.impulse, 0.0);
        // On what nothing moves.
        let mut on_sleeper = constraint;
        on_sleeper.weigh([0.25, 0.0], [1.0, 0.0]);
        assert_eq!((on_sleeper.impulse, on_sleeper.mass), (0.0, 1.0));
    }
}
