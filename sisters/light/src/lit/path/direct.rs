//! Direct light: next event estimation for lights and for emissive triangles.

use casca_scenes::random::Generator;
use casca_scenes::world::Sides;
use glam::DVec3;
use rand::RngExt;

use super::scatter::{Scatter, turned};
use super::{PathTracer, Surface};
use crate::Light;
use crate::lit::{LitTriangle, Material};

/// The emissive triangles, for choosing points on them with a density in proportion to their
/// emission.
#[derive(Debug, Clone, Default)]
pub(super) struct Emitters {
    numbers: Vec<u32>,
    /// Area times emission of the triangles up to and with each.
    sums: Vec<f64>,
}

impl Emitters {
    pub(super) fn new(triangles: &[LitTriangle], materials: &[Material]) -> Self {
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
    /// Direct light of all lights and of one point of the emitters, scattered at a surface.
    pub(super) fn next_event(&self, at: &Surface, scatter: &Scatter, random: &mut Generator) -> DVec3 {
        let mut sum = self.emitted(at, scatter, random).unwrap_or(DVec3::ZERO);
        for light in &self.lights {
            let Some((way, direction, irradiance)) = self.towards(light, at, random) else { continue };
            let value = scatter.value(direction) * irradiance;
            if value.max_element() > 0.0 && !self.hides(at, way) {
                sum += value;
            }
        }
        sum
    }

    /// A chosen point of a light: the way there, its unit direction, and the irradiance that it
    /// stands for on a surface that faces it. `None` if it is behind the surface or gives no light.
    ///
    /// Directions are chosen evenly in the cone under which the light is seen; one that is as wide
    /// as the whole light has a mean cosine of (1 + cos) / 2 to its axis.
    pub(super) fn towards(
        &self,
        light: &Light,
        at: &Surface,
        random: &mut Generator,
    ) -> Option<(DVec3, DVec3, DVec3)> {
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
        let way = target - self.off(at);
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
    /// some point, has hit; the rest of it is found by [`Self::next_event`].
    pub(super) fn share(&self, at: &Surface, direction: DVec3, from: Option<(f64, DVec3)>) -> f64 {
        let Some((density, origin)) = from else { return 1.0 };
        let across = at.normal.dot(direction).abs();
        let square = at.point.distance_squared(origin);
        let by_area = self.emitters.density(&self.materials[at.material]);
        // Over the cosine, which may be 0.
        let sum = density * across + by_area * square;
        if sum > 0.0 { density * across / sum } else { 0.0 }
    }
}
