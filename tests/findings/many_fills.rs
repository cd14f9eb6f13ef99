//! A hundred thousand fills of one ball each took hours: each looks at all balls before it.

use carom::Scene;

#[test]
fn fills_beyond_what_any_scene_needs_are_refused_at_once() {
    let fills = |count| Scene::parse("fills.toml", &"[[fill]]\ncount = 1\nradius = 1\n".repeat(count));
    assert_eq!(fills(1000).unwrap().build().unwrap().balls().len(), 1000);
    let message = fills(100_000).unwrap_err().to_string();
    assert!(message.contains("fills.toml:3001: the scene has more than 1000 fills"), "{message}");
}
