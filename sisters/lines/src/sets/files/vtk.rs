//! VTK's legacy files of lines.
//! <https://docs.vtk.org/en/latest/vtk_file_formats/vtk_legacy_file_format.html>

use super::bytes::{Bytes, Kind, are_words};
use super::error::{FileError, broken};
use super::polydata::{Array, Piece, lines};
use super::words::{is_not, line_end, no_number};
use crate::sets::LineSet;

/// What follows a list of points or cells.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Data {
    None,
    Points(usize),
    Cells(usize),
}

/// A file from a place on.
struct File<'a> {
    bytes: &'a [u8],
    at: usize,
    ascii: bool,
    /// Whether cells have offsets, since version 5.
    offsets: bool,
    /// The byte that ends lines.
    line_end: u8,
}

/// The kind of number with a name.
fn kind_named(name: &str) -> Option<Kind> {
    Some(match name {
        "float" => Kind::Float(4),
        "double" => Kind::Float(8),
        "char" | "signed_char" => Kind::Signed(1),
        "short" => Kind::Signed(2),
        // VTK writes its own kind of number with 32 bits.
        "int" | "vtkIdType" => Kind::Signed(4),
        "long" | "vtktypeint64" => Kind::Signed(8),
        "unsigned_char" => Kind::Unsigned(1),
        "unsigned_short" => Kind::Unsigned(2),
        "unsigned_int" => Kind::Unsigned(4),
        "unsigned_long" | "vtktypeuint64" => Kind::Unsigned(8),
        _ => return None,
    })
}

/// The lines of a file of POLYDATA, with the arrays of their points and cells.
pub(super) fn read(bytes: &[u8]) -> Result<LineSet, FileError> {
    let mut file = File::new(bytes)?;
    let (mut piece, mut data) = (Piece::default(), Data::None);
    while let Some(word) = file.word() {
        match word {
            "POINTS" => {
                let count: usize = file.count("a number of points")?;
                let kind = file.kind()?;
                let values = file.floats(kind, count.saturating_mul(3))?;
                piece.points = values.as_chunks::<3>().0.iter().map(|p| (*p).into()).collect();
            }
            "LINES" => (piece.ends, piece.connectivity) = file.cells()?,
            "VERTICES" => piece.vertices = file.cells()?.0.len(),
            "POLYGONS" | "TRIANGLE_STRIPS" => piece.surfaces += file.cells()?.0.len(),
            "POINT_DATA" => data = Data::Points(file.count("a number of points")?),
            "CELL_DATA" => data = Data::Cells(file.count("a number of cells")?),
            "METADATA" => file.pass_metadata(),
            "LOOKUP_TABLE" => {
                file.name()?;
                let count: usize = file.count("a number of colours")?;
                file.floats(Kind::Unsigned(1), count.saturating_mul(4))?;
            }
            _ => {
                let arrays = file.arrays(word, data)?;
                match data {
                    Data::None => {}
                    Data::Points(_) => piece.point_data.extend(arrays),
                    Data::Cells(_) => piece.cell_data.extend(arrays),
                }
            }
        }
    }
    lines(vec![piece], bytes.len())
}

impl<'a> File<'a> {
    /// Reads the header.
    fn new(bytes: &'a [u8]) -> Result<Self, FileError> {
        let mut file = Self { bytes, at: 0, ascii: true, offsets: false, line_end: line_end(bytes) };
        let Some(version) = file.line().strip_prefix("# vtk DataFile Version ") else {
            let xml = bytes.starts_with(b"<");
            let more = if xml { "; one of XML has the ending .vtp" } else { "" };
            return Err(broken(
                "byte",
                0,
                format!("a VTK file starts with \"# vtk DataFile Version\"{more}"),
            ));
        };
        file.offsets =
            version.trim().split('.').next().and_then(|v| v.parse().ok()).is_some_and(|v: u32| v >= 5);
        // The title.
        file.line();
        file.ascii = match file.word() {
            Some("ASCII") => true,
            Some("BINARY") => false,
            _ => return Err(file.fail("the third line must be ASCII or BINARY")),
        };
        match (file.word(), file.word()) {
            (Some("DATASET"), Some("POLYDATA")) => Ok(file),
            (Some("DATASET"), Some(other)) => {
                Err(file.fail(format!("a data set of {}: only POLYDATA is read", cut(other))))
            }
            _ => Err(file.fail("the fourth line must name a data set")),
        }
    }

    fn fail(&self, why: impl Into<String>) -> FileError {
        broken("byte", self.at, why)
    }

    /// The rest of a line.
    fn line(&mut self) -> &'a str {
        let rest = &self.bytes[self.at..];
        let long = rest.iter().position(|b| *b == self.line_end).unwrap_or(rest.len());
        self.at = (self.at + long + 1).min(self.bytes.len());
        str::from_utf8(&rest[..long]).unwrap_or("\u{fffd}")
    }

    fn word(&mut self) -> Option<&'a str> {
        let rest = &self.bytes[self.at..];
        let start = rest.iter().position(|b| !b.is_ascii_whitespace())?;
        let long = rest[start..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - start);
        self.at += start + long;
        Some(str::from_utf8(&rest[start..start + long]).unwrap_or("\u{fffd}"))
    }

    /// The next word, if it stands in this line.
    fn word_of_line(&mut self) -> Option<&'a str> {
        let rest = &self.bytes[self.at..];
        let start = rest.iter().position(|b| *b == self.line_end || !matches!(b, b' ' | b'\t' | b'\r'))?;
        if rest[start] == self.line_end { None } else { self.word() }
    }

    fn name(&mut self) -> Result<&'a str, FileError> {
        self.word().ok_or_else(|| self.fail("the file ends before a name"))
    }

    fn count<T: std::str::FromStr>(&mut self, what: &str) -> Result<T, FileError> {
        let word = self.word().unwrap_or_default();
        word.parse().map_err(|_| self.fail(self.is_not(word, what)))
    }

    fn is_not(&self, word: &str, what: &str) -> String {
        match word {
            "" => format!("the file ends before {what}"),
            word => is_not(word, what),
        }
    }

    /// The next word as a number with decimals.
    fn real(&mut self) -> Result<f64, FileError> {
        let word = self.word().unwrap_or_default();
        let number = word.parse().ok().or_else(|| no_number(word).map(f64::from));
        number.ok_or_else(|| self.fail(self.is_not(word, "a number")))
    }

    fn kind(&mut self) -> Result<Kind, FileError> {
        let word = self.word().unwrap_or_default();
        kind_named(&word.to_ascii_lowercase())
            .or_else(|| kind_named(word))
            .ok_or_else(|| self.fail(format!("numbers of the type \"{}\" are not read", cut(word))))
    }

    /// Binary numbers start after the end of the line.
    fn binary(&mut self) -> Bytes<'a> {
        self.line();
        Bytes { bytes: self.bytes, at: self.at, big: true }
    }

    fn floats(&mut self, kind: Kind, count: usize) -> Result<Vec<f32>, FileError> {
        if self.ascii {
            return (0..count).map(|_| self.real().map(|v| v as f32)).collect();
        }
        let mut numbers = self.binary();
        let own = count.saturating_mul(kind.size()).min(numbers.left());
        if matches!(kind, Kind::Float(_)) && are_words(&self.bytes[self.at..][..own]) {
            return Err(self.fail("the numbers are text, but the third line says BINARY: it must say ASCII"));
        }
        let all = numbers.floats(kind, count);
        self.at = numbers.at;
        all
    }

    fn indices(&mut self, kind: Kind, count: usize) -> Result<Vec<u32>, FileError> {
        if self.ascii {
            return (0..count).map(|_| self.count::<u32>("the number of a point")).collect();
        }
        let mut numbers = self.binary();
        let all = numbers.indices(kind, count);
        self.at = numbers.at;
        all
    }

    /// Where each cell ends in a list of the numbers of points, and the list.
    fn cells(&mut self) -> Result<(Vec<u32>, Vec<u32>), FileError> {
        let (count, size): (usize, usize) = (self.count("a number of cells")?, self.count("a size")?);
        if self.offsets {
            if count == 0 && size == 0 {
                return Ok(Default::default());
            }
            let mut part = |name, count| match self.name()? == name {
                true => self.kind().and_then(|kind| self.indices(kind, count)),
                false => Err(self.fail(format!("cells must have {name}"))),
            };
            let (mut ends, list) = (part("OFFSETS", count)?, part("CONNECTIVITY", size)?);
            // The first is where the first cell starts.
            let start = (!ends.is_empty()).then(|| ends.remove(0));
            return match start.is_none_or(|s| s == 0) && ends.is_sorted() {
                true => Ok((ends, list)),
                false => Err(self.fail("the offsets of cells must grow from 0")),
            };
        }
        let all = self.indices(Kind::Signed(4), size)?;
        let (mut ends, mut list, mut rest) = (Vec::new(), Vec::new(), &all[..]);
        while let Some((long, after)) = rest.split_first() {
            let Some((cell, after)) = after.split_at_checked(*long as usize) else {
                let swapped = !self.ascii && long.swap_bytes() as usize <= list.len() + after.len();
                let more = if swapped { ": binary numbers of VTK start with their highest byte" } else { "" };
                return Err(self.fail(format!("a cell of {long} points is longer than the list{more}")));
            };
            list.extend_from_slice(cell);
            ends.push(list.len() as u32);
            rest = after;
        }
        match ends.len() == count {
            true => Ok((ends, list)),
            false => Err(self.fail(format!("{} cells stand where {count} were promised", ends.len()))),
        }
    }

    /// Names and locations of components, up to an empty line.
    fn pass_metadata(&mut self) {
        self.line();
        while self.at < self.bytes.len() && !self.line().trim().is_empty() {}
    }

    /// The arrays of a section.
    fn arrays(&mut self, section: &str, data: Data) -> Result<Vec<Array>, FileError> {
        let components = match section {
            "FIELD" => return self.field(data),
            "SCALARS" => 1,
            "VECTORS" | "NORMALS" => 3,
            "TENSORS" => 9,
            "TENSORS6" => 6,
            "GLOBAL_IDS" | "PEDIGREE_IDS" | "EDGE_FLAGS" => 1,
            "TEXTURE_COORDINATES" | "COLOR_SCALARS" => 0,
            _ => return Err(self.fail(format!("a section \"{}\" is not read", cut(section)))),
        };
        let (Data::Points(count) | Data::Cells(count)) = data else {
            return Err(self.fail(format!("{section} must follow POINT_DATA or CELL_DATA")));
        };
        let name = percent(self.name()?);
        if section == "COLOR_SCALARS" {
            let components = self.count("a number of components")?;
            let mut values = self.floats(Kind::Unsigned(1), count.saturating_mul(components))?;
            if self.ascii {
                values.iter_mut().for_each(|v| *v = (*v * 255.0).round());
            }
            return Ok(vec![Array { name, components, values, bytes: true }]);
        }
        let mut components = components;
        if section == "TEXTURE_COORDINATES" {
            components = self.count("a number of components")?;
        }
        let kind = self.kind()?;
        if section == "SCALARS" {
            if let Some(word) = self.word_of_line() {
                components = word.parse().map_err(|_| self.fail("the number of components is none"))?;
            }
            let before = self.at;
            match self.word() {
                Some("LOOKUP_TABLE") => drop(self.name()?),
                _ => self.at = before,
            }
        }
        let values = self.floats(kind, count.saturating_mul(components))?;
        Ok(vec![Array { name, components, values, bytes: kind == Kind::Unsigned(1) }])
    }

    fn field(&mut self, data: Data) -> Result<Vec<Array>, FileError> {
        self.name()?;
        let count: usize = self.count("a number of arrays")?;
        let mut arrays = Vec::new();
        for _ in 0..count {
            let mut name = self.name()?;
            if name == "METADATA" {
                self.pass_metadata();
                name = self.name()?;
            }
            let (components, rows): (usize, usize) =
                (self.count("a number of components")?, self.count("a number of rows")?);
            let kind = self.kind()?;
            let values = self.floats(kind, components.saturating_mul(rows))?;
            let array = Array { name: percent(name), components, values, bytes: kind == Kind::Unsigned(1) };
            // Those of the whole file belong to no line.
            if data != Data::None {
                arrays.push(array);
            }
        }
        Ok(arrays)
    }
}

/// A name with the bytes that VTK writes as %XX.
fn percent(name: &str) -> String {
    let mut parts = name.split('%');
    let mut bytes = parts.next().unwrap_or_default().as_bytes().to_vec();
    for part in parts {
        match part.get(..2).and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                bytes.extend_from_slice(&part.as_bytes()[2..]);
            }
            None => bytes.extend([b"%", part.as_bytes()].concat()),
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// The start of a word, for errors.
fn cut(word: &str) -> String {
    word.chars().take(20).collect()
}
