//! F12: the frame as a PNG file.

use std::io::Write;
use std::path::{Path, PathBuf};

use tiny_skia::PixmapRef;

use super::files::NewFile;
use super::problem::SaveError;

/// Saves a frame in the current folder under the first free name, and tells that.
pub(super) fn save(scene: &str, pixmap: PixmapRef<'_>) -> Result<PathBuf, SaveError> {
    let png = pixmap.encode_png().map_err(|error| SaveError::Encoding(error.to_string()))?;
    let mut file = NewFile::create(Path::new(""), scene, "png")?;
    file.write_all(&png).map_err(|error| file.error(error))?;
    file.finish()
}
