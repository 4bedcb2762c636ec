//! Bricks built out of core, by external sorting along the Morton curve.
//!
//! Points go to a scratch file. Once their bounds are known, runs of them are sorted in memory and
//! written, then merged. The merged points are cut at the largest cells of an octree that hold at
//! most as many points as a brick may.

use super::BrickError;
use super::file::{BrickPoint, HEADER, Header, MOST, POINT};
use super::order::{BITS, arrange, code};
use crate::PointCloud;
use glam::Vec3;
use rayon::slice::ParallelSliceMut;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};
use std::fs::{self, File};
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// The most runs: each needs an open file.
const RUNS: u64 = 256;
/// Bytes of a point while its run is sorted: point and code, twice.
const SORTED: u64 = 48;
/// Bytes of the buffers of files.
const BUFFER: usize = 1 << 18;

/// How bricks are built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BuildOptions {
    /// The most points of a brick, from 1 to 262,144; other numbers count as the nearest of these.
    /// Small ones are culled better, large ones load faster.
    pub most_points: u32,
    /// Bytes for sorting; at least 4 MiB, and enough for 1/256 of the points are taken anyway. It
    /// does not change the result.
    pub memory: u64,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self { most_points: 1 << 16, memory: 1 << 28 }
    }
}

/// A file that is removed when its work is done or broken off.
struct Scratch(PathBuf);

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

/// Builds a file of bricks from points in chunks of any size. Beside the result, which has 16 bytes
/// a point, it needs 32 bytes a point on the disk until the end.
pub struct Builder {
    target: PathBuf,
    options: BuildOptions,
    header: Header,
    low: Vec3,
    high: Vec3,
    raw: BufWriter<File>,
    scratch: Scratch,
}

impl Builder {
    /// Begins a file. Beside it, files that end in `.raw` and `.runs` are written and removed again.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn create(target: &Path, options: BuildOptions) -> Result<Self, BrickError> {
        let scratch = Scratch(beside(target, ".raw"));
        let raw = named(&scratch.0, create(&scratch.0))?;
        let (low, high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        Ok(Self { target: target.into(), options, header: Header::default(), low, high, raw, scratch })
    }

    /// Adds points. The origin is that of the first cloud. Points without colours are white; normals
    /// and radii are not kept.
    ///
    /// # Errors
    /// Those of the file system; positions that are not finite; colours for some points only.
    pub fn push(&mut self, cloud: &PointCloud) -> Result<(), BrickError> {
        cloud.check()?;
        if self.header.points == 0 {
            self.header.origin = cloud.origin;
        }
        let offset = cloud.origin - self.header.origin;
        for (i, &position) in cloud.positions.iter().enumerate() {
            let position = (offset + position.as_dvec3()).as_vec3();
            if !position.is_finite() || !self.header.origin.is_finite() {
                return Err(BrickError::NotFinite { index: self.header.points });
            }
            self.low = self.low.min(position);
            self.high = self.high.max(position);
            let colour = cloud.colours.get(i).copied().unwrap_or([255; 3]);
            named(&self.scratch.0, self.raw.write_all(&BrickPoint { position, colour }.to_bytes()))?;
            self.header.points += 1;
        }
        Ok(())
    }

    /// Sorts the points and writes the bricks. `progress` gets the steps done and all steps, two a point.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn finish(self, mut progress: impl FnMut(u64, u64)) -> Result<(), BrickError> {
        let Self { target, options, mut header, low, high, mut raw, scratch } = self;
        let all = 2 * header.points;
        let edge = (high.as_dvec3() - low.as_dvec3()).max_element();
        let code = |p: &BrickPoint| code(p.position, low, edge, BITS);
        let runs = Scratch(beside(&target, ".runs"));
        named(&scratch.0, raw.flush())?;
        drop(raw);
        let length = (options.memory.max(4 << 20) / SORTED).max(header.points.div_ceil(RUNS));
        named(&runs.0, sort(&scratch.0, &runs.0, length, code, |done| progress(done, all)))?;
        drop(scratch);
        let mut merge = named(&runs.0, Merge::new(&runs.0, header.points, length, code))?;
        let mut out = named(&target, create(&target))?;
        let (mut index, mut first) = (Vec::new(), 0);
        named(&target, out.write_all(&[0; HEADER as usize]))?;
        let most = options.most_points.clamp(1, MOST) as usize;
        while let Some(mut points) = named(&runs.0, merge.brick(most))? {
            let brick = arrange(&mut points, first);
            named(&target, points.iter().try_for_each(|p| out.write_all(&p.to_bytes())))?;
            index.extend(brick.to_bytes());
            header.bricks += 1;
            first += points.len() as u64;
            progress(header.points + first, all);
        }
        named(&target, out.write_all(&index))?;
        named(&target, out.rewind())?;
        named(&target, out.write_all(&header.to_bytes()))?;
        named(&target, out.flush())
    }
}

fn beside(target: &Path, ending: &str) -> PathBuf {
    let mut name = target.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

fn create(path: &Path) -> io::Result<BufWriter<File>> {
    Ok(BufWriter::with_capacity(BUFFER, File::create(path)?))
}

fn named<T>(path: &Path, result: io::Result<T>) -> Result<T, BrickError> {
    result.map_err(|source| BrickError::Io { name: path.display().to_string(), source })
}

/// The next point of a file; `None` at its end.
fn next(file: &mut impl Read) -> io::Result<Option<BrickPoint>> {
    let mut bytes = [0; POINT as usize];
    match file.read_exact(&mut bytes) {
        Ok(()) => Ok(Some(BrickPoint::from_bytes(&bytes))),
        Err(e) if e.kind() == io::ErrorKind::UnexpectedEof => Ok(None),
        Err(e) => Err(e),
    }
}

/// Sorts runs of points by their codes, equal ones in their order.
fn sort(
    from: &Path,
    to: &Path,
    length: u64,
    code: impl Fn(&BrickPoint) -> u64,
    mut progress: impl FnMut(u64),
) -> io::Result<()> {
    let (mut from, mut to) = (BufReader::with_capacity(BUFFER, File::open(from)?), create(to)?);
    let (mut run, mut done) = (Vec::new(), 0);
    loop {
        let point = next(&mut from)?;
        run.extend(point.map(|p| (code(&p), p)));
        if run.len() as u64 == length || point.is_none() {
            run.par_sort_by_key(|&(code, _)| code);
            run.iter().try_for_each(|(_, p)| to.write_all(&p.to_bytes()))?;
            done += run.len() as u64;
            run.clear();
            progress(done);
        }
        if point.is_none() {
            return to.flush();
        }
    }
}

/// Merges sorted runs and cuts them into bricks.
struct Merge<F> {
    runs: Vec<(io::Take<BufReader<File>>, Option<BrickPoint>)>,
    /// The code of the next point of each run, and the run.
    heap: BinaryHeap<Reverse<(u64, usize)>>,
    ahead: VecDeque<(u64, BrickPoint)>,
    /// The code of the last point of the last brick.
    before: Option<u64>,
    code: F,
}

impl<F: Fn(&BrickPoint) -> u64> Merge<F> {
    fn new(path: &Path, points: u64, length: u64, code: F) -> io::Result<Self> {
        let (runs, heap, ahead) = (Vec::new(), BinaryHeap::new(), VecDeque::new());
        let mut merge = Self { runs, heap, ahead, before: None, code };
        for run in 0..points.div_ceil(length) {
            let mut file = File::open(path)?;
            file.seek(SeekFrom::Start(run * length * POINT))?;
            merge.runs.push((BufReader::with_capacity(BUFFER, file).take(length * POINT), None));
            merge.advance(run as usize)?;
        }
        Ok(merge)
    }

    fn advance(&mut self, run: usize) -> io::Result<()> {
        let (file, point) = &mut self.runs[run];
        *point = next(file)?;
        self.heap.extend(point.map(|p| Reverse(((self.code)(&p), run))));
        Ok(())
    }

    /// The points of the largest cell of the octree that begins with the next point and holds at
    /// most `most`; of a smallest cell that holds more, `most`. `None` at the end.
    fn brick(&mut self, most: usize) -> io::Result<Option<Vec<BrickPoint>>> {
        while self.ahead.len() <= most {
            let Some(Reverse((code, run))) = self.heap.pop() else { break };
            self.ahead.extend(self.runs[run].1.map(|p| (code, p)));
            self.advance(run)?;
        }
        let Some(&(first, _)) = self.ahead.front() else { return Ok(None) };
        let next = self.ahead.get(most).map(|&(code, _)| code);
        let others = [self.before, next];
        let fits = |shift: &u32| others.iter().flatten().all(|code| code >> shift != first >> shift);
        let shift = (0..=BITS).rev().map(|level| 3 * level).find(fits).unwrap_or(0);
        let count = self.ahead.partition_point(|(code, _)| code >> shift == first >> shift).min(most);
        self.before = self.ahead.get(count - 1).map(|&(code, _)| code);
        Ok(Some(self.ahead.drain(..count).map(|(_, p)| p).collect()))
    }
}
