//! Nothing that is put in breaks it: scene files, deltas, replays and games of any bytes.
//!
//! The same inputs every time: chance is the fuzz targets' (fuzz/), and what they find goes to tests/findings/.

use std::path::Path;

use carom::Scene;
use carom::headless::Frames;
use carom::scene::names;
use carom::simulation::limits::DELTA;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use proptest::test_runner::RngSeed;

#[path = "common/play.rs"]
mod play;
#[path = "common/replaying.rs"]
mod replaying;

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(1),
        ..ProptestConfig::with_cases(cases)
    }
}

/// The scenes that are written by hand.
fn written() -> impl Strategy<Value = String> {
    let all: Vec<_> = names().into_iter().filter(|name| !["column", "galton"].contains(name)).collect();
    select(all).prop_map(|name| Scene::load(name).unwrap().source().to_owned())
}

/// What may stand where something else stood.
fn word() -> impl Strategy<Value = String> {
    let words = "about solver size gravity walls pairs ball fill rain position radius velocity mass restitution fixed \
                 response count speed density seed region rate [ ] [[ball]] [[fill]] [walls] [pairs] [rain] = . , \" ''' { } \
                 # true false inf nan -1 0 0.5 1e308 -1e-320 9223372036854775807 1979-05-27 \"exact\" \"detect\" é";
    let words: Vec<&str> = words.split_whitespace().chain(["\n", "\r", "\0", "\t", ""]).collect();
    prop_oneof![
        select(words).prop_map(str::to_owned),
        "[ -~]{0,4}",
        any::<f64>().prop_map(|x| format!("{x:?}"))
    ]
}

/// A scene file, some of whose words are others.
fn mutated() -> impl Strategy<Value = String> {
    let change = (any::<Index>(), word(), any::<bool>());
    (written(), prop::collection::vec(change, 1..5)).prop_map(|(mut text, changes)| {
        for (at, word, replaces) in changes {
            let ends: Vec<usize> = text
                .char_indices()
                .filter(|&(_, c)| !c.is_alphanumeric() && c != '.')
                .map(|(at, _)| at)
                .chain([text.len()])
                .collect();
            let place = at.index(ends.len());
            let until = if replaces { *ends.get(place + 1).unwrap_or(&text.len()) } else { ends[place] };
            text.replace_range(ends[place]..until, &word);
        }
        text
    })
}

/// A number, of those that are likely to be taken and of those that are not.
fn number() -> impl Strategy<Value = String> {
    let numbers = ["0", "1", "2", "20", "1e-320", "-1", "nan", "1e7"];
    prop_oneof![
        2 => select(numbers.to_vec()).prop_map(str::to_owned),
        2 => (0.0..0.1).prop_map(|x: f64| format!("{x}")),
        2 => (0.0..1500.0).prop_map(|x: f64| format!("{x}")),
        1 => (-1000.0..1000.0).prop_map(|x: f64| format!("{x}")),
        1 => any::<f64>().prop_map(|x| format!("{x:e}")),
    ]
}

/// A line of a replay, mostly one that can be read.
fn replay_line() -> impl Strategy<Value = String> {
    let numbers = |word: &'static str, count: usize| {
        prop::collection::vec(number(), count)
            .prop_map(move |numbers| format!("{word} {}", numbers.join(" ")))
    };
    let index = |word: &'static str| (0..20_u32).prop_map(move |index| format!("{word} {index}"));
    let fixed = ["reset", "remove-last", "toggle-gravity", "compare on", "compare off", "# a comment", ""];
    let solvers = ["solver canvas", "solver exact", "solver contact"];
    prop_oneof![
        6 => (0.0..0.1).prop_map(|seconds: f64| format!("frame {seconds}")),
        2 => ((0.0..2.0), (1..20_u32)).prop_map(|(seconds, cut): (f64, u32)| format!("frame {seconds} {cut}")),
        1 => numbers("frame", 1),
        2 => select(fixed.to_vec()).prop_map(str::to_owned),
        2 => select(solvers.to_vec()).prop_map(str::to_owned),
        2 => index("add-random"),
        1 => index("reseed"),
        1 => index("remove"),
        1 => numbers("add-ball", 5),
        1 => (index("carry"), numbers("", 2)).prop_map(|(word, place)| word + &place),
        1 => (index("place"), numbers("", 2)).prop_map(|(word, place)| word + &place),
        1 => numbers("tilt-gravity", 2),
        1 => numbers("resize", 2),
    ]
}

/// A replay, most of whose lines can be read.
fn replay() -> impl Strategy<Value = String> {
    let scenes = ["gravity", "elastic", "detect", "cradle", "rain", "bullet"];
    let lines = prop::collection::vec(replay_line(), 0..30);
    let odd = prop::option::weighted(0.2, (any::<Index>(), prop_oneof![word(), any::<String>()]));
    (select(scenes.to_vec()), any::<u64>(), lines, odd).prop_map(|(scene, seed, mut lines, odd)| {
        if let Some((at, odd)) = odd {
            lines.insert(at.index(lines.len() + 1), odd);
        }
        format!("carom replay 1\nscene {scene}\nseed {seed}\n{}\n", lines.join("\n"))
    })
}

/// A text is a scene, or an error that names the file and says more than that.
fn judge_scene(text: &str) {
    match Scene::parse("mutated.toml", text) {
        Ok(scene) => assert_eq!(scene.source(), text),
        Err(error) => {
            let message = error.to_string();
            assert!(message.starts_with("mutated.toml") && message.len() > 20, "{message}\n{text}");
        }
    }
}

proptest! {
    #![proptest_config(config(2000))]

    #[test]
    fn a_scene_file_with_other_words_in_it_is_a_scene_or_an_error_that_says_where(text in mutated()) {
        judge_scene(&text);
    }

    #[test]
    fn any_text_is_a_scene_or_an_error_that_says_something(text in any::<String>()) {
        judge_scene(&text);
    }

    #[test]
    fn any_text_is_a_list_of_deltas_or_an_error_that_says_something(
        lines in prop::collection::vec(prop_oneof![4 => word(), 1 => any::<String>()], 0..20)
    ) {
        match Frames::parse(Path::new("any.txt"), &lines.join("\n")) {
            Ok(frames) => {
                prop_assert!(frames.count() > 0);
                prop_assert!((0..frames.count()).all(|frame| DELTA.check(frames.delta(frame)).is_ok()));
            }
            Err(error) => prop_assert!(error.to_string().starts_with("any.txt") && error.to_string().len() > 20),
        }
    }
}

proptest! {
    #![proptest_config(config(400))]

    #[test]
    fn a_replay_is_refused_with_its_line_or_is_written_as_it_was_read_and_plays_by_the_laws(text in replay()) {
        replaying::judge(&text);
    }

    #[test]
    fn whatever_is_played_keeps_the_laws(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        play::play(&bytes);
    }
}
