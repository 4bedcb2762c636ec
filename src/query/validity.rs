//! Whether a result is still valid.

use crate::method::Method;
use crate::pvs::Pvs;
use crate::query::start::Starts;
use crate::scene::{Scene, inside_occluder};
use crate::view::View;

impl Pvs {
    /// Whether this result still holds for a new view. In doubt, no.
    ///
    /// For all methods, nothing moved that matters, the new view shows the same layers, and it sees
    /// nothing outside the half-spaces of this result's. [`Method::Frustum`] asks no more; nor does
    /// [`Method::Cell`] where its eye was in an occluder. Else the near plane of the new view cuts
    /// into no occluder (nor does any other plane between its eye and the part of the world that it
    /// sees) that counted for this result, and
    /// - [`Method::Cell`]: the new eye lies anywhere in [`Self::view_cell`], inside no occluder;
    /// - [`Method::Point`]: the new eye is at the same point, or within the
    ///   [reach](View::with_reach) of the view.
    ///
    /// So a result of [`Method::Cell`] in all directions ([`View::omnidirectional`]) holds for
    /// every view from its cell. Results of [`crate::Query::shadow_casters`] never hold. Costs the planes of both views, and the cells before the
    /// near plane.
    pub fn is_valid_for(&self, scene: &Scene, view: &View) -> bool {
        let Some(own) = &self.view else { return false };
        let fresh = self.is_fresh(scene.revision(), scene.moves()) && scene.tag() == self.scene;
        if self.partial || own.layers() != view.layers() || !fresh {
            return false;
        }
        // A volume that was hidden stands for all that moves in it; one that was seen does not.
        if self.revealed.iter().any(|&id| scene.moved_since(id, self.moves)) {
            return false;
        }
        let (min, max) = scene.extent();
        match self.method {
            _ if own == view => true,
            _ if !own.contains(view, min, max) => false,
            Method::Frustum => true,
            // Also where the eye is in an occluder: that one was left out.
            Method::Point(_) => {
                own.reaches(view)
                    && (own.covers_starts(view) || !Starts::of(scene, view).touch_occluder(scene))
            }
            // Nothing was taken to be hidden.
            Method::Cell(_) if self.stats.eye_in_occluder => true,
            // The half-spaces were widened to contain the whole cell: every point of it will do.
            Method::Cell(_) => {
                let Some(at) = view.eye() else { return false };
                let error = view.eye_box();
                let cell_of = |p| Some(scene.grid().cell_of(p));
                cell_of(at - error) == self.cell
                    && cell_of(at + error) == self.cell
                    && !inside_occluder(scene, at, view.layers())
                    && !Starts::of(scene, view).touch_occluder(scene)
            }
        }
    }
}
