//! The real window: opened on a virtual X server or on Wayland without a screen, sent real keys, looked at in screenshots.
//!
//! These tests need Xvfb, xdotool, xprop, the `import` of imagemagick, a Vulkan driver, and a few of them openbox, xrandr,
//! weston, sway, wtype and grim (README, "Tests"), so plain `cargo test` leaves them out and says so. `cargo test --test window -- --ignored`
//! runs them. `CAROM_PROGRAM` names another program to test than the one that is built with them, an optimised one for
//! instance; `CAROM_SOAK_SECONDS` and `CAROM_SOAK_SEED` say how long the random input lasts, and which it is.
#![cfg(all(feature = "window", target_os = "linux"))]

mod display;
mod drop;
mod files;
mod frames;
mod mouse;
mod play;
mod screen;
mod soak;
mod sway;
mod system;
mod time;
mod views;
mod wayland;
