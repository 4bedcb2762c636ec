//! The passes of rays through cells.

use casca_stage::gpu::Gpu;
use casca_stage::kernel::{Bound, Kernel, among};
use casca_stage::wgpu::CommandEncoder;

use crate::gpu::grid::CELLS;
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
