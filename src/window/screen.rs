//! The picture on its way to the window: pixels' framebuffer and the surface behind it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use pixels::wgpu::BlendState;
use pixels::{Pixels, PixelsBuilder, SurfaceTexture};
use tiny_skia::PixmapMut;
use winit::dpi::PhysicalSize;
use winit::window::Window;

use super::problem::WindowError;

/// A framebuffer as large as the window, one of its pixels for one of the window's.
///
/// pixels' default formats are a pair of sRGB textures, so the bytes painted are the bytes shown.
pub(super) struct Screen {
    pixels: Pixels<'static>,
    window: Arc<Window>,
    vsync: bool,
    size: PhysicalSize<u32>,
    /// Set by the graphics library when the device has failed.
    failed: Arc<AtomicBool>,
}

/// How long the two halves of presenting took.
#[derive(Debug, Clone, Copy)]
pub(super) struct Presented {
    /// Waiting for the surface's next texture, and copying the picture to the device.
    pub(super) upload: Duration,
    /// Drawing it on the surface and handing that over.
    pub(super) present: Duration,
}

impl Screen {
    /// A screen for the window as it is. Both sides of `size` are at least 1.
    pub(super) fn new(
        window: Arc<Window>,
        size: PhysicalSize<u32>,
        vsync: bool,
        scene: &str,
    ) -> Result<Self, WindowError> {
        let surface = SurfaceTexture::new(size.width, size.height, window.clone());
        let builder = PixelsBuilder::new(size.width, size.height, surface);
        let pixels = builder.enable_vsync(vsync).blend_state(BlendState::REPLACE).build();
        let pixels = pixels.map_err(|error| match error {
            pixels::Error::InvalidTexture(_) => {
                WindowError::TooLarge { width: size.width, height: size.height }
            }
            error => WindowError::NoAdapter { reason: error.to_string(), scene: scene.to_owned() },
        })?;
        let failed = Arc::new(AtomicBool::new(false));
        // Without these the graphics library panics on a lost device or exhausted memory.
        let (on_error, on_loss) = (failed.clone(), failed.clone());
        pixels.device().on_uncaptured_error(Arc::new(move |_| on_error.store(true, Ordering::Relaxed)));
        pixels.device().set_device_lost_callback(move |_, _| on_loss.store(true, Ordering::Relaxed));
        Ok(Self { pixels, window, vsync, size, failed })
    }

    /// Follows the window's size. Both sides are at least 1.
    pub(super) fn resize(&mut self, size: PhysicalSize<u32>) -> Result<(), WindowError> {
        if size != self.size {
            let resized = self.pixels.resize_surface(size.width, size.height);
            let resized = resized.and_then(|()| self.pixels.resize_buffer(size.width, size.height));
            resized.map_err(|_| WindowError::TooLarge { width: size.width, height: size.height })?;
            self.size = size;
        }
        Ok(())
    }

    /// The framebuffer, to be painted.
    pub(super) fn pixmap(&mut self) -> Option<PixmapMut<'_>> {
        PixmapMut::from_bytes(self.pixels.frame_mut(), self.size.width, self.size.height)
    }

    /// Shows what was painted. pixels itself recreates a surface that is lost or outdated; where the device under it has
    /// failed, a new one is asked for, once, and shows the next frame.
    pub(super) fn present(&mut self) -> Result<Presented, WindowError> {
        self.window.pre_present_notify();
        let start = Instant::now();
        let mut uploaded = start;
        let rendered = self.pixels.render_with(|encoder, target, context| {
            uploaded = Instant::now();
            context.scaling_renderer.render(encoder, target);
            Ok(())
        });
        if rendered.is_err() || self.failed.load(Ordering::Relaxed) {
            let reason =
                rendered.err().map_or_else(|| "device failure".to_owned(), |error| error.to_string());
            *self = Self::new(self.window.clone(), self.size, self.vsync, "")
                .map_err(|_| WindowError::DeviceLost { reason })?;
            self.window.request_redraw();
        }
        Ok(Presented { upload: uploaded - start, present: uploaded.elapsed() })
    }

    /// The pixels of the last frame, RGBA.
    pub(super) fn bytes(&self) -> (&[u8], PhysicalSize<u32>) {
        (self.pixels.frame(), self.size)
    }
}
