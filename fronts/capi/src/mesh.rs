//! Prepared meshes and convex bodies.

use std::ffi::c_void;
use std::ops::ControlFlow;
use std::sync::Arc;

use casca::glam::Vec3;
use casca::{Convex, Facing, MeshOptions, TriMesh};

use crate::border::{self, OutSpan, give, give_struct, grows};
use crate::error::{Failure, call, casca_status};
use crate::handle::Registry;

pub(crate) static MESHES: Registry<Arc<TriMesh>> = Registry::new(3);
pub(crate) static SOLIDS: Registry<Arc<Convex>> = Registry::new(4);

/// A prepared mesh, shared by any number of objects of any scenes. {0} is none.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct casca_mesh {
    /// A number that only casca can read.
    pub handle: u64,
}

/// A convex body, shared by any number of objects of any scenes. {0} is none.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct casca_solid {
    /// A number that only casca can read.
    pub handle: u64,
}

/// casca_mesh_desc.flags: triangles hide from the side where their corners run counter-clockwise
/// only, as for renderers that leave out triangles seen from behind.
pub const CASCA_MESH_FRONT_ONLY: u32 = 1;
/// casca_mesh_desc.flags: the mesh is tested and hides nothing. It is prepared faster.
pub const CASCA_MESH_BOUNDS_ONLY: u32 = 2;
/// casca_mesh_desc.flags: the field tolerance is set.
pub const CASCA_MESH_TOLERANCE: u32 = 4;
/// casca_mesh_desc.flags: the field min_radius is set.
pub const CASCA_MESH_MIN_RADIUS: u32 = 8;

/// Told the share of a preparation that is done, from 0 to 1, on the thread that called. Returning
/// anything but 0 ends the preparation soon. It must return: no longjmp and no exception may leave
/// it, and it may call casca only for other handles.
pub type casca_progress = Option<unsafe extern "C" fn(share: f32, user: *mut c_void) -> i32>;

/// Triangles to prepare. Fill it by CASCA_INIT, then set positions and indices.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct casca_mesh_desc {
    /// sizeof(casca_mesh_desc).
    pub size: usize,
    /// The first position: three floats x, y, z. Read during the call only.
    pub positions: *const f32,
    /// How many positions there are.
    pub position_count: usize,
    /// Bytes from one position to the next, a multiple of 4; 0 for 12, which is without gaps.
    pub position_stride: usize,
    /// Three indices of positions for each triangle. Read during the call only.
    pub indices: *const u32,
    /// How many indices there are: a multiple of 3, up to 3 * 2^29.
    pub index_count: usize,
    /// 0, or some of CASCA_MESH_...
    pub flags: u32,
    /// With CASCA_MESH_TOLERANCE, how far outlines may be simplified, in world units; else a 2000th
    /// of the diagonal. More is faster and hides less near outlines.
    pub tolerance: f32,
    /// With CASCA_MESH_MIN_RADIUS, connected groups of triangles of a smaller radius hide nothing;
    /// else a 1000th of the diagonal.
    pub min_radius: f32,
    /// Told of the progress, or null.
    pub progress: casca_progress,
    /// Passed on to progress.
    pub user: *mut c_void,
}

/// What is known of a prepared mesh. Fill it by CASCA_INIT.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct casca_mesh_info {
    /// sizeof(casca_mesh_info).
    pub size: usize,
    /// How many triangles it has.
    pub triangles: usize,
    /// How many positions it has.
    pub positions: usize,
    /// The bytes that it takes on the heap.
    pub bytes: usize,
    /// 1 if every edge belongs to two triangles, so that it has an inside; else 0.
    pub is_closed: u32,
    /// 1 if it can hide others; else 0.
    pub occludes: u32,
    /// The least corner of the box around its triangles.
    pub min: [f32; 3],
    /// The greatest corner of that box.
    pub max: [f32; 3],
}

grows!(
    casca_mesh_desc: size_of::<casca_mesh_desc>(),
    casca_mesh_info: size_of::<casca_mesh_info>(),
);

fn points(numbers: &[[f32; 3]]) -> Vec<Vec3> {
    numbers.iter().map(|p| Vec3::from_array(*p)).collect()
}

fn options(desc: &casca_mesh_desc) -> Result<MeshOptions, Failure> {
    let known = CASCA_MESH_FRONT_ONLY | CASCA_MESH_BOUNDS_ONLY | CASCA_MESH_TOLERANCE | CASCA_MESH_MIN_RADIUS;
    crate::view::check_flags(desc.flags, known, "casca_mesh_desc.flags")?;
    let is = |flag| desc.flags & flag != 0;
    let facing = if is(CASCA_MESH_FRONT_ONLY) { Facing::Front } else { Facing::Both };
    let mut how = MeshOptions::default().facing(facing).occludes(!is(CASCA_MESH_BOUNDS_ONLY));
    if is(CASCA_MESH_TOLERANCE) {
        how = how.tolerance(desc.tolerance);
    }
    if is(CASCA_MESH_MIN_RADIUS) {
        how = how.min_radius(desc.min_radius);
    }
    Ok(how)
}

/// Prepares triangles, open or closed, of any winding. The mesh serves as bounds and occluder of
/// any number of objects.
///
/// Errors: an empty mesh, indices of positions that are not there, numbers that are not finite;
/// CASCA_ERROR_CANCELLED if progress ended it. Costs 0.2 to 4 microseconds a triangle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_mesh_create(
    desc: *const casca_mesh_desc,
    mesh: *mut casca_mesh,
) -> casca_status {
    give(mesh, "mesh", || {
        let desc = border::read(desc)?;
        let how = options(&desc)?;
        // Checked before memory is taken for them.
        const MOST: usize = 1 << 29;
        if desc.index_count / 3 > MOST {
            return Err(casca::Error::MeshTooLarge { triangles: desc.index_count / 3, max: MOST }.into());
        }
        if desc.index_count % 3 != 0 {
            return Err(Failure::argument(format!("{} indices make no triangles", desc.index_count)));
        }
        let (indices, count) = (desc.indices.cast::<[u32; 3]>(), desc.index_count / 3);
        let triangles = border::span(indices, count, "casca_mesh_desc.indices")?.to_vec();
        let (at, count, stride) = (desc.positions, desc.position_count, desc.position_stride);
        let positions = points(&border::positions(at, count, stride, "casca_mesh_desc.positions")?);
        let mut progress = |share| match desc.progress {
            Some(progress) if border::tell(progress, share, desc.user) != 0 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        let made = TriMesh::prepare(positions, triangles, &how, &mut progress)?;
        Ok(casca_mesh { handle: MESHES.add(Arc::new(made))? })
    })
}

/// Frees a mesh. Objects that consist of it keep it until they go.
#[unsafe(no_mangle)]
pub extern "C" fn casca_mesh_free(mesh: casca_mesh) -> casca_status {
    call(|| MESHES.take(mesh.handle).map(drop))
}

/// What is known of a mesh. Costs a few sums.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_mesh_get_info(mesh: casca_mesh, info: *mut casca_mesh_info) -> casca_status {
    give_struct(info, || {
        let mesh = MESHES.shared(mesh.handle)?;
        Ok(casca_mesh_info {
            size: 0,
            triangles: mesh.triangles().len(),
            positions: mesh.positions().len(),
            bytes: mesh.memory_bytes(),
            is_closed: mesh.is_closed().into(),
            occludes: mesh.occludes().into(),
            min: mesh.aabb().min.to_array(),
            max: mesh.aabb().max.to_array(),
        })
    })
}

/// Writes a prepared mesh as bytes for a file, to be loaded by this version of casca.
///
/// bytes has room for capacity bytes; count gets the number that is needed. Call it with capacity 0
/// first (bytes may be null then, the status is CASCA_ERROR_TOO_SMALL), or give enough.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_mesh_save(
    mesh: casca_mesh,
    bytes: *mut u8,
    capacity: usize,
    count: *mut usize,
) -> casca_status {
    call(|| {
        let out = OutSpan::new(bytes, capacity, count, "bytes")?;
        let mut written = Vec::new();
        let failed = |why: std::io::Error| Failure::argument(why.to_string());
        MESHES.shared(mesh.handle)?.write(&mut written).map_err(failed)?;
        out.set(&written)
    })
}

/// Loads a mesh from count bytes that casca_mesh_save wrote. Any bytes may be given: those that no
/// prepared mesh can have are refused as CASCA_ERROR_DAMAGED. A file made by hand could hide what
/// its triangles do not hide: prepare meshes of unknown origin yourself.
///
/// Costs a copy and a checksum: far less than preparing it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_mesh_load(
    bytes: *const u8,
    count: usize,
    mesh: *mut casca_mesh,
) -> casca_status {
    give(mesh, "mesh", || {
        let read = TriMesh::read(&mut border::span(bytes, count, "bytes")?)?;
        Ok(casca_mesh { handle: MESHES.add(Arc::new(read))? })
    })
}

/// A convex body inside the hull of count points of three floats, 4 to 64. Errors: points that are
/// not finite, or whose hull has no volume. Costs about count * count steps.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn casca_solid_create(
    points: *const f32,
    count: usize,
    solid: *mut casca_solid,
) -> casca_status {
    give(solid, "solid", || {
        let at = border::span(points.cast::<[f32; 3]>(), count, "points")?;
        let made = Convex::from_points(&self::points(at))?;
        Ok(casca_solid { handle: SOLIDS.add(Arc::new(made))? })
    })
}

/// Frees a convex body. Objects that it hides with keep it until they go.
#[unsafe(no_mangle)]
pub extern "C" fn casca_solid_free(solid: casca_solid) -> casca_status {
    call(|| SOLIDS.take(solid.handle).map(drop))
}
