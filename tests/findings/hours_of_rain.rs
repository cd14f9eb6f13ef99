//! An hour of rain in one frame could not be cut short where the solver never asks, as `canvas` does not.

use carom::{Scene, Solver};

#[test]
fn rain_asks_whether_to_go_on_where_the_solver_does_not() {
    let scene = Scene::load("rain").unwrap().with_solver(Solver::Canvas);
    let (mut simulation, mut rain) = (scene.build().unwrap(), scene.rain().unwrap());
    for _ in 0..10 {
        let before = simulation.time();
        let done = rain.advance_while(&mut simulation, 3600.0, || false).unwrap();
        assert!(done > 0.0 && done < 1.0, "{done}");
        assert!((simulation.time() - before - done).abs() < 1e-9);
    }
}
