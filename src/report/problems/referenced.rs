//! Problems with a reference run for their truth.

use super::{Problem, Setup, Unposed};
use crate::scene::Scene;
use crate::simulation::{Ball, World};

/// The demo's stages of which chaos lets the truth be known for a while.
const STAGES: [(&str, [(&str, &str); 2]); 3] = [
    ("elastic", [("elastic-1s", "The demo's elastic to 1 s"), ("elastic-2s", "The demo's elastic to 2 s")]),
    (
        "inelastic",
        [("inelastic-1s", "The demo's inelastic to 1 s"), ("inelastic-2s", "The demo's inelastic to 2 s")],
    ),
    ("gravity", [("gravity-1s", "The demo's gravity to 1 s"), ("gravity-2s", "The demo's gravity to 2 s")]),
];

pub(super) fn problems() -> Result<Vec<Problem>, Unposed> {
    let mut problems = Vec::new();
    for (scene, names) in STAGES {
        let (world, balls) = demo(scene)?;
        for ((name, title), seconds) in names.into_iter().zip([1.0, 2.0]) {
            let about = format!(
                "The fifteen balls of the demo's `{scene}` stage, for {seconds} s; the truth is a plain event-driven \
                 run with twice the digits of an f64."
            );
            let setup = Setup { name, title, about, world, balls: balls.clone(), seconds };
            problems.push(setup.with_reference()?);
        }
    }
    Ok(problems)
}

/// The scenes whose errors are followed for ten seconds.
pub(in crate::report) fn growth_scenes() -> impl Iterator<Item = &'static str> {
    STAGES.into_iter().map(|(scene, _)| scene)
}

/// The world and the balls of a built-in scene.
pub(in crate::report) fn demo(scene: &str) -> Result<(World, Vec<Ball>), Unposed> {
    let wrong = |error: crate::SceneError| Unposed::Scene(error.to_string());
    let simulation = Scene::load(scene).map_err(wrong)?.build().map_err(wrong)?;
    Ok((*simulation.world(), simulation.balls().to_vec()))
}
