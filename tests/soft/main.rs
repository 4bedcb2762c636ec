//! Soft visibility against brute force and closed forms.

mod cells;
mod cones;
mod estimates;
mod fractions;
#[path = "../../examples/soft_walls/leak.rs"]
mod leak;
mod misuse;
mod pyramid;
mod volumes;

use casca::GridSpec;
use casca::soft::SoftGrid;
use glam::{UVec3, Vec3};

/// Cells of length 1 from the origin on.
fn soft(dims: UVec3) -> SoftGrid {
    SoftGrid::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims }).unwrap()
}

/// Numbers from 0 to 1 that look random (Knuth's generator).
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    fn point(&mut self, from: f32, to: f32) -> Vec3 {
        Vec3::from_array([(); 3].map(|()| from + (to - from) * self.next()))
    }
}
