//! Frames: moves in bulk, the clock, and what queries found.

use casca::glam::{Affine3A, DVec3, Vec3};
use casca::{Aabb, Bounds, Pvs, Sphere};

use crate::border::{self, Out, OutSpan, OutStruct, grows};
use crate::error::{Failure, call, casca_status};
use crate::query::{Camera, QUERIES, casca_query};
use crate::scene::{SCENES, SceneState, casca_scene, edit};
use crate::view::{self, CASCA_ROW_MAJOR};

/// What casca_scene_end_frame did. Fill it by CASCA_INIT.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct casca_frame_report {
    /// sizeof(casca_frame_report).
    pub size: usize,
    /// Objects that nobody saw and that were put into temporal bounding volumes.
    pub hidden: usize,
    /// Volumes that were seen.
    pub revealed: usize,
}

grows!(casca_frame_report: size_of::<casca_frame_report>(),);

/// Makes all moves that are not refused, and gives the first refusal.
fn moves<T: border::Plain>(
    (scene, ids, values): (casca_scene, *const u64, *const T),
    (count, what): (usize, &str),
    mut make: impl FnMut(&mut SceneState, u64, &T) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let (ids, values) = (border::span(ids, count, "ids")?, border::span(values, count, what)?);
    let mut state = SCENES.exclusive(scene.handle)?;
    let mut first = Ok(());
    for (i, (&id, value)) in ids.iter().zip(values).enumerate() {
        let made = make(&mut state, id, value);
        if first.is_ok() {
            first = made.map_err(|why| why.at(i));
        }
    }
    first
}

fn update(state: &mut SceneState, id: u64, bounds: impl Into<Bounds>) -> Result<(), Failure> {
    let id = state.find(id)?;
    Ok(state.scene.update(id, bounds, None)?)
}

/// Moves count objects to spheres: four floats x, y, z, radius for each.
///
/// All moves are made but those that are refused; the status and message are those of the first
/// refusal. For objects without an occluder. Costs 10 to 20 ns for each small object that stays in
/// its zone of 32x32x32 cells or in its volume.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_move_spheres(
    scene: casca_scene,
    ids: *const u64,
    spheres: *const f32,
    count: usize,
) -> casca_status {
    call(|| {
        let spheres = spheres.cast::<[f32; 4]>();
        moves((scene, ids, spheres), (count, "spheres"), |state, id, &[x, y, z, radius]| {
            update(state, id, Sphere::new(Vec3::new(x, y, z), radius))
        })
    })
}

/// As casca_scene_move_spheres, to boxes: six floats for each, the least corner and the greatest.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_move_boxes(
    scene: casca_scene,
    ids: *const u64,
    boxes: *const f32,
    count: usize,
) -> casca_status {
    call(|| {
        let boxes = boxes.cast::<[f32; 6]>();
        moves((scene, ids, boxes), (count, "boxes"), |state, id, &[x, y, z, to_x, to_y, to_z]| {
            update(state, id, Aabb::new(Vec3::new(x, y, z), Vec3::new(to_x, to_y, to_z)))
        })
    })
}

/// Moves count placed objects, with their occluders: 16 floats for each, column by column unless
/// flags is CASCA_ROW_MAJOR. As casca_scene_move_spheres, the others are moved where one is
/// refused.
///
/// Errors: objects that are not placed (code "not-placed"), a last row other than 0 0 0 1, numbers
/// that are not finite, spheres whose axes are scaled differently.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_set_transforms(
    scene: casca_scene,
    ids: *const u64,
    transforms: *const f32,
    count: usize,
    flags: u32,
) -> casca_status {
    call(|| {
        view::check_flags(flags, CASCA_ROW_MAJOR, "flags")?;
        let transforms = transforms.cast::<[f32; 16]>();
        moves((scene, ids, transforms), (count, "transforms"), |state, id, numbers| {
            let transform: Affine3A = view::transform(*numbers, flags)?;
            let id = state.find(id)?;
            Ok(state.scene.set_transform(id, transform)?)
        })
    })
}

/// Moves one placed object: casca_scene_set_transforms for one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_set_transform(
    scene: casca_scene,
    id: u64,
    transform: *const f32,
    flags: u32,
) -> casca_status {
    call(|| {
        view::check_flags(flags, CASCA_ROW_MAJOR, "flags")?;
        let numbers = border::array(transform.cast::<[f32; 16]>(), "transform")?;
        let transform = view::transform(numbers, flags)?;
        edit(scene, id, |scene, id| scene.set_transform(id, transform))
    })
}

/// Moves an object and its occluder by an offset of three floats, in world units. Errors: a mesh in
/// world space (code "fixed-mesh"): give CASCA_PLACED for meshes that move.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_translate(
    scene: casca_scene,
    id: u64,
    offset: *const f32,
) -> casca_status {
    call(|| {
        let offset = border::array(offset.cast::<[f32; 3]>(), "offset")?;
        edit(scene, id, |scene, id| scene.translate(id, Vec3::from_array(offset)))
    })
}

/// Puts the origin of all coordinates at a place of the world, three doubles. The scene changes the
/// coordinates of its objects; give new ones relative to the new origin. The first origin is zero. For
/// levels far away, and for worlds so large that floats get coarse. Costs all objects.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_set_origin(scene: casca_scene, origin: *const f64) -> casca_status {
    call(|| {
        let origin = border::array(origin.cast::<[f64; 3]>(), "origin")?;
        let mut state = SCENES.exclusive(scene.handle)?;
        Ok(state.scene.set_origin(DVec3::from_array(origin))?)
    })
}

/// Begins a frame at a time in seconds. due_count, unless null, gets how many objects reported on
/// expiry are due: read them by casca_scene_get_due and report where they are. Until then they
/// count as visible and hide nothing.
///
/// Errors: a time that is not finite. Costs the objects that are due.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_begin_frame(
    scene: casca_scene,
    seconds: f64,
    due_count: *mut usize,
) -> casca_status {
    call(|| {
        let out = Out::or_null(due_count, "due_count")?;
        let mut state = SCENES.exclusive(scene.handle)?;
        let due = state.scene.begin_frame(seconds)?;
        let due = state.ids(due.into_iter()).collect::<Vec<u64>>();
        out.set(due.len());
        state.due = due;
        Ok(())
    })
}

/// The objects that were due when the frame began. ids has room for capacity; count gets how many
/// there are, also when that is more (CASCA_ERROR_TOO_SMALL).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_get_due(
    scene: casca_scene,
    ids: *mut u64,
    capacity: usize,
    count: *mut usize,
) -> casca_status {
    call(|| OutSpan::new(ids, capacity, count, "ids")?.set(&SCENES.shared(scene.handle)?.due))
}

/// Ends a frame with the queries of its cameras, and of lights whose casters you draw: moving
/// objects that none of them found get temporal bounding volumes, so that their next moves and
/// queries cost next to nothing. report may be null. A frame that ends without this call loses no
/// object, but costs more.
///
/// Errors: a query that ran last on another scene. Queries that never ran are passed over.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_end_frame(
    scene: casca_scene,
    queries: *const casca_query,
    count: usize,
    report: *mut casca_frame_report,
) -> casca_status {
    call(|| {
        let out = if report.is_null() { None } else { Some(OutStruct::new(report)?) };
        let handles = border::span(queries.cast::<u64>(), count, "queries")?;
        let read = |&handle: &u64| QUERIES.shared(handle);
        let queries = handles.iter().map(read).collect::<Result<Vec<_>, Failure>>()?;
        let mut state = SCENES.exclusive(scene.handle)?;
        let sets = queries.iter().map(|camera: &_| -> &Pvs { Camera::pvs(camera) });
        let done = state.scene.end_frame(sets)?;
        if let Some(out) = out {
            out.set(&casca_frame_report { size: 0, hidden: done.hidden, revealed: done.revealed });
        }
        Ok(())
    })
}
