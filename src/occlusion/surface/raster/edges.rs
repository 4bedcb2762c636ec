//! Edges, eight at a time.

/// Edges that are set up together.
pub(crate) const LANES: usize = 8;

/// Eight numbers.
pub(crate) type Lanes = [f32; LANES];

/// Edges of an outline, in pixels. No coordinate of those that are drawn is greater than
/// [`FAR_PIXEL`](crate::numeric::occlusion::FAR_PIXEL).
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Edges {
    pub(crate) x0: Lanes,
    pub(crate) y0: Lanes,
    pub(crate) x1: Lanes,
    pub(crate) y1: Lanes,
    /// How far the outline may be from each edge.
    pub(crate) wide: Lanes,
    /// How far an edge may be from where its ends say, for rounding alone. At most half of `wide`.
    pub(crate) unsure: Lanes,
    /// The edges to be drawn, one bit each.
    pub(crate) plain: u8,
    /// Those that are shared by two patches which are drawn together.
    pub(crate) seams: u8,
}

impl Edges {
    /// Sets an edge to one of others; `seam` tells whether it is shared.
    #[inline(always)]
    pub(crate) fn take(&mut self, at: usize, from: &Self, lane: usize, seam: bool) {
        self.x0[at] = from.x0[lane];
        self.y0[at] = from.y0[lane];
        self.x1[at] = from.x1[lane];
        self.y1[at] = from.y1[lane];
        self.wide[at] = from.wide[lane];
        self.unsure[at] = from.unsure[lane];
        self.plain |= 1 << at;
        self.seams |= u8::from(seam) << at;
    }
}

/// A value for each lane. The compiler makes vectors of it where all that `f` does is arithmetic.
#[inline(always)]
pub(crate) fn each<T: Copy + Default>(mut f: impl FnMut(usize) -> T) -> [T; LANES] {
    let mut lanes = [T::default(); LANES];
    for (i, lane) in lanes.iter_mut().enumerate() {
        *lane = f(i);
    }
    lanes
}
