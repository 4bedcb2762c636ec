//! The solid inside a mesh against winding numbers along rays.

use std::ops::ControlFlow;
use std::sync::Arc;

use super::*;
use crate::geometry::Sphere;
use crate::mesh::{Facing, MeshOptions, TriMesh};
use crate::object::ObjectDesc;
use crate::query::Query;
use crate::random::Random;
use crate::scene::Scene;
use crate::view::View;

type Made = (Vec<Vec3>, Vec<[u32; 3]>);

/// A closed mesh of `n` by `m` quadrilaterals that wrap around in both directions.
fn wrapped(n: u32, m: u32, at: impl Fn(f64, f64) -> DVec3) -> Made {
    let turn = |i: u32, n: u32| std::f64::consts::TAU * f64::from(i) / f64::from(n);
    let corner = |i: u32, j: u32| i % n * m + j % m;
    let positions = (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
    let positions = positions.map(|(i, j)| at(turn(i, n), turn(j, m)).as_vec3()).collect();
    let quads = (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
    let halves = |(i, j)| {
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    (positions, quads.flat_map(halves).collect())
}

fn torus(bumps: f64, thick: f64, random: &mut Random) -> Made {
    let (a, b) = (random.next() * 6.0, random.next() * 6.0);
    wrapped(24, 16, |u, v| {
        let r = thick * (1.0 + bumps * ((3.0 * u + a).sin() * (2.0 * v + b).sin()));
        DVec3::new((1.0 + r * v.cos()) * u.cos(), (1.0 + r * v.cos()) * u.sin(), r * v.sin())
    })
}

/// A ball with bumps and dents, along its axes as large as `size`.
fn ball(bumps: f64, size: DVec3, random: &mut Random) -> Made {
    let waves: Vec<(DVec3, f64)> = (0..6).map(|_| (random.point(1.0) * 5.0, random.next() * 6.0)).collect();
    let bump = |d: DVec3| waves.iter().map(|(k, phase)| (k.dot(d) + phase).sin()).sum::<f64>() / 6.0;
    let (rows, columns) = (12u32, 16u32);
    let at = |i: u32, j: u32| {
        let up = std::f64::consts::PI * f64::from(i) / f64::from(rows);
        let around = std::f64::consts::TAU * f64::from(j % columns) / f64::from(columns);
        let ring = if i == 0 || i == rows { 0.0 } else { up.sin() };
        let d = DVec3::new(ring * around.cos(), ring * around.sin(), up.cos());
        (d * size * (1.0 + bumps * bump(d))).as_vec3()
    };
    let quads = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
    let corners = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    let corners: Vec<Vec3> = corners.filter(|[a, b, c]| a != b && b != c && c != a).flatten().collect();
    let triangles = (0..corners.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    (corners, triangles)
}

/// Two meshes as one.
fn both(one: Made, other: Made) -> Made {
    let (mut positions, mut triangles) = one;
    let base = positions.len() as u32;
    positions.extend(other.0);
    triangles.extend(other.1.iter().map(|t| t.map(|v| v + base)));
    (positions, triangles)
}

fn placed((positions, triangles): Made, place: impl Fn(Vec3) -> Vec3) -> Made {
    (positions.into_iter().map(place).collect(), triangles)
}

fn turned((positions, mut triangles): Made) -> Made {
    triangles.iter_mut().for_each(|t| t.swap(0, 1));
    (positions, triangles)
}

fn prepare((positions, triangles): Made, facing: Facing) -> TriMesh {
    let how = MeshOptions::default().facing(facing);
    TriMesh::prepare(positions, triangles, &how, &mut |_| ControlFlow::Continue(())).unwrap()
}

/// A ray that passes an edge at less than this, as a product of three lengths of about 1, is not
/// counted: roundings of double precision are a thousandth of it.
const NEAR_EDGE: f64 = 1e-12;

/// How often a mesh winds around a point, by the triangles that a ray passes; `None` if it comes
/// close to an edge.
fn winding_along(mesh: &TriMesh, from: DVec3, way: DVec3) -> Option<i32> {
    let mut sum = 0;
    for corners in mesh.all_corners() {
        let [a, b, c] = corners.map(|p| p - from);
        let sides = [(a, b), (b, c), (c, a)].map(|(p, q)| way.dot(p.cross(q)));
        if sides.iter().any(|s| s.abs() < NEAR_EDGE) {
            return None;
        }
        let normal = (b - a).cross(c - a);
        if sides.iter().all(|&s| s > 0.0) && normal.dot(a) / normal.dot(way) > 0.0 {
            sum += 1;
        } else if sides.iter().all(|&s| s < 0.0) && normal.dot(a) / normal.dot(way) > 0.0 {
            sum -= 1;
        }
    }
    Some(sum)
}

/// Checks that a mesh winds around points of its solid, if it has one. Returns the share of the
/// volume in it.
fn check(made: Made, facing: Facing, random: &mut Random) -> Option<f64> {
    let mesh = prepare(made, facing);
    let solid = &mesh.inner()?.solid;
    for _ in 0..60 {
        let weights: Vec<f64> = solid.vertices.iter().map(|_| random.next().powi(8)).collect();
        let sum: DVec3 = solid.vertices.iter().zip(&weights).map(|(v, w)| *v * *w).sum();
        let p = sum / weights.iter().sum::<f64>();
        let wound = (0..8).find_map(|_| winding_along(&mesh, p, random.point(1.0).normalize()))?;
        assert!(wound != 0 && (facing == Facing::Both || wound > 0), "{p}: {wound}");
    }
    Some(solid.volume() / Moments::of(mesh.all_corners())?.volume)
}

#[test]
fn balls_are_nearly_filled() {
    let mut random = Random::new(2);
    for (bumps, least) in [(0.0, 0.7), (0.1, 0.6), (0.25, 0.4)] {
        for far in [0.0, 300.0] {
            let rough = ball(bumps, DVec3::new(1.0, 2.0, 0.5), &mut random);
            let share = check(placed(rough, |p| p + far), Facing::Both, &mut random);
            assert!(share.is_some_and(|share| share > least), "{bumps} {far}: {share:?}");
        }
    }
}

#[test]
fn meshes_wind_around_their_solids() {
    let mut random = Random::new(2);
    let mut found = [0; 6];
    for round in 0..40 {
        let bumps = f64::from(round) / 40.0;
        let size = (random.point(1.0).abs() + 0.05) * 2.0;
        let made = [
            ball(bumps, size, &mut random),
            torus(bumps, 0.2 + 0.7 * random.next(), &mut random),
            // A shell within another one, one beside another one, and two that touch in a point.
            both(ball(0.0, size, &mut random), turned(ball(bumps, size * 0.2, &mut random))),
            both(ball(bumps, size, &mut random), placed(ball(0.0, size, &mut random), |p| p + Vec3::X * 5.0)),
            both(
                ball(0.0, DVec3::ONE, &mut random),
                placed(ball(0.0, DVec3::ONE, &mut random), |p| p + Vec3::Z * 2.0),
            ),
            // A thin plate.
            ball(0.02 * bumps, DVec3::new(1.0, 1.0, 0.01), &mut random),
        ];
        for (made, found) in made.into_iter().zip(&mut found) {
            for facing in [Facing::Both, Facing::Front] {
                *found += i32::from(check(made.clone(), facing, &mut random).is_some());
                *found += i32::from(check(turned(made.clone()), facing, &mut random).is_some());
            }
        }
    }
    assert!(found[0] > 60 && found[5] > 60, "{found:?}");
}

#[test]
fn inverted_meshes_that_hide_from_their_front_have_no_solid() {
    let made = || ball(0.1, DVec3::ONE, &mut Random::new(3));
    assert!(
        prepare(made(), Facing::Front).inner().is_some()
            != prepare(turned(made()), Facing::Front).inner().is_some()
    );
    assert!(
        prepare(made(), Facing::Both).inner().is_some()
            && prepare(turned(made()), Facing::Both).inner().is_some()
    );
}

#[test]
fn an_eye_between_solid_and_mesh_sees_past_the_solid() {
    for facing in [Facing::Both, Facing::Front] {
        let rough = placed(ball(0.1, DVec3::ONE, &mut Random::new(5)), |p| p * 10.0);
        // Normals outwards, so that it has a solid whichever way it faces.
        let mesh = [rough.clone(), turned(rough)].map(|made| prepare(made, facing));
        let mesh = mesh.into_iter().find(|m| m.inner().is_some() && m.surface().outward > 0.0).unwrap();
        let solid = mesh.inner().unwrap().solid.clone();
        // Along the ray through the middle of a face there is room between solid and mesh, or next
        // to it.
        let ends = [1.0, -1.0].map(|side| {
            let far = |t: f64| DVec3::X * side * t;
            let outside = |p: DVec3| solid.faces.iter().any(|f| f.beyond(p) > 0.01);
            let steps = (0..1000).map(|i| far(f64::from(i) * 0.012));
            steps.into_iter().find(|&p| outside(p)).unwrap().as_vec3()
        });
        let mut scene = Scene::new(1.0).unwrap();
        let mesh = Arc::new(mesh);
        let inside = |p: Vec3| winding_along(&mesh, p.as_dvec3(), DVec3::new(0.31, 0.9, 0.17)) != Some(0);
        assert!(ends.into_iter().all(inside), "{ends:?}");
        let ball = scene.insert(ObjectDesc::fixed(mesh.clone()).occluder(mesh.clone())).unwrap();
        let thing = scene.insert(ObjectDesc::fixed(Sphere::new(ends[1], 0.005))).unwrap();
        let mut query = Query::new();
        let seen: Vec<_> = query.run(&scene, &View::omnidirectional(ends[0]).unwrap()).iter().collect();
        assert!(seen.contains(&thing) && seen.contains(&ball), "{facing:?}");
        // From afar it hides the thing.
        let seen: Vec<_> =
            query.run(&scene, &View::omnidirectional(Vec3::X * 60.0).unwrap()).iter().collect();
        assert!(!seen.contains(&thing) && seen.contains(&ball), "{facing:?}");
    }
}
