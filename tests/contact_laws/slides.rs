//! Balls that slide on others, without friction.

use super::*;

/// They gripped each other: up to a third of what it had gained was lost. Among many balls, too, on a fixed one.
#[test]
fn a_ball_that_slides_off_a_dome_keeps_its_energy_and_leaves_it_where_it_should() {
    for (dome, speed) in [(1000.0, 30.0), (1000.0, 300.0), (100.0, 30.0), (30.0, 30.0), (30.0, 100.0)] {
        for others in [0, 60] {
            let (top, reach) = (DVec2::new(2000.0, 2500.0), dome + 20.0);
            let sliding = ball(top.x, top.y - reach, 20.0).with_restitution(0.0).unwrap();
            let mut balls = vec![moving(sliding, speed, 0.0), ball(top.x, top.y, dome).fixed()];
            balls.extend((0..others).map(|k| ball(30.0 + 50.0 * f64::from(k), 3970.0, 20.0)));
            let mut slide = simulation(world(4000.0, 4000.0, 0.0).with_gravity(EARTH).unwrap(), balls);
            let along = |slide: &Simulation| {
                let from_centre = slide.balls()[0].position() - top;
                (from_centre.length() - reach, from_centre.x.atan2(-from_centre.y))
            };
            // v² = v₀² + 2·g·R·(1 - cos θ), until gravity no longer suffices for the bend.
            let leaves = f64::acos(2.0 / 3.0 + speed * speed / (3.0 * EARTH.y * reach));
            let what = format!("dome of {dome} px, {speed} px/s, {others} others");
            let (mut gap, mut angle) = along(&slide);
            while angle < 0.9 * leaves {
                slide.advance(1.0 / 240.0).unwrap();
                let height = top.y - slide.balls()[0].position().y;
                let law = (speed * speed + 2.0 * EARTH.y * (reach - height)).sqrt();
                let now = slide.balls()[0].velocity().length();
                // What is held is shown with the velocity through the substep, which half a kick of gravity is missing from.
                let most = 1e-3 * law + EARTH.y / 240.0 * angle.sin();
                assert!((now - law).abs() < most, "{what}, {angle}: {now} px/s, not {law}");
                (gap, angle) = along(&slide);
                assert!(gap.abs() < 3e-2, "{what}, {angle}: {gap} px apart");
            }
            while gap < 3e-2 {
                slide.advance(1.0 / 240.0).unwrap();
                (gap, angle) = along(&slide);
            }
            // It is three hundredths of a pixel away a little later.
            assert!((0.9..1.15).contains(&(angle / leaves)), "{what}: it leaves at {angle}, not {leaves}");
        }
    }
}

/// The grip that lets large piles come to rest would take a twentieth of it.
#[test]
fn a_ball_that_slides_off_one_that_can_move_keeps_their_energy_where_there_are_few() {
    let dome = ball(2000.0, 3800.0, 200.0).with_mass(1e4).unwrap().with_restitution(0.0).unwrap();
    let sliding = ball(2000.0, 3580.0, 20.0).with_restitution(0.0).unwrap();
    let balls = vec![moving(sliding, 60.0, 0.0), dome];
    let mut slide = simulation(world(4000.0, 4000.0, 0.0).with_gravity(EARTH).unwrap(), balls);
    let height = |slide: &Simulation| slide.balls()[0].position().y;
    while height(&slide) < 3580.0 + 150.0 {
        slide.advance(1.0 / 240.0).unwrap();
    }
    let fallen = 2.0 * EARTH.y * (height(&slide) - 3580.0) + 60.0 * 60.0;
    let kept = slide.balls()[0].velocity().length_squared() / fallen;
    assert!((kept - 1.0).abs() < 0.03, "{kept} of it is left");
}
