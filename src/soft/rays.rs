//! Directions and points that fill cones, hemispheres and boxes evenly, the same in every run.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::error::Error;
use crate::geometry::{Block, Sphere};
use crate::numeric::soft::GOLDEN_ANGLE;

/// The most rays of one estimate.
const MAX_RAYS: u32 = 4096;

/// Refuses no rays and too many.
pub(super) fn check_rays(rays: u32) -> Result<(), Error> {
    match rays {
        1..=MAX_RAYS => Ok(()),
        _ => {
            let (what, max) = ("the number of rays", f64::from(MAX_RAYS));
            Err(Error::Setting { what, value: rays.into(), min: 1.0, max })
        }
    }
}

/// Unit vectors around an axis, from the angle and the sine of the angle with it. The axis is a
/// unit vector.
fn around(axis: DVec3, turn: f64, sine: f64) -> DVec3 {
    let (right, up) = axis.any_orthonormal_pair();
    let cosine = (1.0 - sine * sine).max(0.0).sqrt();
    axis * cosine + (right * turn.cos() + up * turn.sin()) * sine
}

/// Directions that fill a cone around a unit vector evenly, by solid angle (Vogel's spiral); a
/// single one is that vector.
pub(super) fn in_cone(axis: DVec3, cosine: f64, rays: u32) -> impl Iterator<Item = DVec3> {
    let cosine = if rays == 1 { 1.0 } else { cosine };
    (0..rays).map(move |k| {
        let c = 1.0 - (1.0 - cosine) * (f64::from(k) + 0.5) / f64::from(rays);
        around(axis, f64::from(k) * GOLDEN_ANGLE, (1.0 - c * c).max(0.0).sqrt())
    })
}

/// Directions above a surface, as dense as the cosine of the angle with its normal (Malley's method
/// on Vogel's spiral).
pub(super) fn above_surface(normal: DVec3, rays: u32) -> impl Iterator<Item = DVec3> {
    (0..rays).map(move |k| {
        let sine = ((f64::from(k) + 0.5) / f64::from(rays)).sqrt();
        around(normal, f64::from(k) * GOLDEN_ANGLE, sine)
    })
}

/// Six cones of 60 degrees above a surface: along its normal, and five at 60 degrees to it. With
/// their weights by the cosine, which sum to 1.
pub(super) fn six_cones(normal: DVec3) -> impl Iterator<Item = (DVec3, f64)> {
    let side = (0..5).map(move |k| (around(normal, TAU * f64::from(k) / 5.0, 0.75f64.sqrt()), 0.15));
    std::iter::once((normal, 0.25)).chain(side)
}

/// Points of a sphere that an eye outside sees, evenly by solid angle, all with weight 1; `None`
/// for an eye inside.
pub(super) fn on_sphere(eye: DVec3, ball: &Sphere, rays: u32) -> Option<Vec<(DVec3, f64)>> {
    let (way, radius) = (ball.center.as_dvec3() - eye, f64::from(ball.radius));
    let axis = way.try_normalize().filter(|_| way.length() > radius)?;
    let sine = radius / way.length();
    // Where a ray enters the sphere.
    let point = |d: DVec3| {
        let middle = way.dot(d);
        let half = (radius * radius - way.length_squared() + middle * middle).max(0.0).sqrt();
        (eye + d * (middle - half), 1.0)
    };
    Some(in_cone(axis, (1.0 - sine * sine).sqrt(), rays).map(point).collect())
}

/// Points on those faces of a box that an eye outside sees, with weights by the solid angles that
/// they stand for. About as many as asked.
pub(super) fn on_box(eye: DVec3, block: &Block, rays: u32) -> Vec<(DVec3, f64)> {
    let size = block.max - block.min;
    let seen = |axis: usize| match (eye[axis] < block.min[axis], eye[axis] > block.max[axis]) {
        (true, _) => Some(block.min[axis]),
        (_, true) => Some(block.max[axis]),
        _ => None,
    };
    let faces = (0..3).filter(|&axis| seen(axis).is_some()).count().max(1);
    let side = (f64::from(rays) / faces as f64).sqrt().round().max(1.0) as u32;
    let mut points = Vec::with_capacity(faces * (side * side) as usize);
    for axis in 0..3 {
        let Some(at) = seen(axis) else { continue };
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for i in 0..side * side {
            let share = |k: u32| (f64::from(k) + 0.5) / f64::from(side);
            let mut p = block.min;
            (p[axis], p[u], p[v]) = (at, p[u] + size[u] * share(i % side), p[v] + size[v] * share(i / side));
            let way = p - eye;
            points.push((p, size[u] * size[v] * way[axis].abs() / way.length().powi(3)));
        }
    }
    points
}
