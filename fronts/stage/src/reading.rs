//! Reading back from the device, without waiting for it.

use std::fmt::Display;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use crate::gpu::GpuError;

/// Bytes that are on their way from the device.
pub struct Reading {
    buffer: wgpu::Buffer,
    /// The bytes of a row, and from one row to the next.
    rows: (usize, usize),
    done: Receiver<Result<(), wgpu::BufferAsyncError>>,
}

impl Reading {
    /// Asks for all of a buffer.
    pub(crate) fn new(buffer: wgpu::Buffer, rows: (usize, usize)) -> Self {
        let (send, done) = channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            // Nobody listens if it is no longer wanted.
            let _ = send.send(result);
        });
        Self { buffer, rows, done }
    }

    /// The bytes; `None` if they are not there yet. They are there after
    /// [`crate::gpu::Gpu::wait`], in a page some frames later. They are given once.
    pub fn take(&self) -> Option<Result<Vec<u8>, GpuError>> {
        match self.done.try_recv() {
            Err(TryRecvError::Empty) => None,
            Err(why @ TryRecvError::Disconnected) => Some(Err(failed(&why))),
            Ok(Err(why)) => Some(Err(failed(&why))),
            Ok(Ok(())) => Some(self.bytes()),
        }
    }

    fn bytes(&self) -> Result<Vec<u8>, GpuError> {
        let mapped = self.buffer.get_mapped_range(..).map_err(|e| failed(&e))?;
        let (row, stride) = self.rows;
        if row == stride {
            return Ok(mapped.to_vec());
        }
        let mut bytes = Vec::with_capacity(mapped.len() / stride * row);
        mapped.chunks_exact(stride).for_each(|line| bytes.extend_from_slice(&line[..row]));
        Ok(bytes)
    }
}

/// What was read after a wait for the device. A page cannot wait: there it is an error.
///
/// # Errors
/// It is not there, and those of reading.
pub fn waited_for<T>(read: Option<Result<T, GpuError>>) -> Result<T, GpuError> {
    read.unwrap_or_else(|| Err(GpuError::Read("a page cannot wait for it".to_owned())))
}

fn failed(why: &dyn Display) -> GpuError {
    GpuError::Read(why.to_string())
}
