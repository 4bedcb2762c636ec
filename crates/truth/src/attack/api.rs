//! The calls whose behaviour changes with the library's next interface: the place to follow it.

use casca::internals::SceneInternals;
use casca::{Error, FrameReport, MemoryUse, ObjectId, Pvs, Scene, View};
use glam::{Mat4, Vec3};

/// Whether the next interface is there:
/// - `update` without an occluder of an object that has one is refused,
/// - occluders that stick out of their bounds are refused,
/// - a greatest speed of something fixed is refused,
/// - an eye that is not the matrix's is refused.
///
/// Until then such calls are played, and both answers are taken.
pub const STRICT: bool = true;

/// Ends a frame with results, each with whether its query ever ran.
///
/// # Errors
/// As [`Scene::end_frame`].
pub fn end_frame(scene: &mut Scene, sets: &[(bool, &Pvs)]) -> Result<FrameReport, Error> {
    // Queries that never ran are refused as of another scene by the present interface.
    scene.end_frame(sets.iter().filter(|(ran, _)| *ran || STRICT).map(|(_, set)| *set))
}

/// A perspective view with the eye told.
///
/// # Errors
/// As [`View::perspective`].
pub fn perspective(eye: Vec3, matrix: Mat4) -> Result<View, Error> {
    View::perspective(eye, matrix)
}

/// The id of an object in a clone of its scene.
pub fn id_in_clone(clone: &Scene, id: ObjectId) -> Option<ObjectId> {
    clone.ids().find(|other| other.index() == id.index())
}

/// What an empty scene still holds in its matrices; nothing, if all is right.
pub fn leftovers(scene: &Scene) -> Option<String> {
    let (entries, volumes) = (scene.id_matrix().entries(), scene.tbv_matrix().volumes());
    let opaque = (scene.static_opacity().count(), scene.dynamic_opacity().count());
    let clean = scene.is_empty() && (entries, volumes) == (0, 0) && opaque == (0, 0);
    (!clean).then(|| {
        format!("{} objects, {entries} entries, {volumes} volumes, {opaque:?} opaque cells", scene.len())
    })
}

/// Asks for what must not panic.
pub fn memory(scene: &Scene) -> MemoryUse {
    scene.memory()
}
