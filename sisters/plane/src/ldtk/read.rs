//! Projects and the levels in them.

use std::collections::HashSet;
use std::io;
use std::path::Path;

use super::error::LdtkError;
use super::import::LdtkImport;
use super::level::LdtkLevel;
use super::project::{Level, Project};
use super::walls::Budget;
use crate::editor::file;

impl LdtkImport {
    /// The levels of a project, in the order of the file. Levels in files of their own are looked
    /// for from the folder of the project. The cost is linear in the bytes of the files and the
    /// bits of the result.
    ///
    /// # Errors
    /// A file that is missing, is no project, or contradicts itself; levels that would take far
    /// more memory than they have tiles.
    pub fn read(&self, path: impl AsRef<Path>) -> Result<Vec<LdtkLevel>, LdtkError> {
        let path = path.as_ref();
        let project = file(path).map_err(|why| LdtkError::File { file: path.display().to_string(), why })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        self.parse(&project, |level| file(&folder.join(level)))
    }

    /// As [`Self::read`], from the bytes of a project. `level` gives the bytes of a level in a file
    /// of its own, by the path that the project has for it.
    ///
    /// # Errors
    /// As [`Self::read`]; those of `level` become [`LdtkError::File`].
    pub fn parse(
        &self,
        project: &[u8],
        mut level: impl FnMut(&str) -> io::Result<Vec<u8>>,
    ) -> Result<Vec<LdtkLevel>, LdtkError> {
        let damaged = |file: &str, why| LdtkError::Damaged { file: file.into(), why };
        let project: Project =
            serde_json::from_slice(unmarked(project)).map_err(|why| damaged("the project", why))?;
        let (blocking, mut budget) = (project.blocking(&self.property), Budget::default());
        let mut levels = Vec::new();
        let mut taken = HashSet::new();
        for inner in project.levels.iter().chain(project.worlds.iter().flat_map(|world| &world.levels)) {
            let outside: Level;
            let found = match (&inner.layer_instances, &inner.external_rel_path) {
                (None, Some(path)) => {
                    // Each file once: a project may name one many times.
                    if !taken.insert(path) {
                        return Err(LdtkError::Twice(path.clone()));
                    }
                    let bytes = level(path).map_err(|why| LdtkError::File { file: path.clone(), why })?;
                    outside = serde_json::from_slice(unmarked(&bytes)).map_err(|why| damaged(path, why))?;
                    &outside
                }
                _ => inner,
            };
            levels.push(self.level(found, &blocking, &mut budget)?);
        }
        Ok(levels)
    }
}

/// The text behind a byte-order mark, which some editors put before UTF-8.
fn unmarked(file: &[u8]) -> &[u8] {
    file.strip_prefix(b"\xef\xbb\xbf").unwrap_or(file)
}
