//! A furry ball in a render pass of the application's own, on its own device, with four samples a
//! pixel and without a window: `cargo run -p casca-fur --features gpu --example own_pass`.

use std::error::Error;

use casca_fur::gpu::look::Look;
use casca_fur::gpu::records::{DrawList, Stand, Sun};
use casca_fur::gpu::renderer::Renderer;
use casca_fur::mesh::{Mesh, Vertex};
use casca_fur::strands::Fur;
use casca_stage::gpu::{DEPTH, Gpu};
use casca_stage::wgpu::{self, TextureFormat, TextureUsages};
use casca_tools::camera::Camera;
use casca_tools::image::write_png;
use glam::{Affine3A, Vec3};

const SIZE: (u32, u32) = (320, 240);
const SAMPLES: u32 = 4;
const FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;

/// The picture of a pass of the application, with so many samples over a colour.
pub fn drawn(
    gpu: &Gpu,
    fur: &Renderer,
    (width, height): (u32, u32),
    samples: u32,
    sky: wgpu::Color,
) -> Result<Vec<u8>, Box<dyn Error>> {
    let texture = |format, samples| {
        let copied = if samples == 1 { TextureUsages::COPY_SRC } else { TextureUsages::empty() };
        gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: TextureUsages::RENDER_ATTACHMENT | copied,
            view_formats: &[],
        })
    };
    let [colour, resolved] = [samples, 1].map(|samples| texture(FORMAT, samples));
    let depth = texture(DEPTH, samples);
    let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
    let resolve = (samples > 1).then(|| view(&resolved));
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &view(&colour),
            depth_slice: None,
            resolve_target: resolve.as_ref(),
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(sky), store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &view(&depth),
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(0.0),
                store: wgpu::StoreOp::Discard,
            }),
            stencil_ops: None,
        }),
        ..Default::default()
    });
    fur.draw_in(&mut pass);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    Ok(gpu.read(if samples > 1 { &resolved } else { &colour })?)
}

fn main() -> Result<(), Box<dyn Error>> {
    // The device of the application. Fur takes clones of its handles.
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let wanted = wgpu::RequestAdapterOptions::default();
    let Ok(adapter) = pollster::block_on(instance.request_adapter(&wanted)) else {
        println!("skipped: no adapter");
        return Ok(());
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&Default::default()))?;
    let gpu = Gpu::new(adapter, device, queue);

    let ball = casca_scenes::world::Mesh::ball(4);
    let vertices = ball.positions.iter().map(|&p| Vertex { position: p, normal: p }).collect();
    let meshes = [Mesh::new(vertices, Vec::new(), ball.triangles)?];
    let look = Look::new(Fur::for_radius(1.0, 0.15, 0.4)?);
    let mut fur = Renderer::for_pass(&gpu, FORMAT, SAMPLES, &meshes, &look)?;

    let aspect = SIZE.0 as f32 / SIZE.1 as f32;
    let camera = Camera::look_at(Vec3::new(0.5, 1.0, 3.2), Vec3::ZERO, 45.0, aspect, 0.1, 20.0);
    let stand = Stand { mesh: 0, place: Affine3A::IDENTITY, root: [0.3, 0.15, 0.05], tip: [0.9, 0.6, 0.3] };
    let list = DrawList::new(&[(stand, 24)], Vec::new());
    let sun = Sun { towards: Vec3::ONE, center: Vec3::ZERO, radius: 2.0, shadows: true };
    fur.cast_shadows(&gpu, &list, &sun)?;
    fur.prepare(&gpu, &camera, SIZE.1, &list, &sun)?;
    let pixels = drawn(&gpu, &fur, SIZE, SAMPLES, wgpu::Color::WHITE)?;
    let shown = pixels.chunks(4).filter(|p| *p != [255; 4]).count();
    println!("{shown} of {} pixels show fur", SIZE.0 * SIZE.1);
    if let Some(path) = std::env::args_os().nth(1) {
        write_png(std::path::Path::new(&path), SIZE, &pixels)?;
    }
    Ok(())
}
