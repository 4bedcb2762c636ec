//! Queries: the scratch of one view, and the walks that find its PVS.

pub(crate) mod cell;
pub(crate) mod point;
pub(crate) mod receivers;
pub(crate) mod validity;

use glam::IVec3;

use crate::error::Error;
use crate::matrix::bits::{BitMatrix, OcclusionMatrix};
use crate::method::{Method, Settings};
use crate::occlusion::image::OcclusionImage;
use crate::pvs::Pvs;
use crate::query::cell::masks::{DirectionMasks, SideCells};
use crate::query::receivers::ReceiverScratch;
use crate::scene::Scene;
use crate::view::View;

/// Beyond this distance from the grid, in cells, nothing is taken to be hidden.
const FAR_VIEWER: i32 = 1 << 20;

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
    pub(crate) shadows: ReceiverScratch,
}

#[derive(Debug)]
pub(crate) struct Scratch {
    pub(crate) masks: DirectionMasks,
    pub(crate) sides: [SideCells; 6],
    /// By slot: twice the query's number if the object's volume was revealed,
    /// one more if the object itself was decided.
    pub(crate) marks: Vec<u32>,
    pub(crate) epoch: u32,
    /// Tiles of bricks with objects (true) or surfaces of volumes (false) in sight.
    pub(crate) hits: Vec<(IVec3, u64, bool)>,
    /// Cells of revealed objects by shell.
    pub(crate) pending: Vec<Vec<(IVec3, u32)>>,
    pub(crate) point: point::PointScratch,
}

impl Scratch {
    /// Forgets all marks.
    pub(crate) fn begin(&mut self, slots: usize) {
        self.marks.resize(slots.max(self.marks.len()), 0);
        self.epoch += 1;
        if self.epoch >= u32::MAX / 2 {
            self.marks.fill(0);
            self.epoch = 1;
        }
    }

    pub(crate) fn is_decided(&self, slot: u32) -> bool {
        self.marks[slot as usize] == self.epoch * 2 + 1
    }

    /// Whether the object's volume was revealed, or the object itself decided.
    pub(crate) fn is_revealed(&self, slot: u32) -> bool {
        self.marks[slot as usize] >= self.epoch * 2
    }

    /// Marks an object as decided; false if it was.
    pub(crate) fn mark_decided(&mut self, slot: u32) -> bool {
        let new = !self.is_decided(slot);
        self.marks[slot as usize] = self.epoch * 2 + 1;
        new
    }

    /// Marks an object's volume as revealed; false if it was.
    pub(crate) fn reveal(&mut self, slot: u32) -> bool {
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
            shadows: ReceiverScratch::default(),
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
        pvs.reset(scene.slot_count());
        pvs.scene = scene.tag();
        pvs.moves = scene.last_move();
        pvs.method = self.settings.method;
        pvs.aggressive = more.is_some();
        pvs.cell = None;
        pvs.viewer = view.eye().map(|e| scene.grid().cell_of(e));
        match self.settings.method {
            Method::Frustum => {
                pvs.revision = scene.moves();
                for (slot, object) in scene.living() {
                    pvs.stats.objects_tested += 1;
                    let seen = match object.unreported_volume() {
                        Some(volume) => view.may_see_volume(volume),
                        None => object.is_unlocated() || view.may_see(object.bounds()),
                    };
                    if seen {
                        pvs.push(scene.id(slot));
                    }
                }
            }
            Method::Cell => {
                pvs.revision = scene.revision();
                let dims = scene.grid().dims();
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
        self.pvs.reset(scene.slot_count());
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
