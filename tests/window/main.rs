//! The real window: opened on a virtual X server, sent real keys, looked at in screenshots.
//!
//! These tests need Xvfb, xdotool, xprop, the `import` of imagemagick, a Vulkan driver, and a few of them openbox, xrandr
//! and weston (README, "Tests"), so plain
//! `cargo test` leaves them out and says so. `cargo test --test window -- --ignored` runs them.
#![cfg(all(feature = "window", target_os = "linux"))]

mod display;
mod drop;
mod files;
mod frames;
mod mouse;
mod play;
mod screen;
mod soak;
mod system;
mod time;
mod views;
mod wayland;
