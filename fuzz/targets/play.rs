//! Any bytes as a scene and what is done to it: the laws hold in every frame.

#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../tests/common/play.rs"]
mod play;

fuzz_target!(|bytes: &[u8]| play::play(bytes));
