//! Bounds and occluders of furry objects.

use std::sync::Arc;

use casca::{Aabb, ObjectDesc, Occluder, Sphere, TriMesh};
use glam::{Affine3A, DVec3, Vec3};

use crate::error::Error;
use crate::mesh::Mesh;
use crate::numeric::INNER_ROUNDING;
use crate::strands::Fur;

/// The box around a box and all that is at most `reach` away from it, rounded up.
pub fn inflate(aabb: Aabb, reach: f32) -> Aabb {
    let down = |v: Vec3| Vec3::from_array((v - reach).to_array().map(f32::next_down));
    let up = |v: Vec3| Vec3::from_array((v + reach).to_array().map(f32::next_up));
    Aabb::new(down(aabb.min), up(aabb.max))
}

/// An object for [`casca::Scene::insert`]: the box `base` of a mesh in object space, inflated by
/// the reach of its fur (bent tips included), under a placement. All layers of the mesh lie within
/// these bounds, and so do those of its [levels](Mesh::levels), whose vertices are
/// some of its own.
///
/// `hides` is what hides others, in object space: [`base_occluder`] or [`inner_ball`], or nothing;
/// balls need a placement that scales all axes alike. With `moves`, the object is dynamic.
///
/// # Errors
/// Refuses fur with parameters out of range, as [`Fur::check`].
pub fn furry_object(
    base: Aabb,
    fur: &Fur,
    hides: Option<Occluder>,
    placement: Affine3A,
    moves: bool,
) -> Result<ObjectDesc, Error> {
    let magnitude = base.min.abs().max(base.max.abs()).max_element();
    fur.check(magnitude)?;
    let bounds = inflate(base, fur.reach(magnitude));
    let mut desc = if moves { ObjectDesc::dynamic(bounds) } else { ObjectDesc::fixed(bounds) };
    if let Some(hides) = hides {
        desc = desc.occluder(hides);
    }
    Ok(desc.placed(placement))
}

/// The base mesh as an occluder, prepared once; objects share it. It hides exactly what the opaque
/// base hides, so draw that level of detail and no other: a simplified mesh may be smaller. For
/// several levels use [`inner_ball`]. Costs as [`TriMesh::new`].
///
/// # Errors
/// Refuses meshes that are not closed: one could look through their holes.
pub fn base_occluder(mesh: &Mesh) -> Result<Arc<TriMesh>, Error> {
    match mesh.open_edges() {
        0 => {}
        edges => return Err(Error::Open { edges }),
    }
    let positions = mesh.vertices().iter().map(|v| v.position).collect();
    let mesh = TriMesh::new(positions, mesh.triangles().to_vec());
    mesh.map(Arc::new).map_err(|source| Error::Scene { what: "base mesh", source })
}

/// Cells along each axis of the lattice on which [`inner_ball`] looks for a centre.
const CENTERS: i32 = 12;

/// A large ball inside all meshes, in their common object space; `None` if no point of a coarse
/// lattice is inside all of them. It hides less than the meshes, but safely, whichever level of
/// detail is drawn. Costs 1,728 passes over the triangles of the coarsest mesh, and some over the
/// others.
///
/// # Errors
/// Refuses no meshes, and meshes that are not closed.
pub fn inner_ball(meshes: &[&Mesh]) -> Result<Option<Sphere>, Error> {
    let open = meshes.iter().map(|m| m.open_edges()).find(|&edges| edges > 0);
    if let Some(edges) = open {
        return Err(Error::Open { edges });
    }
    let coarsest = meshes.iter().min_by_key(|m| m.triangles().len()).ok_or(Error::Empty)?;
    let (centers, margin) = deepest(coarsest);
    let mut best: Option<(DVec3, f64)> = None;
    for (center, bound) in centers {
        let least = best.map_or(0.0, |b| b.1);
        if bound - margin <= least {
            break;
        }
        let depth = meshes.iter().map(|m| depth(m, center)).fold(f64::INFINITY, f64::min) - margin;
        if depth > least {
            best = Some((center, depth));
        }
    }
    Ok(best.map(|(center, radius)| Sphere::new(center.as_vec3(), (radius as f32).next_down())))
}

/// Places inside a mesh, deepest first, with their depths, and the margin for rounding. The depths
/// are above it.
fn deepest(mesh: &Mesh) -> (Vec<(DVec3, f64)>, f64) {
    let aabb = mesh.aabb();
    let (lo, size) = (aabb.min.as_dvec3(), (aabb.max - aabb.min).as_dvec3());
    let margin = INNER_ROUNDING * (size.length() + aabb.min.abs().max(aabb.max.abs()).as_dvec3().length());
    let centers = (0..CENTERS.pow(3)).map(|i| {
        let cell =
            DVec3::new((i % CENTERS).into(), (i / CENTERS % CENTERS).into(), (i / CENTERS / CENTERS).into());
        let center = (lo + size * ((cell + 0.5) / f64::from(CENTERS))).as_vec3().as_dvec3();
        (center, depth(mesh, center))
    });
    let mut centers: Vec<(DVec3, f64)> = centers.filter(|c| c.1 > margin).collect();
    centers.sort_by(|a, b| b.1.total_cmp(&a.1));
    (centers, margin)
}

/// How deep a point is inside a closed mesh at rest: the least distance to a triangle; 0 or less
/// outside.
fn depth(mesh: &Mesh, point: DVec3) -> f64 {
    let (mut nearest, mut winding) = (f64::INFINITY, 0.0);
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|v| mesh.vertices()[v as usize].position.as_dvec3() - point);
        nearest = nearest.min(distance(a, b, c));
        // The solid angle of the triangle (van Oosterom & Strackee 1983).
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        winding += 2.0 * a.dot(b.cross(c)).atan2(below);
    }
    // Each turn is 4 pi; inside there is at least one.
    if winding > std::f64::consts::TAU { nearest } else { -nearest.abs() }
}

/// The distance of the origin to a triangle.
fn distance(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let normal = (b - a).cross(c - a);
    let inside = |p: DVec3, q: DVec3| (q - p).cross(-p).dot(normal) >= 0.0;
    if normal != DVec3::ZERO && inside(a, b) && inside(b, c) && inside(c, a) {
        return (a.dot(normal) / normal.length()).abs();
    }
    let segment = |p: DVec3, q: DVec3| {
        let way = q - p;
        let t = (-p.dot(way) / way.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (p + way * t).length()
    };
    segment(a, b).min(segment(b, c)).min(segment(c, a))
}

#[cfg(test)]
mod tests {
    use casca::{ObjectId, Query, Scene, View};

    use super::*;
    use crate::mesh::{Vertex, weld};
    use crate::samples::{ball, cube};

    fn scene() -> Scene {
        Scene::new(0.25).unwrap()
    }

    fn sees(scene: &Scene, eye: Vec3, id: ObjectId) -> bool {
        Query::new().run(scene, &View::omnidirectional(eye).unwrap()).visible().contains(&id)
    }

    fn fur(height: f32, bend: Vec3) -> Fur {
        Fur { bend, ..Fur::for_radius(1.0, height, 0.2).unwrap() }
    }

    #[test]
    fn tips_behind_the_edge_of_a_wall_are_seen() {
        let wall = Aabb::new(Vec3::new(-5.0, 0.0, -0.1), Vec3::new(5.0, 2.0, 0.1));
        let eye = Vec3::new(0.0, 1.9, 5.0);
        let mesh = ball(3);
        let straight = fur(0.6, Vec3::ZERO);
        let bent = fur(0.4, Vec3::Y * 4.0);
        let cases = [
            (straight, Fur { height: 0.0, ..straight }, Vec3::Y, 1.3),
            (bent, Fur { bend: Vec3::ZERO, ..bent }, Vec3::new(0.0, 0.4375, -0.8992), 1.2),
        ];
        for (fur, less, up, y) in cases {
            let place =
                Affine3A::from_translation(Vec3::new(0.0, y, -3.0)) * Affine3A::from_scale(Vec3::splat(0.5));
            // A tip in sight: the way to it passes above the wall.
            let tip = place.transform_point3(fur.extruded(up, up, 1.0));
            let at_wall = eye + (tip - eye) * ((eye.z - 0.1) / (eye.z - tip.z));
            assert!(at_wall.y > wall.max.y + 0.01, "{at_wall}");
            // Bounds without the fur, or without its bend, would lose it.
            for (fur, seen) in [(fur, true), (less, false)] {
                let mut scene = scene();
                scene.insert(ObjectDesc::fixed(wall).occluder(wall)).unwrap();
                let id = scene.insert(furry_object(mesh.aabb(), &fur, None, place, false).unwrap()).unwrap();
                assert_eq!(sees(&scene, eye, id), seen, "{fur:?}");
            }
        }
        // Hardly larger than needed, and an error instead of NaN.
        let reach = fur(0.1, Vec3::ZERO).reach(1.0);
        assert!(reach > 0.1 && reach < 0.10001);
        assert!(furry_object(mesh.aabb(), &fur(0.1, Vec3::NAN), None, Affine3A::IDENTITY, false).is_err());
    }

    #[test]
    fn the_base_hides_and_the_fur_does_not() {
        let mesh = ball(3);
        let hides = base_occluder(&mesh).unwrap();
        let mut scene = scene();
        let desc =
            furry_object(mesh.aabb(), &fur(0.4, Vec3::ZERO), Some(hides.into()), Affine3A::IDENTITY, true);
        let furry = scene.insert(desc.unwrap()).unwrap();
        let small = |y: f32| ObjectDesc::fixed(Sphere::new(Vec3::new(0.0, y, -3.0), 0.05));
        // The base reaches about 1.6 high there, the fur 2.3.
        let [behind_base, behind_fur] = [0.7, 1.95].map(|y| scene.insert(small(y)).unwrap());
        let eye = Vec3::Z * 5.0;
        assert!(sees(&scene, eye, furry) && sees(&scene, eye, behind_fur));
        assert!(!sees(&scene, eye, behind_base));
        scene.remove(furry).unwrap();
        assert!(sees(&scene, eye, behind_base));
    }

    #[test]
    fn inner_balls_lie_inside_all_meshes() {
        let (fine, turn) = (ball(4), glam::Quat::from_rotation_y(0.5));
        // A turned box on top of the ball.
        let upper = |v: &Vertex| Vertex::at(turn * (v.position * 2.0 + Vec3::Y * 2.0));
        let upper: Vec<Vertex> = cube(1.0).iter().map(upper).collect();
        let upper = weld(&upper, &[]).unwrap();
        let sphere = inner_ball(&[&fine, &upper]).unwrap();
        assert_eq!(sphere, None, "they only touch");
        let coarse = fine.levels(3).unwrap().remove(2);
        let sphere = inner_ball(&[&fine, &coarse]).unwrap().unwrap();
        assert!((0.7..1.0).contains(&(sphere.center.length() + sphere.radius)), "{sphere:?}");
        for mesh in [&fine, &coarse] {
            assert!(depth(mesh, sphere.center.as_dvec3()) > sphere.radius.into());
            // Outside of a mesh nothing is deep.
            assert!(depth(mesh, DVec3::ONE) < 0.0 && depth(mesh, DVec3::X * 1.01) < 0.0);
        }
    }

    #[test]
    fn open_meshes_hide_nothing() {
        let soup = cube(1.0);
        let open = weld(&soup[3..], &[]).unwrap();
        assert_eq!(base_occluder(&open).err(), Some(Error::Open { edges: 3 }));
        assert_eq!(inner_ball(&[&open]), Err(Error::Open { edges: 3 }));
        assert_eq!(inner_ball(&[]), Err(Error::Empty));
        // Inside out, no point has a solid around it.
        let closed = weld(&soup, &[]).unwrap();
        let turned = closed.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
        let turned = Mesh::new(closed.vertices().to_vec(), Vec::new(), turned).unwrap();
        assert_eq!(inner_ball(&[&turned]), Ok(None));
    }
}
