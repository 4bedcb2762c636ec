//! The occlusion on the sides of places along lines, which stays on the device from frame to frame.

use std::sync::{Mutex, PoisonError};

use casca_stage::gpu::{Gpu, GpuError};
use casca_stage::kernel::{Bound, Kernel, among, filled};
use casca_stage::timing::Clock;
use casca_stage::wgpu::{Buffer, BufferUsages, ShaderModule};

use crate::gpu::settings::Settings;
use crate::numeric::SIDES;
use crate::occlusion::AoOptions;
use crate::places::Places;

/// The bindings of cells, as in rays.wgsl.
pub(super) const CELLS: [u32; 4] = [19, 20, 21, 22];
/// Numbers before the list of work, as in sides.wgsl.
const WORK: u64 = 4;

/// The values of the places of a set.
pub(super) struct GpuSides {
    places: Buffer,
    /// Where the tangents begin in `places`.
    tangents: u32,
    step: f32,
    count: u32,
    values: Buffer,
    asked: Buffer,
    /// The settings for which the values on the device were computed.
    known: Mutex<Option<Known>>,
}

/// The settings that values depend on.
type Known = (AoOptions, [u32; 2]);

impl GpuSides {
    /// Places that are `step` apart.
    pub(super) fn new(gpu: &Gpu, places: &Places, step: f32) -> Result<Self, GpuError> {
        let spans = places.spans().iter().flat_map(|s| [s.vertex, s.last_vertex, s.place, s.steps]);
        let mut table: Vec<u32> = spans.collect();
        let tangents = table.len() as u32;
        table.extend(places.tangents());
        let values = u64::from(places.count()) * u64::from(SIDES);
        let bytes = |bits: u64| (values * bits).div_ceil(32).max(4) * 4;
        Ok(Self {
            places: filled(gpu, &table, BufferUsages::STORAGE)?,
            tangents,
            step,
            count: places.count(),
            values: gpu.buffer(bytes(8), BufferUsages::STORAGE)?,
            asked: gpu.buffer(bytes(1), BufferUsages::STORAGE)?,
            known: Mutex::new(None),
        })
    }

    /// The number of places.
    pub(super) fn count(&self) -> u32 {
        self.count
    }

    /// The memory on the device in bytes.
    pub(super) fn bytes(&self) -> u64 {
        [&self.places, &self.values, &self.asked].map(Buffer::size).iter().sum()
    }

    /// The way from place to place that they were made for.
    pub(super) fn step(&self) -> f32 {
        self.step
    }

    /// Where the tangents of places begin in their buffer.
    pub(super) fn tangents(&self) -> u32 {
        self.tangents
    }

    /// The next frame computes all values anew.
    pub(super) fn forget(&self) {
        *self.known.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }

    /// Whether values must be computed anew; from then on they are those of these settings.
    fn is_new(&self, settings: &Settings) -> bool {
        let Settings { ao, samples, sets, .. } = *settings;
        let now = Some((ao, [samples, sets]));
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        std::mem::replace(&mut *known, now) != now
    }
}

/// The list of values that a frame computes.
pub(super) struct Work {
    list: Buffer,
    groups: Buffer,
}

impl Work {
    /// For so many pixels.
    pub(super) fn new(gpu: &Gpu, pixels: u64) -> Result<Self, GpuError> {
        Ok(Self {
            // Four values of each pixel at most.
            list: gpu.buffer((WORK + 4 * pixels) * 4, BufferUsages::STORAGE)?,
            groups: gpu.buffer(16, BufferUsages::STORAGE | BufferUsages::INDIRECT)?,
        })
    }

    /// The number of values that the last frame computed.
    pub(super) fn computed(&self, gpu: &Gpu) -> Result<u32, GpuError> {
        let bytes = gpu.read_buffer(&self.list)?;
        Ok(bytes.first_chunk().map_or(0, |b| u32::from_le_bytes(*b)))
    }
}

/// The passes.
pub(super) struct Passes {
    ask: Kernel,
    count: Kernel,
    trace: Kernel,
    shade: Kernel,
}

impl Passes {
    pub(super) fn new(gpu: &Gpu, module: &ShaderModule) -> Self {
        let trace = [&[2, 15, 16, 23, 24, 26][..], &CELLS].concat();
        Self {
            ask: Kernel::new(gpu, module, "ask", &[0, 2, 12, 16, 23, 25, 26]),
            count: Kernel::new(gpu, module, "count", &[26, 27]),
            trace: Kernel::new(gpu, module, "trace_sides", &trace),
            shade: Kernel::new(gpu, module, "shade", &[0, 2, 12, 16, 17, 23, 24]),
        }
    }

    /// Computes what pixels ask for and nobody did before, and the occlusion of the pixels. `bound`
    /// are the lens, the vertices, fragments, samples, settings, the occlusion and the cells.
    pub(super) fn run(
        &self,
        gpu: &Gpu,
        (sides, work): (&GpuSides, &Work),
        settings: &Settings,
        (bound, size): (&[Bound<'_>], [u32; 2]),
        clock: &mut Clock,
    ) -> Result<(), GpuError> {
        let own: [Bound<'_>; 5] = [
            (23, &sides.places),
            (24, &sides.values),
            (25, &sides.asked),
            (26, &work.list),
            (27, &work.groups),
        ];
        let all = [bound, &own[..]].concat();
        let lookup = among(&all);
        let asked = clock.stage(gpu, "places asked for", |encoder| {
            if sides.is_new(settings) {
                encoder.clear_buffer(&sides.values, 0, None);
                encoder.clear_buffer(&sides.asked, 0, None);
            }
            encoder.clear_buffer(&work.list, 0, Some(WORK * 4));
            self.ask.run_pixels(gpu, encoder, size, &lookup);
            self.count.run(gpu, encoder, [1, 1], &lookup);
        });
        // Values that were asked for and not computed would stay 0.
        let traced = asked.and_then(|()| {
            clock.stage(gpu, "rays of places", |encoder| {
                self.trace.run_counted(gpu, encoder, &work.groups, &lookup);
            })
        });
        if traced.is_err() {
            sides.forget();
        }
        traced?;
        clock.stage(gpu, "occlusion", |encoder| self.shade.run_pixels(gpu, encoder, size, &lookup))
    }
}
