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

/// An object for [`casca::Scene::insert`]: the box `base` of a mesh in object space, inflated by the reach of its fur (bent tips
/// included), under a placement. All layers of the mesh lie within these bounds, and so do those of its [`simplified`](Mesh::simplified)
/// levels, whose vertices are some of its own.
///
/// `hides` is what hides others, in object space: [`base_occluder`] or [`inner_ball`], or nothing. With `moves`, the object is dynamic.
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

/// The base mesh as an occluder, prepared once; objects share it. It hides exactly what the opaque base hides, so draw that level of
/// detail and no other: a simplified mesh may be smaller. For several levels use [`inner_ball`]. Costs a second for half a million triangles.
///
/// # Errors
/// Refuses meshes that are not closed: one could look through their holes.
pub fn base_occluder(mesh: &Mesh) -> Result<Arc<TriMesh>, Error> {
    match mesh.open_edges() {
        0 => {}
        edges => return Err(Error::Open { edges }),
    }
    let mesh = TriMesh::new(mesh.positions(), mesh.triangles().to_vec());
    mesh.map(Arc::new).map_err(|source| Error::Scene { what: "base mesh", source })
}

/// Cells along each axis of the lattice on which [`inner_ball`] looks for a centre.
const CENTERS: i32 = 8;

/// A large ball inside all meshes, in their common object space; `None` if no point of a coarse lattice is inside all of them. It hides
/// less than the meshes, but safely, whichever level of detail is drawn. Costs 512 passes over all triangles.
///
/// # Errors
/// Refuses no meshes, and meshes that are not closed.
pub fn inner_ball(meshes: &[&Mesh]) -> Result<Option<Sphere>, Error> {
    let open = meshes.iter().map(|m| m.open_edges()).find(|&edges| edges > 0);
    if let Some(edges) = open {
        return Err(Error::Open { edges });
    }
    let Some(aabb) = meshes.iter().map(|m| m.aabb()).reduce(|a, b| a.union(&b)) else {
        return Err(Error::Empty);
    };
    let (lo, size) = (aabb.min.as_dvec3(), (aabb.max - aabb.min).as_dvec3());
    let margin = INNER_ROUNDING * (size.length() + aabb.min.abs().max(aabb.max.abs()).as_dvec3().length());
    let mut best: Option<(DVec3, f64)> = None;
    for i in 0..CENTERS.pow(3) {
        let place =
            DVec3::new((i % CENTERS).into(), (i / CENTERS % CENTERS).into(), (i / CENTERS / CENTERS).into());
        let center = (lo + size * ((place + 0.5) / f64::from(CENTERS))).as_vec3().as_dvec3();
        let depths = meshes.iter().map(|m| depth(m, center));
        let depth = depths.fold(f64::INFINITY, f64::min) - margin;
        if depth > best.map_or(0.0, |b| b.1) {
            best = Some((center, depth));
        }
    }
    Ok(best.map(|(center, radius)| Sphere::new(center.as_vec3(), (radius as f32).next_down())))
}

/// How deep a point is inside a closed mesh: its distance to the nearest triangle; 0 or less outside.
fn depth(mesh: &Mesh, point: DVec3) -> f64 {
    let (mut nearest, mut winding) = (f64::INFINITY, 0.0);
    for t in mesh.triangles() {
        let [a, b, c] = t.map(|v| mesh.vertices()[v as usize].position.as_dvec3() - point);
        nearest = nearest.min(distance(a, b, c));
        // The solid angle of the triangle (van Oosterom & Strackee 1983).
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        winding += 2.0 * a.dot(b.cross(c)).atan2(below);
    }
    // Each turn is 4 pi; inside there is at least one.
    if winding > std::f64::consts::TAU { nearest } else { -nearest }
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
