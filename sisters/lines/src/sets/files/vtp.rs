//! VTK's XML files of lines.
//! <https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>

use std::borrow::Cow;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use roxmltree::{Document, Node};

use super::bytes::{Bytes, Kind};
use super::error::{FileError, refused};
use super::polydata::{Array, Piece, lines};
use super::unpack::Room;
use super::words::{parse, real};
use crate::sets::LineSet;

/// Starts the part that follows the XML and need not be text.
const APPENDED: &[u8] = b"<AppendedData";
/// What a word of an array should be, in errors.
const NUMBER: &str = "a number of this array";

/// The lines of a file of PolyData, with the arrays of their points and cells.
pub(super) fn read(bytes: &[u8]) -> Result<LineSet, FileError> {
    let start = bytes.windows(APPENDED.len()).position(|w| w == APPENDED);
    let (text, appended) = bytes.split_at(start.unwrap_or(bytes.len()));
    // Letters of other encodings stand in names and comments only.
    let text = String::from_utf8_lossy(text);
    let closed = if start.is_some() { format!("{text}</VTKFile>") } else { text.into_owned() };
    let document = Document::parse(&closed).map_err(|why| refused(format!("the XML is broken: {why}")))?;
    let root = document.root_element();
    if root.tag_name().name() != "VTKFile" {
        return Err(refused("the XML is no VTKFile"));
    }
    let kind = root.attribute("type").unwrap_or_default();
    let Some(data) = child(root, "PolyData").filter(|_| kind == "PolyData") else {
        let kind: String = kind.chars().take(30).collect();
        return Err(refused(format!("a VTKFile of {kind}: only PolyData is read")));
    };
    let mut store = Store::new(root, appended, bytes.len())?;
    let pieces = data.children().filter(|n| n.has_tag_name("Piece"));
    let pieces = pieces.map(|n| piece(n, &mut store)).collect::<Result<Vec<_>, _>>()?;
    lines(pieces, bytes.len())
}

fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    node.children().find(|n| n.has_tag_name(name))
}

fn arrays<'a>(node: Node<'a, 'a>, of: &str) -> impl Iterator<Item = Node<'a, 'a>> + use<'a> {
    child(node, of).into_iter().flat_map(|n| n.children().filter(|n| n.has_tag_name("DataArray")))
}

fn piece<'a>(node: Node<'a, 'a>, store: &mut Store<'_>) -> Result<Piece, FileError> {
    let count = |name: &str| -> Result<usize, FileError> {
        let text = node.attribute(name).unwrap_or("0");
        let number: u32 =
            text.trim().parse().map_err(|_| refused(format!("{name} is no number of something")))?;
        Ok(number as usize)
    };
    let mut piece = Piece {
        vertices: count("NumberOfVerts")?,
        surfaces: count("NumberOfPolys")?.saturating_add(count("NumberOfStrips")?),
        ..Piece::default()
    };
    if let Some(points) = arrays(node, "Points").next() {
        let values = store.floats(points)?;
        piece.points = values.as_chunks::<3>().0.iter().map(|p| (*p).into()).collect();
    }
    if piece.points.len() != count("NumberOfPoints")? {
        return Err(refused(format!("a piece has {} points, not as many as it says", piece.points.len())));
    }
    for array in arrays(node, "Lines") {
        match array.attribute("Name") {
            Some("connectivity") => piece.connectivity = store.indices(array)?,
            Some("offsets") => piece.ends = store.indices(array)?,
            _ => {}
        }
    }
    if piece.ends.len() != count("NumberOfLines")? {
        return Err(refused(format!("a piece has {} lines, not as many as it says", piece.ends.len())));
    }
    piece.point_data = data(node, "PointData", store)?;
    piece.cell_data = data(node, "CellData", store)?;
    Ok(piece)
}

/// The arrays of points or cells; those of other things than numbers are left out.
fn data<'a>(node: Node<'a, 'a>, of: &str, store: &mut Store<'_>) -> Result<Vec<Array>, FileError> {
    let mut all = Vec::new();
    for (i, array) in arrays(node, of).enumerate() {
        let Some(kind) = kind_of(array) else { continue };
        let name = array.attribute("Name").map_or_else(|| format!("array {}", i + 1), str::to_owned);
        let components = array.attribute("NumberOfComponents").unwrap_or("1");
        let components: u32 = components
            .trim()
            .parse()
            .map_err(|_| refused(format!("the array {name} has no number of components")))?;
        let (values, bytes) = (store.floats(array)?, kind == Kind::Unsigned(1));
        all.push(Array { name, components: components as usize, values, bytes });
    }
    Ok(all)
}

/// The encoding that all arrays of a file share.
struct Store<'a> {
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
fn kind_of(array: Node<'_, '_>) -> Option<Kind> {
    Kind::named(&array.attribute("type")?.to_ascii_lowercase())
}

impl<'a> Store<'a> {
    /// By the attributes of the root, and what follows the XML in a file of so many bytes.
    fn new(root: Node<'_, '_>, appended: &'a [u8], bytes: usize) -> Result<Self, FileError> {
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
    fn floats(&mut self, array: Node<'_, '_>) -> Result<Vec<f32>, FileError> {
        self.numbers(array, |word| real(word, NUMBER), |file, kind, n| file.floats(kind, n))
    }

    /// The numbers of an array as numbers of points.
    fn indices(&mut self, array: Node<'_, '_>) -> Result<Vec<u32>, FileError> {
        self.numbers(array, |word| parse(word, NUMBER), |file, kind, n| file.indices(kind, n))
    }

    /// The numbers of an array, as words or in binary. Errors name it; places count from its start.
    fn numbers<T>(
        &mut self,
        array: Node<'_, '_>,
        word: impl Fn(&str) -> Result<T, String>,
        binary: impl Fn(&mut Bytes<'_>, Kind, usize) -> Result<Vec<T>, FileError>,
    ) -> Result<Vec<T>, FileError> {
        let mut read = || -> Result<Vec<T>, FileError> {
            let kind = kind_of(array).ok_or_else(|| refused("an array of points or lines has no numbers"))?;
            // Keys of information may stand before the numbers.
            let texts = array.children().filter_map(|n| n.text().filter(|_| n.is_text()));
            let text = texts.map(str::trim).find(|t| !t.is_empty()).unwrap_or_default();
            let bytes = match array.attribute("format") {
                Some("ascii") => {
                    return text.split_ascii_whitespace().map(|w| word(w).map_err(refused)).collect();
                }
                None | Some("binary") => {
                    let text: Vec<u8> = text.bytes().filter(|b| !b.is_ascii_whitespace()).collect();
                    self.data(&mut Stream { rest: &text, encoded: true })?
                }
                Some("appended") => {
                    let offset = array.attribute("offset").and_then(|o| o.trim().parse::<usize>().ok());
                    let rest = offset.and_then(|at| self.appended.get(at..));
                    let rest =
                        rest.ok_or_else(|| refused("the offset of an array lies outside of the file"))?;
                    self.data(&mut Stream { rest, encoded: self.encoded })?
                }
                Some(_) => return Err(refused("the format of an array must be ascii, binary or appended")),
            };
            let count = bytes.len() / kind.size();
            // Numbers need 4 bytes each.
            self.room.take(count.saturating_mul(4))?;
            binary(&mut Bytes { bytes: &bytes, at: 0, big: self.big }, kind, count)
        };
        read().map_err(|why| {
            let name: String = array.attribute("Name").unwrap_or("without a name").chars().take(40).collect();
            refused(format!("the array {name}: {why}"))
        })
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
        let mut file = Bytes { bytes, at: 0, big: self.big };
        let mut number = |_| match self.header.size() {
            4 => file.array().map(u32::from_le_bytes).map(u64::from),
            _ => file.array().map(u64::from_le_bytes),
        };
        (0..count).map(|i| Ok(usize::try_from(number(i)?).unwrap_or(usize::MAX))).collect()
    }
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
