//! Shapes and descriptions of objects.

use casca::glam::{Quat, Vec3};
use casca::{Aabb, Bounds, Obb, ObjectDesc, Occluder, Sphere};

use crate::border::{self, grows, plain};
use crate::error::Failure;
use crate::mesh::{MESHES, SOLIDS, casca_mesh, casca_solid};
use crate::view::{self, CASCA_ROW_MAJOR};

/// casca_shape.kind: no shape. An object without an occluder hides nothing.
pub const CASCA_SHAPE_NONE: u32 = 0;
/// casca_shape.kind: a solid sphere. Give center and radius.
pub const CASCA_SHAPE_SPHERE: u32 = 1;
/// casca_shape.kind: a solid box along the axes. Give min and max.
pub const CASCA_SHAPE_BOX: u32 = 2;
/// casca_shape.kind: a solid box turned by a rotation. Give center, half and rotation.
pub const CASCA_SHAPE_TURNED_BOX: u32 = 3;
/// casca_shape.kind: a solid convex body, as occluder only. Give solid.
pub const CASCA_SHAPE_SOLID: u32 = 4;
/// casca_shape.kind: the triangles of a mesh. Give mesh.
pub const CASCA_SHAPE_MESH: u32 = 5;

/// A shape, in world units; of a placed object, in the units of the object's own space.
///
/// Fields that the kind does not ask for are not read.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct casca_shape {
    /// One of CASCA_SHAPE_...
    pub kind: u32,
    /// The radius of a sphere, not negative.
    pub radius: f32,
    /// The middle of a sphere or of a turned box.
    pub center: [f32; 3],
    /// The least corner of a box.
    pub min: [f32; 3],
    /// The greatest corner of a box.
    pub max: [f32; 3],
    /// Half the edges of a turned box, not negative.
    pub half: [f32; 3],
    /// The rotation of a turned box: a quaternion x, y, z, w of any length but 0.
    pub rotation: [f32; 4],
    /// The convex body.
    pub solid: casca_solid,
    /// The mesh. The object keeps it: the handle may be freed at any time.
    pub mesh: casca_mesh,
}

plain!(casca_shape);

/// casca_object.flags: the object moves.
pub const CASCA_MOVES: u32 = 2;
/// casca_object.flags: the object moves and keeps to max_speed.
pub const CASCA_HAS_MAX_SPEED: u32 = 4;
/// casca_object.flags: the object's motion is reported only where casca_scene_begin_frame asks for
/// it, and while it is seen. Needs CASCA_HAS_MAX_SPEED.
pub const CASCA_REPORTED_ON_EXPIRY: u32 = 8;
/// casca_object.flags: the shapes are in the object's own space, and transform leads to the world.
/// casca_scene_set_transform moves such an object.
pub const CASCA_PLACED: u32 = 16;

/// An object to add to a scene. Fill it by CASCA_INIT, then set bounds and what else you need.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct casca_object {
    /// sizeof(casca_object).
    pub size: usize,
    /// 0, or some of CASCA_MOVES, CASCA_HAS_MAX_SPEED, CASCA_REPORTED_ON_EXPIRY, CASCA_PLACED and
    /// CASCA_ROW_MAJOR.
    pub flags: u32,
    /// With CASCA_HAS_MAX_SPEED, the greatest speed of any point, in world units per second.
    pub max_speed: f32,
    /// Shown by the views that have a layer in common, a bit for each. 0 is all layers.
    pub layers: u64,
    /// A number of yours: an index into your tables, or a pointer. casca does nothing with it.
    pub user_data: u64,
    /// What is tested for visibility. All that you draw of the object must lie inside.
    pub bounds: casca_shape,
    /// What hides other objects: it must lie inside the solid parts that you draw.
    pub occluder: casca_shape,
    /// With CASCA_PLACED, the transform: 16 numbers, column by column unless CASCA_ROW_MAJOR is
    /// set. The last row is 0 0 0 1.
    pub transform: [f32; 16],
}

grows!(casca_object: size_of::<casca_object>(),);

impl casca_shape {
    fn sphere(&self) -> Sphere {
        Sphere::new(Vec3::from_array(self.center), self.radius)
    }

    fn aabb(&self) -> Aabb {
        Aabb::new(Vec3::from_array(self.min), Vec3::from_array(self.max))
    }

    fn obb(&self) -> Obb {
        let [center, half] = [self.center, self.half].map(Vec3::from_array);
        Obb::new(center, half, Quat::from_array(self.rotation))
    }

    /// The shape as bounds.
    pub(crate) fn bounds(&self) -> Result<Bounds, Failure> {
        match self.kind {
            CASCA_SHAPE_SPHERE => Ok(self.sphere().into()),
            CASCA_SHAPE_BOX => Ok(self.aabb().into()),
            CASCA_SHAPE_TURNED_BOX => Ok(self.obb().into()),
            CASCA_SHAPE_MESH => Ok(MESHES.shared(self.mesh.handle)?.clone().into()),
            CASCA_SHAPE_SOLID => Err(Failure::argument("a solid serves as occluder, not as bounds")),
            CASCA_SHAPE_NONE => Err(Failure::argument("the bounds must be a shape, but the kind is 0")),
            other => Err(Failure::unknown("casca_shape.kind", other)),
        }
    }

    /// The shape as an occluder; none if it is no shape.
    pub(crate) fn occluder(&self) -> Result<Option<Occluder>, Failure> {
        Ok(Some(match self.kind {
            CASCA_SHAPE_NONE => return Ok(None),
            CASCA_SHAPE_SPHERE => self.sphere().into(),
            CASCA_SHAPE_BOX => self.aabb().into(),
            CASCA_SHAPE_TURNED_BOX => self.obb().into(),
            CASCA_SHAPE_SOLID => SOLIDS.shared(self.solid.handle)?.clone().into(),
            CASCA_SHAPE_MESH => MESHES.shared(self.mesh.handle)?.clone().into(),
            other => return Err(Failure::unknown("casca_shape.kind", other)),
        }))
    }
}

/// Reads the description of an object.
pub(crate) fn read_object(object: *const casca_object) -> Result<ObjectDesc, Failure> {
    let object = border::read(object)?;
    let flags = object.flags;
    let known = CASCA_MOVES | CASCA_HAS_MAX_SPEED | CASCA_REPORTED_ON_EXPIRY | CASCA_PLACED | CASCA_ROW_MAJOR;
    view::check_flags(flags, known, "casca_object.flags")?;
    let is = |flag| flags & flag != 0;
    let bounds = object.bounds.bounds()?;
    let mut desc = if is(CASCA_MOVES) { ObjectDesc::dynamic(bounds) } else { ObjectDesc::fixed(bounds) };
    if let Some(occluder) = object.occluder.occluder()? {
        desc = desc.occluder(occluder);
    }
    if is(CASCA_HAS_MAX_SPEED) {
        desc = desc.max_speed(object.max_speed);
    }
    if is(CASCA_REPORTED_ON_EXPIRY) {
        desc = desc.reported_on_expiry();
    }
    if is(CASCA_PLACED) {
        desc = desc.placed(view::transform(object.transform, flags)?);
    }
    if object.layers != 0 {
        desc = desc.layers(object.layers);
    }
    Ok(desc.user_data(object.user_data))
}
