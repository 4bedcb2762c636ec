//! Points that tests share.

use glam::DVec3;

/// Points spread evenly on the unit sphere (the golden spiral).
pub fn sphere(count: usize) -> Vec<DVec3> {
    let turn = std::f64::consts::PI * (3.0 - 5_f64.sqrt());
    let at = |i: usize| {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
        let (y, x) = (turn * i as f64).sin_cos();
        DVec3::new(x * (1.0 - z * z).sqrt(), y * (1.0 - z * z).sqrt(), z)
    };
    (0..count).map(at).collect()
}
