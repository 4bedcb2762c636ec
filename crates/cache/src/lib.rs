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
//! let cache = MeshCache::new(&folder)?.limit(64 << 20);
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

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::time::{Duration, SystemTime};

use casca::glam::Vec3;
use casca::{Error, MeshOptions, TriMesh};

/// What names of entries end with, and those of files that become entries.
const ENTRY: &str = ".casca";
const UNFINISHED: &str = ".casca-part";

/// Hexadecimal digits of a hash.
const DIGITS: usize = 2 * blake3::OUT_LEN;

/// Files that are older and did not become entries are left from programs that ended early.
const ABANDONED: Duration = Duration::from_secs(3600);

/// Once the entries are larger than allowed, they are cut down to this share of it.
const KEPT: f64 = 0.75;

/// Tells the unfinished files of this process apart, also those of several caches in one folder.
static FILES: AtomicUsize = AtomicUsize::new(0);

/// A folder of prepared meshes. Threads share it by reference.
#[derive(Debug)]
pub struct MeshCache {
    folder: PathBuf,
    /// Bytes of all entries, at most.
    limit: u64,
    /// About the bytes of all entries: those that were there, and those written since.
    held: AtomicU64,
    /// One thread at a time looks for entries to remove.
    trimming: Mutex<()>,
    hits: AtomicUsize,
    misses: AtomicUsize,
    unwritten: AtomicUsize,
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
    /// A cache in a folder, which is made if it is missing. Other files in it are left alone.
    ///
    /// # Errors
    /// The folder cannot be made or read.
    pub fn new(folder: impl Into<PathBuf>) -> io::Result<Self> {
        let folder = folder.into();
        fs::create_dir_all(&folder)?;
        let held = entries(&folder)?.iter().map(|entry| entry.bytes).sum();
        Ok(Self {
            folder,
            limit: u64::MAX,
            held: AtomicU64::new(held),
            trimming: Mutex::new(()),
            hits: AtomicUsize::new(0),
            misses: AtomicUsize::new(0),
            unwritten: AtomicUsize::new(0),
        })
    }

    /// Keeps about this many bytes of entries at most: when more are written, those that were not
    /// used for longest go. Without a limit nothing goes but by [`MeshCache::clear`].
    #[must_use]
    pub fn limit(mut self, bytes: u64) -> Self {
        self.limit = bytes;
        self
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
            self.hits.fetch_add(1, Ordering::Relaxed);
            return match progress(1.0) {
                ControlFlow::Continue(()) => Ok(mesh),
                ControlFlow::Break(()) => Err(Error::Cancelled),
            };
        }
        let mesh = TriMesh::prepare(positions, triangles, how, progress)?;
        self.misses.fetch_add(1, Ordering::Relaxed);
        if self.write(&path, &mesh).is_err() {
            self.unwritten.fetch_add(1, Ordering::Relaxed);
        }
        Ok(mesh)
    }

    /// Removes all entries, whoever wrote them. Returns how many there were.
    ///
    /// # Errors
    /// The folder cannot be read, or an entry not be removed.
    pub fn clear(&self) -> io::Result<usize> {
        let all = entries(&self.folder)?;
        for entry in &all {
            remove(&entry.path)?;
        }
        self.held.store(0, Ordering::Relaxed);
        Ok(all.len())
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// What came of [`MeshCache::prepare`] so far.
    pub fn counts(&self) -> CacheCounts {
        let count = |count: &AtomicUsize| count.load(Ordering::Relaxed);
        CacheCounts {
            hits: count(&self.hits),
            misses: count(&self.misses),
            unwritten: count(&self.unwritten),
        }
    }

    /// Where the entry of a mesh is, or would be.
    pub fn path_of(&self, positions: &[Vec3], triangles: &[[u32; 3]], how: &MeshOptions) -> PathBuf {
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
        if same && self.limit < u64::MAX {
            // Where that fails, it goes earlier than it needed to.
            let _ =
                OpenOptions::new().append(true).open(path).and_then(|f| f.set_modified(SystemTime::now()));
        }
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
        written?;
        let bytes = bytes.len() as u64;
        if self.held.fetch_add(bytes, Ordering::Relaxed) + bytes > self.limit {
            self.trim()?;
        }
        Ok(())
    }

    /// Removes entries until they are clearly less than allowed.
    fn trim(&self) -> io::Result<()> {
        // Another thread that is at it will do.
        let Ok(_alone) = self.trimming.try_lock() else { return Ok(()) };
        let mut all = entries(&self.folder)?;
        all.sort_by(|a, b| a.used.cmp(&b.used).then_with(|| a.path.cmp(&b.path)));
        let mut held: u64 = all.iter().map(|entry| entry.bytes).sum();
        let kept = if held > self.limit { (self.limit as f64 * KEPT) as u64 } else { self.limit };
        for entry in all {
            let abandoned = !entry.whole && entry.used.elapsed().is_ok_and(|age| age > ABANDONED);
            if abandoned || entry.whole && held > kept {
                remove(&entry.path)?;
                held -= entry.bytes;
            }
        }
        self.held.store(held, Ordering::Relaxed);
        Ok(())
    }
}

/// A file of a cache.
struct Entry {
    path: PathBuf,
    /// Whether it is no unfinished one.
    whole: bool,
    bytes: u64,
    /// When it was written or read last, as far as the system tells.
    used: SystemTime,
}

/// The files of a cache in a folder: those with names that it gives.
fn entries(folder: &Path) -> io::Result<Vec<Entry>> {
    let mut all = Vec::new();
    for file in fs::read_dir(folder)? {
        let file = file?;
        let name = file.file_name();
        let Some(name) = name.to_str() else { continue };
        let (hash, rest) = name.split_at_checked(DIGITS).unwrap_or(("", ""));
        let is_hash = !hash.is_empty() && hash.bytes().all(|b| b.is_ascii_hexdigit());
        let whole = rest == ENTRY;
        if !is_hash || !whole && !rest.ends_with(UNFINISHED) {
            continue;
        }
        // It may have gone since.
        let Ok(about) = file.metadata() else { continue };
        let used = about.modified().unwrap_or(SystemTime::UNIX_EPOCH);
        all.push(Entry { path: file.path(), whole, bytes: about.len(), used });
    }
    Ok(all)
}

/// Removes a file, unless another process did.
fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => Err(e),
        _ => Ok(()),
    }
}
