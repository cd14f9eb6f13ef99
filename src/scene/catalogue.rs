//! The scenes that come with the program: files that a user could have written, embedded.

/// A scene file in the program.
#[derive(Debug, Clone, Copy)]
pub(super) struct Builtin {
    pub(super) name: &'static str,
    pub(super) source: &'static str,
}

macro_rules! builtin {
    ($($name:literal),+ $(,)?) => {
        &[$(Builtin { name: $name, source: include_str!(concat!("../../assets/scenes/", $name, ".toml")) }),+]
    };
}

/// All of them; the first eight are the demo's stages, in its order.
pub(super) const SCENES: &[Builtin] = builtin![
    "draw",
    "move",
    "two",
    "detect",
    "walls",
    "elastic",
    "inelastic",
    "gravity",
    "pile",
    "rain",
    "column",
    "heavy",
    "bullet",
    "cradle",
    "gas",
    "galton",
];

/// How many of the built-in scenes are the demo's stages.
pub const STAGES: usize = 8;

/// The names of the built-in scenes, in their order.
#[must_use]
pub fn names() -> Vec<&'static str> {
    SCENES.iter().map(|scene| scene.name).collect()
}

pub(super) fn find(name: &str) -> Option<&'static Builtin> {
    SCENES.iter().find(|scene| scene.name == name)
}
