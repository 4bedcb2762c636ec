//! Fur textures (thesis, chapter 5).

use rand::{SeedableRng, seq::SliceRandom};
use rand_pcg::Pcg64Mcg;

use crate::error::{Error, range};
use crate::numeric::LEAST_DENSITY;

/// The texels next to a hair that get no hair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Neighborhood {
    /// Hairs may touch.
    #[default]
    None,
    /// The four texels that share a side.
    Four,
    /// The eight texels that share a side or a corner.
    Eight,
}

/// A square texture of hairs that repeats without seams.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FurMap {
    size: u32,
    hairs: Vec<bool>,
}

/// The largest side of a map: 64 MiB as texels.
const MAX_SIZE: u32 = 4096;

impl FurMap {
    fn check(size: u32, density: f64) -> Result<usize, Error> {
        range("the side of a fur map in texels", size.into(), 1.0, MAX_SIZE.into())?;
        range("the density of a fur map", density, 0.0, 1.0)?;
        Ok((density * f64::from(size) * f64::from(size)).floor() as usize)
    }

    /// The side, in texels.
    pub fn size(&self) -> u32 {
        self.size
    }

    /// Whether a texel has a hair, row by row.
    pub fn hairs(&self) -> &[bool] {
        &self.hairs
    }

    /// The number of hairs.
    pub fn count(&self) -> usize {
        self.hairs.iter().filter(|&&h| h).count()
    }

    /// The texels as RGBA: white everywhere, so that filtering makes no grey fringes; alpha is 255
    /// for hairs and 0 elsewhere.
    pub fn texels(&self) -> Vec<[u8; 4]> {
        self.hairs.iter().map(|&hair| [255, 255, 255, if hair { 255 } else { 0 }]).collect()
    }

    /// The place of the texel at some offset, across the borders.
    fn beside(&self, at: usize, dx: i64, dy: i64) -> usize {
        let n = i64::from(self.size);
        let (x, y) = (at as i64 % n, at as i64 / n);
        ((y + dy).rem_euclid(n) * n + (x + dx).rem_euclid(n)) as usize
    }
}

/// All texels in a random order.
fn shuffled(size: u32, seed: u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..size as usize * size as usize).collect();
    order.shuffle(&mut Pcg64Mcg::seed_from_u64(seed));
    order
}

/// A map of `floor(density * size²)` hairs at random places (thesis, algorithm 4). Each texel is
/// tried once, in random order: the same distribution as trying random texels again and again, but
/// it ends. Linear in the texels; `size` is 1 to 4096.
///
/// # Errors
/// [`Error::Jammed`] if the neighbourhoods leave no room for so many hairs: at a density of about
/// 0.364 with four neighbours, 0.187 with eight. Refuses sizes and densities out of range.
pub fn fur_map(size: u32, density: f64, neighborhood: Neighborhood, seed: u64) -> Result<FurMap, Error> {
    let goal = FurMap::check(size, density)?;
    let offsets: &[(i64, i64)] = match neighborhood {
        Neighborhood::None => &[],
        Neighborhood::Four => &[(1, 0), (-1, 0), (0, 1), (0, -1)],
        Neighborhood::Eight => &[(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)],
    };
    let mut map = FurMap { size, hairs: vec![false; size as usize * size as usize] };
    let mut count = 0;
    for at in shuffled(size, seed) {
        if count == goal {
            break;
        }
        // A map of one texel is its own neighbour.
        if offsets.iter().all(|&(dx, dy)| !map.hairs[map.beside(at, dx, dy)]) {
            map.hairs[at] = true;
            count += 1;
        }
    }
    if count < goal {
        let coverage = count as f64 / map.hairs.len() as f64;
        return Err(Error::Jammed { coverage, density });
    }
    Ok(map)
}

/// A map of `floor(density * size²)` hairs that keep their distance: blue noise, without clumps and
/// gaps, the better choice. Texels are tried in random order, with a circle around each hair that
/// excludes others; whenever no room is left, the circles shrink (relaxed dart throwing, McCool &
/// Fiume 1992). It always ends. Costs some ten passes over the texels.
///
/// # Errors
/// Refuses sizes and densities out of range.
pub fn blue_noise(size: u32, density: f64, seed: u64) -> Result<FurMap, Error> {
    let goal = FurMap::check(size, density)?;
    let mut map = FurMap { size, hairs: vec![false; size as usize * size as usize] };
    let order = shuffled(size, seed);
    let mut count = 0;
    // The distance of hairs in the densest packing: no more fit.
    let mut radius = (2.0 / (3f64.sqrt() * density.max(LEAST_DENSITY))).sqrt().min(f64::from(size) * 0.5);
    while count < goal {
        let mut taken = vec![false; map.hairs.len()];
        let around = |at: usize, taken: &mut [bool]| {
            let reach = radius.floor() as i64;
            for dy in -reach..=reach {
                let width = (radius * radius - (dy * dy) as f64).max(0.0).sqrt();
                // Hairs may be as far apart as the radius.
                let width = width.ceil() as i64 - 1;
                (-width..=width).for_each(|dx| taken[map.beside(at, dx, dy)] = true);
            }
            taken[at] = true;
        };
        (0..map.hairs.len()).filter(|&at| map.hairs[at]).for_each(|at| around(at, &mut taken));
        let mut new = Vec::new();
        for &at in &order {
            if count < goal && !taken[at] {
                around(at, &mut taken);
                new.push(at);
                count += 1;
            }
        }
        new.into_iter().for_each(|at| map.hairs[at] = true);
        radius *= 0.92;
    }
    Ok(map)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_exact_and_neighbours_stay_free() {
        for (neighborhood, density) in [
            (Neighborhood::None, 0.2),
            (Neighborhood::None, 1.0),
            (Neighborhood::Four, 0.3),
            (Neighborhood::Eight, 0.15),
        ] {
            let map = fur_map(64, density, neighborhood, 7).unwrap();
            assert_eq!(map.count(), (density * 4096.0) as usize);
            assert_eq!(map, fur_map(64, density, neighborhood, 7).unwrap());
            if density < 1.0 {
                assert_ne!(map, fur_map(64, density, neighborhood, 8).unwrap());
            }
            for at in (0..4096).filter(|&at| map.hairs()[at]) {
                let taken = |dx, dy| map.hairs()[map.beside(at, dx, dy)];
                let side = [(1, 0), (-1, 0), (0, 1), (0, -1)].iter().any(|&(x, y)| taken(x, y));
                let corner = [(1, 1), (-1, 1), (1, -1), (-1, -1)].iter().any(|&(x, y)| taken(x, y));
                assert!(!(side && neighborhood != Neighborhood::None));
                assert!(!(corner && neighborhood == Neighborhood::Eight));
            }
            assert!(
                map.texels().iter().zip(map.hairs()).all(|(t, &h)| *t == [255, 255, 255, 255 * u8::from(h)])
            );
        }
    }

    #[test]
    fn crowded_maps_jam_instead_of_hanging() {
        for (neighborhood, expected) in [(Neighborhood::Four, 0.364), (Neighborhood::Eight, 0.187)] {
            let Err(Error::Jammed { coverage, density }) = fur_map(256, 0.5, neighborhood, 3) else {
                panic!()
            };
            println!("{neighborhood:?}: jammed at {coverage:.4}");
            assert!((coverage - expected).abs() < 0.003 && density == 0.5, "{coverage}");
        }
        // The density that the thesis used, with eight neighbours.
        assert!(matches!(fur_map(256, 0.2, Neighborhood::Eight, 1), Err(Error::Jammed { .. })));
    }

    /// The variance of the number of hairs in squares of 8x8 texels, relative to that of
    /// independent hairs.
    fn clumping(map: &FurMap) -> f64 {
        let n = map.size() as usize / 8;
        let counts = (0..n * n).map(|b| {
            let texels = (0..64).map(|t| (b / n * 8 + t / 8) * map.size() as usize + b % n * 8 + t % 8);
            texels.filter(|&t| map.hairs()[t]).count() as f64
        });
        let counts: Vec<f64> = counts.collect();
        let mean = counts.iter().sum::<f64>() / counts.len() as f64;
        let variance = counts.iter().map(|c| (c - mean) * (c - mean)).sum::<f64>() / counts.len() as f64;
        variance / (mean * (1.0 - mean / 64.0))
    }

    #[test]
    fn blue_noise_has_no_clumps() {
        for (density, most) in [(0.05, 0.35), (0.1, 0.35), (0.2, 0.4), (0.5, 0.8)] {
            let blue = blue_noise(128, density, 4).unwrap();
            assert_eq!(blue.count(), (density * 16384.0) as usize);
            assert_eq!(blue, blue_noise(128, density, 4).unwrap());
            let white = fur_map(128, density, Neighborhood::None, 4).unwrap();
            println!(
                "density {density}: clumping {:.2}, of independent hairs {:.2}",
                clumping(&blue),
                clumping(&white)
            );
            assert!(clumping(&blue) < most && clumping(&white) > 0.8);
        }
    }

    #[test]
    fn tiny_full_and_empty_maps_work_and_bad_sizes_do_not() {
        for size in [1, 2, 3] {
            for density in [0.0, 0.3, 1.0] {
                let goal = (density * f64::from(size * size)) as usize;
                assert_eq!(blue_noise(size, density, 1).unwrap().count(), goal);
                assert_eq!(fur_map(size, density, Neighborhood::None, 1).unwrap().count(), goal);
            }
        }
        for (size, density) in [(0, 0.1), (4097, 0.1), (8, -0.1), (8, 1.1), (8, f64::NAN)] {
            assert!(matches!(fur_map(size, density, Neighborhood::None, 1), Err(Error::Range { .. })));
            assert!(matches!(blue_noise(size, density, 1), Err(Error::Range { .. })));
        }
    }
}
