//! The numbers of an array: words, base64, or bytes after the XML, packed or not.

use std::borrow::Cow;
use std::str::FromStr;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use roxmltree::Node;

use crate::sets::files::bytes::{Bytes, Kind};
use crate::sets::files::error::{FileError, refused};
use crate::sets::files::unpack::Room;
use crate::sets::files::words::{is_not, no_number};

/// The encoding that all arrays of a file share.
pub(super) struct Store<'a> {
    /// The bytes after the XML.
    appended: &'a [u8],
    /// Whether that is base64.
    encoded: bool,
    big: bool,
    packed: bool,
    /// The numbers before the data.
    header: Kind,
    room: Room,
}

/// The kind of numbers of an array, if it has numbers.
pub(super) fn kind_named(array: Node<'_, '_>) -> Option<Kind> {
    Some(match array.attribute("type")? {
        "Int8" => Kind::Signed(1),
        "Int16" => Kind::Signed(2),
        "Int32" => Kind::Signed(4),
        "Int64" => Kind::Signed(8),
        "UInt8" => Kind::Unsigned(1),
        "UInt16" => Kind::Unsigned(2),
        "UInt32" => Kind::Unsigned(4),
        "UInt64" => Kind::Unsigned(8),
        "Float32" => Kind::Float(4),
        "Float64" => Kind::Float(8),
        _ => return None,
    })
}

impl<'a> Store<'a> {
    /// By the attributes of the root, and what follows the XML in a file of so many bytes.
    pub(super) fn new(root: Node<'_, '_>, appended: &'a [u8], bytes: usize) -> Result<Self, FileError> {
        let big = root.attribute("byte_order") == Some("BigEndian");
        let header = match root.attribute("header_type") {
            None | Some("UInt32") => Kind::Unsigned(4),
            Some("UInt64") => Kind::Unsigned(8),
            Some(_) => return Err(refused("headers must be UInt32 or UInt64")),
        };
        let packed = match root.attribute("compressor") {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => {
                let other: String = other.chars().take(30).collect();
                return Err(refused(format!("data packed by {other}: only vtkZLibDataCompressor is read")));
            }
        };
        let tag = appended.split(|b| *b == b'>').next().unwrap_or_default();
        let encoded = !String::from_utf8_lossy(tag).contains("raw");
        let start = appended.iter().skip(tag.len()).position(|b| *b == b'_').map(|at| tag.len() + at + 1);
        let appended = start.and_then(|at| appended.get(at..)).unwrap_or_default();
        Ok(Self { appended, encoded, big, packed, header, room: Room::of_file(bytes) })
    }

    /// The numbers of an array in single precision.
    pub(super) fn floats(&mut self, array: Node<'_, '_>) -> Result<Vec<f32>, FileError> {
        let numbers = match self.numbers(array) {
            Ok(Numbers::Words(text)) => text.split_ascii_whitespace().map(real).collect(),
            Ok(Numbers::Bytes(bytes, kind)) => {
                self.count(&bytes, kind).and_then(|n| self.all(&bytes).floats(kind, n))
            }
            Err(why) => Err(why),
        };
        numbers.map_err(|why| named(array, &why))
    }

    /// The numbers of an array as numbers of points.
    pub(super) fn indices(&mut self, array: Node<'_, '_>) -> Result<Vec<u32>, FileError> {
        let numbers = match self.numbers(array) {
            Ok(Numbers::Words(text)) => text.split_ascii_whitespace().map(parsed::<u32>).collect(),
            Ok(Numbers::Bytes(bytes, kind)) => {
                self.count(&bytes, kind).and_then(|n| self.all(&bytes).indices(kind, n))
            }
            Err(why) => Err(why),
        };
        numbers.map_err(|why| named(array, &why))
    }

    /// The count of numbers, which need 4 bytes each.
    fn count(&mut self, bytes: &[u8], kind: Kind) -> Result<usize, FileError> {
        let count = bytes.len() / kind.size();
        self.room.take(count.saturating_mul(4))?;
        Ok(count)
    }

    fn all<'b>(&self, bytes: &'b [u8]) -> Bytes<'b> {
        Bytes { bytes, at: 0, big: self.big }
    }

    fn numbers<'b>(&mut self, array: Node<'b, 'b>) -> Result<Numbers<'b>, FileError> {
        let kind = kind_named(array).ok_or_else(|| refused("an array of points or lines has no numbers"))?;
        // Keys of information may stand before the numbers.
        let texts = array.children().filter_map(|n| n.text().filter(|_| n.is_text()));
        let text = texts.map(str::trim).find(|t| !t.is_empty()).unwrap_or_default();
        match array.attribute("format") {
            Some("ascii") => Ok(Numbers::Words(text)),
            None | Some("binary") => {
                let text: Vec<u8> = text.bytes().filter(|b| !b.is_ascii_whitespace()).collect();
                Ok(Numbers::Bytes(self.data(&mut Stream { rest: &text, encoded: true })?, kind))
            }
            Some("appended") => {
                let offset = array.attribute("offset").and_then(|o| o.trim().parse::<usize>().ok());
                let rest = offset.and_then(|at| self.appended.get(at..));
                let rest = rest.ok_or_else(|| refused("the offset of an array lies outside of the file"))?;
                let encoded = self.encoded;
                Ok(Numbers::Bytes(self.data(&mut Stream { rest, encoded })?, kind))
            }
            Some(_) => Err(refused("the format of an array must be ascii, binary or appended")),
        }
    }

    /// The bytes of an array, after the header that says how many there are.
    fn data(&mut self, stream: &mut Stream<'_>) -> Result<Vec<u8>, FileError> {
        // An empty array may have no header.
        if stream.rest.is_empty() {
            return Ok(Vec::new());
        }
        let long = self.header.size();
        let first = self.header(&stream.peek(long)?, 1)?[0];
        if !self.packed {
            return self.plain(stream, first);
        }
        if first == 0 {
            return Ok(Vec::new());
        }
        let numbers = first.checked_add(3).ok_or_else(|| refused("a header of too many blocks"))?;
        let header = stream.take(numbers.saturating_mul(long))?;
        let header = self.header(&header, numbers)?;
        let (block, last, sizes) = (header[1], header[2], &header[3..]);
        let sum = sizes.iter().fold(0usize, |sum, s| sum.saturating_add(*s));
        self.room.take(sum)?;
        let packed = stream.take(sum)?;
        let (mut rest, mut all) = (&packed[..], Vec::new());
        for (i, size) in sizes.iter().enumerate() {
            let (part, after) = rest.split_at_checked(*size).ok_or_else(|| refused("a block is cut off"))?;
            let whole = i + 1 < sizes.len() || last == 0;
            self.room.zlib(part, if whole { block } else { last }, &mut all)?;
            rest = after;
        }
        Ok(all)
    }

    fn plain(&mut self, stream: &mut Stream<'_>, size: usize) -> Result<Vec<u8>, FileError> {
        self.room.take(size)?;
        let long = self.header.size();
        // Some programs encode the header for itself.
        if stream.encoded && stream.rest.iter().take(encoded_length(long)).any(|b| *b == b'=') {
            stream.take(long)?;
            return Ok(stream.take(size)?.into_owned());
        }
        Ok(stream.take(long.saturating_add(size))?[long..].to_vec())
    }

    /// Some numbers of a header.
    fn header(&self, bytes: &[u8], count: usize) -> Result<Vec<usize>, FileError> {
        let mut file = self.all(bytes);
        let mut number = |_| match self.header.size() {
            4 => file.array().map(u32::from_le_bytes).map(u64::from),
            _ => file.array().map(u64::from_le_bytes),
        };
        (0..count).map(|i| Ok(usize::try_from(number(i)?).unwrap_or(usize::MAX))).collect()
    }
}

/// Numbers as words or bytes.
enum Numbers<'a> {
    Words(&'a str),
    Bytes(Vec<u8>, Kind),
}

/// Bytes, or characters of base64 that stand for some.
struct Stream<'a> {
    rest: &'a [u8],
    encoded: bool,
}

/// The characters that stand for some bytes.
fn encoded_length(bytes: usize) -> usize {
    bytes.div_ceil(3).saturating_mul(4)
}

impl<'a> Stream<'a> {
    /// The next bytes.
    fn peek(&self, count: usize) -> Result<Cow<'a, [u8]>, FileError> {
        let long = if self.encoded { encoded_length(count) } else { count };
        let part =
            self.rest.get(..long).ok_or_else(|| refused("an array goes on after the end of the data"))?;
        if !self.encoded {
            return Ok(part.into());
        }
        let mut bytes = BASE64_STANDARD.decode(part).map_err(|why| refused(format!("base64: {why}")))?;
        if bytes.len() < count {
            return Err(refused("an array is shorter than it says"));
        }
        bytes.truncate(count);
        Ok(bytes.into())
    }

    /// The next bytes, up to the end of a group of base64.
    fn take(&mut self, count: usize) -> Result<Cow<'a, [u8]>, FileError> {
        let bytes = self.peek(count)?;
        let long = if self.encoded { encoded_length(count) } else { count };
        self.rest = &self.rest[long..];
        Ok(bytes)
    }
}

/// An error in an array, with its name. Places count from the start of the array.
fn named(array: Node<'_, '_>, why: &FileError) -> FileError {
    let name: String = array.attribute("Name").unwrap_or("without a name").chars().take(40).collect();
    refused(format!("the array {name}: {why}"))
}

fn parsed<T: FromStr>(word: &str) -> Result<T, FileError> {
    word.parse().map_err(|_| refused(is_not(word, "a number of this array")))
}

fn real(word: &str) -> Result<f32, FileError> {
    parsed(word).or_else(|why| no_number(word).ok_or(why))
}
