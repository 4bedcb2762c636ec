//! Random numbers from a seed.

use crate::random::{Generator, generator, spread};
use glam::Vec3;
use rand::RngExt;

/// The random numbers of a scene.
pub(super) struct Dice(pub(super) Generator);

impl Dice {
    pub(super) fn new(seed: u64, scene: u64) -> Self {
        Self(generator(spread(seed), scene))
    }

    /// A number from `lo` to `hi`.
    pub(super) fn range(&mut self, lo: f32, hi: f32) -> f32 {
        lo + (hi - lo) * self.0.random::<f32>()
    }

    pub(super) fn chance(&mut self, share: f32) -> bool {
        self.0.random::<f32>() < share
    }

    pub(super) fn point(&mut self, lo: Vec3, hi: Vec3) -> Vec3 {
        Vec3::new(self.range(lo.x, hi.x), self.range(lo.y, hi.y), self.range(lo.z, hi.z))
    }
}
