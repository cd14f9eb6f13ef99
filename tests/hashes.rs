//! The same bits everywhere: the state of every built-in scene, with each solver that suits it, after 1,000 frames of
//! 1/60 s, in debug and release, with and without the default features, on x86-64 and (`.ci/aarch64`) on aarch64.
//!
//! The table is `tests/data/hashes.txt`. Where a change of the physics is meant,
//!
//! ```text
//! CAROM_WRITE_HASHES=1 cargo test --test hashes -- --nocapture
//! ```
//!
//! writes it anew and prints which lines are others; look at them before the commit.

use std::path::PathBuf;
use std::sync::Mutex;
use std::{env, fs, thread};

use carom::{Scene, Solver};

#[path = "common/suits.rs"]
mod suits;

/// The 64-bit FNV-1a hash of these words, lowest byte first.
fn hash(words: impl IntoIterator<Item = u64>) -> u64 {
    let bytes = words.into_iter().flat_map(u64::to_le_bytes);
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// The line of the table for a scene and a solver.
fn line(name: &str, solver: Solver) -> String {
    let scene = Scene::load(name).unwrap().with_solver(solver);
    let (mut simulation, mut rain) = (scene.build().unwrap(), scene.rain());
    for frame in 0..1000 {
        let delta = if frame == 0 { 0.0 } else { 1.0 / 60.0 };
        match &mut rain {
            Some(rain) => drop(rain.advance_while(&mut simulation, delta, || true).unwrap()),
            None => simulation.advance(delta).unwrap(),
        }
    }
    let tally = simulation.tally();
    let balls = simulation.balls().iter().zip(simulation.touching()).flat_map(|(ball, &touching)| {
        let (p, v) = (ball.position(), ball.velocity());
        [p.x.to_bits(), p.y.to_bits(), v.x.to_bits(), v.y.to_bits(), u64::from(touching)]
    });
    let hash = hash(balls.chain([tally.impacts, tally.wall_hits, simulation.time().to_bits()]));
    format!("{name} {solver} {hash:016x}")
}

/// The lines of the whole table, found on as many threads as there are.
fn lines() -> Vec<String> {
    let runs = Mutex::new(suits::runs().enumerate());
    let found = Mutex::new(Vec::new());
    let take = || runs.lock().unwrap().next();
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                while let Some((index, (scene, solver))) = take() {
                    let line = line(scene, solver);
                    found.lock().unwrap().push((index, line));
                }
            });
        }
    });
    let mut found = found.into_inner().unwrap();
    found.sort_unstable();
    found.into_iter().map(|(_, line)| line).collect()
}

#[test]
fn every_scene_comes_to_the_same_bits_on_every_machine() {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/hashes.txt");
    let known = fs::read_to_string(&path).unwrap_or_default();
    let found = lines();
    let differing: Vec<&String> =
        found.iter().filter(|&line| !known.lines().any(|known| known == line)).collect();
    if env::var_os("CAROM_WRITE_HASHES").is_some() {
        for line in &differing {
            println!("+ {line}");
        }
        fs::write(&path, found.join("\n") + "\n").unwrap();
        return;
    }
    assert!(differing.is_empty(), "not in {}: {differing:#?}", path.display());
    assert_eq!(known.lines().count(), found.len(), "{} has lines of no scene", path.display());
}
