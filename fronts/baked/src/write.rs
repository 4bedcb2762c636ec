//! Files are made.

use alloc::collections::{BTreeMap, BTreeSet};
use alloc::vec::Vec;

use crate::cells::Cells;
use crate::error::WriteError;
use crate::numbers::put;
use crate::read::Baked;
use crate::{CELLS, DEPTH, HEADER, MAGIC, NONE, OBJECTS, VERSION};

/// Makes a file. It holds all sets until the end: four bytes for each object of each.
///
/// The bytes depend on the sets alone, not on the order in which they come: several programs may
/// find parts of them, and one puts them together.
#[derive(Debug, Clone)]
pub struct Writer {
    cells: Cells,
    kind: u32,
    targets: u32,
    objects: u32,
    sets: BTreeMap<u32, Vec<u32>>,
}

/// A set that was written.
struct Written<'a> {
    set: &'a [u32],
    number: u32,
    /// How many lists make it up.
    depth: usize,
}

impl Writer {
    /// A file for so many objects, without sets.
    ///
    /// # Errors
    /// [`WriteError::Cells`].
    pub fn new(cells: Cells, objects: u32) -> Result<Self, WriteError> {
        if !cells.is_valid() {
            return Err(WriteError::Cells);
        }
        Ok(Self { cells, kind: OBJECTS, targets: 0, objects, sets: BTreeMap::new() })
    }

    /// A file whose sets hold cells of the grid itself, for things that move: each set tells which
    /// of `targets` may be seen. Give sets to these alone: a cell that has one and is in no other
    /// counts as hidden.
    ///
    /// # Errors
    /// [`WriteError::Cells`].
    pub fn cell_to_cell(cells: Cells, targets: &BTreeSet<u32>) -> Result<Self, WriteError> {
        let objects = cells.count().ok_or(WriteError::Cells)?;
        let mut hash = crc32fast::Hasher::new();
        targets.iter().for_each(|cell| hash.update(&cell.to_le_bytes()));
        Ok(Self { kind: CELLS, targets: hash.finalize(), ..Self::new(cells, objects)? })
    }

    /// A file for more sets of the bake that a file is of, without sets.
    ///
    /// # Errors
    /// None for a file that was read.
    pub fn like(file: &Baked) -> Result<Self, WriteError> {
        let kind = if file.is_cell_to_cell() { CELLS } else { OBJECTS };
        Ok(Self { kind, targets: file.targets(), ..Self::new(*file.cells(), file.objects())? })
    }

    /// Gives a cell its set: objects in ascending order, each less than the number of objects.
    /// Takes the place of an earlier one.
    ///
    /// # Errors
    /// [`WriteError::Cell`], [`WriteError::Objects`].
    pub fn put(&mut self, cell: u32, set: &[u32]) -> Result<(), WriteError> {
        if self.cells.count().is_none_or(|count| cell >= count) {
            return Err(WriteError::Cell(cell));
        }
        let falls = set.windows(2).position(|pair| pair[0] >= pair[1]).map(|at| at + 1);
        let beyond = set.iter().position(|object| *object >= self.objects);
        if let Some(index) = [falls, beyond].into_iter().flatten().min() {
            return Err(WriteError::Objects { index });
        }
        self.sets.insert(cell, set.to_vec());
        Ok(())
    }

    /// The set of a cell, if it has one.
    pub fn get(&self, cell: u32) -> Option<&[u32]> {
        self.sets.get(&cell).map(Vec::as_slice)
    }

    /// The number of cells that have a set.
    pub fn len(&self) -> usize {
        self.sets.len()
    }

    /// Whether no cell has one.
    pub fn is_empty(&self) -> bool {
        self.sets.is_empty()
    }

    /// The bytes of the file. A set is written as its difference from the one of a neighbour before
    /// it, where that is shorter.
    ///
    /// # Errors
    /// [`WriteError::TooLarge`].
    pub fn finish(&self) -> Result<Vec<u8>, WriteError> {
        let count = self.cells.count().unwrap_or(0);
        let [x, y, _] = self.cells.dims;
        let mut known: BTreeMap<&[u32], usize> = BTreeMap::new();
        let mut all: Vec<Written> = Vec::new();
        let (mut bodies, mut ends) = (Vec::new(), Vec::from([0u32]));
        let mut of_cells = alloc::vec![NONE; count as usize];
        for (&cell, set) in &self.sets {
            let number = known.get(set.as_slice()).copied().unwrap_or_else(|| {
                let before = [1, x, x.saturating_mul(y)];
                let near: BTreeSet<u32> = before
                    .into_iter()
                    .filter_map(|step| of_cells.get(cell.checked_sub(step)? as usize).copied())
                    .filter(|number| *number != NONE)
                    .collect();
                let near = near.into_iter().map(|number| &all[number as usize]);
                let written = write_set(set, all.len() as u32, near, &mut bodies);
                ends.push(bodies.len() as u32);
                all.push(written);
                known.insert(set, all.len() - 1);
                all.len() - 1
            });
            of_cells[cell as usize] = number as u32;
        }
        // Ends in between are less.
        u32::try_from(bodies.len()).map_err(|_| WriteError::TooLarge)?;
        Ok(self.assemble(&of_cells, &ends, &bodies))
    }

    fn assemble(&self, of_cells: &[u32], ends: &[u32], bodies: &[u8]) -> Vec<u8> {
        let mut out = Vec::with_capacity(HEADER + 4 * (of_cells.len() + ends.len() + 1) + bodies.len());
        out.extend_from_slice(&MAGIC);
        out.extend_from_slice(&VERSION.to_le_bytes());
        out.extend_from_slice(&self.kind.to_le_bytes());
        out.extend_from_slice(&self.objects.to_le_bytes());
        out.extend_from_slice(&self.targets.to_le_bytes());
        for number in self.cells.low.into_iter().chain(self.cells.size) {
            out.extend_from_slice(&number.to_le_bytes());
        }
        let sets = ends.len() as u32 - 1;
        self.cells.dims.iter().for_each(|number| out.extend_from_slice(&number.to_le_bytes()));
        self.cells.origin.iter().for_each(|number| out.extend_from_slice(&number.to_le_bytes()));
        for number in [sets].iter().chain(of_cells).chain(ends) {
            out.extend_from_slice(&number.to_le_bytes());
        }
        out.extend_from_slice(bodies);
        out.extend_from_slice(&crc32fast::hash(&out).to_le_bytes());
        out
    }
}

/// Appends a set, by its shortest difference from nothing or from one of those near it.
fn write_set<'a, 'b: 'a>(
    set: &'b [u32],
    number: u32,
    near: impl Iterator<Item = &'a Written<'b>>,
    bodies: &mut Vec<u8>,
) -> Written<'b> {
    let (mut best, mut depth) = (list(0, set.iter().copied()), 1);
    for other in near.filter(|other| other.depth < DEPTH) {
        let bytes = list(number - other.number, difference(set, other.set));
        if bytes.len() < best.len() {
            (best, depth) = (bytes, other.depth + 1);
        }
    }
    bodies.extend_from_slice(&best);
    Written { set, number, depth }
}

/// The bytes of a list.
fn list(back: u32, objects: impl Iterator<Item = u32>) -> Vec<u8> {
    let mut out = Vec::new();
    put(&mut out, back);
    let mut next = 0;
    for object in objects {
        put(&mut out, object - next);
        next = object + 1;
    }
    out
}

/// What is in one of two sets only, ascending.
fn difference<'a>(a: &'a [u32], b: &'a [u32]) -> impl Iterator<Item = u32> + 'a {
    let (mut a, mut b) = (a.iter().copied().peekable(), b.iter().copied().peekable());
    core::iter::from_fn(move || {
        loop {
            match (a.peek(), b.peek()) {
                (Some(x), Some(y)) if x == y => {
                    a.next();
                    b.next();
                }
                (Some(x), Some(y)) if x > y => return b.next(),
                (None, _) => return b.next(),
                _ => return a.next(),
            }
        }
    })
}
