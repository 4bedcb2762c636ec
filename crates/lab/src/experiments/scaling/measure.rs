//! The cost of one size of a world.

use casca::{Aabb, GridSpec, Method, Query};

use super::super::{ASPECT, Contender, FrameInput, LabError, median, p99};
use casca_scenes::drive::{Driver, view_of};
use casca_scenes::measure::timed_by_wall;
use casca_scenes::world::{Camera, World};

/// Pixels of the buffer: those that engines use.
const BUFFER: (usize, usize) = (320, 180);

/// How much is measured.
#[derive(Debug, Clone, Copy)]
pub(super) struct Walks {
    /// Views of the walk, evenly spread.
    pub(super) views: usize,
    /// Runs from each view; the least counts.
    pub(super) repeats: usize,
}

/// Milliseconds over all views.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Times {
    pub(super) median: f64,
    pub(super) p99: f64,
}

impl Times {
    pub(super) fn of(values: &mut [f64]) -> Self {
        Self { median: median(values), p99: p99(values) }
    }
}

/// What one size costs.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Row {
    /// The quantity that grows.
    pub(super) size: f64,
    pub(super) objects: usize,
    /// Seconds to make the scene, meshes included.
    pub(super) setup: f64,
    /// Bytes of the scene, and those of its parts: the grid, objects and shapes.
    pub(super) memory: f64,
    pub(super) parts: [usize; 3],
    /// Objects in the frustum and in the set of `point`: means.
    pub(super) in_frustum: f64,
    pub(super) found: f64,
    pub(super) point: Times,
    pub(super) hzb: Times,
}

/// The cameras of a walk, evenly spread.
pub(super) fn cameras(world: &World, count: usize) -> Vec<Camera> {
    let count = count.clamp(1, world.frames.max(1));
    (0..count).map(|i| world.camera(i * world.frames / count, ASPECT)).collect()
}

/// Makes the scene of a world, in the grid that fits.
pub(super) fn set_up(world: &World) -> Result<(Driver, f64), LabError> {
    let grid = GridSpec::fit(Aabb::new(world.grid.min, world.grid.max), world.objects.len())?;
    // Several threads prepare meshes.
    let (driver, time) = timed_by_wall(|| Driver::new(world, &grid, |_| ()));
    Ok((driver?, time.as_secs_f64()))
}

/// A contender on a scene, and its results from all cameras.
pub(super) struct Turn<'a> {
    contender: Contender,
    driver: &'a Driver,
    ms: Vec<f64>,
    found: usize,
}

impl<'a> Turn<'a> {
    pub(super) fn new(contender: Contender, driver: &'a Driver) -> Self {
        Self { contender, driver, ms: Vec::new(), found: 0 }
    }

    /// The times, and the mean number of objects found.
    pub(super) fn results(mut self) -> (Times, f64) {
        (Times::of(&mut self.ms), self.found as f64 / self.ms.len().max(1) as f64)
    }
}

/// Runs contenders on the same world in turns: from each camera this many times, of which the least
/// counts.
pub(super) fn take_turns(
    turns: &mut [Turn],
    world: &World,
    cameras: &[(Camera, Vec<usize>)],
    repeats: usize,
) -> Result<(), LabError> {
    for (i, (camera, in_frustum)) in cameras.iter().enumerate() {
        let mut least = vec![f64::INFINITY; turns.len()];
        // The first run of all takes memory, and does not count.
        for round in 0..repeats.max(1) + usize::from(i == 0) {
            for (turn, least) in turns.iter_mut().zip(&mut least) {
                let input = FrameInput { driver: turn.driver, objects: &world.objects, in_frustum, camera };
                let time = turn.contender.run(&input)?.as_secs_f64() * 1e3;
                let counts = i > 0 || round > 0;
                *least = if counts { least.min(time) } else { *least };
            }
        }
        for (turn, least) in turns.iter_mut().zip(least) {
            turn.ms.push(least);
            turn.found += turn.contender.found().len();
        }
    }
    Ok(())
}

/// The cameras of a walk with the objects in their frustums.
pub(super) fn frustums(
    driver: &Driver,
    world: &World,
    count: usize,
) -> Result<Vec<(Camera, Vec<usize>)>, LabError> {
    let mut query = Query::with_method(Method::Frustum)?;
    let mut all = Vec::new();
    for camera in cameras(world, count) {
        let pvs = query.run(&driver.scene, &view_of(&camera)?);
        all.push((camera, (0..world.objects.len()).filter(|&i| driver.sees(pvs, i)).collect()));
    }
    Ok(all)
}

/// Measures a world whose quantity of interest is `size`.
pub(super) fn measure(world: &World, size: f64, method: Method, walks: Walks) -> Result<Row, LabError> {
    let (driver, setup) = set_up(world)?;
    let cameras = frustums(&driver, world, walks.views)?;
    let contenders = [Contender::hzb(BUFFER.0, BUFFER.1), Contender::casca("", method)?];
    let mut turns = contenders.map(|c| Turn::new(c, &driver));
    take_turns(&mut turns, world, &cameras, walks.repeats)?;
    let [(hzb, _), (point, found)] = turns.map(Turn::results);
    let memory = driver.scene.memory();
    let in_frustum: usize = cameras.iter().map(|(_, inside)| inside.len()).sum();
    Ok(Row {
        size,
        objects: world.objects.len(),
        setup,
        memory: memory.total() as f64,
        parts: [memory.grid(), memory.objects, memory.shapes],
        in_frustum: in_frustum as f64 / cameras.len().max(1) as f64,
        found,
        point,
        hzb,
    })
}
