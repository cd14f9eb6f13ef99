//! What can go wrong with a window, and what to do about it.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::OutOfRange;
use crate::paint::AnimationError;
use crate::scene::SceneError;

/// Why there is no window, or no more. Each message says what is missing, how to get it, and what works without.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum WindowError {
    /// No display server answers.
    #[error(
        "there is no display to open a window on ({reason})\n  \
         On a desktop, start carom from its terminal; over ssh, use ssh -X; on a server, apt install xvfb and run \
         xvfb-run carom.\n  {}",
        without(scene)
    )]
    NoDisplay {
        /// What the windowing system said.
        reason: String,
        /// The scene that was to be shown.
        scene: String,
    },
    /// A library that windows need is not installed.
    #[error(
        "the library {library} is missing, which reads the keyboard\n  Install it: apt install {package}\n  {}",
        without(scene)
    )]
    NoLibrary {
        /// The library's file name.
        library: &'static str,
        /// The Debian package that has it.
        package: &'static str,
        /// The scene that was to be shown.
        scene: String,
    },
    /// There is no graphics adapter, not even one in software.
    #[error(
        "there is a display but no graphics adapter to draw on it with ({reason})\n  \
         Install a Vulkan driver: apt install libvulkan1 mesa-vulkan-drivers (it also draws without a graphics \
         card).\n  {}",
        without(scene)
    )]
    NoAdapter {
        /// What the graphics library said.
        reason: String,
        /// The scene that was to be shown.
        scene: String,
    },
    /// The window is larger than the graphics adapter can draw.
    #[error(
        "a window of {width}x{height} px is more than this graphics adapter can draw; ask for a smaller one"
    )]
    TooLarge {
        /// Its width in pixels.
        width: u32,
        /// Its height in pixels.
        height: u32,
    },
    /// The graphics device was lost and does not come back.
    #[error("the graphics device was lost and could not be had back ({reason}); start carom again")]
    DeviceLost {
        /// What the graphics library said.
        reason: String,
    },
    /// There is no graphics memory for the window.
    #[error(
        "there is no graphics memory left for a window of {width}x{height} px; close other programs, or ask for a smaller \
         one"
    )]
    GraphicsMemory {
        /// Its width in pixels.
        width: u32,
        /// Its height in pixels.
        height: u32,
    },
    /// The display server has ended, or has thrown the window out.
    #[error("the display that the window was on is gone; what was not saved is lost")]
    DisplayGone,
    /// The windowing system failed.
    #[error("the windowing system failed: {0}")]
    System(String),
    /// The scene cannot be shown.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A number is out of range.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
}

/// Why a picture or a recording was not saved.
#[derive(Debug, Error)]
pub(super) enum SaveError {
    #[error("{}: {source}; check that the folder may be written to and has room", path.display())]
    Io { path: PathBuf, source: io::Error },
    #[error("the picture could not be encoded: {0}")]
    Encoding(String),
    #[error("{}: {source}", path.display())]
    Animation { path: PathBuf, source: AnimationError },
    #[error("no thread could be started that encodes it: {0}")]
    NoThread(io::Error),
    #[error("the thread that encodes it has ended before its time")]
    ThreadEnded,
}

/// What winit says, without the place in its source that it says it at.
pub(super) fn plain(error: &impl ToString) -> String {
    let text = error.to_string();
    let behind_the_place = text.split_once(".rs:").and_then(|(_, rest)| rest.split_once(": "));
    behind_the_place.map_or(text.clone(), |(_, reason)| reason.trim_end_matches('.').to_owned())
}

fn without(scene: &str) -> String {
    format!(
        "Without a window: carom run {scene} --gif {0}.gif, or carom run {scene} --image {0}.png",
        stem(scene)
    )
}

fn stem(scene: &str) -> &str {
    std::path::Path::new(scene).file_stem().and_then(|stem| stem.to_str()).unwrap_or("carom")
}
