//! The bytes that containers of the standard library take on the heap. Where these do not tell,
//! they are estimated.

/// The words before a value that an `Arc` shares: its two counts.
const COUNTS: usize = 2 * size_of::<usize>();
/// Control bytes of a hash table beyond its last place.
const GROUP: usize = 16;

/// A value shared by an `Arc`.
pub(crate) const fn in_arc<T>() -> usize {
    COUNTS + size_of::<T>()
}

/// A hash table with room for a number of entries of a type: an eighth of its places stay free.
pub(crate) const fn in_table<T>(capacity: usize) -> usize {
    match capacity {
        0 => 0,
        1..=3 => 4 * (size_of::<T>() + 1) + GROUP,
        _ => (capacity * 8).div_ceil(7) * (size_of::<T>() + 1) + GROUP,
    }
}
