//! The scene: objects, the matrices of their cells, and the frame loop.
//!
//! # Where an object is
//!
//! Every object is stored in a [`Slot`] and has a *home*, a box in which it is known to stay
//! ([`home`], with the table of what changes it):
//! - the *bricks* that it touches, in the matrices I (objects) and O (opaque cells). All static
//!   objects are there.
//! - a *zone*, for small movers that hide nothing ([`movers`]).
//! - a temporal bounding *volume*, for a mover that no view saw in the last frames. Only the surface
//!   of the volume is in the matrices ([`crate::matrix::tbv`]).
//!
//! Most moves stay inside: [`rooms`] compares them with the boxes of zones and volumes. An object
//! that is reported on expiry, and was not reported in time ([`reports`]), may be anywhere: it is
//! visible to every query and hides nothing.
//!
//! Lists beside the matrices ([`spatial_index`]): objects that no cells tell of - beyond the reach of
//! coordinates, too large, or of unknown place - are in the set `always`, which every query tests.
//!
//! # A frame
//!
//! 1. [`Scene::begin_frame`] sets the clock. Volumes that may no longer contain their objects
//!    expire, and those objects are due for a report.
//! 2. The application edits the scene ([`edit`]): it reports the objects that are due or that
//!    moved, and inserts and removes others.
//! 3. Queries read the scene. Any number may run at the same time.
//! 4. [`Scene::end_frame`] takes their results. Dynamic objects that no view saw get volumes;
//!    objects whose volumes were seen leave them.
//!
//! # Results and revisions
//!
//! [`changes`] counts the changes that a result may depend on (the revision; motion inside a volume
//! is none of them), and the moves of all objects. [`crate::Pvs::is_valid_for`] compares both. It
//! also lists the last changes of static objects and the volumes that are new: results that are
//! kept ask for these.

mod boxes;
mod changes;
mod clock;
mod edit;
mod frame;
mod home;
mod last_frame;
mod memory;
mod movers;
mod near;
mod object;
mod opacity;
mod opaque;
pub(crate) mod origin;
mod reads;
mod reports;
mod rooms;
mod slot_bits;
mod solids;
mod spatial_index;
mod static_solids;
mod transitions;
mod user_data;
mod volume;

use casca_slots::Slots;
use glam::DVec3;

use crate::grid::Grid;
use crate::mesh::surface::seams::Seams;
use crate::scene::changes::Changes;
use crate::scene::clock::Clock;
use crate::scene::last_frame::LastFrame;
use crate::scene::opacity::Opacity;
use crate::scene::spatial_index::SpatialIndex;
use crate::scene::user_data::UserData;

pub(crate) use boxes::{Boxes, ObjectBox};
pub(crate) use changes::StaticChange;
pub use frame::{FrameReport, MOST_NEW_VOLUMES};
pub use memory::MemoryUse;
pub(crate) use movers::{Movers, Zone};
pub(crate) use near::{inside_occluder, occluder_touches};
pub(crate) use object::Object;
pub(crate) use opacity::LayerOpacity;
pub use reads::ObjectRef;

/// Objects in a regular grid, shared read-only by any number of queries.
///
/// # Use
///
/// [`Scene::insert`] takes descriptions of objects, and gives the ids by which they are moved
/// ([`Scene::update`], [`Scene::set_transform`]) and removed. A frame is [`Scene::begin_frame`]
/// with the time, the moves, queries, and [`Scene::end_frame`] with their results.
///
/// A clone is another scene. It knows the ids of all objects that it was made with, but not the ids
/// that the original gives out later, nor the other way round. Each refuses a [`crate::Pvs`] that
/// was found on the other.
///
/// ```
/// use casca::{Aabb, ObjectDesc, Query, Scene, Sphere, View};
/// use glam::{UVec3, Vec3};
///
/// # fn main() -> Result<(), casca::Error> {
/// let mut scene = Scene::new(1.0)?;
/// let wall = Aabb::new(Vec3::new(8.0, 0.0, 0.0), Vec3::new(10.0, 32.0, 32.0));
/// let wall = scene.insert(ObjectDesc::fixed(wall).occluder(wall))?;
/// let near = scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::new(4.0, 16.0, 16.0), 1.0)))?;
/// let far = scene.insert(ObjectDesc::fixed(Sphere::new(Vec3::new(20.0, 16.0, 16.0), 1.0)))?;
/// let mut query = Query::new();
/// let pvs = query.run(&scene, &View::omnidirectional(Vec3::new(2.5, 16.5, 16.5))?);
/// assert!(pvs.contains(wall) && pvs.contains(near) && !pvs.contains(far));
/// # Ok(())
/// # }
/// ```
///
/// # Cost
///
/// An object costs its record and the cells that it touches, a move the cells that it enters and
/// leaves; one of an object that hides nothing costs a comparison while it stays in the same bricks
/// of 8x8x8 cells, or, if it is small, in the same zone of 32x32x32 cells. A moving object that no
/// view saw is put into a temporal bounding volume at the end of the frame: until it leaves that,
/// its moves cost a comparison each, and queries do not look at it. [`Scene::memory`] tells the
/// memory of all parts.
///
/// # Guarantees
///
/// Ids are never used again, and those of other scenes are refused, as are shapes that are not
/// finite; a call that is refused changes nothing. What queries find depends neither on the order
/// of hashes, nor on threads, nor on the clock of the machine.
///
/// # Pitfalls
///
/// - Objects that are promised to keep to a speed ([`crate::ObjectDesc::max_speed`]) and are
///   [reported on expiry](crate::Reports::OnExpiry) must keep to it: the promise is what hides
///   them.
/// - Occluders must lie inside the geometry that is drawn. What they hide is not drawn.
/// - A frame that ends without [`Scene::end_frame`] loses nothing, but hidden movers stay in the
///   matrices and cost every query.
/// - What lies more than 2^20 cells from the corner of the grid is tested in every query.
#[derive(Clone)]
pub struct Scene {
    /// The place of the coordinates' origin.
    origin: DVec3,
    grid: Grid,
    slots: Slots<Object>,
    user_data: UserData,
    /// Where queries find objects: I, lists, zones and volumes.
    index: SpatialIndex,
    /// O and Os.
    opacity: Opacity,
    /// The patches of all surfaces, and where those of static objects touch.
    seams: Seams,
    /// The time, and what is due by it.
    clock: Clock,
    /// What the views of the last frame saw.
    last_frame: LastFrame,
    /// What tells whether results still hold.
    changes: Changes,
}
