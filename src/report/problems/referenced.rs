//! Problems with a reference run for their truth.

use glam::DVec2;

use super::{Problem, Setup, Unposed};
use crate::scene::Scene;
use crate::simulation::{Ball, Pairs, World};

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
    let mut problems = vec![struck()?];
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

/// A hit presses a ball that lies on the floor into it, and the floor throws it back at once: three impacts at one
/// time.
fn struck() -> Result<Problem, Unposed> {
    let world = World::new(DVec2::new(200.0, 300.0))?.with_walls(0.8)?;
    let soft = |x: f64, y: f64, radius: f64| Ball::new(DVec2::new(x, y), radius)?.with_restitution(0.7);
    let setup = Setup {
        name: "struck",
        title: "A ball falls on one that lies on the floor",
        about: "A ball at rest on the floor (e = 0.8) is hit from above, off its middle (e = 0.7), for 0.71 s; the truth is \
                the reference run."
            .to_owned(),
        world: world.with_gravity(DVec2::new(0.0, 980.0))?.with_pairs(Pairs::Impulse),
        balls: vec![soft(100.0, 290.0, 10.0)?, soft(109.0, 120.0, 20.0)?.with_mass(4.0)?],
        seconds: 0.71,
    };
    setup.with_reference()
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
