//! Nothing that is put in breaks it: scene files, deltas and games of any bytes.
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
    fn whatever_is_played_keeps_the_laws(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        play::play(&bytes);
    }
}
