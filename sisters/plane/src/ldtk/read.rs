//! Projects and the levels in them.

use std::collections::HashSet;
use std::io;
use std::path::Path;

use super::error::{LdtkError, LdtkWarning};
use super::import::LdtkImport;
use super::level::LdtkLevel;
use super::project::{Level, Project};
use super::walls::Budget;
use crate::editor::{Inventory, Role, Rule};
use crate::files::{file, text};

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
        let named = || path.display().to_string();
        let project = file(path).map_err(|why| LdtkError::File { file: named(), why })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        self.parse(&project, |level| file(&folder.join(level)))
            .map_err(|why| LdtkError::In { file: named(), why: Box::new(why) })
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
        let (project, mut is_odd) = text(project);
        let project: Project = serde_json::from_str(&project).map_err(|why| damaged("the project", why))?;
        let inner: Vec<&Level> =
            project.levels.iter().chain(project.worlds.iter().flat_map(|world| &world.levels)).collect();
        let (mut outside, mut taken) = (Vec::new(), HashSet::new());
        for inner in &inner {
            let (None, Some(path)) = (&inner.layer_instances, &inner.external_rel_path) else {
                outside.push(None);
                continue;
            };
            // Each file once: a project may name one many times.
            if !taken.insert(path) {
                return Err(LdtkError::Twice(path.clone()));
            }
            let bytes = level(path).map_err(|why| LdtkError::File { file: path.clone(), why })?;
            let (level, odd) = text(&bytes);
            is_odd |= odd;
            outside.push(Some(serde_json::from_str(&level).map_err(|why| damaged(path, why))?));
        }
        let levels = || {
            inner
                .iter()
                .zip(&outside)
                .map(|(inner, own): (&&Level, &Option<Level>)| own.as_ref().unwrap_or(inner))
        };
        let read = |rule: &Rule| -> Result<Vec<LdtkLevel>, LdtkError> {
            let (blocking, mut budget) = (project.blocking(rule), Budget::default());
            levels().map(|level| self.level(level, &blocking, rule, &mut budget)).collect()
        };
        let has_walls = |levels: &Vec<LdtkLevel>| levels.iter().any(|level| level.has(&[Role::Wall]));
        let of_all = project.inventory();
        let inventory = |level: &Level| {
            let mut inventory = Inventory::default();
            level.layer_instances.iter().flatten().for_each(|layer| layer.add_to(&mut inventory));
            inventory.extend(&of_all);
            inventory
        };
        let warn = |rule: &Rule, found: &mut Vec<LdtkLevel>| {
            for (found, level) in found.iter_mut().zip(levels()).filter(|(found, _)| found.has(&[Role::Wall]))
            {
                found.warnings.push(LdtkWarning::Obstacles { names: inventory(level).walls(rule) });
            }
        };
        let mut found = self.names.read(read, has_walls, warn)?;
        for (found, level) in found.iter_mut().zip(levels()) {
            if is_odd {
                found.warnings.push(LdtkWarning::Encoding);
            }
            if !found.has(&[Role::Wall, Role::Door]) {
                let [layers, names] = inventory(level).lists();
                found.warnings.push(LdtkWarning::NothingBlocks { layers, names });
            }
        }
        Ok(found)
    }
}
