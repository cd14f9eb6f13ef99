//! Outputs that change under the window: their scale, and which of them it is on.

use carom::DVec2;

use super::*;

/// An output to the right of the first.
const SECOND: &str = "HEADLESS-2";
/// Where that is, px of the layout.
const RIGHT_OF_FIRST: f64 = 1400.0;

/// A click in this place of the window, whose corner is there, adds a ball in this place of the world.
fn click_adds_a_ball_at(place: DVec2, corner: DVec2, window: &mut Window<'_>, number: u32) {
    window.sway.point(corner.x + place.x, corner.y + place.y);
    window.sway.click(LEFT);
    let balls = window.saved_balls("draw", number);
    assert_eq!(balls.len() as u32, 1 + number);
    assert_eq!(balls.last().unwrap().position(), place);
}

#[test]
#[ignore = "needs sway, wtype and grim; run with --ignored"]
fn a_scale_that_changes_under_the_window_keeps_the_world_and_the_pointers_place() {
    let sway = Sway::start();
    let mut window = sway.open(&["draw", "--size", "640x360"]);
    for (number, scale) in (1..).zip([2.0, 1.5, 1.0, 2.0]) {
        sway.tell(&format!("output {FIRST} scale {scale}"));
        let size = ((640.0 * scale) as u32, (360.0 * scale) as u32);
        window.wait(&format!("the picture at {scale}"), |window| window.fills(FIRST, size));
        let place = DVec2::new(300.0 + 50.0 * f64::from(number), 200.0);
        click_adds_a_ball_at(place, DVec2::ZERO, &mut window, number);
    }
    let (_, lines) = window.saved_replay("draw", 1);
    assert!(!lines.iter().any(|line| line.starts_with("resize")), "the world is as large at every scale");
}

/// How many pixels have the ink's colour, and whether squares of two by two are not alike: no picture of half the size
/// has that.
fn ink(shown: &Pixmap) -> (usize, bool) {
    let is_ink = |x, y| colour(shown, x, y).is_some_and(|parts| parts.iter().all(|&part| part > 0xb0));
    let squares = (0..360).flat_map(|y| (0..640).map(move |x| (2 * x, 2 * y)));
    let inked = squares.map(|(x, y)| {
        [(0, 0), (1, 0), (0, 1), (1, 1)].iter().filter(|(right, below)| is_ink(x + right, y + below)).count()
    });
    inked.fold((0, false), |(count, sharp), inked| (count + inked, sharp || (1..4).contains(&inked)))
}

#[test]
#[ignore = "needs sway, wtype and grim; run with --ignored"]
fn what_lies_over_the_picture_grows_with_the_scale_and_is_as_sharp() {
    let sway = Sway::start();
    // Beside the window at every scale: the pointer is in screenshots.
    sway.point(1390.0, 790.0);
    let mut window = sway.open(&["draw", "--size", "640x360", "--paused"]);
    for key in ["d", "h"] {
        let (without, _) = ink(&sway.screenshot(FIRST));
        sway.key(key);
        // Figures are of small letters in so small a window, above a strip that is left to notes.
        window.wait("ink", |_| ink(&sway.screenshot(FIRST)).0 > without + 100);
        let (small, _) = ink(&sway.screenshot(FIRST));
        // Four times the pixels, and more: thin strokes are less faint. The figures' digits may be others.
        for (scale, least, most) in [("2", 3 * small, 7 * small), ("1", small * 2 / 3, small * 3 / 2)] {
            sway.tell(&format!("output {FIRST} scale {scale}"));
            window.wait("as much ink, and sharp", |_| {
                let (ink, sharp) = ink(&sway.screenshot(FIRST));
                (least..=most).contains(&ink) && sharp
            });
        }
    }
}

#[test]
#[ignore = "needs sway, wtype and grim; run with --ignored"]
fn frames_follow_the_rate_of_the_output_that_the_window_is_on() {
    let sway = Sway::start();
    sway.tell("create_output");
    // Slow ones: frames must come in time on a busy machine, too.
    sway.tell(&format!("output {FIRST} mode --custom 1400x800@20Hz"));
    sway.tell(&format!("output {SECOND} mode --custom 1280x720@10Hz position {RIGHT_OF_FIRST} 0"));
    sway.tell(&format!("focus output {FIRST}"));
    let mut window = sway.open(&["elastic", "--size", "320x180"]);
    window.wait_rate(18..22);
    let mut number = 0;
    for (output, rates) in [(SECOND, 9..12), (FIRST, 18..22), (SECOND, 9..12)] {
        sway.tell(&format!("[app_id=carom] move container to output {output}, focus"));
        window.wait_rate(rates.clone());
        // The title's rate is of half a second, and a busy machine may stop everything in the next.
        window.wait(&format!("deltas of {rates:?} frames per second"), |window| {
            number += 1;
            let (_, lines) = window.saved_replay("elastic", number);
            let deltas = deltas(&lines);
            let mut last = deltas[deltas.len() - 5..].to_vec();
            last.sort_by(f64::total_cmp);
            let period = 1.0 / f64::from(rates.start);
            (0.7 * period..1.2 * period).contains(&last[2])
        });
    }
}

#[test]
#[ignore = "needs sway, wtype and grim; run with --ignored"]
fn on_an_output_of_another_scale_the_world_and_the_pointers_place_are_the_same() {
    let sway = Sway::start();
    sway.tell("create_output");
    sway.tell(&format!("output {SECOND} mode --custom 1280x720@30Hz position {RIGHT_OF_FIRST} 0 scale 2"));
    sway.tell(&format!("focus output {FIRST}"));
    let mut window = sway.open(&["draw", "--size", "640x360"]);
    for (number, (output, corner)) in (1..).zip([(FIRST, 0.0), (SECOND, RIGHT_OF_FIRST), (FIRST, 0.0)]) {
        sway.tell(&format!(
            "[app_id=carom] move container to output {output}, move absolute position {corner} 0, focus"
        ));
        let size = if output == FIRST { (640, 360) } else { (1280, 720) };
        window.wait("the picture", |window| window.fills(output, size));
        let place = DVec2::new(300.0 + 50.0 * f64::from(number), 200.0);
        click_adds_a_ball_at(place, DVec2::new(corner, 0.0), &mut window, number);
    }
}
