//! Cells of lines in the memory of a device.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::kernel::{Bound, filled};
use casca_stage::wgpu::{Buffer, BufferUsages};

use crate::cells::Cells;

/// `Grid` of rays.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct GpuGrid {
    origin: [f32; 3],
    side: f32,
    dims: [u32; 3],
    margin: f32,
    part: u32,
    padding: [u32; 3],
}

/// The buffers that lists and segments may take, as parts.wgsl has them.
const PARTS: [usize; 2] = [6, 2];
/// Buffers that a pass of rays binds then, at most.
const SPLIT_BINDINGS: u32 = 14;

/// The bindings of cells in one buffer each, and those of parts.
pub(super) const WHOLE: &[u32] = &[19, 20, 21, 22];
pub(super) const SPLIT: &[u32] = &[19, 20, 21, 22, 50, 51, 52, 53, 54, 55];

/// Cells on a device.
pub(super) struct GpuCells {
    grid: Buffer,
    starts: Buffer,
    /// In parts where they are larger than a buffer may be.
    lists: Vec<Buffer>,
    ends: Vec<Buffer>,
}

impl GpuCells {
    /// Cells in one buffer for each array, or in parts if the adapter takes no buffers as large.
    pub(super) fn new(gpu: &Gpu, cells: &Cells) -> Result<Self, GpuError> {
        let limits = gpu.device.limits();
        let most = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size).max(32);
        // Numbers of words have 32 bits.
        Self::of_parts(gpu, cells, (most / 4).ilog2().min(31))
    }

    /// In parts of 2^`part` words, 4 bytes each, if there are more words.
    pub(super) fn of_parts(gpu: &Gpu, cells: &Cells, part: u32) -> Result<Self, GpuError> {
        let rows: Vec<Row> = (0..cells.ends().len()).map(|i| row(cells, i)).collect();
        let (origin, dims) = (cells.origin().to_array(), cells.dims().to_array());
        let (side, margin) = (cells.side(), cells.margin());
        let grid = GpuGrid { origin, side, dims, margin, part, padding: [0; 3] };
        let words: &[u32] = bytemuck::cast_slice(&rows);
        let made = Self {
            grid: filled(gpu, &[grid], BufferUsages::UNIFORM)?,
            starts: filled(gpu, cells.starts(), BufferUsages::STORAGE)?,
            lists: in_parts(gpu, cells.lists(), part, PARTS[0])?,
            ends: in_parts(gpu, words, part, PARTS[1])?,
        };
        if made.is_split() && gpu.device.limits().max_storage_buffers_per_shader_stage < SPLIT_BINDINGS {
            return Err(no_room(size_of_val(cells.lists()).max(size_of_val(words)), part, 1));
        }
        Ok(made)
    }

    /// Whether an array is in parts, so that shaders must look for them.
    pub(super) fn is_split(&self) -> bool {
        self.lists.len() > 1 || self.ends.len() > 1
    }

    /// Copies what the motion of segments, by their numbers, changed in the grid.
    pub(super) fn follow(&mut self, gpu: &Gpu, cells: &Cells, segments: &[u32]) -> Result<(), GpuError> {
        let ([lists], [ends]) = (&self.lists[..], &self.ends[..]) else {
            *self = Self::new(gpu, cells)?;
            return Ok(());
        };
        if size_of_val(cells.lists()) as u64 > lists.size() {
            *self = Self::new(gpu, cells)?;
            return Ok(());
        }
        gpu.write(&self.starts, bytemuck::cast_slice(cells.starts()))?;
        gpu.write(lists, bytemuck::cast_slice(cells.lists()))?;
        let ranges: Vec<Range<usize>> = segments.iter().map(|&s| s as usize..s as usize + 1).collect();
        let rows: Vec<Row> = segments.iter().map(|&s| row(cells, s as usize)).collect();
        write_ranges(gpu, ends, &ranges, &rows)
    }

    /// The buffers that passes of rays bind. Where there is no such part, the first takes its
    /// place, and is not read.
    pub(super) fn bound(&self) -> [Bound<'_>; 10] {
        let list = |i: usize| self.lists.get(i).unwrap_or(&self.lists[0]);
        [
            (19, &self.grid),
            (20, &self.starts),
            (21, list(0)),
            (22, &self.ends[0]),
            (50, list(1)),
            (51, list(2)),
            (52, list(3)),
            (53, list(4)),
            (54, list(5)),
            (55, self.ends.get(1).unwrap_or(&self.ends[0])),
        ]
    }

    /// The memory on the device in bytes.
    pub(super) fn bytes(&self) -> u64 {
        let all = std::iter::once(&self.starts).chain(&self.lists).chain(&self.ends);
        all.map(Buffer::size).sum()
    }
}

/// Words in one buffer, or in up to `most` of 2^`part` words.
fn in_parts(gpu: &Gpu, words: &[u32], part: u32, most: usize) -> Result<Vec<Buffer>, GpuError> {
    let long = 1usize << part;
    if words.len().div_ceil(long) > most {
        return Err(no_room(size_of_val(words), part, most));
    }
    // There is one part of no words, too.
    let parts = (0..words.len().max(1)).step_by(long);
    parts.map(|at| filled(gpu, &words[at..words.len().min(at + long)], BufferUsages::STORAGE)).collect()
}

fn no_room(bytes: usize, part: u32, most: usize) -> GpuError {
    GpuError::NoRoom { bytes: bytes as u64, most: (4 * most as u64) << part }
}

/// The two ends of a segment, each with the direction in which its line leads on.
type Row = [[u32; 4]; 2];

fn row(cells: &Cells, segment: usize) -> Row {
    let (ends, beside) = (cells.ends()[segment], cells.neighbours()[segment]);
    [0, 1].map(|i| [ends[i].x.to_bits(), ends[i].y.to_bits(), ends[i].z.to_bits(), beside[i]])
}

/// Writes rows into ranges of a buffer, both ascending; ranges that touch each other in one piece.
pub(super) fn write_ranges<T: Pod>(
    gpu: &Gpu,
    buffer: &Buffer,
    ranges: &[Range<usize>],
    rows: &[T],
) -> Result<(), GpuError> {
    let mut done = 0;
    for touching in ranges.chunk_by(|a, b| a.end == b.start) {
        let (Some(first), Some(last)) = (touching.first(), touching.last()) else { continue };
        let count = last.end - first.start;
        let bytes: &[u8] = bytemuck::cast_slice(&rows[done..done + count]);
        let at = (first.start * size_of::<T>()) as u64;
        done += count;
        let no_room = GpuError::NoRoom { bytes: bytes.len() as u64, most: buffer.size() };
        gpu.try_room(|| gpu.queue.write_buffer(buffer, at, bytes)).ok_or(no_room)?;
    }
    Ok(())
}
