//! Without gravity, a heavy ball drives a light one into a corner, which hits it and the walls ever more often until what
//! is left of their approach is taken at once: what the walls gave then was in no account.

use carom::simulation::ledger::Ledger;
use carom::{Ball, DVec2, Pairs, Simulation, Solver, World};

#[test]
fn walls_account_for_the_momentum_of_what_is_stopped_against_them() {
    let world = World::new(DVec2::splat(200.0)).unwrap().with_walls(1.0).unwrap();
    for aim in [0.88, 1.0, 1.08] {
        let light = Ball::new(DVec2::new(188.0, 12.0), 10.0).unwrap().with_restitution(0.0).unwrap();
        let heavy = Ball::new(DVec2::new(100.0, 100.0), 10.0).unwrap().with_mass(1000.0).unwrap();
        let heavy = heavy.with_velocity(0.2 * DVec2::new(1.0, -aim)).unwrap();
        let balls = vec![light, heavy];
        let mut simulation = Simulation::new(world.with_pairs(Pairs::Impulse), balls, Solver::Exact).unwrap();
        let mut ledger = Ledger::new(&simulation);
        for _ in 0..1000 {
            simulation.advance(1.0).unwrap();
            ledger.check(&simulation).unwrap_or_else(|violation| panic!("aim {aim}: {violation}"));
        }
        assert!(simulation.tally().impacts > 10, "aim {aim}: {:?}", simulation.tally());
    }
}
