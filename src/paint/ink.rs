//! A colour on pixels: filled where a disc covers them whole, blended at its edge, with tiny-skia's own rounding.

use super::Colour;

/// Red, green, blue and alpha of a pixel; the pictures of balls are opaque.
pub(super) type Pixel = [u8; 4];
/// The most pixels that are blended together. A row of them is two SSE registers.
pub(super) const LANES: usize = 8;

/// Fills pixels with a colour: in whole blocks, of which the last may overlap the one before it, since counting what is
/// left over takes longer.
#[inline]
pub(super) fn fill(pixels: &mut [Pixel], colour: Pixel) {
    let block = [colour; LANES];
    if pixels.len() < LANES {
        return pixels.fill(colour);
    }
    for pixels in pixels.as_chunks_mut().0 {
        *pixels = block;
    }
    if let Some(last) = pixels.last_chunk_mut() {
        *last = block;
    }
}

/// A colour, ready to be painted with.
pub(super) struct Ink {
    pub(super) pixel: Pixel,
    /// The bytes of [`LANES`] pixels, as wide as what is computed with them.
    wide: [u16; 4 * LANES],
}

impl Ink {
    pub(super) fn new(Colour(red, green, blue): Colour) -> Self {
        let pixel = [red, green, blue, 255];
        Self { pixel, wide: std::array::from_fn(|byte| pixel[byte % 4].into()) }
    }

    /// Blends this over pixels, by a coverage of 0 to 255 for each of their bytes. 0 leaves a byte as it was and 255
    /// makes it this: for so few pixels that costs less than to ask which of them need it.
    #[inline]
    pub(super) fn blend<const COUNT: usize>(&self, pixels: &mut [Pixel; COUNT], coverage: &[u8]) {
        self.blend_bytes(pixels.as_flattened_mut(), coverage);
    }

    /// [`blend`](Self::blend) for the bytes of pixels whose number is not known beforehand.
    #[inline]
    pub(super) fn blend_bytes(&self, bytes: &mut [u8], coverage: &[u8]) {
        // All bytes in one loop, which compilers turn into vector instructions.
        for ((below, &above), &coverage) in bytes.iter_mut().zip(&self.wide).zip(coverage) {
            let coverage = u16::from(coverage);
            *below = mix(*below, above, coverage);
        }
    }
}

/// tiny-skia's interpolation of two bytes; all intermediate values fit 16 bits.
#[inline]
fn mix(below: u8, above: u16, coverage: u16) -> u8 {
    ((u16::from(below) * (255 - coverage) + above * coverage + 255) >> 8) as u8
}
