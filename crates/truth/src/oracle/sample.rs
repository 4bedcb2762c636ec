//! Points on the side of an object that faces the viewer.

use glam::{DAffine3, DVec3};
use rand::RngExt;

use super::frustum::Viewpoint;
use super::geometry::{MeshCache, corners};
use crate::numeric::oracle::{LEAST_AREA, OFF_RIM, OUTSIDE_SPHERE};
use casca_scenes::random::Generator;
use casca_scenes::world::{Mesh, Shape};

/// Draws points on an object.
pub(super) enum Sampler<'a> {
    Sphere {
        center: DVec3,
        radius: f64,
        /// Unit vectors: towards the viewer, and across.
        axis: DVec3,
        across: [DVec3; 2],
        /// Cosine, at the centre, between the axis and the silhouette.
        rim: f64,
    },
    Box {
        min: DVec3,
        size: DVec3,
        /// By axis: -1 or 1 if the face at the least or greatest side is
        /// seen, 0 if neither.
        faces: [i8; 3],
    },
    Mesh {
        mesh: &'a Mesh,
        transform: DAffine3,
        areas: &'a [f64],
    },
}

impl<'a> Sampler<'a> {
    /// None if no side faces the viewer.
    pub(super) fn new(shape: &'a Shape, viewpoint: Viewpoint, meshes: &'a MeshCache) -> Option<Self> {
        match shape {
            Shape::Sphere { center, radius } => {
                let (center, radius) = (center.as_dvec3(), f64::from(*radius));
                let towards = viewpoint.towards(center);
                let distance = towards.length();
                let rim = match viewpoint {
                    Viewpoint::Eye(_) => radius / distance,
                    Viewpoint::Direction(_) => 0.0,
                };
                // Not written as a plain comparison so that NaN is left out.
                if !(radius > 0.0 && distance > 0.0 && rim < 1.0 - OUTSIDE_SPHERE) {
                    return None;
                }
                let axis = towards / distance;
                let (a, b) = axis.any_orthonormal_pair();
                Some(Self::Sphere { center, radius, axis, across: [a, b], rim })
            }
            Shape::Box { min, max } => {
                let (min, max) = (min.as_dvec3(), max.as_dvec3());
                if !min.cmple(max).all() {
                    return None;
                }
                let (low, high) = (viewpoint.towards(min), viewpoint.towards(max));
                let faces = [0, 1, 2].map(|i| i8::from(high[i] > 0.0) - i8::from(low[i] < 0.0));
                (faces != [0; 3]).then_some(Self::Box { min, size: max - min, faces })
            }
            Shape::Mesh { mesh, transform } => {
                let areas = &meshes.facts(mesh)?.areas;
                (areas.last().copied().unwrap_or(0.0) > 0.0).then(|| Self::Mesh {
                    mesh: mesh.as_ref(),
                    transform: transform.as_daffine3(),
                    areas,
                })
            }
        }
    }

    /// The next point; `attempt` counts up from 0. None if this one failed.
    pub(super) fn point(&mut self, attempt: usize, random: &mut Generator) -> Option<DVec3> {
        match *self {
            Self::Sphere { center, radius, axis, across, rim } => {
                let share: f64 = random.random();
                let cosine = match attempt % 4 {
                    // Anywhere on the visible cap.
                    0 => rim + (1.0 - rim) * share,
                    // In rings ever nearer to the silhouette.
                    ring => rim + (1.0 - rim) * share * 0.05_f64.powi(ring as i32) + OFF_RIM,
                };
                let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
                let (s, c) = (random.random::<f64>() * std::f64::consts::TAU).sin_cos();
                let normal = axis * cosine + (across[0] * c + across[1] * s) * sine;
                Some(center + normal * radius)
            }
            Self::Box { min, size, faces } => {
                let areas = [size.y * size.z, size.z * size.x, size.x * size.y];
                let weights = [0, 1, 2].map(|i| if faces[i] == 0 { 0.0 } else { areas[i] + LEAST_AREA });
                let mut pick = random.random::<f64>() * (weights[0] + weights[1] + weights[2]);
                let mut axis = (0..3).rev().find(|&i| faces[i] != 0)?;
                for i in 0..3 {
                    if faces[i] != 0 && pick < weights[i] {
                        axis = i;
                        break;
                    }
                    pick -= weights[i];
                }
                // How far inside the edge of the face.
                let inset = 10_f64.powf(-1.0 - 4.0 * random.random::<f64>());
                let mut edge = || if random.random::<bool>() { inset } else { 1.0 - inset };
                let (a, b) = match attempt % 4 {
                    2 => (edge(), edge()),
                    1 => {
                        let at = edge();
                        let along = random.random();
                        if random.random() { (at, along) } else { (along, at) }
                    }
                    _ => (random.random(), random.random()),
                };
                let mut share = DVec3::ZERO;
                share[axis] = if faces[axis] > 0 { 1.0 } else { 0.0 };
                share[(axis + 1) % 3] = a;
                share[(axis + 2) % 3] = b;
                let mut point = min + size * share;
                if faces[axis] > 0 {
                    point[axis] = min[axis] + size[axis];
                }
                Some(point)
            }
            Self::Mesh { mesh, transform, areas } => {
                let triangle = if attempt % 4 == 2 {
                    // Each triangle alike: small ones stand for detail.
                    random.random_range(0..mesh.triangles.len())
                } else {
                    let area = random.random::<f64>() * areas[areas.len() - 1];
                    areas.partition_point(|&sum| sum <= area).min(areas.len() - 1)
                };
                let [a, b, c] = corners(mesh, &transform, triangle);
                let (mut u, mut v): (f64, f64) = (random.random(), random.random());
                if u + v > 1.0 {
                    (u, v) = (1.0 - u, 1.0 - v);
                }
                let inset = 10_f64.powf(-1.0 - 3.0 * random.random::<f64>());
                match attempt % 4 {
                    // Near a corner.
                    2 => (u, v) = (u * inset, v * inset),
                    // Near an edge.
                    1 => v = (1.0 - u) * inset,
                    _ => {}
                }
                let [a, b, c] = match random.random_range(0..3) {
                    0 => [a, b, c],
                    1 => [b, c, a],
                    _ => [c, a, b],
                };
                let point = a + (b - a) * u + (c - a) * v;
                point.is_finite().then_some(point)
            }
        }
    }
}
