//! The potentially visible set of a view: the answer to a query.

use std::iter::Copied;
use std::slice::Iter;

use glam::IVec3;

use crate::id::ObjectId;
use crate::method::Method;
use crate::view::View;

/// The work of a query in numbers, the same on every machine. The library has no clock: measure
/// around [`crate::Query::run`].
///
/// They follow from the scene, the view and the method, whatever the query ran before; those of a
/// [coherent](crate::PointOptions::coherent) run also from the runs that it builds on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Stats {
    /// Chessboard shells walked.
    pub shells: u32,
    /// Cells inside the frustum that were visited, counted once for each side of a shell that they
    /// belong to. Large parts that are empty or hidden are passed over and not counted,
    /// and so are all cells where [`Method::Cell`] takes nothing to be hidden.
    pub cells_visited: u64,
    /// How many of them were hidden.
    pub cells_hidden: u64,
    /// Sides of shells whose blocked cells were drawn as occluders.
    pub caps_drawn: u32,
    /// Objects whose bounds were compared with the frustum.
    pub objects_tested: u32,
    /// [`Method::Point`]: bricks of 8x8x8 cells inside the frustum with objects in them.
    pub bricks_visited: u64,
    /// [`Method::Point`]: how many of them were found hidden as a whole.
    pub bricks_hidden: u64,
    /// [`Method::Point`]: pixels of the occlusion buffers inside the view.
    pub pixels: u64,
    /// [`Method::Point`]: objects compared with the occlusion buffers, counted each time.
    pub occlusion_tests: u32,
    /// [`Method::Point`]: objects in sight whose occluders were drawn.
    pub occluders_drawn: u32,
    /// [`Method::Point`]: objects whose occluders, when they were drawn, covered a pixel that was
    /// not covered yet, or covered one at a nearer depth. Patches that cover pixels only together
    /// count for each of their objects. No more than were drawn, except in a
    /// [coherent](crate::PointOptions::coherent) run, which begins with patches of objects that may
    /// be out of sight.
    pub occluders_useful: u32,
    /// [`Method::Point`]: patches of triangles drawn.
    pub patches_drawn: u32,
    /// [`Method::Point`]: blocks of 32x8 pixels that these patches were drawn in.
    pub patch_blocks: u64,
    /// [`Method::Point`]: occluders too small to draw.
    pub occluders_skipped: u32,
    /// [`Method::Point`]: objects that only undecided pixels showed, or seemed to, and
    /// were examined again.
    pub refined: u32,
    /// [`Method::Point`]: how many of those turned out to be hidden.
    pub refined_hidden: u32,
    /// [`Method::Point`]: squares of directions examined for that.
    pub refine_squares: u64,
    /// [`Method::Point`]: patches of triangles drawn again for that.
    pub refine_patches: u32,
    /// Temporal bounding volumes revealed.
    pub tbvs_revealed: u32,
    /// Whether the eye was inside an occluder, or the near plane cut into one, so
    /// that one may see through it. [`Method::Cell`] then takes nothing to be hidden;
    /// [`Method::Point`] leaves out those occluders.
    pub eye_in_occluder: bool,
}

/// The potentially visible set: every object of which any point can be seen, and a few more.
///
/// # Use
///
/// Draw the objects of [`Pvs::visible`], which come roughly from near to far, or ask
/// [`Pvs::contains`] about one. [`Pvs::changes_since`] tells which objects come and go between two
/// sets. At the end of a frame, give the sets of all cameras to [`Scene::end_frame`](crate::Scene::end_frame).
///
/// ```
/// use casca::{ObjectDesc, Query, Scene, Sphere, View};
/// use glam::{UVec3, Vec3};
///
/// # fn main() -> Result<(), casca::Error> {
/// let mut scene = Scene::new(1.0)?;
/// let ball = Sphere::new(Vec3::splat(4.0), 1.0);
/// let id = scene.insert(ObjectDesc::dynamic(ball).user_data(7))?;
/// let view = View::omnidirectional(Vec3::splat(9.5))?;
/// let mut query = Query::new();
/// for id in query.run(&scene, &view) {
///     // An index into tables of the application.
///     assert_eq!(scene.user_data(id)?, 7);
/// }
/// // A copy outlives the next run, and says itself whether it still holds.
/// let kept = query.pvs().clone();
/// assert!(kept.is_valid_for(&scene, &view));
/// scene.update(id, Sphere::new(Vec3::splat(6.0), 1.0), None)?;
/// assert!(kept.contains(id) && !kept.is_valid_for(&scene, &view));
/// scene.end_frame([query.pvs()])?;
/// # Ok(())
/// # }
/// ```
///
/// # Cost
///
/// Membership is one look-up. A set takes 12 bytes for each object in it and 4 for each slot of the
/// scene, and [`crate::Query::run`] writes the next set into the same memory.
///
/// # Guarantees
///
/// No object that can be seen is missing, as long as the promises of the scene hold: occluders lie
/// inside the objects, and movers keep to their speeds. The order is the same on every machine.
///
/// # Pitfalls
///
/// - It is a set for one moment and one view: ask [`Pvs::is_valid_for`] before using it for
///   another, or use a [`KeptQuery`](crate::KeptQuery).
/// - Ids in an old set may name objects that were removed: the scene then refuses them.
#[derive(Debug, Clone)]
pub struct Pvs {
    pub(crate) scene: u32,
    pub(crate) revision: u64,
    /// The last move that the query knew of.
    pub(crate) moves: u64,
    pub(crate) method: Method,
    /// Whether objects of the view were left out: those that cast no shadow onto any receiver, or
    /// dynamic ones.
    pub(crate) partial: bool,
    pub(crate) view: Option<View>,
    pub(crate) cell: Option<IVec3>,
    /// The eye's cell.
    pub(crate) viewer: Option<IVec3>,
    pub(crate) visible: Vec<ObjectId>,
    pub(crate) revealed: Vec<ObjectId>,
    /// By slot: 1 + the place in `visible`, or 0.
    pub(crate) places: Vec<u32>,
    pub(crate) stats: Stats,
}

/// An empty set, of no scene and no view: [`Scene::end_frame`](crate::Scene::end_frame) passes over
/// it.
impl Default for Pvs {
    fn default() -> Self {
        Self::empty()
    }
}

impl Pvs {
    pub(crate) fn empty() -> Self {
        Self {
            scene: 0,
            revision: 0,
            moves: 0,
            method: Method::Frustum,
            partial: false,
            view: None,
            cell: None,
            viewer: None,
            visible: Vec::new(),
            revealed: Vec::new(),
            places: Vec::new(),
            stats: Stats::default(),
        }
    }

    /// The objects that can be seen, front to back: in the order of the
    /// chessboard shells in which they were found. Small moving objects that hide
    /// nothing come last, zone by zone. [`Method::Frustum`] gives all in the order
    /// of their indices.
    pub fn visible(&self) -> &[ObjectId] {
        &self.visible
    }

    /// The objects that can be seen, as [`Pvs::visible`] gives them.
    ///
    /// ```
    /// # use casca::{ObjectDesc, Query, Scene, Sphere, View};
    /// # use glam::{UVec3, Vec3};
    /// # fn main() -> Result<(), casca::Error> {
    /// # let mut scene = Scene::new(1.0)?;
    /// # let id = scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::splat(4.0), 1.0)))?;
    /// # let mut query = Query::new();
    /// for id in query.run(&scene, &View::omnidirectional(Vec3::splat(9.5))?) {
    ///     println!("draw {}", id.index());
    /// }
    /// # assert!(query.pvs().iter().eq([id]));
    /// # Ok(())
    /// # }
    /// ```
    pub fn iter(&self) -> Copied<Iter<'_, ObjectId>> {
        self.visible.iter().copied()
    }

    /// The differences between this set and one that was found earlier: the objects to show and
    /// those to take away. Costs one look-up for each object of both sets, when the iterators run.
    ///
    /// Both may be of any view and method. Of sets of different scenes all objects differ, except
    /// those that a clone of a scene has in common with its original.
    ///
    /// ```
    /// use casca::{ObjectDesc, Plane, Query, Scene, Sphere, View};
    /// use glam::{UVec3, Vec3};
    ///
    /// # fn main() -> Result<(), casca::Error> {
    /// let mut scene = Scene::new(1.0)?;
    /// let mut ball = |x| scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::new(x, 8.0, 8.0), 1.0)));
    /// let (low, high) = (ball(3.0)?, ball(13.0)?);
    /// let half = |normal: Vec3| {
    ///     let eye = Vec3::splat(8.0);
    ///     View::from_planes(eye, &[Plane { normal, offset: -normal.dot(eye) }])
    /// };
    /// let mut query = Query::new();
    /// let before = query.run(&scene, &half(Vec3::NEG_X)?).clone();
    /// let changes = query.run(&scene, &half(Vec3::X)?).changes_since(&before);
    /// assert!(changes.entered().eq([high]) && changes.left().eq([low]));
    /// # Ok(())
    /// # }
    /// ```
    pub fn changes_since<'a>(&'a self, earlier: &'a Self) -> PvsChanges<'a> {
        PvsChanges { earlier, later: self }
    }

    /// Whether it is the result of a query.
    pub(crate) fn has_run(&self) -> bool {
        self.scene != 0
    }

    /// Empties the set for a scene of `slots` slots.
    pub(crate) fn reset(&mut self, slots: usize) {
        for id in self.visible.drain(..) {
            self.places[id.index()] = 0;
        }
        self.places.resize(slots, 0);
        self.revealed.clear();
        self.stats = Stats::default();
    }

    /// Whether nothing that it depends on changed in its scene, of which these are the numbers of
    /// [`Scene::revision`](crate::Scene) and [`Scene::moves`](crate::Scene). All of its ids name
    /// objects then.
    pub(crate) fn is_fresh(&self, revision: u64, moves: u64) -> bool {
        self.revision == if matches!(self.method, Method::Frustum) { moves } else { revision }
    }

    pub(crate) fn push(&mut self, id: ObjectId) {
        self.visible.push(id);
        self.places[id.index()] = self.visible.len() as u32;
    }

    /// Number of objects that can be seen.
    pub fn len(&self) -> usize {
        self.visible.len()
    }

    /// Whether nothing can be seen.
    pub fn is_empty(&self) -> bool {
        self.visible.is_empty()
    }

    /// Whether an object can be seen. Costs one look-up.
    pub fn contains(&self, id: ObjectId) -> bool {
        let place = self.places.get(id.index()).copied().unwrap_or(0) as usize;
        place > 0 && self.visible[place - 1] == id
    }

    /// Dynamic objects whose temporal bounding volume came into sight, visible or not.
    pub fn revealed(&self) -> &[ObjectId] {
        &self.revealed
    }

    /// The work of the query in numbers.
    pub fn stats(&self) -> &Stats {
        &self.stats
    }

    /// The method of the query.
    pub fn method(&self) -> Method {
        self.method
    }

    /// The cell for which the set is valid, where there is one:
    /// it contains all that any eye in this cell sees inside the view's half-spaces, as
    /// [`Method::Cell`] says. `None` for other methods, for parallel rays, and where nothing was
    /// taken to be hidden: then the set contains all that lies inside the half-spaces.
    pub fn view_cell(&self) -> Option<IVec3> {
        self.cell
    }
}

/// The same objects as [`Pvs::iter`].
impl<'a> IntoIterator for &'a Pvs {
    type Item = ObjectId;
    type IntoIter = Copied<Iter<'a, ObjectId>>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

/// The differences between two sets: see [`Pvs::changes_since`].
#[derive(Debug, Clone, Copy)]
pub struct PvsChanges<'a> {
    earlier: &'a Pvs,
    later: &'a Pvs,
}

impl<'a> PvsChanges<'a> {
    /// The objects of the later set that are not in the earlier one, in the order of the later.
    pub fn entered(self) -> impl Iterator<Item = ObjectId> + 'a {
        self.later.iter().filter(move |&id| !self.earlier.contains(id))
    }

    /// The objects of the earlier set that are not in the later one, in the order of the earlier.
    /// Some may have been removed from the scene.
    pub fn left(self) -> impl Iterator<Item = ObjectId> + 'a {
        self.earlier.iter().filter(move |&id| !self.later.contains(id))
    }
}
