//! The point next to each place, as a table for shaders.

use glam::IVec3;

use super::fur::Fur;
use crate::numeric::{MAX_PER_CELL, PERIOD, TEXELS};

impl Fur {
    /// For each texel of [`PERIOD`] cells, along x, then y, then z, the point next to its middle: in
    /// three bytes the way there, in 128ths of a cell and 127.5 more, and in the fourth the point's
    /// own byte. 0 where no point is within a cell. Takes some milliseconds.
    pub fn table(&self) -> Vec<u32> {
        let side = (PERIOD * TEXELS) as i32;
        let mut nearest = vec![(f32::INFINITY, 0); side.pow(3) as usize];
        let (cells, reach) = (PERIOD as i32, 2 * TEXELS as i32 + 1);
        for i in 0..cells.pow(3) {
            let cell = IVec3::new(i % cells, i / cells % cells, i / cells / cells);
            for (inside, id) in (0..self.per_cell.min(MAX_PER_CELL)).map(|k| self.point(cell, k)) {
                let point = cell.as_vec3() + inside;
                let first = ((point - 1.0) * TEXELS as f32).floor().as_ivec3();
                for j in 0..reach.pow(3) {
                    let texel = first + IVec3::new(j % reach, j / reach % reach, j / reach / reach);
                    let way = point - (texel.as_vec3() + 0.5) / TEXELS as f32;
                    // Whole numbers: middles of texels lie between the places where points are.
                    let bytes = way * 128.0 + 127.5;
                    let at = texel.rem_euclid(IVec3::splat(side));
                    let best = &mut nearest[(at.x + side * (at.y + side * at.z)) as usize];
                    let within = bytes.min_element() >= 0.0 && bytes.max_element() <= 255.0;
                    if within && way.length_squared() < best.0 {
                        let [x, y, z] = bytes.to_array().map(|byte| byte as u32);
                        *best = (way.length_squared(), x | y << 8 | z << 16 | id << 24);
                    }
                }
            }
        }
        nearest.into_iter().map(|(_, word)| word).collect()
    }
}
