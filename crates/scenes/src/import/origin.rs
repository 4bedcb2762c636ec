//! Scenes far from the origin of their file, which are moved to one of their own.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{Affine3A, DAffine3, DVec3};

use super::path::Moving;
use crate::numeric::{FAR, LEAST_SIZE};
use crate::world::{FilePart, Mesh, Object, Shape, box_corners};

/// The objects of a file.
#[derive(Default)]
pub(super) struct Found {
    pub(super) objects: Vec<Object>,
    /// By object: where it is at rest, in the coordinates of the file.
    pub(super) places: Vec<DAffine3>,
    /// By object.
    pub(super) parts: Vec<FilePart>,
    pub(super) moving: Vec<Moving>,
}

/// A mesh that is kept, its box, and the middle of that if the mesh is moved there.
struct Centred {
    mesh: Arc<Mesh>,
    corners: [DVec3; 8],
    middle: DVec3,
}

/// Moves objects to an origin near them if they lie far away, seen from their size, and gives that
/// origin; zero if they stay. Meshes whose own coordinates are far are moved, too.
pub(super) fn moved(found: &mut Found) -> DVec3 {
    let mut meshes: HashMap<*const Mesh, Centred> = HashMap::new();
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for (object, place) in found.objects.iter().zip(&found.places) {
        let Shape::Mesh { mesh, .. } = &object.shape else {
            if let Shape::Box { min: low, max: high } = &object.shape {
                (min, max) = (min.min(low.as_dvec3()), max.max(high.as_dvec3()));
            }
            continue;
        };
        let known = meshes.entry(Arc::as_ptr(mesh)).or_insert_with(|| {
            let (low, high) = mesh.bounds(&Affine3A::IDENTITY);
            let corners = box_corners(low, high).map(|corner| corner.as_dvec3());
            Centred { mesh: mesh.clone(), corners, middle: DVec3::ZERO }
        });
        for corner in known.corners {
            let corner = place.transform_point3(corner);
            (min, max) = (min.min(corner), max.max(corner));
        }
    }
    let size = (max - min).max_element().max(LEAST_SIZE.into());
    let is_far = |way: DVec3| way.abs().max_element() > FAR * size;
    let middle = (min + max) * 0.5;
    // Single precision holds its numbers: whole ones, unless the scene is small.
    let step = size.log2().floor().exp2();
    let origin =
        if is_far(middle) { ((middle / step).round() * step).as_vec3().as_dvec3() } else { DVec3::ZERO };
    for (object, place) in found.objects.iter().zip(&found.places) {
        let Shape::Mesh { mesh, .. } = &object.shape else { continue };
        let Some(known) = meshes.get_mut(&Arc::as_ptr(mesh)) else { continue };
        let middle = (known.corners[0] + known.corners[7]).as_vec3() * 0.5;
        if is_far(place.transform_vector3(middle.as_dvec3())) && known.middle == DVec3::ZERO {
            known.middle = middle.as_dvec3();
            let positions = mesh.positions.iter().map(|&p| p - middle).collect();
            let (triangles, sides) = (mesh.triangles.clone(), mesh.sides.clone());
            known.mesh = Arc::new(Mesh { positions, triangles, sides });
        }
    }
    let about = |place: DAffine3, by: DVec3| place * DAffine3::from_translation(by);
    for (object, place) in found.objects.iter_mut().zip(&found.places) {
        let Shape::Mesh { mesh, transform } = &mut object.shape else {
            if let Shape::Box { min, max } = &mut object.shape {
                (*min, *max) = (*min - origin.as_vec3(), *max - origin.as_vec3());
            }
            continue;
        };
        let Some(known) = meshes.get(&Arc::as_ptr(mesh)) else { continue };
        let mut place = about(*place, known.middle);
        place.translation -= origin;
        (*mesh, *transform) = (known.mesh.clone(), place.as_affine3a());
    }
    for moving in &mut found.moving {
        let Some(known) = meshes.get(&Arc::as_ptr(&moving.mesh)) else { continue };
        moving.place = about(moving.place, known.middle);
        moving.mesh = known.mesh.clone();
    }
    origin
}
