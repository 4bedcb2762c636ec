//! Hulls and intersections, and their cells.

use std::collections::BTreeSet;

use glam::{DVec3, Quat, Vec3};

use crate::geometry::{Block, Obb, Plane};
use crate::grid::Grid;
use crate::random::Random;
use crate::shape::{Convex, Shape, Which};

fn any(random: &mut Random) -> Vec3 {
    (random.point(0.5) + 0.5).as_vec3()
}

#[test]
fn hulls_hold_their_points_and_close() {
    let mut random = Random::new(1);
    for n in [4, 5, 8, 12, 20, 30] {
        for _ in 0..10 {
            let points: Vec<Vec3> = (0..n).map(|_| any(&mut random) * 7.0).collect();
            let hull = Convex::from_points(&points).unwrap();
            assert!(points.iter().all(|p| hull.contains_point(p.as_dvec3())));
            assert_eq!(hull.vertices.len() + hull.faces.len(), hull.edges.len() + 2);
        }
    }
}

#[test]
fn a_cube_is_the_same_from_points_and_from_planes() {
    let points: Vec<Vec3> =
        Block { min: DVec3::ZERO, max: DVec3::ONE }.corners().iter().map(|p| p.as_vec3()).collect();
    let planes: Vec<Plane> = Vec3::AXES
        .iter()
        .flat_map(|&n| [Plane { normal: n, offset: 0.0 }, Plane { normal: -n * 2.0, offset: 2.0 }])
        .collect();
    for cube in [Convex::from_points(&points).unwrap(), Convex::from_planes(&planes).unwrap()] {
        assert_eq!((cube.vertices.len(), cube.faces.len(), cube.edges.len()), (8, 6, 12));
        assert!(cube.contains_box(DVec3::splat(0.01), DVec3::splat(0.99)));
        assert!(!cube.contains_box(DVec3::splat(0.01), DVec3::splat(1.01)));
    }
}

#[test]
fn refuses_what_is_no_solid() {
    let flat = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.0), Vec3::new(0.3, 0.2, 0.0)];
    assert!(Convex::from_points(&flat).is_err());
    assert!(Convex::from_points(&[Vec3::ZERO; 8]).is_err());
    assert!(Convex::from_points(&[Vec3::NAN; 4]).is_err());
    assert!(Convex::from_points(&[Vec3::X; 3]).is_err());
    let up = Plane { normal: Vec3::Y, offset: 1.0 };
    assert!(Convex::from_planes(&[up; 4]).is_err());
    assert!(Convex::from_planes(&[Plane { normal: Vec3::ZERO, offset: 1.0 }; 4]).is_err());
}

#[test]
fn cells_of_turned_boxes_agree_with_points() {
    let grid = Grid::new(0.5).unwrap();
    let mut random = Random::new(5);
    for _ in 0..20 {
        let center = any(&mut random) * 10.0;
        let half = any(&mut random) * 3.0 + 0.1;
        let rotation =
            Quat::from_euler(glam::EulerRot::XYZ, random.next() as f32 * 6.0, random.next() as f32, 1.0);
        let boxed = Obb { center, half, rotation };
        let points: Vec<Vec3> = Block { min: -half.as_dvec3(), max: half.as_dvec3() }
            .corners()
            .iter()
            .map(|p| center + rotation * p.as_vec3())
            .collect();
        let hull = Convex::from_points(&points).unwrap();
        let shapes: [&dyn Shape; 2] = [&boxed, &hull];
        for shape in shapes {
            let (mut touched, mut opaque) = (BTreeSet::new(), BTreeSet::new());
            shape.rows(&grid, Which::Touched, &mut |r| touched.extend(r.cells().map(|c| c.to_array())));
            shape.rows(&grid, Which::Opaque, &mut |r| opaque.extend(r.cells().map(|c| c.to_array())));
            for i in 0..8000 {
                let cell = glam::IVec3::new(i % 20, i / 20 % 20, i / 400);
                let (min, max) = grid.cell_bounds(cell);
                let inside = |p: DVec3| {
                    let d = rotation.as_dquat().inverse() * (p - center.as_dvec3());
                    d.abs().cmple(half.as_dvec3()).all()
                };
                if opaque.contains(&cell.to_array()) {
                    assert!(Block { min: min + 1e-5, max: max - 1e-5 }.corners().iter().all(|&p| inside(p)));
                }
                let t = DVec3::new(0.31, 0.57, 0.77);
                if inside(min + (max - min) * t) {
                    assert!(touched.contains(&cell.to_array()));
                }
            }
        }
    }
}
