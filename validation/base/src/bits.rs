//! Values as bytes that keep every bit: the content of a checkpoint. The bytes state neither types nor
//! fields, so only the build that wrote them reads them.

use std::collections::BTreeSet;

use nalgebra::Vector2;
use serde::Serialize;
use thiserror::Error;

use crate::record::{Cost, Record, Status};

/// The bytes are no value of the expected type.
#[derive(Debug, Error)]
#[error("{0} is expected where the bytes hold something else or end")]
pub struct OtherBits(&'static str);

/// A value that writes its changing part as bytes, and reads it back with the same bits.
/// [`observed!`](crate::observed!) implements it for a struct.
pub trait Bits {
    /// Appends all that changes.
    fn save(&self, to: &mut Vec<u8>);

    /// Reads the value and leaves the bytes after it.
    ///
    /// # Errors
    /// If the bytes end too early, or are no value of this type.
    fn restore(&mut self, from: &mut &[u8]) -> Result<(), OtherBits>;
}

/// Reads the next value and leaves the bytes after it.
///
/// # Errors
/// The errors of [`Bits::restore`].
pub fn read<T: Bits + Default>(from: &mut &[u8]) -> Result<T, OtherBits> {
    let mut value = T::default();
    value.restore(from)?;
    Ok(value)
}

/// Implements [`Bits`] for a struct: which of its fields change, and which stay as they are. Every field must
/// be named, so that a new one cannot be forgotten.
#[macro_export]
macro_rules! observed {
    ($Struct:ty: changes($($change:ident),*), stays($($stay:ident),*)) => {
        impl $crate::bits::Bits for $Struct {
            fn save(&self, to: &mut Vec<u8>) {
                let Self { $($change,)* $($stay: _,)* } = self;
                $($crate::bits::Bits::save($change, to);)*
            }
            fn restore(&mut self, from: &mut &[u8]) -> Result<(), $crate::bits::OtherBits> {
                let Self { $($change,)* $($stay: _,)* } = self;
                $($crate::bits::Bits::restore($change, from)?;)*
                Ok(())
            }
        }
    };
}

/// Implements [`Bits`] for numbers, little end first.
macro_rules! numbers {
    ($($Number:ident)+) => {$(
        impl Bits for $Number {
            fn save(&self, to: &mut Vec<u8>) {
                to.extend(self.to_le_bytes());
            }
            fn restore(&mut self, from: &mut &[u8]) -> Result<(), OtherBits> {
                let (bytes, rest) = from.split_first_chunk().ok_or(OtherBits(stringify!($Number)))?;
                (*self, *from) = (Self::from_le_bytes(*bytes), rest);
                Ok(())
            }
        }
    )+};
}

numbers! { u8 u32 u64 f64 }

/// Implements [`Bits`] for values that are written as another one.
macro_rules! by_way_of {
    ($($Value:ty as $Other:ty: $put:expr, $take:expr;)+) => {$(
        impl Bits for $Value {
            fn save(&self, to: &mut Vec<u8>) {
                let put: fn(&Self) -> $Other = $put;
                put(self).save(to);
            }
            fn restore(&mut self, from: &mut &[u8]) -> Result<(), OtherBits> {
                let take: fn($Other) -> Option<Self> = $take;
                *self = take(read(from)?).ok_or(OtherBits(stringify!($Value)))?;
                Ok(())
            }
        }
    )+};
}

/// A document as its JSON, which has no loss either.
fn json(document: &impl Serialize) -> String {
    serde_json::to_string_pretty(document).unwrap_or_default()
}

by_way_of! {
    usize as u64: |n| *n as u64, |n| Self::try_from(n).ok();
    bool as u8: |is| u8::from(*is), |n| (n < 2).then_some(n == 1);
    String as Vec<u8>: |text| text.as_bytes().to_vec(), |bytes| Self::from_utf8(bytes).ok();
    Vector2<f64> as [f64; 2]: |v| [v.x, v.y], |v| Some(v.into());
    BTreeSet<usize> as Vec<usize>: |all| all.iter().copied().collect(), |all| Some(all.into_iter().collect());
    Record as String: json, |text| serde_json::from_str(&text).ok();
    Cost as String: json, |text| serde_json::from_str(&text).ok();
    Status as String: json, |text| serde_json::from_str(&text).ok();
}

impl<T: Bits + ?Sized> Bits for &mut T {
    fn save(&self, to: &mut Vec<u8>) {
        (**self).save(to);
    }
    fn restore(&mut self, from: &mut &[u8]) -> Result<(), OtherBits> {
        (**self).restore(from)
    }
}

/// The length of a slice is fixed.
impl<T: Bits> Bits for [T] {
    fn save(&self, to: &mut Vec<u8>) {
        self.iter().for_each(|value| value.save(to));
    }
    fn restore(&mut self, from: &mut &[u8]) -> Result<(), OtherBits> {
        self.iter_mut().try_for_each(|value| value.restore(from))
    }
}

impl<T: Bits, const N: usize> Bits for [T; N] {
    fn save(&self, to: &mut Vec<u8>) {
        self.as_slice().save(to);
    }
    fn restore(&mut self, from: &mut &[u8]) -> Result<(), OtherBits> {
        self.as_mut_slice().restore(from)
    }
}

impl<T: Bits + Default> Bits for Vec<T> {
    fn save(&self, to: &mut Vec<u8>) {
        self.len().save(to);
        self.as_slice().save(to);
    }
    fn restore(&mut self, from: &mut &[u8]) -> Result<(), OtherBits> {
        // Grows with the available bytes, not with the stated length.
        let count: usize = read(from)?;
        self.clear();
        for _ in 0..count {
            self.push(read(from)?);
        }
        Ok(())
    }
}

impl<T: Bits + Default> Bits for Option<T> {
    fn save(&self, to: &mut Vec<u8>) {
        self.is_some().save(to);
        self.as_slice().save(to);
    }
    fn restore(&mut self, from: &mut &[u8]) -> Result<(), OtherBits> {
        *self = if read(from)? { Some(read(from)?) } else { None };
        Ok(())
    }
}

/// Implements [`Bits`] for tuples, member by member.
macro_rules! tuples {
    ($(($($Member:ident $index:tt),*))+) => {$(
        impl<$($Member: Bits),*> Bits for ($($Member,)*) {
            fn save(&self, _to: &mut Vec<u8>) {
                $(self.$index.save(_to);)*
            }
            fn restore(&mut self, _from: &mut &[u8]) -> Result<(), OtherBits> {
                $(self.$index.restore(_from)?;)*
                Ok(())
            }
        }
    )+};
}

tuples! { () (A 0, B 1) (A 0, B 1, C 2) (A 0, B 1, C 2, D 3) }

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{number, record::MetricKey};

    #[derive(Debug, Default)]
    struct Odd {
        numbers: Vec<f64>,
        text: Option<String>,
        counts: [(usize, bool); 2],
        record: Record,
        width: f64,
    }

    observed! { Odd: changes(numbers, text, counts, record), stays(width) }

    fn odd() -> Odd {
        let numbers = [0.1, -0.0, f64::MIN_POSITIVE / 8.0, f64::NAN, -f64::NAN, f64::NEG_INFINITY];
        let mut record = Record::new("case", "variant", serde_json::json!({"n": 8, "x": 1.0}), 1);
        record.numerics.insert("odd".into(), number::json(f64::INFINITY));
        record.put(MetricKey::new("m", "-", "1/3"), 1.0 / 3.0);
        let (text, counts) = (Some("µ".into()), [(usize::MAX, true), (0, false)]);
        Odd { numbers: numbers.to_vec(), text, counts, record, width: 3.0 }
    }

    #[test]
    fn a_value_keeps_its_bits_and_a_part_of_it_is_refused() {
        let (before, mut bytes) = (odd(), Vec::new());
        before.save(&mut bytes);
        let mut rest = &bytes[..];
        let mut after = Odd { width: 5.0, ..Odd::default() };
        after.restore(&mut rest).expect("all bytes are there");
        assert!(rest.is_empty(), "{} bytes are left of {}", rest.len(), bytes.len());
        let bits = |odd: &Odd| odd.numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&after), bits(&before), "numbers");
        assert_eq!((&after.text, after.counts), (&before.text, before.counts));
        assert_eq!(after.record, before.record);
        assert_eq!(after.width, 5.0, "what stays is not saved");
        for length in 0..bytes.len() {
            let part = read::<Odd>(&mut &bytes[..length]);
            assert!(part.is_err(), "{length} of {} bytes give {part:?}", bytes.len());
        }
    }

    #[test]
    fn bytes_of_no_value_are_refused_before_memory_is_taken() {
        let endless = u64::MAX.to_le_bytes();
        assert!(read::<Vec<f64>>(&mut &endless[..]).is_err(), "a list longer than its bytes");
        assert!(read::<bool>(&mut &[2_u8][..]).is_err(), "neither true nor false");
        assert!(read::<String>(&mut &[1_u8, 0, 0, 0, 0, 0, 0, 0, 0xFF][..]).is_err(), "no UTF-8");
    }
}
