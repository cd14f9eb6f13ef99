//! What to write instead, for what the parser says of a scene file.

/// How each key is written.
const KEYS: [(&str, &str); 19] = [
    ("about", "about = \"Two balls\""),
    ("solver", "solver = \"exact\""),
    ("size", "size = [1280, 720]"),
    ("gravity", "gravity = [0, 980]"),
    ("walls", "[walls]"),
    ("pairs", "[pairs]"),
    ("response", "response = \"impulse\""),
    ("position", "position = [30, 50]"),
    ("velocity", "velocity = [-100, 390]"),
    ("radius", "radius = 30"),
    ("mass", "mass = 30"),
    ("density", "density = 1"),
    ("restitution", "restitution = 0.7"),
    ("fixed", "fixed = true"),
    ("wide", "wide = true"),
    ("count", "count = 1000"),
    ("rate", "rate = 200"),
    ("speed", "speed = 200"),
    ("region", "region = [0, 0, 1280, 360]"),
];
/// The keys that belong to no table.
const AT_THE_TOP: [&str; 4] = ["about", "solver", "size", "gravity"];
/// What is said of `[ball]` and `[fill]`.
const ONE_BRACKET: &str =
    "this table may come more than once; write its name in two brackets: [[ball]], [[fill]]";
/// What is said of tables and arrays that are nested a hundred deep and more.
const ONE_LEVEL: &str =
    "this is nested too deep; a scene file has no tables in tables, and no arrays in arrays";
/// What is said of a line that is none of TOML's.
const NO_LINE: &str = "this is neither a key with its value, such as radius = 30, nor a table's name in brackets, such as \
    [walls], nor a comment behind #";

/// What the parser says of `line`, with what to write instead.
pub(super) fn advice(said: &str, line: &str) -> String {
    let (subject, example) = subject(line);
    let or_so = |message: &str| match example {
        Some(example) => format!("{message}; write {example}"),
        None => message.to_owned(),
    };
    if said.contains("recurs") {
        return ONE_LEVEL.to_owned();
    }
    if said.contains("expected a sequence") {
        return ONE_BRACKET.to_owned();
    }
    if let Some(key) = quoted_after(said, "missing field ") {
        let example = KEYS.iter().find(|known| known.0 == key);
        return example.map_or(said.to_owned(), |(_, example)| format!("{said}; add {example}"));
    }
    if let Some(key) = quoted_after(said, "unknown field ") {
        return if AT_THE_TOP.contains(&key) {
            format!(
                "{key} belongs to no table; write it at the top of the file, before the first name in brackets"
            )
        } else {
            said.to_owned()
        };
    }
    if said == "duplicate key" {
        return if line.starts_with('[') {
            format!("duplicate key: the table [{subject}] comes once; leave the second one out")
        } else {
            format!("duplicate key: {subject} comes once in a table; leave one out, or begin another table")
        };
    }
    if said.starts_with("string values must be quoted") {
        // The parser takes for text whatever it cannot read.
        return match example {
            Some(example) if example.contains('"') => format!("text stands in quotes; write {example}"),
            Some(example) => format!("this is no value that {subject} may have; write {example}"),
            None => "this is neither a number, nor text in quotes, nor an array such as [30, 50]".to_owned(),
        };
    }
    if said.starts_with("missing comma between array elements") {
        return "an array that began before is still open here; close it with ], or put a comma behind its last number"
            .to_owned();
    }
    if said.starts_with("unexpected key or value") {
        return or_so("something stands behind the value, where the line should end");
    }
    if said.starts_with("key with no value") || said.starts_with("invalid key-value pair") {
        return NO_LINE.to_owned();
    }
    if said.ends_with("expected a boolean") {
        return format!("{said}: true or false");
    }
    if said.contains("such as") || said.contains("expected a table") || said.starts_with("unknown variant") {
        // What our own types say of themselves.
        return said.to_owned();
    }
    or_so(said)
}

/// The key or the table that a line is about, and how that is written.
fn subject(line: &str) -> (&str, Option<&'static str>) {
    let name = line.split(['=', ':']).next().unwrap_or_default();
    let name = name.trim_matches(|c: char| c.is_whitespace() || "[]\"'".contains(c));
    let example = KEYS.iter().find(|known| known.0 == name).map(|known| known.1);
    (name, example)
}

/// The word that the parser quotes behind these words.
fn quoted_after<'a>(said: &'a str, words: &str) -> Option<&'a str> {
    said.strip_prefix(words)?.strip_prefix('`')?.split('`').next()
}
