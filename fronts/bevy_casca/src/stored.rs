//! The preparation of meshes, and where those are stored that were prepared.

use std::ops::ControlFlow;

#[cfg(feature = "cache")]
use std::{path::PathBuf, sync::Arc};

use casca::glam::Vec3;
use casca::{Facing, MeshOptions, TriMesh};
#[cfg(feature = "cache")]
use casca_cache::MeshCache;

use crate::settings::{CascaSettings, Opaque};

/// A folder of prepared meshes, or none.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stored {
    #[cfg(feature = "cache")]
    folder: Option<PathBuf>,
    /// `None` if the folder can be neither made nor read.
    #[cfg(feature = "cache")]
    cache: Option<Arc<MeshCache>>,
}

impl Stored {
    /// Opens the folder of the settings, if it is another one than before.
    #[cfg(feature = "cache")]
    pub(crate) fn follow(&mut self, settings: &CascaSettings) {
        if self.folder == settings.cache {
            return;
        }
        self.folder.clone_from(&settings.cache);
        self.cache = self.folder.as_ref().and_then(|folder| match MeshCache::new(folder) {
            Ok(cache) => Some(Arc::new(cache)),
            Err(why) => {
                bevy_log::warn!("meshes are not stored in {}: {why}", folder.display());
                None
            }
        });
    }

    #[cfg(not(feature = "cache"))]
    pub(crate) fn follow(&mut self, _: &CascaSettings) {}

    /// Prepares a mesh that is drawn from some sides, or reads it. `None` if it hides nothing.
    pub(crate) fn prepare(
        &self,
        positions: Vec<Vec3>,
        triangles: Vec<[u32; 3]>,
        sides: Opaque,
    ) -> Option<TriMesh> {
        let facing = match sides {
            Opaque::Front => Facing::Front,
            Opaque::Both => Facing::Both,
        };
        let how = MeshOptions::default().facing(facing);
        let progress = &mut |_| ControlFlow::Continue(());
        #[cfg(feature = "cache")]
        if let Some(cache) = &self.cache {
            return cache.prepare(positions, triangles, &how, progress).ok();
        }
        TriMesh::prepare(positions, triangles, &how, progress).ok()
    }
}
