//! VTK's legacy files of lines.
//! <https://docs.vtk.org/en/latest/vtk_file_formats/vtk_legacy_file_format.html>

use std::iter::repeat_n;

use glam::Vec3;

use super::bytes::{Bytes, Kind};
use super::error::{FileError, refused};
use super::words::Scan;
use crate::sets::LineSet;
use crate::sets::attributes::{Attributes, Of, Scalars};

/// The greatest number of components that become numbers of their own: a tensor.
const MOST_COMPONENTS: usize = 9;
/// The most values of vertices for each byte of a file: lines may share points, and each gets its
/// values.
const MOST_SHARED: usize = 8;

/// An array of points or cells.
struct Array {
    of: Of,
    name: String,
    components: usize,
    values: Vec<f32>,
    /// Whether the values are bytes: three or four of them are a colour, as VTK takes them.
    bytes: bool,
}

/// The data of a file.
#[derive(Default)]
struct PolyData {
    points: Vec<Vec3>,
    /// Cells before the lines, which own the first values of cells.
    vertices: usize,
    /// Where each line ends in `connectivity`.
    ends: Vec<u32>,
    connectivity: Vec<u32>,
    /// Polygons and strips of triangles.
    surfaces: usize,
    arrays: Vec<Array>,
}

impl PolyData {
    /// The lines of a file of so many bytes, with their arrays; those of many components are left
    /// out.
    fn lines(mut self, bytes: usize) -> Result<LineSet, FileError> {
        if self.surfaces > 0 && self.ends.is_empty() {
            let why = format!("the file has {} polygons and no lines: only lines are read", self.surfaces);
            return Err(refused(why));
        }
        let mut set = LineSet::default();
        let mut used = 0;
        for &end in &self.ends {
            let Some(line) = self.connectivity.get(used..end as usize) else {
                let all = self.connectivity.len();
                return Err(refused(format!("a line has the points {used} to {end} of {all} in the list")));
            };
            used = end as usize;
            if let Some(bad) = line.iter().find(|p| **p as usize >= self.points.len()) {
                return Err(refused(format!("a line names point {bad} of {}", self.points.len())));
            }
            set.push(line.iter().map(|p| self.points[*p as usize]))?;
        }
        let lines = self.vertices..self.vertices.saturating_add(self.ends.len());
        let cells = lines.end.saturating_add(self.surfaces);
        let mut room = bytes.saturating_mul(MOST_SHARED);
        let mut attributes = Attributes::default();
        // Those of points first: a set is coloured by its first numbers.
        self.arrays.sort_by_key(|array| array.of == Of::Lines);
        for Array { of, name, components: n, values, bytes } in self.arrays {
            let count = if of == Of::Vertices { self.points.len() } else { cells };
            if values.len() != count.saturating_mul(n) {
                let values = values.len();
                let why = format!("the array {name} has {values} values for {count} points or cells");
                return Err(refused(why));
            }
            if n > MOST_COMPONENTS {
                continue;
            }
            let values: Vec<f32> = match of {
                Of::Lines => values[lines.start * n..lines.end * n].to_vec(),
                Of::Vertices => {
                    let why = "lines share points so often that their values would fill the memory";
                    room = room.checked_sub(used.saturating_mul(n)).ok_or_else(|| refused(why))?;
                    let points = self.connectivity[..used].iter().map(|p| *p as usize * n);
                    points.flat_map(|at| &values[at..at + n]).copied().collect()
                }
            };
            if bytes && (3..=4).contains(&n) {
                let colours = values.chunks_exact(n).map(|c| [0, 1, 2].map(|i| c[i] as u8));
                attributes.colours = attributes.colours.or_else(|| {
                    Some(match of {
                        Of::Vertices => colours.collect(),
                        Of::Lines => {
                            colours.zip(set.iter()).flat_map(|(c, l)| repeat_n(c, l.len())).collect()
                        }
                    })
                });
                continue;
            }
            for c in 0..n {
                let name = if n == 1 { name.clone() } else { format!("{name}.{c}") };
                let values = values.iter().skip(c).step_by(n).copied().collect();
                attributes.scalars.push(Scalars { name, of, values });
            }
        }
        Ok(set.with_attributes(attributes)?)
    }
}

/// A file from a place on.
struct File<'a> {
    text: Scan<'a>,
    ascii: bool,
    /// Whether cells have offsets, since version 5.
    offsets: bool,
}

/// The lines of a file of POLYDATA, with the arrays of their points and cells.
pub(super) fn read(bytes: &[u8]) -> Result<LineSet, FileError> {
    let mut file = File::new(bytes)?;
    // What arrays belong to, and how many rows those have.
    let (mut all, mut data) = (PolyData::default(), None);
    while let Some(word) = file.text.word() {
        match word {
            "POINTS" => {
                let count: usize = file.text.number("a number of points")?;
                let kind = file.kind()?;
                let values = file.floats(kind, count.saturating_mul(3))?;
                all.points = values.as_chunks::<3>().0.iter().map(|p| (*p).into()).collect();
            }
            "LINES" => (all.ends, all.connectivity) = file.cells()?,
            "VERTICES" => all.vertices = file.cells()?.0.len(),
            "POLYGONS" | "TRIANGLE_STRIPS" => all.surfaces += file.cells()?.0.len(),
            "POINT_DATA" => data = Some((Of::Vertices, file.text.number("a number of points")?)),
            "CELL_DATA" => data = Some((Of::Lines, file.text.number("a number of cells")?)),
            "METADATA" => file.pass_metadata(),
            "LOOKUP_TABLE" => {
                file.text.name("a name")?;
                let count: usize = file.text.number("a number of colours")?;
                file.floats(Kind::Unsigned(1), count.saturating_mul(4))?;
            }
            _ => {
                let arrays = file.arrays(word, data)?;
                // Those of the whole file belong to no line.
                all.arrays.extend(arrays.into_iter().filter(|_| data.is_some()));
            }
        }
    }
    all.lines(bytes.len())
}

impl<'a> File<'a> {
    /// Reads the header.
    fn new(bytes: &'a [u8]) -> Result<Self, FileError> {
        let mut text = Scan::new(bytes, "byte");
        let Some(version) = text.line().strip_prefix(b"# vtk DataFile Version ") else {
            let more = if bytes.starts_with(b"<") { "; one of XML must be saved as legacy VTK" } else { "" };
            return Err(text.fail_at(0, format!("a VTK file starts with \"# vtk DataFile Version\"{more}")));
        };
        let version = String::from_utf8_lossy(version);
        let major = version.trim().split('.').next().and_then(|v| v.parse().ok());
        // The title.
        text.line();
        let ascii = match text.word() {
            Some("ASCII") => true,
            Some("BINARY") => false,
            _ => return Err(text.fail("the third line must be ASCII or BINARY")),
        };
        match (text.word(), text.word()) {
            (Some("DATASET"), Some("POLYDATA")) => {
                Ok(Self { text, ascii, offsets: major.is_some_and(|v: u32| v >= 5) })
            }
            (Some("DATASET"), Some(other)) => {
                Err(text.fail(format!("a data set of {}: only POLYDATA is read", cut(other))))
            }
            _ => Err(text.fail("the fourth line must name a data set")),
        }
    }

    fn kind(&mut self) -> Result<Kind, FileError> {
        let word = self.text.word().unwrap_or_default();
        let fail = || self.text.fail(format!("numbers of the type \"{}\" are not read", cut(word)));
        Kind::named(&word.to_ascii_lowercase()).ok_or_else(fail)
    }

    /// Binary numbers start after the end of the line.
    fn binary<T>(&mut self, read: impl FnOnce(&mut Bytes<'a>) -> T) -> T {
        self.text.line();
        let mut numbers = Bytes { bytes: self.text.bytes, at: self.text.at, big: true };
        let all = read(&mut numbers);
        self.text.at = numbers.at;
        all
    }

    fn floats(&mut self, kind: Kind, count: usize) -> Result<Vec<f32>, FileError> {
        if self.ascii {
            return (0..count).map(|_| self.text.real::<f64>("a number").map(|v| v as f32)).collect();
        }
        self.binary(|numbers| numbers.floats(kind, count))
    }

    fn indices(&mut self, kind: Kind, count: usize) -> Result<Vec<u32>, FileError> {
        if self.ascii {
            return (0..count).map(|_| self.text.number("the number of a point")).collect();
        }
        self.binary(|numbers| numbers.indices(kind, count))
    }

    /// Where each cell ends in a list of the numbers of points, and the list.
    fn cells(&mut self) -> Result<(Vec<u32>, Vec<u32>), FileError> {
        let (count, size) = (self.text.number("a number of cells")?, self.text.number("a size")?);
        if self.offsets {
            if count == 0 && size == 0 {
                return Ok(Default::default());
            }
            let mut part = |name, count| match self.text.name("a name")? == name {
                true => self.kind().and_then(|kind| self.indices(kind, count)),
                false => Err(self.text.fail(format!("cells must have {name}"))),
            };
            let (mut ends, list) = (part("OFFSETS", count)?, part("CONNECTIVITY", size)?);
            // The first is where the first cell starts.
            let start = (!ends.is_empty()).then(|| ends.remove(0));
            return match start.is_none_or(|s| s == 0) && ends.is_sorted() {
                true => Ok((ends, list)),
                false => Err(self.text.fail("the offsets of cells must grow from 0")),
            };
        }
        let all = self.indices(Kind::Signed(4), size)?;
        let (mut ends, mut list, mut rest) = (Vec::new(), Vec::new(), &all[..]);
        while let Some((long, after)) = rest.split_first() {
            let Some((cell, after)) = after.split_at_checked(*long as usize) else {
                return Err(self.text.fail(format!("a cell of {long} points is longer than the list")));
            };
            list.extend_from_slice(cell);
            ends.push(list.len() as u32);
            rest = after;
        }
        match ends.len() == count {
            true => Ok((ends, list)),
            false => Err(self.text.fail(format!("{} cells stand where {count} were promised", ends.len()))),
        }
    }

    /// Names and locations of components, up to an empty line.
    fn pass_metadata(&mut self) {
        self.text.line();
        while self.text.at < self.text.bytes.len() && !self.text.line().trim_ascii().is_empty() {}
    }

    /// The arrays of a section, with what they belong to and the number of its rows.
    fn arrays(&mut self, section: &str, data: Option<(Of, usize)>) -> Result<Vec<Array>, FileError> {
        let mut components = match section {
            "FIELD" => return self.field(data.map_or(Of::Vertices, |(of, _)| of)),
            "SCALARS" | "GLOBAL_IDS" | "PEDIGREE_IDS" | "EDGE_FLAGS" => 1,
            "VECTORS" | "NORMALS" => 3,
            "TENSORS" => 9,
            "TENSORS6" => 6,
            "TEXTURE_COORDINATES" | "COLOR_SCALARS" => 0,
            _ => return Err(self.text.fail(format!("a section \"{}\" is not read", cut(section)))),
        };
        let Some((of, rows)) = data else {
            return Err(self.text.fail(format!("{section} must follow POINT_DATA or CELL_DATA")));
        };
        let name = percent(self.text.name("a name")?);
        if components == 0 {
            components = self.text.number("a number of components")?;
        }
        let is_colour = section == "COLOR_SCALARS";
        let kind = if is_colour { Kind::Unsigned(1) } else { self.kind()? };
        if section == "SCALARS" {
            if let Some(word) = self.text.word_of_line() {
                components = word.parse().map_err(|_| self.text.fail("the number of components is none"))?;
            }
            let before = self.text.at;
            match self.text.word() {
                Some("LOOKUP_TABLE") => drop(self.text.name("a name")?),
                _ => self.text.at = before,
            }
        }
        let mut values = self.floats(kind, rows.saturating_mul(components))?;
        if is_colour && self.ascii {
            values.iter_mut().for_each(|v| *v = (*v * 255.0).round());
        }
        Ok(vec![Array { of, name, components, values, bytes: kind == Kind::Unsigned(1) }])
    }

    fn field(&mut self, of: Of) -> Result<Vec<Array>, FileError> {
        self.text.name("a name")?;
        let count: usize = self.text.number("a number of arrays")?;
        let mut arrays = Vec::new();
        for _ in 0..count {
            let mut name = self.text.name("a name")?;
            if name == "METADATA" {
                self.pass_metadata();
                name = self.text.name("a name")?;
            }
            let components: usize = self.text.number("a number of components")?;
            let rows: usize = self.text.number("a number of rows")?;
            let kind = self.kind()?;
            let values = self.floats(kind, components.saturating_mul(rows))?;
            let bytes = kind == Kind::Unsigned(1);
            arrays.push(Array { of, name: percent(name), components, values, bytes });
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
