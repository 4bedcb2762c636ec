//! Queries: the scratch of one view, and the walks that find its PVS.

mod cell;
mod point;

use glam::IVec3;

use crate::error::Error;
use crate::mask::{DirectionMasks, SideCells};
use crate::matrix::{BitMatrix, OcclusionMatrix};
use crate::occlusion::OcclusionImage;
use crate::pvs::Pvs;
use crate::scene::Scene;
use crate::shadows::ShadowScratch;
use crate::view::View;

/// Beyond this distance from the grid, in cells, nothing is taken to be hidden.
const FAR_VIEWER: i32 = 1 << 20;

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
    /// nothing is taken to be hidden ([`crate::Stats::eye_in_occluder`]). [`Pvs::holds`] asks the same of the near plane of
    /// another view.
    ///
    /// Costs what is visible. Orthographic views get the cells of the frustum without occlusion.
    Cell,
    /// What can be seen from the eye, at pixel precision: the tightest. Costs what is visible.
    ///
    /// Its sets are far smaller than those of [`Method::Cell`], but not always part of them, since whole cells know no pixels.
    /// It may keep an object that [`Method::Cell`] hides where
    /// - the object shows only in pixels on a seam between solids that abut, and one of those moves, was inserted
    ///   since [`Scene::begin_frame`], or shares more such seams than 32 boxes in 8x8x8 cells bridge;
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
    fn check(&self) -> Result<(), Error> {
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

/// The scratch of one view, reused from frame to frame.
///
/// Any number of queries can run on one scene at the same time, each in its own thread.
#[derive(Debug)]
pub struct Query {
    settings: Settings,
    pvs: Pvs,
    scratch: Scratch,
    visited: Option<BitMatrix>,
    hidden: Option<OcclusionMatrix>,
    pub(crate) shadows: ShadowScratch,
}

#[derive(Debug)]
struct Scratch {
    masks: DirectionMasks,
    sides: [SideCells; 6],
    /// By slot: twice the query's number if the object's volume was revealed,
    /// one more if the object itself was decided.
    marks: Vec<u32>,
    epoch: u32,
    /// Tiles of bricks with objects (true) or surfaces of volumes (false) in sight.
    hits: Vec<(IVec3, u64, bool)>,
    /// Cells of revealed objects by shell.
    pending: Vec<Vec<(IVec3, u32)>>,
    point: point::PointScratch,
}

impl Scratch {
    /// Forgets all marks.
    fn begin(&mut self, slots: usize) {
        self.marks.resize(slots.max(self.marks.len()), 0);
        self.epoch += 1;
        if self.epoch >= u32::MAX / 2 {
            self.marks.fill(0);
            self.epoch = 1;
        }
    }

    fn is_decided(&self, slot: u32) -> bool {
        self.marks[slot as usize] == self.epoch * 2 + 1
    }

    /// Whether the object's volume was revealed, or the object itself decided.
    fn is_revealed(&self, slot: u32) -> bool {
        self.marks[slot as usize] >= self.epoch * 2
    }

    /// Marks an object as decided; false if it was.
    fn mark_decided(&mut self, slot: u32) -> bool {
        let new = !self.is_decided(slot);
        self.marks[slot as usize] = self.epoch * 2 + 1;
        new
    }

    /// Marks an object's volume as revealed; false if it was.
    fn reveal(&mut self, slot: u32) -> bool {
        let new = !self.is_revealed(slot);
        if new {
            self.marks[slot as usize] = self.epoch * 2;
        }
        new
    }
}

impl std::fmt::Debug for BitMatrix {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "BitMatrix({} of {} cells)", self.count(), self.dims())
    }
}

impl Default for Query {
    fn default() -> Self {
        Self::new()
    }
}

impl Query {
    /// A query with default settings.
    pub fn new() -> Self {
        let settings = Settings::default();
        Self {
            settings,
            pvs: Pvs::empty(),
            scratch: Scratch {
                masks: DirectionMasks::new(settings.mask_resolution.trailing_zeros()),
                sides: Default::default(),
                marks: Vec::new(),
                epoch: 0,
                hits: Vec::new(),
                pending: Vec::new(),
                point: point::PointScratch::default(),
            },
            visited: None,
            hidden: None,
            shadows: ShadowScratch::default(),
        }
    }

    /// A query with the settings given.
    ///
    /// # Errors
    /// Refuses settings out of their range.
    pub fn with_settings(settings: Settings) -> Result<Self, Error> {
        let mut query = Self::new();
        query.set_settings(settings)?;
        Ok(query)
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Changes the settings from the next run on.
    ///
    /// # Errors
    /// Refuses settings out of their range and keeps the old ones.
    pub fn set_settings(&mut self, settings: Settings) -> Result<(), Error> {
        settings.check()?;
        let log = settings.mask_resolution.trailing_zeros();
        if log != self.scratch.masks.log() {
            self.scratch.masks = DirectionMasks::new(log);
        }
        self.settings = settings;
        Ok(())
    }

    /// Finds what the view can see.
    pub fn run(&mut self, scene: &Scene, view: &View) -> &Pvs {
        self.run_with(scene, view, None)
    }

    /// Finds what the view can see if more cells than the opaque ones count as such.
    pub(crate) fn run_with(&mut self, scene: &Scene, view: &View, more: Option<&BitMatrix>) -> &Pvs {
        let pvs = &mut self.pvs;
        pvs.reset(scene.slots.len());
        pvs.scene = scene.tag();
        pvs.moves = scene.last_move();
        pvs.method = self.settings.method;
        pvs.aggressive = more.is_some();
        pvs.cell = None;
        pvs.viewer = view.eye().map(|e| scene.grid.cell_of(e));
        match self.settings.method {
            Method::Frustum => {
                pvs.revision = scene.moves();
                for slot in 0..scene.slots.len() as u32 {
                    let Some(object) = &scene.slots[slot as usize].object else { continue };
                    pvs.stats.objects_tested += 1;
                    let seen = match object.unreported_volume() {
                        Some(volume) => view.may_see_volume(volume),
                        None => object.is_unlocated() || view.may_see(&object.bounds),
                    };
                    if seen {
                        pvs.push(scene.id(slot));
                    }
                }
            }
            Method::Cell => {
                pvs.revision = scene.revision();
                let dims = scene.grid.dims();
                let record = self.settings.record_cells.then(|| (BitMatrix::new(dims), BitMatrix::new(dims)));
                (self.visited, self.hidden) = record.unzip();
                let record = self.visited.as_mut().zip(self.hidden.as_mut());
                let walk = cell::Walk::new(scene, view, &self.settings, pvs, &mut self.scratch, record);
                walk.with_more(more).run();
            }
            Method::Point => {
                pvs.revision = scene.revision();
                point::Walk::new(scene, view, &self.settings, pvs, &mut self.scratch).run();
            }
        }
        match &mut pvs.view {
            Some(own) => own.clone_from(view),
            None => pvs.view = Some(view.clone()),
        }
        pvs
    }

    /// Finds nothing, as from a view without rays. The result holds for no view.
    pub(crate) fn run_nothing(&mut self, scene: &Scene) {
        self.pvs.reset(scene.slots.len());
        self.pvs.scene = scene.tag();
        self.pvs.method = self.settings.method;
        self.pvs.aggressive = false;
        (self.pvs.view, self.pvs.cell, self.pvs.viewer) = (None, None, None);
    }

    /// Runs each query on its view, in parallel: as if each had been run alone, bit for bit.
    /// Of two slices of different lengths, the rest of the longer one is left alone.
    ///
    /// Needs the feature `rayon`.
    #[cfg(feature = "rayon")]
    pub fn run_all(queries: &mut [Self], scene: &Scene, views: &[View]) {
        use rayon::prelude::*;
        queries.par_iter_mut().zip(views).for_each(|(query, view)| {
            query.run(scene, view);
        });
    }

    /// The result of the last run; empty before the first.
    pub fn pvs(&self) -> &Pvs {
        &self.pvs
    }

    /// The cells that the last run found hidden (H), if it was told to record them.
    /// Cells behind the last shell walked are hidden too, and not in it.
    pub fn hidden_cells(&self) -> Option<&OcclusionMatrix> {
        self.hidden.as_ref()
    }

    /// The occlusion buffers of the last run of [`Method::Point`]: for debugging. Costs their pixels.
    pub fn occlusion_images(&self) -> Vec<OcclusionImage> {
        self.scratch.point.buffers.images()
    }

    /// The cells inside the frustum that the last run visited, if it was told to
    /// record them.
    pub fn visited_cells(&self) -> Option<&BitMatrix> {
        self.visited.as_ref()
    }
}
