//! The radius of squares from the distances between neighbouring points.
//!
//! Tavares 2009, section 5.1.5, has one radius by hand, and suggests the distance of one point to
//! its nearest neighbour. Here a side is the distance to the sixth nearest, so that squares of
//! neighbours overlap: a point of an even surface has about six.

use crate::splat::SplatError;
use glam::Vec3;
use nabo::{CandidateContainer, KDTree, NotNan, Parameters, Point};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::cmp::Ordering;

/// The neighbour whose distance is the side of a square.
const NEIGHBOUR: u32 = 6;

/// The part of points whose squares reach their sixth neighbour if all have the automatic radius.
const PART: f64 = 0.95;

/// Distances that are measured for the automatic radius: their 95th percentile is then off by at
/// most about 0.3 percentile ranks.
const QUERIES: usize = 1 << 14;

/// Points of which all neighbours can be found in less than a second.
const FEW: usize = 1 << 19;

/// The boxes that stand for more points than that, and the number of points in a box.
const BOXES: usize = 64;
const POINTS_OF_A_BOX: usize = 1 << 14;

/// The points of a sample within a box.
const NEAREST: usize = 16;

/// The largest number of points in a box. Those of more are left out: they hold a place that many
/// points share.
const MOST_OF_A_BOX: usize = 8 * POINTS_OF_A_BOX;

/// One radius for all points: half the distance to the sixth nearest neighbour that 95 percent of
/// points do not exceed; 0 for less than two places.
///
/// For clouds of even density. Of more than half a million points it looks only at those in 64 small boxes
/// around random points, so that it takes a pass over the points for each of them. The same in every run.
///
/// # Errors
/// [`SplatError::PointNotFinite`].
pub fn automatic_radius(points: &[Vec3]) -> Result<f32, SplatError> {
    if let Some(index) = points.par_iter().position_first(|p| !p.is_finite()) {
        return Err(SplatError::PointNotFinite { index });
    }
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let everywhere = Near { centre: Vec3::ZERO, reach: f32::INFINITY };
    let mut distances = Vec::new();
    if points.len() <= FEW {
        distances = everywhere.distances(points, QUERIES, &mut random);
    } else {
        let sample = some(points, points.len() / POINTS_OF_A_BOX * NEAREST, &mut random);
        let boxes: Vec<Near> =
            some(&sample, BOXES, &mut random).iter().map(|&p| Near::new(p, &sample)).collect();
        let inside = |near: &Near| {
            let all = points.iter().copied().filter(|&p| near.room(p) >= 0.0);
            let inside: Vec<Vec3> = all.take(MOST_OF_A_BOX + 1).collect();
            if inside.len() > MOST_OF_A_BOX { Vec::new() } else { inside }
        };
        let inside: Vec<Vec<Vec3>> = boxes.par_iter().map(inside).collect();
        for (near, inside) in boxes.iter().zip(inside) {
            distances.extend(near.distances(&inside, QUERIES / BOXES, &mut random));
        }
        if distances.is_empty() {
            distances = everywhere.distances(&sample, QUERIES, &mut random);
        }
    }
    if distances.is_empty() {
        return Ok(0.0);
    }
    let at = (distances.len() - 1) as f64 * PART;
    Ok(half(*distances.select_nth_unstable_by(at as usize, f64::total_cmp).1))
}

fn half(distance: f64) -> f32 {
    (distance / 2.0).min(f32::MAX.into()) as f32
}

/// The value that a part of all do not exceed; 0 of none.
pub(crate) fn quantile(mut all: Vec<f32>, part: f32) -> f32 {
    let rank = (all.len() as f32 * part) as usize;
    if rank < all.len() { *all.select_nth_unstable_by(rank, f32::total_cmp).1 } else { 0.0 }
}

/// By x, then y, then z; finite.
fn compare(a: &Vec3, b: &Vec3) -> Ordering {
    a.to_array().partial_cmp(&b.to_array()).unwrap_or(Ordering::Equal)
}

/// Random points, one of each of `count` stretches of equal length.
fn some(points: &[Vec3], count: usize, random: &mut Pcg64Mcg) -> Vec<Vec3> {
    let count = count.min(points.len());
    let stretch = points.len() as f64 / count as f64;
    let mut at = |i: usize| ((i as f64 + random.random::<f64>()) * stretch) as usize % points.len();
    (0..count).map(|i| points[at(i)]).collect()
}

/// The points of a cloud by place, at most 2^30.
pub(crate) struct Places<'a> {
    points: &'a [Vec3],
    order: Vec<u32>,
}

impl<'a> Places<'a> {
    pub fn new(points: &'a [Vec3]) -> Self {
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        order
            .par_sort_unstable_by(|&a, &b| compare(&points[a as usize], &points[b as usize]).then(a.cmp(&b)));
        Self { points, order }
    }

    /// The points at each place.
    pub fn groups(&self) -> impl Iterator<Item = &[u32]> {
        self.order.chunk_by(|&a, &b| self.points[a as usize] == self.points[b as usize])
    }
}

/// Finds neighbours of points that are at different places.
pub(crate) struct Neighbours(KDTree<f64, Place>);

impl Neighbours {
    pub fn new(points: impl Iterator<Item = Vec3>) -> Self {
        Self(KDTree::new(&points.map(Place::new).collect::<Vec<_>>()))
    }

    /// The nearest points to one of them, nearest first, but for itself.
    pub fn of(&self, point: Vec3, count: u32) -> impl Iterator<Item = u32> {
        let (all, place) = (CandidateContainer::Linear, Place::new(point));
        let (epsilon, max_radius) = (0.0, f64::INFINITY);
        let how = Parameters { epsilon, max_radius, allow_self_match: true, sort_results: true };
        let nearest = self.0.knn_advanced(count + 1, &place, all, &how, None).into_iter();
        nearest.filter(|neighbour| neighbour.dist2.into_inner() > 0.0).map(|neighbour| neighbour.index)
    }
}

/// A point for the tree, which cuts boxes in the middle: in doubles the middle of two different
/// floats is between them.
#[derive(Clone, Copy, Default)]
struct Place([f64; 3]);

impl Place {
    fn new(p: Vec3) -> Self {
        Self(p.as_dvec3().to_array())
    }
}

impl Point<f64> for Place {
    const DIM: u32 = 3;

    fn set(&mut self, axis: u32, value: NotNan<f64>) {
        self.0[axis as usize] = value.into_inner();
    }

    fn get(&self, axis: u32) -> NotNan<f64> {
        NotNan::new(self.0[axis as usize]).unwrap_or_default()
    }
}

/// A box, in which points are looked at closely.
struct Near {
    centre: Vec3,
    reach: f32,
}

impl Near {
    /// The box around a point that reaches to its [`NEAREST`] neighbours of a sample.
    fn new(centre: Vec3, sample: &[Vec3]) -> Self {
        let mut reaches: Vec<f32> = sample.iter().map(|&p| (p - centre).abs().max_element()).collect();
        let nearest = NEAREST.min(reaches.len() - 1);
        Self { centre, reach: *reaches.select_nth_unstable_by(nearest, f32::total_cmp).1 }
    }

    /// How far a point is from the sides; negative outside.
    fn room(&self, p: Vec3) -> f32 {
        self.reach - (p - self.centre).abs().max_element()
    }

    /// The distances from some of the points in the box to the neighbours that count, as long as no
    /// point outside may be nearer.
    fn distances(&self, points: &[Vec3], count: usize, random: &mut Pcg64Mcg) -> Vec<f64> {
        let mut points = points.to_vec();
        points.par_sort_unstable_by(compare);
        points.dedup();
        if points.len() < 2 {
            return Vec::new();
        }
        let Neighbours(tree) = Neighbours::new(points.iter().copied());
        let distance = |p: Vec3| {
            // The nearest is the place itself.
            let last = tree.knn(NEIGHBOUR + 1, &Place::new(p)).last().map_or(0.0, |last| last.dist2.sqrt());
            Some(last).filter(|distance| *distance <= self.room(p).into())
        };
        some(&points, count, random).into_par_iter().filter_map(distance).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::sphere;

    fn square(side: usize) -> Vec<Vec3> {
        (0..side * side).map(|i| Vec3::new((i % side) as f32, (i / side) as f32, 0.0)).collect()
    }

    #[test]
    fn the_automatic_radius_of_boxes_is_that_of_all_points() {
        // In a square grid the sixth nearest neighbour is a diagonal away.
        assert_eq!(automatic_radius(&square(100)), Ok(0.5_f32.sqrt()));
        assert_eq!(automatic_radius(&square(800)), Ok(0.5_f32.sqrt()));
        let points: Vec<Vec3> = sphere(FEW + 9).iter().map(|p| p.as_vec3()).collect();
        let everywhere = Near { centre: Vec3::ZERO, reach: f32::INFINITY };
        let mut all = everywhere.distances(&points, points.len(), &mut Pcg64Mcg::seed_from_u64(1));
        let at = (all.len() as f64 * PART) as usize;
        let expected = half(*all.select_nth_unstable_by(at, f64::total_cmp).1);
        let found = automatic_radius(&points).unwrap();
        assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
    }

    #[test]
    fn points_at_few_places_end_quickly() {
        let places =
            |n: usize, count: usize| (0..n).map(|i| Vec3::splat((i % count) as f32)).collect::<Vec<_>>();
        assert_eq!(automatic_radius(&[]), Ok(0.0));
        assert_eq!(automatic_radius(&places(FEW + 1, 1)), Ok(0.0));
        assert_eq!(automatic_radius(&places(100_000, 2)), Ok(0.75_f32.sqrt()));
        assert!(automatic_radius(&places(FEW + 1, 20)).unwrap() > 1.0);
        // Half of the points are at one place, as the invalid pixels of a depth camera are.
        let mut points = square(800);
        points.extend(vec![Vec3::ZERO; points.len()]);
        assert_eq!(automatic_radius(&points), Ok(0.5_f32.sqrt()));
        assert_eq!(automatic_radius(&[Vec3::NAN]), Err(SplatError::PointNotFinite { index: 0 }));
        // Floats beside each other, between which a tree of floats finds no middle.
        let beside =
            |i: usize| Vec3::new(f32::from_bits(0x3f80_0000 + (i % 2) as u32), 0.0, i as f32 * 1e-12);
        assert!(automatic_radius(&(0..1000).map(beside).collect::<Vec<_>>()).is_ok());
    }
}
