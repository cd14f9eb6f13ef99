//! Laws of recordings.

use std::fs;

use tempfile::TempDir;

use super::*;
use crate::paint::animation::tests::decode;

/// A picture that is other for every `number`.
fn picture(number: u32) -> Pixmap {
    let mut pixmap = Pixmap::new(40, 30).unwrap();
    let (pixels, _) = pixmap.data_mut().as_chunks_mut();
    for (index, pixel) in pixels.iter_mut().enumerate() {
        *pixel =
            if (number >> (index % 40).min(31)) & 1 == 1 { [0, 255, 212, 255] } else { [26, 26, 26, 255] };
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

    /// A recording of which nothing was shown yet.
    fn begin(&self) -> Recorder {
        Recorder::start(self.folder.path(), "gas", picture(0).as_ref(), self.start).unwrap()
    }

    fn record(&self) -> Recorder {
        let mut recorder = self.begin();
        recorder.shown();
        recorder
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
        recorded.to_string().ends_with("carom-gas-1.gif (1.0 s); it ends where the window's size changed")
    );
    assert!(setting.seen() == [(picture(0), 50), (picture(1), 50)]);
}

#[test]
fn a_recording_begins_with_the_first_picture_that_is_shown_whatever_size_it_has() {
    let setting = Setting::new();
    let mut recorder = setting.begin();
    let [first, second] = [9, 250].map(|grey| {
        let mut picture = Pixmap::new(50, 20).unwrap();
        picture.fill(tiny_skia::Color::from_rgba8(grey, grey, grey, 255));
        picture
    });
    assert_eq!(recorder.add(picture(1).as_ref(), setting.at(5)), None, "painted, but never shown");
    assert_eq!(recorder.add(first.as_ref(), setting.at(10)), None);
    recorder.shown();
    recorder.add(second.as_ref(), setting.at(110));
    let recorded = recorder.finish(setting.at(210)).unwrap().unwrap();
    assert_eq!((recorded.resized, recorded.seconds, recorded.left_out), (false, 0.2, 0));
    assert!(setting.seen() == [(first, 10), (second, 10)]);
}

#[test]
fn a_recording_that_ends_before_anything_is_shown_is_of_what_was_to_be_seen() {
    let setting = Setting::new();
    setting.begin().finish(setting.at(100)).unwrap().unwrap();
    assert!(setting.seen() == [(picture(0), 10)]);
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

#[test]
fn a_recording_that_is_ended_from_elsewhere_has_its_end_there_and_what_is_not_known_is_not_told_as_saved() {
    let setting = Setting::new();
    let mut recorder = setting.record();
    assert!(recorder.add(picture(1).as_ref(), setting.at(100)).is_none());
    // Not through UNDER_WAY, where the recordings of other tests come and go at the same time.
    let (frames, (tell, saved)) = (recorder.frames.clone().unwrap(), mpsc::channel());
    drop(tell);
    let lost = UnderWay { frames, start: setting.start, saved }.end(setting.at(300));
    assert_eq!(lost, "no recording saved: what writes it has ended");
    let recorded = outcome(&mut recorder).unwrap();
    assert_eq!(recorded.path, setting.path(1));
    let seen = setting.seen();
    assert_eq!(seen.iter().map(|&(_, delay)| delay).collect::<Vec<_>>(), [10, 20]);
}

#[test]
fn who_ends_a_recording_from_another_thread_is_told_its_file() {
    let setting = Setting::new();
    let mut recorder = setting.begin();
    // Before anything is shown.
    let saved = recorder.saved.take().unwrap();
    recorder.shown();
    let under_way = UnderWay { frames: recorder.frames.clone().unwrap(), start: setting.start, saved };
    let said = thread::spawn(move || under_way.end(Instant::now())).join().unwrap();
    assert_eq!(said, format!("saved {}", setting.path(1).display()));
    assert_eq!(setting.seen().len(), 1);
}
