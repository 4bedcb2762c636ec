//! Why calls are refused: every error says which argument is wrong, and why. Files have errors of
//! their own.

use std::fmt;

use glam::{DVec3, Quat, Vec3};

use crate::id::ObjectId;

/// Why a call was refused. The scene or query is left as it was.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number that must be finite is not.
    #[error("{what} must be finite, not {}", Components(*value))]
    NotFinite {
        /// The argument.
        what: &'static str,
        /// Its value, component by component where it is a vector; a number stands there three
        /// times.
        value: DVec3,
    },
    /// A box whose least corner lies beyond its greatest.
    #[error("{what} must not be inverted: the corner {min} must lie below the corner {max} on every axis")]
    InvertedBox {
        /// The argument.
        what: &'static str,
        /// Its least corner.
        min: Vec3,
        /// Its greatest corner.
        max: Vec3,
    },
    /// A rotation that is zero or not finite.
    #[error("{what} must have a rotation: the quaternion {rotation} is zero or not finite")]
    Rotation {
        /// The argument.
        what: &'static str,
        /// Its rotation.
        rotation: Quat,
    },
    /// A direction without length.
    #[error("{what} must not be zero")]
    NoDirection {
        /// The argument.
        what: &'static str,
    },
    /// Points or half-spaces that make no convex solid.
    #[error("the convex solid cannot be made: {0}")]
    Convex(&'static str),
    /// A length that must not be negative.
    #[error("{what} must not be negative: {}", Short(*value))]
    Negative {
        /// The argument.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The cell size is not a positive normal number.
    #[error("the cell size must be a positive normal number, but is {0}")]
    CellSize(f32),
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
    /// The key belongs to no object of this scene: it was removed, or the key comes from elsewhere.
    #[error("the key {0:#x} names no object of this scene: it was removed, or the key comes from elsewhere")]
    UnknownKey(u64),
    /// The scene holds as many objects as ids can name.
    #[error("the scene is full: it already holds {0} objects")]
    SceneFull(usize),
    /// A place that is too far from the origin of the world.
    #[error("{what} is too far from the origin of the world: {}", Components(*value))]
    TooFar {
        /// The argument.
        what: &'static str,
        /// Its value, in world units.
        value: DVec3,
    },
    /// The caller ended a preparation.
    #[error("the preparation of the mesh was cancelled")]
    Cancelled,
    /// A mesh without triangles.
    #[error("the mesh has no triangles")]
    EmptyMesh,
    /// A mesh with more triangles than their edges can be numbered.
    #[error("the mesh has {triangles} triangles, but may have {max} at most: cut it into several")]
    MeshTooLarge {
        /// How many there are.
        triangles: usize,
        /// How many there may be.
        max: usize,
    },
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
    #[error("the occluder is a mesh that was prepared as bounds only, with MeshOptions::occludes = false")]
    BoundsOnly,
    /// An object that may go unreported needs a promised greatest speed.
    #[error("an object that is only reported on expiry needs a greatest speed")]
    SpeedNeeded,
    /// A speed, or reports on expiry, for an object that does not move.
    #[error("a fixed object has no speed and no reports: describe it by ObjectDesc::dynamic")]
    FixedMoves,
    /// An occluder that sticks out of its bounds: it would hide more than the object does.
    #[error("the occluder sticks out of the box of its bounds by {} world units", Short(*by))]
    OccluderOutside {
        /// By how much along an axis, in world units.
        by: f64,
    },
    /// An update without occluder of an object that has one.
    #[error("{0} has an occluder: update it with the occluder, or take that away by Scene::set_occluder")]
    OccluderMissing(ObjectId),
    /// A mesh in world space, which an offset cannot move.
    #[error("{0} has a mesh in world space: what moves is an Instance of a mesh")]
    FixedMesh(ObjectId),
    /// An object whose shapes are where the application put them, and not at a transform.
    #[error(
        "{0} is not placed by a transform: describe it with ObjectDesc::placed, or by instances of meshes"
    )]
    NotPlaced(ObjectId),
    /// A sphere under a transform that does not scale all axes alike.
    #[error("{what} must be a sphere: the transform must scale all axes alike, with no shear")]
    SphereScale {
        /// The shape.
        what: &'static str,
    },
    /// An instance of a mesh in a description that has a transform of its own.
    #[error("{what} must have one transform: give the mesh, not an instance of it")]
    PlacedTwice {
        /// The shape.
        what: &'static str,
    },
    /// The matrix has no inverse, or does not describe a camera.
    #[error("the view-projection matrix is not a camera's: {0}")]
    Matrix(&'static str),
    /// The eye given is not that of the matrix: it may be an earlier frame's.
    #[error(
        "the eye {given} is not the matrix's, which is at {found}: it lies {off} world units beside a plane \
         through that eye, but single precision explains {allowed} at most"
    )]
    EyeMismatch {
        /// The eye given, in world units.
        given: DVec3,
        /// The eye of the matrix, in world units; NaN where the matrix hardly tells it.
        found: DVec3,
        /// The distance of the eye given from the planes on which x, y and w of clip space are zero
        /// and which meet in the matrix's eye: the greatest of the three, in world units.
        off: f64,
        /// The greatest distance that single precision explains, in world units.
        allowed: f64,
    },
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
    /// A view of parallel rays, which has no eye about which it could turn.
    #[error("a view of parallel rays cannot be opened for turns")]
    ParallelTurn,
    /// The result belongs to another scene.
    #[error("the PVS was computed on another scene")]
    ForeignPvs,
    /// A setting is out of its range.
    #[error("{what} must lie between {} and {}, not {}", Short(*min), Short(*max), Short(*value))]
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
    /// The stream is no prepared mesh.
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
    /// A section is longer than the rest of the contents.
    #[error("the {section} of the mesh need {needed} bytes, but {held} are left")]
    Section {
        /// The section.
        section: &'static str,
        /// How many bytes it needs.
        needed: u64,
        /// How many are left.
        held: u64,
    },
    /// An entry that no prepared mesh can have.
    #[error("entry {entry} of the {section} of the mesh {why}")]
    Entry {
        /// The section.
        section: &'static str,
        /// Index of the entry in it.
        entry: usize,
        /// The fault, as the end of a sentence about the entry.
        why: &'static str,
    },
    /// The contents are longer than their sections.
    #[error("{0} bytes follow the last section of the mesh")]
    Trailing(u64),
}

/// Gives each variant of an error its code; a list of them serves the test.
macro_rules! codes {
    ($error:ident, $list:ident, $($variant:ident => $code:literal,)+) => {
        impl $error {
            /// A short name of the reason in kebab-case, for logs, tables and other languages. It
            /// is stable: releases add codes, but neither change nor reuse one. No other error of
            /// this library has the same.
            ///
            /// ```
            /// assert_eq!(casca::Error::EmptyMesh.code(), "empty-mesh");
            /// assert_eq!(casca::FileError::Trailing(3).code(), "file-trailing");
            /// ```
            pub fn code(&self) -> &'static str {
                match self {
                    $(Self::$variant { .. } => $code,)+
                }
            }
        }

        #[cfg(test)]
        pub(super) const $list: &[&str] = &[$($code),+];
    };
}

codes!(
    Error,
    CODES,
    NotFinite => "not-finite",
    InvertedBox => "inverted-box",
    Rotation => "no-rotation",
    NoDirection => "no-direction",
    Convex => "convex",
    Negative => "negative",
    CellSize => "cell-size",
    GridTooFar => "grid-too-far",
    UnknownObject => "unknown-object",
    UnknownKey => "unknown-key",
    SceneFull => "scene-full",
    TooFar => "too-far",
    Cancelled => "cancelled",
    EmptyMesh => "empty-mesh",
    MeshTooLarge => "mesh-too-large",
    MeshIndex => "mesh-index",
    BoundsOnly => "bounds-only",
    SpeedNeeded => "speed-needed",
    FixedMoves => "fixed-moves",
    OccluderOutside => "occluder-outside",
    OccluderMissing => "occluder-missing",
    FixedMesh => "fixed-mesh",
    NotPlaced => "not-placed",
    SphereScale => "sphere-scale",
    PlacedTwice => "placed-twice",
    Matrix => "matrix",
    EyeMismatch => "eye-mismatch",
    Plane => "plane",
    TooManyPlanes => "too-many-planes",
    ParallelTurn => "parallel-turn",
    ForeignPvs => "foreign-pvs",
    Setting => "setting",
);

codes!(
    FileError,
    FILE_CODES,
    Read => "file-read",
    Magic => "file-magic",
    Version => "file-version",
    Truncated => "file-truncated",
    Checksum => "file-checksum",
    Section => "file-section",
    Entry => "file-entry",
    Trailing => "file-trailing",
);

/// A number as short as it can be told from its neighbours: most were given in single precision.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let single = self.0 as f32;
        if f64::from(single) == self.0 { single.fmt(f) } else { self.0.fmt(f) }
    }
}

/// A vector, or the number that all its components are.
struct Components(DVec3);

impl fmt::Display for Components {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.0.to_array();
        if x.to_bits() == y.to_bits() && y.to_bits() == z.to_bits() {
            Short(x).fmt(f)
        } else {
            write!(f, "[{}, {}, {}]", Short(x), Short(y), Short(z))
        }
    }
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn codes_are_distinct_and_in_kebab_case() {
        let all: Vec<&str> = CODES.iter().chain(FILE_CODES).copied().collect();
        assert_eq!(all.iter().collect::<BTreeSet<_>>().len(), all.len());
        for code in all {
            let words = || code.split('-');
            assert!(words().all(|w| !w.is_empty() && w.bytes().all(|b| b.is_ascii_lowercase())), "{code}");
        }
    }
}
