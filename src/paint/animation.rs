//! Animated GIFs whose pace is that of the simulated time.
//!
//! A GIF counts time in hundredths of a second, and browsers slow down anything that is shown for less than two of
//! them; so frames that come sooner are left out, and each of the others is shown until the next by the rounded
//! difference of their absolute times: no error adds up. Only what changed is stored, with the colours that are in
//! that.

use std::fmt;
use std::io::Write;

use gif::{DisposalMethod, Encoder, Frame, Repeat};
use thiserror::Error;
use tiny_skia::Pixmap;

use super::ink::Pixel;
use super::palette::Palette;

/// The index of the colour that leaves a pixel as it was.
const UNCHANGED: u8 = 0;
/// The least time that a frame is shown, in hundredths of a second.
const LEAST_SHOWN: u64 = 2;

/// The longest that an animation may last, s: as a run of the longest frame. What stands so long takes fifty kilobytes.
const LONGEST: f64 = 1e6;

/// Why an animation was not written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AnimationError {
    /// GIF counts a picture's sides in 16 bits.
    #[error("a GIF has at most 65535x65535 px, not {width}x{height}; ask for a smaller world")]
    TooLarge {
        /// The width asked for, px.
        width: u32,
        /// The height asked for, px.
        height: u32,
    },
    /// All pictures of an animation are of one size.
    #[error("a picture of {0}x{1} px does not fit into an animation of {2}x{3} px", given.0, given.1, size.0, size.1)]
    OtherSize {
        /// The width and the height of the picture, px.
        given: (u32, u32),
        /// Those of the animation, px.
        size: (u32, u32),
    },
    /// A frame is at no time that an animation may have.
    #[error("a frame at {0} s is not in an animation, which may last from 0 to {LONGEST} s")]
    NoTime(f64),
    /// What is to be seen takes longer, s, than an animation may last.
    #[error(
        "an animation may last {LONGEST} s, and this would last {0}; ask for less time, or for no animation"
    )]
    TooLong(f64),
    /// It could not be encoded or written.
    #[error(transparent)]
    Encoding(#[from] gif::EncodingError),
}

/// Refuses what is no time of an animation, s.
fn check_time(time: f64) -> Result<(), AnimationError> {
    if time >= 0.0 && !is_too_long(time) { Ok(()) } else { Err(AnimationError::NoTime(time)) }
}

/// Whether no animation may last so many seconds. It counts hundredths of them, and what rounding adds to a sum of frames is none.
pub(crate) fn is_too_long(seconds: f64) -> bool {
    hundredths(seconds) > hundredths(LONGEST)
}

/// Whether what is seen at the second of these times, s, comes too soon after the first to be a frame of its own.
pub(crate) fn is_too_soon(before: f64, now: f64) -> bool {
    hundredths(now) < hundredths(before) + LEAST_SHOWN
}

fn hundredths(time: f64) -> u64 {
    (time * 100.0).round() as u64
}

/// A GIF being written, frame by frame; it loops for ever when shown.
pub struct Animation<W: Write> {
    encoder: Encoder<W>,
    palette: Palette,
    size: (u32, u32),
    /// The picture as it was painted when all frames so far are shown; empty before the first.
    shown: Vec<Pixel>,
    /// The frame that waits to be told how long it is shown, and when it began, s.
    waiting: Option<(Frame<'static>, f64)>,
}

impl<W: Write> fmt::Debug for Animation<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Animation").field("size", &self.size).finish_non_exhaustive()
    }
}

impl<W: Write> Animation<W> {
    /// Begins an animation of `width`×`height` px.
    ///
    /// # Errors
    /// [`AnimationError`] where it is too large or cannot be written.
    pub fn new(writer: W, width: u32, height: u32) -> Result<Self, AnimationError> {
        let side =
            |length: u32| u16::try_from(length).map_err(|_| AnimationError::TooLarge { width, height });
        let mut encoder = Encoder::new(writer, side(width)?, side(height)?, &[])?;
        encoder.set_repeat(Repeat::Infinite)?;
        let (palette, shown) = (Palette::default(), Vec::new());
        Ok(Self { encoder, palette, size: (width, height), shown, waiting: None })
    }

    /// Adds what is seen at `time` seconds, a picture of the animation's size, unless it comes too soon after the frame
    /// before or equals it.
    ///
    /// # Errors
    /// [`AnimationError`] where the picture is of another size, the time is none, or the frame before cannot be written.
    pub fn add(&mut self, time: f64, pixmap: &Pixmap) -> Result<(), AnimationError> {
        check_time(time)?;
        let (given, size) = ((pixmap.width(), pixmap.height()), self.size);
        if given != size {
            return Err(AnimationError::OtherSize { given, size });
        }
        if self.waiting.as_ref().is_some_and(|&(_, since)| is_too_soon(since, time)) {
            return Ok(());
        }
        let (pixels, _) = pixmap.data().as_chunks();
        let Some(frame) = self.difference(pixels) else { return Ok(()) };
        self.write_waiting(time)?;
        self.waiting = Some((frame, time));
        Ok(())
    }

    /// Ends the animation at `time` seconds and gives the writer back.
    ///
    /// # Errors
    /// [`AnimationError`] where the time is none, or the last frame cannot be written.
    pub fn finish(mut self, time: f64) -> Result<W, AnimationError> {
        check_time(time)?;
        self.write_waiting(time)?;
        Ok(self.encoder.into_inner()?)
    }

    /// Writes the frame that waits, if any, which is shown `until` a time, s.
    fn write_waiting(&mut self, until: f64) -> Result<(), AnimationError> {
        if let Some((mut frame, since)) = self.waiting.take() {
            let mut left = hundredths(until).saturating_sub(hundredths(since)).max(LEAST_SHOWN);
            // A frame is shown for at most eleven minutes; another that changes nothing goes on from there.
            while left > u64::from(u16::MAX) {
                frame.delay = u16::MAX - LEAST_SHOWN as u16;
                left -= u64::from(frame.delay);
                self.encoder.write_frame(&frame)?;
                frame = Frame {
                    width: 1,
                    height: 1,
                    buffer: vec![UNCHANGED].into(),
                    palette: Some(vec![0; 3]),
                    transparent: Some(UNCHANGED),
                    ..Frame::default()
                };
            }
            frame.delay = left as u16;
            self.encoder.write_frame(&frame)?;
        }
        Ok(())
    }

    /// The smallest frame that turns what is shown into `pixels`, which count as shown from then on; `None` where they
    /// are the same.
    fn difference(&mut self, pixels: &[Pixel]) -> Option<Frame<'static>> {
        let width = self.size.0 as usize;
        let first = self.shown.is_empty();
        if first {
            // None of these is opaque, so that all pixels of a picture have changed.
            self.shown.resize(pixels.len(), [0; 4]);
        }
        let (left, top, right, bottom) = changed(pixels, &self.shown, width)?;
        let rows = || (top..bottom).map(|row| row * width + left..row * width + right);
        let Self { palette, shown, .. } = self;
        palette.clear();
        for row in rows() {
            count(palette, &pixels[row.clone()], &shown[row]);
        }
        let colours = palette.reduce();
        let mut buffer = Vec::with_capacity((bottom - top) * (right - left));
        for row in rows() {
            let (new, old) = (&pixels[row.clone()], &mut shown[row]);
            let index =
                |(new, old): (&Pixel, &Pixel)| if new == old { UNCHANGED } else { 1 + palette.find(*new) };
            buffer.extend(new.iter().zip(&*old).map(index));
            old.copy_from_slice(new);
        }
        Some(Frame {
            left: left as u16,
            top: top as u16,
            width: (right - left) as u16,
            height: (bottom - top) as u16,
            dispose: DisposalMethod::Keep,
            transparent: Some(UNCHANGED),
            palette: Some([&[[0; 3]], &*colours].concat().as_flattened().to_vec()),
            buffer: buffer.into(),
            ..Frame::default()
        })
    }
}

/// The smallest rectangle around all pixels in which two pictures of this width differ: left, top, right, bottom.
fn changed(new: &[Pixel], old: &[Pixel], width: usize) -> Option<(usize, usize, usize, usize)> {
    let rows = || new.chunks_exact(width).zip(old.chunks_exact(width));
    let differs = |(new, old): (&[Pixel], &[Pixel])| new != old;
    let top = rows().position(differs)?;
    let bottom = new.len() / width - rows().rev().position(differs)?;
    let (mut left, mut right) = (width, 0);
    for (new, old) in rows().take(bottom).skip(top) {
        let pixels = || new.iter().zip(old);
        if let Some(first) = pixels().take(left).position(|(new, old)| new != old) {
            left = first;
        }
        if let Some(last) = pixels().skip(right).rposition(|(new, old)| new != old) {
            right += last + 1;
        }
    }
    Some((left, top, right, bottom))
}

/// Counts the colours of the pixels that differ, in runs of one colour.
fn count(palette: &mut Palette, new: &[Pixel], old: &[Pixel]) {
    let (mut run, mut length) = ([0; 4], 0);
    for (&pixel, _) in new.iter().zip(old).filter(|(new, old)| new != old) {
        if pixel == run {
            length += 1;
            continue;
        }
        if length > 0 {
            palette.count(run, length);
        }
        (run, length) = (pixel, 1);
    }
    if length > 0 {
        palette.count(run, length);
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use gif::{ColorOutput, DecodeOptions};
    use glam::DVec2;
    use tiny_skia::{Color, Paint, PremultipliedColorU8, Rect, Transform};

    use super::*;
    use crate::paint::{BACKGROUND, BALL, CONTACT, Colour, FIXED, fill_disc, paint};
    use crate::simulation::{Ball, Pairs, Simulation, Solver, World};

    /// The pictures of a GIF as they are seen, and for how long each, in hundredths of a second.
    pub(crate) fn decode(bytes: &[u8]) -> Vec<(Pixmap, u16)> {
        let mut options = DecodeOptions::new();
        options.set_color_output(ColorOutput::RGBA);
        let mut decoder = options.read_info(bytes).unwrap();
        let mut seen = Pixmap::new(decoder.width().into(), decoder.height().into()).unwrap();
        let mut pictures = Vec::new();
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            let width = seen.width() as usize;
            let (pixels, _) = seen.data_mut().as_chunks_mut::<4>();
            let (buffer, _) = frame.buffer.as_chunks::<4>();
            for (row, new) in buffer.chunks_exact(frame.width.into()).enumerate() {
                let start = (usize::from(frame.top) + row) * width + usize::from(frame.left);
                let old = &mut pixels[start..start + new.len()];
                old.iter_mut().zip(new).filter(|(_, new)| new[3] > 0).for_each(|(old, new)| *old = *new);
            }
            pictures.push((seen.clone(), frame.delay));
        }
        pictures
    }

    fn animate(pictures: &[(f64, Pixmap)], end: f64) -> Vec<(Pixmap, u16)> {
        let (width, height) = (pictures[0].1.width(), pictures[0].1.height());
        let mut animation = Animation::new(Vec::new(), width, height).unwrap();
        for (time, picture) in pictures {
            animation.add(*time, picture).unwrap();
        }
        decode(&animation.finish(end).unwrap())
    }

    fn plain(colour: Colour) -> Pixmap {
        let mut pixmap = Pixmap::new(8, 6).unwrap();
        pixmap.fill(colour.into());
        pixmap
    }

    /// The largest difference of a channel between two pictures.
    fn difference(one: &Pixmap, other: &Pixmap) -> u8 {
        one.data().iter().zip(other.data()).map(|(&a, &b)| a.abs_diff(b)).max().unwrap()
    }

    fn is(pixel: PremultipliedColorU8, Colour(red, green, blue): Colour) -> bool {
        [pixel.red(), pixel.green(), pixel.blue(), pixel.alpha()] == [red, green, blue, 255]
    }

    /// Whether the whole picture has this colour.
    fn is_plain(pixmap: &Pixmap, colour: Colour) -> bool {
        pixmap.pixels().iter().all(|&pixel| is(pixel, colour))
    }

    /// Balls of each colour that meet, some under trails that fade, half of it under a sheet with an amber edge.
    fn crowded_picture(step: u32) -> Pixmap {
        let world = World::new(DVec2::new(320.0, 200.0)).unwrap().with_pairs(Pairs::Detect);
        let ball = |x: f64, y: f64| Ball::new(DVec2::new(x + f64::from(step), y), 19.7).unwrap();
        let at = [(30.0, 40.0), (60.0, 50.0), (195.0, 50.0), (225.0, 65.0), (290.0, 20.0), (180.0, 100.0)];
        let mut balls: Vec<Ball> = at.map(|(x, y)| ball(x, y)).into();
        balls.push(ball(265.0, 45.0).fixed());
        let mut simulation = Simulation::new(world, balls, Solver::Canvas).unwrap();
        simulation.advance(0.0).unwrap();
        let mut picture = Pixmap::new(320, 200).unwrap();
        paint(&simulation, 1.0, &mut picture.as_mut());
        for (row, colour) in
            [BALL, CONTACT, Colour(0xe0, 0xa0, 0x30), Colour(0xe0, 0x40, 0x40)].into_iter().enumerate()
        {
            for part in 0..100_u8 {
                let Colour(red, green, blue) = colour;
                let faded = Color::from_rgba8(red, green, blue, 2 * part);
                let x = f32::from(part) * 3.0 + step as f32;
                fill(&mut picture, x, 100.0 + 8.0 * row as f32, 3.0, 6.0, faded);
            }
        }
        fill(&mut picture, 0.0, 0.0, 170.0, 160.0, Color::from_rgba8(0x0c, 0x0c, 0x0c, 225));
        fill(&mut picture, 0.0, 160.0, 320.0, 3.0, Color::from_rgba8(0xe0, 0xa0, 0x30, 255));
        for letter in 0..20 {
            let at = DVec2::new(8.0 + 7.3 * f64::from(letter), 150.0);
            fill_disc(&mut picture.as_mut(), at, 2.6, Colour(0xe6, 0xe6, 0xe6));
        }
        picture
    }

    fn fill(picture: &mut Pixmap, x: f32, y: f32, width: f32, height: f32, colour: Color) {
        let mut paint = Paint::default();
        paint.set_color(colour);
        let rect = Rect::from_xywh(x, y, width, height).unwrap();
        picture.fill_rect(rect, &paint, Transform::identity(), None);
    }

    #[test]
    fn what_is_seen_is_what_was_painted_but_for_steps_too_small_to_see() {
        let painted: Vec<_> =
            (0..4).map(|step| (f64::from(step) / 25.0, crowded_picture(7 * step))).collect();
        let seen = animate(&painted, 1.0);
        assert_eq!(seen.len(), 4);
        for ((_, painted), (seen, _)) in painted.iter().zip(&seen) {
            let furthest = difference(painted, seen);
            assert!(furthest <= 12, "a channel is {furthest} of 255 off");
            for colour in [BACKGROUND, BALL, CONTACT, FIXED] {
                let pairs = || painted.pixels().iter().zip(seen.pixels());
                let of_it = || pairs().filter(|(painted, _)| is(**painted, colour));
                assert!(of_it().count() > 100 && of_it().all(|(_, seen)| is(*seen, colour)), "{colour:?}");
            }
        }
    }

    #[test]
    fn pictures_of_any_colours_are_kept_as_well_as_255_of_them_can() {
        let mut noise = Pixmap::new(256, 256).unwrap();
        for (index, pixel) in noise.data_mut().as_chunks_mut().0.iter_mut().enumerate() {
            *pixel = [index as u8, (index >> 8) as u8, ((7 * index) >> 3) as u8, 255];
        }
        let seen = animate(&[(0.0, noise.clone())], 1.0);
        let furthest = difference(&noise, &seen[0].0);
        // Colours that are kept lie so far apart that balls around 256 of them would not fit into the cube of all
        // colours: at most 62 of 255. The distance that is tried is up to √2 times as far, and a colour counts as one 3
        // away.
        assert!((1..=91).contains(&furthest), "{furthest}");
    }

    #[test]
    fn each_picture_is_shown_until_the_next_that_differs() {
        let times =
            [(0.0, BALL), (0.1, CONTACT), (0.25, CONTACT), (0.33, BALL), (0.337, FIXED), (0.35, FIXED)];
        let painted = times.map(|(time, colour)| (time, plain(colour)));
        let seen = animate(&painted, 1.0);
        let shown: Vec<_> = seen.iter().map(|(_, delay)| *delay).collect();
        assert_eq!(shown, [10, 23, 2, 65], "0.337 s is too soon after 0.33 s");
        for ((picture, _), colour) in seen.iter().zip([BALL, CONTACT, BALL, FIXED]) {
            assert!(is_plain(picture, colour));
        }
    }

    #[test]
    fn a_picture_that_stands_for_hours_does() {
        let seen = animate(&[(0.5, plain(BALL)), (7200.5, plain(CONTACT))], 7201.0);
        let ball: u32 =
            seen.iter().filter(|(seen, _)| is_plain(seen, BALL)).map(|(_, delay)| u32::from(*delay)).sum();
        assert_eq!((ball, seen.last().unwrap().1), (720_000, 50));
    }

    #[test]
    fn a_picture_of_another_size_and_a_time_that_is_none_are_refused_and_leave_the_animation_as_it_was() {
        let mut animation = Animation::new(Vec::new(), 8, 6).unwrap();
        animation.add(0.0, &plain(BALL)).unwrap();
        for (width, height) in [(4, 6), (8, 5), (8, 7), (1, 1), (6, 8)] {
            let refused = animation.add(0.1, &Pixmap::new(width, height).unwrap());
            let words = format!("a picture of {width}x{height} px does not fit into an animation of 8x6 px");
            assert_eq!(refused.unwrap_err().to_string(), words);
        }
        for time in [f64::NAN, f64::INFINITY, -1.0, 1e7] {
            assert!(matches!(animation.add(time, &plain(CONTACT)), Err(AnimationError::NoTime(_))), "{time}");
            let other = Animation::new(Vec::new(), 8, 6).unwrap();
            assert!(matches!(other.finish(time), Err(AnimationError::NoTime(_))), "{time}");
        }
        let seen = decode(&animation.finish(0.5).unwrap());
        assert!(seen.len() == 1 && is_plain(&seen[0].0, BALL) && seen[0].1 == 50);
    }

    #[test]
    fn a_picture_too_wide_for_a_gif_is_refused() {
        let error = Animation::new(Vec::new(), 65_536, 1).map(drop).unwrap_err().to_string();
        assert!(error.contains("65535x65535 px, not 65536x1"), "{error}");
    }
}
