//! Any text as a replay: an error that says something, or what is written as it is read and played by the laws.

#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../tests/common/replaying.rs"]
mod replaying;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    replaying::judge(text);
});
