//! Names of clients and entities.

use std::fmt;

use casca_slots::{Id, Slot};

macro_rules! id {
    ($name:ident, $what:literal, $doc:literal) => {
        #[doc = $doc]
        ///
        /// It is never given twice, and no other server knows it.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub(crate) Id);

        impl $name {
            /// 64 bits that no other one of the same server ever has: for the wire.
            pub fn key(self) -> u64 {
                u64::from(self.0.generation()) << 32 | u64::from(self.0.slot().get())
            }

            pub(crate) fn slot(self) -> Slot {
                self.0.slot()
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
                write!(f, concat!($what, " {:#x}"), self.key())
            }
        }
    };
}

id!(ClientId, "client", "Names a client of a server.");
id!(EntityId, "entity", "Names an entity of a server.");
