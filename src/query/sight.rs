//! What the last run of a query says about boxes.

use crate::geometry::Block;
use crate::method::Method;
use crate::query::Query;
use crate::query::point::scratch::PointScratch;
use crate::scene::Scene;
use crate::view::View;

/// The view of a query's last run, and what hides from it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sight<'a> {
    pub(crate) view: &'a View,
    /// The occlusion buffers, as long as they are true.
    buffers: Option<&'a PointScratch>,
}

impl Query {
    /// What the last run says about boxes; `None` if it saw nothing or there was none. Its buffers count only if they
    /// were drawn by that run ([`Method::Point`]) and nothing moved since that they or the set depend on.
    pub(crate) fn sight(&self, scene: &Scene) -> Option<Sight<'_>> {
        let pvs = self.pvs();
        let view = pvs.view.as_ref()?;
        let drawn = matches!(pvs.method, Method::Point(_)) && pvs.is_valid_for(scene, view);
        Some(Sight { view, buffers: drawn.then_some(&self.point) })
    }
}

impl Sight<'_> {
    /// Whether the view may see a point of some geometry in a box; in doubt, yes.
    pub(crate) fn may_see(&self, block: &Block) -> bool {
        self.view.may_see_volume(block) && !self.buffers.is_some_and(|buffers| buffers.hides(block))
    }
}
