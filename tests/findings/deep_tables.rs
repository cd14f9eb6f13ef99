//! Tables nested without end were refused as "recursion limit", without a word of what to write instead.

use carom::Scene;

#[test]
fn nesting_without_end_is_refused_and_the_message_says_what_to_write() {
    let deep = 100_000;
    for text in [
        format!("size = {}{}", "[".repeat(deep), "]".repeat(deep)),
        format!("walls = {}1{}", "{a=".repeat(deep), "}".repeat(deep)),
        format!("{} = 1", vec!["walls"; deep].join(".")),
        format!("[{}]", vec!["walls"; deep].join(".")),
    ] {
        let message = Scene::parse("deep.toml", &text).unwrap_err().to_string();
        assert!(message.contains("nested too deep; a scene file has no tables in tables"), "{message}");
        assert!(message.len() < 1000, "{}", message.len());
    }
}
