//! Why entities hide nothing.

use std::fmt;

/// Makes the reasons: of those without numbers the text is the documentation, too.
macro_rules! reasons {
    ($($name:ident: $text:literal,)*) => {
        /// Why an entity hides nothing: [`CascaScene::why_not`](crate::CascaScene::why_not).
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[non_exhaustive]
        pub enum WhyNot {
            $(#[doc = concat!("Because ", $text, ".")] $name,)*
            /// Because it has no component of this name: Bevy does not draw it, or nobody knows where.
            Lacks(&'static str),
            /// Because it has a component of this name, with which nothing hides.
            Has(&'static str),
            /// Because it moves. If it stays where it is, it hides after so many frames.
            Moves(u32),
            /// Because its mesh has so many triangles: more than [`most_triangles`](crate::CascaSettings::most_triangles).
            Triangles(usize),
            /// Because casca refuses its mesh or its box.
            Refused(casca::Error),
        }

        impl fmt::Display for WhyNot {
            fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
                match self {
                    $(Self::$name => f.write_str($text),)*
                    Self::Lacks(component) => write!(f, "it has no {component}"),
                    Self::Has(component) => write!(f, "it has {component}"),
                    Self::Moves(frames) => write!(f, "it moves, and has to rest for {frames} frames"),
                    Self::Triangles(count) => write!(f, "its mesh has {count} triangles: too many"),
                    Self::Refused(error) => error.fmt(f),
                }
            }
        }
    };
}

reasons! {
    Off: "casca is switched off, or culls by frustum only",
    Disabled: "a component disables it",
    Invisible: "it is not visible",
    Layer: "it is on a render layer from 31 on",
    Flat: "its transform is flat or not finite",
    Mirrored: "it is mirrored, and only its fronts are drawn",
    InFront: "it is drawn before nearer things, or is not a mesh alone",
    NoRule: "there is no rule for its material",
    NoMaterial: "its material is not there",
    NotOpaque: "nothing says that it is opaque",
    Sides: "it has two materials that are drawn from different sides",
    Textures: "a texture of its material is not with the renderer",
    Deferred: "a camera does not draw its deferred material",
    NoMesh: "its mesh is not there",
    NotRendered: "its mesh is for the main world alone",
    Preparing: "its mesh is being prepared",
    Unreadable: "only the graphics processor has its mesh",
    NotTriangles: "its mesh is not a list of triangles",
    Positions: "the positions in its mesh cannot be read",
    OutOfBox: "its mesh reaches out of its Aabb",
    Waits: "it is taken over in one of the next frames",
}

impl From<casca::Error> for WhyNot {
    fn from(error: casca::Error) -> Self {
        Self::Refused(error)
    }
}
