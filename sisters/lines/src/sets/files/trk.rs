//! TrackVis tracks, version 2. <http://trackvis.org/docs/?subsect=fileformat>

use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::bytes::Bytes;
use super::error::{FileError, broken};
use crate::sets::LineSet;
use crate::sets::attributes::{Attributes, Of, Scalars};

/// The bytes of the header, and of a name in it.
const HEADER: usize = 1000;
const NAME: usize = 20;
/// As many names as the header has room for.
const NAMES: usize = 10;
/// Where fields of the header start.
const DIM: usize = 6;
const VOXEL_SIZE: usize = 12;
const SCALARS: usize = 36;
const PROPERTIES: usize = 238;
const VOX_TO_RAS: usize = 440;
const VOXEL_ORDER: usize = 948;
const COUNT: usize = 988;
/// Steps of Newton's iteration to the rotation of a matrix; it converges quadratically.
const STEPS: usize = 60;

/// The header's fields, in its byte order.
struct Header<'a> {
    bytes: &'a [u8],
    big: bool,
}

impl Header<'_> {
    fn new(bytes: &[u8]) -> Result<Header<'_>, FileError> {
        if bytes.get(..5) != Some(b"TRACK") {
            return Err(broken("byte", 0, "a TRK file starts with \"TRACK\""));
        }
        match (Bytes { bytes, at: HEADER - 4, big: false }).i32()? {
            1000 => Ok(Header { bytes, big: false }),
            size if size.swap_bytes() == 1000 => Ok(Header { bytes, big: true }),
            size => Err(broken("byte", HEADER - 4, format!("a header of {size} bytes: it must have 1000"))),
        }
    }

    fn at(&self, at: usize) -> Bytes<'_> {
        Bytes { bytes: self.bytes, at, big: self.big }
    }

    fn short(&self, at: usize) -> Result<i16, FileError> {
        self.at(at).array().map(i16::from_le_bytes)
    }

    fn count(&self, at: usize) -> Result<usize, FileError> {
        let value = self.short(at)?;
        usize::try_from(value).map_err(|_| broken("byte", at, format!("{value} values: less than none")))
    }

    /// The names of so many values, from a table of ten; values beyond have a number. Programs
    /// that store many values by one name write their count after the end of the name.
    fn names(&self, table: usize, count: usize, word: &str) -> Result<Vec<String>, FileError> {
        let mut names = Vec::with_capacity(count);
        for i in 0..NAMES {
            let mut parts = self.at(table + i * NAME).take(NAME)?.split(|b| *b == 0);
            let mut next = || String::from_utf8_lossy(parts.next().unwrap_or_default()).trim().to_owned();
            let (name, columns) = (next(), next().parse().unwrap_or(1));
            let name = if name.is_empty() { format!("{word} {}", i + 1) } else { name };
            match columns {
                0 | 1 => names.push(name),
                _ => names.extend((0..columns.min(count)).map(|c| format!("{name}.{c}"))),
            }
        }
        names.extend((names.len()..count).map(|i| format!("{word} {}", i + 1)));
        names.truncate(count);
        Ok(names)
    }

    /// The way from the file's coordinates (millimetres from the corner of the first voxel, along
    /// the axes of the stored image) to those of the scanner; none if the header has no matrix.
    fn to_scanner(&self) -> Result<Option<DAffine3>, FileError> {
        let fail = |at, why: &str| Err(broken("byte", at, why));
        let (mut file, mut row) = (self.at(VOX_TO_RAS), [[0.0; 4]; 4]);
        for value in row.iter_mut().flatten() {
            *value = f64::from(file.f32()?);
        }
        // The format's sign for a matrix that was not recorded.
        if row[3][3] == 0.0 {
            return Ok(None);
        }
        let turn = DMat3::from_cols_array_2d(&[0, 1, 2].map(|i| [row[i][0], row[i][1], row[i][2]]));
        let turn = turn.transpose();
        let shift = DVec3::new(row[0][3], row[1][3], row[2][3]);
        if !(turn.determinant() != 0.0 && turn.is_finite() && shift.is_finite()) {
            return fail(VOX_TO_RAS, "the matrix vox_to_ras is singular or not finite");
        }
        let mut sizes = self.at(VOXEL_SIZE);
        let size = sizes.point()?.as_dvec3();
        if !(size.min_element() > 0.0 && size.is_finite()) {
            return fail(VOXEL_SIZE, "the voxel sizes must be greater than 0");
        }
        let dim = [self.short(DIM)?, self.short(DIM + 2)?, self.short(DIM + 4)?].map(f64::from);
        let Some(swap) = order_of(self.at(VOXEL_ORDER).take(4)?).map(|order| swap(order, turn, dim)) else {
            return fail(VOXEL_ORDER, "the voxel order must name three axes, such as RAS or LPS");
        };
        // The middle of a voxel has whole coordinates in the matrix, and halves in the file.
        let voxels = DAffine3::from_translation(DVec3::splat(-0.5)) * DAffine3::from_scale(1.0 / size);
        Ok(Some(DAffine3::from_mat3_translation(turn, shift) * swap * voxels))
    }
}

/// The axes that letters name: the axis of the scanner, and whether it is run backwards. An order
/// that is not recorded is LPS.
fn order_of(letters: &[u8]) -> Option<[(usize, bool); 3]> {
    let word: Vec<u8> = letters.iter().copied().take_while(|b| *b != 0 && *b != b' ').collect();
    let word = if word.is_empty() { b"LPS".to_vec() } else { word.to_ascii_uppercase() };
    let axis = |letter: &u8| match letter {
        b'R' | b'L' => Some((0, *letter == b'L')),
        b'A' | b'P' => Some((1, *letter == b'P')),
        b'S' | b'I' => Some((2, *letter == b'I')),
        _ => None,
    };
    let axes: [(usize, bool); 3] = word.iter().map(axis).collect::<Option<Vec<_>>>()?.try_into().ok()?;
    let all = (0..3).all(|wanted| axes.iter().any(|(axis, _)| *axis == wanted));
    all.then_some(axes)
}

/// From voxels in the order of the header to voxels in the order that the matrix has.
fn swap(order: [(usize, bool); 3], turn: DMat3, dim: [f64; 3]) -> DAffine3 {
    let (mut columns, mut shift) = ([DVec3::ZERO; 3], DVec3::ZERO);
    for (row, (axis, back)) in axes_of(turn).into_iter().enumerate() {
        let Some(from) = order.iter().position(|o| o.0 == axis) else { continue };
        let same = order[from].1 == back;
        columns[from][row] = if same { 1.0 } else { -1.0 };
        shift[row] = if same { 0.0 } else { dim[from] - 1.0 };
    }
    DAffine3::from_mat3_translation(DMat3::from_cols(columns[0], columns[1], columns[2]), shift)
}

/// For each column the axis of the scanner that it runs along most, and whether backwards. Shear
/// and scale are taken out first, by the polar decomposition (Higham 1986).
fn axes_of(turn: DMat3) -> [(usize, bool); 3] {
    let unit = |c: DVec3| c.normalize_or_zero();
    let mut rotation = DMat3::from_cols(unit(turn.x_axis), unit(turn.y_axis), unit(turn.z_axis));
    for _ in 0..STEPS {
        let next = (rotation + rotation.inverse().transpose()) * 0.5;
        if !next.is_finite() {
            break;
        }
        rotation = next;
    }
    let mut free = [true; 3];
    [rotation.x_axis, rotation.y_axis, rotation.z_axis].map(|column| {
        let long = |axis: &usize| if free[*axis] { column[*axis].abs() } else { -1.0 };
        let axis = (0..3).max_by(|a, b| long(a).total_cmp(&long(b)).then(b.cmp(a))).unwrap_or(0);
        free[axis] = false;
        (axis, column[axis] < 0.0)
    })
}

/// The lines of a TRK file: a header, then for each line its number of vertices, and for each
/// vertex 3 + scalars floats; properties follow each line. Places are millimetres of the scanner
/// (right, anterior, superior) if the header has a matrix, and as stored if not.
pub(super) fn read(bytes: &[u8]) -> Result<LineSet, FileError> {
    let header = Header::new(bytes)?;
    let (scalars, properties) = (header.count(SCALARS)?, header.count(PROPERTIES)?);
    let promised = header.at(COUNT).i32()?;
    let to_scanner = header.to_scanner()?;
    let place = |p: Vec3| to_scanner.map_or(p, |m| m.transform_point3(p.as_dvec3()).as_vec3());
    let mut file = header.at(HEADER);
    let mut lines = LineSet::default();
    let (mut of_vertices, mut of_lines) = (vec![Vec::new(); scalars], vec![Vec::new(); properties]);
    // A count of 0 means that it was not stored.
    while file.left() > 0 {
        let start = file.at;
        let count = file.i32()?;
        let size = usize::try_from(count).ok().and_then(|c| c.checked_mul((3 + scalars) * 4));
        if size.is_none_or(|s| s > file.left()) {
            let why = "is longer than the file, which is cut short or counts scalars and properties wrongly";
            return Err(broken("byte", start, format!("a line of {count} vertices {why}")));
        }
        let mut line = Vec::with_capacity(count as usize);
        for _ in 0..count {
            line.push(place(file.point()?));
            of_vertices.iter_mut().try_for_each(|s| file.f32().map(|v| s.push(v)))?;
        }
        of_lines.iter_mut().try_for_each(|p| file.f32().map(|v| p.push(v)))?;
        lines.push(line)?;
    }
    if promised > 0 && promised as usize != lines.len() {
        let why = format!("the header promises {promised} lines, the file has {}: is it whole?", lines.len());
        return Err(broken("byte", COUNT, why));
    }
    let named = |table, word, of, all: Vec<Vec<f32>>| -> Result<Vec<Scalars>, FileError> {
        let names = header.names(table, all.len(), word)?;
        Ok(names.into_iter().zip(all).map(|(name, values)| Scalars { name, of, values }).collect())
    };
    let mut all = named(SCALARS + 2, "scalar", Of::Vertices, of_vertices)?;
    all.extend(named(PROPERTIES + 2, "property", Of::Lines, of_lines)?);
    Ok(lines.with_attributes(Attributes { scalars: all, ..Attributes::default() })?)
}
