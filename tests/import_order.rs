//! The house stays as drawn: which part of the program may import which, and libraries only where they belong.
//!
//! ```text
//! simulation  <-  scene  <-  session  <-  headless  <-  report, window  <-  the program
//! simulation  <-  paint               <-  headless
//! ```

use std::fs;
use std::path::{Path, PathBuf};

/// A part of the library, the parts of it that it may name, and the libraries that it may use.
const HOUSE: &[(&str, &[&str], &[&str])] = &[
    ("simulation", &[], &["glam", "proptest"]),
    ("scene", &["simulation"], &["glam", "rand", "serde", "strsim", "thiserror", "toml"]),
    ("session", &["simulation", "scene"], &["glam", "thiserror"]),
    (
        "paint",
        &["simulation"],
        &["ab_glyph", "epaint_default_fonts", "gif", "glam", "thiserror", "tiny_skia"],
    ),
    (
        "headless",
        &["simulation", "scene", "session", "paint"],
        &["gif", "indicatif", "serde", "serde_json", "tempfile", "thiserror", "tiny_skia"],
    ),
    (
        "report",
        // Of headless, how output files are written, and the progress bar.
        &["simulation", "scene", "headless"],
        &[
            "ab_glyph",
            "epaint_default_fonts",
            "glam",
            "plotters",
            "qd",
            "serde",
            "serde_json",
            "thiserror",
            "tiny_skia",
        ],
    ),
    (
        "window",
        &["simulation", "scene", "session", "paint", "headless"],
        &["glam", "pixels", "png", "rustix", "tempfile", "thiserror", "tiny_skia", "winit", "xkbcommon_dl"],
    ),
];

/// The one file of the physics that may know of threads, and what it may use that no other file there may.
const THREADS: (&str, &[&str]) = ("simulation/contact/team.rs", &["panic", "rayon", "sync", "thread"]);

/// Names that lib.rs re-exports, by the part that they come from.
const RE_EXPORTS: &[(&str, &str)] = &[
    ("OutOfRange", "simulation"),
    ("BuildError", "simulation"),
    ("EditError", "simulation"),
    ("Simulation", "simulation"),
    ("Solver", "simulation"),
    ("World", "simulation"),
    ("Ball", "simulation"),
    ("Scene", "scene"),
    ("SceneError", "scene"),
    ("Session", "session"),
    ("Command", "session"),
    ("Change", "session"),
];

fn files(part: &str) -> Vec<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let single = source.join(part).with_extension("rs");
    if single.exists() {
        return vec![single];
    }
    let mut folders = vec![source.join(part)];
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() { folders.push(path) } else { files.push(path) }
        }
    }
    assert!(!files.is_empty());
    files
}

/// The code of a file without comments, whose links may point anywhere.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    let code: Vec<&str> = text.lines().map(|line| line.split("//").next().unwrap()).collect();
    code.join("\n")
}

/// Every identifier that stands after `prefix` in `code`, whatever is before that.
fn named_anywhere(code: &str, prefix: &str) -> Vec<String> {
    let name = |at: usize| {
        code[at + prefix.len()..].chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
    };
    code.match_indices(prefix).map(|(at, _)| name(at)).collect()
}

/// Every identifier that stands after `prefix` in `code`.
fn named(code: &str, prefix: &str) -> Vec<String> {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let behind = code.match_indices(prefix).filter(|(at, _)| !code[..*at].ends_with(is_name));
    behind.map(|(at, _)| code[at + prefix.len()..].chars().take_while(|&c| is_name(c)).collect()).collect()
}

#[test]
fn parts_import_only_what_lies_below_them() {
    for (part, below, _) in HOUSE {
        for file in files(part) {
            for name in named(&code(&file), "crate::") {
                let home =
                    RE_EXPORTS.iter().find(|(export, _)| *export == name).map_or(&*name, |(_, home)| home);
                assert!(home == *part || below.contains(&home), "{} names crate::{name}", file.display());
            }
        }
    }
}

#[test]
fn libraries_are_used_only_where_they_belong() {
    let manifest = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml")).unwrap();
    let manifest: toml::Table = manifest.parse().unwrap();
    let mut libraries: Vec<String> = Vec::new();
    let targets = manifest["target"].as_table().unwrap().values().map(|target| &target["dependencies"]);
    for table in targets.chain([&manifest["dependencies"], &manifest["dev-dependencies"]]) {
        libraries.extend(table.as_table().unwrap().keys().map(|name| name.replace('-', "_")));
    }
    assert!(libraries.contains(&"signal_hook".to_owned()) && libraries.contains(&"xkbcommon_dl".to_owned()));
    assert!(libraries.contains(&"winit".to_owned()) && libraries.contains(&"glam".to_owned()));
    for (part, _, allowed) in HOUSE {
        for file in files(part) {
            let code = code(&file);
            let may = |library: &str| allowed.contains(&library) || is_for_threads(&file, library);
            for library in libraries.iter().filter(|library| !may(library)) {
                let used = !named(&code, &format!("{library}::")).is_empty();
                assert!(!used, "{} uses {library}", file.display());
            }
        }
    }
}

/// Whether this is the file of the physics that may know of threads, and this one of its means.
fn is_for_threads(file: &Path, name: &str) -> bool {
    file.ends_with(THREADS.0) && THREADS.1.contains(&name)
}

#[test]
fn the_physics_knows_no_clock_and_no_files_and_one_file_alone_knows_of_threads() {
    assert!(files("simulation").iter().any(|file| file.ends_with(THREADS.0)));
    for file in files("simulation") {
        for module in named(&code(&file), "std::") {
            assert!(
                ["cmp", "collections", "error", "f64", "fmt", "hint", "iter", "mem", "ops", "slice", "str"]
                    .contains(&module.as_str())
                    || is_for_threads(&file, &module),
                "{}: std::{module}",
                file.display()
            );
        }
    }
}

/// Whatever rounds differently from one machine or one library of mathematics to the next; `powi` because its order of
/// multiplications is not promised, `mul_add` because it rounds once where others round twice. Of glam, what is made of
/// these.
const INEXACT: &[&str] = &[
    "acos",
    "acosh",
    "acos_approx",
    "angle_between",
    "angle_to",
    "asin",
    "asinh",
    "atan",
    "atan2",
    "atanh",
    "cbrt",
    "cos",
    "cosh",
    "exp",
    "exp2",
    "exp_m1",
    "from_angle",
    "hypot",
    "ln",
    "ln_1p",
    "log",
    "log10",
    "log2",
    "mul_add",
    "powf",
    "powi",
    "rotate_towards",
    "sin",
    "sin_cos",
    "sinh",
    "slerp",
    "tan",
    "tanh",
    "to_angle",
];

#[test]
fn the_physics_adds_multiplies_divides_and_takes_roots_and_nothing_else() {
    let mut calls = 0;
    for file in files("simulation") {
        // Tests may compare with whatever they like.
        let code = code(&file);
        let code = code.split("#[cfg(test)]").next().unwrap();
        let named: Vec<String> = [".", "::"].iter().flat_map(|before| named_anywhere(code, before)).collect();
        calls += named.iter().filter(|name| *name == "sqrt").count();
        for name in named {
            assert!(!INEXACT.contains(&&*name), "{}: {name}", file.display());
        }
    }
    assert!(calls > 5, "calls are found at all");
}

#[test]
fn every_part_of_the_library_stands_in_the_house() {
    let library = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs")).unwrap();
    for part in named(&library, "pub mod ") {
        assert!(HOUSE.iter().any(|(name, ..)| *name == part), "{part}");
    }
}
