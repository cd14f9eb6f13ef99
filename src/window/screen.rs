//! The picture on its way to the window: pixels' framebuffer and the surface behind it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use pixels::wgpu::{BlendState, CommandEncoderDescriptor};
use pixels::{Pixels, PixelsBuilder, SurfaceTexture};
use tiny_skia::PixmapMut;
use winit::dpi::PhysicalSize;
use winit::window::Window;

use super::problem::WindowError;
use super::recovery::{Outcome, Recovery, Remedy};

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
    recovery: Recovery,
    /// Why it could not be made anew the last time.
    failure: Option<pixels::Error>,
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
    /// Where it was not shown: after how long to paint and present again.
    pub(super) again: Option<Duration>,
}

impl Screen {
    /// A screen for the window as it is. Both sides of `size` are at least 1. `scene` is for messages.
    pub(super) fn new(
        window: Arc<Window>,
        size: PhysicalSize<u32>,
        vsync: bool,
        scene: &str,
    ) -> Result<Self, WindowError> {
        let device_failed = Arc::new(AtomicBool::new(false));
        let mut screen = Self {
            pixels: None,
            window,
            vsync,
            size,
            device_failed,
            recovery: Recovery::default(),
            failure: None,
            kept: false,
        };
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

    /// Shows what was painted. A surface or a device that has failed costs a few pictures: what has failed is made
    /// anew, and the picture is to be painted and presented again.
    pub(super) fn present(&mut self) -> Result<Presented, WindowError> {
        let start = Instant::now();
        let mut uploaded = start;
        let rendered = self.pixels.as_ref().map(|pixels| {
            pixels.render_with(|_, target, context| {
                uploaded = Instant::now();
                // Submitted here and not after: presenting on a device that was lost as this was submitted would be
                // the end, in the graphics library. An error leaves the picture out instead.
                let descriptor = CommandEncoderDescriptor { label: Some("carom") };
                let mut encoder = context.device.create_command_encoder(&descriptor);
                context.scaling_renderer.render(&mut encoder, target);
                context.queue.submit(Some(encoder.finish()));
                if self.device_failed.load(Ordering::Relaxed) {
                    return Err("the device has failed".into());
                }
                // Only here is it certain that something will be presented: Wayland holds back the next frame until
                // then.
                self.window.pre_present_notify();
                Ok(())
            })
        });
        let present = uploaded.elapsed();
        let outcome = Outcome::of(rendered.as_ref(), self.device_failed.load(Ordering::Relaxed));
        let again = match self.recovery.after(outcome) {
            Remedy::Nothing => None,
            Remedy::Again(wait) => Some(wait),
            Remedy::Renew(wait) => {
                // Where this fails, too, there is nothing to present on the next time.
                self.failure = self.renew().err();
                Some(wait)
            }
            Remedy::GiveUp => return Err(self.give_up(outcome, rendered.and_then(Result::err))),
        };
        Ok(Presented { upload: uploaded - start, present, again })
    }

    fn give_up(&mut self, outcome: Outcome, error: Option<pixels::Error>) -> WindowError {
        if outcome == Outcome::OutOfMemory {
            let PhysicalSize { width, height } = self.size;
            return WindowError::GraphicsMemory { width, height };
        }
        let error = self.failure.take().or(error);
        let reason = error.map_or_else(|| "it fails again and again".to_owned(), |error| error.to_string());
        WindowError::DeviceLost { reason }
    }
}

fn too_large(size: PhysicalSize<u32>) -> WindowError {
    WindowError::TooLarge { width: size.width, height: size.height }
}
