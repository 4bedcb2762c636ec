//! A folder of prepared meshes, found by their content: triangles that were prepared once, with the
//! same options and by the same version of casca, are read instead.
//!
//! An entry is a file as [`TriMesh::write`] writes it. Its name is a hash of positions, triangles,
//! options and [`TriMesh::PREPARATION`], so that nothing is ever out of date: what changed has
//! another name. An entry that is damaged, cut off or of other triangles is prepared anew and
//! written again. Entries appear as a whole, by renaming a file, so any number of threads and
//! processes may use a folder at once.
//!
//! Whoever can write into the folder can make meshes hide what their triangles do not: it is as
//! trusted as the program.
//!
//! ```
//! use std::ops::ControlFlow;
//!
//! use casca::MeshOptions;
//! use casca::glam::Vec3;
//! use casca_cache::MeshCache;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let folder = std::env::temp_dir().join(format!("casca-cache-{}", std::process::id()));
//! let cache = MeshCache::new(&folder)?;
//! for _ in 0..2 {
//!     let (positions, triangles) = (vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
//!     let how = MeshOptions::default();
//!     let mesh = cache.prepare(positions, triangles, &how, &mut |_| ControlFlow::Continue(()))?;
//!     assert_eq!(mesh.triangles().len(), 1);
//! }
//! assert_eq!((cache.counts().misses, cache.counts().hits), (1, 1));
//! # std::fs::remove_dir_all(folder)?;
//! # Ok(())
//! # }
//! ```

#![deny(missing_docs)]

#[cfg(test)]
mod tests;

use std::fs::{self, File};
use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use casca::glam::Vec3;
use casca::{Error, MeshOptions, TriMesh};

/// What names of entries end with, and those of files that become entries.
const ENTRY: &str = ".casca";
const UNFINISHED: &str = ".casca-part";

/// Tells the unfinished files of this process apart, also those of several caches in one folder.
static FILES: AtomicUsize = AtomicUsize::new(0);

/// A folder of prepared meshes. Threads share it by reference.
#[derive(Debug)]
pub struct MeshCache {
    folder: PathBuf,
    counts: Mutex<CacheCounts>,
}

/// How often a cache was asked, and what came of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CacheCounts {
    /// Meshes that were read.
    pub hits: usize,
    /// Meshes that were prepared, because there was no sound entry.
    pub misses: usize,
    /// Those of them that could not be written.
    pub unwritten: usize,
}

impl MeshCache {
    /// A cache in a folder, which is made if it is missing. Other files in it are left alone. It
    /// removes nothing: to begin anew, delete the folder.
    ///
    /// # Errors
    /// The folder cannot be made or read.
    pub fn new(folder: impl Into<PathBuf>) -> io::Result<Self> {
        let folder = folder.into();
        fs::create_dir_all(&folder)?;
        fs::read_dir(&folder)?;
        Ok(Self { folder, counts: Mutex::default() })
    }

    /// As [`TriMesh::prepare`]: reads the mesh if there is an entry of it, and else prepares and
    /// writes it. A mesh that is read is the same in every bit. A folder that cannot be read or
    /// written costs time only.
    ///
    /// Reading costs a hash of the triangles and the checks of [`TriMesh::read`].
    ///
    /// # Errors
    /// As [`TriMesh::prepare`].
    pub fn prepare(
        &self,
        positions: Vec<Vec3>,
        triangles: Vec<[u32; 3]>,
        how: &MeshOptions,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<TriMesh, Error> {
        let path = self.path_of(&positions, &triangles, how);
        if let Some(mesh) = self.read(&path, &positions, &triangles, how) {
            self.count(|counts| counts.hits += 1);
            return match progress(1.0) {
                ControlFlow::Continue(()) => Ok(mesh),
                ControlFlow::Break(()) => Err(Error::Cancelled),
            };
        }
        let mesh = TriMesh::prepare(positions, triangles, how, progress)?;
        self.count(|counts| counts.misses += 1);
        if self.write(&path, &mesh).is_err() {
            self.count(|counts| counts.unwritten += 1);
        }
        Ok(mesh)
    }

    /// What came of [`MeshCache::prepare`] so far.
    pub fn counts(&self) -> CacheCounts {
        *self.counts.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn count(&self, change: impl FnOnce(&mut CacheCounts)) {
        change(&mut self.counts.lock().unwrap_or_else(PoisonError::into_inner));
    }

    /// Where the entry of a mesh is, or would be.
    fn path_of(&self, positions: &[Vec3], triangles: &[[u32; 3]], how: &MeshOptions) -> PathBuf {
        let mut hasher = blake3::Hasher::new_derive_key("casca prepared mesh");
        // All options, also those that are yet to come; floats are written so that none is lost.
        let head = format!("{} {how:?} {} {}", TriMesh::PREPARATION, positions.len(), triangles.len());
        hasher.update(&(head.len() as u64).to_le_bytes()).update(head.as_bytes());
        let words = positions.iter().flat_map(|p| p.to_array()).map(f32::to_bits);
        let mut block = Vec::with_capacity(1 << 14);
        for word in words.chain(triangles.iter().flatten().copied()) {
            block.extend_from_slice(&word.to_le_bytes());
            if block.len() == 1 << 14 {
                hasher.update(&block);
                block.clear();
            }
        }
        hasher.update(&block);
        self.folder.join(format!("{}{ENTRY}", hasher.finalize().to_hex()))
    }

    /// The mesh of an entry, if it is sound.
    fn read(
        &self,
        path: &Path,
        positions: &[Vec3],
        triangles: &[[u32; 3]],
        how: &MeshOptions,
    ) -> Option<TriMesh> {
        let bytes = fs::read(path).ok()?;
        let mut rest = bytes.as_slice();
        let mesh = TriMesh::read(&mut rest).ok()?;
        let bits = |p: &Vec3| p.to_array().map(f32::to_bits);
        let same = rest.is_empty()
            && mesh.occludes() == how.occludes
            && mesh.triangles() == triangles
            && mesh.positions().iter().map(bits).eq(positions.iter().map(bits));
        same.then_some(mesh)
    }

    fn write(&self, path: &Path, mesh: &TriMesh) -> io::Result<()> {
        let mut bytes = Vec::new();
        mesh.write(&mut bytes)?;
        let number = FILES.fetch_add(1, Ordering::Relaxed);
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let unfinished = format!("{name}-{}-{number}{UNFINISHED}", std::process::id());
        let unfinished = self.folder.join(unfinished);
        let written = File::create(&unfinished)
            .and_then(|mut file| file.write_all(&bytes))
            .and_then(|()| fs::rename(&unfinished, path));
        if written.is_err() {
            let _ = fs::remove_file(&unfinished);
        }
        written
    }
}
