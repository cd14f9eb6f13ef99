//! The colours: the demo's, byte for byte, and one for what the demo has not.

/// An opaque colour: red, green, blue, as sRGB bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Colour(pub u8, pub u8, pub u8);

/// The background, hsl(0, 0%, 10%).
pub const BACKGROUND: Colour = Colour(0x1a, 0x1a, 0x1a);
/// A ball, hsl(170, 100%, 50%).
pub const BALL: Colour = Colour(0, 255, 212);
/// A ball that touches another in this frame, hsl(300, 100%, 70%).
pub const CONTACT: Colour = Colour(0xff, 0x66, 0xff);

/// A fixed ball, touched or not, hsl(0, 0%, 40%): a grey that leaves the eye to what moves.
pub const FIXED: Colour = Colour(0x66, 0x66, 0x66);

impl From<Colour> for tiny_skia::Color {
    fn from(Colour(red, green, blue): Colour) -> Self {
        Self::from_rgba8(red, green, blue, 255)
    }
}
