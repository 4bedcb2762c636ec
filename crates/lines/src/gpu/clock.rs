//! The time of each stage, by waiting for the queue.

use std::time::{Duration, Instant};

use casca_stage::gpu::Gpu;
use casca_stage::wgpu::{CommandEncoder, ErrorFilter};

use crate::gpu::error::LinesGpuError;

/// Submits stages, and measures them if it is asked to.
pub struct Clock {
    stages: Option<Vec<(&'static str, Duration)>>,
}

impl Clock {
    /// Measures nothing, and never waits.
    pub fn off() -> Self {
        Self { stages: None }
    }

    /// Measures all stages; each waits for the device.
    pub fn on() -> Self {
        Self { stages: Some(Vec::new()) }
    }

    /// The stages measured, in order.
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
        record: impl FnOnce(&mut CommandEncoder) -> Result<(), LinesGpuError>,
    ) -> Result<(), LinesGpuError> {
        if self.stages.is_some() {
            gpu.wait()?;
        }
        let start = Instant::now();
        // Without scopes, a device that is out of memory ends the program.
        let memory = gpu.device.push_error_scope(ErrorFilter::OutOfMemory);
        let valid = gpu.device.push_error_scope(ErrorFilter::Validation);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let recorded = record(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        let failed = [pollster::block_on(valid.pop()), pollster::block_on(memory.pop())];
        recorded?;
        if let Some(why) = failed.into_iter().flatten().next() {
            return Err(LinesGpuError::Refused { stage: name, why: why.to_string() });
        }
        if self.stages.is_some() {
            gpu.wait()?;
            self.add(name, start.elapsed());
        }
        Ok(())
    }
}
