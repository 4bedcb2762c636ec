//! The plane: floor plans and objects in two dimensions.

use ::casca_plane::glam::Vec2;
use ::casca_plane::{
    ConvexPolygon, Disc, GridSpec, ObjectDesc, ObjectId, Polyline, Rect, Scene, Segment, Shape,
};

use crate::border::{self, give, grows, plain};
use crate::error::{Failure, call, casca_status};
use crate::handle::Registry;
use crate::scene::{salt, unknown};

pub(crate) static PLANES: Registry<PlaneState> = Registry::new(6);

/// Objects in the plane. {0} is none.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct casca_plane {
    /// A number that only casca can read.
    pub handle: u64,
}

/// casca_plane_shape.kind: no shape.
pub const CASCA_PLANE_NONE: u32 = 0;
/// casca_plane_shape.kind: a disc around a with a radius.
pub const CASCA_PLANE_DISC: u32 = 1;
/// casca_plane_shape.kind: a rectangle along the axes, from its least corner a to its greatest b.
pub const CASCA_PLANE_RECT: u32 = 2;
/// casca_plane_shape.kind: a wall without thickness from a to b.
pub const CASCA_PLANE_SEGMENT: u32 = 3;
/// casca_plane_shape.kind: the convex hull of points.
pub const CASCA_PLANE_POLYGON: u32 = 4;
/// casca_plane_shape.kind: walls without thickness from point to point.
pub const CASCA_PLANE_POLYLINE: u32 = 5;

/// A shape in the plane, in world units.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct casca_plane_shape {
    /// One of CASCA_PLANE_...
    pub kind: u32,
    /// Of a disc.
    pub radius: f32,
    /// The middle of a disc, the least corner of a rectangle, or the start of a segment.
    pub a: [f32; 2],
    /// The greatest corner of a rectangle, or the end of a segment.
    pub b: [f32; 2],
    /// Of polygons and polylines: two floats for each point. Read during the call only.
    pub points: *const f32,
    /// How many points there are.
    pub point_count: usize,
}

plain!(casca_plane_shape);

/// The grid of a scene in the plane. Fill it by CASCA_INIT.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct casca_plane_grid {
    /// sizeof(casca_plane_grid).
    pub size: usize,
    /// The least corner of the region where most objects are, in world units.
    pub min: [f32; 2],
    /// The greatest corner of it.
    pub max: [f32; 2],
    /// The edge of a cell in world units.
    pub cell: f32,
}

/// An object in the plane. Fill it by CASCA_INIT.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct casca_plane_object {
    /// sizeof(casca_plane_object).
    pub size: usize,
    /// A number of yours.
    pub user_data: u64,
    /// What is tested for visibility.
    pub bounds: casca_plane_shape,
    /// What hides other objects: it must lie inside the bounds.
    pub occluder: casca_plane_shape,
}

grows!(
    casca_plane_grid: size_of::<casca_plane_grid>(),
    casca_plane_object: size_of::<casca_plane_object>(),
);

/// A scene in the plane, with the ids of its objects in 64 bits.
pub(crate) struct PlaneState {
    pub(crate) scene: Scene,
    salt: u64,
    /// By index: the object there, and how many were there before.
    names: Vec<(Option<ObjectId>, u32)>,
}

impl PlaneState {
    /// Names a new object.
    fn name(&mut self, object: ObjectId) -> u64 {
        let index = object.index();
        if self.names.len() <= index {
            self.names.resize(index + 1, (None, 0));
        }
        let (living, before) = &mut self.names[index];
        *living = Some(object);
        (u64::from(*before) << 32 | index as u64) ^ self.salt
    }

    fn find(&self, id: u64) -> Result<ObjectId, Failure> {
        let key = id ^ self.salt;
        match self.names.get(key as u32 as usize) {
            Some(&(Some(object), before)) if before == (key >> 32) as u32 => Ok(object),
            _ => Err(unknown(id)),
        }
    }

    pub(crate) fn id(&self, object: ObjectId) -> Option<u64> {
        let &(living, before) = self.names.get(object.index())?;
        (living == Some(object)).then_some((u64::from(before) << 32 | object.index() as u64) ^ self.salt)
    }
}

impl casca_plane_shape {
    fn points(&self) -> Result<Vec<Vec2>, Failure> {
        let points = border::span(self.points.cast::<[f32; 2]>(), self.point_count, "points")?;
        Ok(points.iter().map(|p| Vec2::from_array(*p)).collect())
    }

    pub(crate) fn get(&self) -> Result<Option<Shape>, Failure> {
        let [a, b] = [self.a, self.b].map(Vec2::from_array);
        Ok(Some(match self.kind {
            CASCA_PLANE_NONE => return Ok(None),
            CASCA_PLANE_DISC => Disc::new(a, self.radius).into(),
            CASCA_PLANE_RECT => Rect::new(a, b).into(),
            CASCA_PLANE_SEGMENT => Segment::new(a, b).into(),
            CASCA_PLANE_POLYGON => ConvexPolygon::new(&self.points()?)?.into(),
            CASCA_PLANE_POLYLINE => Polyline::new(&self.points()?)?.into(),
            other => return Err(Failure::unknown("casca_plane_shape.kind", other)),
        }))
    }

    fn bounds(&self) -> Result<Shape, Failure> {
        self.get()?.ok_or_else(|| Failure::argument("the bounds must be a shape, but the kind is 0"))
    }
}

/// Makes an empty scene in the plane. Free it by casca_plane_free.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_plane_create(
    grid: *const casca_plane_grid,
    plane: *mut casca_plane,
) -> casca_status {
    give(plane, "plane", || {
        let grid = border::read(grid)?;
        let [min, max] = [grid.min, grid.max].map(Vec2::from_array);
        let scene = Scene::new(&GridSpec::covering(Rect::new(min, max), grid.cell)?)?;
        let state = PlaneState { scene, salt: salt(), names: Vec::new() };
        Ok(casca_plane { handle: PLANES.add(state)? })
    })
}

/// Frees a scene in the plane.
#[unsafe(no_mangle)]
pub extern "C" fn casca_plane_free(plane: casca_plane) -> casca_status {
    call(|| PLANES.take(plane.handle).map(drop))
}

/// Adds an object and writes its id, which is never 0 and never given again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_plane_add(
    plane: casca_plane,
    object: *const casca_plane_object,
    id: *mut u64,
) -> casca_status {
    give(id, "id", || {
        let object = border::read(object)?;
        let mut desc = ObjectDesc::new(object.bounds.bounds()?);
        if let Some(occluder) = object.occluder.get()? {
            desc = desc.occluder(occluder);
        }
        let mut state = PLANES.exclusive(plane.handle)?;
        let added = state.scene.insert(desc.user_data(object.user_data))?;
        Ok(state.name(added))
    })
}

/// Moves an object or changes its shape; occluder is null for an object that has none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_plane_update(
    plane: casca_plane,
    id: u64,
    bounds: *const casca_plane_shape,
    occluder: *const casca_plane_shape,
) -> casca_status {
    call(|| {
        let bounds = border::array(bounds, "bounds")?.bounds()?;
        let occluder = if occluder.is_null() { None } else { border::array(occluder, "occluder")?.get()? };
        let mut state = PLANES.exclusive(plane.handle)?;
        let id = state.find(id)?;
        Ok(state.scene.update(id, bounds, occluder)?)
    })
}

/// Removes an object.
#[unsafe(no_mangle)]
pub extern "C" fn casca_plane_remove(plane: casca_plane, id: u64) -> casca_status {
    call(|| {
        let mut state = PLANES.exclusive(plane.handle)?;
        let object = state.find(id)?;
        state.scene.remove(object)?;
        let (living, before) = &mut state.names[object.index()];
        // An index whose generations are used up is never given again.
        (*living, *before) = (None, before.saturating_add(1));
        Ok(())
    })
}

/// Your number of an object.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_plane_get_user_data(
    plane: casca_plane,
    id: u64,
    user_data: *mut u64,
) -> casca_status {
    give(user_data, "user_data", || {
        let state = PLANES.shared(plane.handle)?;
        Ok(state.scene.user_data(state.find(id)?)?)
    })
}
