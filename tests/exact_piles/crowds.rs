//! Crowds that press on each other: more balls than are left to impacts alone while they do.

use super::*;

/// Balls of many sizes that fall into a narrow box, where they slide over each other for seconds.
fn crowd(seed: u32) -> Simulation {
    let text = format!(
        "solver = \"exact\"\nsize = [300, 400]\ngravity = [0, {EARTH:?}]\n[walls]\nrestitution = 0.8\n[pairs]\n\
         [[fill]]\ncount = 100\nradius = [6, 14]\nspeed = [0, 300]\nrestitution = 0.7\nseed = {seed}\n"
    );
    Scene::parse("crowd", &text).unwrap().build().unwrap()
}

#[test]
fn a_crowd_that_presses_settles_in_few_events_and_gains_no_energy_and_overlaps_nowhere() {
    for seed in [1, 2, 3] {
        let mut crowd = crowd(seed);
        let mass: f64 = crowd.balls().iter().map(Ball::mass).sum();
        let mut least = energy(&crowd);
        while crowd.time() < 8.0 {
            crowd.advance(1.0 / 60.0).unwrap();
            let now = energy(&crowd);
            // Hops at half the rest speed, and as much for velocities that steps find.
            assert!(now <= least + 0.25 * mass, "seed {seed}: {least} rose to {now}");
            least = least.min(now);
            assert!(overlap(&crowd) < 1e-13, "seed {seed}, {} s: {}", crowd.time(), overlap(&crowd));
            assert!(max_wall_overlap(crowd.world(), crowd.balls()) < 1e-13);
        }
        // Impact by impact 1.8 to 10 million.
        assert!(hits(&crowd) < 1_000_000, "seed {seed}: {}", hits(&crowd));
        assert!(fastest(&crowd) < 100.0, "seed {seed}: {}", fastest(&crowd));
    }
}

#[test]
fn a_crowd_that_presses_is_the_same_to_the_last_bit_however_time_is_cut_into_frames() {
    let mut at_once = crowd(4);
    let (mut in_frames, mut cut) = (at_once.clone(), at_once.clone());
    at_once.advance(2.0).unwrap();
    for _ in 0..120 {
        in_frames.advance(1.0 / 60.0).unwrap();
    }
    let mut cuts = 0;
    while cut.time() < 2.0 {
        let left = 2.0 - cut.time();
        cuts += u32::from(cut.advance_while(left, || false).unwrap() < left);
    }
    assert!(cuts > 100 && fastest(&at_once) > 0.0, "{cuts} cuts");
    assert_eq!(in_frames.balls(), at_once.balls());
    assert_eq!(cut.balls(), at_once.balls());
}
