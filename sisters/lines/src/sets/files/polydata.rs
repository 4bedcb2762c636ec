//! The data of VTK files, legacy and XML: points, lines that name them, and arrays of both.

use std::collections::VecDeque;

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

/// A column of values, in the order of vertices or lines.
enum Column {
    Scalars(Scalars),
    Colours(Of, Vec<[u8; 3]>),
}

/// The lines of the pieces of a file of so many bytes. Arrays that a piece lacks are left out.
pub(super) fn lines(pieces: Vec<Piece>, bytes: usize) -> Result<LineSet, FileError> {
    let fail = |why: String| Err(refused(why));
    let surfaces: usize = pieces.iter().map(|p| p.surfaces).sum();
    if surfaces > 0 && pieces.iter().all(|p| p.ends.is_empty()) {
        return fail(format!("the file has {surfaces} polygons and no lines: only lines are read"));
    }
    let mut set = LineSet::default();
    let mut columns: Option<Vec<Column>> = None;
    let mut room = bytes.saturating_mul(MOST_SHARED);
    for piece in pieces {
        let mut start = 0;
        for &end in &piece.ends {
            let Some(line) = piece.connectivity.get(start..end as usize) else {
                let all = piece.connectivity.len();
                return fail(format!("a line has the points {start} to {end} of {all} in the list"));
            };
            start = end as usize;
            if let Some(bad) = line.iter().find(|p| **p as usize >= piece.points.len()) {
                return fail(format!("a line names point {bad} of {}", piece.points.len()));
            }
            set.push(line.iter().map(|p| piece.points[*p as usize]))?;
        }
        let own = piece.columns(start, &mut room)?;
        columns = Some(match columns {
            None => own,
            Some(before) => joined(before, own),
        });
    }
    let mut attributes = Attributes::default();
    let ends: Vec<u32> = set
        .iter()
        .scan(0, |end, l| {
            Some({
                *end += l.len() as u32;
                *end
            })
        })
        .collect();
    for column in columns.unwrap_or_default() {
        match column {
            Column::Scalars(scalars) => attributes.scalars.push(scalars),
            Column::Colours(Of::Vertices, all) => attributes.colours = attributes.colours.or(Some(all)),
            Column::Colours(Of::Lines, all) => {
                let lengths = ends.iter().scan(0, |start, end| Some(end - std::mem::replace(start, *end)));
                let each = all.iter().zip(lengths).flat_map(|(c, n)| std::iter::repeat_n(*c, n as usize));
                attributes.colours = attributes.colours.or_else(|| Some(each.collect()));
            }
        }
    }
    Ok(set.with_attributes(attributes)?)
}

/// Columns that both have, one after the other.
fn joined(before: Vec<Column>, after: Vec<Column>) -> Vec<Column> {
    let alike = |a: &Column, b: &Column| match (a, b) {
        (Column::Scalars(a), Column::Scalars(b)) => a.name == b.name && a.of == b.of,
        (Column::Colours(a, _), Column::Colours(b, _)) => a == b,
        _ => false,
    };
    let mut after = VecDeque::from(after);
    // Arrays stand in the same order in all pieces; so the first is the one that is looked for.
    let join = |mut column: Column| {
        let at = after.iter().position(|other| alike(&column, other))?;
        match (&mut column, after.remove(at)?) {
            (Column::Scalars(a), Column::Scalars(b)) => a.values.extend(b.values),
            (Column::Colours(_, a), Column::Colours(_, b)) => a.extend(b),
            _ => {}
        }
        Some(column)
    };
    before.into_iter().filter_map(join).collect()
}

impl Piece {
    /// The columns of its arrays. `used` is the number of vertices of its lines; `room` the values
    /// of vertices that may still be made.
    fn columns(self, used: usize, room: &mut usize) -> Result<Vec<Column>, FileError> {
        let mut columns = Vec::new();
        for array in &self.point_data {
            let asked = used.saturating_mul(array.components.min(MOST_COMPONENTS));
            let Some(left) = room.checked_sub(asked) else {
                let why = "lines share points so often that their values would fill the memory";
                return Err(refused(why));
            };
            *room = left;
            let rows = self.connectivity[..used].iter().map(|p| *p as usize);
            array.columns(self.points.len(), Of::Vertices, rows, &mut columns)?;
        }
        let lines = self.ends.len();
        let cells = self.vertices.saturating_add(lines).saturating_add(self.surfaces);
        for array in &self.cell_data {
            let rows = self.vertices..self.vertices.saturating_add(lines);
            array.columns(cells, Of::Lines, rows, &mut columns)?;
        }
        Ok(columns)
    }
}

impl Array {
    /// The columns of some rows of so many.
    fn columns(
        &self,
        count: usize,
        of: Of,
        rows: impl Iterator<Item = usize> + Clone,
        columns: &mut Vec<Column>,
    ) -> Result<(), FileError> {
        let n = self.components;
        if self.values.len() != count.saturating_mul(n) {
            let (name, values) = (&self.name, self.values.len());
            let why = format!("the array {name} has {values} values for {count} points or cells");
            return Err(refused(why));
        }
        if self.bytes && (3..=4).contains(&n) {
            let colour = |r: usize| [0, 1, 2].map(|c| self.values[r * n + c] as u8);
            columns.push(Column::Colours(of, rows.map(colour).collect()));
            return Ok(());
        }
        if n > MOST_COMPONENTS {
            return Ok(());
        }
        for c in 0..n {
            let name = if n == 1 { self.name.clone() } else { format!("{}.{c}", self.name) };
            let values = rows.clone().map(|r| self.values[r * n + c]).collect();
            columns.push(Column::Scalars(Scalars { name, of, values }));
        }
        Ok(())
    }
}
