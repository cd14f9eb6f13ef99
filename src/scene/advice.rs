//! What to write instead, for what the parser says of a scene file.

use strsim::osa_distance;

use super::values::TWO_NUMBERS;
use crate::simulation::Solver;

/// A key or a table of a scene file.
struct Known {
    name: &'static str,
    /// How it is written.
    example: &'static str,
    /// The tables that have it; empty where it belongs to none.
    tables: &'static str,
}

const fn known(name: &'static str, example: &'static str, tables: &'static str) -> Known {
    Known { name, example, tables }
}

const KNOWN: [Known; 23] = [
    known("about", "about = \"Two balls\"", ""),
    known("solver", "solver = \"exact\"", ""),
    known("size", "size = [1280, 720]", ""),
    known("gravity", "gravity = [0, 980]", ""),
    known("walls", "[walls]", ""),
    known("pairs", "[pairs]", ""),
    known("ball", "[[ball]]", ""),
    known("fill", "[[fill]]", ""),
    known("rain", "[rain]", ""),
    known("response", "response = \"impulse\"", "[pairs]"),
    known("position", "position = [30, 50]", "[[ball]]"),
    known("velocity", "velocity = [-100, 390]", "[[ball]]"),
    known("fixed", "fixed = true or fixed = false", "[[ball]]"),
    known("wide", "wide = true or wide = false", "[[ball]]"),
    known("radius", "radius = 30", "[[ball]], [[fill]] or [rain]"),
    known("mass", "mass = 30", "[[ball]], [[fill]] or [rain]"),
    known("restitution", "restitution = 0.7", "[walls], [[ball]], [[fill]] or [rain]"),
    known("density", "density = 1", "[[fill]] or [rain]"),
    known("speed", "speed = 200", "[[fill]] or [rain]"),
    known("seed", "seed = 7", "[[fill]] or [rain]"),
    known("region", "region = [0, 0, 1280, 360]", "[[fill]] or [rain]"),
    known("count", "count = 1000", "[[fill]]"),
    known("rate", "rate = 200", "[rain]"),
];

impl Known {
    fn of(name: &str) -> Option<&'static Self> {
        KNOWN.iter().find(|known| known.name == name)
    }

    /// Whether it is a table, by its brackets.
    fn is_table(&self) -> bool {
        self.example.starts_with('[')
    }

    /// The words that it may be, where not any will do.
    fn words(&self) -> Vec<&'static str> {
        match self.name {
            "solver" => Solver::ALL.iter().map(|solver| solver.name()).collect(),
            "response" => vec!["impulse", "detect"],
            _ => Vec::new(),
        }
    }

    /// How it is written, with what its author meant where that can be told from `value`.
    fn example(&self, value: &str) -> String {
        let is_word = |word: &str| {
            !word.is_empty() && word.chars().all(|c| c.is_alphanumeric() || c == '-' || c == '_')
        };
        let words = self.words();
        if !words.is_empty() && !words.contains(&value) {
            format!("{}; choose from: {}", self.example, words.join(", "))
        } else if self.example.contains('"') && is_word(value) {
            format!("{} = \"{value}\"", self.name)
        } else {
            self.example.to_owned()
        }
    }
}

/// What is said of `[ball]` and `[fill]`.
const TWO_BRACKETS: &str =
    "this table may come more than once; write its name in two brackets: [[ball]], [[fill]]";
/// What is said of tables and arrays that are nested eighty deep and more.
const ONE_LEVEL: &str =
    "this is nested too deep; a scene file has no tables in tables, and no arrays in arrays";
/// What is said of a line that is none of TOML's.
const NO_LINE: &str = "this is neither a key with its value, such as radius = 30, nor a table's name in brackets, such as \
    [walls], nor a comment after #";
/// What is said where an array goes on into the next line.
const OPEN_ARRAY: &str =
    "an array that began before is still open here; close it with ], and put commas between its numbers";

/// What is said where a radius is missing: what the world's size is, the parser does not know yet.
const LESS_IN_A_SMALL_WORLD: &str = ", in px; in a world less than 60 px wide or high, at most half of that";

/// What is said where a mass is no number: of random balls, masses may differ.
const DIFFERENT_MASSES: &str = "; random balls whose masses differ have a density instead: density = 1";

/// The entry that the parser complains of.
struct Entry<'a> {
    /// The line, from where it says something.
    line: &'a str,
    /// The key or the table that it is about.
    name: &'a str,
    /// What stands after that key's equals sign, except a comment.
    value: &'a str,
}

impl<'a> Entry<'a> {
    /// The entry at the byte `offset` of a line.
    fn at(line: &'a str, offset: usize) -> Self {
        let before = line.get(..offset).unwrap_or(line);
        let text = line.trim_start_matches('\u{feff}').trim_start();
        // In an inline table, the last key before the fault.
        let equals = before.rfind('=').or_else(|| line.find(['=', ':']));
        let (name, value) = match equals {
            _ if text.starts_with('[') => (text, ""),
            Some(at) => (line[..at].rsplit(['{', ',', '=']).next().unwrap_or_default(), &line[at + 1..]),
            None => (text, ""),
        };
        Self { line: text, name: bare(name), value: value.split('#').next().unwrap_or_default().trim() }
    }

    fn known(&self) -> Option<&'static Known> {
        Known::of(self.name)
    }

    /// A message, and how the key is written.
    fn and_write(&self, message: &str) -> String {
        match self.known() {
            Some(known) if known.is_table() => {
                format!("{message}; write {}, or leave it out for none", known.example)
            }
            Some(known) => format!("{message}; write {}", known.example(self.value)),
            None => message.to_owned(),
        }
    }

    /// Where the parser finds no value, or takes for text whatever it cannot read.
    fn no_value(&self) -> String {
        match self.known() {
            _ if self.value.is_empty() => self.and_write(&format!("{} has no value", self.name)),
            Some(known) if known.is_table() => self.and_write("this is a table"),
            Some(known) if known.example.contains('"') => self.and_write("text stands in quotes"),
            Some(_) => {
                self.and_slashes(self.and_write(&format!("this is no value that {} may have", self.name)))
            }
            None => "this is neither a number, nor text in quotes, nor an array such as [30, 50]".to_owned(),
        }
    }

    /// Where something stands after what should be all.
    fn too_much(&self) -> String {
        let message = if self.line.starts_with('[') {
            "something stands after the table's name, where the line should end".to_owned()
        } else {
            self.and_write("something stands after the value, where the line should end")
        };
        self.and_slashes(message)
    }

    /// A message that two numbers are expected, and such ones as this key has.
    fn and_two_numbers(&self, message: &str) -> String {
        let example = self.known().and_then(|known| known.example.split_once(" = "));
        format!("{message}, such as {}", example.map_or("[30, 50]", |(_, value)| value))
    }

    /// A message, and what a comment begins with, if it looks as if there were one.
    fn and_slashes(&self, message: String) -> String {
        if self.line.contains("//") { message + "; a comment begins with #" } else { message }
    }
}

/// What the parser says of the byte `offset` of a line, with what to write instead.
pub(super) fn advice(said: &str, line: &str, offset: usize) -> String {
    let entry = Entry::at(line, offset);
    let begins = |starts: &[&str]| starts.iter().any(|start| said.starts_with(start));
    if begins(&["cannot recurse", "recursion limit"]) {
        ONE_LEVEL.to_owned()
    } else if said.contains("$__toml") {
        // How the parser passes dates on.
        entry.and_write("this is a date")
    } else if said.ends_with("expected a sequence") {
        TWO_BRACKETS.to_owned()
    } else if let Some(key) = quoted_after(said, "missing field ") {
        let less = if key == "radius" { LESS_IN_A_SMALL_WORLD } else { "" };
        Known::of(key).map_or(said.to_owned(), |known| format!("{said}; add {}{less}", known.example))
    } else if let Some(key) = quoted_after(said, "unknown field ") {
        misplaced(said, key)
    } else if said == "duplicate key" {
        twice(bare(line.get(offset..).unwrap_or_default()), entry.line.starts_with('['))
    } else if begins(&[
        "string values must be quoted",
        "invalid float, expected `",
        "invalid boolean, expected `",
    ]) {
        entry.no_value()
    } else if begins(&["missing comma between array elements", "unexpected `=` in array"]) {
        OPEN_ARRAY.to_owned()
    } else if begins(&["unexpected key or value"]) {
        entry.too_much()
    } else if begins(&["key with no value", "invalid key-value pair", "invalid unquoted key"]) {
        NO_LINE.to_owned()
    } else if said.ends_with("expected a boolean") {
        format!("{said}: true or false")
    } else if said.contains("expected a table: ") {
        format!("{}, or leave it out for none", in_toml(said))
    } else if said.ends_with(TWO_NUMBERS) {
        entry.and_two_numbers(&in_toml(said))
    } else if said.contains("such as") || begins(&["unknown variant"]) {
        let ranged = entry.name == "mass" && said.contains("type: sequence");
        in_toml(said) + if ranged { DIFFERENT_MASSES } else { "" }
    } else {
        entry.and_write(&in_toml(said))
    }
}

/// What our own types say of themselves, with TOML's names for what was found.
fn in_toml(said: &str) -> String {
    said.replace("type: map", "type: table")
        .replace("type: sequence", "type: array")
        .replace("floating point", "number")
        .replace(" as i128", "")
        .replace(" as u128", "")
}

/// What is said of a key that a table does not have.
fn misplaced(said: &str, key: &str) -> String {
    let in_ball = said.contains("`radius`");
    match Known::of(key) {
        Some(_) if key == "size" && in_ball => {
            "a ball's size is its radius; write radius = 30 (the world's size stands at the top of the file)"
                .to_owned()
        }
        Some(known) if known.is_table() => said.to_owned(),
        Some(known) if known.tables.is_empty() => format!(
            "{key} belongs to no table; write it at the top of the file, before the first name in brackets"
        ),
        Some(known) => format!("{key} does not belong here; write it below {}", known.tables),
        None => alike(said, key).map_or(said.to_owned(), |meant| format!("{said}; did you mean {meant}?")),
    }
}

/// The longest word that is held against keys: no slip of the finger makes a key longer.
const LONGEST_SLIP: usize = 20;

/// The key among those that the parser expects that a slip or two make of this one, the nearest first: a letter that is
/// added, left out or changed, or two that are swapped.
fn alike<'a>(said: &'a str, key: &str) -> Option<&'a str> {
    if key.len() > LONGEST_SLIP {
        return None;
    }
    let (_, expected) = said.split_once(", expected ")?;
    let keys = expected.split('`').skip(1).step_by(2).map(|known| (osa_distance(key, known), known));
    // Nearest is the same word with an s.
    let (slips, known) = keys.min_by_key(|&(slips, known)| (slips, !key.starts_with(known)))?;
    // Of a short word, two slips leave nothing.
    (slips <= (known.len() / 3).min(2)).then_some(known)
}

/// What is said of a name that is there twice.
fn twice(name: &str, is_table: bool) -> String {
    match name {
        "ball" | "fill" => TWO_BRACKETS.to_owned(),
        _ if is_table => format!("duplicate key: the table [{name}] comes once; leave the second one out"),
        _ => format!("duplicate key: {name} comes once in a table; leave one out, or begin another table"),
    }
}

/// A name without what stands around it and after it.
fn bare(text: &str) -> &str {
    let around = |c: char| c.is_whitespace() || "[]\"'\u{feff}".contains(c);
    text.trim_start_matches(around)
        .split(['=', ':', ']', '#'])
        .next()
        .unwrap_or_default()
        .trim_matches(around)
}

/// The word that the parser quotes after these words.
fn quoted_after<'a>(said: &'a str, words: &str) -> Option<&'a str> {
    said.strip_prefix(words)?.strip_prefix('`')?.split('`').next()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    #[test]
    fn how_each_key_of_each_table_is_written_is_known() {
        for table in ["", "[walls]", "[pairs]", "[[ball]]", "[[fill]]", "[rain]"] {
            let error = Scene::parse("keys.toml", &format!("{table}\nnone = 1\n")).unwrap_err().to_string();
            let (_, keys) = error.split_once(", expected ").unwrap();
            let keys: Vec<&str> = keys.lines().next().unwrap().split('`').skip(1).step_by(2).collect();
            assert!(!keys.is_empty(), "{error}");
            for key in keys {
                assert!(Known::of(key).is_some(), "{key} of {table}");
            }
        }
    }
}
