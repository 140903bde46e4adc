//! Numbers as bytes.

use touchstone_base::text::short;

/// An array of three components of a particle has no more than these.
pub const MOST_NUMBERS: usize = 3 * super::MOST_ROWS;

/// Message for a longer file.
pub fn too_long() -> String {
    format!("it has more than {MOST_NUMBERS} numbers; expected fewer particles or times")
}

/// Type of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Of {
    Float,
    Signed,
    Unsigned,
}

/// Representation of numbers as bytes.
#[derive(Clone, Copy, Debug)]
pub struct NumberFormat {
    pub of: Of,
    /// Bytes of each.
    pub width: usize,
    /// Does the most significant byte come first?
    pub is_big: bool,
}

impl NumberFormat {
    /// Floats of 4 or 8 bytes, or whole numbers of 1, 2, 4 or 8.
    fn new(of: Of, bits: Option<usize>, is_big: bool) -> Option<Self> {
        let is_known = |bits: &usize| match of {
            Of::Float => [32, 64].contains(bits),
            Of::Signed | Of::Unsigned => [8, 16, 32, 64].contains(bits),
        };
        bits.filter(is_known).map(|bits| Self { of, width: bits / 8, is_big })
    }

    /// The type with this name in ParaView, as in `Float64`.
    pub fn of_vtk(name: &str, is_big: bool) -> Result<Self, String> {
        let kinds = [("Float", Of::Float), ("Int", Of::Signed), ("UInt", Of::Unsigned)];
        let of = |(begin, of)| {
            let bits = name.strip_prefix(begin)?.parse().ok();
            Self::new(of, bits, is_big)
        };
        kinds.into_iter().find_map(of).ok_or_else(|| unknown(name))
    }
}

fn unknown(name: &str) -> String {
    format!(
        "its type is {}; expected floats of 4 or 8 bytes, or whole numbers of 1, 2, 4 or 8",
        short(name)
    )
}

/// Numbers of a kind.
///
/// # Errors
/// If the bytes end within a number, or there are too many.
pub fn numbers(
    NumberFormat { of, width, is_big }: NumberFormat,
    bytes: &[u8],
) -> Result<Vec<f64>, String> {
    if !bytes.len().is_multiple_of(width) {
        return Err("it ends within a number".into());
    }
    if bytes.len() / width > MOST_NUMBERS {
        return Err(too_long());
    }
    let number = |bytes: &[u8]| {
        let mut whole = [0; 8];
        whole[..width].copy_from_slice(bytes);
        if is_big {
            whole[..width].reverse();
        }
        let bits = u64::from_le_bytes(whole);
        let unused = 64 - 8 * width as u32;
        match (of, width) {
            (Of::Float, 4) => f32::from_bits(bits as u32).into(),
            (Of::Float, _) => f64::from_bits(bits),
            (Of::Signed, _) => ((bits << unused).cast_signed() >> unused) as f64,
            (Of::Unsigned, _) => bits as f64,
        }
    };
    Ok(bytes.chunks_exact(width).map(number).collect())
}
