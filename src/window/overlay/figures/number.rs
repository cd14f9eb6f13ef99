//! Numbers in a column: as wide as they may be, however large they are.

/// Characters of a number; none has more.
pub(super) const WIDTH: usize = 11;
/// What stands where there is no number.
const NONE: &str = "–";

/// A number with so many decimals, its digits in groups of three; with a power of ten where that would not fit or would
/// show nothing but zeros.
pub(super) fn number(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return NONE.to_owned();
    }
    let plain = format!("{value:.decimals$}");
    let is_zero = |text: &str| !text.contains(|digit| ('1'..='9').contains(&digit));
    if is_zero(&plain) && value != 0.0 {
        return power(value);
    }
    // A rounded number that shows as zero has no sign.
    let plain = if is_zero(&plain) { plain.trim_start_matches('-').to_owned() } else { plain };
    let grouped = group(&plain);
    if grouped.chars().count() <= WIDTH { grouped } else { power(value) }
}

/// Whole numbers that are read beside each other: all with a power of ten where one is too long for its column.
pub(super) fn alike<const COUNT: usize>(values: [f64; COUNT]) -> [String; COUNT] {
    let plain = values.map(|value| number(value, 0));
    // One that is nearly nothing has a power, too, which says nothing of the others.
    let is_long = |(value, text): (&f64, &String)| value.abs() >= 1.0 && text.contains('e');
    if !values.iter().zip(&plain).any(is_long) {
        return plain;
    }
    values.map(|value| if value == 0.0 || !value.is_finite() { number(value, 0) } else { power(value) })
}

/// The same where there may be no number.
pub(super) fn perhaps(value: Option<f64>, decimals: usize) -> String {
    value.map_or(NONE.to_owned(), |value| number(value, decimals))
}

/// A number from 1 to 10, with four decimals or as many as there is room for, and a power of ten.
fn power(value: f64) -> String {
    let with = |decimals| format!("{value:.decimals$e}").replace('-', "−");
    let fits = |text: &String| text.chars().count() <= WIDTH;
    (1..=4).rev().map(with).find(fits).unwrap_or_else(|| with(0))
}

/// Sets the digits before the point in groups of three, and a minus as long as a plus.
fn group(plain: &str) -> String {
    let (whole, decimals) = plain.split_at(plain.find('.').unwrap_or(plain.len()));
    let (sign, digits) = whole.strip_prefix('-').map_or(("", whole), |digits| ("−", digits));
    let mut grouped = sign.to_owned();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index) % 3 == 0 {
            grouped.push(' ');
        }
        grouped.push(digit);
    }
    grouped + decimals
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_of_any_size_fits_its_column() {
        for exponent in -300..=300 {
            for digits in [1.0, 9.999_999, 3.3] {
                let value: f64 = format!("{digits}e{exponent}").parse().unwrap();
                for decimals in 0..6 {
                    for value in [value, -value] {
                        let text = number(value, decimals);
                        assert!(text.chars().count() <= WIDTH, "{value}: {text}");
                        let read = text.replace(' ', "").replace('−', "-").parse::<f64>().unwrap();
                        let error = 0.5 * 10_f64.powi(-(decimals as i32)).max(1.01e-3 * value.abs());
                        assert!((read - value).abs() <= error, "{value} with {decimals} decimals: {text}");
                        assert!(read != 0.0, "{value}: {text} hides that it is not 0");
                    }
                }
            }
        }
    }

    #[test]
    fn numbers_read_as_people_write_them_and_those_beside_each_other_alike() {
        for (value, decimals, text) in [
            (0.0, 3, "0.000"),
            (-0.0, 3, "0.000"),
            (15.0, 0, "15"),
            (-1234.5, 1, "−1 234.5"),
            (123_456_789.4, 0, "123 456 789"),
            (1_234_567_890.0, 0, "1.2346e9"),
            (1e300, 1, "1.0000e300"),
            (-2.5e-9, 4, "−2.5000e−9"),
            (f64::NAN, 1, "–"),
            (f64::INFINITY, 1, "–"),
        ] {
            assert_eq!(number(value, decimals), text);
        }
        assert_eq!(alike([0.3, 107_968_765.0]), ["3.0000e−1", "107 968 765"]);
        assert_eq!(alike([1_763_912_345.0, 107_968_765.0, 0.0]), ["1.7639e9", "1.0797e8", "0"]);
        assert_eq!((perhaps(None, 2), perhaps(Some(1.0), 2)), ("–".to_owned(), "1.00".to_owned()));
    }
}
