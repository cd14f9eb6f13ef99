//! Files that are being written, each under a temporary name beside its place until it is whole.
//!
//! What is dropped before is removed, with the folders that were made for it. A program that is told to end by a signal
//! drops nothing, so all of them stand in one list, and [`discard_unfinished`] removes what is there; carom does so on SIGHUP,
//! SIGINT, SIGQUIT, SIGTERM and SIGXCPU. What ends a program otherwise (SIGKILL, a power failure, another signal) leaves such a
//! file: its name begins with `.carom-`, and it may be deleted.

use std::fs;
use std::io::{self, Write};
use std::mem;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, Once, PoisonError};

use tempfile::NamedTempFile;

/// The temporary names of all that are being written, each behind the folders that were made for it.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes every output file that is not whole yet, and the folders made for them that are empty then, for a program that ends at
/// once: none can be begun or put into its place from now on, and whoever tries waits for the end. To call it again does nothing.
pub fn discard_unfinished() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let unfinished = unfinished();
        for path in unfinished.iter().rev() {
            // One that cannot be removed stays; there is nobody left to tell.
            let _ = if path.is_dir() { fs::remove_dir(path) } else { fs::remove_file(path) };
        }
        // Never unlocked.
        mem::forget(unfinished);
    });
}

/// Folders that were made for files to come. Dropped, those of them that are empty are removed.
#[cfg(feature = "report")]
#[derive(Debug)]
pub(crate) struct MadeFolders(Vec<PathBuf>);

#[cfg(feature = "report")]
impl MadeFolders {
    /// Makes a folder, and those around it, where there are none.
    pub(crate) fn make(folder: &Path) -> io::Result<Self> {
        let missing =
            folder.ancestors().take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists());
        let mut made: Vec<PathBuf> = missing.map(Path::to_owned).collect();
        made.reverse();
        let mut unfinished = unfinished();
        unfinished.extend_from_slice(&made);
        let (made, done) = (Self(made), fs::create_dir_all(folder));
        drop(unfinished);
        done.map(|()| made)
    }
}

#[cfg(feature = "report")]
impl Drop for MadeFolders {
    fn drop(&mut self) {
        let mut unfinished = unfinished();
        for folder in self.0.iter().rev() {
            // One that has something in it stays.
            let _ = fs::remove_dir(folder);
        }
        unfinished.retain(|path| !self.0.contains(path));
    }
}

/// A file that is not in its place yet. Dropped, it is removed.
#[derive(Debug)]
pub(crate) struct Unfinished {
    /// There until it is put into its place, or dropped.
    file: Option<NamedTempFile>,
}

impl Unfinished {
    /// Begins a file that is to replace the one at `path`, if there is any, in `folder`, which is where that is.
    pub(super) fn beside(path: &Path, folder: &Path) -> io::Result<Self> {
        let file = Self::in_folder(folder)?;
        if let Ok(replaced) = fs::metadata(path) {
            // What others may not read, they still may not.
            file.file().as_file().set_permissions(replaced.permissions())?;
        }
        Ok(file)
    }

    /// Begins a file in a folder; empty for the current one.
    pub(crate) fn in_folder(folder: &Path) -> io::Result<Self> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".carom-");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // As any program's file: what the user's umask leaves of rw-rw-rw-, not the private mode of temporary
            // files.
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let mut unfinished = unfinished();
        // What the system said, without the temporary name that it said it of.
        let file = builder.tempfile_in(folder).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => {
                // Of some folders the system says so where it lets nothing be made in them.
                let is_there = folder.as_os_str().is_empty() || folder.is_dir();
                let (kind, what) = if is_there {
                    (io::ErrorKind::PermissionDenied, "no file can be made in")
                } else {
                    (io::ErrorKind::NotFound, "there is no folder")
                };
                io::Error::new(kind, format!("{what} {}", folder.display()))
            }
            kind => kind.into(),
        })?;
        unfinished.push(file.path().to_owned());
        Ok(Self { file: Some(file) })
    }

    /// Puts the file into its place.
    pub(super) fn persist(mut self, path: &Path) -> io::Result<()> {
        let Some(file) = self.file.take() else { return Ok(()) };
        leave(file, |file| file.persist(path).map(drop).map_err(|error| error.error))
    }

    /// Puts the file into a place where there is none; where there is one, it is as unfinished as before.
    #[cfg_attr(not(feature = "window"), expect(dead_code, reason = "only the window names files by itself"))]
    pub(crate) fn persist_new(mut self, path: &Path) -> Result<(), (Self, io::Error)> {
        let Some(file) = self.file.take() else { return Ok(()) };
        let mut unfinished = unfinished();
        let name = file.path().to_owned();
        match file.persist_noclobber(path) {
            Ok(_) => {
                unfinished.retain(|path| *path != name);
                Ok(())
            }
            Err(failed) => {
                self.file = Some(failed.file);
                Err((self, failed.error))
            }
        }
    }

    fn file(&self) -> &NamedTempFile {
        self.file.as_ref().expect("a file is there until it is put into its place")
    }
}

/// Does away with a file's temporary name and its place in the list, so that nobody sees one without the other.
fn leave<T>(file: NamedTempFile, by: impl FnOnce(NamedTempFile) -> T) -> T {
    let mut unfinished = unfinished();
    let name = file.path().to_owned();
    let left = by(file);
    unfinished.retain(|path| *path != name);
    left
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if let Some(file) = self.file.take() {
            leave(file, drop);
        }
    }
}

impl Write for Unfinished {
    // By the open file: the other way, errors name the temporary file.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file().as_file().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file().as_file().flush()
    }
}
