//! Values for the patches of a scene.

use std::ops::Range;

use crate::mesh::surface::PatchNumber;

/// Patches in a page.
const PAGE: usize = 256;

/// A value for each patch of a scene, by its number. Memory is taken where values were set, so that
/// scenes may have hundreds of millions of patches.
#[derive(Debug, Clone, Default)]
pub(crate) struct ByPatch<T> {
    pages: Vec<Option<Box<[T; PAGE]>>>,
}

impl<T: Copy + Default> ByPatch<T> {
    /// Makes room for patches of lesser numbers than `count`.
    pub(crate) fn grow(&mut self, count: usize) {
        let pages = count.div_ceil(PAGE);
        if self.pages.len() < pages {
            self.pages.resize_with(pages, || None);
        }
    }

    /// Forgets all values.
    pub(crate) fn clear(&mut self) {
        self.pages.iter_mut().for_each(|page| *page = None);
    }

    /// The value of a patch, or the default one.
    #[inline]
    pub(crate) fn get(&self, number: PatchNumber) -> T {
        let page = self.pages.get(number.index() / PAGE).and_then(Option::as_ref);
        page.map_or_else(T::default, |page| page[number.index() % PAGE])
    }

    /// Sets the values of patches whose numbers follow each other, as far as there is room.
    #[inline]
    pub(crate) fn fill(&mut self, numbers: Range<PatchNumber>, value: T) {
        let (mut at, end) = (numbers.start.index(), numbers.end.index());
        while at < end {
            let first = at % PAGE;
            let count = (end - at).min(PAGE - first);
            if let Some(page) = self.pages.get_mut(at / PAGE) {
                page.get_or_insert_with(|| Box::new([T::default(); PAGE]))[first..first + count].fill(value);
            }
            at += count;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_kept_by_number() {
        let mut values: ByPatch<u32> = ByPatch::default();
        values.grow(1000);
        let range = |from, to| PatchNumber::new(from)..PatchNumber::new(to);
        let get = |values: &ByPatch<u32>, number| values.get(PatchNumber::new(number));
        values.fill(range(250, 600), 7);
        values.fill(range(300, 301), 8);
        let found = [0, 249, 250, 300, 301, 599, 600, 999, 5000].map(|n| get(&values, n));
        assert_eq!(found, [0, 0, 7, 8, 7, 7, 0, 0, 0]);
        // Beyond the room nothing is kept.
        values.fill(range(1020, 9000), 9);
        assert_eq!((get(&values, 1020), get(&values, 2000)), (9, 0));
        values.clear();
        assert_eq!(get(&values, 300), 0);
    }
}
