//! A grid that suits the entities of a world.

use bevy_math::Vec3A;
use casca::glam::Vec3;
use casca::{Aabb, GridSpec, Scene};

use crate::border;
use crate::scene::CascaScene;

/// This share of the entities may lie beyond each side of the grid: a sky, or something lost far
/// away. They are tested in every query.
const STRAY: f64 = 0.01;

/// Fewer entities than this all count.
const FEW: usize = 64;

/// Around the entities the grid has room for this share of its size.
const ROOM: f32 = 0.1;

/// A grid has this size at least, in world units: entities may all be in one point.
const LEAST: f32 = 1e-3;

/// The least side of a grid, as a share of the greatest: entities may all lie in a plane.
const FLATTEST: f32 = 0.01;

/// A grid is kept for so many frames at least.
const GRID_FRAMES: u32 = 64;

/// Of the entities in the scene, so many tell whether the grid still suits them.
const GRID_SAMPLE: usize = 4096;

/// Makes a grid if there is none, or if the world has outgrown it: then says that the scene is
/// empty.
pub(crate) fn choose(casca: &mut CascaScene, new: impl Iterator<Item = (Vec3A, Vec3A)>) -> bool {
    let make = |boxes: &[_]| around(boxes).and_then(|spec| Scene::new(&spec).ok());
    let Some(scene) = &casca.scene else {
        let boxes: Vec<_> = new.collect();
        if !boxes.is_empty() {
            casca.scene = make(&boxes);
            casca.grid_made = casca.frame;
        }
        return false;
    };
    if casca.frame.wrapping_sub(casca.grid_made) < GRID_FRAMES {
        return false;
    }
    casca.grid_made = casca.frame;
    let step = (scene.len() / GRID_SAMPLE).max(1);
    let known = scene.iter().step_by(step).map(|(_, object)| border::back(&object.bounds().aabb()));
    let boxes: Vec<_> = known.chain(new).collect();
    let outside = boxes.iter().filter(|b| is_outside(scene.grid(), **b)).count();
    // The estimate of cells is for a sample of them.
    let Some(scene) = make(&boxes).filter(|_| outside * 4 > boxes.len()) else { return false };
    casca.scene = Some(scene);
    casca.movers.clear();
    casca.cameras.clear();
    casca.suns.clear();
    casca.lamps.clear();
    true
}

/// A grid around boxes in world space. `None` without boxes, or if none suits them.
fn around(boxes: &[(Vec3A, Vec3A)]) -> Option<GridSpec> {
    let stray = if boxes.len() < FEW { 0 } else { (boxes.len() as f64 * STRAY) as usize };
    let (mut min, mut max) = ([0.0; 3], [0.0; 3]);
    let mut sides: Vec<f32> = Vec::with_capacity(boxes.len());
    for axis in 0..3 {
        // Of two boxes at the sides, the middles decide: one that is as large as the world would
        // else make it larger.
        min[axis] = nth(&mut sides, boxes.iter().map(|b| b.0[axis]), stray)?;
        max[axis] = nth(&mut sides, boxes.iter().map(|b| -b.1[axis]), stray).map(|m| -m)?;
    }
    let (min, max) = (Vec3::from(min), Vec3::from(max));
    // Where many are far larger than others, sides may cross.
    let (min, max) = (min.min(max), min.max(max));
    let size = (max - min).max_element().max(LEAST);
    let room = (max - min).max(Vec3::splat(size * FLATTEST)) * ROOM;
    GridSpec::fit(Aabb::new(min - room, max + room), boxes.len()).ok()
}

/// The number that so many others are less than.
fn nth(memory: &mut Vec<f32>, numbers: impl Iterator<Item = f32>, n: usize) -> Option<f32> {
    memory.clear();
    memory.extend(numbers);
    if n >= memory.len() {
        return None;
    }
    let (_, found, _) = memory.select_nth_unstable_by(n, f32::total_cmp);
    Some(*found).filter(|x| x.is_finite())
}

/// Whether a box lies outside of a grid.
fn is_outside(grid: &casca::Grid, (min, max): (Vec3A, Vec3A)) -> bool {
    let (low, high) = (grid.min(), grid.max());
    (0..3).any(|axis| f64::from(min[axis]) > high[axis] || f64::from(max[axis]) < low[axis])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(x: f32) -> (Vec3A, Vec3A) {
        (Vec3A::new(x, 0.0, 0.0), Vec3A::new(x + 1.0, 1.0, 1.0))
    }

    #[test]
    fn a_grid_covers_what_there_is_but_for_strays() {
        assert_eq!(around(&[]), None);
        let few = around(&[cube(0.0), cube(1000.0)]).unwrap();
        assert!(few.cell * few.dims.x as f32 >= 1001.0);
        let mut many: Vec<_> = (0..1000).map(|i| cube(i as f32 * 0.1)).collect();
        many.push((Vec3A::splat(-1e6), Vec3A::splat(1e6)));
        many.push(cube(1e7));
        let grid = around(&many).unwrap();
        assert!((90.0..200.0).contains(&(grid.cell * grid.dims.x as f32)), "{grid:?}");
        let grid = casca::Grid::new(&grid).unwrap();
        assert!(is_outside(&grid, cube(1e7)) && !is_outside(&grid, cube(50.0)));
    }

    #[test]
    fn no_input_makes_a_grid_that_casca_refuses() {
        for x in [0.0, 1e-30, 1e20, f32::MAX, f32::NAN, f32::INFINITY] {
            for n in [1, 100] {
                if let Some(spec) = around(&vec![(Vec3A::splat(-x), Vec3A::splat(x)); n]) {
                    casca::Scene::new(&spec).unwrap();
                }
            }
        }
    }
}
