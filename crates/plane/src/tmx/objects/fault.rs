//! What is amiss with objects.

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
    /// The object is made of a template, which is not read. The object is left out.
    #[error("the template {0} is not read: it is left out")]
    Template(String),
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
    /// The property that says that objects hide, or that they are doors, is not of the type `bool`.
    /// It says nothing.
    #[error("the property {property} is of the type {kind}, not bool")]
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

/// The begin of a text from the file.
pub(super) fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}
