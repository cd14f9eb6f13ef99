//! Animated GIFs whose pace is that of the simulated time.
//!
//! A GIF counts time in hundredths of a second, and browsers slow down anything that is shown for less than two of
//! them; so frames that come sooner are left out, and each of the others is shown until the next by the rounded
//! difference of their absolute times: no error adds up. Only what changed is stored, and the colours are the four of a
//! picture with a few steps between each two for the edges, so files stay small.

use std::io::Write;

use gif::{DisposalMethod, Encoder, Frame, Repeat};
use thiserror::Error;
use tiny_skia::Pixmap;

use super::{BACKGROUND, BALL, CONTACT, Colour, FIXED};

/// Steps between two colours at an antialiased edge.
const EDGE_STEPS: u8 = 16;
/// Steps between the background and the colours of two balls that meet.
const MEETING_STEPS: u8 = 16;
/// The same where one of them is fixed. There is room for fewer, and need: grey is near the background.
const MEETING_STEPS_FIXED: u8 = 8;
/// The index of the colour that leaves a pixel as it was.
const UNCHANGED: u8 = 0;
/// The least time that a frame is shown, in hundredths of a second.
const SHOWN_LEAST: u64 = 2;

/// Why an animation was not written.
#[derive(Debug, Error)]
pub enum AnimationError {
    /// GIF counts a picture's sides in 16 bits.
    #[error("a GIF has at most 65535x65535 px, not {width}x{height}; give a smaller --size")]
    TooLarge {
        /// The width asked for, px.
        width: u32,
        /// The height asked for, px.
        height: u32,
    },
    /// It could not be encoded or written.
    #[error(transparent)]
    Encoding(#[from] gif::EncodingError),
}

/// A GIF being written, frame by frame; it loops for ever when shown.
pub struct Animation<W: Write> {
    encoder: Encoder<W>,
    palette: Palette,
    width: u16,
    /// The picture as it is when all frames so far are shown.
    shown: Vec<u8>,
    /// The frame that waits to be told how long it is shown, and when it began.
    waiting: Option<(Frame<'static>, u64)>,
}

impl<W: Write> Animation<W> {
    /// Begins an animation of `width`×`height` px.
    ///
    /// # Errors
    /// [`AnimationError`] where it is too large or cannot be written.
    pub fn new(writer: W, width: u32, height: u32) -> Result<Self, AnimationError> {
        let side =
            |length: u32| u16::try_from(length).map_err(|_| AnimationError::TooLarge { width, height });
        let palette = Palette::new();
        let mut encoder = Encoder::new(writer, side(width)?, side(height)?, &palette.bytes())?;
        encoder.set_repeat(Repeat::Infinite)?;
        Ok(Self { encoder, palette, width: side(width)?, shown: Vec::new(), waiting: None })
    }

    /// Adds what is seen at `time` seconds, unless it comes too soon after the frame before or equals it.
    ///
    /// # Errors
    /// [`AnimationError::Encoding`] where the frame before cannot be written.
    pub fn add(&mut self, time: f64, pixmap: &Pixmap) -> Result<(), AnimationError> {
        let now = (time * 100.0).round() as u64;
        if self.waiting.as_ref().is_some_and(|&(_, since)| now < since + SHOWN_LEAST) {
            return Ok(());
        }
        let indices = self.palette.indices(pixmap);
        let Some(frame) = self.difference(&indices) else { return Ok(()) };
        self.write_waiting(now)?;
        self.shown = indices;
        self.waiting = Some((frame, now));
        Ok(())
    }

    /// Ends the animation at `time` seconds and gives the writer back.
    ///
    /// # Errors
    /// [`AnimationError::Encoding`] where the last frame cannot be written.
    pub fn finish(mut self, time: f64) -> Result<W, AnimationError> {
        self.write_waiting((time * 100.0).round() as u64)?;
        Ok(self.encoder.into_inner()?)
    }

    fn write_waiting(&mut self, until: u64) -> Result<(), AnimationError> {
        if let Some((mut frame, since)) = self.waiting.take() {
            let mut left = until.saturating_sub(since).max(SHOWN_LEAST);
            // A frame is shown for at most eleven minutes; another that changes nothing goes on from there.
            while left > u64::from(u16::MAX) {
                frame.delay = u16::MAX - SHOWN_LEAST as u16;
                left -= u64::from(frame.delay);
                self.encoder.write_frame(&frame)?;
                let (width, height, buffer) = (1, 1, vec![UNCHANGED].into());
                frame = Frame { width, height, buffer, transparent: Some(UNCHANGED), ..Frame::default() };
            }
            frame.delay = left as u16;
            self.encoder.write_frame(&frame)?;
        }
        Ok(())
    }

    /// The smallest frame that turns what is shown into `indices`; `None` where they are the same.
    fn difference(&self, indices: &[u8]) -> Option<Frame<'static>> {
        let width = usize::from(self.width);
        let rows = || indices.chunks_exact(width).zip(self.shown.chunks_exact(width));
        if self.shown.is_empty() {
            let height = (indices.len() / width) as u16;
            return Some(Frame {
                width: self.width,
                height,
                buffer: indices.to_vec().into(),
                ..Frame::default()
            });
        }
        let changed = |(new, old): (&[u8], &[u8])| new != old;
        let top = rows().position(changed)?;
        let bottom = indices.len() / width - rows().rev().position(changed)?;
        let (mut left, mut right) = (width, 0);
        for (new, old) in rows().take(bottom).skip(top) {
            let differs = |(a, b): (&u8, &u8)| a != b;
            if let Some(first) = new.iter().zip(old).position(differs) {
                left = left.min(first);
                right = right.max(width - new.iter().zip(old).rev().position(differs).unwrap_or(0));
            }
        }
        let mut buffer = Vec::with_capacity((bottom - top) * (right - left));
        for (new, old) in rows().take(bottom).skip(top) {
            let pixels = new[left..right].iter().zip(&old[left..right]);
            buffer.extend(pixels.map(|(&new, &old)| if new == old { UNCHANGED } else { new }));
        }
        Some(Frame {
            left: left as u16,
            top: top as u16,
            width: (right - left) as u16,
            height: (bottom - top) as u16,
            dispose: DisposalMethod::Keep,
            transparent: Some(UNCHANGED),
            buffer: buffer.into(),
            ..Frame::default()
        })
    }
}

/// The colours of an animation: the four of a picture, exactly, steps between each two, and between the background and
/// each two others, for where the edges of two balls meet.
struct Palette {
    /// Index 0 is [`UNCHANGED`], whose colour is never seen.
    colours: Vec<Colour>,
    /// The nearest colour for the upper five bits of red, green and blue.
    nearest: Vec<u8>,
}

impl Palette {
    fn new() -> Self {
        let mut colours = vec![BACKGROUND, BACKGROUND, BALL, CONTACT, FIXED];
        for (from, to) in [
            (BACKGROUND, BALL),
            (BACKGROUND, CONTACT),
            (BALL, CONTACT),
            (BACKGROUND, FIXED),
            (BALL, FIXED),
            (CONTACT, FIXED),
        ] {
            let part = |step| f64::from(step) / f64::from(EDGE_STEPS);
            colours.extend((1..EDGE_STEPS).map(|step| from.towards(to, part(step))));
        }
        for (one, other, steps) in [
            (BALL, CONTACT, MEETING_STEPS),
            (BALL, FIXED, MEETING_STEPS_FIXED),
            (CONTACT, FIXED, MEETING_STEPS_FIXED),
        ] {
            let part = |step| f64::from(step) / f64::from(steps);
            for ones in 1..steps {
                // As much of this as is left when there is some background.
                let edge = |others| BACKGROUND.towards(other, part(others) / (1.0 - part(ones)));
                colours.extend((1..steps - ones).map(|others| edge(others).towards(one, part(ones))));
            }
        }
        let centre = |bits: usize| (bits & 31) as i32 * 8 + 4;
        let nearest = (0..1 << 15).map(|bits: usize| {
            let (red, green, blue) = (centre(bits >> 10), centre(bits >> 5), centre(bits));
            let distance = |&Colour(r, g, b): &Colour| {
                let square = |a: i32, b: u8| (a - i32::from(b)).pow(2);
                square(red, r) + square(green, g) + square(blue, b)
            };
            let best = (1..colours.len()).min_by_key(|&index| distance(&colours[index]));
            best.unwrap_or(1) as u8
        });
        let nearest = nearest.collect();
        Self { colours, nearest }
    }

    fn bytes(&self) -> Vec<u8> {
        self.colours.iter().flat_map(|&Colour(red, green, blue)| [red, green, blue]).collect()
    }

    fn indices(&self, pixmap: &Pixmap) -> Vec<u8> {
        let index = |pixel: &tiny_skia::PremultipliedColorU8| {
            let colour = Colour(pixel.red(), pixel.green(), pixel.blue());
            // The four colours of a picture stay exact; only edges are rounded.
            match colour {
                BACKGROUND => 1,
                BALL => 2,
                CONTACT => 3,
                FIXED => 4,
                Colour(red, green, blue) => {
                    let bits = |value: u8| usize::from(value >> 3);
                    self.nearest[bits(red) << 10 | bits(green) << 5 | bits(blue)]
                }
            }
        };
        pixmap.pixels().iter().map(index).collect()
    }
}
