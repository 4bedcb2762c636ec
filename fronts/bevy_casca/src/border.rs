//! The border between two versions of glam: Bevy's own, and the one that casca was built with.
//! Numbers cross it as arrays, so that nobody else has to know.

use bevy_camera::primitives::Aabb;
use bevy_math::{Affine3A, Mat4, Vec3, Vec3A};
use casca::glam;

pub(crate) fn vec3(v: Vec3) -> glam::Vec3 {
    v.to_array().into()
}

pub(crate) fn mat4(m: &Mat4) -> glam::Mat4 {
    glam::Mat4::from_cols_array(&m.to_cols_array())
}

pub(crate) fn affine(a: &Affine3A) -> glam::Affine3A {
    glam::Affine3A::from_cols_array(&a.to_cols_array())
}

/// Bevy has the middle of a box and half of its edges. Each of the four roundings on the way there
/// and back is of half an epsilon of their sum, at most.
const ROUNDING: f32 = 4.0 * f32::EPSILON;

/// The box, with room for the rounding of a middle and half of an edge.
pub(crate) fn aabb(b: &Aabb) -> casca::Aabb {
    let room = (b.center.abs() + b.half_extents.abs()) * ROUNDING;
    casca::Aabb::new(vec3((b.min() - room).into()), vec3((b.max() + room).into()))
}

/// What rounding may add to the range of a light, and more.
pub(crate) const SLACK: f32 = 1.001;

/// What rounding may do to places as far away as this, and more.
pub(crate) fn rounding(place: Vec3A) -> f32 {
    place.abs().max_element() * ROUNDING
}

/// A box in world space around a box under a transform.
pub(crate) fn world_box(b: &Aabb, transform: &Affine3A) -> (Vec3A, Vec3A) {
    let middle = transform.transform_point3a(b.center);
    let half = transform.matrix3.abs() * b.half_extents.abs();
    (middle - half, middle + half)
}

/// The same with room for the roundings on the way, here and in renderers.
pub(crate) fn placed(b: &Aabb, transform: &Affine3A) -> casca::Aabb {
    let (min, max) = world_box(b, transform);
    let reach = transform.matrix3.abs() * (b.center.abs() + b.half_extents.abs());
    // Some eight roundings each, of an epsilon at most of all that is added up.
    let room = 4.0 * rounding(reach + transform.translation.abs());
    casca::Aabb::new(vec3((min - room).into()), vec3((max + room).into()))
}

/// A box of casca's, as its corners.
pub(crate) fn back(b: &casca::Aabb) -> (Vec3A, Vec3A) {
    (b.min.to_array().into(), b.max.to_array().into())
}

/// Whether a box lies in another one. [`aabb`] has room for rounding.
pub(crate) fn holds(outer: &casca::Aabb, inner: &casca::Aabb) -> bool {
    outer.min.cmple(inner.min).all() && outer.max.cmpge(inner.max).all()
}

/// After a shift of the origin a place has the roundings of the one before it, of the shift, and of
/// the parents of an entity: each of half an epsilon of the greatest coordinate. This is for some
/// thirty of them; what differs by more counts as moved.
const SHIFT_ROUNDING: f32 = 16.0 * f32::EPSILON;

/// Whether two transforms are the same but for the rounding of a shift of the origin.
pub(crate) fn is_shifted(a: &glam::Affine3A, b: &glam::Affine3A, shift: Vec3) -> bool {
    let size = b.translation.abs().max_element() + shift.abs().max_element();
    a.matrix3 == b.matrix3 && (a.translation - b.translation).abs().max_element() <= size * SHIFT_ROUNDING
}

/// What moves by less than this share of half its longest edge in a frame counts as staying.
const TREMBLE: f32 = 2e-4;

/// Whether no point of a box moves by more than that from one transform to another one.
pub(crate) fn trembles(from: &glam::Affine3A, to: &glam::Affine3A, b: &Aabb) -> bool {
    let (middle, half) = (vec3(b.center.into()), glam::Vec3A::from(vec3(b.half_extents.into())));
    let apart = (to.transform_point3(middle) - from.transform_point3(middle)).abs();
    let apart = glam::Vec3A::from(apart) + (to.matrix3 - from.matrix3).abs() * half;
    apart.max_element() <= (to.matrix3.abs() * half).max_element() * TREMBLE
}

#[cfg(test)]
mod tests {
    use super::*;

    /// More than rounding makes of a box, and less than a look at it tells.
    const SLIVER: f32 = 1e-5;

    #[test]
    fn boxes_do_not_shrink_by_rounding() {
        let (min, max) = (Vec3::splat(0.1), Vec3::new(0.7, 1e6, 0.3));
        let there = aabb(&Aabb::from_min_max(min, max));
        let exact = casca::Aabb::new(vec3(min), vec3(max));
        assert!(holds(&there, &exact), "{there:?}");
        let beyond = casca::Aabb { max: exact.max + glam::Vec3::Z * SLIVER, ..exact };
        assert!(!holds(&there, &beyond), "it is drawn where its box is not: {there:?}");
    }
}
