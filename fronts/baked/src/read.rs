//! Files that are read where they are.

use crate::cells::Cells;
use crate::error::ReadError;
use crate::numbers::{f64_at, take, u32_at};
use crate::set::{List, Set};
use crate::{CELLS, DEPTH, HEADER, MAGIC, NONE, OBJECTS, VERSION};

/// A file of baked visibility, over bytes in memory: read, or mapped.
#[derive(Debug, Clone, Copy)]
pub struct Baked<'a> {
    cells: Cells,
    objects: u32,
    is_cell_to_cell: bool,
    targets: u32,
    sets: u32,
    /// The set of each cell.
    of_cells: &'a [u8],
    /// Where sets begin and end.
    ends: &'a [u8],
    bodies: &'a [u8],
}

impl<'a> Baked<'a> {
    /// Takes bytes for a file. Checks all of it: about a second for a gigabyte. Nothing is copied.
    ///
    /// # Errors
    /// Refuses bytes that are no file, of another version, cut off or changed: see [`ReadError`].
    pub fn read(bytes: &'a [u8]) -> Result<Self, ReadError> {
        let baked = Self::open(bytes)?;
        let at = bytes.len() - 4;
        if u32_at(bytes, at) != Some(crc32fast::hash(&bytes[..at])) {
            return Err(ReadError::Checksum);
        }
        baked.check()?;
        Ok(baked)
    }

    /// Takes bytes for a file without a look at the sets and the checksum, for files that were
    /// checked before, by [`Baked::read`] or by whoever packed them. Costs nothing. Sets of a
    /// damaged file are wrong, but reading them is safe.
    ///
    /// # Errors
    /// As [`Baked::read`], as far as the header tells.
    pub fn open(bytes: &'a [u8]) -> Result<Self, ReadError> {
        let given = bytes.len() as u64;
        let short = |needed: u64| ReadError::Length { needed, given };
        if bytes.get(..8) != Some(&MAGIC[..]) {
            return Err(ReadError::NotBaked);
        }
        let version = u32_at(bytes, 8).ok_or(short(HEADER as u64))?;
        if version != VERSION {
            return Err(ReadError::Version(version));
        }
        let number = |at| u32_at(bytes, at).ok_or(short(HEADER as u64));
        let mut cells = Cells { low: [0.0; 3], size: [0.0; 3], dims: [0; 3], origin: [0.0; 3] };
        for i in 0..3 {
            cells.low[i] = f64_at(bytes, 24 + 8 * i).ok_or(short(HEADER as u64))?;
            cells.size[i] = f64_at(bytes, 48 + 8 * i).ok_or(short(HEADER as u64))?;
            cells.dims[i] = number(72 + 4 * i)?;
            cells.origin[i] = f64_at(bytes, 84 + 8 * i).ok_or(short(HEADER as u64))?;
        }
        let (kind, objects, targets, sets) = (number(12)?, number(16)?, number(20)?, number(108)?);
        let count = cells.count().filter(|_| cells.is_valid()).ok_or(ReadError::Cells)?;
        if !(kind == OBJECTS && targets == 0 || kind == CELLS && objects == count) {
            return Err(ReadError::Kind(kind));
        }
        let of_cells = HEADER as u64;
        let ends = of_cells + 4 * u64::from(count);
        let bodies = ends + 4 * (u64::from(sets) + 1);
        let needed = bodies + 4;
        if given < needed {
            return Err(short(needed));
        }
        // They are less than the length.
        let (of_cells, ends, bodies) = (of_cells as usize, ends as usize, bodies as usize);
        let file = Self {
            cells,
            objects,
            is_cell_to_cell: kind == CELLS,
            targets,
            sets,
            of_cells: &bytes[of_cells..ends],
            ends: &bytes[ends..bodies],
            bodies: &bytes[bodies..bytes.len() - 4],
        };
        let last = u32_at(file.ends, 4 * sets as usize).unwrap_or(0);
        if file.bodies.len() as u64 != u64::from(last) {
            return Err(short(needed + u64::from(last)));
        }
        Ok(file)
    }

    /// Looks at each set and each cell.
    fn check(&self) -> Result<(), ReadError> {
        for set in 0..self.sets {
            let lists = self.lists(set).ok_or(ReadError::Set(set))?;
            // Those that it differs from were looked at before.
            let mut list = List::new(lists[0]);
            while list.next < u64::from(self.objects) {
                list.step();
            }
            if !list.is_at_end() {
                return Err(ReadError::Set(set));
            }
        }
        let count = (self.of_cells.len() / 4) as u32;
        match (0..count).find(|cell| self.set_number(*cell).is_some_and(|set| set >= self.sets)) {
            Some(cell) => Err(ReadError::Cell(cell)),
            None => Ok(()),
        }
    }

    /// The grid of cells.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }

    /// The number of objects: sets have numbers less than that.
    pub fn objects(&self) -> u32 {
        self.objects
    }

    /// Whether sets hold cells of the grid itself: from each cell that has a set, those of them
    /// that have one, too, and may be seen. Nothing is known about the others. See
    /// [`Baked::may_see`].
    pub fn is_cell_to_cell(&self) -> bool {
        self.is_cell_to_cell
    }

    /// A checksum of the cells that sets from cell to cell tell of; 0 for sets of objects. Parts of
    /// a bake can be put together only if it is the same: a cell that one of them does not know
    /// would count as hidden from its cells.
    pub fn targets(&self) -> u32 {
        self.targets
    }

    /// Whether an eye in one box may see a point in another one: from the least to the greatest
    /// corner each. True if the sets are not from cell to cell, or know nothing about a cell of
    /// one of the two. Costs a look at the set of each cell of the eyes.
    pub fn may_see(&self, eyes: [[f64; 3]; 2], target: [[f64; 3]; 2]) -> bool {
        let (eyes, target) = (self.cells.of_eyes(eyes[0], eyes[1]), self.cells.of_box(target[0], target[1]));
        let (Some(eyes), Some(target)) = (eyes, target) else { return true };
        let known = |all| self.cells.numbers(all).all(|cell| self.set_number(cell).is_some());
        let mut seen = self.cells.numbers(eyes).filter_map(|cell| self.set(cell)).flatten();
        let is_in = |cell: u32| self.cells.is_in(cell, target);
        !self.is_cell_to_cell || !known(eyes) || !known(target) || seen.any(is_in)
    }

    /// The number of sets: cells with equal ones share them.
    pub fn sets(&self) -> u32 {
        self.sets
    }

    /// The objects that an eye can see. `None` if nothing is known about its place, or it is on the
    /// border of cells with different sets, which must be joined ([`Cells::of_eyes`]): then it may
    /// see all.
    #[inline]
    pub fn set_at(&self, eye: [f64; 3]) -> Option<Set<'a>> {
        let number = self.set_number(self.cells.at(eye)?)?;
        if self.cells.is_at_border(eye) {
            let mut cells = self.cells.numbers(self.cells.of_eyes(eye, eye)?);
            cells.all(|cell| self.set_number(cell) == Some(number)).then_some(())?;
        }
        Some(Set::new(self.lists(number)?))
    }

    /// The objects that can be seen from a cell; `None` if it has no set, or is none.
    #[inline]
    pub fn set(&self, cell: u32) -> Option<Set<'a>> {
        Some(Set::new(self.lists(self.set_number(cell)?)?))
    }

    /// The number of a cell's set: equal ones have equal sets. `None` as for [`Baked::set`].
    #[inline]
    pub fn set_number(&self, cell: u32) -> Option<u32> {
        u32_at(self.of_cells, (cell as usize).checked_mul(4)?).filter(|set| *set != NONE)
    }

    /// The lists that make up a set.
    fn lists(&self, mut set: u32) -> Option<[&'a [u8]; DEPTH]> {
        let mut lists = [&[][..]; DEPTH];
        for list in &mut lists {
            let at = (set as usize).checked_mul(4)?;
            let from = u32_at(self.ends, at)?..u32_at(self.ends, at + 4)?;
            let mut bytes = self.bodies.get(from.start as usize..from.end as usize)?;
            let back = take(&mut bytes)?;
            *list = bytes;
            if back == 0 {
                return Some(lists);
            }
            set = set.checked_sub(back)?;
        }
        None
    }
}
