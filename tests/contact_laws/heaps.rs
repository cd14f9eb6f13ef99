//! Balls that were put into each other, under gravity.

use super::numbers::random;
use super::*;

/// So many balls in a square of this side, in each other, high above the floor or not.
fn heap(count: u32, side: f64, height: f64, (restitution, seed): (f64, u64)) -> Vec<Ball> {
    let mut number = random(seed);
    let mut next = || {
        let place = DVec2::new(250.0, 500.0 - height) + side * DVec2::new(number() - 0.5, number() - 0.5);
        let velocity = 150.0 * DVec2::from_angle(number() * std::f64::consts::TAU);
        let radius = 4.0 + 8.0 * number();
        ball(place.x, place.y, radius).with_mass(radius * radius).unwrap().with_velocity(velocity).unwrap()
    };
    (0..count).map(|_| next().with_restitution(restitution).unwrap()).collect()
}

/// They were shot apart with up to a third of all energy more.
#[test]
fn balls_put_into_each_other_part_and_gain_no_energy() {
    for (count, side, height, restitution) in [
        (20, 30.0, 100.0, 1.0),
        (60, 40.0, 250.0, 0.5),
        (60, 100.0, 100.0, 1.0),
        (100, 100.0, 100.0, 0.8),
        (400, 300.0, 200.0, 0.5),
    ] {
        for seed in [1, 2, 3] {
            let balls = heap(count, side, height, (restitution, seed));
            let mut parting = simulation(world(500.0, 500.0, 0.8).with_gravity(EARTH).unwrap(), balls);
            let (mut least, mut back) = (energy(&parting), 0.0_f64);
            let start = least;
            for _ in 0..90 {
                parting.advance(FRAME).unwrap();
                back = back.max(energy(&parting) - least);
                least = least.min(energy(&parting));
            }
            let what = format!("{count} in {side} px, {height} px high");
            assert!(back < 1e-2 * start, "{what}: {:e} of it came back", back / start);
            assert!(overlap(&parting) < 0.1, "{what}: {}", overlap(&parting));
        }
    }
}

#[test]
fn balls_that_part_while_they_fall_keep_their_momentum() {
    for (restitution, speed) in [(1.0, 0.0), (0.5, 3000.0)] {
        let balls = heap(80, 60.0, 250.0, (restitution, 3));
        let thrown = |ball: Ball| moving(ball, ball.velocity().x + speed, ball.velocity().y);
        let space = World::new(DVec2::splat(500.0)).unwrap().with_gravity(EARTH).unwrap();
        let mut falling =
            simulation(space.with_pairs(Pairs::Impulse), balls.into_iter().map(thrown).collect());
        let start = momentum(falling.balls());
        (0..60).for_each(|_| falling.advance(FRAME).unwrap());
        let law = start + EARTH * falling.balls().iter().map(Ball::mass).sum::<f64>();
        let off = momentum(falling.balls()).distance(law);
        assert!(off < 1e-9 * law.length(), "{off} of {law}");
        assert!(overlap(&falling) < 1e-3, "{}", overlap(&falling));
    }
}
