//! The methods of a query.

/// How a query decides which objects can be seen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Method {
    /// The objects that lie in the view, hidden or not. Costs all objects of the scene.
    Sector,
    /// The objects that can be seen from the eye, exactly. Costs the cells and objects in sight.
    #[default]
    Point,
}

impl Method {
    /// The name of the method: `"sector"` or `"point"`.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Sector => "sector",
            Self::Point => "point",
        }
    }
}
