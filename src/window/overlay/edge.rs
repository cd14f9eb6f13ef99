//! Where the world ends, where that is not where the window does.

use glam::DVec2;
use tiny_skia::PixmapMut;

use crate::paint::strokes::Pen;

use super::sheet::QUIET;

/// Paints the two edges of a world of this size, px, that may be inside of the picture.
pub(super) fn edge(pixmap: &mut PixmapMut<'_>, size: DVec2, scale: f64) {
    let pen = Pen { colour: QUIET, opacity: 0.8, width: scale };
    // As wide as it is, outside of the world.
    let corner = (size * scale).ceil() + scale / 2.0;
    pen.line(pixmap, DVec2::new(corner.x, 0.0), corner);
    pen.line(pixmap, DVec2::new(0.0, corner.y), corner);
}

#[cfg(test)]
mod tests {
    use tiny_skia::Pixmap;

    use super::*;

    #[test]
    fn the_edge_is_a_thin_line_around_the_world() {
        let mut pixmap = Pixmap::new(200, 100).unwrap();
        edge(&mut pixmap.as_mut(), DVec2::new(150.0, 80.0), 1.0);
        let painted = |x: u32, y: u32| pixmap.pixel(x, y).unwrap().alpha() > 0x80;
        assert!(painted(150, 40) && painted(70, 80));
        for (x, y) in [(149, 40), (151, 40), (70, 79), (70, 81), (150, 90), (190, 80)] {
            assert!(!painted(x, y), "{x}, {y}");
        }
    }
}
