//! The methods of a query, and the options of each.

use crate::error::Error;

/// How a query decides which objects can be seen.
///
/// ```
/// use casca::{Method, PointOptions, Query};
///
/// # fn main() -> Result<(), casca::Error> {
/// let precise = Query::with_method(Method::Point(PointOptions::default().pixel_degrees(0.1)))?;
/// let for_the_cell = Query::with_method(Method::cell())?;
/// # let _ = (precise, for_the_cell);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Method {
    /// The objects whose bounds may meet the frustum, hidden or not. Costs all objects of the
    /// scene.
    Frustum,
    /// The objects that can be seen from anywhere in the grid cell of the view's eye: for every eye
    /// in that cell that is inside no occluder, each object of which that eye sees a point inside
    /// all half-spaces of the view.
    ///
    /// The half-spaces stay where they are; they bound the objects that are seen, and need not hold
    /// the other eyes. The rays of those eyes start at the eye, so that occluders outside the
    /// half-spaces, as before a near plane, hide too. Only for the view itself do rays start at its
    /// near plane: where that plane cuts into an occluder, or the eye may be in one, nothing is
    /// taken to be hidden ([`crate::Stats::eye_in_occluder`]). [`crate::Pvs::is_valid_for`] asks
    /// the same of the near plane of another view.
    ///
    /// Costs the cells in sight, as far as they may contain objects that were not found yet, and a
    /// comparison for each object that moves. The first run of a query on a scene lists all objects
    /// by cell. Orthographic views get no occlusion. Where nothing is taken to be hidden, a run
    /// costs all objects of the scene, and no cells. Thesis, section 3.3.
    Cell(CellOptions),
    /// The objects that can be seen from the eye, at pixel precision: the tightest method. Costs
    /// the cells and occluders in sight. Thesis, section 5 (future work).
    ///
    /// Its sets are far smaller than those of [`Method::Cell`], but not always part of them, since
    /// whole cells know no pixels. It may keep an object that [`Method::Cell`] hides where
    /// - the object shows only in pixels on a seam between solids that abut, and one of those
    ///   moves, was inserted since [`crate::Scene::begin_frame`], or shares more such seams than 32
    ///   boxes in 8x8x8 cells bridge;
    /// - the eye is known from the matrix alone, and solids shrunk by the uncertainty of that eye
    ///   no longer abut;
    /// - only the inside of a closed mesh hides it, of which the triangles are drawn, not the
    ///   cells;
    /// - the budget of refinement in [`PointOptions`] is used up, or the options leave out
    ///   occluders.
    Point(PointOptions),
}

impl Default for Method {
    /// [`Method::point`].
    fn default() -> Self {
        Self::point()
    }
}

impl Method {
    /// [`Method::Cell`] with its default options.
    pub const fn cell() -> Self {
        Self::Cell(CellOptions::new())
    }

    /// [`Method::Point`] with its default options.
    pub const fn point() -> Self {
        Self::Point(PointOptions::new())
    }

    /// The name of the method without its options: `"frustum"`, `"cell"` or `"point"`.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Frustum => "frustum",
            Self::Cell(_) => "cell",
            Self::Point(_) => "point",
        }
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        match self {
            Self::Frustum => Ok(()),
            Self::Cell(options) => options.check(),
            Self::Point(options) => options.check(),
        }
    }
}

/// Options of [`Method::Cell`]. None of them can hide an object that can be seen.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct CellOptions {
    /// Directions along each side of the view cube: a power of two from 64 to 4096. The six masks
    /// have this many bits squared each. Finer masks hide more and cost more. Default: 256.
    pub mask_resolution: u32,
    /// Opaque cells in sight on one side of a shell are not drawn if together they appear smaller
    /// than this, in steradians from 0 to 1 (Coorg & Teller 1997: area over squared distance).
    /// Default: 0, which draws all.
    pub min_solid_angle: f32,
}

impl Default for CellOptions {
    fn default() -> Self {
        Self::new()
    }
}

impl CellOptions {
    /// The default options, as a constant.
    pub const fn new() -> Self {
        Self { mask_resolution: 256, min_solid_angle: 0.0 }
    }

    /// Sets [`CellOptions::mask_resolution`].
    #[must_use]
    pub const fn mask_resolution(mut self, directions: u32) -> Self {
        self.mask_resolution = directions;
        self
    }

    /// Sets [`CellOptions::min_solid_angle`], in steradians.
    #[must_use]
    pub const fn min_solid_angle(mut self, steradians: f32) -> Self {
        self.min_solid_angle = steradians;
        self
    }

    fn check(&self) -> Result<(), Error> {
        let n = self.mask_resolution;
        let what = "the mask resolution (a power of two)";
        if !n.is_power_of_two() {
            return Err(Error::Setting { what, value: f64::from(n), min: 64.0, max: 4096.0 });
        }
        within(what, f64::from(n), 64.0, 4096.0)?;
        within(LEAST_ANGLE, f64::from(self.min_solid_angle), 0.0, 1.0)
    }
}

/// Options of [`Method::Point`]. Each trades speed for tightness; none of them can hide an object
/// that can be seen.
///
/// Three sets of them have names, from the fastest to the one with the smallest sets:
/// [`PointOptions::fast`], [`PointOptions::balanced`] and [`PointOptions::tight`]. Which one to take
/// depends on what an object of the set costs you, measured on a city, a forest, a harbour, a town
/// and a world of blocks:
///
/// | | time | objects found | cheapest where an object costs |
/// |---|---|---|---|
/// | `fast` | 0.49 to 0.81 | 1.24 to 1.71 | less than 7 to 9 µs, among blocks 39 |
/// | `balanced` | 1 | 1 | more than that |
/// | `tight` | 1.3 to 2.1 | 0.91 to 1.00 | more than 110 µs to 1.6 ms |
///
/// ```
/// use casca::{Method, PointOptions, Query};
///
/// # fn main() -> Result<(), casca::Error> {
/// let query = Query::with_method(Method::Point(PointOptions::tight()))?;
/// assert_eq!(PointOptions::balanced(), PointOptions::default());
/// # let _ = query;
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct PointOptions {
    /// Occluders that appear smaller than this are not drawn, in steradians from 0 to 1 (Coorg &
    /// Teller 1997: area over squared distance; for parallel rays their area in square world units
    /// counts instead). Default: 0, which draws all.
    pub min_solid_angle: f32,
    /// Width of a pixel of the occlusion buffers in the middle of a face of the view cube, in
    /// degrees from 0.03 to 11.25. Finer pixels hide more and cost more. For orthographic views 90
    /// degrees mean the width of the view. Default: 0.25.
    pub pixel_degrees: f32,
    /// The longer side of the view gets at least this many pixels, up to 4096, so that narrow views
    /// stay sharp. Default: 128.
    pub min_pixels: u32,
    /// The most occluders drawn in a query: shell by shell from the eye, and within a shell those
    /// of the largest solid angle first. Default: no limit.
    pub max_occluders: u32,
    /// The most squares of directions that are examined again for one object that only undecided
    /// pixels show. 0 takes such objects for visible. More than the default also allow an object
    /// more undecided pixels, in proportion, before it is taken for visible. A mesh whose box has
    /// many open pixels is not examined at all: one in seven of those would turn out to be hidden,
    /// and an examination costs up to a hundred times the quick tests. Default: 256.
    pub refine_squares: u32,
    /// How often an undecided pixel is halved, up to 16. Default: 6.
    pub refine_depth: u32,
    /// The most squares examined again in a whole query: this bounds the time where thousands of
    /// objects are smaller than a pixel. Once it is used up, the order of objects decides which of
    /// the undecided ones are left out; until then it decides nothing. Default: 65,536.
    pub refine_budget: u32,
    /// The most patches of triangles that are drawn again, eight times as fine, in pixels that
    /// leave objects undecided, in a whole query. 0 turns it off. The order of objects matters as
    /// for [`PointOptions::refine_budget`]. Default: 3,000.
    pub refine_patches: u32,
    /// Patches of triangles are drawn from this radius on, in pixels of the occlusion buffers from 0
    /// to 64. Smaller ones hide little: pixels that their outlines touch do not count. Where far
    /// surfaces consist of small faces, as in a world of blocks, a smaller radius hides more, and
    /// costs up to half as much again. Default: 4.
    pub patch_radius: f32,
    /// Whether a run begins with the occluders that were of use in the last run of the same query,
    /// and leaves out others until something comes into sight that the last run did not find. For
    /// cameras that move little from frame to frame this costs 48 to 86 percent of a run that knows
    /// nothing. Sets are up to 4 percent larger, with thousands of movers in sight up to 12, since
    /// objects that were visible are examined in one of sixteen runs only; they depend on the runs
    /// since the last [`crate::Query::reset`]. Without effect where [`PointOptions::max_occluders`]
    /// or [`PointOptions::min_solid_angle`] leave out occluders. Default: false.
    pub coherent: bool,
}

impl Default for PointOptions {
    fn default() -> Self {
        Self::new()
    }
}

impl PointOptions {
    /// The least time, and the largest sets: pixels of the default size decide, nothing is examined
    /// again, and patches of triangles below 6 pixels are not drawn. Saves most, and keeps most
    /// hidden objects, where those are smaller than a few pixels; the report of the laboratory has
    /// figures for each of its scenes.
    pub const fn fast() -> Self {
        Self::new().refine_squares(0).refine_patches(0).patch_radius(6.0)
    }

    /// The default options, [`PointOptions::new`], by the name that they have beside the other two.
    pub const fn balanced() -> Self {
        Self::new()
    }

    /// The smallest sets, and the most time: pixels of 0.09 degrees, and larger budgets. Where
    /// thousands of boxes are smaller than a pixel, it costs little more than
    /// [`PointOptions::balanced`], since finer pixels leave fewer of them undecided.
    pub const fn tight() -> Self {
        Self::new()
            .pixel_degrees(0.09)
            .refine_squares(1024)
            .refine_depth(7)
            .refine_budget(1 << 18)
            .refine_patches(20_000)
    }

    /// The default options, as a constant.
    pub const fn new() -> Self {
        Self {
            min_solid_angle: 0.0,
            pixel_degrees: 0.25,
            min_pixels: 128,
            max_occluders: u32::MAX,
            refine_squares: 256,
            refine_depth: 6,
            refine_budget: 1 << 16,
            refine_patches: 3000,
            patch_radius: 4.0,
            coherent: false,
        }
    }

    /// Sets [`PointOptions::min_solid_angle`], in steradians.
    #[must_use]
    pub const fn min_solid_angle(mut self, steradians: f32) -> Self {
        self.min_solid_angle = steradians;
        self
    }

    /// Sets [`PointOptions::pixel_degrees`], in degrees.
    #[must_use]
    pub const fn pixel_degrees(mut self, degrees: f32) -> Self {
        self.pixel_degrees = degrees;
        self
    }

    /// Sets [`PointOptions::min_pixels`].
    #[must_use]
    pub const fn min_pixels(mut self, pixels: u32) -> Self {
        self.min_pixels = pixels;
        self
    }

    /// Sets [`PointOptions::max_occluders`].
    #[must_use]
    pub const fn max_occluders(mut self, occluders: u32) -> Self {
        self.max_occluders = occluders;
        self
    }

    /// Sets [`PointOptions::refine_squares`].
    #[must_use]
    pub const fn refine_squares(mut self, squares: u32) -> Self {
        self.refine_squares = squares;
        self
    }

    /// Sets [`PointOptions::refine_depth`].
    #[must_use]
    pub const fn refine_depth(mut self, halvings: u32) -> Self {
        self.refine_depth = halvings;
        self
    }

    /// Sets [`PointOptions::refine_budget`].
    #[must_use]
    pub const fn refine_budget(mut self, squares: u32) -> Self {
        self.refine_budget = squares;
        self
    }

    /// Sets [`PointOptions::refine_patches`].
    #[must_use]
    pub const fn refine_patches(mut self, patches: u32) -> Self {
        self.refine_patches = patches;
        self
    }

    /// Sets [`PointOptions::patch_radius`], in pixels.
    #[must_use]
    pub const fn patch_radius(mut self, pixels: f32) -> Self {
        self.patch_radius = pixels;
        self
    }

    /// Sets [`PointOptions::coherent`].
    #[must_use]
    pub const fn coherent(mut self, coherent: bool) -> Self {
        self.coherent = coherent;
        self
    }

    fn check(&self) -> Result<(), Error> {
        within(LEAST_ANGLE, f64::from(self.min_solid_angle), 0.0, 1.0)?;
        let degrees = f64::from(self.pixel_degrees);
        within("the width of a pixel in degrees", degrees, f64::from(0.03f32), 11.25)?;
        within("the least number of pixels", f64::from(self.min_pixels), 0.0, 4096.0)?;
        within("the least radius of a patch in pixels", f64::from(self.patch_radius), 0.0, 64.0)?;
        within("the depth of refinement", f64::from(self.refine_depth), 0.0, 16.0)
    }
}

const LEAST_ANGLE: &str = "the least solid angle";

/// Refuses a value out of its range; NaN lies in none.
fn within(what: &'static str, value: f64, min: f64, max: f64) -> Result<(), Error> {
    if (min..=max).contains(&value) { Ok(()) } else { Err(Error::Setting { what, value, min, max }) }
}
