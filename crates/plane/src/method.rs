//! The methods of a query.

/// How a query decides which objects can be seen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Method {
    /// The objects that lie in the view, hidden or not. Costs all objects of the scene.
    Sector,
    /// The objects that can be seen from anywhere in the grid cell of the view's eye: for every eye in that cell that is inside no
    /// occluder, each object of which that eye sees a point inside the view. The view stays where it is; it bounds the objects that are
    /// seen, and need not hold the other eyes.
    ///
    /// Only cells that lie wholly inside one solid or one rectangle of opaque tiles hide: walls without thickness hide nothing. Where the
    /// eye is inside a solid occluder, nothing is hidden. Costs the cells in sight, 64 at a time (thesis, section 3.3).
    /// [`crate::Query::set_cell_options`] sets the options.
    Cell,
    /// The objects that can be seen from the eye, exactly. Costs the cells and objects in sight.
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
