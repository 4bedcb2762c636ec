//! Prepares arbitrary triangles in arbitrary ways, looks at them from some eyes, and checks that
//! nothing panics, that broken meshes are refused, and that no ray reaches an object left out.
#![no_main]

use std::ops::ControlFlow;
use std::sync::Arc;

use arbitrary::Arbitrary;
use casca::{
    Aabb, Bounds, Error, Facing, Instance, MeshOptions, Method, ObjectDesc, Occluder, PointOptions, Query,
    Scene, TriMesh, View,
};
use glam::{Affine3A, DAffine3, DVec3, Vec3};
use libfuzzer_sys::fuzz_target;

mod coordinates;
use coordinates::{Coordinate, Point};

/// Many triangles that once cost far more than their number.
#[derive(Debug, Clone, Copy, Arbitrary)]
enum Worst {
    /// Large slanted triangles across the grid.
    Slanted(u8),
    /// Triangles around a vertex.
    Around(u8),
    /// Triangles that share an edge.
    Leaves(u8),
    /// Long teeth in a row.
    Comb(u8),
    /// One triangle again and again, with vertices of its own or not.
    Same(u8, bool),
}

impl Worst {
    /// Corners that lie around the grid, and triangles.
    fn make(self) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let turn = |i: u32, n: u32| std::f32::consts::TAU * i as f32 / n as f32;
        match self {
            Self::Slanted(n) => {
                let n = 1 + u32::from(n);
                let corner =
                    |i: u32| Vec3::new((i * 37 % 101) as f32, (i * 53 % 97) as f32, (i * 29 % 103) as f32);
                let corners = (0..3 * n).map(|i| corner(i) * 0.3 - 3.0).collect();
                (corners, (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
            }
            Self::Around(n) => {
                let n = 3 + u32::from(n);
                let rim = |i| {
                    Vec3::new(
                        12.0 + 9.0 * turn(i, n).cos(),
                        12.0 + (i % 3) as f32,
                        12.0 + 9.0 * turn(i, n).sin(),
                    )
                };
                let corners = [Vec3::splat(12.0)].into_iter().chain((0..n).map(rim)).collect();
                (corners, (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect())
            }
            Self::Leaves(n) => {
                let n = 1 + u32::from(n);
                let tip = |i| Vec3::new(12.0 + 9.0 * turn(i, n).cos(), 12.0, 12.0 + 9.0 * turn(i, n).sin());
                let edge = [Vec3::new(12.0, 2.0, 12.0), Vec3::new(12.0, 22.0, 12.0)];
                (edge.into_iter().chain((0..n).map(tip)).collect(), (0..n).map(|i| [0, 1, i + 2]).collect())
            }
            Self::Comb(n) => {
                let n = 1 + u32::from(n);
                let at = |i: f32| 1.0 + 22.0 * i / n as f32;
                let ridge = (0..=n).flat_map(|i| [2.0, 1.0].map(|y| Vec3::new(at(i as f32), y, 10.0)));
                let tips = (0..n).map(|i| Vec3::new(at(i as f32 + 0.5), 23.0 - 0.03 * i as f32, 10.0));
                let tip = 2 * n + 2;
                let tooth = |i: u32| {
                    let (a, b, c, d) = (2 * i, 2 * i + 2, 2 * i + 1, 2 * i + 3);
                    [[a, b, tip + i], [b, a, c], [b, c, d]]
                };
                (ridge.chain(tips).collect(), (0..n).flat_map(tooth).collect())
            }
            Self::Same(n, apart) => {
                let n = 1 + u32::from(n);
                let corners =
                    [Vec3::new(2.0, 3.0, 9.0), Vec3::new(21.0, 4.0, 11.0), Vec3::new(9.0, 20.0, 14.0)];
                let first = |i: u32| if apart { 3 * i } else { 0 };
                (corners.repeat(n as usize), (0..n).map(|i| [0, 1, 2].map(|k| first(i) + k)).collect())
            }
        }
    }
}

#[derive(Debug, Arbitrary)]
struct Mesh {
    worst: Option<Worst>,
    positions: Vec<Point>,
    triangles: Vec<[u8; 3]>,
    tolerance: Option<Coordinate>,
    least: Option<Coordinate>,
    angle: Option<Coordinate>,
    front: bool,
    bounds_only: bool,
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
    let mut scene = Scene::new(1.0).expect("a plain grid");
    let mut ids = Vec::new();
    let mut walls: Vec<Wall> = Vec::new();
    let mut points: Vec<Vec<DVec3>> = Vec::new();
    for mesh in play.meshes.iter().take(6) {
        let mut positions: Vec<Vec3> = mesh.positions.iter().take(64).map(|p| p.value()).collect();
        let n = positions.len() as u32;
        // Indices are valid but for a few.
        let index = |v: u8| if v == 255 { u32::from(v) } else { u32::from(v) % n.max(1) };
        let mut triangles: Vec<[u32; 3]> = mesh.triangles.iter().take(128).map(|t| t.map(index)).collect();
        if let Some(worst) = mesh.worst {
            (positions, triangles) = worst.make();
        }
        let n = positions.len() as u32;
        let mut how = MeshOptions::default();
        how.tolerance = mesh.tolerance.map(Coordinate::value);
        how.min_radius = mesh.least.map(Coordinate::value);
        how.max_angle = mesh.angle.map(Coordinate::value);
        how.facing = if mesh.front { Facing::Front } else { Facing::Both };
        how.occludes = !mesh.bounds_only;
        let broken = positions.iter().any(|p| !p.is_finite())
            || triangles.is_empty()
            || triangles.iter().flatten().any(|&v| v >= n);
        let length = |v: Option<f32>| v.is_none_or(|v| v >= 0.0 && v.is_finite());
        let badly = how.max_angle.is_some_and(|a| !(0.0..=80.0).contains(&a))
            || !length(how.tolerance)
            || !length(how.min_radius);
        let made =
            TriMesh::prepare(positions.clone(), triangles.clone(), &how, &mut |_| ControlFlow::Continue(()));
        assert_eq!(made.is_err(), broken || badly, "{made:?}");
        let Ok(made) = made else { continue };
        let made = Arc::new(made);
        let transform = mesh.transform.map(|t| Affine3A::from_cols_array(&t.map(Coordinate::value)));
        let place = transform.map_or(DAffine3::IDENTITY, |a| a.as_daffine3());
        let owner = ids.len();
        let occluder = match transform {
            Some(transform) => {
                let Ok(instance) = Instance::new(made, transform) else { continue };
                Occluder::from(instance)
            }
            None => Occluder::from(made),
        };
        let bounds = match occluder.clone() {
            Occluder::Instance(instance) => Bounds::from(instance),
            Occluder::Mesh(mesh) => Bounds::from(mesh),
            other => unreachable!("{other:?} is no mesh"),
        };
        let desc = if mesh.dynamic { ObjectDesc::dynamic(bounds) } else { ObjectDesc::fixed(bounds) };
        let hiding = scene.insert(desc.clone().occluder(occluder));
        let id = if mesh.bounds_only {
            assert_eq!(hiding, Err(Error::BoundsOnly));
            scene.insert(desc)
        } else {
            hiding
        };
        ids.push(id.expect("a checked mesh"));
        let corner = |v: u32| place.transform_point3(positions[v as usize].as_dvec3());
        let triangles: Vec<[DVec3; 3]> = triangles.iter().map(|t| t.map(corner)).collect();
        let middles = triangles.iter().map(|t| (t[0] + t[1] + t[2]) / 3.0);
        points
            .push(middles.chain(triangles.iter().map(|t| t[0] * 0.98 + t[1] * 0.01 + t[2] * 0.01)).collect());
        let determinant = place.matrix3.determinant();
        // What is flat has no front.
        let hides = !mesh.bounds_only && (!mesh.front || determinant.abs() > 1e-9);
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
    let options = PointOptions::default().pixel_degrees(0.5 + f32::from(play.pixels % 16) * 0.25);
    let options = options.min_pixels(0).refine_squares(u32::from(play.pixels) * 4);
    for eye in play.eyes.iter().take(3) {
        let Ok(view) = View::omnidirectional(eye.value()) else { continue };
        for method in [Method::Point(options), Method::cell()] {
            let mut query = Query::with_method(method).expect("settings in range");
            let pvs = query.run(&scene, &view);
            let eye = eye.value().as_dvec3();
            if eye.abs().max_element() > 1e4 {
                continue;
            }
            for (i, id) in ids.iter().enumerate().filter(|(_, id)| !pvs.contains(**id)) {
                // Some of many: each is looked at through all triangles.
                let step = 1 + points[i].len() / 64;
                for &p in points[i].iter().step_by(step).filter(|p| p.abs().max_element() < 1e4) {
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
