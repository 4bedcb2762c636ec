//! The device of all tests.

use casca_stage::gpu::{Gpu, GpuError};

/// A device, unless the machine has none.
pub fn gpu() -> Option<Gpu> {
    match Gpu::headless(false) {
        Ok(gpu) => Some(gpu),
        Err(GpuError::NoAdapter(why)) => {
            println!("skipped: no adapter: {why}");
            None
        }
        Err(error) => panic!("{error}"),
    }
}
