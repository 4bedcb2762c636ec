//! Scenes for the measurements.

use std::time::Instant;

use casca_plane::maps::MapKind;
use casca_plane::{BitGrid, Disc, Error, GridSpec, Method, ObjectDesc, Pvs, Query, Scene, TileLayer, View};
use glam::{UVec2, Vec2};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Tiles along each side of a map.
pub const SIDE: u32 = 128;

pub type Failure = Box<dyn std::error::Error>;

/// A map with small objects in its open tiles.
pub struct Level {
    pub scene: Scene,
    pub map: BitGrid,
    pub random: Pcg64Mcg,
}

impl Level {
    /// A map whose tiles are the cells of the grid, and so many resting objects.
    pub fn new(kind: MapKind, objects: u32) -> Result<Self, Failure> {
        Self::from_map(kind.generate(SIDE, SIDE, 7), objects)
    }

    /// As [`Level::new`], from a map of any size.
    pub fn from_map(map: BitGrid, objects: u32) -> Result<Self, Failure> {
        let dims = UVec2::new(map.width(), map.height());
        let mut scene = Scene::new(&GridSpec { min: Vec2::ZERO, cell: 1.0, dims })?;
        scene.insert_tiles(&TileLayer::new(Vec2::ZERO, 1.0, map.clone())?)?;
        let mut level = Self { scene, map, random: Pcg64Mcg::seed_from_u64(1) };
        for _ in 0..objects {
            let disc = Disc::new(level.place(), 0.3);
            level.scene.insert(ObjectDesc::fixed(disc).user_data(1))?;
        }
        Ok(level)
    }

    /// A place in an open tile, a third of a tile from its sides.
    pub fn place(&mut self) -> Vec2 {
        loop {
            let x = self.random.random_range(0..self.map.width());
            let y = self.random.random_range(0..self.map.height());
            if !self.map.get(x, y) {
                let inner =
                    Vec2::new(self.random.random_range(0.34..0.66), self.random.random_range(0.34..0.66));
                return Vec2::new(x as f32, y as f32) + inner;
            }
        }
    }
}

/// The objects of a set, without the walls.
pub fn count(scene: &Scene, pvs: &Pvs) -> f64 {
    pvs.iter().filter(|&id| scene.user_data(id) == Ok(1)).count() as f64
}

/// The objects that some of 49 eyes in the cell of an eye see exactly: nearly all that can be seen
/// from the cell.
pub fn seen_from_cell(scene: &Scene, eye: Vec2) -> Result<f64, Error> {
    let (lo, hi) = scene.grid().cell_bounds(scene.grid().cell_of(eye.as_dvec2()));
    let (lo, hi) = (lo.as_vec2(), hi.as_vec2());
    let mut query = Query::with_method(Method::Point)?;
    let mut seen = std::collections::BTreeSet::new();
    for i in 0..49 {
        let share = Vec2::new((i % 7) as f32, (i / 7) as f32) / 6.0;
        let pvs = query.run(scene, &View::all_round(lo + (hi - lo) * share)?);
        if !pvs.stats().eye_in_occluder {
            seen.extend(pvs.iter().filter(|&id| scene.user_data(id) == Ok(1)));
        }
    }
    Ok(seen.len() as f64)
}

/// The mean time of a run in microseconds, after one to warm up.
pub fn micros(mut run: impl FnMut()) -> f64 {
    run();
    let start = Instant::now();
    (0..10).for_each(|_| run());
    start.elapsed().as_secs_f64() * 1e5
}
