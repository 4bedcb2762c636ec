//! Errors of sets of keys.

/// Why bytes are no set of keys ([`crate::KeySet`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum KeySetError {
    /// The bytes were written by another version of the library.
    #[error("the set is of version {found}, but only version {known} is read")]
    Version {
        /// The version of the bytes.
        found: u8,
        /// The version that is read.
        known: u8,
    },
    /// The second byte tells neither a whole set nor a difference.
    #[error("{0} is no kind of set: 0 is a whole one, 1 a difference")]
    Kind(u8),
    /// The bytes are those of a difference.
    #[error("these bytes are a difference to another set: apply them to that set")]
    NotWhole,
    /// The bytes end too early.
    #[error("the set ends too early, after {0} bytes")]
    Truncated(usize),
    /// More bytes follow the set.
    #[error("{0} bytes follow the set")]
    Trailing(usize),
    /// A number is too large.
    #[error("the number at byte {at} of the set is too large")]
    Number {
        /// Where it begins.
        at: usize,
    },
    /// The difference starts from another set than the one that it is applied to.
    #[error(
        "the difference starts from the set {base:08x}, but is applied to {own:08x}: ask for the whole set"
    )]
    Base {
        /// The digest of the set that the difference starts from.
        base: u32,
        /// The digest of the set that it is applied to.
        own: u32,
    },
    /// The difference takes away more objects than there are.
    #[error("the difference takes away objects beyond the {objects} of the set")]
    Place {
        /// How many objects the set has.
        objects: usize,
    },
    /// Two objects of the set have one index.
    #[error("two objects of the set have the index {index}")]
    Twice {
        /// The index.
        index: u32,
    },
    /// The contents are damaged.
    #[error("the set is damaged: its digest is {computed:08x}, but should be {stored:08x}")]
    Digest {
        /// The digest in the bytes.
        stored: u32,
        /// That of the set.
        computed: u32,
    },
}

codes!(
    KeySetError,
    KEY_SET_CODES,
    Version => "set-version",
    Kind => "set-kind",
    NotWhole => "set-not-whole",
    Truncated => "set-truncated",
    Trailing => "set-trailing",
    Number => "set-number",
    Base => "set-base",
    Place => "set-place",
    Twice => "set-twice",
    Digest => "set-digest",
);
