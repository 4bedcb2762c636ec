//! Many short lists in one piece of memory.

/// Lists of numbers, by the number of the list.
pub(crate) struct Lists {
    /// Where each list starts; the last one is the end of all.
    starts: Vec<u32>,
    entries: Vec<u32>,
}

impl Lists {
    /// The lists of pairs of a list and an entry, which are passed over twice. Each list keeps
    /// their order.
    pub(crate) fn new(count: usize, pairs: impl Iterator<Item = (u32, u32)> + Clone) -> Self {
        // Two places later, so that writing the entries leaves the starts in their places.
        let mut starts = vec![0u32; count + 2];
        pairs.clone().for_each(|(list, _)| starts[list as usize + 2] += 1);
        for i in 2..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut entries = vec![0; starts[count + 1] as usize];
        for (list, entry) in pairs {
            let end = &mut starts[list as usize + 1];
            entries[*end as usize] = entry;
            *end += 1;
        }
        starts.pop();
        Self { starts, entries }
    }

    pub(crate) fn of(&self, list: u32) -> &[u32] {
        &self.entries[self.starts[list as usize] as usize..self.starts[list as usize + 1] as usize]
    }

    /// Number of entries of all lists.
    pub(crate) fn len(&self) -> usize {
        self.entries.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_keep_the_order_of_their_pairs() {
        let pairs = [(2, 7), (0, 1), (2, 3), (4, 9), (0, 1), (2, 5)];
        let lists = Lists::new(5, pairs.into_iter());
        let all: Vec<&[u32]> = (0..5).map(|i| lists.of(i)).collect();
        assert_eq!(all, [&[1, 1][..], &[], &[7, 3, 5], &[], &[9]]);
        assert_eq!((lists.len(), Lists::new(0, [].into_iter()).len()), (6, 0));
    }
}
