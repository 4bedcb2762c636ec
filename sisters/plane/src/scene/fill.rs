//! The cells that occluders make opaque: each alone, and several together.

use casca_slots::Slot;
use glam::IVec2;

use crate::cover::covers;
use crate::geometry::Shape;
use crate::geometry::block::Block;
use crate::raster::touched;
use crate::scene::Scene;
use crate::solid::filled;

/// Objects of a cell that are looked at for solids, at most.
const MOST_LOOKS: usize = 64;

impl Scene {
    /// Makes the cells inside the occluder of an object opaque, and those that it covers with
    /// others.
    pub(super) fn fill(&mut self, slot: Slot) {
        let Some(object) = self.slots.get_mut(slot) else { return };
        // Opaque cells hide in all views.
        let Some(occluder) = object.occluder.as_ref().filter(|_| object.layers == u64::MAX) else { return };
        let opacity = if object.mover.is_some() { &mut self.moving } else { &mut self.fixed };
        object.fills = true;
        filled(occluder, &self.grid, &mut |y, xs| xs.for_each(|x| opacity.add(x as u32, y as u32)));
        self.join(slot);
    }

    /// Undoes [`Scene::fill`], if it was done.
    pub(super) fn unfill(&mut self, slot: Slot) {
        let Some(object) = self.slots.get_mut(slot).filter(|object| object.fills) else { return };
        object.fills = false;
        let Some(occluder) = &object.occluder else { return };
        let opacity = if object.mover.is_some() { &mut self.moving } else { &mut self.fixed };
        filled(occluder, &self.grid, &mut |y, xs| xs.for_each(|x| opacity.remove(x as u32, y as u32)));
        self.join(slot);
    }

    /// Decides the cells anew that the occluder of an object touches: whether several cover them
    /// together.
    fn join(&mut self, slot: Slot) {
        // Objects in no lists are not looked for.
        let Some(object) = self.slots.get(slot).filter(|object| object.outer == 0) else { return };
        let Some(occluder @ (Shape::Rect(_) | Shape::Polygon(_))) = &object.occluder else { return };
        let (came, opacity) = (object.fills, self.opacity());
        let (mut cells, mut apart) = (Vec::new(), Vec::new());
        let block = occluder.block();
        touched(occluder, &self.grid, &mut |y, xs| {
            for x in xs {
                // One at the border of a cell covers nothing of it.
                let (min, max) = self.grid.cell_bounds(IVec2::new(x, y));
                if !block.overlaps(&Block { min, max }) {
                    continue;
                }
                let [fixed, moving, joined] = opacity.map(|bits| bits.get(x as u32, y as u32));
                let alone = fixed || moving;
                // One that comes uncovers nothing. Where one goes, others may be together; what one
                // fills alone counts as not joined, since a disc that goes decides nothing anew.
                if alone && joined && !came {
                    apart.push(IVec2::new(x, y));
                } else if !(alone || came && joined) {
                    cells.push(IVec2::new(x, y));
                }
            }
        });
        for cell in apart {
            self.joined.set(cell.x as u32, cell.y as u32, false);
        }
        for cell in cells {
            let covered = self.is_covered(cell);
            self.joined.set(cell.x as u32, cell.y as u32, covered);
        }
    }

    /// Whether the solids in a cell cover it together.
    fn is_covered(&self, cell: IVec2) -> bool {
        let (lo, hi) = self.grid.cell_bounds(cell);
        let fills = |&slot: &Slot| {
            let object = self.slots.get(slot).filter(|object| object.fills)?;
            object.occluder.as_ref().filter(|occluder| matches!(occluder, Shape::Rect(_) | Shape::Polygon(_)))
        };
        let solids = self.lists.get(cell).iter().take(MOST_LOOKS).filter_map(fills);
        solids.clone().nth(1).is_some() && covers(lo, hi, solids)
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, UVec2, Vec2};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg32;

    use super::*;
    use crate::geometry::{Disc, Rect};
    use crate::grid::GridSpec;
    use crate::id::ObjectId;
    use crate::object::ObjectDesc;

    const SIDE: i32 = 6;

    fn opaque(scene: &Scene) -> Vec<bool> {
        let cells = (0..SIDE * SIDE).map(|i| ((i % SIDE) as u32, (i / SIDE) as u32));
        cells.map(|(x, y)| scene.opacity().iter().any(|bits| bits.get(x, y))).collect()
    }

    /// A disc fills a cell while one of two solids goes that cover it together. Then it goes.
    #[test]
    fn a_cell_that_a_disc_filled_meanwhile_is_not_opaque_without_its_solids() {
        let spec = GridSpec { min: Vec2::ZERO, cell: 3.0, dims: UVec2::splat(SIDE as u32) };
        let mut scene = Scene::new(&spec).unwrap();
        let half = |x: f32| Rect::new(Vec2::new(x, 5.5), Vec2::new(x + 2.0, 9.5));
        let disc = Disc::new(Vec2::splat(7.5), 3.0);
        let [left, _] =
            [5.5, 7.5].map(|x| scene.insert(ObjectDesc::dynamic(half(x)).occluder(half(x))).unwrap());
        assert!(opaque(&scene)[14], "together");
        let round = scene.insert(ObjectDesc::dynamic(disc).occluder(disc)).unwrap();
        scene.remove(left).unwrap();
        assert!(opaque(&scene)[14], "the disc alone");
        scene.remove(round).unwrap();
        assert!(!opaque(&scene)[14], "half of it is free");
    }

    /// Rectangles with corners on a lattice of thirds of cells come, move and go. Cells are opaque
    /// if all parts of the lattice in them are covered, and no others.
    #[test]
    fn cells_are_opaque_while_solids_cover_them_together() {
        let mut random = Pcg32::seed_from_u64(43);
        let spec = GridSpec { min: Vec2::ZERO, cell: 3.0, dims: UVec2::splat(SIDE as u32) };
        let (mut together, mut last) = (0, 0);
        for _ in 0..60 {
            let mut scene = Scene::new(&spec).unwrap();
            let mut all: Vec<(ObjectId, Rect)> = Vec::new();
            for _ in 0..60 {
                let mut corner =
                    || Vec2::new(random.random_range(1..17) as f32, random.random_range(1..17) as f32);
                let (a, b) = (corner(), corner());
                let rect = Rect::new(a.min(b), a.max(b).min(a.min(b) + 7.0) + 0.5);
                let choice = random.random_range(0..4);
                if all.len() > 9 || choice == 0 && !all.is_empty() {
                    let (id, _) = all.swap_remove(random.random_range(0..all.len()));
                    scene.remove(id).unwrap();
                } else if choice == 1 && !all.is_empty() {
                    let at = random.random_range(0..all.len());
                    scene.update(all[at].0, rect, Some(rect.into())).unwrap();
                    all[at].1 = rect;
                } else {
                    let desc = if choice == 2 { ObjectDesc::fixed(rect) } else { ObjectDesc::dynamic(rect) };
                    all.push((scene.insert(desc.occluder(rect)).unwrap(), rect));
                }
                let holds = |p: DVec2| all.iter().any(|(_, rect)| rect.block().contains(p));
                let truth = (0..SIDE * SIDE).map(|i| {
                    let cell = IVec2::new(i % SIDE, i / SIDE).as_dvec2() * 3.0;
                    (0..36).all(|k| holds(cell + DVec2::new(f64::from(k % 6), f64::from(k / 6)) / 2.0 + 0.25))
                });
                assert_eq!(opaque(&scene), truth.collect::<Vec<_>>(), "{all:?}");
                last = scene.opacity()[2].cells().count();
                together += last;
            }
        }
        assert!(together > 500 && last < 36, "{together}");
    }
}
