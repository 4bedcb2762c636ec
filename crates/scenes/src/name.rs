//! A scene on a command line: a procedural one by its name, or a file.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

use crate::generated::{self, SceneKind, SceneOptions};
use crate::import::{self, ImportError};
use crate::world::World;

/// A scene on a command line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SceneName {
    /// A procedural one.
    Built(SceneKind),
    /// A glTF 2.0 file.
    File(PathBuf),
    /// The bytes of such a file, which other files cannot be part of, and its name.
    Given(String, Arc<[u8]>),
}

impl FromStr for SceneName {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        if let Ok(kind) = name.parse() {
            return Ok(Self::Built(kind));
        }
        let ending = Path::new(name).extension().unwrap_or_default();
        if ending.eq_ignore_ascii_case("glb") || ending.eq_ignore_ascii_case("gltf") {
            return Ok(Self::File(PathBuf::from(name)));
        }
        let kinds = SceneKind::names();
        Err(format!("neither a procedural scene ({kinds}) nor a .glb or .gltf file"))
    }
}

impl fmt::Display for SceneName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Built(kind) => f.pad(kind.name()),
            Self::File(path) => path.display().fmt(f),
            Self::Given(name, _) => f.pad(name),
        }
    }
}

impl SceneName {
    /// Builds or loads the scene. A file has its own seed and frames.
    ///
    /// # Errors
    /// As [`import::load`].
    pub fn open(&self, options: &SceneOptions) -> Result<World, ImportError> {
        match self {
            Self::Built(kind) => Ok(generated::build(*kind, options)),
            Self::File(path) => import::load(path),
            Self::Given(name, bytes) => {
                import::read(name, bytes, None).map_err(|why| ImportError { path: PathBuf::from(name), why })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_told_by_name_or_ending_and_missing_files_are_found_by_trying() {
        assert_eq!("city".parse(), Ok(SceneName::Built(SceneKind::City)));
        assert_eq!("a b/X.GLB".parse(), Ok(SceneName::File(PathBuf::from("a b/X.GLB"))));
        for bad in ["", "house", "house.obj", ".glb"] {
            let said = bad.parse::<SceneName>().unwrap_err();
            assert!(said.contains("crowd") && said.contains(".gltf"), "{said}");
        }
        let refused = |name: SceneName| name.open(&SceneOptions::default()).err().unwrap().to_string();
        let folder = std::env::temp_dir().join(format!("casca-scene-{}.glb", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join("none.glb");
        for bad in [file.clone(), folder.clone()] {
            let said = refused(SceneName::File(bad.clone()));
            assert!(said.starts_with(&format!("{}: cannot be read", bad.display())), "{said}");
        }
        std::fs::write(&file, "no scene").unwrap();
        let given = SceneName::Given("dropped".to_owned(), b"no scene".as_slice().into());
        let said = refused(given);
        assert!(said.starts_with("dropped: is not a valid"), "{said}");
        let said = refused(SceneName::File(file.clone()));
        assert!(said.starts_with(&format!("{}: is not a valid", file.display())), "{said}");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
