//! What is said where the window's libraries end the program.
//!
//! winit and wgpu panic where the display server or the graphics driver has gone away under them. That is no defect of
//! theirs or ours that a place in their source would explain; who sits there wants to know what happened.

use std::io::{self, Write};
use std::panic::{self, Location};
use std::process;

use carom::headless::discard_unfinished;

/// From now on, a panic inside of the window's libraries is told as what it means, leaves nothing half-written, and
/// ends the program with exit code 1. All others are told as ever.
pub fn watch() {
    let others = panic::take_hook();
    panic::set_hook(Box::new(move |panic| {
        let Some(meaning) = panic.location().and_then(meaning) else { return others(panic) };
        discard_unfinished();
        let _ = writeln!(io::stderr(), "carom: {meaning}");
        process::exit(1);
    }));
}

/// What a panic at this place means, where it is not ours.
fn meaning(place: &Location<'_>) -> Option<&'static str> {
    meaning_in(place.file())
}

fn meaning_in(file: &str) -> Option<&'static str> {
    // A registry's folders are called <crate>-<version>.
    let from = |names: &[&str]| {
        let folder = |part: &str| names.iter().any(|name| part.strip_prefix(name).is_some_and(is_version));
        file.split(['/', '\\']).any(folder)
    };
    if from(&[
        "winit-",
        "x11rb-",
        "x11-dl-",
        "wayland-client-",
        "wayland-backend-",
        "smithay-client-toolkit-",
    ]) {
        Some("the display that the window was on is gone; what was not saved is lost")
    } else if from(&["wgpu-", "wgpu-core-", "wgpu-hal-", "pixels-"]) {
        Some("the graphics device was lost and could not be had back; start carom again")
    } else {
        None
    }
}

fn is_version(text: &str) -> bool {
    text.starts_with(|first: char| first.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_panics_of_the_windows_libraries_are_told_as_what_they_mean() {
        let registry = "/home/me/.cargo/registry/src/index.crates.io-1949cf8c6b5b557f";
        for (file, part) in [
            ("winit-0.30.13/src/platform_impl/linux/x11/mod.rs", "display"),
            ("wgpu-27.0.1/src/backend/wgpu_core.rs", "graphics device"),
            ("wgpu-hal-27.0.4/src/vulkan/mod.rs", "graphics device"),
        ] {
            assert!(meaning_in(&format!("{registry}/{file}")).unwrap().contains(part), "{file}");
        }
        for file in ["src/window/app/mod.rs", "/home/me/winit-demo/src/main.rs", "glam-0.34.2/src/lib.rs", ""]
        {
            assert_eq!(meaning_in(file), None, "{file}");
        }
    }
}
