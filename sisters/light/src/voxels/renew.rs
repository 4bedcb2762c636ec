//! The cells after some objects moved: cells that these touch, or touched, are made anew, and all
//! others are copied. What comes out is what would be made of all triangles.

use crate::error::LightError;
use crate::numeric::MOST_REFERENCES;
use crate::surfaces::Surface;
use crate::voxels::{Entry, NONE, Part, Reference, Voxels};

/// A brick, and the bit of a cell in it.
type Slot = (usize, i32);

/// Old numbers of triangles as new ones, [`NONE`] for those of objects that changed. Both lists are
/// in order of objects, and the others have the same triangles.
fn renumbered(old: &[Surface], new: &[Surface], is_changed: &impl Fn(&Surface) -> bool) -> Vec<u32> {
    let mut others = (0..).zip(new).filter(|(_, s)| !is_changed(s)).map(|(number, _)| number);
    let number = |s: &Surface| if is_changed(s) { NONE } else { others.next().unwrap_or(NONE) };
    old.iter().map(number).collect()
}

impl Voxels {
    /// The same cells with other triangles, of which only those of some objects changed; their
    /// numbers are sorted. Costs a copy, and the cells that the changed triangles touch and
    /// touched.
    ///
    /// # Errors
    /// If the triangles touch too many cells.
    pub(crate) fn moved(&self, surfaces: Vec<Surface>, changed: &[u32]) -> Result<Self, LightError> {
        let is_changed = |s: &Surface| changed.binary_search(&s.object).is_ok();
        let numbers = renumbered(&self.surfaces, &surfaces, &is_changed);
        let tree = self.tree.moved(&self.lattice, &surfaces, changed, &numbers);
        let mut next = Self::empty(self.lattice, surfaces, tree);
        let mut parts = Vec::new();
        for surface in (0..).zip(&next.surfaces).filter(|(_, s)| is_changed(s)) {
            next.add_all_parts(surface, &mut parts)?;
        }
        let old = self.slots();
        let mut dirty: Vec<Slot> = parts.iter().map(|p| self.lattice.slot_of(p.cell)).collect();
        let touched = |r: &Reference| numbers[r.surface as usize] == NONE;
        dirty.extend(
            (0..).zip(&old).filter(|(k, _)| self.references_at(*k).iter().any(touched)).map(|(_, s)| *s),
        );
        dirty.sort_unstable();
        dirty.dedup();
        for slot in &dirty {
            let Ok(k) = old.binary_search(slot) else { continue };
            // The parts in the cell of those old triangles that did not change.
            let cell = self.lattice.of_slot(*slot);
            let kept = self.references_at(k).iter().map(|r| numbers[r.surface as usize]);
            parts.extend(kept.filter(|number| *number != NONE).map(|number| {
                let surface = &next.surfaces[number as usize];
                let whole = surface.scaled(self.lattice.fine(cell));
                Part::new(&self.lattice, cell, &whole, (number, surface))
            }));
        }
        next.sort(&mut parts);
        next.merge(self, (&old, &dirty), &parts, &numbers);
        if next.references.len() >= MOST_REFERENCES {
            return Err(LightError::TooManyReferences);
        }
        next.count();
        Ok(next)
    }

    /// The occupied cells, in order.
    fn slots(&self) -> Vec<Slot> {
        let of = |(brick, mask): (usize, &u64)| {
            let mask = *mask;
            (0..64).filter(move |bit| mask >> bit & 1 == 1).map(move |bit| (brick, bit))
        };
        self.masks.iter().enumerate().flat_map(of).collect()
    }

    fn references_at(&self, k: usize) -> &[Reference] {
        &self.references[self.starts[k] as usize..self.starts[k + 1] as usize]
    }

    /// Adds the cells in order: made anew of their parts, or copied.
    fn merge(&mut self, from: &Self, (old, dirty): (&[Slot], &[Slot]), parts: &[Part], numbers: &[u32]) {
        let lattice = self.lattice;
        let slot_of = |parts: &&[Part]| lattice.slot_of(parts[0].cell);
        let mut cells = parts.chunk_by(|a, b| a.cell == b.cell).peekable();
        let mut dirty = dirty.iter().copied().peekable();
        const END: Slot = (usize::MAX, 0);
        for (k, slot) in old.iter().copied().chain([END]).enumerate() {
            let mut is_anew = false;
            while let Some(next) = dirty.next_if(|d| *d <= slot) {
                is_anew = next == slot;
                // A cell that nothing touches any more has no parts.
                if let Some(of_cell) = cells.next_if(|parts| slot_of(parts) == next) {
                    self.occupy(next);
                    self.add_cell(of_cell);
                }
            }
            if slot != END && !is_anew {
                self.occupy(slot);
                self.copy_cell(from, k, numbers);
            }
        }
    }

    fn occupy(&mut self, (brick, bit): Slot) {
        self.masks[brick] |= 1 << bit;
    }

    /// Adds a cell whose triangles did not change.
    fn copy_cell(&mut self, from: &Self, k: usize, numbers: &[u32]) {
        let (first, old) = (self.entries.len() as u32, from.heads[k]);
        for entry in &from.entries[old as usize..from.heads[k + 1] as usize] {
            let members = &from.members[entry.first as usize..entry.end as usize];
            let start = self.members.len() as u32;
            self.members.extend(members.iter().map(|m| numbers[*m as usize]));
            self.entries.push(Entry { first: start, end: self.members.len() as u32, ..*entry });
        }
        self.references.extend(from.references_at(k).iter().map(|r| Reference {
            surface: numbers[r.surface as usize],
            entry: if r.entry == NONE { NONE } else { r.entry - old + first },
        }));
        self.starts.push(self.references.len() as u32);
        self.heads.push(self.entries.len() as u32);
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};

    use super::*;
    use crate::input::{Grid, Material, Window};
    use crate::lattice::Lattice;
    use crate::spread::unit;

    /// Ten objects of triangles of all sizes, some in faces of cells and some outside.
    fn surfaces(turns: &[u64; 10]) -> Vec<Surface> {
        let of = |(object, turn): (u32, u64)| {
            let count = 3 + (u64::from(object) + turn) % 9;
            (0..count).filter_map(move |i| {
                let key = (u64::from(object) << 32) + (turn << 16) + i;
                let random = |k: u64| DVec3::from_array([0, 1, 2].map(|a| unit(key, 3 * k + a)));
                let size = [0.4, 3.0, 14.0][i as usize % 3];
                let middle = random(0) * 20.0 - 1.0;
                let mut corners = [1, 2, 3].map(|k| middle + (random(k) - 0.5) * size);
                if i % 4 == 0 {
                    corners.iter_mut().for_each(|c| c.x = middle.x.round());
                }
                let of = Material::new(Vec3::splat(0.5), Vec3::splat((i % 2) as f32));
                Surface::new(corners, (i % 2) as u32, object, &of)
            })
        };
        (0..).zip(*turns).flat_map(of).collect()
    }

    #[test]
    fn cells_after_moves_are_those_of_all_triangles() {
        let window = Window { middle: Vec3::splat(6.0), half: 4.0, finer: 2 };
        let grid = Grid { min: Vec3::ZERO, max: Vec3::splat(16.0), cells: 16 };
        for windows in [[None; 2], [Some(window), None]] {
            let lattice = Lattice::new(&grid, &windows);
            let mut turns = [0; 10];
            let mut moved = Voxels::new(lattice, surfaces(&turns)).unwrap();
            for round in 0..12_u64 {
                let changed: Vec<u32> =
                    (0..10).filter(|o| unit(round, *o) < 0.25).map(|o| o as u32).collect();
                changed.iter().for_each(|o| turns[*o as usize] += 1);
                moved = moved.moved(surfaces(&turns), &changed).unwrap();
                let anew = Voxels::new(lattice, surfaces(&turns)).unwrap();
                assert!(anew.entries.len() > 400, "{}", anew.entries.len());
                assert_eq!(moved.entries, anew.entries, "{round}");
                assert_eq!(moved.members, anew.members, "{round}");
                let pairs =
                    |v: &Voxels| v.references.iter().map(|r| (r.surface, r.entry)).collect::<Vec<_>>();
                assert_eq!(pairs(&moved), pairs(&anew), "{round}");
                assert_eq!((&moved.starts, &moved.heads), (&anew.starts, &anew.heads), "{round}");
                assert_eq!((&moved.masks, &moved.ranks), (&anew.masks, &anew.ranks), "{round}");
                for i in 0..500 {
                    let random =
                        |k: u64| DVec3::from_array([0, 1, 2].map(|a| unit(round << 32 | i << 8 | k, a)));
                    let (from, direction) = (random(0) * 18.0, (random(1) - 0.5).normalize());
                    let first = anew.first(from, direction, 9.0);
                    assert_eq!(moved.first(from, direction, 9.0), first);
                    let blocker = moved.tree.blocker(from, direction, 9.0, i as u32);
                    assert_eq!(blocker.is_some(), first.is_some());
                }
            }
        }
    }
}
