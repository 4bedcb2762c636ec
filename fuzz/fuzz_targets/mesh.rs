//! Prepares arbitrary triangles in arbitrary ways, looks at them from some eyes, and checks that
//! nothing panics, that broken meshes are refused, and that no ray reaches an object left out.
#![no_main]

use std::sync::Arc;

use arbitrary::Arbitrary;
use casca::{
    Aabb, Facing, GridSpec, Instance, Method, ObjectDesc, Preparation, Query, Scene, Settings, TriMesh, View,
};
use glam::{Affine3A, DAffine3, DVec3, UVec3, Vec3};
use libfuzzer_sys::fuzz_target;

mod coordinates;
use coordinates::{Coordinate, Point};

#[derive(Debug, Arbitrary)]
struct Mesh {
    positions: Vec<Point>,
    triangles: Vec<[u8; 3]>,
    tolerance: Option<Coordinate>,
    least: Option<Coordinate>,
    angle: Option<Coordinate>,
    front: bool,
    transform: Option<[Coordinate; 12]>,
    dynamic: bool,
}

#[derive(Debug, Arbitrary)]
struct Play {
    meshes: Vec<Mesh>,
    targets: Vec<(Point, u8)>,
    eyes: Vec<Point>,
    pixels: u8,
}

/// Two-sided triangles that may hide, and what they belong to.
struct Wall {
    triangles: Vec<[DVec3; 3]>,
    owner: usize,
    front: bool,
    mirrored: bool,
}

/// Whether a triangle may keep an eye from a point: in doubt, yes.
fn may_block(t: &[DVec3; 3], wall: &Wall, eye: DVec3, target: DVec3) -> bool {
    let ray = target - eye;
    let [a, b, c] = t.map(|v| v - eye);
    let edge = |p: DVec3, q: DVec3| (ray.dot(p.cross(q)), 1e-10 * ray.length() * p.length() * q.length());
    let edges = [edge(a, b), edge(b, c), edge(c, a)];
    let positive = edges.iter().all(|e| !(e.0 < -e.1));
    let negative = edges.iter().all(|e| !(e.0 > e.1));
    if !positive && !negative {
        return false;
    }
    if positive && negative {
        return true;
    }
    let normal = (b - a).cross(c - a);
    let towards = normal.dot(ray);
    if wall.front && (towards > 0.0) != wall.mirrored {
        return false;
    }
    let at = normal.dot(a) / towards;
    !(at > 1.0 + 1e-6 || at < -1e-6)
}

fuzz_target!(|play: Play| {
    let mut scene =
        Scene::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(24) }).expect("a plain grid");
    let mut ids = Vec::new();
    let mut walls: Vec<Wall> = Vec::new();
    let mut points: Vec<Vec<DVec3>> = Vec::new();
    for mesh in play.meshes.iter().take(6) {
        let positions: Vec<Vec3> = mesh.positions.iter().take(64).map(|p| p.value()).collect();
        let n = positions.len() as u32;
        // Indices are valid but for a few.
        let index = |v: u8| if v == 255 { u32::from(v) } else { u32::from(v) % n.max(1) };
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().take(128).map(|t| t.map(index)).collect();
        let mut how = Preparation::default();
        how.tolerance = mesh.tolerance.map(Coordinate::value);
        how.least_radius = mesh.least.map(Coordinate::value);
        how.max_angle = mesh.angle.map(Coordinate::value);
        how.facing = if mesh.front { Facing::Front } else { Facing::Both };
        let broken = positions.iter().any(|p| !p.is_finite())
            || triangles.is_empty()
            || triangles.iter().flatten().any(|&v| v >= n);
        let length = |v: Option<f32>| v.is_none_or(|v| v >= 0.0 && v.is_finite());
        let badly = how.max_angle.is_some_and(|a| !(0.0..=80.0).contains(&a))
            || !length(how.tolerance)
            || !length(how.least_radius);
        let made = TriMesh::prepare(positions.clone(), triangles.clone(), &how, &mut |_| ());
        assert_eq!(made.is_err(), broken || badly, "{made:?}");
        let Ok(made) = made else { continue };
        let made = Arc::new(made);
        let transform = mesh.transform.map(|t| Affine3A::from_cols_array(&t.map(Coordinate::value)));
        let place = transform.map_or(DAffine3::IDENTITY, |a| a.as_daffine3());
        let owner = ids.len();
        let id = match transform {
            Some(transform) => {
                let Ok(instance) = Instance::new(made, transform) else { continue };
                let desc = if mesh.dynamic {
                    ObjectDesc::dynamic(instance.clone())
                } else {
                    ObjectDesc::fixed(instance.clone())
                };
                scene.insert(desc.occluder(instance))
            }
            None if mesh.dynamic => scene.insert(ObjectDesc::dynamic(made.clone()).occluder(made)),
            None => scene.insert(ObjectDesc::fixed(made.clone()).occluder(made)),
        };
        ids.push(id.expect("a checked mesh"));
        let corner = |v: u32| place.transform_point3(positions[v as usize].as_dvec3());
        let triangles: Vec<[DVec3; 3]> = triangles.iter().map(|t| t.map(corner)).collect();
        let middles = triangles.iter().map(|t| (t[0] + t[1] + t[2]) / 3.0);
        points
            .push(middles.chain(triangles.iter().map(|t| t[0] * 0.98 + t[1] * 0.01 + t[2] * 0.01)).collect());
        let determinant = place.matrix3.determinant();
        // What is flat has no front.
        let hides = !mesh.front || determinant.abs() > 1e-9;
        let triangles = if hides { triangles } else { Vec::new() };
        walls.push(Wall { triangles, owner, front: mesh.front, mirrored: determinant < 0.0 });
    }
    for (at, size) in play.targets.iter().take(16) {
        let (at, half) = (at.value(), f32::from(*size) / 256.0);
        let Ok(id) = scene.insert(ObjectDesc::fixed(Aabb::new(at - half, at + half))) else { continue };
        ids.push(id);
        let (min, max) = ((at - half).as_dvec3(), (at + half).as_dvec3());
        let pick = |i: u32| DVec3::select(glam::BVec3::new(i & 1 == 0, i & 2 == 0, i & 4 == 0), min, max);
        points.push((0..8).map(pick).chain([(min + max) * 0.5]).collect());
    }
    let mut settings = Settings::default();
    settings.pixel_degrees = 0.5 + f32::from(play.pixels % 16) * 0.25;
    settings.min_pixels = 0;
    settings.refine_squares = u32::from(play.pixels) * 4;
    for eye in play.eyes.iter().take(3) {
        let Ok(view) = View::around(eye.value()) else { continue };
        for method in [Method::Point, Method::Cell] {
            settings.method = method;
            let mut query = Query::with_settings(settings).expect("settings in range");
            let pvs = query.run(&scene, &view);
            let eye = eye.value().as_dvec3();
            if eye.abs().max_element() > 1e4 {
                continue;
            }
            for (i, id) in ids.iter().enumerate().filter(|(_, id)| !pvs.contains(**id)) {
                for &p in points[i].iter().filter(|p| p.abs().max_element() < 1e4) {
                    let blocked = walls
                        .iter()
                        .filter(|w| w.owner != i)
                        .any(|w| w.triangles.iter().any(|t| may_block(t, w, eye, p)));
                    assert!(blocked, "{method:?}: {id} is left out, and seen at {p} from {eye}");
                }
            }
        }
    }
});
