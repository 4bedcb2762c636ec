//! A path tracer: the light that reaches a camera in a [`LitScene`], by exact rays in f64 and
//! seeded chance.
//!
//! Kajiya, *The Rendering Equation* (1986), with next event estimation for lights and emissive
//! triangles, and multiple importance sampling by the balance heuristic for the latter (Veach &
//! Guibas 1995). Light is sorted by how often it was scattered on its way, so that direct light and
//! each bounce can be looked at on their own. All rays go through the centres of pixels. Results do
//! not depend on the number of threads.
//!
//! Rays go on through panes and through the backs of single-sided sheets, as a camera sees them:
//! what looks at such a back gets the light behind it.

mod scatter;
#[cfg(test)]
mod tests;

use std::ops::RangeInclusive;

use glam::{DVec2, DVec3, Vec3};
use obvhs::BvhBuildParams;
use rand::RngExt;
use rayon::prelude::*;

use super::{LitScene, LitTriangle, Material};
use crate::{Light, Texture};
use casca_scenes::random::{Generator, generator, spread};
use casca_scenes::world::{Camera, Sides};
use casca_truth::oracle::Frustum;
use casca_truth::oracle::tree::{Part, Primitive, Tree};
use scatter::{Scatter, turned};

/// What is added to the greatest coordinate of a scene, so that one at the origin has a size.
const LEAST_SCALE: f64 = 1e-3;
/// Rays of light start this far off the surface, as a share of the greatest coordinate: rounding is
/// less, and nothing in a scene is as thin.
const OFF: f64 = 1e-8;
/// Shadow rays end this far before the light, as a share of the way, so that an emitter does not
/// hide itself.
const BEFORE_LIGHT: f64 = 1e-7;
/// Samples that a pixel has at most.
const MOST_SAMPLES: u32 = 1 << 20;
/// How often light is scattered at most.
const MOST_ORDERS: u32 = 256;

/// Pixels that a picture has at most.
const MOST_PIXELS: usize = 1 << 24;

/// A picture that has no pixels, or too many.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a picture of {width}x{height} pixels: there must be 1 to {MOST_PIXELS}")]
pub struct SizeError {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

/// A picture of linear light by chance, and how sure it is: row by row from the top.
#[derive(Debug, Clone)]
pub struct Render {
    /// The mean of the samples.
    pub image: Vec<Vec3>,
    /// By channel: the standard error of that mean, estimated from the samples.
    pub error: Vec<Vec3>,
}

/// A point of a surface that a ray hits.
#[derive(Debug, Clone, Copy)]
pub struct Surface {
    /// The point.
    pub point: DVec3,
    /// Unit normal on the side that the ray came from.
    pub normal: DVec3,
    /// Index into [`LitScene::materials`].
    pub material: usize,
    /// The colour of its texture there.
    pub colour: Vec3,
}

/// Traces paths in one scene.
pub struct PathTracer {
    /// Its parts have the numbers of triangles as objects.
    tree: Tree,
    triangles: Vec<LitTriangle>,
    materials: Vec<Material>,
    textures: Vec<Texture>,
    lights: Vec<Light>,
    emitters: Emitters,
    sky: DVec3,
}

impl PathTracer {
    /// Builds the hierarchy. Material values out of range are brought into it; O(n log n) for n
    /// triangles.
    pub fn new(scene: &LitScene) -> Self {
        let triangles = scene.triangles();
        let materials: Vec<Material> = scene.materials.iter().map(Material::sound).collect();
        let part = |(i, t): (usize, &LitTriangle)| Part {
            shape: Primitive::Triangle(t.corners.map(|p| p.as_dvec3())),
            object: i as u32,
            triangle: 0,
            sides: materials[t.material as usize].sides,
        };
        let parts = triangles.iter().enumerate().map(part).collect();
        let sky = if scene.sky.is_finite() { scene.sky.as_dvec3().max(DVec3::ZERO) } else { DVec3::ZERO };
        Self {
            tree: Tree::of(parts, BvhBuildParams::medium_build()),
            emitters: Emitters::new(&triangles, &materials),
            triangles,
            materials,
            textures: scene.textures.clone(),
            lights: scene.lights.clone(),
            sky,
        }
    }

    /// The first surface along a ray.
    pub fn hit(&self, mut origin: DVec3, direction: DVec3) -> Option<Surface> {
        loop {
            let mut best = None;
            self.tree.first(origin, direction, &mut best);
            let (number, t) = best?;
            let (triangle, point) = (&self.triangles[number as usize], origin + direction * t);
            let [a, b, c] = triangle.corners.map(|p| p.as_dvec3());
            let normal = (b - a).cross(c - a).try_normalize()?;
            let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
            let material = triangle.material as usize;
            if let Some(colour) = self.colour(triangle, point) {
                return Some(Surface { point, normal, material, colour });
            }
            // On behind the hole.
            origin = self.off(point, -normal);
        }
    }

    /// The colour of the texture of a triangle at a point of it; `None` in a hole.
    fn colour(&self, triangle: &LitTriangle, point: DVec3) -> Option<Vec3> {
        let texture = self.materials[triangle.material as usize].texture;
        let Some(texture) = texture.and_then(|t| self.textures.get(t as usize)) else {
            return Some(Vec3::ONE);
        };
        let [a, b, c] = triangle.corners.map(|p| p.as_dvec3());
        let [u, v, w] = triangle.uv.map(|p| p.as_dvec2());
        // By the least of squares, which any point has.
        let (x, y, p) = (b - a, c - a, point - a);
        let (xx, xy, yy) = (x.dot(x), x.dot(y), y.dot(y));
        let [s, t] =
            [yy * p.dot(x) - xy * p.dot(y), xx * p.dot(y) - xy * p.dot(x)].map(|k| k / (xx * yy - xy * xy));
        texture.at(u + (v - u) * s + (w - u) * t)
    }

    /// A picture of `width` times `height` pixels, of the radiance that was scattered so many times on
    /// its way to the camera: 0 for emitters that are looked at, 1 for direct light, 2 for the first
    /// indirect bounce, 3 for the second; at most 256. `samples` a pixel, 1 to 2^20, are more for less
    /// noise. Costs pixels times samples times the orders.
    ///
    /// # Errors
    /// [`SizeError`].
    pub fn render(
        &self,
        camera: &Camera,
        (width, height): (usize, usize),
        orders: &RangeInclusive<u32>,
        samples: u32,
        seed: u64,
    ) -> Result<Render, SizeError> {
        let frustum = Frustum::new(camera);
        let count = width.checked_mul(height).filter(|n| (1..=MOST_PIXELS).contains(n));
        let pixels = (0..count.ok_or(SizeError { width, height })?).into_par_iter().map(|i| {
            let place = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
            let [x, y] = (place / DVec2::new(width as f64, height as f64) * 2.0 - 1.0).to_array();
            let (start, step) = frustum.ray(x, -y);
            let surface = self.hit(frustum.eye() + start, step);
            // A generator of its own, so that threads do not matter.
            let mut random = generator(seed, spread(i as u64 + 1));
            mean(samples, || self.radiance(surface, step.normalize_or_zero(), orders, &mut random))
        });
        let (image, error) = pixels.unzip();
        Ok(Render { image, error })
    }

    /// Whether anything lies on the way from a surface to a light.
    fn hides(&self, at: &Surface, way: DVec3) -> bool {
        let (start, end) = (self.off(at.point, at.normal), 1.0 - BEFORE_LIGHT);
        let is_solid = |part: &Part, t: f64| {
            self.colour(&self.triangles[part.object as usize], start + way * t).is_some()
        };
        let blocks = |part: &Part| part.enter(start, way, true).is_some_and(|t| t < end && is_solid(part, t));
        self.tree.any(start, way, end, blocks).is_some()
    }

    /// A distance from a point beyond which there is nothing.
    fn far(&self, point: DVec3) -> f64 {
        4.0 * self.tree.scale + point.length() + 1.0
    }

    /// A point just above a surface.
    fn off(&self, point: DVec3, normal: DVec3) -> DVec3 {
        point + normal * (OFF * (self.tree.scale + LEAST_SCALE))
    }

    /// The light of some orders that arrives against a unit direction from a surface, or from the
    /// sky.
    fn radiance(
        &self,
        seen: Option<Surface>,
        mut direction: DVec3,
        orders: &RangeInclusive<u32>,
        random: &mut Generator,
    ) -> DVec3 {
        let (mut light, mut weight) = (DVec3::ZERO, DVec3::ONE);
        let last = (*orders.end()).min(MOST_ORDERS);
        // The density of the direction that led here; none for the camera.
        let mut density = None;
        let mut next = seen;
        for order in 0..=last {
            let Some(at) = next else {
                if orders.contains(&order) {
                    light += weight * self.sky;
                }
                break;
            };
            let material = &self.materials[at.material];
            if orders.contains(&order) && material.emits() {
                light += weight * material.emission.as_dvec3() * self.share(&at, direction, density);
            }
            if order == last {
                break;
            }
            let scatter = Scatter::new(material, (at.colour, at.normal), direction);
            if orders.contains(&(order + 1)) {
                // Direct light of all lights and of one point of the emitters.
                let mut direct = self.emitted(&at, &scatter, random).unwrap_or(DVec3::ZERO);
                for of in &self.lights {
                    let Some((way, towards, irradiance)) = self.towards(of, &at, random) else { continue };
                    let value = scatter.value(towards) * irradiance;
                    if value.max_element() > 0.0 && !self.hides(&at, way) {
                        direct += value;
                    }
                }
                light += weight * direct;
            }
            let Some((way, factor)) = scatter.sample(random) else { break };
            density = Some((scatter.density(way), at.point));
            weight *= factor;
            direction = way;
            next = self.hit(self.off(at.point, at.normal), way);
        }
        light
    }
}

/// Mean and standard error of samples.
fn mean(samples: u32, mut sample: impl FnMut() -> DVec3) -> (Vec3, Vec3) {
    let samples = samples.clamp(1, MOST_SAMPLES);
    let n = f64::from(samples);
    let (mut mean, mut squares) = (DVec3::ZERO, DVec3::ZERO);
    // Welford's sums do not cancel.
    for k in 1..=samples {
        let value = sample();
        let step = value - mean;
        mean += step / f64::from(k);
        squares += step * (value - mean);
    }
    let variance = squares / (n * (n - 1.0).max(1.0));
    (mean.as_vec3(), variance.map(f64::sqrt).as_vec3())
}

/// The emissive triangles, for choosing points on them with a density in proportion to their
/// emission.
#[derive(Debug, Clone, Default)]
struct Emitters {
    numbers: Vec<u32>,
    /// Area times emission of the triangles up to and with each.
    sums: Vec<f64>,
}

impl Emitters {
    fn new(triangles: &[LitTriangle], materials: &[Material]) -> Self {
        let mut emitters = Self::default();
        let mut sum = 0.0;
        for (i, t) in triangles.iter().enumerate() {
            let power = brightness(&materials[t.material as usize]) * t.area();
            if power > 0.0 && power.is_finite() {
                sum += power;
                emitters.numbers.push(i as u32);
                emitters.sums.push(sum);
            }
        }
        emitters
    }

    /// The density, by area, with which points of a material are chosen.
    fn density(&self, material: &Material) -> f64 {
        self.sums.last().map_or(0.0, |sum| brightness(material) / sum)
    }
}

fn brightness(material: &Material) -> f64 {
    material.emission.as_dvec3().element_sum()
}

impl PathTracer {
    /// A chosen point of a light: the way there, its unit direction, and the irradiance that it
    /// stands for on a surface that faces it. `None` if it is behind the surface or gives no light.
    ///
    /// Directions are chosen evenly in the cone under which the light is seen; one that is as wide
    /// as the whole light has a mean cosine of (1 + cos) / 2 to its axis.
    fn towards(&self, light: &Light, at: &Surface, random: &mut Generator) -> Option<(DVec3, DVec3, DVec3)> {
        let incident = light.incident(at.point.as_vec3())?;
        let cos = f64::from(incident.cos_half_angle);
        let (a, b): (f64, f64) = (random.random(), random.random());
        let direction = turned(incident.direction.as_dvec3().normalize(), 1.0 - a * (1.0 - cos), b);
        if direction.dot(at.normal) <= 0.0 {
            return None;
        }
        let distance = f64::from(incident.distance).min(self.far(at.point));
        Some((direction * distance, direction, incident.irradiance.as_dvec3() * (2.0 / (1.0 + cos))))
    }

    fn emitted(&self, at: &Surface, scatter: &Scatter, random: &mut Generator) -> Option<DVec3> {
        let Emitters { numbers, sums } = &self.emitters;
        let wanted = random.random::<f64>() * sums.last()?;
        let place = sums.partition_point(|&s| s <= wanted).min(numbers.len() - 1);
        let triangle = &self.triangles[numbers[place] as usize];
        let [p, q, r] = triangle.corners.map(|p| p.as_dvec3());
        // Evenly on the triangle (Turk 1990).
        let (root, v) = (random.random::<f64>().sqrt(), random.random::<f64>());
        let target = p * (1.0 - root) + q * (root * (1.0 - v)) + r * (root * v);
        self.colour(triangle, target)?;
        let way = target - self.off(at.point, at.normal);
        let square = way.length_squared();
        let direction = way.try_normalize()?;
        let material = &self.materials[triangle.material as usize];
        let across = -(q - p).cross(r - p).try_normalize()?.dot(direction);
        // A surface that is seen from its front only emits nothing to its back.
        let across = if material.sides == Sides::Front { across } else { across.abs() };
        let (value, by_area) = (scatter.value(direction), self.emitters.density(material));
        if value.max_element() <= 0.0 || across <= 0.0 || self.hides(at, way) {
            return None;
        }
        let density = by_area * square / across;
        // The balance heuristic, with the density over itself taken out.
        let weighed = material.emission.as_dvec3() / (density + scatter.density(direction));
        (scatter.normal().dot(direction) > 0.0).then_some(value * weighed)
    }

    /// The weight of the emission of a surface that a scattered ray, found with some density from
    /// some point, has hit; the rest of it is found by [`Self::emitted`].
    fn share(&self, at: &Surface, direction: DVec3, from: Option<(f64, DVec3)>) -> f64 {
        let Some((density, origin)) = from else { return 1.0 };
        let across = at.normal.dot(direction).abs();
        let square = at.point.distance_squared(origin);
        let by_area = self.emitters.density(&self.materials[at.material]);
        // Over the cosine, which may be 0.
        let sum = density * across + by_area * square;
        if sum > 0.0 { density * across / sum } else { 0.0 }
    }
}
