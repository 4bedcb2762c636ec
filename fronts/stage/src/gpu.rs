//! The graphics device, pictures drawn without a window, and reading them back.

use std::fmt::Display;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use wgpu::{Texture, TextureFormat, TextureUsages};

use crate::scope::{Trouble, refused};

/// Format of pictures: 8 bits a channel, stored as drawn.
pub const COLOUR: TextureFormat = TextureFormat::Rgba8Unorm;
/// Format of item buffers.
pub const ITEMS: TextureFormat = TextureFormat::R32Uint;
/// Format of depth: 1 at the near plane, 0 at infinity.
pub const DEPTH: TextureFormat = TextureFormat::Depth32Float;

/// Features of the device, as far as the adapter has them.
const USEFUL: wgpu::Features = wgpu::Features::FLOAT32_FILTERABLE
    .union(wgpu::Features::SHADER_INT64)
    .union(wgpu::Features::SHADER_INT64_ATOMIC_MIN_MAX);

/// Whether this is a page of a browser. There the device answers only after the program has
/// returned, and the page shows the report of a program in place of a panel.
pub const IS_PAGE: bool = cfg!(target_arch = "wasm32");

/// Why nothing can be drawn.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// The machine has no adapter that serves; with the words of the graphics library.
    #[error("no graphics adapter: {} is needed; a software one will do", if IS_PAGE { "WebGPU or WebGL 2" } else { "a Vulkan, Metal or Direct3D 12 driver" })]
    NoAdapter(String),
    /// The adapter gives no device.
    #[error("the graphics adapter gives no device: {0}")]
    NoDevice(String),
    /// The adapter has no room for a buffer.
    #[error("the graphics adapter has no room for {bytes} bytes in one buffer (its limit is {most})")]
    NoRoom {
        /// The size of the buffer.
        bytes: u64,
        /// The largest buffer that shaders can be given.
        most: u64,
    },
    /// The device refused commands.
    #[error("the graphics device refused {stage}: {why}")]
    Refused {
        /// The stage.
        stage: &'static str,
        /// The device's words.
        why: String,
    },
    /// A picture cannot be read back.
    #[error("the picture cannot be read back: {0}")]
    Read(String),
}

/// A device and its queue.
pub struct Gpu {
    /// What the adapter calls itself.
    pub name: String,
    /// The adapter.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// What it told after the work that it was about.
    pub(crate) trouble: Trouble,
}

impl Gpu {
    /// A device without a window; `software` takes none but a software adapter.
    ///
    /// # Errors
    /// Says what is missing.
    pub fn headless(software: bool) -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        pollster::block_on(Self::request(&instance, None, software))
    }

    /// The device of a test, without a window. Without an adapter `None`, and a line that says so:
    /// the test is skipped.
    ///
    /// # Panics
    /// If there is an adapter and no device can be had, or if the environment variable
    /// `CASCA_ADAPTER` is set and there is none: a test must not pass without a look.
    pub fn for_tests() -> Option<Self> {
        match Self::headless(false) {
            Ok(gpu) => Some(gpu),
            Err(GpuError::NoAdapter(why)) if std::env::var_os("CASCA_ADAPTER").is_none() => {
                println!("skipped: no adapter: {why}");
                None
            }
            Err(error) => panic!("{error}"),
        }
    }

    /// A device that can draw to `surface`, if one is given. It has all limits of the adapter.
    ///
    /// # Errors
    /// Says what is missing.
    pub async fn request(
        instance: &wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
        software: bool,
    ) -> Result<Self, GpuError> {
        let wanted = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            force_fallback_adapter: software,
            compatible_surface: surface,
            ..Default::default()
        };
        let adapter = instance.request_adapter(&wanted).await;
        let adapter = adapter.map_err(|e| GpuError::NoAdapter(e.to_string()))?;
        let wanted = wgpu::DeviceDescriptor {
            label: Some("stage"),
            required_features: adapter.features() & USEFUL,
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let made = adapter.request_device(&wanted).await;
        let (device, queue) = made.map_err(|e| GpuError::NoDevice(e.to_string()))?;
        Ok(Self::new(adapter, device, queue))
    }

    /// A device that is there already, with its adapter and queue.
    pub fn new(adapter: wgpu::Adapter, device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let (name, trouble) = (called(&adapter.get_info()), Trouble::of(&device));
        Self { name, adapter, device, queue, trouble }
    }

    /// What the device has told since the last call about work that was done before: that it is
    /// lost, for instance. Only a page must ask; elsewhere such trouble comes with the work.
    pub fn trouble(&self) -> Option<String> {
        self.trouble.take()
    }

    /// Whether it runs compute shaders. WebGL has none.
    pub fn computes(&self) -> bool {
        let able = self.adapter.get_downlevel_capabilities().flags;
        able.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS)
    }

    /// The picture sizes that can be drawn.
    pub fn clamp(&self, (width, height): (u32, u32)) -> (u32, u32) {
        let most = self.device.limits().max_texture_dimension_2d;
        (width.clamp(1, most), height.clamp(1, most))
    }

    /// A texture to draw to, to read back from and to give to shaders.
    pub fn texture(&self, size: (u32, u32), format: TextureFormat) -> Texture {
        self.texture_for(size, format, TextureUsages::RENDER_ATTACHMENT)
    }

    /// The same for another use than to draw to.
    pub fn texture_for(&self, size: (u32, u32), format: TextureFormat, usage: TextureUsages) -> Texture {
        let (width, height) = self.clamp(size);
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usage | TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    }

    /// A buffer of `bytes` zeros, to copy to and from.
    ///
    /// # Errors
    /// It is larger than the adapter's limits, or than its memory.
    pub fn buffer(&self, bytes: u64, usage: wgpu::BufferUsages) -> Result<wgpu::Buffer, GpuError> {
        let limits = self.device.limits();
        let most = if usage.contains(wgpu::BufferUsages::STORAGE) {
            limits.max_buffer_size.min(limits.max_storage_buffer_binding_size)
        } else {
            limits.max_buffer_size
        };
        let usage = usage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        self.with_room([bytes, most], || {
            let least = wgpu::COPY_BUFFER_ALIGNMENT;
            self.device.create_buffer(&unmapped(bytes.next_multiple_of(least).max(least), usage))
        })
    }

    /// Writes to the start of a buffer of [`Self::buffer`].
    ///
    /// # Errors
    /// There is no room for a copy on the way to the device.
    pub fn write(&self, buffer: &wgpu::Buffer, bytes: &[u8]) -> Result<(), GpuError> {
        let limits = [bytes.len() as u64, self.device.limits().max_buffer_size];
        self.with_room(limits, || self.queue.write_buffer(buffer, 0, bytes))
    }

    /// Does what takes so many bytes of at most so many.
    fn with_room<T>(&self, [bytes, most]: [u64; 2], work: impl FnOnce() -> T) -> Result<T, GpuError> {
        let refused = GpuError::NoRoom { bytes, most };
        if bytes > most { Err(refused) } else { self.try_room(work).ok_or(refused) }
    }

    /// Does what takes memory of the device; `None` if it has none left. Without this, a device
    /// that is out of memory ends the program. In a page it is [`Self::trouble`] that tells.
    pub fn try_room<T>(&self, work: impl FnOnce() -> T) -> Option<T> {
        let (done, error) = refused((&self.device, &self.trouble), &[wgpu::ErrorFilter::OutOfMemory], work);
        error.is_none().then_some(done)
    }

    /// A buffer for reading back.
    fn readable(&self, bytes: u64) -> Result<wgpu::Buffer, GpuError> {
        let most = self.device.limits().max_buffer_size;
        let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
        self.with_room([bytes, most], || self.device.create_buffer(&unmapped(bytes, usage)))
    }

    /// Waits until all that was submitted is done. In a page nothing can be waited for: it goes on.
    ///
    /// # Errors
    /// The device is lost.
    pub fn wait(&self) -> Result<(), GpuError> {
        let whether = if IS_PAGE { wgpu::PollType::Poll } else { wgpu::PollType::wait_indefinitely() };
        let done = self.device.poll(whether);
        done.map(|_| ()).map_err(|e| GpuError::Read(e.to_string()))
    }

    /// The pixels of a texture of four bytes a pixel, row by row from the top.
    ///
    /// # Errors
    /// The device is lost or out of memory, or this is a page.
    pub fn read(&self, texture: &Texture) -> Result<Vec<u8>, GpuError> {
        let reading = self.read_later(texture)?;
        self.wait()?;
        waited_for(reading.take())
    }

    /// Begins to read the pixels of a texture.
    ///
    /// # Errors
    /// The device is out of memory.
    pub fn read_later(&self, texture: &Texture) -> Result<Reading, GpuError> {
        let (width, height) = (texture.width(), texture.height());
        // Depth and compressed formats have no such size; pictures have neither.
        let bytes = texture.format().block_copy_size(None).unwrap_or(4);
        let row = (width * bytes) as usize;
        let stride = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
        let buffer = self.readable((stride * height as usize) as u64)?;
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(stride as u32),
                    rows_per_image: None,
                },
            },
            texture.size(),
        );
        self.queue.submit([encoder.finish()]);
        Ok(Reading::new(buffer, (row, stride)))
    }

    /// The bytes of a buffer that may be copied from.
    ///
    /// # Errors
    /// The device is lost or out of memory.
    pub fn read_buffer(&self, buffer: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
        let copy = self.readable(buffer.size())?;
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, buffer.size());
        self.queue.submit([encoder.finish()]);
        let reading = Reading::new(copy, (1, 1));
        self.wait()?;
        waited_for(reading.take())
    }
}

/// The name of an adapter. Browsers do not tell all of them.
fn called(info: &wgpu::AdapterInfo) -> String {
    let name = if info.name.is_empty() { "an adapter without a name" } else { &info.name };
    if IS_PAGE { format!("{name}, {}", info.backend) } else { name.to_owned() }
}

fn unmapped(size: u64, usage: wgpu::BufferUsages) -> wgpu::BufferDescriptor<'static> {
    wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false }
}

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
    /// [`Gpu::wait`], in a page some frames later. They are given once.
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

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::util::DeviceExt;

    #[test]
    fn a_buffer_beyond_the_limits_is_an_error() {
        let Some(gpu) = Gpu::for_tests() else { return };
        let most = gpu.device.limits().max_buffer_size;
        let error = gpu.buffer(most + 1, wgpu::BufferUsages::STORAGE).unwrap_err();
        assert!(matches!(error, GpuError::NoRoom { bytes, .. } if bytes == most + 1), "{error}");
        assert_eq!(gpu.buffer(7, wgpu::BufferUsages::STORAGE).unwrap().size(), 8);
        let error = gpu.readable(most + 1).unwrap_err();
        assert!(matches!(error, GpuError::NoRoom { bytes, .. } if bytes == most + 1), "{error}");
    }

    #[test]
    fn a_buffer_is_read_as_it_was_written() {
        let Some(gpu) = Gpu::for_tests() else { return };
        let contents: Vec<u8> = (0..1024_u32).map(|i| i as u8).collect();
        let buffer = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: &contents,
            usage: wgpu::BufferUsages::COPY_SRC,
        });
        assert_eq!(gpu.read_buffer(&buffer).unwrap(), contents);
        let written = gpu.buffer(8, wgpu::BufferUsages::STORAGE).unwrap();
        gpu.write(&written, &contents[4..8]).unwrap();
        assert_eq!(gpu.read_buffer(&written).unwrap(), [4, 5, 6, 7, 0, 0, 0, 0]);
    }
}
