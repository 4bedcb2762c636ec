//! The reference: strands one by one as chains of tubes, and the skin, hit by rays. It shares the
//! strands' places, their shape and their light with the shells, but neither layers nor fragments.

use std::time::Duration;

use crate::Error;
use crate::mesh::Mesh;
use crate::shading::{Directions, Material};
use crate::strands::{Root, roots};
use casca_tools::camera::Camera;
use glam::{DVec3, Vec3};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::{Ray, RayHit};
use rayon::prelude::*;

use crate::gpu::look::{Look, SKY, stored};
use crate::gpu::numeric::{TUBES, WET, WET_EXPONENT, WIDER};

/// A piece of a strand: a part of a cone, with a ball that fills the joint at its first end. Tips
/// end flat, as the highest layer of a strand does.
struct Tube {
    ends: [DVec3; 2],
    /// At its ends.
    radii: [f64; 2],
    strand: u32,
    /// Where it is on the strand, 0 to 1.
    along: [f32; 2],
}

/// What rays can hit.
enum Part {
    Tube(Tube),
    /// A triangle of the skin, by its number.
    Skin(u32, [DVec3; 3]),
}

/// Strands and skin of one mesh, in its object space.
pub struct Reference<'a> {
    mesh: &'a Mesh,
    look: Look,
    strands: Vec<Root>,
    parts: Vec<Part>,
    bvh: Bvh2,
}

/// The colours at the roots and the tips of strands, which multiply those of the mesh.
pub type Tint = [Vec3; 2];

impl<'a> Reference<'a> {
    /// All strands of a mesh. Takes about four kilobytes for each.
    ///
    /// # Errors
    /// As [`roots`].
    pub fn new(mesh: &'a Mesh, look: &Look) -> Result<Self, Error> {
        let strands = roots(mesh, &look.fur)?;
        let tubes = strands.iter().zip(0u32..).flat_map(|(root, strand)| {
            (0..TUBES).map(move |i| {
                let along = [i, i + 1].map(|i| i as f32 / TUBES as f32);
                let ends = along.map(|t| root.point(&look.fur, t).as_dvec3());
                let radii = along.map(|t| f64::from(look.fur.radius_along(t)));
                Part::Tube(Tube { ends, radii, strand, along })
            })
        });
        let skin = mesh.triangles().iter().zip(0u32..).map(|(triangle, i)| {
            Part::Skin(i, triangle.map(|v| mesh.vertices()[v as usize].position.as_dvec3()))
        });
        let mut parts: Vec<Part> = tubes.chain(skin).collect();
        let boxes: Vec<Aabb> = parts.iter().map(Part::bounds).collect();
        let bvh = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Duration::default());
        // In the order of the hierarchy.
        let mut sorted: Vec<Option<Part>> = parts.drain(..).map(Some).collect();
        let parts = bvh.primitive_indices.iter().filter_map(|&i| sorted[i as usize].take()).collect();
        Ok(Self { mesh, look: *look, strands, parts, bvh })
    }

    /// How many strands there are.
    pub fn strands(&self) -> usize {
        self.strands.len()
    }

    /// The picture that a camera takes of the object where it is modelled, with `side * side` rays
    /// in each pixel: red, green, blue, opacity, row by row from the top. `to_sun` is a unit
    /// vector. There is no shadow map; strands shade each other by depth.
    pub fn picture(
        &self,
        camera: &Camera,
        (width, height): (u32, u32),
        side: u32,
        tint: &Tint,
        to_sun: Vec3,
    ) -> Vec<u8> {
        let inverse = camera.view_projection().as_dmat4().inverse();
        let eye = camera.eye.as_dvec3();
        let samples = f64::from(side.max(1));
        let pixel = |x: u32, y: u32| {
            let mut sum = Vec3::ZERO;
            for i in 0..side.max(1).pow(2) {
                let (sx, sy) = (f64::from(i % side.max(1)) + 0.5, f64::from(i / side.max(1)) + 0.5);
                let u = (f64::from(x) + sx / samples) / f64::from(width) * 2.0 - 1.0;
                let v = 1.0 - (f64::from(y) + sy / samples) / f64::from(height) * 2.0;
                let there = inverse.project_point3(DVec3::new(u, v, 0.5));
                sum += stored(self.light(eye, (there - eye).normalize(), tint, to_sun));
            }
            let mean = sum / samples.powi(2) as f32 * 255.0;
            [mean.x.round() as u8, mean.y.round() as u8, mean.z.round() as u8, 255]
        };
        (0..height).into_par_iter().flat_map_iter(|y| (0..width).flat_map(move |x| pixel(x, y))).collect()
    }

    /// The light that comes from a direction.
    fn light(&self, eye: DVec3, direction: DVec3, tint: &Tint, to_sun: Vec3) -> Vec3 {
        let Some((part, t)) = self.hit(eye, direction) else { return Vec3::from_array(SKY) };
        match part {
            Part::Tube(tube) => {
                let root = &self.strands[tube.strand as usize];
                let axis = tube.ends[1] - tube.ends[0];
                let place = (eye + direction * t - tube.ends[0]).dot(axis) / axis.length_squared();
                let along = tube.along[0] + (tube.along[1] - tube.along[0]) * place.clamp(0.0, 1.0) as f32;
                let own = 1.0 + self.look.vary * (2.0 * root.id as f32 / 255.0 - 1.0);
                let height = along * root.share;
                let fur = root.bent(&self.look.fur, height);
                let strand = Directions {
                    tangent: fur.tangent(root.direction, height),
                    normal: root.direction,
                    to_light: to_sun,
                    to_eye: -direction.as_vec3(),
                };
                let color = own * root.color * tint[0].lerp(tint[1], along);
                let sky = self.look.material.depth(along);
                let lit = fur.sun_through(root.direction, height, root.share / fur.share(root.id), to_sun);
                self.look.material.shade(color, &strand, sky, lit)
            }
            Part::Skin(i, corners) => {
                let weights = weights(corners, eye + direction * t);
                let of = self.mesh.triangles()[*i as usize].map(|v| v as usize);
                let mix = |f: &dyn Fn(usize) -> Vec3| (0..3).map(|k| f(of[k]) * weights[k]).sum::<Vec3>();
                let normal = mix(&|v| self.mesh.vertices()[v].normal).normalize_or_zero();
                let color = mix(&|v| self.mesh.coats()[v].color);
                let length = mix(&|v| Vec3::splat(self.mesh.coats()[v].length)).x;
                let to_eye = -direction.as_vec3();
                let seen = Directions { tangent: normal, normal, to_light: to_sun, to_eye };
                let sky = under(&self.look.material, length);
                let lit = self.look.fur.sun_through(normal, 0.0, length, to_sun);
                skin(&self.look.material, color * tint[0], length, &seen, [sky, lit])
            }
        }
    }

    /// The nearest part on a ray, and how far it is.
    fn hit(&self, start: DVec3, direction: DVec3) -> Option<(&Part, f64)> {
        let mut best: Option<(usize, f64)> = None;
        let ray = Ray::new(start.as_vec3a(), direction.as_vec3a(), 0.0, f32::MAX);
        self.bvh.ray_traverse(ray, &mut RayHit::none(), |_, i| {
            let Some(t) = self.parts[i].enter(start, direction) else { return f32::INFINITY };
            if best.is_none_or(|(_, b)| t < b) {
                best = Some((i, t));
            }
            // Boxes a little farther are searched, too: the ray of the hierarchy is rounded.
            (t * (1.0 + WIDER)) as f32
        });
        best.map(|(i, t)| (&self.parts[i], t))
    }
}

/// How much of a coat of a length, as a share of the greatest, covers the skin.
fn covered(length: f32) -> f32 {
    let t = (length / 0.2).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The factor of skin under a coat of a length: as dark as roots.
fn under(material: &Material, length: f32) -> f32 {
    1.0 + (material.root - 1.0) * covered(length)
}

/// The light of skin under a coat of a length, by the shares of the light from everywhere and of
/// the sun's that reach it; bald it is wet.
fn skin(material: &Material, color: Vec3, length: f32, strand: &Directions, [sky, lit]: [f32; 2]) -> Vec3 {
    let facing = strand.normal.dot(strand.to_light);
    let direct = ((facing + material.wrap) / (1.0 + material.wrap)).clamp(0.0, 1.0);
    let half = (strand.to_light + strand.to_eye).normalize_or_zero();
    let wet = WET * (1.0 - covered(length)) * strand.normal.dot(half).clamp(0.0, 1.0).powf(WET_EXPONENT);
    color * (sky * material.ambient + lit * material.diffuse * direct) + Vec3::splat(wet * direct)
}

impl Part {
    fn bounds(&self) -> Aabb {
        let points: &[DVec3] = match self {
            Self::Tube(tube) => &tube.ends,
            Self::Skin(_, corners) => corners,
        };
        let radius = if let Self::Tube(tube) = self { tube.radii[0] } else { 0.0 };
        let (lo, hi) = points
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        let margin = DVec3::splat(radius + WIDER * (lo.abs().max(hi.abs()).max_element() + radius));
        Aabb::new((lo - margin).as_vec3a(), (hi + margin).as_vec3a())
    }

    /// How far along a ray it begins; `None` if the ray misses it, or starts inside.
    fn enter(&self, start: DVec3, direction: DVec3) -> Option<f64> {
        match self {
            Self::Tube(tube) => enter_tube(tube.ends, tube.radii, tube.along[1] >= 1.0, start, direction),
            Self::Skin(_, corners) => enter_triangle(corners, start, direction),
        }
    }
}

/// A tube: the part between the ends is that of a cone that does not widen, and a ball that touches
/// it from inside is at the first end; at the second one is a disc if it is `flat`.
fn enter_tube(
    [a, b]: [DVec3; 2],
    radii: [f64; 2],
    flat: bool,
    start: DVec3,
    direction: DVec3,
) -> Option<f64> {
    let (axis, long) = (b - a).try_normalize().map_or((DVec3::Z, 0.0), |axis| (axis, a.distance(b)));
    let narrows = if long > 0.0 { (radii[0] - radii[1]) / long } else { 0.0 };
    let ball = || {
        let way = a - start;
        let near = way.dot(direction);
        let miss = way - direction * near;
        let half = radii[0] * radii[0] / (1.0 + narrows * narrows) - miss.length_squared();
        // Beside the cone it would touch it.
        let behind = |t: &f64| *t > 0.0 && axis.dot(direction * *t - way) <= 0.0;
        (half >= 0.0).then(|| near - half.sqrt()).filter(behind)
    };
    // Along the axis, and away from it.
    let way = start - a;
    let (rise, height) = (axis.dot(direction), axis.dot(way));
    let (across, aside) = (direction - axis * rise, way - axis * height);
    let radius = radii[0] - narrows * height;
    let aa = across.length_squared() - (narrows * rise).powi(2);
    let ab = across.dot(aside) + radius * narrows * rise;
    let square = ab * ab - aa * (aside.length_squared() - radius * radius);
    let side = || {
        if square < 0.0 {
            return None;
        }
        // Without differences of numbers that are nearly equal.
        let q = -(ab + square.sqrt().copysign(ab));
        let crossings = [q / aa, (aside.length_squared() - radius * radius) / q];
        let within = |t: &f64| *t > 0.0 && (0.0..=long).contains(&(height + rise * t));
        crossings.into_iter().filter(within).min_by(f64::total_cmp)
    };
    let disc = || {
        let t = axis.dot(b - start) / rise;
        let inside = (start + direction * t).distance_squared(b) <= radii[1] * radii[1];
        (inside && t > 0.0).then_some(t)
    };
    let end = if flat { disc() } else { None };
    [side(), ball(), end].into_iter().flatten().min_by(f64::total_cmp)
}

/// A triangle, from both sides.
fn enter_triangle([a, b, c]: &[DVec3; 3], start: DVec3, direction: DVec3) -> Option<f64> {
    // The signs of the volumes between the ray and the edges.
    let (p, q, r) = (a - start, b - start, c - start);
    let volumes = [r.cross(q), p.cross(r), q.cross(p)].map(|n| n.dot(direction));
    if !(volumes.iter().all(|v| *v >= 0.0) || volumes.iter().all(|v| *v <= 0.0)) {
        return None;
    }
    let normal = (*b - *a).cross(*c - *a);
    let t = normal.dot(p) / normal.dot(direction);
    (t.is_finite() && t > 0.0).then_some(t)
}

/// The weights of the corners at a point of a triangle.
fn weights([a, b, c]: &[DVec3; 3], at: DVec3) -> [f32; 3] {
    let normal = (*b - *a).cross(*c - *a);
    let part = |p: DVec3, q: DVec3| (p - at).cross(q - at).dot(normal) / normal.length_squared();
    let (u, v) = (part(*b, *c) as f32, part(*c, *a) as f32);
    [u, v, 1.0 - u - v]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of doubles at ways of some units.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn tubes_and_triangles_are_entered_where_they_begin() {
        let ends = [DVec3::ZERO, DVec3::new(0.0, 2.0, 0.0)];
        let enter = |from: [f64; 3], to: [f64; 3]| {
            let (from, to) = (DVec3::from(from), DVec3::from(to));
            let way = (to - from).normalize();
            enter_tube(ends, [0.5; 2], false, from, way).map(|t| from + way * t)
        };
        let near = |p: Option<DVec3>, q: [f64; 3]| p.is_some_and(|p| p.distance(DVec3::from(q)) < 1e-9);
        assert!(near(enter([3.0, 1.0, 0.0], [0.0, 1.0, 0.0]), [0.5, 1.0, 0.0]), "the side");
        assert!(near(enter([0.0, -9.0, 0.0], [0.0, 0.0, 0.0]), [0.0, -0.5, 0.0]), "along the axis");
        assert!(near(enter([3.0, -0.3, 0.0], [0.0, -0.3, 0.0]), [0.4, -0.3, 0.0]), "a round end");
        assert_eq!(enter([3.0, 1.0, 0.6], [0.0, 1.0, 0.6]), None);
        assert_eq!(enter([3.0, 1.0, 0.0], [4.0, 1.0, 0.0]), None, "behind");
        // A cone of half the radius at its end.
        let cone = |from: DVec3, way: DVec3| enter_tube(ends, [0.5, 0.25], false, from, way);
        for (y, radius) in [(0.5, 0.4375), (1.5, 0.3125)] {
            let found = cone(DVec3::new(3.0, y, 0.0), DVec3::NEG_X).unwrap();
            assert!((3.0 - found - radius).abs() < ROUNDING, "{y}: {found}");
        }
        assert_eq!(cone(DVec3::new(3.0, 1.5, 0.32), DVec3::NEG_X), None, "beside where it is narrower");
        let found = cone(DVec3::new(0.3, 9.0, 0.0), DVec3::NEG_Y).unwrap();
        assert!((9.0 - found - 1.6).abs() < ROUNDING, "along the axis, to its side: {found}");
        let down = |x: f64| enter_tube(ends, [0.5; 2], true, DVec3::new(x, 9.0, 0.0), DVec3::NEG_Y);
        assert_eq!((down(0.3), down(0.6)), (Some(7.0), None), "a tip ends flat");
        assert_eq!(
            enter_tube([DVec3::ZERO; 2], [0.5; 2], false, DVec3::X * 2.0, DVec3::NEG_X),
            Some(1.5),
            "a ball"
        );

        let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let from = DVec3::new(0.2, 0.3, 2.0);
        assert_eq!(enter_triangle(&triangle, from, DVec3::NEG_Z), Some(2.0));
        assert_eq!(enter_triangle(&triangle, -from, DVec3::Z), None, "beside it");
        assert_eq!(enter_triangle(&triangle, from, DVec3::Z), None, "behind");
        let share = weights(&triangle, DVec3::new(0.2, 0.3, 0.0));
        assert!(
            (share[0] - 0.5).abs() < 1e-6 && (share[1] - 0.2).abs() < 1e-6 && (share[2] - 0.3).abs() < 1e-6
        );
    }
}
