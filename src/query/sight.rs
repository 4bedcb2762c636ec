//! Testing boxes against the last run of a query.

use crate::geometry::Block;
use crate::method::Method;
use crate::numeric::view::ALONG_RAYS;
use crate::object::Occluder;
use crate::query::Query;
use crate::query::point::scratch::PointScratch;
use crate::scene::Scene;
use crate::view::cut::may_start_in;
use crate::view::{Origin, View};

/// The view of a query's last run, and the buffers that hide boxes from it.
#[derive(Debug)]
pub(crate) struct Sight<'a> {
    pub(crate) view: &'a View,
    /// The occlusion buffers, as long as they are true.
    buffers: Option<&'a PointScratch>,
    /// Regions between the eye and the near plane.
    cut: Vec<(View, Block)>,
    /// The region where an eye may be that is not known exactly.
    unsure: Option<(View, Block)>,
}

impl Query {
    /// The sight of the last run; `None` if it saw nothing or there was none. Its buffers count only if they
    /// were drawn by that run ([`Method::Point`]) and nothing moved since that they or the set depend on.
    pub(crate) fn sight(&self, scene: &Scene) -> Option<Sight<'_>> {
        let pvs = self.pvs();
        let view = pvs.view.as_ref()?;
        let drawn = matches!(pvs.method, Method::Point(_)) && pvs.is_valid_for(scene, view);
        let (min, max) = scene.extent();
        Some(Sight {
            view,
            buffers: drawn.then_some(&self.point),
            cut: view.cut_regions(min, max).collect(),
            unsure: view.eye_region(),
        })
    }
}

impl Sight<'_> {
    /// Whether the view may see a point of some geometry in a box; in doubt, yes.
    pub(crate) fn may_see(&self, block: &Block) -> bool {
        self.view.may_see_volume(block) && !self.buffers.is_some_and(|buffers| buffers.hides(block))
    }

    /// Whether one may see an occluder from its inside.
    pub(crate) fn may_start_in(&self, occluder: &Occluder) -> bool {
        !self.view.is_ordered() || may_start_in(self.view, &self.cut, self.unsure.as_ref(), occluder)
    }

    /// Whether rays may run into the side of a box with a normal along an axis (`sign` 1) or against it (-1), at a
    /// coordinate on that axis; in doubt, yes.
    pub(crate) fn may_enter(&self, axis: usize, sign: f64, at: f64) -> bool {
        match self.view.origin {
            Origin::Eye { at: eye, error } => (eye[axis] - at) * sign >= -error,
            Origin::Direction(d) => d[axis] * sign <= ALONG_RAYS,
        }
    }
}
