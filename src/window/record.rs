//! V: what is painted, as an animated GIF that is encoded in a thread of its own.
//!
//! The window copies a frame and goes on. Pictures go round: the window fills one and sends it, and gets it back when
//! its frame is encoded; where all are on their way, the frame is left out and counted. Frames carry the time that the
//! window measures, so a window that stands still, and paints nothing, costs nothing and is seen to stand still.
//!
//! A GIF has one size. Where the window takes another, the recording ends: what is cut off, or framed in black, is not
//! what was seen.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use tiny_skia::{Pixmap, PixmapRef};

use super::files::NewFile;
use super::problem::SaveError;
use crate::paint::animation::is_too_soon;
use crate::paint::{Animation, AnimationError};

/// The memory that pictures on their way may take, bytes ...
const PICTURES_BYTES: usize = 64 << 20;
/// ... but there are at least, and at most, so many of them.
const FEWEST_PICTURES: usize = 2;
const MOST_PICTURES: usize = 8;
/// After how long to come again with a frame that was not added: the shortest frame of a GIF.
const AGAIN: Duration = Duration::from_millis(20);

/// A recording. It ends with [`stop`](Self::stop), with another size of the window, or where it cannot be written; then
/// [`poll`](Self::poll) tells what became of it. Dropped, it ends with the last frame, and its file is finished.
pub(super) struct Recorder {
    /// The way to the thread; `None` once the recording has ended.
    frames: Option<Sender<Message>>,
    /// Pictures that the thread is done with.
    spare: Receiver<Pixmap>,
    /// `None` once it was told what became of the recording.
    thread: Option<JoinHandle<Result<PathBuf, SaveError>>>,
    size: (u32, u32),
    start: Instant,
    /// How many pictures there are, on their way or spare.
    pictures: usize,
    /// When the last frame was sent, s from the start; once the recording has ended, when that was.
    last: f64,
    /// Whether the last frame found no picture and may come again.
    late: bool,
    /// How many frames before it found none.
    left_out: u64,
    /// Whether the recording ended because the window took another size.
    resized: bool,
}

enum Message {
    /// What is seen from this time on, s from the start.
    Frame(f64, Pixmap),
    /// The recording ends, s from the start.
    End(f64),
}

/// A recording that is saved.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Recorded {
    pub(super) path: PathBuf,
    /// How long it is, s.
    pub(super) seconds: f64,
    /// Frames that came faster than they could be encoded.
    pub(super) left_out: u64,
    /// Whether it ended because the window took another size.
    pub(super) resized: bool,
}

impl Recorder {
    /// Begins a recording with what is painted now, in `folder`, which is empty for the current one.
    pub(super) fn start(
        folder: &Path,
        scene: &str,
        painted: PixmapRef<'_>,
        now: Instant,
    ) -> Result<Self, SaveError> {
        let file = NewFile::create(folder, scene, "gif")?;
        let (path, size) = (file.path(), (painted.width(), painted.height()));
        let animation = Animation::new(file, size.0, size.1)
            .map_err(|source| SaveError::Animation { path: path.clone(), source })?;
        let (frames, messages) = mpsc::channel();
        let (done, spare) = mpsc::channel();
        let thread = thread::Builder::new().name("recorder".to_owned());
        let encode = move || match encode(animation, &messages, &done) {
            Ok(file) => file.finish(),
            Err(source) => Err(SaveError::Animation { path, source }),
        };
        let thread = thread.spawn(encode).map_err(SaveError::NoThread)?;
        let (frames, thread) = (Some(frames), Some(thread));
        let (pictures, last, late, left_out, resized) = (0, 0.0, false, 0, false);
        let mut recorder =
            Self { frames, spare, thread, size, start: now, pictures, last, late, left_out, resized };
        recorder.send(0.0, painted);
        Ok(recorder)
    }

    /// Adds a frame that was painted now, unless it comes sooner after the one before than a GIF may have it, or than
    /// that can be encoded. Then this tells when to [come again](Self::add_again) with it, should nothing else be
    /// painted until then: a window that stands still shows its last frame, and so must the recording.
    pub(super) fn add(&mut self, painted: PixmapRef<'_>, now: Instant) -> Option<Instant> {
        // The one before that could not be encoded in time now never is.
        self.left_out += u64::from(std::mem::take(&mut self.late));
        self.add_again(painted, now)
    }

    /// Adds the frame that [`add`](Self::add) did not, in the same way.
    pub(super) fn add_again(&mut self, painted: PixmapRef<'_>, now: Instant) -> Option<Instant> {
        if (painted.width(), painted.height()) != self.size && self.is_recording() {
            self.resized = true;
            self.stop(now);
        }
        let time = self.time(now);
        let added = !self.is_recording() || !is_too_soon(self.last, time) && self.send(time, painted);
        (!added).then_some(now + AGAIN)
    }

    /// Ends the recording, whose file is then finished without anyone waiting for it.
    pub(super) fn stop(&mut self, now: Instant) {
        if let Some(frames) = self.frames.take() {
            self.left_out += u64::from(std::mem::take(&mut self.late));
            self.last = self.last.max(self.time(now));
            // A thread that is gone has failed, which it will tell.
            let _ = frames.send(Message::End(self.last));
        }
    }

    /// Whether frames are still taken.
    pub(super) fn is_recording(&self) -> bool {
        self.frames.is_some()
    }

    /// What became of the recording, once, as soon as that is known; to be asked now and then, also while recording.
    pub(super) fn poll(&mut self) -> Option<Result<Recorded, SaveError>> {
        let thread = self.thread.take_if(|thread| thread.is_finished())?;
        self.frames = None;
        Some(self.outcome(thread))
    }

    /// Ends the recording and waits until its file is finished, for a window that closes; `None` where what became of
    /// it was told before.
    pub(super) fn finish(mut self, now: Instant) -> Option<Result<Recorded, SaveError>> {
        self.stop(now);
        let thread = self.thread.take()?;
        Some(self.outcome(thread))
    }

    fn outcome(&self, thread: JoinHandle<Result<PathBuf, SaveError>>) -> Result<Recorded, SaveError> {
        let path = thread.join().map_err(|_| SaveError::ThreadEnded)??;
        Ok(Recorded { path, seconds: self.last, left_out: self.left_out, resized: self.resized })
    }

    /// Seconds since the recording began.
    fn time(&self, now: Instant) -> f64 {
        now.saturating_duration_since(self.start).as_secs_f64()
    }

    /// Sends a copy to the thread, if there is a picture for it, and tells whether there was.
    fn send(&mut self, time: f64, painted: PixmapRef<'_>) -> bool {
        let picture = self.picture();
        self.late = picture.is_none();
        let Some(mut picture) = picture else { return false };
        picture.data_mut().copy_from_slice(painted.data());
        self.last = time;
        if let Some(frames) = &self.frames
            && frames.send(Message::Frame(time, picture)).is_err()
        {
            self.frames = None;
        }
        true
    }

    /// A picture that is not on its way.
    fn picture(&mut self) -> Option<Pixmap> {
        let spare = self.spare.try_recv().ok();
        if spare.is_some() || self.pictures == most_pictures(self.size) {
            return spare;
        }
        self.pictures += 1;
        Pixmap::new(self.size.0, self.size.1)
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        if let Some(frames) = self.frames.take() {
            let _ = frames.send(Message::End(self.last));
        }
        if let Some(thread) = self.thread.take() {
            // Nobody is left who could be told.
            let _ = thread.join();
        }
    }
}

impl fmt::Display for Recorded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "saved {} ({:.1} s)", self.path.display(), self.seconds)?;
        if self.resized {
            write!(f, "; it ends where the window's size changed")?;
        }
        match self.left_out {
            0 => Ok(()),
            1 => write!(f, "; 1 frame is missing, which could not be encoded in time"),
            count => write!(f, "; {count} frames are missing, which could not be encoded in time"),
        }
    }
}

/// How many pictures of this size may be on their way.
fn most_pictures((width, height): (u32, u32)) -> usize {
    (PICTURES_BYTES / (4 * width as usize * height as usize)).clamp(FEWEST_PICTURES, MOST_PICTURES)
}

/// Encodes frames until the recording ends.
fn encode(
    mut animation: Animation<NewFile>,
    messages: &Receiver<Message>,
    done: &Sender<Pixmap>,
) -> Result<NewFile, AnimationError> {
    let mut end = 0.0;
    for message in messages {
        match message {
            Message::Frame(time, picture) => {
                animation.add(time, &picture)?;
                end = time;
                // Where nobody fills it again, the picture is dropped.
                let _ = done.send(picture);
            }
            Message::End(time) => {
                end = time;
                break;
            }
        }
    }
    animation.finish(end)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use tempfile::TempDir;

    use super::*;
    use crate::paint::animation::tests::decode;

    /// A picture that is other for every `number`.
    fn picture(number: u32) -> Pixmap {
        let mut pixmap = Pixmap::new(40, 30).unwrap();
        let (pixels, _) = pixmap.data_mut().as_chunks_mut();
        for (index, pixel) in pixels.iter_mut().enumerate() {
            *pixel = if (number >> (index % 40).min(31)) & 1 == 1 {
                [0, 255, 212, 255]
            } else {
                [26, 26, 26, 255]
            };
        }
        pixmap
    }

    struct Setting {
        folder: TempDir,
        start: Instant,
    }

    impl Setting {
        fn new() -> Self {
            Self { folder: tempfile::tempdir().unwrap(), start: Instant::now() }
        }

        fn at(&self, milliseconds: u64) -> Instant {
            self.start + Duration::from_millis(milliseconds)
        }

        fn record(&self) -> Recorder {
            Recorder::start(self.folder.path(), "gas", picture(0).as_ref(), self.start).unwrap()
        }

        fn path(&self, number: u32) -> PathBuf {
            self.folder.path().join(format!("carom-gas-{number}.gif"))
        }

        fn seen(&self) -> Vec<(Pixmap, u16)> {
            decode(&fs::read(self.path(1)).unwrap())
        }
    }

    /// Waits, as the window does in its loop, until it is known what became of the recording.
    fn outcome(recorder: &mut Recorder) -> Result<Recorded, SaveError> {
        loop {
            if let Some(outcome) = recorder.poll() {
                return outcome;
            }
            thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn frames_are_seen_at_the_time_at_which_the_window_showed_them() {
        let setting = Setting::new();
        let mut recorder = setting.record();
        for (time, number) in [(40, 1), (100, 2), (3100, 3)] {
            recorder.add(picture(number).as_ref(), setting.at(time));
        }
        assert!(recorder.is_recording() && recorder.poll().is_none());
        recorder.stop(setting.at(4000));
        recorder.add(picture(4).as_ref(), setting.at(5000));
        let recorded = outcome(&mut recorder).unwrap();
        assert_eq!(recorded, Recorded { path: setting.path(1), seconds: 4.0, left_out: 0, resized: false });
        assert!(!recorder.is_recording() && recorder.poll().is_none());
        let expected = [(picture(0), 4), (picture(1), 6), (picture(2), 300), (picture(3), 90)];
        assert!(setting.seen() == expected);
    }

    #[test]
    fn every_frame_is_in_the_file_or_counted_as_left_out() {
        let setting = Setting::new();
        let mut recorder = setting.record();
        for number in 1..500 {
            recorder.add(picture(number).as_ref(), setting.at(20 * u64::from(number)));
        }
        let recorded = recorder.finish(setting.at(10_000)).unwrap().unwrap();
        assert_eq!(setting.seen().len() as u64 + recorded.left_out, 500);
        assert!(setting.seen().len() >= MOST_PICTURES, "as many as there are pictures for find their way");
    }

    #[test]
    fn frames_that_come_too_soon_for_a_gif_are_no_loss_and_the_last_of_them_can_come_again() {
        let setting = Setting::new();
        let mut recorder = setting.record();
        for number in 1..=10 {
            let again = recorder.add(picture(number).as_ref(), setting.at(u64::from(number)));
            assert_eq!(again, Some(setting.at(u64::from(number) + 20)));
        }
        assert_eq!(recorder.add_again(picture(10).as_ref(), setting.at(30)), None);
        assert_eq!(recorder.finish(setting.at(50)).unwrap().unwrap().left_out, 0);
        assert!(setting.seen() == [(picture(0), 3), (picture(10), 2)]);
    }

    #[test]
    fn a_frame_that_finds_no_picture_is_left_out_unless_it_comes_again_before_the_next() {
        let setting = Setting::new();
        let mut recorder = setting.record();
        // As many as there may be, and none of them comes back.
        (recorder.pictures, recorder.spare) = (MOST_PICTURES, mpsc::channel().1);
        assert!(recorder.add(picture(1).as_ref(), setting.at(100)).is_some());
        assert!(recorder.add_again(picture(1).as_ref(), setting.at(120)).is_some());
        assert!(recorder.add(picture(2).as_ref(), setting.at(140)).is_some());
        recorder.pictures -= 1;
        assert_eq!(recorder.add_again(picture(2).as_ref(), setting.at(160)), None);
        assert!(recorder.add(picture(3).as_ref(), setting.at(200)).is_some());
        let recorded = recorder.finish(setting.at(300)).unwrap().unwrap();
        assert_eq!(recorded.left_out, 2, "the first and the third");
        assert!(setting.seen() == [(picture(0), 16), (picture(2), 14)]);
    }

    #[test]
    fn another_size_of_the_window_ends_the_recording_and_says_so() {
        let setting = Setting::new();
        let mut recorder = setting.record();
        recorder.add(picture(1).as_ref(), setting.at(500));
        recorder.add(Pixmap::new(41, 30).unwrap().as_ref(), setting.at(1000));
        recorder.add(picture(2).as_ref(), setting.at(2000));
        assert!(!recorder.is_recording());
        let recorded = outcome(&mut recorder).unwrap();
        assert_eq!((recorded.resized, recorded.seconds), (true, 1.0));
        assert!(
            recorded
                .to_string()
                .ends_with("carom-gas-1.gif (1.0 s); it ends where the window's size changed")
        );
        assert!(setting.seen() == [(picture(0), 50), (picture(1), 50)]);
    }

    #[test]
    fn a_recorder_that_is_dropped_finishes_its_file_and_the_next_overwrites_nothing() {
        let setting = Setting::new();
        let mut recorder = setting.record();
        recorder.add(picture(1).as_ref(), setting.at(100));
        drop(recorder);
        assert!(setting.seen() == [(picture(0), 10), (picture(1), 2)]);
        let second = setting.record().finish(setting.at(100)).unwrap().unwrap();
        assert_eq!(second.path, setting.path(2));
        assert_eq!(fs::read_dir(setting.folder.path()).unwrap().count(), 2, "no temporary file is left");
    }

    #[test]
    fn a_file_that_cannot_be_written_is_told_at_the_start_or_at_the_end() {
        let setting = Setting::new();
        let nowhere = setting.folder.path().join("nowhere");
        let refused = Recorder::start(&nowhere, "gas", picture(0).as_ref(), setting.start).map(drop);
        assert!(matches!(refused, Err(SaveError::Io { .. })));
        let recorder = setting.record();
        fs::remove_dir_all(setting.folder.path()).unwrap();
        let error = recorder.finish(setting.at(100)).unwrap().unwrap_err();
        assert!(matches!(&error, SaveError::Io { path, .. } if *path == setting.path(1)), "{error}");
    }

    #[test]
    fn pictures_on_their_way_take_64_mebibytes_or_two_pictures() {
        assert_eq!(most_pictures((1, 1)), MOST_PICTURES);
        assert_eq!(most_pictures((1280, 720)), MOST_PICTURES);
        assert_eq!(most_pictures((2560, 1440)), 4);
        assert_eq!(most_pictures((7680, 4320)), FEWEST_PICTURES);
    }
}
