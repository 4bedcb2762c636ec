//! Where the rays of a view start.

use glam::DVec3;
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::object::Occluder;
use crate::scene::{Scene, inside_occluder, occluder_touches};
use crate::view::cut::may_start_in;
use crate::view::{Origin, View};

/// The regions where rays of a view may start beside its eye, each with its box.
#[derive(Debug)]
pub(crate) struct Starts {
    /// Between the eye and the near plane.
    cut: SmallVec<[(View, Block); 1]>,
    /// Where an eye may be that is not known exactly, or that may go elsewhere.
    unsure: Option<(View, Block)>,
}

impl Starts {
    /// The regions as far as they lie in the scene.
    pub(crate) fn of(scene: &Scene, view: &View) -> Self {
        let (min, max) = scene.extent();
        Self { cut: view.cut_regions(min, max).collect(), unsure: view.eye_region() }
    }

    /// Whether an occluder, or an opaque cell, may touch one of the regions.
    pub(crate) fn touch_occluder(&self, scene: &Scene) -> bool {
        self.regions().any(|(region, around)| occluder_touches(scene, region, around))
    }

    /// Those between the eye and the near plane.
    pub(crate) fn cut(&self) -> &[(View, Block)] {
        &self.cut
    }

    /// All regions.
    fn regions(&self) -> impl Iterator<Item = &(View, Block)> {
        self.cut.iter().chain(&self.unsure)
    }

    /// A box around an eye and the regions.
    pub(crate) fn around(&self, eye: DVec3) -> Block {
        self.regions().fold(Block { min: eye, max: eye }, |all, (_, around)| Block {
            min: all.min.min(around.min),
            max: all.max.max(around.max),
        })
    }

    /// Whether rays of the view may start inside an occluder, so that one sees through it; in
    /// doubt, yes.
    pub(crate) fn may_be_in(&self, view: &View, occluder: &Occluder) -> bool {
        may_start_in(view, &self.cut, self.unsure.as_ref(), occluder)
    }
}

/// Whether rays may start inside an occluder: at the eye, or in one of the regions. One then sees
/// through its inside, so the cells that it makes opaque hide nothing.
pub(crate) fn rays_start_in_occluder(scene: &Scene, view: &View, starts: &Starts) -> bool {
    match view.origin {
        Origin::Eye { at, .. } => inside_occluder(scene, at, view.layers()) || starts.touch_occluder(scene),
        Origin::Direction(_) => true,
    }
}
