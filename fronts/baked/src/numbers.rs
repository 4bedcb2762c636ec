//! Numbers in bytes.

/// The number of four bytes from `at` on; `None` if they are not there.
pub(crate) fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    let bytes = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(bytes.try_into().ok()?))
}

/// The double of eight bytes from `at` on.
pub(crate) fn f64_at(bytes: &[u8], at: usize) -> Option<f64> {
    let bytes = bytes.get(at..at.checked_add(8)?)?;
    Some(f64::from_le_bytes(bytes.try_into().ok()?))
}

/// Takes a number of 7 bits a byte from the front; `None`, and nothing is taken, if it ends early
/// or is too large.
#[inline]
pub(crate) fn take(bytes: &mut &[u8]) -> Option<u32> {
    let mut number = 0u64;
    for (i, byte) in bytes.iter().take(5).enumerate() {
        number |= u64::from(byte & 0x7f) << (7 * i);
        if byte & 0x80 == 0 {
            let number = u32::try_from(number).ok()?;
            *bytes = &bytes[i + 1..];
            return Some(number);
        }
    }
    None
}

/// Appends a number of 7 bits a byte.
#[cfg(feature = "write")]
pub(crate) fn put(out: &mut alloc::vec::Vec<u8>, mut number: u32) {
    while number >= 0x80 {
        out.push(number as u8 | 0x80);
        number >>= 7;
    }
    out.push(number as u8);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_end_and_are_not_too_large() {
        for (bytes, number) in [
            (&[0][..], Some(0)),
            (&[0x7f], Some(0x7f)),
            (&[0x80, 1, 9], Some(0x80)),
            (&[0xff, 0xff, 0xff, 0xff, 0x0f], Some(u32::MAX)),
            (&[0xff, 0xff, 0xff, 0xff, 0x1f], None),
            (&[0x80, 0x80, 0x80, 0x80, 0x80, 0], None),
            (&[0x80], None),
            (&[], None),
        ] {
            let mut rest = bytes;
            assert_eq!(take(&mut rest), number, "{bytes:?}");
            assert!(number.is_none() == (rest == bytes), "{bytes:?}");
        }
    }
}
