//! Animations: how long they last, and what they show.

use super::*;

#[test]
fn a_gif_lasts_as_long_as_the_simulated_time_at_any_frame_rate() {
    let here = folder();
    for fps in ["24", "60", "144", "7.5"] {
        succeed(
            &here,
            &["run", "walls", "--size", "320x240", "--seconds", "2", "--fps", fps, "--gif", "it.gif"],
        );
        let file = fs::File::open(here.path().join("it.gif")).unwrap();
        let mut decoder = gif::DecodeOptions::new().read_info(file).unwrap();
        assert_eq!((decoder.width(), decoder.height()), (320, 240));
        let (mut shown, mut shortest) = (0, u16::MAX);
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            shown += u32::from(frame.delay);
            shortest = shortest.min(frame.delay);
        }
        // In hundredths of a second; the last frame is shown for two of them when the time is over.
        assert!((200..=202).contains(&shown), "{fps} fps: {shown}");
        assert!(shortest >= 2, "browsers slow down frames of 1/100 s");
    }
}

#[test]
fn a_gif_of_an_hour_lasts_an_hour() {
    let here = folder();
    succeed(
        &here,
        &["run", "draw", "--size", "200x200", "--seconds", "3600", "--fps", "1", "--gif", "it.gif"],
    );
    let file = fs::File::open(here.path().join("it.gif")).unwrap();
    let mut decoder = gif::DecodeOptions::new().read_info(file).unwrap();
    let mut shown = 0;
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        shown += u32::from(frame.delay);
    }
    assert_eq!(shown, 360_000);
}

#[test]
fn a_run_longer_than_a_gif_may_last_is_refused_before_it_begins() {
    let here = folder();
    fs::write(here.path().join("days.txt"), "0\n600000\n600000\n").unwrap();
    let outputs = ["--gif", "it.gif", "--trace", "t.csv"];
    let days = [&["run", "draw", "--deltas", "days.txt"][..], &outputs].concat();
    let says = "it.gif: an animation may last 1000000 s, and this would last 1200000; ask for less time, or for no \
                animation (--seconds, --deltas or --commands, --gif)";
    fail(&here, &days, 2, says);
    let begun = Instant::now();
    let years = [&["run", "draw", "--seconds", "1e8", "--fps", "1000"][..], &outputs].concat();
    fail(
        &here,
        &years,
        2,
        "an animation may last 1000000 s, and this would last 100000000; ask for less time",
    );
    assert!(begun.elapsed() < Duration::from_secs(20), "known before what takes long");
    assert_eq!(names(here.path()), ["days.txt"]);
    // As is a replay's time, whatever it resets: nothing of its first frame is printed.
    let replay = "carom replay 1\nframe 600000\nreset\nframe 600000\n";
    fs::write(here.path().join("days.replay"), replay).unwrap();
    fail(&here, &["run", "draw", "--commands", "days.replay", "--gif", "it.gif", "--trace", "-"], 2, says);
    // How much of a frame that was cut short took place, only the run tells: of this one, all.
    let replay = "carom replay 1\nframe 600000\nframe 600000 1000000\n";
    fs::write(here.path().join("days.replay"), replay).unwrap();
    fail(&here, &[&["run", "draw", "--commands", "days.replay"][..], &outputs].concat(), 2, says);
    assert_eq!(names(here.path()), ["days.replay", "days.txt"]);
    // As long as one may last, it is written, also where the sum of its frames is rounded up.
    let longest = ["run", "draw", "--size", "50x50", "--seconds", "1e6", "--fps", "0.011", "--gif", "it.gif"];
    succeed(&here, &longest);
}

#[test]
fn a_gif_of_a_replay_without_frames_shows_what_its_changes_left() {
    let here = folder();
    fs::write(here.path().join("a.replay"), "carom replay 1\nremove-last\n").unwrap();
    let replay = ["run", "draw", "--commands", "a.replay", "--gif", "it.gif", "--image", "it.png"];
    succeed(&here, &replay);
    let picture = tiny_skia::Pixmap::load_png(here.path().join("it.png")).unwrap();
    let file = fs::File::open(here.path().join("it.gif")).unwrap();
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(file).unwrap();
    assert!(decoder.read_next_frame().unwrap().is_some_and(|frame| frame.buffer == picture.data()));
    assert!(decoder.read_next_frame().unwrap().is_none());
}

#[test]
fn a_gif_shows_the_last_frame_in_the_pictures_own_colours() {
    let here = folder();
    let args =
        ["run", "gravity", "--size", "320x240", "--seconds", "1", "--gif", "it.gif", "--image", "it.png"];
    succeed(&here, &args);
    let picture = tiny_skia::Pixmap::load_png(here.path().join("it.png")).unwrap();
    let file = fs::File::open(here.path().join("it.gif")).unwrap();
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(file).unwrap();
    let mut shown = vec![[0_u8; 4]; 320 * 240];
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        let (left, top, width) = (usize::from(frame.left), usize::from(frame.top), usize::from(frame.width));
        for (at, &pixel) in frame.buffer.as_chunks().0.iter().enumerate() {
            if pixel[3] > 0 {
                shown[(top + at / width) * 320 + left + at % width] = pixel;
            }
        }
    }
    for ([red, green, blue, _], pixel) in shown.into_iter().zip(picture.pixels()) {
        let (gif, png) = ([red, green, blue], [pixel.red(), pixel.green(), pixel.blue()]);
        if [[26, 26, 26], [0, 255, 212], [255, 102, 255]].contains(&png) {
            assert_eq!(gif, png, "the three colours are exact");
        }
        let distance = gif.iter().zip(png).map(|(&a, b)| a.abs_diff(b)).max().unwrap();
        assert!(distance <= 10, "edges are near: {gif:?} {png:?}");
    }
}
