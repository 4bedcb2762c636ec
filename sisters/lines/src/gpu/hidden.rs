//! Lines that hide lines: which chunks of segments lie wholly behind nearer ones.
//!
//! After hierarchical depth buffers (Greene, Kass, Miller 1993, "Hierarchical Z-buffer visibility")
//! and two passes by what the last frame saw. Chunks that were seen in the last frame are drawn
//! first. The depths that they leave bound what each pixel can still show: a chunk whose pixels all
//! have something nearer changes none of them, and is not drawn. A pixel without a line hides
//! nothing. The last frame decides only which chunks are drawn first, so that no pixel depends on
//! it.

use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::kernel::{Bound, Kernel, among, filled};
use casca_stage::wgpu::{Buffer, BufferUsages, CommandEncoder, DeviceType, ShaderModule};

use crate::gpu::context::Surfaces;
use crate::gpu::numeric::{CHUNK, LARGE_SET};

/// The pixels along a side of a tile, and the tiles along a side of one above, as in hidden.wgsl.
const SIDE: u32 = 8;

/// Whether lines that lie wholly behind nearer lines are left out when the nearest are looked for,
/// 64 segments at a time. No pixel depends on it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum LineCulling {
    /// All are drawn.
    Never,
    /// They are left out.
    Always,
    /// They are left out of views of 2^19 segments and more, and of all on software adapters.
    /// Finding them takes 0.2 ms on an NVIDIA H200 (1280 x 720), as long as it draws 400,000
    /// segments; a million streamlines then take 0.9 ms instead of 3.1.
    #[default]
    Large,
}

impl LineCulling {
    /// Whether it leaves lines out of views of so many segments.
    pub(super) fn applies(self, gpu: &Gpu, segments: u32) -> bool {
        let is_software = || gpu.adapter.get_info().device_type == DeviceType::Cpu;
        match self {
            Self::Never => false,
            Self::Always => true,
            Self::Large => segments >= LARGE_SET || is_software(),
        }
    }
}

/// How much was drawn of a view.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Drawn {
    /// Chunks of up to 64 segments.
    pub chunks: u32,
    /// Segments.
    pub segments: u32,
}

/// The buffers for so many chunks and pixels.
pub(super) struct Chunks {
    count: usize,
    size: [u32; 2],
    /// Whether each was seen.
    pub(super) shown: Buffer,
    /// Those drawn first and later, and their workgroups.
    pub(super) lists: [Buffer; 2],
    pub(super) groups: [Buffer; 2],
    counts: Buffer,
    tiles: Buffer,
}

impl Chunks {
    /// Memory on the device: 20 bytes a chunk, and 4 for each 63 pixels.
    pub(super) fn new(gpu: &Gpu, count: usize, size: [u32; 2]) -> Result<Self, GpuError> {
        let buffer = |bytes: usize, usage| gpu.buffer((bytes as u64).max(16), BufferUsages::STORAGE | usage);
        let list = || buffer(count * 8, BufferUsages::empty());
        let groups = || buffer(16, BufferUsages::INDIRECT);
        let tiles = size.map(|s| s.div_ceil(SIDE));
        let above = tiles.map(|s| s.div_ceil(SIDE));
        let all = [tiles, above].map(|[x, y]| x as usize * y as usize);
        Ok(Self {
            count,
            size,
            shown: buffer(count * 4, BufferUsages::empty())?,
            lists: [list()?, list()?],
            groups: [groups()?, groups()?],
            counts: buffer(16, BufferUsages::empty())?,
            tiles: buffer((all[0] + all[1]) * 4, BufferUsages::empty())?,
        })
    }

    /// Whether they are for so many chunks and pixels.
    pub(super) fn fit(&self, count: usize, size: [u32; 2]) -> bool {
        (self.count, self.size) == (count, size)
    }

    /// How much was drawn.
    pub(super) fn drawn(&self, gpu: &Gpu) -> Result<Drawn, GpuError> {
        let bytes = gpu.read_buffer(&self.counts)?;
        let word = |i: usize| bytes.as_chunks().0.get(i).map_or(0, |b| u32::from_le_bytes(*b));
        Ok(Drawn { chunks: word(0) + word(2), segments: word(1) + word(3) })
    }
}

/// The passes that make the two lists.
pub(super) struct Hidden {
    divide: Kernel,
    count: Kernel,
    of_pixels: Kernel,
    of_tiles: Kernel,
    examine: Kernel,
    /// The numbers of the lists.
    steps: [Buffer; 2],
}

impl Hidden {
    pub(super) fn new(gpu: &Gpu, module: &ShaderModule) -> Result<Self, GpuError> {
        let step = |value: u32| filled(gpu, &[value, 0, 0, 0], BufferUsages::UNIFORM);
        Ok(Self {
            divide: Kernel::new(gpu, module, "divide", &[1, 5, 41, 42, 43]),
            count: Kernel::new(gpu, module, "count", &[1, 43, 44]),
            of_pixels: Kernel::new(gpu, module, "of_pixels", &[0, 8, 10, 45]),
            of_tiles: Kernel::new(gpu, module, "of_tiles", &[0, 45]),
            examine: Kernel::new(gpu, module, "examine", &[0, 1, 5, 8, 10, 40, 41, 42, 43, 45]),
            steps: [step(0)?, step(1)?],
        })
    }

    /// Lists the chunks that are drawn first.
    pub(super) fn first(
        &self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        (chunks, all): (&Chunks, &[[u32; 2]]),
        list: &Buffer,
    ) {
        encoder.clear_buffer(&chunks.counts, 0, None);
        chunks.lists.iter().for_each(|list| encoder.clear_buffer(list, 0, None));
        let bound = [(5, list), (41, &chunks.shown)];
        self.list(gpu, encoder, (&self.divide, 0), (chunks, all), &bound, None);
    }

    /// Lists the others that a pixel may still show. `bound` are the lens, all chunks to be drawn,
    /// the nearest depths and the corners of the chunks.
    pub(super) fn second(
        &self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        (chunks, all): (&Chunks, &[[u32; 2]]),
        (bound, surfaces): (&[Bound<'_>], &Surfaces),
    ) {
        let own: [Bound<'_>; 2] = [(41, &chunks.shown), (45, &chunks.tiles)];
        let bound = [bound, &own[..]].concat();
        self.of_pixels.run_pixels(gpu, encoder, chunks.size, &surfaces.with(among(&bound)));
        let tiles = chunks.size.map(|s| s.div_ceil(SIDE));
        self.of_tiles.run_pixels(gpu, encoder, tiles, &among(&bound));
        self.list(gpu, encoder, (&self.examine, 1), (chunks, all), &bound, Some(surfaces));
    }

    fn list(
        &self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        (kernel, step): (&Kernel, usize),
        (chunks, all): (&Chunks, &[[u32; 2]]),
        bound: &[Bound<'_>],
        surfaces: Option<&Surfaces>,
    ) {
        let own: [Bound<'_>; 4] = [
            (1, &self.steps[step]),
            (42, &chunks.lists[step]),
            (43, &chunks.counts),
            (44, &chunks.groups[step]),
        ];
        let bound = [bound, &own[..]].concat();
        let groups = all.len().div_ceil(CHUNK as usize);
        match surfaces {
            Some(surfaces) => kernel.run_groups(gpu, encoder, groups, &surfaces.with(among(&bound))),
            None => kernel.run_groups(gpu, encoder, groups, &among(&bound)),
        }
        self.count.run(gpu, encoder, [1, 1], &among(&bound));
    }
}
