//! F12: the frame as a PNG file.

use std::fs::File;
use std::io::{self, Write};
use std::path::PathBuf;

use tiny_skia::PixmapRef;

use super::problem::PictureError;

/// Saves a frame in the current folder under the first free name, and tells that.
pub(super) fn save(scene: &str, pixmap: PixmapRef<'_>) -> Result<PathBuf, PictureError> {
    let png = pixmap.encode_png().map_err(|error| PictureError::Encoding(error.to_string()))?;
    let (mut file, path) = create_new(scene)?;
    let written = file.write_all(&png);
    written.map_err(|source| {
        // Half a picture is worse than none; that it cannot be removed either would be no news.
        let _ = std::fs::remove_file(&path);
        PictureError::Io { path: path.clone(), source }
    })?;
    Ok(path)
}

fn create_new(scene: &str) -> Result<(File, PathBuf), PictureError> {
    let mut number = 1;
    loop {
        let path = PathBuf::from(format!("carom-{scene}-{number}.png"));
        match File::create_new(&path) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => number += 1,
            Err(source) => return Err(PictureError::Io { path, source }),
            Ok(file) => return Ok((file, path)),
        }
    }
}
