//! Emissive triangles, as lights.

use crate::lit::{LitTriangle, Material};

/// The emissive triangles, for choosing points on them with a density in proportion to their
/// emission.
#[derive(Debug, Clone, Default)]
pub(super) struct Emitters {
    pub(super) numbers: Vec<u32>,
    /// Area times emission of the triangles up to and with each.
    pub(super) sums: Vec<f64>,
}

impl Emitters {
    pub(super) fn new(triangles: &[LitTriangle], materials: &[Material]) -> Self {
        let mut emitters = Self::default();
        let mut sum = 0.0;
        for (i, t) in triangles.iter().enumerate() {
            let power = brightness(&materials[t.material as usize]) * area(t);
            if power > 0.0 && power.is_finite() {
                sum += power;
                emitters.numbers.push(i as u32);
                emitters.sums.push(sum);
            }
        }
        emitters
    }

    /// The density, by area, with which points of a material are chosen.
    pub(super) fn density(&self, material: &Material) -> f64 {
        self.sums.last().map_or(0.0, |sum| brightness(material) / sum)
    }
}

fn brightness(material: &Material) -> f64 {
    material.emission.as_dvec3().element_sum()
}

pub(super) fn area(t: &LitTriangle) -> f64 {
    let [a, b, c] = t.corners.map(|p| p.as_dvec3());
    (b - a).cross(c - a).length() / 2.0
}
