//! Words and numbers of texts, with the lines that they stand in.

use std::str::FromStr;

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
        let lines = lines(bytes).zip(first..);
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
    pub(super) fn number<T: FromStr>(&mut self, what: &str) -> Result<T, FileError> {
        let Some(word) = self.next() else {
            return Err(broken("line", self.line, format!("the file ends before {what}")));
        };
        parse(word, what, self.line)
    }

    /// The next word as a number with decimals.
    pub(super) fn real<T: FromStr + From<f32>>(&mut self, what: &str) -> Result<T, FileError> {
        let Some(word) = self.next() else {
            return Err(broken("line", self.line, format!("the file ends before {what}")));
        };
        real(word, what, self.line)
    }

    pub(super) fn point(&mut self) -> Result<Vec3, FileError> {
        let mut next = || self.real("a coordinate");
        Ok(Vec3::new(next()?, next()?, next()?))
    }
}

/// The lines of a text, which end with a line feed, a carriage return, or both.
pub(super) fn lines(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let whole = bytes.split(|b| *b == b'\n').map(|line| line.strip_suffix(b"\r").unwrap_or(line));
    whole.flat_map(|line| line.split(|b| *b == b'\r'))
}

/// The byte that ends each line of a text before binary numbers, as it ends the first one: a
/// carriage return if no line feed follows it.
pub(super) fn line_end(bytes: &[u8]) -> u8 {
    let first = bytes.iter().position(|b| matches!(b, b'\r' | b'\n'));
    match first.and_then(|at| bytes.get(at..)) {
        Some([b'\r', next, ..]) if *next != b'\n' => b'\r',
        _ => b'\n',
    }
}

pub(super) fn words(line: &[u8]) -> Vec<&str> {
    line.split(u8::is_ascii_whitespace)
        .filter(|w| !w.is_empty())
        .map(|w| str::from_utf8(w).unwrap_or("\u{fffd}"))
        .collect()
}

pub(super) fn parse<T: FromStr>(word: &str, what: &str, line: usize) -> Result<T, FileError> {
    word.parse().map_err(|_| broken("line", line, is_not(word, what)))
}

/// A number with decimals.
pub(super) fn real<T: FromStr + From<f32>>(word: &str, what: &str, line: usize) -> Result<T, FileError> {
    parse(word, what, line).or_else(|why| no_number(word).map(T::from).ok_or(why))
}

/// What runtimes of C write for numbers that are none and for infinite ones: `-nan(ind)`,
/// `1.#QNAN`, `-1.#INF`.
pub(super) fn no_number(word: &str) -> Option<f32> {
    let size = word.trim_start_matches(['-', '+']).to_ascii_lowercase();
    match size.as_str() {
        s if s.starts_with("1.#inf") => {
            Some(if word.starts_with('-') { -f32::INFINITY } else { f32::INFINITY })
        }
        s if s.starts_with("nan(") || s.starts_with("1.#") => Some(f32::NAN),
        _ => None,
    }
}

/// Says that a word is not what should stand there.
pub(super) fn is_not(word: &str, what: &str) -> String {
    let short: String = word.chars().take(20).filter(|c| !c.is_control()).collect();
    let hint = match word {
        w if w.contains(|c: char| c.is_control() || c == char::REPLACEMENT_CHARACTER) => {
            ": here the file is no text (perhaps its numbers are binary)"
        }
        w if w.contains(',') && w.replace(',', ".").parse::<f64>().is_ok() => ": decimals need a point",
        _ => "",
    };
    format!("\"{short}\" is not {what}{hint}")
}
