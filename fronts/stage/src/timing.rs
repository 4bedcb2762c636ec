//! The time of each stage, by waiting for the queue.

use std::time::Duration;

use wgpu::{CommandEncoder, ErrorFilter};

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
        let submit = || {
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            record(&mut encoder);
            gpu.queue.submit([encoder.finish()]);
        };
        let Some(stages) = &mut self.stages else { return checked(gpu, name, submit) };
        gpu.wait()?;
        let start = Instant::now();
        checked(gpu, name, submit)?;
        gpu.wait()?;
        stages.push((name, start.elapsed()));
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
