//! I, by cell: which objects touch each cell, kept by the query that asks.
//!
//! The scene lists objects by brick and small movers by zone, and no move of theirs costs more
//! because some query looks at single cells. The first run on a scene lists all objects; later ones
//! follow what changed since: static objects by the journal of the scene, movers by the numbers of
//! their last moves.

use casca_slots::Slot;
use glam::IVec3;

use crate::grid::Grid;
use crate::grid::bricks::{Bricks, Pages};
use crate::grid::mask::{ALL, NONE};
use crate::grid::side::SideAxes;
use crate::id::ObjectId;
use crate::matrix::slots::SlotList;
use crate::object::Bounds;
use crate::query::cell::cell_ids::CellIds;
use crate::scene::Scene;
use crate::shape::pieces::touched;

/// What an object was listed by.
#[derive(Clone)]
struct ListedBy {
    id: ObjectId,
    /// The number of its last move then.
    moved: u64,
    bounds: Bounds,
}

/// The objects of a scene that touch each cell.
#[derive(Clone, Default)]
pub(crate) struct CellLists {
    /// The tag of the scene.
    scene: Option<u32>,
    /// How many changes of static objects the lists know.
    fixed: u64,
    /// By slot.
    listed: Vec<Option<ListedBy>>,
    /// The movers that the scene had.
    movers: Vec<Slot>,
    /// The objects that touch every cell of a brick. They are in no list of a cell.
    whole: Bricks<SlotList>,
    cells: CellIds,
}

impl CellLists {
    /// Brings the lists up to date with a scene. Costs the cells of all objects the first time;
    /// then a comparison for each mover, and the cells of what changed.
    pub(crate) fn follow(&mut self, scene: &Scene) {
        let changes = scene.static_changes();
        let known = if self.scene == Some(scene.tag()) { changes.since(self.fixed) } else { None };
        let before = std::mem::take(&mut self.movers);
        match known {
            Some(fixed) => {
                self.listed.resize_with(scene.slot_count().max(self.listed.len()), || None);
                fixed.for_each(|change| self.refresh(scene, change.slot()));
                before.iter().for_each(|&slot| self.refresh(scene, slot));
                scene.listed_movers().iter().for_each(|&slot| self.refresh(scene, slot));
            }
            None => {
                (self.whole, self.cells) = Default::default();
                self.listed.clear();
                self.listed.resize_with(scene.slot_count(), || None);
                scene.living().for_each(|(slot, _)| self.refresh(scene, slot));
            }
        }
        (self.scene, self.fixed, self.movers) = (Some(scene.tag()), changes.end(), before);
        self.movers.clear();
        self.movers.extend_from_slice(scene.listed_movers());
    }

    /// Lists an object as it is now, or no more.
    fn refresh(&mut self, scene: &Scene, slot: Slot) {
        let now = scene.living_at(slot).filter(|object| object.in_cells());
        let Some(listed) = self.listed.get_mut(slot.index()) else { return };
        let as_before = |listed: &ListedBy| {
            now.is_some_and(|object| object.last_move() == listed.moved) && scene.id(slot) == listed.id
        };
        if listed.as_ref().map_or(now.is_none(), as_before) {
            return;
        }
        let new =
            now.map(|o| ListedBy { id: scene.id(slot), moved: o.last_move(), bounds: o.bounds().clone() });
        if let Some(old) = std::mem::replace(listed, new) {
            self.change(scene.grid(), &old.bounds, slot, false);
        }
        if let Some(object) = now {
            self.change(scene.grid(), object.bounds(), slot, true);
        }
    }

    /// An object enters the cells of its bounds, or leaves them.
    fn change(&mut self, grid: &Grid, bounds: &Bounds, slot: Slot, enters: bool) {
        touched(bounds.kind(), grid, &mut |piece| {
            piece.bricks(|at, mask| match (enters, *mask == ALL) {
                (true, true) => self.whole.get_mut(at).push(slot),
                (false, true) => {
                    let whole = self.whole.get_mut(at);
                    whole.find(slot).into_iter().for_each(|i| whole.remove(i));
                    if whole.as_slice().is_empty() {
                        self.whole.release(at);
                    }
                }
                (true, false) => self.cells.change(at, &NONE, mask, slot),
                (false, false) => self.cells.change(at, mask, &NONE, slot),
            })
        });
    }

    /// The objects that touch a cell.
    #[inline]
    pub(super) fn of(&self, cell: IVec3) -> impl Iterator<Item = Slot> {
        self.whole.get(cell >> 3i32).as_slice().iter().chain(self.cells.of(cell)).copied()
    }

    /// Calls `found` with each cell of a tile whose bit is set, as its bit, the objects that touch
    /// all of its brick, and its others.
    #[inline]
    pub(super) fn for_tile(
        &self,
        brick: IVec3,
        axes: &SideAxes,
        at: i32,
        tile: u64,
        mut found: impl FnMut(i32, &[Slot], &[Slot]),
    ) {
        let whole = self.whole.get(brick).as_slice();
        self.cells.for_tile(brick, axes, at, tile, |bit, own| found(bit, whole, own));
    }

    /// Which cells of a tile have objects.
    #[inline]
    pub(super) fn tile(&self, brick: IVec3, axes: &SideAxes, at: i32) -> u64 {
        let whole = self.whole.get(brick).as_slice();
        if whole.is_empty() { self.cells.tile(brick, axes, at) } else { u64::MAX }
    }

    /// The pages with objects, of both lists.
    pub(super) fn pages(&self) -> [&Pages; 2] {
        [self.cells.pages(), self.whole.pages()]
    }
}

impl std::fmt::Debug for CellLists {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "CellLists({} objects)", self.listed.iter().flatten().count())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use glam::{DVec3, Vec3};

    use super::*;
    use crate::geometry::{Aabb, Sphere};
    use crate::method::Method;
    use crate::object::ObjectDesc;
    use crate::query::Query;
    use crate::random::Random;
    use crate::shape::Which;
    use crate::view::View;

    /// The objects of all cells that have some, told cell by cell and tile by tile.
    fn all(lists: &CellLists, _grid: &Grid) -> BTreeMap<[i32; 3], Vec<Slot>> {
        let mut all = BTreeMap::new();
        let dims = IVec3::splat(40);
        for i in 0..dims.x * dims.y * dims.z {
            let cell = IVec3::new(i % dims.x, i / dims.x % dims.y, i / dims.x / dims.y) - 8;
            let mut slots: Vec<Slot> = lists.of(cell).collect();
            slots.sort_unstable();
            for axes in &SideAxes::ALL {
                let bit = (cell[axes.row] & 7) << 3 | cell[axes.col] & 7;
                let tile = lists.tile(cell >> 3i32, axes, cell[axes.normal]);
                assert_eq!(tile >> bit & 1 != 0, !slots.is_empty(), "{cell}");
                lists.for_tile(cell >> 3i32, axes, cell[axes.normal], tile & 1 << bit, |at, whole, own| {
                    let mut tiled = [whole, own].concat();
                    tiled.sort_unstable();
                    assert_eq!((at, &tiled), (bit, &slots), "{cell}");
                });
            }
            if !slots.is_empty() {
                all.insert(cell.to_array(), slots);
            }
        }
        all
    }

    /// What [`all`] is to tell, from the shapes.
    fn expected(scene: &Scene) -> BTreeMap<[i32; 3], Vec<Slot>> {
        let mut all = BTreeMap::<_, Vec<Slot>>::new();
        for (slot, object) in scene.living().filter(|(_, object)| object.in_cells()) {
            object.bounds().kind().rows(scene.grid(), Which::Touched, &mut |run| {
                run.cells().for_each(|cell| all.entry(cell.to_array()).or_default().push(slot));
            });
        }
        all
    }

    #[test]
    fn lists_follow_a_scene() {
        let mut scene = Scene::new(1.0).unwrap();
        let mut random = Random::new(1);
        let mut place = move |most: f64| random.point(most).as_vec3();
        let mut numbers = Random::new(2);
        let wall = Aabb::new(Vec3::new(11.0, 0.0, 0.0), Vec3::new(12.0, 24.0, 24.0));
        scene.insert(ObjectDesc::fixed(wall).occluder(wall)).unwrap();
        let mut shape = |large: bool| -> Bounds {
            let center = Vec3::splat(12.0) + place(11.0);
            if large { Aabb::new(center - 6.0, center + 6.0).into() } else { Sphere::new(center, 0.7).into() }
        };
        let (mut ids, mut lists) = (Vec::new(), CellLists::default());
        let mut query = Query::with_method(Method::cell()).unwrap();
        for step in 0..400 {
            for _ in 0..numbers.below(6) {
                let large = numbers.below(5) == 0;
                match numbers.below(8) {
                    0 => ids.push(scene.insert(ObjectDesc::fixed(shape(large))).unwrap()),
                    1 | 2 => ids.push(scene.insert(ObjectDesc::dynamic(shape(large))).unwrap()),
                    3 if !ids.is_empty() => {
                        let id = ids.swap_remove(numbers.below(ids.len() as u32) as usize);
                        scene.remove(id).unwrap();
                    }
                    _ if !ids.is_empty() => {
                        let id = ids[numbers.below(ids.len() as u32) as usize];
                        scene.update(id, shape(large), None).unwrap();
                    }
                    _ => {}
                }
            }
            if step % 97 == 96 {
                scene.set_origin(DVec3::new(2.0, 0.0, -2.0)).unwrap();
                scene.set_origin(DVec3::ZERO).unwrap();
            }
            // Movers behind the wall go into volumes, and come out of them.
            scene.begin_frame(f64::from(step)).unwrap();
            query.run(&scene, &View::omnidirectional(Vec3::new(4.5, 12.5, 12.5)).unwrap());
            scene.end_frame([query.pvs()]).unwrap();
            if numbers.below(3) == 0 {
                lists.follow(&scene);
                assert_eq!(all(&lists, scene.grid()), expected(&scene), "step {step}");
            }
            if step == 200 {
                // Another scene, whose ids and numbers of moves are alike.
                let mut other = scene.clone();
                ids.iter().for_each(|&id| other.update(id, shape(false), None).unwrap());
                lists.follow(&other);
                assert_eq!(all(&lists, other.grid()), expected(&other));
            }
        }
        assert!(ids.len() > 20, "{}", ids.len());
    }

    #[test]
    fn objects_that_fill_bricks_cost_them_not_their_cells() {
        let mut scene = Scene::new(1.0).unwrap();
        scene.insert(ObjectDesc::fixed(Aabb::new(Vec3::splat(0.5), Vec3::splat(127.5)))).unwrap();
        let mut lists = CellLists::default();
        lists.follow(&scene);
        assert_eq!((lists.of(IVec3::splat(77)).count(), lists.cells.entries()), (1, 0));
    }
}
