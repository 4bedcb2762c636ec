//! Voxels that hold points, and the flat parts in them.

use std::collections::HashMap;

use glam::{DVec3, IVec3, Vec3};
use rayon::prelude::*;

use super::facets::{Facet, facets};
use crate::bricks::{BrickError, Bricks};

/// The side of a voxel in cells, about: a plane fitted to the 64 cells of a wall is known to a
/// small part of a cell, and a room still has many voxels.
const VOXEL: f64 = 8.0;

/// Voxels in the order of their places. They are cells of the octree that bricks are cut by: a thin
/// slice of a hedge, cut off with its brick, would look like a wall.
pub(super) struct Voxels {
    low: DVec3,
    /// The side of a cell, and of a voxel.
    pub cell: f64,
    side: f64,
    places: Vec<IVec3>,
    numbers: HashMap<IVec3, u32>,
    /// In the order of voxels; those of one in the order of bricks.
    pub facets: Vec<Facet>,
    /// The first facet of each voxel, and their number.
    firsts: Vec<u32>,
}

impl Voxels {
    pub fn of(bricks: &Bricks, cell: f32) -> Result<Self, BrickError> {
        let (bounds, cell) = (bricks.bounds(), f64::from(cell));
        let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let edge = (high - low).max_element();
        let side = edge * (-(edge / (VOXEL * cell)).log2().round().max(0.0)).exp2();
        let mut voxels = Self {
            low,
            cell,
            side,
            places: Vec::new(),
            numbers: HashMap::new(),
            facets: Vec::new(),
            firsts: Vec::new(),
        };
        let mut found: Vec<(IVec3, Facet)> = Vec::new();
        for brick in 0..bricks.len() as u32 {
            let points = bricks.positions(brick)?;
            let mut points: Vec<(IVec3, Vec3)> = points.map(|p| (voxels.place(p), p)).collect();
            points.sort_by_key(|(place, _)| place.to_array());
            let groups: Vec<&[(IVec3, Vec3)]> = points.chunk_by(|a, b| a.0 == b.0).collect();
            voxels.numbers.extend(groups.iter().map(|group| (group[0].0, 0)));
            let each = |group: &&[(IVec3, Vec3)]| {
                let place = group[0].0;
                let middle = low + (place.as_dvec3() + 0.5) * side;
                let local = group.iter().map(|(_, p)| (p.as_dvec3() - middle) / cell);
                let seed = place.to_array().map(|i| i as u32);
                facets(local.collect(), middle, cell, seed).into_iter().map(move |facet| (place, facet))
            };
            found.extend(groups.par_iter().flat_map_iter(each).collect::<Vec<_>>());
        }
        voxels.places = voxels.numbers.keys().copied().collect();
        voxels.places.sort_unstable_by_key(|place| place.to_array());
        voxels.numbers = voxels.places.iter().copied().zip(0..).collect();
        found.sort_by_key(|(place, _)| place.to_array());
        let first = |place: &IVec3| found.partition_point(|(p, _)| p.to_array() < place.to_array()) as u32;
        voxels.firsts = voxels.places.iter().map(first).chain([found.len() as u32]).collect();
        voxels.facets = found.into_iter().map(|(_, facet)| facet).collect();
        Ok(voxels)
    }

    fn place(&self, p: Vec3) -> IVec3 {
        ((p.as_dvec3() - self.low) / self.side).floor().as_ivec3()
    }

    /// The number of the voxel that a point lies in.
    pub fn at(&self, p: Vec3) -> Option<u32> {
        self.numbers.get(&self.place(p)).copied()
    }

    /// The facets of a voxel.
    pub fn facets_of(&self, voxel: u32) -> std::ops::Range<u32> {
        let voxel = voxel as usize;
        self.firsts[voxel]..self.firsts[voxel + 1]
    }

    /// The voxel that a place near a facet's mean lies in, and its neighbours, also across edges
    /// and corners, that hold points.
    pub fn around(&self, facet: u32) -> impl Iterator<Item = u32> {
        let middle = self.place(self.facets[facet as usize].plane.mean.as_vec3());
        let step = |i: i32| IVec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        (0..27).filter_map(move |i| self.numbers.get(&(middle + step(i))).copied())
    }
}
