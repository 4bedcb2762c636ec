//! The methods of a query.

/// How a query decides which objects can be seen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Method {
    /// The objects that lie in the view, hidden or not. Costs all objects of the scene.
    Sector,
    /// The objects that can be seen from anywhere in the grid cell of the view's eye: for every eye
    /// in that cell that is inside no occluder, each object of which that eye sees a point inside
    /// the view. Eyes of the cell inside another solid do not count. The view stays where it is; it
    /// bounds the objects that are seen, and need not hold the other eyes.
    ///
    /// Only cells that lie wholly inside solids hide, in one or in several together: up to 12
    /// rectangles (those of tiles among them) and convex polygons of up to 12 sides that do not
    /// leave the grid. Walls without thickness hide nothing. Where the eye is inside a solid
    /// occluder, nothing is hidden. Costs the cells in sight, 64 at a time (thesis, section 3.3).
    /// [`crate::Query::set_cell_options`] sets the options.
    Cell,
    /// The objects that can be seen from the eye: all of them, and no others.
    ///
    /// Occluders are closed sets. A point is visible if it lies in the closure of the set of points
    /// that a set of directions of positive angle reaches. So
    /// - rays that only graze do not count, and two walls that touch in a point let nothing
    ///   through;
    /// - the border of the visible region belongs to it: a wall is visible, and an object behind it
    ///   that touches it where it is visible;
    /// - a wall through the eye hides nothing, as it covers no angle; along it one sees both of its
    ///   sides;
    /// - from the border of a solid one sees nothing in the directions into it; on the seam between
    ///   two solids, nothing at all;
    /// - a solid that surrounds the eye hides nothing ([`crate::Stats::eye_in_occluder`]).
    ///
    /// Comparisons are exact for all finite coordinates. Only discs are rounded: as occluders to
    /// the polygon inside ([`crate::Disc::polygon`]), as bounds outwards by about 1e-14 of their
    /// coordinates, as is the end of a range.
    ///
    /// Costs the cells and objects in sight, and for the n sides of occluders found there O(n log
    /// n) comparisons, even if they cross. An eye more than 2^24 cells away from the grid costs all
    /// objects. The walk follows the thesis (section 3.3.3); the nearest sides are found as by
    /// Hershberger 1989 ("Finding the upper envelope of n line segments in O(n log n) time").
    #[default]
    Point,
}

impl Method {
    /// The name of the method: `"sector"`, `"cell"` or `"point"`.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Sector => "sector",
            Self::Cell => "cell",
            Self::Point => "point",
        }
    }
}
