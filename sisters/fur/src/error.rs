//! Every error of the crate.

use glam::Vec3;

/// Why something was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A triangle list whose length is no multiple of three.
    #[error(
        "a triangle list has {vertices} vertices, which is no multiple of 3: give three for each triangle"
    )]
    Corners {
        /// The vertices given.
        vertices: usize,
    },
    /// No triangle.
    #[error("the mesh has no triangles: give at least one")]
    Empty,
    /// A list that does not fit another one.
    #[error("{what}: {found} given, {expected} needed, one for each vertex")]
    Count {
        /// The list.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length that it must have.
        expected: usize,
    },
    /// A vertex or a joint that does not exist.
    #[error("{what} {of} {does} {number} of {count}: numbers start at 0")]
    Missing {
        /// Triangle, vertex or channel.
        what: &'static str,
        /// Its number.
        of: usize,
        /// What it asks for: uses vertex, follows joint, moves joint.
        does: &'static str,
        /// The number that it asks for.
        number: usize,
        /// How many there are.
        count: usize,
    },
    /// A vertex that is not finite or too far away.
    #[error("vertex {vertex} has the {what} {value}: its components must be finite and at most {max}")]
    Vertex {
        /// The number of the vertex.
        vertex: usize,
        /// Position, normal or coat.
        what: &'static str,
        /// The value.
        value: Vec3,
        /// The greatest component allowed.
        max: f32,
    },
    /// More than memory or indices are planned for.
    #[error("{count:.0} {what}, more than {max}: simplify the mesh, or make the spacing of strands wider")]
    TooMany {
        /// Triangles or strands.
        what: &'static str,
        /// The number given or expected.
        count: f64,
        /// The most allowed.
        max: usize,
    },
    /// An open mesh where a closed one is needed.
    #[error(
        "the mesh is not closed: {edges} edges do not belong to exactly two triangles that run along them in opposite \
         directions. Close its holes, or give no occluder"
    )]
    Open {
        /// The edges at fault.
        edges: usize,
    },
    /// A number out of its range.
    #[error("{what} is {value}: it must be from {least} to {most}")]
    Range {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The least value allowed.
        least: f64,
        /// The greatest value allowed.
        most: f64,
    },
    /// A joint that hangs from one that does not come before it.
    #[error("joint {joint} hangs from joint {parent}: parents must come before their children")]
    Parent {
        /// The joint.
        joint: usize,
        /// Its parent.
        parent: usize,
    },
    /// Shares of joints that cannot be scaled to add up to 1.
    #[error(
        "vertex {vertex} follows its joints with the shares {shares:?}: none may be negative, not all may be zero"
    )]
    Shares {
        /// The vertex.
        vertex: usize,
        /// The shares.
        shares: [f32; 4],
    },
    /// A vertex that the mesh with the weights lacks.
    #[error("vertex {vertex} lies where the mesh with the weights has none: simplify that mesh only")]
    Stranger {
        /// The vertex.
        vertex: usize,
    },
    /// Keys of a track that are not in order or hold no value.
    #[error("key {key} of a track {why}")]
    Keys {
        /// The key.
        key: usize,
        /// The reason.
        why: &'static str,
    },
    /// casca refused bounds, an occluder or a scene.
    #[error("casca refused the {what}: {source}")]
    Scene {
        /// The object or the step.
        what: &'static str,
        /// Its reason.
        source: casca::Error,
    },
}

impl Error {
    /// A vertex that follows a joint that its skeleton lacks.
    pub(crate) fn follows(vertex: usize, joint: usize, joints: usize) -> Self {
        Self::Missing { what: "vertex", of: vertex, does: "follows joint", number: joint, count: joints }
    }
}

/// Refuses a number outside of its range; NaN is outside.
pub(crate) fn range(what: &'static str, value: f64, least: f64, most: f64) -> Result<(), Error> {
    if (least..=most).contains(&value) { Ok(()) } else { Err(Error::Range { what, value, least, most }) }
}
