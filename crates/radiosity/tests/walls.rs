//! Light does not cross walls.

mod common;

use casca_radiosity::{Object, Scene, Triangle};
use common::{cuboid, indirect, lamp, lit, matt, placed, scene, sheet, total, turned};
use glam::{Affine3A, Vec3};

/// Two rooms of 4 x 3 x 4 metres, one beside the other, on one floor and below one ceiling, with a
/// wall of a thickness between them; 0 is a sheet.
fn rooms(thickness: f32) -> Vec<Triangle> {
    let (low, high) = (Vec3::new(-4.3, 0.0, -2.1), Vec3::new(4.3, 3.0, 2.1));
    let mut all = Vec::new();
    let wall = |a: [f32; 3], b: [f32; 3]| cuboid(Vec3::from_array(a), Vec3::from_array(b), 0);
    let t = thickness.max(0.1);
    // One floor and one ceiling run below and above all walls.
    all.extend(wall([low.x - t, -t, low.z - t], [high.x + t, 0.0, high.z + t]));
    all.extend(wall([low.x - t, 3.0, low.z - t], [high.x + t, 3.0 + t, high.z + t]));
    all.extend(wall([low.x - t, 0.0, low.z - t], [low.x, 3.0, high.z + t]));
    all.extend(wall([high.x, 0.0, low.z - t], [high.x + t, 3.0, high.z + t]));
    all.extend(wall([low.x, 0.0, low.z - t], [high.x, 3.0, low.z]));
    all.extend(wall([low.x, 0.0, high.z], [high.x, 3.0, high.z + t]));
    if thickness > 0.0 {
        all.extend(wall([-0.5 * thickness, 0.0, low.z], [0.5 * thickness, 3.0, high.z]));
    } else {
        let size = high - low;
        all.extend(sheet(Vec3::new(0.0, 0.0, low.z), Vec3::Y * size.y, Vec3::Z * size.z, 0));
    }
    all
}

/// Points of the floor, the ceiling and the middle wall of a room, with normals; `side` is -1 or 1.
fn questions(side: f32, thickness: f32) -> Vec<(Vec3, Vec3)> {
    let mut all = Vec::new();
    for i in 0..6 {
        for k in 0..6 {
            let (u, v) = ((i as f32 + 0.3) / 6.0, (k as f32 + 0.6) / 6.0);
            let (x, z) = (side * (0.5 * thickness + 0.01 + 4.0 * u), -2.0 + 4.0 * v);
            all.push((Vec3::new(x, 0.0, z), Vec3::Y));
            all.push((Vec3::new(x, 3.0, z), -Vec3::Y));
            all.push((Vec3::new(side * 0.5 * thickness, 0.05 + 2.9 * u, z), Vec3::X * side));
        }
    }
    all
}

/// The mean light of the dark room over that of the lit one, and the most of a point.
fn leak(thickness: f32, cells: u32, place: Affine3A) -> (f64, f64) {
    let lights = vec![lamp(place.transform_point3(Vec3::new(-2.0, 2.0, 0.3)), 10.0)];
    let scene = scene(placed(&rooms(thickness), place), vec![matt(0.7)], lights, 0.0);
    let cache = lit(&scene, cells, 32, 8);
    let of = |side: f32| {
        let ask = |(p, n): (Vec3, Vec3)| total(&cache, place.transform_point3(p), place.transform_vector3(n));
        let all: Vec<f64> = questions(side, thickness).into_iter().map(ask).collect();
        let most = all.iter().copied().fold(0.0, f64::max);
        (all.iter().sum::<f64>() / all.len() as f64, most)
    };
    let (bright, dark) = (of(-1.0), of(1.0));
    assert!(bright.0 > 0.5, "{bright:?}");
    (dark.0 / bright.0, dark.1 / bright.0)
}

#[test]
fn a_sealed_room_beside_a_lit_one_is_dark() {
    for place in [Affine3A::IDENTITY, turned()] {
        for thickness in [0.0, 0.02, 0.2] {
            let (mean, most) = leak(thickness, 32, place);
            println!("{thickness} {mean:e} {most:e}");
            assert!(mean < 1e-6, "{thickness}: {mean}, {most}");
        }
    }
}

#[test]
fn walls_in_faces_of_cells_stop_light() {
    // Of 8 cells on 8 metres, so that all walls lie in faces.
    let mut all = cuboid(Vec3::ZERO, Vec3::new(8.0, 4.0, 4.0), 0);
    all.extend(sheet(Vec3::new(4.0, 0.0, 0.0), Vec3::Y * 4.0, Vec3::Z * 4.0, 0));
    let scene = scene(all, vec![matt(0.8)], vec![lamp(Vec3::new(2.5, 2.0, 1.7), 5.0)], 0.0);
    let cache = lit(&scene, 8, 64, 8);
    for (x, z) in [(4.001, 0.5), (4.2, 3.0), (6.0, 2.0), (7.9, 0.1)] {
        assert_eq!(total(&cache, Vec3::new(x, 0.0, z), Vec3::Y), 0.0);
        assert!(total(&cache, Vec3::new(8.0 - x, 0.0, z), Vec3::Y) > 0.1);
    }
    assert_eq!(total(&cache, Vec3::new(4.0, 1.0, 1.0), Vec3::X), 0.0);
    assert!(total(&cache, Vec3::new(4.0, 1.0, 1.0), -Vec3::X) > 0.1);
}

#[test]
fn a_sealed_box_under_the_sky_is_dark() {
    for place in [Affine3A::IDENTITY, turned()] {
        for thin in [true, false] {
            let mut all = cuboid(Vec3::ZERO, Vec3::splat(2.0), 0);
            if !thin {
                all.extend(cuboid(Vec3::splat(0.02), Vec3::splat(1.98), 0));
            }
            let scene = scene(placed(&all, place), vec![matt(0.7)], vec![], 1.0);
            let cache = lit(&scene, 24, 64, 8);
            for i in 0..20 {
                let at = Vec3::new(0.1 + 0.09 * i as f32, if thin { 0.0 } else { 0.02 }, 1.1);
                let point = place.transform_point3(at);
                assert_eq!(indirect(&cache, point, place.transform_vector3(Vec3::Y)), 0.0, "{i}, {thin}");
            }
            // The top of it sees all of the sky.
            let top = place.transform_point3(Vec3::new(1.0, 2.0, 1.0));
            let light = indirect(&cache, top, place.transform_vector3(Vec3::Y));
            assert!((light / std::f64::consts::PI - 1.0).abs() < 1e-4, "{light}");
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

#[test]
fn an_open_door_lets_light_through() {
    // The wall of two rooms, but for its last metre.
    let mut all = rooms(0.0);
    all.truncate(all.len() - 2);
    all.extend(sheet(Vec3::new(0.0, 0.0, -2.1), Vec3::Y * 3.0, Vec3::Z * 3.2, 0));
    let lights = vec![lamp(Vec3::new(-2.0, 2.0, 0.3), 10.0)];
    let scene =
        Scene { objects: vec![Object { triangles: all }], ..scene(vec![], vec![matt(0.7)], lights, 0.0) };
    let cache = lit(&scene, 32, 32, 8);
    assert!(indirect(&cache, Vec3::new(2.0, 0.0, 0.0), Vec3::Y) > 0.1);
}
