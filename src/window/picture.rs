//! F12: the frame as a PNG file.

use std::path::PathBuf;

use tiny_skia::PixmapRef;

use super::files;
use super::problem::SaveError;

/// Saves a frame in the current folder under the first free name, and tells that.
pub(super) fn save(scene: &str, pixmap: PixmapRef<'_>) -> Result<PathBuf, SaveError> {
    let png = pixmap.encode_png().map_err(|error| SaveError::Encoding(error.to_string()))?;
    files::save(scene, "png", &png)
}
