//! Random numbers of benches.

use glam::Vec2;

/// Random numbers from 0 to 1 (Weyl sequence, mixed as in SplitMix64).
pub struct Random(pub u64);

// Not every bench asks for everything.
#[allow(dead_code)]
impl Random {
    /// The next one.
    pub fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z >> 40) as f32 / (1u64 << 24) as f32
    }

    /// A point of a square.
    pub fn point(&mut self, size: f32) -> Vec2 {
        Vec2::new(self.next(), self.next()) * size
    }

    /// A unit vector.
    pub fn direction(&mut self) -> Vec2 {
        Vec2::from_angle(self.next() * std::f32::consts::TAU)
    }
}
