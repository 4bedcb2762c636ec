//! What names a patch: its place in its surface, or its number in a scene.

/// The place of a patch among those of its surface.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub(crate) struct PatchIndex(u32);

impl PatchIndex {
    /// The patch that contains all others.
    pub(crate) const FIRST: Self = Self(0);

    /// No patch, or none that can be told.
    pub(crate) const NONE: Self = Self(u32::MAX);

    #[inline]
    pub(crate) const fn new(index: u32) -> Self {
        Self(index)
    }

    #[inline]
    pub(crate) const fn get(self) -> u32 {
        self.0
    }

    #[inline]
    pub(crate) const fn index(self) -> usize {
        self.0 as usize
    }

    /// The place after it.
    #[inline]
    pub(crate) const fn after(self) -> Self {
        Self(self.0 + 1)
    }

    /// How many places lie from this one up to before another, which is no lesser.
    #[inline]
    pub(crate) const fn up_to(self, end: Self) -> u32 {
        end.0 - self.0
    }
}

/// The number of a patch among all patches of a scene. Those of one surface follow each other.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub(crate) struct PatchNumber(u32);

impl PatchNumber {
    /// No patch: all numbers are smaller.
    pub(crate) const NONE: Self = Self(u32::MAX);

    #[inline]
    pub(crate) const fn new(number: u32) -> Self {
        Self(number)
    }

    #[inline]
    pub(crate) const fn get(self) -> u32 {
        self.0
    }

    #[inline]
    pub(crate) const fn index(self) -> usize {
        self.0 as usize
    }

    /// The number after it.
    #[inline]
    pub(crate) const fn after(self) -> Self {
        Self(self.0 + 1)
    }

    /// The number of a patch of the surface whose first patch has this number.
    #[inline]
    pub(crate) const fn of(self, patch: PatchIndex) -> Self {
        Self(self.0 + patch.0)
    }

    /// The number of the first patch of the surface in which this is the number of a patch.
    #[inline]
    pub(crate) const fn base(self, patch: PatchIndex) -> Self {
        Self(self.0 - patch.0)
    }
}
