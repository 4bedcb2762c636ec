//! Files of parts put together.

use std::path::Path;

use casca_baked::{Baked, Cells, Writer};

use crate::error::BakeError;

/// Puts the sets of parts of one bake together, as they come.
#[derive(Default)]
pub struct Merger {
    /// With what all parts have: the cells, the number of objects, what sets hold, and which cells
    /// they tell of.
    writer: Option<(Writer, (Cells, u32, bool, u32))>,
}

impl Merger {
    /// Takes the sets of a part.
    ///
    /// # Errors
    /// The part is of another bake, or has another set for a cell; nothing of it is taken then.
    pub fn put(&mut self, part: &Baked) -> Result<(), BakeError> {
        let cells = *part.cells();
        let bake = (cells, part.objects(), part.is_cell_to_cell(), part.targets());
        if self.writer.as_ref().is_some_and(|(_, of)| *of != bake) {
            return Err(BakeError::OtherBake);
        }
        let numbers = 0..cells.dims.iter().product();
        let mut new = Writer::like(part)?;
        for (cell, set) in numbers.clone().filter_map(|cell| Some((cell, part.set(cell)?))) {
            let there = self.writer.as_ref().and_then(|(writer, _)| writer.get(cell));
            if there.is_some_and(|there| !set.iter().eq(there.iter().copied())) {
                return Err(BakeError::Differs(cell));
            }
            new.put(cell, &set.iter().collect::<Vec<_>>())?;
        }
        match &mut self.writer {
            Some((writer, _)) => {
                numbers
                    .filter_map(|cell| Some((cell, new.get(cell)?)))
                    .try_for_each(|(cell, set)| writer.put(cell, set))?;
            }
            None => self.writer = Some((new, bake)),
        }
        Ok(())
    }

    /// The number of cells that have a set.
    pub fn len(&self) -> usize {
        self.writer.as_ref().map_or(0, |(writer, _)| writer.len())
    }

    /// Whether no cell has one.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The bytes of a file with all sets.
    ///
    /// # Errors
    /// [`BakeError::NoFiles`] without parts.
    pub fn finish(&self) -> Result<Vec<u8>, BakeError> {
        let (writer, _) = self.writer.as_ref().ok_or(BakeError::NoFiles)?;
        Ok(writer.finish()?)
    }
}

/// The sets of several files of one bake in one: the same bytes as if one machine had found them.
///
/// # Errors
/// There are no files, one cannot be read or is damaged, they are of different bakes, or two have
/// different sets for a cell.
pub fn merge(files: &[impl AsRef<Path>]) -> Result<Vec<u8>, BakeError> {
    let mut all = Merger::default();
    for path in files.iter().map(AsRef::as_ref) {
        let bytes = std::fs::read(path).map_err(BakeError::file("read", path))?;
        let put = Baked::read(&bytes).map_err(BakeError::from).and_then(|part| all.put(&part));
        put.map_err(|why| why.of(path))?;
    }
    all.finish()
}

#[cfg(test)]
mod tests {
    use casca_baked::Cells;

    use super::*;

    #[test]
    fn a_part_that_is_refused_leaves_nothing() {
        let cells = Cells { low: [0.0; 3], size: [1.0; 3], dims: [4, 1, 1], origin: [0.0; 3] };
        let part = |sets: &[(u32, &[u32])]| {
            let mut writer = Writer::new(cells, 9).unwrap();
            sets.iter().for_each(|(cell, set)| writer.put(*cell, set).unwrap());
            writer.finish().unwrap()
        };
        let (first, other) = (part(&[(1, &[2, 3]), (3, &[8])]), part(&[(0, &[1]), (1, &[2, 3]), (3, &[7])]));
        let mut all = Merger::default();
        all.put(&Baked::read(&first).unwrap()).unwrap();
        let refused = all.put(&Baked::read(&other).unwrap());
        assert!(matches!(refused, Err(BakeError::Differs(3))), "{refused:?}");
        assert_eq!((all.len(), all.finish().unwrap()), (2, first));
    }
}
