//! Lines that move in a grid that stays.

use glam::Vec3;

use super::{Cells, Segments, segments};
use crate::numeric::{CELL_ROUNDING, MOST_NAMES};
use crate::sets::LineSet;

/// How the motion of some lines changed the cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Change {
    /// The numbers of the segments that moved, ascending.
    pub segments: Vec<u32>,
    /// The cells whose lists are others.
    pub cells: usize,
}

/// A cell, a segment, and whether the cell names it from now on.
type Edit = (u32, u32, bool);

impl Cells {
    /// Moves some lines, given ascending, to where they are in `lines`. Lists are then those that
    /// the same grid has when it is filled anew. Without a change, `None`: a moved line leaves the
    /// grid, has another number of segments with a length, or the cells would name more than
    /// [`MOST_NAMES`] times as many segments as at first; then cells must be made anew.
    ///
    /// Time: m log m for m cells that the moved lines come near, and a copy of the lists. Memory
    /// while it runs: as much as the lists take, and 12 bytes for each of the m cells.
    pub fn update(&mut self, lines: &LineSet, moved: &[u32]) -> Option<Change> {
        let points = lines.points();
        let vertices = |&line: &u32| lines.range(line as usize).map(|range| &points[range]);
        let of_moved: Vec<&[Vec3]> = moved.iter().map(vertices).collect::<Option<_>>()?;
        let Segments { ends, neighbours, firsts } = segments(of_moved.into_iter());
        let mut numbers = Vec::with_capacity(ends.len());
        for (&line, new) in moved.iter().zip(firsts.windows(2)) {
            let old = self.firsts.get(line as usize..line as usize + 2)?;
            if old[1] - old[0] != new[1] - new[0] {
                return None;
            }
            numbers.extend_from_slice(&self.numbers[old[0] as usize..old[1] as usize]);
        }
        if !ends.iter().flatten().all(|p| self.holds(*p)) {
            return None;
        }
        let edits = self.edits(&numbers, &ends);
        let added: i64 = edits.iter().map(|e| if e.2 { 1 } else { -1 }).sum();
        if self.lists.len() as i64 + added > (self.first_names * MOST_NAMES) as i64 {
            return None;
        }
        let cells = self.edit(&edits);
        for ((&number, ends), beside) in numbers.iter().zip(ends).zip(neighbours) {
            (self.ends[number as usize], self.neighbours[number as usize]) = (ends, beside);
        }
        numbers.sort_unstable();
        Some(Change { segments: numbers, cells })
    }

    /// Whether all that comes nearer to a point than the margin lies in the grid.
    fn holds(&self, p: Vec3) -> bool {
        let margin = f64::from(self.margin) / f64::from(self.side) - f64::from(CELL_ROUNDING);
        let at = self.place(p);
        (at - margin).min_element() >= 0.0 && (at + margin).cmple(self.dims.as_dvec3()).all()
    }

    /// The names that the motion of segments adds and removes, by cells and then segments.
    fn edits(&self, numbers: &[u32], ends: &[[Vec3; 2]]) -> Vec<Edit> {
        let mut edits: Vec<Edit> = Vec::new();
        for (&number, &new) in numbers.iter().zip(ends) {
            self.for_cells(self.ends[number as usize], |cell| edits.push((cell, number, false)));
            self.for_cells(new, |cell| edits.push((cell, number, true)));
        }
        edits.sort_unstable();
        // A cell that goes on to name a segment does not change.
        let mut kept: Vec<Edit> = Vec::with_capacity(edits.len());
        for edit in edits {
            match kept.last() {
                Some(&(cell, number, false)) if (cell, number, true) == edit => {
                    kept.pop();
                }
                _ => kept.push(edit),
            }
        }
        kept
    }

    /// Edits the lists, and says how many cells have another one.
    fn edit(&mut self, edits: &[Edit]) -> usize {
        let mut lists = Vec::with_capacity(self.lists.len() + edits.len());
        let (mut copied, mut cells) = (0, 0);
        let (mut shift, mut next) = (0u32, 0);
        for of_cell in edits.chunk_by(|a, b| a.0 == b.0) {
            let cell = of_cell[0].0 as usize;
            let [from, to] = [self.starts[cell], self.starts[cell + 1]];
            lists.extend_from_slice(&self.lists[copied..from as usize]);
            copied = to as usize;
            self.starts[next..=cell].iter_mut().for_each(|s| *s = s.wrapping_add(shift));
            next = cell + 1;
            let before = lists.len();
            let mut rest = of_cell.iter().peekable();
            for &named in &self.lists[from as usize..to as usize] {
                while let Some(&&(_, number, true)) = rest.peek()
                    && number < named
                {
                    lists.push(number);
                    rest.next();
                }
                match rest.peek() {
                    Some(&&(_, number, false)) if number == named => {
                        rest.next();
                    }
                    _ => lists.push(named),
                }
            }
            lists.extend(rest.map(|edit| edit.1));
            shift = shift.wrapping_add(((lists.len() - before) as u32).wrapping_sub(to - from));
            cells += 1;
        }
        lists.extend_from_slice(&self.lists[copied..]);
        self.starts[next..].iter_mut().for_each(|s| *s = s.wrapping_add(shift));
        self.lists = lists;
        cells
    }
}
