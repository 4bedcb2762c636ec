//! Edges, eight at a time.

use fearless_simd::f32x8;
use fearless_simd::prelude::*;

/// Edges that are set up together.
pub(crate) const LANES: usize = 8;

/// Eight numbers.
pub(crate) type Lanes = [f32; LANES];

/// Edges of an outline, in pixels. Those that are drawn lie within
/// [`FAR_PIXEL`](crate::numeric::occlusion::FAR_PIXEL) of the origin or of the area.
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

/// [`Edges`] as vectors.
#[derive(Clone, Copy)]
pub(crate) struct EdgeVectors<S: Simd> {
    pub(crate) x0: f32x8<S>,
    pub(crate) y0: f32x8<S>,
    pub(crate) x1: f32x8<S>,
    pub(crate) y1: f32x8<S>,
    pub(crate) wide: f32x8<S>,
    pub(crate) unsure: f32x8<S>,
    pub(crate) plain: u8,
    pub(crate) seams: u8,
}

impl Edges {
    /// These as vectors, in pixels that are finer by a factor.
    #[inline(always)]
    pub(crate) fn vectors<S: Simd>(&self, simd: S, by: f32) -> EdgeVectors<S> {
        let Self { plain, seams, .. } = *self;
        let all = [&self.x0, &self.y0, &self.x1, &self.y1, &self.wide, &self.unsure];
        let [x0, y0, x1, y1, wide, unsure] = all.map(|lanes| f32x8::from_slice(simd, lanes) * by);
        EdgeVectors { x0, y0, x1, y1, wide, unsure, plain, seams }
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
