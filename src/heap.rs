//! The bytes that containers of the standard library take on the heap. Where these do not tell,
//! they are estimated.

/// The words before a value that an `Arc` shares: its two counts.
const COUNTS: usize = 2 * size_of::<usize>();
/// Entries of a node of a B-tree, and those that it has on average after many insertions.
const NODE: usize = 11;
const IN_NODE: usize = 8;
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

/// A B-tree of a number of entries of a type.
pub(crate) const fn in_tree<T>(entries: usize) -> usize {
    let leaf = NODE * size_of::<T>() + 2 * size_of::<usize>();
    let branch = leaf + (NODE + 1) * size_of::<usize>();
    let leaves = entries.div_ceil(IN_NODE);
    if leaves < 2 { leaves * leaf } else { leaves * leaf + leaves.div_ceil(IN_NODE) * (branch - leaf) }
}
