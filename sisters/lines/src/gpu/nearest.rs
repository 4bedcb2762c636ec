//! The nearest line in each pixel, drawn twice: depths first, then the lines at them.

use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::kernel::{Bound, Kernel, among, filled};
use casca_stage::wgpu::{Buffer, BufferUsages, CommandEncoder, ShaderModule};

use crate::gpu::context::Surfaces;
use crate::gpu::hidden::{Chunks, Drawn, Hidden, LineCulling};
use crate::gpu::set::GpuLines;
use crate::gpu::shader::shader;

/// The passes.
pub(super) struct Nearest {
    draw: Kernel,
    resolve: Kernel,
    draw_thick: Kernel,
    resolve_samples: Kernel,
    hidden: Hidden,
    /// The two runs of `draw`.
    choosing: [Buffer; 2],
    /// Whether lines behind lines are left out, and whether they are in the last view.
    pub(super) culling: LineCulling,
    culls: bool,
    chunks: Option<Chunks>,
    /// How much was to be drawn of the last view.
    all: Drawn,
}

/// The buffers of pixels: the lens, the greatest keys of depths and their segments, the layers of
/// samples, fragments.
pub(super) struct Pixels<'a> {
    pub(super) size: [u32; 2],
    /// Whether pixels have samples, which the lens and the first two buffers are of.
    pub(super) has_samples: bool,
    pub(super) lens: &'a Buffer,
    pub(super) nearest: &'a Buffer,
    pub(super) owners: &'a Buffer,
    pub(super) layers: &'a Buffer,
    pub(super) fragments: &'a Buffer,
    pub(super) surfaces: &'a Surfaces,
}

impl Nearest {
    pub(super) fn new(gpu: &Gpu, raster: &ShaderModule) -> Result<Self, GpuError> {
        let hidden = shader(
            gpu,
            "hidden",
            concat!(include_str!("shaders/keys.wgsl"), include_str!("shaders/hidden.wgsl")),
        );
        let flag = |value: u32| filled(gpu, &[value, 0, 0, 0], BufferUsages::UNIFORM);
        Ok(Self {
            draw: Kernel::new(gpu, raster, "draw", &[0, 1, 2, 3, 4, 5, 8, 9, 10, 41]),
            resolve: Kernel::new(gpu, raster, "resolve", &[0, 2, 3, 9, 11, 12]),
            draw_thick: Kernel::new(gpu, raster, "draw_thick", &[0, 1, 2, 3, 4, 5, 8, 9, 10, 41]),
            resolve_samples: Kernel::new(gpu, raster, "resolve_samples", &[0, 2, 3, 9, 10, 11, 12, 28]),
            hidden: Hidden::new(gpu, &hidden)?,
            choosing: [flag(0)?, flag(1)?],
            culling: LineCulling::default(),
            culls: false,
            chunks: None,
            all: Drawn::default(),
        })
    }

    /// Buffers for the chunks of a set and the pixels of a picture. The old ones stay if they fit,
    /// even those of another set: their chunks are only a guess.
    pub(super) fn fit(
        &mut self,
        gpu: &Gpu,
        (lines, all): (&GpuLines, &[[u32; 2]]),
        size: [u32; 2],
    ) -> Result<(), GpuError> {
        let segments = all.iter().map(|chunk| chunk[1]).sum();
        self.all = Drawn { chunks: all.len() as u32, segments };
        self.culls = self.culling.applies(gpu, segments);
        let count = lines.chunk_count();
        if !self.chunks.as_ref().is_some_and(|chunks| chunks.fit(count, size)) {
            self.chunks = None;
            self.chunks = Some(Chunks::new(gpu, count, size)?);
        }
        Ok(())
    }

    /// How much was drawn of the last view.
    pub(super) fn drawn(&self, gpu: &Gpu) -> Result<Drawn, GpuError> {
        match &self.chunks {
            Some(chunks) if self.culls => chunks.drawn(gpu),
            _ => Ok(self.all),
        }
    }

    /// Finds the nearest lines among some chunks, which are in `list`, too.
    pub(super) fn run(
        &self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        (lines, all, list): (&GpuLines, &[[u32; 2]], &Buffer),
        pixels: &Pixels<'_>,
    ) {
        let Some(chunks) = &self.chunks else { return };
        [pixels.nearest, pixels.owners].into_iter().for_each(|b| encoder.clear_buffer(b, 0, None));
        let set: [Bound<'_>; 8] = [
            (0, pixels.lens),
            (2, &lines.vertices),
            (3, &lines.segments),
            (4, &lines.order),
            (8, pixels.nearest),
            (9, pixels.owners),
            (40, &lines.corners),
            (41, &chunks.shown),
        ];
        let draw = |encoder: &mut CommandEncoder, run: usize, list: &Buffer, groups: Option<&Buffer>| {
            let own: [Bound<'_>; 2] = [(1, &self.choosing[run]), (5, list)];
            let bound = [&set[..], &own[..]].concat();
            let lookup = pixels.surfaces.with(among(&bound));
            let kernel = if pixels.has_samples { &self.draw_thick } else { &self.draw };
            match groups {
                Some(groups) => kernel.run_counted(gpu, encoder, groups, &lookup),
                None => kernel.run_groups(gpu, encoder, all.len(), &lookup),
            }
        };
        if self.culls {
            let [first, second] = &chunks.lists;
            let [few, more] = &chunks.groups;
            self.hidden.first(gpu, encoder, (chunks, all), list);
            draw(encoder, 0, first, Some(few));
            let bound: [Bound<'_>; 4] =
                [(0, pixels.lens), (5, list), (8, pixels.nearest), (40, &lines.corners)];
            self.hidden.second(gpu, encoder, (chunks, all), (&bound, pixels.surfaces));
            draw(encoder, 0, second, Some(more));
            encoder.clear_buffer(&chunks.shown, 0, None);
            draw(encoder, 1, first, Some(few));
            draw(encoder, 1, second, Some(more));
        } else {
            encoder.clear_buffer(&chunks.shown, 0, None);
            draw(encoder, 0, list, None);
            draw(encoder, 1, list, None);
        }
        let bound: [Bound<'_>; 3] = [(11, &lines.tangents), (12, pixels.fragments), (28, pixels.layers)];
        let bound = [&set[..], &bound[..]].concat();
        let kernel = if pixels.has_samples { &self.resolve_samples } else { &self.resolve };
        kernel.run_pixels(gpu, encoder, pixels.size, &pixels.surfaces.with(among(&bound)));
    }
}
