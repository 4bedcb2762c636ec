//! The data of VTK files, legacy and XML: points, lines that name them, and arrays of both.

use std::collections::VecDeque;
use std::iter::repeat_n;

use glam::Vec3;

use super::error::{FileError, refused};
use crate::sets::LineSet;
use crate::sets::attributes::{Attributes, Of, Scalars};

/// The greatest number of components that become numbers of their own: a tensor.
const MOST_COMPONENTS: usize = 9;
/// The most values of vertices for each byte of a file: lines may share points, and each gets its
/// values.
const MOST_SHARED: usize = 8;

/// An array of points or cells.
pub(super) struct Array {
    pub(super) name: String,
    pub(super) components: usize,
    pub(super) values: Vec<f32>,
    /// Whether the values are bytes: three or four of them are a colour, as VTK takes them.
    pub(super) bytes: bool,
}

/// A piece of a file.
#[derive(Default)]
pub(super) struct Piece {
    pub(super) points: Vec<Vec3>,
    /// Cells before the lines, which own the first values of cells.
    pub(super) vertices: usize,
    /// Where each line ends in `connectivity`.
    pub(super) ends: Vec<u32>,
    pub(super) connectivity: Vec<u32>,
    /// Polygons and strips of triangles.
    pub(super) surfaces: usize,
    pub(super) point_data: Vec<Array>,
    pub(super) cell_data: Vec<Array>,
}

/// The lines of the pieces of a file of so many bytes. Arrays that a piece lacks are left out.
pub(super) fn lines(pieces: Vec<Piece>, bytes: usize) -> Result<LineSet, FileError> {
    let surfaces: usize = pieces.iter().map(|p| p.surfaces).sum();
    if surfaces > 0 && pieces.iter().all(|p| p.ends.is_empty()) {
        return Err(refused(format!("the file has {surfaces} polygons and no lines: only lines are read")));
    }
    let mut set = LineSet::default();
    let mut all: Option<VecDeque<(Of, Array)>> = None;
    let mut room = bytes.saturating_mul(MOST_SHARED);
    for piece in pieces {
        let mut start = 0;
        for &end in &piece.ends {
            let Some(line) = piece.connectivity.get(start..end as usize) else {
                let all = piece.connectivity.len();
                return Err(refused(format!("a line has the points {start} to {end} of {all} in the list")));
            };
            start = end as usize;
            if let Some(bad) = line.iter().find(|p| **p as usize >= piece.points.len()) {
                return Err(refused(format!("a line names point {bad} of {}", piece.points.len())));
            }
            set.push(line.iter().map(|p| piece.points[*p as usize]))?;
        }
        let mut own = piece.of_lines(start, &mut room)?;
        let Some(before) = &mut all else {
            all = Some(own);
            continue;
        };
        // Arrays stand in the same order in all pieces; so the first is the one that is looked for.
        before.retain_mut(|(of, array)| {
            let is_same = |other: &(Of, Array)| {
                (other.0, &other.1.name, other.1.components) == (*of, &array.name, array.components)
            };
            let found = own.iter().position(is_same).and_then(|at| own.remove(at));
            found.is_some_and(|(_, other)| {
                array.values.extend(other.values);
                true
            })
        });
    }
    let mut attributes = Attributes::default();
    for (of, array) in all.unwrap_or_default() {
        let n = array.components;
        if array.bytes && (3..=4).contains(&n) {
            let colours = array.values.chunks_exact(n).map(|c| [0, 1, 2].map(|i| c[i] as u8));
            attributes.colours = attributes.colours.or_else(|| {
                Some(match of {
                    Of::Vertices => colours.collect(),
                    Of::Lines => colours.zip(set.iter()).flat_map(|(c, l)| repeat_n(c, l.len())).collect(),
                })
            });
            continue;
        }
        for c in 0..n {
            let name = if n == 1 { array.name.clone() } else { format!("{}.{c}", array.name) };
            let values = array.values.iter().skip(c).step_by(n).copied().collect();
            attributes.scalars.push(Scalars { name, of, values });
        }
    }
    Ok(set.with_attributes(attributes)?)
}

impl Piece {
    /// Its arrays for the vertices of lines, `used` in all, and for the lines, in their order. At
    /// most `room` values of vertices may still be made. Arrays of many components are left out.
    fn of_lines(self, used: usize, room: &mut usize) -> Result<VecDeque<(Of, Array)>, FileError> {
        let lines = self.ends.len();
        let before = self.vertices.saturating_add(lines);
        let cells = before.saturating_add(self.surfaces);
        let of_points = self.point_data.into_iter().map(|array| (Of::Vertices, self.points.len(), array));
        let of_cells = self.cell_data.into_iter().map(|array| (Of::Lines, cells, array));
        let mut all = VecDeque::new();
        for (of, count, array) in of_points.chain(of_cells) {
            let (n, values) = (array.components, array.values);
            if values.len() != count.saturating_mul(n) {
                let (name, values) = (&array.name, values.len());
                let why = format!("the array {name} has {values} values for {count} points or cells");
                return Err(refused(why));
            }
            if n > MOST_COMPONENTS {
                continue;
            }
            let values = match of {
                Of::Lines => values[self.vertices * n..before * n].to_vec(),
                Of::Vertices => {
                    let why = "lines share points so often that their values would fill the memory";
                    *room = room.checked_sub(used.saturating_mul(n)).ok_or_else(|| refused(why))?;
                    let points = self.connectivity[..used].iter().map(|p| *p as usize * n);
                    points.flat_map(|at| &values[at..at + n]).copied().collect()
                }
            };
            all.push_back((of, Array { values, ..array }));
        }
        Ok(all)
    }
}
