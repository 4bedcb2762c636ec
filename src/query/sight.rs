//! Questions about boxes, points and bounds to the last run of a query.

use glam::Vec3;

use crate::geometry::{Aabb, Block};
use crate::method::Method;
use crate::numeric::view::ALONG_RAYS;
use crate::object::{Bounds, Occluder};
use crate::pvs::Pvs;
use crate::query::Query;
use crate::query::point::drawing::DrawingScratch;
use crate::query::start::Starts;
use crate::scene::Scene;
use crate::view::{Origin, View};

/// Answers whether the view of a query's last run can see a box, a point or some bounds, which need
/// not be objects of the scene: bullets, sounds, particles, the place where something is to appear.
/// See [`Query::sight`].
///
/// The answer "no" is certain: no segment from the eye to any point asked for is free of occluders
/// inside the view. The answer "yes" may be wrong, as with a [`crate::Pvs`]. Many questions share
/// the one set of occlusion buffers, so each costs the pixels that it covers.
///
/// ```
/// use casca::{Aabb, ObjectDesc, Query, Scene, View};
/// use glam::{UVec3, Vec3};
///
/// # fn main() -> Result<(), casca::Error> {
/// let mut scene = Scene::new(1.0)?;
/// let wall = Aabb::new(Vec3::new(2.0, 2.0, 15.0), Vec3::new(30.0, 30.0, 17.0));
/// scene.insert(ObjectDesc::fixed(wall).occluder(wall))?;
/// let mut query = Query::new();
/// query.run(&scene, &View::omnidirectional(Vec3::new(16.0, 16.0, 8.0))?);
///
/// let sight = query.sight(&scene).expect("the query has run");
/// assert!(sight.has_occlusion());
/// assert!(sight.may_see_point(Vec3::new(16.0, 16.0, 12.0)), "before the wall");
/// assert!(!sight.may_see_point(Vec3::new(16.0, 16.0, 20.0)), "behind it");
/// assert!(!sight.may_see_box(&Aabb::new(Vec3::new(10.0, 10.0, 20.0), Vec3::new(20.0, 20.0, 24.0))));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Sight<'a> {
    pub(crate) view: &'a View,
    /// The occlusion buffers, as long as they are true.
    buffers: Option<&'a DrawingScratch>,
    /// Where rays start beside the eye.
    starts: Starts,
}

impl Query {
    /// The view of the last run with its occlusion buffers, for questions about anything in space;
    /// `None` before the first run. Buffers count only if that run drew them ([`Method::Point`])
    /// and nothing moved since that they or the set depend on ([`Sight::has_occlusion`]). Costs the
    /// objects that the near plane may cut.
    pub fn sight(&self, scene: &Scene) -> Option<Sight<'_>> {
        let pvs = self.pvs();
        let view = pvs.view.as_ref()?;
        let drawn = matches!(pvs.method, Method::Point(_)) && pvs.is_valid_for(scene, view);
        Some(Sight::new(scene, view, drawn.then_some(&self.point.drawing)))
    }
}

impl<'a> Sight<'a> {
    /// A view, with occlusion buffers that are true for it.
    pub(crate) fn new(scene: &Scene, view: &'a View, buffers: Option<&'a DrawingScratch>) -> Self {
        Self { view, buffers, starts: Starts::of(scene, view) }
    }

    /// Whether occluders count. If not, all that lies inside the frustum may be seen.
    pub fn has_occlusion(&self) -> bool {
        self.buffers.is_some()
    }

    /// Whether a point of a box can be seen; in doubt, yes. A box that is inverted or not finite
    /// may be seen.
    pub fn may_see_box(&self, b: &Aabb) -> bool {
        b.check("a box").is_err() || self.may_see(&Block::from(*b))
    }

    /// Whether a point can be seen; in doubt, yes. A point that is not finite may be seen.
    pub fn may_see_point(&self, point: Vec3) -> bool {
        self.may_see_box(&Aabb::new(point, point))
    }

    /// Whether a point of some bounds can be seen; in doubt, yes, also of bounds that a scene would
    /// refuse. Tighter than their box, and slower: undecided bounds are compared with the pixels
    /// that their own outline touches. Meshes are tested as one convex shape.
    pub fn may_see_bounds(&self, bounds: &Bounds) -> bool {
        bounds.kind().check("bounds").is_err()
            || self.view.may_see(bounds) && !self.buffers.is_some_and(|scratch| scratch.hides_bounds(bounds))
    }

    /// Whether the view may see a point of some geometry in a box; in doubt, yes.
    pub(crate) fn may_see(&self, block: &Block) -> bool {
        self.view.may_see_volume(block) && !self.buffers.is_some_and(|buffers| buffers.hides(block))
    }

    /// Whether one may see an occluder from its inside.
    pub(crate) fn may_start_in(&self, occluder: &Occluder) -> bool {
        !self.view.is_ordered() || self.starts.may_be_in(self.view, occluder)
    }

    /// Whether rays may run into the side of a box with a normal along an axis (`sign` 1) or
    /// against it (-1), at a coordinate on that axis; in doubt, yes.
    pub(crate) fn may_enter(&self, axis: usize, sign: f64, at: f64) -> bool {
        match self.view.origin {
            Origin::Eye { at: eye, .. } => (eye[axis] - at) * sign >= -self.view.eye_box()[axis],
            Origin::Direction(d) => d[axis] * sign <= ALONG_RAYS,
        }
    }
}

/// A query of a camera: a [`Query`] or a [`KeptQuery`](crate::KeptQuery). [`Query::shadow_casters`]
/// takes either.
pub trait CameraQuery: sealed::Sealed {
    /// The result of the last run.
    fn pvs(&self) -> &Pvs;

    /// The view of the last run with its occlusion buffers: see [`Query::sight`].
    fn sight(&self, scene: &Scene) -> Option<Sight<'_>>;
}

/// Other crates have no camera queries: results rest on the private parts of those.
pub(crate) mod sealed {
    pub trait Sealed {}
}

impl sealed::Sealed for Query {}

impl CameraQuery for Query {
    fn pvs(&self) -> &Pvs {
        Self::pvs(self)
    }

    fn sight(&self, scene: &Scene) -> Option<Sight<'_>> {
        Self::sight(self, scene)
    }
}
