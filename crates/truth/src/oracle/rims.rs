//! Where occluders end as seen from an eye: the places that another eye looks past.

use glam::DVec3;
use rand::RngExt;

use super::frustum::Frustum;
use super::item_buffer::ItemBuffer;
use casca_scenes::random::Generator;

/// Depths that differ by a smaller share belong to one surface.
const STEP: f64 = 0.01;

/// A point at the rim of an occluder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rim {
    /// The point, on the occluder.
    pub(super) point: DVec3,
    /// The unit vector across the way to the point, away from the occluder.
    pub(super) out: DVec3,
}

/// Points at rims that an item buffer shows, at most this many. Nearer rims, and those with more
/// room behind them, come more often: an eye that moves sees more past them.
pub(super) fn rims(buffer: &ItemBuffer, frustum: &Frustum, most: usize, random: &mut Generator) -> Vec<Rim> {
    let (width, items, depths) = (buffer.width(), buffer.items(), buffer.depths());
    let mut kept: Vec<(f64, usize, usize)> = Vec::new();
    let mut offer = |a: usize, b: usize| {
        let (near, far) = if depths[a] < depths[b] { (a, b) } else { (b, a) };
        if items[a] == items[b] || depths[far] < depths[near] * (1.0 + STEP) {
            return;
        }
        // The greatest keys are a sample with these weights (Efraimidis & Spirakis 2006).
        let weight = 1.0 / depths[near] - 1.0 / depths[far];
        let key = random.random::<f64>().ln() / weight;
        kept.push((key, near, far));
        if kept.len() >= 4 * most.max(1) {
            keep(&mut kept, most);
        }
    };
    for pixel in 0..items.len() {
        if pixel % width + 1 < width {
            offer(pixel, pixel + 1);
        }
        if pixel + width < items.len() {
            offer(pixel, pixel + width);
        }
    }
    keep(&mut kept, most);
    let rim = |&(_, near, far): &(f64, usize, usize)| {
        let (origin, step) = buffer.pixel_ray(frustum, near);
        let (_, beside) = buffer.pixel_ray(frustum, far);
        let across = beside - step;
        let out = (across - step * (across.dot(step) / step.length_squared())).normalize_or_zero();
        Rim { point: origin + step * (depths[near] - frustum.near()), out }
    };
    kept.iter().map(rim).filter(|r| r.out != DVec3::ZERO && r.point.is_finite()).collect()
}

/// Keeps those with the greatest keys.
fn keep(kept: &mut Vec<(f64, usize, usize)>, most: usize) {
    kept.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    kept.truncate(most);
}
