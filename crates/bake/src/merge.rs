//! Files of parts put together.

use std::path::Path;

use casca_baked::{Baked, Writer};

use crate::error::BakeError;

/// The sets of several files of one bake in one: the same bytes as if one machine had found them.
///
/// # Errors
/// There are no files, one cannot be read or is damaged, they are of different bakes, or two have
/// different sets for a cell.
pub fn merge(files: &[impl AsRef<Path>]) -> Result<Vec<u8>, BakeError> {
    let mut all: Option<Writer> = None;
    let mut first = None;
    for path in files.iter().map(AsRef::as_ref) {
        let bytes = std::fs::read(path).map_err(BakeError::file("read", path))?;
        let baked = Baked::read(&bytes).map_err(|why| BakeError::Read { path: path.to_owned(), why })?;
        let same = (*baked.cells(), baked.objects());
        if *first.get_or_insert(same) != same {
            return Err(BakeError::OtherBake(path.to_owned()));
        }
        let writer = match &mut all {
            Some(writer) => writer,
            None => all.insert(Writer::new(same.0, same.1)?),
        };
        if let Some(cell) = put_all(writer, &baked)? {
            return Err(BakeError::Differs { path: path.to_owned(), cell });
        }
    }
    Ok(all.ok_or(BakeError::NoFiles)?.finish()?)
}

/// Puts the sets of a file into a writer. Returns a cell that has another one there.
///
/// # Errors
/// The writer is one for other cells.
pub fn put_all(writer: &mut Writer, baked: &Baked) -> Result<Option<u32>, BakeError> {
    let count = baked.cells().dims.iter().product();
    for cell in 0..count {
        let Some(set) = baked.set(cell) else { continue };
        let set: Vec<u32> = set.iter().collect();
        match writer.get(cell) {
            Some(there) if there != set => return Ok(Some(cell)),
            Some(_) => {}
            None => writer.put(cell, &set)?,
        }
    }
    Ok(None)
}
