//! Occluders ready to be drawn, rounded inwards.

use glam::DVec3;

use crate::geometry::Room;
use crate::geometry::aspect::{Aspect, Outline};
use crate::geometry::body::Body;
use crate::geometry::plane::HalfSpace;
use crate::geometry::polytope::Part;
use crate::numeric::occlusion::{BEHIND, SPHERE_AROUND_EYE};
use crate::occlusion::face::{Face, Rect};
use crate::occlusion::front::contour_depth;
use crate::occlusion::silhouette::SilhouetteKind;

/// A convex occluder relative to the origin of the rays. It is filled again for each one; methods
/// that do so return whether it can be drawn: the eye must not be in it or too close to tell.
///
/// With a `room`, it hides a point only if it hides it from all eyes in that, which all lie outside
/// of it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Solid {
    aspect: Aspect,
    /// What hides lies within the solid scaled so about its middle.
    scale: f64,
}

/// The part of a solid that a face sees.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SeenSolid {
    /// A rectangle around it.
    pub(crate) rect: Rect,
    /// Its least depth, and the greatest depth of the silhouette along the face's axis.
    pub(crate) near: f64,
    pub(crate) far: f64,
}

impl Solid {
    pub(crate) fn set_body(&mut self, body: &Body, direction: Option<DVec3>, room: &Room) -> bool {
        if let Body::Sphere { center, radius } = *body {
            // A smaller sphere covers nearly the same directions.
            return self.set_sphere(center, radius - room.radius(), direction);
        }
        self.aspect.set_body(body, direction, room);
        self.scale = 1.0;
        self.is_drawable()
    }

    fn set_sphere(&mut self, center: DVec3, radius: f64, direction: Option<DVec3>) -> bool {
        let distance = center.length();
        let front = match direction {
            Some(d) => HalfSpace { normal: d, offset: -center.dot(d) },
            None => {
                let offset = -(distance - radius) * (distance + radius) / distance;
                HalfSpace { normal: center / distance, offset }
            }
        };
        self.aspect.set_sphere(center, radius);
        self.aspect.fronts.push(front);
        let outside = direction.is_some() || distance > radius * (1.0 + SPHERE_AROUND_EYE);
        radius > 0.0 && outside && front.normal.is_finite()
    }

    /// Fills it with a solid inside a convex shell that reaches beyond its faces by some distance
    /// at most, and that each line through the solid meets: it hides what lies beyond the shell,
    /// seen from outside of it.
    pub(crate) fn set_shell(
        &mut self,
        part: &Part,
        beyond: f64,
        direction: Option<DVec3>,
        room: &Room,
    ) -> bool {
        self.aspect.set_part(part, part.bounds(), direction, room);
        let middle = part.middle();
        let depth = part.faces().map(|face| face.distance(middle)).fold(f64::INFINITY, f64::min);
        // Scaled so about its middle, the solid contains the shell.
        self.scale = 1.0 + beyond / depth + BEHIND;
        let Some(along) = direction.or_else(|| middle.try_normalize()) else { return false };
        let farthest = self.aspect.vertices.iter().map(|v| along.dot(*v - middle)).fold(0.0, f64::max);
        let far = along.dot(middle) + farthest * self.scale;
        self.aspect.fronts.clear();
        self.aspect.fronts.push(HalfSpace { normal: along, offset: -far });
        self.is_drawable() && depth > 0.0 && far.is_finite()
    }

    fn is_drawable(&self) -> bool {
        matches!(self.aspect.outline, Outline::Cone) && !self.aspect.fronts.is_empty()
    }

    pub(crate) fn aspect(&self) -> &Aspect {
        &self.aspect
    }

    /// The part of it that a face sees.
    pub(crate) fn on_face(&self, face: &Face) -> Option<SeenSolid> {
        let Aspect { outline, vertices, block, .. } = &self.aspect;
        let (rect, (near, far)) = face.block(block)?;
        let (tighter, far) = match *outline {
            Outline::Sphere { center, radius } => (
                SilhouetteKind::sphere(center, radius, face).conic_rect(),
                contour_depth(center, radius, face.forward, face.parallel),
            ),
            // The rectangle around a box is exact if the box lies in front of the eye.
            _ if vertices.is_empty() => (None, far),
            _ => {
                let depths = || vertices.iter().map(|v| v.dot(face.forward));
                let middle = depths().sum::<f64>() / vertices.len() as f64;
                let far = depths().fold(f64::NEG_INFINITY, f64::max);
                (face.points(vertices).map(|(r, _)| r), middle + (far - middle) * self.scale)
            }
        };
        let rect = tighter.map_or(Some(rect), |t| rect.intersect(&t))?;
        Some(SeenSolid { rect: rect.intersect(&Rect::FACE)?, near, far })
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;
    use std::sync::Arc;

    use casca_slots::Slot;
    use glam::{Affine3A, Quat, Vec3};

    use super::*;
    use crate::geometry::Block;
    use crate::mesh::{Instance, TriMesh};
    use crate::occlusion::buffers::{OcclusionBuffers, Verdict};
    use crate::occlusion::pitch::Pitch;
    use crate::occlusion::target::{FaceTarget, Target};
    use crate::random::Random;
    use crate::view::View;

    /// A cone without its base.
    fn cone() -> TriMesh {
        let rim = |i: u32| Vec3::new((TAU * i as f32 / 9.0).cos(), 0.0, (TAU * i as f32 / 9.0).sin());
        let mut positions: Vec<Vec3> = (0..9).map(rim).collect();
        positions.push(Vec3::Y * 1.7);
        TriMesh::new(positions, (0..9).map(|i| [i, 9, (i + 1) % 9]).collect()).unwrap()
    }

    /// Whether a segment from the origin meets a triangle.
    fn meets([a, b, c]: [DVec3; 3], end: DVec3) -> bool {
        let normal = (b - a).cross(c - a);
        let at = a.dot(normal) / end.dot(normal);
        let p = end * at;
        (0.0..=1.0).contains(&at)
            && [(a, b), (b, c), (c, a)].iter().all(|(s, e)| (*e - *s).cross(p - *s).dot(normal) >= 0.0)
    }

    #[test]
    fn a_shell_hides_only_what_segments_find_behind_its_triangles() {
        let mesh = Arc::new(cone());
        let mut random = Random::new(19);
        let view = View::omnidirectional(Vec3::ZERO).unwrap();
        let pitch = Pitch { pixels: 256.0, least: 0.0, nearest: 1e-3, radius: 40.0, middle: DVec3::ZERO };
        let mut buffers = OcclusionBuffers::default();
        let (mut hidden, mut inside) = (0, 0);
        for round in 0..300 {
            let turn =
                Quat::from_axis_angle(random.point(1.0).as_vec3().normalize(), random.next() as f32 * 6.0);
            let scale = Vec3::splat(1.0) + random.point(1.0).as_vec3().abs();
            let at = random.point(1.0).as_vec3().normalize() * random.within(3.0, 8.0) as f32;
            let place = Affine3A::from_scale_rotation_translation(scale, turn, at);
            let instance = Instance::new(mesh.clone(), place).unwrap();
            buffers.begin(&view, &pitch);
            let mut drawn = 0;
            for (part, beyond) in instance.shells_from(DVec3::ZERO) {
                drawn += 1;
                buffers.draw_shell(&part, beyond, Slot::new(0));
            }
            assert_eq!(drawn, 1);
            let triangles: Vec<[DVec3; 3]> = mesh
                .all_corners()
                .map(|t| t.map(|p| place.transform_point3(p.as_vec3()).as_dvec3()))
                .collect();
            for _ in 0..40 {
                let middle = at.as_dvec3() * random.within(0.9, 2.0) + random.point(1.0);
                let half = random.point(0.2).abs() + 0.01;
                let block = Block { min: middle - half, max: middle + half };
                if buffers.test(&Target::block(block, None), &mut FaceTarget::default()) != Verdict::Hidden {
                    inside += u32::from(triangles.iter().any(|t| meets(*t, middle)));
                    continue;
                }
                hidden += 1;
                for _ in 0..30 {
                    let share = DVec3::new(random.next(), random.next(), random.next());
                    let end = block.min + share * (block.max - block.min);
                    assert!(triangles.iter().any(|t| meets(*t, end)), "{round}: {block:?} {end}");
                }
            }
        }
        assert!(hidden > 1000 && inside > 500, "{hidden} {inside}");
    }
}
