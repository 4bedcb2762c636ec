//! Files of parts put together.

use std::path::Path;

use casca_baked::{Baked, Cells, WriteError, Writer};

use crate::error::BakeError;

/// Puts the sets of parts of one bake together, as they come.
#[derive(Default)]
pub struct Merger {
    /// With what all parts have: the cells, the number of objects, what sets hold, and which cells
    /// they tell of.
    writer: Option<(Writer, (Cells, u32, bool, u32))>,
}

/// Why the sets of a part do not go with those before it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PartError {
    /// It is of another bake.
    #[error("the part has other cells, objects or kinds of sets than those before it")]
    OtherBake,
    /// A cell has two sets.
    #[error("the part has another set for cell {0} than one before it")]
    Differs(u32),
    /// The sets make no file.
    #[error("the sets cannot be stored: {0}")]
    Write(#[from] WriteError),
}

impl Merger {
    /// Takes the sets of a part.
    ///
    /// # Errors
    /// The part is of another bake, or has another set for a cell; parts before it stay.
    pub fn put(&mut self, part: &Baked) -> Result<(), PartError> {
        let cells = *part.cells();
        let bake = (cells, part.objects(), part.is_cell_to_cell(), part.targets());
        let writer = match &mut self.writer {
            Some((writer, of)) if *of == bake => writer,
            Some(_) => return Err(PartError::OtherBake),
            None => &mut self.writer.insert((Writer::like(part)?, bake)).0,
        };
        for cell in 0..cells.dims.iter().product() {
            let Some(set) = part.set(cell) else { continue };
            let set: Vec<u32> = set.iter().collect();
            match writer.get(cell) {
                Some(there) if there != set => return Err(PartError::Differs(cell)),
                Some(_) => {}
                None => writer.put(cell, &set)?,
            }
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
        let baked = Baked::read(&bytes).map_err(|why| BakeError::Read { path: path.to_owned(), why })?;
        all.put(&baked).map_err(|why| match why {
            PartError::OtherBake => BakeError::OtherBake(path.to_owned()),
            PartError::Differs(cell) => BakeError::Differs { path: path.to_owned(), cell },
            PartError::Write(why) => why.into(),
        })?;
    }
    all.finish()
}
