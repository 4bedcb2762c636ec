//! Convex solids with few faces inside closed meshes.
//!
//! A small rock, a tree crown or a ball costs less to draw as one convex solid than patch by patch,
//! and a solid inside the mesh hides nothing that the mesh does not hide.
//!
//! Let a closed mesh be wound alike, and let some half-spaces around a point `c` be such that all
//! three corners of each triangle lie beyond the plane of one of them. A triangle is convex, so it
//! lies beyond that plane as a whole, and no triangle meets the inside of the intersection of the
//! half-spaces. That intersection is convex and contains `c`, so the mesh winds around each of its
//! points as often as around `c`. If that is not zero, rays that start outside of the mesh pass a
//! triangle before they reach the solid; if it is positive, they pass the front of one.
//!
//! The directions of the half-spaces are fixed in advance ([`frames`]), and their offsets are
//! fitted to a sample of the triangles ([`fit`]). Both decide the size of the solid only: in the
//! end every triangle is compared with the planes.

mod fit;
mod frames;
#[cfg(test)]
mod tests;

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use crate::geometry::Aabb;
use crate::geometry::plane::HalfSpace;
use crate::mesh::inner::fit::{Fit, Sample};
use crate::mesh::inner::frames::{Frame, Moments, frames};
use crate::numeric::mesh::{INNER_DEPTH, INNER_ROOM, WINDING};
use crate::shape::Convex;

/// Planes are first fitted to this many triangles, at most.
const SAMPLE: usize = 512;

/// How often triangles that the planes leave out are added to the sample.
const ROUNDS: usize = 3;

/// A solid with less than this share of the mesh's volume hides too little to replace it.
const LEAST_SHARE: f64 = 0.4;

/// Larger meshes get no solid, so that the preparation of the largest ones takes no longer.
const MOST_TRIANGLES: usize = 1 << 18;

/// A convex solid inside a closed mesh.
#[derive(Debug, Clone)]
pub(crate) struct Inner {
    pub(crate) solid: Convex,
    /// By how much the mesh is larger along each axis on average, as a share of its size.
    pub(crate) gap: f64,
}

/// A convex solid inside a mesh that is closed and wound alike: `None` if none is found that is
/// large enough. `outward` is 1 if normals point outwards, -1 if inwards, and 0 if the mesh is
/// open. If `front`, triangles hide from their front only.
///
/// Costs a few passes over the triangles.
pub(super) fn inner_solid(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    bounds: Aabb,
    outward: f64,
    front: bool,
) -> Option<Inner> {
    if outward == 0.0 || triangles.len() > MOST_TRIANGLES {
        return None;
    }
    let corners = |t: &[u32; 3]| t.map(|v| positions[v as usize].as_dvec3());
    let moments = Moments::of(triangles.iter().map(corners))?;
    let step = triangles.len().div_ceil(SAMPLE);
    let mut sample = Sample::new(positions, triangles.iter().step_by(step));
    let (frame, mut fit) = best_fit(&moments, &sample)?;
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let mut planes = Vec::new();
    for round in 1..=ROUNDS {
        let before = sample.len();
        planes = exact_planes(&fit, positions, triangles, &mut sample)?;
        if sample.len() == before || round == ROUNDS {
            break;
        }
        fit = Fit::of(&frame, fit.center, &sample)?;
    }
    let depth = planes.iter().map(|plane| plane.offset).fold(f64::INFINITY, f64::min);
    if depth.is_nan() || depth < INNER_DEPTH * (max - min).length() {
        return None;
    }
    let wound = winding(fit.center, triangles.iter().map(corners))?;
    if wound == 0 || front && wound < 0 {
        return None;
    }
    let largest = min.abs().max(max.abs()).max_element();
    let solid = Convex::inside_planes(fit.center, &planes, INNER_ROOM * largest)?;
    let share = (solid.volume() / moments.volume).min(1.0);
    (share >= LEAST_SHARE).then(|| Inner { solid, gap: 1.0 - share.cbrt() })
}

/// The largest solid that the frames of a mesh give for a sample of its triangles, and the frame.
fn best_fit(moments: &Moments, sample: &Sample) -> Option<(Frame, Fit)> {
    let fits = frames(moments, sample.corners())
        .filter_map(|frame| Fit::of(&frame, moments.center, sample).map(|fit| (frame, fit)));
    let (frame, fit) = fits.max_by(|a, b| a.1.volume.total_cmp(&b.1.volume))?;
    // Around its own middle the solid may be larger.
    let moved = Fit::of(&frame, fit.middle, sample).filter(|moved| moved.volume > fit.volume);
    let fit = moved.unwrap_or(fit);
    (fit.volume >= LEAST_SHARE * moments.volume).then_some((frame, fit))
}

/// The half-spaces of a fit relative to its center, with planes moved inwards until each triangle
/// of the mesh lies beyond one. Triangles for which one was moved join the sample.
fn exact_planes(
    fit: &Fit,
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    sample: &mut Sample,
) -> Option<Vec<HalfSpace>> {
    let mut planes = fit.planes.clone();
    let beyond: Vec<u32> = positions.iter().map(|p| sides(&planes, p.as_dvec3() - fit.center)).collect();
    for t in triangles {
        let [a, b, c] = t.map(|v| beyond[v as usize]);
        if a & b & c != 0 {
            continue;
        }
        let corners = t.map(|v| positions[v as usize].as_dvec3());
        let extent = |plane: &HalfSpace| {
            let along = corners.map(|p| -plane.normal.dot(p - fit.center));
            along.into_iter().fold(f64::INFINITY, f64::min)
        };
        let shares = planes.iter().map(|plane| extent(plane) / plane.offset);
        // The plane that loses least.
        let (at, share) = shares.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        if share.is_nan() || share <= 0.0 {
            return None;
        }
        if share < 1.0 {
            planes[at].offset = extent(&planes[at]);
            sample.push(corners);
        }
    }
    Some(planes)
}

/// The planes that a point lies beyond, as bits.
fn sides(planes: &[HalfSpace], p: DVec3) -> u32 {
    planes.iter().zip(0..).fold(0, |bits, (plane, i)| bits | u32::from(plane.distance(p) <= 0.0) << i)
}

/// How often triangles wind around a point, counted by the solid angles that it sees them at (van
/// Oosterom and Strackee 1983); `None` if their sum is not near a whole number.
fn winding(center: DVec3, triangles: impl Iterator<Item = [DVec3; 3]>) -> Option<i64> {
    let half_angle = |t: [DVec3; 3]| {
        let [a, b, c] = t.map(|p| p - center);
        let (x, y, z) = (a.length(), b.length(), c.length());
        f64::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
    };
    let turns = triangles.map(half_angle).sum::<f64>() / (2.0 * PI);
    ((turns - turns.round()).abs() < WINDING).then_some(turns.round() as i64)
}
