//! Values as bytes that keep every bit: what a checkpoint is made of. The bytes of a value say neither its
//! type nor its fields, so only the build that wrote them reads them.

use std::collections::BTreeSet;

use nalgebra::Vector2;
use thiserror::Error;

use crate::record::{Cost, Record, Status};

/// The bytes are not those of a value of the type that is read.
#[derive(Debug, Error)]
#[error("{0} is expected where the bytes hold something else or end")]
pub struct OtherBits(&'static str);

/// A value that can be written as bytes and read again with the same bits.
pub trait Bits: Sized {
    /// Appends the value.
    fn write_to(&self, to: &mut Vec<u8>);

    /// Reads the next value, and leaves what follows it.
    ///
    /// # Errors
    /// If the bytes end before it does, or cannot be those of such a value.
    fn read_from(from: &mut &[u8]) -> Result<Self, OtherBits>;
}

/// Implements [`Bits`] for structs, field by field in this order. A field that is not named does not compile.
#[macro_export]
macro_rules! bits {
    ($($Struct:ident { $($field:ident),* })+) => {$(
        impl $crate::bits::Bits for $Struct {
            fn write_to(&self, to: &mut Vec<u8>) {
                let Self { $($field),* } = self;
                $($crate::bits::Bits::write_to($field, to);)*
            }
            fn read_from(from: &mut &[u8]) -> Result<Self, $crate::bits::OtherBits> {
                Ok(Self { $($field: $crate::bits::Bits::read_from(from)?),* })
            }
        }
    )+};
}

/// Implements [`Bits`] for numbers, little end first.
macro_rules! numbers {
    ($($Number:ident)+) => {$(
        impl Bits for $Number {
            fn write_to(&self, to: &mut Vec<u8>) {
                to.extend(self.to_le_bytes());
            }
            fn read_from(from: &mut &[u8]) -> Result<Self, OtherBits> {
                let (bytes, rest) = from.split_first_chunk().ok_or(OtherBits(stringify!($Number)))?;
                *from = rest;
                Ok(Self::from_le_bytes(*bytes))
            }
        }
    )+};
}

numbers! { u8 u32 u64 f64 }

/// Implements [`Bits`] for values that are written as another one.
macro_rules! by_way_of {
    ($($Value:ty as $Other:ty: $put:expr, $take:expr;)+) => {$(
        impl Bits for $Value {
            fn write_to(&self, to: &mut Vec<u8>) {
                let put: fn(&Self) -> $Other = $put;
                put(self).write_to(to);
            }
            fn read_from(from: &mut &[u8]) -> Result<Self, OtherBits> {
                let take: fn($Other) -> Option<Self> = $take;
                take(Bits::read_from(from)?).ok_or(OtherBits(stringify!($Value)))
            }
        }
    )+};
}

by_way_of! {
    usize as u64: |n| *n as u64, |n| Self::try_from(n).ok();
    bool as u8: |is| u8::from(*is), |n| (n < 2).then_some(n == 1);
    String as Vec<u8>: |text| text.as_bytes().to_vec(), |bytes| Self::from_utf8(bytes).ok();
    Vector2<f64> as [f64; 2]: |v| [v.x, v.y], |v| Some(v.into());
    BTreeSet<usize> as Vec<usize>: |all| all.iter().copied().collect(), |all| Some(all.into_iter().collect());
}

/// Implements [`Bits`] for documents, by way of their JSON, which has no loss either.
macro_rules! documents {
    ($($Document:ident)+) => {$(
        impl Bits for $Document {
            fn write_to(&self, to: &mut Vec<u8>) {
                serde_json::to_string(self).unwrap_or_default().write_to(to);
            }
            fn read_from(from: &mut &[u8]) -> Result<Self, OtherBits> {
                serde_json::from_str(&String::read_from(from)?).map_err(|_| OtherBits(stringify!($Document)))
            }
        }
    )+};
}

documents! { Record Cost Status }

impl<T: Bits> Bits for Vec<T> {
    fn write_to(&self, to: &mut Vec<u8>) {
        self.len().write_to(to);
        self.iter().for_each(|value| value.write_to(to));
    }
    fn read_from(from: &mut &[u8]) -> Result<Self, OtherBits> {
        // Grows with what is there, whatever the length claims.
        let count = usize::read_from(from)?;
        (0..count).map(|_| T::read_from(from)).collect()
    }
}

impl<T: Bits, const N: usize> Bits for [T; N] {
    fn write_to(&self, to: &mut Vec<u8>) {
        self.iter().for_each(|value| value.write_to(to));
    }
    fn read_from(from: &mut &[u8]) -> Result<Self, OtherBits> {
        let all: Vec<T> = (0..N).map(|_| T::read_from(from)).collect::<Result<_, _>>()?;
        all.try_into().map_err(|_| OtherBits("an array"))
    }
}

impl<T: Bits> Bits for Option<T> {
    fn write_to(&self, to: &mut Vec<u8>) {
        self.is_some().write_to(to);
        self.iter().for_each(|value| value.write_to(to));
    }
    fn read_from(from: &mut &[u8]) -> Result<Self, OtherBits> {
        bool::read_from(from)?.then(|| T::read_from(from)).transpose()
    }
}

/// Implements [`Bits`] for tuples, member by member.
macro_rules! tuples {
    ($(($($Member:ident $index:tt),+))+) => {$(
        impl<$($Member: Bits),+> Bits for ($($Member,)+) {
            fn write_to(&self, to: &mut Vec<u8>) {
                $(self.$index.write_to(to);)+
            }
            fn read_from(from: &mut &[u8]) -> Result<Self, OtherBits> {
                Ok(($($Member::read_from(from)?,)+))
            }
        }
    )+};
}

tuples! { (A 0, B 1) (A 0, B 1, C 2) (A 0, B 1, C 2, D 3) }

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{number, record::MetricKey};

    #[derive(Debug)]
    struct Odd {
        numbers: Vec<f64>,
        text: Option<String>,
        counts: [(usize, bool); 2],
        record: Record,
    }

    bits! { Odd { numbers, text, counts, record } }

    fn odd() -> Odd {
        let numbers = [0.1, -0.0, f64::MIN_POSITIVE / 8.0, f64::NAN, -f64::NAN, f64::NEG_INFINITY];
        let mut record = Record::new("case", "variant", serde_json::json!({"n": 8, "x": 1.0}), 1);
        record.numerics.insert("odd".into(), number::json(f64::INFINITY));
        record.put(MetricKey::new("m", "-", "1/3"), 1.0 / 3.0);
        let (text, counts) = (Some("µ".into()), [(usize::MAX, true), (0, false)]);
        Odd { numbers: numbers.to_vec(), text, counts, record }
    }

    #[test]
    fn a_value_keeps_its_bits_and_a_part_of_it_is_refused() {
        let (before, mut bytes) = (odd(), Vec::new());
        before.write_to(&mut bytes);
        let mut rest = &bytes[..];
        let after = Odd::read_from(&mut rest).expect("all bytes are there");
        assert!(rest.is_empty(), "{} bytes are left of {}", rest.len(), bytes.len());
        let bits = |odd: &Odd| odd.numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&after), bits(&before), "numbers");
        assert_eq!((&after.text, after.counts), (&before.text, before.counts));
        assert_eq!(after.record, before.record);
        for length in 0..bytes.len() {
            let part = Odd::read_from(&mut &bytes[..length]);
            assert!(part.is_err(), "{length} of {} bytes give {part:?}", bytes.len());
        }
    }

    #[test]
    fn bytes_of_no_value_are_refused_before_memory_is_taken() {
        let endless = u64::MAX.to_le_bytes();
        assert!(Vec::<f64>::read_from(&mut &endless[..]).is_err(), "a list longer than its bytes");
        assert!(bool::read_from(&mut &[2_u8][..]).is_err(), "neither true nor false");
        assert!(
            String::read_from(&mut &[1_u8, 0, 0, 0, 0, 0, 0, 0, 0xFF][..]).is_err(),
            "no UTF-8"
        );
    }
}
