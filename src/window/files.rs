//! Files that the window leaves in the current folder: under the first free name, whole or not at all.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::problem::SaveError;
use crate::headless::Unfinished;

/// The most characters of a scene's name in a file's: file systems take names of 255 bytes.
const LONGEST_NAME: usize = 48;

/// A file being written. It stands in a temporary one until [`finish`](Self::finish); dropped before, it leaves
/// nothing.
pub(super) struct NewFile {
    file: BufWriter<Unfinished>,
    folder: PathBuf,
    stem: String,
    ending: &'static str,
}

impl NewFile {
    /// Begins a file in `folder` (empty for the current one) that will be called `carom-<scene>-<number>.<ending>`.
    pub(super) fn create(folder: &Path, scene: &str, ending: &'static str) -> Result<Self, SaveError> {
        let scene: String = scene.chars().take(LONGEST_NAME).collect();
        let stem = format!("carom-{}", scene.replace(['/', '\\'], "-"));
        let folder = folder.to_owned();
        match Unfinished::in_folder(&folder) {
            Ok(file) => Ok(Self { file: BufWriter::new(file), folder, stem, ending }),
            Err(source) => Err(SaveError::Io { path: numbered(&folder, &stem, 1, ending), source }),
        }
    }

    /// Gives the file the first number that no other has, and tells its path. What comes into the way meanwhile is not
    /// overwritten either.
    pub(super) fn finish(mut self) -> Result<PathBuf, SaveError> {
        self.flush().map_err(|source| self.error(source))?;
        let Self { file, folder, stem, ending } = self;
        let first = numbered(&folder, &stem, 1, ending);
        let mut file =
            file.into_inner().map_err(|error| SaveError::Io { path: first, source: error.into_error() })?;
        let mut number = 1;
        loop {
            let path = numbered(&folder, &stem, number, ending);
            match file.persist_new(&path) {
                Ok(()) => return Ok(path),
                Err((unfinished, error)) if error.kind() == io::ErrorKind::AlreadyExists => file = unfinished,
                Err((_, source)) => return Err(SaveError::Io { path, source }),
            }
            number += 1;
        }
    }

    /// The path that it will have where nothing is in its way.
    pub(super) fn path(&self) -> PathBuf {
        numbered(&self.folder, &self.stem, 1, self.ending)
    }

    /// An error of writing here.
    pub(super) fn error(&self, source: io::Error) -> SaveError {
        SaveError::Io { path: self.path(), source }
    }
}

/// Saves `bytes` in the current folder, and tells the path.
pub(super) fn save(scene: &str, ending: &'static str, bytes: &[u8]) -> Result<PathBuf, SaveError> {
    let mut file = NewFile::create(Path::new(""), scene, ending)?;
    file.write_all(bytes).map_err(|error| file.error(error))?;
    file.finish()
}

fn numbered(folder: &Path, stem: &str, number: u64, ending: &str) -> PathBuf {
    folder.join(format!("{stem}-{number}.{ending}"))
}

impl Write for NewFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn save(folder: &Path, scene: &str) -> PathBuf {
        let mut file = NewFile::create(folder, scene, "png").unwrap();
        file.write_all(b"new").unwrap();
        file.finish().unwrap()
    }

    #[test]
    fn files_take_the_first_free_number_and_overwrite_nothing() {
        let folder = tempfile::tempdir().unwrap();
        for taken in ["carom-gravity-1.png", "carom-gravity-3.png", "carom-gravity-2.gif"] {
            fs::write(folder.path().join(taken), "old").unwrap();
        }
        fs::create_dir(folder.path().join("carom-gravity-4.png")).unwrap();
        assert_eq!(save(folder.path(), "gravity"), folder.path().join("carom-gravity-2.png"));
        assert_eq!(save(folder.path(), "gravity"), folder.path().join("carom-gravity-5.png"));
        assert_eq!(fs::read(folder.path().join("carom-gravity-1.png")).unwrap(), b"old");
        assert_eq!(fs::read(folder.path().join("carom-gravity-5.png")).unwrap(), b"new");
        assert_eq!(names(folder.path()).len(), 6, "and no temporary file is left");
    }

    #[test]
    fn a_name_that_is_taken_while_the_file_is_written_is_not_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let (one, other) =
            (NewFile::create(folder.path(), "gas", "gif"), NewFile::create(folder.path(), "gas", "gif"));
        assert_eq!(one.unwrap().finish().unwrap(), folder.path().join("carom-gas-1.gif"));
        assert_eq!(other.unwrap().finish().unwrap(), folder.path().join("carom-gas-2.gif"));
    }

    #[test]
    fn a_file_that_is_not_finished_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let mut file = NewFile::create(folder.path(), "gas", "gif").unwrap();
        file.write_all(&vec![0; 100_000]).unwrap();
        drop(file);
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn names_of_scenes_that_are_long_or_paths_still_make_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = save(folder.path(), &"é".repeat(300));
        assert_eq!(path, folder.path().join(format!("carom-{}-1.png", "é".repeat(LONGEST_NAME))));
        assert_eq!(save(folder.path(), "../mine"), folder.path().join("carom-..-mine-1.png"));
    }

    #[test]
    fn a_folder_that_is_not_there_is_told_at_the_start_with_the_name() {
        let error = NewFile::create(Path::new("no/such/folder"), "gas", "gif").map(drop).unwrap_err();
        assert!(error.to_string().starts_with("no/such/folder/carom-gas-1.gif: "), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn others_may_read_the_file_as_any_other() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("plain"), "").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&save(folder.path(), "gas")), mode(&folder.path().join("plain")));
    }
}
