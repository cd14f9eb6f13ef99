//! What balls weigh where they are held.
//!
//! What a light ball passes on from one heavy ball to another is found in steps of its own mass: where it weighs a
//! thousandth of them, that would take thousands of sweeps, and they would meet in it meanwhile. So it counts as no lighter
//! than a part of any ball near it. It does so for all that hold it, not for each pair alike: action and reaction stay equal,
//! and what comes of it is what balls of these weights would do. Impacts know what each really weighs.

use super::super::lesser::lesser;
use super::find::Near;
use super::holds::Hold;
use super::sleep::Rest;
use super::{Body, DVec2, Setting};

/// No ball counts as less than the fourth part as dense as one near it, or as heavy where that is less. With a tenth, light
/// balls are squeezed twice as deep; with a half, more of what lies around a heavy ball counts as heavy, too, and holds it up.
const HEAVIER: f64 = 4.0;
/// Balls that pass each other faster than so many kicks of gravity are no reason to count as heavier: they meet in impacts,
/// and what is left of them would strike like a heavy ball.
const PASSING: f64 = 32.0;

impl Near {
    /// Finds what balls weigh where they are held, from the pairs that a search has found, and keeps what holds them.
    pub(super) fn weigh_balls(&mut self, bodies: &mut [Body], rests: &mut [Rest], setting: &Setting) {
        // Without gravity nothing presses.
        if setting.kick == DVec2::ZERO || !are_unequal(bodies, rests) {
            return;
        }
        let before: Vec<f64> = rests.iter().map(|rest| rest.inverse_mass).collect();
        // Sleepers rest on what they weighed when they fell asleep.
        for rest in rests.iter_mut().filter(|rest| !rest.asleep) {
            rest.inverse_mass = rest.own;
        }
        let most = PASSING * setting.kick.length();
        let passes =
            |i: usize, j: usize| bodies[i].velocity.distance_squared(bodies[j].velocity) > most * most;
        let near: Vec<_> = self.pairs().filter(|&(i, j)| !passes(i, j)).collect();
        let mut any = true;
        while any {
            any = false;
            for &(i, j) in &near {
                any |= make_heavier(bodies, rests, i, j) || make_heavier(bodies, rests, j, i);
            }
        }
        for (body, rest) in bodies.iter_mut().zip(&*rests).filter(|(_, rest)| !rest.asleep) {
            body.inverse_mass = rest.inverse_mass;
        }
        for (number, stripe) in self.stripes.iter_mut().enumerate() {
            let start = self.layout.start(number);
            for hold in &mut stripe.holds {
                let balls = [hold.pair.first, hold.pair.second].map(|ball| start + ball as usize);
                let (old, new) = (balls.map(|ball| before[ball]), balls.map(|ball| rests[ball].inverse_mass));
                if old != new {
                    hold.weigh(old, new, balls.map(|ball| bodies[ball].inverse_mass));
                }
            }
        }
    }
}

impl Hold {
    /// Takes it that its balls, which had the `old` inverse masses, have `new` ones, of which those that move now are `moved`.
    fn weigh(&mut self, old: [f64; 2], new: [f64; 2], moved: [f64; 2]) {
        let sum = |[first, second]: [f64; 2]| first + second;
        // A heavier ball is held by the same impulse: it may be what carries the other. But what held a heavier one would
        // shoot a lighter one away.
        let part = lesser(1.0, sum(old) / sum(new));
        (self.impulse, self.grip, self.mass) = (self.impulse * part, self.grip * part, sum(moved).recip());
    }
}

/// Whether any two balls may differ by more than they may count. Those of one material do not.
fn are_unequal(bodies: &[Body], rests: &[Rest]) -> bool {
    let differ = |of: &dyn Fn(&Body, &Rest) -> f64| {
        let moved = bodies.iter().zip(rests).filter(|(_, rest)| rest.own > 0.0);
        let (least, most) = moved
            .map(|(body, rest)| of(body, rest))
            .fold((f64::INFINITY, 0.0_f64), |(least, most), of| (least.min(of), most.max(of)));
        most > HEAVIER * least
    };
    differ(&|_, rest| rest.own) && differ(&|body, rest| rest.own * body.radius * body.radius)
}

/// Lets the first of two balls count as heavier where it is too light for the second. Whether it was.
fn make_heavier(bodies: &[Body], rests: &mut [Rest], first: usize, second: usize) -> bool {
    let ratio = (bodies[second].radius / bodies[first].radius).max(1.0);
    let most = HEAVIER * ratio * ratio * rests[second].inverse_mass;
    let first = &mut rests[first];
    let too_light = most > 0.0 && first.inverse_mass > most && !first.asleep;
    if too_light {
        first.inverse_mass = most;
    }
    too_light
}

#[cfg(test)]
mod tests {
    use super::super::super::ball::Ball;
    use super::*;

    /// Balls of these radii and masses, the first ones asleep.
    fn balls(of: &[(f64, f64)], asleep: usize) -> (Vec<Body>, Vec<Rest>) {
        let ball =
            |&(radius, mass): &(f64, f64)| Ball::new(DVec2::ZERO, radius).unwrap().with_mass(mass).unwrap();
        let bodies: Vec<_> = of.iter().map(|of| Body::new(&ball(of), DVec2::ZERO)).collect();
        let mut rests: Vec<_> = bodies.iter().map(Rest::new).collect();
        rests[..asleep].iter_mut().for_each(|rest| rest.asleep = true);
        (bodies, rests)
    }

    fn weight_beside(of: [(f64, f64); 2], asleep: usize) -> f64 {
        let (bodies, mut rests) = balls(&of, asleep);
        make_heavier(&bodies, &mut rests, 0, 1);
        make_heavier(&bodies, &mut rests, 1, 0);
        assert_eq!(rests[1].inverse_mass, rests[1].own, "the heavier one weighs what it did");
        rests[0].inverse_mass.recip()
    }

    #[test]
    fn a_ball_counts_as_no_less_than_a_quarter_as_dense_as_its_neighbour_or_as_heavy() {
        assert_eq!(weight_beside([(5.0, 1.0), (5.0, 1000.0)], 0), 250.0);
        assert_eq!(weight_beside([(5.0, 300.0), (5.0, 1000.0)], 0), 300.0);
        // A hundred times as dense and a tenth of the size: a ten-thousandth of the mass is enough.
        assert_eq!(weight_beside([(1.0, 1.0), (10.0, 1e4)], 0), 25.0);
        // However large it is itself.
        assert_eq!(weight_beside([(10.0, 1.0), (1.0, 1000.0)], 0), 250.0);
    }

    #[test]
    fn balls_of_one_material_or_of_one_mass_weigh_what_they_do() {
        for of in [[(1.0, 1.0), (10.0, 100.0)], [(1.0, 1.0), (10.0, 1.0)], [(5.0, 1.0), (5.0, 4.0)]] {
            let (bodies, rests) = balls(&of, 0);
            assert!(!are_unequal(&bodies, &rests));
        }
        let (bodies, rests) = balls(&[(5.0, 1.0), (5.0, 5.0)], 0);
        assert!(are_unequal(&bodies, &rests));
        assert_eq!(weight_beside([(1.0, 1.0), (10.0, 100.0)], 0), 1.0);
    }

    #[test]
    fn sleepers_go_on_weighing_what_they_did() {
        assert_eq!(weight_beside([(5.0, 1.0), (5.0, 1000.0)], 1), 1.0);
    }

    #[test]
    fn a_hold_of_a_heavier_ball_keeps_its_impulse_and_that_of_a_lighter_one_gives_the_same_velocity() {
        let pair = super::super::holds::Pair { first: 0, second: 1 };
        let hold = Hold { impulse: 8.0, ..Hold::none(pair, 0.5) };
        let mut heavier = hold;
        heavier.weigh([1.0, 1.0], [1.0, 0.0], [1.0, 0.0]);
        assert_eq!((heavier.impulse, heavier.mass), (8.0, 1.0));
        let mut lighter = hold;
        lighter.weigh([1.0, 1.0], [3.0, 1.0], [3.0, 1.0]);
        assert_eq!((lighter.impulse, lighter.mass), (4.0, 0.25));
    }
}
