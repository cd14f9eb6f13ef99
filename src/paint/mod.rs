//! Painting: a simulation becomes a pixmap, by tiny-skia.
//!
//! The window, pictures, animations and tests all paint through here. Painting reads the simulation and never moves it.

mod animation;
mod colours;
#[cfg(feature = "window")]
pub(crate) mod text;

use std::f64::consts::{PI, TAU};

use glam::DVec2;
use thiserror::Error;
use tiny_skia::{FillRule, Paint, Path, PathBuilder, Pixmap, PixmapMut, Transform};

pub use animation::{Animation, AnimationError};
pub use colours::{BACKGROUND, BALL, CONTACT, Colour, FIXED};

use crate::simulation::Simulation;

/// The most pixels that a picture may have: half a gigabyte.
const MOST_PIXELS: f64 = (1_u64 << 27) as f64;

/// A picture that is too large to paint.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error(
    "a picture of {width}x{height} px takes too much memory; give a smaller --size, at most {MOST_PIXELS} px in all"
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
/// [`PictureTooLarge`] where it has more pixels than memory should hold.
pub fn blank(size: DVec2) -> Result<Pixmap, PictureTooLarge> {
    let size = size.ceil();
    let too_large = PictureTooLarge { width: size.x, height: size.y };
    if size.x * size.y > MOST_PIXELS {
        return Err(too_large);
    }
    Pixmap::new(size.x as u32, size.y as u32).ok_or(too_large)
}

/// Paints the background and every ball, antialiased, in the simulation's order: a later ball lies over an earlier one.
/// `scale` is the number of pixels per px of the world.
pub fn paint(simulation: &Simulation, scale: f64, pixmap: &mut PixmapMut<'_>) {
    pixmap.fill(BACKGROUND.into());
    for (ball, &touching) in simulation.balls().iter().zip(simulation.touching()) {
        let colour = if ball.is_fixed() {
            FIXED
        } else if touching {
            CONTACT
        } else {
            BALL
        };
        disc(pixmap, ball.position() * scale, ball.radius() * scale, colour);
    }
}

/// Fills an antialiased disc; nothing where it lies outside of the picture.
pub(crate) fn disc(pixmap: &mut PixmapMut<'_>, centre: DVec2, radius: f64, colour: Colour) {
    let size = DVec2::new(f64::from(pixmap.width()), f64::from(pixmap.height()));
    // Written so that a NaN is outside.
    let inside = (centre + radius).cmpgt(DVec2::ZERO) & (centre - radius).cmplt(size);
    if !inside.all() {
        return;
    }
    if let Some(path) = circle(centre, radius) {
        pixmap.fill_path(&path, &colour.paint(), FillRule::Winding, Transform::identity(), None);
    }
}

/// How far a circle's polygon may leave the circle, px; farther only for circles that no screen holds.
const SAGITTA: f64 = 0.05;

/// A circle as a polygon of the same area, for tiny-skia to fill.
///
/// tiny-skia's own circle is flattened so coarsely that a disc of 10 px loses 2 % of its area; this one, in about the
/// same time, less than 0.2 %.
fn circle(centre: DVec2, radius: f64) -> Option<Path> {
    // A chord over the angle 2h leaves the circle by r(1 − cos h) ≈ rh²/2.
    let sides = (PI * (radius / (2.0 * SAGITTA)).sqrt()).clamp(16.0, 1024.0).ceil();
    let angle = TAU / sides;
    let turn = DVec2::from_angle(angle);
    // The polygon's area is n/2·R² sin(2π/n), the circle's πr².
    let mut corner = DVec2::new(radius * (angle / turn.y).sqrt(), 0.0);
    let mut path = PathBuilder::new();
    for side in 0..sides as u32 {
        let at = centre + corner;
        let (x, y) = (at.x as f32, at.y as f32);
        if side == 0 {
            path.move_to(x, y);
        } else {
            path.line_to(x, y);
        }
        corner = turn.rotate(corner);
    }
    path.close();
    path.finish()
}

impl Colour {
    /// A solid, antialiased paint of this colour.
    pub(crate) fn paint(self) -> Paint<'static> {
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        paint.set_color(self.into());
        paint
    }
}
