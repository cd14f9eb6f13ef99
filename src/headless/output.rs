//! Output files: written whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use thiserror::Error;

/// Why an output was not written.
#[derive(Debug, Error)]
#[error("{}: {source}; nothing was written there; check that the folder exists, may be written to and has room", path.display())]
pub struct OutputError {
    /// Where it should have gone.
    pub path: PathBuf,
    /// What the system said.
    pub source: io::Error,
}

/// An output being written. What goes to a file stands in a temporary one beside it until [`finish`](Self::finish);
/// dropped before, it leaves nothing.
pub struct Output {
    path: PathBuf,
    target: Target,
}

enum Target {
    Stdout(BufWriter<io::Stdout>),
    Temporary(BufWriter<NamedTempFile>),
    /// A device or a pipe, which must not be replaced by a file.
    Device(BufWriter<File>),
}

impl Output {
    /// Begins an output to `path`; `-` is standard output.
    ///
    /// # Errors
    /// [`OutputError`] where nothing can be written there.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        let wrong = |source| OutputError { path: path.to_owned(), source };
        if path == Path::new("-") {
            let target = Target::Stdout(BufWriter::new(io::stdout()));
            return Ok(Self { path: path.to_owned(), target });
        }
        // A link's target is replaced, not the link.
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let target = match fs::metadata(&path) {
            Ok(found) if found.is_dir() => return Err(wrong(io::ErrorKind::IsADirectory.into())),
            Ok(found) if !found.is_file() => {
                let device = File::options().write(true).open(&path).map_err(wrong)?;
                Target::Device(BufWriter::new(device))
            }
            _ => Target::Temporary(BufWriter::new(temporary_beside(&path).map_err(wrong)?)),
        };
        Ok(Self { path, target })
    }

    /// Whether this is standard output.
    #[must_use]
    pub fn is_stdout(&self) -> bool {
        matches!(self.target, Target::Stdout(_))
    }

    /// Puts the output in its place.
    ///
    /// # Errors
    /// [`OutputError`] where the last bytes or the file's name cannot be written.
    pub fn finish(self) -> Result<(), OutputError> {
        let Self { path, target } = self;
        let finish = |target| match target {
            Target::Stdout(mut stdout) => stdout.flush(),
            Target::Device(mut device) => device.flush(),
            Target::Temporary(file) => {
                let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
                file.persist(&path).map(drop).map_err(|error| error.error)
            }
        };
        finish(target).map_err(|source| OutputError { path: path.clone(), source })
    }

    /// An error of writing here.
    pub(super) fn error(&self, source: io::Error) -> OutputError {
        OutputError { path: self.path.clone(), source }
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.target {
            Target::Stdout(stdout) => stdout.write(bytes),
            Target::Temporary(file) => file.write(bytes),
            Target::Device(device) => device.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.target {
            Target::Stdout(stdout) => stdout.flush(),
            Target::Temporary(file) => file.flush(),
            Target::Device(device) => device.flush(),
        }
    }
}

fn temporary_beside(path: &Path) -> io::Result<NamedTempFile> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".carom-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As any program's file: what the user's umask leaves of rw-rw-rw-, not the private mode of temporary files.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}
