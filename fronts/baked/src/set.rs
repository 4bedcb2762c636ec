//! Sets of objects, as they stand in a file.

use crate::DEPTH;
use crate::numbers::take;

/// The objects that can be seen from a cell.
#[derive(Debug, Clone, Copy)]
pub struct Set<'a> {
    /// Lists of differences: an object is in the set if it is in an odd number of them.
    lists: [&'a [u8]; DEPTH],
}

impl<'a> Set<'a> {
    pub(crate) fn new(lists: [&'a [u8]; DEPTH]) -> Self {
        Self { lists }
    }

    /// The objects, ascending. Costs a few bytes for each, and for each in which the set differs
    /// from sets of other cells that it is stored by.
    pub fn iter(&self) -> Objects<'a> {
        Objects { lists: self.lists.map(List::new) }
    }

    /// Whether an object is in it. Costs a look at the objects before it.
    pub fn contains(&self, object: u32) -> bool {
        self.iter().take_while(|seen| *seen <= object).any(|seen| seen == object)
    }
}

impl<'a> IntoIterator for Set<'a> {
    type Item = u32;
    type IntoIter = Objects<'a>;

    fn into_iter(self) -> Objects<'a> {
        self.iter()
    }
}

/// The objects of a [`Set`], ascending.
#[derive(Debug, Clone)]
pub struct Objects<'a> {
    lists: [List<'a>; DEPTH],
}

impl Iterator for Objects<'_> {
    type Item = u32;

    fn next(&mut self) -> Option<u32> {
        loop {
            let least = self.lists.iter().map(|list| list.next).min().filter(|least| *least != END)?;
            let mut odd = false;
            for list in self.lists.iter_mut().filter(|list| list.next == least) {
                list.step();
                odd = !odd;
            }
            if odd {
                return Some(least as u32);
            }
        }
    }
}

/// More than any object: a list that has ended.
const END: u64 = u64::MAX;

/// An ascending list of objects.
#[derive(Debug, Clone, Copy)]
pub(crate) struct List<'a> {
    bytes: &'a [u8],
    /// The next object, or [`END`].
    pub(crate) next: u64,
}

impl<'a> List<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        let mut list = Self { bytes, next: END };
        // The first distance is counted from -1.
        list.next = list.after(None);
        list
    }

    fn after(&mut self, last: Option<u64>) -> u64 {
        // Bytes that are no number end it.
        match take(&mut self.bytes) {
            Some(gap) => last.map_or(0, |last| last + 1) + u64::from(gap),
            None => END,
        }
    }

    #[inline]
    pub(crate) fn step(&mut self) {
        self.next = self.after(Some(self.next));
    }

    /// Whether all bytes were numbers.
    pub(crate) fn is_at_end(&self) -> bool {
        self.bytes.is_empty() && self.next == END
    }
}
