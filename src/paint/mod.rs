//! Painting: a simulation becomes a pixmap, by tiny-skia or in its arithmetic.
//!
//! The window, pictures, animations and tests all paint through here. Painting reads the simulation and never moves it.

pub(crate) mod animation;
mod bands;
mod circle;
mod colours;
mod coverage;
mod disc;
mod ink;
mod lines;
mod painter;
mod palette;
mod shapes;
mod spans;
#[cfg(feature = "window")]
pub(crate) mod strokes;
mod target;
#[cfg(feature = "window")]
pub(crate) mod text;
#[cfg(feature = "window")]
pub(crate) mod trails;

use glam::DVec2;
use thiserror::Error;
use tiny_skia::Paint;

pub use animation::{Animation, AnimationError};
pub use colours::{BACKGROUND, BALL, CONTACT, Colour, FIXED};
use disc::Disc;
use lines::Lines;
pub use painter::Painter;
use shapes::Shapes;
use target::Target;
pub use tiny_skia::{Pixmap, PixmapMut};

use crate::simulation::{Ball, Simulation};

/// The most pixels that a picture may have: half a gigabyte.
const MOST_PIXELS: f64 = (1_u64 << 27) as f64;

/// tiny-skia fills no paths of discs of this radius, px, or more: its numbers do not hold them.
const LARGEST_PATH: f64 = 1e4;

/// A picture that is too large to paint, or has no size.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error(
    "a picture of {width}x{height} px has no pixels, or takes too much memory; ask for at most {MOST_PIXELS} px in all, and at \
     least 1x1 px"
)]
pub struct PictureTooLarge {
    /// Its width, px.
    width: f64,
    /// Its height, px.
    height: f64,
}

/// A picture of the whole world, one pixel a px.
///
/// # Errors
/// [`PictureTooLarge`] where the world has more pixels than memory should hold.
pub fn picture(simulation: &Simulation) -> Result<Pixmap, PictureTooLarge> {
    let mut pixmap = blank(simulation.world().size())?;
    paint(simulation, 1.0, &mut pixmap.as_mut());
    Ok(pixmap)
}

/// A transparent pixmap of `size` px, rounded up.
///
/// # Errors
/// [`PictureTooLarge`] where it has more pixels than memory should hold, or none.
pub fn blank(size: DVec2) -> Result<Pixmap, PictureTooLarge> {
    let size = size.ceil();
    let too_large = PictureTooLarge { width: size.x, height: size.y };
    if size.x * size.y > MOST_PIXELS {
        return Err(too_large);
    }
    Pixmap::new(size.x as u32, size.y as u32).ok_or(too_large)
}

/// Paints the background and every ball, antialiased, in the simulation's order: a later ball lies over an earlier one.
/// `scale` is the number of pixels per px of the world. Who paints more than one picture keeps a [`Painter`].
pub fn paint(simulation: &Simulation, scale: f64, pixmap: &mut PixmapMut<'_>) {
    Painter::default().paint(simulation, scale, pixmap);
}

/// Fills an antialiased disc, of centre and radius in px; by tiny-skia's own rasteriser, but where it is so large that this would not
/// do. There is nothing of it outside of the picture, nor where a number is none.
pub fn fill_disc(pixmap: &mut PixmapMut<'_>, centre: DVec2, radius: f64, colour: Colour) {
    let disc = Disc { centre, radius, colour };
    if !disc.is_inside(DVec2::new(pixmap.width().into(), pixmap.height().into())) {
        return;
    }
    if radius < LARGEST_PATH {
        return circle::fill_disc(pixmap, centre, radius, colour);
    }
    let (mut shapes, width) = (Shapes::default(), pixmap.width() as usize);
    shapes.prepare(&disc);
    let (pixels, _) = pixmap.data_mut().as_chunks_mut();
    shapes.paint_one(&disc, &mut Lines::default(), &mut Target::rows(pixels, width, 0));
}

/// The colour of a ball.
fn colour(ball: &Ball, touching: bool) -> Colour {
    if ball.is_fixed() {
        FIXED
    } else if touching {
        CONTACT
    } else {
        BALL
    }
}

impl Colour {
    /// A solid, antialiased paint of this colour.
    pub(crate) fn paint(self) -> Paint<'static> {
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        paint.set_color(self.into());
        paint
    }
}
