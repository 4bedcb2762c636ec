//! Cells that suit the entities of a world.

use bevy_math::Vec3A;
use casca::glam::Vec3;
use casca::{Aabb, Scene, cell_for};

use crate::border;
use crate::scene::CascaScene;

/// This share of the entities, at each side, has no say in the size of cells: a sky, or something
/// lost far away.
const STRAY: f64 = 0.01;

/// Fewer entities than this all count.
const FEW: usize = 64;

/// Entities take this much room at least, in world units: they may all be in one point.
const LEAST: f32 = 1e-3;

/// A grid is kept for so many frames at least.
const GRID_FRAMES: u32 = 64;

/// Of the entities in the scene, so many tell whether the grid still suits them.
const GRID_SAMPLE: usize = 4096;

/// A grid stays unless its cells are this many times larger or smaller than new ones would be. Those
/// are larger far away from the origin, too.
const MISFIT: f64 = 4.0;

/// Makes a scene if there is none, or if its cells suit no more: then says that it is empty.
pub(crate) fn choose(casca: &mut CascaScene, new: impl Iterator<Item = (Vec3A, Vec3A)>) -> bool {
    let make = |boxes: &[_]| around(boxes).and_then(|cell| Scene::new(cell).ok());
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
    let next = make(&boxes).filter(|next| !suits(scene, next, step));
    let Some(next) = next else { return false };
    casca.scene = Some(next);
    casca.movers.clear();
    casca.cameras.clear();
    casca.suns.clear();
    casca.lamps.clear();
    true
}

/// The edge length of cells for boxes in world space. `None` without boxes, or if none suits them.
fn around(boxes: &[(Vec3A, Vec3A)]) -> Option<f32> {
    let boxes: Vec<_> = boxes.iter().filter(|(min, max)| (*max - *min).is_finite()).collect();
    let stray = if boxes.len() < FEW { 0 } else { (boxes.len() as f64 * STRAY) as usize };
    let (mut min, mut max) = ([0.0; 3], [0.0; 3]);
    let mut sides: Vec<f32> = Vec::with_capacity(boxes.len());
    for axis in 0..3 {
        // Of two boxes at the sides, the middles decide: one that is as large as the world would
        // else make it larger.
        min[axis] = nth(&mut sides, boxes.iter().map(|b| b.0[axis]), stray)?;
        max[axis] = nth(&mut sides, boxes.iter().map(|b| -b.1[axis]), stray).map(|m| -m)?;
    }
    // Where many are far larger than others, sides may cross.
    let (min, max) = (Vec3::from(min).min(max.into()), Vec3::from(min).max(max.into()));
    cell_for(Aabb::new(min - LEAST, max + LEAST), boxes.len()).ok()
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

/// Whether a scene can stay where another one would be made, for one entity in `step`.
fn suits(scene: &Scene, next: &Scene, step: usize) -> bool {
    let ratio = next.grid().cell_size() / (step as f64).cbrt() / scene.grid().cell_size();
    (1.0 / MISFIT..=MISFIT).contains(&ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(x: f32) -> (Vec3A, Vec3A) {
        (Vec3A::new(x, 0.0, 0.0), Vec3A::new(x + 1.0, 1.0, 1.0))
    }

    #[test]
    fn cells_follow_what_there_is_but_for_strays() {
        assert_eq!(around(&[]), None);
        let few = around(&[cube(0.0), cube(1000.0)]).unwrap();
        assert!(few * 32.0 >= 1000.0);
        let mut many: Vec<_> = (0..1000).map(|i| cube(i as f32 * 0.1)).collect();
        many.push((Vec3A::splat(-1e6), Vec3A::splat(1e6)));
        many.push(cube(1e7));
        let cell = around(&many).unwrap();
        assert!((90.0..200.0).contains(&(cell * 90.0)), "{cell}");
        let scene = |boxes: &[_]| Scene::new(around(boxes).unwrap()).unwrap();
        let street =
            |from: f32, by: f32| -> Vec<_> { (0..1000).map(|i| cube(from + i as f32 * by)).collect() };
        let own = scene(&many);
        assert!(suits(&own, &scene(&street(5e5, 0.1)), 1), "the same at another place");
        assert!(!suits(&own, &scene(&street(1e7, 0.1)), 1), "too far away");
        assert!(!suits(&own, &scene(&street(0.0, 1.0)), 1) && suits(&own, &scene(&street(0.0, 1.0)), 1000));
    }
}
