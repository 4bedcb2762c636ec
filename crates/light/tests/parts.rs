//! Parts that need no picture: cones, masks of bricks, and a device without memory.

use std::f32::consts::TAU;

use casca_light::cones::{Cone, ConeCount, MOST_CONES};
use casca_light::device::held;
use casca_light::error::{LightError, Part};
use casca_light::reach::grown;
use casca_light::volume::{BRICK, Volume};
use casca_stage::gpu::Gpu;
use casca_stage::wgpu;
use glam::{UVec3, Vec3};

#[test]
fn a_device_without_memory_is_an_error_by_name() {
    let Ok(gpu) = Gpu::headless(false) else { return println!("skipped: no adapter") };
    let most = gpu.device.limits().max_texture_dimension_3d;
    let size = wgpu::Extent3d { width: most, height: most, depth_or_array_layers: most };
    let descriptor = wgpu::TextureDescriptor {
        label: None,
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D3,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    };
    // Each takes most³ x 8 bytes: 64 GiB at 2048 texels.
    let textures: Vec<_> = (0..64)
        .map(|_| held(&gpu, Part::of_cells("voxels"), || gpu.device.create_texture(&descriptor)))
        .take_while(|made| made.is_ok())
        .collect();
    assert!(textures.len() < 64, "the device has memory for everything");
    let said = LightError::NoMemory(Part::of_cells("voxels")).to_string();
    assert_eq!(said, "the device has no memory for voxels; fewer cells take less");
}

#[test]
fn cones_fill_the_hemisphere_and_weigh_as_its_light() {
    for count in [ConeCount::Six, ConeCount::Sixteen] {
        let cones = count.cones();
        assert!(cones.len() <= MOST_CONES);
        let sum: f32 = cones.iter().map(|c| c.share).sum();
        assert!((sum - 1.0).abs() < 1e-6, "{sum}");
        let solid = |c: &Cone| TAU * (1.0 - c.slope.atan().cos());
        let solid: f32 = cones.iter().map(solid).sum();
        assert!((solid - TAU).abs() < 1e-4, "{solid}");
        // The mean of the directions, weighted, is that of light by the cosine law: two thirds of
        // the normal. The rule of one direction for a sector is a few percent off.
        let mean: Vec3 = cones.iter().map(|c| Vec3::from_array(c.direction) * c.share).sum();
        assert!(mean.abs_diff_eq(Vec3::Z * 2.0 / 3.0, 0.05), "{mean}");
    }
}

#[test]
fn masks_grow_by_a_box() {
    let bricks = UVec3::new(7, 5, 6);
    let volume = Volume { origin: Vec3::ZERO, cell: 1.0, dims: bricks * BRICK };
    for away in [0, 1, 2, 9] {
        let at = UVec3::new(1, 4, 2);
        let mut mask = vec![false; volume.brick_count()];
        mask[volume.number(at) as usize] = true;
        for (i, is_near) in grown(mask, bricks, away).into_iter().enumerate() {
            let far = volume.brick(i as u32).as_ivec3() - at.as_ivec3();
            assert_eq!(is_near, far.abs().max_element() <= away as i32, "{i} {away}");
        }
    }
}
