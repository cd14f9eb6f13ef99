//! Any text as a file of deltas: frames of a simulation's range, or an error that says something.

#![no_main]

use std::path::Path;

use carom::headless::Frames;
use carom::simulation::limits::DELTA;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match Frames::parse(Path::new("fuzzed.txt"), text) {
        Ok(frames) => {
            assert!((1..=text.len() as u64).contains(&frames.count()));
            assert!((0..frames.count()).all(|frame| DELTA.check(frames.delta(frame)).is_ok()));
        }
        Err(error) => assert!(error.to_string().starts_with("fuzzed.txt")),
    }
});
