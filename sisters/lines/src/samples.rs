//! Sets of points in the unit disc, for directions around a receiver: spirals for rays, and blue
//! noise for the columns of the thesis (Benevides 2015, section 3.3.2).

use glam::Vec2;

use crate::sets::random::{Random, hash};

/// The radii of the discs of blue noise.
const RADII: [f32; 3] = [0.2, 0.5, 1.0];
/// Candidates for each of its points.
const CANDIDATES: usize = 12;

/// The greatest number of points of a set.
pub const MOST_SAMPLES: u32 = 4096;
/// The greatest number of points of all sets: best candidates take a time that grows with the
/// square of a set.
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
    /// way to construct the sunflower head"), each turned by a seeded angle. Time and memory:
    /// proportional to the points.
    ///
    /// # Errors
    /// If one of the numbers is 0, or there are too many points.
    pub fn spirals(samples: u32, sets: u32, seed: u64) -> Result<Self, SampleError> {
        let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        Self::new([samples, sets], seed, |random| {
            let turn = random.within(0.0, std::f64::consts::TAU);
            let point = |i: u32| {
                let radius = ((f64::from(i) + 0.5) / f64::from(samples)).sqrt();
                let (sine, cosine) = (turn + golden * f64::from(i)).sin_cos();
                Vec2::new((radius * cosine) as f32, (radius * sine) as f32)
            };
            (0..samples).map(point).collect()
        })
    }

    /// Sets of points of three discs of the radii 0.2, 0.5 and 1, a third each, so that they are
    /// denser in the middle, where the lines are that darken most. Points of one disc keep apart
    /// (best candidates of Mitchell 1991, "Spectrally optimal sampling for distribution ray
    /// tracing"). Time: 2 `sets * samples^2` distances.
    ///
    /// # Errors
    /// As [`Self::spirals`].
    pub fn discs(samples: u32, sets: u32, seed: u64) -> Result<Self, SampleError> {
        Self::new([samples, sets], seed, |random| {
            // The outermost disc has points in any case.
            let counts = [samples / 3, (samples + 1) / 3, samples.div_ceil(3)];
            let discs = RADII.into_iter().zip(counts);
            discs.flat_map(|(r, n)| disc(n as usize, random).into_iter().map(move |p| p * r)).collect()
        })
    }

    fn new(
        [samples, sets]: [u32; 2],
        seed: u64,
        set: impl Fn(&mut Random) -> Vec<Vec2>,
    ) -> Result<Self, SampleError> {
        let many = samples > MOST_SAMPLES || samples.saturating_mul(sets) > MOST_POINTS;
        if samples == 0 || sets == 0 || many {
            return Err(SampleError { samples, sets });
        }
        let points = (0..sets).flat_map(|number| set(&mut Random::new(hash(seed) ^ u64::from(number))));
        Ok(Self { points: points.collect(), sets: sets as usize })
    }

    /// The number of sets.
    pub fn count(&self) -> usize {
        self.sets
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
    fn sets_fill_their_discs_evenly_and_wrong_numbers_are_refused() {
        let sets = SampleSets::discs(150, 8, 3).unwrap();
        let within = |set: &[Vec2], r: f32| set.iter().filter(|p| p.length() < r).count();
        for set in (0..sets.count()).map(|i| sets.set(i)) {
            // 50 of the smallest disc, and by area 16% and 4% of the others: 50 + 8 + 2, and 50 +
            // 50 + 12.5.
            let counts = [within(set, 0.2), within(set, 0.5)];
            assert!((52..68).contains(&counts[0]) && (104..122).contains(&counts[1]), "{counts:?}");
            // Random points of this density come as near as 0.003 to each other.
            let outer = &set[100..];
            let pairs = (1..outer.len()).flat_map(|i| (0..i).map(move |j| outer[i].distance(outer[j])));
            assert!(pairs.fold(f32::INFINITY, f32::min) > 0.05);
        }
        assert_eq!(sets, SampleSets::discs(150, 8, 3).unwrap());
        assert_ne!(sets.set(0), sets.set(1));
        let spiral = SampleSets::spirals(400, 2, 1).unwrap();
        assert!((98..=102).contains(&within(spiral.set(1), 0.5)) && spiral.set(0) != spiral.set(1));
        for make in [SampleSets::discs, SampleSets::spirals] {
            for (samples, count) in [(0, 1), (1, 0), (5000, 1), (4096, 5), (u32::MAX, u32::MAX)] {
                assert_eq!(make(samples, count, 1), Err(SampleError { samples, sets: count }));
            }
            assert_eq!(make(1, 1, 1).unwrap().set(7).len(), 1);
        }
    }
}
