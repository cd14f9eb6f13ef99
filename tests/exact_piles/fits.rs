//! Few balls that fit between the walls to the last digit: round numbers in a scene file do.

use carom::simulation::ledger::Ledger;

use super::*;

/// So many balls of this radius in a box, which fall and come to rest.
fn fit((width, height): (u32, u32), radius: u32, count: u32, seed: u32) -> Simulation {
    let restitution = [0.0, 0.3, 0.5, 0.7][seed as usize % 4];
    let text = format!(
        "solver = \"exact\"\nsize = [{width}, {height}]\ngravity = [0, {EARTH:?}]\n[walls]\nrestitution = 0.5\n[pairs]\n\
         [[fill]]\ncount = {count}\nradius = {radius}\nspeed = [0, 200]\nrestitution = {restitution}\nseed = {seed}\n"
    );
    Scene::parse("fit", &text).unwrap().build().unwrap()
}

#[test]
fn few_balls_whose_widths_divide_that_of_their_box_come_to_rest_in_few_events_and_lawfully() {
    for (size, radius, count) in [
        ((300, 300), 50, 5),
        ((400, 300), 50, 6),
        ((640, 480), 40, 12),
        ((500, 500), 25, 16),
        ((90, 300), 15, 5),
        ((150, 400), 15, 8),
        ((240, 400), 15, 16),
    ] {
        for seed in 0..6 {
            let mut balls = fit(size, radius, count, seed);
            let (mut ledger, mut before) = (Ledger::new(&balls), 0);
            for frame in 0..6 * 60 {
                balls.advance(1.0 / 60.0).unwrap();
                let found = hits(&balls);
                // Up to seven million while hits had no end.
                assert!(found - before < 200_000, "{size:?}, {count} balls, seed {seed}: {}", found - before);
                before = found;
                let held = ledger.check(&balls);
                assert!(held.is_ok(), "{size:?}, {count} balls, seed {seed}, frame {frame}: {held:?}");
            }
            assert_eq!(fastest(&balls), 0.0, "{size:?}, {count} balls, seed {seed}");
            assert!(overlap(&balls) < 1e-6, "{size:?}, {count} balls, seed {seed}: {}", overlap(&balls));
        }
    }
}
