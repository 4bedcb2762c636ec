//! The passes of rays through cells.

use casca_stage::gpu::Gpu;
use casca_stage::kernel::{Bound, Kernel, among};
use casca_stage::wgpu::CommandEncoder;

use crate::gpu::grid::{SPLIT, WHOLE};
use crate::gpu::shader::shader;
use crate::gpu::sides::Passes;

/// The pixels of a workgroup, as in rays.wgsl.
const TILE: [u32; 2] = [4, 2];

/// Rays from pixels and from places.
pub(super) struct Rays {
    trace: Kernel,
    pub(super) places: Passes,
}

impl Rays {
    /// Through cells in one buffer for each array, or through cells that are split into parts.
    pub(super) fn new(gpu: &Gpu, is_split: bool) -> Self {
        let (cells, bindings) = match is_split {
            true => (include_str!("shaders/parts.wgsl"), SPLIT),
            false => (include_str!("shaders/cells.wgsl"), WHOLE),
        };
        let others = concat!(
            include_str!("shaders/receiver.wgsl"),
            include_str!("shaders/rays.wgsl"),
            include_str!("shaders/sides.wgsl")
        );
        let module = shader(gpu, "rays", &format!("{cells}{others}"));
        Self {
            trace: Kernel::new(gpu, &module, "trace", &[&[0, 12, 15, 16, 17][..], bindings].concat()),
            places: Passes::new(gpu, &module, bindings),
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
