//! Lamps that lie flush with a ceiling.

use crate::common::{indirect, lit, matt, room, scene, sheet};
use casca_radiosity::Material;
use glam::Vec3 as V;

#[test]
fn lamps_half_a_millimetre_under_a_ceiling_light_a_corridor_as_energy_says() {
    const SIZE: V = V::new(8.0, 2.5, 2.0);
    const GAP: f32 = 5e-4;
    const LAMP: f32 = 0.6;
    // Passes end when one changes less than this share, far below the margin of the test.
    const SETTLED: f64 = 1e-5;
    const PASSES: u32 = 64;
    let albedo = 0.6;
    let mut all = room(V::ZERO, SIZE, 0);
    for x in [0.7, 2.7, 4.7, 6.7] {
        all.extend(sheet(V::new(x, SIZE.y - GAP, 0.7), V::X * LAMP, V::Z * LAMP, 1));
    }
    let glowing = Material { emission: V::ONE, ..matt(albedo) };
    let corridor = scene(all, vec![matt(albedo), glowing], vec![], 0.0);
    // What lamps send down is scattered from one surface to the next until all of it is absorbed.
    let flux = std::f64::consts::PI * f64::from(4.0 * LAMP * LAMP);
    let area = f64::from(2.0 * (SIZE.x * SIZE.y + SIZE.y * SIZE.z + SIZE.z * SIZE.x));
    let known = flux / area * f64::from(albedo / (1.0 - albedo));
    for cells in [32, 64] {
        let mut cache = lit(&corridor, cells, 64, 0);
        cache.converge(SETTLED, PASSES);
        let (mut sum, steps) = (0.0, 20);
        for (i, k) in (0..steps).flat_map(|i| (0..steps).map(move |k| (i, k))) {
            let [u, v] = [i, k].map(|i| (i as f32 + 0.5) / steps as f32);
            for axis in 0..3 {
                let mut point = V::ZERO;
                let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
                (point[a], point[b]) = (SIZE[a] * u, SIZE[b] * v);
                let share = f64::from(SIZE[a] * SIZE[b]) / area / f64::from(steps * steps);
                sum += share * indirect(&cache, point, V::AXES[axis]);
                // What hangs under the ceiling is seen instead of it.
                let is_lamp =
                    axis == 1 && (0.7..1.3).contains(&point.z) && (0.7..1.3).contains(&(point.x % 2.0));
                point[axis] = SIZE[axis] - if is_lamp { GAP } else { 0.0 };
                sum += share * indirect(&cache, point, -V::AXES[axis]);
            }
        }
        println!("{cells} cells: {:.3} of what is known", sum / known);
        assert!((sum / known - 1.0).abs() < 0.05, "{cells} cells: {}", sum / known);
    }
}
