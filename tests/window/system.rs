//! Files that the window saves, how it ends, and what it says where there can be none.

use std::io::Write;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::os::unix::process::ExitStatusExt;
use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};

use tiny_skia::Pixmap;

use super::display::*;

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn pictures_are_saved_and_overwrite_nothing() {
    let display = Display::start();
    let mut window = display.open(&["gravity", "--paused"]);
    window.key("F12");
    window.wait_title("saved carom-gravity-1.png");
    window.key("F12");
    window.wait_title("saved carom-gravity-2.png");
    let saved = Pixmap::load_png(window.folder.path().join("carom-gravity-1.png")).unwrap();
    assert_eq!(saved.data(), picture(&["gravity"]).data());
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn escape_ends_with_0() {
    let display = Display::start();
    let window = display.open(&[]);
    window.key("Escape");
    assert!(window.end().success());
}

/// What carom says without a display and with a display that does not answer.
#[test]
fn without_a_display_the_message_says_what_to_do_instead() {
    for display in [None, Some(":4321")] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_carom"));
        command
            .arg("elastic")
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET");
        if let Some(display) = display {
            command.env("DISPLAY", display);
        }
        let output = command.output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{said}");
        // Where the keyboard's library is missing, that is said first.
        assert!(
            said.contains("no display to open a window on") || said.contains("apt install libxkbcommon"),
            "{said}"
        );
        assert!(said.contains("carom run elastic --gif elastic.gif"), "{said}");
        assert!(!said.contains(".rs:"), "no place in somebody's source: {said}");
    }
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn without_a_graphics_adapter_the_message_says_what_to_install() {
    let display = Display::start();
    let mut command = display.command(env!("CARGO_BIN_EXE_carom"));
    // No Vulkan driver, and no other backend.
    let command = command.env("VK_DRIVER_FILES", "/dev/null").env("VK_ICD_FILENAMES", "/dev/null");
    let output = command.env("WGPU_BACKEND", "vulkan").output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("no graphics adapter") && said.contains("mesa-vulkan-drivers"), "{said}");
    assert!(said.contains("carom run gravity --gif gravity.gif"), "{said}");
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_display_that_ends_under_the_window_is_no_panic() {
    for args in [&["elastic"][..], &["elastic", "--paused"]] {
        let display = Display::start();
        let mut window = display.open(args);
        display.fail();
        let (status, said) = window.end_saying();
        assert_eq!(status.code(), Some(1), "{said}");
        // Xlib says so itself, in one way or another, and ends the program, where it notices first.
        let words = ["the display that the window was on is gone", "X connection", "on X server"];
        assert!(words.iter().any(|words| said.contains(words)), "{said}");
        assert!(!said.contains("panicked") && !said.contains(".rs:"), "{said}");
    }
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_signal_while_recording_saves_what_was_recorded_and_leaves_nothing_half_written() {
    for signal in ["INT", "TERM", "HUP"] {
        let display = Display::start();
        let mut window = display.open(&["elastic"]);
        window.key("v");
        window.wait("the recording", |window| !window.files().is_empty());
        // It begins with the first picture that is shown.
        sleep(Duration::from_secs(1));
        window.signal(signal);
        let (status, said) = window.end_saying();
        assert!(!status.success());
        let names = window.files();
        assert_eq!(names, ["carom-elastic-1.gif"], "{signal}: {said}");
        let gif = std::fs::read(window.folder.path().join(&names[0])).unwrap();
        assert!(gif.starts_with(b"GIF89a") && gif.ends_with(&[0x3b]), "{signal}: {} bytes", gif.len());
        assert!(said.contains("saved carom-elastic-1.gif"), "{signal}: {said}");
    }
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_second_signal_while_a_recording_is_finished_ends_the_window_at_once_and_leaves_nothing() {
    // A recording that is finished before the window could be stopped shows nothing of this: another one is tried.
    let was_unfinished = || {
        let display = Display::start();
        let mut window = display.open(&["elastic", "--balls", "300"]);
        window.key("v");
        window.wait("the recording", |window| !window.files().is_empty());
        sleep(Duration::from_secs(1));
        // Stopped, it does not finish the recording between the two.
        window.signal("INT");
        sleep(Duration::from_millis(20));
        window.signal("STOP");
        sleep(Duration::from_millis(500));
        let finished = window.files().iter().any(|name| !name.starts_with(".carom-"));
        window.signal("INT");
        window.signal("CONT");
        let (status, said) = window.end_saying();
        let left = window.files();
        assert_eq!(status.signal(), Some(2), "{said}");
        assert!(finished || left.is_empty(), "{left:?}: {said}");
        !finished
    };
    assert!((0..10).any(|_| was_unfinished()), "each of ten recordings was finished within 20 ms");
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_second_signal_ends_the_window_where_nobody_reads_its_last_words_and_the_same_sent_twice_is_one() {
    let display = Display::start();
    let (nobody, theirs) = UnixStream::pair().unwrap();
    let mut command = display.command(&program());
    command.args(["elastic", "--timings"]).stderr(OwnedFd::from(theirs.try_clone().unwrap()));
    let mut child = command.spawn().unwrap();
    wait("a window", || !display.ask("xdotool", &["search", "--name", "^carom"]).is_empty());
    theirs.set_nonblocking(true).unwrap();
    while (&theirs).write(&[0; 4096]).is_ok() {}
    theirs.set_nonblocking(false).unwrap();
    let id = child.id().to_string();
    let send = |signal: &str| drop(display.ask("kill", &["-s", signal, &id]));
    ["TERM", "TERM"].into_iter().for_each(send);
    sleep(Duration::from_secs(1));
    send("HUP");
    sleep(Duration::from_secs(1));
    let waits = child.try_wait().unwrap().is_none();
    send("INT");
    let begun = Instant::now();
    while child.try_wait().unwrap().is_none() && begun.elapsed() < PATIENCE {
        sleep(Duration::from_millis(20));
    }
    // One that does not end is not left behind.
    let _ = child.kill();
    let status = child.wait().unwrap();
    assert!(waits, "it ended before: {status}");
    assert_eq!(status.signal(), Some(2));
    drop(nobody);
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn timings_so_far_are_told_where_a_signal_ends_the_window() {
    for signal in ["INT", "TERM", "HUP"] {
        let display = Display::start();
        let mut window = display.open(&["elastic", "--timings"]);
        assert!(window.moves());
        window.signal(signal);
        let (status, said) = window.end_saying();
        assert_eq!(status.code(), None, "it ends by the signal");
        let frames =
            said.split_once("frame times in ms, ").and_then(|(_, rest)| rest.split_once(" frames\n"));
        let (frames, parts) = frames.unwrap_or_else(|| panic!("{said}"));
        assert!(frames.parse::<u32>().unwrap() > 0 && parts.contains("present   median"), "{said}");
    }
}
