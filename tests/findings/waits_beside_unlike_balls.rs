//! A ball that came to one that waits for the next step of what is carried waited, too; one of a tenth of its mass ended that, and it
//! waited again, without end.

use carom::{Scene, Solver};

#[test]
fn a_ball_that_an_unlike_one_wakes_from_its_wait_does_not_wait_again_in_the_same_step() {
    let text = include_str!("../data/crowds/unlike-among-pegs.toml");
    let mut crowd = Scene::parse("unlike among pegs", text).unwrap().build().unwrap();
    assert_eq!(crowd.solver(), Solver::Exact);
    let mut looks = 0;
    for frame in 0..60 {
        // There was no end of events in one of these frames. A look is at every 256 of them, or at what takes as long.
        crowd
            .advance_while(1.0 / 60.0, || {
                looks += 1;
                looks < 50_000
            })
            .unwrap();
        assert!(looks < 50_000, "frame {frame}: {:?}", crowd.tally());
    }
}
