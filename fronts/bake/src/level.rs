//! A level made ready for baking.

use std::collections::BTreeSet;

use casca::glam::{DVec3, Vec3};
use casca::{Aabb, Error, ObjectDesc, ObjectId, Scene};
use casca_baked::Cells;
use casca_scenes::drive::Driver;
use casca_scenes::world::{GridHint, Motion, Object, Shape, World};

use casca_walls::Walls;

use crate::solids::solids_of;

/// The static objects of a level, and the occluders among them.
///
/// The number of an object is its place in [`World::objects`]: for a glTF file in the order of its
/// nodes, each before those that hang from it, without those that are hidden or left out.
/// [`Source::parts`](casca_scenes::world::Source::parts) names the node of each. Objects that move
/// are left to run time: they are in no set, and hide nothing.
pub struct Level {
    pub(crate) scene: Scene,
    /// The box around each object; `None` if it moves, or its visibility is not asked for.
    pub(crate) bounds: Vec<Option<Aabb>>,
    /// The grid, if those are its cells.
    pub(crate) cells: Option<Cells>,
    /// Boxes that hold no eye, in the order of their least x, and the greatest extent along x.
    pub(crate) solids: Vec<Aabb>,
    pub(crate) longest: f32,
    /// Rectangles that hide without a query.
    pub(crate) walls: Walls,
    room: Aabb,
    /// What is added to the coordinates of all of these for those of the file.
    pub(crate) origin: DVec3,
    objects: Vec<Object>,
}

/// Narrower walls hide too little, in metres, even from parts of a cell.
const LEAST_WALL: f32 = 0.1;

/// Objects that are not asked for have this number in the scene.
const NOBODY: u64 = u64::MAX;

impl Level {
    /// Takes the static objects of a scene as they are now. `cell` is the edge of a cell of the
    /// grid, in metres; `None` takes the scene's own. `solid` promises that closed boxes among the
    /// parts of meshes hold no eye, as those of [`Shape::Box`] do not: then cells that reach into
    /// walls get smaller sets. A room that is modelled as one box breaks that promise.
    ///
    /// # Errors
    /// Refuses what casca refuses: a grid that is too large, or shapes that are not finite.
    pub fn new(world: &World, cell: Option<f32>, solid: bool) -> Result<Self, Error> {
        let origin = world.source.origin;
        Ok(Self { origin, ..Self::of(&world.objects, world.grid, cell, solid)? })
    }

    /// The same for objects, and the grid that they lie in.
    ///
    /// # Errors
    /// As [`Level::new`].
    pub fn of(all: &[Object], grid: GridHint, cell: Option<f32>, solid: bool) -> Result<Self, Error> {
        let is_static = |object: &Object| object.motion == Motion::Static;
        let numbers: Vec<usize> = (0..all.len()).filter(|&i| is_static(&all[i])).collect();
        let objects: Vec<Object> = numbers.iter().map(|&i| all[i].clone()).collect();
        let cell = cell.unwrap_or(grid.cell);
        let driver = Driver::with(&objects, cell, None, |_, desc| desc, |_| ())?;
        let mut bounds = vec![None; all.len()];
        for (&number, object) in numbers.iter().zip(&objects) {
            bounds[number] = object.tested.then(|| bounds_of(&object.shape));
        }
        let ids: Vec<_> = (0..objects.len()).map(|i| driver.id(i)).collect();
        let mut scene = driver.scene;
        for (id, (&number, object)) in ids.into_iter().zip(numbers.iter().zip(&objects)) {
            scene.set_user_data(id, if object.tested { number as u64 } else { NOBODY })?;
        }
        let walls = Walls::of(&scene, LEAST_WALL);
        let mut solids = solids_of(&objects, solid);
        solids.sort_by(|a, b| a.min.x.total_cmp(&b.min.x));
        let longest = solids.iter().map(|b| b.max.x - b.min.x).fold(0.0, f32::max);
        let room = Aabb::new(grid.min, grid.max);
        let origin = DVec3::ZERO;
        Ok(Self { scene, bounds, cells: None, solids, longest, walls, room, origin, objects })
    }

    /// The same level, of which sets tell what may be seen of some cells of a grid, and not of its
    /// objects: for all that moves there. Numbers of no cell are left out. Others than these cells
    /// cannot be baked then: see [`BakeError::OtherCells`](crate::BakeError::OtherCells).
    ///
    /// # Errors
    /// Refuses what casca refuses: more cells than its ids can name.
    pub fn cell_to_cell(mut self, cells: &Cells, numbers: &[u32]) -> Result<Self, Error> {
        let objects: Vec<ObjectId> = self.scene.ids().collect();
        for id in objects {
            self.scene.set_user_data(id, NOBODY)?;
        }
        self.bounds = vec![None; cells.count().unwrap_or(0) as usize];
        for &cell in numbers {
            let Some(room) = eyes_of(cells, cell) else { continue };
            let is_first = self.bounds[cell as usize].replace(room).is_none();
            if is_first {
                self.scene.insert(ObjectDesc::fixed(room).user_data(cell.into()))?;
            }
        }
        self.cells = Some(*cells);
        Ok(self)
    }

    /// The numbers of those cells.
    pub(crate) fn targets(&self) -> BTreeSet<u32> {
        (0..self.len()).filter(|&cell| self.bounds[cell as usize].is_some()).collect()
    }

    /// The number of objects, those that move included; or of cells of the grid, see
    /// [`Level::cell_to_cell`].
    pub fn len(&self) -> u32 {
        self.bounds.len() as u32
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.bounds.is_empty()
    }

    /// A grid of cells of this level in the coordinates of its file, which are those of files of
    /// sets: they differ where the level lies far from the origin of its file.
    pub fn in_file(&self, mut cells: Cells) -> Cells {
        cells.low = (DVec3::from_array(cells.low) + self.origin).to_array();
        cells.origin = self.origin.to_array();
        cells
    }

    /// The box that the level lies in, in metres; y is up. Seen from an origin of its own if it
    /// lies far from that of its file; see [`Level::in_file`].
    pub fn room(&self) -> Aabb {
        self.room
    }

    /// The static objects.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// The number of an object of the scene, unless its visibility is not asked for.
    pub(crate) fn number(&self, id: ObjectId) -> Option<usize> {
        self.scene.user_data(id).ok().filter(|&number| number != NOBODY).map(|number| number as usize)
    }

    /// The solid boxes that have points in common with a box.
    pub(crate) fn solids_in(&self, b: &Aabb) -> impl Iterator<Item = &Aabb> {
        let first = self.solids.partition_point(|s| s.min.x < b.min.x - self.longest);
        let (min, max) = (b.min, b.max);
        let near = self.solids[first..].iter().take_while(move |s| s.min.x <= max.x);
        near.filter(move |s| s.min.cmple(max).all() && min.cmple(s.max).all())
    }
}

/// The box around a shape.
pub fn bounds_of(shape: &Shape) -> Aabb {
    match shape {
        Shape::Sphere { center, radius } => Aabb::new(center - *radius, center + *radius),
        Shape::Box { min, max } => Aabb::new(*min, *max),
        Shape::Mesh { mesh, transform } => {
            let (min, max) = mesh.bounds(transform);
            Aabb::new(min, max)
        }
    }
}

/// The box of eyes of a cell, rounded outwards to single precision; `None` if there is no such
/// cell.
pub fn eyes_of(cells: &Cells, cell: u32) -> Option<Aabb> {
    let (low, high) = cells.room(cell)?;
    let down = |v: f64| if f64::from(v as f32) > v { (v as f32).next_down() } else { v as f32 };
    let up = |v: f64| if f64::from(v as f32) < v { (v as f32).next_up() } else { v as f32 };
    Some(Aabb::new(Vec3::from_array(low.map(down)), Vec3::from_array(high.map(up))))
}
