//! Sets from cell to cell, found ahead of time: the first filter.

use bitvec::vec::BitVec;
use casca_baked::{Baked, CellBox};
use casca_walls::Span;

use crate::error::ServerError;

/// Eyes or entities that may be in more cells than this are not looked up: walls decide.
const MOST_CELLS: u64 = 64;

/// A file of sets from cell to cell.
#[derive(Debug, Clone)]
pub(crate) struct BakedFile(Vec<u8>);

impl BakedFile {
    /// Checks all of a file.
    pub(crate) fn read(bytes: Vec<u8>) -> Result<Self, ServerError> {
        if Baked::read(&bytes)?.is_cell_to_cell() { Ok(Self(bytes)) } else { Err(ServerError::NotCellToCell) }
    }

    /// The sets.
    pub(crate) fn sets(&self) -> Option<Baked<'_>> {
        Baked::open(&self.0).ok()
    }
}

/// The cells that a box has points in, if all of them have sets and they are few.
pub(crate) fn cells_of(sets: &Baked, place: &Span) -> Option<CellBox> {
    known(sets, sets.cells().of_box(place.min.to_array(), place.max.to_array())?)
}

fn known(sets: &Baked, cells: CellBox) -> Option<CellBox> {
    let is_known = |cell| sets.set_number(cell).is_some();
    (cells.count() <= MOST_CELLS && sets.cells().numbers(cells).all(is_known)).then_some(cells)
}

/// The cells that a client may see.
#[derive(Debug, Clone, Default)]
pub(crate) struct SeenCells {
    /// Those that its eye may be in; `None` if it may see all.
    eyes: Option<CellBox>,
    seen: BitVec,
}

impl SeenCells {
    /// Takes over where the eye may be. Costs a pass over the sets of its cells if it got to
    /// others.
    pub(crate) fn follow(&mut self, sets: Option<&Baked>, eyes: &Span) {
        let cells_of =
            |sets: &Baked| known(sets, sets.cells().of_eyes(eyes.min.to_array(), eyes.max.to_array())?);
        let cells = sets.and_then(|sets| Some((sets, cells_of(sets)?)));
        let Some((sets, cells)) = cells else {
            self.eyes = None;
            return;
        };
        if self.eyes == Some(cells) {
            return;
        }
        self.eyes = Some(cells);
        self.seen.clear();
        self.seen.resize(sets.objects() as usize, false);
        for cell in sets.cells().numbers(cells).filter_map(|cell| sets.set(cell)).flatten() {
            self.seen.set(cell as usize, true);
        }
    }

    /// Whether one of some cells may be seen; `None` stands for all.
    pub(crate) fn may_see(&self, sets: &Baked, place: Option<CellBox>) -> bool {
        let (Some(_), Some(place)) = (self.eyes, place) else { return true };
        sets.cells().numbers(place).any(|cell| self.seen.get(cell as usize).is_none_or(|seen| *seen))
    }

    /// Forgets all: the sets are others.
    pub(crate) fn forget(&mut self) {
        self.eyes = None;
    }
}
