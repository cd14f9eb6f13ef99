//! V: what is painted, as an animated GIF that is encoded in a thread of its own.
//!
//! The window copies a frame and goes on. Pictures go round: the window fills one and sends it, and gets it back when
//! its frame is encoded; where all are on their way, the frame is left out and counted. Frames carry the time that the
//! window measures, so a window that stands still, and paints nothing, costs nothing and is seen to stand still.
//!
//! A GIF has one size: that of the first picture that was shown. Where the window takes another later, the recording ends:
//! what is cut off, or framed in black, is not what was seen.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Mutex, MutexGuard, PoisonError};
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
/// How long a program that is told to end waits for its recording at most: what is on its way takes a second or so.
const LAST_WAIT: Duration = Duration::from_secs(5);

/// The recording that is under way.
static UNDER_WAY: Mutex<Option<UnderWay>> = Mutex::new(None);

fn under_way() -> MutexGuard<'static, Option<UnderWay>> {
    UNDER_WAY.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Ends the recording that is under way, if one is, and waits until its file is finished, for a program that a signal ends
/// whatever the window does: what became of it, to be told.
#[must_use]
pub fn end_recording() -> Option<String> {
    let under_way = under_way().take()?;
    Some(under_way.end(Instant::now()))
}

/// What it takes to end a recording from another thread.
#[derive(Debug)]
struct UnderWay {
    frames: Sender<Message>,
    start: Instant,
    /// Its file's path, or why there is none.
    saved: Receiver<Result<PathBuf, String>>,
}

impl UnderWay {
    fn end(&self, now: Instant) -> String {
        let seconds = now.saturating_duration_since(self.start).as_secs_f64();
        // Where it has ended before, its file is being finished.
        let _ = self.frames.send(Message::End(seconds));
        match self.saved.recv_timeout(LAST_WAIT) {
            Ok(Ok(path)) => format!("saved {}", path.display()),
            Ok(Err(error)) => format!("no recording saved: {error}"),
            Err(RecvTimeoutError::Timeout) => "no recording saved: there was no time to finish it".to_owned(),
            Err(RecvTimeoutError::Disconnected) => "no recording saved: what writes it has ended".to_owned(),
        }
    }
}

/// A recording. It ends with [`stop`](Self::stop), with another size of the window, or where it cannot be written; then
/// [`poll`](Self::poll) tells what became of it. Dropped, it ends with the last frame, and its file is finished.
pub(super) struct Recorder {
    /// The way to the thread; `None` once the recording has ended.
    frames: Option<Sender<Message>>,
    /// Pictures that the thread is done with.
    spare: Receiver<Pixmap>,
    /// What the recording begins with, until that was shown: one that comes before takes its place.
    first: Option<Pixmap>,
    /// For the recording [under way](UNDER_WAY), which it is once something was shown.
    saved: Option<Receiver<Result<PathBuf, String>>>,
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

#[derive(Debug)]
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
    /// Begins a recording with what is painted now, in `folder`, which is empty for the current one; or, where something
    /// else, of another size, too, is added before anything was [shown](Self::shown), with that.
    pub(super) fn start(
        folder: &Path,
        scene: &str,
        painted: PixmapRef<'_>,
        now: Instant,
    ) -> Result<Self, SaveError> {
        let file = NewFile::create(folder, scene, "gif")?;
        let (path, size) = (file.path(), (painted.width(), painted.height()));
        let (frames, messages) = mpsc::channel();
        let (done, spare) = mpsc::channel();
        let thread = thread::Builder::new().name("recorder".to_owned());
        let (tell, saved) = mpsc::channel();
        let encode = move || {
            let outcome = match encode(file, &messages, &done) {
                Ok(file) => file.finish(),
                Err(source) => Err(SaveError::Animation { path, source }),
            };
            // Mostly nobody asks.
            let _ = tell.send(outcome.as_ref().map(PathBuf::clone).map_err(ToString::to_string));
            outcome
        };
        let thread = thread.spawn(encode).map_err(SaveError::NoThread)?;
        let (frames, thread, first) = (Some(frames), Some(thread), Some(painted.to_owned()));
        let (pictures, last, late, left_out, resized) = (0, 0.0, false, 0, false);
        let saved = Some(saved);
        Ok(Self {
            frames,
            spare,
            first,
            saved,
            thread,
            size,
            start: now,
            pictures,
            last,
            late,
            left_out,
            resized,
        })
    }

    /// What was added last was shown: from now on another size is a change of what is recorded.
    pub(super) fn shown(&mut self) {
        if let Some(first) = self.first.take() {
            self.pictures = 1;
            self.post(0.0, first);
            if let (Some(frames), Some(saved)) = (&self.frames, self.saved.take()) {
                *under_way() = Some(UnderWay { frames: frames.clone(), start: self.start, saved });
            }
        }
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
        let size = (painted.width(), painted.height());
        if self.first.is_some() && self.is_recording() {
            // What was to be seen when the recording was asked for never was: the window may have been resized since.
            (self.first, self.size, self.start) = (Some(painted.to_owned()), size, now);
            return None;
        }
        if size != self.size && self.is_recording() {
            self.resized = true;
            self.stop(now);
        }
        let time = self.time(now);
        let added = !self.is_recording() || !is_too_soon(self.last, time) && self.send(time, painted);
        (!added).then_some(now + AGAIN)
    }

    /// Ends the recording, whose file is then finished without anyone waiting for it.
    pub(super) fn stop(&mut self, now: Instant) {
        self.shown();
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
        // What is known is told by who asked for it.
        under_way().take();
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
        self.post(time, picture);
        true
    }

    /// Sends a picture to the thread.
    fn post(&mut self, time: f64, picture: Pixmap) {
        self.last = time;
        if let Some(frames) = &self.frames
            && frames.send(Message::Frame(time, picture)).is_err()
        {
            self.frames = None;
        }
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
        self.shown();
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

/// Encodes frames, all as large as the first, until the recording ends.
fn encode(
    file: NewFile,
    messages: &Receiver<Message>,
    done: &Sender<Pixmap>,
) -> Result<NewFile, AnimationError> {
    let mut messages = messages.iter().peekable();
    let (width, height) = match messages.peek() {
        Some(Message::Frame(_, first)) => (first.width(), first.height()),
        // No recording ends before it began.
        _ => (1, 1),
    };
    let mut animation = Animation::new(file, width, height)?;
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
mod tests;
