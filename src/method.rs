//! The methods of a query, and its settings.

use crate::error::Error;

/// How a query decides which objects can be seen.
///
/// No method loses an object that can be seen; they differ in how many hidden ones they keep, and in cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Method {
    /// The objects whose bounds may intersect the frustum. The cost grows with the number of objects in the scene.
    Frustum,
    /// The objects that can be seen from anywhere in the viewer's cell: for every eye in the cell of the view's eye that
    /// is inside no occluder, every object of which that eye sees a point inside all half-spaces of the view.
    ///
    /// The half-spaces stay where they are for all these eyes. They bound the points that are seen, and need not contain
    /// the eyes. The rays of the other eyes start at those eyes, so objects outside the half-spaces, as before a near
    /// plane, hide others too. Only the rays of the view itself start at its near plane: where that cuts into an
    /// occluder, or the eye may be in one, nothing is taken to be hidden ([`crate::Stats::eye_in_occluder`]).
    /// [`crate::Pvs::holds`] makes the same test for the near plane of another view.
    ///
    /// The cost grows with the number of visible cells. Orthographic views get the cells of the frustum, without
    /// occlusion.
    Cell,
    /// The objects that can be seen from the eye, at the precision of pixels: the smallest sets. The cost grows with the
    /// number of visible bricks, objects and pixels.
    ///
    /// Its sets are far smaller than those of [`Method::Cell`], but not always subsets of them. It may keep an object
    /// that [`Method::Cell`] hides where
    /// - the object shows only in pixels on a seam between solids that abut, and one of those moves, was inserted
    ///   since [`crate::Scene::begin_frame`], or has more such seams than 32 boxes in 8x8x8 cells bridge;
    /// - the eye is known from the matrix of the view only, and solids that were shrunk by its uncertainty no longer
    ///   abut;
    /// - only the inside of a closed mesh hides it: the triangles of the mesh are drawn, not its cells;
    /// - the budgets for refinement in [`Settings`] are used up, or the settings leave out occluders.
    #[default]
    Point,
}

/// Settings of a query. They trade hidden objects in the result for time; none makes a visible object lost.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// How visibility is decided. [`Method::Point`] by default.
    pub method: Method,
    /// [`Method::Cell`]: directions along each side of the view cube, whose six masks have this many pixels squared. A
    /// power of two from 64 to 4096; 256 by default. Finer masks hide more; their cost grows with the square.
    pub mask_resolution: u32,
    /// Occluders that appear smaller than this are not drawn, in steradians (area over squared distance, after Coorg
    /// & Teller 1997), from 0 to 1. For [`Method::Cell`] they are the visible opaque cells of one side of a shell; for
    /// [`Method::Point`], single occluders (for parallel rays, their area in square world units). 0, the default,
    /// draws all.
    pub min_solid_angle: f32,
    /// [`Method::Point`]: width of a pixel of the occlusion buffers in the middle of a face of the view cube, in
    /// degrees, from 0.03 to 11.25; 0.25 by default. Finer pixels hide more; their cost grows with the square. For
    /// orthographic views, 90 degrees mean the width of the view.
    pub pixel_degrees: f32,
    /// [`Method::Point`]: the longer side of the view gets at least this many pixels, so that narrow views stay
    /// sharp. Up to 4096; 128 by default.
    pub min_pixels: u32,
    /// [`Method::Point`]: the most occluders drawn in a query, shell by shell from the eye, the largest solid angles of a
    /// shell first. Without limit by default.
    pub max_occluders: u32,
    /// [`Method::Point`]: the most squares of directions examined again for one object that only undecided pixels
    /// show; 256 by default. 0 takes such objects for visible.
    pub refine_squares: u32,
    /// [`Method::Point`]: how often an undecided pixel is halved, up to 16; 6 by default.
    pub refine_depth: u32,
    /// [`Method::Point`]: the most squares examined again in a whole query; 65536 by default. Objects left over are
    /// decided by pixels. This bounds the time where thousands of objects are smaller than a pixel.
    pub refine_budget: u32,
    /// [`Method::Point`]: the most patches of triangles drawn again in a query, eight times as fine, in pixels that leave
    /// objects undecided; 3000 by default. 0 leaves this step out.
    pub refine_patches: u32,
    /// [`Method::Cell`]: records the visited and the hidden cells, for pictures and tests
    /// ([`crate::Query::visited_cells`], [`crate::Query::hidden_cells`]). Costs a bit for each of them. Off by default.
    pub record_cells: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            method: Method::Point,
            mask_resolution: 256,
            min_solid_angle: 0.0,
            pixel_degrees: 0.25,
            min_pixels: 128,
            max_occluders: u32::MAX,
            refine_squares: 256,
            refine_depth: 6,
            refine_budget: 1 << 16,
            refine_patches: 3000,
            record_cells: false,
        }
    }
}

impl Settings {
    pub(crate) fn check(&self) -> Result<(), Error> {
        let n = self.mask_resolution;
        if !n.is_power_of_two() {
            let what = "the mask resolution (a power of two)";
            return Err(Error::Setting { what, value: f64::from(n), min: 64.0, max: 4096.0 });
        }
        let within = |what, value: f64, min, max| {
            if (min..=max).contains(&value) { Ok(()) } else { Err(Error::Setting { what, value, min, max }) }
        };
        within("the mask resolution (a power of two)", f64::from(n), 64.0, 4096.0)?;
        within("the least solid angle", f64::from(self.min_solid_angle), 0.0, 1.0)?;
        let degrees = f64::from(self.pixel_degrees);
        within("the width of a pixel in degrees", degrees, f64::from(0.03f32), 11.25)?;
        within("the least number of pixels", f64::from(self.min_pixels), 0.0, 4096.0)?;
        within("the depth of refinement", f64::from(self.refine_depth), 0.0, 16.0)
    }
}
