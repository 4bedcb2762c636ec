//! Text as programs write it: lines that end in any way, in any encoding, and words in the place of numbers.

use std::io::{self, BufRead, Read};

/// The longest line, in bytes: enough for a list of 100,000 numbers.
const LONGEST_LINE: u64 = 1 << 20;

/// What some programs write before a text, to say that it is one of Unicode.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The bytes of a text behind its byte-order mark.
pub(super) fn unmarked(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes)
}

/// The lines of a text, which end as the first one does: by a carriage return alone, or not.
pub(super) struct Lines<S> {
    source: S,
    end: u8,
    /// The number of the last line, from 1; at the end, that of the line that there is not.
    pub number: usize,
    bytes: Vec<u8>,
    text: String,
}

impl<S: BufRead> Lines<S> {
    pub fn new(mut source: S) -> io::Result<Self> {
        if source.fill_buf()?.starts_with(BYTE_ORDER_MARK) {
            source.consume(BYTE_ORDER_MARK.len());
        }
        let start = source.fill_buf()?;
        let first = start.iter().position(|byte| b"\r\n".contains(byte));
        let alone = |i: usize| start[i] == b'\r' && start.get(i + 1) != Some(&b'\n');
        let end = if first.is_some_and(alone) { b'\r' } else { b'\n' };
        Ok(Self { source, end, number: 0, bytes: Vec::new(), text: String::new() })
    }

    /// The next line that is not blank; none at the end. Bytes that are no UTF-8 are replaced.
    pub fn next(&mut self) -> io::Result<Option<&str>> {
        self.bytes.clear();
        while self.bytes.trim_ascii().is_empty() {
            self.bytes.clear();
            self.number += 1;
            let mut most = (&mut self.source).take(LONGEST_LINE);
            if most.read_until(self.end, &mut self.bytes)? == 0 {
                return Ok(None);
            }
        }
        self.text.clear();
        self.text.push_str(&String::from_utf8_lossy(self.bytes.trim_ascii()));
        Ok(Some(&self.text))
    }

    /// What follows the last line.
    pub fn into_inner(self) -> S {
        self.source
    }
}

/// A number as programs write it: with a comma for a point or behind it, and what is none as the
/// runtimes of C do.
pub(super) fn number(word: &str) -> Option<f64> {
    if let Ok(number) = word.parse() {
        return Some(number);
    }
    let word = word.trim_end_matches([',', ';']).to_ascii_lowercase();
    let bare = word.trim_start_matches(['+', '-']);
    if ["nan", "1.#qnan", "1.#snan", "1.#ind"].iter().any(|start| bare.starts_with(start)) {
        return Some(f64::NAN);
    }
    if bare.starts_with("1.#inf") {
        return Some(if word.starts_with('-') { f64::NEG_INFINITY } else { f64::INFINITY });
    }
    if word.contains('.') { word.parse().ok() } else { word.replacen(',', ".", 1).parse().ok() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_programs_write_them() {
        let nan = ["nan", "NaN", "-nan", "-nan(ind)", "nan(0x7ff)", "1.#QNAN", "-1.#IND00", "1.#SNAN0"];
        assert!(nan.iter().all(|word| number(word).is_some_and(f64::is_nan)));
        let (most, least) = (f64::INFINITY, f64::NEG_INFINITY);
        let infinite = [("inf", most), ("-Infinity", least), ("1.#INF", most), ("-1.#INF00", least)];
        let finite = [("1,5", 1.5), ("-2.5,", -2.5), ("3;", 3.0), ("+1e3", 1000.0), ("1,5E-1,", 0.15)];
        for (word, value) in infinite.into_iter().chain(finite) {
            assert_eq!(number(word), Some(value), "{word}");
        }
        for word in ["", "-", "five", "1,2,3", "1.2,3", "1.#", "0x10"] {
            assert_eq!(number(word), None, "{word}");
        }
    }
}
