//! Numbers as bytes, least first.

/// An array of three components of a particle has no more than these.
pub const MOST_NUMBERS: usize = 3 * super::MOST_ROWS;

/// What is said of a longer one.
pub fn too_long() -> String {
    format!("it has more than {MOST_NUMBERS} numbers; expected fewer particles or times")
}

/// Numbers of a kind by the name of NumPy or of ParaView.
///
/// # Errors
/// If the kind is another one, or the bytes end within a number.
pub fn numbers(kind: &str, bytes: &[u8]) -> Result<Vec<f64>, String> {
    fn all<const N: usize>(bytes: &[u8], number: fn([u8; N]) -> f64) -> Result<Vec<f64>, String> {
        let (numbers, rest) = bytes.as_chunks::<N>();
        match rest.is_empty() {
            _ if numbers.len() > MOST_NUMBERS => Err(too_long()),
            true => Ok(numbers.iter().map(|bytes| number(*bytes)).collect()),
            false => Err("it ends within a number".into()),
        }
    }
    match kind {
        "<f8" | "Float64" => all(bytes, f64::from_le_bytes),
        "<f4" | "Float32" => all(bytes, |bytes| f32::from_le_bytes(bytes).into()),
        "<i8" | "Int64" => all(bytes, |bytes| i64::from_le_bytes(bytes) as f64),
        "<i4" | "Int32" => all(bytes, |bytes| i32::from_le_bytes(bytes).into()),
        "|u1" | "UInt8" => all(bytes, |bytes: [u8; 1]| bytes[0].into()),
        other => {
            Err(format!("its type is {other}; expected floats of 8 or 4 bytes, or whole numbers"))
        }
    }
}
