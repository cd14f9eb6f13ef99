//! Any text as a scene file: a scene, or an error that says something.

#![no_main]

use carom::Scene;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match Scene::parse("fuzzed.toml", text) {
        Ok(scene) => assert_eq!(scene.source(), text),
        Err(error) => assert!(error.to_string().starts_with("fuzzed.toml")),
    }
});
