//! Whether a scene file was saved: what `--watch` asks.
//!
//! The file's modification time and length are looked at four times a second. Where they differ from those before,
//! something is going on: an editor may write in pieces, or delete the file, or put another in its place. Only when
//! they have stayed the same from one look to the next is the file read, and only text that is new is told. Clocks of
//! file systems tick slowly, so a file that was read just now may be written once more, as long as before, without a
//! trace in its times: for two seconds it is read again.

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io;
use std::path::PathBuf;
use std::time::{Duration, Instant, SystemTime};

use crate::scene::{self, Scene, SceneError};

/// Time between two looks.
const LOOK: Duration = Duration::from_millis(250);
/// The longest tick of a file system's clock: that of FAT.
const TICK: Duration = Duration::from_secs(2);

/// Watches one scene file.
#[derive(Debug)]
pub(super) struct Watch {
    path: PathBuf,
    next: Instant,
    /// What was seen of the file at the last look; `None` where it was not there, or empty.
    seen: Option<Stamp>,
    /// What was seen of it when it was read last, and when that was.
    read: Option<(Stamp, Instant)>,
    /// What was told last.
    content: Option<Content>,
}

/// What tells of a change without reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Stamp {
    modified: Option<SystemTime>,
    length: u64,
}

/// What was in the file, as a hash, or why it could not be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Content {
    Text(u64),
    Unreadable(io::ErrorKind),
    TooLong,
}

impl Watch {
    /// Watches the file at `path`, of which this text was told.
    pub(super) fn new(path: impl Into<PathBuf>, told: &str) -> Self {
        let path = path.into();
        let now = Instant::now();
        let seen = stamp(&path);
        let content = Some(Content::of_text(told));
        Self { next: now + LOOK, read: seen.map(|stamp| (stamp, now)), seen, content, path }
    }

    /// When [`poll`](Self::poll) looks at the file again.
    pub(super) fn next_poll(&self) -> Instant {
        self.next
    }

    /// The scene, if the file was saved since it was told last and has stood still since; or what is wrong with it,
    /// once. A file that is away, or empty, as it is while some editors save, says nothing until it is back.
    pub(super) fn poll(&mut self, now: Instant) -> Option<Result<Scene, SceneError>> {
        if now < self.next {
            return None;
        }
        self.next = now + LOOK;
        let before = std::mem::replace(&mut self.seen, stamp(&self.path));
        let stamp = self.seen.filter(|_| self.seen == before)?;
        let known =
            |&(read, since): &(Stamp, Instant)| read == stamp && now.saturating_duration_since(since) > TICK;
        if self.read.as_ref().is_some_and(known) {
            return None;
        }
        let text = scene::read(&self.path);
        if matches!(&text, Err(SceneError::Unreadable { source, .. }) if source.kind() == io::ErrorKind::NotFound)
        {
            self.seen = None;
            return None;
        }
        if self.read.is_none_or(|(read, _)| read != stamp) {
            self.read = Some((stamp, now));
        }
        let content = Some(Content::of(&text));
        if std::mem::replace(&mut self.content, content) == content {
            return None;
        }
        // It was written between two looks without a trace in its times, and may be once more.
        self.read = Some((stamp, now));
        Some(text.and_then(|text| Scene::of_file(&self.path, &text)))
    }
}

impl Content {
    fn of(read: &Result<String, SceneError>) -> Self {
        match read {
            Ok(text) => Self::of_text(text),
            Err(SceneError::Unreadable { source, .. }) => Self::Unreadable(source.kind()),
            Err(_) => Self::TooLong,
        }
    }

    fn of_text(text: &str) -> Self {
        let mut hasher = DefaultHasher::new();
        text.hash(&mut hasher);
        Self::Text(hasher.finish())
    }
}

/// What is seen of a file that is there and has something in it.
fn stamp(path: &PathBuf) -> Option<Stamp> {
    let found = fs::metadata(path).ok().filter(|found| found.len() > 0)?;
    Some(Stamp { modified: found.modified().ok(), length: found.len() })
}

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::io::Write;

    use tempfile::TempDir;

    use super::*;

    /// A scene file in a folder of its own, looked at in a time of the test's own.
    struct Setting {
        folder: TempDir,
        watch: Watch,
        now: Instant,
    }

    /// A scene of one ball of this radius, px, of two digits.
    fn text(radius: u32) -> String {
        format!("[[ball]]\nposition = [100, 100]\nradius = {radius}\n")
    }

    impl Setting {
        fn new() -> Self {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("mine.toml");
            fs::write(&path, text(10)).unwrap();
            let watch = Watch::new(&path, &text(10));
            let now = watch.next_poll();
            Self { folder, watch, now }
        }

        fn path(&self) -> PathBuf {
            self.folder.path().join("mine.toml")
        }

        fn look(&mut self) -> Option<Result<Scene, SceneError>> {
            self.now = self.now.max(self.watch.next_poll());
            self.watch.poll(self.now)
        }

        /// What is told in so many looks, each the radius of the ball or what is wrong.
        fn told(&mut self, looks: u32) -> Vec<Result<f64, String>> {
            let told = (0..looks).filter_map(|_| self.look());
            told.map(|told| match told {
                Ok(scene) => Ok(scene.build().unwrap().balls()[0].radius()),
                Err(error) => Err(error.to_string()),
            })
            .collect()
        }

        /// Lets the file look as it did, as far as times go.
        fn set_modified(&self, time: SystemTime) {
            File::options().write(true).open(self.path()).unwrap().set_modified(time).unwrap();
        }

        fn modified(&self) -> SystemTime {
            fs::metadata(self.path()).unwrap().modified().unwrap()
        }
    }

    #[test]
    fn a_file_that_nobody_saves_says_nothing() {
        let mut setting = Setting::new();
        assert!(setting.told(50).is_empty());
    }

    #[test]
    fn the_file_is_looked_at_no_more_than_four_times_a_second() {
        let mut setting = Setting::new();
        let first = setting.watch.next_poll();
        fs::write(setting.path(), text(12)).unwrap();
        assert!(setting.watch.poll(first).is_none());
        assert_eq!(setting.watch.next_poll(), first + Duration::from_millis(250));
        assert!(setting.watch.poll(first + Duration::from_millis(249)).is_none());
        assert!(setting.watch.poll(first + Duration::from_millis(250)).is_some());
    }

    #[test]
    fn a_saved_file_is_told_once() {
        let mut setting = Setting::new();
        fs::write(setting.path(), text(12)).unwrap();
        assert_eq!(setting.told(20), [Ok(12.0)]);
        fs::write(setting.path(), text(13) + "# and longer\n").unwrap();
        assert_eq!(setting.told(20), [Ok(13.0)]);
    }

    #[test]
    fn a_file_that_was_saved_before_it_is_watched_but_after_it_was_read_is_told() {
        let mut setting = Setting::new();
        fs::write(setting.path(), text(12)).unwrap();
        setting.watch = Watch::new(setting.path(), &text(10));
        assert_eq!(setting.told(20), [Ok(12.0)]);
    }

    #[test]
    fn a_file_put_in_the_place_of_the_old_one_is_told() {
        let mut setting = Setting::new();
        let other = setting.folder.path().join("mine.toml.tmp");
        fs::write(&other, text(12)).unwrap();
        fs::rename(&other, setting.path()).unwrap();
        assert_eq!(setting.told(20), [Ok(12.0)]);
    }

    #[test]
    fn a_file_that_is_away_for_a_while_is_no_error_and_is_told_when_it_is_back() {
        let mut setting = Setting::new();
        fs::remove_file(setting.path()).unwrap();
        assert!(setting.told(40).is_empty());
        fs::write(setting.path(), text(12)).unwrap();
        assert_eq!(setting.told(20), [Ok(12.0)]);
        fs::remove_file(setting.path()).unwrap();
        assert!(setting.told(3).is_empty());
        fs::write(setting.path(), text(12)).unwrap();
        assert!(setting.told(20).is_empty(), "it is back as it was");
    }

    #[test]
    fn a_file_written_in_pieces_is_told_when_it_has_stood_still() {
        let mut setting = Setting::new();
        let whole = text(12) + &"# a long comment\n".repeat(20);
        let mut file = File::create(setting.path()).unwrap();
        assert!(setting.told(3).is_empty(), "an empty file is one that is about to be written");
        for piece in whole.as_bytes().chunks(50) {
            file.write_all(piece).unwrap();
            assert!(setting.told(1).is_empty());
        }
        assert_eq!(setting.told(20), [Ok(12.0)]);
    }

    #[test]
    fn a_file_saved_as_long_within_one_tick_of_the_clock_is_told() {
        let mut setting = Setting::new();
        let time = setting.modified();
        for radius in [12, 13, 14] {
            fs::write(setting.path(), text(radius)).unwrap();
            setting.set_modified(time);
            assert_eq!(setting.told(5), [Ok(f64::from(radius))]);
        }
    }

    #[test]
    fn a_file_that_was_touched_but_not_changed_says_nothing() {
        let mut setting = Setting::new();
        for seconds in [5, 10] {
            setting.set_modified(setting.modified() + Duration::from_secs(seconds));
            assert!(setting.told(20).is_empty());
        }
    }

    #[test]
    fn what_is_wrong_is_told_once_and_what_is_mended_to_what_it_was_before_is_told() {
        let mut setting = Setting::new();
        fs::write(setting.path(), text(12).replace("12", "-1")).unwrap();
        let [Err(error)] = &setting.told(20)[..] else { panic!() };
        assert!(error.contains("mine.toml:3: radius is -1 px"), "{error}");
        fs::write(setting.path(), text(10)).unwrap();
        assert_eq!(setting.told(20), [Ok(10.0)]);
        fs::write(setting.path(), b"about = \"\xff\xfe\"\n").unwrap();
        let [Err(error)] = &setting.told(20)[..] else { panic!() };
        assert!(error.contains("mine.toml:1: this is not UTF-8"), "{error}");
    }

    #[test]
    fn a_file_that_is_not_there_yet_is_told_when_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        let watch = Watch::new(&path, "");
        let mut setting = Setting { folder, now: watch.next_poll(), watch };
        assert!(setting.told(3).is_empty());
        fs::write(&path, text(12)).unwrap();
        assert_eq!(setting.told(20), [Ok(12.0)]);
    }
}
