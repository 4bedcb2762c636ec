//! Voxels against brute force: exact clipping in double precision, which shares no code with the
//! test by separating axes.

mod common;

use std::sync::Arc;

use casca_light::error::LightError;
use casca_light::picture::Layer;
use casca_light::renderer::{Renderer, Settings};
use casca_scenes::lit::{Kind, LitObject, LitScene, Material};
use casca_stage::gpu::Gpu;
use casca_stage::timing::Clock;
use common::{ball, gpu, limited, touched_by_clipping};
use glam::{Affine3A, Vec3};

/// Radius of a ball that fills many bricks of a grid of 4 m and 8x8x8 bricks.
const LARGE: f32 = 1.3;

type Surfaces = Vec<(u32, Vec<[u32; 4]>)>;

fn settings(resolution: u32) -> Settings {
    Settings { resolution, ..Settings::default() }
}

fn voxels(gpu: &Gpu, scene: &LitScene, resolution: u32) -> (Renderer, Surfaces) {
    let mut renderer = Renderer::new(gpu, scene, settings(resolution)).unwrap();
    renderer.update(gpu, None, &mut Clock::off()).unwrap();
    let surfaces = renderer.layers().read_surfaces(gpu).unwrap();
    (renderer, surfaces)
}

#[test]
fn voxels_are_the_cells_that_triangles_touch() {
    let Some(gpu) = gpu() else { return };
    for (kind, resolution) in [(Kind::Cornell, 24), (Kind::LightBox, 40), (Kind::Emissive, 33)] {
        let scene = kind.build();
        let (renderer, surfaces) = voxels(&gpu, &scene, resolution);
        let volume = renderer.volume();
        // A cell is full as soon as triangles come within the margin of it.
        let touched = |grow| touched_by_clipping(&scene, volume, grow);
        let (least, most) = (touched(-1e-5), touched(2.0 / 2048.0));
        let mut full = 0;
        for brick in 0..volume.brick_count() as u32 {
            let cells = surfaces.iter().find(|s| s.0 == brick).map(|s| &s.1);
            for local in 0..512 {
                let cell = volume.brick(brick) * 8 + glam::UVec3::new(local % 8, local / 8 % 8, local / 64);
                // Every material has an albedo, an emission or a normal that is not 0.
                let is_full = cells.is_some_and(|c| c[local as usize] != [0; 4]);
                full += usize::from(is_full);
                assert!(is_full || !least.contains(&cell), "{}: {cell} is missing", scene.name);
                assert!(!is_full || most.contains(&cell), "{}: {cell} is too much", scene.name);
            }
        }
        assert!(full > 500, "{full}");
    }
}

#[test]
fn no_cell_that_a_sliver_touches_is_missing() {
    let Some(gpu) = gpu() else { return };
    let mut scene = Kind::Cornell.build();
    // A sequence without a pattern (R3, Roberts 2018), as points of the box.
    let point =
        |i: usize| 5.4 * (Vec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5) * (i as f32 + 0.5)).fract();
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..40 {
        let (a, b) = (point(2 * i), point(2 * i + 1));
        let aside = (b - a).normalize().any_orthonormal_vector() * 0.02 * 0.5_f32.powi(i as i32 % 12);
        triangles.push([0, 1, 2].map(|k| k + positions.len() as u32));
        positions.extend([a, b, a.lerp(b, 0.4) + aside]);
    }
    scene.objects.truncate(1);
    scene.objects[0].materials = vec![0; triangles.len()].into();
    scene.objects[0].mesh = casca_scenes::world::Mesh { positions, triangles }.into();
    let (renderer, surfaces) = voxels(&gpu, &scene, 32);
    let volume = renderer.volume();
    let is_full = |cell: &glam::UVec3| {
        let brick = surfaces.iter().find(|s| s.0 == volume.number(cell / 8));
        let [x, y, z] = (cell % 8).to_array();
        brick.is_some_and(|s| s.1[(x + 8 * (y + 8 * z)) as usize] != [0; 4])
    };
    let touched = touched_by_clipping(&scene, volume, -1e-4);
    let missing = touched.iter().filter(|&cell| !is_full(cell)).count();
    assert!(touched.len() > 500 && missing == 0, "{missing} of {}", touched.len());
    // The width of the widest sliver, in cells, is a tenth.
    let near = touched_by_clipping(&scene, volume, 0.1);
    let full = surfaces.iter().flat_map(|s| &s.1).filter(|c| **c != [0; 4]).count();
    assert!(full <= near.len(), "{full} of {}", near.len());
}

#[test]
fn the_order_of_triangles_does_not_matter() {
    let Some(gpu) = gpu() else { return };
    let mut scene = Kind::LightBox.build();
    scene.objects.push(ball(0, Vec3::new(0.2, 0.1, 0.3), 0.7));
    scene.materials[0].emission = Vec3::ONE;
    let (_, first) = voxels(&gpu, &scene, 24);
    scene.objects.reverse();
    for object in &mut scene.objects {
        let mut mesh = (*object.mesh).clone();
        // A permutation: 7919 is a prime that divides no number of triangles here.
        let n = mesh.triangles.len();
        assert!(!n.is_multiple_of(7919));
        mesh.triangles = (0..n).map(|i| mesh.triangles[i * 7919 % n]).collect();
        object.materials = (0..n).map(|i| object.materials[i * 7919 % n]).collect();
        object.mesh = mesh.into();
    }
    assert!(first == voxels(&gpu, &scene, 24).1);
}

#[test]
fn what_moved_in_and_out_again_leaves_no_trace() {
    let Some(gpu) = gpu() else { return };
    let still = Kind::Cornell.build();
    let (_, fixed) = voxels(&gpu, &still, 40);
    let mut scene = still.clone();
    scene.objects.push(ball(1, Vec3::new(2.6, 1.7, 2.4), 0.5));
    let object = scene.objects.len() - 1;
    let (mut renderer, with_ball) = voxels(&gpu, &scene, 40);
    assert!(fixed != with_ball);
    let far = [Vec3::splat(1e4), Vec3::splat(f32::NAN), Vec3::splat(f32::MAX)];
    for to in far.map(Affine3A::from_translation) {
        renderer.move_object(&gpu, object, scene.objects[object].transform).unwrap();
        renderer.update(&gpu, None, &mut Clock::off()).unwrap();
        assert!(renderer.layers().read_surfaces(&gpu).unwrap() == with_ball);
        renderer.move_object(&gpu, object, to).unwrap();
        renderer.update(&gpu, None, &mut Clock::off()).unwrap();
        assert!(renderer.layers().read_surfaces(&gpu).unwrap() == fixed);
    }
    // Objects that stay, and others, are refused.
    for wrong in [0, object + 1, usize::MAX] {
        let refused = renderer.move_object(&gpu, wrong, Affine3A::IDENTITY);
        assert!(matches!(refused, Err(LightError::Object(n)) if n == wrong));
    }
}

#[test]
fn what_moves_before_the_first_update_is_where_it_went() {
    let Some(gpu) = gpu() else { return };
    let mut scene = Kind::Cornell.build();
    scene.objects.push(ball(1, Vec3::new(2.6, 1.7, 2.4), 0.5));
    let object = scene.objects.len() - 1;
    let to = Affine3A::from_translation(Vec3::new(-1.5, 1.0, -1.0)) * scene.objects[object].transform;
    let mut renderer = Renderer::new(&gpu, &scene, settings(40)).unwrap();
    renderer.move_object(&gpu, object, to).unwrap();
    renderer.update(&gpu, None, &mut Clock::off()).unwrap();
    let moved = renderer.layers().read_surfaces(&gpu).unwrap();
    scene.objects[object].transform = to;
    assert!(moved == voxels(&gpu, &scene, 40).1);
}

#[test]
fn a_dim_lamp_shines_beside_a_very_bright_one() {
    let Some(gpu) = gpu() else { return };
    let mut scene = Kind::Emissive.build();
    let lamps = |scene: &LitScene| {
        let (_, surfaces) = voxels(&gpu, scene, 32);
        // The words of a cell hold albedo, emission and normal.
        surfaces.iter().flat_map(|s| &s.1).filter(|c| c[2] != 0).count()
    };
    let dim = lamps(&scene);
    scene.materials.push(Material { emission: Vec3::splat(1e12), ..Material::matt(Vec3::ONE) });
    let (min, max) = scene.bounds();
    scene.objects.push(ball(scene.materials.len() as u32 - 1, min.lerp(max, 0.2), 0.2));
    let both = lamps(&scene);
    assert!(dim > 0 && both > dim, "{dim}, then {both}");
}

#[test]
fn a_layer_of_one_triangle_in_one_brick_holds_no_other() {
    let Some(gpu) = gpu() else { return };
    let mut scene = common::wall_scene(1);
    scene.materials.push(Material::matt(Vec3::splat(0.2)));
    // Across the wall, within a cell or two.
    let at = scene.objects[0].mesh.positions[0].y;
    let positions =
        [[0.1, -0.02], [0.12, 0.02], [0.14, -0.02]].map(|[x, y]| Vec3::new(x, at + y, 0.1)).into();
    scene.objects.push(LitObject {
        name: "small".to_owned(),
        materials: vec![1].into(),
        mesh: casca_scenes::world::Mesh { positions, triangles: vec![[0, 1, 2]] }.into(),
        transform: Affine3A::IDENTITY,
        moves: false,
    });
    let (_, fixed) = voxels(&gpu, &scene, 64);
    scene.objects.last_mut().unwrap().moves = true;
    assert!(fixed == voxels(&gpu, &scene, 64).1);
}

#[test]
fn after_an_update_that_failed_the_next_one_makes_everything_again() {
    let Some(gpu) = gpu() else { return };
    // Room for 200 bricks: the wall and a large ball have 166, and half as many as move are added,
    // for moves to come.
    let gpu = limited(&gpu, |limits| limits.max_storage_buffer_binding_size = 200 * 512 * 16);
    let mut scene = common::wall_scene(1);
    // Small triangles instead of large ones without area, whose boxes have all bricks.
    let corners =
        [-2.0_f32, 2.0].map(|c| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|way| Vec3::splat(c) - way * 0.01 * c));
    let triangles = vec![[0, 1, 2], [3, 4, 5]];
    scene.objects[1].mesh = casca_scenes::world::Mesh { positions: corners.concat(), triangles }.into();
    scene.lights.push(casca_scenes::lit::Light::point(Vec3::new(0.5, 1.5, 0.5), Vec3::ONE));
    scene.objects.push(ball(0, Vec3::new(-0.5, 0.2, 0.0), 0.2));
    let object = scene.objects.len() - 1;
    let mut renderer = Renderer::new(&gpu, &scene, settings(64)).unwrap();
    renderer.update(&gpu, None, &mut Clock::off()).unwrap();
    let too_large = Affine3A::from_scale(Vec3::splat(LARGE));
    renderer.move_object(&gpu, object, too_large).unwrap();
    let said = renderer.update(&gpu, None, &mut Clock::off()).unwrap_err().to_string();
    assert!(said.contains("surfaces takes"), "{said}");
    scene.objects[object].transform.translation.x += 1.0;
    renderer.move_object(&gpu, object, scene.objects[object].transform).unwrap();
    renderer.update(&gpu, None, &mut Clock::off()).unwrap();
    let mut new = Renderer::new(&gpu, &scene, settings(64)).unwrap();
    new.update(&gpu, None, &mut Clock::off()).unwrap();
    for layer in [Layer::Picture, Layer::Voxels] {
        let [after, expected] = [&mut renderer, &mut new].map(|r| common::draw(&gpu, r, &scene, layer));
        assert!(after == expected && after.iter().any(|p| p[0] > 0.01), "{layer:?}");
    }
}

#[test]
fn an_adapter_that_binds_too_few_buffers_is_refused_by_name() {
    let Some(gpu) = gpu() else { return };
    let gpu = limited(&gpu, |limits| limits.max_storage_buffers_per_shader_stage = 8);
    let said = Renderer::new(&gpu, &Kind::Cornell.build(), settings(16)).err().unwrap().to_string();
    assert!(said.contains("nine storage buffers"), "{said}");
}

#[test]
fn scenes_and_grids_that_cannot_be_had_are_named() {
    let Some(gpu) = gpu() else { return };
    let refused =
        |scene: &LitScene, settings| Renderer::new(&gpu, scene, settings).err().map(|e| e.to_string());
    let scene = Kind::Cornell.build();
    for n in [0, 15, 513, u32::MAX] {
        assert!(refused(&scene, settings(n)).unwrap().contains("from 16 to 512"), "{n}");
    }
    let bad = Settings { step: f32::NAN, ..settings(32) };
    assert!(refused(&scene, bad).unwrap().contains("the step is NaN"));
    let empty = LitScene { objects: Vec::new(), ..scene.clone() };
    assert!(refused(&empty, settings(32)).unwrap().contains("no triangles"));
    let mut broken = scene.clone();
    broken.objects.truncate(1);
    broken.objects[0].materials = Arc::new([0, 99]);
    let mut mesh = (*broken.objects[0].mesh).clone();
    mesh.positions[1] = Vec3::NAN;
    mesh.triangles = vec![[0, 1, 2], [0, 2, 3]];
    broken.objects[0].mesh = mesh.into();
    let said = refused(&broken, settings(32)).unwrap();
    assert!(said.contains("1 have corners") && said.contains("1 have no material"), "{said}");
    if gpu.device.limits().max_storage_buffer_binding_size <= 1 << 27 {
        let said = refused(&scene, settings(512)).unwrap();
        assert!(said.contains("but the adapter has 134217728") && said.contains("fewer cells"), "{said}");
        let mut renderer = Renderer::new(&gpu, &scene, settings(16)).unwrap();
        let lights = vec![casca_scenes::lit::Light::point(Vec3::ZERO, Vec3::ONE); (1 << 21) + 1];
        let said = renderer.set_lights(&gpu, &lights).unwrap_err().to_string();
        assert!(said.contains("lights takes") && said.contains("fewer lights"), "{said}");
    }
}

#[test]
fn scenes_of_any_size_and_place_are_taken_or_refused() {
    let Some(gpu) = gpu() else { return };
    for (scale, shift) in
        [(1e-30, 0.0), (1e-3, 1e4), (1.0, 1e30), (1.0, 0.0), (1e30, 0.0), (3e38, 0.0), (0.0, 5.0), (0.0, 0.0)]
    {
        let mut scene = Kind::Cornell.build();
        for object in &mut scene.objects {
            object.transform =
                Affine3A::from_translation(Vec3::splat(shift)) * Affine3A::from_scale(Vec3::splat(scale));
        }
        scene.lights.push(casca_scenes::lit::Light::point(Vec3::NAN, Vec3::INFINITY));
        let near = Vec3::splat(2.7 * scale + shift);
        scene.lights.push(casca_scenes::lit::Light::point(near, Vec3::splat(1e38)));
        scene.sky = Vec3::INFINITY;
        let Ok(mut renderer) = Renderer::new(&gpu, &scene, settings(16)) else { continue };
        renderer.update(&gpu, None, &mut Clock::off()).unwrap();
        let light = common::draw(&gpu, &mut renderer, &scene, casca_light::picture::Layer::Picture);
        assert!(light.iter().flatten().all(|v| v.is_finite()), "scale {scale}, shift {shift}");
        // Where single precision tells cells, the light of 1e38 is in the picture.
        let is_lit = light.iter().any(|p| p[0] > 1e15);
        assert!(is_lit || scale != 1.0 || shift != 0.0, "scale {scale}, shift {shift}");
    }
}
