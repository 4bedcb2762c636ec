//! Views: cameras and other eyes, as plain structs.

use casca::View;
use casca::glam::{Affine3A, Mat4, Vec3, Vec4};
use casca::{Aabb, Plane};

use crate::border::{self, grows};
use crate::error::Failure;

/// casca_view.kind: a perspective camera whose eye is known. Give matrix and eye.
pub const CASCA_VIEW_PERSPECTIVE: u32 = 0;
/// casca_view.kind: an orthographic camera. Give matrix and forward.
pub const CASCA_VIEW_ORTHOGRAPHIC: u32 = 1;
/// casca_view.kind: a camera of which only the matrix is known. Sets are larger: give the eye where
/// you have it.
pub const CASCA_VIEW_MATRIX: u32 = 2;
/// casca_view.kind: all directions around an eye. Give eye.
pub const CASCA_VIEW_OMNIDIRECTIONAL: u32 = 3;
/// casca_view.kind: what lies inside some half-spaces around an eye. Give eye and planes.
pub const CASCA_VIEW_PLANES: u32 = 4;
/// casca_view.kind: all directions, for each eye in a box. Give eye, the least corner, and
/// cell_max, the greatest one.
pub const CASCA_VIEW_CELL: u32 = 5;

/// A flag of matrices: their 16 numbers are stored row by row; without it column by column, as in
/// OpenGL, Vulkan, glm, Godot and Unity. Vectors are columns in any case: clip = matrix * point.
/// Libraries that multiply rows by matrices (point * matrix) and store them row by row, as
/// DirectXMath and Unreal do, have the same numbers in the same places: leave the flag out.
pub const CASCA_ROW_MAJOR: u32 = 1;
/// A flag of view matrices: depth runs from -1 to 1, as in OpenGL. Without it from 0 to 1, as in
/// Vulkan, Direct3D, Metal and WebGPU. Reversed depth and infinite far planes need no flag.
pub const CASCA_DEPTH_MINUS_ONE: u32 = 2;

/// What can be looked at, and from where. Fill it by CASCA_INIT, then set the kind and its fields.
///
/// Units are those of the world. A view is copied by the call that takes it, and can be used again.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct casca_view {
    /// sizeof(casca_view).
    pub size: usize,
    /// One of CASCA_VIEW_...; 0 is CASCA_VIEW_PERSPECTIVE.
    pub kind: u32,
    /// 0, or some of CASCA_ROW_MAJOR and CASCA_DEPTH_MINUS_ONE.
    pub flags: u32,
    /// From world space to clip space: projection * view. It must be the matrix that you draw with.
    pub matrix: [f32; 16],
    /// The eye in world units. It must be the one of the matrix, not that of an earlier frame: the
    /// call is refused if the two differ by more than rounding (code "eye-mismatch").
    pub eye: [f32; 3],
    /// Of an orthographic camera, the direction in which it looks, of any length.
    pub forward: [f32; 3],
    /// Of CASCA_VIEW_CELL, the greatest corner of the box of eyes.
    pub cell_max: [f32; 3],
    /// How far the eye may go from its place, in world units: the result holds for all eyes there.
    /// 0 for CASCA_VIEW_CELL.
    pub reach: f32,
    /// By how much the camera may turn, in radians: the result holds for all such cameras.
    pub turn: f32,
    /// Of CASCA_VIEW_PLANES, plane_count planes of four numbers x, y, z, w: inside is where
    /// x * px + y * py + z * pz + w >= 0. They are read during the call only.
    pub planes: *const f32,
    /// How many planes there are, up to 32.
    pub plane_count: usize,
    /// The layers that are shown, a bit for each. 0 shows all.
    pub layers: u64,
}

grows!(casca_view: size_of::<casca_view>(),);

/// A matrix in column vectors.
pub(crate) fn matrix(numbers: [f32; 16], flags: u32) -> Mat4 {
    let stored = Mat4::from_cols_array(&numbers);
    if flags & CASCA_ROW_MAJOR == 0 { stored } else { stored.transpose() }
}

/// Refuses flags that are not among the known ones.
pub(crate) fn check_flags(flags: u32, known: u32, what: &str) -> Result<(), Failure> {
    if flags & !known == 0 {
        return Ok(());
    }
    Err(Failure::argument(format!("{what} has the unknown flags {:#x}", flags & !known)))
}

/// A transform from the space of an object to the world.
pub(crate) fn transform(numbers: [f32; 16], flags: u32) -> Result<Affine3A, Failure> {
    let matrix = matrix(numbers, flags);
    if matrix.row(3) != Vec4::W {
        let row = matrix.row(3);
        return Err(Failure::argument(format!(
            "the last row of a transform must be 0 0 0 1, not {row}: is CASCA_ROW_MAJOR missing, or too much?"
        )));
    }
    Ok(Affine3A::from_mat4(matrix))
}

impl casca_view {
    /// The view that it describes.
    pub(crate) fn get(&self) -> Result<View, Failure> {
        check_flags(self.flags, CASCA_ROW_MAJOR | CASCA_DEPTH_MINUS_ONE, "casca_view.flags")?;
        let gl = self.flags & CASCA_DEPTH_MINUS_ONE != 0;
        let (eye, matrix) = (Vec3::from_array(self.eye), matrix(self.matrix, self.flags));
        let view = match self.kind {
            CASCA_VIEW_PERSPECTIVE if gl => View::perspective_gl(eye, matrix)?,
            CASCA_VIEW_PERSPECTIVE => View::perspective(eye, matrix)?,
            CASCA_VIEW_ORTHOGRAPHIC => {
                // Halving is exact, so that the row is rounded once.
                let depth = |m: Mat4| {
                    Mat4::from_cols_array(&std::array::from_fn(|i| match (m.to_cols_array(), i % 4) {
                        (m, 2) => 0.5 * (m[i] + m[i + 1]),
                        (m, _) => m[i],
                    }))
                };
                View::orthographic(Vec3::from_array(self.forward), if gl { depth(matrix) } else { matrix })?
            }
            CASCA_VIEW_MATRIX if gl => View::from_view_projection_gl(matrix)?,
            CASCA_VIEW_MATRIX => View::from_view_projection(matrix)?,
            CASCA_VIEW_OMNIDIRECTIONAL => View::omnidirectional(eye)?,
            CASCA_VIEW_PLANES => View::from_planes(eye, &self.half_spaces()?)?,
            CASCA_VIEW_CELL => View::of_cell(Aabb::new(eye, Vec3::from_array(self.cell_max)))?,
            other => return Err(Failure::unknown("casca_view.kind", other)),
        };
        // A reach would take the place of the box.
        let view = match self.kind {
            CASCA_VIEW_CELL if self.reach == 0.0 => view,
            CASCA_VIEW_CELL => {
                return Err(Failure::argument("a CASCA_VIEW_CELL has no reach: make its box larger"));
            }
            _ => view.with_reach(self.reach)?,
        };
        let view = view.with_turn(self.turn)?;
        Ok(if self.layers == 0 { view } else { view.with_layers(self.layers) })
    }

    fn half_spaces(&self) -> Result<Vec<Plane>, Failure> {
        let planes = self.planes.cast::<[f32; 4]>();
        if self.plane_count > casca::MAX_PLANES {
            let (given, max) = (self.plane_count, casca::MAX_PLANES);
            return Err(casca::Error::TooManyPlanes { given, max }.into());
        }
        let planes = border::span(planes, self.plane_count, "casca_view.planes")?;
        let plane = |&[x, y, z, offset]: &[f32; 4]| Plane { normal: Vec3::new(x, y, z), offset };
        Ok(planes.iter().map(plane).collect())
    }
}

/// Reads a view of the caller's.
pub(crate) fn read(view: *const casca_view) -> Result<View, Failure> {
    border::read(view)?.get()
}
