//! Fur in a pass that the application begins.

use casca_fur::gpu::error::FurGpuError;
use casca_fur::gpu::look::Look;
use casca_fur::gpu::own_pass::OwnPass;
use casca_fur::gpu::records::{DrawList, Stand, Sun};
use casca_fur::gpu::renderer::Renderer;
use casca_fur::mesh::{Mesh, Vertex};
use casca_fur::strands::Fur;
use casca_scenes::world;
use casca_stage::camera::Camera;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, DEPTH, Gpu};
use casca_stage::wgpu::{self, TextureFormat, TextureUsages};
use glam::{Affine3A, Vec3};

const SIZE: (u32, u32) = (96, 64);

fn texture(gpu: &Gpu, format: TextureFormat, samples: u32) -> wgpu::Texture {
    let copied = if samples == 1 { TextureUsages::COPY_SRC } else { TextureUsages::empty() };
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: SIZE.0, height: SIZE.1, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: samples,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: TextureUsages::RENDER_ATTACHMENT | copied,
        view_formats: &[],
    })
}

/// The picture of a pass with so many samples, over the colour of the first pixel of `sky`.
fn drawn(gpu: &Gpu, fur: &OwnPass, samples: u32, sky: &[u8]) -> Vec<u8> {
    let [colour, resolved] = [samples, 1].map(|samples| texture(gpu, COLOUR, samples));
    let depth = texture(gpu, DEPTH, samples);
    let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
    let [r, g, b] = [0, 1, 2].map(|i| f64::from(sky[i]) / 255.0);
    let resolve = (samples > 1).then(|| view(&resolved));
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &view(&colour),
            depth_slice: None,
            resolve_target: resolve.as_ref(),
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 }),
                store: wgpu::StoreOp::Store,
            },
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
    fur.draw(&mut pass);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    gpu.read(if samples > 1 { &resolved } else { &colour }).unwrap()
}

#[test]
fn a_pass_of_ones_own_shows_what_the_renderer_shows() {
    let Ok(gpu) = Gpu::headless(false) else { return println!("skipped: no adapter") };
    let ball = world::Mesh::ball(3);
    let vertices = ball.positions.iter().map(|&p| Vertex { position: p, normal: p }).collect();
    let meshes = [Mesh::new(vertices, Vec::new(), ball.triangles).unwrap()];
    let look = Look::new(Fur::for_radius(1.0, 0.2, 0.4).unwrap());
    let camera = Camera::look_at(Vec3::Z * 4.0, Vec3::ZERO, 45.0, 1.5, 0.1, 20.0);
    let stand = Stand { mesh: 0, place: Affine3A::IDENTITY, root: [0.4, 0.2, 0.1], tip: [1.0, 0.5, 0.2] };
    let list = DrawList::new(&[(stand, 6)], Vec::new());
    let sun = Sun { towards: Vec3::ONE, center: Vec3::ZERO, radius: 2.0, shadows: true };

    let mut renderer = Renderer::new(&gpu, COLOUR, &meshes, &look).unwrap();
    let canvas = Canvas::new(&gpu, SIZE);
    renderer.cast_shadows(&gpu, &list, &sun).unwrap();
    renderer.draw(&gpu, &canvas.picture(), &camera, &list, &sun).unwrap();
    let want = canvas.read_picture(&gpu).unwrap();
    let same = |p: &[u8]| p.chunks(4).zip(want.chunks(4)).filter(|(a, b)| a == b).count();
    let sky = want.chunks(4).filter(|p| *p == &want[..4]).count();
    assert!(sky > 1000 && sky < 5000, "the ball covers a part: {sky}");

    for samples in [1, 4] {
        let mut fur = OwnPass::new(&gpu, COLOUR, samples, &meshes, &look).unwrap();
        let empty = drawn(&gpu, &fur, samples, &want);
        assert_eq!(same(&empty), sky, "nothing before it is prepared");
        fur.cast_shadows(&gpu, &list, &sun).unwrap();
        fur.prepare(&gpu, &camera, SIZE.1, &list, &sun).unwrap();
        let got = drawn(&gpu, &fur, samples, &want);
        if samples == 1 {
            assert!(got == want, "one sample: the same, pixel by pixel");
        } else {
            // Outlines differ, where some of the samples are of the sky.
            let others = 96 * 64 - same(&got);
            println!("{others} pixels differ with 4 samples");
            assert!(others > 50 && others < 3000, "{others}");
        }
    }
    for (format, samples) in [(TextureFormat::Rgba8UnormSrgb, 1), (COLOUR, 3), (COLOUR, 0), (DEPTH, 1)] {
        let refused = OwnPass::new(&gpu, format, samples, &meshes, &look);
        assert!(matches!(refused, Err(FurGpuError::Pass { .. })), "{format:?} {samples}");
    }
}
