//! F12: the frame as a PNG file.

use std::path::PathBuf;

use png::{BitDepth, ColorType, Compression, Encoder, EncodingError};
use tiny_skia::PixmapRef;

use super::files;
use super::problem::SaveError;

/// Saves a frame in the current folder under the first free name, and tells that.
pub(super) fn save(scene: &str, pixmap: PixmapRef<'_>) -> Result<PathBuf, SaveError> {
    let png = encode(pixmap).map_err(|error| SaveError::Encoding(error.to_string()))?;
    files::save(scene, "png", &png)
}

/// A frame as a PNG file, soon rather than small: the window waits for it, and the smallest file of a frame full of trails
/// would take a third of a second and more.
fn encode(pixmap: PixmapRef<'_>) -> Result<Vec<u8>, EncodingError> {
    let mut samples = Vec::with_capacity(pixmap.data().len());
    for pixel in pixmap.pixels() {
        let colour = pixel.demultiply();
        samples.extend_from_slice(&[colour.red(), colour.green(), colour.blue(), colour.alpha()]);
    }
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, pixmap.width(), pixmap.height());
    encoder.set_color(ColorType::Rgba);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&samples)?;
    writer.finish()?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use tiny_skia::Pixmap;

    use super::*;

    #[test]
    fn a_frame_is_read_back_as_it_was() {
        for (width, height) in [(1, 1), (7, 3), (320, 200)] {
            let mut frame = Pixmap::new(width, height).unwrap();
            for (at, sample) in frame.data_mut().iter_mut().enumerate() {
                *sample = if at % 4 == 3 { 255 } else { (at * at / 7 % 251) as u8 };
            }
            assert_eq!(Pixmap::decode_png(&encode(frame.as_ref()).unwrap()).unwrap(), frame);
        }
    }
}
