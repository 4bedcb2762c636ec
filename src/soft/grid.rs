//! The grid of soft visibility: shapes as cells in two layers, and the pyramid above them.
//!
//! A layer counts the shapes in each cell, so that a shape that goes leaves the cells of the others
//! as they were, and the order of insertions does not matter.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DAffine3, IVec3};

use crate::error::Error;
use crate::grid::bricks::BRICK;
use crate::grid::run::CellRun;
use crate::grid::{Grid, GridSpec};
use crate::heap::in_tree;
use crate::id::ObjectId;
use crate::matrix::bits::{ALL, BitMatrix, Mask, either, without};
use crate::matrix::counts::Counts;
use crate::object::{Motion, Occluder};
use crate::scene::Scene;
use crate::shape::pieces::{opaque, touched};
use crate::soft::pyramid::Pyramid;

/// The most cells of a grid: 1024^3. A solid that fills them has 2 million bricks, each of which is
/// visited.
const MAX_CELLS: u64 = 1 << 30;

/// Numbers shapes across all grids, so that an id of another grid is found out. Clones have the ids
/// of their original.
static NEXT: AtomicU64 = AtomicU64::new(0);

/// The layer of a shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Layer {
    /// Shapes that seldom change.
    Fixed,
    /// Shapes that move.
    Moving,
}

/// Names a shape of a [`SoftGrid`]. No two shapes of a process have the same, but a clone of the
/// grid has the same ids.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SoftId(u64);

/// Cells that any of several shapes has.
#[derive(Clone)]
struct Bits {
    cells: BitMatrix,
    counts: Counts,
}

impl Bits {
    fn new(dims: IVec3) -> Self {
        Self { cells: BitMatrix::new(dims), counts: Counts::new(dims) }
    }

    fn add(&mut self, part: &Part) {
        part.bricks().for_each(|(brick, mask)| self.counts.add(&mut self.cells, brick, mask));
    }

    fn take(&mut self, part: &Part) {
        for (brick, mask) in part.bricks() {
            self.counts.take(&mut self.cells, brick, mask);
        }
    }

    fn bytes(&self) -> usize {
        self.cells.bytes() + self.counts.bytes()
    }
}

/// The cells of the shapes of a layer.
#[derive(Clone)]
struct Occupied {
    touched: Bits,
    filled: Bits,
}

/// Some cells of one shape.
#[derive(Clone, Default)]
struct Part {
    partial: Vec<(IVec3, Mask)>,
    full: Vec<IVec3>,
}

impl Part {
    fn push(&mut self, brick: IVec3, mask: &Mask) {
        if *mask == ALL { self.full.push(brick) } else { self.partial.push((brick, *mask)) }
    }

    fn bricks(&self) -> impl Iterator<Item = (IVec3, &Mask)> {
        self.partial.iter().map(|(brick, mask)| (*brick, mask)).chain(self.full.iter().map(|&b| (b, &ALL)))
    }

    fn bytes(&self) -> usize {
        self.partial.capacity() * size_of::<(IVec3, Mask)>() + self.full.capacity() * size_of::<IVec3>()
    }
}

/// The cells of one shape.
#[derive(Clone)]
struct Held {
    layer: Layer,
    /// Those that it touches, and those inside of it.
    touched: Part,
    /// Those that lie in it wholly.
    filled: Part,
}

impl Held {
    /// The cells of a shape. Costs those on its surface, and the full bricks.
    fn new(shape: &Occluder, layer: Layer, grid: &Grid) -> Self {
        let mut held = Self { layer, touched: Part::default(), filled: Part::default() };
        let (mesh, transform) = match shape {
            Occluder::Mesh(mesh) => (mesh, DAffine3::IDENTITY),
            Occluder::Instance(instance) => (instance.mesh(), instance.placement().affine),
            solid => {
                touched(solid, grid, &mut |piece| piece.bricks(|brick, mask| held.touched.push(brick, mask)));
                opaque(solid, grid, &mut |piece| piece.bricks(|brick, mask| held.filled.push(brick, mask)));
                return held;
            }
        };
        let mut inner = BitMatrix::new(grid.dims());
        let mut cells = BitMatrix::new(grid.dims());
        let set = |cells: &mut BitMatrix, run: CellRun| cells.set_run(run.x0, run.x1, run.y, run.z);
        mesh.filled(&transform, grid, &mut |run, inside| {
            set(&mut cells, run);
            if inside {
                set(&mut inner, run);
            }
        });
        cells.masks().for_each(|(brick, mask)| held.touched.push(brick, mask));
        inner.masks().for_each(|(brick, mask)| held.filled.push(brick, mask));
        held
    }

    fn bytes(&self) -> usize {
        self.touched.bytes() + self.filled.bytes()
    }
}

/// The cells that shapes occupy, and how much they hide. See the [module](crate::soft).
///
/// Shapes count as the cells that they touch, those of closed meshes and solids with the cells
/// inside. Call [`SoftGrid::rebuild`] to apply changes; it rebuilds only the 8x8x8-cell bricks they
/// touch.
#[derive(Clone)]
pub struct SoftGrid {
    grid: Grid,
    layers: [Occupied; 2],
    shapes: BTreeMap<SoftId, Held>,
    /// The objects of a scene: what was inserted for them.
    followed: BTreeMap<ObjectId, (SoftId, Occluder)>,
    /// Bricks that changed since the last rebuild.
    stale: BitMatrix,
    pyramid: Pyramid,
    /// The cells that lie wholly in a shape of either layer, as of the last rebuild.
    filled: BitMatrix,
}

impl SoftGrid {
    /// An empty grid.
    ///
    /// # Errors
    /// As [`Grid::new`]; also [`Error::SoftGridCells`] for more than 2^30 cells.
    pub fn new(spec: &GridSpec) -> Result<Self, Error> {
        let grid = Grid::new(spec)?;
        if grid.cells() > MAX_CELLS {
            return Err(Error::SoftGridCells { cells: grid.cells(), max: MAX_CELLS });
        }
        let dims = grid.dims();
        let layer = || Occupied { touched: Bits::new(dims), filled: Bits::new(dims) };
        Ok(Self {
            grid,
            layers: [layer(), layer()],
            shapes: BTreeMap::new(),
            followed: BTreeMap::new(),
            stale: BitMatrix::new((dims + (BRICK - 1)) >> 3i32),
            pyramid: Pyramid::new(dims),
            filled: BitMatrix::new(dims),
        })
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The occupied cells of both layers, as of the last [`SoftGrid::rebuild`], and the levels
    /// above.
    pub fn pyramid(&self) -> &Pyramid {
        &self.pyramid
    }

    /// Whether shapes of a layer touch or contain a cell. At once, not as of the last
    /// [`SoftGrid::rebuild`].
    pub fn is_occupied(&self, layer: Layer, cell: IVec3) -> bool {
        self.layers[layer as usize].touched.cells.get(cell)
    }

    /// The cells that lie wholly in a shape, as of the last [`SoftGrid::rebuild`].
    pub(super) fn filled(&self) -> &BitMatrix {
        &self.filled
    }

    /// Adds a shape: a solid, a mesh, or an instance of a mesh. The part outside of the grid is
    /// left out.
    ///
    /// Costs the triangles and the cells on the surface, and the bricks inside.
    ///
    /// # Errors
    /// Refuses shapes that are not finite, inverted or negative, as [`Scene::insert`] does.
    pub fn insert(&mut self, shape: impl Into<Occluder>, layer: Layer) -> Result<SoftId, Error> {
        let shape = shape.into();
        shape.kind().check("the shape")?;
        let held = Held::new(&shape, layer, &self.grid);
        let id = SoftId(NEXT.fetch_add(1, Ordering::Relaxed));
        self.add(id, held);
        Ok(id)
    }

    /// Replaces a shape.
    ///
    /// # Errors
    /// As [`SoftGrid::insert`], and [`Error::UnknownShape`]. The grid is then as before.
    pub fn update(&mut self, id: SoftId, shape: impl Into<Occluder>) -> Result<(), Error> {
        let shape = shape.into();
        shape.kind().check("the shape")?;
        let layer = self.shapes.get(&id).ok_or(Error::UnknownShape(id.0))?.layer;
        let held = Held::new(&shape, layer, &self.grid);
        self.remove(id)?;
        self.add(id, held);
        Ok(())
    }

    /// Removes a shape.
    ///
    /// # Errors
    /// [`Error::UnknownShape`] if it was removed before, or belongs to another grid that this one
    /// was not cloned from.
    pub fn remove(&mut self, id: SoftId) -> Result<(), Error> {
        let held = self.shapes.remove(&id).ok_or(Error::UnknownShape(id.0))?;
        let Occupied { touched, filled } = &mut self.layers[held.layer as usize];
        touched.take(&held.touched);
        filled.take(&held.filled);
        // A shape touches all that it fills.
        held.touched.bricks().for_each(|(brick, _)| self.stale.set(brick));
        Ok(())
    }

    fn add(&mut self, id: SoftId, held: Held) {
        let Occupied { touched, filled } = &mut self.layers[held.layer as usize];
        touched.add(&held.touched);
        filled.add(&held.filled);
        held.touched.bricks().for_each(|(brick, _)| self.stale.set(brick));
        self.shapes.insert(id, held);
    }

    /// Takes over the occluders of a scene, and [rebuilds](SoftGrid::rebuild): inserts new ones,
    /// replaces those that changed and removes those that are gone since the last call. Static
    /// objects go to [`Layer::Fixed`]. Shapes that were inserted by hand stay.
    ///
    /// Costs the objects of the scene, and the cells of those that changed.
    ///
    /// # Errors
    /// Only errors the scene itself would have returned. Objects before the failing one are already
    /// inserted, but not yet rebuilt.
    pub fn follow(&mut self, scene: &Scene) -> Result<usize, Error> {
        let gone = |id: &ObjectId| !scene.occluder(*id).is_ok_and(|occluder| occluder.is_some());
        for id in self.followed.keys().copied().filter(gone).collect::<Vec<_>>() {
            if let Some((held, _)) = self.followed.remove(&id) {
                self.remove(held)?;
            }
        }
        for (id, object) in scene.iter() {
            let Some(occluder) = object.occluder() else { continue };
            let held = match self.followed.get(&id) {
                Some((_, old)) if old.same(occluder) => continue,
                Some(&(held, _)) => {
                    self.update(held, occluder.clone())?;
                    held
                }
                None if object.motion() == Motion::Static => self.insert(occluder.clone(), Layer::Fixed)?,
                None => self.insert(occluder.clone(), Layer::Moving)?,
            };
            self.followed.insert(id, (held, occluder.clone()));
        }
        Ok(self.rebuild())
    }

    /// Brings all answers up to date with the shapes. Returns the number of bricks of 8x8x8 cells
    /// that changed.
    ///
    /// Costs those bricks and the cells of the pyramid above them.
    pub fn rebuild(&mut self) -> usize {
        let mut changed: Vec<IVec3> = Vec::new();
        for brick in self.stale.iter() {
            let [a, b] = &self.layers;
            let mask = either(a.filled.cells.brick(brick), b.filled.cells.brick(brick));
            self.filled.clear_mask(brick, &without(&ALL, &mask));
            self.filled.set_mask(brick, &mask);
            let mask = either(a.touched.cells.brick(brick), b.touched.cells.brick(brick));
            if self.pyramid.set_base(brick, &mask) {
                changed.push(brick);
            }
        }
        self.stale.clear();
        let count = changed.len();
        self.pyramid.rebuild(changed);
        count
    }

    /// Bytes on the heap, without meshes, which others share.
    pub fn memory_bytes(&self) -> usize {
        let layers = self.layers.iter().map(|l| l.touched.bytes() + l.filled.bytes()).sum::<usize>();
        let shapes = in_tree::<(SoftId, Held)>(self.shapes.len());
        let followed = in_tree::<(ObjectId, (SoftId, Occluder))>(self.followed.len());
        let held = self.shapes.values().map(Held::bytes).sum::<usize>();
        layers
            + shapes
            + followed
            + held
            + self.stale.bytes()
            + self.pyramid.memory_bytes()
            + self.filled.bytes()
    }
}

impl std::fmt::Debug for SoftGrid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "SoftGrid({} shapes, {:?})", self.shapes.len(), self.pyramid)
    }
}
