//! Output files: written whole or not at all.
//!
//! Where standard output was closed before the program began (`>&-`), what is written to it is lost, and nothing says so: before
//! `main`, Rust puts `/dev/null` in its place, which from then on looks like the one that a script asked for.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::unfinished::Unfinished;

/// Why an output was not written.
#[derive(Debug, Error)]
#[error("{}: {source}{}", super::in_words(path), remedy(path, source))]
pub struct OutputError {
    /// Where it should have gone.
    pub path: PathBuf,
    /// What the system said.
    pub source: io::Error,
}

impl OutputError {
    /// Whether the reader of standard output went away.
    #[must_use]
    pub fn is_broken_pipe(&self) -> bool {
        is_stdout(&self.path) && self.source.kind() == io::ErrorKind::BrokenPipe
    }
}

/// What became of an output that failed, and what to do about it; nothing where it was standard output.
fn remedy(path: &Path, source: &io::Error) -> String {
    if is_stdout(path) { String::new() } else { format!("; this file was not written; {}", advice(source)) }
}

/// What to do about a file that failed.
fn advice(source: &io::Error) -> &'static str {
    match source.kind() {
        io::ErrorKind::NotFound => "make the folder first, or give another",
        io::ErrorKind::NotADirectory => "what should be its folder is a file: give another folder",
        io::ErrorKind::IsADirectory => "name a file in it, or move it out of the way",
        // Our own word, not the system's.
        io::ErrorKind::InvalidFilename if source.raw_os_error().is_none() => "end it with the name of a file",
        io::ErrorKind::InvalidFilename => "give it a shorter name",
        io::ErrorKind::FileTooLarge => "allow larger files (ulimit -f), or ask for less",
        io::ErrorKind::PermissionDenied => "allow writing there (chmod), or give another path",
        _ => "check that the folder may be written to and has room",
    }
}

/// Whether this path means standard output.
pub(super) fn is_stdout(path: &Path) -> bool {
    ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"].into_iter().any(|name| path == Path::new(name))
}

/// Whether this is the file that standard output was sent to.
#[cfg(unix)]
fn is_behind_stdout(path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let files = fs::metadata(path).ok().zip(fs::metadata("/dev/stdout").ok());
    // Into one device, /dev/null for instance, two may write.
    files.is_some_and(|(one, other)| one.is_file() && (one.dev(), one.ino()) == (other.dev(), other.ino()))
}

#[cfg(not(unix))]
fn is_behind_stdout(_: &Path) -> bool {
    false
}

/// The same path for all paths to the same place, as far as links to existing files and folders tell; `-` for standard
/// output and the file behind it.
pub(super) fn canonical(path: &Path) -> PathBuf {
    if is_stdout(path) || is_behind_stdout(path) {
        return "-".into();
    }
    let path = &past_broken_links(path);
    let in_folder = || Some(fs::canonicalize(folder(path)).ok()?.join(path.file_name()?));
    fs::canonicalize(path).ok().or_else(in_folder).unwrap_or_else(|| path.to_owned())
}

/// The path itself, or, where it is a link to nothing, that of what would be there.
fn past_broken_links(path: &Path) -> PathBuf {
    let mut path = path.to_owned();
    // Of links in a circle the system says so, which is another error.
    while fs::metadata(&path).is_err_and(|error| error.kind() == io::ErrorKind::NotFound)
        && let Ok(target) = fs::read_link(&path)
    {
        path = path.with_file_name(target);
    }
    path
}

/// Whether nothing stands behind the last name in a path.
fn ends_with_a_name(path: &Path) -> bool {
    let (path, name) = (path.as_os_str().as_encoded_bytes(), path.file_name());
    name.is_some_and(|name| path.ends_with(name.as_encoded_bytes()))
}

/// Refuses a file that the user may not write to: putting another into its place takes leave of the folder alone.
fn check_writable(path: &Path) -> io::Result<()> {
    match File::options().append(true).open(path) {
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => {
            Err(io::Error::new(error.kind(), WRITE_PROTECTED))
        }
        // Whatever else keeps it from being opened, it may be replaced.
        _ => Ok(()),
    }
}

/// What is said of a file that the user may not write to.
const WRITE_PROTECTED: &str = "the file that is there is write-protected";

/// The folder that a file is in.
fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// An output being written. What goes to a file stands in a temporary one beside it until [`finish`](Self::finish);
/// dropped before, it leaves nothing, nor where a signal ends the program and that calls
/// [`discard_unfinished`](super::discard_unfinished).
pub struct Output {
    path: PathBuf,
    target: Target,
}

enum Target {
    Stdout(BufWriter<io::Stdout>),
    Temporary(BufWriter<Unfinished>),
    /// A device or a pipe, which must not be replaced by a file.
    Device(BufWriter<File>),
}

impl Output {
    /// Begins an output to `path`; `-` is standard output.
    ///
    /// # Errors
    /// [`OutputError`] where nothing can be written there.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        let place = past_broken_links(path);
        let wrong = |error: io::Error| {
            let source = if place == path {
                error
            } else {
                io::Error::new(error.kind(), format!("this is a link to {}, and {error}", place.display()))
            };
            OutputError { path: path.to_owned(), source }
        };
        if is_stdout(path) {
            let target = Target::Stdout(BufWriter::new(io::stdout()));
            return Ok(Self { path: path.to_owned(), target });
        }
        // The target of a link to a file is replaced, not the link.
        let path = fs::canonicalize(&place).unwrap_or_else(|_| place.clone());
        let target = match fs::metadata(&path) {
            Ok(found) if found.is_dir() => return Err(wrong(io::ErrorKind::IsADirectory.into())),
            Ok(found) if !found.is_file() => {
                let device = File::options().write(true).open(&path).map_err(wrong)?;
                Target::Device(BufWriter::new(device))
            }
            // A temporary file beside it would tell neither of its own name.
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(wrong(error)),
            Err(_) if !ends_with_a_name(&path) => {
                let message = "a path that ends with a slash or with a dot is that of a folder";
                return Err(wrong(io::Error::new(io::ErrorKind::InvalidFilename, message)));
            }
            found => {
                if found.is_ok() {
                    check_writable(&path).map_err(wrong)?;
                }
                Target::Temporary(BufWriter::new(Unfinished::beside(&path, folder(&path)).map_err(wrong)?))
            }
        };
        Ok(Self { path, target })
    }

    /// Writes all of the output at once, and puts it in its place.
    ///
    /// # Errors
    /// [`OutputError`] where it cannot be written.
    pub fn complete(mut self, bytes: &[u8]) -> Result<(), OutputError> {
        self.write_all(bytes).map_err(|error| self.error(error))?;
        self.finish()
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
                file.persist(&path)
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
