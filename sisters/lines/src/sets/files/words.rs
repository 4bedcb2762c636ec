//! Words and numbers of texts, with the lines that they stand in.

use glam::Vec3;

use super::error::{FileError, broken};

/// The words of a text with their line numbers; white space separates.
pub(super) struct Words<'a> {
    words: Box<dyn Iterator<Item = (usize, &'a str)> + 'a>,
    pub(super) line: usize,
}

impl<'a> Words<'a> {
    /// Words of lines that are counted from `first`.
    pub(super) fn new(bytes: &'a [u8], first: usize) -> Self {
        let lines = bytes.split(|b| *b == b'\n').zip(first..);
        Self {
            words: Box::new(lines.flat_map(|(l, i)| words(l).into_iter().map(move |w| (i, w)))),
            line: first,
        }
    }

    pub(super) fn next(&mut self) -> Option<&'a str> {
        let (line, word) = self.words.next()?;
        self.line = line;
        Some(word)
    }

    /// The next word as a number.
    pub(super) fn number<T: std::str::FromStr>(&mut self, what: &str) -> Result<T, FileError> {
        let Some(word) = self.next() else {
            return Err(broken("line", self.line, format!("the file ends before {what}")));
        };
        parse(word, what, self.line)
    }

    pub(super) fn point(&mut self) -> Result<Vec3, FileError> {
        let mut next = || self.number("a coordinate");
        Ok(Vec3::new(next()?, next()?, next()?))
    }
}

pub(super) fn words(line: &[u8]) -> Vec<&str> {
    line.split(u8::is_ascii_whitespace)
        .filter(|w| !w.is_empty())
        .map(|w| str::from_utf8(w).unwrap_or("\u{fffd}"))
        .collect()
}

pub(super) fn parse<T: std::str::FromStr>(word: &str, what: &str, line: usize) -> Result<T, FileError> {
    let short: String = word.chars().take(20).collect();
    word.parse().map_err(|_| broken("line", line, format!("\"{short}\" is not {what}")))
}
