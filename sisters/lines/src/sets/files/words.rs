//! Words and numbers of texts.

use std::str::FromStr;

use super::error::{FileError, broken};

/// A file from a place on, as words that white space separates.
pub(super) struct Scan<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
    /// How errors count places: "line" or "byte".
    unit: &'static str,
    /// The byte that ends each line of a text before binary numbers, as it ends the first one: a
    /// carriage return if no line feed follows it.
    line_end: u8,
}

impl<'a> Scan<'a> {
    pub(super) fn new(bytes: &'a [u8], unit: &'static str) -> Self {
        let first = bytes.iter().position(|b| matches!(b, b'\r' | b'\n'));
        let line_end = match first.and_then(|at| bytes.get(at..)) {
            Some([b'\r', next, ..]) if *next != b'\n' => b'\r',
            _ => b'\n',
        };
        Self { bytes, at: 0, unit, line_end }
    }

    /// An error at this place.
    pub(super) fn fail(&self, why: impl Into<String>) -> FileError {
        self.fail_at(self.at, why)
    }

    pub(super) fn fail_at(&self, at: usize, why: impl Into<String>) -> FileError {
        let place = if self.unit == "line" { lines(&self.bytes[..at]).count() } else { at };
        broken(self.unit, place, why)
    }

    /// The rest of a line.
    pub(super) fn line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        let long = rest.iter().position(|b| *b == self.line_end).unwrap_or(rest.len());
        self.at = (self.at + long + 1).min(self.bytes.len());
        &rest[..long]
    }

    pub(super) fn word(&mut self) -> Option<&'a str> {
        let rest = &self.bytes[self.at..];
        let start = rest.iter().position(|b| !b.is_ascii_whitespace())?;
        let long = rest[start..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - start);
        self.at += start + long;
        Some(str::from_utf8(&rest[start..start + long]).unwrap_or("\u{fffd}"))
    }

    /// The next word, if it stands in this line.
    pub(super) fn word_of_line(&mut self) -> Option<&'a str> {
        let rest = &self.bytes[self.at..];
        let start = rest.iter().position(|b| *b == self.line_end || !matches!(b, b' ' | b'\t' | b'\r'))?;
        if rest[start] == self.line_end { None } else { self.word() }
    }

    pub(super) fn name(&mut self, what: &str) -> Result<&'a str, FileError> {
        self.word().ok_or_else(|| self.fail(format!("the file ends before {what}")))
    }

    /// The next word as a number.
    pub(super) fn number<T: FromStr>(&mut self, what: &str) -> Result<T, FileError> {
        let word = self.name(what)?;
        parse(word, what).map_err(|why| self.fail(why))
    }

    /// The next word as a number with decimals.
    pub(super) fn real<T: FromStr + From<f32>>(&mut self, what: &str) -> Result<T, FileError> {
        let word = self.name(what)?;
        real(word, what).map_err(|why| self.fail(why))
    }
}

/// The lines of a text, which end with a line feed, a carriage return, or both.
pub(super) fn lines(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let whole = bytes.split(|b| *b == b'\n').map(|line| line.strip_suffix(b"\r").unwrap_or(line));
    whole.flat_map(|line| line.split(|b| *b == b'\r'))
}

pub(super) fn words(line: &[u8]) -> Vec<&str> {
    line.split(u8::is_ascii_whitespace)
        .filter(|w| !w.is_empty())
        .map(|w| str::from_utf8(w).unwrap_or("\u{fffd}"))
        .collect()
}

pub(super) fn parse<T: FromStr>(word: &str, what: &str) -> Result<T, String> {
    word.parse().map_err(|_| {
        let short: String = word.chars().take(20).filter(|c| !c.is_control()).collect();
        format!("\"{short}\" is not {what}")
    })
}

/// A number with decimals. Runtimes of C write `-nan(ind)`, `1.#QNAN` and `-1.#INF` for numbers that
/// are none and for infinite ones.
pub(super) fn real<T: FromStr + From<f32>>(word: &str, what: &str) -> Result<T, String> {
    parse(word, what).or_else(|why| {
        let size = word.trim_start_matches(['-', '+']).to_ascii_lowercase();
        match size.as_str() {
            s if s.starts_with("1.#inf") && word.starts_with('-') => Ok(T::from(f32::NEG_INFINITY)),
            s if s.starts_with("1.#inf") => Ok(T::from(f32::INFINITY)),
            s if s.starts_with("nan(") || s.starts_with("1.#") => Ok(T::from(f32::NAN)),
            _ => Err(why),
        }
    })
}
