//! Making the window: what it needs, where it appears, how large.

use std::sync::Arc;

use glam::DVec2;
use tiny_skia::PremultipliedColorU8;
use winit::dpi::{LogicalSize, PhysicalSize};
use winit::event_loop::ActiveEventLoop;
use winit::window::{Fullscreen, Icon, Window};

use super::Options;
use super::problem::{self, WindowError};
use super::screen::Screen;
use crate::paint;

/// The widest window that is asked for, in pixels of the screen. No graphics adapter draws a wider one.
const WIDEST: f64 = 32_767.0;

/// winit aborts where the keyboard's library is missing under X11; this asks before it does.
#[cfg(target_os = "linux")]
pub(super) fn check_libraries(scene: &str) -> Result<(), WindowError> {
    let missing = |library, package| WindowError::NoLibrary { library, package, scene: scene.to_owned() };
    if xkbcommon_dl::xkbcommon_option().is_none() {
        return Err(missing("libxkbcommon.so.0", "libxkbcommon0"));
    }
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let on_wayland = set("WAYLAND_DISPLAY") || set("WAYLAND_SOCKET");
    if !on_wayland && set("DISPLAY") && xkbcommon_dl::x11::xkbcommon_x11_option().is_none() {
        return Err(missing("libxkbcommon-x11.so.0", "libxkbcommon-x11-0"));
    }
    Ok(())
}

#[cfg(not(target_os = "linux"))]
pub(super) fn check_libraries(_scene: &str) -> Result<(), WindowError> {
    Ok(())
}

/// A window on a world of `size` px, and what its pictures are shown with. `scene` is for messages.
pub(super) fn create(
    event_loop: &ActiveEventLoop,
    size: DVec2,
    options: &Options,
    scene: &str,
) -> Result<(Arc<Window>, Screen), WindowError> {
    let mut attributes = Window::default_attributes()
        .with_title("carom")
        .with_inner_size(LogicalSize::new(size.x, size.y))
        .with_window_icon(icon());
    #[cfg(target_os = "linux")]
    {
        use winit::platform::{wayland::WindowAttributesExtWayland, x11::WindowAttributesExtX11};
        attributes = WindowAttributesExtX11::with_name(attributes, "carom", "carom");
        attributes = WindowAttributesExtWayland::with_name(attributes, "carom", "carom");
    }
    if options.fullscreen {
        attributes = attributes.with_fullscreen(Some(Fullscreen::Borderless(None)));
    }
    // X11 counts a window's sides in 16 bits, and winit ends the program where they do not fit.
    let pixels = size * event_loop.primary_monitor().map_or(1.0, |monitor| monitor.scale_factor());
    if pixels.max_element() > WIDEST {
        return Err(WindowError::TooLarge { width: pixels.x as u32, height: pixels.y as u32 });
    }
    let window = event_loop.create_window(attributes).map_err(|error| WindowError::NoDisplay {
        reason: problem::plain(&error),
        scene: scene.to_owned(),
    })?;
    let window = Arc::new(window);
    let size = window.inner_size();
    let at_least_one = PhysicalSize::new(size.width.max(1), size.height.max(1));
    let screen = Screen::new(window.clone(), at_least_one, options.vsync, scene)?;
    Ok((window, screen))
}

/// One of our balls.
fn icon() -> Option<Icon> {
    const SIDE: u32 = 64;
    let mut pixmap = tiny_skia::Pixmap::new(SIDE, SIDE)?;
    let middle = f64::from(SIDE) / 2.0;
    paint::fill_disc(&mut pixmap.as_mut(), DVec2::splat(middle), middle - 2.0, paint::BALL);
    let straight = pixmap.pixels().iter().map(PremultipliedColorU8::demultiply);
    let rgba = straight.flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue(), pixel.alpha()]);
    Icon::from_rgba(rgba.collect(), SIDE, SIDE).ok()
}
