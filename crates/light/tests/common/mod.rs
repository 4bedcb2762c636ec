//! What the tests share: scenes, reading back, and oracles.
#![allow(dead_code)] // Each test file uses a part of it.

use std::collections::HashSet;
use std::f32::consts::PI;
use std::sync::Arc;

use casca_light::picture::Layer;
use casca_light::renderer::Renderer;
use casca_light::volume::Volume;
use casca_scenes::lit::{Kind, Light, LightKind, LitObject, LitScene, Material};
use casca_scenes::world::{Camera, Mesh};
use casca_stage::canvas::Canvas;
use casca_stage::gpu::Gpu;
use casca_stage::timing::Clock;
use casca_stage::wgpu;
use casca_truth::oracle::path::{PathTracer, Quantity};
use glam::{Affine3A, DVec3, Quat, UVec3, Vec3};

/// Size of pictures.
pub const SIZE: (u32, u32) = (48, 36);

/// Any adapter.
pub fn gpu() -> Option<Gpu> {
    let gpu = Gpu::headless(false).ok();
    if gpu.is_none() {
        println!("skipped: no adapter");
    }
    gpu
}

/// A device of the same adapter with lower limits.
pub fn limited(gpu: &Gpu, lower: impl FnOnce(&mut wgpu::Limits)) -> Gpu {
    let mut required_limits = gpu.adapter.limits();
    lower(&mut required_limits);
    let descriptor = wgpu::DeviceDescriptor { required_limits, ..Default::default() };
    let (device, queue) = pollster::block_on(gpu.adapter.request_device(&descriptor)).unwrap();
    Gpu::new(gpu.adapter.clone(), device, queue)
}

/// A ball that moves.
pub fn ball(material: u32, center: Vec3, radius: f32) -> LitObject {
    let mesh = Mesh::ball(2);
    LitObject {
        name: "ball".to_owned(),
        materials: vec![material; mesh.triangles.len()].into(),
        mesh: Arc::new(mesh),
        transform: Affine3A::from_scale_rotation_translation(Vec3::splat(radius), Quat::IDENTITY, center),
        moves: true,
    }
}

/// The light of the pixels of a small picture.
pub fn draw(gpu: &Gpu, renderer: &mut Renderer, scene: &LitScene, layer: Layer) -> Vec<[f32; 4]> {
    let canvas = Canvas::new(gpu, SIZE);
    renderer.draw(gpu, &canvas.picture(), &scene.camera, layer, &mut Clock::off()).unwrap();
    renderer.read_light(gpu).unwrap()
}

/// The picture by the path tracer: light scattered up to three times, as by voxels with a second
/// bounce.
pub fn truth(scene: &LitScene, samples: u32) -> Vec<Vec3> {
    let render = PathTracer::new(scene).render(
        &scene.camera,
        (SIZE.0 as usize, SIZE.1 as usize),
        &Quantity::Radiance(0..=3),
        samples,
        1,
    );
    render.unwrap().image.pixels().to_vec()
}

/// A square wall of 4 m, and a small square that makes the grid a cube; the wall's plane is in the
/// middle of a cell.
pub fn wall_scene(axis: usize) -> LitScene {
    let mut scene = Kind::Plane.build();
    let turned = |p: Vec3| {
        let mut q = Vec3::ZERO;
        (q[axis], q[(axis + 1) % 3], q[(axis + 2) % 3]) = (p.y, p.z, p.x);
        q
    };
    let square = |y: f32, half: f32| {
        [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]]
            .map(|[x, z]| turned(Vec3::new(x * half, y, z * half)))
    };
    // In a grid of 64 cells, 56 span 4 m, and planes of cells begin at -2 m.
    let y = 4.0 / 56.0 * 20.5 - 2.0;
    let object = |name: &str, corners: Vec<Vec3>| LitObject {
        name: name.to_owned(),
        materials: vec![0; 2].into(),
        mesh: Arc::new(Mesh { positions: corners, triangles: vec![[0, 1, 2], [0, 2, 3]] }),
        transform: Affine3A::IDENTITY,
        moves: false,
    };
    let corners = [-2.0, 2.0].map(|y| turned(Vec3::new(2.0, y, 2.0)));
    let tiny = vec![corners[0], corners[0], corners[1], corners[1]];
    scene.objects = vec![object("wall", square(y, 2.0).to_vec()), object("corners", tiny)];
    scene.materials = vec![Material::matt(Vec3::ONE)];
    scene.lights.clear();
    scene.camera = Camera::look_at(
        Vec3::new(0.3, 1.6, 0.4),
        Vec3::new(0.0, y, -0.1),
        60.0,
        SIZE.0 as f32 / SIZE.1 as f32,
        0.01,
        20.0,
    );
    scene
}

/// The points of the first wall (with y up) that the centres of pixels show.
pub fn wall_points(scene: &LitScene) -> Vec<Option<Vec3>> {
    let y = scene.objects[0].mesh.positions[0].y;
    let back = scene.camera.view_projection().inverse();
    let pixel = |i: u32| {
        let (x, row) = (i % SIZE.0, i / SIZE.0);
        let clip = Vec3::new(
            (x as f32 + 0.5) / SIZE.0 as f32 * 2.0 - 1.0,
            1.0 - (row as f32 + 0.5) / SIZE.1 as f32 * 2.0,
            0.5,
        );
        let ray = back.project_point3(clip) - scene.camera.eye;
        let at = scene.camera.eye + ray * ((y - scene.camera.eye.y) / ray.y);
        (ray.y < 0.0 && at.x.abs() < 1.8 && at.z.abs() < 1.8).then_some(at)
    };
    (0..SIZE.0 * SIZE.1).map(pixel).collect()
}

/// What the wall reflects at a point.
pub fn light(lights: &[Light], at: Vec3, scene: &LitScene) -> Vec3 {
    let sum: Vec3 =
        lights.iter().filter_map(|l| l.incident(at)).map(|i| i.irradiance * i.direction.y.max(0.0)).sum();
    sum * scene.materials[0].albedo / PI
}

/// A hall of 24 m with walls across that leave doors, lit by lamps, and a ball that moves at its
/// end.
pub fn long_hall() -> LitScene {
    let mut scene = Kind::CornellPoint.build();
    (scene.objects, scene.lights) = (Vec::new(), Vec::new());
    scene.sky = Vec3::ZERO;
    let mut add = |mesh: Mesh, material: u32| {
        scene.objects.push(LitObject {
            name: String::new(),
            materials: vec![material; mesh.triangles.len()].into(),
            mesh: Arc::new(mesh),
            transform: Affine3A::IDENTITY,
            moves: false,
        });
    };
    let cuboid = |a: [f32; 3], b: [f32; 3]| Mesh::cuboid(Vec3::from_array(a), Vec3::from_array(b));
    add(cuboid([0.0, -0.3, 0.0], [24.0, 0.0, 3.0]), 0);
    add(cuboid([0.0, 2.5, 0.0], [24.0, 2.8, 3.0]), 0);
    add(cuboid([0.0, 0.0, -0.3], [24.0, 2.5, 0.0]), 1);
    add(cuboid([0.0, 0.0, 3.0], [24.0, 2.5, 3.3]), 2);
    for x in [4.0, 8.0, 12.0, 16.0, 20.0] {
        add(cuboid([x, 0.0, 0.0], [x + 0.4, 2.5, 2.2]), 0);
    }
    for x in [2.0, 6.0, 10.0, 14.0, 18.0, 22.0] {
        let kind = LightKind::Point { position: Vec3::new(x, 2.0, 1.5), radius: 0.1 };
        scene.lights.push(Light { kind, ..Light::point(Vec3::ZERO, Vec3::splat(3.0)) });
    }
    scene.objects.push(ball(1, Vec3::new(1.0, 1.0, 1.0), 0.3));
    scene
}

/// The camera in the hall: it looks along it, and turns.
pub fn hall_camera(frame: usize) -> Camera {
    let target = [
        Vec3::new(1.0, 1.0, 1.0),
        Vec3::new(2.0, 1.0, 0.0),
        Vec3::new(4.0, 1.2, 2.0),
        Vec3::new(4.5, 1.0, 2.6),
    ][frame];
    Camera::look_at(Vec3::new(2.9, 1.4, 2.0), target, 60.0, SIZE.0 as f32 / SIZE.1 as f32, 0.01, 50.0)
}

/// A level of a texture of half floats.
pub fn texels(gpu: &Gpu, texture: &wgpu::Texture, mip_level: u32) -> Vec<[f32; 4]> {
    let size = texture.size().mip_level_size(mip_level, wgpu::TextureDimension::D3);
    let row = (size.width * 8).next_multiple_of(256);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(row * size.height * size.depth_or_array_layers),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(row),
        rows_per_image: Some(size.height),
    };
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo { mip_level, ..texture.as_image_copy() },
        wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
        size,
    );
    gpu.queue.submit([encoder.finish()]);
    let bytes = gpu.read_buffer(&buffer).unwrap();
    let rows = bytes.chunks_exact(row as usize).flat_map(|r| r[..size.width as usize * 8].chunks_exact(8));
    rows.map(|t| [0, 2, 4, 6].map(|i| half(u16::from_le_bytes([t[i], t[i + 1]])))).collect()
}

/// The value of a half float that is 0 or more.
fn half(bits: u16) -> f32 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f32::from(bits & 1023) / 1024.0);
    if exponent == 0 { fraction * 2.0_f32.powi(-14) } else { (1.0 + fraction) * 2.0_f32.powi(exponent - 15) }
}

/// The cells, grown by a share of their edge, in which something of a triangle is left after
/// clipping it.
pub fn touched_by_clipping(scene: &LitScene, volume: &Volume, grow: f64) -> HashSet<UVec3> {
    let mut touched = HashSet::new();
    for triangle in scene.triangles() {
        // As the grid sees it: in single precision.
        let corners = triangle.corners.map(|p| volume.cells_from(p).as_dvec3());
        let low = corners.into_iter().fold(DVec3::INFINITY, DVec3::min) - 1.0;
        let high = corners.into_iter().fold(DVec3::NEG_INFINITY, DVec3::max) + 1.0;
        let (low, high) = (low.max(DVec3::ZERO).as_uvec3(), high.as_uvec3().min(volume.dims - 1));
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    let cell = UVec3::new(x, y, z);
                    if !touched.contains(&cell)
                        && is_left(&corners, cell.as_dvec3() - grow, cell.as_dvec3() + 1.0 + grow)
                    {
                        touched.insert(cell);
                    }
                }
            }
        }
    }
    touched
}

/// Whether something of a polygon is left in a box (Sutherland & Hodgman 1974).
fn is_left(polygon: &[DVec3], low: DVec3, high: DVec3) -> bool {
    let mut polygon = polygon.to_vec();
    for axis in 0..3 {
        for (sign, bound) in [(1.0, low[axis]), (-1.0, -high[axis])] {
            let inside = |p: DVec3| sign * p[axis] - bound;
            let mut clipped = Vec::new();
            for i in 0..polygon.len() {
                let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
                let (u, v) = (inside(a), inside(b));
                if u >= 0.0 {
                    clipped.push(a);
                }
                if (u > 0.0 && v < 0.0) || (u < 0.0 && v > 0.0) {
                    clipped.push(a + (b - a) * (u / (u - v)));
                }
            }
            polygon = clipped;
        }
    }
    !polygon.is_empty()
}
