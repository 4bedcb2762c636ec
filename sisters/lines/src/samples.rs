//! Blue-noise points in discs, for the columns around a receiver (Benevides 2015, section 3.3.2).
//!
//! The points of a set come from three discs of radii 0.2, 0.5 and 1, a third each, so that they
//! are denser in the middle, where the lines are that darken most. Points of one disc keep apart:
//! Mitchell 1991, "Spectrally optimal sampling for distribution ray tracing" (best candidates).

use glam::Vec2;

use crate::sets::random::{Random, hash};

/// The radii of the discs.
pub const RADII: [f32; 3] = [0.2, 0.5, 1.0];

/// The greatest number of points of a set.
pub const MOST_SAMPLES: u32 = 4096;
/// The greatest number of points of all sets: best candidates take a time that grows with the
/// square of a set.
pub const MOST_POINTS: u32 = 16_384;

/// Candidates for each point.
const CANDIDATES: usize = 12;

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

/// A point in the unit disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The point.
    pub at: Vec2,
    /// The area of the disc that it stands for: the inverse of the density of all points here.
    /// Those of a set add up to about pi.
    pub area: f32,
}

/// Some sets of points.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleSets {
    samples: Vec<Sample>,
    sets: usize,
}

impl SampleSets {
    /// Makes `sets` sets of `samples` points. Time: 2 `sets * samples^2` distances. Memory: 12
    /// bytes a point.
    ///
    /// # Errors
    /// If one of them is 0, or there are too many.
    pub fn new(samples: u32, sets: u32, seed: u64) -> Result<Self, SampleError> {
        let many = samples > MOST_SAMPLES || samples.saturating_mul(sets) > MOST_POINTS;
        if samples == 0 || sets == 0 || many {
            return Err(SampleError { samples, sets });
        }
        // The outermost disc has points in any case.
        let counts = [samples / 3, (samples + 1) / 3, samples.div_ceil(3)].map(|n| n as usize);
        let set = |number: u32| {
            let mut random = Random::new(hash(seed) ^ u64::from(number));
            let discs = RADII.iter().zip(counts).map(|(&r, n)| (r, disc(n, &mut random)));
            discs.flat_map(|(r, points)| points.into_iter().map(move |p| p * r)).collect::<Vec<_>>()
        };
        let density = |p: Vec2| -> f32 {
            let of = |(&r, &n): (&f32, &usize)| match p.length() < r {
                true => n as f32 / (std::f32::consts::PI * r * r),
                false => 0.0,
            };
            RADII.iter().zip(&counts).map(of).sum()
        };
        let samples = (0..sets).flat_map(set).map(|at| Sample { at, area: 1.0 / density(at) }).collect();
        Ok(Self { samples, sets: sets as usize })
    }

    /// Makes `sets` sets of `samples` points that fill one disc evenly, for rays: spirals of Vogel
    /// (1979, "A better way to construct the sunflower head"), each turned by a seeded angle. Time
    /// and memory: proportional to the points.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn spirals(samples: u32, sets: u32, seed: u64) -> Result<Self, SampleError> {
        let many = samples > MOST_SAMPLES || samples.saturating_mul(sets) > MOST_POINTS;
        if samples == 0 || sets == 0 || many {
            return Err(SampleError { samples, sets });
        }
        let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        let area = std::f32::consts::PI / samples as f32;
        let set = |number: u32| {
            let turn = Random::new(hash(seed) ^ u64::from(number)).within(0.0, std::f64::consts::TAU);
            (0..samples).map(move |i| {
                let radius = ((f64::from(i) + 0.5) / f64::from(samples)).sqrt();
                let (sine, cosine) = (turn + golden * f64::from(i)).sin_cos();
                Sample { at: Vec2::new((radius * cosine) as f32, (radius * sine) as f32), area }
            })
        };
        Ok(Self { samples: (0..sets).flat_map(set).collect(), sets: sets as usize })
    }

    /// The number of sets.
    pub fn count(&self) -> usize {
        self.sets
    }

    /// The points of all sets, one set after the other.
    pub fn all(&self) -> &[Sample] {
        &self.samples
    }

    /// The points of a set; sets repeat.
    pub fn set(&self, number: usize) -> &[Sample] {
        let size = self.samples.len() / self.sets;
        &self.samples[number % self.sets * size..][..size]
    }
}

/// Points of the open unit disc that keep apart.
fn disc(count: usize, random: &mut Random) -> Vec<Vec2> {
    let mut points: Vec<Vec2> = Vec::with_capacity(count);
    let mut candidate = || loop {
        let p = Vec2::new(random.within(-1.0, 1.0) as f32, random.within(-1.0, 1.0) as f32);
        if p.length() < 0.999 {
            return p;
        }
    };
    for _ in 0..count {
        let mut best = (candidate(), -1.0);
        for _ in 0..CANDIDATES {
            let p = candidate();
            let apart = points.iter().map(|q| q.distance_squared(p)).fold(f32::INFINITY, f32::min);
            if apart > best.1 {
                best = (p, apart);
            }
        }
        points.push(best.0);
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_fill_three_discs_evenly_and_their_areas_add_up_to_the_disc() {
        let sets = SampleSets::new(150, 8, 3).unwrap();
        for i in 0..sets.count() {
            let set = sets.set(i);
            let within = |r: f32| set.iter().filter(|s| s.at.length() < r).count();
            // 50 of the smallest disc, and by area 16% and 4% of the others: 50 + 8 + 2, and 50 +
            // 50 + 12.5.
            assert!((52..68).contains(&within(0.2)) && (104..122).contains(&within(0.5)), "{}", within(0.5));
            let area: f32 = set.iter().map(|s| s.area).sum();
            assert!((area - std::f32::consts::PI).abs() < 0.35, "{area}");
            // Random points of this density come as near as 0.003 to each other.
            let outer = &set[100..];
            let apart = |i: usize| {
                let others = outer.iter().enumerate().filter(|(j, _)| *j != i);
                others.map(|(_, q)| q.at.distance(outer[i].at)).fold(f32::INFINITY, f32::min)
            };
            let nearest = (0..outer.len()).map(apart).fold(f32::INFINITY, f32::min);
            assert!(nearest > 0.05, "{nearest}");
        }
        assert_eq!(sets, SampleSets::new(150, 8, 3).unwrap());
        assert_ne!(sets.set(0), sets.set(1));
        for (samples, count) in [(0, 1), (1, 0), (5000, 1), (4096, 5), (u32::MAX, u32::MAX)] {
            assert_eq!(SampleSets::new(samples, count, 1), Err(SampleError { samples, sets: count }));
        }
        assert_eq!(SampleSets::new(1, 1, 1).unwrap().set(7).len(), 1);
    }
}
