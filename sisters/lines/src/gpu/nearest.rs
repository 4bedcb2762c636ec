//! The nearest line in each pixel, drawn twice: depths first, then the lines at them.

use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::kernel::{Bound, Kernel, among, filled};
use casca_stage::wgpu::{Buffer, BufferUsages, CommandEncoder, ShaderModule};

use crate::gpu::frame::Frame;
use crate::gpu::set::GpuLines;

/// The passes.
pub(super) struct Nearest {
    /// Without and with samples, as `resolve`.
    draw: [Kernel; 2],
    resolve: [Kernel; 2],
    /// The two runs of `draw`.
    choosing: [Buffer; 2],
}

impl Nearest {
    pub(super) fn new(gpu: &Gpu, raster: &ShaderModule) -> Result<Self, GpuError> {
        let flag = |value: u32| filled(gpu, &[value, 0, 0, 0], BufferUsages::UNIFORM);
        let kernel = |entry, bindings: &[u32]| Kernel::new(gpu, raster, entry, bindings);
        Ok(Self {
            draw: ["draw", "draw_thick"].map(|entry| kernel(entry, &[0, 1, 2, 3, 4, 5, 8, 9, 10])),
            resolve: [
                kernel("resolve", &[0, 2, 3, 9, 11, 12]),
                kernel("resolve_samples", &[0, 2, 3, 9, 10, 11, 12, 28]),
            ],
            choosing: [flag(0)?, flag(1)?],
        })
    }

    /// Finds the nearest lines among some chunks in a picture of a size.
    pub(super) fn run(
        &self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        (lines, chunks, count): (&GpuLines, &Buffer, usize),
        (frame, size): (&Frame, [u32; 2]),
    ) {
        let which = usize::from(frame.has_samples());
        [&frame.nearest, &frame.owners].into_iter().for_each(|b| encoder.clear_buffer(b, 0, None));
        for choosing in &self.choosing {
            let bound: [Bound<'_>; 8] = [
                (0, &frame.lens),
                (1, choosing),
                (2, &lines.vertices),
                (3, &lines.segments),
                (4, &lines.order),
                (5, chunks),
                (8, &frame.nearest),
                (9, &frame.owners),
            ];
            self.draw[which].run_groups(gpu, encoder, count, &frame.surfaces.with(among(&bound)));
        }
        let bound: [Bound<'_>; 7] = [
            (0, &frame.lens),
            (2, &lines.vertices),
            (3, &lines.segments),
            (9, &frame.owners),
            (11, &lines.tangents),
            (12, &frame.fragments),
            (28, &frame.layers),
        ];
        self.resolve[which].run_pixels(gpu, encoder, size, &frame.surfaces.with(among(&bound)));
    }
}
