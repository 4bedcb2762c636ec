//! Sets of points in the unit disc, for directions of rays around a receiver.

use glam::Vec2;

use crate::sets::random::{Random, hash};

/// The greatest number of points of a set.
pub const MOST_SAMPLES: u32 = 4096;
/// The greatest number of points of all sets.
pub const MOST_POINTS: u32 = 16_384;

/// Why sets were refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "{sets} sets of {samples} samples: there must be 1 or more of both, up to {MOST_SAMPLES} samples and {MOST_POINTS} in all"
)]
pub struct SampleError {
    /// Points of a set.
    pub samples: u32,
    /// The number of sets.
    pub sets: u32,
}

/// Some sets of points.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleSets {
    points: Vec<Vec2>,
    sets: usize,
}

impl SampleSets {
    /// `sets` sets of `samples` points that fill the disc evenly: spirals of Vogel (1979, "A better
    /// way to construct the sunflower head"), each turned by an angle of its own. Time and
    /// memory: proportional to the points.
    ///
    /// # Errors
    /// If one of the numbers is 0, or there are too many points.
    pub fn spirals(samples: u32, sets: u32) -> Result<Self, SampleError> {
        if samples == 0 || sets == 0 || samples > MOST_SAMPLES || samples.saturating_mul(sets) > MOST_POINTS {
            return Err(SampleError { samples, sets });
        }
        let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        let mut points = Vec::with_capacity((samples * sets) as usize);
        for number in 0..sets {
            let turn = Random::new(hash(1) ^ u64::from(number)).within(0.0, std::f64::consts::TAU);
            points.extend((0..samples).map(|i| {
                let radius = ((f64::from(i) + 0.5) / f64::from(samples)).sqrt();
                let (sine, cosine) = (turn + golden * f64::from(i)).sin_cos();
                Vec2::new((radius * cosine) as f32, (radius * sine) as f32)
            }));
        }
        Ok(Self { points, sets: sets as usize })
    }

    /// The points of all sets, one set after the other.
    pub fn all(&self) -> &[Vec2] {
        &self.points
    }

    /// The points of a set; sets repeat.
    pub fn set(&self, number: usize) -> &[Vec2] {
        let size = self.points.len() / self.sets;
        &self.points[number % self.sets * size..][..size]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_fill_the_disc_evenly_and_wrong_numbers_are_refused() {
        let sets = SampleSets::spirals(400, 2).unwrap();
        let near = sets.set(1).iter().filter(|p| p.length() < 0.5).count();
        assert!((98..=102).contains(&near) && sets.set(0) != sets.set(1));
        assert_eq!(sets, SampleSets::spirals(400, 2).unwrap());
        for (samples, sets) in [(0, 1), (1, 0), (5000, 1), (4096, 5), (u32::MAX, u32::MAX)] {
            assert_eq!(SampleSets::spirals(samples, sets), Err(SampleError { samples, sets }));
        }
        assert_eq!(SampleSets::spirals(1, 1).unwrap().set(7).len(), 1);
    }
}
