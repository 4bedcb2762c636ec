//! Scenes: making them, and the objects in them.

use std::sync::atomic::{AtomicU32, Ordering};

use casca::glam::Vec3;
use casca::{Aabb, ObjectId, Occluder, Scene, cell_for};

use crate::border::{self, Out, OutSpan, give, give_struct, grows};
use crate::error::{Failure, call, casca_status};
use crate::handle::Registry;
use crate::shape::{self, casca_object, casca_shape};

pub(crate) static SCENES: Registry<SceneState> = Registry::new(1);

/// Objects on a grid. {0} is none.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct casca_scene {
    /// A number that only casca can read.
    pub handle: u64,
}

/// The grid of a scene. It has no border. Fill it by CASCA_INIT, then set cell, or min, max and
/// objects.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct casca_grid {
    /// sizeof(casca_grid).
    pub size: usize,
    /// If cell is 0: the least corner of the region where most objects are, in world units.
    pub min: [f32; 3],
    /// If cell is 0: the greatest corner of it.
    pub max: [f32; 3],
    /// The edge of a cell in world units; 0 lets casca choose.
    pub cell: f32,
    /// If cell is 0: about how many objects there will be.
    pub objects: u32,
}

/// The memory that a scene takes, in bytes. Fill it by CASCA_INIT.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct casca_memory {
    /// sizeof(casca_memory).
    pub size: usize,
    /// Opaque cells.
    pub opacity: usize,
    /// The objects of each cell.
    pub ids: usize,
    /// Temporal bounding volumes.
    pub volumes: usize,
    /// Objects and lists of them.
    pub objects: usize,
    /// Meshes and convex bodies. One that several objects share counts once.
    pub shapes: usize,
    /// All of them together.
    pub total: usize,
}

grows!(
    casca_grid: size_of::<casca_grid>(),
    casca_memory: size_of::<casca_memory>(),
);

/// A scene, and what C asks of it later.
pub(crate) struct SceneState {
    pub(crate) scene: Scene,
    salt: u64,
    /// The objects that the present frame began with as due.
    pub(crate) due: Vec<u64>,
}

/// Numbers of scenes.
static NEXT: AtomicU32 = AtomicU32::new(0);

/// Bits that make the ids of a scene different from those of others.
///
/// An id is the key of an object in its scene (index in the low bits, generation in the high ones)
/// xor these. The reversed number of the scene differs in high bits from that of others, where the
/// generations and indices of real scenes have zeros, so that the ids of other scenes are refused.
/// Indices stay below 2^31: with that bit set, no id is 0.
pub(crate) fn salt() -> u64 {
    let number = NEXT.fetch_add(1, Ordering::Relaxed).reverse_bits();
    u64::from(number) << 32 | u64::from(number >> 1 | 1 << 31)
}

impl SceneState {
    /// The object that an id names.
    #[inline]
    pub(crate) fn find(&self, id: u64) -> Result<ObjectId, Failure> {
        self.scene.id_from_key(id ^ self.salt).map_err(|_| unknown(id))
    }

    /// The id of an object that is there.
    #[inline]
    pub(crate) fn id(&self, object: ObjectId) -> Option<u64> {
        self.scene.key(object).ok().map(|key| key ^ self.salt)
    }

    /// The ids of some objects; without those that are gone.
    pub(crate) fn ids(&self, objects: impl Iterator<Item = ObjectId>) -> impl Iterator<Item = u64> {
        objects.filter_map(|object| self.id(object))
    }
}

#[cold]
pub(crate) fn unknown(id: u64) -> Failure {
    let why = format!("{id:#x} is no object of this scene: it was removed, or belongs to another scene");
    Failure::new(casca_status::CASCA_ERROR_UNKNOWN_OBJECT, why)
}

/// Changes an object of a scene.
pub(crate) fn edit(
    scene: casca_scene,
    id: u64,
    change: impl FnOnce(&mut Scene, ObjectId) -> Result<(), casca::Error>,
) -> Result<(), Failure> {
    let mut state = SCENES.exclusive(scene.handle)?;
    let id = state.find(id)?;
    Ok(change(&mut state.scene, id)?)
}

/// An occluder that C gives; none if it is null or has no shape.
fn read_occluder(occluder: *const casca_shape) -> Result<Option<Occluder>, Failure> {
    if occluder.is_null() {
        return Ok(None);
    }
    border::array(occluder, "occluder")?.occluder()
}

/// Makes an empty scene on a grid. Free it by casca_scene_free.
///
/// Errors: cells that are not positive; where casca chooses them, a region that is inverted, not
/// finite or a point.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_create(
    grid: *const casca_grid,
    scene: *mut casca_scene,
) -> casca_status {
    give(scene, "scene", || {
        let grid = border::read(grid)?;
        let [min, max] = [grid.min, grid.max].map(Vec3::from_array);
        let region = Aabb::new(min, max);
        let cell = match grid.cell {
            0.0 => cell_for(region, grid.objects as usize)?,
            cell => cell,
        };
        let state = SceneState { scene: Scene::new(cell)?, salt: salt(), due: Vec::new() };
        Ok(casca_scene { handle: SCENES.add(state)? })
    })
}

/// Frees a scene with its objects. Its handle and ids are refused from then on, and never given
/// again. Queries that ran on it stay.
#[unsafe(no_mangle)]
pub extern "C" fn casca_scene_free(scene: casca_scene) -> casca_status {
    call(|| SCENES.take(scene.handle).map(drop))
}

/// Adds an object and writes its id, which is never 0 and never given again.
///
/// Errors: shapes that are not finite or inverted, occluders that stick out of their bounds (code
/// "occluder-outside"), a speed of an object that does not move. Costs the cells around its
/// surfaces.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_add(
    scene: casca_scene,
    object: *const casca_object,
    id: *mut u64,
) -> casca_status {
    give(id, "id", || {
        let object = shape::read_object(object)?;
        let mut state = SCENES.exclusive(scene.handle)?;
        let added = state.scene.insert(object)?;
        Ok(state.id(added).unwrap_or_default())
    })
}

/// Takes the memory for more objects now, before many are added.
#[unsafe(no_mangle)]
pub extern "C" fn casca_scene_reserve(scene: casca_scene, count: usize) -> casca_status {
    call(|| {
        let mut state = SCENES.exclusive(scene.handle)?;
        state.scene.reserve(count);
        Ok(())
    })
}

/// Removes an object. Costs the cells that it touches.
#[unsafe(no_mangle)]
pub extern "C" fn casca_scene_remove(scene: casca_scene, id: u64) -> casca_status {
    call(|| edit(scene, id, Scene::remove))
}

/// Removes all objects. The scene stays.
#[unsafe(no_mangle)]
pub extern "C" fn casca_scene_clear(scene: casca_scene) -> casca_status {
    call(|| {
        SCENES.exclusive(scene.handle)?.scene.clear();
        Ok(())
    })
}

/// Gives an object other bounds and another occluder, null for none that it had: all of it, in
/// world units. This is the report of an object that is reported on expiry.
///
/// Errors: as casca_scene_add, and a missing occluder of an object that has one (code
/// "occluder-missing"). Costs a comparison while a hidden object stays in its volume; else the
/// cells that it enters and leaves.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_update(
    scene: casca_scene,
    id: u64,
    bounds: *const casca_shape,
    occluder: *const casca_shape,
) -> casca_status {
    call(|| {
        let bounds = border::array(bounds, "bounds")?.bounds()?;
        let occluder = read_occluder(occluder)?;
        edit(scene, id, |scene, id| scene.update(id, bounds, occluder))
    })
}

/// Gives an object other bounds; its occluder stays. Those of a placed object are in its own space:
/// for skinned meshes, the box of the pose.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_set_bounds(
    scene: casca_scene,
    id: u64,
    bounds: *const casca_shape,
) -> casca_status {
    call(|| {
        let bounds = border::array(bounds, "bounds")?.bounds()?;
        edit(scene, id, |scene, id| scene.set_bounds(id, bounds))
    })
}

/// Gives an object another occluder in world units, or takes it away, if null. A placed object is
/// not placed any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_set_occluder(
    scene: casca_scene,
    id: u64,
    occluder: *const casca_shape,
) -> casca_status {
    call(|| {
        let occluder = read_occluder(occluder)?;
        edit(scene, id, |scene, id| scene.set_occluder(id, occluder))
    })
}

/// Puts an object on other layers, a bit for each. Here 0 is no layer: no view shows it.
#[unsafe(no_mangle)]
pub extern "C" fn casca_scene_set_layers(scene: casca_scene, id: u64, layers: u64) -> casca_status {
    call(|| edit(scene, id, |scene, id| scene.set_layers(id, layers)))
}

/// The layers of an object.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_get_layers(
    scene: casca_scene,
    id: u64,
    layers: *mut u64,
) -> casca_status {
    give(layers, "layers", || {
        let state = SCENES.shared(scene.handle)?;
        Ok(state.scene.layers(state.find(id)?)?)
    })
}

/// Gives an object another number of yours.
#[unsafe(no_mangle)]
pub extern "C" fn casca_scene_set_user_data(scene: casca_scene, id: u64, user_data: u64) -> casca_status {
    call(|| edit(scene, id, |scene, id| scene.set_user_data(id, user_data)))
}

/// Your numbers of count objects, in the order of their ids. Refused as a whole, with nothing
/// written, if one of them is no object of the scene. Costs a look-up for each.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_get_user_data(
    scene: casca_scene,
    ids: *const u64,
    count: usize,
    user_data: *mut u64,
) -> casca_status {
    call(|| {
        let out = border::OutList::new(user_data, count, "user_data")?;
        let ids = border::span(ids, count, "ids")?;
        let state = SCENES.shared(scene.handle)?;
        let of = |(i, &id): (usize, &u64)| {
            let found = state.find(id).map_err(|why| why.at(i))?;
            Ok(state.scene.user_data(found)?)
        };
        let found = ids.iter().enumerate().map(of).collect::<Result<Vec<u64>, Failure>>()?;
        out.set(found.into_iter());
        Ok(())
    })
}

/// Writes whether an id names an object of this scene. Costs a look-up.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_contains(
    scene: casca_scene,
    id: u64,
    answer: *mut bool,
) -> casca_status {
    give(answer, "answer", || Ok(SCENES.shared(scene.handle)?.find(id).is_ok()))
}

/// The box around the bounds of an object in world units, rounded outwards: three floats each.
/// Infinite where it ends beyond the range of a float.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_get_box(
    scene: casca_scene,
    id: u64,
    min: *mut f32,
    max: *mut f32,
) -> casca_status {
    call(|| {
        let [least, greatest] =
            [Out::new(min.cast::<[f32; 3]>(), "min")?, Out::new(max.cast::<[f32; 3]>(), "max")?];
        let state = SCENES.shared(scene.handle)?;
        let around = state.scene.bounds(state.find(id)?)?.aabb();
        least.set(around.min.to_array());
        greatest.set(around.max.to_array());
        Ok(())
    })
}

/// The ids of all objects, in no promised order. ids has room for capacity; count gets how many
/// there are, also when that is more (CASCA_ERROR_TOO_SMALL).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_get_ids(
    scene: casca_scene,
    ids: *mut u64,
    capacity: usize,
    count: *mut usize,
) -> casca_status {
    call(|| {
        let out = OutSpan::new(ids, capacity, count, "ids")?;
        let state = SCENES.shared(scene.handle)?;
        out.set(&state.ids(state.scene.ids()).collect::<Vec<u64>>())
    })
}

/// The memory that a scene takes. Costs a walk over all objects.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_scene_get_memory(
    scene: casca_scene,
    memory: *mut casca_memory,
) -> casca_status {
    give_struct(memory, || {
        let used = SCENES.shared(scene.handle)?.scene.memory();
        Ok(casca_memory {
            size: 0,
            opacity: used.opacity,
            ids: used.ids,
            volumes: used.tbvs,
            objects: used.objects,
            shapes: used.shapes,
            total: used.total(),
        })
    })
}
