//! What calls are refused with: every refusal says which argument and why. Files have reasons of their own.

use glam::{DVec3, Quat, UVec3, Vec3};

use crate::ObjectId;

/// Why a call was refused. The scene or query is left as it was.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number that must be finite is not.
    #[error("{what} must be finite, but is {value}")]
    NotFinite {
        /// The argument.
        what: &'static str,
        /// Its value, component by component where it is a vector.
        value: DVec3,
    },
    /// A box whose least corner lies beyond its greatest.
    #[error("{what} is inverted: min {min} is not below max {max} on every axis")]
    InvertedBox {
        /// The argument.
        what: &'static str,
        /// Its least corner.
        min: Vec3,
        /// Its greatest corner.
        max: Vec3,
    },
    /// A rotation that is zero or not finite.
    #[error("{what} has no rotation: the quaternion {rotation} is zero or not finite")]
    Rotation {
        /// The argument.
        what: &'static str,
        /// Its rotation.
        rotation: Quat,
    },
    /// A direction without length.
    #[error("{what} is zero")]
    NoDirection {
        /// The argument.
        what: &'static str,
    },
    /// Points or half-spaces that make no convex solid.
    #[error("the convex solid cannot be made: {0}")]
    Convex(&'static str),
    /// A length that must not be negative.
    #[error("{what} must not be negative, but is {value}")]
    Negative {
        /// The argument.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The cell size is not a positive normal number.
    #[error("the cell size must be a positive normal number, but is {0}")]
    CellSize(f32),
    /// The grid has no cells or too many.
    #[error("a grid needs 1 to {max} cells along each axis, but {dims} were asked for")]
    GridDims {
        /// What was asked for.
        dims: UVec3,
        /// The limit along each axis.
        max: u32,
    },
    /// The grid lies so far from the origin that its cells cannot be told apart.
    #[error(
        "a grid at {min} with cells of {cell} is too far from the origin: its planes are not exact numbers"
    )]
    GridTooFar {
        /// The least corner asked for.
        min: Vec3,
        /// The cell size asked for.
        cell: f32,
    },
    /// The id belongs to no object of this scene: it was removed, or comes
    /// from another scene.
    #[error("{0} is not an object of this scene: it was removed, or belongs to another scene")]
    UnknownObject(ObjectId),
    /// The scene holds as many objects as ids can name.
    #[error("the scene is full: it already holds {0} objects")]
    SceneFull(usize),
    /// A mesh without triangles.
    #[error("the mesh has no triangles")]
    EmptyMesh,
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but the mesh has {vertices}")]
    MeshIndex {
        /// Index of the triangle.
        triangle: usize,
        /// The vertex that it names.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// A mesh that hides nothing was given as an occluder.
    #[error("the occluder is a mesh that was prepared as bounds only, with Preparation::occludes = false")]
    BoundsOnly,
    /// An object that may go unreported needs a promised greatest speed.
    #[error("an object that is only reported on expiry needs a greatest speed")]
    SpeedNeeded,
    /// The matrix has no inverse, or does not describe a camera.
    #[error("the view-projection matrix is not a camera's: {0}")]
    Matrix(&'static str),
    /// A plane whose normal is zero or not finite.
    #[error("plane {0} has no direction: its normal is zero or not finite")]
    Plane(usize),
    /// Too many planes bound the view.
    #[error("a view is bounded by at most {max} planes, but {given} were given")]
    TooManyPlanes {
        /// How many were given.
        given: usize,
        /// How many there may be.
        max: usize,
    },
    /// The result belongs to another scene.
    #[error("the PVS was computed on another scene")]
    ForeignPvs,
    /// The aggressive opacity belongs to another scene.
    #[error("the aggressive opacity was computed on another scene")]
    ForeignOpacity,
    /// Only [`crate::Method::Cell`] has an aggressive form.
    #[error("aggressive queries need Method::Cell")]
    AggressiveMethod,
    /// A setting is out of its range.
    #[error("{what} must lie between {min} and {max}, but is {value}")]
    Setting {
        /// The setting.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The least value.
        min: f64,
        /// The greatest value.
        max: f64,
    },
}

/// Why a prepared mesh was not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The stream failed.
    #[error("the mesh cannot be read: {0}")]
    Read(#[from] std::io::Error),
    /// What is read is something else.
    #[error("this is no prepared mesh: it starts with the bytes {found:02x?}")]
    Magic {
        /// The first bytes, zeros where there are none.
        found: [u8; 8],
    },
    /// The file was written by another version of the library.
    #[error("the mesh is of version {found}, but only version {known} is read: prepare it again")]
    Version {
        /// The version of the file.
        found: u32,
        /// The version that is read.
        known: u32,
    },
    /// The stream ends too early.
    #[error("the mesh ends after {held} of {needed} bytes")]
    Truncated {
        /// How many there are.
        held: u64,
        /// How many there should be.
        needed: u64,
    },
    /// The contents are damaged.
    #[error("the mesh is damaged: its checksum is {computed:016x}, but should be {stored:016x}")]
    Checksum {
        /// The checksum in the file.
        stored: u64,
        /// That of the contents.
        computed: u64,
    },
    /// A section is longer than what is left of the contents.
    #[error("the {section} of the mesh need {needed} bytes, but {held} are left")]
    Section {
        /// The section.
        section: &'static str,
        /// How many bytes it needs.
        needed: u64,
        /// How many are left.
        held: u64,
    },
    /// An entry is not what a prepared mesh can hold.
    #[error("entry {entry} of the {section} of the mesh {why}")]
    Entry {
        /// The section.
        section: &'static str,
        /// Index of the entry in it.
        entry: usize,
        /// What is wrong with it.
        why: &'static str,
    },
    /// The contents are longer than their sections.
    #[error("{0} bytes follow the last section of the mesh")]
    Trailing(u64),
}

/// Refuses a vector with a component that is not finite.
pub(crate) fn finite3(what: &'static str, v: Vec3) -> Result<(), Error> {
    if v.is_finite() { Ok(()) } else { Err(Error::NotFinite { what, value: v.as_dvec3() }) }
}

/// Refuses a number that is not finite or negative.
pub(crate) fn not_negative(what: &'static str, v: f64) -> Result<(), Error> {
    if !v.is_finite() {
        Err(Error::NotFinite { what, value: DVec3::splat(v) })
    } else if v < 0.0 {
        Err(Error::Negative { what, value: v })
    } else {
        Ok(())
    }
}
