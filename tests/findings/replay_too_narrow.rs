//! A replay whose world has no room for the scene's balls was refused without a word of the replay.

use std::path::Path;

use carom::Scene;
use carom::session::Replay;

#[test]
fn a_world_without_room_is_refused_by_the_replays_name() {
    let scene = Scene::load("bullet").unwrap();
    let error = Replay::parse(Path::new("narrow"), "carom replay 1\nsize 128 2\n", &scene).unwrap_err();
    assert!(error.to_string().starts_with("narrow: ball 0 (radius 3 px) is wider than the world"), "{error}");
}
