//! The values of a scene file: numbers, pairs, ranges, and what is said where one is something else.

use std::fmt;
use std::marker::PhantomData;

use glam::DVec2;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error as _, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::simulation::limits::Quantity;

/// Any TOML number.
#[derive(Clone, Copy)]
pub(super) struct Number(pub(super) f64);

/// What a pair is called where there is something else; `advice` adds an example of the key.
pub(super) const TWO_NUMBERS: &str = "two numbers";

/// Two numbers: x and y.
#[derive(Clone, Copy)]
pub(super) struct Pair(pub(super) DVec2);

/// One number, or the two ends of a range.
#[derive(Clone, Copy)]
pub(super) struct Interval(f64, f64);

/// Left, top, right, bottom.
#[derive(Clone, Copy)]
pub(super) struct Corners([f64; 4]);

/// A whole number from 0 up.
pub(super) struct Count(pub(super) u64);

/// A table. (What serde derives takes an array for one, too, value by value.)
pub(super) struct Table<T>(pub(super) T);

/// What a table is called, with its brackets.
pub(super) trait Named {
    const NAME: &str;
}

impl Interval {
    /// Both ends, in the range of `quantity` and in their order.
    pub(super) fn check(self, quantity: &'static Quantity) -> Result<(f64, f64), String> {
        let check = |value| quantity.check(value).map_err(|error| error.to_string());
        let (low, high) = (check(self.0)?, check(self.1)?);
        if low <= high {
            Ok((low, high))
        } else {
            Err(format!(
                "{} is [{low}, {high}]; write the smaller number first: [{high}, {low}]",
                quantity.name
            ))
        }
    }
}

impl Corners {
    /// The corners of a region of a world of `size` that a ball of `radius` fits into.
    pub(super) fn check(self, size: DVec2, radius: f64) -> Result<(DVec2, DVec2), String> {
        let [left, top, right, bottom] = self.0;
        let (low, high) = (DVec2::new(left, top), DVec2::new(right, bottom));
        let world = format!("[0, 0, {}, {}]", size.x, size.y);
        if !(low.cmpge(DVec2::ZERO).all() && high.cmple(size).all()) {
            return Err(format!(
                "region is [{left}, {top}, {right}, {bottom}]; left, top, right and bottom must lie in the world, {world}"
            ));
        }
        if !low.cmple(high).all() {
            let (low, high) = (low.min(high), low.max(high));
            return Err(format!(
                "region is [{left}, {top}, {right}, {bottom}]; write left before right and top before bottom, the \
                 smaller number first: [{}, {}, {}, {}]",
                low.x, low.y, high.x, high.y
            ));
        }
        if !(high - low).cmpge(DVec2::splat(2.0 * radius)).all() {
            return Err(format!(
                "region is [{left}, {top}, {right}, {bottom}], which has no room for a ball of radius {radius}; \
                 write left, top, right, bottom at least {} apart",
                2.0 * radius
            ));
        }
        Ok((low, high))
    }
}

impl<'de, T: Deserialize<'de> + Named> Deserialize<'de> for Table<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct TableVisitor<T>(PhantomData<T>);

        impl<'de, T: Deserialize<'de> + Named> Visitor<'de> for TableVisitor<T> {
            type Value = Table<T>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a table: {}", T::NAME)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Table<T>, A::Error> {
                T::deserialize(MapAccessDeserializer::new(map)).map(Table)
            }
        }

        deserializer.deserialize_map(TableVisitor(PhantomData))
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NumberVisitor;

        impl Visitor<'_> for NumberVisitor {
            type Value = Number;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, such as 12 or 0.5")
            }

            fn visit_f64<E>(self, value: f64) -> Result<Number, E> {
                Ok(Number(value))
            }

            fn visit_i64<E>(self, value: i64) -> Result<Number, E> {
                Ok(Number(value as f64))
            }

            fn visit_u64<E>(self, value: u64) -> Result<Number, E> {
                Ok(Number(value as f64))
            }

            fn visit_i128<E>(self, value: i128) -> Result<Number, E> {
                Ok(Number(value as f64))
            }

            fn visit_u128<E>(self, value: u128) -> Result<Number, E> {
                Ok(Number(value as f64))
            }
        }

        deserializer.deserialize_any(NumberVisitor)
    }
}

impl<'de> Deserialize<'de> for Count {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct CountVisitor;

        impl Visitor<'_> for CountVisitor {
            type Value = Count;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number from 0 up, such as 1000")
            }

            fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<Count, E> {
                let wrong = || E::invalid_value(serde::de::Unexpected::Signed(value), &self);
                u64::try_from(value).map(Count).map_err(|_| wrong())
            }

            fn visit_u64<E>(self, value: u64) -> Result<Count, E> {
                Ok(Count(value))
            }
        }

        deserializer.deserialize_any(CountVisitor)
    }
}

impl<'de> Deserialize<'de> for Pair {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let [x, y] = deserializer.deserialize_any(Numbers(TWO_NUMBERS))?;
        Ok(Self(DVec2::new(x, y)))
    }
}

impl<'de> Deserialize<'de> for Corners {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        const EXPECTED: &str = "four numbers, left, top, right and bottom, such as [0, 0, 1280, 360]";
        deserializer.deserialize_any(Numbers(EXPECTED)).map(Self)
    }
}

impl<'de> Deserialize<'de> for Interval {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        const INTERVAL: &str = "a number or a range, such as 5 or [3, 6]";
        struct IntervalVisitor;

        impl<'de> Visitor<'de> for IntervalVisitor {
            type Value = Interval;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(INTERVAL)
            }

            fn visit_f64<E>(self, value: f64) -> Result<Interval, E> {
                Ok(Interval(value, value))
            }

            fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<Interval, E> {
                self.visit_f64(value as f64)
            }

            fn visit_u64<E: serde::de::Error>(self, value: u64) -> Result<Interval, E> {
                self.visit_f64(value as f64)
            }

            fn visit_i128<E: serde::de::Error>(self, value: i128) -> Result<Interval, E> {
                self.visit_f64(value as f64)
            }

            fn visit_u128<E: serde::de::Error>(self, value: u128) -> Result<Interval, E> {
                self.visit_f64(value as f64)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Interval, A::Error> {
                let [low, high] = Numbers(INTERVAL).visit_seq(seq)?;
                Ok(Interval(low, high))
            }
        }

        deserializer.deserialize_any(IntervalVisitor)
    }
}

/// Exactly `N` numbers in an array; the text says what is expected.
struct Numbers<const N: usize>(&'static str);

impl<'de, const N: usize> Visitor<'de> for Numbers<N> {
    type Value = [f64; N];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<[f64; N], A::Error> {
        let mut numbers = [0.0; N];
        for (found, number) in numbers.iter_mut().enumerate() {
            *number = seq.next_element::<Number>()?.ok_or_else(|| A::Error::invalid_length(found, &self))?.0;
        }
        match seq.next_element::<Number>()? {
            None => Ok(numbers),
            Some(_) => Err(A::Error::invalid_length(N + 1, &self)),
        }
    }
}
