//! Voxels that hold points, and the flat parts in them.

use std::collections::HashMap;

use glam::{DVec3, IVec3, Vec3};
use rayon::prelude::*;

use super::facets::{Facet, facets};
use crate::bricks::{BrickError, Bricks};

/// The side of a voxel in cells, about: a plane fitted to the 64 cells of a wall is known to a
/// small part of a cell, and a room still has many voxels.
const VOXEL: f64 = 8.0;

/// The grid of voxels. They are cells of the octree that bricks are cut by: a thin slice of a
/// hedge, cut off with its brick, would look like a wall.
pub(super) struct Grid {
    low: DVec3,
    /// The side of a cell, and of a voxel.
    cell: f64,
    side: f64,
}

impl Grid {
    pub fn new(bricks: &Bricks, cell: f32) -> Self {
        let (bounds, cell) = (bricks.bounds(), f64::from(cell));
        let low = bounds.min.as_dvec3();
        let edge = (bounds.max.as_dvec3() - low).max_element();
        let side = edge * (-(edge / (VOXEL * cell)).log2().round().max(0.0)).exp2();
        Self { low, cell, side }
    }

    fn place(&self, p: Vec3) -> IVec3 {
        ((p.as_dvec3() - self.low) / self.side).floor().as_ivec3()
    }

    /// The points of a brick by their voxels.
    pub fn groups(&self, bricks: &Bricks, brick: u32) -> Result<Vec<Group>, BrickError> {
        let mut points: Vec<(IVec3, Vec3)> = bricks.positions(brick)?.map(|p| (self.place(p), p)).collect();
        points.sort_by_key(|(place, _)| place.to_array());
        let group = |all: &[(IVec3, Vec3)]| (all[0].0, all.iter().map(|(_, p)| *p).collect());
        Ok(points.chunk_by(|a, b| a.0 == b.0).map(group).collect())
    }

    /// The flat parts among the points of a voxel.
    pub fn facets(&self, (place, points): &Group) -> Vec<Facet> {
        let middle = self.low + (place.as_dvec3() + 0.5) * self.side;
        let local = points.iter().map(|p| (p.as_dvec3() - middle) / self.cell);
        facets(local.collect(), middle, self.cell, place.to_array().map(|i| i as u32))
    }
}

/// The place of a voxel, and points in it.
type Group = (IVec3, Vec<Vec3>);

/// Voxels in the order of their places.
pub(super) struct Voxels {
    grid: Grid,
    /// The side of a cell.
    pub cell: f64,
    numbers: HashMap<IVec3, u32>,
    /// In the order of voxels; those of one in the order of bricks.
    pub facets: Vec<Facet>,
    /// The first facet of each voxel, and their number.
    firsts: Vec<u32>,
}

impl Voxels {
    pub fn of(bricks: &Bricks, cell: f32) -> Result<Self, BrickError> {
        let grid = Grid::new(bricks, cell);
        let mut numbers = HashMap::new();
        let mut found: Vec<(IVec3, Facet)> = Vec::new();
        for brick in 0..bricks.len() as u32 {
            let groups = grid.groups(bricks, brick)?;
            numbers.extend(groups.iter().map(|group| (group.0, 0)));
            let each = |group: &Group| {
                let place = group.0;
                grid.facets(group).into_iter().map(move |facet| (place, facet))
            };
            found.extend(groups.par_iter().flat_map_iter(each).collect::<Vec<_>>());
        }
        let mut places: Vec<IVec3> = numbers.into_keys().collect();
        places.sort_unstable_by_key(|place| place.to_array());
        let numbers = places.iter().copied().zip(0..).collect();
        found.sort_by_key(|(place, _)| place.to_array());
        let first = |place: &IVec3| found.partition_point(|(p, _)| p.to_array() < place.to_array()) as u32;
        let firsts = places.iter().map(first).chain([found.len() as u32]).collect();
        let facets = found.into_iter().map(|(_, facet)| facet).collect();
        Ok(Self { cell: grid.cell, grid, numbers, facets, firsts })
    }

    /// The number of the voxel that a point lies in.
    pub fn at(&self, p: Vec3) -> Option<u32> {
        self.numbers.get(&self.grid.place(p)).copied()
    }

    /// The facets of a voxel.
    pub fn facets_of(&self, voxel: u32) -> std::ops::Range<u32> {
        let voxel = voxel as usize;
        self.firsts[voxel]..self.firsts[voxel + 1]
    }

    /// The voxel that a place near a facet's mean lies in, and its neighbours, also across edges
    /// and corners, that hold points.
    pub fn around(&self, facet: u32) -> impl Iterator<Item = u32> {
        let middle = self.grid.place(self.facets[facet as usize].plane.mean.as_vec3());
        let step = |i: i32| IVec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        (0..27).filter_map(move |i| self.numbers.get(&(middle + step(i))).copied())
    }
}
