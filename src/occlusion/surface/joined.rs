//! The patches of a drawing, joined to components and put in order.

/// A patch in the order of drawing: farness of its component, the root of that, index of the patch.
pub(super) type DrawPlace = (u32, u32, u32);

/// The patches of a drawing by their indices.
#[derive(Debug, Clone, Default)]
pub(super) struct Joined {
    /// The index of another patch of the same component, or the patch's own.
    parents: Vec<u32>,
    /// No point of the patch is nearer; once they are in order, none of the component of a root.
    nears: Vec<f32>,
    /// For each patch by its number in the order of first drawing, the last drawing that saw it,
    /// and its index there.
    places: Vec<(u32, u32)>,
    /// Counts drawings.
    drawing: u32,
    /// Nearest components first, since they may hide the rest.
    pub(super) order: Vec<DrawPlace>,
}

impl Joined {
    /// Forgets the patches, for another drawing.
    pub(super) fn begin(&mut self) {
        self.drawing = self.drawing.wrapping_add(1);
        if self.drawing == 0 {
            self.forget_numbers();
            self.drawing = 1;
        }
        self.parents.clear();
        self.nears.clear();
    }

    /// Forgets all numbers: those of first drawing begin anew.
    pub(super) fn forget_numbers(&mut self) {
        self.places.clear();
    }

    /// Appends a patch by its number in the order of first drawing.
    #[inline]
    pub(super) fn push(&mut self, id: u32, near: f32) {
        debug_assert!(self.find(id).is_none(), "patches of a drawing share triangles");
        if self.places.len() <= id as usize {
            self.places.resize(id as usize + 1, (0, 0));
        }
        let index = self.parents.len() as u32;
        self.places[id as usize] = (self.drawing, index);
        self.parents.push(index);
        self.nears.push(near);
    }

    /// The index of a patch by its number in the order of first drawing.
    #[inline(always)]
    pub(super) fn find(&self, id: u32) -> Option<u32> {
        let &(drawing, index) = self.places.get(id as usize)?;
        (drawing == self.drawing).then_some(index)
    }

    /// The root of the component of a patch. Shortens the way for the next call.
    fn root(&mut self, mut i: u32) -> u32 {
        while self.parents[i as usize] != i {
            let up = self.parents[self.parents[i as usize] as usize];
            self.parents[i as usize] = up;
            i = up;
        }
        i
    }

    /// Makes one component of those of two patches.
    #[inline]
    pub(super) fn unite(&mut self, i: u32, k: u32) {
        if self.parents[i as usize] != self.parents[k as usize] {
            let (a, b) = (self.root(i), self.root(k));
            self.parents[a.max(b) as usize] = a.min(b);
        }
    }

    /// Puts the patches in order, by their indices.
    pub(super) fn sort(&mut self) {
        for i in 0..self.parents.len() {
            let root = self.root(i as u32);
            self.parents[i] = root;
            self.nears[root as usize] = self.nears[root as usize].max(self.nears[i]);
        }
        let all = self.parents.iter().enumerate();
        self.order.clear();
        self.order.extend(all.map(|(i, &root)| (farness(self.nears[root as usize]), root, i as u32)));
        self.order.sort_unstable();
    }
}

/// An integer that falls as nearness grows.
fn farness(near: f32) -> u32 {
    let bits = near.to_bits();
    if bits >> 31 == 0 { !bits & 0x7fff_ffff } else { bits }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_have_one_root() {
        let mut joined = Joined::default();
        joined.begin();
        (0..10).for_each(|i| joined.push(i * 2, 1.0));
        assert_eq!((joined.find(6), joined.find(7)), (Some(3), None));
        for (a, b) in [(9, 7), (7, 5), (2, 4), (5, 3), (4, 8)] {
            joined.unite(a, b);
        }
        let roots: Vec<u32> = (0..10).map(|i| joined.root(i)).collect();
        assert_eq!(roots, [0, 1, 2, 3, 2, 3, 6, 3, 2, 3]);
        joined.begin();
        assert_eq!(joined.find(6), None);
    }

    #[test]
    fn farness_falls_as_nearness_grows() {
        let nears = [f32::NEG_INFINITY, -3.0, -1e-9, 0.0, 1e-9, 0.5, 2.0, f32::INFINITY];
        assert!(nears.windows(2).all(|w| farness(w[0]) > farness(w[1])));
    }
}
