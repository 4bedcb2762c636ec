//! The cells of shapes, by separating axes and winding numbers cell by cell, and walks through
//! them, box by box.

use std::collections::BTreeSet;
use std::sync::Arc;

use casca::soft::{Layer, SoftGrid};
use casca::{Aabb, Instance, Obb, ObjectDesc, Scene, Sphere, TriMesh};
use casca_truth::cases;
use glam::{Affine3A, DVec3, IVec3, Quat, UVec3, Vec3};
use proptest::prelude::*;

use crate::{Dice, soft};

type Triangle = [DVec3; 3];

fn all_cells(n: i32) -> impl Iterator<Item = IVec3> {
    (0..n * n * n).map(move |i| IVec3::new(i % n, i / n % n, i / (n * n)))
}

fn occupied(soft: &SoftGrid, layer: Layer) -> BTreeSet<[i32; 3]> {
    let n = soft.grid().dims().x;
    all_cells(n).filter(|&c| soft.is_occupied(layer, c)).map(|c| c.to_array()).collect()
}

/// The greatest gap between a triangle and a unit cell along the thirteen axes that can separate
/// them; not positive if they meet.
fn gap(t: &Triangle, cell: IVec3) -> f64 {
    let middle = cell.as_dvec3() + 0.5;
    let edges = [t[1] - t[0], t[2] - t[1], t[0] - t[2]];
    let units = [DVec3::X, DVec3::Y, DVec3::Z];
    let crossed = edges.iter().flat_map(|e| units.map(|u| e.cross(u)));
    let axes = units.into_iter().chain([edges[0].cross(edges[1])]).chain(crossed);
    let along = axes.filter_map(DVec3::try_normalize).map(|axis| {
        let p = t.map(|v| axis.dot(v - middle));
        let reach = axis.abs().element_sum() * 0.5;
        (p[0].min(p[1]).min(p[2]) - reach).max(-reach - p[0].max(p[1]).max(p[2]))
    });
    along.fold(f64::NEG_INFINITY, f64::max)
}

/// The winding number of triangles around a point, by solid angles (Van Oosterom and Strackee
/// 1983).
fn winding(triangles: &[Triangle], at: DVec3) -> f64 {
    let angle = |t: &Triangle| {
        let [a, b, c] = t.map(|p| p - at);
        let (x, y, z) = (a.length(), b.length(), c.length());
        let below = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
        2.0 * a.dot(b.cross(c)).atan2(below)
    };
    triangles.iter().map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

/// A closed star-shaped mesh around the origin: a cube whose corners and face middles are moved.
fn star(dice: &mut Dice) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let corner = |i: i32| IVec3::new(i & 1, i >> 1 & 1, i >> 2).as_vec3() * 2.0 - 1.0;
    let mut points: Vec<Vec3> = (0..8).map(corner).collect();
    let mut triangles = Vec::new();
    for (face, middle) in (8u32..).zip([Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z]) {
        points.push(middle);
        let (right, up) = middle.any_orthonormal_pair();
        let find = |p: Vec3| (0..8).min_by_key(|&i| (points[i as usize].distance(p) * 1e3) as i32).unwrap();
        let ring = [-right - up, right - up, right + up, up - right].map(|p| find(middle + p));
        triangles.extend((0..4).map(|i| [face, ring[i], ring[(i + 1) % 4]]));
    }
    points.iter_mut().for_each(|p| *p *= 0.5 + dice.next());
    (points, triangles)
}

/// Meshes under transforms, and their triangles as placed.
fn placed(points: Vec<Vec3>, triangles: Vec<[u32; 3]>, transform: Affine3A) -> (Instance, Vec<Triangle>) {
    let m = transform.to_cols_array().map(f64::from);
    let at = |p: Vec3| {
        let p = p.as_dvec3();
        DVec3::from_array([0, 1, 2].map(|i| m[i] * p.x + m[3 + i] * p.y + m[6 + i] * p.z + m[9 + i]))
    };
    let world = triangles.iter().map(|t| t.map(|v| at(points[v as usize]))).collect();
    let mesh = TriMesh::bounds_only(points, triangles).unwrap();
    (Instance::new(Arc::new(mesh), transform).unwrap(), world)
}

fn any_transform(dice: &mut Dice, scale: f32) -> Affine3A {
    let axis = (dice.point(-1.0, 1.0) + Vec3::X * 1e-3).normalize();
    let turn = Quat::from_axis_angle(axis, dice.next() * 6.0);
    let mirror = if dice.next() < 0.5 { Vec3::new(-1.0, 1.0, 1.0) } else { Vec3::ONE };
    Affine3A::from_scale_rotation_translation(mirror * scale, turn, dice.point(2.0, 14.0))
}

#[test]
fn meshes_occupy_the_cells_that_brute_force_finds() {
    let mut dice = Dice(1);
    let (mut touched, mut inside) = (0, 0);
    for round in 0..24 {
        let closed = round % 2 == 0;
        let (points, triangles) = match closed {
            true => star(&mut dice),
            false => ((0..9).map(|_| dice.point(-2.0, 2.0)).collect(), vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]]),
        };
        let scale = 1.5 + 3.0 * dice.next();
        let transform = any_transform(&mut dice, scale);
        let (instance, world) = placed(points, triangles, transform);
        assert_eq!(instance.mesh().is_closed(), closed);
        let mut soft = soft(UVec3::splat(16));
        soft.insert(instance, Layer::Moving).unwrap();
        for cell in all_cells(16) {
            let gap = world.iter().map(|t| gap(t, cell)).fold(f64::INFINITY, f64::min);
            let within = closed && winding(&world, cell.as_dvec3() + 0.5).abs() > 0.5;
            let held = soft.is_occupied(Layer::Moving, cell);
            // The rasteriser widens triangles by 1e-12 of their coordinates; the test rounds as
            // well.
            if !(-1e-9..=1e-9).contains(&gap) {
                assert_eq!(held, gap < 0.0 || within, "round {round}, cell {cell}, gap {gap}");
            }
            (touched, inside) = (touched + usize::from(gap < 0.0), inside + usize::from(gap > 0.0 && held));
        }
    }
    assert!(touched > 1500 && inside > 300, "{touched} {inside}");
}

#[test]
fn order_decides_nothing() {
    let mut dice = Dice(2);
    let (points, mut triangles) = star(&mut dice);
    let transform = Affine3A::from_scale_rotation_translation(
        Vec3::splat(5.0),
        Quat::from_rotation_y(0.3),
        Vec3::new(8.0, 8.5, 7.0),
    );
    let ball = Sphere::new(Vec3::new(11.0, 9.0, 3.0), 2.5);
    let turned = Obb::new(Vec3::splat(5.0), Vec3::new(3.0, 1.0, 0.4), Quat::from_rotation_x(0.7));
    let mut first = soft(UVec3::new(17, 16, 13));
    first.insert(placed(points.clone(), triangles.clone(), transform).0, Layer::Fixed).unwrap();
    first.insert(ball, Layer::Fixed).unwrap();
    first.insert(turned, Layer::Moving).unwrap();
    first.rebuild();
    triangles.reverse();
    triangles.rotate_left(5);
    let mut second = soft(UVec3::new(17, 16, 13));
    let moved = second.insert(Sphere::new(Vec3::splat(4.0), 3.0), Layer::Moving).unwrap();
    second.rebuild();
    second.insert(ball, Layer::Fixed).unwrap();
    second.insert(placed(points, triangles, transform).0, Layer::Fixed).unwrap();
    second.rebuild();
    second.update(moved, turned).unwrap();
    second.rebuild();
    crate::pyramid::assert_same(&first, &second);
}

#[test]
fn fixed_and_moving_without_moving_is_fixed() {
    let mut dice = Dice(3);
    let mut grid = soft(UVec3::splat(64));
    let wall = Aabb::new(Vec3::new(0.0, 0.0, 30.0), Vec3::new(64.0, 64.0, 31.0));
    grid.insert(wall, Layer::Fixed).unwrap();
    assert_eq!(grid.rebuild(), 64);
    let alone = grid.clone();
    let ids: Vec<_> = (0..40)
        .map(|_| grid.insert(Sphere::new(dice.point(0.0, 64.0), 6.0 * dice.next()), Layer::Moving).unwrap())
        .collect();
    grid.rebuild();
    for (i, &id) in ids.iter().enumerate().rev() {
        grid.update(id, Sphere::new(dice.point(0.0, 64.0), 4.0)).unwrap();
        if i % 3 == 0 {
            grid.rebuild();
        }
        grid.remove(id).unwrap();
        assert!(grid.remove(id).is_err());
    }
    assert!(grid.rebuild() < 512);
    crate::pyramid::assert_same(&grid, &alone);
    assert_eq!(occupied(&grid, Layer::Moving).len(), 0);
    assert_eq!(grid.rebuild(), 0, "nothing changed since");
    // A small ball that moves makes only its own bricks anew.
    let ball = |x: f32| Sphere::new(Vec3::new(x, 16.0, 16.0), 2.0);
    let id = grid.insert(ball(4.0), Layer::Moving).unwrap();
    assert_eq!(grid.rebuild(), 4);
    grid.update(id, ball(4.5)).unwrap();
    assert_eq!(grid.rebuild(), 4);
}

#[test]
fn a_scene_is_followed() {
    let spec = casca::GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(32) };
    let (mut scene, mut grid) = (Scene::new(&spec).unwrap(), SoftGrid::new(&spec).unwrap());
    let by_hand = Aabb::new(Vec3::splat(28.2), Vec3::splat(29.8));
    grid.insert(by_hand, Layer::Fixed).unwrap();
    let (wall, ball) =
        (Aabb::new(Vec3::ZERO, Vec3::new(2.0, 9.0, 9.0)), |x| Sphere::new(Vec3::splat(x), 2.0));
    let fixed = scene.insert(ObjectDesc::fixed(wall).occluder(wall)).unwrap();
    let moving = scene.insert(ObjectDesc::dynamic(ball(14.0)).occluder(ball(14.0))).unwrap();
    scene.insert(ObjectDesc::dynamic(ball(22.0))).unwrap();
    let same_as = |grid: &SoftGrid, walls: &[Aabb], balls: &[Sphere]| {
        let mut other = SoftGrid::new(&spec).unwrap();
        for &wall in walls {
            other.insert(wall, Layer::Fixed).unwrap();
        }
        for &ball in balls {
            other.insert(ball, Layer::Moving).unwrap();
        }
        other.rebuild();
        crate::pyramid::assert_same(grid, &other);
        for layer in [Layer::Fixed, Layer::Moving] {
            assert_eq!(occupied(grid, layer), occupied(&other, layer));
        }
    };
    assert!(grid.follow(&scene).unwrap() > 0);
    same_as(&grid, &[by_hand, wall], &[ball(14.0)]);
    assert_eq!(grid.follow(&scene).unwrap(), 0);
    scene.update(moving, ball(18.0), Some(ball(18.0).into())).unwrap();
    scene.remove(fixed).unwrap();
    grid.follow(&scene).unwrap();
    same_as(&grid, &[by_hand], &[ball(18.0)]);
    scene.set_occluder(moving, None).unwrap();
    grid.follow(&scene).unwrap();
    same_as(&grid, &[by_hand], &[]);
}

/// Where a segment enters a unit cell that is grown by `room`, as a share of its way.
fn enters(cell: IVec3, from: DVec3, to: DVec3, room: f64) -> Option<f64> {
    let way = to - from;
    let (mut start, mut end) = (0.0f64, 1.0f64);
    for axis in 0..3 {
        let (lo, hi) =
            (f64::from(cell[axis]) - room - from[axis], f64::from(cell[axis] + 1) + room - from[axis]);
        if way[axis] == 0.0 {
            if lo > 0.0 || hi < 0.0 {
                return None;
            }
            continue;
        }
        let (a, b) = (lo / way[axis], hi / way[axis]);
        (start, end) = (start.max(a.min(b)), end.min(a.max(b)));
    }
    (start <= end).then_some(start)
}

/// Points near a grid of 40 cells: anywhere, on the lattice, or in the middle of cells.
fn point() -> impl Strategy<Value = Vec3> {
    (prop::array::uniform3(-8.0f32..48.0), 0..4).prop_map(|(p, kind)| {
        let p = Vec3::from(p);
        match kind {
            0 | 1 => p,
            2 => p.round(),
            _ => p.floor() + 0.5,
        }
    })
}

proptest! {
    #![proptest_config(cases(192))]

    #[test]
    fn walks_find_the_first_of_all_cells(
        cells in prop::collection::vec(prop::array::uniform3(0..40), 1..160),
        ends in prop::collection::vec((point(), point()), 8),
    ) {
        let mut grid = soft(UVec3::splat(40));
        for c in &cells {
            let min = IVec3::from(*c).as_vec3();
            grid.insert(Aabb::new(min + 0.25, min + 0.75), Layer::Fixed).unwrap();
        }
        grid.rebuild();
        for (from, to) in ends {
            let (a, b) = (from.as_dvec3(), to.as_dvec3());
            let first = |room: f64| {
                let all = cells.iter().filter_map(|c| enters(IVec3::from(*c), a, b, room));
                all.reduce(f64::min).map(|share| share * (b - a).length())
            };
            // Cells that the segment only touches may or may not count.
            let (surely, perhaps) = (first(-1e-9), first(1e-9));
            match grid.first_hit(from, to).unwrap() {
                Some(hit) => {
                    prop_assert!(cells.contains(&hit.cell.to_array()));
                    prop_assert!(perhaps.is_some_and(|d| hit.distance > d - 1e-6), "{hit:?} {perhaps:?}");
                    prop_assert!(surely.is_none_or(|d| hit.distance < d + 1e-6), "{hit:?} {surely:?}");
                }
                None => prop_assert!(surely.is_none(), "{from} {to} {surely:?}"),
            }
        }
    }
}
