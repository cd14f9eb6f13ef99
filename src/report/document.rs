//! What a report is written with: rounded numbers for readers, tables, and CSV with whole ones.

use std::fmt::Display;

/// One part of the report: its text, its files, what is to be said first of it, and what failed or ran out of time in it.
#[derive(Debug, Default)]
pub(super) struct Section {
    pub(super) text: String,
    pub(super) files: Vec<(String, Vec<u8>)>,
    pub(super) in_short: Vec<String>,
    pub(super) failures: Vec<String>,
}

impl Section {
    /// Adds a paragraph.
    pub(super) fn say(&mut self, text: impl AsRef<str>) {
        self.text += text.as_ref();
        self.text += "\n\n";
    }

    pub(super) fn heading(&mut self, text: &str) {
        self.say(format!("## {text}"));
    }

    /// Shows a figure, whose PNG and SVG are among the files.
    pub(super) fn picture(&mut self, name: &str, about: &str) {
        self.say(format!("![{about}]({name}.png)\n\n*{about}* ([SVG]({name}.svg))"));
    }
}

/// A table: Markdown for readers.
#[derive(Debug)]
pub(super) struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    pub(super) fn new(header: &[&str]) -> Self {
        Self { rows: vec![header.iter().map(ToString::to_string).collect()] }
    }

    pub(super) fn row(&mut self, cells: Vec<String>) {
        self.rows.push(cells);
    }

    pub(super) fn markdown(&self) -> String {
        let line = |cells: &Vec<String>| {
            let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let mut rows = self.rows.iter().map(line);
        let header = rows.next().unwrap_or_default();
        let rule = "|---".repeat(self.rows.first().map_or(0, Vec::len));
        format!("{header}{rule}|\n{}", rows.collect::<String>())
    }
}

/// Comma-separated values, one row a line.
#[derive(Debug)]
pub(super) struct Csv(String);

impl Csv {
    pub(super) fn new(header: &str) -> Self {
        Self(format!("{header}\n"))
    }

    pub(super) fn row(&mut self, fields: &[&dyn Display]) {
        let fields: Vec<String> = fields.iter().map(|field| quoted(&field.to_string())).collect();
        self.0 += &fields.join(",");
        self.0 += "\n";
    }

    pub(super) fn file(self, name: &str) -> (String, Vec<u8>) {
        (name.to_owned(), self.0.into_bytes())
    }
}

/// A field, in quotes where commas or quotes would break it.
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

/// A number to two digits: more than its measurement is worth is not shown.
pub(super) fn rounded(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if !(1e-3..1e5).contains(&size) {
        format!("{value:.1e}")
    } else {
        // Rounding may carry into another digit: it comes first.
        let short: f64 = format!("{value:.1e}").parse().unwrap_or(value);
        let digits = 1 - short.abs().log10().floor() as i32;
        format!("{short:.*}", digits.max(0) as usize)
    }
}

/// A time to two digits, with its unit.
pub(super) fn duration(seconds: f64) -> String {
    let (unit, scale) = match seconds {
        ..1e-6 => ("ns", 1e9),
        ..1e-3 => ("µs", 1e6),
        ..1.0 => ("ms", 1e3),
        _ => ("s", 1.0),
    };
    format!("{} {unit}", rounded(seconds * scale))
}

/// 10 to a power, as it is printed.
pub(super) fn power_of_ten(power: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digits = power.unsigned_abs().to_string();
    let raised = digits.bytes().map(|digit| DIGITS[usize::from(digit - b'0')]);
    let sign = if power < 0 { "⁻" } else { "" };
    format!("10{sign}{}", raised.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_two_digits() {
        for (value, wanted) in [
            (0.0, "0"),
            (1.0, "1.0"),
            (0.012_345, "0.012"),
            (0.099_9, "0.10"),
            (3.149, "3.1"),
            (12.7, "13"),
            (1234.0, "1200"),
            (-98765.0, "-99000"),
            (4.4e-13, "4.4e-13"),
            (1.26e7, "1.3e7"),
            (f64::NAN, "NaN"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(rounded(value), wanted);
        }
        assert_eq!(duration(3.21e-5), "32 µs");
        assert_eq!(duration(0.5), "500 ms");
        assert_eq!(duration(12.3), "12 s");
    }

    #[test]
    fn tables_and_csv_keep_their_columns() {
        let mut table = Table::new(&["a", "b"]);
        table.row(vec!["1".to_owned(), "x|y".to_owned()]);
        assert_eq!(table.markdown(), "| a | b |\n|---|---|\n| 1 | x\\|y |\n");
        let mut csv = Csv::new("a,b");
        csv.row(&[&0.1, &"so, \"it\""]);
        assert_eq!(csv.file("t.csv").1, b"a,b\n0.1,\"so, \"\"it\"\"\"\n");
    }
}
