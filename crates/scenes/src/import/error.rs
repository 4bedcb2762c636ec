//! Why files are refused.

use std::path::PathBuf;

/// Why a file was refused.
#[derive(Debug, thiserror::Error)]
#[error("{}: {why}", path.display())]
pub struct ImportError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub why: Trouble,
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Trouble {
    /// It cannot be read.
    #[error("cannot be read: {0}")]
    Read(#[from] std::io::Error),
    /// It is no glTF 2.0, or breaks its rules: at which place, and how.
    #[error("is not a valid glTF 2.0 file: {0}")]
    Format(String),
    /// It is of another version of glTF.
    #[error("is glTF, but version {0} is not read; export it as glTF 2.0")]
    Version(String),
    /// A buffer that it names cannot be had.
    #[error("buffer {buffer} cannot be read: {why}")]
    Buffer {
        /// Index of the buffer.
        buffer: usize,
        /// Why.
        why: String,
    },
    /// A buffer is shorter than the file says.
    #[error("buffer {buffer} has {held} bytes, but {needed} are needed")]
    ShortBuffer {
        /// Index of the buffer.
        buffer: usize,
        /// Bytes there.
        held: usize,
        /// Bytes needed.
        needed: usize,
    },
    /// An accessor has a form that is not read.
    #[error("accessor {accessor} ({what}) is {why}")]
    Accessor {
        /// Index of the accessor.
        accessor: usize,
        /// What it holds.
        what: &'static str,
        /// What is not read about it.
        why: &'static str,
    },
    /// It requires extensions that are not read.
    #[error("requires extensions that are not read: {0}")]
    Extensions(String),
    /// What Draco packs cannot be had: of which primitive, and why.
    #[error("{0}; export it anew, or without compression")]
    Packed(String),
    /// The corners of a primitive make no whole triangles.
    #[error("primitive {primitive} of mesh {mesh} has {corners} corners, which make no whole triangles")]
    Corners {
        /// Index of the mesh.
        mesh: usize,
        /// Index of the primitive in the mesh.
        primitive: usize,
        /// How many corners there are.
        corners: usize,
    },
    /// A mesh has more vertices than can be numbered.
    #[error("mesh {0} has too many vertices")]
    TooManyVertices(usize),
    /// A triangle names a vertex that does not exist.
    #[error("mesh {mesh} names vertex {vertex} of {vertices}")]
    Vertex {
        /// Index of the mesh.
        mesh: usize,
        /// The vertex.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// A coordinate or transform is not finite.
    #[error("{0} is not finite")]
    NotFinite(String),
    /// A node breaks the rules, or is of a kind that is not read.
    #[error("node {node} ({name:?}) {why}")]
    Node {
        /// Index of the node.
        node: usize,
        /// Its name; may be empty.
        name: String,
        /// What is wrong with it.
        why: String,
    },
    /// Nodes are their own ancestors, or have two parents.
    #[error("node {0} is reached twice: nodes must form trees")]
    NotATree(usize),
    /// An image is damaged, too large or one too many.
    #[error("image {image} {why}")]
    Image {
        /// Index of the image.
        image: usize,
        /// What is wrong with it.
        why: String,
    },
    /// There is no material of this name.
    #[error("has no material {name:?}; there are: {known}")]
    Material {
        /// The name asked for.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// Coats, a skeleton, its weights or its clips are refused.
    #[error("has fur or a skin that is refused: {0}")]
    Skin(Box<dyn std::error::Error + Send + Sync>),
    /// There is nothing to show.
    #[error("holds no triangles in any node")]
    NoTriangles,
}
