//! Cells that pass for opaque in aggressive runs of [`crate::Method::Cell`].

use glam::IVec3;

use crate::matrix::bits::BitMatrix;

/// Cells that solids fill for the most part, by the layers of those.
#[derive(Debug, Clone, Default)]
pub(crate) struct AggressiveCells {
    pub(crate) parts: Vec<(u64, BitMatrix)>,
}

impl AggressiveCells {
    /// Adds a cell of a grid for solids on some layers; false if it was there.
    pub(crate) fn set(&mut self, layers: u64, dims: IVec3, cell: IVec3) -> bool {
        let at = self.parts.iter().position(|part| part.0 == layers).unwrap_or_else(|| {
            self.parts.push((layers, BitMatrix::new(dims)));
            self.parts.len() - 1
        });
        let cells = &mut self.parts[at].1;
        let new = !cells.get(cell);
        cells.set(cell);
        new
    }

    /// The cells that count in views of some layers.
    pub(crate) fn in_views_of(&self, layers: u64) -> impl Iterator<Item = &BitMatrix> {
        self.parts.iter().filter(move |part| part.0 & layers != 0).map(|part| &part.1)
    }
}
