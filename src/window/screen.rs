//! The picture on its way to the window: pixels' framebuffer and the surface behind it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use pixels::wgpu::{BlendState, SurfaceError};
use pixels::{Pixels, PixelsBuilder, SurfaceTexture};
use tiny_skia::PixmapMut;
use winit::dpi::PhysicalSize;
use winit::window::Window;

use super::problem::WindowError;

/// A framebuffer as large as the window, one of its pixels for one of the window's.
///
/// pixels' default formats are a pair of sRGB textures, so the bytes painted are the bytes shown.
pub(super) struct Screen {
    /// `None` only where making it anew has failed.
    pixels: Option<Pixels<'static>>,
    window: Arc<Window>,
    vsync: bool,
    size: PhysicalSize<u32>,
    /// Set by the graphics library when the device has failed.
    device_failed: Arc<AtomicBool>,
    /// Frames in a row that could not be shown.
    failures: u32,
    /// Whether the framebuffer holds what was painted last.
    kept: bool,
}

/// How long the two halves of presenting took.
#[derive(Debug, Clone, Copy)]
pub(super) struct Presented {
    /// Waiting for the surface's next texture, and copying the picture to the device.
    pub(super) upload: Duration,
    /// Drawing it on the surface and handing that over.
    pub(super) present: Duration,
}

/// After so many frames in a row that could not be shown, the device and its surface are made anew.
const FAILURES_UNTIL_RENEWAL: u32 = 3;
/// After so many, carom gives up.
const FAILURES_MOST: u32 = 10;

impl Screen {
    /// A screen for the window as it is. Both sides of `size` are at least 1. `scene` is for messages.
    pub(super) fn new(
        window: Arc<Window>,
        size: PhysicalSize<u32>,
        vsync: bool,
        scene: &str,
    ) -> Result<Self, WindowError> {
        let device_failed = Arc::new(AtomicBool::new(false));
        let mut screen = Self { pixels: None, window, vsync, size, device_failed, failures: 0, kept: false };
        screen.renew().map_err(|error| match error {
            pixels::Error::InvalidTexture(_) => too_large(size),
            error => WindowError::NoAdapter { reason: error.to_string(), scene: scene.to_owned() },
        })?;
        Ok(screen)
    }

    /// Makes device, surface and framebuffer anew.
    fn renew(&mut self) -> Result<(), pixels::Error> {
        // A window has one surface at a time.
        self.pixels = None;
        self.kept = false;
        let PhysicalSize { width, height } = self.size;
        let surface = SurfaceTexture::new(width, height, self.window.clone());
        let builder = PixelsBuilder::new(width, height, surface);
        let pixels = builder.enable_vsync(self.vsync).blend_state(BlendState::REPLACE).build()?;
        // Without these the graphics library panics on a lost device or exhausted memory.
        self.device_failed.store(false, Ordering::Relaxed);
        let (on_error, on_loss) = (self.device_failed.clone(), self.device_failed.clone());
        pixels.device().on_uncaptured_error(Arc::new(move |_| on_error.store(true, Ordering::Relaxed)));
        pixels.device().set_device_lost_callback(move |_, _| on_loss.store(true, Ordering::Relaxed));
        self.pixels = Some(pixels);
        Ok(())
    }

    /// Follows the window's size. Both sides are at least 1.
    pub(super) fn resize(&mut self, size: PhysicalSize<u32>) -> Result<(), WindowError> {
        if let Some(pixels) = &mut self.pixels {
            let resized = pixels.resize_surface(size.width, size.height);
            let resized = resized.and_then(|()| pixels.resize_buffer(size.width, size.height));
            resized.map_err(|_| too_large(size))?;
        }
        self.kept = false;
        self.size = size;
        Ok(())
    }

    /// The size of the framebuffer.
    pub(super) fn size(&self) -> PhysicalSize<u32> {
        self.size
    }

    /// The framebuffer, to be painted, and whether it still holds what was painted last.
    pub(super) fn pixmap(&mut self) -> Option<(PixmapMut<'_>, bool)> {
        let PhysicalSize { width, height } = self.size;
        let pixmap = PixmapMut::from_bytes(self.pixels.as_mut()?.frame_mut(), width, height)?;
        Some((pixmap, std::mem::replace(&mut self.kept, true)))
    }

    /// Shows what was painted. A surface that is outdated or lost costs this frame, and a failed device a few; both are
    /// made anew, and another frame is asked for.
    pub(super) fn present(&mut self) -> Result<Presented, WindowError> {
        let start = Instant::now();
        let mut uploaded = start;
        let rendered = self.pixels.as_ref().map(|pixels| {
            pixels.render_with(|encoder, target, context| {
                uploaded = Instant::now();
                // Only here is it certain that something will be presented: Wayland holds back the next frame until then.
                self.window.pre_present_notify();
                context.scaling_renderer.render(encoder, target);
                Ok(())
            })
        });
        let presented = Presented { upload: uploaded - start, present: uploaded.elapsed() };
        let failed = self.device_failed.load(Ordering::Relaxed);
        match rendered {
            Some(Ok(())) if !failed => self.failures = 0,
            // A surface that nobody shows gives no texture in time; one that is outdated, pixels has reconfigured.
            Some(Err(pixels::Error::Surface(SurfaceError::Timeout))) if !failed => {
                self.window.request_redraw();
            }
            Some(Err(pixels::Error::Surface(SurfaceError::Outdated)))
                if !failed && self.failures < FAILURES_UNTIL_RENEWAL =>
            {
                self.failures += 1;
                self.window.request_redraw();
            }
            rendered => {
                self.failures += 1;
                let renewed = self.renew();
                if self.failures > FAILURES_MOST {
                    let error = renewed.err().or(rendered.and_then(Result::err));
                    let reason = error
                        .map_or_else(|| "it fails again and again".to_owned(), |error| error.to_string());
                    return Err(WindowError::DeviceLost { reason });
                }
                self.window.request_redraw();
            }
        }
        Ok(presented)
    }
}

fn too_large(size: PhysicalSize<u32>) -> WindowError {
    WindowError::TooLarge { width: size.width, height: size.height }
}
