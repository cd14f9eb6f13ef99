//! What is saved: pictures, scenes, replays and recordings.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use tiny_skia::Pixmap;

use super::super::overlay::Room;
use super::super::problem::SaveError;
use super::super::record::Recorder;
use super::super::{files, picture};
use super::App;

/// How often it is asked what became of a recording.
const RECORDER_LOOKS: Duration = Duration::from_millis(200);

impl App {
    pub(super) fn save_picture(&mut self) {
        let Some(picture) = self.picture(Instant::now()) else { return };
        let saved = picture::save(self.session.name(), picture.as_ref());
        self.tell_saved("picture", saved);
    }

    /// The picture without what is said over it to who sits before the window.
    pub(super) fn picture(&mut self, now: Instant) -> Option<Pixmap> {
        self.picture_in(self.room()?, now)
    }

    /// The same in such a room: all as it is now, whatever was painted last.
    pub(super) fn picture_in(&mut self, room: Room, now: Instant) -> Option<Pixmap> {
        // A scene is not shown before its first frame.
        let _ = self.session.begin();
        // This is no frame, and the figures are those of frames.
        let gauge = self.gauge.clone();
        let overlay = self.overlay(room, 0.0, now);
        self.gauge = gauge;
        let size = (room.picture.x as u32, room.picture.y as u32);
        let mut picture = Pixmap::new(size.0, size.1)?;
        let target = &mut picture.as_mut();
        let simulation = self.session.simulation();
        self.painter.paint_aside(simulation, room.scale, target);
        if let Some(trails) = &mut self.trails {
            trails.follow(simulation, room.scale, size);
            trails.paint(target);
        }
        overlay.paint_kept(target, room.scale);
        Some(picture)
    }

    /// Saves the balls as they are now as a scene file.
    pub(super) fn save_scene(&mut self) {
        let text = self.session.scene_file();
        let saved = files::save(self.session.name(), "toml", text.as_bytes());
        self.tell_saved("scene", saved);
    }

    /// Saves all that was done since the scene began.
    pub(super) fn save_replay(&mut self) {
        let Some(text) = self.session.replay() else {
            return self.complain("no replay saved: the scene began too long ago".to_owned());
        };
        let saved = files::save(self.session.name(), "replay", text.as_bytes());
        self.tell_saved("replay", saved);
    }

    pub(super) fn tell_saved(&mut self, what: &str, saved: Result<PathBuf, SaveError>) {
        match saved {
            Ok(path) => self.announce(format!("saved {}", path.display())),
            Err(error) => self.complain(format!("no {what} saved: {error}")),
        }
    }

    pub(super) fn toggle_recording(&mut self) {
        let now = Instant::now();
        match &mut self.recorder {
            Some(recorder) if recorder.is_recording() => recorder.stop(now),
            Some(_) => {
                self.records_next = !self.records_next;
                let next = if self.records_next {
                    "the next begins once the last is written"
                } else {
                    "no other one"
                };
                self.say(format!("recording: {next}"));
            }
            None => {
                let Some(picture) = self.picture(now) else { return };
                match Recorder::start(Path::new(""), self.session.name(), picture.as_ref(), now) {
                    Ok(recorder) => {
                        self.recorder = Some(recorder);
                        self.recording_since = now;
                        // There, Escape leaves the list.
                        let keys = if self.browser.is_some() { "V" } else { "V or Esc" };
                        self.say(format!("recording; {keys}: end"));
                    }
                    Err(error) => self.complain(format!("no recording: {error}")),
                }
            }
        }
        self.look_at_recorder(now);
    }

    /// Records what still stands there and could not be taken before.
    pub(super) fn record_again(&mut self, now: Instant) {
        self.recorder_again = None;
        if let Some(picture) = self.picture(now)
            && let Some(recorder) = &mut self.recorder
        {
            self.recorder_again = recorder.add_again(picture.as_ref(), now);
        }
    }

    /// Tells what became of a recording, and looks again before long where that is not known yet.
    pub(super) fn look_at_recorder(&mut self, now: Instant) {
        let Some(recorder) = &mut self.recorder else { return };
        let outcome = recorder.poll();
        // The dot's seconds go on, too.
        self.recorder_looks = outcome.is_none().then_some(now + RECORDER_LOOKS);
        match outcome {
            None => return,
            Some(Ok(recorded)) => self.announce(recorded.to_string()),
            Some(Err(error)) => {
                self.complain(format!("no recording saved: {error}"));
                self.records_next = false;
            }
        }
        self.recorder = None;
        if std::mem::take(&mut self.records_next) {
            self.toggle_recording();
        }
    }
}
