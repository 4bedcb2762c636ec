//! Cells of lines in the memory of a device, and the passes of rays through them.

use bytemuck::{Pod, Zeroable};
use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::kernel::{Bound, Kernel, among, filled};
use casca_stage::wgpu::{Buffer, BufferUsages, CommandEncoder};
use glam::Vec3;

use crate::cells::Cells;
use crate::gpu::lens::shader;
use crate::gpu::sides::{CELLS, Passes};

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
        // The two ends of a segment, each with the direction in which its line leads on.
        let row = |(ends, beside): (&[Vec3; 2], &[u32; 2])| {
            [0, 1].map(|i| [ends[i].x.to_bits(), ends[i].y.to_bits(), ends[i].z.to_bits(), beside[i]])
        };
        let rows: Vec<[[u32; 4]; 2]> = cells.ends().iter().zip(cells.neighbours()).map(row).collect();
        let (origin, dims) = (cells.origin().to_array(), cells.dims().to_array());
        let grid = GpuGrid { origin, side: cells.side(), dims, margin: cells.margin() };
        Ok(Self {
            grid: filled(gpu, &[grid], BufferUsages::UNIFORM)?,
            starts: filled(gpu, &[cells.starts(), cells.lines()].concat(), BufferUsages::STORAGE)?,
            lists: filled(gpu, cells.lists(), BufferUsages::STORAGE)?,
            ends: filled(gpu, &rows, BufferUsages::STORAGE)?,
        })
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

/// The pixels of a workgroup, as in rays.wgsl.
const TILE: [u32; 2] = [4, 2];

/// Rays from pixels and from places.
pub(super) struct Rays {
    trace: Kernel,
    pub(super) places: Passes,
}

impl Rays {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let text = concat!(include_str!("shaders/rays.wgsl"), include_str!("shaders/sides.wgsl"));
        let module = shader(gpu, "rays", text);
        Self {
            trace: Kernel::new(gpu, &module, "trace", &[&[0, 12, 15, 16, 17][..], &CELLS].concat()),
            places: Passes::new(gpu, &module),
        }
    }

    /// Sends the rays of all pixels of a picture.
    pub(super) fn of_pixels(
        &self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        [width, height]: [u32; 2],
        bound: &[Bound<'_>],
    ) {
        let tiles = width.div_ceil(TILE[0]) as usize * height.div_ceil(TILE[1]) as usize;
        self.trace.run_groups(gpu, encoder, tiles, &among(bound));
    }
}
