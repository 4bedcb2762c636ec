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
}

/// Cells on a device.
pub(super) struct GpuCells {
    grid: Buffer,
    starts: Buffer,
    lists: Buffer,
    ends: Buffer,
}

impl GpuCells {
    pub(super) fn new(gpu: &Gpu, cells: &Cells) -> Result<Self, GpuError> {
        let rows: Vec<Row> = (0..cells.ends().len()).map(|i| row(cells, i)).collect();
        let (origin, dims) = (cells.origin().to_array(), cells.dims().to_array());
        let grid = GpuGrid { origin, side: cells.side(), dims, margin: cells.margin() };
        let usage = BufferUsages::STORAGE;
        Ok(Self {
            grid: filled(gpu, &[grid], BufferUsages::UNIFORM)?,
            starts: filled(gpu, cells.starts(), usage)?,
            lists: filled(gpu, cells.lists(), usage)?,
            ends: filled(gpu, &rows, usage)?,
        })
    }

    /// Copies what the motion of segments, by their numbers, changed in the grid.
    pub(super) fn follow(&mut self, gpu: &Gpu, cells: &Cells, segments: &[u32]) -> Result<(), GpuError> {
        gpu.write(&self.starts, bytemuck::cast_slice(cells.starts()))?;
        if size_of_val(cells.lists()) as u64 > self.lists.size() {
            self.lists = filled(gpu, cells.lists(), BufferUsages::STORAGE)?;
        } else {
            gpu.write(&self.lists, bytemuck::cast_slice(cells.lists()))?;
        }
        let ranges: Vec<Range<usize>> = segments.iter().map(|&s| s as usize..s as usize + 1).collect();
        let rows: Vec<Row> = segments.iter().map(|&s| row(cells, s as usize)).collect();
        write_ranges(gpu, &self.ends, &ranges, &rows)
    }

    /// The buffers that passes of rays bind.
    pub(super) fn bound(&self) -> [Bound<'_>; 4] {
        [(19, &self.grid), (20, &self.starts), (21, &self.lists), (22, &self.ends)]
    }

    /// The memory on the device in bytes.
    pub(super) fn bytes(&self) -> u64 {
        [&self.starts, &self.lists, &self.ends].map(Buffer::size).iter().sum()
    }
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
