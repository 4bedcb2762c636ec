//! The buffers of a frame.

use bytemuck::{Pod, Zeroable};
use casca_stage::gpu::Gpu;
use casca_stage::wgpu::{Buffer, BufferUsages};

use crate::gpu::antialiasing::Antialiasing;
use crate::gpu::context::Surfaces;
use crate::gpu::error::LinesGpuError;
use crate::gpu::lens::GpuLens;
use crate::gpu::numeric::FARTHEST;
use crate::gpu::settings::Settings;
use crate::gpu::sides::Work;
use crate::view::View;

/// `Fragment` of view.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub(super) struct GpuFragment {
    pub(super) position: [f32; 3],
    pub(super) line: u32,
    pub(super) tangent: [f32; 3],
    pub(super) along: f32,
}

/// The buffers of a frame.
pub(super) struct Frame {
    kind: Kind,
    /// One for each sample, as in the next two: for each pixel without antialiasing.
    pub(super) nearest: Buffer,
    pub(super) owners: Buffer,
    pub(super) surfaces: Surfaces,
    /// The layers of the samples of each pixel, with antialiasing.
    pub(super) layers: Buffer,
    pub(super) fragments: Buffer,
    pub(super) occlusion: Buffer,
    /// With places.
    pub(super) work: Option<Work>,
    /// That of the samples.
    pub(super) lens: Buffer,
    /// Those of the lines that were drawn, if they have colours.
    pub(super) colours: Option<Buffer>,
}

/// The settings and the view by which buffers are sized.
#[derive(PartialEq)]
struct Kind {
    size: [u32; 2],
    has_samples: bool,
    has_places: bool,
}

impl Frame {
    /// Buffers for a view: the old ones if their sizes are right. After an error there are none, or
    /// the old ones.
    pub(super) fn fit(
        old: &mut Option<Self>,
        gpu: &Gpu,
        view: &View,
        settings: &Settings,
    ) -> Result<(), LinesGpuError> {
        let [near, far] = view.depths();
        if near.abs().max(far.abs()) > FARTHEST * (far - near) {
            return Err(LinesGpuError::Depths { near, far });
        }
        let antialiasing = settings.antialiasing;
        // The view whose pixels are the samples, and half the thickness of lines in these; 0 where a
        // line shows in all pixels that it crosses.
        let (samples, thick) = match antialiasing {
            Antialiasing::None => (*view, 0.0),
            Antialiasing::Four { thickness } => {
                (view.with_height(view.size()[1].saturating_mul(2))?, thickness)
            }
        };
        let (has_samples, has_places) = (antialiasing.has_samples(), settings.by_places());
        let kind = Kind { size: view.size(), has_samples, has_places };
        if !old.as_ref().is_some_and(|f| f.kind == kind) {
            // The old ones are freed first.
            *old = None;
            *old = Some(Self::new(gpu, &samples, antialiasing, kind)?);
        }
        if let Some(frame) = old {
            let lens = GpuLens::new(&samples, thick);
            gpu.write(&frame.lens, bytemuck::cast_slice(&[lens]))?;
        }
        Ok(())
    }

    /// Whether pixels have samples.
    pub(super) fn has_samples(&self) -> bool {
        self.kind.has_samples
    }

    fn new(gpu: &Gpu, samples: &View, antialiasing: Antialiasing, kind: Kind) -> Result<Self, LinesGpuError> {
        let count = |size: [u32; 2]| size.iter().map(|&s| u64::from(s)).product::<u64>();
        let storage = BufferUsages::STORAGE;
        let of_samples = |bytes: u64| gpu.buffer(count(samples.size()) * bytes, storage);
        let layers = if kind.has_samples { count(kind.size) } else { 1 };
        // As many fragments as samples.
        let work = || Work::new(gpu, count(antialiasing.layers_of(kind.size)));
        Ok(Self {
            nearest: of_samples(4)?,
            owners: of_samples(4)?,
            surfaces: Surfaces::new(gpu, samples.size())?,
            layers: gpu.buffer(layers * 4, storage)?,
            fragments: of_samples(size_of::<GpuFragment>() as u64)?,
            occlusion: of_samples(4)?,
            work: if kind.has_places { Some(work()?) } else { None },
            lens: gpu.buffer(size_of::<GpuLens>() as u64, BufferUsages::UNIFORM)?,
            colours: None,
            kind,
        })
    }
}
