//! Files, and the texts in them.

use std::borrow::Cow;
use std::io;
use std::path::Path;

/// Bytes at the start of a file in which it may name its encoding.
const HEAD: usize = 200;

/// The bytes of a file. Pipes and devices are not opened: they may have no end.
pub(crate) fn file(path: &Path) -> io::Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(io::Error::other("is no file"));
    }
    std::fs::read(path)
}

/// The text of a file in UTF-8 or UTF-16, with a byte-order mark or without. Other bytes are taken
/// as Latin-1; then the second value says whether that is a guess: names in other letters than
/// those of English may be wrong.
pub(crate) fn text(bytes: &[u8]) -> (Cow<'_, str>, bool) {
    let wide = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
        let (pairs, rest) = bytes.as_chunks::<2>();
        let units = pairs.iter().map(|&pair| unit(pair));
        let all =
            char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect::<String>();
        (all.into(), !rest.is_empty())
    };
    match bytes {
        [0xff, 0xfe, rest @ ..] => return wide(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => return wide(rest, u16::from_be_bytes),
        // A text of XML or JSON begins with a letter of ASCII.
        [first, 0, ..] if first.is_ascii_graphic() => return wide(bytes, u16::from_le_bytes),
        [0, first, ..] if first.is_ascii_graphic() => return wide(bytes, u16::from_be_bytes),
        _ => {}
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    match str::from_utf8(bytes) {
        Ok(text) => (text.into(), false),
        Err(_) => {
            let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD)]).to_ascii_lowercase();
            let says_so = ["8859-1", "windows-1252"].iter().any(|name| head.contains(name));
            (bytes.iter().map(|&byte| char::from(byte)).collect::<String>().into(), !says_so)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::text;

    #[test]
    fn all_encodings_give_the_same_text() {
        const TEXT: &str = "<map name=\"W\u{e4}nde\"/>";
        let mut all = vec![TEXT.as_bytes().to_vec(), [b"\xef\xbb\xbf", TEXT.as_bytes()].concat()];
        for mark in ["", "\u{feff}"] {
            let units: Vec<u16> = mark.encode_utf16().chain(TEXT.encode_utf16()).collect();
            all.push(units.iter().flat_map(|unit| unit.to_le_bytes()).collect());
            all.push(units.iter().flat_map(|unit| unit.to_be_bytes()).collect());
        }
        for bytes in all {
            assert_eq!(text(&bytes), (TEXT.into(), false), "{bytes:?}");
        }
        let latin: Vec<u8> = TEXT.chars().map(|c| c as u8).collect();
        assert_eq!(text(&latin), (TEXT.into(), true));
        let declared = [b"<?xml encoding=\"ISO-8859-1\"?>", &latin[..]].concat();
        assert!(!text(&declared).1);
        assert_eq!((text(b"").0, text(b"\xff\xfe<").1), ("".into(), true));
    }
}
