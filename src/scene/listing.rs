//! What each built-in scene shows, uses and leaves out.

use serde::Serialize;

use super::{Scene, SceneError, names};
use crate::simulation::Part;

/// A built-in scene, described by the simulation that it makes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Listing {
    /// Its name.
    pub name: String,
    /// What it shows.
    pub about: String,
    /// Its solver's name.
    pub solver: &'static str,
    /// How many balls it has at time 0; those of rain come later.
    pub balls: usize,
    /// The parts of the solver that run; where balls fall in, after a second of that.
    pub uses: Vec<String>,
    /// What does not exist for it.
    pub leaves_out: Vec<&'static str>,
}

impl Listing {
    /// All built-in scenes.
    ///
    /// # Errors
    /// [`SceneError`] where a built-in scene is wrong: a defect that a test looks for.
    pub fn all() -> Result<Vec<Self>, SceneError> {
        names().into_iter().map(|name| Self::new(&Scene::load(name)?)).collect()
    }

    fn new(scene: &Scene) -> Result<Self, SceneError> {
        let mut simulation = scene.build()?;
        let balls = simulation.balls().len();
        if let Some(mut rain) = scene.rain() {
            // Before the first ball falls in, nothing of what it meets is needed.
            rain.advance(&mut simulation, 1.0).expect("a second is a delta");
        }
        let parts = simulation.parts();
        let without = |wanted: &[Part]| !parts.iter().any(|part| wanted.contains(part));
        let left_out = [
            ("gravity", without(&[Part::Gravity])),
            ("walls", without(&[Part::Walls])),
            ("pairs", without(&[Part::AllPairs, Part::Grid])),
            ("impulse", without(&[Part::Impulse])),
        ];
        Ok(Self {
            name: scene.name().to_owned(),
            about: scene.about().to_owned(),
            solver: simulation.solver().name(),
            balls,
            uses: parts.iter().map(Part::to_string).collect(),
            leaves_out: left_out.into_iter().filter(|&(_, out)| out).map(|(name, _)| name).collect(),
        })
    }
}
