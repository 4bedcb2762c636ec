//! Cells of meshes, and refusals.

use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{DVec3, IVec3, Quat, Vec3};

use crate::error::Error;
use crate::geometry::{Aabb, Block, Obb};
use crate::grid::Grid;
use crate::grid::run::CellRun;
use crate::mesh::{Facing, Instance, MeshOptions, TriMesh};
use crate::object::{ObjectDesc, Occluder};
use crate::scene::Scene;
use crate::shape::{Shape, Which};

/// A box as twelve triangles.
fn cuboid(min: Vec3, max: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let corner = |i: u32| {
        let pick = |bit: u32, axis: usize| if i >> bit & 1 == 0 { min[axis] } else { max[axis] };
        Vec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    ((0..8).map(corner).collect(), triangles)
}

fn cells(shape: &dyn Shape, grid: &Grid, opaque: bool) -> BTreeSet<[i32; 3]> {
    let mut set = BTreeSet::new();
    let mut add = |run: CellRun| run.cells().for_each(|c| assert!(set.insert(c.to_array())));
    shape.rows(grid, if opaque { Which::Opaque } else { Which::Touched }, &mut add);
    set
}

fn grid(cells: u32) -> Grid {
    Grid::new(10.0 / cells as f32).unwrap()
}

#[test]
fn a_closed_box_has_the_cells_of_the_box() {
    let (min, max) = (Vec3::new(1.3, 2.2, 3.1), Vec3::new(7.9, 8.0, 9.3));
    let (p, t) = cuboid(min, max);
    let mesh = TriMesh::new(p, t).unwrap();
    assert!(mesh.is_closed());
    let g = grid(20);
    let (opaque, of_box) = (cells(&mesh, &g, true), cells(&Aabb::new(min, max), &g, true));
    assert!(opaque.is_subset(&of_box) && opaque.len() * 10 > of_box.len() * 6, "{}", opaque.len());
    for c in &of_box {
        let (lo, hi) = g.cell_bounds(IVec3::from_array(*c));
        assert_eq!(mesh.contains_box(lo, hi), opaque.contains(c), "{c:?}");
    }
    assert!(cells(&mesh, &g, false).is_disjoint(&opaque));
    assert!(mesh.contains_point(DVec3::splat(5.0)) && !mesh.contains_point(DVec3::splat(1.0)));
}

#[test]
fn a_hollow_shell_is_not_solid() {
    let (mut p, mut t) = cuboid(Vec3::splat(1.0), Vec3::splat(9.0));
    let (q, u) = cuboid(Vec3::splat(3.0), Vec3::splat(7.0));
    p.extend(q);
    t.extend(u.iter().map(|c| c.map(|v| v + 8)));
    let mesh = TriMesh::new(p, t).unwrap();
    let opaque = cells(&mesh, &grid(40), true);
    assert!(!opaque.is_empty() && !opaque.contains(&[20, 20, 20]));
    assert!(opaque.contains(&[8, 20, 20]));
}

#[test]
fn an_open_box_touches_only() {
    let (p, mut t) = cuboid(Vec3::splat(1.0), Vec3::splat(9.0));
    t.pop();
    let mesh = TriMesh::new(p, t).unwrap();
    assert!(!mesh.is_closed());
    assert!(cells(&mesh, &grid(20), true).is_empty());
    assert!(!cells(&mesh, &grid(20), false).is_empty());
    assert!(!mesh.contains_point(DVec3::splat(5.0)));
}

/// A box turned about its middle.
fn turned(center: Vec3, half: Vec3, turn: Quat) -> TriMesh {
    let (p, t) = cuboid(-half, half);
    TriMesh::new(p.iter().map(|&p| center + turn * p).collect(), t).unwrap()
}

/// A ring of square section around an axis along y.
fn ring(n: u32) -> TriMesh {
    let section = [(2.0, 4.1), (3.9, 4.1), (3.9, 5.9), (2.0, 5.9)];
    let point = |i: u32, k: usize| {
        let angle = i as f32 / n as f32 * std::f32::consts::TAU;
        let (r, y) = section[k];
        Vec3::new(5.0 + r * angle.cos(), y, 5.0 + r * angle.sin())
    };
    let p = (0..n).flat_map(|i| (0..4).map(move |k| point(i, k))).collect();
    let at = |i: u32, k: u32| i % n * 4 + k % 4;
    let quad = |i: u32, k: u32| {
        let (a, b, c, d) = (at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k));
        [[a, b, c], [a, c, d]]
    };
    TriMesh::new(p, (0..n).flat_map(|i| (0..4).flat_map(move |k| quad(i, k))).collect()).unwrap()
}

#[test]
fn cells_inside_are_those_of_the_solid() {
    // Inside the grid, out of it on every side, and around it.
    let mut centers = vec![(Vec3::splat(5.0), 3.0), (Vec3::splat(5.0), 30.0)];
    for axis in Vec3::AXES {
        centers.extend([-1.0, 11.0].map(|at| (Vec3::splat(5.0) * (1.0 - axis) + at * axis, 4.0)));
    }
    let mut count = 0;
    for (i, &(center, size)) in centers.iter().enumerate() {
        let half = Vec3::new(0.8, 1.0, 1.2) * size;
        let turn = Quat::from_axis_angle(Vec3::new(1.0, 2.0, 0.5).normalize(), 0.3 + i as f32);
        let mesh = turned(center, half, turn);
        let g = grid(30);
        let (opaque, of_box) = (cells(&mesh, &g, true), cells(&Obb::new(center, half, turn), &g, true));
        // Corners are rounded to single precision, so single cells may differ.
        let differ = opaque.symmetric_difference(&of_box).count();
        assert!(differ * 200 <= of_box.len(), "{center} {size}: {differ} of {}", of_box.len());
        assert!(opaque.is_disjoint(&cells(&mesh, &g, false)));
        for c in opaque.iter().chain(&of_box).step_by(7) {
            let (lo, hi) = g.cell_bounds(IVec3::from_array(*c));
            assert_eq!(mesh.contains_box(lo, hi), opaque.contains(c), "{c:?}");
        }
        count += opaque.len();
    }
    assert!(count > 30_000, "{count}");
}

#[test]
fn cells_in_a_hole_are_not_inside() {
    let (mesh, g) = (ring(200), grid(40));
    let (opaque, touched) = (cells(&mesh, &g, true), cells(&mesh, &g, false));
    for i in 0..64_000 {
        let cell = IVec3::new(i % 40, i / 40 % 40, i / 1600);
        let (lo, hi) = g.cell_bounds(cell);
        let far = (hi - 5.0).abs().max((lo - 5.0).abs());
        let near = (lo - 5.0).max(5.0 - hi).max(DVec3::ZERO);
        let (most, least) = (far.with_y(0.0).length(), near.with_y(0.0).length());
        // The ring's sides are chords: they leave circles by less than this.
        let room = 0.01;
        let inside = least > 2.0 + room && most < 3.9 - room && lo.y > 4.11 && hi.y < 5.89;
        let outside = most < 2.0 - room || least > 3.9 + room || hi.y < 4.09 || lo.y > 5.91;
        let named = [opaque.contains(&cell.to_array()), touched.contains(&cell.to_array())];
        match (inside, outside) {
            (true, _) => assert_eq!(named, [true, false], "{cell}"),
            (_, true) => assert_eq!(named, [false, false], "{cell}"),
            _ => {}
        }
        assert_eq!(mesh.surface_meets(&Block::new((lo, hi))), named[1], "{cell}");
        assert_eq!(mesh.contains_box(lo, hi), named[0], "{cell}");
        let at = (lo + hi) * 0.5;
        assert!(!named[0] || mesh.contains_point(at));
        assert!(!outside || !mesh.contains_point(at));
    }
    assert!(opaque.len() > 2000, "{}", opaque.len());
}

#[test]
fn cells_are_held_for_one_grid_only() {
    let (mesh, g) = (ring(20), grid(20));
    let held = mesh.cache_cells(&g);
    let one = mesh.surface_cells(&g).unwrap();
    assert!(Arc::ptr_eq(&one, &mesh.surface_cells(&g).unwrap()));
    let other = mesh.surface_cells(&grid(30)).unwrap();
    assert!(other.runs.len() > one.runs.len());
    drop(held);
    let again = mesh.surface_cells(&g).unwrap();
    assert!(!Arc::ptr_eq(&one, &again) && one.runs == again.runs);
}

#[test]
fn what_is_bounds_only_hides_nothing_and_takes_less() {
    let full = Arc::new(ring(200));
    let bounds = TriMesh::bounds_only(full.positions.to_vec(), full.triangles.to_vec()).unwrap();
    let bounds = Arc::new(bounds);
    assert!(full.occludes() && !bounds.occludes() && bounds.is_closed());
    assert_eq!((bounds.patches(), bounds.sides()), (0, 0));
    assert!(bounds.memory_bytes() < full.memory_bytes());
    let g = grid(20);
    assert_eq!(cells(&*bounds, &g, false), cells(&*full, &g, false));
    assert!(cells(&*bounds, &g, true).is_empty());

    let mut scene = Scene::new(0.5).unwrap();
    let place = glam::Affine3A::from_rotation_y(0.2);
    let instance = Instance::new(bounds.clone(), place).unwrap();
    let id = scene.insert(ObjectDesc::dynamic(instance.clone())).unwrap();
    for occluder in [Occluder::from(bounds.clone()), instance.clone().into()] {
        let desc = ObjectDesc::fixed(bounds.clone()).occluder(occluder.clone());
        assert_eq!(scene.insert(desc).unwrap_err(), Error::BoundsOnly);
        assert_eq!(scene.update(id, instance.clone(), Some(occluder)), Err(Error::BoundsOnly));
    }
    assert!(scene.insert(ObjectDesc::fixed(bounds)).is_ok());
}

#[test]
fn memory_counts_what_is_held() {
    let mesh = ring(2000);
    let before = mesh.memory_bytes();
    assert!(before > mesh.positions.len() * 12 + mesh.triangles.len() * 12 + mesh.sides() * 16);
    assert!(mesh.contains_point(DVec3::new(8.0, 5.0, 5.0)));
    assert!(mesh.memory_bytes() > before + mesh.triangles.len() * 4);
}

/// A hilly floor, boxes that abut and one beside a crack, in numbers that are not rounded.
fn level() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..100u32 {
        positions.push(Vec3::new((i % 10) as f32, (i * 7 % 11) as f32 * 0.125, (i / 10) as f32));
    }
    for i in (0..90).filter(|i| i % 10 < 9) {
        triangles.extend([[i, i + 10, i + 11], [i, i + 11, i + 1]]);
    }
    for at in [2.0, 4.0, 6.25] {
        let first = positions.len() as u32;
        let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32);
        positions.extend((0..8).map(|i| corner(i) * 2.0 + Vec3::new(at, 3.0, 4.0)));
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let faces = faces.map(|f| f.map(|v| first + v));
        triangles.extend(faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]));
    }
    (positions, triangles)
}

#[test]
fn the_number_of_the_preparation_tells_what_it_makes() {
    let (positions, triangles) = level();
    let prepare = |how: MeshOptions| {
        let go_on = &mut |_| ControlFlow::Continue(());
        let mesh = TriMesh::prepare(positions.clone(), triangles.clone(), &how, go_on).unwrap();
        let mut bytes = Vec::new();
        mesh.write(&mut bytes).unwrap();
        u64::from_le_bytes(*bytes.last_chunk().unwrap())
    };
    let how = MeshOptions::default();
    let made = [how, how.tolerance(2.0), how.facing(Facing::Front)].map(prepare);
    // Checksums of the bytes. Where others come out, both lines change.
    let known = [0xc786_bcf0_5fe2_e9e0, 0x28a5_ce17_4716_124c, 0xf6ae_95b2_c579_f7fb];
    assert_eq!((TriMesh::PREPARATION, made), (3, known));
}

#[test]
fn refuses_broken_meshes() {
    assert_eq!(TriMesh::new(vec![], vec![]).unwrap_err(), Error::EmptyMesh);
    let one = vec![Vec3::ZERO; 3];
    let missing = TriMesh::new(one.clone(), vec![[0, 1, 3]]).unwrap_err();
    assert_eq!(missing, Error::MeshIndex { triangle: 0, vertex: 3, vertices: 3 });
    assert!(TriMesh::new(vec![Vec3::NAN; 3], vec![[0, 1, 2]]).is_err());
    let point = TriMesh::new(one, vec![[0, 1, 2]]).unwrap();
    assert!(!point.is_closed());
    assert_eq!(cells(&point, &grid(10), false).len(), 1);
}

/// Rolling ground, beside triangles that touch nothing.
fn ground_and_loose_triangles() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let n = 30;
    let height = |x: f32, z: f32| (x * 0.4).sin() * (z * 0.3).cos();
    let point = |i: u32| ((i % (n + 1)) as f32, (i / (n + 1)) as f32);
    let mut positions: Vec<Vec3> =
        (0..(n + 1) * (n + 1)).map(point).map(|(x, z)| Vec3::new(x, height(x, z), z)).collect();
    let square = |i: u32| {
        let a = i / n * (n + 1) + i % n;
        [[a, a + n + 1, a + n + 2], [a, a + n + 2, a + 1]]
    };
    let mut triangles: Vec<[u32; 3]> = (0..n * n).flat_map(square).collect();
    for i in 0..200u32 {
        let corner = Vec3::new((i % 17) as f32, 5.0 + (i % 5) as f32, (i % 29) as f32);
        let first = positions.len() as u32;
        positions.extend([corner, corner + Vec3::new(0.5, 0.1, 0.0), corner + Vec3::new(0.0, 0.2, 0.7)]);
        triangles.push(if i % 2 == 0 {
            [first, first + 1, first + 2]
        } else {
            [first + 1, first, first + 2]
        });
    }
    (positions, triangles)
}

#[test]
fn progress_rises_to_one_and_ends_the_preparation_where_it_is_told_to() {
    let (positions, triangles) = ground_and_loose_triangles();
    let how = MeshOptions::default();
    let mut shares = Vec::new();
    let mut tell = |share| {
        shares.push(share);
        ControlFlow::Continue(())
    };
    TriMesh::prepare(positions.clone(), triangles.clone(), &how, &mut tell).unwrap();
    assert!(shares.is_sorted() && shares.len() > 8, "{shares:?}");
    assert_eq!((shares.first(), shares.last()), (Some(&0.0), Some(&1.0)));
    for asked in 1..=shares.len() {
        let mut left = asked;
        let mut tell = |_| {
            left -= 1;
            if left == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let made = TriMesh::prepare(positions.clone(), triangles.clone(), &how, &mut tell);
        assert_eq!((made.err(), left), (Some(Error::Cancelled), 0));
    }
}
