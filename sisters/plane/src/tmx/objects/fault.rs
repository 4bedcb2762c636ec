//! What is amiss with objects.

/// Bytes that templates may give to the objects of a map, for each byte of the map: an object that
/// names a template takes some 60. Else 4,000 objects (100 kB) would copy 4 GB of one of 1 MB.
pub(super) const BYTES_FOR_A_BYTE: u64 = 32;

/// Bytes that templates may give to the objects of any map: 1 MiB.
pub(super) const BYTES_FOR_ALL: u64 = 1 << 20;

/// What is amiss with an object: see [`TmxWarning::Object`](crate::tmx::TmxWarning::Object). Texts
/// from the file are cut to 40 characters.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TmxFault {
    /// A number is none, is not finite, is negative where it must not be, or lies farther than 2^30
    /// tiles from the origin. The object is left out.
    #[error("{attribute}=\"{value}\" is no number that is read: it is left out")]
    Number {
        /// The attribute.
        attribute: &'static str,
        /// Its value.
        value: String,
    },
    /// A polygon of fewer than three points, or a polyline of fewer than two. The object is left
    /// out.
    #[error("{points} points make no such shape: it is left out")]
    FewPoints {
        /// How many points it has.
        points: usize,
    },
    /// A shape that is not known. The object is left out.
    #[error("the shape {0} is not known: it is left out")]
    UnknownShape(String),
    /// A tile that no tileset of the map has. The object is left out.
    #[error("no tileset has its tile {0}: it is left out")]
    UnknownTile(u32),
    /// The object is made of a template that is missing or damaged. The object is left out.
    #[error("the template {path} is not read: {why}: it is left out")]
    Template {
        /// The path as the map has it.
        path: String,
        /// The reason, cut to 200 characters.
        why: String,
    },
    /// Templates gave the objects before this one more than a MiB and 32 bytes for each of the map.
    /// The object is left out.
    #[error(
        "templates give the objects of the map more than {} bytes and {} for each of its own: it is left out",
        BYTES_FOR_ALL,
        BYTES_FOR_A_BYTE
    )]
    Copies,
    /// An object with a picture that a tileset draws on a tile: the editor makes none. It is left
    /// out.
    #[error("an object on a tile has a picture: it is left out")]
    Picture,
    /// A polygon whose sides cross or touch, or without area: it is a ring of walls.
    #[error("the sides of the polygon cross or touch: it is taken as a ring of walls")]
    Crossed,
    /// A polygon of more corners than are split ([`crate::MAX_SPLIT_CORNERS`]): it is a ring of
    /// walls.
    #[error("the polygon has {0} corners: it is taken as a ring of walls")]
    ManyCorners(usize),
    /// A rectangle or ellipse without width and height, or a point that should hide others: it is a
    /// point, which hides nothing.
    #[error("it has no size: it is a point, and hides nothing")]
    NoSize,
    /// A property that says whether objects hide, or are doors, is neither true nor false. It says
    /// nothing.
    #[error("the property {property}, of the type {kind}, is neither true nor false")]
    PropertyType {
        /// The name of the property.
        property: String,
        /// Its type: `string` if the file names none.
        kind: &'static str,
    },
    /// The value of a property is none of its type, or the type is not known. It is kept as a
    /// string.
    #[error("the property {property} has no value of its type {kind}: it is kept as a string")]
    PropertyValue {
        /// The name of the property.
        property: String,
        /// Its type.
        kind: String,
    },
    /// A property has classes in each other, deeper than 16: the inner ones are left out.
    #[error("the property {0} has classes in each other, deeper than 16: the inner ones are left out")]
    Deep(String),
}

impl TmxFault {
    /// A template that is not read.
    pub(crate) fn template(path: &str, why: &str) -> Self {
        Self::Template { path: shortened(path), why: why.chars().take(200).collect() }
    }
}

/// The begin of a text from the file.
pub(super) fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}
