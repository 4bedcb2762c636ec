//! How a query decides what can be seen, and its settings.

use crate::error::Error;

/// How a query decides what can be seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Method {
    /// Objects whose bounds may meet the frustum. Costs all objects.
    Frustum,
    /// What can be seen from anywhere in the viewer's cell: for every eye in the cell of the view's eye that is
    /// inside no occluder, every object of which that eye sees a point inside all half-spaces of the view.
    ///
    /// The half-spaces stay where they are; they bound what is seen, and need not hold the other eyes. The rays of
    /// those start at the eye, so that what lies outside the half-spaces, as before a near plane, hides too. Only for the
    /// view itself do rays start at its near plane: where that cuts into an occluder, or the eye may be in one,
    /// nothing is taken to be hidden ([`crate::Stats::eye_in_occluder`]). [`crate::Pvs::holds`] asks the same of the near plane of
    /// another view.
    ///
    /// Costs what is visible. Orthographic views get the cells of the frustum without occlusion.
    Cell,
    /// What can be seen from the eye, at pixel precision: the tightest. Costs what is visible.
    ///
    /// Its sets are far smaller than those of [`Method::Cell`], but not always part of them, since whole cells know no pixels.
    /// It may keep an object that [`Method::Cell`] hides where
    /// - the object shows only in pixels on a seam between solids that abut, and one of those moves, was inserted
    ///   since [`crate::Scene::begin_frame`], or shares more such seams than 32 boxes in 8x8x8 cells bridge;
    /// - the eye is known from the matrix alone, and solids shrunk by what that leaves open no longer abut;
    /// - only the inside of a closed mesh hides it, of which the triangles are drawn, not the cells;
    /// - what [`Settings`] spend on refinement is used up, or they leave out occluders.
    #[default]
    Point,
}

/// Settings of a query.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// How visibility is decided.
    pub method: Method,
    /// [`Method::Cell`]: directions along each side of the view cube. The masks have this many pixels
    /// squared, six times. A power of two from 64 to 4096. Finer masks
    /// hide more and cost more.
    pub mask_resolution: u32,
    /// Occluders that appear smaller than this are not drawn, in steradians (Coorg & Teller
    /// 1997: area over squared distance). For [`Method::Cell`] they are sides of shells with their
    /// visible opaque cells; for [`Method::Point`], single occluders (for parallel rays their area counts
    /// instead). 0 draws all.
    pub min_solid_angle: f32,
    /// [`Method::Point`]: width of a pixel of the occlusion buffers in the middle of a face of the
    /// view cube, in degrees, from 0.03 to 11.25. Finer pixels hide more and cost more. For
    /// orthographic views 90 degrees mean the width of the view.
    pub pixel_degrees: f32,
    /// [`Method::Point`]: the longer side of the view gets at least this many pixels, so
    /// that narrow views stay sharp. Up to 4096.
    pub min_pixels: u32,
    /// [`Method::Point`]: occluders drawn in a query, at most: shell by shell from the eye, the
    /// largest solid angles of a shell first.
    pub max_occluders: u32,
    /// [`Method::Point`]: squares of directions examined again for one object that only undecided
    /// pixels show, at most. 0 takes such objects for visible.
    pub refine_squares: u32,
    /// [`Method::Point`]: how often an undecided pixel is halved, up to 16.
    pub refine_depth: u32,
    /// [`Method::Point`]: squares examined again in a whole query, at most. What is left when they are spent
    /// is decided by pixels: this bounds the time where thousands of objects are smaller than those.
    pub refine_budget: u32,
    /// [`Method::Point`]: patches of triangles drawn again, eight times as fine, in pixels that leave
    /// objects undecided, at most in one query. 0 leaves it out.
    pub refine_patches: u32,
    /// [`Method::Cell`]: keeps which cells were visited and which were hidden, for pictures and tests.
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
