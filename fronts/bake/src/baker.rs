//! Bakes: the sets of many cells, by several threads, kept in a journal.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;

use casca_baked::{Cells, Writer};
use casca_scenes::world::Shape;

use crate::error::BakeError;
use crate::find::Finder;
use crate::journal::Journal;
use crate::level::{Level, eyes_of};
use crate::places::Places;

/// Told how many cells are done, and of how many; says whether to go on.
pub type Progress<'a> = dyn FnMut(usize, usize) -> ControlFlow<()> + 'a;

/// A bake of one level, or a part of it.
pub struct Baker<'l> {
    level: &'l Level,
    cells: Cells,
    numbers: Vec<u32>,
    queries: u32,
}

impl<'l> Baker<'l> {
    /// A bake of all cells of a level, with up to about so many queries each: see [`Finder::new`].
    ///
    /// # Errors
    /// [`BakeError::Places`].
    pub fn new(level: &'l Level, places: &Places, queries: u32) -> Result<Self, BakeError> {
        let mut numbers = places.numbers(level)?;
        let cells = places.cells(level)?;
        // Neighbours in space are near each other in this order, so that parts of it are too.
        numbers.sort_by_key(|&cell| (morton(&cells, cell), cell));
        Ok(Self { level, cells, numbers, queries })
    }

    /// The same with one of `parts` parts of the cells, counted from 1.
    ///
    /// # Errors
    /// [`BakeError::Shard`].
    pub fn shard(mut self, part: u32, parts: u32) -> Result<Self, BakeError> {
        if part == 0 || part > parts {
            return Err(BakeError::Shard { part, parts });
        }
        let end = |part: u32| (self.numbers.len() as u64 * u64::from(part) / u64::from(parts)) as usize;
        self.numbers = self.numbers[end(part - 1)..end(part)].to_vec();
        Ok(self)
    }

    /// A bake of some cells of a grid; those that are none are left out.
    pub fn of(level: &'l Level, cells: Cells, numbers: &[u32], queries: u32) -> Self {
        let is_one = |cell: &u32| eyes_of(&cells, *cell).is_some();
        Self { level, cells, numbers: numbers.iter().copied().filter(is_one).collect(), queries }
    }

    /// The grid of cells.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }

    /// The cells to bake, neighbours near each other.
    pub fn numbers(&self) -> &[u32] {
        &self.numbers
    }

    /// A file without sets, to put them in.
    ///
    /// # Errors
    /// [`BakeError::OtherCells`].
    pub fn writer(&self) -> Result<Writer, BakeError> {
        Ok(match self.level.cells {
            Some(cells) => {
                let targets = self.level.targets();
                // A cell with a set that is in no other would count as hidden.
                if cells != self.cells || self.numbers.iter().any(|cell| !targets.contains(cell)) {
                    return Err(BakeError::OtherCells);
                }
                Writer::cell_to_cell(self.level.in_file(cells), &targets)?
            }
            None => Writer::new(self.level.in_file(self.cells), self.level.len())?,
        })
    }

    /// Finds the sets of all cells. With a journal, those in it are taken over, and each that is
    /// found is noted in it; the journal stays. The sets do not depend on the threads, nor on how
    /// often a bake was stopped.
    ///
    /// # Errors
    /// The journal cannot be had or is of another bake, or the progress says to stop.
    pub fn run(
        &self,
        threads: usize,
        journal: Option<&Path>,
        progress: &mut Progress,
    ) -> Result<Writer, BakeError> {
        let mut writer = self.writer()?;
        let (mut journal, done) = match journal {
            Some(path) => {
                let (journal, done) = Journal::open(path, &self.name())?;
                (Some(journal), done)
            }
            None => (None, Vec::new()),
        };
        let mut known = BTreeMap::from_iter(done);
        let is_new = |cell: &&u32| !known.contains_key(cell);
        let open: Vec<u32> = self.numbers.iter().filter(is_new).copied().collect();
        for &cell in &self.numbers {
            if let Some(set) = known.remove(&cell) {
                writer.put(cell, &set)?;
            }
        }
        let total = self.numbers.len();
        let mut count = total - open.len();
        if progress(count, total).is_break() {
            return Err(BakeError::Stopped);
        }
        let (next, stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
        let (sender, found) = mpsc::channel();
        std::thread::scope(|scope| {
            for _ in 0..threads.clamp(1, open.len().max(1)) {
                let (sender, next, stopped, open) = (sender.clone(), &next, &stopped, &open);
                scope.spawn(move || {
                    let mut finder = Finder::new(self.level, self.queries);
                    while let Some(&cell) = open.get(next.fetch_add(1, Ordering::Relaxed)) {
                        let set = eyes_of(&self.cells, cell).map(|eyes| finder.set(eyes)).unwrap_or_default();
                        if stopped.load(Ordering::Relaxed) || sender.send((cell, set)).is_err() {
                            break;
                        }
                    }
                });
            }
            drop(sender);
            for (cell, set) in found {
                let mut note = || {
                    journal.as_mut().map_or(Ok(()), |journal| journal.note(cell, &set))?;
                    writer.put(cell, &set)?;
                    count += 1;
                    if progress(count, total).is_break() { Err(BakeError::Stopped) } else { Ok(()) }
                };
                if let Err(why) = note() {
                    stopped.store(true, Ordering::Relaxed);
                    return Err(why);
                }
            }
            Ok(())
        })?;
        Ok(writer)
    }

    /// Runs, writes the file, and deletes the journal, which lies beside the file. The file is
    /// there whole or not at all.
    ///
    /// # Errors
    /// As [`Baker::run`], and if the file cannot be written.
    pub fn write(&self, out: &Path, threads: usize, progress: &mut Progress) -> Result<(), BakeError> {
        let journal = journal_of(out);
        let bytes = self.run(threads, Some(&journal), progress)?.finish()?;
        write_whole(out, &bytes)?;
        Journal::open(&journal, &self.name())?.0.remove()
    }

    /// What tells this bake from others.
    fn name(&self) -> [u8; 32] {
        let mut hash = blake3::Hasher::new();
        hash.update(env!("CARGO_PKG_VERSION").as_bytes());
        let mut number = |n: u64| {
            hash.update(&n.to_le_bytes());
        };
        let mut float = |x: f32| number(u64::from(x.to_bits()));
        float(self.level.scene.grid().cell_size() as f32);
        float(self.level.solids.len() as f32);
        for object in self.level.objects() {
            float(f32::from(u8::from(object.occludes) + 2 * u8::from(object.tested)));
            match &object.shape {
                Shape::Sphere { center, radius } => {
                    center.to_array().into_iter().chain([*radius, 0.0]).for_each(&mut float);
                }
                Shape::Box { min, max } => {
                    min.to_array().into_iter().chain(max.to_array()).for_each(&mut float)
                }
                Shape::Mesh { mesh, transform } => {
                    transform.to_cols_array().into_iter().for_each(&mut float);
                    mesh.positions.iter().flat_map(|p| p.to_array()).for_each(&mut float);
                    mesh.triangles.iter().flatten().for_each(|v| float(f32::from_bits(*v)));
                    mesh.sides.iter().for_each(|&sides| float(f32::from(sides as u8)));
                }
            }
        }
        let cells = self.level.in_file(self.cells);
        let cells = cells.low.iter().chain(&cells.size).chain(&cells.origin).map(|v| v.to_bits());
        cells.chain(self.cells.dims.map(u64::from)).for_each(&mut number);
        number(self.queries.into());
        self.numbers.iter().for_each(|&cell| number(cell.into()));
        // Objects that move are in no set, but have a number.
        self.level.bounds.iter().for_each(|target| number(target.is_some().into()));
        *hash.finalize().as_bytes()
    }
}

/// The journal of a file: beside it, with `.journal` after its name.
pub fn journal_of(out: &Path) -> std::path::PathBuf {
    with_ending(out, ".journal")
}

fn with_ending(path: &Path, ending: &str) -> std::path::PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

/// Writes a file beside its place, and moves it there.
///
/// # Errors
/// It cannot be written; nothing is left behind then, and an earlier file stays.
pub fn write_whole(out: &Path, bytes: &[u8]) -> Result<(), BakeError> {
    let beside = with_ending(out, ".part");
    let written = std::fs::write(&beside, bytes).and_then(|()| std::fs::rename(&beside, out));
    written.map_err(|why| {
        let _ = std::fs::remove_file(&beside);
        BakeError::file("write", out)(why)
    })
}

/// The place of a cell on a curve that stays near: the bits of its three numbers in turn.
fn morton(cells: &Cells, cell: u32) -> u64 {
    let [x, y, _] = cells.dims;
    let at = [cell % x, cell / x % y, cell / x / y].map(u64::from);
    (0..21)
        .fold(0, |code, bit| (0..3).fold(code, |code, axis| code | (at[axis] >> bit & 1) << (3 * bit + axis)))
}
