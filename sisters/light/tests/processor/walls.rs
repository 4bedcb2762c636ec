//! Light does not cross walls.

use crate::common::{indirect, lit, matt, scene, sealed, sheet, turned};
use casca_radiosity::Triangle;
use glam::{Affine3A, Vec3};

#[test]
fn a_sealed_box_under_the_sky_is_dark() {
    for place in [Affine3A::IDENTITY, turned()] {
        for thickness in [0.0, 0.02, 0.25] {
            assert_eq!(sealed(thickness, 24, 64, place), 0.0, "{thickness}");
        }
    }
}

#[test]
fn a_slanted_roof_near_the_floor_stops_light() {
    // Starts of rays just above the floor must not be above the roof.
    let mut all = sheet(Vec3::ZERO, Vec3::Z * 4.0, Vec3::X * 8.0, 0);
    let (a, b, c, d) =
        (Vec3::ZERO, Vec3::new(0.0, 0.0, 4.0), Vec3::new(8.0, 0.3, 4.0), Vec3::new(8.0, 0.3, 0.0));
    all.extend([[a, b, c], [a, c, d]].map(|corners| Triangle { corners, material: 0 }));
    // The ends are closed.
    all.extend(sheet(Vec3::new(8.0, 0.0, 0.0), Vec3::Y * 0.3, Vec3::Z * 4.0, 0));
    for z in [0.0, 4.0] {
        let corners = [Vec3::new(0.0, 0.0, z), Vec3::new(8.0, 0.0, z), Vec3::new(8.0, 0.3, z)];
        all.push(Triangle { corners, material: 0 });
    }
    let scene = scene(all, vec![matt(0.9)], vec![], 1.0);
    let cache = lit(&scene, 32, 64, 4);
    for i in 0..60 {
        let point = Vec3::new(0.05 + 7.9 * i as f32 / 60.0, 0.0, 2.0);
        assert_eq!(indirect(&cache, point, Vec3::Y), 0.0, "{point}");
    }
}
