//! Fur in a pass that the application begins.

use casca_fur::gpu::error::FurGpuError;
use casca_fur::gpu::look::Look;
use casca_fur::gpu::own_pass::OwnPass;
use casca_fur::gpu::records::{DrawList, Stand, Sun};
use casca_fur::gpu::renderer::Renderer;
use casca_fur::mesh::{Mesh, Vertex};
use casca_fur::skin::{Channel, Clip, Ending, Interpolation, Joint, Pose, Skeleton, Track, Weights};
use casca_fur::strands::{Fur, Lean};
use casca_scenes::world;
use casca_stage::canvas::Canvas;
use casca_stage::gpu::{COLOUR, DEPTH, Gpu};
use casca_stage::wgpu::{self, TextureFormat, TextureUsages};
use casca_tools::camera::Camera;
use glam::{Affine3A, Quat, Vec3};

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

/// Weights by which the upper half of a mesh follows a joint, and a pose that turns the joint.
fn nodding(mesh: &Mesh) -> (Weights, Pose) {
    let skeleton = Skeleton::new(vec![Joint::at(None, Vec3::ZERO), Joint::at(Some(0), Vec3::ZERO)]).unwrap();
    let up = |v: &Vertex| (v.position.y + 0.5).clamp(0.0, 1.0);
    let shares: Vec<[f32; 4]> = mesh.vertices().iter().map(|v| [1.0 - up(v), up(v), 0.0, 0.0]).collect();
    let weights = Weights::new(&vec![[0, 1, 0, 0]; shares.len()], &shares, &skeleton).unwrap();
    let turn = Track::new(vec![0.0], vec![Quat::from_rotation_z(0.7)], Interpolation::Step).unwrap();
    let clip = Clip::new(vec![(1, Channel::Rotation(turn))], &skeleton).unwrap();
    let mut pose = Pose::rest(&skeleton);
    pose.set(&skeleton, &clip, 0.0, Ending::Clamp);
    (weights, pose)
}

#[test]
fn a_pass_of_ones_own_shows_what_the_renderer_shows() {
    let Some(gpu) = Gpu::for_tests() else { return };
    let ball = world::Mesh::ball(3);
    let vertices = ball.positions.iter().map(|&p| Vertex { position: p, normal: p }).collect();
    let meshes = [Mesh::new(vertices, Vec::new(), ball.triangles).unwrap()];
    let look = Look::new(Fur::for_radius(1.0, 0.2, 0.4).unwrap());
    let camera = Camera::look_at(Vec3::Z * 4.0, Vec3::ZERO, 45.0, 1.5, 0.1, 20.0);
    let stand = Stand { mesh: 0, place: Affine3A::IDENTITY, root: [0.4, 0.2, 0.1], tip: [1.0, 0.5, 0.2] };
    let other = Stand { place: Affine3A::from_translation(Vec3::X * 1.5), ..stand };
    let mut list = DrawList::new(&[(stand, 6), (other, 4)], Vec::new());
    // The first is posed and leans, the second stands at rest.
    let (weights, pose) = nodding(&meshes[0]);
    list.pose(0, &pose).unwrap();
    list.lean(0, Lean { towards: Vec3::new(0.5, -0.4, 0.0), most: 1.0 }).unwrap();
    let sun = Sun { towards: Vec3::ONE, center: Vec3::ZERO, radius: 2.0, shadows: true };

    let mut renderer = Renderer::new(&gpu, COLOUR, &meshes, &look).unwrap();
    let canvas = Canvas::new(&gpu, SIZE);
    let shot = |renderer: &mut Renderer| {
        renderer.cast_shadows(&gpu, &list, &sun).unwrap();
        renderer.draw(&gpu, &canvas.picture(), &camera, &list, &sun).unwrap();
        canvas.read_picture(&gpu).unwrap()
    };
    let rest = shot(&mut renderer);
    renderer.set_weights(&gpu, 0, &weights).unwrap();
    let want = shot(&mut renderer);
    let moved = rest.chunks(4).zip(want.chunks(4)).filter(|(a, b)| a != b).count();
    assert!(moved > 200, "{moved}");
    let same = |p: &[u8]| p.chunks(4).zip(want.chunks(4)).filter(|(a, b)| a == b).count();
    let sky = want.chunks(4).filter(|p| *p == &want[..4]).count();
    assert!(sky > 1000 && sky < 5000, "the ball covers a part: {sky}");

    for samples in [1, 4] {
        let mut fur = OwnPass::new(&gpu, COLOUR, samples, &meshes, &look).unwrap();
        let empty = drawn(&gpu, &fur, samples, &want);
        assert_eq!(same(&empty), sky, "nothing before it is prepared");
        assert!(fur.set_weights(&gpu, 1, &weights).is_err(), "there is one mesh");
        fur.set_weights(&gpu, 0, &weights).unwrap();
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
