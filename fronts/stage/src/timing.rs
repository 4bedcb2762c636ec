//! The time of each stage: by timestamps of a graphics processor that has them, else by waiting for
//! the queue.

use std::time::Duration;

use wgpu::{BufferUsages, CommandEncoder, ErrorFilter, Features};

use crate::gpu::{Gpu, GpuError};
use crate::scope::refused;

/// The clock, in pages, too.
pub use web_time::Instant;

/// Submits stages, and measures them if it is asked to.
pub struct Clock {
    stages: Option<Vec<(&'static str, Duration)>>,
}

impl Clock {
    /// Measures nothing, and never waits.
    pub fn off() -> Self {
        Self { stages: None }
    }

    /// Measures all stages.
    pub fn on() -> Self {
        Self { stages: Some(Vec::new()) }
    }

    /// The stages measured, in order; one that ran twice is there twice.
    pub fn stages(&self) -> &[(&'static str, Duration)] {
        self.stages.as_deref().unwrap_or_default()
    }

    /// Adds the time of work on the processor.
    pub fn add(&mut self, name: &'static str, time: Duration) {
        if let Some(stages) = &mut self.stages {
            stages.push((name, time));
        }
    }

    /// Submits the commands of a stage.
    ///
    /// # Errors
    /// The device is lost, out of memory, or refuses the commands.
    pub fn stage(
        &mut self,
        gpu: &Gpu,
        name: &'static str,
        record: impl FnOnce(&mut CommandEncoder),
    ) -> Result<(), GpuError> {
        let Some(stages) = &mut self.stages else {
            return checked(gpu, name, || {
                let mut encoder = gpu.device.create_command_encoder(&Default::default());
                record(&mut encoder);
                gpu.queue.submit([encoder.finish()]);
            });
        };
        gpu.wait()?;
        let stamps = has_timestamps(gpu).then(|| Stamps::new(gpu));
        let start = Instant::now();
        checked(gpu, name, || {
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            if let Some(stamps) = &stamps {
                stamps.write(&mut encoder, 0);
            }
            record(&mut encoder);
            if let Some(stamps) = &stamps {
                stamps.write(&mut encoder, 1);
                encoder.resolve_query_set(&stamps.set, 0..2, &stamps.buffer, 0);
            }
            gpu.queue.submit([encoder.finish()]);
        })?;
        gpu.wait()?;
        let waited = start.elapsed();
        let measured = stamps.map(|stamps| stamps.read(gpu)).transpose()?.flatten();
        stages.push((name, measured.unwrap_or(waited)));
        Ok(())
    }
}

/// Does what the device may refuse. Without scopes, a device that is out of memory ends the
/// program.
fn checked(gpu: &Gpu, stage: &'static str, work: impl FnOnce()) -> Result<(), GpuError> {
    let ((), failed) =
        refused((&gpu.device, &gpu.trouble), &[ErrorFilter::OutOfMemory, ErrorFilter::Validation], work);
    match failed {
        Some(why) => Err(GpuError::Refused { stage, why: why.to_string() }),
        None => Ok(()),
    }
}

/// Whether timestamps tell when work was done. Software adapters write them when it is recorded:
/// Mesa's gives microseconds for any dispatch.
fn has_timestamps(gpu: &Gpu) -> bool {
    let is_software = gpu.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
    !is_software && gpu.device.features().contains(Features::TIMESTAMP_QUERY)
}

/// Two timestamps.
struct Stamps {
    set: wgpu::QuerySet,
    buffer: wgpu::Buffer,
}

impl Stamps {
    fn new(gpu: &Gpu) -> Self {
        let (ty, count) = (wgpu::QueryType::Timestamp, 2);
        Self {
            set: gpu.device.create_query_set(&wgpu::QuerySetDescriptor { label: None, ty, count }),
            buffer: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: 16,
                usage: BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
        }
    }

    /// Writes one at the end of an empty pass, after all that was recorded.
    fn write(&self, encoder: &mut CommandEncoder, index: u32) {
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: None,
            timestamp_writes: Some(wgpu::ComputePassTimestampWrites {
                query_set: &self.set,
                beginning_of_pass_write_index: None,
                end_of_pass_write_index: Some(index),
            }),
        });
    }

    /// The time between them; `None` if the device wrote none.
    fn read(&self, gpu: &Gpu) -> Result<Option<Duration>, GpuError> {
        let bytes = gpu.read_buffer(&self.buffer)?;
        let ticks: Vec<u64> = bytes.as_chunks().0.iter().map(|b| u64::from_le_bytes(*b)).collect();
        let span = ticks[1].checked_sub(ticks[0]).filter(|t| *t > 0);
        let nanoseconds = span.map(|t| t as f64 * f64::from(gpu.queue.get_timestamp_period()));
        Ok(nanoseconds.map(|n| Duration::from_nanos(n as u64)))
    }
}
