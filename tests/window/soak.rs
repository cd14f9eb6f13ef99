//! Whatever keys and mouse do, for however long, the window goes on.

use std::time::{Duration, Instant};

use super::display::*;

/// How long the soak lasts, s, where the environment does not say.
const SECONDS: u64 = 60;
/// What the program itself may take in one turn of its event loop, ms. Without optimisation all takes ten times as long;
/// that is a watchdog then.
fn own_most() -> f64 {
    if cfg!(debug_assertions) && std::env::var_os("CAROM_PROGRAM").is_none() { 2500.0 } else { 250.0 }
}

/// What there may be more of resident memory in the last quarter than in the one before: this share, and this much, MB.
const GROWTH: (f64, f64) = (1.1, 8.0);

/// All keys that do something, except Escape, which ends the program.
const KEYS: [&str; 44] = [
    "a",
    "shift+a",
    "BackSpace",
    "r",
    "shift+r",
    "space",
    "period",
    "Right",
    "Left",
    "shift+Right",
    "bracketleft",
    "bracketright",
    "s",
    "g",
    "ctrl+Right",
    "ctrl+Left",
    "ctrl+Up",
    "ctrl+Down",
    "x",
    "d",
    "t",
    "h",
    "F1",
    "m",
    "v",
    "Tab",
    "shift+Tab",
    "1",
    "2",
    "3",
    "4",
    "5",
    "6",
    "7",
    "8",
    "F11",
    "F12",
    "ctrl+s",
    "ctrl+shift+s",
    "Return",
    "Up",
    "Down",
    "q",
    "alt+F3",
];

/// The same choices for the same seed (Steele, Lea, Flood 2014: splitmix64).
struct Choices(u64);

impl Choices {
    fn below(&mut self, most: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (mixed ^ (mixed >> 31)) % most
    }

    fn place(&mut self) -> [String; 3] {
        ["mousemove".to_owned(), self.below(1280).to_string(), self.below(720).to_string()]
    }

    /// What xdotool is to do next in this window.
    fn next(&mut self, id: &str) -> Vec<String> {
        let words = |words: &[&str]| words.iter().map(|&word| word.to_owned()).collect::<Vec<_>>();
        let button = ["1", "1", "1", "3", "2", "8"][self.below(6) as usize];
        match self.below(40) {
            0..16 => words(&["key", KEYS[self.below(KEYS.len() as u64) as usize]]),
            16 => words(&["key", "--repeat", "20", "--delay", "5", KEYS[self.below(15) as usize]]),
            17 => words(&["keydown", "Left", "sleep", "0.4", "keyup", "Left"]),
            18..25 => self.place().to_vec(),
            25..30 => [&self.place()[..], &words(&["click", button])].concat(),
            30..34 => {
                let (from, to) = (self.place(), self.place());
                [&from[..], &words(&["mousedown", "1", "sleep", "0.05"]), &to, &words(&["mouseup", "1"])]
                    .concat()
            }
            34..37 => {
                let (wheel, notches) = (["4", "5"][self.below(2) as usize], 1 + self.below(12));
                words(&["click", "--repeat", &notches.to_string(), "--delay", "2", wheel])
            }
            37 => words(&[
                "windowunmap",
                id,
                "sleep",
                "0.1",
                "windowmap",
                id,
                "sleep",
                "0.1",
                "windowfocus",
                id,
            ]),
            _ => {
                let size = |most: u64, choices: &mut Self| (1 + choices.below(most)).to_string();
                let (width, height) = match self.below(3) {
                    0 => (size(40, self), size(40, self)),
                    1 => ("1280".to_owned(), "720".to_owned()),
                    _ => (size(1400, self), size(800, self)),
                };
                words(&["windowsize", id, &width, &height])
            }
        }
    }
}

/// Ends the window by Escape, however many things lie over it; what it said of its time: the processor time of the
/// longest turn, ms, without what a hypervisor stole meanwhile, which counts in part as the program's.
fn end_and_ask(window: &mut Window<'_>) -> f64 {
    let start = Instant::now();
    while window.runs() {
        assert!(start.elapsed() < PATIENCE, "Escape ends it: {}", window.title());
        window.mouse(&["windowfocus", &window.id, "key", "Escape"]);
        std::thread::sleep(Duration::from_millis(200));
    }
    let (status, said) = window.end_saying();
    assert!(status.success() && !said.contains("panic"), "{status}: {said}");
    let longest = said.lines().find(|line| line.starts_with("certain")).unwrap_or_else(|| panic!("{said}"));
    println!("{}", &said[said.find("frame times").unwrap()..]);
    longest.rsplit(' ').next().unwrap().parse().unwrap()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// `CAROM_SOAK_SECONDS` and `CAROM_SOAK_SEED` say how long and what.
#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn random_keys_mouse_and_sizes_neither_end_nor_slow_nor_fatten_the_window() {
    let number = |name: &str, default| std::env::var(name).map_or(default, |text| text.parse().unwrap());
    let seconds = number("CAROM_SOAK_SECONDS", SECONDS);
    let seed = number("CAROM_SOAK_SEED", 1);
    let display = Display::start();
    let mut window = display.open_talking(&["gravity", "--timings"], "1");
    let (mut choices, mut memory, mut events) = (Choices(seed), Vec::new(), 0);
    let (start, length) = (Instant::now(), Duration::from_secs(seconds));
    // Of every two seconds, memory is taken where the same is shown: a scene that has just begun. An allocator keeps what
    // was ever needed at one time, in whatever scene: the first half of the soak finds that out.
    while start.elapsed() < length {
        let round = Instant::now();
        while round.elapsed() < Duration::from_secs(2) {
            let id = window.id.clone();
            let batch = ["windowfocus".to_owned(), id.clone()].into_iter();
            let batch: Vec<String> = batch.chain((0..8).flat_map(|_| choices.next(&id))).collect();
            window.mouse(&batch.iter().map(String::as_str).collect::<Vec<_>>());
            events += 8;
            assert!(window.runs(), "after {events} events: {}", window.said());
        }
        for file in std::fs::read_dir(window.folder.path()).unwrap() {
            let _ = std::fs::remove_file(file.unwrap().path());
        }
        window.mouse(&[
            "keyup",
            "Left",
            "mouseup",
            "1",
            "windowsize",
            &window.id.clone(),
            "1280",
            "720",
            "key",
            "8",
        ]);
        if start.elapsed() > length / 2 {
            memory.push(window.memory());
        }
    }
    let longest = end_and_ask(&mut window);
    let (first, second) = memory.split_at(memory.len() / 2);
    let (first, second) = (mean(first), mean(second));
    let span = memory.iter().fold((f64::MAX, 0.0_f64), |(low, high), &at| (low.min(at), high.max(at)));
    println!("{events} events in {seconds} s, seed {seed}; longest turn {longest} ms; memory {span:.0?} MB,");
    println!("mean of the third quarter {first:.1} MB, of the fourth {second:.1} MB");
    assert!(second < GROWTH.0 * first + GROWTH.1, "memory grows: {memory:.0?}");
    // Balls that a tiny window presses together take `exact` and `contact` seconds between two looks at the watch: told
    // above, and held against the limit only where an optimised program is measured.
    if std::env::var_os("CAROM_PROGRAM").is_some() {
        assert!(longest < own_most(), "the longest turn took {longest} ms");
    }
}

#[test]
#[ignore = "needs Xvfb, xdotool and ImageMagick; run with --ignored"]
fn a_window_that_is_asked_for_a_million_balls_at_once_answers_meanwhile_and_after() {
    let display = Display::start();
    let mut window = display.open(&["elastic", "--timings"]);
    window.mouse(&[
        "keydown",
        "shift",
        "key",
        "--repeat",
        "10000",
        "--repeat-delay",
        "0",
        "--delay",
        "0",
        "a",
        "keyup",
        "shift",
    ]);
    // There is work left for a while; what is asked for now does not wait for it.
    window.key("r");
    window.wait_title("15 balls");
    window.key("space");
    window.wait_title("paused");
    window.key("shift+a");
    window.wait_title("115 balls");
    let longest = end_and_ask(&mut window);
    assert!(longest < own_most(), "the longest turn took {longest} ms");
}
