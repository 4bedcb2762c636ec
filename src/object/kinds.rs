//! Dispatch from bounds and occluders to the kinds of shapes.

/// Implements an enum of shapes by asking its variants, each of which is a
/// [`Kind`](crate::shape::kind::Kind), or an `Arc` or a `Box` of one. A new kind of shape is one more
/// name in the list.
macro_rules! kinds {
    ($name:ident: $($variant:ident($kind:ty)),+ $(,)?) => {
        impl $name {
            /// The shape, to ask whatever depends on its kind.
            pub(crate) fn kind(&self) -> &dyn Kind {
                match self {
                    $(Self::$variant(s) => s.as_kind(),)+
                }
            }

            /// Whether both are the same shape at the same place.
            pub(crate) fn same(&self, other: &Self) -> bool {
                match (self, other) {
                    $((Self::$variant(a), Self::$variant(b)) => a.same(b),)+
                    _ => false,
                }
            }

            /// The shape moved by an offset in world units; `None` if it stays where it is.
            pub(crate) fn moved(&self, offset: Vec3) -> Result<Option<Self>, Error> {
                match self {
                    $(Self::$variant(s) => Ok(s.moved(offset)?.map(|s| Self::$variant(s.into()))),)+
                }
            }

            /// Tells the parts of it that several objects may share: the place of each in memory,
            /// and its bytes.
            pub(crate) fn shared(&self, out: &mut dyn FnMut(*const u8, usize)) {
                self.kind().shared(out);
            }

            /// A box around the shape.
            pub(crate) fn block(&self) -> Block {
                self.kind().block()
            }
        }

        $(impl From<$kind> for $name {
            fn from(shape: $kind) -> Self {
                Self::$variant(shape)
            }
        })+
    };
}

pub(crate) use kinds;
