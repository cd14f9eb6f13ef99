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
