//! A window that shrinks over balls among fixed ones, in the middle of a frame that was stopped: what is left of their
//! approach has no answer there, and what is found instead, no numbers, must not become their velocities.

#[path = "../common/play.rs"]
mod play;

#[test]
fn balls_that_are_jammed_among_fixed_ones_stay_finite() {
    play::play(include_bytes!("no_answer_in_a_jam.bytes"));
}
