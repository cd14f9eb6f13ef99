//! Thin antialiased lines, by their distance from each pixel's middle.
//!
//! tiny-skia strokes a path by making an outline of it, which takes as long for a line of three pixels as for a disc.
//! Where hundreds of balls have a ring or a trail each, this takes a tenth of that.

use std::ops::Range;

use glam::DVec2;
use tiny_skia::PixmapMut;

use super::Colour;

/// What a line is drawn with.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pen {
    pub(crate) colour: Colour,
    /// From 0, nothing, to 1, which hides what is below.
    pub(crate) opacity: f64,
    /// Width of the line in pixels.
    pub(crate) width: f64,
}

impl Pen {
    /// A straight line with round ends; all in pixels.
    pub(crate) fn line(self, pixmap: &mut PixmapMut<'_>, from: DVec2, to: DVec2) {
        let size = (pixmap.width(), pixmap.height());
        let (pixels, _) = pixmap.data_mut().as_chunks_mut();
        line(size, (from, to), self.width, |index, _, coverage| self.blend(&mut pixels[index], coverage));
    }

    /// A circle's line, its middle at `radius`; all in pixels.
    pub(crate) fn ring(self, pixmap: &mut PixmapMut<'_>, centre: DVec2, radius: f64) {
        let size = (pixmap.width(), pixmap.height());
        let (pixels, _) = pixmap.data_mut().as_chunks_mut();
        ring(size, centre, radius, self.width, |index, coverage| self.blend(&mut pixels[index], coverage));
    }

    fn blend(self, pixel: &mut [u8; 4], coverage: f64) {
        let part = coverage * self.opacity.clamp(0.0, 1.0);
        let Colour(red, green, blue) = self.colour;
        for (below, above) in pixel.iter_mut().zip([red, green, blue, 255]) {
            *below = (f64::from(*below) + part * (f64::from(above) - f64::from(*below)) + 0.5) as u8;
        }
    }
}

/// Calls `plot` with each pixel, by its index in a picture of `size` px, that a line with round ends covers: how far
/// along the line the pixel is (0 to 1), and how much of it is covered (0 to 1).
pub(super) fn line(
    size: (u32, u32),
    (from, to): (DVec2, DVec2),
    width: f64,
    mut plot: impl FnMut(usize, f64, f64),
) {
    if !(from.is_finite() && to.is_finite() && width > 0.0) {
        return;
    }
    let along = to - from;
    let per_square = if along == DVec2::ZERO { 0.0 } else { along.length_squared().recip() };
    let reach = width / 2.0 + 0.5;
    let (low, high) = (from.min(to) - reach, from.max(to) + reach);
    // Lines narrower than a pixel are drawn as wide as one, and fainter by as much.
    let faint = width.min(1.0);
    for y in cells(low.y, high.y, size.1) {
        let middle = f64::from(y) + 0.5;
        let (mut left, mut right) = (low.x, high.x);
        if along.y.abs() * (high.x - low.x) > reach * along.length() {
            // Where the infinitely long line, as wide as `reach` on both sides, crosses this row.
            let at = from.x + (middle - from.y) / along.y * along.x;
            let half = reach * along.length() / along.y.abs();
            (left, right) = (left.max(at - half), right.min(at + half));
        }
        for x in cells(left, right, size.0) {
            let behind = DVec2::new(f64::from(x) + 0.5, middle) - from;
            let part = (behind.dot(along) * per_square).clamp(0.0, 1.0);
            let distance = (behind - part * along).length();
            let coverage = (width.max(1.0) / 2.0 + 0.5 - distance).min(1.0);
            if coverage > 0.0 {
                plot((y * size.0 + x) as usize, part, coverage * faint);
            }
        }
    }
}

/// Calls `plot` with each pixel, by its index in a picture of `size` px, that a ring covers whose line has its middle
/// at `radius`, and how much of the pixel is covered (0 to 1).
fn ring(size: (u32, u32), centre: DVec2, radius: f64, width: f64, mut plot: impl FnMut(usize, f64)) {
    if !(centre.is_finite() && radius.is_finite() && width > 0.0) {
        return;
    }
    let faint = width.min(1.0);
    let half = width.max(1.0) / 2.0 + 0.5;
    let (outer, inner) = (radius + half, (radius - half).max(0.0));
    for y in cells(centre.y - outer, centre.y + outer, size.1) {
        let down = f64::from(y) + 0.5 - centre.y;
        let reach = |radius: f64| (radius * radius - down * down).max(0.0).sqrt();
        let (out, hole) = (reach(outer), reach(inner));
        let row = cells(centre.x - out, centre.x + out, size.0);
        // The hole's pixels, whose middles lie within.
        let hole = if hole > 1.0 {
            cells(centre.x - hole + 1.0, centre.x + hole - 1.0, size.0)
        } else {
            row.end..row.end
        };
        for x in (row.start..hole.start.clamp(row.start, row.end))
            .chain(hole.end.clamp(row.start, row.end)..row.end)
        {
            let distance = DVec2::new(f64::from(x) + 0.5 - centre.x, down).length() - radius;
            let coverage = (half - distance.abs()).min(1.0);
            if coverage > 0.0 {
                plot((y * size.0 + x) as usize, coverage * faint);
            }
        }
    }
}

/// The pixels from `low` to `high` on an axis of so many.
fn cells(low: f64, high: f64, count: u32) -> Range<u32> {
    // Casts keep what is outside of the picture at its borders.
    let start = (low.floor() as u32).min(count);
    start..(high.ceil() as u32).clamp(start, count)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use tiny_skia::{Color, LineCap, PathBuilder, Pixmap, Stroke, Transform};

    use super::super::circle::fill_disc;
    use super::super::{BACKGROUND, BALL};
    use super::*;

    const SIZE: u32 = 100;

    fn pen(width: f64) -> Pen {
        Pen { colour: BALL, opacity: 1.0, width }
    }

    fn blank() -> Pixmap {
        let mut pixmap = Pixmap::new(SIZE, SIZE).unwrap();
        pixmap.fill(BACKGROUND.into());
        pixmap
    }

    /// How much is covered by the pen's colour, px².
    fn area(pixmap: &Pixmap) -> f64 {
        let (none, whole) = (f64::from(BACKGROUND.1), f64::from(BALL.1));
        pixmap.pixels().iter().map(|pixel| (f64::from(pixel.green()) - none) / (whole - none)).sum()
    }

    #[test]
    fn lines_and_rings_have_their_area_wherever_they_lie_between_pixels() {
        for width in [0.5, 1.0, 1.5, 3.0, 6.0] {
            for shift in [DVec2::ZERO, DVec2::new(0.3, 0.8), DVec2::splat(0.5)] {
                let (from, to) = (DVec2::new(20.0, 30.0) + shift, DVec2::new(70.0, 55.0) + shift);
                let mut picture = blank();
                pen(width).line(&mut picture.as_mut(), from, to);
                let whole = width * from.distance(to);
                let error = area(&picture) - whole;
                // Beside its own area, two half discs at the ends, and half a pixel around narrow ones.
                assert!((-0.02 * whole..3.0 + width * width).contains(&error), "{width}: {error} of {whole}");
                for radius in [8.0, 20.4, 41.0] {
                    let mut picture = blank();
                    pen(width).ring(&mut picture.as_mut(), DVec2::splat(50.0) + shift, radius);
                    let whole = 2.0 * PI * radius * width;
                    let error = area(&picture) / whole - 1.0;
                    assert!(error.abs() < 0.02, "r {radius}, {width} px wide: {error}");
                }
            }
        }
    }

    #[test]
    fn a_line_lies_where_tiny_skia_strokes_it() {
        let ends = [
            (5.0, 5.0, 95.0, 20.0),
            (10.0, 90.0, 14.0, 8.0),
            (50.0, 2.0, 50.0, 98.0),
            (-40.0, 50.0, 300.0, 61.0),
        ];
        for (x1, y1, x2, y2) in ends {
            let (mut ours, mut theirs) = (blank(), blank());
            pen(4.0).line(&mut ours.as_mut(), DVec2::new(x1, y1), DVec2::new(x2, y2));
            let mut path = PathBuilder::new();
            path.move_to(x1 as f32, y1 as f32);
            path.line_to(x2 as f32, y2 as f32);
            let stroke = Stroke { width: 4.0, line_cap: LineCap::Round, ..Stroke::default() };
            let path = path.finish().unwrap();
            theirs.stroke_path(&path, &BALL.paint(), &stroke, Transform::identity(), None);
            let pairs = ours.pixels().iter().zip(theirs.pixels());
            let most = pairs.map(|(a, b)| a.green().abs_diff(b.green())).max().unwrap();
            assert!(most < 100, "{most}: less than half of a pixel's step");
        }
    }

    #[test]
    fn a_ring_surrounds_a_disc_and_leaves_its_middle_free() {
        let mut picture = blank();
        let centre = DVec2::new(50.3, 49.8);
        pen(2.0).ring(&mut picture.as_mut(), centre, 30.0);
        let mut covered = picture.clone();
        fill_disc(&mut covered.as_mut(), centre, 32.0, BACKGROUND);
        assert!(area(&covered).abs() < 1.0, "nothing outside");
        let inside = |x: u32, y: u32| DVec2::new(x.into(), y.into()).distance(centre) < 27.5;
        for (x, y) in (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y))).filter(|&(x, y)| inside(x, y)) {
            assert_eq!(picture.pixel(x, y), blank().pixel(x, y), "{x}, {y}");
        }
    }

    #[test]
    fn what_lies_outside_is_cut_off_and_what_is_no_number_leaves_no_mark() {
        let far = [f64::NAN, f64::INFINITY, -1e300, 1e300, -1e6, 1e9];
        for x in far {
            let mut picture = blank();
            pen(2.0).line(&mut picture.as_mut(), DVec2::new(x, -5.0), DVec2::new(x, -9.0));
            pen(2.0).ring(&mut picture.as_mut(), DVec2::new(x, 50.0), 20.0);
            pen(f64::NAN).line(&mut picture.as_mut(), DVec2::ZERO, DVec2::splat(50.0));
            assert_eq!(picture, blank());
        }
        let mut picture = blank();
        pen(2.0).ring(&mut picture.as_mut(), DVec2::new(1e6 + 50.0, 50.0), 1e6);
        let expected = 2.0 * f64::from(SIZE);
        assert!((area(&picture) / expected - 1.0).abs() < 0.02, "an arc of a huge ring crosses the picture");
    }

    #[test]
    fn a_pen_of_half_opacity_shows_half_of_what_is_below() {
        let mut picture = Pixmap::new(SIZE, SIZE).unwrap();
        picture.fill(Color::BLACK);
        let half = Pen { opacity: 0.5, ..pen(6.0) };
        half.line(&mut picture.as_mut(), DVec2::new(10.0, 50.0), DVec2::new(90.0, 50.0));
        assert_eq!(picture.pixel(50, 50).unwrap().green(), 128);
    }
}
