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

impl Colour {
    /// This colour, `part` of the way (0 to 1) to another.
    pub(super) fn towards(self, other: Self, part: f64) -> Self {
        let blend =
            |from: u8, to: u8| (f64::from(from) + part * (f64::from(to) - f64::from(from))).round() as u8;
        Self(blend(self.0, other.0), blend(self.1, other.1), blend(self.2, other.2))
    }
}

impl From<Colour> for tiny_skia::Color {
    fn from(Colour(red, green, blue): Colour) -> Self {
        Self::from_rgba8(red, green, blue, 255)
    }
}
