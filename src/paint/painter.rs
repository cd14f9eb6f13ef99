//! The painter: what it painted last tells what need not be painted again.

use glam::DVec2;
use tiny_skia::PixmapMut;

use super::bands::Bands;
use super::colour;
use super::disc::Disc;
use super::shapes::Shapes;
use super::target::{Area, Target};
use crate::simulation::Simulation;

/// Paints simulations, and keeps from picture to picture what painting them takes.
///
/// ```
/// use carom::Scene;
/// use carom::paint::{Painter, blank};
///
/// let mut simulation = Scene::load("gravity")?.build()?;
/// let mut picture = blank(simulation.world().size())?;
/// let mut painter = Painter::default();
/// painter.paint(&simulation, 1.0, &mut picture.as_mut());
/// assert!(!painter.repaint(&simulation, 1.0, &mut picture.as_mut()), "nothing has moved");
/// simulation.advance(1.0)?;
/// assert!(painter.repaint(&simulation, 1.0, &mut picture.as_mut()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct Painter {
    shapes: Shapes,
    bands: Bands,
    /// What was painted last, in order, and the size of that picture; no size where the picture is not known any more.
    discs: Vec<Disc>,
    size: Option<(u32, u32)>,
    /// What is to be painted.
    next: Vec<Disc>,
}

/// With more discs that have changed than this, all is painted anew.
const MOST_CHANGED: usize = 64;
/// The most comparisons of a changed place with a disc.
const MOST_COMPARED: usize = 1 << 16;

impl Painter {
    /// Paints the background and every ball, antialiased, in the simulation's order: a later ball lies over an earlier
    /// one. `scale` is the number of pixels per px of the world.
    pub fn paint(&mut self, simulation: &Simulation, scale: f64, pixmap: &mut PixmapMut<'_>) {
        self.forget();
        self.repaint(simulation, scale, pixmap);
    }

    /// Paints as [`paint`](Self::paint) does, on another pixmap than that which is painted again and again: what is known
    /// of that one still stands.
    pub fn paint_aside(&mut self, simulation: &Simulation, scale: f64, pixmap: &mut PixmapMut<'_>) {
        let width = pixmap.width() as usize;
        self.read(simulation, scale, (pixmap.width(), pixmap.height()));
        let (pixels, _) = pixmap.data_mut().as_chunks_mut();
        self.bands.paint(&self.next, &self.shapes, pixels, width);
    }

    /// Paints as [`paint`](Self::paint) does, on a pixmap that this painter painted last and nobody has changed since:
    /// only what differs, and nothing, which it tells, where nothing does.
    pub fn repaint(&mut self, simulation: &Simulation, scale: f64, pixmap: &mut PixmapMut<'_>) -> bool {
        let size = (pixmap.width(), pixmap.height());
        if !self.would_change(simulation, scale, size) {
            return false;
        }
        let known = self.size.replace(size) == Some(size);
        let changed = if known { self.changed(size) } else { None };
        std::mem::swap(&mut self.discs, &mut self.next);
        let width = size.0 as usize;
        let (pixels, _) = pixmap.data_mut().as_chunks_mut();
        let Some(areas) = changed else {
            self.bands.paint(&self.discs, &self.shapes, pixels, width);
            return true;
        };
        for area in areas {
            let discs = self.discs.iter().filter(|disc| !disc.area().intersection(area).is_empty());
            let all = Target::rows(pixels, width, 0);
            self.shapes.paint(discs, Target { clip: all.clip.intersection(area), ..all });
        }
        true
    }

    /// Whether the simulation would look other than it was painted last, in a picture of this size, px.
    pub fn would_change(&mut self, simulation: &Simulation, scale: f64, size: (u32, u32)) -> bool {
        self.read(simulation, scale, size);
        self.size != Some(size) || self.next != self.discs
    }

    /// Takes note that the pixmap painted last is not as it was: the next is painted as a whole.
    pub fn forget(&mut self) {
        self.size = None;
    }

    /// Lists the discs that can be seen.
    fn read(&mut self, simulation: &Simulation, scale: f64, size: (u32, u32)) {
        let size = DVec2::new(size.0.into(), size.1.into());
        self.next.clear();
        for (ball, &touching) in simulation.balls().iter().zip(simulation.touching()) {
            let (centre, radius) = (ball.position() * scale, ball.radius() * scale);
            let disc = Disc { centre, radius, colour: colour(ball, touching) };
            if disc.is_inside(size) {
                self.shapes.prepare(&disc);
                self.next.push(disc);
            }
        }
    }

    /// The areas in which the picture differs from that before, unless they are too many or too large to be worth it.
    fn changed(&self, size: (u32, u32)) -> Option<Vec<Area>> {
        let picture = Area { left: 0, top: 0, right: size.0 as i32, bottom: size.1 as i32 };
        let count = self.discs.len().max(self.next.len());
        let most = MOST_CHANGED.min(MOST_COMPARED / count.max(1));
        let mut areas = Vec::new();
        for index in 0..count {
            let (before, now) = (self.discs.get(index), self.next.get(index));
            if before == now {
                continue;
            }
            let area = |disc: Option<&Disc>| disc.map(|disc| disc.area().intersection(picture));
            match (area(before), area(now)) {
                (Some(before), Some(now)) if before.around(now).count() > before.count() + now.count() => {
                    areas.extend([before, now]);
                }
                (Some(before), Some(now)) => areas.push(before.around(now)),
                (before, now) => areas.extend(before.or(now)),
            }
            if areas.len() > most {
                return None;
            }
        }
        let pixels: u64 = areas.iter().map(|area| area.count()).sum();
        (pixels < picture.count() / 2).then_some(areas)
    }
}
