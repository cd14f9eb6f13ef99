//! How piles are laid to rest, and what wakes them.

use super::*;

#[test]
fn a_column_of_any_height_stands_and_has_events_in_the_first_moment_alone() {
    for count in [2, 20, 200, 2000] {
        let mut column = column(count);
        let top = column.balls()[count as usize - 1].position();
        column.advance(0.1).unwrap();
        let first = hits(&column);
        assert!(first < 20 * u64::from(count), "{count} balls: {first} hits");
        column.advance(100.0).unwrap();
        assert_eq!((hits(&column), fastest(&column)), (first, 0.0), "{count} balls");
        assert_eq!(column.balls()[count as usize - 1].position(), top, "{count} balls");
    }
}

#[test]
fn a_pile_comes_to_rest_for_good_and_shows_which_balls_touch() {
    // The last touches nothing.
    let mut balls = rows(20, 5);
    balls.push(ball(125.0, 5.0, 5.0).fixed());
    let mut pile = exact(boxed(130.0, 300.0, EARTH), balls);
    let start = energy(&pile);
    pile.advance(10.0).unwrap();
    let (settled, balls) = (hits(&pile), pile.balls().to_vec());
    assert_eq!(fastest(&pile), 0.0);
    assert!(energy(&pile) < start && overlap(&pile) < 1e-13);
    let mut compared = [0, 0];
    for _ in 0..100 {
        pile.advance(1.0 / 60.0).unwrap();
        for (index, one) in balls.iter().enumerate() {
            let gaps =
                balls.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, other)| {
                    one.position().distance(other.position()) - one.radius() - other.radius()
                });
            let nearest = gaps.fold(f64::INFINITY, f64::min);
            // Those that are nearly as near as held ones are may lean on each other or not.
            if !(1e-5..0.1).contains(&nearest) {
                compared[usize::from(pile.touching()[index])] += 1;
                assert_eq!(pile.touching()[index], nearest < 1e-5, "ball {index}, {nearest} px from others");
            }
        }
    }
    let [free, touching] = compared;
    assert!(free >= 100 && touching >= 400, "{compared:?} were compared");
    assert_eq!((hits(&pile), pile.balls()), (settled, &balls[..]));
}

#[test]
fn a_pile_at_rest_is_the_same_to_the_last_bit_however_time_is_cut_into_frames() {
    let pile = || exact(boxed(110.0, 300.0, EARTH), rows(12, 4));
    let mut once = pile();
    once.advance(6.0).unwrap();
    for rate in [24_u32, 60, 144] {
        let mut frames = pile();
        for _ in 0..6 * rate {
            frames.advance(1.0 / f64::from(rate)).unwrap();
        }
        assert_eq!(once.balls(), frames.balls(), "{rate} Hz");
        assert_eq!(once.tally(), frames.tally(), "{rate} Hz");
    }
}

#[test]
fn what_lies_on_a_ball_that_is_knocked_away_falls() {
    let mut column: Vec<Ball> = (0..5).map(|k| ball(300.0, 390.0 - 20.0 * f64::from(k), 10.0)).collect();
    column.push(moving(ball(20.0, 390.0, 10.0), 100.0, 0.0));
    let mut simulation = exact(boxed(600.0, 400.0, EARTH), column);
    simulation.advance(1.0).unwrap();
    // The column rests; what comes is still on its way.
    assert_eq!(simulation.balls()[4].position().y, 310.0);
    assert_eq!(simulation.balls()[4].velocity(), DVec2::ZERO);
    simulation.advance(9.0).unwrap();
    for ball in simulation.balls() {
        assert_eq!(ball.position().y, 390.0, "{ball:?}");
    }
    assert!(overlap(&simulation) < 1e-13);
}

#[test]
fn a_ball_that_falls_on_a_pile_at_rest_moves_what_it_hits_and_adds_no_energy() {
    let settled = {
        let mut pile = exact(boxed(130.0, 300.0, EARTH), rows(15, 5));
        pile.advance(10.0).unwrap();
        assert_eq!(fastest(&pile), 0.0);
        pile.balls().to_vec()
    };
    let mut pile = exact(boxed(130.0, 300.0, EARTH), settled.clone());
    pile.advance(1.0).unwrap();
    assert_eq!(fastest(&pile), 0.0);
    pile.add(&[moving(ball(65.0, 20.0, 10.0).with_mass(20.0).unwrap(), 0.0, 500.0)]).unwrap();
    let mass: f64 = pile.balls().iter().map(Ball::mass).sum();
    let mut least = energy(&pile);
    for _ in 0..600 {
        pile.advance(1.0 / 60.0).unwrap();
        let now = energy(&pile);
        // Hops at half the rest speed.
        assert!(now <= least + 0.125 * mass, "{least} rose to {now}");
        least = least.min(now);
        assert!(overlap(&pile) < 1e-13 && max_wall_overlap(pile.world(), pile.balls()) < 1e-13);
    }
    let moved = |(now, before): (&Ball, &Ball)| now.position().distance(before.position());
    assert!(pile.balls().iter().zip(&settled).map(moved).fold(0.0, f64::max) > 1.0);
    assert_eq!(fastest(&pile), 0.0);
}

#[test]
fn balls_that_are_not_in_balance_slide_however_slowly_they_begin() {
    // In the valley of two that nothing holds together, and on top of one, a hundredth of the radius off its middle.
    let valley = vec![ball(390.0, 390.0, 10.0), ball(410.0, 390.0, 10.0), ball(400.0, 372.6, 10.0)];
    let top = vec![ball(400.0, 390.0, 10.0), ball(400.1, 369.9, 10.0)];
    for balls in [valley, top] {
        let mut simulation = exact(boxed(800.0, 400.0, EARTH), balls);
        simulation.advance(3.0).unwrap();
        for ball in simulation.balls() {
            assert!(ball.position().y > 389.9, "{ball:?}");
        }
    }
}

#[test]
fn two_balls_at_rest_that_touch_do_not_bear_a_heavy_one_between_them() {
    let mut balls = vec![ball(390.0, 390.0, 10.0), ball(410.0, 390.0, 10.0)];
    balls.push(ball(400.0, 355.0, 10.0).with_mass(1e4).unwrap());
    let mut simulation = exact(boxed(800.0, 400.0, EARTH), balls);
    simulation.advance(5.0).unwrap();
    for ball in simulation.balls() {
        assert!(ball.position().y > 389.9, "{ball:?}");
    }
}

#[test]
fn however_strong_gravity_is_balls_settle_with_as_many_impacts_and_gain_no_energy() {
    for gravity in [1e3, 1e4, 1e5, 1e6, 1e7, 1e9] {
        let place = |index: u32| {
            let (column, row) = (f64::from(index % 8), f64::from(index / 8));
            let turn = 2.4 * f64::from(index);
            moving(
                ball(40.0 + 45.0 * column, 40.0 + 45.0 * row, 10.0),
                150.0 * turn.cos(),
                150.0 * turn.sin(),
            )
        };
        let mut simulation = exact(boxed(600.0, 400.0, gravity), (0..30).map(place).collect());
        // What hops at half the rest speed, which is larger where gravity is, but not by hops of more than a hundredth of
        // the radius.
        let rest_speed = f64::min(gravity / EARTH, (2.0 * gravity * 0.1).sqrt());
        let hops = 0.5 * 30.0 * (0.5 * rest_speed).powi(2);
        let start = energy(&simulation);
        let mut least = start;
        for _ in 0..100 {
            simulation.advance(0.03).unwrap();
            let now = energy(&simulation);
            let most = (least + hops).min(start * (1.0 + 1e-12));
            assert!(now <= most, "gravity {gravity}: {least} rose to {now}");
            least = least.min(now);
            // What is carried may come nearer by 1e-12 of that in each of its steps.
            assert!(overlap(&simulation) < 1e-10, "gravity {gravity}");
            assert!(max_wall_overlap(simulation.world(), simulation.balls()) < 1e-10, "gravity {gravity}");
        }
        assert!((2000..60_000).contains(&hits(&simulation)), "gravity {gravity}: {:?}", simulation.tally());
        // Under the weakest of these they roll to and fro for longer.
        assert!(fastest(&simulation) == 0.0 || gravity < 1e4, "gravity {gravity}: {}", fastest(&simulation));
    }
}

#[test]
fn a_ball_that_another_has_slid_off_is_not_shown_as_touching_it() {
    let (corner, slope) = (DVec2::new(20.0, 180.0), DVec2::new(0.5_f64.sin(), -(0.5_f64.cos())));
    let balls = [(corner, 20.0), (corner + 35.0 * slope, 15.0)].map(|(at, radius)| ball(at.x, at.y, radius));
    let mut simulation = exact(boxed(800.0, 200.0, EARTH), balls.to_vec());
    simulation.advance(10.0).unwrap();
    let apart = simulation.balls()[0].position().distance(simulation.balls()[1].position());
    assert!(apart > 100.0, "{apart}");
    simulation.advance(1.0 / 60.0).unwrap();
    assert_eq!(simulation.touching(), [false; 2]);
}
