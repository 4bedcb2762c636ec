//! Values for the patches of a scene.

use std::ops::Range;

/// Patches in a page.
const PAGE: usize = 256;

/// A value for each patch of a scene, by its number. Memory is taken where values were set, so that scenes may have
/// hundreds of millions of patches.
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
    pub(crate) fn get(&self, number: u32) -> T {
        let page = self.pages.get(number as usize / PAGE).and_then(Option::as_ref);
        page.map_or_else(T::default, |page| page[number as usize % PAGE])
    }

    /// Sets the values of patches whose numbers follow each other, as far as there is room.
    #[inline]
    pub(crate) fn fill(&mut self, numbers: Range<u32>, value: T) {
        let (mut at, end) = (numbers.start as usize, numbers.end as usize);
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
        values.fill(250..600, 7);
        values.fill(300..301, 8);
        let found = [0, 249, 250, 300, 301, 599, 600, 999, 5000].map(|n| values.get(n));
        assert_eq!(found, [0, 0, 7, 8, 7, 7, 0, 0, 0]);
        // Beyond the room nothing is kept.
        values.fill(1020..9000, 9);
        assert_eq!((values.get(1020), values.get(2000)), (9, 0));
        values.clear();
        assert_eq!(values.get(300), 0);
    }
}
