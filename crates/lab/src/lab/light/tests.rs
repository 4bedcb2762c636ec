use glam::Vec3;

use super::*;

const SIZE: (usize, usize) = (20, 15);

/// The picture of a volume of light that is gathered at the surfaces of a scene of white things.
fn gathered(case: &Case, volume: &LightVolume, how: Gather) -> Vec<f32> {
    let image = case.image(|at| volume.gather(at.point.as_vec3(), at.normal.as_vec3(), how, 0.3)).unwrap();
    image.pixels().iter().map(|p| p.x).collect()
}

const CONES: Gather = Gather::Cones { count: 16, step: 0.5, corrected: true };

#[test]
fn in_a_furnace_all_gather_its_emission() {
    let case = Case::new(Kind::Furnace.build(), SIZE).unwrap();
    for n in [16, 32] {
        let voxels = Voxels::new(&case.scene, n).unwrap();
        // Nothing leaks past exact walks.
        let volume = LightVolume::new(&voxels, voxels.emission(), Vec3::ZERO);
        for value in gathered(&case, &volume, Gather::Walks(32)) {
            assert!((value - 1.0).abs() < 1e-5, "{value}");
        }
        // Cones leak through walls of one cell, and gain no light.
        for value in gathered(&case, &volume, CONES) {
            assert!((0.6..1.0 + 1e-3).contains(&value), "{value}");
        }
        // Where the sky is as bright, leaks do not matter.
        let volume = LightVolume::new(&voxels, voxels.emission(), Vec3::ONE);
        for step in [0.1, 0.5, 2.5] {
            for value in gathered(&case, &volume, Gather::Cones { count: 16, step, corrected: true }) {
                assert!((value - 1.0).abs() < 2e-3, "step {step}: {value}");
            }
        }
    }
}

#[test]
fn bounces_come_near_the_path_tracer() {
    let case = Case::new(Kind::Cornell.build(), SIZE).unwrap();
    let voxels = Voxels::new(&case.scene, 48).unwrap();
    let mut sides = voxels.emission();
    for bounce in 1..=2 {
        let order = case.held + bounce;
        let truth = case
            .tracer
            .render(&case.scene.camera, SIZE, &Quantity::Radiance(order..=order), 200, 1)
            .unwrap()
            .image;
        let volume = LightVolume::new(&voxels, sides, Vec3::ZERO);
        for how in [Gather::Walks(1024), CONES] {
            // A few wide cones find a small lamp by luck.
            if how == CONES && order == 1 {
                continue;
            }
            let image = case
                .image(|at| {
                    case.albedo(at) * volume.gather(at.point.as_vec3(), at.normal.as_vec3(), how, 0.0)
                })
                .unwrap();
            let Difference { rmse, flip } = difference(&truth, &image).unwrap();
            assert!(rmse < 0.7 && flip < 0.35, "bounce {bounce}, {how:?}: {rmse} {flip}");
            let sum = |i: &HdrImage| i.pixels().iter().map(|p| p.element_sum()).sum::<f32>();
            let share = sum(&image) / sum(&truth);
            assert!((0.6..1.4).contains(&share), "bounce {bounce}, {how:?}: {share}");
        }
        sides = volume.bounce(Gather::Walks(64));
    }
}

#[test]
fn a_sheet_is_lit_on_one_side_only() {
    let mut scene = Kind::Plane.build();
    scene.lights[0] = crate::lit::Light::point(Vec3::new(0.0, 4.0, 0.0), Vec3::ONE);
    let voxels = Voxels::new(&scene, 32).unwrap();
    let sides = voxels.direct(&scene.lights);
    let plate: Vec<usize> = (0..voxels.voxels.len()).filter(|&v| voxels.voxels[v].normal.y > 0.99).collect();
    assert!(plate.len() > 300);
    let lit = plate.iter().filter(|&&v| sides[v][0].x > 0.0).count();
    assert!(lit > plate.len() / 2, "{lit}");
    assert!(plate.iter().all(|&v| sides[v][1] == Vec3::ZERO));
    // Every voxel has a share of its material: white.
    assert!(plate.iter().all(|&v| (voxels.voxels[v].albedo - 0.73).abs().max_element() < 1e-4));
}

#[test]
fn differences_are_those_of_the_reference_implementation() {
    // A ramp, and the same with a bright square.
    let ramp: Vec<Vec3> = (0..64 * 48).map(|i| Vec3::splat((i % 64) as f32 / 63.0)).collect();
    let mut square = ramp.clone();
    for y in 16..32 {
        square[y * 64 + 24..y * 64 + 40].fill(Vec3::new(1.0, 0.2, 0.2));
    }
    let (a, b) = (HdrImage::new(64, 48, ramp).unwrap(), HdrImage::new(64, 48, square).unwrap());
    assert_eq!(difference(&a, &a).unwrap(), Difference::default());
    let found = difference(&a, &b).unwrap();
    assert!((found.flip - REFERENCE).abs() < 2e-3, "{found:?}");
    assert!(difference(&a, &HdrImage::new(48, 64, Vec::new()).unwrap()).is_err());
}

/// What NVIDIA's flip-evaluator 1.7 says of these pictures.
const REFERENCE: f64 = 0.0945;

#[test]
fn sizes_out_of_range_are_refused_and_an_empty_scene_is_dark() {
    let mut scene = Kind::Plane.build();
    for n in [0, 7, 257, u32::MAX] {
        assert!(Voxels::new(&scene, n).err().unwrap().to_string().contains("8 to 256"));
    }
    scene.objects.clear();
    let voxels = Voxels::new(&scene, 8).unwrap();
    let volume = LightVolume::new(&voxels, voxels.emission(), Vec3::ZERO);
    for how in [CONES, Gather::Walks(8), Gather::Walks(0)] {
        assert_eq!(volume.gather(Vec3::ZERO, Vec3::Y, how, 0.0), Vec3::ZERO);
    }
}
